//! The table of all runs, for the documentation and as a file.

use super::cell::{Cell, Row};
use super::known::UNFOUND;
use super::list::{FAULTS, Group, Same};
use super::{MOST_J, broken::Memory, tamper::Breaks};
use std::fmt::Write;
use touchstone_protocol::{Board, FaultCode};

/// Energy that a healthy knob gives a hand in a run, rounded up, J.
const HEALTHY_J: f64 = 0.01;

/// The rows of all boards.
pub struct Table<'b> {
    /// The rows.
    pub rows: Vec<Row<'b>>,
    /// The rows without a found fault ([`Table::unfound`]), repeated for 33 s instead of 3 s.
    pub long: Vec<Row<'b>>,
}

fn code(cell: &Cell) -> String {
    cell.code.map_or_else(
        || "-".into(),
        |code| format!("{:02}", FaultCode::to_wire(code)),
    )
}

fn milli(value: f64) -> f64 {
    1e3 * value
}

impl<'b> Table<'b> {
    /// All rows as a CSV file.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut text =
            "board,group,fault,moment,grip,quarter,most_j,off_s,fastest_rad_per_s,code,differs\n"
                .to_owned();
        for row in &self.rows {
            let Row {
                bench, fault, cell, ..
            } = row;
            let off = cell
                .off_s
                .map_or_else(String::new, |off_s| format!("{off_s:.3}"));
            let _ = writeln!(
                text,
                "{},{:?},\"{}\",{},{},{},{:.6},{off},{:.3},{},{}",
                bench.board.name(),
                fault.group,
                fault.name,
                bench.moment.name(),
                bench.grip.name(),
                bench.quarter,
                cell.most_j,
                cell.fastest_rad_per_s,
                code(cell),
                row.differs,
            );
        }
        text
    }

    /// Violations of what the rows must fulfil, one per line; empty if there are none. A healthy board raises no fault and keeps
    /// the guard's bound. A fault with `Same::Nowhere` changes every run. Each fault gives at most [`MOST_J`], also in the longer run,
    /// and is found if the bound is exceeded; a known gap may give more in the longer run and may stay unfound.
    #[must_use]
    pub fn complaints(&self) -> Vec<String> {
        let mut lines = Vec::new();
        for row in &self.rows {
            let (board, cell) = (row.bench.board, &row.cell);
            let mut complain = |what: String| {
                let energy = milli(cell.most_j);
                let (board, name) = (board.name(), row.name());
                lines.push(format!("{board}: {name}: {energy:.1} mJ, {what}"));
            };
            let healthy = row.fault.group == Group::Control
                || row.fault.breaks == Breaks::Memory(Memory::Right);
            if healthy && (cell.off_s.is_some() || cell.most_j > row.bench.promise_j()) {
                let bound = milli(row.bench.promise_j());
                complain(format!(
                    "fault {}, of a healthy board with a bound of {bound:.1} mJ",
                    code(cell)
                ));
            }
            if !row.differs && row.fault.same == Same::Nowhere {
                complain("nothing differs from the healthy board".into());
            }
            if cell.most_j > MOST_J {
                complain(format!("more than {:.0} mJ", milli(MOST_J)));
            }
            if row.is_unfound() && !is_known(row) {
                complain("beyond the guard's bound, and not found".into());
            }
        }
        for row in self.long.iter().filter(|row| !is_known(row)) {
            let energy = milli(row.cell.most_j);
            if row.cell.most_j > MOST_J {
                let (board, name) = (row.bench.board.name(), row.name());
                lines.push(format!("{board}: {name}: {energy:.1} mJ in the longer run"));
            }
        }
        lines
    }

    /// Violations that only all rows together show: a known gap that no run shows, a fault that changes no run, and a fault that
    /// changes a run although all must be equal.
    #[must_use]
    pub fn complaints_of_all(&self) -> Vec<String> {
        let mut lines = Vec::new();
        for (board, names) in UNFOUND {
            for name in *names {
                let mut rows = self.of(*board).filter(|row| row.fault.name == *name);
                if !rows.any(Row::is_unfound) {
                    let board = board.name();
                    lines.push(format!("{board}: {name}: it is found or harmless now"));
                }
            }
        }
        for board in Board::ALL {
            for fault in FAULTS.iter().filter(|fault| fault.not_on(board).is_none()) {
                let mut rows = self.of(board).filter(|row| row.fault == fault);
                let differs = rows.any(|row| row.differs);
                if differs == matches!(fault.same, Same::Everywhere(_)) {
                    let (board, name) = (board.name(), fault.name);
                    lines.push(format!(
                        "{board}: {name}: it differs from the healthy board: {differs}"
                    ));
                }
            }
        }
        lines
    }

    /// Worst and median run of every board, the ten worst faults, and the ten worst of the faults that the board does not find
    /// within 33 s.
    #[must_use]
    pub fn page(&self) -> String {
        let mut text = "\n|board|cells|faults found|energy, mJ: median, worst|time to off, ms: median, worst|fastest, rad/s|\n|---|--:|--:|--:|--:|--:|\n"
            .to_owned();
        for board in Board::ALL {
            let rows: Vec<_> = self.of(board).collect();
            if rows.is_empty() {
                continue;
            }
            let energy = sorted(rows.iter().map(|row| milli(row.cell.most_j)));
            let off = sorted(rows.iter().filter_map(|row| row.cell.off_s).map(milli));
            let fastest = sorted(rows.iter().map(|row| row.cell.fastest_rad_per_s));
            let _ = writeln!(
                text,
                "|`{}`|{}|{}|{:.1}, {:.0}|{:.0}, {:.0}|{:.0}|",
                board.name(),
                rows.len(),
                off.len(),
                middle(&energy),
                worst(&energy),
                middle(&off),
                worst(&off),
                worst(&fastest),
            );
        }
        text.push_str("\n|the worst ten|moment, grip, quarter|energy, mJ|off after, ms|rad/s|fault|\n|---|---|--:|--:|--:|---|\n");
        for row in worst_of(self.rows.iter(), 10) {
            let cell = &row.cell;
            let off = cell
                .off_s
                .map_or_else(|| "never".into(), |off_s| format!("{:.0}", milli(off_s)));
            let (moment, grip, quarter) = row.place();
            let _ = writeln!(
                text,
                "|`{}`: {}|{}, {}, {quarter}|{:.0}|{off}|{:.0}|{}|",
                row.bench.board.name(),
                row.fault.name,
                moment.name(),
                grip.name(),
                milli(cell.most_j),
                cell.fastest_rad_per_s,
                code(cell),
            );
        }
        text.push_str("\n|never found, the worst ten in 33 s|moment, grip, quarter|energy, mJ|rad/s|\n|---|---|--:|--:|\n");
        let never = self.long.iter().filter(|row| row.cell.off_s.is_none());
        for row in worst_of(never, 10) {
            let (moment, grip, quarter) = row.place();
            let _ = writeln!(
                text,
                "|`{}`: {}|{}, {}, {quarter}|{:.0}|{:.0}|",
                row.bench.board.name(),
                row.fault.name,
                moment.name(),
                grip.name(),
                milli(row.cell.most_j),
                row.cell.fastest_rad_per_s,
            );
        }
        text.push('\n');
        text
    }

    /// Rows in which the board found no fault and the hand got more than a healthy knob gives.
    #[must_use]
    pub fn unfound(&self) -> Vec<Row<'b>> {
        let is_more = |row: &&Row<'b>| row.cell.off_s.is_none() && row.cell.most_j > HEALTHY_J;
        self.rows.iter().filter(is_more).copied().collect()
    }

    /// Faults that a board did not find in at least one run, each with the number of such runs and the most energy in them, J.
    #[must_use]
    pub fn not_found(&self, board: Board) -> Vec<(&'static str, usize, f64)> {
        let mut found: Vec<(&'static str, usize, f64)> = Vec::new();
        for row in self.of(board).filter(|row| row.cell.off_s.is_none()) {
            let name = row.fault.name;
            match found.iter_mut().find(|it| it.0 == name) {
                Some(it) => (it.1, it.2) = (it.1 + 1, it.2.max(row.cell.most_j)),
                None => found.push((name, 1, row.cell.most_j)),
            }
        }
        found
    }

    fn of(&self, board: Board) -> impl Iterator<Item = &Row<'_>> {
        self.rows.iter().filter(move |row| row.bench.board == board)
    }
}

/// Whether it is known that the board of this row does not find the fault.
fn is_known(row: &Row<'_>) -> bool {
    UNFOUND
        .iter()
        .any(|(on, names)| *on == row.bench.board && names.contains(&row.fault.name))
}

/// The worst row for each board and fault, the one with the most energy first; at most `number` rows.
fn worst_of<'r, 'b>(rows: impl Iterator<Item = &'r Row<'b>>, number: usize) -> Vec<&'r Row<'b>>
where
    'b: 'r,
{
    let mut rows: Vec<_> = rows.collect();
    rows.sort_by(|a, b| b.cell.most_j.total_cmp(&a.cell.most_j));
    let mut seen = Vec::new();
    rows.retain(|row| {
        let place = (row.bench.board, row.fault.name);
        let is_new = !seen.contains(&place);
        seen.push(place);
        is_new
    });
    rows.truncate(number);
    rows
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

fn middle(sorted: &[f64]) -> f64 {
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

fn worst(sorted: &[f64]) -> f64 {
    sorted.last().copied().unwrap_or(f64::NAN)
}
