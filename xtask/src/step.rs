//! A step of the project's checks: one row in the table of all `cargo xtask` commands.

use crate::outcome::Outcome;

/// One row in the table of `cargo xtask` commands.
pub struct Step {
    pub name: &'static str,
    pub about: &'static str,
    /// The part of the step that each gate runs.
    pub gates: Gates,
    pub run: fn(&[String]) -> Outcome,
}

/// A gate: a test run of one extent. From short to long: `cargo xtask test --quick`, `cargo xtask test`, `cargo xtask test --full`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gate {
    /// The gate for daily work, `cargo xtask test --quick`.
    Quick,
    /// The gate that must pass before a change is accepted, `cargo xtask test`; CI runs it too.
    Test,
    /// The gate that takes a night, `cargo xtask test --full`.
    Full,
}

/// For each [`Gate`], the part of a step that it runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gates {
    pub quick: Share,
    pub test: Share,
    pub full: Share,
}

/// The part of a step that a [`Gate`] runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Share {
    /// The whole step.
    Whole,
    /// The gate calls the step with these arguments; the text names what the gate leaves out.
    Part(&'static [&'static str], &'static str),
    /// The gate leaves the step out.
    LeftOut,
}

impl Gates {
    /// For a command that no gate runs.
    pub const NONE: Self = Self {
        quick: Share::LeftOut,
        test: Share::LeftOut,
        full: Share::LeftOut,
    };
    /// For a step that every gate runs whole.
    pub const ALL: Self = Self {
        quick: Share::Whole,
        test: Share::Whole,
        full: Share::Whole,
    };
    /// For a step that only the full gate (`cargo xtask test --full`) runs.
    pub const FULL_ONLY: Self = Self {
        full: Share::Whole,
        ..Self::NONE
    };
    /// For a step of which the quick gate and the middle gate run the same part, with these arguments. `left_out` names the rest.
    pub const fn part(args: &'static [&'static str], left_out: &'static str) -> Self {
        let part = Share::Part(args, left_out);
        Self {
            quick: part,
            test: part,
            full: Share::Whole,
        }
    }

    /// The part of the step that a gate runs.
    pub const fn of(self, gate: Gate) -> Share {
        match gate {
            Gate::Quick => self.quick,
            Gate::Test => self.test,
            Gate::Full => self.full,
        }
    }

    /// Whether any gate runs at least a part of the step.
    pub fn is_tested(self) -> bool {
        self != Self::NONE
    }
}

impl Share {
    /// The arguments with which the gate calls the step; `None` if the gate leaves the step out.
    pub fn args(self) -> Option<Vec<String>> {
        match self {
            Share::LeftOut => None,
            Share::Whole => Some(Vec::new()),
            Share::Part(args, _) => Some(args.iter().map(|arg| (*arg).to_owned()).collect()),
        }
    }

    /// Text that names what the gate leaves out of the step; `None` if nothing is left out.
    pub fn left_out(self) -> Option<&'static str> {
        match self {
            Share::Whole => None,
            Share::Part(_, what) => Some(what),
            Share::LeftOut => Some("all of it"),
        }
    }
}
