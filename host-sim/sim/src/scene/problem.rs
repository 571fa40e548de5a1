//! Problems of a scene before their place in the file is known.

/// A problem with one field or table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Problem {
    /// Field or table, dotted.
    pub path: String,
    /// The problem.
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
