//! The scene's fields of the operator: the hand, its tremor and reflexes, and its motion.

use super::Kind::{Choice, Flag, Text};
use super::Range::{Any, AtLeast, NotNegative, NotZero, Positive, UpTo, Within};
use super::{Field, field, number};
use crate::scene::operator::{FASTEST_RAMP_S, FASTEST_WIGGLE_HZ};

const PRESSES: &[&str] = &["ramp-and-hold", "press-wiggle-release", "touch-and-press"];
const FROM_OUTSIDE: &[&str] = &[
    "ramp-and-hold",
    "tap",
    "press-wiggle-release",
    "touch-and-press",
];
const TIMED: &[&str] = &[
    "ramp-and-hold",
    "tap",
    "press-wiggle-release",
    "touch-and-press",
    "turn",
];
const TOUCH: &[&str] = &["touch-and-press"];
const WIGGLE: &[&str] = &["press-wiggle-release"];
const TAP: &[&str] = &["tap"];
const TURN: &[&str] = &["turn"];
const RECORDED: &[&str] = &["recorded"];

/// Names of the grips that a scene may give.
const GRIPS: &[&str] = &["none", "light", "medium", "firm", "custom"];
const MOTIONS: &[&str] = &[
    "none",
    "ramp-and-hold",
    "tap",
    "press-wiggle-release",
    "touch-and-press",
    "turn",
    "recorded",
];

/// Path of the field that names the hand's motion. The named motion decides which other fields `[operator.motion]` has.
pub(crate) const MOTION_KIND: &str = "operator.motion.kind";

pub(super) const OPERATOR: &[Field] = &[
    field("operator.grip", "", Choice(GRIPS), "how the knob is held"),
    number(
        "operator.hand.pad_stiffness_n_m_per_rad",
        "n_m_per_rad",
        Positive,
        "the fingertip pad's stiffness",
    ),
    number(
        "operator.hand.pad_damping_n_m_s_per_rad",
        "n_m_s_per_rad",
        NotNegative,
        "the fingertip pad's damping",
    ),
    number(
        "operator.hand.inertia_kg_m2",
        "kg_m2",
        Positive,
        "the hand's moment of inertia",
    ),
    number(
        "operator.hand.damping_n_m_s_per_rad",
        "n_m_s_per_rad",
        NotNegative,
        "the hand's damping",
    ),
    number(
        "operator.hand.stiffness_n_m_per_rad",
        "n_m_per_rad",
        Positive,
        "the stiffness between hand and rest point",
    ),
    number(
        "operator.tremor.amplitude_rad",
        "rad",
        NotNegative,
        "the amplitude of the rest point's tremor",
    ),
    number(
        "operator.tremor.frequency_hz",
        "hz",
        UpTo(30.0),
        "the tremor's rate",
    ),
    number(
        "operator.reflex.delay_s",
        "s",
        Within(0.0, 1.0),
        "the time from a stretch to the muscles' response",
    ),
    number(
        "operator.reflex.muscle_stiffness_n_m_per_rad",
        "n_m_per_rad",
        NotNegative,
        "the torque of that response per stretch",
    ),
    field(MOTION_KIND, "", Choice(MOTIONS), "the motion of the hand"),
    number(
        "operator.motion.start_s",
        "s",
        NotNegative,
        "the time at which the hand starts to move",
    )
    .only(TIMED),
    number(
        "operator.motion.touch_ramp_s",
        "s",
        AtLeast(FASTEST_RAMP_S),
        "the time from rest to the light touch",
    )
    .only(TOUCH),
    number(
        "operator.motion.touch_s",
        "s",
        Positive,
        "the time of the light touch",
    )
    .only(TOUCH),
    number(
        "operator.motion.touch_torque_n_m",
        "n_m",
        Positive,
        "the static torque of the light touch",
    )
    .only(TOUCH),
    number(
        "operator.motion.ramp_s",
        "s",
        AtLeast(FASTEST_RAMP_S),
        "the time from rest to the full push",
    )
    .only(PRESSES),
    number(
        "operator.motion.wiggle_s",
        "s",
        Positive,
        "the time of the wiggling",
    )
    .only(WIGGLE),
    number(
        "operator.motion.hold_s",
        "s",
        Positive,
        "the time of the steady push",
    )
    .only(PRESSES),
    number(
        "operator.motion.release_s",
        "s",
        AtLeast(FASTEST_RAMP_S),
        "the time from the push back to rest",
    )
    .only(PRESSES),
    number(
        "operator.motion.push_torque_n_m",
        "n_m",
        Positive,
        "the static torque of the push",
    )
    .only(PRESSES),
    number(
        "operator.motion.wiggle_amplitude_n_m",
        "n_m",
        NotNegative,
        "the amplitude with which the push varies",
    )
    .only(WIGGLE),
    number(
        "operator.motion.wiggle_frequency_hz",
        "hz",
        UpTo(FASTEST_WIGGLE_HZ),
        "the rate of the wiggling",
    )
    .only(WIGGLE),
    number(
        "operator.motion.velocity_rad_per_s",
        "rad_per_s",
        Positive,
        "the device's speed at the wall",
    )
    .only(TAP),
    number(
        "operator.motion.approach_rad",
        "rad",
        Positive,
        "the distance outside the wall at which the hand starts",
    )
    .only(FROM_OUTSIDE),
    number(
        "operator.motion.from_rad",
        "rad",
        Any,
        "where the hand starts and ends",
    )
    .only(TURN),
    number(
        "operator.motion.angle_rad",
        "rad",
        NotZero,
        "how far the hand turns",
    )
    .only(TURN),
    number(
        "operator.motion.turn_s",
        "s",
        AtLeast(FASTEST_RAMP_S),
        "the time for the way there, and for the way back",
    )
    .only(TURN),
    number(
        "operator.motion.stay_s",
        "s",
        Positive,
        "the time that the hand stays",
    )
    .only(TURN),
    field(
        "operator.motion.file",
        "",
        Text,
        "the recording, a CSV file",
    )
    .only(RECORDED),
    number(
        "operator.motion.scale",
        "",
        NotZero,
        "the factor on the recorded motion",
    )
    .only(RECORDED),
    number(
        "operator.motion.offset_rad",
        "rad",
        Any,
        "the distance of the recording's mean from the surface (positive inside)",
    )
    .only(RECORDED),
    field(
        "operator.motion.exact",
        "",
        Flag,
        "whether the angles are used unchanged as the rest point, each until the next",
    )
    .only(RECORDED),
];
