//! The person at the knob: two masses and their intended motion.
//!
//! Device – fingertip pad – hand – moving rest point. A hand bolted to the device would hide every instability of the
//! thesis, so the pad's give is part of every grip.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::effects::{HandReflex, HandTremor};
use touchstone_world::plant;

/// The operator. Absent: no hand at the device.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Operator {
    /// How the knob is held. Default `none`, and `custom` where `[operator.hand]` is given.
    pub grip: Grip,
    /// The hand's own values, for the grip `custom` only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hand: Option<Hand>,
    /// A hand that trembles. Absent: it does not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tremor: Option<HandTremor>,
    /// Muscles that answer late. Absent: they do not answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reflex: Option<HandReflex>,
    /// The hand's intended motion. Default `none`.
    pub motion: MotionSpec,
}

impl Operator {
    /// The hand to simulate; `None` without a hand.
    pub fn hand(&self) -> Option<Hand> {
        self.grip.hand().or_else(|| self.hand.clone())
    }
}

/// Presets of [`Hand`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Grip {
    /// No hand at the device: the hardest case for a law, as no damping comes from outside.
    #[default]
    None,
    /// Fingertips just touch.
    Light,
    /// The grip of the thesis' experiments as far as they can be matched.
    Medium,
    /// Whole hand.
    Firm,
    /// The values of `[operator.hand]`.
    Custom,
}

impl Grip {
    /// Name in scenes and results.
    pub fn name(self) -> &'static str {
        match self {
            Grip::None => "none",
            Grip::Light => "light",
            Grip::Medium => "medium",
            Grip::Firm => "firm",
            Grip::Custom => "custom",
        }
    }

    /// The preset's values; `None` for `none` and `custom`.
    ///
    /// They are the plant's, where the choice is explained: [`plant::MEDIUM`].
    pub fn hand(self) -> Option<Hand> {
        let hand = match self {
            Grip::Light => plant::LIGHT,
            Grip::Medium => plant::MEDIUM,
            Grip::Firm => plant::FIRM,
            Grip::None | Grip::Custom => return None,
        };
        Some(Hand {
            pad_stiffness_n_m_per_rad: hand.pad_stiffness,
            pad_damping_n_m_s_per_rad: hand.pad_damping,
            inertia_kg_m2: hand.inertia,
            damping_n_m_s_per_rad: hand.damping,
            stiffness_n_m_per_rad: hand.stiffness,
        })
    }
}

/// A hand in rotary terms. Values that `[operator.hand]` leaves out are those of the medium grip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Hand {
    /// Fingertip pad's stiffness between device and hand, N·m/rad, above 0. Default 0.1575.
    pub pad_stiffness_n_m_per_rad: f64,
    /// Fingertip pad's damping, N·m·s/rad, 0 or more. Default 1e-4.
    pub pad_damping_n_m_s_per_rad: f64,
    /// Hand's moment of inertia, kg·m², above 0. Default 6.75e-5.
    pub inertia_kg_m2: f64,
    /// Damping between hand and rest point's frame (the ground), N·m·s/rad, 0 or more. Default 6.75e-4.
    pub damping_n_m_s_per_rad: f64,
    /// Stiffness between hand and rest point, N·m/rad, above 0. Default 0.0225.
    pub stiffness_n_m_per_rad: f64,
}

impl Hand {
    /// Angle by which pad and hand give under one newton metre, rad/(N·m).
    pub fn compliance_rad_per_n_m(&self) -> f64 {
        1.0 / self.pad_stiffness_n_m_per_rad + 1.0 / self.stiffness_n_m_per_rad
    }
}

impl Default for Hand {
    fn default() -> Self {
        // The grip that comes nearest to the thesis.
        Grip::Medium.hand().expect("a preset")
    }
}

/// The hand's intended motion. [`RestPath`](super::RestPath) turns it into a rest point.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum MotionSpec {
    /// The rest point stays where the device starts.
    #[default]
    None,
    /// Moves in, presses, holds, lets go.
    RampAndHold(RampAndHold),
    /// Pushes quickly and withdraws.
    Tap(Tap),
    /// Presses, presses harder and softer in turn, holds still, lets go.
    PressWiggleRelease(PressWiggleRelease),
    /// Touches the wall lightly and briskly, stays, then presses, holds, lets go.
    TouchAndPress(TouchAndPress),
    /// Turns the knob by an angle and back, wall or not.
    Turn(Turn),
    /// Follows a recording.
    Recorded(Recorded),
}

impl MotionSpec {
    /// Name in scenes.
    pub fn name(&self) -> &'static str {
        match self {
            MotionSpec::None => "none",
            MotionSpec::RampAndHold(_) => "ramp-and-hold",
            MotionSpec::Tap(_) => "tap",
            MotionSpec::PressWiggleRelease(_) => "press-wiggle-release",
            MotionSpec::TouchAndPress(_) => "touch-and-press",
            MotionSpec::Turn(_) => "turn",
            MotionSpec::Recorded(_) => "recorded",
        }
    }

    /// The quiet holds, each from the end of its ramp to the end of the hold, s, in order. The last is the press that the
    /// displayed stiffness is judged by.
    pub fn holds_s(&self) -> Vec<(f64, f64)> {
        match self {
            MotionSpec::RampAndHold(m) => {
                vec![(m.start_s + m.ramp_s, m.start_s + m.ramp_s + m.hold_s)]
            }
            MotionSpec::PressWiggleRelease(m) => {
                let start = m.start_s + m.ramp_s + m.wiggle_s;
                vec![(start, start + m.hold_s)]
            }
            MotionSpec::TouchAndPress(m) => {
                let touched = m.start_s + m.touch_ramp_s;
                let pressed = touched + m.touch_s + m.ramp_s;
                vec![
                    (touched, touched + m.touch_s),
                    (pressed, pressed + m.hold_s),
                ]
            }
            MotionSpec::None
            | MotionSpec::Tap(_)
            | MotionSpec::Turn(_)
            | MotionSpec::Recorded(_) => Vec::new(),
        }
    }

    /// Multiplies the push by a factor; a motion without a push does not change.
    pub fn scale_push(&mut self, share: f64) {
        match self {
            MotionSpec::RampAndHold(motion) => motion.push_torque_n_m *= share,
            MotionSpec::TouchAndPress(motion) => motion.push_torque_n_m *= share,
            MotionSpec::PressWiggleRelease(motion) => motion.push_torque_n_m *= share,
            MotionSpec::None
            | MotionSpec::Tap(_)
            | MotionSpec::Turn(_)
            | MotionSpec::Recorded(_) => {}
        }
    }

    /// Start and end of the time over which the displayed stiffness is judged, s; `None` without a quiet hold.
    ///
    /// It is the second half of the last hold: in the first half hand and offset still settle.
    pub fn hold_window_s(&self) -> Option<(f64, f64)> {
        self.holds_s()
            .last()
            .map(|&(start, end)| (0.5 * (start + end), end))
    }
}

/// Least time of a ramp, s: half a period of 10 Hz, the upper end of voluntary motion.
pub const FASTEST_RAMP_S: f64 = 0.05;
/// Upper end of voluntary motion, Hz.
pub const FASTEST_MOTION_HZ: f64 = 10.0;
/// Fastest wiggle, Hz: a probe of `F/x` that is faster than voluntary motion, and up to where a hand still transmits a
/// tremor.
pub const FASTEST_WIGGLE_HZ: f64 = 16.0;

/// Default distance outside the wall at which a hand waits, rad.
///
/// Enough to arrive moving (1.6 to 2.1 rad/s in the default press, by grip), little enough that the contact comes
/// soon.
pub const APPROACH_RAD: f64 = 0.05;

/// Moves in, presses, holds, lets go.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RampAndHold {
    /// Time at which the hand starts to move, s, 0 or more. Default 0.1.
    pub start_s: f64,
    /// Time from rest outside to the full push, s, at least 0.05. Default 0.5.
    pub ramp_s: f64,
    /// Time of the steady push, s, above 0. Default 1.5.
    pub hold_s: f64,
    /// Time from the full push back to rest outside, s, at least 0.05. Default 0.4.
    pub release_s: f64,
    /// Static torque against a wall that displays the desired stiffness, N·m, above 0. Default 0.1.
    pub push_torque_n_m: f64,
    /// Distance outside the wall at which the hand starts and ends, rad, above 0. Default 0.05.
    pub approach_rad: f64,
}

impl Default for RampAndHold {
    fn default() -> Self {
        RampAndHold {
            // A tenth of a second of rest shows that the device starts in equilibrium.
            start_s: 0.1,
            // An unhurried press.
            ramp_s: 0.5,
            // Pad and hand ring for about half a second; the second half of the hold is still.
            hold_s: 1.5,
            release_s: 0.4,
            // Thesis Fig. 5.5.
            push_torque_n_m: 0.1,
            approach_rad: APPROACH_RAD,
        }
    }
}

/// Pushes quickly and withdraws.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tap {
    /// Time at which the hand starts to move, s, 0 or more. Default 0.1.
    pub start_s: f64,
    /// Speed of the device when it reaches the wall, rad/s, above 0. Default 3.
    pub velocity_rad_per_s: f64,
    /// Distance outside the wall at which the hand starts and ends, rad, above 0; the run-up. Default 0.1.
    pub approach_rad: f64,
}

impl Default for Tap {
    fn default() -> Self {
        Tap {
            start_s: 0.1,
            // Knobs are turned at 1 to 10 rad/s; 3 rad/s is 45 mm/s at the fingertip.
            velocity_rad_per_s: 3.0,
            // Long enough that the tap stays a human motion (about 4 Hz).
            approach_rad: 0.1,
        }
    }
}

/// Turns the knob by an angle, stays, and turns it back. The hand's rest point moves so; the knob follows as hand, detents and walls let
/// it, and stays behind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Turn {
    /// Time at which the hand starts to move, s, 0 or more. Default 0.1.
    pub start_s: f64,
    /// Where the hand starts and ends, rad. Default 0.
    pub from_rad: f64,
    /// How far it turns, rad, of any sign, not 0. Default 1.
    pub angle_rad: f64,
    /// Time of the way there, and of the way back, s, at least 0.05. Default 2.
    pub turn_s: f64,
    /// Time that it stays, s, above 0. Default 1.
    pub stay_s: f64,
}

impl Default for Turn {
    fn default() -> Self {
        Turn {
            start_s: 0.1,
            from_rad: 0.0,
            angle_rad: 1.0,
            turn_s: 2.0,
            stay_s: 1.0,
        }
    }
}

/// Touches lightly, then presses: one scene that an unstable law has two ways to fail in. A light touch lets a wall that
/// gives too much energy throw the hand off; a firm press drives a wall that samples too coarsely into oscillation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TouchAndPress {
    /// Time at which the hand starts to move, s, 0 or more. Default 0.1.
    pub start_s: f64,
    /// Time from rest outside to the light touch, s, at least 0.05. Default 0.05.
    pub touch_ramp_s: f64,
    /// Time of the light touch, s, above 0. Default 2.
    pub touch_s: f64,
    /// Static torque of the light touch, N·m, above 0. Default 0.02.
    pub touch_torque_n_m: f64,
    /// Time from the touch to the full push, s, at least 0.05. Default 0.3.
    pub ramp_s: f64,
    /// Time of the steady push, s, above 0. Default 1.5.
    pub hold_s: f64,
    /// Time from the push back to rest outside, s, at least 0.05. Default 0.4.
    pub release_s: f64,
    /// Static torque against a wall that displays the desired stiffness, N·m, above 0. Default 0.1.
    pub push_torque_n_m: f64,
    /// Distance outside the wall at which the hand starts and ends, rad, above 0. Default 0.05.
    pub approach_rad: f64,
}

impl Default for TouchAndPress {
    fn default() -> Self {
        TouchAndPress {
            start_s: 0.1,
            // As brisk as a hand can (10 Hz): the contact that throws a light hand off an energetic wall.
            touch_ramp_s: FASTEST_RAMP_S,
            // Long enough for the heaviest hand's own swing in its grip (0.3 s) to die away.
            touch_s: 2.0,
            // A fifth of the push.
            touch_torque_n_m: 0.02,
            ramp_s: 0.3,
            hold_s: 1.5,
            release_s: 0.4,
            push_torque_n_m: 0.1,
            approach_rad: APPROACH_RAD,
        }
    }
}

/// Presses, presses harder and softer in turn, holds still, lets go.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PressWiggleRelease {
    /// Time at which the hand starts to move, s, 0 or more. Default 0.1.
    pub start_s: f64,
    /// Time from rest outside to the mean push, s, at least 0.05. Default 0.5.
    pub ramp_s: f64,
    /// Time of the wiggling, s, above 0. Default 1.
    pub wiggle_s: f64,
    /// Time of the steady push after it, s, above 0. Default 1.
    pub hold_s: f64,
    /// Time from the push back to rest outside, s, at least 0.05. Default 0.4.
    pub release_s: f64,
    /// Mean static torque against a wall that displays the desired stiffness, N·m, above 0. Default 0.1.
    pub push_torque_n_m: f64,
    /// Static torque by which the push rises and falls, N·m, 0 or more. Default 0.03.
    pub wiggle_amplitude_n_m: f64,
    /// Rate of the wiggling, Hz, above 0, at most 16 (a hand by itself ends near 10). Default 2.
    pub wiggle_frequency_hz: f64,
    /// Distance outside the wall at which the hand starts and ends, rad, above 0. Default 0.05.
    pub approach_rad: f64,
}

impl Default for PressWiggleRelease {
    fn default() -> Self {
        PressWiggleRelease {
            start_s: 0.1,
            ramp_s: 0.5,
            // Two periods.
            wiggle_s: 1.0,
            hold_s: 1.0,
            release_s: 0.4,
            push_torque_n_m: 0.1,
            // A third of the push: every period moves in and out, none loses the contact.
            wiggle_amplitude_n_m: 0.03,
            // The middle of the 1 to 3 Hz of deliberate probing, well below the hand's own resonance in contact (8
            // Hz).
            wiggle_frequency_hz: 2.0,
            approach_rad: APPROACH_RAD,
        }
    }
}

/// Follows a recording: rest point = surface + offset + scale · (angle - mean angle), or the recorded rest point itself.
///
/// With the defaults the recording's mean lies on the surface, so the hand goes in and out of the wall whatever was
/// recorded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// CSV file with a time and an angle column; relative to the scene's folder, on the command line to the current
    /// one.
    pub file: PathBuf,
    /// Factor on the recorded motion, any sign (negative turns it round), not 0. Default 1.
    #[serde(default = "unchanged")]
    pub scale: f64,
    /// Distance of the recording's mean from the surface, rad, positive inside. Default 0.
    #[serde(default)]
    pub offset_rad: f64,
    /// Takes the angles as the rest point as they stand, each until the next: a record of ticks is repeated bit for bit.
    /// Scale and offset must then be 1 and 0. Default `false`: placed and smoothed.
    #[serde(default)]
    pub exact: bool,
}

/// The factor that changes nothing.
fn unchanged() -> f64 {
    1.0
}

impl Recorded {
    /// The recording unscaled, with its mean on the surface.
    pub fn new(file: PathBuf) -> Self {
        Recorded {
            file,
            scale: unchanged(),
            offset_rad: 0.0,
            exact: false,
        }
    }
}
