//! Properties of the estimator's wide states as numbers, and of the few functions of `Fixed32` and `Fixed8` that no other file
//! covers. Each is compared with its equation over integers.
//!
//! ```text
//! a + b, a - b where they fit; leading digits; ±2^k     p3_wide_sums, p3_wide_parts, p3_wide_within
//! word_of(w, i) = floor(w 2^-i) modulo 2^32            p3_wide_of_words
//! a weight is the nearest, or there is none             p3_wide_weights
//! setting -> signal, towards zero, to the end           p8_saturating_signal32
//! p / k by a prepared divisor (stored reciprocal), at 8 bits                p6_divide_by8
//! floor(e 2^-24)                                        p3_energy_digits32
//! ```

use crate::{assume, cover, property};
use touchstone_control::number::{Exact, Wide as _, Wide64, word_of};
use touchstone_control::{Fixed8, Fixed32, Number, Si};

property! {
    /// P3 (arithmetic): sum and difference of two wide states of the estimator are exact if they fit.
    equation "a + b, a - b"
    over "two states"
    by cadical fn p3_wide_sums(s) {
        let (a, b) = (Wide64(s.i64()), Wide64(s.i64()));
        let (of_a, of_b) = (i128::from(a.0), i128::from(b.0));
        let fits = |x: i128| i64::try_from(x).is_ok();
        if fits(of_a + of_b) {
            assert_reached!(i128::from(a.plus_fitting(b).0) == of_a + of_b);
        }
        if fits(of_a - of_b) {
            assert_reached!(i128::from(a.minus_fitting(b).0) == of_a - of_b);
        }
        cover!(s, fits(of_a + of_b) && a.0 < 0 && b.0 < 0, "both negative");
    }
}
property! {
    /// P3 (arithmetic): the part of an estimator's state that is multiplied is its leading digits: of a motion the first 28
    /// fractional bits, of a torque the first 24. Both are rounded down, and are exact if they fit words.
    equation "part = floor(w 2^-26), torque part = floor(w 2^-30)"
    over "a state within ±8, within ±128"
    by cadical fn p3_wide_parts(s) {
        // In tests on random samples the first number is mostly within ±8.
        let any = s.i64();
        let state = Wide64(if s.shortcut() { any >> 6 } else { any });
        let whole = i128::from(state.0);
        let digits = |down: u32| {
            // Rounded down: what is left out is not negative.
            let rest = whole.rem_euclid(1 << down);
            (whole - rest) / (1 << down)
        };
        if whole.abs() < 8 << 54 {
            assert_reached!(i128::from(state.part()) == digits(26));
        }
        if whole.abs() < 128 << 54 {
            assert_reached!(i128::from(state.torque_part()) == digits(30));
        }
        cover!(s, whole < 0 && whole > -(1 << 26), "less than a step below zero");
        cover!(s, whole > 7 << 54 && whole < 8 << 54, "at the end of a part");
    }
}
property! {
    /// P3 (arithmetic): `word_of` takes the 32-bit word that begins at a given bit of a 64-bit state.
    equation "word from bit i = floor(w 2^-i) modulo 2^32"
    over "a state, i from 1 to 31"
    by cadical fn p3_wide_of_words(s) {
        let (bits, from) = (s.i64(), u32::from(s.u8() % 31) + 1);
        let whole = i128::from(bits);
        let rest = whole.rem_euclid(1 << from);
        let expected = ((whole - rest) / (1 << from)).rem_euclid(1 << 32);
        assert!(i128::from(word_of(bits, from).cast_unsigned()) == expected);
        cover!(s, whole < 0 && word_of(bits, from) > 0, "of more than a word");
    }
}
property! {
    /// P3 (arithmetic): the check whether a wide state is within ±`2^k` includes the lower end and excludes the upper.
    equation "-2^k <= w < 2^k"
    over "state, k from 0 to 8"
    by cadical fn p3_wide_within(s) {
        let bits = u32::from(s.u8() % 9);
        // In random tests the state is mostly near one of the two ends; otherwise hardly any would be.
        let any = s.i64();
        let state = Wide64(if s.shortcut() {
            let (end, near) = (1_i64 << (54 + bits), any >> 61);
            if any & 1 == 0 { end + near } else { near - end }
        } else {
            any
        });
        let limit = 1_i128 << (54 + bits);
        let whole = i128::from(state.0);
        assert!(state.within(bits) == (whole >= -limit && whole < limit));
        cover!(s, whole == -limit && bits == 3, "at the lower end");
        cover!(s, whole == limit && bits == 2, "at the upper end");
    }
}
property! {
    /// P3 (arithmetic): a weight (coefficient) is the number nearest to the calculated one, halves rounded up. There is none if the
    /// number is beyond ±32, or ±2 for a torque.
    equation "w = floor(v 2^-30 + 1/2), of a torque floor(v 2^-26 + 1/2); none beyond a word"
    over "value with 56 fractional digits"
    by cadical fn p3_wide_weights(s) {
        let value = Exact::from_bits(s.i64());
        let whole = i128::from(value.to_bits());
        let nearest = |down: u32| i32::try_from((whole + (1 << (down - 1))) >> down).ok();
        assert!(Wide64::weight(value) == nearest(30));
        assert!(Wide64::torque_weight(value) == nearest(26));
        cover!(s, nearest(30).is_none() && whole < 0, "below the range");
        cover!(s, nearest(30).is_some() && nearest(26).is_none(), "a motion's, no torque's");
        cover!(s, nearest(26) == Some(1) && whole < 1 << 26, "rounded up");
    }
}
property! {
    /// P8 (settings): a setting is converted to a position or force by rounding towards zero, limited to the range of the format.
    equation "bits' = bits 2^-8 towards zero, within the format"
    over "setting of 64 bits"
    by cadical fn p8_saturating_signal32(s) {
        let si = Si::from_bits(s.i64());
        let whole = i128::from(si.to_bits());
        // Towards zero: digits of the magnitude are cut off.
        let size = whole.abs() >> 8;
        let cut = if whole < 0 { -size } else { size };
        let shown = cut.clamp(i128::from(i32::MIN), i128::from(i32::MAX));
        assert!(i128::from(Fixed32::saturating_signal(si).to_bits()) == shown);
        cover!(s, cut < i128::from(i32::MIN), "below the format");
        cover!(s, cut > i128::from(i32::MAX), "above the format");
        cover!(s, whole < 0 && cut << 8 != whole && cut == shown, "raised");
    }
}
property! {
    /// P6 (rounding): at 8 bits, the quotient by a prepared divisor (stored reciprocal) is the exact one, rounded towards zero and
    /// limited to the format.
    equation "|q| = min(floor(|p| / k), 127), sign of p"
    over "product of 16 bits, gain of 8 bits above zero"
    by kissat fn p6_divide_by8(s) {
        let (p, k) = (s.i16(), s.i8());
        assume!(s, k > 0, "validate: a total is above zero");
        let divisor = Fixed8::divisor(<Fixed8 as Number>::Gain::from_bits(k));
        let found = i32::from(Fixed8::divide_by(p, &divisor).to_bits());
        let (size, dividend, k) = (found.abs(), i32::from(p).abs(), i32::from(k));
        // Checked by products: the solver would have to follow another division.
        assert!(size * k <= dividend && size <= 127);
        assert!(size == 127 || dividend < size * k + k);
        assert!(found == 0 || (found < 0) == (p < 0));
        cover!(s, p < 0 && found > -127 && found < 0, "negative");
        cover!(s, dividend > 128 * k, "beyond the format");
    }
}
property! {
    /// P3 (arithmetic): an energy, cut to the fractional bits of a position or force, is rounded down if it fits.
    equation "e' = floor(e 2^-24)"
    over "energy within ±2^55"
    by cadical fn p3_energy_digits32(s) {
        let any = s.i64();
        let bits = if s.shortcut() { any >> 8 } else { any };
        assume!(s, (-(1_i64 << 55)..1 << 55).contains(&bits), "case; it is asked only of what fits, checked where it is");
        let energy = <Fixed32 as Number>::Energy::from_bits(bits);
        let found = i64::from(Fixed32::energy_digits_fitting(energy).to_bits());
        let rest = i128::from(bits) - (i128::from(found) << 24);
        assert!((0..1 << 24).contains(&rest));
        cover!(s, bits < 0 && rest > 0, "downwards");
    }
}
