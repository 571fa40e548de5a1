//! Identifiers of places in the report page, for links within the page.

/// Identifier of one stiffness (a table row) of a matrix of runs.
pub fn row_id(matrix: usize, row: usize) -> String {
    format!("m{matrix}-k{row}")
}

/// Identifier of a run's figures.
pub fn run_id(index: usize) -> String {
    format!("run-{index}")
}
