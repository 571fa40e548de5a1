//! Properties of the signed functions of `Number`: each has a result for every input (P3). The functions on which other proofs
//! build equal the unsigned functions of `control::magnitude` ([`crate::heart`]) on the absolute values, with the sign restored.

use crate::format::Format;
use crate::{assume, cover, property};
use touchstone_control::magnitude::{self, Word};
use touchstone_control::{Energy, Fixed8, Fixed32, Force, Number, Position, Stiffness, Tension};

macro_rules! edges {
    ($(#[doc = $doc:literal])* $module:ident, $number:ident, $word:ident, $wide:ident, products $products:ident, quotients $quotients:ident, bits $bits:ident) => {
        $(#[doc = $doc])*
        pub mod $module {
            use super::*;
            type N = $number;

            property! {
                /// P1 (energy): the signed passivity step is the unsigned step of the absolute values, which [`crate::heart`]
                /// proves; negative energies and forces count as 0.
                equation "(E', f') = heart(max(E, 0), max(f, 0), |d|, d >= 0)"
                over "energy, force, displacement"
                by $products fn p1_edge_step(s) {
                    let (energy, force, moved) = (N::any_energy(s), N::any_force(s), N::any_position(s));
                    let (after, shown) = N::passivity_step(energy.0, force.0, moved.0);
                    // The operands are written as in the code, so that a solver that works on terms recognises the same products.
                    let heart = magnitude::passivity_step::<$word>(
                        energy.0.to_bits().max(0).unsigned_abs(),
                        force.0.max(Force::<N>::zero().0).to_bits().unsigned_abs(),
                        moved.0.to_bits().unsigned_abs(),
                        !moved.0.is_negative(),
                    );
                    assert!(after >= 0 && shown >= 0);
                    assert!(shown.to_bits().unsigned_abs() == heart.force);
                    assert!(after.to_bits().unsigned_abs() == heart.energy);
                    cover!(s, moved.0 < 0 && shown > 0 && shown < force.0, "force reduced");
                    cover!(s, moved.0 == N::LOWEST, "largest displacement outward");
                }
            }
            property! {
                /// P1 (energy): the distance that energy pays for, and the energy left, are those of the unsigned function that
                /// [`crate::heart`] proves; negative energies count as 0.
                equation "(m, r) = heart(max(E, 0), |f|)"
                over "force and stored energy"
                by $quotients fn p1_edge_affordable(s) {
                    let (force, energy) = (N::any_force(s), N::any_energy(s));
                    let (moved, rest) = energy.affordable(force);
                    let heart = magnitude::affordable::<$word>(
                        energy.0.to_bits().max(0).unsigned_abs(),
                        force.0.to_bits().unsigned_abs(),
                    );
                    assert!(moved >= Position::zero() && rest >= Energy::zero());
                    assert!(moved.0.to_bits().unsigned_abs() == heart.moved);
                    assert!(rest.0.to_bits().unsigned_abs() == heart.rest);
                    cover!(s, moved > Position::zero() && rest > Energy::zero(), "retreat with a rest");
                }
            }
            property! {
                /// P1 (energy): force times displacement is the exact energy: its absolute value is the product of the absolute
                /// values.
                equation "W = f d"
                over "force and displacement"
                by $bits fn p1_edge_work(s) {
                    let (force, moved) = (N::any_force(s), N::any_position(s));
                    let work = (force * moved).0.to_bits();
                    let product = $wide::from(force.0.to_bits()) * $wide::from(moved.0.to_bits());
                    assert!(work == product);
                    cover!(s, work < 0, "given");
                    cover!(s, force.0 == N::LOWEST && moved.0 == N::LOWEST, "largest");
                }
            }
            property! {
                /// P1 (energy): the force that works off an energy deficit is energy divided by displacement, by the unsigned
                /// function that [`crate::heart`] proves.
                equation "|E / d| = heart(|E|, |d|)"
                over "displacement and energy"
                by $quotients fn p1_edge_per(s) {
                    let (moved, energy) = (N::any_position(s), N::any_energy(s));
                    assume!(s, moved.0 != 0, "case; at rest there is nothing to work off over: tdpa::p1_exact_correction");
                    let force = energy.per_displacement(moved).0;
                    let heart = magnitude::quotient::<$word>(
                        energy.0.to_bits().unsigned_abs(),
                        moved.0.to_bits().unsigned_abs(),
                    );
                    assert!(force >= 0);
                    assert!(force.to_bits().unsigned_abs() == heart);
                    cover!(s, energy.0 < 0 && moved.0 < 0 && force > 0, "deficit, outward");
                }
            }
            property! {
                /// P2 (rounding): a ratio times a position or force keeps the sign; its absolute value is that of the unsigned
                /// `scale`, which [`crate::heart`] proves.
                equation "|r x| = heart(|r|, |x|), sign of x"
                over "ratio >= 0 and signal"
                by $bits fn p2_edge_scale(s) {
                    let (ratio, x) = (N::any_ratio(s), N::any_position(s));
                    assume!(s, ratio.0 >= 0, "validate");
                    let scaled = (ratio * x).0.to_bits();
                    // The operands are written as in the code, as above.
                    let heart = magnitude::scale::<$word>(
                        ratio.0.to_bits() as $word,
                        x.0.to_bits().unsigned_abs(),
                        N::SIGNAL_BITS,
                    );
                    assert!(scaled.unsigned_abs() == heart);
                    assert!(scaled == 0 || (scaled < 0) == (x.0 < 0));
                    cover!(s, scaled < 0, "negative");
                    cover!(s, heart == $word::MAX >> 1, "saturated");
                }
            }
            property! {
                /// P6 (rounding): the quotient of a tension (stiffness times position) keeps the sign; its absolute value is the
                /// unsigned quotient, which [`crate::heart`] proves.
                equation "|p / k| = heart(|p|, |k|), sign of p"
                over "stiffness above 0 and tension"
                by $quotients fn p6_edge_divide(s) {
                    let (k, tension) = (N::any_stiffness(s), N::any_tension(s));
                    assume!(s, k.0 > 0, "validate; by 0 it is 0: p3_total");
                    let x = tension.over(k).0.to_bits();
                    let heart = magnitude::quotient::<$word>(tension.0.unsigned_abs(), k.0.to_bits().unsigned_abs());
                    assert!(x.unsigned_abs() == heart);
                    assert!(x == 0 || (x < 0) == (tension.0 < 0));
                    cover!(s, x < 0, "negative");
                }
            }
            property! {
                /// P2/P4: rounding a tension (stiffness times position) to a force towards zero removes less than a step of the
                /// number format and never makes it larger.
                equation "0 <= |p| - |f 2^b| < 2^b"
                over "tension"
                fn p2_edge_round_to_zero(s) {
                    let tension = N::any_tension(s);
                    let force = tension.towards_zero();
                    let (size, back) = (tension.0.unsigned_abs(), force.lift().0.unsigned_abs());
                    assert!(back <= size);
                    assert!(size - back < 1 << N::GAIN_BITS || force.0.to_bits().unsigned_abs() == <$word>::MAX_SIGNED);
                    assert!(force.0 == 0 || (force.0 < 0) == (tension.0 < 0));
                    cover!(s, force.0 < 0 && back < size, "negative, rounded");
                    cover!(s, tension.0 == $wide::MIN, "lowest tension");
                }
            }
            property! {
                /// P6 (rounding): rounding a tension (stiffness times position) up never gives less than the tension, unless it
                /// saturates, and adds less than a step of the number format.
                equation "0 <= f 2^b - p < 2^b"
                over "tension"
                fn p6_edge_round_up(s) {
                    let tension = N::any_tension(s);
                    let force = tension.rounded_up();
                    let lifted = force.lift();
                    let saturated = force.0.to_bits().unsigned_abs() == <$word>::MAX_SIGNED;
                    assert!(saturated || lifted >= tension);
                    assert!(saturated || lifted.0 - tension.0 < 1 << N::GAIN_BITS);
                    cover!(s, !saturated && lifted > tension && force.0 < 0, "negative, rounded");
                    cover!(s, tension == Tension::zero(), "zero");
                }
            }
            property! {
                /// P3 (arithmetic): all other functions of `Number` have a result for any input: no panic and no overflow.
                equation "no panic, no overflow"
                over "argument of every operation, all bits"
                by $bits fn p3_total(s) {
                    let (a, b) = (N::any_position(s), N::any_position(s));
                    let (k, r) = (N::any_stiffness(s), N::any_ratio(s));
                    let (p, q) = (N::any_tension(s), N::any_tension(s));
                    let (d, e) = (N::any_energy(s), N::any_energy(s));
                    let _ = (a + b, a - b, -a, a.modulus(), a.within(b), r * a, k * a);
                    let _ = (p + q, p - q, p.towards_zero(), p.rounded_up(), p.over(k));
                    let _ = (d + e, d - e, d.per_displacement(a), N::half_energy_up(d.0));
                    let _ = N::passivity_step(d.0, a.0, b.0);
                    let _ = d.affordable(Force(a.0));
                    assert!(p.over(Stiffness::zero()).0 == 0);
                    cover!(s, a.0 == N::LOWEST && d.0.to_bits() == $wide::MIN, "lowest values");
                }
            }
            property! {
                /// P3 (arithmetic): a sum of two positions or forces is exact or at the end of the range; calculating it in a wider
                /// word loses nothing.
                equation "a + b = min(max(a + b, lowest), highest)"
                over "pair of signals"
                fn p3_sums_saturate(s) {
                    let (a, b) = (N::any_position(s), N::any_position(s));
                    let exact = N::of_signal(a.0) + N::of_signal(b.0);
                    let sum = N::of_signal((a + b).0);
                    assert!(sum == exact.clamp(N::of_signal(N::LOWEST), N::of_signal(N::HIGHEST)));
                    let exact = N::of_signal(a.0) - N::of_signal(b.0);
                    let difference = N::of_signal((a - b).0);
                    assert!(difference == exact.clamp(N::of_signal(N::LOWEST), N::of_signal(N::HIGHEST)));
                    cover!(s, exact > sum, "end of the range");
                }
            }
        }
    };
}

edges!(
    /// The properties of this file at 32 bits, the width of the firmware.
    w32, Fixed32, u32, i64, products cvc5, quotients cvc5, bits kissat
);
edges!(
    /// The properties of this file at 8 bits, where the model checker refutes wrong changes of the code quickly. Quotients are
    /// tried on all inputs (`examples/every.rs`).
    w8, Fixed8, u8, i16, products kissat, quotients sampled, bits cadical
);
