//! Stiff virtual walls in fixed point: energy observers, passivity control, successive force augmentation.
//!
//! One tick (control period) has these steps, the same in firmware, simulator and proofs:
//!
//! ```text
//! encoder count -> penetration -> states -> law -> pulse at the touch -> guard -> command
//! ```
//!
//! Read the modules in that order: [`Position`] in [`quantity`], [`observer`], one file per law in [`law`], [`filter`] for the
//! virtual mass, [`CountScale`] for the encoder, [`Controller`] for how settings become a running law. The arithmetic of these
//! modules is in [`number`]; the part of it that the machine-checked proofs cover is in [`magnitude`].
//!
//! | word | meaning | unit (1-DoF / 3-DoF) |
//! |---|---|---|
//! | HIP | haptic interaction point, the position `x` the user moves | rad / m |
//! | surface | `x_s`, the undeformed wall | rad / m |
//! | penetration | `e = x - x_s`, positive inside | rad / m |
//! | force | `f`, positive = pushes the hand's point (HIP) out; the device is commanded `-f` along `+x` | N·m / N |
//! | offset | `O`, the artificial extra deformation of SFA | rad / m |
//! | `k_de`, `k_di` | desired and displayed stiffness, `k_di = f/e` | N·m/rad / N/m |
//! | `k_v` | the soft, inherently stable spring of SFA | N·m/rad / N/m |
//! | `k_c` | critical stiffness `2 c_i/T` | N·m/rad / N/m |
//! | energy | positive = absorbed from the user by the virtual object | J |
//! | tick | one control period `T` | s |
//!
//! ```
//! use touchstone_control::{Controller, Fixed32, Position, Settings, Si};
//!
//! let settings = Settings { k_desired: Si::lit("5"), ..Settings::default() };
//! let mut wall = Controller::<Fixed32>::new(&settings).unwrap();
//! let e = Position::from_si(Si::lit("0.01")).unwrap(); // 10 mrad inside
//! let f = wall.tick(e);
//! assert!(f.to_si() < Si::lit("0.05") && f.to_si() > Si::lit("0.0499998")); // 50 mN·m, rounded towards zero
//! ```
//!
//! `examples/one_wall.rs` and the README go from encoder count to motor torque. Settings and values in SI units are [`Si`] numbers,
//! as above. The crate of the fixed-point types (`I8F24` and the like) is re-exported as [`fixed`].
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

pub mod choices;
mod coefficients;
pub mod controller;
pub mod device;
mod division;
pub mod encoder;
pub mod environment;
pub mod estimator;
pub mod filter;
pub mod guard;
pub mod law;
pub mod magnitude;
pub mod named;
pub mod number;
pub mod observer;
pub mod quantity;
pub mod quotient;
pub mod reciprocal;
mod refusal;
mod sample;
pub mod settings;
pub mod space;
pub mod states;
pub mod table;
pub mod validate;
pub mod velocity;

/// The crate of the fixed-point types, re-exported so that a user need not depend on the same version of it.
pub use fixed;

pub use choices::*;
pub use controller::{AnyLaw, Controller};
pub use device::{Device, OwnForce};
pub use encoder::CountScale;
pub use environment::Environment;
pub use estimator::Estimator;
pub use guard::{Guard, GuardState, Guarded, GuardedDevice};
pub use named::NotSet;
#[cfg(feature = "float")]
pub use number::Reported;
pub use number::{Fixed8, Fixed16, Fixed32, Number};
pub use quantity::{Compliance, Divisor, Energy, Force, Position, Ratio, Stiffness, Tension};
pub use quotient::Si;
pub use refusal::{Field, SettingsError, Warning};
pub use settings::*;
pub use states::States;
pub use table::Choice;

/// The README's code example, which a test compiles and runs.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
