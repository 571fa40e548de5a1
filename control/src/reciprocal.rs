//! Divides by a constant without a division instruction.
//!
//! A control law divides by the same few stiffnesses at every tick. So an inverse of each is calculated once. `W` is the number of
//! bits of a word. For the divisor shifted up until its highest bit is set, `2^(W-1) <= d < 2^W`, the inverse is `m = floor((2^k -
//! 1)/d)` with `k = 3W - 1`. Then, for every `n < 2^(W-1) d`,
//!
//! ```text
//! floor(n/d) = floor((n + 1) m / 2^k)
//! ```
//!
//! exactly (Robison, "N-bit unsigned division via N-bit multiply-add", 2005). Proof: let `e = 2^k - m d`, so `1 <= e <= d`; then
//! `(n + 1) m/2^k = (n + 1)/d - (n + 1) e/(2^k d)`. That is less than `(n + 1)/d`, hence below the next whole number after
//! `floor(n/d)`; and it is at least `n/d`, since `(n + 1) e <= 2^(W-1) d · d < 2^k`. `m` is below `2^2W`: a double word.

macro_rules! reciprocal {
    ($(#[$doc:meta])* $name:ident, $word:ty, $wide:ty, $high:expr) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
        pub struct $name {
            /// The divisor.
            pub divisor: $word,
            /// The power of two that shifts the divisor up until its highest bit is set. Multiplying by it shifts in fewer
            /// instructions.
            pub scale: $word,
            /// The inverse `m` of the shifted divisor `d`: `floor((2^k - 1)/d)` with `k = 3W - 1` for words of `W` bits.
            pub inverse: $wide,
        }

        impl $name {
            const WORD: u32 = <$word>::BITS;

            /// Prepares a divisor. For a divisor of 0 every quotient is 0.
            pub fn new(divisor: $word) -> Self {
                let shift = divisor.leading_zeros();
                // For the divisor 0 the shift by all bits of the word wraps to a shift by none. The result is not used.
                let (scale, normal) = (
                    (1 as $word).wrapping_shl(shift),
                    <$wide>::from(divisor.wrapping_shl(shift)),
                );
                // Calculates (2^k - 1)/d digit by digit. The dividend is three words of ones except for the highest bit; its first
                // word is less than `d`.
                let ones = <$wide>::from(<$word>::MAX);
                let mut inverse: $wide = 0;
                let mut rest = ones >> 1;
                for _ in 0..2 {
                    let digit = (rest << Self::WORD | ones).checked_div(normal).unwrap_or(0);
                    rest = (rest << Self::WORD | ones).wrapping_sub(digit.wrapping_mul(normal));
                    inverse = inverse << Self::WORD | digit;
                }
                Self {
                    divisor,
                    scale,
                    inverse,
                }
            }

            /// `floor(dividend / divisor)`, limited to `2^(W-1) - 1` for words of `W` bits; 0 for a divisor of 0.
            #[inline(always)]
            pub fn quotient(&self, dividend: $wide) -> $word {
                if dividend >= <$wide>::from(self.divisor) << (Self::WORD - 1) {
                    return if self.divisor == 0 {
                        0
                    } else {
                        <$word>::MAX >> 1
                    };
                }
                // The product is below `2^(2W-1)` for words of `W` bits, so adding 1 cannot overflow.
                let scaled = dividend
                    .wrapping_mul(<$wide>::from(self.scale))
                    .wrapping_add(1);
                // The result is below `2^(W-1)`. The mask tells the compiler that the highest bit is 0.
                ($high(scaled, self.inverse) >> (Self::WORD - 1)) as $word & <$word>::MAX >> 1
            }
        }
    };
}
reciprocal!(
    /// A 32-bit divisor prepared for fast division.
    Reciprocal32, u32, u64, high_64
);
reciprocal!(
    /// The 8-bit version of the same source, which a test checks for every input.
    Reciprocal8, u8, u16, high_16
);
#[cfg(test)]
reciprocal!(
    /// The 16-bit version of the same source.
    Reciprocal16, u16, u32, high_32
);

/// The upper half of a product of two double words.
#[inline(always)]
fn high_64(a: u64, b: u64) -> u64 {
    (u128::from(a).wrapping_mul(u128::from(b)) >> 64) as u64
}
#[cfg(test)]
fn high_32(a: u32, b: u32) -> u32 {
    (u64::from(a).wrapping_mul(u64::from(b)) >> 32) as u32
}
#[inline(always)]
fn high_16(a: u16, b: u16) -> u16 {
    (u32::from(a).wrapping_mul(u32::from(b)) >> 16) as u16
}

#[cfg(test)]
mod tests {
    use super::{Reciprocal8, Reciprocal16, Reciprocal32};

    /// Checks the quotient by a prepared inverse for every 16-bit dividend with every 8-bit divisor.
    #[test]
    fn every_quotient_of_8_bits() {
        for divisor in 0..=u8::MAX {
            let reciprocal = Reciprocal8::new(divisor);
            for dividend in 0..=u16::MAX {
                let expected = dividend.checked_div(divisor.into()).unwrap_or(0).min(127);
                assert_eq!(
                    u16::from(reciprocal.quotient(dividend)),
                    expected,
                    "{dividend}/{divisor}"
                );
            }
        }
    }

    /// Checks every 16-bit divisor at dividends where the quotient changes: at a multiple of the divisor and just below, for small,
    /// large and saturated quotients.
    #[test]
    fn every_divisor_of_16_bits() {
        for divisor in 0..=u16::MAX {
            let reciprocal = Reciprocal16::new(divisor);
            let check = |dividend: u32| {
                let expected = dividend
                    .checked_div(divisor.into())
                    .unwrap_or(0)
                    .min(0x7fff);
                assert_eq!(
                    u32::from(reciprocal.quotient(dividend)),
                    expected,
                    "{dividend}/{divisor}"
                );
            };
            let mut quotient = 0x8001_u32;
            while quotient > 0 {
                let multiple = quotient.wrapping_mul(divisor.into());
                check(multiple);
                check(multiple.wrapping_sub(1));
                check(multiple.wrapping_add(u32::from(divisor).wrapping_sub(1)));
                quotient = quotient.wrapping_sub(1 + quotient / 64);
            }
        }
    }

    fn check(reciprocal: &Reciprocal32, divisor: u32, dividend: u64) {
        let expected = dividend
            .checked_div(divisor.into())
            .unwrap_or(0)
            .min(0x7fff_ffff);
        assert_eq!(
            u64::from(reciprocal.quotient(dividend)),
            expected,
            "{dividend}/{divisor}"
        );
    }

    /// Checks dividends around `quotient · divisor`, where the quotient changes.
    fn check_around(reciprocal: &Reciprocal32, divisor: u32, quotient: u32) {
        let multiple = u64::from(quotient).wrapping_mul(divisor.into());
        check(reciprocal, divisor, multiple);
        check(reciprocal, divisor, multiple.wrapping_sub(1));
        check(
            reciprocal,
            divisor,
            multiple.wrapping_add(u64::from(divisor).wrapping_sub(1)),
        );
    }

    #[test]
    fn hard_words_of_32_bits() {
        let mut words = vec![0, u32::MAX, 0xffff_0000, 0x8000_ffff, 0x7fff_8000];
        for bit in 0..32 {
            let power = 1_u32 << bit;
            words.extend([power, power - 1, power | 1, !power, power | power >> 7]);
        }
        for &divisor in &words {
            let reciprocal = Reciprocal32::new(divisor);
            for &high in &words {
                check_around(&reciprocal, divisor, high);
                for &low in &words {
                    check(&reciprocal, divisor, u64::from(high) << 32 | u64::from(low));
                }
            }
        }
    }

    fn random(times: u32) {
        let mut state = 1_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            state ^ state >> 29
        };
        for _ in 0..times {
            // Random divisors of all lengths in bits.
            let divisor = (next() >> 32) as u32 >> (next() >> 40 & 31);
            let reciprocal = Reciprocal32::new(divisor);
            for _ in 0..16 {
                let lengths = next() >> 40;
                check(&reciprocal, divisor, next() >> (lengths & 63));
                let quotient = (next() >> 32) as u32 >> (lengths >> 6 & 31);
                check_around(&reciprocal, divisor, quotient);
            }
        }
    }

    #[test]
    fn random_words_of_32_bits() {
        random(100_000);
    }

    /// Compares 2^32 quotients of random words with the machine's division. It takes about a minute: `cargo test --release -p
    /// touchstone-control -- --ignored`.
    #[test]
    #[ignore = "a minute in a release build"]
    fn four_thousand_million_random_words() {
        random(1 << 26);
    }
}
