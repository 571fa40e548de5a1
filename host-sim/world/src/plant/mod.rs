//! The mechanical side of a simulation: device and hand between two control ticks, exact under a zero-order hold.
//!
//! ```text
//!   u (torque, held)           pad k_p, b_p             spring k_h
//!        |                          |                        |
//!   [ device J, x ] ----/\/\/--[]---- [ hand J_h, x_h ] ----/\/\/---- r (rest point, held)
//!        |                                   |
//!   b, dry friction                      damper b_h
//!        |                                   |
//!     ground                              ground
//! ```
//!
//! ```text
//! J   dv/dt   = u + k_p (x_h - x) + b_p (v_h - v) - b v - friction(v)
//! J_h dv_h/dt =    - k_p (x_h - x) - b_p (v_h - v) - b_h v_h + k_h (r - x_h)
//! ```
//!
//! Torque `u` and rest point `r` are constant during an interval, so the linear part needs no integrator: one precomputed matrix step is the
//! exact solution (Van Loan, IEEE TAC 23(3) 395, 1978). Dry friction adds events (stops and starts), whose times are calculated. There is
//! no step size and no setting of accuracy.
//!
//! A scene makes two choices, which are types, so that they cost no branch in a tick:
//!
//! | | no friction | Coulomb friction |
//! |---|---|---|
//! | nobody holds the device | [`BareLinear`] | [`BareCoulomb`] |
//! | a hand holds it | [`HeldLinear`] | [`HeldCoulomb`] |
//!
//! All four are [`Stepper`]s: they hold the configuration for one fixed interval and advance a small separate [`State`]. A computational
//! delay of a fraction of a tick uses two steppers in turn on one state, with the intervals `delay` and `T - delay`.
//!
//! A device with three translations is three axes, each with a stepper of its own, [`Cartesian`], or a mechanism of arms, [`DeltaPlant`].
//!
//! Units are those of a knob (rad, N·m, kg·m²). An axis of a translational device has the same equations with m, N and kg; only the units in
//! the names of fields are wrong then.
//!
//! [`train`] has a drive train: a current that lags, a compliant transmission, cogging, imbalance and further kinds of friction.

mod bare;
mod bare_coulomb;
mod biased;
mod cartesian;
mod delta;
pub(crate) mod device;
pub(crate) mod flow;
mod hand;
mod held;
mod held_coulomb;
mod sampled_loop;
mod state;
mod stepper;
mod taylor;
pub mod train;

pub use bare::BareLinear;
pub use bare_coulomb::BareCoulomb;
pub use biased::Biased;
pub use cartesian::{
    Cartesian, FIRM_TRANSLATION, LIGHT_TRANSLATION, Limits, MEDIUM_TRANSLATION, OMEGA3, OMEGA3_AXIS,
};
pub use delta::{
    DeltaDevice, DeltaGeometry, DeltaMasses, DeltaPlant, DeltaPose, DeltaState, DeltaWork, FALCON,
    FALCON_GEOMETRY, Unreachable,
};
pub use device::{Coulomb, Device, Invalid};
pub use hand::{FIRM, Hand, LIGHT, MEDIUM};
pub use held::HeldLinear;
pub use held_coulomb::HeldCoulomb;
pub use sampled_loop::{closed_loop_matrix, critical_stiffness, spectral_radius};
pub use state::{Kinematics, State};
pub use stepper::{LinearStepper, Loss, Port, Stepper};
