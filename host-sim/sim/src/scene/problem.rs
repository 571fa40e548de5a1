//! Problems of a scene, before the line in the file is known.

/// A problem with one field or table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Problem {
    /// Dotted path of the field or table.
    pub path: String,
    /// What is wrong, in words.
    pub problem: String,
    /// Remedy, in words.
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
