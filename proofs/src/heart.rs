//! Properties of the unsigned functions of `touchstone_control::magnitude`, on which all signed arithmetic builds: one nonlinear
//! fact per property.
//!
//! Absolute values of signed words are at most `2^(BITS-1)`; energies are at most the signed limit of the double width. The
//! properties assume no more than that, and the types of the callers ensure it.

use crate::{assume, cover, property, replaced_property};
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
                /// P1 (energy), motion inward against the force: the wall stores exactly the work, up to the largest energy of the
                /// signed format; the force stays.
                equation "E' = min(E + f d, highest), f' = f"
                over "energy, force, displacement"
                by $bits fn p1_step_inward(s) {
                    let (energy, force, moved) = (s.$wide(), s.$word(), s.$word());
                    assume!(s, energy <= FULL && force <= LARGEST && moved <= LARGEST, "types of the callers");
                    let step = passivity_step::<$word>(energy, force, moved, true);
                    // A product of two words fits the double width, so it does not wrap.
                    let sum = energy + $wide::from(force).wrapping_mul(moved.into());
                    assert!(step.force == force);
                    assert!(step.energy == sum.min(FULL));
                    cover!(s, sum > FULL, "cap reached");
                    cover!(s, sum < FULL && sum > energy, "stored");
                    cover!(s, energy == 0 && sum > 0, "from an empty store");
                }
            }
            property! {
                /// P1 (energy), motion outward with enough stored energy: the wall gives exactly the work, and the force stays.
                equation "f d <= E  =>  E' = E - f d, f' = f"
                over "energy, force, displacement"
                by $products
                fn p1_step_paid(s) {
                    let (energy, force, moved) = (s.$wide(), s.$word(), s.$word());
                    assume!(s, energy <= FULL && force <= LARGEST && moved <= LARGEST, "types of the callers");
                    let work = $wide::from(force) * $wide::from(moved);
                    assume!(s, work <= energy, "case; the other is p1_step_clamped_*");
                    let step = passivity_step::<$word>(energy, force, moved, false);
                    assert!(step.force == force);
                    assert!(step.energy == energy - work);
                    cover!(s, work == energy && work > 0, "spent to the last quantum");
                    cover!(s, work == 0 && energy > 0, "no work");
                    cover!(s, work > 0 && work < energy, "some left");
                }
            }
            property! {
                /// P1 (energy), motion outward without enough stored energy: the energy that is left is the remainder of the
                /// division, so the wall gives exactly the work of the reduced force.
                equation "f d > E  =>  E' = E - floor(E / d) d"
                over "energy, force, displacement"
                by $products fn p1_step_clamped_energy(s) {
                    let (energy, force, moved) = (s.$wide(), s.$word(), s.$word());
                    assume!(s, energy <= FULL && force <= LARGEST && moved <= LARGEST, "types of the callers");
                    assume!(s, $wide::from(force) * $wide::from(moved) > energy, "case; the other is p1_step_paid");
                    let step = passivity_step::<$word>(energy, force, moved, false);
                    let work = energy / $wide::from(moved) * $wide::from(moved);
                    assert!(work <= energy);
                    assert!(step.energy == energy - work);
                    cover!(s, step.force > 0 && step.force < force, "force reduced");
                    cover!(s, step.force == 0, "no force left");
                    cover!(s, step.energy > 0, "a rest stays");
                }
            }
            property! {
                /// P1 (energy), motion outward without enough stored energy: the reduced force is energy divided by displacement.
                /// The two limits of the force in the code never bind.
                equation "f d > E  =>  f' = floor(E / d)"
                over "energy, force, displacement"
                by $products fn p1_step_clamped_force(s) {
                    let (energy, force, moved) = (s.$wide(), s.$word(), s.$word());
                    assume!(s, energy <= FULL && force <= LARGEST && moved <= LARGEST, "types of the callers");
                    assume!(s, $wide::from(force) * $wide::from(moved) > energy, "case; the other is p1_step_paid");
                    let step = passivity_step::<$word>(energy, force, moved, false);
                    assert!($wide::from(step.force) == energy / $wide::from(moved));
                    cover!(s, step.force > 0 && step.force < force, "force reduced");
                    cover!(s, step.force == 0, "no force left");
                }
            }
            property! {
                /// P1/P4, motion outward without enough stored energy: the force is reduced by no more than needed. The remaining
                /// energy would not pay for one more step of the force over the displacement.
                equation "f d > E  =>  f' <= f, E' < d"
                over "energy, force, displacement"
                by $products
                fn p1_step_force_shrinks(s) {
                    let (energy, force, moved) = (s.$wide(), s.$word(), s.$word());
                    assume!(s, energy <= FULL && force <= LARGEST && moved <= LARGEST, "types of the callers");
                    assume!(s, $wide::from(force) * $wide::from(moved) > energy, "case; the other is p1_step_paid");
                    let step = passivity_step::<$word>(energy, force, moved, false);
                    assert!(step.force <= force);
                    assert!(step.energy < $wide::from(moved));
                    cover!(s, step.force + 1 == force, "reduced by one quantum");
                    cover!(s, moved == LARGEST, "largest displacement");
                }
            }
            property! {
                /// P1 (energy) for the enhanced law: the work of an outward motion at full force and the energy that is left sum to
                /// the energy before.
                equation "r = E - f m >= 0"
                over "energy and force"
                by $products
                fn p1_affordable(s) {
                    let (energy, force) = (s.$wide(), s.$word());
                    assume!(
                        s,
                        energy <= FULL && force <= LARGEST && force > 0,
                        "types of the callers; the law retreats under a force only"
                    );
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
                /// P1 (energy): quotient times divisor is at most the energy, and the remainder is less than the divisor (the
                /// displacement). The reduced force relies on this lemma; a second solver confirms the lemma.
                equation "q d <= E < q d + d"
                over "energy and displacement"
                by $bits fn p1_divide(s) {
                    let (energy, moved) = (s.$wide(), s.$word());
                    assume!(s, moved > 0, "the code asks for the quotient only if it moved");
                    let (quotient, accounted) = moved.divides(energy);
                    assert!(accounted <= energy);
                    assert!(energy - accounted < moved.widen());
                    assert!(quotient <= energy);
                    cover!(s, quotient > 1 && accounted < energy, "rounded");
                    cover!(s, accounted == energy && quotient > 1, "no rest");
                }
            }
            property! {
                /// P1 (energy), by a SAT solver: in a motion outward the stored energy never grows and never gets negative.
                equation "0 <= E' <= E"
                over "energy, force, displacement"
                by minisat fn p1_step_remainder(s) {
                    let (energy, force, moved) = (s.$wide(), s.$word(), s.$word());
                    assume!(s, energy <= FULL && force <= LARGEST && moved <= LARGEST, "types of the callers");
                    let step = passivity_step::<$word>(energy, force, moved, false);
                    assert!(step.energy <= energy);
                    cover!(s, step.force > 0 && step.force < force, "force reduced");
                    cover!(s, step.force == force && step.energy < energy, "paid");
                }
            }
            property! {
                /// P5 (roots): a digit of a square root is kept, with the new square, if that square does not exceed the radicand;
                /// otherwise nothing changes. By induction `square = root² <= radicand` for the whole root.
                equation "s' = r'² <= E, or nothing changed"
                over "radicand, candidate, root so far"
                by $products fn p5_root_digit(s) {
                    let (radicand, candidate) = (s.$wide(), s.$word());
                    let so_far = Root::<$word> { root: s.$word(), square: s.$wide() };
                    let next = root_digit(so_far, radicand, candidate);
                    let square = $wide::from(candidate) * $wide::from(candidate);
                    if square <= radicand {
                        assert_reached!(next.root == candidate && next.square == square);
                    } else {
                        assert_reached!(next == so_far);
                    }
                    cover!(s, square > 0 && square == radicand, "perfect square");
                    cover!(s, square > radicand, "refused");
                }
            }
            property! {
                /// P2 (rounding): a position or force times a gain with `bits` fractional bits rounds towards zero: `scale(g, x) ·
                /// 2^bits <= g·x`.
                equation "(g x >> b) 2^b <= g x"
                over "gain and signal"
                by $bits
                fn p2_scale(s) {
                    let (gain, x) = (s.$word(), s.$word());
                    assume!(s, gain <= LARGEST && x <= LARGEST, "types of the callers");
                    const BITS: u32 = $word::BITS * 3 / 4;
                    let product = gain.times(x);
                    let scaled = scale::<$word>(gain, x, BITS).widen();
                    assert!(scaled << BITS <= product);
                    cover!(s, scaled > 1 && scaled << BITS < product, "rounded");
                    cover!(s, scaled == <$word>::MAX_SIGNED.widen(), "saturated");
                    cover!(s, scaled == 0 && product > 0, "lost");
                }
            }
            property! {
                /// P6 (rounding): a quotient rounds towards zero: quotient times divisor is at most the dividend.
                equation "q d <= n"
                over "dividend and divisor"
                by $products
                fn p6_quotient(s) {
                    let (wide, divisor) = (s.$wide(), s.$word());
                    assume!(s, divisor <= LARGEST, "types of the callers");
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
    /// The properties of this file at 32 bits, the width of the firmware.
    w32, u32, u64, products cvc5, bits kissat
);
heart!(
    /// The properties of this file at 8 bits, where the model checker refutes wrong changes of the code quickly.
    w8, u8, u16, products kissat, bits kissat
);

/// Property of the whole square root, at 8 bits. At 32 bits no solver finishes with 32 products in a row; there the proof of one
/// digit and induction take its place.
pub mod root8 {
    use super::*;
    property! {
        /// P5/P3: the square of the root never exceeds the radicand, and the next larger square does; no overflow.
        equation "r² <= E < (r + 1)²"
        over "radicand"
        fn p5_root(s) {
            let radicand = s.u16();
            let found = root::<u8>(radicand);
            assert!(found.square == found.root.times(found.root));
            assert!(found.square <= radicand);
            assert!(u32::from(found.root).pow(2) + 2 * u32::from(found.root) + 1 > u32::from(radicand));
            cover!(s, found.root > 2 && found.square == radicand, "perfect square");
            cover!(s, found.root == u8::MAX, "largest root");
            cover!(s, found.root == 0, "no root");
        }
    }
}

/// Properties of quotients by a prepared divisor (stored reciprocal), which is used for many dividends.
pub mod reciprocal {
    use super::*;
    use fixed::FixedI32;
    use touchstone_control::reciprocal::{Reciprocal8, Reciprocal32};
    use touchstone_control::{Fixed32, Number};

    property! {
        /// P3/P6: the quotient by a prepared divisor (stored reciprocal) is the plain quotient, for every dividend and divisor at 8
        /// bits. All inputs are tried, as a solver takes longer for two divisions and a product.
        equation "q = min(floor(n / d), highest)"
        over "word and double word"
        by sampled fn p6_reciprocal_8(s) {
            let divisor = s.u8();
            let dividend = s.u16();
            let q = Reciprocal8::new(divisor).quotient(dividend);
            assert!(q == quotient::<u8>(dividend, divisor));
            cover!(s, divisor == 0, "no divisor");
            cover!(s, q > 1 && q < i8::MAX as u8 && q.times(divisor) < dividend, "rounded");
            cover!(s, q == i8::MAX as u8, "saturated");
        }
    }
    property! {
        /// P3/P6: the quotient by a prepared divisor (stored reciprocal) is the plain quotient, in random tests at 32 bits.
        /// `obligations/` proves its arithmetic over the integers.
        equation "q = min(floor(n / d), highest)"
        over "double word and word"
        by sampled fn p6_reciprocal_32(s) {
            let (dividend, divisor) = (s.u64(), s.u32());
            let q = Reciprocal32::new(divisor).quotient(dividend);
            assert!(q == quotient::<u32>(dividend, divisor));
            cover!(s, divisor == 0, "no divisor");
            cover!(s, q > 1 && q < i32::MAX as u32 && q.times(divisor) < dividend, "rounded");
            cover!(s, q == i32::MAX as u32, "saturated");
        }
    }
    property! {
        /// P6 (rounding): the quotient by a prepared divisor is the leading digits of a product: the scaled dividend times the
        /// stored inverse. It is proved for two inverses, one with one binary digit set and one with two.
        equation "q = ((n 2^scale + 1) inverse / 2^64) / 2^31"
        over "dividend below 2^62; inverses 2^63 and 2^62 + 2^33, divisors 2^31"
        by cadical fn p6_leading_digits32(s) {
            let dividend = s.u64() >> 2;
            for inverse in [1_u64 << 63, 1 << 62 | 1 << 33] {
                let by = Reciprocal32 { divisor: 1 << 31, scale: 1, inverse };
                let product = (u128::from(dividend) + 1) * u128::from(inverse);
                assert_reached!(u128::from(by.quotient(dividend)) == product >> 95);
            }
            cover!(s, dividend >> 33 > 0, "a quotient");
        }
    }
    replaced_property! {
        [(touchstone_control::reciprocal::Reciprocal32::new, crate::heart::reciprocal::told_divisor)
        (touchstone_control::reciprocal::Reciprocal32::quotient, crate::heart::reciprocal::any_quotient)]
        /// P6 (rounding): a signed dividend is divided by its absolute value, with the absolute value of the prepared divisor, and
        /// the quotient gets the dividend's sign. This holds for any quotient of absolute values.
        equation "q(p, k) = sign(p) q(|p|, |k|)"
        over "product, gain; under the checker whatever a quotient of magnitudes is"
        by cadical fn p6_divide_by32(s) {
            let (dividend, divisor) = (s.i64(), s.i32());
            let by = Fixed32::divisor(FixedI32::from_bits(divisor));
            let found = i64::from(Fixed32::divide_by(dividend, &by).to_bits());
            let size = Reciprocal32::new(divisor.unsigned_abs()).quotient(dividend.unsigned_abs());
            assert!(found == if dividend < 0 { -i64::from(size) } else { size.into() });
            cover!(s, found < 0 && divisor > 0, "of a negative number");
            cover!(s, found > 0 && divisor < 0, "by a negative number");
        }
    }

    /// Replaces `Reciprocal32::new` when the model checker runs: it records the divisor and computes no inverse.
    #[cfg(kani)]
    pub fn told_divisor(divisor: u32) -> Reciprocal32 {
        Reciprocal32 {
            divisor,
            scale: 0,
            inverse: 0,
        }
    }
    /// Replaces `Reciprocal32::quotient` when the model checker runs: any absolute value that fits a word, and the same one for
    /// equal arguments.
    #[cfg(kani)]
    pub fn any_quotient(by: &Reciprocal32, dividend: u64) -> u32 {
        use core::sync::atomic::{AtomicU64, Ordering::Relaxed};
        static ASKED: [AtomicU64; 4] = [const { AtomicU64::new(0) }; 4];
        let answer: u32 = kani::any();
        let question = [1, by.divisor.into(), dividend];
        let same = (0..3).all(|at| ASKED[at].load(Relaxed) == question[at]);
        kani::assume(!same || ASKED[3].load(Relaxed) == u64::from(answer));
        // The quotient of 0 is 0.
        kani::assume(answer <= i32::MAX as u32 && (dividend > 0 || answer == 0));
        for at in 0..3 {
            ASKED[at].store(question[at], Relaxed);
        }
        ASKED[3].store(answer.into(), Relaxed);
        answer
    }
}

/// An equation without code, which shows why the energy after an outward motion is a sum of terms that are not negative.
pub mod algebra32 {
    use super::*;
    property! {
        /// P1 (energy) for the enhanced law: the work of a smaller force and the saved work sum to the work of the full force. So
        /// with `p1_affordable`, the remainder plus the saved work is exactly the energy minus the work done.
        equation "(f_w - f) m + f m = f_w m"
        over "pair of forces, retreat"
        by cvc5 fn p1_smaller_force(s) {
            let (saved_force, smaller, moved) = (s.u64(), s.u64(), s.u64());
            assume!(s, saved_force <= 1 << 31 && smaller <= 1 << 31 && moved <= 1 << 31, "types of the callers");
            // At most 2^32 · 2^31, so nothing wraps. No solver finishes if it also has to check for wrapping.
            let work = smaller.wrapping_mul(moved);
            let saved = saved_force.wrapping_mul(moved);
            assert!(saved.wrapping_add(work) == saved_force.wrapping_add(smaller).wrapping_mul(moved));
            cover!(s, smaller > 0 && saved > 0 && work > 0, "both parts");
            cover!(s, saved_force == 0, "full force");
            cover!(s, smaller == 0, "no force");
        }
    }
}
