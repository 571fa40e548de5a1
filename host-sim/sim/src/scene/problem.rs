//! What is wrong with a scene, before it is known where that stands.

/// Something wrong with one field or table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Problem {
    /// Field or table, dotted.
    pub path: String,
    /// What is wrong.
    pub problem: String,
    /// How to mend it.
    pub fix: String,
}

impl Problem {
    pub fn new(
        path: impl Into<String>,
        problem: impl Into<String>,
        fix: impl Into<String>,
    ) -> Self {
        Problem {
            path: path.into(),
            problem: problem.into(),
            fix: fix.into(),
        }
    }
}
