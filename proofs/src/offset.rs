//! Properties of the three bounds on the step of the soft spring's offset (P2), thesis (3.7) to (3.11), for the shipped arithmetic.

use crate::format::Format;
use crate::functions::Functions32;
use crate::valid::{any_augmentation, augmentation_ok};
use crate::{cover, property, such};
use touchstone_control::law::Augmentation;
use touchstone_control::{Fixed8, Fixed32, Force, Position};

macro_rules! offset {
    ($(#[doc = $doc:literal])* $module:ident, $number:ident, functions $functions:ident, sums $sums:ident) => {
        $(#[doc = $doc])*
        pub mod $module {
            use super::*;
            type N = $number;
            type F = $functions;

            property! {
                /// P2 (offset): the step of the offset is at most each of three bounds, whatever these are. It is not negative if
                /// no bound is negative. `heart::w32::p2_scale` shows that the bounds are those of thesis (3.7) to (3.11).
                equation "ΔO <= each bound"
                over "three bounds, all bits"
                fn p2_least(s) {
                    let bounds = [N::any_position(s), N::any_position(s), N::any_position(s)];
                    let [ideal, weber, near] = bounds;
                    let step = Augmentation::<N>::least(ideal, weber, near);
                    assert!(step <= ideal);
                    assert!(step <= weber.max(Position::quantum()));
                    assert!(step <= near);
                    assert!(bounds.iter().any(|bound| *bound < Position::zero()) || step >= Position::zero());
                    cover!(s, step == ideal && step < weber && step < near, "ideal binds");
                    cover!(s, step == weber && step < ideal && step < near, "force binds");
                    cover!(s, step == near && step < ideal && step < weber, "penetration binds");
                }
            }
            property! {
                /// P2 (offset), first bound: the step of the offset is at most a coefficient times the difference of requested and
                /// commanded force. The coefficient is a fraction `c` over the soft or the desired stiffness.
                equation "0 <= ΔO <= c |f_wanted - |f||"
                over "valid shares, forces, penetration"
                by $sums fn p2_bound_of_ideal(s) {
                    let a = such!(s, any_augmentation::<F, _>(s), |a| augmentation_ok(&a), "validate");
                    let (wanted, shown, e) = (F::any_force(s), F::any_force(s), F::any_position(s));
                    let step = a.step(wanted, shown, e);
                    assert!(step >= Position::zero());
                    assert!(step <= a.of_ideal * (wanted - shown.modulus()).modulus());
                    cover!(s, step > Position::zero() && step == a.of_ideal * (wanted - shown.modulus()).modulus(), "binding");
                    cover!(s, step < a.of_ideal * (wanted - shown.modulus()).modulus(), "not binding");
                }
            }
            property! {
                /// P2 (offset), second bound: the step of the offset is at most a coefficient times the force. The coefficient is a
                /// fraction `b` over the soft stiffness. At least one step of the number format is allowed; otherwise the offset
                /// could never change at a force of 0.
                equation "ΔO <= b |f|, at least a quantum"
                over "valid shares, forces, penetration"
                by $sums fn p2_bound_of_force(s) {
                    let a = such!(s, any_augmentation::<F, _>(s), |a| augmentation_ok(&a), "validate");
                    let (wanted, shown, e) = (F::any_force(s), F::any_force(s), F::any_position(s));
                    let step = a.step(wanted, shown, e);
                    let weber = a.of_force * shown.modulus().max(Force::quantum());
                    assert!(step <= weber.max(Position::quantum()));
                    cover!(s, step == weber && step > Position::quantum(), "binding");
                    cover!(s, shown == Force::zero() && step == Position::quantum(), "out of the trap");
                }
            }
            property! {
                /// P2 (offset), third bound: the step of the offset is at most a fraction `a` of the penetration.
                equation "ΔO <= a |e|"
                over "valid shares, forces, penetration"
                by $sums fn p2_bound_of_penetration(s) {
                    let a = such!(s, any_augmentation::<F, _>(s), |a| augmentation_ok(&a), "validate");
                    let (wanted, shown, e) = (F::any_force(s), F::any_force(s), F::any_position(s));
                    let step = a.step(wanted, shown, e);
                    assert!(step <= a.of_penetration * e.modulus());
                    cover!(s, step > Position::zero() && step == a.of_penetration * e.modulus(), "binding");
                    cover!(s, step == Position::zero() && e == Position::zero(), "at the surface");
                }
            }
        }
    };
}

offset!(
    /// The properties of this file at 32 bits, the width of the firmware.
    w32, Fixed32, functions Functions32, sums cadical
);
offset!(
    /// The properties of this file at 8 bits, where the model checker refutes wrong changes of the code quickly.
    w8, Fixed8, functions Fixed8, sums cadical
);
