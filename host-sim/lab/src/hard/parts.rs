//! Hard cases of the parts around a control law: the encoder's counter, and the virtual mass in front of the wall.

use super::random::Random;
use super::{Case, Effort, Finding};
use touchstone_control::filter::{MassState, VirtualMass};
use touchstone_control::{CountScale, Divisor, Fixed32, Force, Position, Si, Stiffness};
use touchstone_protocol::unwrap::{Unwrap16, Unwrap32};
use touchstone_sim::error::Result;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "encoder-wrap",
        about: "counters of 16 and 32 bits that wrap around, 10^6 readings over thousands of turns",
        oracle: "the sum of the moves; the same penetration in every turn, to a step of the format",
        unit: "counts, or steps of the format",
        run: wrap,
    },
    Case {
        name: "virtual-mass",
        about: "the virtual mass over twelve decades, shaken at random",
        oracle: "backward Euler never gives energy; semi-implicit Euler is stable above k T²/4 and not below",
        unit: "of the throughput, or spectral radius",
        run: virtual_mass,
    },
];

fn wrap(_: Effort) -> Result<Vec<Finding>> {
    let mut random = Random::new(16);
    let (mut short, mut long) = (Unwrap16::new(65_000, 0), Unwrap32::new(u32::MAX - 5, 0));
    let (mut true_short, mut true_long) = (0_i64, 0_i64);
    let (mut off_short, mut off_long) = (0_i64, 0_i64);
    for _ in 0..1_000_000 {
        let move_short = (32_767.0 * random.uniform()) as i64 + 3_000;
        let move_short = move_short.clamp(-32_767, 32_767);
        true_short += move_short;
        let reading = (65_000 + true_short).rem_euclid(1 << 16) as u16;
        off_short = off_short.max((short.update(reading) - true_short).abs());
        let move_long = (2_147_483_647.0 * random.uniform()) as i64;
        true_long += move_long;
        let reading = (i64::from(u32::MAX) - 5 + true_long).rem_euclid(1 << 32) as u32;
        off_long = off_long.max((long.update(reading) - true_long).abs());
    }
    let mut found = vec![
        Finding::new("16 bits", off_short as f64, 0.0),
        Finding::new("32 bits", off_long as f64, 0.0),
    ];
    // A wall in another turn: the scale is exact to 1.4e-10 rad per turn, and a position to its step.
    for turns in [-100_i64, -1, 1, 100] {
        let surface = Si::saturating_from_num(std::f64::consts::TAU * turns as f64);
        let (Some(near), Some(far)) = (
            CountScale::new(40_000, Si::ZERO),
            CountScale::new(40_000, surface),
        ) else {
            continue;
        };
        let worst = (-200..200_i64)
            .map(|count| {
                let here = near.penetration::<Fixed32>(count).to_f64();
                let there = far.penetration::<Fixed32>(count + 40_000 * turns).to_f64();
                (here - there).abs() * 16_777_216.0
            })
            .fold(0.0, f64::max);
        found.push(Finding::new(format!("{turns} turns away"), worst, 1.0));
    }
    Ok(found)
}

/// Moves the virtual mass at random and sums the energy that the hand puts in. Returns the most energy that came out, divided by
/// the sum of all exchanged energies.
fn shaken(inertia: f64, stiffness: f64, damping: f64, ground: f64) -> f64 {
    let gain = |value: f64| Stiffness::<f64>(value);
    let total = gain(inertia + stiffness + damping + ground);
    let mass = VirtualMass::<f64> {
        inertia: gain(inertia),
        stiffness: gain(stiffness),
        damping: gain(damping),
        total,
        by_total: Divisor::of(total),
    };
    let mut random = Random::new(21);
    let (mut state, mut e) = (MassState::<f64>::default(), 0.0_f64);
    let (mut energy, mut least, mut throughput) = (0.0_f64, 0.0_f64, f64::MIN_POSITIVE);
    for tick in 0..20_000 {
        let moved = if tick % 50 < 40 {
            1e-3 * random.uniform()
        } else {
            0.0
        };
        // The position stays near its start, because sums of large numbers would hide the effect.
        let moved = moved - 0.01 * e;
        e += moved;
        let (position, change) = (Position::<f64>::from_f64(e), Position::from_f64(moved));
        let drive = mass.drive(&state, position, change);
        let step = mass.displacement(state.position, drive, Force::zero());
        state = state.moved_by(step);
        let work = mass.coupling(&state, position, change).to_f64() * moved;
        energy += work;
        throughput += work.abs();
        least = least.min(energy);
    }
    -least / throughput
}

fn virtual_mass(_: Effort) -> Result<Vec<Finding>> {
    let stiffness = 1.0;
    let mut found = Vec::new();
    for decade in -9..=3 {
        let inertia = stiffness * 10_f64.powi(decade);
        for (damping, ground) in [(0.0, 0.0), (0.3, 0.1)] {
            let name =
                format!("backward Euler, m = 1e{decade} k T², c = {damping}, c_env = {ground}");
            found.push(Finding::new(
                name,
                shaken(inertia, stiffness, damping, ground),
                1e-12,
            ));
        }
        // z² + (k/M - 2) z + 1 for a mass without damping: eigenvalues on the unit circle up to k/M = 4.
        let ratio = stiffness / inertia;
        let half = 1.0 - 0.5 * ratio;
        let radius = if half.abs() <= 1.0 {
            1.0
        } else {
            half.abs() + (half * half - 1.0).sqrt()
        };
        let grown = semi_implicit_growth(ratio);
        let name = format!("semi-implicit Euler, m = 1e{decade} k T²");
        // The bound is a multiple of the ratio of the axes of the motion's ellipse.
        let bound = 4.0 / (1.0 - half * half).abs().sqrt().max(1e-3);
        let finding = Finding::new(name, grown, bound);
        found.push(if radius > 1.0 {
            finding.failing(format!("below k T²/4: radius {radius:.3}"))
        } else {
            finding
        });
    }
    Ok(found)
}

/// Largest position in 2000 steps of a mass on a spring that semi-implicit Euler integrates from position 1. `ratio` is `k T²/m`:
/// stiffness times the square of the step's length, over the mass.
fn semi_implicit_growth(ratio: f64) -> f64 {
    let (mut position, mut moved, mut largest) = (1.0_f64, 0.0_f64, 1.0_f64);
    for _ in 0..2000 {
        moved -= ratio * position;
        position += moved;
        largest = largest.max(position.abs());
        if !largest.is_finite() || largest > 1e100 {
            break;
        }
    }
    largest
}
