//! Additions that saturate at the ends of their format, in the form that takes the fewest instructions.
//!
//! A Cortex-M4 has one instruction for a saturating sum of 32-bit words. For other widths, a form without a branch takes six
//! instructions. A form with a branch that is hardly ever taken needs two.

/// A signed integer whose sums, differences and negatives saturate.
pub(crate) trait Saturates: Copy {
    /// `self + other`, saturating.
    fn sum(self, other: Self) -> Self;
    /// `self - other`, saturating.
    fn difference(self, other: Self) -> Self;
    /// `-self`, saturating.
    fn opposite(self) -> Self;
}

macro_rules! saturates {
    ($($int:ty)*) => {
        $(
            impl Saturates for $int {
                #[inline(always)]
                fn sum(self, other: Self) -> Self {
                    if cfg!(target_pointer_width = "32") {
                        return self.saturating_add(other);
                    }
                    match self.checked_add(other) {
                        Some(sum) => sum,
                        // If the sum does not fit, both numbers have the sign of the end of the range that the sum exceeds.
                        None if self < 0 => Self::MIN,
                        None => Self::MAX,
                    }
                }
                #[inline(always)]
                fn difference(self, other: Self) -> Self {
                    if cfg!(target_pointer_width = "32") {
                        return self.saturating_sub(other);
                    }
                    match self.checked_sub(other) {
                        Some(difference) => difference,
                        None if self < 0 => Self::MIN,
                        None => Self::MAX,
                    }
                }
                #[inline(always)]
                fn opposite(self) -> Self {
                    match self.checked_neg() {
                        Some(opposite) => opposite,
                        None => Self::MAX,
                    }
                }
            }
        )*
    };
}
saturates!(i8 i16 i32 i64);

#[cfg(test)]
mod tests {
    use super::Saturates as _;

    /// Compares with the standard library's saturating sums: every pair of 8-bit numbers, and difficult pairs of 16, 32 and 64
    /// bits.
    #[test]
    fn every_sum_is_the_library_s() {
        macro_rules! check {
            ($a:expr, $b:expr) => {
                assert_eq!($a.sum($b), $a.saturating_add($b));
                assert_eq!($a.difference($b), $a.saturating_sub($b));
                assert_eq!($a.opposite(), $a.saturating_neg());
            };
        }
        for a in i8::MIN..=i8::MAX {
            for b in i8::MIN..=i8::MAX {
                check!(a, b);
                // The same pair of numbers at each end of a wider format, and around its middle.
                let [c, d] = [a, b].map(i64::from);
                for (c, d) in [
                    (c << 56, d << 56),
                    (c << 56 | 0xff, d),
                    (c, d << 56),
                    (i64::MAX.wrapping_sub(c), d),
                ] {
                    check!(c, d);
                    check!((c >> 32) as i32, (d >> 32) as i32);
                    check!((c >> 48) as i16, (d >> 48) as i16);
                }
            }
        }
    }
}
