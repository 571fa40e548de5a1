//! Parsers of numeric options. Each checks a range, which the help text and the error message state alike.

use std::fmt::Display;
use std::str::FromStr;

/// A measured quantity whose magnitude is below this value, in its SI unit, is only rounding error.
const ROUNDING: f64 = 1e-12;

/// Formats a measured quantity for people, with an exponent and this many digits after the decimal point. A value that is only
/// rounding error is shown as 0.
pub fn measured(value: f64, digits: usize) -> String {
    if value.abs() < ROUNDING {
        return "0".into();
    }
    format!("{value:.digits$e}")
}

/// Parser of a number from `least` to `most`, for clap's `value_parser`.
pub fn within<T>(
    least: T,
    most: T,
    unit: &'static str,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static
where
    T: FromStr + PartialOrd + Display + Copy + Send + Sync + 'static,
{
    parser(
        unit,
        format!("between {least} and {most}"),
        move |value: T| value >= least && value <= most,
    )
}

/// Parser of a finite number of 0 or more, for clap's `value_parser`.
pub fn not_negative(
    unit: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    parser(unit, "0 or more".to_owned(), |value: f64| {
        value >= 0.0 && value.is_finite()
    })
}

/// Parser of a number above 0 and at most the given limit, for clap's `value_parser`.
pub fn up_to(
    most: f64,
    unit: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    parser(
        unit,
        format!("above 0 and at most {most}"),
        move |value: f64| value > 0.0 && value <= most,
    )
}

fn parser<T: FromStr + Copy>(
    unit: &'static str,
    range: String,
    holds: impl Fn(T) -> bool + Clone + Send + Sync + 'static,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static {
    move |text| match text.parse::<T>() {
        Ok(value) if holds(value) => Ok(value),
        _ => Err(format!("must be {range}, is {text}; give a number {unit}")),
    }
}
