//! Scenes: TOML files that describe what to simulate. The name of every field contains its unit.
//!
//! An effect that a scene does not name is `None` and is not computed. Every field has a default. The type of a scene is in
//! `experiment`; [`schema`] lists name, unit and range of every field. `draft` reads and checks scenes for the modules `load` and
//! `overrides`. [`RestPath`] turns the intended motion of a scene into the hand's rest point over time.

mod check;
mod detent_list;
mod device;
mod draft;
mod effects;
mod environment;
mod experiment;
mod feel;
mod law;
mod load;
mod motion;
mod operator;
mod origin;
mod overrides;
mod preset;
mod print;
mod problem;
mod profile_file;
mod renamed;
pub mod schema;
mod sent;
mod settings;
mod shipped;
#[cfg(test)]
mod tests;
mod torque_profile;
mod units;
mod unknown;
mod value;

pub use detent_list::{DetentList, MOST_DETENTS};
pub use device::{DeviceSpec, Encoder, Friction, Integrator, Plant, Timing, Wall};
pub use effects::{
    Cogging, CurrentLoop, CurrentSensor, HandReflex, HandTremor, Imbalance, PeriodicError,
    SensorErrors, SensorNoise, Transmission,
};
pub use environment::{DetentRing, Endstops, Environment, FurtherWall};
pub use experiment::Scene;
pub use feel::{AddedInertia, CentreSpring, Clicks, DryFriction, ViscousFriction};
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
pub use torque_profile::TorqueProfile;
pub use touchstone_control::Choice;
pub use unknown::{list, nearest};
pub use value::choices;
