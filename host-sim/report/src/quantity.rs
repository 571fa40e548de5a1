//! Formats numbers for readers: significant digits, SI prefixes, round tick marks.

/// A unit with an SI prefix: `shown = si / factor`, where `shown` is the number that readers see.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// Size of the prefixed unit in SI units, for example 0.001 for `mN·m`.
    pub factor: f64,
    /// The unit with its prefix, e.g. `mN·m`.
    pub unit: String,
}

const PREFIXES: [(f64, &str); 7] = [
    (1e-12, "p"),
    (1e-9, "n"),
    (1e-6, "µ"),
    (1e-3, "m"),
    (1.0, ""),
    (1e3, "k"),
    (1e6, "M"),
];

/// Chooses the prefix with which the magnitude of `largest` (in SI units) is shown as a number between 1 and 1000.
///
/// Quotients such as N·m/rad keep their plain unit: 500 mN·m/rad is harder to compare with 2.5 N·m/rad than 0.5 N·m/rad is.
pub fn scale_for(largest: f64, unit: &str) -> Scale {
    let size = largest.abs();
    let plain = unit.contains('/') || !size.is_finite() || size == 0.0;
    let (factor, prefix) = if plain {
        (1.0, "")
    } else {
        // A small tolerance, so that 1e-3 minus one bit is still 1 m and not 1000 µ.
        PREFIXES
            .iter()
            .rev()
            .copied()
            .find(|(factor, _)| size * (1.0 + 1e-9) >= *factor)
            .unwrap_or(PREFIXES[0])
    };
    Scale {
        factor,
        unit: format!("{prefix}{unit}"),
    }
}

/// Formats `value` with `digits` significant digits, without an exponent between 1e-6 and 1e9; `–` if it is not finite.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-6..1e9).contains(&value.abs()) {
        return format!("{value:.*e}", digits.saturating_sub(1));
    }
    let decimals =
        |value: f64| (digits as i32 - 1 - value.abs().log10().floor() as i32).max(0) as usize;
    let once = format!("{value:.*}", decimals(value));
    // Rounding can carry into a new digit (9.996 is 10.0 at three digits, not 10.00).
    match once.parse::<f64>() {
        Ok(rounded) if rounded != 0.0 && decimals(rounded) < decimals(value) => {
            format!("{value:.*}", decimals(rounded))
        }
        _ => once,
    }
}

/// Formats `value` (in SI units) with a prefixed unit, e.g. `1.24 mrad`.
pub fn with_unit(value: f64, unit: &str, digits: usize) -> String {
    let scale = scale_for(value, unit);
    let shown = value / scale.factor;
    // A value below a thousandth of the shown unit (1e-15 with prefixes), mostly the rounding of a sum, is written with an
    // exponent.
    if value != 0.0 && shown.abs() < 1e-3 {
        return format!("{value:.0e} {unit}");
    }
    format!("{} {}", significant(shown, digits), scale.unit)
}

/// Formats a setting in its shortest decimal form: `2.5`, `20`, `0.5`.
pub fn plain(value: f64) -> String {
    format!("{value}")
}

/// Formats a number with its digits in groups of three: `40,000`. Digits of the fraction are not grouped.
pub fn grouped(value: f64) -> String {
    let text = plain(value);
    let (whole, rest) = text.split_at(text.find('.').unwrap_or(text.len()));
    let (sign, whole) = whole
        .strip_prefix('-')
        .map_or(("", whole), |whole| ("-", whole));
    let mut out = String::from(sign);
    for (index, digit) in whole.chars().enumerate() {
        if index > 0 && (whole.len() - index).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out + rest
}

/// Tick marks of an axis with their labels, at multiples of 1, 2 or 5 times a power of ten inside `min..=max`. Their number is
/// about `wanted`, at most `wanted / 0.7 + 1`.
pub fn ticks(min: f64, max: f64, wanted: usize) -> Vec<(f64, String)> {
    let span = max - min;
    if !(span > 0.0 && span.is_finite()) {
        return Vec::new();
    }
    let raw = span / wanted.max(1) as f64;
    let power = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * power)
        .find(|s| *s >= raw * 0.7)
        .unwrap_or(power);
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let slack = step * 1e-6;
    let first = ((min - slack) / step).ceil() as i64;
    let last = ((max + slack) / step).floor() as i64;
    (first..=last)
        .map(|index| {
            let value = index as f64 * step;
            (
                value,
                format!("{value:.decimals$}").replace('-', "\u{2212}"),
            )
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prefixes_keep_numbers_between_one_and_a_thousand() {
        assert_eq!(with_unit(0.00124, "rad", 3), "1.24 mrad");
        assert_eq!(with_unit(-0.154e-3, "J", 3), "-154 µJ");
        assert_eq!(with_unit(0.001, "J", 3), "1.00 mJ");
        assert_eq!(with_unit(2.4996, "N·m/rad", 3), "2.50 N·m/rad");
        assert_eq!(with_unit(0.5, "N·m/rad", 3), "0.500 N·m/rad");
        assert_eq!(with_unit(0.0, "J", 3), "0 J");
        assert_eq!(with_unit(-3e-19, "J", 3), "-3e-19 J");
        assert_eq!(scale_for(0.55, "rad").unit, "mrad");
    }

    #[test]
    fn significant_digits_survive_a_carry() {
        assert_eq!(significant(9.996, 3), "10.0");
        assert_eq!(significant(0.09996, 3), "0.100");
        assert_eq!(significant(1234.5, 3), "1234");
        assert_eq!(significant(f64::NAN, 3), "–");
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let labels = |min, max, n| {
            ticks(min, max, n)
                .into_iter()
                .map(|t| t.1)
                .collect::<Vec<_>>()
        };
        assert_eq!(labels(0.0, 5.2, 5), ["0", "1", "2", "3", "4", "5"]);
        assert_eq!(
            labels(-0.1, 0.31, 4),
            ["\u{2212}0.1", "0.0", "0.1", "0.2", "0.3"].map(str::to_owned)
        );
        assert_eq!(labels(487.0, 562.0, 4), ["500", "520", "540", "560"]);
        assert!(ticks(1.0, 1.0, 4).is_empty());
        assert!(ticks(0.0, f64::INFINITY, 4).is_empty());
    }

    #[test]
    fn groups_of_three() {
        assert_eq!(grouped(40_000.0), "40,000");
        assert_eq!(grouped(16_384.0), "16,384");
        assert_eq!(grouped(100.0), "100");
        assert_eq!(grouped(-1_234_567.5), "-1,234,567.5");
    }
}
