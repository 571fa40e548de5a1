//! HTML identifiers of places in the report page, for links within the page.

/// HTML identifier of one stiffness (a table row) of a table of runs.
pub fn row_id(matrix: usize, row: usize) -> String {
    format!("m{matrix}-k{row}")
}

/// HTML identifier of the figures of a run.
pub fn run_id(index: usize) -> String {
    format!("run-{index}")
}
