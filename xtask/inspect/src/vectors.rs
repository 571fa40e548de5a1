//! Compares the digests (hashes of results) that this machine and the emulated microcontroller print for the test vectors, and
//! collects instruction counts.

use std::collections::BTreeMap;
use std::fmt::Write;

/// Instructions counted over many calls of a function: number of calls, sum and worst.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Cost {
    calls: u64,
    sum: u64,
    worst: u64,
}

impl Cost {
    /// Parses the text `calls sum worst`, split into words.
    fn parse(words: &[&str]) -> Option<Self> {
        let [calls, sum, worst] = words else {
            return None;
        };
        Some(Self {
            calls: calls.parse().ok()?,
            sum: sum.parse().ok()?,
            worst: worst.parse().ok()?,
        })
    }

    fn and(self, other: Self) -> Self {
        Self {
            calls: self.calls + other.calls,
            sum: self.sum + other.sum,
            worst: self.worst.max(other.worst),
        }
    }

    fn mean(self) -> f64 {
        self.sum as f64 / self.calls.max(1) as f64
    }
}

/// Result of one control law in one number format: a row of the table.
#[derive(Debug, Default)]
struct Row {
    name: String,
    format: String,
    cost: Cost,
    /// Name of the segment (part of the test vector) with the most expensive control period.
    worst_in: String,
    /// Name of the first segment (part of the test vector) whose digests differ; `None` if all are equal.
    differs_in: Option<String>,
    segments: usize,
}

/// Results of all laws, read from the output of this machine (desktop) and of the microcontroller.
#[derive(Debug, Default)]
pub struct Report {
    /// Digests printed by the desktop. The key is `law format segment`. An entry is removed when the microcontroller prints the
    /// same key.
    desktop: BTreeMap<String, String>,
    rows: Vec<Row>,
    penetration: Vec<(String, Cost)>,
    odd: Vec<String>,
    ended: bool,
}

impl Report {
    /// Reads a line that the desktop printed.
    pub fn desktop(&mut self, line: &str) {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["golden", law, format, segment, digest] => {
                let key = format!("{law} {format} {segment}");
                self.desktop.insert(key, digest.into());
            }
            _ => self.odd.push(format!("this machine: {line}")),
        }
    }

    /// Reads a line that the microcontroller printed. Call it after all lines of the desktop were read.
    pub fn microcontroller(&mut self, line: &str) {
        let words: Vec<&str> = line.split_whitespace().collect();
        match (&words[..], words.get(5..).and_then(Cost::parse)) {
            (["golden", law, format, segment, digest, ..], Some(cost)) => {
                let here = self.desktop.remove(&format!("{law} {format} {segment}"));
                let same = here.as_deref() == Some(*digest);
                self.add([law, format, segment], same, cost);
            }
            (["penetration", format, cost @ ..], _) => match Cost::parse(cost) {
                Some(cost) => self.penetration.push(((*format).into(), cost)),
                None => self.odd.push(format!("the microcontroller: {line}")),
            },
            (["end"], _) => self.ended = true,
            _ => self.odd.push(format!("the microcontroller: {line}")),
        }
    }

    fn add(&mut self, [law, format, segment]: [&str; 3], same: bool, cost: Cost) {
        let is_it = |row: &Row| row.name == law && row.format == format;
        let at = self.rows.iter().position(is_it).unwrap_or_else(|| {
            self.rows.push(Row {
                name: law.into(),
                format: format.into(),
                ..Row::default()
            });
            self.rows.len() - 1
        });
        let row = &mut self.rows[at];
        if cost.worst > row.cost.worst {
            row.worst_in = segment.into();
        }
        row.cost = row.cost.and(cost);
        row.segments += 1;
        if !same && row.differs_in.is_none() {
            row.differs_in = Some(segment.into());
        }
    }

    /// Number of segments of test vectors with equal digests, over all laws and formats without a difference.
    pub fn equal(&self) -> usize {
        let equal = self.rows.iter().filter(|row| row.differs_in.is_none());
        equal.map(|row| row.segments).sum()
    }

    /// Instructions of the most expensive control period among the laws whose names begin with `start`, in any number format.
    pub fn worst_of(&self, start: &str) -> u64 {
        let rows = self.rows.iter().filter(|row| row.name.starts_with(start));
        rows.map(|row| row.cost.worst).max().unwrap_or(0)
    }

    /// Descriptions of all problems: different or missing digests, unknown lines, an output that ends too early.
    pub fn differences(&self) -> Vec<String> {
        let mut wrong: Vec<String> = self.odd.clone();
        for row in &self.rows {
            if let Some(segment) = &row.differs_in {
                wrong.push(format!(
                    "{} {}: differs from `{segment}` on",
                    row.name, row.format
                ));
            }
        }
        let missing = self.desktop.keys();
        wrong.extend(missing.map(|key| format!("{key}: not from the microcontroller")));
        if !self.ended || self.rows.is_empty() {
            wrong.push("the microcontroller did not come to its end".into());
        }
        wrong
    }

    /// Table with a row for each law in each format: whether the digests are equal, and instructions per control period (mean and
    /// worst).
    pub fn table(&self) -> String {
        let mut text = format!(
            "{:<22}{:<9}{:<22}{:>8}{:>8}  {}\n",
            "law", "format", "bits", "mean", "worst", "worst in"
        );
        for row in &self.rows {
            let bits = match &row.differs_in {
                None => "equal".to_owned(),
                Some(segment) => format!("DIFFER in {segment}"),
            };
            let (mean, worst) = (row.cost.mean(), row.cost.worst);
            let _ = writeln!(
                text,
                "{:<22}{:<9}{bits:<22}{mean:>8.1}{worst:>8}  {}",
                row.name, row.format, row.worst_in
            );
        }
        for (format, cost) in &self.penetration {
            let (mean, worst) = (cost.mean(), cost.worst);
            let _ = writeln!(
                text,
                "{:<22}{format:<31}{mean:>8.1}{worst:>8}",
                "count to penetration"
            );
        }
        text + "Instructions with the call and its arguments (one or two too many at most), of the ticks played; not cycles.\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(microcontroller: &[&str]) -> Report {
        let mut report = Report::default();
        report.desktop("golden fba fixed32 presses 00aa");
        report.desktop("golden fba fixed32 jumps 00bb");
        for line in microcontroller {
            report.microcontroller(line);
        }
        report
    }

    #[test]
    fn equal_digests_pass_and_their_costs_add_up() {
        let report = report(&[
            "golden fba fixed32 presses 00aa 10 1000 120",
            "golden fba fixed32 jumps 00bb 10 2000 300",
            "penetration fixed32 20 400 25",
            "end",
        ]);
        assert_eq!(report.differences(), Vec::<String>::new());
        assert_eq!((report.equal(), report.worst_of("fb")), (2, 300));
        assert!(
            report
                .table()
                .contains("equal                    150.0     300  jumps")
        );
    }

    #[test]
    fn a_wrong_a_missing_and_an_unknown_line_fail() {
        let wrong = report(&[
            "golden fba fixed32 presses 00aa 10 1000 120",
            "golden fba fixed32 jumps 00bc 10 2000 300",
            "end",
        ]);
        assert_eq!(
            wrong.differences(),
            ["fba fixed32: differs from `jumps` on"]
        );
        assert_eq!(wrong.equal(), 0);
        let missing = report(&["golden fba fixed32 presses 00aa 10 1000 120"]);
        assert_eq!(missing.differences().len(), 2);
        let unknown = report(&["panicked at law.rs", "end"]);
        assert!(unknown.differences()[0].contains("panicked"));
    }
}
