//! Every field of a scene in one table: name, unit, range and meaning.
//!
//! Parsing, `--set`, error messages and printing all read this table, so a field that is added to the types in this
//! module needs one entry in `schema/fields.rs`. A test compares the two. The law's fields are those of
//! [`touchstone_control::law_settings`].

mod environment_fields;
mod fields;
mod hand_fields;

pub use fields::FIELDS;
pub(crate) use fields::OPTIONAL_TABLES;
pub(crate) use hand_fields::MOTION_KIND;

/// The values that a field may have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Any text.
    Text,
    /// `true` or `false`.
    Flag,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// A whole number in this range, ends included.
    Whole(i64, i64),
    /// A finite number.
    Number(Range),
    /// A list of finite numbers: the least and the most of them, and the range of each, ends included.
    Numbers(usize, usize, f64, f64),
}

/// Range of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// Any finite number.
    Any,
    /// Any but 0.
    NotZero,
    /// Above 0.
    Positive,
    /// 0 or more.
    NotNegative,
    /// At least this.
    AtLeast(f64),
    /// Above 0 and at most this.
    UpTo(f64),
    /// Between these, ends included.
    Within(f64, f64),
    /// Between these decimals, ends included, as a table of settings gives them.
    Exactly(&'static str, &'static str),
}

impl Range {
    /// Whether `value` lies in the range.
    pub fn holds(self, value: f64) -> bool {
        match self {
            Range::Any => true,
            Range::NotZero => value != 0.0,
            Range::Positive => value > 0.0,
            Range::NotNegative => value >= 0.0,
            Range::AtLeast(least) => value >= least,
            Range::UpTo(most) => value > 0.0 && value <= most,
            Range::Within(least, most) => (least..=most).contains(&value),
            Range::Exactly(least, most) => {
                let number = |text: &str| text.parse().unwrap_or(f64::NAN);
                (number(least)..=number(most)).contains(&value)
            }
        }
    }

    /// The range in words, to stand after "must be".
    pub fn words(self) -> String {
        match self {
            Range::Any => "finite".into(),
            Range::NotZero => "other than 0".into(),
            Range::Positive => "above 0".into(),
            Range::NotNegative => "0 or more".into(),
            Range::AtLeast(least) => format!("at least {least}"),
            Range::UpTo(most) => format!("above 0 and at most {most}"),
            Range::Within(least, most) => format!("between {least} and {most}"),
            Range::Exactly(least, most) => format!("between {least} and {most}"),
        }
    }
}

/// One field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// Tables and name, dotted.
    pub path: &'static str,
    /// Suffix of its unit; empty where it has none.
    pub unit: &'static str,
    /// The values that the setting may hold.
    pub kind: Kind,
    /// Description that can stand after "give".
    pub about: &'static str,
    /// The meaning of leaving it out; `None` if it has a default value.
    pub absent: Option<&'static str>,
    /// Motions that have it; empty outside `[operator.motion]`.
    pub motions: &'static [&'static str],
}

impl Field {
    const fn absent(self, meaning: &'static str) -> Field {
        Field {
            absent: Some(meaning),
            ..self
        }
    }

    const fn only(self, motions: &'static [&'static str]) -> Field {
        Field { motions, ..self }
    }
}

const fn field(path: &'static str, unit: &'static str, kind: Kind, about: &'static str) -> Field {
    Field {
        path,
        unit,
        kind,
        about,
        absent: None,
        motions: &[],
    }
}

const fn number(
    path: &'static str,
    unit: &'static str,
    range: Range,
    about: &'static str,
) -> Field {
    field(path, unit, Kind::Number(range), about)
}

impl Field {
    /// Last part of the path.
    pub fn name(&self) -> &'static str {
        self.path
            .rsplit('.')
            .next()
            .expect("rsplit gives at least one part")
    }

    /// All but the last part of the path.
    pub fn table(&self) -> &'static str {
        self.path.rsplit_once('.').map_or("", |(table, _)| table)
    }

    /// The name without its unit; `None` for a field without a unit.
    pub fn stem(&self) -> Option<&'static str> {
        self.name().strip_suffix(self.unit)?.strip_suffix('_')
    }

    /// The unit for people: `kg·m²`.
    pub fn unit_shown(&self) -> &'static str {
        crate::scene::units::by_suffix(self.unit).map_or("", |unit| unit.shown)
    }

    /// `about` with the unit: "the device's moment of inertia in kg·m²".
    pub fn about_with_unit(&self) -> String {
        match self.unit_shown() {
            "" => self.about.to_owned(),
            unit => format!("{} in {unit}", self.about),
        }
    }

    /// Whether a motion of this kind has the field.
    pub fn suits(&self, motion: &str) -> bool {
        self.motions.is_empty() || self.motions.contains(&motion)
    }
}

/// The field at this path.
pub(crate) fn at(path: &str) -> Option<&'static Field> {
    FIELDS.iter().find(|field| field.path == path)
}

/// Whether some field lies in the table at this path.
pub(crate) fn is_table(path: &str) -> bool {
    FIELDS.iter().any(|field| {
        field
            .path
            .strip_prefix(path)
            .is_some_and(|rest| rest.starts_with('.'))
    })
}

/// Fields and tables directly inside a table (`""` is the top), by name, in order.
pub(crate) fn inside(table: &str) -> Vec<&'static str> {
    let mut names: Vec<&'static str> = Vec::new();
    for field in FIELDS {
        let rest = match table {
            "" => Some(field.path),
            _ => field
                .path
                .strip_prefix(table)
                .and_then(|rest| rest.strip_prefix('.')),
        };
        if let Some(name) = rest.and_then(|rest| rest.split('.').next())
            && !names.contains(&name)
        {
            names.push(name);
        }
    }
    names
}
