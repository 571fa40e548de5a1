//! Where in the loop effects stand.

/// Place of an effect in the loop, which also decides its least cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// The innermost part: the sensor that gives the law the angle.
    Sensor,
    /// A stage on the way of the angle to the law.
    Angle,
    /// A stage on the way of the torque to the motor.
    Torque,
    /// The effect wraps the whole controller side.
    Law,
    /// Between torque and plant, and in time.
    Crossing,
    /// The effect is part of the plant's exact step.
    Exact,
    /// A linear state more in the exact step of a drive train.
    State,
    /// The effect acts at the shaft of a drive train, in substeps.
    Shaft,
    /// Between a motion and the hand.
    Hand,
    /// The effect acts in addition to the wall, before its guard.
    Environment,
    /// The effect is in the law: the velocity of its damper.
    Velocity,
}

impl Place {
    /// The name in words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Place::Sensor => "how the law is told the angle",
            Place::Angle => "stage on the angle",
            Place::Torque => "stage on the torque",
            Place::Law => "around the law's side",
            Place::Crossing => "between torque and plant",
            Place::Exact => "in the exact step",
            Place::State => "a state of the exact step",
            Place::Shaft => "at the shaft, in substeps",
            Place::Hand => "between motion and hand",
            Place::Environment => "beside the wall, before its guard",
            Place::Velocity => "in the law spring-damper",
        }
    }
}
