//! Taps of the shipped wall with and without the pulse at the touch (`law.impact`), beside an ideal damped wall. The test prints
//! the table of docs/tuning.md: `cargo test -p touchstone-tests pulse_at_the_touch:: -- --nocapture`.

use touchstone_sim::run;
use touchstone_sim::scene::Scene;

/// Stiffness of the wall, N·m/rad.
const STIFFNESS: f64 = 14.0;
/// Inertia of the device in the scene `tap`, kg·m².
const INERTIA: f64 = 1e-4;
/// Time after the first push in which depth and speed on the way back are measured, s. Later the hand itself moves the knob.
const FIRST_S: f64 = 0.03;

/// A tap of the wall.
#[derive(Debug, Clone, Copy)]
struct Tap {
    /// Deepest penetration, mrad; 0 if the device stopped before the surface.
    depth: f64,
    /// Largest speed on the way back, rad/s.
    back: f64,
}

/// Simulates a tap by a hand at a speed in rad/s, on a device with a multiple of the inertia. `None` if the wall never pushed.
fn tap(grip: &str, speed: u32, inertia: f64, wall: &[String]) -> Option<Tap> {
    let mut sets = vec![
        format!("wall.k_desired_n_m_per_rad={STIFFNESS}"),
        format!("operator.grip={grip}"),
        format!("operator.motion.velocity_rad_per_s={speed}"),
        format!("device.inertia_kg_m2={}", INERTIA * inertia),
    ];
    sets.extend_from_slice(wall);
    let scene = Scene::load("tap").unwrap().with_overrides(&sets).unwrap();
    let surface = scene.wall.surface_rad;
    let trace = run::run(&scene, true).unwrap().trace.unwrap();
    let first = trace.force_n_m.iter().position(|force| *force > 0.0)?;
    let end = trace.time_s[first] + FIRST_S;
    let mut found = Tap {
        depth: 0.0,
        back: 0.0,
    };
    for index in first..trace.time_s.len() {
        if trace.time_s[index] > end {
            break;
        }
        found.depth = found.depth.max(1e3 * (trace.angle_rad[index] - surface));
        found.back = found.back.max(-trace.velocity_rad_per_s[index]);
    }
    Some(found)
}

/// Taps of the ideal damped wall, of the shipped wall without the pulse, and of the shipped wall.
fn taps(grip: &str, speed: u32, inertia: f64) -> Option<[Tap; 3]> {
    let damping = (STIFFNESS * INERTIA * inertia).sqrt();
    let ideal = [
        "timing.rate_hz=50000".to_owned(),
        "law.kind=spring-damper".to_owned(),
        "law.states=measured".to_owned(),
        "law.velocity.from=told".to_owned(),
        format!("law.virtual_damping_n_m_s_per_rad={damping}"),
        "law.impact.share_of_momentum=0".to_owned(),
        "law.guard.on=false".to_owned(),
        "law.number=f64".to_owned(),
    ];
    let without = ["law.impact.share_of_momentum=0".to_owned()];
    let found = [
        tap(grip, speed, inertia, &ideal)?,
        tap(grip, speed, inertia, &without)?,
        tap(grip, speed, inertia, &[])?,
    ];
    let [ideal, without, shipped] = found.map(|tap| format!("{:.2} | {:.2}", tap.depth, tap.back));
    println!("| {inertia} | {grip} | {speed} | {ideal} | {without} | {shipped} |");
    Some(found)
}

#[test]
fn a_tap_is_shallow_and_bounces_less_than_from_an_ideal_wall() {
    println!(
        "| inertia | grip | rad/s | ideal: mrad | back rad/s | no pulse: mrad | back rad/s | shipped: mrad | back rad/s |"
    );
    let mut judged = 0;
    for grip in ["light", "medium", "firm"] {
        for speed in [1, 3, 6] {
            let Some([ideal, without, shipped]) = taps(grip, speed, 1.0) else {
                continue;
            };
            judged += 1;
            assert!(shipped.back <= ideal.back, "{grip} {speed}");
            // A slow firm hand pushes the knob deeper into the wall after the knob has stopped.
            let most = if (grip, speed) == ("firm", 1) {
                0.6
            } else {
                0.37
            };
            assert!(shipped.depth <= most * without.depth, "{grip} {speed}");
        }
    }
    assert_eq!(judged, 8, "a light hand at 1 rad/s does not reach the wall");
}

/// Checks the pulse on devices with half and double the inertia for which the pulse is set: there the pulse is too strong and too
/// weak. A tap goes at most 1.2 times as deep as without the pulse. With half the inertia the device bounces faster than off the
/// ideal wall.
#[test]
fn an_unknown_inertia_costs_bounce_but_no_depth() {
    let mut bounce: f64 = 0.0;
    for inertia in [0.5, 2.0] {
        for grip in ["light", "medium", "firm"] {
            for speed in [1, 3, 6] {
                let Some([ideal, without, shipped]) = taps(grip, speed, inertia) else {
                    continue;
                };
                assert!(shipped.depth <= 1.2 * without.depth, "{grip} {speed}");
                bounce = bounce.max(shipped.back - ideal.back);
                assert!(
                    inertia < 1.0 || shipped.back <= ideal.back,
                    "{grip} {speed}"
                );
            }
        }
    }
    assert!((1.0..2.0).contains(&bounce), "{bounce} rad/s");
}
