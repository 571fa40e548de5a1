//! The devices of a scorecard (nominal and varied), and the actions of the simulated hand.

use serde::Serialize;
use touchstone_sim::scene::{Grip, MotionSpec, PressWiggleRelease, Scene, TouchAndPress};

/// The three simulated grips of a scorecard. Every measure is the worst over these grips.
pub const GRIPS: [Grip; 3] = [Grip::Light, Grip::Medium, Grip::Firm];

/// How a device of the scorecard differs from the device that the control law assumes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// The device is the nominal one, without a change.
    Nothing,
    /// Factor on the encoder counts per turn.
    Counts(f64),
    /// Factor on the device's inertia.
    Inertia(f64),
    /// Factor on the device's damping.
    Damping(f64),
    /// The delay from a sample until its command acts, in ticks (control periods), in place of the scene's delay.
    Delay(f64),
}

/// A device of the scorecard, on which one set of law settings must work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Name of the device.
    pub name: &'static str,
    /// Change that makes the device differ from the nominal one.
    pub change: Change,
}

const fn case(name: &'static str, change: Change) -> Case {
    Case { name, change }
}

/// The nine devices of a scorecard; the nominal one comes first.
pub const CASES: [Case; 9] = [
    case("nominal", Change::Nothing),
    // 16,384 of 40,000: a magnetic sensor of 14 bits in place of an optical disc.
    case("0.41 of the counts", Change::Counts(0.4096)),
    case("half the inertia", Change::Inertia(0.5)),
    case("double inertia", Change::Inertia(2.0)),
    case("0.1 tick of delay", Change::Delay(0.1)),
    case("0.5 tick of delay", Change::Delay(0.5)),
    case("1 tick of delay", Change::Delay(1.0)),
    case("half the damping", Change::Damping(0.5)),
    case("double damping", Change::Damping(2.0)),
];

/// Stiffness above which a wall need not work on all devices: only on the nominal one, and with up to half a tick of delay.
/// Stiffness is the angle in rad by which the device's oscillation on the wall advances per control period. Sampling limits every
/// wall near 1.
pub const STIFFEST_FOR_ALL: f64 = 0.5;
/// Delay in ticks (control periods) from which on a deeper press is allowed.
pub const LATE_TICKS: f64 = 0.5;

impl Case {
    /// Whether a wall of this stiffness must work on the device. Stiffness is the angle in rad by which the device's oscillation on
    /// the wall advances per control period.
    #[must_use]
    pub fn is_asked(&self, stiffness_per_tick: f64) -> bool {
        let always = match self.change {
            Change::Nothing => true,
            Change::Delay(ticks) => ticks <= 0.5,
            _ => false,
        };
        always || stiffness_per_tick <= STIFFEST_FOR_ALL
    }

    /// Whether the device has at least [`LATE_TICKS`] of delay.
    #[must_use]
    pub fn is_late(&self) -> bool {
        matches!(self.change, Change::Delay(ticks) if ticks >= LATE_TICKS)
    }

    /// The scene with this device. The settings of the control law do not change.
    #[must_use]
    pub fn of(&self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        match self.change {
            Change::Nothing => {}
            Change::Counts(share) => {
                if let Some(encoder) = &mut scene.encoder {
                    encoder.counts_per_rev = (encoder.counts_per_rev * share).round().max(1.0);
                }
            }
            Change::Inertia(times) => scene.device.inertia_kg_m2 *= times,
            Change::Damping(times) => scene.device.damping_n_m_s_per_rad *= times,
            Change::Delay(ticks) => {
                scene.timing.computational_delay_s = ticks * scene.timing.period_s();
            }
        }
        scene
    }
}

/// An action of the simulated hand.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Deed {
    /// The hand touches lightly, presses, holds and lets go.
    Press,
    /// The hand presses, then oscillates with this frequency in Hz around the press.
    Move(f64),
}

/// Largest press as a fraction of the wall's largest torque. An oscillating hand pushes with up to 1.3 times the press, and the
/// wall needs a reserve to stop a touch.
pub const MOST_OF_THE_TORQUE: f64 = 0.6;

/// Amplitude of an oscillating hand's torque, as a fraction of the press.
pub const MOVES_WITH: f64 = 0.3;

/// Largest torque of a wall, N·m: the smaller of the law's force limit and the motor's torque limit.
#[must_use]
pub fn most_torque_n_m(scene: &Scene) -> f64 {
    let motor = scene.device.torque_limit_n_m.unwrap_or(f64::INFINITY);
    motor.min(scene.law.force_limit_n_m)
}

/// The actions of the simulated hand on a device, the same for every device.
#[derive(Debug, Clone, PartialEq)]
pub struct Programme {
    /// Motion of the hand: light touch, press and release.
    pub press: TouchAndPress,
    /// Frequencies at which the hand oscillates, Hz.
    pub frequencies_hz: Vec<f64>,
}

impl Programme {
    /// Chooses the actions for a scene. The press is the scene's own if it has one, with a light touch before it. Oscillations at
    /// 1, 2 and 4 Hz follow.
    ///
    /// A press is at most [`MOST_OF_THE_TORQUE`] of the wall's largest torque; the touch is reduced in proportion.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let mut press = match &scene.operator.motion {
            MotionSpec::TouchAndPress(press) => press.clone(),
            MotionSpec::RampAndHold(press) => pressing(press.push_torque_n_m, press.approach_rad),
            MotionSpec::PressWiggleRelease(press) => {
                pressing(press.push_torque_n_m, press.approach_rad)
            }
            MotionSpec::None
            | MotionSpec::Tap(_)
            | MotionSpec::Turn(_)
            | MotionSpec::Recorded(_) => TouchAndPress::default(),
        };
        let share = MOST_OF_THE_TORQUE * most_torque_n_m(scene) / press.push_torque_n_m;
        if share < 1.0 {
            press.push_torque_n_m *= share;
            press.touch_torque_n_m *= share;
        }
        Self {
            press,
            frequencies_hz: vec![1.0, 2.0, 4.0],
        }
    }

    /// Keeps only the oscillations at 1 and 4 Hz.
    #[must_use]
    pub fn with_fewer_motions(mut self) -> Self {
        self.frequencies_hz = vec![1.0, 4.0];
        self
    }

    /// Shortens touch and hold of the press, and keeps only the oscillations at 1 and 4 Hz.
    #[must_use]
    pub fn shortened(mut self) -> Self {
        self.press.touch_s = self.press.touch_s.min(0.3);
        self.press.hold_s = self.press.hold_s.min(0.6);
        self.with_fewer_motions()
    }

    /// All actions: the press, then the oscillations.
    pub fn deeds(&self) -> impl Iterator<Item = Deed> + '_ {
        std::iter::once(Deed::Press).chain(self.frequencies_hz.iter().copied().map(Deed::Move))
    }

    /// The scene with this grip and this action of the hand.
    #[must_use]
    pub fn scene(&self, scene: &Scene, grip: Grip, deed: Deed) -> Scene {
        let mut scene = scene.clone();
        scene.operator.grip = grip;
        scene.operator.hand = None;
        scene.device.initial_angle_rad = None;
        scene.device.initial_velocity_rad_per_s = 0.0;
        let press = &self.press;
        match deed {
            Deed::Press => {
                // A tenth of a second after the release, to see where the device goes.
                scene.timing.duration_s = press.start_s
                    + press.touch_ramp_s
                    + press.touch_s
                    + press.ramp_s
                    + press.hold_s
                    + press.release_s
                    + 0.1;
                scene.operator.motion = MotionSpec::TouchAndPress(press.clone());
            }
            Deed::Move(frequency_hz) => {
                let period_s = 1.0 / frequency_hz;
                // The measured part starts after one period and at least half a second. It lasts a whole number of periods, about
                // a second or one period if that is longer. Then the oscillation fades within half a period.
                let periods = frequency_hz.ceil().max(1.0);
                let wiggle_s = period_s.max(0.5) + (periods + 0.5) * period_s + 1e-6;
                scene.timing.duration_s = press.start_s + press.ramp_s + wiggle_s;
                scene.operator.motion = MotionSpec::PressWiggleRelease(PressWiggleRelease {
                    start_s: press.start_s,
                    ramp_s: press.ramp_s,
                    wiggle_s,
                    hold_s: 0.1,
                    release_s: press.release_s,
                    push_torque_n_m: press.push_torque_n_m,
                    wiggle_amplitude_n_m: MOVES_WITH * press.push_torque_n_m,
                    wiggle_frequency_hz: frequency_hz,
                    approach_rad: press.approach_rad,
                });
            }
        }
        scene
    }

    /// Simulated time of all actions on one device in one grip, s.
    #[must_use]
    pub fn seconds(&self, scene: &Scene) -> f64 {
        self.deeds()
            .map(|deed| self.scene(scene, Grip::Medium, deed).timing.duration_s)
            .sum()
    }
}

fn pressing(push_torque_n_m: f64, approach_rad: f64) -> TouchAndPress {
    TouchAndPress {
        push_torque_n_m,
        touch_torque_n_m: 0.2 * push_torque_n_m,
        approach_rad,
        ..TouchAndPress::default()
    }
}
