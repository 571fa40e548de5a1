//! The variables of an FMU: which a scene has, and their numbers, units and meanings.

use crate::Half;
use touchstone_control::ChangeOfForce;
use touchstone_sim::scene::Scene;

/// A variable. Its number is FMI's value reference; the numbers are the same in every FMU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Name {
    /// The independent variable of both FMUs.
    Time = 0,
    /// Law: the device's angle at the beginning of the step.
    MeasuredAngle = 1,
    /// Law: the angle at which the last torque began to act.
    MeasuredChange = 2,
    /// Law: the torque for the motor.
    Torque = 3,
    /// Law: the penetration that the encoder gave.
    Penetration = 4,
    /// Law: the level of the energy guard's account.
    Account = 5,
    /// Law: whether the energy guard reduced the force.
    Limited = 6,
    /// Law: whether the energy guard switched the force off.
    Tripped = 7,
    /// Plant: the torque that the motor gets.
    Command = 11,
    /// Plant: an angle that is added to the hand's rest point.
    HandOffset = 12,
    /// Plant: the device's angle.
    Angle = 13,
    /// Plant: the device's velocity.
    Velocity = 14,
    /// Plant: the angle of the hand's mass.
    Hand = 15,
    /// Plant: the angle at which the motor's torque changed.
    Change = 16,
    /// Plant: the energy that the motor has absorbed.
    Absorbed = 17,
}

/// Whether the importing program sets a variable or reads it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    /// The time.
    Independent,
    /// Set by the importing program.
    Input,
    /// Read by the importing program.
    Output,
}

/// One row of the table of variables.
#[derive(Debug, Clone, Copy)]
pub struct Variable {
    /// The variable.
    pub name: Name,
    /// Name of the variable in the FMU; the name of a number ends in the unit.
    pub text: &'static str,
    /// Whether the importing program sets or reads the variable.
    pub causality: Causality,
    /// Unit of the variable; `None` for a truth value.
    pub unit: Option<&'static str>,
    /// Meaning of the variable in one sentence.
    pub meaning: &'static str,
}

const fn row(
    name: Name,
    text: &'static str,
    causality: Causality,
    unit: Option<&'static str>,
    meaning: &'static str,
) -> Variable {
    Variable {
        name,
        text,
        causality,
        unit,
        meaning,
    }
}

use Causality::{Independent, Input, Output};

const TIME: Variable = row(Name::Time, "time", Independent, Some("s"), "Time.");

const LAW: [Variable; 8] = [
    TIME,
    row(
        Name::MeasuredAngle,
        "angle_rad",
        Input,
        Some("rad"),
        "Angle of the device at the beginning of the step. The encoder of the scene counts it.",
    ),
    row(
        Name::MeasuredChange,
        "angle_at_change_rad",
        Input,
        Some("rad"),
        "Angle of the device at which the last torque began to act, as a second encoder reading.",
    ),
    row(
        Name::Torque,
        "torque_n_m",
        Output,
        Some("N.m"),
        "Torque to command until the next step, in the direction of growing angles.",
    ),
    row(
        Name::Penetration,
        "penetration_rad",
        Output,
        Some("rad"),
        "Penetration into the wall that the encoder gave.",
    ),
    row(
        Name::Account,
        "energy_account_j",
        Output,
        Some("J"),
        "Account of the energy guard: energy that the hand may still get out.",
    ),
    row(
        Name::Limited,
        "is_limited",
        Output,
        None,
        "Whether the energy guard passed less force than the control law requested.",
    ),
    row(
        Name::Tripped,
        "is_tripped",
        Output,
        None,
        "Whether the energy guard switched the force off because of overspeed.",
    ),
];

const PLANT: [Variable; 8] = [
    TIME,
    row(
        Name::Command,
        "torque_n_m",
        Input,
        Some("N.m"),
        "Torque command of this step, in the direction of growing angles. The delays of the scene follow it.",
    ),
    row(
        Name::HandOffset,
        "hand_offset_rad",
        Input,
        Some("rad"),
        "Angle that is added to the rest point of the scene's hand, to move the hand otherwise.",
    ),
    row(
        Name::Angle,
        "angle_rad",
        Output,
        Some("rad"),
        "True angle of the device.",
    ),
    row(
        Name::Velocity,
        "velocity_rad_per_s",
        Output,
        Some("rad/s"),
        "True velocity of the device.",
    ),
    row(
        Name::Hand,
        "hand_rad",
        Output,
        Some("rad"),
        "Angle of the hand's mass.",
    ),
    row(
        Name::Change,
        "angle_at_change_rad",
        Output,
        Some("rad"),
        "True angle of the device at which the motor's torque changed in the last step.",
    ),
    row(
        Name::Absorbed,
        "wall_energy_j",
        Output,
        Some("J"),
        "Energy that the motor has absorbed since the start; negative where it gave energy.",
    ),
];

/// The variables of one FMU of a scene. Variables of a guard, a hand or a second encoder reading are left out if the scene has
/// none.
pub fn of(scene: &Scene, half: Half) -> impl Iterator<Item = &'static Variable> {
    let guard = scene.law.guard.on;
    let change = guard && scene.law.guard.change == ChangeOfForce::Measured;
    let hand = scene.operator.hand().is_some();
    let all: &[Variable] = match half {
        Half::Law => &LAW,
        Half::Plant => &PLANT,
    };
    all.iter().filter(move |variable| match variable.name {
        Name::MeasuredChange | Name::Change => change,
        Name::Account | Name::Limited | Name::Tripped => guard,
        Name::HandOffset | Name::Hand => hand,
        _ => true,
    })
}
