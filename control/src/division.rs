//! Divides a double word (64 bits) by a word (32 bits) on a machine that can divide words only.
//!
//! A Cortex-M4 divides 32 bits by 32 bits. The routine that a compiler inserts for 64 bits takes some 300 instructions at worst.
//! The divisors of control laws are always words. So long division needs only three machine divisions, or two if the quotient
//! fits a word. A machine that can divide 64 bits uses its own instruction, with the same quotients.

/// `floor(dividend / divisor)`; `None` for a divisor of zero.
#[inline]
pub fn quotient(dividend: u64, divisor: u32) -> Option<u64> {
    if cfg!(target_pointer_width = "32") {
        long_32(dividend, divisor)
    } else {
        dividend.checked_div(u64::from(divisor))
    }
}

/// The quotient `floor(dividend / divisor)`, for `dividend < divisor · 2^32`, so that it fits a word; and the quotient times the
/// divisor. For a larger dividend both values have no meaning.
#[inline(always)]
pub fn short_quotient(dividend: u64, divisor: u32) -> (u32, u64) {
    if cfg!(target_pointer_width = "32") {
        let quotient = short_32(dividend, divisor);
        (
            quotient,
            u64::from(quotient).wrapping_mul(u64::from(divisor)),
        )
    } else {
        // The product is calculated from the unlimited quotient, and the limit never binds: in this form the proofs' solver can
        // follow the function.
        let quotient = dividend.checked_div(u64::from(divisor)).unwrap_or(0);
        (
            quotient.min(u64::from(u32::MAX)) as u32,
            quotient.wrapping_mul(u64::from(divisor)),
        )
    }
}

macro_rules! long_division {
    ($(#[$doc:meta])* $name:ident, $short:ident, $word:ty, $wide:ty) => {
        $(#[$doc])*
        fn $name(dividend: $wide, divisor: $word) -> Option<$wide> {
            let high = (dividend >> <$word>::BITS) as $word;
            let first = high.checked_div(divisor)?;
            let rest = high.wrapping_sub(first.wrapping_mul(divisor));
            let low = <$wide>::from(dividend as $word);
            let low = $short(<$wide>::from(rest) << <$word>::BITS | low, divisor);
            Some(<$wide>::from(first) << <$word>::BITS | <$wide>::from(low))
        }

        $(#[$doc])*
        /// Divides a double word by a word if the quotient fits a word; for a larger dividend the result has no meaning.
        #[inline(always)]
        fn $short(dividend: $wide, divisor: $word) -> $word {
            const WORD: u32 = <$word>::BITS;
            const HALF: u32 = WORD / 2;
            const LOW: $word = <$word>::MAX >> HALF;

            /// One digit of half a word in a long division: `(rest · 2^HALF + next) / divisor` and the remainder. Needs `rest <
            /// divisor` and a divisor whose highest bit is set.
            #[inline(always)]
            fn digit(rest: $word, next: $word, divisor: $word) -> ($word, $word) {
                // The divisor's highest bit is set. Setting it again lets the compiler leave out the check for a division by 0.
                let (upper, lower) = (divisor >> HALF | 1 << (HALF - 1), divisor & LOW);
                // A quotient by the divisor's upper half alone is never too small, and at most 2 too large (Knuth 4.3.1, B).
                let mut digit = rest.checked_div(upper).unwrap_or(0);
                let left = rest.wrapping_sub(digit.wrapping_mul(upper));
                // Compares what is left for the divisor's lower half with what the lower half takes: both fit a word.
                let mut have = left << HALF | next;
                let mut need = digit.wrapping_mul(lower);
                if need > have {
                    let carried;
                    digit = digit.wrapping_sub(1);
                    need = need.wrapping_sub(lower);
                    (have, carried) = have.overflowing_add(upper << HALF);
                    if !carried && need > have {
                        digit = digit.wrapping_sub(1);
                        need = need.wrapping_sub(lower);
                        have = have.wrapping_add(upper << HALF);
                    }
                }
                (digit, have.wrapping_sub(need))
            }

            // Dividend and divisor are shifted up until the divisor's highest bit is set. A multiplication by a power of two shifts
            // in fewer instructions.
            let scale = (1 as $word).wrapping_shl(divisor.leading_zeros());
            let divisor = divisor.wrapping_mul(scale);
            let dividend = dividend.wrapping_mul(<$wide>::from(scale));
            let (rest, low) = ((dividend >> WORD) as $word, dividend as $word);
            let (second, rest) = digit(rest, low >> HALF, divisor);
            let (third, _) = digit(rest, low & LOW, divisor);
            // The two digits have no bits in common, so OR combines them.
            second << HALF | third
        }
    };
}
long_division!(
    /// The 32-bit version, which the microcontroller runs.
    #[cfg_attr(not(target_pointer_width = "32"), allow(dead_code))]
    long_32, short_32, u32, u64
);
long_division!(
    /// The 8-bit version of the same source, which a test checks for every input.
    #[cfg(test)]
    long_8, short_8, u8, u16
);

#[cfg(test)]
mod tests {
    use super::{long_8, long_32, quotient, short_8, short_32, short_quotient};

    #[test]
    fn every_quotient_of_8_bits() {
        for dividend in 0..=u16::MAX {
            for divisor in 0..=u8::MAX {
                assert_eq!(
                    long_8(dividend, divisor),
                    dividend.checked_div(divisor.into()),
                    "{dividend}/{divisor}"
                );
                // If the quotient does not fit a word, the function only has to return without a panic.
                let short = short_8(dividend, divisor);
                let expected = dividend.checked_div(divisor.into()).map(u8::try_from);
                if let Some(Ok(expected)) = expected {
                    assert_eq!(short, expected, "{dividend}/{divisor}");
                }
            }
        }
    }

    /// Words that are difficult cases of a division: powers of two and their neighbours, all bits set, half of the bits set.
    fn hard_words() -> Vec<u32> {
        let mut words = vec![0, u32::MAX, 0xffff_0000, 0x8000_ffff, 0x7fff_8000];
        for bit in 0..32 {
            let power = 1_u32 << bit;
            words.extend([power, power - 1, power | 1, !power, power | power >> 7]);
        }
        words
    }

    #[test]
    fn quotients_of_32_bits_at_hard_words_and_at_random() {
        let check = |dividend: u64, divisor: u32| {
            let expected = dividend.checked_div(divisor.into());
            assert_eq!(long_32(dividend, divisor), expected, "{dividend}/{divisor}");
            assert_eq!(quotient(dividend, divisor), expected);
            if let Some(Ok(short)) = expected.map(u32::try_from) {
                assert_eq!(short_32(dividend, divisor), short, "{dividend}/{divisor}");
                let accounted = u64::from(short).wrapping_mul(u64::from(divisor));
                assert_eq!(short_quotient(dividend, divisor), (short, accounted));
            }
        };
        let words = hard_words();
        for high in &words {
            for low in &words {
                for divisor in &words {
                    check(u64::from(*high) << 32 | u64::from(*low), *divisor);
                }
            }
        }
        let mut random = 1_u64;
        let mut next = || {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            random ^ random >> 29
        };
        for _ in 0..2_000_000 {
            // Random dividends and divisors of all lengths in bits.
            let lengths = next() >> 40;
            let dividend = next() >> (lengths & 63);
            let divisor = (next() >> 32) as u32 >> (lengths >> 6 & 31);
            check(dividend, divisor);
            // Checks a multiple of the divisor, and the number just below it.
            let multiple = u64::from(divisor).wrapping_mul(dividend & 0xffff_ffff);
            check(multiple, divisor);
            check(multiple.wrapping_sub(1), divisor);
        }
    }
}
