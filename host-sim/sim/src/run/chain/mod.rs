//! Once-per-tick effects around law and plant, one kind a file.
//!
//! | where | trait | absent | present |
//! |---|---|---|---|
//! | how the law is told the angle | [`Sensor`] | [`ExactAngle`] | [`Counts`] |
//! | between world and law, on the angle or on the torque | [`Stage`] | nothing | [`Staged`]: one indirect call |
//! | whether the law's side runs at all | [`Control`] | nothing | [`Lossy`]: one indirect call |
//! | between torque and plant | [`Crossing`] | [`Prompt`], compiled with the plant | [`Delayed`], [`Irregular`]: one indirect call |
//! | between a motion and the hand | [`Crossing`] | nothing | [`Handled`]: one indirect call |
//!
//! Effects add up, they do not multiply: the law's side of the loop is behind the one indirect call by which the loop reaches
//! the law anyway, and a stage is put around it only where the scene names it. So what a scene does not name is not in the
//! loop (not computed, not stored, not branched on), and a new effect is compiled once, whatever else there is.

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
