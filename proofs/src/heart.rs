//! The unsigned heart, `touchstone_control::magnitude`: one nonlinear fact per property.
//!
//! Magnitudes of signed words are at most `2^(BITS-1)`; energies at most the signed limit of the double width. That is all
//! that is assumed, and the types of the callers enforce it.

use crate::source::Source;
use crate::{assume, cover, property};
use touchstone_control::magnitude::{
    Root, Word, affordable, passivity_step, quotient, root, root_digit, scale,
};

macro_rules! heart {
    ($(#[doc = $doc:literal])* $module:ident, $word:ident, $wide:ident, products $products:ident, bits $bits:ident) => {
        $(#[doc = $doc])*
        pub mod $module {
            use super::*;
            const LARGEST: $word = 1 << ($word::BITS - 1);
            const FULL: $wide = $wide::MAX >> 1;

            property! {
                /// P1, inward: the wall stores at most the work, and exactly the work below the cap; the force stays.
                by $products
                fn p1_step_inward(s) {
                    let (energy, force, moved) = (s.$wide(), s.$word(), s.$word());
                    assume!(s, energy <= FULL && force <= LARGEST && moved <= LARGEST);
                    let step = passivity_step::<$word>(energy, force, moved, true);
                    let sum = energy + $wide::from(force) * $wide::from(moved);
                    assert!(step.force == force);
                    assert!(step.energy <= sum);
                    assert!(step.energy == sum || step.energy == FULL);
                    cover!(s, sum > FULL, "cap reached");
                    cover!(s, sum < FULL && sum > energy, "stored");
                    cover!(s, energy == 0 && sum > 0, "from an empty store");
                }
            }
            property! {
                /// P1, outward, with enough energy: exactly the work is given, the force stays.
                by $products
                fn p1_step_paid(s) {
                    let (energy, force, moved) = (s.$wide(), s.$word(), s.$word());
                    assume!(s, energy <= FULL && force <= LARGEST && moved <= LARGEST);
                    let work = $wide::from(force) * $wide::from(moved);
                    assume!(s, work <= energy);
                    let step = passivity_step::<$word>(energy, force, moved, false);
                    assert!(step.force == force);
                    assert!(step.energy == energy - work);
                    cover!(s, work == energy && work > 0, "spent to the last quantum");
                    cover!(s, work == 0 && energy > 0, "no work");
                    cover!(s, work > 0 && work < energy, "some left");
                }
            }
            property! {
                /// P1, outward, without enough: a smaller force, exactly its work is given, less than one quantum of force is
                /// withheld.
                by $products
                fn p1_step_clamped(s) {
                    let (energy, force, moved) = (s.$wide(), s.$word(), s.$word());
                    assume!(s, energy <= FULL && force <= LARGEST && moved <= LARGEST);
                    assume!(s, $wide::from(force) * $wide::from(moved) > energy);
                    let step = passivity_step::<$word>(energy, force, moved, false);
                    let work = $wide::from(step.force) * $wide::from(moved);
                    assert!(work <= energy);
                    assert!(step.energy == energy - work);
                    cover!(s, step.force > 0 && step.force < force, "force reduced");
                    cover!(s, step.force == 0, "no force left");
                    cover!(s, step.energy > 0, "a rest stays");
                }
            }
            property! {
                /// P1/P4, outward, without enough: the force shrinks, and no more than needed: less than `moved` is left.
                by $products
                fn p1_step_force_shrinks(s) {
                    let (energy, force, moved) = (s.$wide(), s.$word(), s.$word());
                    assume!(s, energy <= FULL && force <= LARGEST && moved <= LARGEST);
                    assume!(s, $wide::from(force) * $wide::from(moved) > energy);
                    let step = passivity_step::<$word>(energy, force, moved, false);
                    assert!(step.force <= force);
                    assert!(step.energy < $wide::from(moved));
                    cover!(s, step.force + 1 == force, "reduced by one quantum");
                    cover!(s, moved == LARGEST, "largest displacement");
                }
            }
            property! {
                /// P1 for the enhanced law: what a retreat costs at full force and what is left make up the energy.
                by $products
                fn p1_affordable(s) {
                    let (energy, force) = (s.$wide(), s.$word());
                    assume!(s, energy <= FULL && force <= LARGEST && force > 0);
                    let retreat = affordable::<$word>(energy, force);
                    let cost = $wide::from(force) * $wide::from(retreat.moved);
                    assert!(cost <= energy);
                    assert!(retreat.rest == energy - cost);
                    cover!(s, retreat.moved == <$word>::MAX_SIGNED, "end of the format");
                    cover!(s, retreat.moved == 0 && energy > 0, "too little for one step");
                    cover!(s, retreat.rest > 0 && retreat.moved > 1, "a rest stays");
                }
            }
            property! {
                /// P1 for the enhanced law: with a smaller force, rest plus saving is exactly the energy minus the work.
                by $products
                fn p1_smaller_force(s) {
                    let (energy, force, smaller) = (s.$wide(), s.$word(), s.$word());
                    assume!(s, energy <= FULL && force <= LARGEST && force > 0 && smaller <= force);
                    let retreat = affordable::<$word>(energy, force);
                    let work = $wide::from(smaller) * $wide::from(retreat.moved);
                    let saved = $wide::from(force - smaller) * $wide::from(retreat.moved);
                    assert!(retreat.rest + saved + work == energy);
                    cover!(s, smaller > 0 && saved > 0 && work > 0 && retreat.rest > 0, "all parts");
                    cover!(s, smaller == force, "full force");
                    cover!(s, smaller == 0, "no force");
                }
            }
            property! {
                /// P5/P8: a digit keeps `square = root² <= radicand`.
                by $products
                fn p5_root_digit(s) {
                    let (radicand, so_far, bit) = (s.$wide(), s.$word(), s.$word());
                    let square = $wide::from(so_far) * $wide::from(so_far);
                    assume!(s, square <= radicand);
                    let next = root_digit::<$word>(Root { root: so_far, square }, radicand, bit);
                    assert!(next.square <= radicand);
                    assert!(next.root == so_far || next.square == next.root.times(next.root));
                    assert!(next.root != so_far || next.square == square);
                    cover!(s, next.root > so_far, "kept");
                    cover!(s, next.root == so_far && bit > 0, "refused");
                }
            }
            property! {
                /// P5/P3: the square found never exceeds the radicand; no overflow.
                fn p5_root(s) {
                    let radicand = s.$wide();
                    let found = root::<$word>(radicand);
                    assert!(found.square <= radicand);
                    cover!(s, found.root > 2 && found.square == radicand, "perfect square");
                    cover!(s, found.root == $word::MAX, "largest root");
                    cover!(s, found.root == 0, "no root");
                }
            }
            property! {
                /// P2: a gain rounds towards zero: `scale(g, x) · 2^bits <= g·x`, and the rest is below one quantum.
                by $bits
                fn p2_scale(s) {
                    let (gain, x) = (s.$word(), s.$word());
                    assume!(s, gain <= LARGEST && x <= LARGEST);
                    const BITS: u32 = $word::BITS * 3 / 4;
                    let product = gain.times(x);
                    let scaled = scale::<$word>(gain, x, BITS).widen();
                    assert!(scaled << BITS <= product);
                    assert!(product - (scaled << BITS) < 1 << BITS || scaled == <$word>::MAX_SIGNED.widen());
                    cover!(s, scaled > 1 && scaled << BITS < product, "rounded");
                    cover!(s, scaled == <$word>::MAX_SIGNED.widen(), "saturated");
                    cover!(s, scaled == 0 && product > 0, "lost");
                }
            }
            property! {
                /// P6: a quotient rounds towards zero: `quotient·divisor <= dividend`.
                by $products
                fn p6_quotient(s) {
                    let (wide, divisor) = (s.$wide(), s.$word());
                    assume!(s, divisor <= LARGEST);
                    let q = quotient::<$word>(wide, divisor);
                    assert!(q.times(divisor) <= wide);
                    assert!(q <= <$word>::MAX_SIGNED);
                    cover!(s, divisor == 0, "no divisor");
                    cover!(s, q > 1 && q.times(divisor) < wide, "rounded");
                    cover!(s, q == <$word>::MAX_SIGNED, "saturated");
                }
            }
        }
    };
}

heart!(
    /// At the width that the firmware runs.
    w32, u32, u64, products cvc5, bits kissat
);
heart!(
    /// At 8 bits: where mutants are refuted quickly.
    w8, u8, u16, products cadical, bits cadical
);

/// The second witnesses: the same facts from the contract of the division alone, by a SAT solver.
#[cfg(kani)]
mod contract {
    use super::*;
    use touchstone_control::magnitude::{divide_u8, divide_u32};

    /// The contract of the one division, at full width.
    #[kani::proof_for_contract(divide_u32)]
    #[kani::solver(kissat)]
    fn p1_divide_u32() {
        let (wide, by) = (kani::any(), kani::any());
        let r = divide_u32(wide, by);
        kani::cover!(r.0 > 1 && r.1 < wide, "rounded");
    }
    /// The same at 8 bits, for mutants.
    #[kani::proof_for_contract(divide_u8)]
    fn p1_divide_u8() {
        let (wide, by) = (kani::any(), kani::any());
        let r = divide_u8(wide, by);
        kani::cover!(r.0 > 1 && r.1 < wide, "rounded");
    }
    /// P1 by the contract: never more energy than before, less than `moved` after a correction, never more force.
    #[kani::proof]
    #[kani::stub_verified(divide_u32)]
    fn p1_step_by_contract() {
        let (energy, force, moved): (u64, u32, u32) = (kani::any(), kani::any(), kani::any());
        kani::assume(energy <= u64::MAX >> 1 && force <= 1 << 31 && moved <= 1 << 31);
        let step = passivity_step::<u32>(energy, force, moved, false);
        assert!(step.energy <= energy);
        assert!(step.force <= force);
        let paid = force.times(moved) <= energy;
        assert!(paid || step.energy < u64::from(moved));
        kani::cover!(
            !paid && step.force > 0 && step.force < force,
            "force reduced"
        );
        kani::cover!(paid && step.energy < energy, "paid");
    }
}
