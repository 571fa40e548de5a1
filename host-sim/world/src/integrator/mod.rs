//! Textbook integration methods for the equations of [`crate::plant`], as other simulators use them.
//!
//! Simulations do not use them: the exact step of [`crate::plant`] is faster and has no step size. They serve for comparison. Each
//! method divides an interval into substeps and has an error that the exact step has not.
//!
//! | method | order | dry friction |
//! |---|---|---|
//! | [`ImplicitEuler`] | 1 | set-valued: true rest, no chatter |
//! | [`ImplicitMidpoint`] | 2 | set-valued at the step's end: true rest |
//! | [`SemiImplicitEuler`] | 1 | takes at most the torque that stops the device |
//! | [`RungeKutta4`] | 4 | smoothed by a `tanh`: the device creeps where it should rest |
//!
//! The orders hold for smooth motion. A stop or a start of the device falls inside a substep, where each method is of first order
//! at best.

mod implicit;
mod model;
mod runge_kutta;
mod semi_implicit_euler;
mod substepped;

pub use implicit::{Implicit, ImplicitEuler, ImplicitMidpoint};
pub use model::{ExactLinear, Model};
pub use runge_kutta::{CREEP_RAD_PER_S, RungeKutta4};
pub use semi_implicit_euler::SemiImplicitEuler;
pub use substepped::Substepped;

use crate::plant::{Coulomb, Invalid, Loss};

/// A one-step integration method, prepared for substeps of one length.
pub trait Method<const N: usize>: Sized {
    /// Order of the method's error over a fixed time, for smooth motion.
    const ORDER: u32;

    /// Prepares substeps of `step_s` seconds, above zero.
    ///
    /// # Errors
    /// [`Invalid`] if the method has no step of this length.
    fn new(model: &Model<N>, step_s: f64) -> Result<Self, Invalid>;

    /// Makes one substep under a held torque and a held rest point of the hand. Computes the losses only if `LOSS` is true.
    fn step<const LOSS: bool>(
        &self,
        model: &Model<N>,
        state: &mut [f64; N],
        held: [f64; 2],
    ) -> Loss;
}

/// The result of set-valued friction in one step.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Reaction {
    /// Friction holds the device with this torque against the motion, N·m.
    Rests(f64),
    /// The device moves against this torque, N·m.
    Slides(f64),
}

impl Reaction {
    /// Finds the friction torque that is consistent with the velocity at the step's end, `free - torque · per_torque`.
    ///
    /// `before` is the velocity at the step's start; `free` would be that at its end without friction.
    #[inline(always)]
    fn of(coulomb: Coulomb, before: f64, free: f64, per_torque: f64) -> Self {
        let stopping = free / per_torque;
        // Whoever turns round comes to rest on the way, and has to break away again.
        let most = if before * free <= 0.0 {
            coulomb.breakaway
        } else {
            coulomb.kinetic
        };
        if stopping.abs() <= most {
            Reaction::Rests(stopping)
        } else {
            Reaction::Slides(coulomb.kinetic.copysign(stopping))
        }
    }

    #[inline(always)]
    fn torque(self) -> f64 {
        match self {
            Reaction::Rests(torque) | Reaction::Slides(torque) => torque,
        }
    }
}

/// Energy that viscous damping and a friction torque dissipate over a substep, J, calculated with the velocities of one state.
#[inline(always)]
fn losses<const N: usize>(model: &Model<N>, at: &[f64; N], friction: f64, step_s: f64) -> Loss {
    let Loss { device_j, hand_j } = model.viscous(at);
    Loss {
        device_j: step_s * (device_j + friction * at[1]),
        hand_j: step_s * hand_j,
    }
}
