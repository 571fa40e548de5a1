//! Certificate of a knob's feel: the steepest place of every part, and whether the knob rests there in a hand.
//!
//! Detents, a profile, a spring to a centre and dry friction are torques that depend piecewise linearly on the angle. The
//! interval between two corners is a **cell**. In a cell the part is a linear spring on measured positions, and the loop's matrix
//! is exact. In a **restoring** cell the torque falls with the angle and draws the knob back. In a **driving** cell the torque
//! rises with the angle and drives the knob away, as on the way from one detent to the next. There the knob snaps to the next
//! cell, unless a stiff enough hand holds it. The stiffest wall is certified like the wall of a scene, with simulated touches.

mod cells;
#[cfg(test)]
mod tests;

use super::contact::Contact;
use super::hand_report::{Played, report};
use super::hands::{Family, GRIPS};
use super::judge::{HandReport, within_reach};
use super::law::{Phases, Switching};
use super::linear_law::{LinearLaw, Phase};
use super::state_space::eigenvalues;
use super::{CertifyOptions, Verdict, certify, per_tick};
use cells::{Cell, statics, together};
use serde::Serialize;
use touchstone_control::Si;
use touchstone_control::environment::Refused;
use touchstone_control::environment::feel::Viscous;
use touchstone_sim::error::Result;
use touchstone_sim::run::plan;
use touchstone_sim::scene::{Environment, Scene};
use touchstone_world::plant::Hand;

/// What a knob does at the steepest place of a part, from good to bad.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rest {
    /// The knob comes to rest.
    Stable,
    /// The knob leaves the cell without an oscillation, because the torque drives it away.
    Snaps,
    /// Neither the matrices nor the simulations decide.
    Undecided,
    /// The knob oscillates, and the oscillation grows.
    Unstable,
}

impl Rest {
    /// Name of the result in lower case.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Rest::Stable => "stable",
            Rest::Snaps => "snaps",
            Rest::Undecided => "undecided",
            Rest::Unstable => "unstable",
        }
    }

    const fn verdict(self) -> Verdict {
        match self {
            Rest::Stable | Rest::Snaps => Verdict::Stable,
            Rest::Undecided => Verdict::Undecided,
            Rest::Unstable => Verdict::Unstable,
        }
    }
}

impl From<Verdict> for Rest {
    fn from(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Stable => Rest::Stable,
            Verdict::Undecided => Rest::Undecided,
            Verdict::Unstable => Rest::Unstable,
        }
    }
}

/// Result for one hand at the steepest place of a part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HandAtPart {
    /// Name of the grip, or `nobody`.
    pub hand: String,
    /// What the knob does in this hand.
    pub rest: Rest,
    /// Rate at which the slowest motion decays, 1/s; negative if it grows.
    pub decay_per_s: f64,
    /// Frequency of the slowest motion, Hz.
    pub frequency_hz: f64,
    /// Reasons why the knob does not rest, or why this is undecided.
    pub causes: Vec<String>,
}

/// The steepest place of one part of a feel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartAtSteepest {
    /// Scene table that describes the part; `together` for the sum of all parts.
    pub part: String,
    /// Stiffness at the steepest place, N·m/rad: positive if the torque draws the knob back, negative if it drives the knob away.
    pub stiffness_n_m_per_rad: f64,
    /// Angles at which the cell begins and ends, rad; `None` for a part that acts at any angle.
    pub cell_rad: Option<[f64; 2]>,
    /// Distance after which the cell repeats, rad; `None` if it does not repeat.
    pub every_rad: Option<f64>,
    /// Worst result over the three grips (light, medium, firm).
    pub rest: Rest,
    /// Results for every grip, and for a knob that nobody holds (`nobody`).
    pub hands: Vec<HandAtPart>,
}

/// Certificate of a feel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FeelCertificate {
    /// Name of the scene.
    pub scene: String,
    /// Worst verdict over all parts and grips. A place at which the knob snaps as intended counts as stable.
    pub verdict: Verdict,
    /// Index of the part with the largest restoring stiffness in `parts`.
    pub stiffest: usize,
    /// The steepest restoring and the steepest driving place of every part, the sum of all parts, and the stiffest wall.
    pub parts: Vec<PartAtSteepest>,
    /// Effects that the certificate does not cover.
    pub not_covered: Vec<String>,
}

/// Certifies a feel. `None` if it has no wall and no part whose torque changes with the angle.
///
/// # Errors
/// The control law does not accept the scene's settings.
pub fn certify_feel(scene: &Scene, options: &CertifyOptions) -> Result<Option<FeelCertificate>> {
    let around = scene.environment.clone().unwrap_or_default();
    let refused = |error: Refused| {
        let fix = "give 2 to 96 points from -1 to 1";
        scene.error("environment.profile.shape", error.to_string(), fix)
    };
    let parts = statics(&around).map_err(refused)?;
    let base = Contact::of(scene)?;
    let drag = drag(scene)?;
    let mut found = Vec::new();
    for part in &parts {
        for cell in part.steepest().into_iter().flatten() {
            found.push(at_cell(&base, options, drag, part.part, cell, part.every));
        }
    }
    if let Some(cell) = together(&parts) {
        found.push(at_cell(&base, options, drag, "together", cell, None));
    }
    found.extend(wall(scene, &around, options)?);
    let stiffest = (0..found.len()).max_by(|&a, &b| {
        let stiffness = |i: usize| found[i].stiffness_n_m_per_rad;
        stiffness(a).total_cmp(&stiffness(b))
    });
    let Some(stiffest) = stiffest else {
        return Ok(None);
    };
    let verdicts = found.iter().map(|part| part.rest.verdict());
    Ok(Some(FeelCertificate {
        scene: scene.name.clone(),
        verdict: verdicts.max().unwrap_or(Verdict::Undecided),
        stiffest,
        not_covered: not_covered(&around, &found),
        parts: found,
    }))
}

/// Coefficients of the feel's parts that depend on the velocity.
#[derive(Debug, Clone, Copy, Default)]
struct Drag {
    /// Viscous friction: fraction of its force that remains after a tick, and force per displacement in a tick.
    viscous: Option<(f64, f64)>,
    /// Inertia: fraction of the distance to the virtual mass that remains after a tick, and the coefficients of the damper to
    /// that mass.
    inertia: Option<(f64, (f64, f64))>,
}

fn drag(scene: &Scene) -> Result<Drag> {
    let Some(around) = scene.environment.as_ref() else {
        return Ok(Drag::default());
    };
    let (feel, settings) = (around.feel(), scene.settings()?);
    let refused = |error: Refused| match error {
        Refused::Part { path, .. } | Refused::PartOfFormat { path, .. } => {
            scene.error(path, error.to_string(), "give a smaller value")
        }
        _ => scene.error("environment", error.to_string(), "give a smaller value"),
    };
    let viscous = feel.viscous.map(|it| it.viscous::<f64>(&settings));
    let viscous = viscous.transpose().map_err(refused)?;
    let beside = feel.viscous.map_or(Si::ZERO, |it| it.damping);
    let inertia = feel.inertia.map(|it| it.rendered::<f64>(&settings, beside));
    let inertia = inertia.transpose().map_err(refused)?;
    let of = |it: &Viscous<f64>| (it.kept.0, it.per_way.0);
    Ok(Drag {
        viscous: viscous.as_ref().map(of),
        inertia: inertia.map(|it| (it.kept.0, of(&it.damper))),
    })
}

/// Linear law of a part with the given stiffness, together with the feel's viscous friction and inertia.
fn law(stiffness: f64, Drag { viscous, inertia }: Drag) -> LinearLaw {
    let damped = |force: &mut f64, (kept, per_way): (f64, f64), moved: f64| {
        *force = kept * *force + per_way * moved;
        *force
    };
    let of_friction = usize::from(viscous.is_some());
    let order = of_friction + 2 * usize::from(inertia.is_some());
    LinearLaw::of(order, |state, e, moved| {
        let mut sum = stiffness * e;
        if let Some(damper) = viscous {
            sum += damped(&mut state[0], damper, moved);
        }
        if let Some((kept, damper)) = inertia {
            let before = state[of_friction];
            state[of_friction] = kept * before + moved;
            let moved = state[of_friction] - before;
            sum += damped(&mut state[of_friction + 1], damper, moved);
        }
        sum
    })
}

fn at_cell(
    base: &Contact,
    options: &CertifyOptions,
    drag: Drag,
    part: &str,
    cell: Cell,
    every_rad: Option<f64>,
) -> PartAtSteepest {
    let contact = Contact {
        phases: Phases {
            lasting: vec![Phase {
                name: "the part",
                law: law(cell.stiffness, drag),
            }],
            switching: Switching::Never,
            by_direction: false,
            loan_covers_n_m: None,
            first_contact: None,
            clamps: None,
        },
        // These parts use the measured position, not an estimate.
        estimator: None,
        k_desired: cell.stiffness.abs(),
        // Dry friction has to end an oscillation as wide as the cell.
        press_n_m: Some(cell.stiffness.abs() * cell.half),
        touch_n_m: None,
        hold_s: None,
        current_loop_hz: options.current_loop_hz,
        ..base.clone()
    };
    let grips = GRIPS.map(|(name, hand)| (name, Some(hand)));
    let hands = grips.into_iter().chain([("nobody", None)]);
    let hands: Vec<_> = hands
        .map(|(name, hand)| at_hand(&contact, cell.stiffness, name, hand.as_ref()))
        .collect();
    PartAtSteepest {
        part: part.to_owned(),
        stiffness_n_m_per_rad: cell.stiffness,
        cell_rad: cell.from.is_finite().then_some([cell.from, cell.to]),
        every_rad,
        rest: worst(&hands),
        hands,
    }
}

/// Worst result over the grips. A knob that nobody holds does not count.
fn worst(hands: &[HandAtPart]) -> Rest {
    let grips = hands.iter().filter(|it| it.hand != "nobody");
    grips.map(|it| it.rest).max().unwrap_or(Rest::Undecided)
}

fn at_hand(contact: &Contact, stiffness: f64, name: &str, hand: Option<&Hand>) -> HandAtPart {
    let played = Played {
        bounce: 0.0,
        loan_used: None,
    };
    let mut report = report(contact, name, hand, played);
    if report.verdict == Verdict::Undecided && friction_ends(contact, &report) {
        report.verdict = Verdict::Stable;
        let decay = report.decay_per_s;
        report.causes = vec![format!("decays at {decay:.2} /s, and dry friction ends it")];
    }
    within_reach(&mut report, per_tick(contact));
    let mut rest = Rest::from(report.verdict);
    let snaps = stiffness < 0.0 && rest != Rest::Stable && leaves_without_swinging(contact, hand);
    if snaps {
        rest = Rest::Snaps;
        report.causes.clear();
    }
    HandAtPart {
        hand: report.name,
        rest,
        decay_per_s: report.decay_per_s,
        frequency_hz: report.frequency_hz,
        causes: report.causes,
    }
}

/// Whether dry friction ends a motion that decays slowly without friction. The friction must exceed the torque of one encoder
/// count, so that rounding cannot move the resting knob again.
fn friction_ends(contact: &Contact, report: &HandReport) -> bool {
    let of_a_count = contact.k_desired * contact.count_rad.unwrap_or(0.0);
    let friction = contact.device.friction;
    report.decay_per_s > 0.0 && friction.is_some_and(|it| it.kinetic > of_a_count)
}

/// Whether every motion that grows does so without oscillating.
fn leaves_without_swinging(contact: &Contact, hand: Option<&Hand>) -> bool {
    let Some(plant) = contact.plant(hand) else {
        return false;
    };
    contact.phases.lasting.iter().all(|phase| {
        let matrix = plant.closed_by(&contact.law(&phase.law), 1.0);
        eigenvalues(&matrix).is_some_and(|values| {
            let mut swings = values
                .iter()
                .filter(|value| !(value.im.abs() < 1e-9 && value.re > 0.0));
            swings.all(|value| value.norm() < 1.0)
        })
    })
}

/// Result for the scene's stiffest wall, certified like a scene's only wall; `None` without a wall.
fn wall(
    scene: &Scene,
    around: &Environment,
    options: &CertifyOptions,
) -> Result<Option<PartAtSteepest>> {
    let own = scene.wall.k_desired_n_m_per_rad;
    let first = around
        .first_wall
        .then_some(("wall", own, scene.wall.surface_rad));
    let stops = around.endstops.iter().map(|it| {
        let stiffness = it.stiffness_n_m_per_rad.unwrap_or(own);
        ("environment.endstops", stiffness, it.upper_rad)
    });
    let further = around
        .further()
        .map(|(table, it)| (table, it.stiffness_n_m_per_rad.unwrap_or(own), it.at_rad));
    let all = first.into_iter().chain(stops).chain(further);
    let Some((part, stiffness, at)) = all.reduce(|a, b| if b.1 > a.1 { b } else { a }) else {
        return Ok(None);
    };
    let alone = scene.with(|it| {
        it.environment = None;
        it.wall.k_desired_n_m_per_rad = stiffness;
    })?;
    let asked = CertifyOptions {
        family: Family::Grips,
        margins: false,
        ..*options
    };
    let certificate = certify(&alone, &asked)?;
    let own_hand = plan::hand(scene);
    let named = |name: &str| match own_hand {
        // The scene's own hand may be one of the grips.
        Some(hand) if name.starts_with("scene") => GRIPS
            .iter()
            .find(|(_, grip)| *grip == hand)
            .map_or_else(|| name.to_owned(), |(grip, _)| (*grip).to_owned()),
        _ => name.to_owned(),
    };
    let mut hands: Vec<_> = (certificate.hands.iter())
        .map(|it| HandAtPart {
            hand: named(&it.name),
            rest: it.verdict.into(),
            decay_per_s: it.decay_per_s,
            frequency_hz: it.frequency_hz,
            causes: it.causes.clone(),
        })
        .collect();
    let place = |hand: &HandAtPart| GRIPS.iter().position(|(grip, _)| *grip == hand.hand);
    hands.sort_by_key(|hand| (hand.hand == "nobody", place(hand)));
    Ok(Some(PartAtSteepest {
        part: part.to_owned(),
        stiffness_n_m_per_rad: stiffness,
        cell_rad: Some([at, at]),
        every_rad: None,
        rest: worst(&hands),
        hands,
    }))
}

fn not_covered(around: &Environment, found: &[PartAtSteepest]) -> Vec<String> {
    let mut list = vec![
        "corners between cells, and a swing through several cells: scorecard --feel plays them"
            .to_owned(),
    ];
    let is_wall = |part: &&PartAtSteepest| part.cell_rad.is_some_and(|[from, to]| from == to);
    let walls = found.iter().filter(is_wall).count();
    if walls > 0 && found.len() > walls {
        list.push("a wall and another part at one angle".to_owned());
    }
    if around.feel().click.is_some() {
        list.push("clicks: pulses without a slope; the energy guard counts them".to_owned());
    }
    if found
        .iter()
        .any(|it| it.part == "together" && it.cell_rad.is_none())
    {
        list.push("where the parts meet: `together` adds the steepest slopes of all".to_owned());
    }
    list.push(
        "hands outside the three grips; the energy guard, which only makes a part softer"
            .to_owned(),
    );
    list
}
