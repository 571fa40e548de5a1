//! Texts for readers of reports: names and explanations of control laws, verdicts and the conditions of a run.

use super::figure::Sign;
use super::quantity::{grouped, plain};
use touchstone_control::LawKind;
use touchstone_sim::run::record::{Summary, Verdict};

/// Name and explanation of a control law, for readers.
pub struct LawWords {
    /// Short name of the law for readers.
    pub name: &'static str,
    /// What the control law does, as a clause.
    pub meaning: &'static str,
}

/// Name and explanation of a control law. A new law needs one more arm here.
pub fn law_words(law: LawKind) -> LawWords {
    let (name, meaning) = match law {
        LawKind::Spring => ("Spring", "force in proportion to the penetration"),
        LawKind::SpringDamper => ("Damped spring", "a spring with virtual damping"),
        LawKind::Tdpa => (
            "TDPA",
            "time-domain passivity approach: a spring that is damped as soon as its observer counts a loss of energy",
        ),
        LawKind::Fba => (
            "FBA",
            "force bounding approach: a spring whose force is bounded by the observed energy",
        ),
        LawKind::Sfa => (
            "Original SFA",
            "successive force augmentation: a soft spring whose rest point moves each time the motion turns inwards",
        ),
        LawKind::SfaContinuous => (
            "SFA, contin.",
            "successive force augmentation in every control period of inward motion",
        ),
        LawKind::EnhancedSfa => (
            "Enhanced SFA",
            "successive force augmentation through a virtual mass, its energy observed and bounded",
        ),
    };
    LawWords { name, meaning }
}

/// Short name of a law for readers.
pub fn law(law: LawKind) -> &'static str {
    law_words(law).name
}

/// Name of a run for readers: the name of its law, or the name that the report gives to the run.
pub fn run_name(run: &Summary) -> &'static str {
    run.shown_as.unwrap_or(law(run.law))
}

/// Position of a law in tables; the simplest law comes first.
pub fn law_order(law: LawKind) -> usize {
    law as usize
}

/// Name, explanation and style of a verdict on a run.
pub struct VerdictWords {
    /// Name of the verdict in one or two words.
    pub name: &'static str,
    /// Name of the verdict in results files, and of its CSS class.
    pub key: &'static str,
    /// A character that stands for the verdict, so that verdicts do not differ by colour alone.
    pub sign: &'static str,
    /// The verdict's symbol in a figure.
    pub mark: Sign,
    /// ANSI colour code of the verdict in a terminal.
    pub ansi: &'static str,
    /// Meaning of the verdict, in words.
    pub meaning: &'static str,
}

/// Name, explanation and style of a verdict. A new verdict needs one more arm here.
pub fn verdict_words(verdict: Verdict) -> VerdictWords {
    let (name, sign, mark, ansi) = match verdict {
        Verdict::Passive => ("passive", "✓", Sign::Dot, "32"),
        Verdict::Active => ("active", "△", Sign::Triangle, "33"),
        Verdict::LimitCycle => ("limit cycle", "≈", Sign::Waves, "35"),
        Verdict::Unstable => ("unstable", "✕", Sign::Cross, "31"),
        Verdict::NotJudged => ("not judged", "?", Sign::Ring, "2"),
        Verdict::NoContact => ("no contact", "–", Sign::Ring, "2"),
    };
    VerdictWords {
        name,
        key: verdict.name(),
        sign,
        mark,
        ansi,
        meaning: verdict.meaning(),
    }
}

/// Name of a verdict for readers.
pub fn verdict(verdict: Verdict) -> &'static str {
    verdict_words(verdict).name
}

/// The conditions of a run apart from control law and requested stiffness. Runs in one table share them.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    /// The conditions in words, always in the same order: scene, grip, encoder, rate, number format.
    pub parts: [String; 5],
}

impl Condition {
    /// The conditions of a run, from its summary.
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

    /// All conditions of the run in one line of text.
    pub fn text(&self) -> String {
        self.parts.join(" · ")
    }
}

/// Largest number of characters of a scene's name in the names of its files. File systems accept names of 255 bytes.
const SCENE_MAX: usize = 80;

/// Name of a run's trace file without extension. It contains everything that usually differs between runs of a report.
pub fn file_stem(summary: &Summary) -> String {
    let counts = summary
        .encoder_counts_per_rev
        .map_or("exact".to_owned(), |c| format!("{}cpr", plain(c)));
    let parts = [
        summary.scene.chars().take(SCENE_MAX).collect(),
        summary.word(),
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

/// Replaces every character of `text` that a file name must not contain. The name of a scene comes from a file and may contain any
/// character, even a path separator.
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
    use crate::synthetic;

    #[test]
    fn a_file_name_cannot_leave_its_folder() {
        let mut summary = synthetic::run(LawKind::Spring, 2.5, 0.01).summary;
        summary.scene = "../a b/ü".to_owned();
        assert_eq!(
            file_stem(&summary),
            "a-b--_spring_k2.5_medium_16384cpr_1000hz_f64"
        );
        summary.scene = "y".repeat(5000);
        assert!(file_stem(&summary).len() < 160);
    }
}
