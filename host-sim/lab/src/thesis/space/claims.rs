//! Compares the thesis' statements on its experiments in three degrees of freedom (§5.2) with the simulation.
//!
//! A statement that the simulation does not reproduce is reported as not reproduced, with the measured values.

use super::record::Record;
use super::stepwise::wall;
use super::tuned::{self, DirectionCard};
use super::verdict::AT_REST_MM;
use super::{Approach, Cell, Mechanism, Object, Phase, RATE_HZ, SurfaceFeel, place};
use crate::thesis::claims::{Claim, Outcome};
use touchstone_control::{Fixed32, Reported, SettingsError};
use touchstone_world::plant::{BareLinear, Cartesian, Invalid, Kinematics, OMEGA3, OMEGA3_AXIS};

fn outcome(holds: bool) -> Outcome {
    if holds {
        Outcome::Reproduced
    } else {
        Outcome::NotReproduced
    }
}

/// Finds the run with this object, stiffness in N/mm and approach (way to compute the force).
fn of(runs: &[Record], object: Object, k: f64, approach: Approach) -> Option<&Record> {
    runs.iter().find(|run| {
        let cell = &run.cell;
        cell.object == object && cell.k_desired_n_per_mm == k && cell.approach == approach
    })
}

const EXTENSIONS: [Approach; 2] = [Approach::PerAxis, Approach::Magnitude];

/// Checks every claim against the runs of [`super::cells`] and the scorecards of [`super::tuned`]. The critical stiffness (largest
/// stable stiffness of a plain spring) is that of the omega.3.
///
/// # Errors
/// The control law does not accept its settings.
pub fn check(
    mechanism: Mechanism,
    runs: &[Record],
    cards: &[DirectionCard],
) -> Result<Vec<Claim>, SettingsError> {
    let ks = mechanism.stiffnesses_n_per_mm();
    let mut claims = match mechanism {
        Mechanism::Cartesian => vec![critical()?],
        Mechanism::Delta => Vec::new(),
    };
    claims.extend([
        springs(runs, ks),
        bounded(runs, ks),
        horizontal(runs, ks),
        planes(runs, ks[1]),
        sphere_probed(runs, ks[1]),
        sliding(runs, ks[1]),
        jumps(runs, ks[1]),
        audited(runs),
        tuned::claim(mechanism, cards),
    ]);
    Ok(claims)
}

/// Largest stiffness in N/mm at which the oscillation on a plain spring does not grow, by bisection over simulated presses
/// without a hand.
///
/// # Errors
/// The control law does not accept its settings.
pub fn largest_stable_n_per_mm() -> Result<f64, SettingsError> {
    let (mut stable, mut ringing) = (1.0, 20.0);
    while ringing - stable > 0.01 {
        let middle = 0.5 * (stable + ringing);
        if grows(middle)? {
            ringing = middle;
        } else {
            stable = middle;
        }
    }
    Ok(0.5 * (stable + ringing))
}

/// Whether an oscillation of the device without a hand on a spring of `k` N/mm grows. A force of 4 N presses the device into the
/// spring. The device starts at 1.4 times the depth at which it would rest.
fn grows(k: f64) -> Result<bool, SettingsError> {
    const PUSH_N: f64 = 4.0;
    let cell = Cell {
        mechanism: Mechanism::Cartesian,
        object: Object::Horizontal,
        k_desired_n_per_mm: k,
        approach: Approach::Spring,
        feel: SurfaceFeel::default(),
    };
    let mut wall = wall(&cell)?;
    let Ok(plant) = bare() else {
        return Ok(false);
    };
    let rest_mm = -PUSH_N / k;
    let off = 0.4 * rest_mm;
    let mut state = Cartesian::<BareLinear>::at_rest([0.0, 0.0, (rest_mm + off) * 1e-3]);
    let (mut early, mut late) = (0.0_f64, 0.0_f64);
    for tick in 0..10 * RATE_HZ {
        let here = Cartesian::<BareLinear>::position(&state);
        let measured = OMEGA3
            .counts(here)
            .map(|n| f64::from(n) * OMEGA3.count_m * 1e3);
        let force = wall.tick(place(measured)).unwrap_or_default();
        let mut force = OMEGA3.limited(force.0.map(|f| Fixed32::signal_to_f64(f.0)));
        force[2] -= PUSH_N;
        let swing = (state[2].position() * 1e3 - rest_mm).abs();
        if (RATE_HZ / 2..3 * RATE_HZ / 2).contains(&tick) {
            early = early.max(swing);
        } else if tick >= 9 * RATE_HZ {
            late = late.max(swing);
        }
        plant.step(&mut state, force, [0.0; 3]);
    }
    Ok(late > early)
}

fn bare() -> Result<Cartesian<BareLinear>, Invalid> {
    let axis = BareLinear::new(&OMEGA3_AXIS, 1.0 / f64::from(RATE_HZ))?;
    Cartesian::new([axis.clone(), axis.clone(), axis])
}

fn critical() -> Result<Claim, SettingsError> {
    let found = largest_stable_n_per_mm()?;
    Ok(Claim {
        name: "critical-stiffness",
        source: "§5.2",
        statement: "the device's critical stiffness is 5 N/mm",
        outcome: outcome((found / 5.0 - 1.0).abs() <= 0.02),
        measured: format!("a spring rings without a hand from {found:.2} N/mm on (within 2 %)"),
    })
}

fn springs(runs: &[Record], [critical, stiff]: [f64; 2]) -> Claim {
    let ripple = |k| {
        of(runs, Object::Horizontal, k, Approach::Spring)
            .map_or(f64::NAN, |run| run.ripple_mm(run.late(Phase::Hold, 0.5)))
    };
    let (calm, wild) = (ripple(critical), ripple(stiff));
    Claim {
        name: "spring-above-critical",
        source: "Fig. 5.9",
        statement: "for stiffnesses above the critical one the interaction with a spring becomes unstable",
        outcome: outcome(calm < AT_REST_MM && wild > AT_REST_MM),
        measured: format!(
            "ripple in the hold {calm:.4} mm at {critical} N/mm, {wild:.3} mm at {stiff} N/mm"
        ),
    }
}

fn bounded(runs: &[Record], [critical, stiff]: [f64; 2]) -> Claim {
    let (mut worst, mut ripple) = (0.0_f64, 0.0_f64);
    for object in Object::ALL {
        if let Some(run) = of(runs, object, stiff, Approach::Bounding) {
            let late = run.late(Phase::Hold, 0.5);
            worst = worst.max(run.displayed_n_per_mm(late.clone()));
            ripple = ripple.max(run.ripple_mm(late));
        }
    }
    Claim {
        name: "bounding-shows-critical",
        source: "§5.1.4",
        statement: "force bounding is stable, and shows no more than the critical stiffness",
        outcome: outcome(worst < 1.1 * critical && worst > 0.0 && ripple < AT_REST_MM),
        measured: format!("at most {worst:.2} N/mm of {stiff} in the hold, ripple {ripple:.4} mm"),
    }
}

fn horizontal(runs: &[Record], [critical, stiff]: [f64; 2]) -> Claim {
    let mut worst = 0.0_f64;
    for k in [critical, stiff] {
        let pair = EXTENSIONS.map(|approach| of(runs, Object::Horizontal, k, approach));
        let [Some(one), Some(other)] = pair else {
            worst = f64::NAN;
            continue;
        };
        for (a, b) in one.force_n.iter().zip(&other.force_n) {
            for i in 0..3 {
                worst = worst.max((a[i] - b[i]).abs());
            }
        }
    }
    Claim {
        name: "horizontal-equal",
        source: "§5.2.1, Fig. 5.10",
        statement: "on a horizontal plane both extensions are mathematically equivalent",
        outcome: outcome(worst <= 1e-6),
        measured: format!("forces differ by at most {worst:.1e} N in any tick"),
    }
}

fn planes(runs: &[Record], stiff: f64) -> Claim {
    let (mut shown, mut ripple) = (Vec::new(), 0.0_f64);
    for object in [Object::Horizontal, Object::Inclined] {
        for approach in EXTENSIONS {
            if let Some(run) = of(runs, object, stiff, approach) {
                let late = run.late(Phase::Hold, 0.25);
                shown.push((object, approach, run.displayed_n_per_mm(late.clone())));
                ripple = ripple.max(run.ripple_mm(late));
            }
        }
    }
    let near = shown
        .iter()
        .all(|(_, _, k)| (k / stiff - 1.0).abs() <= 0.05);
    let list: Vec<String> = shown
        .iter()
        .map(|(object, approach, k)| format!("{} {} {k:.2}", object.name(), approach.name()))
        .collect();
    Claim {
        name: "planes-shown",
        source: "§5.2.1, §5.2.2, Figs. 5.10 and 5.11",
        statement: "on both planes both extensions are stable and come to the desired stiffness",
        outcome: outcome(near && shown.len() == 4 && ripple < AT_REST_MM),
        measured: format!(
            "N/mm of {stiff} at rest (within 5 %): {}; ripple {ripple:.4} mm",
            list.join(", ")
        ),
    }
}

fn sphere_probed(runs: &[Record], stiff: f64) -> Claim {
    let shown: Vec<f64> = EXTENSIONS
        .into_iter()
        .filter_map(|approach| of(runs, Object::Sphere, stiff, approach))
        .map(|run| run.displayed_n_per_mm(run.late(Phase::Hold, 0.25)))
        .collect();
    let near = shown.iter().all(|k| (k / stiff - 1.0).abs() <= 0.05);
    Claim {
        name: "sphere-probed",
        source: "§5.2.3, Fig. 5.12",
        statement: "both come to the desired stiffness on perpendicular probing of the sphere",
        outcome: outcome(near && shown.len() == 2),
        measured: format!("{shown:.2?} N/mm of {stiff} at rest (per axis, magnitude)"),
    }
}

fn sliding(runs: &[Record], stiff: f64) -> Claim {
    let Some(run) = of(runs, Object::Sphere, stiff, Approach::Magnitude) else {
        return missing("magnitude-slides");
    };
    let slide = run.late(Phase::Slide, 0.9);
    let whole = run.displayed_n_per_mm(slide.clone());
    // Tenths of the slide, to report the worst one beside the mean.
    let part = slide.len() / 10;
    let (mut least, mut most) = (f64::MAX, f64::MIN);
    for i in 0..10 {
        let from = slide.start + i * part;
        let shown = run.displayed_n_per_mm(from..from + part);
        (least, most) = (least.min(shown), most.max(shown));
    }
    Claim {
        name: "magnitude-slides",
        source: "§5.2.3, Fig. 5.12",
        statement: "on the sphere the magnitude shows the desired stiffness even while it slides at 50 mm/s",
        outcome: outcome((whole / stiff - 1.0).abs() <= 0.05),
        measured: format!(
            "{whole:.2} N/mm of {stiff} over a slide of {:.1} mm/s (within 5 %); tenths of it {least:.2} to {most:.2}",
            run.speed_mm_per_s(slide)
        ),
    }
}

fn jumps(runs: &[Record], stiff: f64) -> Claim {
    let pair = EXTENSIONS.map(|approach| of(runs, Object::Sphere, stiff, approach));
    let [Some(axes), Some(magnitude)] = pair else {
        return missing("per-axis-jumps");
    };
    let of = |run: &Record| {
        let slide = run.late(Phase::Slide, 0.95);
        (run.most_tangential(slide.clone()), run.largest_jump(slide))
    };
    let ((tangential, jump), (calm, still)) = (of(axes), of(magnitude));
    Claim {
        name: "per-axis-jumps",
        source: "§5.2.3, Fig. 5.13",
        statement: "sliding on the sphere, the force per axis is not perpendicular, and jumps where a coordinate changes its side; along the normal it does neither",
        outcome: outcome(jump > 0.1 && tangential > 0.1 && calm < 0.02 && still < 0.02),
        measured: format!(
            "tangential over normal force at most {tangential:.3} per axis and {calm:.4} along the normal; largest step of it in a tick {jump:.3} and {still:.4}"
        ),
    }
}

fn audited(runs: &[Record]) -> Claim {
    let worst = runs.iter().map(|run| run.audit_j).fold(0.0, f64::max);
    Claim {
        name: "books-close",
        source: "simulation",
        statement: "the energy of device and hand is accounted for in every run",
        outcome: outcome(worst < 1e-9),
        measured: format!("off by at most {worst:.1e} J"),
    }
}

fn missing(name: &'static str) -> Claim {
    Claim {
        name,
        source: "§5.2.3",
        statement: "not run",
        outcome: Outcome::NotReproduced,
        measured: "its cell was not run".to_owned(),
    }
}
