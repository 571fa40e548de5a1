//! Closed-form step of a linear system as a matrix. The matrix is computed once, when a plant is made, and applied in every
//! interval.
//!
//! A plant has a state `z` and a *drive* `y`, with `y' = M y` and `z' = R y`. The drive contains all values on which the motion
//! depends: velocities, strains and the held torque, but no absolute angle. For an interval `h`:
//!
//! ```text
//! z(h) - z(0) = R Ψ(h) y(0),    Ψ(h) = ∫₀ʰ exp(M t) dt,    exp(M h) = I + M Ψ(h)
//! ```
//!
//! This is the augmented matrix exponential of Van Loan (IEEE TAC 23(3) 395, 1978), written for increments. Increments keep their
//! relative accuracy when damping or interval go to zero, where the usual closed form `(m/b)(1 - exp(-bT/m))` cancels (mass `m`,
//! damping `b`, time `T`). A singular `M` (no damping, no spring) needs no special case.

use super::device::Invalid;
use nalgebra::{SMatrix, Scalar};

/// Largest norm of `M h` (matrix of the rates times the interval) for which [`TERMS`] terms of the series suffice. For a larger
/// norm the interval is halved repeatedly, and the result is doubled as often.
const SERIES_NORM: f64 = 0.5;
/// Number of terms of the series. The first term left out is below `0.5^18 / 18!`, 6e-22, far below rounding.
const TERMS: u32 = 18;

/// Largest sum of magnitudes in a row of a matrix: a norm with `norm(M^k) <= norm(M)^k`.
pub(crate) fn row_sum_norm<const K: usize>(m: &SMatrix<f64, K, K>) -> f64 {
    m.row_iter()
        .map(|row| row.iter().map(|entry| entry.abs()).sum())
        .fold(0.0, f64::max)
}

/// Largest accepted norm of `M h` (matrix of the rates times the interval). Above it the slow part of the motion is lost in the 53
/// bits of a float. An infinite norm would need endless halvings.
const MOST_NORM: f64 = 1e15;

/// Refuses a system whose fastest and slowest rates differ too much for floating-point numbers.
pub(crate) fn within_numbers<const K: usize>(
    m: &SMatrix<f64, K, K>,
    h: f64,
) -> Result<(), Invalid> {
    let norm = (row_sum_norm(m) + row_sum_norm(&m.transpose())) * h;
    (norm <= MOST_NORM).then_some(()).ok_or(Invalid {
        field: "rates",
        value: norm,
        needs: "stiffnesses, dampings, inertias and bandwidths that move nothing 1e15 times in a tick",
    })
}

/// Number of times that an interval with this norm of `M h` (matrix of the rates times the interval) must be halved so that the
/// series converges.
fn halvings(norm: f64) -> u32 {
    if norm > SERIES_NORM {
        libm::log2(norm / SERIES_NORM).ceil() as u32
    } else {
        0
    }
}

/// Norm of `M h` (matrix of the rates times the interval) above which [`stiff_flow`] is used. Plants with usual values are far
/// below it.
const STIFF_NORM: f64 = 4096.0;

/// The integral `Ψ(h) = ∫₀ʰ exp(M t) dt` for the matrix `M` of the rates. A Taylor series over `h / 2ⁿ` is doubled `n` times by
/// `Ψ(2t) = 2 Ψ(t) + M Ψ(t) Ψ(t)`.
pub(crate) fn flow_integral<const K: usize>(m: &SMatrix<f64, K, K>, h: f64) -> SMatrix<f64, K, K> {
    let norm = row_sum_norm(m) * h;
    if norm > STIFF_NORM {
        return stiff_flow(m, h).1;
    }
    let doublings = halvings(norm);
    let mut psi = series(m, h, doublings);
    for _ in 0..doublings {
        psi = psi * 2.0 + m * psi * psi;
    }
    psi
}

/// Taylor series of `Ψ = ∫ exp(M t) dt` over the interval `h / 2ⁿ`, where `n` is `doublings`.
fn series<const K: usize>(m: &SMatrix<f64, K, K>, h: f64, doublings: u32) -> SMatrix<f64, K, K> {
    let base = libm::ldexp(h, -(doublings as i32));
    let mut term = SMatrix::<f64, K, K>::identity() * base;
    let mut psi = term;
    for k in 2..=TERMS {
        term = m * term * (base / f64::from(k));
        psi += term;
    }
    psi
}

/// Computes `exp(M h)` and `Ψ(h) = ∫₀ʰ exp(M t) dt` for a stiff system, one whose rates differ by orders of magnitude.
///
/// `M` is large where `Ψ` is small, so the product `M Ψ Ψ` would mix the rounding errors of fast and slow rates. Instead `X = exp(M
/// h) - I` is doubled by `X(2t) = 2 X + X X`, and `Ψ` by `Ψ(2t) = 2 Ψ + X Ψ`. These products have no large factor and keep the
/// digits of the slow part.
fn stiff_flow<const K: usize>(
    m: &SMatrix<f64, K, K>,
    h: f64,
) -> (SMatrix<f64, K, K>, SMatrix<f64, K, K>) {
    let doublings = halvings(row_sum_norm(m) * h);
    let mut psi = series(m, h, doublings);
    let mut moved = m * psi;
    for _ in 0..doublings {
        psi = psi * 2.0 + moved * psi;
        moved = moved * 2.0 + moved * moved;
    }
    (SMatrix::identity() + moved, psi)
}

/// The matrix exponential `exp(M h)` of the rates `M` over the interval `h`.
pub(crate) fn flow<const K: usize>(m: &SMatrix<f64, K, K>, h: f64) -> SMatrix<f64, K, K> {
    if row_sum_norm(m) * h > STIFF_NORM {
        return stiff_flow(m, h).0;
    }
    SMatrix::identity() + m * flow_integral(m, h)
}

/// The matrix `S(h) = ∫₀ʰ exp(M t)ᵀ Q exp(M t) dt`. It gives the energy `∫ yᵀ Q y dt = y(0)ᵀ S y(0)` of a power `yᵀ Q y` over the
/// interval.
///
/// Van Loan's method computes `S` from one exponential of twice the size, which contains `exp(-Mᵀ h)` and overflows for stiff
/// plants. The doubling `S(2t) = S(t) + exp(M t)ᵀ S(t) exp(M t)`, used here, only adds energies.
pub(crate) fn quadratic_integral<const K: usize>(
    m: &SMatrix<f64, K, K>,
    q: &SMatrix<f64, K, K>,
    h: f64,
) -> SMatrix<f64, K, K> {
    // The terms of the series come from repeated `Mᵀ Q + Q M`.
    let doublings = halvings((row_sum_norm(m) + row_sum_norm(&m.transpose())) * h);
    let base = libm::ldexp(h, -(doublings as i32));
    let mut term = q * base;
    let mut s = term;
    for k in 2..=TERMS {
        let half = term * m;
        term = (half.transpose() + half) * (base / f64::from(k));
        s += term;
    }
    let mut interval = base;
    for _ in 0..doublings {
        let phi = flow(m, interval);
        s += phi.transpose() * s * phi;
        interval *= 2.0;
    }
    s
}

/// The columns of a matrix as plain arrays, the form that [`apply`] reads.
pub(crate) fn columns<T: Scalar + Copy, const N: usize, const K: usize>(
    m: &SMatrix<T, N, K>,
) -> [[T; N]; K] {
    std::array::from_fn(|column| std::array::from_fn(|row| m[(row, column)]))
}

/// Matrix times vector, column by column. The sums are independent, so the compiler can put several into one register (SIMD).
#[inline(always)]
pub(crate) fn apply<const N: usize, const K: usize>(
    columns: &[[f64; N]; K],
    drive: &[f64; K],
) -> [f64; N] {
    let mut sum = [0.0; N];
    for (column, factor) in columns.iter().zip(drive) {
        for (total, entry) in sum.iter_mut().zip(column) {
            *total += entry * factor;
        }
    }
    sum
}

/// The quadratic form `yᵀ S y`, e.g. the energy lost in an interval, of the vector `y` (`drive`).
#[inline(always)]
pub(crate) fn quadratic<const K: usize>(s: &[[f64; K]; K], drive: &[f64; K]) -> f64 {
    apply(s, drive)
        .iter()
        .zip(drive)
        .map(|(entry, factor)| entry * factor)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{SMatrix, matrix};

    type Matrix3 = SMatrix<f64, 3, 3>;

    fn largest<const K: usize>(m: &SMatrix<f64, K, K>) -> f64 {
        m.iter()
            .fold(0.0, |largest, entry| largest.max(entry.abs()))
    }

    /// An oscillator with a held input and an eigenfrequency of 60 rad/s. Over the tests' intervals, the norm of rates times
    /// interval is 1e-3 to 1e3.
    fn oscillator() -> Matrix3 {
        matrix![0.0, 1.0, 0.0; -3600.0, -7.0, 2.0; 0.0, 0.0, 0.0]
    }

    #[test]
    fn flow_is_the_matrix_exponential() {
        for h in [1e-6, 1e-3, 1e-2, 0.3] {
            let expected = (oscillator() * h).exp();
            let error = largest(&(flow(&oscillator(), h) - expected));
            assert!(error < 1e-12 * largest(&expected), "h {h}: {error:e}");
        }
    }

    #[test]
    fn series_is_complete_at_the_norm_where_halving_begins() {
        let turn = matrix![0.0, 1.0; -1.0, 0.0];
        let (sin, cos) = SERIES_NORM.sin_cos();
        let expected = matrix![sin, 1.0 - cos; cos - 1.0, sin];
        assert!(largest(&(flow_integral(&turn, SERIES_NORM) - expected)) < 1e-16);
        // Tests the integral of cos² over time, with a rotation as the motion.
        let q = matrix![1.0, 0.0; 0.0, 0.0];
        let s = quadratic_integral(&turn, &q, 0.25);
        assert!((s[(0, 0)] - (0.125 + 0.5_f64.sin() / 4.0)).abs() < 1e-16);
    }

    #[test]
    fn flow_integral_solves_its_differential_equation_when_the_matrix_is_singular() {
        // For a double integrator, three terms of the series give Ψ exactly.
        let m: Matrix3 = matrix![0.0, 1.0, 0.0; 0.0, 0.0, 1.0; 0.0, 0.0, 0.0];
        let h = 0.125;
        let expected = matrix![h, h * h / 2.0, h * h * h / 6.0; 0.0, h, h * h / 2.0; 0.0, 0.0, h];
        assert_eq!(flow_integral(&m, h), expected);
        assert_eq!(flow_integral(&m, 0.0), Matrix3::zeros());
    }

    #[test]
    fn flow_survives_stiffness() {
        // A rate of 1e9 1/s together with a rate of 1 1/s: the fast motion has decayed, the slow one has not.
        let m = matrix![-1e9, 0.0; 0.0, -1.0];
        let psi = flow_integral(&m, 1.0);
        assert!((psi[(0, 0)] - 1e-9).abs() < 1e-22);
        assert!((psi[(1, 1)] - (1.0 - (-1.0_f64).exp())).abs() < 1e-14);
    }

    #[test]
    fn rates_that_are_far_apart_do_not_multiply_each_others_rounding() {
        // A light mass on a stiff spring and a strong damper: some 1.6e3 and 1e6 1/s, and an entry of 1.6e9.
        let m = matrix![0.0, 1.0; -1.6e9, -1e6];
        let h = 1e-2;
        let spread = (1e12_f64 - 4.0 * 1.6e9).sqrt();
        let (slow, fast) = (-1.6e9 / (0.5 * (1e6 + spread)), -0.5 * (1e6 + spread));
        let mean = |rate: f64| (rate * h).exp_m1() / rate;
        let expected = (mean(slow) * -fast + mean(fast) * slow) / (slow - fast);
        let psi = flow_integral(&m, h);
        assert!(
            (psi[(0, 0)] / expected - 1.0).abs() < 1e-10,
            "{psi} {expected}"
        );
        let phi = flow(&m, h);
        let expected = ((slow * h).exp() * -fast + (fast * h).exp() * slow) / (slow - fast);
        assert!((phi[(0, 0)] - expected).abs() < 1e-10, "{phi} {expected}");
    }

    #[test]
    fn quadratic_integral_is_van_loans() {
        // Van Loan's method for comparison: exp([-Mᵀ Q; 0 M] h) = [.. G; 0 Φ] gives S = Φᵀ G.
        let m = oscillator();
        let q: Matrix3 = matrix![0.0, 0.0, 0.0; 0.0, 2.0, -1.0; 0.0, -1.0, 3.0];
        for h in [1e-5, 1e-3, 2e-2] {
            let mut block = SMatrix::<f64, 6, 6>::zeros();
            block
                .fixed_view_mut::<3, 3>(0, 0)
                .copy_from(&(-m.transpose() * h));
            block.fixed_view_mut::<3, 3>(0, 3).copy_from(&(q * h));
            block.fixed_view_mut::<3, 3>(3, 3).copy_from(&(m * h));
            let exponential = block.exp();
            let expected = exponential.fixed_view::<3, 3>(3, 3).transpose()
                * exponential.fixed_view::<3, 3>(0, 3);
            let error = largest(&(quadratic_integral(&m, &q, h) - expected));
            assert!(error < 1e-12 * largest(&expected), "h {h}: {error:e}");
        }
    }

    #[test]
    fn plain_arrays_multiply_as_matrices_do() {
        let m: SMatrix<f64, 2, 3> = matrix![1.0, 2.0, 3.0; 4.0, 5.0, 6.0];
        assert_eq!(apply(&columns(&m), &[1.0, 10.0, 100.0]), [321.0, 654.0]);
        let s: SMatrix<f64, 2, 2> = matrix![1.0, 3.0; 3.0, 2.0];
        assert_eq!(quadratic(&columns(&s), &[2.0, 5.0]), 4.0 + 60.0 + 50.0);
    }
}
