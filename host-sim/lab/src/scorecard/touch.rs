//! Compares a light touch of a wall with a touch of an ideal wall: how deep it goes, and how fast the torque rises.
//!
//! Hand and device limit how fast even an ideal wall can stop a moving device. A touch is therefore compared with that of the
//! same hand on the same device at an ideal wall. The ideal wall has the requested stiffness `k_de`, a damping ratio of
//! [`DAMPING_RATIO`], exact states, 50 kHz, no delay and no torque limit.
//!
//! Rate-hardness (slope of the torque over the speed) underrates damping, whose torque is there at once and then falls. It is
//! therefore divided by `k_de`, which is the rate-hardness of an undamped spring. Extended rate-hardness favours damping, so the
//! results of an undamped spring are given as well.

use super::cases::{Deed, GRIPS, Programme};
use super::measure::Beside;
use super::touch_ratios::TouchRatios;
use super::watch::watch;
use touchstone_control::choices::{LawKind, StatesKind, VelocityKind};
use touchstone_sim::error::Result;
use touchstone_sim::scene::{Grip, MotionSpec, Number, Preset, Scene};

/// Damping of the ideal wall, divided by the critical damping of the device on a spring of the requested stiffness.
pub const DAMPING_RATIO: f64 = 0.5;
/// Rate at which the ideal wall is simulated, Hz.
const RATE_HZ: u32 = 50_000;
/// Longest duration of a simulated touch of an ideal wall, s; the touch is deepest in the first oscillation.
const LONGEST_S: f64 = 0.4;

/// Measures of touches of the ideal damped wall by the hands of [`GRIPS`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IdealTouch {
    touches: [Beside; GRIPS.len()],
    k_desired: f64,
}

impl IdealTouch {
    /// Simulates touches of the ideal wall on a scene's device.
    ///
    /// # Errors
    /// The device cannot be simulated.
    pub fn of(scene: &Scene, programme: &Programme) -> Result<Self> {
        let mut touches = [Beside::default(); GRIPS.len()];
        for (touch, grip) in touches.iter_mut().zip(GRIPS) {
            *touch = ideal(scene, programme, grip, DAMPING_RATIO)?;
        }
        Ok(Self {
            touches,
            k_desired: scene.wall.k_desired_n_m_per_rad,
        })
    }

    /// The measures `own` of a touch, divided by those of the ideal wall; `grip` is the index in [`GRIPS`].
    #[must_use]
    pub fn ratios(&self, grip: usize, own: &Beside) -> TouchRatios {
        ratios(own, &self.touches[grip], self.k_desired)
    }

    /// Measures of touches of an ideal wall with another damping ratio, relative to the ideal damped wall. The worst of three
    /// simulated grips (light, medium, firm).
    ///
    /// # Errors
    /// The device cannot be simulated.
    pub fn with_ratio(
        &self,
        scene: &Scene,
        programme: &Programme,
        ratio: f64,
    ) -> Result<TouchRatios> {
        let of = |index: usize| {
            let own = ideal(scene, programme, GRIPS[index], ratio)?;
            Ok(self.ratios(index, &own))
        };
        Ok(of(0)?.worst(&of(1)?).worst(&of(2)?))
    }
}

/// The measures of a touch, divided by those of the ideal wall.
fn ratios(own: &Beside, ideal: &Beside, k_desired: f64) -> TouchRatios {
    let over = |own: Option<f64>, ideal: Option<f64>| {
        let ratio = own? / ideal?;
        ratio.is_finite().then_some(ratio)
    };
    TouchRatios {
        penetration: own.touch_penetration_ratio / ideal.touch_penetration_ratio,
        rate_hardness: over(own.rate_hardness, Some(k_desired)),
        extended_rate_hardness: over(own.extended_rate_hardness, ideal.extended_rate_hardness),
        torque: over(own.touch_torque_n_m, ideal.touch_torque_n_m),
    }
}

/// Simulates the touch of an ideal wall with this damping ratio.
fn ideal(scene: &Scene, programme: &Programme, grip: Grip, ratio: f64) -> Result<Beside> {
    let mut wall = scene
        .with_preset(Preset::Thesis)
        .unwrap_or_else(|_| scene.clone());
    let device = &mut wall.device;
    device.torque_limit_n_m = None;
    device.amplifier_step_n_m = None;
    device.cogging = None;
    device.imbalance = None;
    device.current_sensor = None;
    device.current_loop = None;
    device.transmission = None;
    wall.encoder = None;
    wall.sensor = Default::default();
    wall.plant = None;
    wall.environment = None;
    wall.timing.rate_hz = RATE_HZ;
    wall.timing.computational_delay_s = 0.0;
    wall.timing.jitter_s = None;
    wall.timing.latency_spread_s = None;
    wall.timing.lost_share = None;
    let critical = 2.0 * (wall.wall.k_desired_n_m_per_rad * device.inertia_kg_m2).sqrt();
    let law = &mut wall.law;
    law.kind = LawKind::SpringDamper;
    law.states = StatesKind::Measured;
    law.velocity.from = VelocityKind::Told;
    law.virtual_damping_n_m_s_per_rad = ratio * critical;
    law.number = Number::F64;
    law.impact.share_of_momentum = 0.0;
    law.guard.on = false;
    let mut pressed = programme.scene(&wall, grip, Deed::Press);
    if let MotionSpec::TouchAndPress(press) = &mut pressed.operator.motion {
        press.touch_s = press.touch_s.min(LONGEST_S);
        // The press that follows the touch is not simulated.
        pressed.timing.duration_s = press.start_s + press.touch_ramp_s + press.touch_s;
    }
    Ok(watch(&pressed, Deed::Press, false)?.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scorecard::rivals::Rival;

    fn knob(k_desired: f64) -> Scene {
        let mut scene = Scene::load("thesis-knob").expect("a shipped scene");
        scene.wall.k_desired_n_m_per_rad = k_desired;
        scene
    }

    #[test]
    fn the_ideal_wall_shows_what_it_is_made_of() {
        for k_desired in [5.0, 14.0] {
            let scene = knob(k_desired);
            let programme = Programme::of(&scene);
            for grip in GRIPS {
                let spring = ideal(&scene, &programme, grip, 0.0).expect("runs");
                // A spring's rate-hardness is k_de, also over a millisecond.
                assert!((spring.rate_hardness.unwrap() / k_desired - 1.0).abs() < 1e-2);
                let extended = spring.extended_rate_hardness.unwrap() / k_desired;
                assert!((0.8..=1.01).contains(&extended), "{extended}");
                // The force of damping acts at once. Over a millisecond the slope is B/1 ms, less the part that the falling speed
                // takes away.
                let damped = ideal(&scene, &programme, grip, DAMPING_RATIO).expect("runs");
                let b = (k_desired * scene.device.inertia_kg_m2).sqrt();
                let most = k_desired + b / 1e-3;
                let extended = damped.extended_rate_hardness.unwrap() / most;
                assert!((0.6..=1.01).contains(&extended), "{extended}");
                assert!(damped.touch_penetration_ratio < spring.touch_penetration_ratio);
            }
        }
    }

    /// Checks the depths of touches of an undamped spring against those that another program computed, also at 50 kHz.
    #[test]
    fn an_ideal_spring_is_as_deep_as_it_was_found_elsewhere() {
        for (k_desired, expected) in [(14.0, 1.77), (20.0, 2.06)] {
            let scene = knob(k_desired);
            let programme = Programme::of(&scene);
            let touch = ideal(&scene, &programme, Grip::Light, 0.0).expect("runs");
            let found = touch.touch_penetration_ratio;
            assert!(
                (found / expected - 1.0).abs() < 0.01,
                "{k_desired}: {found}"
            );
        }
    }

    #[test]
    fn more_counts_and_a_faster_loop_come_nearer_to_the_ideal_wall() {
        let scene = knob(5.0);
        let programme = Programme::of(&scene);
        let ideal = IdealTouch::of(&scene, &programme).expect("runs");
        let b = (5.0 * scene.device.inertia_kg_m2).sqrt();
        let off = |rate_hz: u32| {
            let mut wall = Rival::named("spring-damper").expect("a law").of(&scene);
            wall.timing.rate_hz = rate_hz;
            wall.encoder = None;
            wall.law.virtual_damping_n_m_s_per_rad = b;
            let pressed = programme.scene(&wall, GRIPS[1], Deed::Press);
            let (_, own) = watch(&pressed, Deed::Press, false).expect("runs");
            let found = ideal.ratios(1, &own);
            let each = [
                Some(found.penetration),
                found.extended_rate_hardness,
                found.torque,
            ];
            each.map(|ratio| (ratio.expect("a touch") - 1.0).abs())
        };
        let (slow, fast) = (off(1000), off(20_000));
        for (slow, fast) in slow.into_iter().zip(fast) {
            assert!(fast < 0.05 && fast < slow, "{fast} {slow}");
        }
    }
}
