//! Identifies mass, damping and friction of one axis of a haptic device, from recorded forces and positions of an axis in motion.
//!
//! The equation of motion is `M dv/dt + b v + F_c sign(v) + c = F`, with mass `M`, damping `b`, dry friction `F_c`, velocity `v`
//! and commanded force `F`. `c` is a constant force: a weight that is not compensated, or a motor's offset. Each side is multiplied
//! by a bump function `φ` of time, which is zero at its ends, and integrated by parts over the position `x`:
//!
//! ```text
//! M ∫φ'' x  -  b ∫φ' x  +  F_c ∫φ sign(v)  +  c ∫φ  =  ∫φ F
//! ```
//!
//! These are Shinbrot's modulating functions. No measured value is differentiated, and position and speed at the start of a bump
//! are not needed. Every bump gives one equation; all equations are solved by least squares.

use super::Estimate;
use nalgebra::{Matrix4, Vector4};

/// Identified properties of an axis, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisMechanics {
    /// Mass that moves with the axis, kg.
    pub mass_kg: Estimate,
    /// Viscous damping of the axis, N·s/m.
    pub damping_n_s_per_m: Estimate,
    /// Dry friction while the axis moves, N.
    pub friction_n: Estimate,
    /// Constant force, such as a weight that is not compensated, N.
    pub offset_n: Estimate,
    /// Fraction of the force that mass, damping, friction and offset do not explain: rms residual of the equations divided by the
    /// rms of their forces.
    pub unexplained: f64,
}

/// Reason why an axis was not identified.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Unidentified {
    /// The record is too short for the equations; the value is its length in seconds.
    #[error("{0:.2} s of motion are too short")]
    TooShort(f64),
    /// The axis moved too little, or not in a way that separates mass from damping; the value is the travel in millimetres.
    #[error("it moved by only {0:.3} mm, too little to measure mass and damping")]
    Still(f64),
    /// The forces do not explain the motion, for example because a hand holds the device or control periods were missed.
    #[error(
        "its forces do not explain its motion: a mass of {mass_kg:.3} ± {uncertainty_kg:.3} kg"
    )]
    Unexplained {
        /// The mass that fits best, kg.
        mass_kg: f64,
        /// Uncertainty of the mass, kg.
        uncertainty_kg: f64,
    },
}

/// Duration of a bump function (weight over time), s. Motions much slower than a bump cannot be distinguished from a constant
/// force.
const BUMP_S: f64 = 0.4;
/// Number of bump functions, and so of equations, per second of the record.
const BUMPS_PER_S: f64 = 40.0;
/// Time before and after a tick at which positions are compared to find the direction of motion, s.
const AROUND_S: f64 = 3e-3;
/// Least travel that is enough for an identification, in position counts.
const LEAST_COUNTS: f64 = 50.0;

/// Value, first and second derivative over `s` of the bump function `φ = (s (1 - s))³`, for `s` from 0 to 1.
fn bump(s: f64) -> [f64; 3] {
    let (p, d) = (s * (1.0 - s), 1.0 - 2.0 * s);
    [p * p * p, 3.0 * p * p * d, 6.0 * p * (d * d - p)]
}

/// Identifies an axis from the position in m at each tick (control period), and the force in N from each tick to the next.
/// `count_m` is the resolution of the position in m.
///
/// # Errors
/// The record is too short, the axis moved too little, or the forces do not explain the motion.
pub fn mechanics(
    position_m: &[f64],
    force_n: &[f64],
    rate_hz: u32,
    count_m: f64,
) -> Result<AxisMechanics, Unidentified> {
    let tick_s = 1.0 / f64::from(rate_hz);
    let ticks = position_m.len().min(force_n.len());
    let (around, length) = (
        (AROUND_S / tick_s).ceil() as usize,
        (BUMP_S / tick_s).round() as usize,
    );
    let hop = ((1.0 / BUMPS_PER_S) / tick_s).round().max(1.0) as usize;
    if ticks < 2 * around + 2 * length {
        return Err(Unidentified::TooShort(ticks as f64 * tick_s));
    }
    let (least, most) = position_m[..ticks]
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(*x), b.max(*x))
        });
    let still = Unidentified::Still(1e3 * (most - least));
    if most - least < LEAST_COUNTS * count_m {
        return Err(still);
    }
    let direction = |tick: usize| {
        let moved = position_m[tick + around] - position_m[tick - around];
        // A displacement below half a count does not show a direction.
        if moved.abs() < 0.5 * count_m {
            0.0
        } else {
            moved.signum()
        }
    };
    let mut equations: Vec<(Vector4<f64>, f64)> = Vec::new();
    let mut start = around;
    while start + length + around < ticks {
        let (mut row, mut right) = (Vector4::zeros(), 0.0);
        // Positions are relative to the first one of the bump, so that a large absolute position costs no digits.
        let home = position_m[start];
        for i in 0..length {
            let s = i as f64 / length as f64;
            let [value, slope, bend] = bump(s);
            let x = position_m[start + i] - home;
            row += Vector4::new(
                bend * x / (BUMP_S * BUMP_S),
                -slope * x / BUMP_S,
                value * direction(start + i),
                value,
            );
            // A force acts for a whole tick, so the bump is taken in the middle of the tick.
            let middle = bump((i as f64 + 0.5) / length as f64)[0];
            right += middle * force_n[start + i];
        }
        equations.push((row, right));
        start += hop;
    }
    let mut normal = Matrix4::zeros();
    let mut sides = Vector4::zeros();
    for (row, right) in &equations {
        normal += row * row.transpose();
        sides += row * *right;
    }
    // Columns are scaled to equal size, so that their units do not matter for the condition of the matrix.
    let scale = normal
        .diagonal()
        .map(|x| 1.0 / x.max(f64::MIN_POSITIVE).sqrt());
    let scaled = Matrix4::from_fn(|i, j| normal[(i, j)] * scale[i] * scale[j]);
    let inverse = scaled.try_inverse().ok_or(still)?;
    if inverse.amax() > 1e6 {
        return Err(still);
    }
    let found = (inverse * sides.component_mul(&scale)).component_mul(&scale);
    let (mut left, mut all) = (0.0, 0.0);
    for (row, right) in &equations {
        left += (right - row.dot(&found)).powi(2);
        all += right * right;
    }
    // Bumps overlap. Only as many equations are independent as bumps fit side by side into the record.
    let independent = (ticks as f64 / length as f64).max(5.0);
    let variance = left / equations.len() as f64 * (equations.len() as f64 / (independent - 4.0));
    let of = |i: usize| Estimate {
        value: found[i],
        uncertainty: (variance * inverse[(i, i)]).sqrt() * scale[i],
    };
    let mass = of(0);
    // Reject NaN, and a mass that may be zero within two standard uncertainties.
    let told = mass.value - 2.0 * mass.uncertainty;
    if told.is_nan() || told <= 0.0 {
        return Err(Unidentified::Unexplained {
            mass_kg: mass.value,
            uncertainty_kg: mass.uncertainty,
        });
    }
    Ok(AxisMechanics {
        mass_kg: mass,
        damping_n_s_per_m: of(1),
        friction_n: of(2),
        offset_n: of(3),
        unexplained: (left / all.max(f64::MIN_POSITIVE)).sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_world::plant::{
        BareCoulomb, BareLinear, Coulomb, Device, Kinematics, State, Stepper,
    };

    const RATE_HZ: u32 = 4000;
    const COUNT_M: f64 = 1e-5;

    /// Simulated positions and forces of an axis on a soft spring, moved by the sum of three sines. Positions are rounded to
    /// counts.
    fn moved(stepper: &impl Stepper<State = State<2>>, offset_n: f64) -> (Vec<f64>, Vec<f64>) {
        let mut state = State::<2>::at_rest(0.0);
        let (mut positions, mut forces) = (Vec::new(), Vec::new());
        for tick in 0..6 * RATE_HZ {
            let t = f64::from(tick) / f64::from(RATE_HZ) * std::f64::consts::TAU;
            let place = (state.position() / COUNT_M).round() * COUNT_M;
            let pushed = (1.3 * t).sin() + 0.8 * (3.1 * t).sin() + 0.8 * (6.7 * t).sin();
            let force = pushed - 150.0 * place;
            positions.push(place);
            forces.push(force);
            stepper.step(&mut state, force - offset_n, 0.0);
        }
        (positions, forces)
    }

    fn near(what: &str, found: Estimate, truth: f64, share: f64) {
        let off = (found.value - truth).abs();
        assert!(off <= share * truth.abs(), "{what}: {found:?} for {truth}");
        assert!(
            off <= 6.0 * found.uncertainty,
            "{what}: {found:?} claims too much for {truth}"
        );
    }

    #[test]
    fn mass_and_damping_are_found_in_counts() {
        let device = Device {
            inertia: 0.148,
            damping: 2.5,
            friction: None,
        };
        let plant = BareLinear::new(&device, 1.0 / f64::from(RATE_HZ)).expect("plant");
        let (positions, forces) = moved(&plant, 0.4);
        let found = mechanics(&positions, &forces, RATE_HZ, COUNT_M).expect("found");
        println!("{found:?}");
        near("mass", found.mass_kg, 0.148, 0.01);
        near("damping", found.damping_n_s_per_m, 2.5, 0.01);
        near("offset", found.offset_n, 0.4, 0.02);
        assert!(found.friction_n.value.abs() < 0.01);
        assert!(found.unexplained < 0.01);
    }

    #[test]
    fn friction_is_told_from_damping_and_a_lie_about_the_force_shows() {
        let device = Device {
            inertia: 0.2,
            damping: 1.0,
            friction: Some(Coulomb {
                kinetic: 0.2,
                breakaway: 0.2,
            }),
        };
        let plant = BareCoulomb::new(&device, 1.0 / f64::from(RATE_HZ)).expect("plant");
        let (positions, mut forces) = moved(&plant, 0.0);
        let found = mechanics(&positions, &forces, RATE_HZ, COUNT_M).expect("found");
        println!("{found:?}");
        near("mass", found.mass_kg, 0.2, 0.03);
        near("friction", found.friction_n, 0.2, 0.1);
        assert!(
            (found.damping_n_s_per_m.value - 1.0).abs() < 0.15,
            "{found:?}"
        );
        for force in &mut forces {
            *force *= 1.2;
        }
        let wrong = mechanics(&positions, &forces, RATE_HZ, COUNT_M).expect("found");
        assert!((wrong.mass_kg.value / found.mass_kg.value - 1.2).abs() < 1e-6);
    }

    #[test]
    fn a_device_that_does_not_move_is_said_to() {
        let still = vec![0.01; 20_000];
        let found = mechanics(&still, &still, RATE_HZ, COUNT_M);
        assert!(matches!(found, Err(Unidentified::Still(_))), "{found:?}");
        let short = mechanics(&still[..400], &still, RATE_HZ, COUNT_M);
        assert!(matches!(short, Err(Unidentified::TooShort(_))), "{short:?}");
    }

    #[test]
    fn a_motion_that_is_not_of_the_commanded_force_is_refused() {
        let device = Device {
            inertia: 0.148,
            damping: 2.5,
            friction: None,
        };
        let stepper = BareLinear::new(&device, 1.0 / f64::from(RATE_HZ)).expect("plant");
        let (positions, forces) = moved(&stepper, 0.0);
        assert!(mechanics(&positions, &forces, RATE_HZ, COUNT_M).is_ok());
        // These forces did not cause the motion, as if a hand had pushed too.
        let others: Vec<f64> = (0..forces.len())
            .map(|i| (31.0 * i as f64 / f64::from(RATE_HZ)).sin())
            .collect();
        let found = mechanics(&positions, &others, RATE_HZ, COUNT_M);
        assert!(
            matches!(found, Err(Unidentified::Unexplained { .. })),
            "{found:?}"
        );
    }
}
