//! The three bounds of the offset's step (P2), thesis (3.7) to (3.11), on the shipped arithmetic itself.

use crate::format::Format;
use crate::valid::{any_augmentation, augmentation_ok};
use crate::{cover, property, such};
use touchstone_control::{Fixed8, Fixed32, Force, Position};

macro_rules! offset {
    ($(#[doc = $doc:literal])* $module:ident, $number:ident, by $solver:ident) => {
        $(#[doc = $doc])*
        pub mod $module {
            use super::*;
            type N = $number;

            property! {
                /// P2, first bound: `ΔO <= c/k_v · |wanted - shown|`.
                by $solver fn p2_bound_of_ideal(s) {
                    let a = such!(s, any_augmentation::<N, _>(s), |a| augmentation_ok(&a));
                    let (wanted, shown, e) = (N::any_force(s), N::any_force(s), N::any_position(s));
                                        let step = a.step(wanted, shown, e);
                    assert!(step >= Position::zero());
                    assert!(step <= a.of_ideal * (wanted - shown.modulus()).modulus());
                    cover!(s, step > Position::zero() && step == a.of_ideal * (wanted - shown.modulus()).modulus(), "binding");
                    cover!(s, step < a.of_ideal * (wanted - shown.modulus()).modulus(), "not binding");
                }
            }
            property! {
                /// P2, second bound: `ΔO <= b/k_v · |f|`, but at least one quantum is allowed, or no force were a trap.
                by $solver fn p2_bound_of_force(s) {
                    let a = such!(s, any_augmentation::<N, _>(s), |a| augmentation_ok(&a));
                    let (wanted, shown, e) = (N::any_force(s), N::any_force(s), N::any_position(s));
                                        let step = a.step(wanted, shown, e);
                    let weber = a.of_force * shown.modulus().max(Force::quantum());
                    assert!(step <= weber.max(Position::quantum()));
                    cover!(s, step == weber && step > Position::quantum(), "binding");
                    cover!(s, shown == Force::zero() && step == Position::quantum(), "out of the trap");
                }
            }
            property! {
                /// P2, third bound: `ΔO <= a · |e|`.
                by $solver fn p2_bound_of_penetration(s) {
                    let a = such!(s, any_augmentation::<N, _>(s), |a| augmentation_ok(&a));
                    let (wanted, shown, e) = (N::any_force(s), N::any_force(s), N::any_position(s));
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
    /// At the width that the firmware runs.
    w32, Fixed32, by kissat
);
offset!(
    /// At 8 bits: where mutants are refuted quickly.
    w8, Fixed8, by cadical
);
