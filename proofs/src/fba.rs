//! Properties of force bounding (FBA): the force is at most `sqrt(4 E c_i/T)`, so that no next displacement can make the energy
//! negative. `E` is the energy, `c_i` the device's damping and `T` the control period.
//!
//! Let `b` be the number of fractional bits of a gain. In steps of the number formats, with `c = c_i/T`, three facts about the code
//! imply one fact of arithmetic:
//!
//! ```text
//! f 2^b <= bound root      p5_force_below_bound
//! root² <= E               heart::w32::p5_root_digit, by induction over the digits
//! bound² <= c 2^(b+2)      p5_bound_of_damping
//! => f² 2^b <= 4 c E  =>  2^b (E + f Δ) + c Δ² >= 0 for every Δ       proofs/obligations, in two solvers
//! ```

use crate::facts::Facts32;
use crate::format::Format;
use crate::functions::Functions32;
use crate::valid::Valid;
use crate::{assume, cover, property, such};
use touchstone_control::law::{Fba, FbaState, Law, Sample};
use touchstone_control::observer::damping_loss;
use touchstone_control::{Energy, Fixed8, Force, Number, Position};

macro_rules! fba {
    ($(#[doc = $doc:literal])* $module:ident, $number:ident, functions $functions:ident, by $solver:ident, sums $sums:ident, bound $bound:ident) => {
        $(#[doc = $doc])*
        pub mod $module {
            use super::*;
            type N = $number;
            type F = $functions;

            property! {
                /// P5 (force bounding): the largest force is the law's bound times the root of the energy, rounded towards zero.
                /// With an energy deficit it is 0.
                equation "f 2^b <= bound root(E); E <= 0  =>  f = 0"
                over "valid configuration, energy"
                by $sums fn p5_force_below_bound(s) {
                    let law = such!(s, Fba::<F>::any(s), |law| law.valid(), "validate");
                    let energy = F::any_energy(s);
                    let force = law.largest_force(energy);
                    let root = Position::<F>(F::root(energy.0));
                    assert!(force >= Force::zero());
                    assert!(force.lift() <= law.bound * root);
                    assert!(energy > Energy::zero() || force == Force::zero());
                    cover!(s, force > Force::zero() && force.lift() < law.bound * root, "rounded");
                    cover!(s, force == Force::zero() && energy > Energy::zero(), "too little for one quantum");
                }
            }
            property! {
                /// P1, P3, P4 and the invariant, force bounding: one tick does not panic, its force is at most the limit and never
                /// pulls, and it keeps the invariant. The law's energy is the energy taken at the port plus the counted damping,
                /// and is limited from above only.
                equation "0 <= f <= limit, E <= cap, (E >= 0 or f = 0)"
                over "valid configuration, memory in the invariant, position"
                by $solver fn p4_tick_keeps_invariant(s) {
                    let law = such!(s, Fba::<N>::any(s), |law| law.valid(), "validate");
                    let before = such!(
                        s, <Fba<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p4_*"
                    );
                    let e = N::any_position(s);
                    let sample = Sample { e, moved: N::any_position(s) };
                    let mut state = before;
                    let force = law.tick(&mut state, sample);
                    assert!(law.holds(&state));
                    assert!(force >= Force::zero() && force <= law.limit && force == state.force);
                    cover!(s, force == law.limit && force > Force::zero(), "limit reached");
                    cover!(s, state.energy < Energy::zero(), "deficit");
                    cover!(s, state.energy == law.energy_cap, "cap reached");
                }
            }
            property! {
                /// P5 (force bounding): the force of a tick is at most the largest that the law's energy allows.
                equation "f <= largest(E')"
                over "valid configuration, memory in the invariant, position inside"
                by $sums fn p5_tick_is_bounded(s) {
                    let law = such!(s, Fba::<F>::any(s), |law| law.valid(), "validate");
                    let before = such!(
                        s, <Fba<F> as Valid<F>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p4_*"
                    );
                    let e = F::any_position(s);
                    let sample = Sample { e, moved: F::any_position(s) };
                    assume!(s, e > Position::zero(), "case; outside is p7_leaves");
                    let mut state = before;
                    let force = law.tick(&mut state, sample);
                    let allowed = law.largest_force(state.energy);
                    assert!(force <= allowed);
                    cover!(s, force == allowed && force > Force::zero(), "bound reached");
                    cover!(s, force > Force::zero() && force < allowed, "below the bound");
                }
            }
            property! {
                /// P1 (energy): the energy of force bounding after a tick is the energy before, plus the work of the force that
                /// acted, plus what the damper dissipated.
                equation "E' = min(E + f Δe + c Δe², cap)"
                over "valid configuration, memory in the invariant, position inside"
                by $sums fn p1_energy_is_the_sum(s) {
                    let law = such!(s, Fba::<F>::any(s), |law| law.valid(), "validate");
                    let before = such!(
                        s, <Fba<F> as Valid<F>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p4_*"
                    );
                    let e = F::any_position(s);
                    let sample = Sample { e, moved: F::any_position(s) };
                    assume!(s, e > Position::zero(), "case; outside is p7_leaves");
                    let mut state = before;
                    let _ = law.tick(&mut state, sample);
                    let moved = sample.moved_inside();
                    let work = i128::from(F::of_energy((before.force * moved).0));
                    let loss = i128::from(F::of_energy(damping_loss(law.device_damping, moved).0));
                    let cap = i128::from(F::of_energy(law.energy_cap.0));
                    let worked = i128::from(F::of_energy(before.energy.0)) + work;
                    // The sum is limited only below a deficit of the whole format, 32 kJ.
                    let lowest = -2 * cap;
                    assert!(worked < lowest || i128::from(F::of_energy(state.energy.0)) == (worked + loss).min(cap));
                    cover!(s, state.energy < before.energy, "gives");
                    cover!(s, state.energy > before.energy && moved < Position::zero(), "damped outward");
                }
            }
            property! {
                /// P5 (force bounding): rounding makes the counted damping force too small by less than a step of the number
                /// format. So the energy can become negative by at most that step times the displacement.
                equation "|f_c 2^b| <= |c Δe|, loss >= 0"
                over "valid configuration, displacement"
                by $sums fn p5_damping_rounds_down(s) {
                    let law = such!(s, Fba::<F>::any(s), |law| law.valid(), "validate");
                    let moved = F::any_position(s);
                    let exact = law.device_damping * moved;
                    let force = exact.towards_zero();
                    let size = force.lift().0.unsigned_abs();
                    assert!(size <= exact.0.unsigned_abs());
                    assert!(damping_loss(law.device_damping, moved) >= Energy::zero());
                    cover!(s, size < exact.0.unsigned_abs() && size > 0, "rounded");
                }
            }
            property! {
                /// P5 (force bounding): the factor of the force bound that a new controller stores is at most what its stored
                /// damping allows.
                equation "bound² <= c 2^(b+2)"
                over "damping"
                by $bound fn p5_bound_of_damping(s) {
                    let damping = N::any_stiffness(s);
                    let bound = i128::from(N::of_gain(N::root_of_four(damping.0)));
                    let stored = i128::from(N::of_gain(damping.0)).max(0);
                    assert!(bound >= 0 && bound * bound <= stored << (N::GAIN_BITS + 2));
                    cover!(s, bound > 2 && bound * bound < stored << (N::GAIN_BITS + 2), "rounded");
                    cover!(s, stored == 0, "no damping");
                }
            }
            property! {
                /// P7 (end of contact), force bounding: outside the wall the force is 0 and nothing is remembered.
                equation "e <= 0  =>  f = 0, memory cleared"
                over "valid configuration, memory whatever, position outside"
                fn p7_leaves(s) {
                    let law = such!(s, Fba::<N>::any(s), |law| law.valid(), "validate");
                    let mut state = <Fba<N> as Valid<N>>::any_state(s);
                    let e = N::any_position(s);
                    let sample = Sample { e, moved: N::any_position(s) };
                    assume!(s, e <= Position::zero(), "case; inside is p4_tick_keeps_invariant");
                    cover!(s, state.inside && e == Position::zero(), "from inside");
                    assert!(law.tick(&mut state, sample) == Force::zero());
                    assert_reached!(state == FbaState::default());
                }
            }
        }
    };
}

fba!(
    /// The properties of this file at 32 bits, the width of the firmware. Of products, quotients and roots only the facts of
    /// [`crate::facts`] are used.
    w32, Facts32, functions Functions32, by cadical, sums cadical, bound sampled
);
fba!(
    /// The properties of this file at 8 bits, where the model checker refutes wrong changes of the code quickly.
    w8, Fixed8, functions Fixed8, by cadical, sums kissat, bound cadical
);
