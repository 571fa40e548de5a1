//! Effects that act once per tick (control period) around control law and plant, one type of effect per file.
//!
//! | where the effect acts | trait | without the effect | with the effect |
//! |---|---|---|---|
//! | on the sensor that gives the law the angle | [`Sensor`] | [`ExactAngle`] | [`Counts`] |
//! | between device and law, on the angle or on the torque | [`Stage`] | nothing | [`Staged`]: one indirect call |
//! | on whether the controller side runs in a tick | [`Control`] | nothing | [`Lossy`]: one indirect call |
//! | between torque and plant | [`Crossing`] | [`Prompt`], compiled with the plant | [`Delayed`], [`Irregular`]: one indirect call |
//! | between intended motion and hand | [`Crossing`] | nothing | [`Handled`]: one indirect call |
//!
//! The costs of effects add up; they do not multiply. The loop calls the controller side indirectly in any case, and a stage is put
//! around it only if the scene names the effect. An effect that the scene does not name is therefore neither computed nor stored
//! nor branched on. A new effect is compiled once, not once for each combination.

mod control;
mod crossing;
mod irregular;
mod lost;
mod noise;
mod sensor;
mod stage;
mod unsteady;

pub use control::{Answer, Control, Sampled};
pub use crossing::{Crossing, Delayed, Flow, Prompt};
pub use irregular::{Irregular, Lateness, PARTS};
pub use lost::Lossy;
pub use noise::{Channel, CurrentError, Eccentric, Noisy, Stream};
pub use sensor::{Counts, ExactAngle, ExactPlace, Sensor};
pub use stage::{Limited, Stage, Staged, Stepped};
pub use unsteady::{Handled, Reflex, Tremor, Unsteady};
