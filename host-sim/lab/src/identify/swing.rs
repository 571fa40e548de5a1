//! Identifies inertia, viscous damping and dry friction from swings: the device is pushed, released, and coasts to rest.
//!
//! The coast separates damping from friction: in `J dv/dt = -b v - F_k sign(v)` the damping `b` dominates at high speed `v`, the
//! friction `F_k` at low speed. The pushes give the scale of the inertia `J`, because their torque is known. The fit compares whole
//! motions, computed by the closed-form plant model, with the recorded counts. No measured value is differentiated, which would add
//! noise.

use nalgebra::{DMatrix, DVector, Vector3};
use touchstone_sim::error::Result;
use touchstone_sim::run::plan;
use touchstone_sim::scene::Scene;
use touchstone_world::plant::{BareCoulomb, Coulomb, Device, Kinematics as _, State, Stepper as _};

/// Commanded torque and measured angle of one swing (push and coast), one entry per control period.
#[derive(Debug, Clone, Default)]
pub struct Swing {
    /// Torque from each sample to the next, N·m.
    pub torque_n_m: Vec<f64>,
    /// Angle as read from the encoder, rad.
    pub angle_rad: Vec<f64>,
}

/// How the device is pushed: torque, angles and times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swings {
    /// Torque of a push, N·m; above the device's friction and below its torque limit.
    pub torque_n_m: f64,
    /// Angles over which the pushes act, rad. Each angle gives one speed, in both directions.
    pub pushes_rad: [f64; 3],
    /// Longest push, s. A device that has not turned far enough by then is held, or pushed too weakly.
    pub longest_push_s: f64,
    /// Time for the coast after each push, s. A device that still moves then is stopped before the next push.
    pub coast_s: f64,
}

impl Default for Swings {
    fn default() -> Self {
        Self {
            torque_n_m: 0.05,
            pushes_rad: [0.05, 0.2, 0.6],
            longest_push_s: 0.5,
            coast_s: 2.0,
        }
    }
}

/// An estimated value with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The estimated value.
    pub value: f64,
    /// Standard uncertainty. In [`Mechanics`] it is the largest of the fit's own uncertainty, the spread between pushes of
    /// different length, and the uncertainty of the mean torque.
    pub uncertainty: f64,
}

/// Identified properties of a device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mechanics {
    /// Inertia of the device, kg·m².
    pub inertia_kg_m2: Estimate,
    /// Viscous damping of the device, N·m·s/rad.
    pub damping_n_m_s_per_rad: Estimate,
    /// Dry friction of the device while sliding, N·m.
    pub friction_n_m: Estimate,
    /// Root mean square difference between predicted and measured angles, rad. If it exceeds a few encoder counts, the device has
    /// properties besides inertia, damping and friction.
    pub residual_rms_rad: f64,
}

/// Reason why the device was not identified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NotFound {
    /// A push did not turn the device far enough.
    #[error(
        "a push of {torque_n_m} N·m did not turn the device by {wanted_rad} rad within {within_s} s"
    )]
    DidNotMove {
        /// Torque of the push, N·m.
        torque_n_m: f64,
        /// Angle by which the push should have turned the device, rad.
        wanted_rad: f64,
        /// Time that was available for the push, s.
        within_s: f64,
    },
    /// The fit failed or leaves too large a residual.
    #[error(
        "no inertia, damping and friction explain the motion: {residual_rad:.2e} rad rms remain"
    )]
    NoFit {
        /// Root mean square difference between predicted and measured angles, rad.
        residual_rad: f64,
    },
}

/// Simulates swings (pushes with coasts) of the scene's device without a hand, measured by the scene's encoder.
///
/// # Errors
/// The plant cannot be built. The inner error is a push that did not turn the device.
pub fn swing(scene: &Scene, swings: &Swings) -> Result<std::result::Result<Vec<Swing>, NotFound>> {
    let period_s = scene.timing.period_s();
    let mut device = plan::device(scene);
    device.friction.get_or_insert(Coulomb {
        kinetic: 0.0,
        breakaway: 0.0,
    });
    let plant = BareCoulomb::new(&device, period_s)
        .map_err(|invalid| scene.error("device", invalid.to_string(), "correct it in the scene"))?;
    let read = |angle: f64| match &scene.encoder {
        Some(encoder) => (angle / encoder.step_rad()).round() * encoder.step_rad(),
        None => angle,
    };
    let limit = scene.device.torque_limit_n_m.unwrap_or(f64::INFINITY);
    let torque = swings.torque_n_m.min(limit);
    let mut state = State::<2>::at_rest(0.0);
    let mut done = Vec::new();
    for (sign, push) in [1.0, -1.0]
        .into_iter()
        .flat_map(|sign| swings.pushes_rad.map(|push| (sign, push)))
    {
        let mut swing = Swing::default();
        let start = read(state.position());
        let longest = (swings.longest_push_s / period_s).ceil() as usize;
        while (read(state.position()) - start).abs() < push {
            if swing.angle_rad.len() >= longest {
                return Ok(Err(NotFound::DidNotMove {
                    torque_n_m: torque,
                    wanted_rad: push,
                    within_s: swings.longest_push_s,
                }));
            }
            tick(&plant, &mut state, sign * torque, read, &mut swing);
        }
        for _ in 0..(swings.coast_s / period_s).ceil() as usize {
            tick(&plant, &mut state, 0.0, read, &mut swing);
        }
        done.push(swing);
        // A hand would stop the device here; the next swing starts from rest.
        state = State::at_rest(state.position());
    }
    Ok(Ok(done))
}

fn tick(
    plant: &BareCoulomb,
    state: &mut State<2>,
    torque: f64,
    read: impl Fn(f64) -> f64,
    swing: &mut Swing,
) {
    swing.torque_n_m.push(torque);
    swing.angle_rad.push(read(state.position()));
    plant.step(state, torque, 0.0);
}

/// Predicts the angles of a device with these parameters in a swing from rest, and subtracts their mean. The commanded torque is
/// multiplied by `torques`. `None` if the parameters are not valid.
fn predicted(
    parameters: &DVector<f64>,
    swing: &Swing,
    torques: f64,
    period_s: f64,
) -> Option<Vec<f64>> {
    let device = Device {
        inertia: parameters[0],
        damping: parameters[1],
        friction: Some(Coulomb {
            kinetic: parameters[2],
            breakaway: parameters[2],
        }),
    };
    let plant = BareCoulomb::new(&device, period_s).ok()?;
    let mut state = State::<2>::at_rest(0.0);
    let mut angles = Vec::with_capacity(swing.torque_n_m.len());
    for torque in &swing.torque_n_m {
        angles.push(state.position());
        plant.step(&mut state, torques * torque, 0.0);
    }
    centre(&mut angles);
    Some(angles)
}

/// Subtracts the mean from the angles. It is used for measured and predicted angles alike, because the start within the first
/// encoder count is unknown.
fn centre(angles: &mut [f64]) {
    let mean = angles.iter().sum::<f64>() / angles.len().max(1) as f64;
    angles.iter_mut().for_each(|angle| *angle -= mean);
}

/// Result of a fit by Gauss–Newton steps. A step that makes the fit worse is halved.
struct Fit {
    parameters: Vector3<f64>,
    /// Variances of inertia, damping and friction.
    variance: Vector3<f64>,
    residual_rms: f64,
    /// Root mean square deviation of the torques from the commanded ones, as a fraction.
    torques_apart: f64,
}

/// Fits inertia, damping and friction. If the torques are uncertain, it also fits a factor on each swing's torque; the mean of
/// the factors is 1. The mean torque of the pushes thus sets the scale of the inertia. Differences between the pushes do not
/// distort the coasts, which alone separate damping from friction.
fn fit(swings: &[Swing], period_s: f64, start: Vector3<f64>, torques: Torques) -> Option<Fit> {
    let measured: Vec<Vec<f64>> = swings
        .iter()
        .map(|swing| {
            let mut angles = swing.angle_rad.clone();
            centre(&mut angles);
            angles
        })
        .collect();
    let own = match torques {
        Torques::Exact => 0,
        Torques::Unsure => swings.len().saturating_sub(1),
    };
    let residuals = |parameters: &DVector<f64>| -> Option<Vec<f64>> {
        let mut all = Vec::new();
        for (index, (swing, measured)) in swings.iter().zip(&measured).enumerate() {
            let model = predicted(parameters, swing, times(parameters, index), period_s)?;
            all.extend(measured.iter().zip(model).map(|(y, x)| y - x));
        }
        Some(all)
    };
    let cost = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
    let whole = |three: Vector3<f64>, rest: f64| {
        DVector::from_fn(3 + own, |i, _| if i < 3 { three[i] } else { rest })
    };
    let smallest = whole(start * 1e-6, 1.0);
    let least = whole(Vector3::new(start[0] * 1e-3, 0.0, 0.0), 0.0);
    let mut at = whole(start, 1.0);
    let mut r = residuals(&at)?;
    let mut normal = DMatrix::identity(3 + own, 3 + own);
    // Convergence is quadratic near the end; forty steps are far more than any device has needed.
    for _ in 0..40 {
        let scale = at.abs().sup(&smallest);
        let mut columns = Vec::with_capacity(3 + own);
        for index in 0..3 + own {
            let step = 1e-5 * scale[index];
            let mut ahead = at.clone();
            ahead[index] += step;
            let moved = residuals(&ahead)?;
            let slopes = moved
                .iter()
                .zip(&r)
                .map(|(m, r)| (r - m) / step * scale[index]);
            columns.push(slopes.collect::<Vec<_>>());
        }
        // The parameters are scaled to size one, so that kg·m² and N·m have equal weight.
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        normal = DMatrix::from_fn(3 + own, 3 + own, |i, j| product(&columns[i], &columns[j]));
        let gradient = DVector::from_fn(3 + own, |i, _| product(&columns[i], &r));
        let step = (normal.clone().try_inverse()? * gradient).component_mul(&scale);
        let mut share = 1.0;
        let (next, after) = loop {
            let tried = (&at + &step * share).sup(&least);
            let after = residuals(&tried)?;
            if cost(&after) <= cost(&r) || share < 1e-6 {
                break (tried, after);
            }
            share *= 0.5;
        };
        let moved = (&next - &at).component_div(&scale).amax();
        (at, r) = (next, after);
        if moved < 1e-9 || share < 1e-6 || (share == 1.0 && moved < 1e-6) {
            let back = DMatrix::from_diagonal(&scale).try_inverse()?;
            normal = &back * normal * &back;
            break;
        }
    }
    let residual_rms = (cost(&r) / r.len() as f64).sqrt();
    let variance = (normal.try_inverse()? * residual_rms * residual_rms).diagonal();
    let apart = (0..swings.len()).map(|index| (times(&at, index) - 1.0).powi(2));
    Some(Fit {
        torques_apart: (apart.sum::<f64>() / swings.len() as f64).sqrt(),
        parameters: Vector3::new(at[0], at[1], at[2]),
        variance: Vector3::new(variance[0], variance[1], variance[2]),
        residual_rms,
    })
}

/// The factor on the torque of swing `index`, from the parameters of the fit.
fn times(parameters: &DVector<f64>, index: usize) -> f64 {
    let own = parameters.len() - 3;
    match parameters.get(3 + index) {
        Some(times) => *times,
        None if own == 0 => 1.0,
        None => own as f64 + 1.0 - parameters.rows(3, own).sum(),
    }
}

/// How exactly the torques of the swings (pushes) are known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Torques {
    /// The torques are exactly as commanded.
    Exact,
    /// Only the mean torque over all swings is exact; the torque of a single swing may differ by some percent.
    Unsure,
}

/// Fits inertia, damping and friction to swings (pushes with the coasts after them).
///
/// # Errors
/// The fit failed or leaves too large a residual.
pub fn mechanics(
    swings: &[Swing],
    period_s: f64,
    torques: Torques,
) -> std::result::Result<Mechanics, NotFound> {
    let none = NotFound::NoFit {
        residual_rad: f64::NAN,
    };
    let start = guess(swings, period_s).ok_or(none.clone())?;
    let all = fit(swings, period_s, start, torques).ok_or(none.clone())?;
    // Each speed is also fitted alone, with both directions. The difference between speeds shows what the model does not contain.
    let half = swings.len() / 2;
    let parts: Vec<Vector3<f64>> = (0..half)
        .filter_map(|index| {
            let pair = [swings[index].clone(), swings[index + half].clone()];
            fit(&pair, period_s, all.parameters, torques).map(|fit| fit.parameters)
        })
        .collect();
    let estimate = |index: usize| {
        let value = all.parameters[index];
        let count = parts.len() as f64;
        let spread = parts
            .iter()
            .map(|part| (part[index] - value).powi(2))
            .sum::<f64>()
            / (count * (count - 1.0)).max(1.0);
        // The differences between the torques give the uncertainty of their mean, which scales all three parameters.
        let scale = (value * all.torques_apart).powi(2) / swings.len() as f64;
        Estimate {
            value,
            uncertainty: all.variance[index].max(spread).max(scale).sqrt(),
        }
    };
    let furthest = swings
        .iter()
        .flat_map(|swing| &swing.angle_rad)
        .fold(0.0_f64, |most, angle| most.max(angle.abs()));
    // A residual of a twentieth of the whole motion cannot be encoder noise.
    if !all.residual_rms.is_finite() || all.residual_rms > 0.05 * furthest {
        return Err(NotFound::NoFit {
            residual_rad: all.residual_rms,
        });
    }
    Ok(Mechanics {
        inertia_kg_m2: estimate(0),
        damping_n_m_s_per_rad: estimate(1),
        friction_n_m: estimate(2),
        residual_rms_rad: all.residual_rms,
    })
}

/// Start values of the fit. The inertia `J` follows from the angle `x = u t²/(2 J)` of the longest push, with torque `u` and time
/// `t`. Damping takes a tenth of the torque at the push's final speed, friction a twentieth.
fn guess(swings: &[Swing], period_s: f64) -> Option<Vector3<f64>> {
    let (torque, time, way) = swings
        .iter()
        .filter_map(|swing| {
            let ticks = swing.torque_n_m.iter().take_while(|u| **u != 0.0).count();
            let first = *swing.angle_rad.first()?;
            let way = (swing.angle_rad.get(ticks)? - first).abs();
            let torque = swing.torque_n_m.first()?.abs();
            Some((torque, ticks as f64 * period_s, way))
        })
        .max_by(|a, b| a.2.total_cmp(&b.2))?;
    let inertia = torque * time * time / (2.0 * way);
    let speed = 2.0 * way / time;
    inertia
        .is_finite()
        .then(|| Vector3::new(inertia, 0.1 * torque / speed, 0.05 * torque))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(sets: &[&str]) -> Mechanics {
        let scene = Scene::load("thesis-knob")
            .unwrap()
            .with_overrides(sets)
            .unwrap();
        let swings = swing(&scene, &Swings::default()).unwrap().unwrap();
        mechanics(&swings, scene.timing.period_s(), Torques::Exact).unwrap()
    }

    fn within(estimate: Estimate, truth: f64, share: f64, floor: f64) {
        let error = (estimate.value - truth).abs();
        assert!(error <= share * truth + floor, "{estimate:?} for {truth}");
        // The errors are within four standard uncertainties.
        assert!(
            error <= 4.0 * estimate.uncertainty + floor,
            "{estimate:?} for {truth}"
        );
    }

    #[test]
    fn friction_is_told_from_damping() {
        for (sets, inertia, damping, friction) in [
            (&[][..], 1e-4, 4e-4, 3e-4),
            (&["device.friction=none"], 1e-4, 4e-4, 0.0),
            (&["device.friction.kinetic_n_m=5e-3"], 1e-4, 4e-4, 5e-3),
            (&["device.damping_n_m_s_per_rad=2e-3"], 1e-4, 2e-3, 3e-4),
            (&["device.damping_n_m_s_per_rad=0"], 1e-4, 0.0, 3e-4),
            (&["device.inertia_kg_m2=1e-3"], 1e-3, 4e-4, 3e-4),
            (&["encoder.counts_per_rev=4096"], 1e-4, 4e-4, 3e-4),
        ] {
            let found = found(sets);
            within(found.inertia_kg_m2, inertia, 0.01, 0.0);
            within(found.damping_n_m_s_per_rad, damping, 0.02, 2e-6);
            within(found.friction_n_m, friction, 0.02, 1e-6);
        }
    }

    #[test]
    fn more_static_than_sliding_friction_does_not_mislead() {
        let found = found(&[
            "device.friction.kinetic_n_m=1e-3",
            "device.friction.static_n_m=3e-3",
        ]);
        within(found.friction_n_m, 1e-3, 0.02, 1e-6);
        within(found.damping_n_m_s_per_rad, 4e-4, 0.02, 2e-6);
    }

    #[test]
    fn a_device_that_does_not_move_is_said_to() {
        let scene = Scene::load("thesis-knob")
            .unwrap()
            .with_overrides(&["device.friction.kinetic_n_m=0.1"])
            .unwrap();
        let refused = swing(&scene, &Swings::default()).unwrap().unwrap_err();
        assert!(matches!(refused, NotFound::DidNotMove { .. }), "{refused}");
    }

    #[test]
    fn a_lie_about_the_torque_shows_in_the_inertia() {
        // With torques twice as large as the true ones, all parameters double; the fit must show that.
        let scene = Scene::load("thesis-knob").unwrap();
        let mut swings = swing(&scene, &Swings::default()).unwrap().unwrap();
        for swing in &mut swings {
            swing
                .torque_n_m
                .iter_mut()
                .for_each(|torque| *torque *= 2.0);
        }
        let found = mechanics(&swings, scene.timing.period_s(), Torques::Exact).unwrap();
        within(found.inertia_kg_m2, 2e-4, 0.01, 0.0);
        within(found.damping_n_m_s_per_rad, 8e-4, 0.02, 0.0);
    }
}
