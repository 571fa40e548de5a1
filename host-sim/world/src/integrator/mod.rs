//! Textbook integration methods for the equations of motion of [`crate::plant`], as other simulators use them.
//!
//! They serve for comparison only. Simulations use the closed-form solution of [`crate::plant`], which is faster and has no step
//! size. Each method here divides an interval into substeps, and has an error that falls with the length of the substeps.
//!
//! | method | order | dry friction |
//! |---|---|---|
//! | [`ImplicitEuler`] | 1 | set-valued: true rest, no chatter |
//! | [`ImplicitMidpoint`] | 2 | set-valued at the step's end: true rest |
//! | [`SemiImplicitEuler`] | 1 | at most the torque that stops the device |
//! | [`RungeKutta4`] | 4 | smoothed by a `tanh`: the device creeps where it should rest |
//!
//! The orders hold for smooth motion. If the device stops or starts within a substep, each method is of first order at best.

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
pub trait Method<const N: usize>: Sized + Send {
    /// Order of the method: exponent of the substep's length in the error over a fixed time, for smooth motion.
    const ORDER: u32;

    /// Prepares substeps of `step_s` seconds, above zero.
    ///
    /// # Errors
    /// [`Invalid`] if the method cannot make a step of this length.
    fn new(model: &Model<N>, step_s: f64) -> Result<Self, Invalid>;

    /// Makes one substep under a constant torque and a constant rest point of the hand. Computes the losses only if `LOSS` is true.
    fn step<const LOSS: bool>(
        &self,
        model: &Model<N>,
        state: &mut [f64; N],
        held: [f64; 2],
    ) -> Loss;
}

/// Effect of dry friction on the device in one substep.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Reaction {
    /// The device is at rest at the substep's end. The value is the friction torque that stopped or held the device, N·m against
    /// positive motion.
    Rests(f64),
    /// The device still moves at the substep's end. The value is the friction torque, N·m against positive motion.
    Slides(f64),
}

impl Reaction {
    /// Computes the friction torque that is consistent with the device's velocity at the substep's end, `free - torque ·
    /// per_torque`.
    ///
    /// `before` is the velocity at the substep's start. `free` is the velocity at its end without friction, and `per_torque` the
    /// change of velocity per friction torque.
    #[inline(always)]
    fn of(coulomb: Coulomb, before: f64, free: f64, per_torque: f64) -> Self {
        let stopping = free / per_torque;
        // A device that reverses comes to rest on the way and has to break away again.
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

/// Energy that the dampers and a friction torque dissipate over a substep, J, computed with the velocities of the state `at`.
#[inline(always)]
fn losses<const N: usize>(model: &Model<N>, at: &[f64; N], friction: f64, step_s: f64) -> Loss {
    let Loss { device_j, hand_j } = model.viscous(at);
    Loss {
        device_j: step_s * (device_j + friction * at[1]),
        hand_j: step_s * hand_j,
    }
}
