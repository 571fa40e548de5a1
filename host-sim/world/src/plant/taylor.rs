//! Power series of a motion over a short interval: gives the value at any time in the interval, and the time at which the value
//! first becomes negative.
//!
//! Stops and starts of the device fall between control ticks. The exact solution of `y' = M y` at an arbitrary time is `exp(M t)
//! y`. Its power series over an interval `h` has the coefficients `y_{k+1} = M y_k h / (k + 1)`, and is cheap to evaluate.

/// Largest norm of `M h` (matrix of the rates times the interval) for one power series. The norm of a knob in a hand over 1 ms is
/// smaller.
pub(super) const NORM: f64 = 0.5;
/// Number of coefficients of a series. The first coefficient left out is below `0.5^16 / 16!`, 1e-18.
pub(super) const TERMS: usize = 16;

/// Reciprocals `1 / (k + 1)` for the integration of a series, for `k` from 0.
pub(super) const RECIPROCAL: [f64; TERMS] = {
    let mut table = [0.0; TERMS];
    let mut k = 0;
    while k < TERMS {
        table[k] = 1.0 / (k + 1) as f64;
        k += 1;
    }
    table
};

/// Nodes and weights of Gauss–Legendre integration on `[-1, 1]`; of each symmetric pair of nodes only the positive one. With eight
/// nodes the relative error for the square of a series within [`NORM`] is below 1e-22.
const GAUSS: [(f64, f64); 4] = [
    (0.1834346424956498, 0.362683783378362),
    (0.525532409916329, 0.31370664587788727),
    (0.7966664774136267, 0.22238103445337448),
    (0.9602898564975363, 0.10122853629037626),
];

/// The power series `p(t) = Σ c_k tᵏ`, where `t` in `[0, 1]` is the fraction of an interval.
#[derive(Debug, Clone, Copy)]
pub(super) struct Series(pub(super) [f64; TERMS]);

impl Series {
    pub(super) const ZERO: Self = Self([0.0; TERMS]);

    /// Value of the series `p` at the fraction `t` of the interval.
    pub(super) fn at(&self, t: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * t + c)
    }

    /// Integral of the series `p` from 0 to the fraction `t` of the interval.
    pub(super) fn integral(&self, t: f64) -> f64 {
        let sum = self
            .0
            .iter()
            .enumerate()
            .rev()
            .fold(0.0, |sum, (k, c)| sum * t + c / (k + 1) as f64);
        sum * t
    }

    /// Integral of the square of the series `p` from 0 to the fraction `t` of the interval.
    pub(super) fn integral_of_square(&self, t: f64) -> f64 {
        let half = 0.5 * t;
        let pair = |(node, weight): (f64, f64)| {
            let (before, after) = (self.at(half - half * node), self.at(half + half * node));
            weight * (before * before + after * after)
        };
        half * GAUSS.into_iter().map(pair).sum::<f64>()
    }

    /// The series `a p + b q + c`, coefficient by coefficient.
    pub(super) fn combine(a: f64, p: &Self, b: f64, q: &Self, c: f64) -> Self {
        let mut sum = Self(std::array::from_fn(|k| a * p.0[k] + b * q.0[k]));
        sum.0[0] += c;
        sum
    }

    /// The first `t` in `[0, 1]` at which the series `p` becomes negative; `p(0)` must not be negative.
    ///
    /// Zeros at `t = 0` are divided out, so that a motion that starts from exact rest is judged by its direction. Then the search
    /// goes up from 0 in steps that cannot jump over a root. With a bound `B >= |p''|`, the parabola `p(t) + p'(t) s - B s²/2` lies
    /// below `p(t + s)`, so its root is at or before that of `p`. Near a simple root the steps are those of Newton's method, with
    /// quadratic convergence. The search also finds a dip below zero and back within the interval. A fall that ends at zero to
    /// within rounding counts as a root.
    pub(super) fn first_negative(&self) -> Option<f64> {
        let leading = self.0.iter().position(|&c| c != 0.0)?;
        let mut c = [0.0; TERMS];
        c[..TERMS - leading].copy_from_slice(&self.0[leading..]);
        if c[0] < 0.0 {
            return Some(0.0);
        }
        // If all later terms together cannot make the series negative, by more than rounding, the search would find no root.
        let rest: f64 = c[1..].iter().map(|c| c.abs()).sum();
        if c[0] > rest * (1.0 + 1e-9) {
            return None;
        }
        let curvature: f64 = c
            .iter()
            .enumerate()
            .skip(2)
            .map(|(k, c)| (k * (k - 1)) as f64 * c.abs())
            .sum();
        let rounding = 2.0 * f64::EPSILON * c.iter().map(|c| c.abs()).sum::<f64>();
        let mut t = 0.0;
        // Convergence is quadratic near a simple root, and by a factor of 0.6 per step near a double one. The worst case is about
        // 80 steps.
        for _ in 0..200 {
            let (value, slope) = value_and_slope(&c, t);
            let above = value.max(0.0);
            let reach = (slope * slope + 2.0 * curvature * above).sqrt();
            let stride = if slope < 0.0 {
                2.0 * above / (reach - slope)
            } else {
                (slope + reach) / curvature
            };
            let next = t + stride;
            if value <= rounding && slope < 0.0 {
                return Some(next.min(1.0));
            }
            // The comparison is false for NaN too, which then counts as no event.
            let inside = next < 1.0;
            if !inside {
                return None;
            }
            if next == t {
                return (slope < 0.0).then_some(t);
            }
            t = next;
        }
        None
    }
}

fn value_and_slope(c: &[f64; TERMS], t: f64) -> (f64, f64) {
    let (mut value, mut slope) = (0.0, 0.0);
    for &c in c.iter().rev() {
        slope = slope * t + value;
        value = value * t + c;
    }
    (value, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(c: &[f64]) -> Series {
        let mut padded = [0.0; TERMS];
        padded[..c.len()].copy_from_slice(c);
        Series(padded)
    }

    /// The series of `cos(t / 2)`, whose frequency is the highest that [`NORM`] allows.
    fn cosine() -> Series {
        let mut c = [0.0; TERMS];
        let mut term = 1.0;
        for k in (0..TERMS).step_by(2) {
            c[k] = term;
            term *= -NORM * NORM / ((k + 1) * (k + 2)) as f64;
        }
        Series(c)
    }

    #[test]
    fn values_and_integrals_of_a_cosine() {
        let p = cosine();
        for t in [0.0_f64, 0.3, 1.0] {
            assert!((p.at(t) - (0.5 * t).cos()).abs() < 2e-16);
            assert!((p.integral(t) - 2.0 * (0.5 * t).sin()).abs() < 3e-16);
            assert!((p.integral_of_square(t) - 0.5 * (t + t.sin())).abs() < 3e-16);
        }
    }

    #[test]
    fn first_root_of_several() {
        // A series with the roots 0.25, 0.5 and 0.75.
        let p = series(&[0.09375, -0.6875, 1.5, -1.0]);
        assert!((p.first_negative().unwrap() - 0.25).abs() < 1e-14);
        // cos(t / 2) falls to cos(0.3) at t = 0.6.
        let root = Series::combine(1.0, &cosine(), 0.0, &Series::ZERO, -0.3_f64.cos());
        assert!((root.first_negative().unwrap() - 0.6).abs() < 2e-15);
    }

    #[test]
    fn a_dip_is_found_and_a_near_miss_is_not() {
        // The parabola (t - 0.5)² - m.
        for (m, hit) in [(1e-6, true), (1e-12, true), (-1e-6, false), (-1e-12, false)] {
            let found = series(&[0.25 - m, -1.0, 1.0]).first_negative();
            assert_eq!(found.is_some(), hit, "{m}");
            if let Some(t) = found {
                assert!((t - (0.5 - f64::sqrt(m))).abs() < 1e-9, "{t}");
            }
        }
    }

    #[test]
    fn what_cannot_come_down_is_not_searched_and_what_just_can_is_found() {
        // The line 1 - s t falls to 1 - s at the end of the interval.
        for (fall, hit) in [(1.0 + 1e-9, true), (1.0 + 1e-12, true), (1.0 - 1e-6, false)] {
            let found = series(&[1.0, -fall]).first_negative();
            assert_eq!(found.is_some(), hit, "{fall}");
        }
        // All terms fall, but none alone falls far enough to make the sum negative.
        assert!(series(&[1.0, -0.3, -0.3, -0.5]).first_negative().is_some());
        assert_eq!(series(&[1.0, -0.3, -0.3, -0.3]).first_negative(), None);
        // With opposite signs, the sum of magnitudes does not decide whether the series becomes negative.
        assert_eq!(series(&[1.0, -1.5, 1.0]).first_negative(), None);
    }

    #[test]
    fn zeros_at_the_start_are_judged_by_what_follows() {
        assert_eq!(series(&[0.0, 1.0, -0.5]).first_negative(), None);
        assert_eq!(series(&[0.0, -1.0, 5.0]).first_negative(), Some(0.0));
        assert_eq!(series(&[-0.0, 0.0, 1.0]).first_negative(), None);
        assert_eq!(series(&[]).first_negative(), None);
        // The series t² (0.5 - t) starts from zero with zero slope, and becomes negative at 0.5.
        assert!((series(&[0.0, 0.0, 0.5, -1.0]).first_negative().unwrap() - 0.5).abs() < 1e-15);
        // A motion whose start is small compared with the rest of the series still counts as started.
        assert_eq!(series(&[0.0, 1e-30, 1.0]).first_negative(), None);
    }

    #[test]
    fn straight_lines_and_ends() {
        assert_eq!(series(&[1.0, -2.0]).first_negative(), Some(0.5));
        assert_eq!(series(&[1.0, -0.5]).first_negative(), None);
        assert_eq!(series(&[1.0]).first_negative(), None);
        assert_eq!(series(&[f64::NAN, 1.0]).first_negative(), None);
    }

    #[test]
    fn agrees_with_dense_sampling_on_random_series() {
        let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
        let mut uniform = || {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let mut hits = 0;
        for _ in 0..2000 {
            let mut c = [0.0; TERMS];
            let mut scale = 1.0;
            for (k, c) in c.iter_mut().enumerate() {
                *c = uniform() * scale;
                scale *= 4.0 / (k + 1) as f64;
            }
            c[0] = c[0].abs() * 0.5;
            let p = Series(c);
            let sampled = (0..=20_000)
                .map(|i| f64::from(i) / 20_000.0)
                .find(|&t| p.at(t) < 0.0);
            match (p.first_negative(), sampled) {
                (None, None) => {}
                (Some(t), Some(sample)) => {
                    hits += 1;
                    assert!(sample - t < 5.1e-5 && t <= sample, "{t} {sample}");
                }
                // Sampling may miss a dip between two samples; then the found root is checked on its own.
                (Some(t), None) => assert!(p.at(t).abs() < 1e-14 && p.at(t + 1e-6) < 1e-14, "{t}"),
                (None, Some(sample)) => panic!("missed a root before {sample}"),
            }
        }
        assert!(
            (500..1900).contains(&hits),
            "{hits} of 2000 had a root: the test lost its point"
        );
    }
}
