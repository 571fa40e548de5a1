//! The table itself.

use super::Kind::{Choice, Flag, Text, Whole};
use super::Range::{Any, AtLeast, Exactly, NotNegative, NotZero, Positive, UpTo, Within};
use super::{Field, Kind, Range};
use crate::scene::device::Integrator;
use crate::scene::law::Number;
use crate::scene::operator::{FASTEST_MOTION_HZ, FASTEST_RAMP_S};
use touchstone_control::choices::*;
use touchstone_control::table::suffix;
use touchstone_control::{Choice as _, setting_path};

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

/// Grips and motions by their names in scenes.
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
    ("plant", "the exact step"),
];

const DEVICE: &[Field] = &[
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
        "plant.integrator",
        "",
        Choice(Integrator::WORDS),
        "the method by which device and hand cross a tick",
    ),
    field(
        "plant.substeps",
        "",
        Whole(1, 100_000),
        "the method's substeps in a tick (the exact step has none)",
    ),
];

const TIMING_AND_SURFACE: &[Field] = &[
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
];

const NUMBER: &[Field] = &[field(
    "law.number",
    "",
    Choice(Number::WORDS),
    "the number format that the law computes in",
)];

const OPERATOR: &[Field] = &[
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
    field(
        "operator.motion.exact",
        "",
        Flag,
        "whether the angles are the rest point as they stand, each until the next",
    )
    .only(RECORDED),
];

/// Of the law's table: its rows as fields, and all fields in their order.
macro_rules! table {
    (
        timing { $($timing:tt)* } wall { $($wall:tt)* } law { $($law:tt)* }
        $($(#[$doc:meta])* $group:ident $Group:ident { $($rows:tt)* })+
    ) => {
        /// Everything in the order in which it is printed.
        const PARTS: &[&[Field]] = &[
            DEVICE,
            table!(@rows (timing) $($timing)*),
            TIMING_AND_SURFACE,
            table!(@rows (wall) $($wall)*),
            table!(@rows (law) $($law)*),
            NUMBER,
            $(table!(@rows (law $group) $($rows)*),)+
            OPERATOR,
        ];
    };
    (@rows $table:tt $($variant:ident $field:ident, $name:ident: $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+) => {
        &[$(table!(@row $kind $range (setting_path!($table $name), suffix($unit)) $about),)+]
    };
    (@row number ($least:literal, $most:literal) ($path:expr, $unit:expr) $about:literal) => {
        number($path, $unit, Exactly($least, $most), $about)
    };
    (@row flag () ($path:expr, $unit:expr) $about:literal) => { field($path, $unit, Flag, $about) };
    (@row choice ($choice:ident) ($path:expr, $unit:expr) $about:literal) => {
        field($path, $unit, Choice($choice::WORDS), $about)
    };
    (@row choice_of_law ($choice:ident) ($path:expr, $unit:expr) $about:literal) => {
        field($path, $unit, Choice($choice::WORDS), $about).absent("the law's own")
    };
    (@row $whole:ident ($least:literal, $most:literal) ($path:expr, $unit:expr) $about:literal) => {
        field($path, $unit, Whole($least, $most), $about)
    };
}
touchstone_control::law_settings!(table);

const COUNT: usize = {
    let (mut part, mut count) = (0, 0);
    while part < PARTS.len() {
        count += PARTS[part].len();
        part += 1;
    }
    count
};

const JOINED: [Field; COUNT] = {
    let mut all = [field("", "", Text, ""); COUNT];
    let (mut part, mut place) = (0, 0);
    while part < PARTS.len() {
        let mut row = 0;
        while row < PARTS[part].len() {
            all[place] = PARTS[part][row];
            (row, place) = (row + 1, place + 1);
        }
        part += 1;
    }
    all
};

/// All fields, in the order in which they are printed.
pub const FIELDS: &[Field] = &JOINED;
