//! Where a spring with damping takes its velocity from, for comparing with the literature: none of it is on a device.

use serde::{Deserialize, Serialize};

use super::law::{of_word, word};
use touchstone_control::choice;

choice! {
    /// How a velocity is made of positions.
    Differentiation {
        /// The difference of two positions through a low pass of first order.
        #[default]
        LowPass = "low-pass",
        /// Levant's sliding mode: an observer whose acceleration only has a sign.
        Levant = "levant",
        /// The slope over the longest window over which a line fits every position.
        Window = "window",
    }
}

/// A velocity made of measured positions in another way than by their difference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Velocity {
    /// Which way. Default `low-pass`.
    #[serde(deserialize_with = "of_word", serialize_with = "word")]
    pub differentiator: Differentiation,
    /// Corner of the low pass, Hz, above 0. Default 100.
    pub cutoff_hz: f64,
    /// Largest acceleration that Levant's observer follows, rad/s², above 0. Default 300.
    pub acceleration_rad_per_s2: f64,
    /// Longest window, s, above 0 and at most 1; rounded to ticks. Default 0.015.
    pub window_s: f64,
    /// Distance from the line up to which a position still fits it, rad, 0 or more. Default 1.6e-4.
    pub band_rad: f64,
}

impl Default for Velocity {
    fn default() -> Self {
        Velocity {
            differentiator: Differentiation::default(),
            cutoff_hz: 100.0,
            // What 30 mN·m does to the thesis' knob: less follows a touch too late, more shakes at 1 kHz.
            acceleration_rad_per_s2: 300.0,
            // As many positions at 1 kHz as the implementation of its authors' laboratory keeps.
            window_s: 0.015,
            // A count of the thesis' encoder: both ends of the line are off by half of one, and so is what lies between.
            band_rad: 1.6e-4,
        }
    }
}
