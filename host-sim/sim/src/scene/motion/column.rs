//! Finds the columns of a recording in a CSV header: the time column, the angle column, and the unit of each.

use crate::scene::units::{self, Dimension, UNITS};

/// Names of angle columns in files that Touchstone wrote, the preferred first. A trace of a simulation contains the hand's rest
/// point; a recording from a device contains only the device's angle.
const OWN_ANGLES: [&str; 5] = [
    "rest_rad",
    "hand_rad",
    "angle_rad",
    "angle_measured_rad",
    "penetration_rad",
];
/// Columns that only files of this program have: a simulation's trace, or a recording by `touchstone monitor`.
const OWN_MARKS: [&str; 2] = ["time_s", "force_n_m"];

/// The column of a CSV file from which times or angles are read, with the factor that converts its unit to SI.
pub(in crate::scene) struct Column {
    pub index: usize,
    pub name: String,
    pub si: f64,
}

/// Finds the angle column in a file that Touchstone wrote; `None` for other files.
pub(super) fn own_angle(header: &csv::StringRecord) -> Option<Column> {
    let place = |wanted: &str| header.iter().position(|name| name == wanted);
    OWN_MARKS
        .into_iter()
        .try_for_each(|mark| place(mark).map(drop))?;
    OWN_ANGLES.into_iter().find_map(|name| {
        Some(Column {
            index: place(name)?,
            name: name.to_owned(),
            si: 1.0,
        })
    })
}

/// Words that the name of a time column may begin with, in several languages.
const TIMES: [&str; 7] = [
    "time",
    "t",
    "timestamp",
    "zeit",
    "temps",
    "elapsed",
    "clock",
];

/// Units spelled as words in a CSV header, each with its short form as suffix.
const WORDS: [(&str, &str); 18] = [
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("msec", "ms"),
    ("millis", "ms"),
    ("milliseconds", "ms"),
    ("usec", "us"),
    ("micros", "us"),
    ("microseconds", "us"),
    ("nsec", "ns"),
    ("nanos", "ns"),
    ("nanoseconds", "ns"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("radians", "rad"),
    ("turns", "rev"),
    ("revolutions", "rev"),
];

/// Normalises a column's name: lower case, with `_` between the words. `Angle [deg]` and `angle (deg)` become `angle_deg`, and
/// `°/s` becomes `deg_per_s`.
fn plain(name: &str) -> String {
    let name = name
        .to_lowercase()
        .replace('°', "_deg")
        .replace(['µ', 'μ'], "u")
        .replace('/', "_per_")
        .replace(|c: char| !c.is_alphanumeric(), "_");
    let words: Vec<&str> = name.split('_').filter(|word| !word.is_empty()).collect();
    words.join("_")
}

/// The unit at the end of a column's name; `None` if the name ends in no known unit.
fn unit_of(name: &str) -> Option<&'static units::Unit> {
    let plain = plain(name);
    let (stem, last) = plain.rsplit_once('_').unwrap_or(("", &plain));
    match WORDS.iter().find(|(word, _)| *word == last) {
        Some((_, suffix)) if stem != "per" && !stem.ends_with("_per") => units::by_suffix(suffix),
        Some(_) => None,
        None => units::at_end_of(&plain),
    }
}

/// Finds the only column whose name ends in a unit of the quantity `dimension`. Error: problem and remedy, if no column or several
/// fit.
pub(in crate::scene) fn find(
    header: &csv::StringRecord,
    dimension: Dimension,
    what: &str,
) -> std::result::Result<Column, (String, String)> {
    let accepted: Vec<String> = UNITS
        .iter()
        .filter(|unit| unit.dimension == dimension)
        .map(|unit| format!("_{}", unit.suffix))
        .collect();
    let accepted = accepted.join(", ");
    let mut found: Vec<Column> = header
        .iter()
        .enumerate()
        .filter_map(|(index, name)| {
            let unit = unit_of(name).filter(|unit| unit.dimension == dimension)?;
            Some(Column {
                index,
                name: name.to_owned(),
                si: unit.si,
            })
        })
        .collect();
    // `axis_s` ends like a time. If exactly one column's name also begins with a word for time, that column is used.
    if dimension == Dimension::Time && found.len() > 1 {
        let is_named = |column: &Column| {
            TIMES.contains(&plain(&column.name).split('_').next().unwrap_or_default())
        };
        if found.iter().filter(|column| is_named(column)).count() == 1 {
            found.retain(is_named);
        }
    }
    let mut found = found.into_iter();
    let names: Vec<String> = header.iter().take(20).map(cut).collect();
    let names = names.join(", ");
    match (found.next(), found.next()) {
        (Some(column), None) => Ok(column),
        (Some(one), Some(other)) => Err((
            format!("both {} and {} fit", cut(&one.name), cut(&other.name)),
            "keep one of the two columns".to_owned(),
        )),
        (None, _) => {
            let article = if what.starts_with('a') { "an" } else { "a" };
            let problem = format!("no column with {article} {what} unit among {names}");
            Err((
                problem,
                format!("end the column's name in one of {accepted}"),
            ))
        }
    }
}

/// Returns the CSV text without its byte-order mark, and a reader of its rows, including the header. Lines that begin with `#`
/// are comments; a row may have any number of cells.
pub(in crate::scene) fn rows(text: &str) -> (&str, csv::Reader<&[u8]>) {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    (text, reader)
}

/// Cuts a cell for a message, because an unclosed quote makes the whole rest of the file one cell.
pub(in crate::scene) fn cut(cell: &str) -> String {
    let line = cell.split(['\n', '\r']).next();
    line.unwrap_or_default().chars().take(40).collect()
}

/// Reads the finite number in one cell of the CSV file.
pub(in crate::scene) fn cell(
    row: &csv::StringRecord,
    column: &Column,
) -> std::result::Result<f64, (String, &'static str)> {
    // The callers have checked that the row is at least as long as the header.
    let text = row.get(column.index).unwrap_or_default();
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err((
            format!("{} is not a finite number", cut(text)),
            "remove the row or fill the gap",
        )),
        Err(_) if text.is_empty() => Err(("is empty".to_owned(), "complete or remove the row")),
        Err(_) => Err((
            format!("\"{}\" is not a number", cut(text)),
            "write numbers such as 0.25 or 2.5e-1",
        )),
    }
}
