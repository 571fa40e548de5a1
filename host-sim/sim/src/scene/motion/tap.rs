//! Rest point of a hand that taps on the wall, so that the device reaches the wall at a given speed.
//!
//! A pulse of the rest point alone would not set the speed. A hand with a natural frequency of 2 Hz on a soft fingertip pad barely
//! follows a quick pulse. The tap is therefore given as a motion of the *device* in free air: a bump whose steepest point lies on
//! the wall's surface. The rest point is then computed backwards through the chain of device, pad and hand. With the wall present,
//! the device moves differently.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use crate::scene::device::DeviceSpec;
use crate::scene::operator::{Hand, Tap};

/// Height of the steepest point of a tap's bump, as a fraction of the bump's full height.
///
/// The bump is `sin⁶ θ` for `θ` from 0 to π, steepest where `tan² θ = 5`. It has five continuous derivatives, as the computation of
/// the rest point needs: two for each of the two masses, and one for a continuous slope.
const HEIGHT_AT_STEEPEST: f64 = 125.0 / 216.0;

/// Slope of the bump `sin⁶ θ` over `θ` at its steepest point: `6 sin⁵ θ cos θ = 6·(5/6)^(5/2)·(1/6)^(1/2)`.
fn steepest_slope() -> f64 {
    6.0 * libm::pow(5.0 / 6.0, 2.5) * (1.0_f64 / 6.0).sqrt()
}

/// Fourier coefficients of the tap's bump `sin⁶ θ`: the factors of `cos 2kθ` for k = 0 to 3.
const HARMONICS: [f64; 4] = [10.0 / 32.0, -15.0 / 32.0, 6.0 / 32.0, -1.0 / 32.0];

/// Duration of the whole tap, out and back, s.
pub(in crate::scene) fn length_s(spec: &Tap) -> f64 {
    PI * steepest_slope() * (spec.approach_rad / HEIGHT_AT_STEEPEST) / spec.velocity_rad_per_s
}

/// Rest point of the hand over time during a tap.
#[derive(Debug, Clone)]
pub(super) struct TapPath {
    outside_rad: f64,
    start_s: f64,
    length_s: f64,
    /// Complex amplitude of the rest point at each of the tap's harmonics 0 to 3, rad.
    rest: [Complex<f64>; 4],
    /// Time constant of the fingertip pad, s: its damping divided by its stiffness.
    pad_s: f64,
    /// Correction of the rest point at the start of the tap, rad. The harmonics describe taps repeated for ever, but a single tap
    /// starts from rest. The correction is subtracted at the start and added back at the end; it decays with the pad's time
    /// constant.
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
        // The free decay of the pad's deformation exerts no torque on the device. So the decay's effect on the rest point follows
        // from the hand's impedance at s = -1/pad_s.
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

/// Transfer functions from device angle to hand angle and to rest point, at the complex frequency `s`. Wall and dry friction are
/// left out.
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
