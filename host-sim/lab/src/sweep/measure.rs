//! The results that a sweep stores for each cell: the verdict, and the chosen measures of the run.

use touchstone_report::measures::MEASURES;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::run::record::{Run, Summary};
use touchstone_sim::run::verdict::WORDS;
use touchstone_sim::scene::nearest;

/// Name under which the verdict is chosen among the measures.
pub const VERDICT: &str = "verdict";
/// Word in place of a verdict if values of the scene contradict each other, or if the law refuses the scene.
pub const REFUSED: &str = "refused";

/// A measure: a number from the summary of a run.
#[derive(Debug, Clone, Copy)]
pub struct Measure {
    /// Name of the measure, which is a field of `results.json`.
    pub name: &'static str,
    /// Name of the measure for readers.
    pub words: &'static str,
    /// SI unit; `1` for a number without unit.
    pub unit: &'static str,
    /// Meaning of the measure, in words.
    pub meaning: &'static str,
    /// The measure's value in SI units; `None` if the measure does not apply.
    pub of: fn(&Summary) -> Option<f64>,
}

impl Measure {
    /// Heading of the measure's column: its name, followed by the unit if the name does not contain it.
    #[must_use]
    pub fn column(&self) -> String {
        let unit = match self.unit {
            "N·m/rad" => "_n_m_per_rad",
            "N·m" => "_n_m",
            "rad/s" => "_rad_per_s",
            "rad" => "_rad",
            "J" => "_j",
            "s" => "_s",
            _ => "",
        };
        match self.name.ends_with(unit) {
            true => self.name.to_owned(),
            false => format!("{}{unit}", self.name),
        }
    }
}

/// All measures that a sweep can store.
#[must_use]
pub fn measures() -> Vec<Measure> {
    let mut all: Vec<Measure> = MEASURES
        .iter()
        .map(|measure| Measure {
            name: measure.field,
            words: measure.words,
            unit: measure.unit,
            meaning: measure.meaning,
            of: measure.value,
        })
        .collect();
    all.push(Measure {
        name: "dynamic_stiffness_modulus",
        words: "dynamic stiffness",
        unit: "N·m/rad",
        meaning: "amplitude of the force over that of the penetration of a hand that moves in a rhythm inside the wall",
        of: |s| s.dynamic_stiffness.first().map(|it| it.modulus_n_m_per_rad),
    });
    all.push(Measure {
        name: "dynamic_stiffness_phase_deg",
        words: "phase of the dynamic stiffness",
        unit: "°",
        meaning: "lead of the force over the penetration of that hand; a force that lags is negative damping",
        of: |s| s.dynamic_stiffness.first().map(|it| it.phase_deg),
    });
    all
}

/// Returns the measures with these names, without the verdict and without repetitions.
///
/// # Errors
/// [`Error::Option`]: a name is unknown.
pub fn named(names: &[String]) -> Result<Vec<Measure>> {
    let all = measures();
    let mut found: Vec<Measure> = Vec::new();
    for name in names.iter().filter(|name| *name != VERDICT) {
        let Some(measure) = all.iter().find(|measure| measure.name == name) else {
            let known: Vec<&str> = all.iter().map(|measure| measure.name).collect();
            return Err(Error::Option {
                option: format!("--measure {name}"),
                problem: "a run has no such measure".to_owned(),
                fix: match nearest(name, &known) {
                    Some(near) => format!("did you mean {near}?"),
                    None => format!("give {VERDICT} or some of {}", known.join(", ")),
                },
            });
        };
        if found.iter().all(|other| other.name != measure.name) {
            found.push(*measure);
        }
    }
    Ok(found)
}

/// Names that may be in the column of the verdict, from good to bad, including [`REFUSED`].
#[must_use]
pub fn verdicts() -> Vec<&'static str> {
    WORDS
        .iter()
        .map(|(word, _)| *word)
        .chain([REFUSED])
        .collect()
}

/// A row of the table of cells: the stored results of one cell.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Row(
    /// Number of the cell in the map.
    pub u64,
    /// Value of the horizontal axis, as text.
    pub String,
    /// Value of the vertical axis, as text.
    pub String,
    /// The verdict on the run, or [`REFUSED`].
    pub String,
    /// The chosen measures. A value that does not apply or is not finite is `NaN` in the table.
    #[serde(default, with = "crate::journal::or_nan::each")]
    pub Vec<Option<f64>>,
);

impl Row {
    /// Makes the row of a cell from its run. Without a run, the cell was refused.
    #[must_use]
    pub fn of(cell: u64, [x, y]: [String; 2], run: Option<&Run>, measures: &[Measure]) -> Self {
        let verdict = run.map_or(REFUSED, |run| run.summary.verdict_name());
        let value = |measure: &Measure| {
            run.and_then(|run| (measure.of)(&run.summary))
                .filter(|value| value.is_finite())
        };
        Self(
            cell,
            x,
            y,
            verdict.to_owned(),
            measures.iter().map(value).collect(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that the heading of every column contains its unit exactly once.
    #[test]
    fn every_column_says_its_unit_once() {
        for measure in measures() {
            let column = measure.column();
            let says = [
                "_n_m_per_rad",
                "_n_m",
                "_rad_per_s",
                "_rad",
                "_j",
                "_s",
                "_deg",
            ];
            let plain = measure.unit == "1";
            assert!(
                plain || says.iter().any(|end| column.ends_with(end)),
                "{column} in {}",
                measure.unit
            );
            assert!(
                !column.contains("_j_j") && !column.contains("_rad_rad"),
                "{column}"
            );
        }
        let named = named(&["k_displayed".to_owned(), "guard_tripped_s".to_owned()]).unwrap();
        assert_eq!(named[0].column(), "k_displayed_n_m_per_rad");
        assert_eq!(named[1].column(), "guard_tripped_s");
    }
}
