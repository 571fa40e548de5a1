//! Sorts runs into tables, one for each set of conditions. Rows are requested stiffnesses, columns are control laws.

use super::label::{self, Condition};
use touchstone_control::LawKind;
use touchstone_sim::run::record::{Run, Summary};

/// A column of a table: a control law, or a set of its settings that the report has named.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Column {
    /// Name of the column in place of the law's name. The field comes first, so that columns with a name of their own are sorted
    /// last.
    shown_as: Option<&'static str>,
    /// The control law of the column.
    pub law: LawKind,
}

impl Column {
    /// The column to which a run belongs.
    pub fn of(run: &Summary) -> Self {
        Self {
            shown_as: run.shown_as,
            law: run.law,
        }
    }

    /// Whether the report gives the column a name of its own, instead of the law's name.
    pub fn is_named(self) -> bool {
        self.shown_as.is_some()
    }

    /// Heading of the column.
    pub fn name(self) -> &'static str {
        self.shown_as.unwrap_or(label::law(self.law))
    }
}

/// Runs under the same conditions, as a table of requested stiffness `k_de` × control law.
pub struct Matrix {
    /// The conditions that the runs share.
    pub condition: Condition,
    /// The conditions that differ between the report's tables, in words; empty if there is only one table.
    pub distinction: String,
    /// Requested stiffness of each row, N·m/rad, ascending.
    pub stiffnesses: Vec<f64>,
    /// Control law (or named set of its settings) of each column.
    pub laws: Vec<Column>,
    /// Indices of the runs in `cells[row][column]`; several if the same conditions were run more than once.
    pub cells: Vec<Vec<Vec<usize>>>,
}

impl Matrix {
    /// Indices of all runs in a row, from left to right.
    pub fn row(&self, row: usize) -> impl Iterator<Item = usize> + '_ {
        self.cells[row].iter().flatten().copied()
    }
}

/// Sorts the runs of a report into tables, in the order in which their conditions first appear.
pub fn matrices(runs: &[Run]) -> Vec<Matrix> {
    let conditions: Vec<Condition> = runs.iter().map(|run| Condition::of(&run.summary)).collect();
    let mut distinct: Vec<&Condition> = Vec::new();
    for condition in &conditions {
        if !distinct.contains(&condition) {
            distinct.push(condition);
        }
    }
    let varies: Vec<bool> = (0..5)
        .map(|part| {
            distinct
                .iter()
                .any(|c| c.parts[part] != distinct[0].parts[part])
        })
        .collect();
    distinct
        .iter()
        .map(|&condition| {
            let members: Vec<usize> = (0..runs.len())
                .filter(|&index| conditions[index] == *condition)
                .collect();
            let mut stiffnesses: Vec<f64> = members
                .iter()
                .map(|&index| runs[index].summary.k_desired)
                .collect();
            stiffnesses.sort_by(f64::total_cmp);
            stiffnesses.dedup();
            let mut laws: Vec<Column> = members
                .iter()
                .map(|&index| Column::of(&runs[index].summary))
                .collect();
            // The simplest law comes first, as in the enum `LawKind`.
            laws.sort_unstable();
            laws.dedup();
            let at = |k: f64, law: Column| {
                let here = |&&i: &&usize| {
                    Column::of(&runs[i].summary) == law
                        && runs[i].summary.k_desired.total_cmp(&k).is_eq()
                };
                members.iter().filter(here).copied().collect()
            };
            let cells = stiffnesses
                .iter()
                .map(|&k| laws.iter().map(|&law| at(k, law)).collect())
                .collect();
            let parts = condition
                .parts
                .iter()
                .zip(&varies)
                .filter(|(_, varies)| **varies);
            Matrix {
                condition: condition.clone(),
                distinction: parts
                    .map(|(part, _)| part.as_str())
                    .collect::<Vec<_>>()
                    .join(" · "),
                stiffnesses,
                laws,
                cells,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;

    #[test]
    fn one_table_for_each_condition() {
        let mut runs = Vec::new();
        for grip in ["medium", "light"] {
            for (law, k) in [
                (LawKind::Tdpa, 5.0),
                (LawKind::Spring, 0.5),
                (LawKind::Spring, 5.0),
            ] {
                let mut run = synthetic::run(law, k, 0.01);
                run.summary.grip = grip.to_owned();
                runs.push(run);
            }
        }
        let tables = matrices(&runs);
        assert_eq!(tables.len(), 2);
        assert_eq!(tables[1].distinction, "light grip");
        assert_eq!(tables[0].stiffnesses, [0.5, 5.0]);
        let names: Vec<&str> = tables[0].laws.iter().map(|law| law.name()).collect();
        assert_eq!(names, ["Spring", "TDPA"]);
        assert_eq!(
            tables[0].cells,
            [vec![vec![1], vec![]], vec![vec![2], vec![0]]]
        );
        assert_eq!(tables[1].row(1).collect::<Vec<_>>(), [5, 3]);
        assert!(matrices(&[]).is_empty());
    }
    #[test]
    fn what_a_report_names_has_a_column_of_its_own_at_the_end() {
        let mut named = synthetic::run(LawKind::Spring, 5.0, 0.01);
        named.summary.shown_as = Some("Shipped");
        let runs = [
            named,
            synthetic::run(LawKind::Spring, 5.0, 0.01),
            synthetic::run(LawKind::Tdpa, 5.0, 0.01),
        ];
        let [table] = matrices(&runs).try_into().ok().expect("one table");
        let names: Vec<&str> = table.laws.iter().map(|law| law.name()).collect();
        assert_eq!(names, ["Spring", "TDPA", "Shipped"]);
        assert_eq!(table.cells, [vec![vec![1], vec![2], vec![0]]]);
    }
}
