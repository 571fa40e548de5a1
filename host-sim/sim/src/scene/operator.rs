//! The person at the knob in a scene: mechanical values of the hand and its intended motion.
//!
//! The model is a chain: device, fingertip pad (spring and damper), hand (mass), and a moving rest point at the end of the hand's
//! spring. Every grip includes the compliant pad, because a hand bolted rigidly to the device would suppress the instabilities that
//! the thesis examines.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::effects::{HandReflex, HandTremor};
use touchstone_world::plant;

/// The operator: a hand and its intended motion. Absent: no hand at the device.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Operator {
    /// How the hand holds the knob. Default `none`, or `custom` if the scene gives `[operator.hand]`.
    pub grip: Grip,
    /// The hand's mechanical values, for the grip `custom` only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hand: Option<Hand>,
    /// Tremor of the hand. Absent: no tremor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tremor: Option<HandTremor>,
    /// Reflex: muscles that react with a delay. Absent: no reflex.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reflex: Option<HandReflex>,
    /// The hand's intended motion. Default `none`.
    pub motion: MotionSpec,
}

impl Operator {
    /// Mechanical values of the hand to simulate: those of the grip, or the custom ones; `None` without a hand.
    pub fn hand(&self) -> Option<Hand> {
        self.grip.hand().or_else(|| self.hand.clone())
    }
}

/// Grips: named sets of values of [`Hand`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Grip {
    /// No hand at the device. This case is the hardest for a control law, because no damping comes from outside.
    #[default]
    None,
    /// Fingertips that just touch the knob.
    Light,
    /// A medium grip, matched as closely as possible to the one in the thesis' experiments.
    Medium,
    /// The whole hand grips the knob.
    Firm,
    /// The values given in `[operator.hand]`.
    Custom,
}

impl Grip {
    /// Name of the grip in scene files and results.
    pub fn name(self) -> &'static str {
        match self {
            Grip::None => "none",
            Grip::Light => "light",
            Grip::Medium => "medium",
            Grip::Firm => "firm",
            Grip::Custom => "custom",
        }
    }

    /// The grip's mechanical values; `None` for `none` and `custom`.
    ///
    /// The values come from the plant model, whose comment explains the choice: [`plant::MEDIUM`].
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

/// Mechanical values of a hand, converted to rotation about the knob's axis. Values that `[operator.hand]` leaves out are those of
/// the medium grip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Hand {
    /// Stiffness of the fingertip pad between device and hand, N·m/rad, above 0. Default 0.1575.
    pub pad_stiffness_n_m_per_rad: f64,
    /// Damping of the fingertip pad, N·m·s/rad, 0 or more. Default 1e-4.
    pub pad_damping_n_m_s_per_rad: f64,
    /// Moment of inertia of the hand, kg·m², above 0. Default 6.75e-5.
    pub inertia_kg_m2: f64,
    /// Damping between hand and ground, N·m·s/rad, 0 or more. Default 6.75e-4.
    pub damping_n_m_s_per_rad: f64,
    /// Stiffness of the spring between hand and rest point, N·m/rad, above 0. The rest point is the angle to which the person pulls
    /// the hand. Default 0.0225.
    pub stiffness_n_m_per_rad: f64,
}

impl Hand {
    /// Angle by which fingertip pad and hand together yield per newton metre, rad/(N·m).
    pub fn compliance_rad_per_n_m(&self) -> f64 {
        1.0 / self.pad_stiffness_n_m_per_rad + 1.0 / self.stiffness_n_m_per_rad
    }
}

impl Default for Hand {
    fn default() -> Self {
        // The grip that is most similar to that of the thesis' experiments.
        Grip::Medium.hand().expect("a preset")
    }
}

/// The intended motion of the hand, as the scene file gives it. [`RestPath`](super::RestPath) computes the hand's rest point over
/// time.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum MotionSpec {
    /// No motion: the rest point stays at the device's initial angle.
    #[default]
    None,
    /// Moves into the wall, presses, holds, lets go.
    RampAndHold(RampAndHold),
    /// Pushes quickly against the wall and withdraws.
    Tap(Tap),
    /// Presses, presses harder and softer in turn, holds still, lets go.
    PressWiggleRelease(PressWiggleRelease),
    /// Touches the wall lightly and quickly, stays, then presses, holds, lets go.
    TouchAndPress(TouchAndPress),
    /// Turns the knob by an angle and back, with or without a wall.
    Turn(Turn),
    /// Follows a recorded motion from a CSV file.
    Recorded(Recorded),
}

impl MotionSpec {
    /// Name of the motion in scenes.
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

    /// Start and end of each steady hold, s, in order of time. A hold starts when the ramp before it ends. The displayed stiffness
    /// is measured in the last hold.
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

    /// Multiplies the push torque by `share`. A motion without a push does not change.
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

    /// Start and end of the time in which the displayed stiffness is measured, s; `None` for a motion without a steady hold.
    ///
    /// It is the second half of the last hold: in the first half, the hand and the wall's offset still settle.
    pub fn hold_window_s(&self) -> Option<(f64, f64)> {
        self.holds_s()
            .last()
            .map(|&(start, end)| (0.5 * (start + end), end))
    }
}

/// Shortest time that a ramp of the hand may take, s: half a period of 10 Hz, the highest frequency of voluntary motion.
pub const FASTEST_RAMP_S: f64 = 0.05;
/// Highest frequency of voluntary motion, Hz.
pub const FASTEST_MOTION_HZ: f64 = 10.0;
/// Highest frequency of the wiggle (alternating harder and softer push), Hz.
///
/// It lies above voluntary motion, so that force over position can be measured there, and within the range in which a hand
/// transmits tremor.
pub const FASTEST_WIGGLE_HZ: f64 = 16.0;

/// Default distance outside the wall at which a hand waits, rad.
///
/// From this distance the default press reaches the wall at 1.6 to 2.1 rad/s, depending on the grip.
pub const APPROACH_RAD: f64 = 0.05;

/// Motion of a press: the hand moves into the wall, presses, holds, lets go.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RampAndHold {
    /// Time at which the hand starts to move, s, 0 or more. Default 0.1.
    pub start_s: f64,
    /// Time from rest outside the wall to the full push, s, at least 0.05. Default 0.5.
    pub ramp_s: f64,
    /// Duration of the steady push, s, above 0. Default 1.5.
    pub hold_s: f64,
    /// Time from the full push back to rest outside the wall, s, at least 0.05. Default 0.4.
    pub release_s: f64,
    /// Static torque of the push, N·m, above 0, against a wall of exactly the requested stiffness. Default 0.1.
    pub push_torque_n_m: f64,
    /// Distance outside the wall at which the hand starts and ends, rad, above 0. Default 0.05.
    pub approach_rad: f64,
}

impl Default for RampAndHold {
    fn default() -> Self {
        RampAndHold {
            // A tenth of a second of rest shows that the device starts in equilibrium.
            start_s: 0.1,
            // A press at a moderate pace.
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

/// Motion of a tap: the hand pushes quickly against the wall and withdraws.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tap {
    /// Time at which the hand starts to move, s, 0 or more. Default 0.1.
    pub start_s: f64,
    /// Speed of the device when it reaches the wall, rad/s, above 0. Default 3.
    pub velocity_rad_per_s: f64,
    /// Distance outside the wall at which the hand starts and ends, rad, above 0. Default 0.1.
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

/// Motion of a turn: the hand turns the knob by an angle, stays, and turns it back. The scene gives the hand's rest point; the knob
/// lags behind it, as hand, detents and walls allow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Turn {
    /// Time at which the hand starts to move, s, 0 or more. Default 0.1.
    pub start_s: f64,
    /// Rest point at which the hand starts and ends, rad. Default 0.
    pub from_rad: f64,
    /// Angle by which the rest point turns, rad, of either sign, not 0. Default 1.
    pub angle_rad: f64,
    /// Time of each of the two turns (out and back), s, at least 0.05. Default 2.
    pub turn_s: f64,
    /// Time for which the hand stays between the two turns, s, above 0. Default 1.
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

/// Motion of a light touch followed by a firm press. An unstable control law can fail in either phase: a wall that gives too much
/// energy pushes the lightly touching hand away, and a wall sampled too coarsely oscillates under the firm press.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TouchAndPress {
    /// Time at which the hand starts to move, s, 0 or more. Default 0.1.
    pub start_s: f64,
    /// Time from rest outside the wall to the light touch, s, at least 0.05. Default 0.05.
    pub touch_ramp_s: f64,
    /// Duration of the light touch, s, above 0. Default 2.
    pub touch_s: f64,
    /// Static torque of the light touch, N·m, above 0, against a wall of exactly the requested stiffness. Default 0.02.
    pub touch_torque_n_m: f64,
    /// Time from the light touch to the full push, s, at least 0.05. Default 0.3.
    pub ramp_s: f64,
    /// Duration of the steady push, s, above 0. Default 1.5.
    pub hold_s: f64,
    /// Time from the full push back to rest outside the wall, s, at least 0.05. Default 0.4.
    pub release_s: f64,
    /// Static torque of the push, N·m, above 0, against a wall of exactly the requested stiffness. Default 0.1.
    pub push_torque_n_m: f64,
    /// Distance outside the wall at which the hand starts and ends, rad, above 0. Default 0.05.
    pub approach_rad: f64,
}

impl Default for TouchAndPress {
    fn default() -> Self {
        TouchAndPress {
            start_s: 0.1,
            // The fastest touch of a hand (10 Hz). A wall that gives too much energy then pushes a light hand away.
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

/// Motion of a press with a wiggle: the hand presses, pushes harder and softer in turn (wiggle), holds still and lets go.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PressWiggleRelease {
    /// Time at which the hand starts to move, s, 0 or more. Default 0.1.
    pub start_s: f64,
    /// Time from rest outside the wall to the mean push, s, at least 0.05. Default 0.5.
    pub ramp_s: f64,
    /// Duration of the wiggle (alternating harder and softer push), s, above 0. Default 1.
    pub wiggle_s: f64,
    /// Duration of the steady push after the wiggle, s, above 0. Default 1.
    pub hold_s: f64,
    /// Time from the steady push back to rest outside the wall, s, at least 0.05. Default 0.4.
    pub release_s: f64,
    /// Mean static torque of the push, N·m, above 0, against a wall of exactly the requested stiffness. Default 0.1.
    pub push_torque_n_m: f64,
    /// Amplitude of the wiggle, N·m, 0 or more: torque by which the static push rises above its mean and falls below it. Default
    /// 0.03.
    pub wiggle_amplitude_n_m: f64,
    /// Frequency of the wiggle (alternating harder and softer push), Hz, above 0, at most 16. Voluntary motion ends near 10 Hz.
    /// Default 2.
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

/// Motion from a recording. The hand's rest point is `surface + offset + scale · (angle - mean angle)`, or the recorded angle
/// itself if `exact` is true.
///
/// With the defaults the mean angle of the recording lies on the wall's surface, so that the hand goes in and out of the wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// CSV file with a column of time and a column of angle. In a scene file, the path is relative to the scene's folder; on the
    /// command line, to the current folder.
    pub file: PathBuf,
    /// Factor on the recorded motion, of either sign (a negative one reverses the direction), not 0. Default 1.
    #[serde(default = "unchanged")]
    pub scale: f64,
    /// Distance of the recording's mean angle from the wall's surface, rad, positive inside. Default 0.
    #[serde(default)]
    pub offset_rad: f64,
    /// With `true` the recorded angles are used as rest points without change, each held until the next sample. A record of all
    /// ticks (control periods) is thus repeated bit for bit. Scale and offset must then be 1 and 0.
    ///
    /// With `false` the recording is placed on the wall and smoothed. Default `false`.
    #[serde(default)]
    pub exact: bool,
}

/// Default factor on a recorded motion: 1, which leaves the motion unchanged.
fn unchanged() -> f64 {
    1.0
}

impl Recorded {
    /// A motion from the recording `file`, unscaled, with its mean angle on the wall's surface.
    pub fn new(file: PathBuf) -> Self {
        Recorded {
            file,
            scale: unchanged(),
            offset_rad: 0.0,
            exact: false,
        }
    }
}
