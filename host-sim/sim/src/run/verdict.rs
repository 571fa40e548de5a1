//! Verdicts on a run: their names in options and results, and their meanings.

use serde::Serialize;

/// Verdict on a run. The order is from good to bad.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The device came to rest, and at no time had the user got more energy out of it than was put in.
    Passive,
    /// The device came to rest, but at some time it had given the user more energy than it had received.
    Active,
    /// The device keeps oscillating near the wall's surface.
    LimitCycle,
    /// The device diverges, moves farther than a limit cycle (0.25 rad peak to peak), or keeps moving and also leaves the wall
    /// twice or reaches the torque limit.
    Unstable,
    /// The run does not show whether the device would come to rest at the wall; [`NotJudged`] gives the reason.
    NotJudged,
    /// The wall never pushed, so the run says nothing about the wall. This verdict is the last in the order, so that it never
    /// counts as good.
    NoContact,
}

/// Least time for which a device is examined for rest, s: one period of 50 Hz. Most limit cycles are faster.
pub const LEAST_REST_S: f64 = 0.02;

/// Name of the verdict on a run in which the wall never pushed.
pub const NO_CONTACT: &str = "no-contact";

/// Name of the verdict on a run that does not show whether the wall lets the device rest.
pub const NOT_JUDGED: &str = "not-judged";

/// Name and meaning of every verdict, from good to bad; the last two say nothing about the wall.
pub const WORDS: [(&str, &str); 6] = [
    (
        "passive",
        "came to rest; the hand never got out more energy than it had put in",
    ),
    (
        "active",
        "came to rest, but for a while the hand had got out more energy than it had put in",
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
        "the hand did not rest, or the run was too short to show whether the wall comes to rest",
    ),
    (
        NO_CONTACT,
        "the wall never pushed, so the run shows nothing about it",
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

    /// Name of the verdict in options and results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        WORDS[self.place()].0
    }

    /// Meaning of the verdict in words.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        WORDS[self.place()].1
    }
}

/// Reason why a run has the verdict [`Verdict::NotJudged`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NotJudged {
    /// The hand moved in the time in which the device should have rested.
    HandMoves {
        /// Motion of the hand's rest point, peak to peak, rad.
        hand_rad: f64,
        /// Motion of the device in the same time as that of the hand, peak to peak, rad.
        device_rad: f64,
    },
    /// The last hold of the hand within the run was too short.
    TooShort {
        /// Time for which the device was examined, s.
        seen_s: f64,
        /// Time for which the device must be examined, s.
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
                "the run shows only {:.1} ms of rest; at least {:.0} ms are needed",
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
