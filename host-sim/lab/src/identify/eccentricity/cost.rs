//! The cost of the encoder's error for a wall, and when to seat its magnet anew.

use super::Eccentricity;
use std::f64::consts::TAU;

/// Places of a turn that are examined.
const PLACES: u32 = 720;

/// More than this is too much, electrical degrees. The check of a kept alignment allows for 15 of its 20 (`touchstone_drive::calibration`), and a right
/// one would be refused at some places. It is 3.4 % of the torque.
pub const ELECTRICAL_MOST_DEG: f64 = 15.0;
/// Largest tolerable error as a share of the stiffness: the scorecard's limit for a wall under a hand that rests.
pub const STIFFNESS_MOST: f64 = 0.05;

/// The cost of an eccentric encoder for a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Largest error of a wall's place, rad.
    pub place_rad: f64,
    /// Error of the motor's field, electrical degrees.
    pub electrical_deg: f64,
    /// Part of the torque that is lost at the worst place: `1 - cos(p ε)`.
    pub torque_lost: f64,
    /// The largest part by which a stiffness, or a speed, is read wrong: the slope of the error.
    pub stiffness_off: f64,
}

/// Why the magnet should be seated anew.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reseat {
    /// The motor's field is too far from where it should be.
    Electrical,
    /// The wall's stiffness is too far off.
    Stiffness,
}

impl Eccentricity {
    /// The cost with this many pole pairs.
    #[must_use]
    pub fn cost(&self, pole_pairs: f64) -> Cost {
        let places = (0..PLACES).map(|place| TAU * f64::from(place) / f64::from(PLACES));
        let (mut place_rad, mut slope) = (0.0_f64, 0.0_f64);
        for angle in places {
            place_rad = place_rad.max(self.error_rad(angle).abs());
            slope = slope.max(self.slope(angle).abs());
        }
        let electrical = pole_pairs * place_rad;
        Cost {
            place_rad,
            electrical_deg: electrical.to_degrees(),
            // Beyond a quarter of a turn nothing is left, and more is not lost.
            torque_lost: 1.0 - electrical.min(TAU / 4.0).cos(),
            stiffness_off: slope,
        }
    }

    /// Share by which the reading turns faster than the shaft.
    fn slope(&self, angle_rad: f64) -> f64 {
        let parts = self.harmonics.iter().zip(1..);
        parts
            .map(|(it, order)| {
                let order = f64::from(order);
                order * it.amplitude_rad * (order * angle_rad + it.phase_rad).cos()
            })
            .sum()
    }
}

impl Cost {
    /// Whether, and why, the magnet should be seated anew.
    #[must_use]
    pub fn reseat(&self) -> Option<Reseat> {
        if self.electrical_deg > ELECTRICAL_MOST_DEG {
            Some(Reseat::Electrical)
        } else if self.stiffness_off > STIFFNESS_MOST {
            Some(Reseat::Stiffness)
        } else {
            None
        }
    }
}
