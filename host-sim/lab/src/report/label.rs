//! The words that a reader sees for laws, verdicts and the conditions of a run.

use super::quantity::{grouped, plain};
use touchstone_control::{Choice, LawKind};
use touchstone_sim::run::record::{Summary, Verdict};

/// A law's short name for people.
pub fn law(law: LawKind) -> &'static str {
    match law {
        LawKind::Spring => "Spring",
        LawKind::SpringDamper => "Damped spring",
        LawKind::Tdpa => "TDPA",
        LawKind::Fba => "FBA",
        LawKind::Sfa => "Original SFA",
        LawKind::SfaContinuous => "SFA, contin.",
        LawKind::EnhancedSfa => "Enhanced SFA",
    }
}

/// A verdict in a word.
pub fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Passive => "passive",
        Verdict::Active => "active",
        Verdict::LimitCycle => "limit cycle",
        Verdict::Unstable => "unstable",
        Verdict::NoContact => "no contact",
    }
}

/// What a verdict means.
pub fn verdict_meaning(verdict: Verdict) -> &'static str {
    verdict.meaning()
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
        summary.law.word().to_owned(),
        format!("k{}", plain(summary.k_desired)),
        summary.grip.clone(),
        counts,
        format!("{}hz", summary.rate_hz),
        summary.number.clone(),
    ];
    // A scene's name comes from a file and may hold anything, a path separator too.
    let safe = |c: char| {
        if c.is_ascii_alphanumeric() || c == '.' || c == '-' {
            c
        } else {
            '-'
        }
    };
    parts
        .map(|part| part.chars().map(safe).collect::<String>())
        .join("_")
        .trim_start_matches(['.', '-'])
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::synthetic;

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
