//! What a row of `cargo xtask` is.

use crate::outcome::Outcome;

/// One row of `cargo xtask`.
pub struct Step {
    pub name: &'static str,
    pub about: &'static str,
    /// What `cargo xtask test` runs of it, in the order of the table.
    pub in_test: InTest,
    pub quick: Quick,
    pub run: fn(&[String]) -> Outcome,
}

/// What `cargo xtask test` does of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InTest {
    /// Nothing.
    No,
    /// All of it.
    Whole,
    /// With this argument a sample of it.
    Sample(&'static str),
}

impl InTest {
    /// The arguments, where it is run.
    pub fn args(self) -> Option<Vec<String>> {
        match self {
            InTest::No => None,
            InTest::Whole => Some(Vec::new()),
            InTest::Sample(option) => Some(vec![option.to_owned()]),
        }
    }
}

/// What `cargo xtask test --quick` does of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quick {
    /// All of it.
    Whole,
    /// With this argument; what is then left out.
    Part(&'static str, &'static str),
    /// Nothing.
    LeftOut,
}

impl Quick {
    /// What is left out of a step, for people; `None`: nothing.
    pub fn left_out(self) -> Option<&'static str> {
        match self {
            Quick::Whole => None,
            Quick::Part(_, what) => Some(what),
            Quick::LeftOut => Some("all of it"),
        }
    }
}
