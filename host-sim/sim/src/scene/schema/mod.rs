//! Every field of a scene file in one table: name, unit, range and meaning.
//!
//! Parsing, `--set`, error messages and printing all read this table. A field that is added to a scene's types therefore needs
//! one entry in `fields.rs`, `environment_fields.rs` or `hand_fields.rs`; a test compares types and table. The fields of the
//! control law are those of [`touchstone_control::law_settings`].

mod environment_fields;
mod fields;
mod hand_fields;

pub use fields::FIELDS;
pub(crate) use fields::OPTIONAL_TABLES;
pub(crate) use hand_fields::MOTION_KIND;

/// Type and allowed range of the value of a scene field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Any text.
    Text,
    /// `true` or `false`.
    Flag,
    /// One of these names.
    Choice(&'static [&'static str]),
    /// An integer between these two numbers, ends included.
    Whole(i64, i64),
    /// A finite number.
    Number(Range),
    /// A list of finite numbers: smallest and largest length of the list, then lowest and highest value of each number, ends
    /// included.
    Numbers(usize, usize, f64, f64),
}

/// Range of a number, in the unit of its field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// Any finite number.
    Any,
    /// Any finite number except 0.
    NotZero,
    /// Above 0.
    Positive,
    /// 0 or more.
    NotNegative,
    /// At least this number.
    AtLeast(f64),
    /// Above 0 and at most this number.
    UpTo(f64),
    /// Between these two numbers, ends included.
    Within(f64, f64),
    /// Between two decimal numbers, ends included. They are given as text, as in the control crate's list of settings.
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

    /// Describes the range in words that can follow "must be" in an error message.
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

/// One field of a scene: name, unit, allowed values and meaning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// Path of the field from the top of the scene, with dots: `device.inertia_kg_m2`.
    pub path: &'static str,
    /// Unit suffix at the end of the field's name, such as `rad_per_s`; empty for a field without a unit.
    pub unit: &'static str,
    /// Type and range of the field's value.
    pub kind: Kind,
    /// Description of the field that can follow "give" in an error message.
    pub about: &'static str,
    /// The meaning of leaving the field out; `None` if the field has a default value.
    pub absent: Option<&'static str>,
    /// Motions that have the field; empty for fields outside `[operator.motion]`.
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
    /// The field's name: the last part of its path.
    pub fn name(&self) -> &'static str {
        self.path
            .rsplit('.')
            .next()
            .expect("rsplit gives at least one part")
    }

    /// Path of the table that contains the field: all but the last part of the field's path.
    pub fn table(&self) -> &'static str {
        self.path.rsplit_once('.').map_or("", |(table, _)| table)
    }

    /// The field's name without the unit suffix; `None` for a field without a unit.
    pub fn stem(&self) -> Option<&'static str> {
        self.name().strip_suffix(self.unit)?.strip_suffix('_')
    }

    /// The unit as people write it, such as `kg·m²`.
    pub fn unit_shown(&self) -> &'static str {
        crate::scene::units::by_suffix(self.unit).map_or("", |unit| unit.shown)
    }

    /// Description of the field with its unit: "the device's moment of inertia in kg·m²".
    pub fn about_with_unit(&self) -> String {
        match self.unit_shown() {
            "" => self.about.to_owned(),
            unit => format!("{} in {unit}", self.about),
        }
    }

    /// Whether the hand's motion named `motion` has the field.
    pub fn suits(&self, motion: &str) -> bool {
        self.motions.is_empty() || self.motions.contains(&motion)
    }
}

/// The field with this dotted path; `None` if no field has it.
pub(crate) fn at(path: &str) -> Option<&'static Field> {
    FIELDS.iter().find(|field| field.path == path)
}

/// Whether the path names a table that contains at least one field.
pub(crate) fn is_table(path: &str) -> bool {
    FIELDS.iter().any(|field| {
        field
            .path
            .strip_prefix(path)
            .is_some_and(|rest| rest.starts_with('.'))
    })
}

/// Names of the fields and tables directly inside a table, in printing order; `""` is the top of the scene.
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
