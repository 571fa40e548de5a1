//! Places in the control loop at which effects act.

/// Place of an effect in the control loop. It determines the least computing time that the effect costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// The effect replaces the sensor that gives the control law the angle.
    Sensor,
    /// The effect changes the angle before it reaches the control law.
    Angle,
    /// The effect changes the torque before it reaches the motor.
    Torque,
    /// The effect acts around the whole controller side, such as lost control periods.
    Law,
    /// The effect acts between torque command and plant, or on the times of samples and commands.
    Crossing,
    /// The effect is part of the closed-form solution of device and hand.
    Exact,
    /// The effect adds a linear state to the closed-form solution of a drive train.
    State,
    /// The effect acts at the shaft of a drive train; the simulation then needs substeps.
    Shaft,
    /// The effect acts between the intended motion and the hand.
    Hand,
    /// The effect adds a torque to that of the wall, before the energy guard limits their sum.
    Environment,
    /// The effect is the velocity estimate for the damper of the control law `spring-damper`.
    Velocity,
}

impl Place {
    /// Name of the place in words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Place::Sensor => "in the angle that the control law reads",
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
