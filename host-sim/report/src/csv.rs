//! Writes a trace as CSV: one header line, then one line per tick (control period), with the columns of [`COLUMNS`].

use std::io::{self, Write};

use super::columns::{self, COLUMNS};
use std::fmt::Display;
use touchstone_sim::run::record::Trace;

/// Writes every `every`th tick of `trace`, beginning with the first. Every number has enough digits to read back the same `f64`; a
/// missing value is `NaN`.
///
/// # Errors
/// The operating system's error if writing failed.
pub fn write(out: impl Write, trace: &Trace, every: usize) -> io::Result<()> {
    let mut csv = ::csv::Writer::from_writer(out);
    csv.write_record(COLUMNS.iter().map(|column| column.name))?;
    let values: Vec<&[f64]> = COLUMNS
        .iter()
        .map(|column| (column.values)(trace))
        .collect();
    for row in (0..columns::len(trace)).step_by(every.max(1)) {
        for column in &values {
            csv.write_field(Decimal::new(column[row]).as_str())?;
        }
        csv.write_record(None::<&[u8]>)?;
    }
    csv.flush()
}

/// Writes a number with a decimal point, as in every table of the program. Without the point, a program that reads thousands of
/// rows of `0` may parse the column as integers, and round or refuse later values.
pub fn decimal(number: impl Display) -> String {
    let mut text = number.to_string();
    let digits = text.strip_prefix('-').unwrap_or(&text);
    if digits.bytes().all(|digit| digit.is_ascii_digit()) {
        text.push_str(".0");
    }
    text
}

/// A number in its shortest decimal form that reads back the same `f64`, with an exponent if plain digits would be long.
struct Decimal {
    text: [u8; 32],
    len: usize,
}

impl Decimal {
    fn new(value: f64) -> Self {
        let mut decimal = Decimal {
            text: [0; 32],
            len: 0,
        };
        let mut rest = &mut decimal.text[..];
        // `{:?}` writes an exponent below 1e-5 and from 1e16, at most 24 characters, and `NaN` for NaN.
        write!(rest, "{value:?}").expect("an f64 in 32 characters");
        decimal.len = 32 - rest.len();
        decimal
    }

    fn as_str(&self) -> &str {
        std::str::from_utf8(&self.text[..self.len]).expect("digits are ASCII")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use touchstone_control::LawKind;

    #[test]
    fn a_decimal_has_a_point_and_is_the_same_number() {
        for (number, text) in [
            (0.0, "0.0"),
            (-0.0, "-0.0"),
            (5.0, "5.0"),
            (-17.0, "-17.0"),
            (4.9457, "4.9457"),
            (1e15, "1000000000000000.0"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(decimal(number), text);
        }
        for number in [f64::MAX, f64::MIN_POSITIVE, 5e-324, 0.1 + 0.2, 1e22] {
            let text = decimal(number);
            assert!(text.contains('.'), "{text}");
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), number.to_bits());
        }
    }

    #[test]
    fn every_third_tick_is_every_third_line() {
        let trace = synthetic::run(LawKind::Tdpa, 5.0, 0.1).trace.unwrap();
        let text = |every| {
            let mut file = Vec::new();
            write(&mut file, &trace, every).unwrap();
            String::from_utf8(file).unwrap()
        };
        let (all, some) = (text(1), text(3));
        let expected: Vec<&str> = all.lines().skip(1).step_by(3).collect();
        assert_eq!(expected.len(), 34);
        assert_eq!(some.lines().skip(1).collect::<Vec<_>>(), expected);
    }

    #[test]
    fn reads_back_to_the_bit() {
        let mut trace = synthetic::run(LawKind::Spring, 5.0, 0.2).trace.unwrap();
        trace.force_n_m[3] = -f64::MIN_POSITIVE / 3.0;
        trace.force_n_m[4] = -f64::MAX;
        let mut file = Vec::new();
        write(&mut file, &trace, 1).unwrap();
        let mut csv = ::csv::Reader::from_reader(&file[..]);
        assert_eq!(
            csv.headers().unwrap(),
            COLUMNS.iter().map(|c| c.name).collect::<Vec<_>>()
        );
        let mut read = vec![Vec::new(); COLUMNS.len()];
        for record in csv.records() {
            for (column, field) in read.iter_mut().zip(&record.unwrap()) {
                column.push(field.parse::<f64>().unwrap());
            }
        }
        assert_eq!(read[0].len(), 200);
        for (column, read) in COLUMNS.iter().zip(&read) {
            for (a, b) in (column.values)(&trace).iter().zip(read) {
                assert!(
                    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()),
                    "{}: {a} {b}",
                    column.name
                );
            }
        }
        assert!(
            trace.energy_observed_j[0].is_nan(),
            "the spring has no observer, so NaN was tried too"
        );
    }
}
