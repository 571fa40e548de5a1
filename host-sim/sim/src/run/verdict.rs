//! How a run ended, and the words for it: names in options and results, and what each means. They stand here and nowhere else.

use serde::Serialize;

/// How a run ended. The order is from good to bad.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Came to rest; the user never got more energy out of the device than was put in.
    Passive,
    /// Came to rest, but at some time the device had given the user more energy than it had got.
    Active,
    /// Keeps oscillating without growing beyond the wall's neighbourhood.
    LimitCycle,
    /// Leaves the wall again and again, hits the torque limit, or grows without bound.
    Unstable,
    /// The wall was never touched: nothing was shown, good or bad. Last, so that it does not pass for a wall that holds.
    NoContact,
}

/// Name of a run in which the wall never pushed: nothing is known of the wall then, least of all that it is passive.
pub const NO_CONTACT: &str = "no-contact";

/// Every name with its meaning, from good to bad, [`NO_CONTACT`] last.
pub const WORDS: [(&str, &str); 5] = [
    (
        "passive",
        "came to rest; the user never got out more energy than was put in",
    ),
    (
        "active",
        "came to rest, but the device had at some time given the user more energy than it had got",
    ),
    (
        "limit-cycle",
        "keeps oscillating near the wall without growing",
    ),
    (
        "unstable",
        "leaves the wall again and again, hits the torque limit, or grows",
    ),
    (
        NO_CONTACT,
        "the wall never pushed, so that nothing is known of it",
    ),
];

impl Verdict {
    const fn place(self) -> usize {
        match self {
            Verdict::Passive => 0,
            Verdict::Active => 1,
            Verdict::LimitCycle => 2,
            Verdict::Unstable => 3,
            Verdict::NoContact => 4,
        }
    }

    /// Name in options and results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        WORDS[self.place()].0
    }

    /// What it means, for people.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        WORDS[self.place()].1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_the_serialised_ones() {
        for verdict in [
            Verdict::Passive,
            Verdict::Active,
            Verdict::LimitCycle,
            Verdict::Unstable,
            Verdict::NoContact,
        ] {
            let text = toml::Value::try_from(verdict).unwrap();
            assert_eq!(text.as_str(), Some(verdict.name()));
        }
    }
}
