//! Motions of a hand into a wall, as a list of penetrations in rad, one per control period.

/// One press as half a sine wave: in to `depth_rad` and out again within `ticks` control periods, 0 at both ends.
#[must_use]
pub fn half_sine(depth_rad: f64, ticks: u32) -> Vec<f64> {
    (0..=ticks)
        .map(|tick| {
            // In floating point the sine of π is not quite zero.
            if tick == 0 || tick == ticks {
                0.0
            } else {
                depth_rad * (std::f64::consts::PI * f64::from(tick) / f64::from(ticks)).sin()
            }
        })
        .collect()
}

/// A press that, on its way in and out, comes out by 30 % of its depth and goes in again eight times, like a searching hand.
#[must_use]
pub fn wiggle(depth_rad: f64, ticks: u32) -> Vec<f64> {
    let press = half_sine(depth_rad, ticks);
    let wave = |tick: usize| {
        let turns = 8.0 * tick as f64 / f64::from(ticks);
        (1.0 - (std::f64::consts::TAU * turns).cos()) / 2.0
    };
    press
        .iter()
        .enumerate()
        .map(|(tick, e)| e * (1.0 - 0.3 * wave(tick)))
        .collect()
}

/// A motion into the wall in 200 control periods, a little back in 50, and a hold for `ticks` periods. The way back ends the phase
/// in which the control law SFA starts with a soft wall.
#[must_use]
pub fn hold(depth_rad: f64, ticks: usize) -> Vec<f64> {
    let ramp = |tick: u32, of: u32| {
        (1.0 - (std::f64::consts::PI * f64::from(tick) / f64::from(of)).cos()) / 2.0
    };
    let rest = 0.92 * depth_rad;
    let into = (0..200).map(|tick| depth_rad * ramp(tick, 200));
    let back = (0..50).map(|tick| depth_rad + (rest - depth_rad) * ramp(tick, 50));
    into.chain(back)
        .chain(std::iter::repeat_n(rest, ticks))
        .collect()
}

/// Rounds the positions of a motion to a grid with `bits` fractional bits.
#[must_use]
pub fn on_grid(path: &[f64], bits: i32) -> Vec<f64> {
    let scale = 2_f64.powi(bits);
    path.iter().map(|e| (e * scale).round() / scale).collect()
}
