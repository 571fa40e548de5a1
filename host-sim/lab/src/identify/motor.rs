//! Identifies the motor of a real knob. Resistance, inductance and flux come from the voltages of its current controller. Inertia,
//! damping and friction then come from [`super::swing`], with torques computed from current and flux.
//!
//! The data are those that the device sends during a measurement (`touchstone_drive::measurement`). First a current vector
//! rotates far faster than the rotor can follow, at two amplitudes one after the other. Then the motor pushes the rotor to two
//! speeds in both directions; each push ends in a coast.

use super::swing::{self, Estimate, Mechanics, Swing, Torques};
use nalgebra::Complex;
use std::f64::consts::TAU;
use std::ops::Range;
use touchstone_protocol::MeasuringPart;

/// Data that a device sends for one control period (tick) of the motor's measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorTick {
    /// Number of the control period (tick).
    pub tick: u32,
    /// Part of the measurement to which the tick belongs.
    pub part: MeasuringPart,
    /// Position of the shaft, encoder counts.
    pub count: i32,
    /// Current in A that the current controller has just used, as the complex number `d + jq` in the rotating frame (`d` along the
    /// field, `q` across it).
    pub current_a: Complex<f64>,
    /// Voltage in V, in the same rotating frame as the current.
    pub voltage_v: Complex<f64>,
}

/// Properties of the motor that the caller has to give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownMotor {
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Encoder counts per turn.
    pub counts_per_rev: f64,
    /// Number of pole pairs, which the motor's alignment has confirmed.
    pub pole_pairs: f64,
    /// Frequency of the fast rotating current, electrical turns per second.
    pub fast_field_hz: f64,
}

/// Identified properties of a motor with its knob.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredMotor {
    /// Resistance of one phase to the star point, Ω, including that of the bridge.
    pub resistance_ohm: Estimate,
    /// Inductance of one phase to the star point, H.
    pub inductance_h: Estimate,
    /// Flux linkage of the motor, Wb.
    pub flux_linkage_wb: Estimate,
    /// Torque constant, N·m per ampere of phase amplitude: 3/2 times pole pairs times flux linkage.
    pub torque_constant_n_m_per_a: Estimate,
    /// Inertia, damping and friction of rotor and knob.
    pub mechanics: Mechanics,
}

/// Reason why the motor was not identified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NotMeasured {
    /// Data of the measurement are missing.
    #[error("the measurement is incomplete: {part} is missing")]
    Incomplete {
        /// Name of the missing part of the measurement.
        part: &'static str,
    },
    /// Too many records in a row were lost in transmission.
    #[error("{lost} records in a row were lost")]
    Lost {
        /// Number of records lost in a row.
        lost: u32,
    },
    /// A push was too short: it reached its speed after too few samples.
    #[error("a push lasted {ticks} control periods, too short to show the voltage rise")]
    ShortPush {
        /// Duration of the push, in ticks (control periods).
        ticks: usize,
    },
    /// A computed value is impossible for a motor.
    #[error("the {what} results as {value:.3e}, which is impossible for a motor")]
    Absurd {
        /// Name of the quantity whose value is impossible.
        what: &'static str,
        /// The impossible value, in its SI unit.
        value: f64,
    },
    /// The motion does not fit a free knob.
    #[error("the motion is not that of a free knob: {0}")]
    Motion(#[from] swing::NotFound),
    /// The swings (pushes with coasts) give different inertias, for example because a hand holds the knob.
    #[error("the swings disagree about the inertia by {percent:.0} %")]
    Disagree {
        /// Four times the standard uncertainty of the inertia, % of the inertia.
        percent: f64,
    },
}

/// Longest gap in the data that is filled by interpolation, ticks.
const LOST_MOST: u32 = 5;
/// Half length of the window for a speed, ticks: a speed is the difference of positions this many ticks before and after.
const HALF_WINDOW: usize = 4;
/// Largest accepted uncertainty of the inertia: four standard uncertainties as a fraction of the inertia. A hand at the knob
/// exceeds it.
const DISAGREEMENT_MOST: f64 = 0.1;

/// Identifies the motor from a device's data.
///
/// # Errors
/// Data are missing, a value is not possible, or the motion is not that of a free knob; see [`NotMeasured`].
pub fn motor(
    ticks: &[MotorTick],
    known: &KnownMotor,
) -> std::result::Result<MeasuredMotor, NotMeasured> {
    let ticks = filled(ticks)?;
    let parts = parts(&ticks);
    let of = |part: MeasuringPart| parts.iter().filter(move |(it, _)| *it == part);
    let only = |part, name| {
        let missing = NotMeasured::Incomplete { part: name };
        of(part).next().map(|(_, range)| range).ok_or(missing)
    };
    let low = only(MeasuringPart::Low, "the fast field at half its current")?;
    let high = only(MeasuringPart::High, "the fast field")?;
    let impedance = impedance(&ticks, low, high, known);
    let resistance = positive("resistance", impedance.map(|z| z.re))?;
    let omega = TAU * known.fast_field_hz;

    let pushes: Vec<Range<usize>> = of(MeasuringPart::Push).map(|(_, it)| it.clone()).collect();
    let coasts: Vec<Range<usize>> = of(MeasuringPart::Coast).map(|(_, it)| it.clone()).collect();
    // The pushes in order: fast forward and backward, slow forward and backward.
    let [there, back, _, _] = pushes.as_slice() else {
        return Err(NotMeasured::Incomplete { part: "a push" });
    };
    if coasts.len() < 4 {
        return Err(NotMeasured::Incomplete { part: "a coast" });
    }
    let flux = |pushes: &[&Range<usize>]| flux(&ticks, pushes, resistance.value, known);
    // Each direction is also fitted alone; the difference between the two shows what the model does not contain.
    let (both, ways) = (flux(&[there, back])?, [flux(&[there])?, flux(&[back])?]);
    let linkage = positive("flux", [both.abs(), ways[0].abs(), ways[1].abs()])?;
    let constant = 1.5 * known.pole_pairs;

    let swings: Vec<Swing> = [0, 2, 1, 3]
        .into_iter()
        .map(|index| {
            let whole = pushes[index].start..coasts[index].end;
            of_swing(&ticks, whole, constant * both, known)
        })
        .collect();
    // The reported current is that at the end of a control period. In the first of a slow push's 35 ticks it is a third above
    // that tick's mean current. The push's torque is then wrong by less than a percent, which `Torques::Exact` would attribute to
    // friction.
    let mechanics = swing::mechanics(&swings, 1.0 / known.rate_hz, Torques::Unsure)?;
    let inertia = mechanics.inertia_kg_m2;
    let disagreement = 4.0 * inertia.uncertainty / inertia.value;
    // NaN is refused too.
    if disagreement.is_nan() || disagreement > DISAGREEMENT_MOST {
        return Err(NotMeasured::Disagree {
            percent: 100.0 * disagreement,
        });
    }
    // The rotor is not held. In the fast field it oscillates by `k_t I/(J ω²)`. Half of its back-EMF turns with the field and looks
    // like a capacitor in series.
    let reaction =
        constant * known.pole_pairs * linkage.value.powi(2) / (2.0 * inertia.value * omega.powi(2));
    let inductance = impedance.map(|z| z.im / omega + reaction);
    Ok(MeasuredMotor {
        resistance_ohm: resistance,
        inductance_h: positive("inductance", inductance)?,
        torque_constant_n_m_per_a: Estimate {
            value: constant * linkage.value,
            uncertainty: constant * linkage.uncertainty,
        },
        flux_linkage_wb: linkage,
        mechanics,
    })
}

/// Makes an estimate from the value for all data, and from the values for two parts of the data. Half the difference of the two
/// values is the uncertainty.
fn positive(
    what: &'static str,
    [value, first, second]: [f64; 3],
) -> std::result::Result<Estimate, NotMeasured> {
    if !(value.is_finite() && value > 0.0) {
        return Err(NotMeasured::Absurd { what, value });
    }
    Ok(Estimate {
        value,
        uncertainty: 0.5 * (first - second).abs(),
    })
}

/// The data with missing ticks interpolated, one entry per tick.
fn filled(ticks: &[MotorTick]) -> std::result::Result<Vec<MotorTick>, NotMeasured> {
    let mut all: Vec<MotorTick> = Vec::with_capacity(ticks.len());
    for tick in ticks {
        if let Some(last) = all.last().copied() {
            let lost = tick.tick.wrapping_sub(last.tick).saturating_sub(1);
            if lost > LOST_MOST {
                return Err(NotMeasured::Lost { lost });
            }
            let way = f64::from(tick.count - last.count);
            for step in 1..=lost {
                let share = f64::from(step) / f64::from(lost + 1);
                all.push(MotorTick {
                    tick: last.tick.wrapping_add(step),
                    count: last.count + (way * share).round() as i32,
                    ..last
                });
            }
        }
        all.push(*tick);
    }
    Ok(all)
}

/// Index range of each part of the measurement.
fn parts(ticks: &[MotorTick]) -> Vec<(MeasuringPart, Range<usize>)> {
    let mut start = 0;
    ticks
        .chunk_by(|a, b| a.part == b.part)
        .map(|run| {
            let range = start..start + run.len();
            start = range.end;
            (run[0].part, range)
        })
        .collect()
}

/// Impedance: difference of the voltages divided by difference of the currents, between the low and the high current. Returns the
/// value over the last quarter of a second of each current, then the values over the two halves of that time.
fn impedance(
    ticks: &[MotorTick],
    low: &Range<usize>,
    high: &Range<usize>,
    known: &KnownMotor,
) -> [Complex<f64>; 3] {
    let window = (known.rate_hz / 4.0) as usize;
    let mean = |range: Range<usize>| {
        let count = range.len().max(1) as f64;
        let sum = ticks[range]
            .iter()
            .fold((Complex::ZERO, Complex::ZERO), |sum, tick| {
                (sum.0 + tick.voltage_v, sum.1 + tick.current_a)
            });
        (sum.0 / count, sum.1 / count)
    };
    // The last two ticks are left out, because their readings may belong to the next part.
    let last = |range: &Range<usize>, from: usize, to: usize| {
        let end = range.end.saturating_sub(2);
        let at = |back: usize| end.saturating_sub(back).max(range.start);
        at(from)..at(to)
    };
    [(window, 0), (window, window / 2), (window / 2, 0)].map(|(from, to)| {
        let (low, high) = (mean(last(low, from, to)), mean(last(high, from, to)));
        (high.0 - low.0) / (high.1 - low.1)
    })
}

/// Flux linkage in Wb: slope of `v_q - R i_q` over the electrical speed, with the q-axis voltage and current and the resistance
/// `R`.
///
/// Each push has its own offset, for the voltage lost to dead time. The slope is negative if the electrical angle falls when the
/// count rises.
fn flux(
    ticks: &[MotorTick],
    pushes: &[&Range<usize>],
    resistance_ohm: f64,
    known: &KnownMotor,
) -> std::result::Result<f64, NotMeasured> {
    let per_count = TAU / known.counts_per_rev * known.pole_pairs * known.rate_hz;
    let (mut square, mut product) = (0.0, 0.0);
    for push in pushes {
        let ticks = &ticks[(*push).clone()];
        if ticks.len() < 6 * HALF_WINDOW {
            return Err(NotMeasured::ShortPush { ticks: ticks.len() });
        }
        let points: Vec<(f64, f64)> = ticks
            .windows(2 * HALF_WINDOW + 1)
            .map(|window| {
                let (first, middle) = (&window[0], &window[HALF_WINDOW]);
                let way = f64::from(window[2 * HALF_WINDOW].count - first.count);
                let speed = way * per_count / (2 * HALF_WINDOW) as f64;
                let emf = middle.voltage_v.im - resistance_ohm * middle.current_a.im;
                (speed, emf)
            })
            .collect();
        let count = points.len() as f64;
        let sum = points
            .iter()
            .fold((0.0, 0.0), |sum, point| (sum.0 + point.0, sum.1 + point.1));
        let (speed, emf) = (sum.0 / count, sum.1 / count);
        for point in points {
            square += (point.0 - speed).powi(2);
            product += (point.0 - speed) * (point.1 - emf);
        }
    }
    Ok(product / square)
}

/// Makes a swing (a push and the coast after it) from the record. The current that a tick reports acted in the control period
/// before the tick.
fn of_swing(ticks: &[MotorTick], whole: Range<usize>, constant: f64, known: &KnownMotor) -> Swing {
    let per_count = TAU / known.counts_per_rev;
    let first = ticks[whole.start].count;
    let next = |index: usize| ticks.get(index + 1).map_or(0.0, |tick| tick.current_a.im);
    Swing {
        torque_n_m: whole.clone().map(|index| constant * next(index)).collect(),
        angle_rad: ticks[whole.clone()]
            .iter()
            .map(|tick| per_count * f64::from(tick.count - first))
            .collect(),
    }
}
