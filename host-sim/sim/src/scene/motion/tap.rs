//! Taps: the device reaches the wall at a given speed.
//!
//! The rest point alone says little about speed: a hand of 2 Hz on a soft pad barely follows a quick pulse. So the
//! wanted motion of the *device* in free air is given, a bump whose steepest point lies on the surface, and the rest
//! point that makes the chain device – pad – hand do just that is computed by inverting the chain. What the wall then
//! does to it is the experiment.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use crate::scene::device::DeviceSpec;
use crate::scene::operator::{Hand, Tap};

/// The bump is `sin⁶` over half a turn: five continuous derivatives, which the inversion uses up (two for each mass
/// and a slope). It is steepest where `tan² = 5`, at this height ...
const HEIGHT_AT_STEEPEST: f64 = 125.0 / 216.0;

/// ... with this slope over the angle: `6 sin⁵ cos = 6·(5/6)^(5/2)·(1/6)^(1/2)`.
fn steepest_slope() -> f64 {
    6.0 * libm::pow(5.0 / 6.0, 2.5) * (1.0_f64 / 6.0).sqrt()
}

/// `sin⁶ θ` as a sum of `cos 2kθ`, k = 0 to 3.
const HARMONICS: [f64; 4] = [10.0 / 32.0, -15.0 / 32.0, 6.0 / 32.0, -1.0 / 32.0];

/// Length of the whole tap, out and back, s.
pub(in crate::scene) fn length_s(spec: &Tap) -> f64 {
    PI * steepest_slope() * (spec.approach_rad / HEIGHT_AT_STEEPEST) / spec.velocity_rad_per_s
}

/// Rest point of a tap.
#[derive(Debug, Clone)]
pub(super) struct TapPath {
    outside_rad: f64,
    start_s: f64,
    length_s: f64,
    /// Complex amplitude of the rest point at each harmonic of the tap.
    rest: [Complex<f64>; 4],
    /// Time constant of the pad, damping over stiffness, s.
    pad_s: f64,
    /// The rest point's remainder at the start of each tap, since the harmonics assume that taps follow each other for
    /// ever. It dies away with the pad's time constant. It is subtracted at the start and added back at the end.
    left_over: f64,
}

impl TapPath {
    pub fn new(spec: &Tap, hand: &Hand, device: &DeviceSpec, surface_rad: f64) -> Self {
        let height = spec.approach_rad / HEIGHT_AT_STEEPEST;
        let length_s = length_s(spec);
        let chain: [_; 4] = std::array::from_fn(|k| {
            inverse_chain(Complex::new(0.0, TAU * k as f64 / length_s), hand, device)
        });
        let rest = std::array::from_fn(|k| chain[k].1 * (height * HARMONICS[k]));
        let hand_at_start: f64 = (0..4)
            .map(|k| (chain[k].0 * (height * HARMONICS[k])).re)
            .sum();
        let pad_s = hand.pad_damping_n_m_s_per_rad / hand.pad_stiffness_n_m_per_rad;
        // The pad's own motion pulls no torque at the device, so only the hand's own impedance at s = -1/pad_s stands
        // behind it.
        let left_over = if pad_s > 0.0 {
            let s = -1.0 / pad_s;
            let own = s * s * hand.inertia_kg_m2 + s * hand.damping_n_m_s_per_rad;
            hand_at_start * (1.0 + own / hand.stiffness_n_m_per_rad)
        } else {
            0.0
        };
        TapPath {
            outside_rad: surface_rad - spec.approach_rad,
            start_s: spec.start_s,
            length_s,
            rest,
            pad_s,
            left_over,
        }
    }

    pub fn rest_rad(&self, time_s: f64) -> f64 {
        let time = time_s - self.start_s;
        let share = time / self.length_s;
        let fading = |since: f64| {
            if self.pad_s > 0.0 {
                self.left_over * libm::exp(-since / self.pad_s)
            } else {
                0.0
            }
        };
        if share < 0.0 {
            return self.outside_rad;
        }
        if share > 1.0 {
            return self.outside_rad + fading(time - self.length_s) - fading(time);
        }
        let bump: f64 = (self.rest.iter().enumerate())
            .map(|(k, amplitude)| {
                let (sin, cos) = libm::sincos(TAU * k as f64 * share);
                amplitude.re * cos - amplitude.im * sin
            })
            .sum();
        self.outside_rad + bump - fading(time)
    }
}

/// Hand and rest point over device angle at the complex frequency `s`, without wall and dry friction.
fn inverse_chain(
    s: Complex<f64>,
    hand: &Hand,
    device: &DeviceSpec,
) -> (Complex<f64>, Complex<f64>) {
    let pull = s * s * device.inertia_kg_m2 + s * device.damping_n_m_s_per_rad;
    let hand_angle =
        pull / (s * hand.pad_damping_n_m_s_per_rad + hand.pad_stiffness_n_m_per_rad) + 1.0;
    let own = s * s * hand.inertia_kg_m2 + s * hand.damping_n_m_s_per_rad;
    (
        hand_angle,
        hand_angle + (own * hand_angle + pull) / hand.stiffness_n_m_per_rad,
    )
}
