//! How a run ended, and the words for it: names in options and results, and their meanings, in one place.

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
    /// The hand's motion hides whether the wall lets the device rest; [`NotJudged`] has the reason.
    NotJudged,
    /// The wall was never touched: nothing was shown, good or bad. Last, so that it does not pass for a wall that holds.
    NoContact,
}

/// Name of a run in which the wall never pushed: nothing is known of the wall then, least of all that it is passive.
pub const NO_CONTACT: &str = "no-contact";

/// Name of a run that does not show whether the wall lets the device rest.
pub const NOT_JUDGED: &str = "not-judged";

/// Every name with its meaning, from good to bad, then those that say nothing of the wall.
pub const WORDS: [(&str, &str); 6] = [
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
        NOT_JUDGED,
        "the hand did not rest, or the run was too short, so that it cannot be seen whether the wall does",
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
            Verdict::NotJudged => 4,
            Verdict::NoContact => 5,
        }
    }

    /// Name in options and results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        WORDS[self.place()].0
    }

    /// The meaning in words.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        WORDS[self.place()].1
    }
}

/// Why a run is [`Verdict::NotJudged`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NotJudged {
    /// The hand moved while the device should have rested.
    HandMoves {
        /// Motion of the hand's rest point, peak to peak, rad.
        hand_rad: f64,
        /// Motion of the device in that time, peak to peak, rad.
        device_rad: f64,
    },
    /// The run ends before the hand has held still for long enough.
    TooShort {
        /// Time for which the device was examined, s.
        seen_s: f64,
        /// Time for which it must be examined, s.
        least_s: f64,
    },
}

impl std::fmt::Display for NotJudged {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::HandMoves {
                hand_rad,
                device_rad,
            } => write!(
                f,
                "the hand never rests: it moves by {:.2} mrad while the device moves by {:.2} mrad",
                1e3 * hand_rad,
                1e3 * device_rad
            ),
            Self::TooShort { seen_s, least_s } => write!(
                f,
                "only {:.1} ms of rest are seen, {:.0} ms are the least",
                1e3 * seen_s,
                1e3 * least_s
            ),
        }
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
            Verdict::NotJudged,
            Verdict::NoContact,
        ] {
            let text = toml::Value::try_from(verdict).unwrap();
            assert_eq!(text.as_str(), Some(verdict.name()));
        }
    }
}
