//! Tests of a knob's inertia, the part of its feel that drags a virtual mass.

use touchstone_control::environment::{FeelSettings, InertiaSettings};
use touchstone_control::{Fixed32, Force, Si};
use touchstone_tests::environment::{COUNT_RAD, at, built, feeling, unguarded};
use touchstone_tests::si::si;

const RATE_HZ: f64 = 1000.0;

fn dragging() -> FeelSettings {
    FeelSettings {
        inertia: Some(InertiaSettings {
            inertia: si("0.00002"),
            bandwidth_hz: si("12"),
        }),
        ..FeelSettings::default()
    }
}

/// Swings a knob with this amplitude, rad, and frequency, Hz. Returns the feel's inertia, kg·m², and damping, N·m·s/rad: the parts
/// of its torque in phase with acceleration and velocity.
fn swung(feel: &FeelSettings, amplitude: f64, hz: f64) -> (f64, f64) {
    let mut environment = feeling::<Fixed32>(feel);
    let omega = std::f64::consts::TAU * hz;
    let ticks = (4.0 * RATE_HZ / hz).round() as i64;
    let (mut of_position, mut of_velocity) = (0.0, 0.0);
    // In the first half the transient of the start decays.
    for tick in 0..2 * ticks {
        let phase = omega * tick as f64 / RATE_HZ;
        let count = (amplitude * phase.sin() / COUNT_RAD).round() as i64;
        let force = environment.tick(&at(count), None).to_f64();
        if tick >= ticks {
            of_position += force * phase.sin();
            of_velocity += force * phase.cos();
        }
    }
    let share = 2.0 / ticks as f64 / amplitude;
    (
        -of_position * share / (omega * omega),
        of_velocity * share / omega,
    )
}

/// Checks that at 1 to 3 Hz the knob is heavier by the set inertia to within 10 %, and that at constant speed nothing holds it.
/// Above its bandwidth the mass is a damper.
#[test]
fn an_inertia_is_felt_in_the_acceleration_alone() {
    let feel = dragging();
    for amplitude in [0.1, 1.0] {
        for hz in [1.0, 2.0, 3.0] {
            let (inertia, damping) = swung(&feel, amplitude, hz);
            assert!((inertia / 2e-5 - 1.0).abs() < 0.1, "{hz} Hz: {inertia}");
            // A mass `J` with the bandwidth `p` (rad/s) also damps: at the angular frequency `w` by `J p w²/(p² + w²)`.
            let omega = std::f64::consts::TAU * hz;
            let pole = std::f64::consts::TAU * 12.0;
            let share = omega * omega / (pole * pole + omega * omega);
            let expected = 2e-5 * pole * share;
            assert!(
                (0.7..1.3).contains(&(damping / expected)),
                "{hz}: {damping}"
            );
        }
    }
    let (_, fast) = swung(&feel, 0.02, 40.0);
    assert!(fast > 0.7 * 2e-5 * 75.4, "{fast}");
    let mut environment = feeling::<Fixed32>(&feel);
    for speed in [40_i64, -250] {
        for tick in 0..400 {
            environment.tick(&at(speed * tick), None);
        }
        for tick in 400..600 {
            let force = environment.tick(&at(speed * tick), None).to_f64();
            assert!(force.abs() < 1e-6, "{force} at constant speed");
        }
        // The mass goes on when the knob stops, and has stopped after a while.
        let first = environment.tick(&at(speed * 599), None).to_f64();
        assert!(first * (speed as f64) < 0.0, "{first} at {speed}");
        for _ in 0..2_000 {
            environment.tick(&at(speed * 599), None);
        }
        assert_eq!(environment.tick(&at(speed * 599), None), Force::zero());
    }
}

/// Checks a free knob of inertia `J` with the heaviest mass `m` that is accepted. Turned by a swinging torque, it moves as a knob
/// of the inertia `J + m`. At rest it stays within two counts, and the hand gets no more than the guard allows.
#[test]
fn a_free_knob_is_heavier_and_rests() {
    const STEPS: u32 = 20;
    let mut settings = unguarded();
    settings.guard.on = true;
    let mut inertia = InertiaSettings {
        inertia: Si::ZERO,
        bandwidth_hz: si("12"),
    };
    inertia.inertia = inertia.heaviest(&settings, Si::ZERO);
    let feel = FeelSettings {
        inertia: Some(inertia),
        ..FeelSettings::default()
    };
    let heavier: f64 = inertia.inertia.to_num();
    let own: f64 = settings.estimator.inertia.to_num();
    let damping: f64 = settings.guard.damping.to_num();
    let step_s = 1.0 / RATE_HZ / f64::from(STEPS);
    for hz in [1.0, 2.0, 3.0] {
        let mut environment = built::<Fixed32>(&settings, &[], None)
            .with_feel(&feel, &settings)
            .unwrap();
        let omega = std::f64::consts::TAU * hz;
        let torque = 0.5 * (own + heavier) * omega * omega;
        let (mut angle, mut velocity, mut force, mut next) = (0.0_f64, 0.0_f64, 0.0, 0.0);
        let (mut work, mut least) = (0.0_f64, 0.0_f64);
        let (mut sums, mut range) = ([0.0; 2], [f64::INFINITY, f64::NEG_INFINITY]);
        // Eight swings, of which the second half is measured; then four seconds without a torque.
        let swings = (8.0 * RATE_HZ / hz) as u32;
        let rest = swings + 4 * RATE_HZ as u32;
        for tick in 0..rest {
            let count = (angle / COUNT_RAD).round() as i64;
            // The force that was calculated a tick ago.
            (force, next) = (next, environment.tick(&at(count), None).to_f64());
            for step in 0..STEPS {
                let time = (f64::from(tick) + f64::from(step) / f64::from(STEPS)) / RATE_HZ;
                let hand = if tick < swings {
                    torque * (omega * time).sin()
                } else {
                    -0.002 * velocity
                };
                velocity += (hand - force - damping * velocity) / own * step_s;
                angle += velocity * step_s;
                work += hand * velocity * step_s;
                if (swings / 2..swings).contains(&tick) {
                    // Components of the knob's velocity: in phase with the torque, and a quarter of a period later.
                    sums[0] += velocity * (omega * time).sin() * step_s;
                    sums[1] -= velocity * (omega * time).cos() * step_s;
                }
            }
            least = least.min(work);
            if tick > rest - 1000 {
                range = [range[0].min(angle), range[1].max(angle)];
            }
        }
        let seconds = f64::from(swings / 2) / RATE_HZ;
        let [a, b] = sums.map(|it| 2.0 * it / seconds / torque);
        // Velocity over torque is 1/(b + jwJ).
        let told = b / (a * a + b * b) / omega - own;
        assert!(
            (told / heavier - 1.0).abs() < 0.1,
            "{hz} Hz: {told} of {heavier}"
        );
        assert!(range[1] - range[0] <= 2.0 * COUNT_RAD, "{hz} Hz: {range:?}");
        let allowed: f64 = settings.guard.capacity.to_num();
        assert!(-least <= allowed, "{least} J");
        let _ = force;
    }
}
