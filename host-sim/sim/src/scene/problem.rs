//! Problems found in a scene, before the file's line is looked up.

/// A problem with one field or table of a scene.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Problem {
    /// Dotted path of the field or table.
    pub path: String,
    /// Description of the problem.
    pub problem: String,
    /// What the user can do about the problem.
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
