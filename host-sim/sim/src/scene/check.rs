//! Checks that depend on several fields of a scene at once.

use super::experiment::Scene;
use super::motion::tap;
use super::operator::{FASTEST_MOTION_HZ, Grip, MotionSpec, Recorded};
use super::problem::Problem;
use super::schema::MOTION_KIND;
use super::units::tidy;

/// Finds the first contradiction between fields of a scene. Each single field is already known to lie within its own range.
pub(crate) fn scene(scene: &Scene) -> Option<Problem> {
    friction(scene)
        .or_else(|| shaft(scene))
        .or_else(|| lateness(scene))
        .or_else(|| endstops(scene))
        .or_else(|| detents(scene))
        .or_else(|| profile(scene))
        .or_else(|| detent_list(scene))
        .or_else(|| grip(scene))
        .or_else(|| motion(scene))
        .or_else(|| duration(scene))
}

fn friction(scene: &Scene) -> Option<Problem> {
    let friction = scene.device.friction.as_ref()?;
    let (kinetic, break_away) = (friction.kinetic_n_m, friction.static_n_m());
    (break_away < kinetic).then(|| {
        Problem::new(
            "device.friction.static_n_m",
            format!("must be at least kinetic_n_m, is {break_away} below {kinetic}"),
            format!("write static_n_m = {} or leave it out", tidy(kinetic)),
        )
    })
}

fn endstops(scene: &Scene) -> Option<Problem> {
    let stops = scene.environment.as_ref()?.endstops.as_ref()?;
    (stops.upper_rad <= stops.lower_rad).then(|| {
        Problem::new(
            "environment.endstops.upper_rad",
            format!(
                "must be above lower_rad, but is {} with lower_rad = {}",
                stops.upper_rad, stops.lower_rad
            ),
            "exchange the two values, or change one",
        )
    })
}

fn detents(scene: &Scene) -> Option<Problem> {
    let ring = scene.environment.as_ref()?.detents.as_ref()?;
    within_limit(scene, "environment.detents.strength_n_m", ring.strength_n_m)
}

fn profile(scene: &Scene) -> Option<Problem> {
    let profile = scene.environment.as_ref()?.profile.as_ref()?;
    let length = profile.end_rad - profile.start_rad;
    if profile.per_rev == 0 && !(0.001..=6283.0).contains(&length) {
        return Some(Problem::new(
            "environment.profile.end_rad",
            format!("must be 0.001 to 6283 rad beyond start_rad, is {length} beyond it"),
            "exchange start_rad and end_rad, or change one",
        ));
    }
    within_limit(
        scene,
        "environment.profile.strength_n_m",
        profile.strength_n_m,
    )
}

fn detent_list(scene: &Scene) -> Option<Problem> {
    let list = scene.environment.as_ref()?.detent_list.as_ref()?;
    match list.profile() {
        Err(problem) => Some(problem),
        Ok(drawn) => within_limit(
            scene,
            "environment.detent_list.strengths_n_m",
            drawn.strength_n_m,
        ),
    }
}

/// Reports a strength (largest torque of detents or of a torque profile, N·m) above the force limit of the control law.
fn within_limit(scene: &Scene, path: &'static str, strength: f64) -> Option<Problem> {
    let limit = scene.law.force_limit_n_m;
    // The text of a sent scene cannot raise the device's limit.
    let (whose, or_raise) = match scene.origin.is_sent {
        true => ("the device's ", ""),
        false => ("", ", or raise law.force_limit_n_m"),
    };
    (strength > limit).then(|| {
        Problem::new(
            path,
            format!("{strength} is more than {whose}law.force_limit_n_m = {limit}"),
            format!("give at most {}{or_raise}", tidy(limit)),
        )
    })
}

fn shaft(scene: &Scene) -> Option<Problem> {
    let friction = scene.device.friction.as_ref()?;
    if friction.bristle_stiffness_n_m_per_rad.is_some() && friction.kinetic_n_m == 0.0 {
        let problem = "bristles without friction in motion never let go";
        let fix = "give kinetic_n_m above 0, or leave out the bristles";
        return Some(Problem::new(
            "device.friction.bristle_stiffness_n_m_per_rad",
            problem,
            fix,
        ));
    }
    let asymmetry = friction.asymmetry_n_m.unwrap_or(0.0).abs();
    let drives = if friction.bristle_stiffness_n_m_per_rad.is_some() {
        asymmetry >= friction.kinetic_n_m
    } else {
        asymmetry > friction.kinetic_n_m
    };
    drives.then(|| {
        Problem::new(
            "device.friction.asymmetry_n_m",
            format!(
                "{asymmetry} leaves nothing of kinetic_n_m = {} in one direction",
                friction.kinetic_n_m
            ),
            "give less than kinetic_n_m",
        )
    })
}

fn lateness(scene: &Scene) -> Option<Problem> {
    let timing = &scene.timing;
    let (jitter, period) = (timing.jitter_s.unwrap_or(0.0), timing.period_s());
    if jitter > period {
        return Some(Problem::new(
            "timing.jitter_s",
            format!("must be at most the period of {period} s, is {jitter}"),
            "give a smaller value; for control periods that are left out, use lost_share",
        ));
    }
    let operator = &scene.operator;
    let unsteady = [
        ("operator.tremor", operator.tremor.is_some()),
        ("operator.reflex", operator.reflex.is_some()),
    ];
    let (table, _) = unsteady.into_iter().find(|(_, named)| *named)?;
    operator.hand().is_none().then(|| {
        Problem::new(
            table,
            "no hand holds the device",
            "give operator.grip = \"medium\", or leave the table out",
        )
    })
}

fn grip(scene: &Scene) -> Option<Problem> {
    let operator = &scene.operator;
    match (operator.grip, &operator.hand) {
        (Grip::Custom, None) => {
            let fix = "add a table [operator.hand], or give light, medium or firm";
            Some(Problem::new(
                "operator.grip",
                "a custom grip needs the hand's values",
                fix,
            ))
        }
        (Grip::Custom, Some(_)) | (_, None) => None,
        (grip, Some(_)) => {
            let problem = format!(
                "the grip {} contradicts the table [operator.hand]",
                grip.name()
            );
            Some(Problem::new(
                "operator.grip",
                problem,
                "remove one of the two",
            ))
        }
    }
}

fn motion(scene: &Scene) -> Option<Problem> {
    let motion = &scene.operator.motion;
    if scene.operator.hand().is_none() && *motion != MotionSpec::None {
        let problem = format!(
            "no hand holds the device, so there is no hand for the motion {}",
            motion.name()
        );
        return Some(Problem::new(
            MOTION_KIND,
            problem,
            "give operator.grip = \"medium\", or the motion none",
        ));
    }
    match motion {
        MotionSpec::Tap(tap) => {
            let frequency = 1.0 / tap::length_s(tap);
            (frequency > FASTEST_MOTION_HZ).then(|| {
                // The tap's frequency is proportional to velocity over approach. The advised approach is rounded up to 0.001 rad.
                let approach = (tap.approach_rad * frequency / FASTEST_MOTION_HZ * 1e3).ceil() / 1e3;
                Problem::new(
                    "operator.motion.velocity_rad_per_s",
                    format!(
                        "{} rad/s from {} rad outside is a tap of {frequency:.1} Hz, but a hand moves at most at {FASTEST_MOTION_HZ} Hz",
                        tap.velocity_rad_per_s, tap.approach_rad
                    ),
                    format!("lower it, or give approach_rad = {} or more", tidy(approach)),
                )
            })
        }
        MotionSpec::Recorded(recorded) => recording(recorded),
        MotionSpec::None
        | MotionSpec::RampAndHold(_)
        | MotionSpec::PressWiggleRelease(_)
        | MotionSpec::TouchAndPress(_)
        | MotionSpec::Turn(_) => None,
    }
}

fn recording(recorded: &Recorded) -> Option<Problem> {
    if !recorded.file.exists() || recorded.file.is_dir() {
        return Some(Problem::new(
            "operator.motion.file",
            format!("no file {}", recorded.file.display()),
            "give the path of a CSV file, relative to the scene's folder",
        ));
    }
    let moved = recorded.scale != 1.0 || recorded.offset_rad != 0.0;
    (recorded.exact && moved).then(|| {
        Problem::new(
            "operator.motion.exact",
            "plays the recording unchanged, but scale or offset_rad would change it",
            "give scale = 1 and offset_rad = 0, or exact = false",
        )
    })
}

fn duration(scene: &Scene) -> Option<Problem> {
    let end = match &scene.operator.motion {
        // The release may be cut off by the end of the run: only the measures of the release need it.
        motion @ (MotionSpec::RampAndHold(_)
        | MotionSpec::PressWiggleRelease(_)
        | MotionSpec::TouchAndPress(_)) => motion.hold_window_s()?.1,
        MotionSpec::Tap(tap) => tap.start_s + tap::length_s(tap),
        // The turn back may be cut off by the end of the run.
        MotionSpec::Turn(turn) => turn.start_s + turn.turn_s + turn.stay_s,
        MotionSpec::None | MotionSpec::Recorded(_) => return None,
    };
    let end = (end * 1e6).round() / 1e6;
    (scene.timing.duration_s < end).then(|| {
        Problem::new(
            "timing.duration_s",
            format!(
                "{} s is too short for the motion, which needs {end} s",
                scene.timing.duration_s
            ),
            format!(
                "give duration_s = {} or more, or shorten the motion",
                tidy((end * 1e3).ceil() / 1e3)
            ),
        )
    })
}
