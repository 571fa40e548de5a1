//! Measures the encoder's error with the motor's field, which turns at a known speed: one electrical turn, then a mechanical one,
//! and the same back.
//!
//! The tick at which the motion ends is known: there the calibration ends, or its next part begins. The ticks before it belong to
//! the turn back, the ticks before those to the turn forward. In each direction the last mechanical turn is used, in which the
//! field's speed is constant. The model is `reading = C + s ω t + ε`, with a constant `C`, the field's angle `s ω t` (direction
//! `s`, speed `ω`, time `t`) and the error `ε`. Friction makes the shaft lag, which is part of `C`. The shaft's true angle, on
//! which the error depends, is therefore `C + s ω t`.
//!
//! A light rotor with little damping oscillates around the field, at about 20 Hz and by a degree. The fit therefore has a term in
//! proportion to the measured acceleration, and this motion does not count as encoder error. The term also absorbs some
//! thousandths of the error `ε` (with `n` periods per turn), because the reading accelerates by `-(n ω)² ε`. The code corrects
//! for this loss.

use super::least::{Normal, of_cos_sin};
use super::{CalibrationTick, KnownEncoder, NotSeen, ORDERS, Said};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Number of ticks that are left out at both ends of a turn. The field changes direction there, and a count belongs to the field
/// of the previous tick.
const EDGE: f64 = 3.0;
/// Smallest fraction of a turn's ticks whose data must have arrived.
const HEARD_LEAST: f64 = 0.8;
/// Time step of the second difference that gives the acceleration, s; shorter than a period of the rotor's oscillation.
const DIFFERENCE_S: f64 = 6e-3;
/// Largest accepted residual of the fit, root mean square, electrical degrees. A larger residual means that a hand held the shaft,
/// or that the calibration only checked an alignment.
const OFF_MOST_DEG: f64 = 10.0;
/// Largest accepted difference between the two directions: 3.5e-3 rad (0.2 degrees), or the fraction `DISAGREE_MOST` of the
/// amplitude if that is larger.
const DISAGREE_MOST_RAD: f64 = 3.5e-3;
const DISAGREE_MOST: f64 = 0.2;

/// Computes the encoder's error from the turning field of a calibration.
///
/// # Errors
/// Data are missing, the shaft did not follow the field, or the directions differ; see [`NotSeen`].
pub fn said(ticks: &[CalibrationTick], known: &KnownEncoder) -> Result<Said, NotSeen> {
    let turning = ticks.iter().take_while(|it| it.part.is_none());
    let ticks: Vec<CalibrationTick> = turning.copied().collect();
    let turn = known.pole_pairs / known.field_turns_per_s * known.rate_hz;
    // The field's speed is ramped up within a quarter of a second, so its mean until then is half.
    let ramp = (known.rate_hz / 4.0).floor().max(1.0);
    let way = turn + known.rate_hz / known.field_turns_per_s + 0.5 * (ramp - 1.0);
    let of = |end: f64| Way::new(&ticks, end, turn, known);
    let (back, there) = (of(0.0)?, of(way)?);
    let mut parts = [Complex::ZERO; ORDERS];
    let mut uncertainty_rad = [0.0; ORDERS];
    for index in 0..ORDERS {
        let (a, b) = (there.parts[index], back.parts[index]);
        parts[index] = 0.5 * (a + b);
        let apart = (a - b).norm();
        if apart > DISAGREE_MOST_RAD.max(DISAGREE_MOST * parts[index].norm()) {
            return Err(NotSeen::DoesNotRepeat {
                degrees: apart.to_degrees(),
            });
        }
        uncertainty_rad[index] = (0.5 * apart).max(there.noise_rad.max(back.noise_rad));
    }
    Ok(Said {
        parts,
        uncertainty_rad,
        residual_rms_rad: there.residual_rad.hypot(back.residual_rad) / 2_f64.sqrt(),
    })
}

/// Results of one mechanical turn of the field.
struct Way {
    parts: [Complex<f64>; ORDERS],
    noise_rad: f64,
    residual_rad: f64,
}

impl Way {
    /// Fits the turn that ended `end` ticks before the last tick.
    fn new(
        ticks: &[CalibrationTick],
        end: f64,
        turn: f64,
        known: &KnownEncoder,
    ) -> Result<Self, NotSeen> {
        let last = ticks.last().map_or(0, |it| it.tick);
        let before = |it: &CalibrationTick| f64::from(last.wrapping_sub(it.tick)) - end;
        let ticks: Vec<&CalibrationTick> = ticks
            .iter()
            .filter(|it| (EDGE..=turn - EDGE).contains(&before(it)))
            .collect();
        let (Some(first), Some(latest)) = (ticks.first(), ticks.last()) else {
            return Err(incomplete(0, turn));
        };
        // If the telemetry contains only every n-th tick, fewer ticks are needed.
        let told = ticks
            .windows(2)
            .map(|it| it[1].tick.wrapping_sub(it[0].tick));
        let every = f64::from(told.min().unwrap_or(1).max(1));
        if (ticks.len() as f64) < HEARD_LEAST * turn / every {
            return Err(incomplete(ticks.len(), turn / every));
        }
        let moved = f64::from(latest.count - first.count);
        let (direction, per_count) = (moved.signum(), TAU / known.counts_per_rev);
        let behind = TAU - per_count * moved.abs();
        if behind > 0.5 * TAU {
            return Err(NotSeen::NotFollowed {
                degrees: (known.pole_pairs * behind).to_degrees(),
            });
        }
        let mut normal = Normal::new(2 + 2 * ORDERS);
        let reach = ((DIFFERENCE_S * known.rate_hz / every) as usize).max(1);
        let reading = |it: &CalibrationTick| per_count * f64::from(it.count - first.count);
        for window in ticks.windows(2 * reach + 1) {
            let (it, ends) = (window[reach], [window[0], window[2 * reach]]);
            let turned = -direction * TAU * before(it) / turn;
            let row = [
                1.0,
                turned.cos(),
                turned.sin(),
                (2.0 * turned).cos(),
                (2.0 * turned).sin(),
                reading(ends[0]) + reading(ends[1]) - 2.0 * reading(it),
            ];
            normal.add(&row, reading(it) - turned);
        }
        let Some(solved) = normal.solve() else {
            return Err(incomplete(ticks.len(), turn / every));
        };
        let off_deg = (known.pole_pairs * solved.residual_rms).to_degrees();
        // NaN is refused too.
        if off_deg.is_nan() || off_deg > OFF_MOST_DEG {
            return Err(NotSeen::NotFollowed { degrees: off_deg });
        }
        let of = &solved.values;
        // Angle of the shaft from count 0 at the moment at which the field's angle is 0.
        let place = of[0] + per_count * f64::from(first.count);
        let part = |index: usize| {
            let order = (index + 1) as f64;
            // The second difference contains a part of the encoder's error itself, which is corrected here.
            let step = order * TAU * reach as f64 * every / turn;
            let own = 1.0 + 2.0 * (step.cos() - 1.0) * of[2 * ORDERS + 1];
            of_cos_sin(of[2 * index + 1], of[2 * index + 2]) * own * Complex::cis(-order * place)
        };
        Ok(Self {
            parts: std::array::from_fn(part),
            noise_rad: (1..=2 * ORDERS)
                .fold(0.0, |most, column| solved.uncertainties[column].max(most)),
            residual_rad: solved.residual_rms,
        })
    }
}

fn incomplete(heard: usize, needed: f64) -> NotSeen {
    NotSeen::Incomplete {
        heard,
        needed: needed as usize,
    }
}
