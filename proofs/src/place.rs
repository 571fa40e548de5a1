//! P11 (refinement): the estimator of a place in space consists of one position estimator per axis, for any results of these.
//!
//! The model checker replaces the three estimators' functions by recorders. A recorder's result depends on its arguments, on its
//! estimator and on the last command. [`crate::estimated`] proves that an estimator's tick equals its specification.

use crate::cover;
use crate::estimator::{any, ok};
use crate::format::Format as _;
use crate::source::Source;
use touchstone_control::estimator::EstimatorState;
use touchstone_control::space::{PlaceEstimator, Vector};
use touchstone_control::{Estimator, Fixed32, Position};

#[cfg(kani)]
use touchstone_control::{
    Force, Number, estimator::EstimatedMotion, law::Sample, number::Wide as _,
};

type N = Fixed32;

/// Defines a property of the place estimator that holds whatever its three estimators return.
macro_rules! placed_property {
    ($($property:tt)*) => {
        $crate::replaced_property! {
            [(touchstone_control::Estimator::tick, $crate::place::recorded)
            (touchstone_control::Estimator::commanded, $crate::place::told)]
            $($property)*
        }
    };
}

/// Replaces [`Estimator::tick`]. As position it returns the measured position. As displacement it returns the estimator's limit if
/// that was the last command, otherwise the position before.
#[cfg(kani)]
pub fn recorded<N: Number>(
    law: &Estimator<N>,
    state: &mut EstimatorState<N>,
    measured: Position<N>,
) -> Sample<N> {
    let before = state.motion.unwrap_or_default();
    state.motion = Some(EstimatedMotion::standing(measured));
    let limited = state.commands[0] == N::widen(law.limit.0).torque_part();
    Sample {
        e: measured,
        moved: Position(if limited {
            law.limit.0
        } else {
            N::narrow(before.position)
        }),
    }
}
/// Replaces [`Estimator::commanded`]: records the force as the last command.
#[cfg(kani)]
pub fn told<N: Number>(_: &Estimator<N>, state: &mut EstimatorState<N>, force: Force<N>) {
    state.commands[0] = N::widen(force.0).torque_part();
}

placed_property! {
    /// P11 (refinement): two ticks of the place estimator are those of three estimators that get the negative coordinates, with the
    /// sign of their results reversed. A commanded force is reported to each axis' estimator.
    equation "(x', Δx')_i = -tick_i(-x_i), commanded_i(f_i)"
    over "three estimators, of which the recorder stands for any; two measured places, a force"
    by cadical fn p11_place_estimator(s) {
        let laws: [Estimator<N>; 3] = core::array::from_fn(|_| any_in_range(s));
        let mut place = PlaceEstimator::new(laws);
        let mut states = [EstimatorState::<N>::default(); 3];
        let mut round = 0;
        while round < 2 {
            let at = core::array::from_fn(|_| N::any_position(s));
            let force = core::array::from_fn(|_| N::any_force(s));
            let ahead = place.tick(Vector(at));
            let mut i = 0;
            while i < 3 {
                let sample = laws[i].tick(&mut states[i], Position::zero() - at[i]);
                assert!(ahead.at.0[i] == Position::zero() - sample.e);
                assert_reached!(ahead.moved.0[i] == Position::zero() - sample.moved);
                laws[i].commanded(&mut states[i], force[i]);
                i += 1;
            }
            place.commanded(Vector(force));
            cover!(s, round == 1 && ahead.moved.0[2] > Position::zero() && ahead.at.0[2] < Position::zero(), "back");
            round += 1;
        }
    }
}

/// A state estimator with any coefficients; in random tests one that settings can give.
fn any_in_range<S: Source>(s: &mut S) -> Estimator<N> {
    loop {
        let law = any(s);
        if cfg!(kani) || ok(&law) {
            return law;
        }
    }
}
