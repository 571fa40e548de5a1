//! Where a link within the page leads.

/// Identifier of a row of a matrix.
pub fn row_id(matrix: usize, row: usize) -> String {
    format!("m{matrix}-k{row}")
}

/// Identifier of a run's figures.
pub fn run_id(index: usize) -> String {
    format!("run-{index}")
}
