//! Compares the state estimator (position and speed from a model of the device) with an independent matrix form, and tests its
//! guarantees.

use std::f64::consts::TAU;
use touchstone_control::estimator::EstimatorState;
use touchstone_control::{Fixed32, Force, Position};
use touchstone_tests::estimator::{DEVICES, amplification, estimator, play, reference};

#[test]
fn float_agrees_with_the_matrices() {
    for device in &DEVICES {
        let (law, mut state) = (estimator::<f64>(device), EstimatorState::default());
        let mut matrices = reference(device);
        play(3_000, 1, |e, f| {
            let sample = law.tick(&mut state, Position(e));
            let (x, d) = matrices.tick(e);
            // Inertia and damping per tick have steps of 2.3e-10 N·m/rad; the tolerance allows for the smallest inertia that is
            // used.
            let tolerance = 1e-9;
            assert!(
                (sample.e.0 - x).abs() < tolerance,
                "{device:?}: {} {x}",
                sample.e.0
            );
            assert!(
                (sample.moved.0 - d).abs() < tolerance,
                "{device:?}: {} {d}",
                sample.moved.0
            );
            law.commanded(&mut state, Force(f));
            matrices.commanded(f);
        });
    }
}

/// Bounds of the estimator's rounding errors: of each state in one control period, and of the outputs. Rounding a coefficient costs
/// 2^-27 of a motion and 2^-31 of a torque; a product is cut at 2^-28. `largest` is the size of the states, `force` that of the
/// commands.
fn rounding(largest: [f64; 3], delay: f64, force: f64) -> ([f64; 3], [f64; 2]) {
    let (weight, torque, part) = (2f64.powi(-27), 2f64.powi(-31), 2f64.powi(-28));
    let [d, g, r] = largest;
    let flow = |time: f64| {
        let of_parts = (time + 0.5 * time * time) * part;
        let of_commands = 4.0 * force * torque;
        [
            weight * (d + g) + of_parts + of_commands,
            weight * (d + g) + (1.0 + time) * part + of_commands,
        ]
    };
    let [x, v] = flow(1.0);
    // Errors of the correction: its weights, and the cut part of the innovation under weights of at most 1, 3/2 and 1.
    let correction = weight * r + 1.5 * part;
    let ahead = flow(delay);
    ([x + correction, v + correction, correction], ahead)
}

#[test]
fn fixed_agrees_with_float_within_what_rounding_adds_up_to() {
    for device in &DEVICES {
        let (exact, mut exact_state) = (estimator::<f64>(device), EstimatorState::default());
        let (fixed, mut fixed_state) = (estimator::<Fixed32>(device), EstimatorState::default());
        let (mut worst, mut largest) = ([0.0_f64; 2], [0.0_f64; 3]);
        let mut last_shown = 0.0;
        play(20_000, 2, |e, f| {
            let a = exact.tick(&mut exact_state, Position(e));
            let b = fixed.tick(&mut fixed_state, Position::from_f64(e));
            worst[0] = worst[0].max((a.e.0 - b.e.to_f64()).abs());
            worst[1] = worst[1].max((a.moved.0 - b.moved.to_f64()).abs());
            let motion = exact_state.motion.unwrap();
            largest[0] = largest[0].max(motion.moved.abs() + 1e-6);
            largest[1] = largest[1].max(motion.pushed.abs() + 1e-6);
            largest[2] = largest[2].max((e - last_shown).abs() + motion.moved.abs() * 2.0);
            last_shown = e;
            exact.commanded(&mut exact_state, Force(f));
            fixed.commanded(&mut fixed_state, Force::from_f64(f));
        });
        let delay = device.4;
        let sums = amplification(&reference(device), delay);
        // An innovation is at most the change of the measured and of the expected position.
        let (into, ahead) = rounding([largest[0], largest[1], 4.0 * largest[2]], delay, 0.5);
        let shown = 2f64.powi(-25);
        for (index, name) in ["position", "displacement"].iter().enumerate() {
            let sum: f64 = (0..3).map(|j| sums[index][j] * into[j]).sum();
            let bound = sum + ahead[index] + shown;
            println!("{device:?} {name}: {:.2e}, bound {bound:.2e}", worst[index]);
            assert!(
                worst[index] <= bound,
                "{device:?} {name}: {} {bound}",
                worst[index]
            );
        }
    }
}

#[test]
fn at_rest_it_is_exact_and_stays_so_for_ten_million_ticks() {
    for (index, device) in DEVICES.iter().enumerate() {
        let ticks = if index == 0 { 10_000_000 } else { 200_000 };
        let (law, mut state) = (estimator::<Fixed32>(device), EstimatorState::default());
        let e = Position::<Fixed32>::from_f64(0.0123);
        // At rest only the cut parts of products and the rounding of the result are left. The first three devices have no error at
        // all.
        let sums = amplification(&reference(device), device.4);
        let (into, ahead) = rounding([0.0; 3], device.4, 0.1);
        let bound = [0, 1].map(|row| {
            let sum: f64 = (0..3).map(|j| sums[row][j] * into[j]).sum();
            if index < 3 {
                0.0
            } else {
                sum + ahead[row] + 2f64.powi(-25)
            }
        });
        // The hand holds the device at rest against a constant force.
        let force = Force::from_f64(0.1);
        let start = Position::from_f64(0.01);
        law.tick(&mut state, start);
        law.commanded(&mut state, force);
        for n in 0..ticks {
            let sample = law.tick(&mut state, e);
            if n > 4_000 {
                let (x, d) = (sample.e.to_f64() - e.to_f64(), sample.moved.to_f64());
                assert!(
                    x.abs() <= bound[0] && d.abs() <= bound[1],
                    "{device:?} {n}: {x} {d}"
                );
            }
            law.commanded(&mut state, force);
        }
    }
}

#[test]
fn all_three_poles_are_where_the_bandwidth_puts_them() {
    for device in &DEVICES {
        let law = estimator::<f64>(device);
        let exact = reference(device);
        for i in 0..3 {
            let (own, other) = (law.correction[i], exact.gains[i]);
            assert!(
                (own - other).abs() < 1e-8,
                "{device:?} gain {i}: {own} {other}"
            );
        }
        // (1 - L C) F with the weights as the format holds them: its characteristic polynomial is (s - z)³.
        let fixed = estimator::<Fixed32>(device);
        let weight = |bits: i32| f64::from(bits) / f64::from(1 << 26);
        let (v, x, loss) = (
            weight(fixed.tick.reach),
            weight(fixed.tick.drift),
            weight(fixed.tick.loss),
        );
        let [a, b, g] = fixed.correction.map(weight);
        let rows = [[1.0, v, x], [0.0, 1.0 - loss, v], [0.0, 0.0, 1.0]];
        let m: [[f64; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| rows[i][j] - [a, b, g][i] * rows[0][j])
        });
        let trace = m[0][0] + m[1][1] + m[2][2];
        let minors = m[0][0] * m[1][1] - m[0][1] * m[1][0] + m[0][0] * m[2][2] - m[0][2] * m[2][0]
            + m[1][1] * m[2][2]
            - m[1][2] * m[2][1];
        let determinant = (1.0 - a) * (1.0 - loss);
        let z = (-TAU * device.1.parse::<f64>().unwrap() / f64::from(device.0)).exp();
        let off = [
            trace - 3.0 * z,
            minors - 3.0 * z * z,
            determinant - z * z * z,
        ];
        assert!(off.iter().all(|x| x.abs() < 3e-7), "{device:?}: {off:?}");
        // Jury's criterion with the stored weights: all roots are inside the unit circle.
        let (c2, c1, c0) = (-trace, minors, -determinant);
        assert!(
            1.0 + c2 + c1 + c0 > 0.0 && 1.0 - c2 + c1 - c0 > 0.0,
            "{device:?}"
        );
        assert!(
            c0.abs() < 1.0 && (c0 * c0 - 1.0).abs() > (c0 * c2 - c1).abs(),
            "{device:?}"
        );
    }
}
