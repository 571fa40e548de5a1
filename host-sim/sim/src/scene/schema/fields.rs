//! The list of all fields that a scene may have, with unit, range and meaning.

use super::Kind::{Choice, Flag, Text, Whole};
use super::Range::{Any, Exactly, NotNegative, Positive, UpTo, Within};
use super::environment_fields::ENVIRONMENT;
use super::hand_fields::OPERATOR;
use super::{Field, field, number};
use crate::scene::device::Integrator;
use crate::scene::law::Number;
use touchstone_control::choices::*;
use touchstone_control::table::suffix;
use touchstone_control::{Choice as _, setting_path};

/// Tables that a scene file may leave out, each with the meaning of its absence.
pub(crate) const OPTIONAL_TABLES: &[(&str, &str)] = &[
    ("device.friction", "no dry friction"),
    ("device.cogging", "no cogging"),
    ("device.imbalance", "no mass beside the axis"),
    ("device.current_sensor", "the current is known exactly"),
    ("device.current_loop", "the torque is the command"),
    ("device.transmission", "motor and knob are one"),
    ("encoder", "exact position"),
    ("sensor.noise", "no noise"),
    ("sensor.periodic", "no such error"),
    ("environment", "the wall alone"),
    ("environment.wall2", "no second wall"),
    ("environment.wall3", "no third wall"),
    ("environment.wall4", "no fourth wall"),
    ("environment.endstops", "no endstops"),
    ("environment.detents", "no detents"),
    ("environment.profile", "no profile"),
    ("environment.detent_list", "no list of detents"),
    ("environment.spring", "no spring"),
    ("environment.damper", "no rendered damping"),
    ("environment.dry_friction", "no rendered friction"),
    ("environment.click", "no clicks"),
    ("environment.inertia", "no added inertia"),
    ("operator.hand", "the grip's values"),
    ("operator.tremor", "a steady hand"),
    ("operator.reflex", "no reflex"),
    ("plant", "the exact step"),
];

const DEVICE: &[Field] = &[
    field("name", "", Text, "the scene's name"),
    field("description", "", Text, "what the scene shows"),
    field(
        "seed",
        "",
        Whole(0, 4_294_967_295),
        "where everything random begins",
    )
    .absent("1"),
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
        "device.friction.asymmetry_n_m",
        "n_m",
        Any,
        "how much more friction there is against positive motion, and less against negative motion",
    )
    .absent("0"),
    number(
        "device.friction.stribeck_rad_per_s",
        "rad_per_s",
        Positive,
        "the velocity at which friction has fallen from its static to its kinetic value",
    )
    .absent("kinetic in motion"),
    number(
        "device.friction.bristle_stiffness_n_m_per_rad",
        "n_m_per_rad",
        Positive,
        "the stiffness of the bristles in the model of friction at rest",
    )
    .absent("they hold rigidly"),
    number(
        "device.friction.bristle_damping_n_m_s_per_rad",
        "n_m_s_per_rad",
        NotNegative,
        "the bristles' damping",
    )
    .absent("the root of their stiffness times the inertia"),
    number(
        "device.cogging.torque_n_m",
        "n_m",
        NotNegative,
        "the amplitude of the cogging torque",
    ),
    field(
        "device.cogging.periods_per_rev",
        "",
        Whole(1, 100_000),
        "the cogging's periods in one turn",
    ),
    number(
        "device.cogging.phase_rad",
        "rad",
        Any,
        "the cogging's phase at angle 0",
    ),
    number(
        "device.imbalance.torque_n_m",
        "n_m",
        NotNegative,
        "the mass beside the axis times its distance from the axis",
    ),
    number(
        "device.imbalance.phase_rad",
        "rad",
        Any,
        "the angle of that mass from its lowest point, at angle 0",
    ),
    number(
        "device.current_sensor.noise_rms_n_m",
        "n_m",
        NotNegative,
        "the rms of the current sensor's noise as torque",
    ),
    number(
        "device.current_sensor.step_n_m",
        "n_m",
        NotNegative,
        "the current sensor's step as torque",
    ),
    number(
        "device.current_loop.bandwidth_hz",
        "hz",
        Positive,
        "the bandwidth with which the torque follows its command",
    ),
    number(
        "device.current_loop.back_emf_n_m_s_per_rad",
        "n_m_s_per_rad",
        NotNegative,
        "the damping by the motor's induced voltage (0 with a current loop)",
    ),
    number(
        "device.transmission.spring_n_m_per_rad",
        "n_m_per_rad",
        Positive,
        "the transmission's stiffness",
    ),
    number(
        "device.transmission.damper_n_m_s_per_rad",
        "n_m_s_per_rad",
        NotNegative,
        "the transmission's damping",
    ),
    number(
        "device.transmission.knob_share",
        "",
        Within(1e-3, 0.999),
        "the share of the device's inertia that is the knob's",
    ),
    number(
        "device.transmission.play_rad",
        "rad",
        NotNegative,
        "the transmission's whole play",
    ),
    number(
        "encoder.counts_per_rev",
        "",
        Positive,
        "the encoder's counts in one turn",
    ),
    number(
        "sensor.noise.rms_rad",
        "rad",
        NotNegative,
        "the rms of the sensor's white noise",
    ),
    number(
        "sensor.periodic.amplitude_rad",
        "rad",
        NotNegative,
        "the amplitude of a sensor error that repeats every turn",
    ),
    field(
        "sensor.periodic.periods_per_rev",
        "",
        Whole(1, 100_000),
        "that error's periods in one turn",
    ),
    number(
        "sensor.periodic.phase_rad",
        "rad",
        Any,
        "that error's phase at angle 0",
    ),
    number(
        "sensor.periodic.second_amplitude_rad",
        "rad",
        NotNegative,
        "the amplitude of that error's second part, of twice as many periods",
    ),
    number(
        "sensor.periodic.second_phase_rad",
        "rad",
        Any,
        "the second part's phase at angle 0",
    ),
    field(
        "plant.integrator",
        "",
        Choice(Integrator::WORDS),
        "the method that computes device and hand over a control period",
    ),
    field(
        "plant.substeps",
        "",
        Whole(1, 100_000),
        "the method's substeps in a control period (the exact step needs none, unless an effect needs some)",
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
    number(
        "timing.jitter_s",
        "s",
        Within(0.0, 1.0),
        "the largest lateness of a control period",
    )
    .absent("every control period is in time"),
    number(
        "timing.latency_spread_s",
        "s",
        Within(0.0, 1.0),
        "the largest further delay of a command",
    )
    .absent("every command has the same delay"),
    number(
        "timing.lost_share",
        "",
        Within(0.0, 0.9),
        "the share of control periods that are left out",
    )
    .absent("none"),
    number("wall.surface_rad", "rad", Any, "the wall's surface"),
];

const NUMBER: &[Field] = &[field(
    "law.number",
    "",
    Choice(Number::WORDS),
    "the number format that the law computes in",
)];

/// Joins the lists of fields in printing order. The fields of `[law]` are made from the control crate's list of law settings.
macro_rules! table {
    (
        timing { $($timing:tt)* } wall { $($wall:tt)* } law { $($law:tt)* }
        $($(#[$doc:meta])* $group:ident $Group:ident { $($rows:tt)* })+
    ) => {
        /// Groups of fields in the order in which a scene is printed.
        const PARTS: &[&[Field]] = &[
            DEVICE,
            table!(@rows (timing) $($timing)*),
            TIMING_AND_SURFACE,
            table!(@rows (wall) $($wall)*),
            ENVIRONMENT,
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

static JOINED: [Field; COUNT] = {
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

/// All fields of a scene, in the order in which they are printed.
pub const FIELDS: &[Field] = &JOINED;
