//! The table itself.

use super::Kind::{Choice, Flag, Text, Whole};
use super::Range::{Any, AtLeast, NotNegative, NotZero, Positive, UpTo, Within};
use super::{Field, Kind, Range};
use crate::scene::operator::{FASTEST_MOTION_HZ, FASTEST_RAMP_S};

impl Field {
    const fn absent(self, meaning: &'static str) -> Field {
        Field {
            absent: Some(meaning),
            ..self
        }
    }

    const fn only(self, motions: &'static [&'static str]) -> Field {
        Field { motions, ..self }
    }
}

const fn field(path: &'static str, unit: &'static str, kind: Kind, about: &'static str) -> Field {
    Field {
        path,
        unit,
        kind,
        about,
        absent: None,
        motions: &[],
    }
}

const fn number(
    path: &'static str,
    unit: &'static str,
    range: Range,
    about: &'static str,
) -> Field {
    field(path, unit, Kind::Number(range), about)
}

const PRESSES: &[&str] = &["ramp-and-hold", "press-wiggle-release", "touch-and-press"];
const TIMED: &[&str] = &[
    "ramp-and-hold",
    "tap",
    "press-wiggle-release",
    "touch-and-press",
];
const TOUCH: &[&str] = &["touch-and-press"];
const WIGGLE: &[&str] = &["press-wiggle-release"];
const TAP: &[&str] = &["tap"];
const RECORDED: &[&str] = &["recorded"];

/// Laws, motions and the like by their names in scenes.
const LAWS: &[&str] = &[
    "spring",
    "spring-damper",
    "tdpa",
    "fba",
    "sfa",
    "sfa-continuous",
    "enhanced-sfa",
];
const NUMBERS: &[&str] = &["fixed32", "fixed16", "f32", "f64"];
const OBSERVERS: &[&str] = &["exact", "thesis"];
const FIRST_CONTACTS: &[&str] = &["keep-force", "zero-offset"];
const REGULATES: &[&str] = &["mass", "mass-compensated", "hip"];
const OFFSET_UPDATES: &[&str] = &["inward", "every-tick"];
const IDEAL_STEPS: &[&str] = &["position", "force"];
const GRIPS: &[&str] = &["none", "light", "medium", "firm", "custom"];
const MOTIONS: &[&str] = &[
    "none",
    "ramp-and-hold",
    "tap",
    "press-wiggle-release",
    "touch-and-press",
    "recorded",
];

/// Path of the field that decides which other fields a motion has.
pub(crate) const MOTION_KIND: &str = "operator.motion.kind";

/// Tables that may be left out as a whole, and what that means.
pub(crate) const OPTIONAL_TABLES: &[(&str, &str)] = &[
    ("device.friction", "no dry friction"),
    ("encoder", "exact position"),
    ("operator.hand", "the grip's values"),
];

/// All fields, in the order in which they are printed.
pub(crate) const FIELDS: &[Field] = &[
    field("name", "", Text, "the scene's name"),
    field("description", "", Text, "what the scene shows"),
    number(
        "device.inertia_kg_m2",
        "kg_m2",
        Positive,
        "the device's moment of inertia",
    ),
    number(
        "device.damping_n_m_s_per_rad",
        "n_m_s_per_rad",
        NotNegative,
        "the device's viscous damping",
    ),
    number(
        "device.initial_angle_rad",
        "rad",
        Any,
        "the angle at the start",
    )
    .absent("the hand's rest point, without a hand 0.05 rad outside the wall"),
    number(
        "device.initial_velocity_rad_per_s",
        "rad_per_s",
        Any,
        "the velocity at the start (positive into the wall)",
    ),
    number(
        "device.torque_limit_n_m",
        "n_m",
        Positive,
        "the drive's largest torque",
    )
    .absent("no limit"),
    number(
        "device.amplifier_step_n_m",
        "n_m",
        Positive,
        "the amplifier's smallest step of torque",
    )
    .absent("no steps"),
    number(
        "device.friction.kinetic_n_m",
        "n_m",
        NotNegative,
        "the friction torque while sliding",
    ),
    number(
        "device.friction.static_n_m",
        "n_m",
        NotNegative,
        "the break-away torque",
    )
    .absent("equal to kinetic_n_m"),
    number(
        "encoder.counts_per_rev",
        "",
        Positive,
        "the encoder's counts in one turn",
    ),
    field(
        "timing.rate_hz",
        "hz",
        Whole(1, 1_000_000),
        "the control rate",
    ),
    number(
        "timing.duration_s",
        "s",
        UpTo(86_400.0),
        "the simulated time",
    ),
    number(
        "timing.computational_delay_s",
        "s",
        Within(0.0, 1.0),
        "the delay from sample to command",
    ),
    number("wall.surface_rad", "rad", Any, "the wall's surface"),
    number(
        "wall.k_desired_n_m_per_rad",
        "n_m_per_rad",
        Positive,
        "the stiffness to display",
    ),
    field("law.kind", "", Choice(LAWS), "the control law"),
    field(
        "law.number",
        "",
        Choice(NUMBERS),
        "the number format that the law computes in",
    ),
    number(
        "law.k_v_n_m_per_rad",
        "n_m_per_rad",
        Positive,
        "the soft spring of the augmentation",
    ),
    number(
        "law.c_i_n_m_s_per_rad",
        "n_m_s_per_rad",
        Positive,
        "the damping that the law counts on",
    ),
    field(
        "law.observer",
        "",
        Choice(OBSERVERS),
        "the form of the energy observer",
    ),
    field(
        "law.count_device_damping",
        "",
        Flag,
        "whether TDPA counts the energy that c_i dissipates",
    ),
    number(
        "law.virtual_damping_n_m_s_per_rad",
        "n_m_s_per_rad",
        NotNegative,
        "the virtual damping of the law spring-damper",
    ),
    field(
        "law.first_contact",
        "",
        Choice(FIRST_CONTACTS),
        "the rule at the end of the first contact",
    )
    .absent("keep-force for sfa, zero-offset for the later laws"),
    field(
        "law.regulate",
        "",
        Choice(REGULATES),
        "where the displayed stiffness is regulated",
    ),
    field(
        "law.offset_update",
        "",
        Choice(OFFSET_UPDATES),
        "when the enhanced law changes the offset",
    ),
    field(
        "law.ideal_step",
        "",
        Choice(IDEAL_STEPS),
        "what the offset's ideal step supposes to stay",
    ),
    number(
        "law.energy_credit_j",
        "j",
        NotNegative,
        "the energy that one contact may give beyond what it took",
    ),
    number(
        "law.limit_a_of_penetration",
        "",
        Within(0.0, 1.0),
        "the largest step of the offset as a share of the penetration",
    ),
    number(
        "law.limit_b_of_force",
        "",
        Within(0.0, 1.0),
        "the largest step of the force as a share of the force",
    ),
    number(
        "law.step_c_of_ideal",
        "",
        Within(0.0, 1.0),
        "the step of the offset as a share of the ideal one",
    ),
    number(
        "law.force_limit_n_m",
        "n_m",
        Positive,
        "the largest force that the law commands",
    ),
    number(
        "law.filter.mass_kg_m2",
        "kg_m2",
        Positive,
        "the filter's virtual mass",
    ),
    number(
        "law.filter.stiffness_n_m_per_rad",
        "n_m_per_rad",
        Positive,
        "the filter's spring",
    ),
    number(
        "law.filter.damping_n_m_s_per_rad",
        "n_m_s_per_rad",
        NotNegative,
        "the damper between HIP and virtual mass",
    ),
    number(
        "law.filter.damping_to_ground_n_m_s_per_rad",
        "n_m_s_per_rad",
        NotNegative,
        "the damper between virtual mass and ground",
    ),
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
    field(
        MOTION_KIND,
        "",
        Choice(MOTIONS),
        "what the hand sets out to do",
    ),
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
        "the torque by which the push rises and falls",
    )
    .only(WIGGLE),
    number(
        "operator.motion.wiggle_frequency_hz",
        "hz",
        UpTo(FASTEST_MOTION_HZ),
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
    .only(TIMED),
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
];
