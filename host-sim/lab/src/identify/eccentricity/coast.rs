//! Measures the encoder's error from the shaft's own motion: with the motor switched off, the shaft slows down evenly.
//!
//! The model of the encoder's reading over time is `P(t) + ε(θ) + Σ (ω0/ω)² (c_n cos nθ + d_n sin nθ)`. The polynomial `P`
//! describes the slowing down, `ε` the encoder's error at the angle `θ`. The sum is the motion caused by a torque that repeats
//! `n` = 1 or 2 times per turn. The sum depends on the speed `ω` (`ω0` is the first speed), which distinguishes the sum from the
//! error. In the small terms, `θ` is the reading minus the error of the previous iteration. Each coast is fitted alone. The
//! uncertainty is the larger of the fits' own and the coasts' difference from their mean.

use super::least::{Normal, of_cos_sin};
use super::{CalibrationTick, KnownEncoder, ORDERS, Said};
use nalgebra::Complex;
use std::f64::consts::TAU;
use touchstone_protocol::MeasuringPart;

/// Number of ticks at the start of a coast that are left out, because the current is still decaying.
const EDGE: usize = 8;
/// Fraction of the first speed at which the used part of a coast ends.
const SLOWEST: f64 = 0.5;
/// Smallest first speed of a used coast, as a fraction of the fastest coast's first speed. In a slower coast, torques disturb the
/// motion too much.
const SLOW: f64 = 0.6;
/// Fewest turns of the shaft in a usable coast.
const TURNS_LEAST: f64 = 3.0;
/// Degree of the polynomial for the slowing down. Over the used range of speeds it follows an exponential decay with an error far
/// below an encoder count.
const DEGREE: usize = 6;
/// Number of iterations in which the encoder's error is subtracted from the reading.
const ROUNDS: usize = 3;
/// Half length of the window for a speed, ticks: a speed is the difference of positions this many ticks before and after.
const HALF_WINDOW: usize = 10;

/// Computes the encoder's error from a measurement's coasts; `None` if fewer than two coasts are long and fast enough.
#[must_use]
pub fn said(ticks: &[CalibrationTick], known: &KnownEncoder) -> Option<Said> {
    let runs = ticks.chunk_by(|a, b| a.part == b.part);
    let coasts = runs.filter(|run| run[0].part == Some(MeasuringPart::Coast));
    let ways: Vec<(f64, Said)> = coasts.filter_map(|run| way(run, known)).collect();
    let fastest = ways.iter().fold(0.0, |most, it| it.0.max(most));
    let ways: Vec<Said> = ways
        .into_iter()
        .filter(|it| it.0 > SLOW * fastest)
        .map(|it| it.1)
        .collect();
    if ways.len() < 2 {
        return None;
    }
    let count = ways.len() as f64;
    let mut parts = [Complex::ZERO; ORDERS];
    let mut uncertainty_rad = [0.0_f64; ORDERS];
    for index in 0..ORDERS {
        let mean = ways.iter().map(|it| it.parts[index]).sum::<Complex<f64>>() / count;
        let spread = ways.iter().map(|it| (it.parts[index] - mean).norm());
        let noise = ways.iter().map(|it| it.uncertainty_rad[index]);
        parts[index] = mean;
        uncertainty_rad[index] = spread.fold(0.0, f64::max).max(noise.fold(0.0, f64::max));
    }
    let squares: f64 = ways.iter().map(|it| it.residual_rms_rad.powi(2)).sum();
    Some(Said {
        parts,
        uncertainty_rad,
        residual_rms_rad: (squares / count).sqrt(),
    })
}

/// Computes the first speed of a coast in rad per tick (control period), and the encoder's error from that coast.
fn way(run: &[CalibrationTick], known: &KnownEncoder) -> Option<(f64, Said)> {
    let per_count = TAU / known.counts_per_rev;
    let run = run.get(EDGE..)?;
    let begun = run.first()?.tick;
    let at = |it: &CalibrationTick| f64::from(it.tick.wrapping_sub(begun));
    let angle = |it: &CalibrationTick| per_count * f64::from(it.count);
    let points: Vec<(f64, f64, f64)> = run
        .windows(2 * HALF_WINDOW + 1)
        .map(|window| {
            let (first, last) = (&window[0], &window[2 * HALF_WINDOW]);
            let speed = (angle(last) - angle(first)) / (at(last) - at(first));
            let middle = &window[HALF_WINDOW];
            (at(middle), angle(middle), speed)
        })
        .collect();
    let fastest = points.first()?.2;
    let looked_at = points
        .iter()
        .take_while(|it| it.2 / fastest > SLOWEST)
        .count();
    let points = &points[..looked_at];
    let (first, last) = (points.first()?, points.last()?);
    if (last.1 - first.1).abs() < TURNS_LEAST * TAU {
        return None;
    }
    let (middle, half) = (0.5 * (first.0 + last.0), 0.5 * (last.0 - first.0));
    let mut said = Said {
        parts: [Complex::ZERO; ORDERS],
        uncertainty_rad: [0.0; ORDERS],
        residual_rms_rad: 0.0,
    };
    let mut speeds: Vec<f64> = points.iter().map(|it| it.2 / fastest).collect();
    for _ in 0..ROUNDS {
        let mut normal = Normal::new(DEGREE + 1 + 4 * ORDERS);
        for ((time, reading, _), speed) in points.iter().zip(&speeds) {
            let time = (time - middle) / half;
            let error: f64 = (1..)
                .zip(&said.parts)
                .map(|(order, part)| (part * Complex::cis(f64::from(order) * reading)).im)
                .sum();
            let shaft = reading - error;
            let shaken = speed.powi(-2);
            let mut row = [1.0; DEGREE + 1 + 4 * ORDERS];
            row[1] = time;
            // Chebyshev polynomials, because plain powers would be nearly dependent.
            for power in 2..=DEGREE {
                row[power] = 2.0 * time * row[power - 1] - row[power - 2];
            }
            for index in 0..ORDERS {
                let (sin, cos) = ((index + 1) as f64 * shaft).sin_cos();
                let from = DEGREE + 1 + 4 * index;
                row[from..from + 4].copy_from_slice(&[cos, sin, shaken * cos, shaken * sin]);
            }
            normal.add(&row, reading - first.1);
        }
        let solved = normal.solve()?;
        for index in 0..ORDERS {
            let from = DEGREE + 1 + 4 * index;
            said.parts[index] = of_cos_sin(solved.values[from], solved.values[from + 1]);
            said.uncertainty_rad[index] =
                solved.uncertainties[from].hypot(solved.uncertainties[from + 1]);
        }
        said.residual_rms_rad = solved.residual_rms;
        // Speed of the slowing down alone, without the encoder's error.
        for ((time, ..), speed) in points.iter().zip(&mut speeds) {
            let slope = slope(solved.values.as_slice(), (time - middle) / half);
            *speed = slope / (half * fastest);
        }
    }
    Some((fastest.abs(), said))
}

/// Derivative of a sum of Chebyshev polynomials at a time; the derivative of the `k`th polynomial is `k U_{k-1}` (Chebyshev
/// polynomial of the second kind).
fn slope(values: &[f64], time: f64) -> f64 {
    let (mut before, mut second) = (0.0, 1.0);
    let mut sum = 0.0;
    for (power, value) in values.iter().enumerate().take(DEGREE + 1).skip(1) {
        sum += value * power as f64 * second;
        (before, second) = (second, 2.0 * time * second - before);
    }
    sum
}
