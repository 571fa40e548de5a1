//! Textbook integrators over the same equations as [`crate::plant`]: what another simulator would do in the exact step's place.
//!
//! A run has no use for them: the exact step is both cheaper and free of a step size. They are here to be compared with: each
//! divides an interval into substeps, and each leaves an error that the exact step does not have.
//!
//! | method | order | dry friction |
//! |---|---|---|
//! | [`ImplicitEuler`] | 1 | set-valued: true rest, no chatter |
//! | [`ImplicitMidpoint`] | 2 | set-valued at the step's end: true rest |
//! | [`SemiImplicitEuler`] | 1 | takes at most what stops the device |
//! | [`RungeKutta4`] | 4 | smoothed by a `tanh`: the device creeps where it should rest |
//!
//! Orders are those of smooth motion. At a stop or a start, which falls inside a substep, each is of first order at best.

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

/// A one-step method, prepared for substeps of one length.
pub trait Method<const N: usize>: Sized {
    /// Order of its error over a fixed time, where the motion is smooth.
    const ORDER: u32;

    /// Prepares substeps of `step_s` seconds, above zero.
    ///
    /// # Errors
    /// [`Invalid`] where the method has no step of this length.
    fn new(model: &Model<N>, step_s: f64) -> Result<Self, Invalid>;

    /// Makes one substep under a held torque and rest point; losses are computed only with `LOSS`.
    fn step<const LOSS: bool>(
        &self,
        model: &Model<N>,
        state: &mut [f64; N],
        held: [f64; 2],
    ) -> Loss;
}

/// What friction does in one set-valued step.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Reaction {
    /// Friction holds the device with this torque against the motion, N·m.
    Rests(f64),
    /// The device moves against this torque, N·m.
    Slides(f64),
}

impl Reaction {
    /// The torque for which the velocity at the step's end, `free - torque · per_torque`, and the torque agree; `before` is the
    /// velocity at its start.
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

/// What viscous damping and a torque of friction took over a substep, by the velocities of one state.
#[inline(always)]
fn losses<const N: usize>(model: &Model<N>, at: &[f64; N], friction: f64, step_s: f64) -> Loss {
    let Loss { device_j, hand_j } = model.viscous(at);
    Loss {
        device_j: step_s * (device_j + friction * at[1]),
        hand_j: step_s * hand_j,
    }
}
