//! Velocities made of measured positions, as the literature on haptic walls makes them.
//!
//! With `e` the penetration at tick `n`, `T` the tick, `v` the velocity:
//!
//! - **low pass**: `v(n) = (τ v(n-1) + e(n) - e(n-1))/(τ + T)`, the difference behind a first-order low pass of `τ`, mapped by the backward
//!   difference. The wall of Colgate and Brown, *Factors affecting the Z-width of a haptic display*, ICRA 1994, with the filter of
//!   J. M. Brown's thesis, Northwestern 1995, appendix A.
//! - **Levant**: `x' = v`, `v = u - 1.5 sqrt(C) sqrt(abs(x - e)) sign(x - e)`, `u' = -1.1 C sign(x - e)`, a step of Euler a tick; exact
//!   for every motion whose acceleration is below `C`. Levant, *Robust exact differentiation via sliding mode technique*, Automatica
//!   34(3), 1998; for walls Chawda, Celik and O'Malley, *Application of Levant's differentiator for velocity estimation and increased
//!   Z-width in haptic interfaces*, World Haptics 2011.
//! - **window**: `v(n) = (e(n) - e(n-i))/(i T)` of the largest `i` for which that line passes within a band of every position between, and
//!   so do the lines of all lesser `i`. End-fit FOAW of Janabi-Sharifi, Hayward and Chen, *Discrete-time adaptive windowing for velocity
//!   estimation*, IEEE TCST 8(6), 2000.

use crate::scene::{Differentiation, Velocity};
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// One of them, with its memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Differentiator {
    period_s: f64,
    way: Way,
}

#[derive(Debug, Clone, PartialEq)]
enum Way {
    LowPass {
        tau_s: f64,
        last: Option<f64>,
        velocity: f64,
    },
    Levant {
        acceleration: f64,
        /// Observed position; none before the first tick.
        position: Option<f64>,
        /// The part of the velocity that is integrated.
        drift: f64,
    },
    Window {
        band: f64,
        /// Most positions: one more than the longest window has ticks.
        most: usize,
        /// The newest first.
        positions: VecDeque<f64>,
    },
}

impl Differentiator {
    /// At rest, before the first position.
    #[must_use]
    pub fn new(velocity: &Velocity, period_s: f64) -> Self {
        let way = match velocity.differentiator {
            Differentiation::LowPass => Way::LowPass {
                tau_s: 1.0 / (TAU * velocity.cutoff_hz),
                last: None,
                velocity: 0.0,
            },
            Differentiation::Levant => Way::Levant {
                acceleration: velocity.acceleration_rad_per_s2,
                position: None,
                drift: 0.0,
            },
            Differentiation::Window => {
                let longest = (velocity.window_s / period_s).round().max(1.0);
                Way::Window {
                    band: velocity.band_rad,
                    most: longest as usize + 1,
                    positions: VecDeque::new(),
                }
            }
        };
        Self { period_s, way }
    }

    /// The velocity at a position, rad/s; one call a tick.
    pub fn rad_per_s(&mut self, position_rad: f64) -> f64 {
        let period_s = self.period_s;
        match &mut self.way {
            Way::LowPass {
                tau_s,
                last,
                velocity,
            } => {
                let moved = position_rad - last.replace(position_rad).unwrap_or(position_rad);
                *velocity = (*tau_s * *velocity + moved) / (*tau_s + period_s);
                *velocity
            }
            Way::Levant {
                acceleration,
                position,
                drift,
            } => {
                let observed = position.unwrap_or(position_rad);
                let off = observed - position_rad;
                // `signum` of 0 is 1.
                let side = if off == 0.0 { 0.0 } else { off.signum() };
                let velocity = *drift - 1.5 * (*acceleration * off.abs()).sqrt() * side;
                *position = Some(observed + period_s * velocity);
                *drift -= period_s * 1.1 * *acceleration * side;
                velocity
            }
            Way::Window {
                band,
                most,
                positions,
            } => {
                positions.push_front(position_rad);
                positions.truncate(*most);
                slope(positions, *band) / period_s
            }
        }
    }
}

/// Slope a tick over the longest window whose line, and those of all shorter ones, pass within `band` of every position between.
fn slope(positions: &VecDeque<f64>, band: f64) -> f64 {
    let newest = positions.front().copied().unwrap_or(0.0);
    let mut slope = 0.0;
    for (length, oldest) in positions.iter().enumerate().skip(1) {
        let tried = (newest - oldest) / length as f64;
        let fits =
            |(ago, position): (usize, &f64)| (newest - tried * ago as f64 - position).abs() <= band;
        if !positions.iter().enumerate().take(length).skip(1).all(fits) {
            break;
        }
        slope = tried;
    }
    slope
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 1e-3;
    const COUNT_RAD: f64 = TAU / 40_000.0;

    fn of(differentiator: Differentiation) -> Differentiator {
        let velocity = Velocity {
            differentiator,
            // Half as much again as the swing below has.
            acceleration_rad_per_s2: 20.0,
            ..Velocity::default()
        };
        Differentiator::new(&velocity, PERIOD_S)
    }

    /// Largest error of the velocity after 0.2 s, for positions in whole counts.
    fn error(
        kind: Differentiation,
        position: impl Fn(f64) -> f64,
        truth: impl Fn(f64) -> f64,
    ) -> f64 {
        let mut differentiator = of(kind);
        (0..1000)
            .map(|tick| {
                let at_s = f64::from(tick) * PERIOD_S;
                let counted = (position(at_s) / COUNT_RAD).round() * COUNT_RAD;
                let found = differentiator.rad_per_s(counted);
                if tick < 200 {
                    0.0
                } else {
                    (found - truth(at_s)).abs()
                }
            })
            .fold(0.0, f64::max)
    }

    /// A difference of counts is off by up to a count a tick, 0.157 rad/s; each of these is better at a steady motion.
    #[test]
    fn a_steady_motion_is_known_better_than_by_a_difference() {
        let error = |kind| error(kind, |t| 0.35 * t, |_| 0.35);
        assert!(error(Differentiation::LowPass) < 0.08);
        assert!(error(Differentiation::Levant) < 0.12);
        // Half a count at either end of a window of 15 ticks.
        assert!(error(Differentiation::Window) < COUNT_RAD / 15.0 / PERIOD_S * 1.5);
    }

    /// By its lag times the acceleration, and a count over the window.
    #[test]
    fn a_swing_is_followed() {
        let (swing, omega) = (0.02, TAU * 4.0);
        for kind in [
            Differentiation::LowPass,
            Differentiation::Levant,
            Differentiation::Window,
        ] {
            let error = error(
                kind,
                |t| swing * (omega * t).sin(),
                |t| swing * omega * (omega * t).cos(),
            );
            let lag_s = 1.0 / (TAU * 100.0) + PERIOD_S;
            let most = swing * omega * omega * lag_s + 0.6 * COUNT_RAD / PERIOD_S;
            assert!(error < most, "{kind:?}: {error} of {most}");
        }
    }

    #[test]
    fn the_low_pass_is_its_formula() {
        let mut differentiator = of(Differentiation::LowPass);
        let tau = 1.0 / (TAU * 100.0);
        assert_eq!(differentiator.rad_per_s(0.3), 0.0);
        let first = differentiator.rad_per_s(0.31);
        assert!((first - 0.01 / (tau + PERIOD_S)).abs() < 1e-12);
        let second = differentiator.rad_per_s(0.31);
        assert!((second - tau * first / (tau + PERIOD_S)).abs() < 1e-12);
    }

    #[test]
    fn the_window_ends_where_a_position_does_not_fit() {
        let positions = |newest_first: &[f64]| newest_first.iter().copied().collect();
        // Three ticks of slope 1, before them a rest.
        let turned: VecDeque<f64> = positions(&[3.0, 2.0, 1.0, 0.0, 0.0, 0.0]);
        assert_eq!(slope(&turned, 0.1), 1.0);
        // A wide band takes the whole of it.
        assert_eq!(slope(&turned, 2.0), 0.6);
        assert_eq!(slope(&positions(&[3.0]), 0.1), 0.0);
    }
}
