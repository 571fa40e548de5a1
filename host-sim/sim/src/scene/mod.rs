//! Scenes: what to simulate, in TOML, every field with its unit in its name.
//!
//! A scene names the effects it wants; what it does not name is `None` in it and is not computed. Every field has a
//! default. The types hold what a scene means (`experiment` and what it names); [`schema`] holds every field's name, unit and
//! range; `draft` reads and checks, for `load` and `overrides`. [`RestPath`] turns the operator's intention into the hand's rest point.

mod check;
mod device;
mod draft;
mod effects;
mod environment;
mod experiment;
mod law;
mod load;
mod motion;
mod operator;
mod origin;
mod overrides;
mod preset;
mod print;
mod problem;
mod renamed;
pub mod schema;
mod settings;
mod shipped;
#[cfg(test)]
mod tests;
mod units;
mod unknown;
mod value;

pub use device::{DeviceSpec, Encoder, Friction, Integrator, Plant, Timing, Wall};
pub use effects::{
    Cogging, CurrentLoop, CurrentSensor, HandReflex, HandTremor, Imbalance, PeriodicError,
    SensorErrors, SensorNoise, Transmission,
};
pub use environment::{DetentRing, Endstops, Environment, FurtherWall, TorqueProfile};
pub use experiment::Scene;
pub(crate) use law::word;
pub use law::{FilterSettings, Law, Number, VelocitySettings};
pub use motion::{Curve, Recording, RestPath, SMOOTHING_HZ};
pub use operator::{
    APPROACH_RAD, FASTEST_MOTION_HZ, FASTEST_RAMP_S, FASTEST_WIGGLE_HZ, Grip, Hand, MotionSpec,
    Operator, PressWiggleRelease, RampAndHold, Recorded, Tap, TouchAndPress, Turn,
};
pub use origin::Origin;
pub use overrides::path_of;
pub use preset::Preset;
pub use renamed::renamed;
pub use shipped::{feels, is_shipped, names};
pub use touchstone_control::Choice;
pub use unknown::{list, nearest};
pub use value::choices;
