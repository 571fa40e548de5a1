//! The fields of a scene's table `[environment]`: further walls, end stops, detents, a torque profile, spring, damper, dry
//! friction, clicks and inertia.

use super::super::MOST_DETENTS;
use super::Kind::{Choice, Flag, Numbers, Whole};
use super::Range::{Any, NotNegative, Within};
use super::{Field, field, number};
use touchstone_control::Choice as _;
use touchstone_control::environment::{MOST_POINTS, Side};

/// Range of the stiffness of an additional wall, N·m/rad, the same as for the stiffness of `[wall]`.
const STIFFNESS: super::Range = Within(0.0, 500_000.0);

/// Range of a place on the axis, rad, that the fixed-point numbers of the control law hold.
const FAR: super::Range = Within(-1e9, 1e9);

/// Makes the three fields of one additional wall: position of its surface, solid side and stiffness.
macro_rules! wall {
    ($table:literal, $which:literal) => {
        [
            number(
                concat!("environment.", $table, ".at_rad"),
                "rad",
                Any,
                concat!("the ", $which, " wall's surface"),
            ),
            field(
                concat!("environment.", $table, ".solid"),
                "",
                Choice(Side::WORDS),
                concat!(
                    "on which side of its surface the ",
                    $which,
                    " wall is solid"
                ),
            ),
            number(
                concat!("environment.", $table, ".stiffness_n_m_per_rad"),
                "n_m_per_rad",
                STIFFNESS,
                concat!("the ", $which, " wall's desired stiffness"),
            )
            .absent("that of [wall]"),
        ]
    };
}

const WALLS: [[Field; 3]; 3] = [
    wall!("wall2", "second"),
    wall!("wall3", "third"),
    wall!("wall4", "fourth"),
];

const fn of_wall(wall: usize, row: usize) -> Field {
    WALLS[wall][row]
}

pub(super) const ENVIRONMENT: &[Field] = &[
    field(
        "environment.first_wall",
        "",
        Flag,
        "whether the wall of [wall] is there itself",
    ),
    of_wall(0, 0),
    of_wall(0, 1),
    of_wall(0, 2),
    of_wall(1, 0),
    of_wall(1, 1),
    of_wall(1, 2),
    of_wall(2, 0),
    of_wall(2, 1),
    of_wall(2, 2),
    number(
        "environment.endstops.lower_rad",
        "rad",
        Any,
        "the lower end of the travel",
    ),
    number(
        "environment.endstops.upper_rad",
        "rad",
        Any,
        "the upper end of the travel",
    ),
    number(
        "environment.endstops.stiffness_n_m_per_rad",
        "n_m_per_rad",
        STIFFNESS,
        "the endstops' desired stiffness",
    )
    .absent("that of [wall]"),
    field(
        "environment.detents.per_rev",
        "",
        Whole(0, 6283),
        "the detents in one turn; 0: pitch_rad apart",
    ),
    number(
        "environment.detents.pitch_rad",
        "rad",
        Within(0.001, std::f64::consts::TAU),
        "the distance between two detents, if per_rev = 0",
    ),
    number(
        "environment.detents.strength_n_m",
        "n_m",
        NotNegative,
        "the detents' largest torque (0: counted, not felt)",
    ),
    number(
        "environment.detents.centre_rad",
        "rad",
        Any,
        "where a detent is",
    ),
    field(
        "environment.profile.per_rev",
        "",
        Whole(0, 6283),
        "the copies of the profile in one turn; 0: once, from start_rad to end_rad",
    ),
    number(
        "environment.profile.start_rad",
        "rad",
        Any,
        "where the first point is",
    ),
    number(
        "environment.profile.end_rad",
        "rad",
        Any,
        "where the last point is, if per_rev = 0",
    ),
    number(
        "environment.profile.strength_n_m",
        "n_m",
        NotNegative,
        "the torque of a point of 1",
    ),
    field(
        "environment.profile.shape",
        "",
        Numbers(2, MOST_POINTS, -1.0, 1.0),
        "2 to 96 points at equal distances, as fractions of the strength; positive ones push towards larger angles",
    ),
    field(
        "environment.detent_list.positions_rad",
        "rad",
        Numbers(1, MOST_DETENTS, -1e9, 1e9),
        "1 to 16 angles that pull the knob in, rising",
    ),
    field(
        "environment.detent_list.strengths_n_m",
        "n_m",
        Numbers(1, MOST_DETENTS, 0.0, 1e4),
        "the largest torque of each listed detent, or one for all",
    ),
    field(
        "environment.detent_list.widths_rad",
        "rad",
        Numbers(1, MOST_DETENTS, 0.001, 6283.0),
        "the width of each listed detent, or one for all",
    ),
    number(
        "environment.spring.centre_rad",
        "rad",
        FAR,
        "where the spring gives no torque",
    ),
    number(
        "environment.spring.stiffness_n_m_per_rad",
        "n_m_per_rad",
        Within(0.0, 100.0),
        "the spring's stiffness",
    ),
    number(
        "environment.spring.strength_n_m",
        "n_m",
        NotNegative,
        "the spring's largest torque",
    ),
    number(
        "environment.damper.damping_n_m_s_per_rad",
        "n_m_s_per_rad",
        NotNegative,
        "the rendered damping",
    ),
    number(
        "environment.damper.bandwidth_hz",
        "hz",
        Within(5.0, 500.0),
        "the bandwidth of the velocity's filter",
    ),
    number(
        "environment.dry_friction.strength_n_m",
        "n_m",
        NotNegative,
        "the rendered friction while the knob slides",
    ),
    number(
        "environment.dry_friction.stretch_rad",
        "rad",
        Within(0.001, 1.0),
        "the way from rest until the knob slides",
    ),
    field(
        "environment.click.per_rev",
        "",
        Whole(0, 6283),
        "the clicks in one turn; 0: pitch_rad apart",
    ),
    number(
        "environment.click.pitch_rad",
        "rad",
        Within(0.001, std::f64::consts::TAU),
        "the distance between two clicks, if per_rev = 0",
    ),
    number(
        "environment.click.centre_rad",
        "rad",
        FAR,
        "where a click is",
    ),
    number(
        "environment.click.strength_n_m",
        "n_m",
        NotNegative,
        "the torque of a click's pulse",
    ),
    number(
        "environment.click.duration_s",
        "s",
        Within(0.001, 0.1),
        "the length of a click's pulse",
    ),
    number(
        "environment.inertia.inertia_kg_m2",
        "kg_m2",
        NotNegative,
        "the inertia of the mass that the knob drags",
    ),
    number(
        "environment.inertia.bandwidth_hz",
        "hz",
        Within(5.0, 30.0),
        "the frequency below which motions feel the mass",
    ),
];
