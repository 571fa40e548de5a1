//! Properties of the time-domain passivity approach (TDPA): what the law guarantees with each of its two energy observers.

use crate::facts::Facts32;
use crate::format::Format;
use crate::functions::Functions32;
use crate::valid::Valid;
use crate::{assume, cover, property, such};
use touchstone_control::law::{Law, Sample, Tdpa, TdpaState};

use touchstone_control::observer::damping_loss;
use touchstone_control::{Energy, Fixed8, Force, Number, ObserverForm, Position};

macro_rules! tdpa {
    ($(#[doc = $doc:literal])* $module:ident, $number:ident, functions $functions:ident, by $solver:ident, sums $sums:ident, step $step:ident) => {
        $(#[doc = $doc])*
        pub mod $module {
            use super::*;
            type N = $number;
            type F = $functions;

            property! {
                /// P1, P3, P4 and the invariant, TDPA (time-domain passivity) with either observer: one tick does not panic, its
                /// force is at most the limit, and it keeps the invariant. This holds from any memory that satisfies the invariant,
                /// for any configuration and position. With the thesis' observer the invariant contains that the energy is not
                /// negative.
                equation "|f| <= limit, E <= cap; thesis: E >= 0, f >= 0"
                over "valid configuration, memory in the invariant, position"
                by $solver fn p4_tick_keeps_invariant(s) {
                    let law = such!(s, Tdpa::<N>::any(s), |law| law.valid(), "validate");
                    let before = such!(
                        s, <Tdpa<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p4_*"
                    );
                    let e = N::any_position(s);
                    let sample = Sample { e, moved: N::any_position(s) };
                    let mut state = before;
                    let force = law.tick(&mut state, sample);
                    assert!(law.holds(&state));
                    assert!(force.modulus() <= law.limit);
                    assert!(law.observer == ObserverForm::Exact || force >= Force::zero());
                    cover!(s, law.observer == ObserverForm::Thesis && state.energy == Energy::zero() && force > Force::zero(), "thesis, spent");
                    cover!(s, law.observer == ObserverForm::Exact && force < Force::zero(), "exact, pulls");
                    cover!(s, force == law.limit && force > Force::zero(), "limit reached");
                    cover!(s, state.energy == law.energy_cap, "cap reached");
                    cover!(s, before.inside && state.inside && sample.moved < Position::zero(), "outward");
                }
            }
            property! {
                /// P1 (energy), TDPA with the thesis' observer: a tick inside the wall is the passivity step of the stored energy
                /// plus what the counted damper dissipated, at most the cap. With the properties of `heart` it follows that the
                /// energy is not negative and grows by at most that loss and the work of the new force.
                equation "(E', f') = step(min(E + loss, cap), k e, Δe)"
                over "valid configuration, memory in the invariant, position inside"
                by $step fn p1_thesis_is_the_step(s) {
                    let law = such!(s, Tdpa::<F>::any(s), |law| law.valid(), "validate");
                    let before = such!(
                        s, <Tdpa<F> as Valid<F>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p4_*"
                    );
                    let e = F::any_position(s);
                    let sample = Sample { e, moved: F::any_position(s) };
                    assume!(
                        s,
                        law.observer == ObserverForm::Thesis && e > Position::zero(),
                        "case; the exact observer is p1_exact_*, outside p7_leaves"
                    );
                    let mut state = before;
                    let force = law.tick(&mut state, sample);
                    let moved = sample.moved_inside();
                    let wanted = (law.desired * e).towards_zero().min(law.limit);
                    let store = (before.energy + damping_loss(law.device_damping, moved)).min(law.energy_cap);
                    let (after, shown) = F::passivity_step(store.0, wanted.0, moved.0);
                    assert!(force.0 == shown && state.force == force);
                    assert!(state.energy == Energy(after).min(law.energy_cap));
                    cover!(s, force > Force::zero() && force < wanted, "force reduced");
                    cover!(s, force == wanted && moved < Position::zero() && force > Force::zero(), "paid in full");
                }
            }
            property! {
                /// P1 (energy): the counted damper of TDPA (time-domain passivity) never gives energy.
                equation "c Δe² >= 0"
                over "valid configuration, displacement"
                fn p1_loss_is_not_negative(s) {
                    let law = such!(s, Tdpa::<N>::any(s), |law| law.valid(), "validate");
                    let moved = N::any_position(s);
                    let loss = damping_loss(law.device_damping, moved);
                    assert!(loss >= Energy::zero());
                    cover!(s, loss > Energy::zero() && moved < Position::zero(), "outward");
                }
            }
            property! {
                /// P1 (energy), TDPA with the exact observer: the law's energy is the energy taken at the port plus that of the
                /// counted damping, and is limited from above only.
                equation "E' = min(E + f Δe + loss, cap)"
                over "valid configuration, memory in the invariant, position inside"
                by $sums fn p1_exact_is_the_sum(s) {
                    let law = such!(s, Tdpa::<F>::any(s), |law| law.valid(), "validate");
                    let before = such!(
                        s, <Tdpa<F> as Valid<F>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p4_*"
                    );
                    let e = F::any_position(s);
                    let sample = Sample { e, moved: F::any_position(s) };
                    assume!(
                        s,
                        law.observer == ObserverForm::Exact && e > Position::zero(),
                        "case; the thesis' observer is p1_thesis_*, outside p7_leaves"
                    );
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
                    cover!(s, before.energy >= Energy::zero() && state.energy < Energy::zero(), "the dip of one tick");
                    cover!(s, loss > 0 && work < 0, "damped");
                }
            }
            property! {
                /// P1 (energy), TDPA with the exact observer: a corrected force is the quotient of energy and displacement. Its
                /// sign is such that a displacement like the last one pays the deficit back. Without a deficit it is the wall's own
                /// force.
                equation "f = ± |E| / |Δe|, or f_wanted without need"
                over "valid configuration, energy, wanted force, displacement"
                by $sums fn p1_exact_correction(s) {
                    let law = such!(s, Tdpa::<F>::any(s), |law| law.valid(), "validate");
                    let (energy, wanted, moved) = (F::any_energy(s), F::any_force(s), F::any_position(s));
                    assume!(s, wanted >= Force::zero() && energy <= law.energy_cap, "what tick passes: p4_tick_keeps_invariant");
                    let force = law.exact_force(energy, wanted, moved);
                    let repeat = energy + wanted * moved;
                    if moved == Position::zero() || repeat >= Energy::zero() {
                        assert_reached!(force == wanted);
                    } else {
                        let enough = energy.per_displacement(moved);
                        assert!(enough >= Force::zero() && (force == enough || force == -enough));
                        // A surplus is given out in an outward motion; a deficit is worked off by a force against the motion.
                        let absorbs = (force.0 > 0) == (moved.0 > 0);
                        assert!(enough == Force::zero() || absorbs == (energy < Energy::zero()));
                        assert_reached!(energy < Energy::zero() || moved < Position::zero());
                    }
                    cover!(s, force < Force::zero(), "pulls");
                    cover!(s, energy < Energy::zero() && force > wanted, "pushes harder");
                    cover!(s, energy > Energy::zero() && force < wanted && force > Force::zero(), "force reduced");
                    cover!(s, moved == Position::zero() && energy < Energy::zero(), "deficit kept at rest");
                }
            }
            property! {
                /// P7 (end of contact), TDPA (time-domain passivity): outside the wall the force is 0 and nothing is remembered.
                equation "e <= 0  =>  f = 0, memory cleared"
                over "valid configuration, memory whatever, position outside"
                fn p7_leaves(s) {
                    let law = such!(s, Tdpa::<N>::any(s), |law| law.valid(), "validate");
                    let mut state = <Tdpa<N> as Valid<N>>::any_state(s);
                    let e = N::any_position(s);
                    let sample = Sample { e, moved: N::any_position(s) };
                    assume!(s, e <= Position::zero(), "case; inside is p4_tick_keeps_invariant");
                    cover!(s, state.inside && state.energy < Energy::zero() && e == Position::zero(), "with a deficit");
                    assert!(law.tick(&mut state, sample) == Force::zero());
                    assert_reached!(state == TdpaState::default());
                }
            }
        }
    };
}

tdpa!(
    /// The properties of this file at 32 bits, the width of the firmware. Of products, quotients and roots only the facts of
    /// [`crate::facts`] are used.
    w32, Facts32, functions Functions32, by cadical, sums cadical, step cadical
);
tdpa!(
    /// The properties of this file at 8 bits, where the model checker refutes wrong changes of the code quickly. The sums are
    /// proved at 32 bits, and run in random tests at 8.
    w8, Fixed8, functions Fixed8, by cadical, sums sampled, step sampled
);
