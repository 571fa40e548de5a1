//! Measures the cogging of a real knob from the current that a slow, even turn needs at each angle. Also measures the cogging that
//! remains when the device compensates it by a map.
//!
//! The data are those that the device sends during a sweep (`touchstone_drive::sweep`): two turns in each direction, with positions
//! from the encoder's own zero. The equations are `J a = k_t i + T(θ) - F` forward and `J a = k_t i + T(θ) + F` backward. `θ` is
//! the angle, `J` the inertia, `a` the acceleration, `k_t` the torque constant, `i` the current, `T` the cogging torque, `F` the
//! friction. The mean of both directions does not contain `F`, so the current that compensates the cogging is `-T/k_t = i - J
//! a/k_t`. The acceleration follows from the motion: a ripple `δ` with `n` periods per turn at the speed `ω` has `a = -(n ω)² δ`.
//! The two turns in each direction make two pairs (one forward, one backward). The difference between the two pairs' means shows
//! how well the measurement repeats.

use nalgebra::Complex;
use std::f64::consts::TAU;
use touchstone_protocol::MeasuringPart;
use touchstone_protocol::settings::cogging::{
    CURRENT_BITS, CoggingHarmonic, CoggingMap, HARMONICS,
};

/// Data that a device sends for one control period (tick) of a cogging sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SweepTick {
    /// Number of the control period (tick).
    pub tick: u32,
    /// Direction of the turn in which the data were measured.
    pub part: MeasuringPart,
    /// Position from the encoder's own zero, encoder counts.
    pub count: i32,
    /// Current along the rotor's q axis (the one that makes torque), A.
    pub current_a: f64,
}

/// Properties of the knob that the caller has to give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownKnob {
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Encoder counts per turn.
    pub counts_per_rev: f64,
    /// Torque constant, N·m/A.
    pub torque_constant_n_m_per_a: f64,
    /// Inertia of rotor and knob, kg·m².
    pub inertia_kg_m2: f64,
    /// Whether the motor's electrical angle falls when the encoder count rises.
    pub against: bool,
    /// Largest current that a cogging map may contain, A.
    pub most_a: f64,
}

/// Fourier harmonics over a turn of the shaft, from a cogging sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Swept {
    /// Current that compensates the cogging, A, one entry per harmonic from order `n` = 1: `re cos(n θ) - im sin(n θ)` at the angle
    /// `θ`.
    current_a: Vec<Complex<f64>>,
    /// Half of the difference between the results of two pairs of turns (a pair has one turn in each direction), A, one entry per
    /// harmonic.
    apart_a: Vec<Complex<f64>>,
    /// Ripple of the shaft's angle around an even motion, rad, one entry per harmonic.
    ripple_rad: Vec<Complex<f64>>,
    /// Half of the torque difference between the two directions, N·m, caused by friction and damping.
    pub drag_n_m: f64,
}

/// A measured cogging map, with its torque and repeatability.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredCogging {
    /// The cogging map, in the form that the device stores.
    pub map: CoggingMap,
    /// Torque of the cogging map, root mean square, N·m.
    pub rms_n_m: f64,
    /// Largest torque of the map, N·m.
    pub peak_n_m: f64,
    /// How far the two pairs of turns differ: rms, over the map's harmonics, of half their difference, as a fraction of the map's
    /// rms.
    pub unrepeated: f64,
}

/// Reason why no cogging map was computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoMap {
    /// Data of the sweep are missing.
    #[error("the slow turn is incomplete: a turn is missing, or {lost} records in a row were lost")]
    Incomplete {
        /// Longest gap in the data, in ticks (control periods).
        lost: u32,
    },
    /// No harmonic of the cogging exceeds the noise.
    #[error("no cogging is measurable: it is below {n_m:.1e} N·m at every order")]
    Nothing {
        /// Torque above which a harmonic would have exceeded the noise, N·m.
        n_m: f64,
    },
    /// The turns differ too much from each other.
    #[error("the turns disagree by {percent:.0} % of what they have in common")]
    DoesNotRepeat {
        /// Half the difference between the two pairs of turns in a slow harmonic, rms over these harmonics, % of the map's rms.
        percent: f64,
    },
    /// The cogging needs more current than a map may contain.
    #[error(
        "the cogging takes {ampere:.3} A, more than the {most:.3} A of a map (a quarter of motor.current_limit_a)"
    )]
    TooLarge {
        /// Largest current that compensates the cogging, A.
        ampere: f64,
        /// Largest current that a map may contain, A.
        most: f64,
    },
}

/// Number of harmonics that are examined, from order 1.
const ORDERS: usize = 255;
/// Turns of the shaft per direction in a sweep.
const TURNS: usize = 2;
/// Longest gap that is accepted in the telemetry, ticks.
const LOST_MOST: u32 = 50;
/// Factor by which a harmonic must exceed the median difference between turns to be kept in the map. With noise alone, whose
/// amplitudes are Rayleigh-distributed, one sweep in twenty would have such a harmonic: `255 · 2^-(3.5²)` = 0.05.
const OUTSTANDING: f64 = 3.5;
/// Factor by which a harmonic's amplitude must exceed its own difference between two pairs of turns to be kept in the map.
const ITS_OWN: f64 = 2.0;
/// Largest order of a harmonic that counts as slow. A hand at the knob or a loose part appears in slow harmonics.
const SLOW: usize = 12;
/// Factor on the median difference above which the slow harmonics of two turns count as disagreeing. They must also differ by more
/// than the fraction `UNREPEATED_MOST` of the map.
const SLOW_MOST: f64 = 5.0;
const UNREPEATED_MOST: f64 = 0.2;

impl Swept {
    /// Computes the harmonics of a sweep from a device's telemetry.
    ///
    /// # Errors
    /// [`NoMap::Incomplete`]: data are missing.
    pub fn new(ticks: &[SweepTick], known: &KnownKnob) -> Result<Self, NoMap> {
        let way = |part| -> Vec<&SweepTick> { ticks.iter().filter(|it| it.part == part).collect() };
        let (there, back) = (way(MeasuringPart::Forward), way(MeasuringPart::Backward));
        let mut turns = Vec::new();
        for back_by in 0..TURNS {
            turns.push([
                Turn::new(&there, back_by, known)?,
                Turn::new(&back, back_by, known)?,
            ]);
        }
        let mean = |of: &dyn Fn(&Turn) -> &[Complex<f64>], turn: usize| -> Vec<Complex<f64>> {
            let [there, back] = &turns[turn];
            let pairs = of(there).iter().zip(of(back));
            pairs.map(|(a, b)| 0.5 * (a + b)).collect()
        };
        let both = |of: &dyn Fn(&Turn) -> &[Complex<f64>], sign: f64| -> Vec<Complex<f64>> {
            let pairs = mean(of, 0).into_iter().zip(mean(of, 1));
            pairs.map(|(a, b)| 0.5 * (a + sign * b)).collect()
        };
        let drag_a = turns.iter().map(|[there, back]| there.mean_a - back.mean_a);
        Ok(Self {
            current_a: both(&|turn| &turn.current_a, 1.0),
            apart_a: both(&|turn| &turn.current_a, -1.0),
            ripple_rad: both(&|turn| &turn.ripple_rad, 1.0),
            drag_n_m: 0.5 * known.torque_constant_n_m_per_a * drag_a.sum::<f64>() / TURNS as f64,
        })
    }

    /// Computes the cogging map of this sweep.
    ///
    /// # Errors
    /// No harmonic exceeds the noise, the turns differ too much, or the current is too large for a map; see [`NoMap`].
    pub fn map(&self, known: &KnownKnob) -> Result<MeasuredCogging, NoMap> {
        let constant = known.torque_constant_n_m_per_a;
        let mut apart: Vec<f64> = self.apart_a.iter().map(|it| it.norm()).collect();
        apart.sort_by(f64::total_cmp);
        let noise = apart[apart.len() / 2];
        let floor = OUTSTANDING * noise;
        let mut found: Vec<(usize, Complex<f64>)> = (1..)
            .zip(&self.current_a)
            .zip(&self.apart_a)
            .filter(|((_, it), apart)| it.norm() > floor.max(ITS_OWN * apart.norm()))
            .map(|((order, it), _)| (order, *it))
            .collect();
        found.sort_by(|a, b| b.1.norm().total_cmp(&a.1.norm()));
        found.truncate(HARMONICS);
        let kept: Vec<Complex<f64>> = found.iter().map(|(_, it)| *it).collect();
        let rms_a = rms(&kept);
        if found.is_empty() {
            return Err(NoMap::Nothing {
                n_m: floor * constant,
            });
        }
        // Noise is equal in all orders. A hand or a loose part shows in slow orders and differs from turn to turn.
        let slow = rms(&self.apart_a[..SLOW]) / (0.5 * SLOW as f64).sqrt();
        let unrepeated = slow / rms_a;
        if slow > SLOW_MOST * noise && unrepeated > UNREPEATED_MOST {
            return Err(NoMap::DoesNotRepeat {
                percent: 100.0 * unrepeated,
            });
        }
        let of_kept = found
            .iter()
            .filter_map(|(order, _)| self.apart_a.get(order - 1));
        let unrepeated = rms(&of_kept.copied().collect::<Vec<_>>()) / rms_a;
        let at = |angle: f64| -> f64 {
            let of =
                |(order, it): &(usize, Complex<f64>)| (it * Complex::cis(*order as f64 * angle)).re;
            found.iter().map(of).sum()
        };
        let places = 4_096;
        let peak_a = (0..places)
            .map(|place| at(TAU * f64::from(place) / f64::from(places)).abs())
            .fold(0.0, f64::max);
        if peak_a > known.most_a {
            return Err(NoMap::TooLarge {
                ampere: peak_a,
                most: known.most_a,
            });
        }
        // The value is below 4 A because of the check above and the largest current limit, so it fits into 16 bits.
        let bits = |ampere: f64| (ampere * f64::from(1 << CURRENT_BITS)).round() as i16;
        let harmonics = found.iter().map(|(order, it)| CoggingHarmonic {
            order: *order as u8,
            cos: bits(it.re),
            sin: bits(-it.im),
        });
        Ok(MeasuredCogging {
            map: CoggingMap {
                harmonics: harmonics.collect(),
            },
            rms_n_m: rms_a * constant,
            peak_n_m: peak_a * constant,
            unrepeated,
        })
    }

    /// Root mean square ripple of the shaft's angle in the harmonics of a map, rad.
    #[must_use]
    pub fn ripple_rad(&self, map: &CoggingMap) -> f64 {
        let of = |it: &CoggingHarmonic| self.ripple_rad.get(usize::from(it.order).checked_sub(1)?);
        rms(&map
            .harmonics
            .iter()
            .filter_map(of)
            .copied()
            .collect::<Vec<_>>())
    }
}

/// Root mean square of the sum of the given harmonics.
fn rms(harmonics: &[Complex<f64>]) -> f64 {
    let squares: f64 = harmonics.iter().map(|it| it.norm_sqr()).sum();
    (0.5 * squares).sqrt()
}

/// Harmonics of one turn in one direction.
struct Turn {
    current_a: Vec<Complex<f64>>,
    ripple_rad: Vec<Complex<f64>>,
    mean_a: f64,
}

impl Turn {
    /// Computes the harmonics of the last turn in a direction (`back_by` 0), or of the turn before the last (`back_by` 1).
    fn new(way: &[&SweepTick], back_by: usize, known: &KnownKnob) -> Result<Self, NoMap> {
        let incomplete = NoMap::Incomplete { lost: 0 };
        let (Some(first), Some(last)) = (way.first(), way.last()) else {
            return Err(incomplete);
        };
        let sign = f64::from((last.count - first.count).signum());
        let turn = known.counts_per_rev;
        // Distance to the end of the turns, encoder counts.
        let left = |it: &SweepTick| sign * f64::from(last.count - it.count);
        let (from, to) = (turn * (back_by + 1) as f64, turn * back_by as f64);
        let inside = |it: &&&SweepTick| left(it) < from && left(it) >= to;
        let ticks: Vec<&SweepTick> = way.iter().filter(inside).copied().collect();
        let is_whole = way.iter().any(|it| left(it) >= from);
        let lost = ticks
            .windows(2)
            .map(|pair| pair[1].tick.wrapping_sub(pair[0].tick).saturating_sub(1))
            .max();
        match lost {
            Some(lost) if lost > LOST_MOST => return Err(NoMap::Incomplete { lost }),
            Some(_) if is_whole => {}
            _ => return Err(incomplete),
        }
        Ok(Self::of(&ticks, known))
    }

    fn of(ticks: &[&SweepTick], known: &KnownKnob) -> Self {
        let angle = |it: &SweepTick| TAU * f64::from(it.count) / known.counts_per_rev;
        let current = |it: &SweepTick| match known.against {
            true => -it.current_a,
            false => it.current_a,
        };
        let time = |it: &SweepTick| f64::from(it.tick.wrapping_sub(ticks[0].tick)) / known.rate_hz;
        // Fits a straight line to the position as a function of time, because the speed is constant except for the ripple. The
        // residual of the position is the ripple.
        let count = ticks.len() as f64;
        let sum =
            |of: &dyn Fn(&SweepTick) -> f64| ticks.iter().map(|it| of(it)).sum::<f64>() / count;
        let (t, x) = (sum(&time), sum(&angle));
        let speed = sum(&|it| (time(it) - t) * (angle(it) - x)) / sum(&|it| (time(it) - t).powi(2));
        let ripple = |it: &SweepTick| angle(it) - x - speed * (time(it) - t);
        let direction = speed.signum();
        // Range of angles that a record represents: half of the distance to each neighbour, also across the ends of the turn.
        let whole = TAU * direction;
        let share = |index: usize| {
            let at = |index: usize, turns: f64| angle(ticks[index]) + turns * whole;
            let before = match index.checked_sub(1) {
                Some(before) => at(before, 0.0),
                None => at(ticks.len() - 1, -1.0),
            };
            let after = match index + 1 < ticks.len() {
                true => at(index + 1, 0.0),
                false => at(0, 1.0),
            };
            0.5 * direction * (after - before)
        };
        let shares: Vec<f64> = (0..ticks.len()).map(share).collect();
        let weighed = |of: &dyn Fn(&SweepTick) -> f64, order: f64| -> Complex<f64> {
            let parts = ticks.iter().zip(&shares);
            parts
                .map(|(it, share)| of(it) * share * Complex::cis(-order * angle(it)))
                .sum::<Complex<f64>>()
                / TAU
        };
        let mut all = Self {
            current_a: Vec::with_capacity(ORDERS),
            ripple_rad: Vec::with_capacity(ORDERS),
            mean_a: weighed(&current, 0.0).re,
        };
        for order in 1..=ORDERS {
            let order = order as f64;
            let (current, ripple) = (
                2.0 * weighed(&current, order),
                2.0 * weighed(&ripple, order),
            );
            // `i - J a/k_t`, with `a = -(n ω)² δ`.
            let of_inertia =
                known.inertia_kg_m2 * (order * speed).powi(2) / known.torque_constant_n_m_per_a;
            all.current_a.push(current + of_inertia * ripple);
            all.ripple_rad.push(ripple);
        }
        all
    }
}
