//! `touchstone certify`: computes, without a simulation run, whether device and hand come to rest at the wall with each grip, and
//! how the wall's stiffness is rendered.

use super::SceneOptions;
use super::out::{json, say};
use touchstone_lab::certify::feel::{PartAtSteepest, certify_feel};
use touchstone_lab::certify::hands::{Family, HYPOTHETICAL};
use touchstone_lab::certify::judge::HandReport;
use touchstone_lab::certify::{Certificate, CertifyOptions, certify};
use touchstone_lab::tune::outcome::Outcome;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::Scene;

/// Options of the command `touchstone certify`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Name of a shipped scene or path of a scene's TOML file.
    #[arg(default_value = "thesis-knob")]
    scene: String,
    #[command(flatten)]
    changes: SceneOptions,
    /// Leaves out the search for the worst hand of a whole family of hypothetical hands.
    #[arg(long)]
    grips: bool,
    /// Leaves out the stability margins, which take most of the time.
    #[arg(long)]
    no_margins: bool,
    /// Bandwidth of a simulated current loop, Hz.
    #[arg(long, value_name = "HZ")]
    current_loop_hz: Option<f64>,
}

/// Runs the command `touchstone certify`.
pub fn main(options: &Options) -> Result<()> {
    if let Some(bandwidth) = options
        .current_loop_hz
        .filter(|hz| !(*hz > 0.0 && hz.is_finite()))
    {
        return Err(Error::Option {
            option: "--current-loop-hz".to_owned(),
            problem: format!("{bandwidth} is not a valid bandwidth"),
            fix: "give a number above 0".to_owned(),
        });
    }
    let (scene, _) = options.changes.load(&options.scene)?;
    let asked = CertifyOptions {
        family: if options.grips {
            Family::Grips
        } else {
            Family::All
        },
        margins: !options.no_margins,
        current_loop_hz: options.current_loop_hz,
    };
    let around = scene.environment.as_ref();
    if around.is_some_and(|it| it.is_more_than_the_wall()) {
        return certify_parts(&scene, &asked);
    }
    let certificate = certify(&scene, &asked)?;
    let feel = Outcome::of(&scene)?;
    if json() {
        let mut value = serde_json::json!(certificate);
        value["feel"] = serde_json::json!(feel);
        value["feel"]["holds"] = feel.holds().into();
        say!("{}", super::out::json_text(&value));
        return Ok(());
    }
    print(&certificate, &feel)
}

/// Certifies the parts of a feel instead of a wall.
fn certify_parts(scene: &Scene, asked: &CertifyOptions) -> Result<()> {
    let found = certify_feel(scene, asked)?;
    if json() {
        let value = match &found {
            Some(certificate) => serde_json::json!(certificate),
            None => serde_json::json!({ "scene": scene.name, "verdict": null, "parts": [] }),
        };
        say!("{}", super::out::json_text(&value));
        return Ok(());
    }
    let Some(found) = found else {
        say!(
            "{}: nothing to certify: no part of this feel has a torque that changes with the angle",
            scene.name
        );
        return Ok(());
    };
    let stiffest = &found.parts[found.stiffest];
    say!(
        "{}: stiffest part {}, {:.4} N·m/rad {}: {} with the three grips",
        found.scene,
        stiffest.part,
        stiffest.stiffness_n_m_per_rad,
        place(stiffest),
        stiffest.rest.word()
    );
    say!("all parts: {}", found.verdict.word());
    say!("");
    let names: Vec<&str> = stiffest.hands.iter().map(|it| &*it.hand).collect();
    let columns = |words: &mut dyn Iterator<Item = &str>| -> String {
        words.map(|word| format!("{word:<11}")).collect()
    };
    let head = columns(&mut names.iter().copied());
    say!("{:<27}{:>9}  {head}at", "part", "N·m/rad");
    for part in &found.parts {
        let rests = columns(&mut part.hands.iter().map(|it| it.rest.word()));
        let stiffness = part.stiffness_n_m_per_rad;
        say!("{:<27}{stiffness:>9.4}  {rests}{}", part.part, place(part));
        for hand in part.hands.iter().filter(|it| it.hand != "nobody") {
            for cause in &hand.causes {
                say!("  {}: {cause}", hand.hand);
            }
        }
    }
    say!("");
    say!(
        "negative: the torque drives the knob away; it snaps on unless a hand holds it. not covered:"
    );
    for line in &found.not_covered {
        say!("  {line}");
    }
    Ok(())
}

/// The angles at which a part of a feel is steepest, as text.
fn place(part: &PartAtSteepest) -> String {
    match (part.cell_rad, part.every_rad) {
        (None, _) => "at any angle".to_owned(),
        (Some([from, to]), _) if from == to => format!("from {from:.4} rad on"),
        (Some([from, to]), None) => format!("{from:.4} to {to:.4} rad"),
        (Some([from, to]), Some(every)) => {
            format!("{from:.4} to {to:.4} rad, every {every:.4}")
        }
    }
}

/// The first lines of the report: whether the wall comes to rest with each grip, and the rendered stiffness.
fn verdicts(certificate: &Certificate, feel: &Outcome) -> Vec<String> {
    let worst = &certificate.hands[certificate.worst];
    let mut said = vec![
        format!(
            "grips that people have, at rest: {} (worst: {})",
            certificate.verdict.word(),
            worst.name
        ),
        format!(
            "three grips, feel: {}: {}",
            if feel.holds() {
                "holds"
            } else {
                "does not hold"
            },
            feel.words()
        ),
    ];
    if let Some(verdict) = certificate.every_hand {
        said.push(format!(
            "hypothetical hand, the worst of the whole family: {}",
            verdict.word()
        ));
    }
    said
}

fn print(certificate: &Certificate, feel: &Outcome) -> Result<()> {
    say!(
        "{}  (k_de {} N·m/rad, T sqrt(k_de/J) {:.3})",
        certificate.scene,
        certificate.k_desired,
        certificate.stiffness_per_tick
    );
    for line in verdicts(certificate, feel) {
        say!("{line}");
    }
    say!("");
    say!(
        "{:<18}{:<11}{:>10}{:>12}{:>10}",
        "hand",
        "verdict",
        "radius",
        "decay 1/s",
        "Hz"
    );
    for hand in &certificate.hands {
        say!(
            "{:<18}{:<11}{:>10.6}{:>12.3}{:>10.2}",
            hand.name,
            hand.verdict.word(),
            hand.radius,
            hand.decay_per_s,
            hand.frequency_hz
        );
        for phase in &hand.phases {
            say!(
                "  {:<27}{:>10.6}{:>12.3}{:>10.2}",
                phase.phase,
                phase.radius,
                phase.decay_per_s,
                phase.frequency_hz
            );
        }
        for cause in &hand.causes {
            say!("  {cause}");
        }
    }
    let hypothetical = |hand: &&HandReport| hand.name == HYPOTHETICAL;
    if let Some([inertia, damping, stiffness, pad_damping, pad_stiffness]) = certificate
        .hands
        .iter()
        .find(hypothetical)
        .and_then(|hand| hand.parameters)
    {
        say!("");
        say!(
            "{HYPOTHETICAL}: inertia {inertia:.3e} kg·m², damping {damping:.3e} N·m·s/rad, stiffness {stiffness:.3e} N·m/rad, pad {pad_damping:.3e} N·m·s/rad and {pad_stiffness:.3e} N·m/rad"
        );
    }
    if let Some(margins) = &certificate.margins {
        say!("");
        say!("margins of the grips:");
        say!(
            "margin in delay: {}{:.3} ms",
            if margins.delay_beyond {
                "more than "
            } else {
                ""
            },
            1e3 * margins.delay_s
        );
        match (margins.inertia_down, margins.inertia_up) {
            (Some(down), Some(up)) => say!("stable for {down:.3} to {up:.3} times the inertia"),
            _ => say!("no margin in inertia"),
        }
        let ranges: Vec<_> = margins
            .k_desired
            .iter()
            .map(|[low, high]| format!("{low:.3} to {high:.3}"))
            .collect();
        say!(
            "every phase decays for k_de (N·m/rad): {}",
            if ranges.is_empty() {
                "none".to_owned()
            } else {
                ranges.join(", ")
            }
        );
    }
    say!("");
    say!("not covered:");
    for line in &certificate.not_covered {
        say!("  {line}");
    }
    Ok(())
}
