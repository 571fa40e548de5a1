//! The words that a reader sees for laws, verdicts and the conditions of a run.

use super::figure::Sign;
use super::quantity::{grouped, plain};
use touchstone_sim::run::record::{LawKind, Summary, Verdict};

/// What is said of a law.
pub struct LawWords {
    /// Short name for people.
    pub name: &'static str,
    /// Name in scenes, on the command line and in results.
    pub key: &'static str,
    /// What it does, in a clause.
    pub meaning: &'static str,
}

/// The words for a law. A law more is one arm more.
pub fn law_words(law: LawKind) -> LawWords {
    let (name, key, meaning) = match law {
        LawKind::Spring => ("Spring", "spring", "force in proportion to the penetration"),
        LawKind::SpringDamper => (
            "Damped spring",
            "spring-damper",
            "a spring with virtual damping",
        ),
        LawKind::Tdpa => (
            "TDPA",
            "tdpa",
            "time-domain passivity approach: a spring that damps once its observer counts a loss",
        ),
        LawKind::Fba => (
            "FBA",
            "fba",
            "force bounding approach: a spring whose force the observed energy bounds",
        ),
        LawKind::Sfa => (
            "Original SFA",
            "sfa",
            "successive force augmentation: a soft spring whose rest point is moved at each turn inwards",
        ),
        LawKind::SfaContinuous => (
            "SFA, contin.",
            "sfa-continuous",
            "successive force augmentation at every tick inwards",
        ),
        LawKind::EnhancedSfa => (
            "Enhanced SFA",
            "enhanced-sfa",
            "successive force augmentation through a virtual mass, its energy observed and bounded",
        ),
    };
    LawWords { name, key, meaning }
}

/// A law's short name for people.
pub fn law(law: LawKind) -> &'static str {
    law_words(law).name
}

/// A law's name in scenes, on the command line and in results.
pub fn law_key(law: LawKind) -> &'static str {
    law_words(law).key
}

/// A law's place in tables: simplest first.
pub fn law_order(law: LawKind) -> usize {
    law as usize
}

/// What is said of a verdict, and how it is shown.
pub struct VerdictWords {
    /// In a word.
    pub name: &'static str,
    /// Name in results and of its style.
    pub key: &'static str,
    /// A sign, so that colour is never the only difference.
    pub sign: &'static str,
    /// The sign in a figure.
    pub mark: Sign,
    /// Colour in a terminal, ANSI.
    pub ansi: &'static str,
    /// What it means.
    pub meaning: &'static str,
}

/// The words for a verdict. A verdict more is one arm more.
#[rustfmt::skip]
pub fn verdict_words(verdict: Verdict) -> VerdictWords {
    let (name, key, sign, mark, ansi, meaning) = match verdict {
        Verdict::Passive => ("passive", "passive", "✓", Sign::Dot, "32",
            "came to rest; the user never got out more energy than was put in"),
        Verdict::Active => ("active", "active", "△", Sign::Triangle, "33",
            "came to rest, but the device had at some time given the user more energy than it had got"),
        Verdict::LimitCycle => ("limit cycle", "limit-cycle", "≈", Sign::Waves, "35",
            "keeps oscillating near the wall without growing"),
        Verdict::Unstable => ("unstable", "unstable", "✕", Sign::Cross, "31",
            "leaves the wall again and again, hits the torque limit, or grows"),
    };
    VerdictWords { name, key, sign, mark, ansi, meaning }
}

/// A verdict in a word.
pub fn verdict(verdict: Verdict) -> &'static str {
    verdict_words(verdict).name
}

/// What a run was made under, apart from the law and the desired stiffness. Runs of one table share it.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    /// Each part in words, always in the same order: scene, grip, encoder, rate, number format.
    pub parts: [String; 5],
}

impl Condition {
    /// The condition of a run.
    pub fn of(summary: &Summary) -> Self {
        let rate = f64::from(summary.rate_hz);
        Condition {
            parts: [
                format!("scene {}", summary.scene),
                if summary.grip == "none" {
                    "no hand".to_owned()
                } else {
                    format!("{} grip", summary.grip)
                },
                match summary.encoder_counts_per_rev {
                    Some(counts) => format!("{} counts/rev", grouped(counts)),
                    None => "exact position".to_owned(),
                },
                if rate >= 1000.0 {
                    format!("{} kHz", plain(rate / 1000.0))
                } else {
                    format!("{} Hz", plain(rate))
                },
                format!("law in {}", summary.number),
            ],
        }
    }

    /// All parts in one line.
    pub fn text(&self) -> String {
        self.parts.join(" · ")
    }
}

/// A file name without ending for a run's trace; tells apart what a report usually varies.
pub fn file_stem(summary: &Summary) -> String {
    let counts = summary
        .encoder_counts_per_rev
        .map_or("exact".to_owned(), |c| format!("{}cpr", plain(c)));
    let parts = [
        summary.scene.clone(),
        law_key(summary.law).to_owned(),
        format!("k{}", plain(summary.k_desired)),
        summary.grip.clone(),
        counts,
        format!("{}hz", summary.rate_hz),
        summary.number.clone(),
    ];
    parts
        .map(|part| safe(&part))
        .join("_")
        .trim_start_matches(['.', '-'])
        .to_owned()
}

/// `text` without what a file name cannot hold: a scene's name comes from a file and may hold anything, a path separator too.
pub fn safe(text: &str) -> String {
    let safe = |c: char| {
        if c.is_ascii_alphanumeric() || c == '.' || c == '-' || c == '_' {
            c
        } else {
            '-'
        }
    };
    text.chars().map(safe).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::synthetic;

    #[test]
    fn keys_are_the_serialised_names() {
        for kind in synthetic::ALL_LAWS {
            assert_eq!(serde_json::to_value(kind).unwrap(), law_key(kind));
        }
    }

    #[test]
    fn a_file_name_cannot_leave_its_folder() {
        let mut summary = synthetic::run(LawKind::Spring, 2.5, 0.01).summary;
        summary.scene = "../a b/ü".to_owned();
        assert_eq!(
            file_stem(&summary),
            "a-b--_spring_k2.5_medium_16384cpr_1000hz_f64"
        );
    }
}
