//! A device without a hand, with Coulomb friction, solved in closed form.

use super::bare::BareLinear;
use super::device::{Coulomb, Device, Invalid};
use super::state::State;
use super::stepper::{Loss, Stepper};

/// A device without a hand under a held torque `u`: `J dv/dt = u - b v - friction(v)`. `J` is the inertia, `b` the viscous damping;
/// the state is angle and velocity `v`.
///
/// While the device turns, friction is the constant torque `F_k`. The total torque is then `w = u - sign(v) F_k`, and the velocity
/// goes monotonically towards `w/b`. The device stops in the interval exactly if the velocity at its end has the other sign; a
/// logarithm then gives the time of the stop. After the stop, the device rests while `|u|` is at most the break-away torque `F_s`.
/// Otherwise it starts in the other direction and turns to the end of the interval. An interval therefore has at most one stop and
/// one start.
///
/// An interval without a stop gives the same bits as [`BareLinear`] under the torque `w`. If both levels of friction are zero,
/// intervals in which the velocity changes sign agree with [`BareLinear`] to rounding only.
#[derive(Debug, Clone, PartialEq)]
pub struct BareCoulomb {
    sliding: BareLinear,
    kinetic: f64,
    breakaway: f64,
}

impl BareCoulomb {
    /// Prepares steps of `interval_s` seconds (zero or more).
    ///
    /// # Errors
    /// [`Invalid`] when device or interval are out of range, or when the device has no friction.
    pub fn new(device: &Device, interval_s: f64) -> Result<Self, Invalid> {
        let sliding = BareLinear::new(device, interval_s)?;
        let Coulomb { kinetic, breakaway } = device.required_friction()?;
        Ok(Self {
            sliding,
            kinetic,
            breakaway,
        })
    }

    /// Advances by one interval. Computes the losses only if `LOSS` is true.
    #[inline(always)]
    fn advance<const LOSS: bool>(&self, state: &mut State<2>, torque: f64) -> Loss {
        let v = state.0[1];
        // The sign of -0.0 is no direction: at rest, the torque decides.
        let sign = if v != 0.0 {
            1.0_f64.copysign(v)
        } else if torque.abs() <= self.breakaway {
            return Loss::default();
        } else {
            1.0_f64.copysign(torque)
        };
        let w = torque - sign * self.kinetic;
        let increment = self.sliding.increment(v, w);
        if sign * (v + increment[1]) < 0.0 {
            return self.stop_and_go_on::<LOSS>(state, torque, w);
        }
        state.add(&increment);
        if !LOSS {
            return Loss::default();
        }
        let device_j = self.sliding.viscous_loss(v, w) + self.kinetic * increment[0].abs();
        Loss {
            device_j,
            hand_j: 0.0,
        }
    }

    /// Advances by an interval in which the device, turning under the total torque `w` in N·m, comes to a stop.
    #[cold]
    #[inline(never)]
    fn stop_and_go_on<const LOSS: bool>(&self, state: &mut State<2>, torque: f64, w: f64) -> Loss {
        let interval = self.sliding.interval_s();
        let (time, first) = self.stop(state.0[1], w);
        let mut travel = first.travel;
        let mut device_j = first.viscous_j + self.kinetic * first.travel.abs();
        state.0[1] = 0.0;
        if torque.abs() > self.breakaway {
            let w = torque - self.kinetic.copysign(torque);
            let (velocity, second) = self.start(w, (interval - time).max(0.0));
            state.0[1] = velocity;
            travel += second.travel;
            device_j += second.viscous_j + self.kinetic * second.travel.abs();
        }
        state.0[0] += travel;
        if LOSS {
            Loss {
                device_j,
                hand_j: 0.0,
            }
        } else {
            Loss::default()
        }
    }

    /// Computes the motion from the velocity `v` to rest under a torque `w` of the opposite sign. Returns the time `τ` to the stop,
    /// with displacement and loss until then.
    ///
    /// With inertia `J`, damping `b` and `q = -b v / w = exp(b τ / J) - 1`:
    ///
    /// ```text
    /// τ = -(J v / w) L(q)              L = ln(1 + q) / q
    /// Δx = -(J v² / w) Λ(q)            Λ = (q - ln(1 + q)) / q²
    /// b ∫v² dt = J v² (1/2 - Λ(q))
    /// ```
    ///
    /// Up to `q = 1` all three values come from the series of `atanh`, `ln(1 + q) = 2 atanh(q / (2 + q))`. Its terms do not cancel,
    /// even for `b = 0`.
    fn stop(&self, v: f64, w: f64) -> (f64, Piece) {
        let (j, b) = (self.sliding.inertia, self.sliding.damping);
        let q = (-v * b / w).min(f64::MAX);
        let (time, travel, viscous_j) = if q <= 1.0 {
            let lead = -j * v / w;
            let t = q / (2.0 + q);
            // (atanh(t)/t - 1)/t² = 1/3 + t²/5 + t⁴/7 + ...; t² is at most 1/9.
            let rest = (0..19)
                .rev()
                .fold(0.0, |sum, k| sum * t * t + 1.0 / f64::from(2 * k + 3));
            let tail = 0.5 * (1.0 - t) * (1.0 - t) * t * rest;
            let lambda = 0.5 * (1.0 - t) - tail;
            (
                lead * (1.0 - t) * (1.0 + t * t * rest),
                lead * v * lambda,
                j * v * v * (0.5 * t + tail),
            )
        } else {
            let log = libm::log1p(q);
            let lambda = (q - log) / q / q;
            (
                j / b * log,
                j / b * (v + w / b * log),
                j * v * v * (0.5 - lambda),
            )
        };
        (
            time.min(self.sliding.interval_s()),
            Piece { travel, viscous_j },
        )
    }

    /// Computes the motion from rest under the torque `w` for the time `t`. Returns the final velocity, with displacement and loss.
    ///
    /// With inertia `J`, damping `b` and `z = b t / J`:
    ///
    /// ```text
    /// v = (w / J) t φ₁                 φ₁ = (1 - e⁻ᶻ) / z
    /// Δx = (w / J) t² φ₂               φ₂ = (1 - φ₁) / z
    /// b ∫v² dt = b (w / J)² t³ κ       κ = (z - 3/2 + 2 e⁻ᶻ - e⁻²ᶻ / 2) / z³
    /// ```
    fn start(&self, w: f64, t: f64) -> (f64, Piece) {
        let a = w / self.sliding.inertia;
        let z = self.sliding.damping * t / self.sliding.inertia;
        let (phi1, phi2, kappa) = growth(z);
        let viscous_j = self.sliding.damping * a * a * t * t * t * kappa;
        (
            a * t * phi1,
            Piece {
                travel: a * t * t * phi2,
                viscous_j,
            },
        )
    }
}

/// Displacement and viscous loss in a part of an interval in which the device turns in one direction.
struct Piece {
    travel: f64,
    viscous_j: f64,
}

/// The functions `(φ₁, φ₂, κ)` of [`BareCoulomb::start`], for `z >= 0`.
fn growth(z: f64) -> (f64, f64, f64) {
    if z > 1.0 {
        let decayed = libm::exp(-z);
        let phi1 = (1.0 - decayed) / z;
        let kappa = (z - 1.5 + 2.0 * decayed - 0.5 * decayed * decayed) / (z * z * z);
        return (phi1, (1.0 - phi1) / z, kappa);
    }
    // φ₂ = Σ (-z)ᵏ / (k + 2)!,  κ = Σ (-z)ᵏ (2ᵏ⁺² - 2) / (k + 3)!
    let (mut phi2, mut kappa) = (0.0, 0.0);
    let (mut power, mut two_to, mut factorial) = (1.0, 4.0, 2.0);
    for k in 0..28 {
        phi2 += power / factorial;
        factorial *= f64::from(k + 3);
        kappa += power * (two_to - 2.0) / factorial;
        power *= -z;
        two_to *= 2.0;
    }
    (1.0 - z * phi2, phi2, kappa)
}

impl Stepper for BareCoulomb {
    type State = State<2>;

    fn interval_s(&self) -> f64 {
        self.sliding.interval_s()
    }

    #[inline]
    fn step(&self, state: &mut State<2>, force: f64, _rest: f64) {
        self.advance::<false>(state, force);
    }

    #[inline]
    fn step_with_loss(&self, state: &mut State<2>, force: f64, _rest: f64) -> Loss {
        self.advance::<true>(state, force)
    }

    fn stored_energy_j(&self, state: &State<2>, rest: f64) -> f64 {
        self.sliding.stored_energy_j(state, rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(value: f64, expected: f64, tolerance: f64) {
        assert!(
            (value - expected).abs() <= tolerance * expected.abs(),
            "{value:e} is not {expected:e}"
        );
    }

    #[test]
    fn growth_is_continuous_where_its_two_forms_meet() {
        let (below, above) = (growth(1.0), growth(1.0_f64.next_up()));
        close(below.0, above.0, 2e-15);
        close(below.1, above.1, 2e-15);
        close(below.2, above.2, 2e-15);
        // Limits at z = 0.
        assert_eq!(growth(0.0), (1.0, 0.5, 1.0 / 3.0));
    }

    #[test]
    fn growth_matches_quadrature() {
        for z in [1e-9, 0.01, 0.7, 1.0, 3.0, 40.0] {
            // Simpson over s = t/T of v/(aT) = (1 - exp(-z s))/z.
            let n = 20_000;
            let v = |s: f64| -(-z * s).exp_m1() / z;
            let simpson = |f: &dyn Fn(f64) -> f64| {
                let h = 1.0 / f64::from(n);
                let inner: f64 = (1..n)
                    .map(|i| (if i % 2 == 1 { 4.0 } else { 2.0 }) * f(f64::from(i) * h))
                    .sum();
                (f(0.0) + inner + f(1.0)) * h / 3.0
            };
            let (phi1, phi2, kappa) = growth(z);
            close(phi1, v(1.0), 1e-15);
            close(phi2, simpson(&v), 1e-12);
            close(kappa, simpson(&|s| v(s) * v(s)), 1e-12);
        }
    }

    fn stepper(b: f64) -> BareCoulomb {
        let friction = Some(Coulomb {
            kinetic: 2e-3,
            breakaway: 3e-3,
        });
        let device = Device {
            inertia: 1e-4,
            damping: b,
            friction,
        };
        BareCoulomb::new(&device, 1.0).unwrap()
    }

    #[test]
    fn stop_agrees_with_the_equation_of_motion() {
        // Oracle: v(τ) = 0 and Δx from the textbook closed form, viscous loss from the energy balance; for small q, nearly equal
        // terms cancel in all three, hence a tolerance that depends on q.
        for (b, v) in [
            (5e-4, 1.0),
            (5e-4, 0.01),
            (5e-4, 30.0),
            (0.1, 0.05),
            (1e-5, 5.0),
        ] {
            let (j, w) = (1e-4, -2.5e-3);
            let (time, piece) = stepper(b).stop(v, w);
            let q: f64 = -b * v / w;
            let e = (-b * time / j).exp();
            assert!((w / b + (v - w / b) * e).abs() < 1e-14 * (v + (w / b).abs()));
            let travel = w / b * time + j / b * (v - w / b) * (1.0 - e);
            close(piece.travel, travel, 1e-14 / (q * q).min(1.0));
            close(
                piece.viscous_j,
                w * travel + 0.5 * j * v * v,
                1e-14 / (q * q * q).min(1.0),
            );
        }
    }

    #[test]
    fn stop_without_damping_is_a_parabola_and_its_limit() {
        let (time, piece) = stepper(0.0).stop(0.5, -2e-3);
        close(time, 0.5 * 1e-4 / 2e-3, 1e-15);
        close(piece.travel, 0.5 * 0.5 * 1e-4 / 2e-3 / 2.0, 1e-15);
        assert_eq!(piece.viscous_j, 0.0);
        let (near_time, near) = stepper(1e-12).stop(0.5, -2e-3);
        close(near_time, time, 1e-9);
        close(near.travel, piece.travel, 1e-9);
    }

    #[test]
    fn stop_is_continuous_where_its_two_forms_meet() {
        let stepper = stepper(5e-4);
        // q = 1 at v = -w/b.
        let (below, above) = (
            stepper.stop(5.0, -2.5e-3),
            stepper.stop(5.0_f64.next_up(), -2.5e-3),
        );
        close(below.0, above.0, 2e-15);
        close(below.1.travel, above.1.travel, 4e-15);
        close(below.1.viscous_j, above.1.viscous_j, 4e-15);
    }
}
