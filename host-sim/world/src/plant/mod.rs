//! The mechanical side: device and hand between two control ticks, exact under a zero-order hold.
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
//! The torque and the rest point are constant during an interval, so the linear part needs no integrator: one
//! precomputed matrix step is the exact solution (Van Loan, IEEE TAC 23(3) 395, 1978). Dry friction adds events, and those
//! are solved for and not stepped over. There is no step size and no accuracy setting in here.
//!
//! Two choices are made when a scene is planned, and are types so that neither costs a branch in a tick:
//!
//! | | no friction | Coulomb friction |
//! |---|---|---|
//! | nobody holds the device | [`BareLinear`] | [`BareCoulomb`] |
//! | a hand holds it | [`HeldLinear`] | [`HeldCoulomb`] |
//!
//! All four are [`Stepper`]s: configuration for one fixed interval, applied to a small separate [`State`]. A
//! computational delay of a fraction of a tick is two steppers, `delay` and `T - delay`, taking turns on one state.
//!
//! Three translations are three axes, each with a stepper of its own, [`Cartesian`], or a mechanism of arms, [`DeltaPlant`].
//!
//! Units are those of a knob (rad, N·m, kg·m²). One axis of a translational device obeys the same equations with
//! m, N and kg; only the names of the fields then say the wrong unit.
//!
//! A current that lags, a transmission that gives, cogging, imbalance and further kinds of friction are a drive train, [`train`].

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
