//! Motions of the HIP, given in penetration.

/// Half a sine wave: one press of `depth_rad`, in and out of the wall in `ticks`, zero at both ends.
#[must_use]
pub fn half_sine(depth_rad: f64, ticks: u32) -> Vec<f64> {
    (0..=ticks)
        .map(|tick| {
            // The sine of π is not quite zero in floats.
            if tick == 0 || tick == ticks {
                0.0
            } else {
                depth_rad * (std::f64::consts::PI * f64::from(tick) / f64::from(ticks)).sin()
            }
        })
        .collect()
}
