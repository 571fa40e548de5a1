//! The mechanical side of a simulation: device and hand between two control ticks, solved exactly for a torque that is constant in
//! between (zero-order hold).
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
//! `x`, `v`, `J`, `b` are angle, velocity, inertia and viscous damping of the device; those of the hand have the index `h`. `k_p`
//! and `b_p` are stiffness and damping of the fingertip pad, `k_h` is the stiffness of the hand's spring.
//!
//! Torque `u` and rest point `r` are constant during an interval, so the linear part needs no numerical integration. One
//! precomputed matrix step is the exact solution (Van Loan, IEEE TAC 23(3) 395, 1978). Dry friction adds stops and starts, whose
//! times are calculated. There is no step size and no accuracy setting.
//!
//! Hand and friction are optional. Each combination is a type of its own, so that the choice costs no branch in a tick:
//!
//! | | no friction | Coulomb friction |
//! |---|---|---|
//! | nobody holds the device | [`BareLinear`] | [`BareCoulomb`] |
//! | a hand holds it | [`HeldLinear`] | [`HeldCoulomb`] |
//!
//! All four are [`Stepper`]s: they hold the configuration for one fixed interval and advance a small separate [`State`]. A
//! computational delay of a fraction of a control period `T` uses two steppers in turn on one state, with the intervals `delay` and
//! `T - delay`.
//!
//! A device with three translations is either three axes, each with its own stepper ([`Cartesian`]), or a mechanism of arms
//! ([`DeltaPlant`]).
//!
//! Units are those of a knob (rad, N·m, kg·m²). A translational axis has the same equations with m, N and kg; the units in the
//! names of fields then do not apply.
//!
//! [`train`] has a drive train: a current that lags, a compliant transmission, cogging, imbalance and further models of friction.

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
