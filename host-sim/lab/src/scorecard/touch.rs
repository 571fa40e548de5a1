//! A light touch beside that of an ideal wall: how deep it goes, and how hard it begins.
//!
//! What a wall can do about a blow is bounded by the hand and the device alone. So a touch is held against the same hand's on the same
//! device at an ideal wall: `k_de` with a damping ratio of [`DAMPING_RATIO`], exact states, 50 kHz, no delay, no torque limit. A slope is unfair to
//! damping, whose force is there at once and falls, so rate-hardness is taken over `k_de`, which an undamped spring has. Extended rate-hardness is kind
//! to damping. So the undamped spring stands beside.

use super::cases::{Deed, GRIPS, Programme};
use super::measure::Beside;
use super::watch::watch;
use serde::Serialize;
use touchstone_control::choices::{LawKind, StatesKind, VelocityKind};
use touchstone_sim::error::Result;
use touchstone_sim::scene::{Grip, MotionSpec, Number, Preset, Scene};

/// Damping of the ideal wall over the critical damping of the device on `k_de`.
pub const DAMPING_RATIO: f64 = 0.5;
/// Rate of the ideal wall, Hz.
const RATE_HZ: u32 = 50_000;
/// Longest touch of an ideal wall, s: it is deepest in the first swing.
const LONGEST_S: f64 = 0.4;

/// Depth of a touch over that of the ideal damped wall, and how hard it begins over how hard that does. The worst of several hands.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TouchRatios {
    /// Deepest penetration; less is better.
    pub penetration: f64,
    /// Rate-hardness (1.5), over `k_de`: of a damped wall it may be negative. More is better, as below.
    pub rate_hardness: Option<f64>,
    /// Extended rate-hardness.
    pub extended_rate_hardness: Option<f64>,
    /// Largest torque in the first five milliseconds.
    pub torque: Option<f64>,
}

impl TouchRatios {
    fn new(own: &Beside, ideal: &Beside, k_desired: f64) -> Self {
        let over = |own: Option<f64>, ideal: Option<f64>| {
            let ratio = own? / ideal?;
            ratio.is_finite().then_some(ratio)
        };
        Self {
            penetration: own.touch_penetration_ratio / ideal.touch_penetration_ratio,
            rate_hardness: over(own.rate_hardness, Some(k_desired)),
            extended_rate_hardness: over(own.extended_rate_hardness, ideal.extended_rate_hardness),
            torque: over(own.touch_torque_n_m, ideal.touch_torque_n_m),
        }
    }

    /// The worst of each.
    #[must_use]
    pub fn worst(&self, other: &Self) -> Self {
        let less = |one: Option<f64>, other: Option<f64>| Some(one?.min(other?));
        Self {
            penetration: self.penetration.max(other.penetration),
            rate_hardness: less(self.rate_hardness, other.rate_hardness),
            extended_rate_hardness: less(self.extended_rate_hardness, other.extended_rate_hardness),
            torque: less(self.torque, other.torque),
        }
    }
}

/// The ideal damped wall's touch, for each of [`GRIPS`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IdealTouch {
    touches: [Beside; GRIPS.len()],
    k_desired: f64,
}

impl IdealTouch {
    /// The touch for the device of a scene.
    ///
    /// # Errors
    /// A device that no run can be made of.
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

    /// A touch in one of [`GRIPS`] over the ideal one.
    #[must_use]
    pub fn ratios(&self, grip: usize, own: &Beside) -> TouchRatios {
        TouchRatios::new(own, &self.touches[grip], self.k_desired)
    }

    /// The ideal walls themselves: with a damping ratio, over the damped one. The worst of three grips.
    ///
    /// # Errors
    /// A device that no run can be made of.
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

/// The touch of an ideal wall with a damping ratio.
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
    law.guard.on = false;
    let mut pressed = programme.scene(&wall, grip, Deed::Press);
    if let MotionSpec::TouchAndPress(press) = &mut pressed.operator.motion {
        press.touch_s = press.touch_s.min(LONGEST_S);
        // The press that follows is not looked at.
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
                // A spring has k_de as its slope, and no more in a millisecond.
                assert!((spring.rate_hardness.unwrap() / k_desired - 1.0).abs() < 1e-2);
                let extended = spring.extended_rate_hardness.unwrap() / k_desired;
                assert!((0.8..=1.01).contains(&extended), "{extended}");
                // Damping is there at once: over a millisecond B/1 ms, less what the speed has fallen.
                let damped = ideal(&scene, &programme, grip, DAMPING_RATIO).expect("runs");
                let b = (k_desired * scene.device.inertia_kg_m2).sqrt();
                let most = k_desired + b / 1e-3;
                let extended = damped.extended_rate_hardness.unwrap() / most;
                assert!((0.6..=1.01).contains(&extended), "{extended}");
                assert!(damped.touch_penetration_ratio < spring.touch_penetration_ratio);
            }
        }
    }

    /// The undamped spring's depths, as they were found before with another program, at 50 kHz too.
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
