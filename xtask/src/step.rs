//! A step: one row of `cargo xtask`.

use crate::outcome::Outcome;

/// One row of `cargo xtask`.
pub struct Step {
    pub name: &'static str,
    pub about: &'static str,
    /// The part that each gate runs, in the order of the table.
    pub gates: Gates,
    pub run: fn(&[String]) -> Outcome,
}

/// The gates: `cargo xtask test --quick`, `cargo xtask test`, `cargo xtask test --full`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gate {
    /// The gate for daily work.
    Quick,
    /// The run that a person waits for, and CI.
    Test,
    /// The run of a night.
    Full,
}

/// What each gate runs of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gates {
    pub quick: Share,
    pub test: Share,
    pub full: Share,
}

/// The part of a step that a gate runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Share {
    /// The whole step.
    Whole,
    /// The step with these arguments; the text names what is left out.
    Part(&'static [&'static str], &'static str),
    /// The step is left out.
    LeftOut,
}

impl Gates {
    /// A command that no gate runs.
    pub const NONE: Self = Self {
        quick: Share::LeftOut,
        test: Share::LeftOut,
        full: Share::LeftOut,
    };
    /// A step that every gate runs whole.
    pub const ALL: Self = Self {
        quick: Share::Whole,
        test: Share::Whole,
        full: Share::Whole,
    };
    /// A step of the night alone.
    pub const FULL_ONLY: Self = Self {
        full: Share::Whole,
        ..Self::NONE
    };
    /// A step of which daily work and the first gate run the same part.
    pub const fn part(args: &'static [&'static str], left_out: &'static str) -> Self {
        let part = Share::Part(args, left_out);
        Self {
            quick: part,
            test: part,
            full: Share::Whole,
        }
    }

    /// The part that a gate runs.
    pub const fn of(self, gate: Gate) -> Share {
        match gate {
            Gate::Quick => self.quick,
            Gate::Test => self.test,
            Gate::Full => self.full,
        }
    }

    /// Whether any gate runs a part.
    pub fn is_tested(self) -> bool {
        self != Self::NONE
    }
}

impl Share {
    /// The arguments, where it is run.
    pub fn args(self) -> Option<Vec<String>> {
        match self {
            Share::LeftOut => None,
            Share::Whole => Some(Vec::new()),
            Share::Part(args, _) => Some(args.iter().map(|arg| (*arg).to_owned()).collect()),
        }
    }

    /// The text about what is left out; `None` where nothing is.
    pub fn left_out(self) -> Option<&'static str> {
        match self {
            Share::Whole => None,
            Share::Part(_, what) => Some(what),
            Share::LeftOut => Some("all of it"),
        }
    }
}
