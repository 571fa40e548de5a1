//! The words for how a run ended: their names in options and results, and what each means. They stand here and nowhere else.

use super::record::{Summary, Verdict};

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

impl Summary {
    /// The run's verdict by its name.
    #[must_use]
    pub const fn verdict_name(&self) -> &'static str {
        self.verdict.name()
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
