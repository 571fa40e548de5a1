//! One axis of a map: a field of the scene file and the values that it takes.

use serde_json::Value;
use std::ops::RangeInclusive;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::schema::{FIELDS, Field, Kind};
use touchstone_sim::scene::{Scene, list, path_of};

/// Largest number of values on an axis.
pub const MOST_VALUES: usize = 10_000;

/// One axis of a map: a field of the scene file and its values.
#[derive(Debug, Clone)]
pub struct Axis {
    /// The field of the scene file that varies along the axis.
    pub field: &'static Field,
    /// Whether the values are evenly spaced on a logarithmic scale.
    pub log: bool,
    /// The values in the form of the scene file.
    pub values: Vec<Value>,
    /// The axis as the user typed it, for messages.
    pub asked: String,
}

impl Axis {
    /// Reads an axis in the form `FIELD=a..b:n`, `FIELD=a..b:n:log` or `FIELD=v,v,…`. `option` is the name of the command-line
    /// option, for messages.
    ///
    /// # Errors
    /// [`Error::Option`]: the field does not exist, the text has another form, or the field cannot have one of the values.
    pub fn parse(option: &str, text: &str, scene: &Scene) -> Result<Self> {
        let asked = format!("{option} {text}");
        let wrong = |problem: String, fix: String| Error::Option {
            option: asked.clone(),
            problem,
            fix,
        };
        let form = || {
            "write FIELD=FROM..TO:COUNT, FIELD=FROM..TO:COUNT:log or FIELD=VALUE,VALUE,…".to_owned()
        };
        let (key, rest) = text
            .split_once('=')
            .ok_or_else(|| wrong("no values".to_owned(), form()))?;
        let (key, rest) = (key.trim(), rest.trim());
        let Some(field) =
            path_of(key).and_then(|path| FIELDS.iter().find(|field| field.path == path))
        else {
            // An unknown key gives the scene's own error message.
            scene.with_option(key, "0", &asked)?;
            return Err(wrong(
                format!("{key} is a table"),
                "give a field of it".to_owned(),
            ));
        };
        let mut axis = Self {
            field,
            log: false,
            values: Vec::new(),
            asked: asked.clone(),
        };
        match (rest.split_once(".."), field.kind) {
            (Some((from, rest)), Kind::Number(_) | Kind::Whole(..)) => {
                let mut parts = rest.split(':');
                let number = |text: Option<&str>| {
                    text.and_then(|text| text.trim().parse::<f64>().ok())
                        .filter(|number| number.is_finite())
                        .ok_or_else(|| wrong("not two numbers and a count".to_owned(), form()))
                };
                let (from, to) = (number(Some(from))?, number(parts.next())?);
                let count = parts
                    .next()
                    .and_then(|count| count.trim().parse::<usize>().ok())
                    .ok_or_else(|| wrong("no count of values".to_owned(), form()))?;
                axis.log = match (parts.next(), parts.next()) {
                    (None, _) => false,
                    (Some("log"), None) => true,
                    _ => return Err(wrong("only `log` may follow the count".to_owned(), form())),
                };
                if !(2..=MOST_VALUES).contains(&count) || from == to {
                    return Err(wrong(
                        "two different ends and a count from 2 on make an axis".to_owned(),
                        format!("give a count of 2 to {MOST_VALUES}"),
                    ));
                }
                if axis.log && !(from > 0.0 && to > 0.0) {
                    return Err(wrong(
                        "a logarithmic scale has no 0".to_owned(),
                        "give ends above 0, or leave out :log".to_owned(),
                    ));
                }
                axis.values = (0..count)
                    .map(|index| axis.leaf(between(from, to, index, count, axis.log)))
                    .collect();
            }
            (Some(_), _) => {
                return Err(wrong(
                    "this field has no range of numbers".to_owned(),
                    "write FIELD=VALUE,VALUE,…".to_owned(),
                ));
            }
            (None, kind) => {
                for word in rest.split(',').map(str::trim) {
                    axis.values.push(match (kind, word.parse::<f64>()) {
                        (Kind::Number(_) | Kind::Whole(..), Ok(number)) => axis.leaf(number),
                        (Kind::Flag, _) if word == "true" || word == "false" => {
                            Value::Bool(word == "true")
                        }
                        _ => Value::from(word),
                    });
                }
            }
        }
        axis.refuse_wrong(&wrong)?;
        let falls = |pair: &[f64]| pair[1] <= pair[0];
        if axis
            .numbers()
            .is_some_and(|numbers| numbers.windows(2).any(falls))
        {
            return Err(wrong(
                "the numbers do not rise".to_owned(),
                "give them in order, the least first".to_owned(),
            ));
        }
        Ok(axis)
    }

    /// Converts a number to the type of the axis' field: integer or decimal.
    #[must_use]
    pub fn leaf(&self, number: f64) -> Value {
        match self.field.kind {
            Kind::Whole(..) => Value::from(number.round() as i64),
            _ => Value::from(number),
        }
    }

    fn refuse_wrong(&self, wrong: &dyn Fn(String, String) -> Error) -> Result<()> {
        for (index, value) in self.values.iter().enumerate() {
            let known = match (self.field.kind, value) {
                (Kind::Number(range), Value::Number(number)) => {
                    range.holds(number.as_f64().unwrap_or(f64::NAN))
                }
                (Kind::Whole(least, most), Value::Number(number)) => number
                    .as_i64()
                    .is_some_and(|whole| (least..=most).contains(&whole)),
                (Kind::Choice(words), Value::String(word)) => words.contains(&word.as_str()),
                (Kind::Flag, Value::Bool(_)) => true,
                _ => false,
            };
            if !known {
                let must = match self.field.kind {
                    Kind::Number(range) => format!("give {} {}", self.field.about, range.words()),
                    Kind::Whole(least, most) => {
                        format!("give whole numbers from {least} to {most}")
                    }
                    Kind::Choice(words) => format!("give some of {}", list(words)),
                    Kind::Flag => "give true,false".to_owned(),
                    Kind::Text => "texts cannot be varied".to_owned(),
                    Kind::Numbers(..) => "lists cannot be varied".to_owned(),
                };
                return Err(wrong(
                    format!("{value} is not a value of {}", self.field.path),
                    must,
                ));
            }
            if self.values[..index].contains(value) {
                return Err(wrong(
                    format!("{value} comes twice"),
                    "give fewer values, or others".to_owned(),
                ));
            }
        }
        Ok(())
    }

    /// The values as numbers; `None` if the axis has words.
    #[must_use]
    pub fn numbers(&self) -> Option<Vec<f64>> {
        self.values.iter().map(Value::as_f64).collect()
    }

    /// First and last value on the axis' scale, which is logarithmic if `log` is set. Words are numbered from 0.
    #[must_use]
    pub fn span(&self) -> (f64, f64) {
        match self.numbers() {
            Some(numbers) => (
                self.scaled(numbers[0]),
                self.scaled(*numbers.last().unwrap_or(&0.0)),
            ),
            None => (0.0, (self.values.len() - 1) as f64),
        }
    }

    /// Converts a number to the axis' scale: its decimal logarithm if `log` is set, else the number itself.
    #[must_use]
    pub fn scaled(&self, number: f64) -> f64 {
        if self.log { number.log10() } else { number }
    }

    /// Converts a position on the axis' scale back to a number.
    #[must_use]
    pub fn unscaled(&self, place: f64) -> f64 {
        if self.log {
            10.0_f64.powf(place)
        } else {
            place
        }
    }

    /// Range on the axis' scale that the cells of a value cover, half-way to the neighbouring values.
    #[must_use]
    pub fn edges(&self, index: usize) -> RangeInclusive<f64> {
        let at = |index: usize| match self.numbers() {
            Some(numbers) => self.scaled(numbers[index]),
            None => index as f64,
        };
        let last = self.values.len() - 1;
        let here = at(index);
        let half = |other: usize| 0.5 * (here + at(other));
        let outer = |inner: f64| 2.0 * here - inner;
        match (index > 0, index < last) {
            (true, true) => half(index - 1)..=half(index + 1),
            (false, true) => outer(half(1))..=half(1),
            (true, false) => half(last - 1)..=outer(half(last - 1)),
            (false, false) => {
                let half = if here == 0.0 { 0.5 } else { 0.05 * here.abs() };
                here - half..=here + half
            }
        }
    }

    /// Text of an axis value for tables.
    #[must_use]
    pub fn text(&self, index: usize) -> String {
        match &self.values[index] {
            Value::String(word) => word.clone(),
            other => other.to_string(),
        }
    }
}

/// Returns value number `index` of `count` values from `from` to `to`, rounded to twelve digits. The rounding makes the simulated
/// value equal to the value in the file, on every machine.
fn between(from: f64, to: f64, index: usize, count: usize, log: bool) -> f64 {
    if index == 0 {
        return from;
    }
    if index == count - 1 {
        return to;
    }
    let share = index as f64 / (count - 1) as f64;
    let value = if log {
        from * (to / from).powf(share)
    } else {
        from + (to - from) * share
    };
    format!("{value:.11e}").parse().unwrap_or(value)
}
