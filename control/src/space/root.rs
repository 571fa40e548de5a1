//! Square roots of double words, exact: `floor(sqrt(n))` and the remainder.
//!
//! The root of one word gives the root of the next width (Zimmermann, "Karatsuba square root", 1999). Let `n = h 2^W + a 2^(W/2) +
//! b` with `h` of one word that has one of its two highest bits set, and `h = s² + r`; then
//!
//! ```text
//! q, u = divide(r 2^(W/2) + a, 2 s)       root = s 2^(W/2) + q       rest = u 2^(W/2) + b - q²
//! ```
//!
//! If the rest is negative, the root is one less. The first 16 bits come from a table of 256 bytes. So a root of a 64-bit number
//! takes two machine divisions, and a quarter of the instructions of a root that is calculated bit by bit. Tests check every root
//! of 16 bits, and every step of a root of 32 bits.

/// For each first byte `h` of a 16-bit number, the root of the largest number with that byte: `floor(sqrt(256 h + 255))`.
const LARGEST_ROOTS: [u8; 256] = {
    let mut roots = [0; 256];
    let (mut high, mut root) = (0_usize, 0_u32);
    while high < 256 {
        while (root + 1) * (root + 1) <= 256 * high as u32 + 255 {
            root += 1;
        }
        roots[high] = root as u8;
        high += 1;
    }
    roots
};

/// Square root, rounded down, and remainder of a 16-bit number with one of its two highest bits set. Roots of numbers with the same
/// first byte differ by at most 1.
#[inline(always)]
fn scaled_16(n: u16) -> (u16, u16) {
    let first = usize::from((n >> 8) as u8);
    let most = u16::from(LARGEST_ROOTS.get(first).copied().unwrap_or(0));
    let square = most.wrapping_mul(most);
    let root = if square > n {
        most.wrapping_sub(1)
    } else {
        most
    };
    (root, n.wrapping_sub(root.wrapping_mul(root)))
}

macro_rules! level {
    ($scaled:ident, $below:ident, $word:ty, $wide:ty) => {
        /// Square root, rounded down, and remainder of a number with one of its two highest bits set. The remainder is at most
        /// twice the root.
        #[inline(always)]
        fn $scaled(n: $wide) -> ($wide, $wide) {
            const HALF: u32 = <$word>::BITS / 2;
            const LOW: $word = <$word>::MAX >> HALF;
            let (high, low) = ((n >> <$word>::BITS) as $word, n as $word);
            let (root, rest) = $below(high);
            let (root, rest) = (root as $word, rest as $word);
            let (a, b) = (low >> HALF, low & LOW);
            // Divides by half of the divisor, so that the dividend fits a word: the remainder of the level above is at most twice
            // its root.
            let dividend = (rest << (HALF - 1)) | (a >> 1);
            // The root's highest bit is set. Setting it again lets the compiler leave out the check for a division by 0.
            let digit = dividend.checked_div(root | 1 << (HALF - 1)).unwrap_or(0);
            let left = (dividend.wrapping_sub(digit.wrapping_mul(root)) << 1) | (a & 1);
            let (wide_digit, digit_root) = (<$wide>::from(digit), <$wide>::from(root));
            let found = (digit_root << HALF).wrapping_add(wide_digit);
            let have = (<$wide>::from(left) << HALF) | <$wide>::from(b);
            let need = wide_digit.wrapping_mul(wide_digit);
            if have >= need {
                (found, have.wrapping_sub(need))
            } else {
                let less = found.wrapping_sub(1);
                (
                    less,
                    have.wrapping_sub(need)
                        .wrapping_add(found)
                        .wrapping_add(less),
                )
            }
        }
    };
}
level!(scaled_32, scaled_16, u16, u32);
level!(scaled_64, scaled_32, u32, u64);

macro_rules! whole {
    ($(#[doc = $doc:literal])* $name:ident, $high:ident, $scaled:ident, $word:ty, $wide:ty) => {
        $(#[doc = $doc])*
        #[inline]
        #[must_use]
        pub fn $name(n: $wide) -> $word {
            if n == 0 {
                return 0;
            }
            // Scales the number by a power of four, so that the root is scaled by a power of two.
            let pairs = n.leading_zeros() / 2;
            let (root, _) = $scaled(n << (2 * pairs));
            (root >> pairs) as $word
        }

        /// The square root, rounded down, of a number with one of its four highest bits set. The number is first shifted up by at
        /// most two bits.
        #[inline]
        #[must_use]
        pub fn $high(n: $wide) -> $word {
            let low = n >> (<$wide>::BITS - 2) == 0;
            let (root, _) = $scaled(if low { n << 2 } else { n });
            (if low { root >> 1 } else { root }) as $word
        }
    };
}

whole!(
    /// Square root of a 16-bit number, rounded down.
    root_16, root_high_16, scaled_16, u8, u16
);
whole!(
    /// Square root of a 32-bit number, rounded down.
    root_32, root_high_32, scaled_32, u16, u32
);
whole!(
    /// Square root of a 64-bit number, rounded down.
    root_64, root_high_64, scaled_64, u32, u64
);

#[cfg(test)]
mod tests {
    use super::{root_16, root_32, root_64, root_high_16, root_high_32, root_high_64};

    #[test]
    fn every_root_of_16_bits() {
        for n in 0..=u16::MAX {
            let root = u32::from(root_16(n));
            let n = u32::from(n);
            assert!(root * root <= n && (root + 1) * (root + 1) > n, "{n}");
        }
        for n in 0x1000..=u16::MAX {
            assert_eq!(root_high_16(n), root_16(n), "{n}");
        }
    }

    /// Checks 32-bit square roots where the root changes: at every square, just below and just above.
    #[test]
    fn every_step_of_a_root_of_32_bits() {
        for root in 1..=u16::MAX {
            let square = u32::from(root) * u32::from(root);
            assert_eq!(root_32(square), root);
            assert_eq!(root_32(square - 1), root - 1);
            assert_eq!(root_32(square + u32::from(root)), root);
            assert_eq!(root_32(square + 2 * u32::from(root)), root, "last one");
            for n in [square - 1, square, square + 2 * u32::from(root)] {
                if n >= 1 << 28 {
                    assert_eq!(root_high_32(n), root_32(n), "{n}");
                }
            }
        }
    }

    #[test]
    fn roots_of_64_bits_where_they_step() {
        let mut state = 1_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            state ^ (state >> 29)
        };
        let hard = (0..32).flat_map(|bit| {
            let power = 1_u32 << bit;
            [power, power - 1, power | 1, !power, u32::MAX - bit]
        });
        let random: Vec<u32> = (0..1_000_000)
            .map(|_| {
                let length = next() & 31;
                (next() >> 32) as u32 >> length
            })
            .collect();
        for root in hard.chain(random).filter(|root| *root > 0) {
            let square = u64::from(root) * u64::from(root);
            assert_eq!(root_64(square), root);
            assert_eq!(root_64(square - 1), root - 1);
            assert_eq!(root_64(square + 2 * u64::from(root)), root, "last one");
            for n in [square - 1, square, square + 2 * u64::from(root)] {
                if n >= 1 << 60 {
                    assert_eq!(root_high_64(n), root_64(n), "{n}");
                }
            }
        }
        assert_eq!(root_64(u64::MAX), u32::MAX);
    }
}
