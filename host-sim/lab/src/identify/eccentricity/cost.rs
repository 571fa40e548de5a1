//! Computes how much the encoder's error disturbs a wall, and whether the encoder's magnet should be mounted again.

use super::{Eccentricity, Harmonic};
use std::f64::consts::TAU;

/// Number of angles per turn at which the error is computed.
const PLACES: u32 = 720;

/// Largest acceptable error of the field's direction, electrical degrees; it costs 3.4 % of the torque.
///
/// The check of a stored alignment (`touchstone_drive::calibration`) has a limit of 20 degrees, of which it allows 15 for this
/// error. With a larger error it would refuse a correct alignment at some angles.
pub const ELECTRICAL_MOST_DEG: f64 = 15.0;
/// Largest acceptable relative error of a wall's stiffness by the encoder's error. The scorecard has the same limit for a hand at
/// rest.
pub const STIFFNESS_MOST: f64 = 0.05;

/// Effects of an eccentric encoder on a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Largest error of the measured position, rad.
    pub place_rad: f64,
    /// Largest error of the field's direction, electrical degrees.
    pub electrical_deg: f64,
    /// Largest fraction of the torque that is lost at any angle: `1 - cos(p ε)`, with `p` pole pairs and the encoder's error `ε`.
    pub torque_lost: f64,
    /// Largest relative error of a stiffness or a speed: the slope of the encoder's error over the angle.
    pub stiffness_off: f64,
}

/// Reason why the encoder's magnet should be mounted again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reseat {
    /// The direction of the motor's field has too large an error.
    Electrical,
    /// The error of the wall's stiffness is too large.
    Stiffness,
}

impl Eccentricity {
    /// Computes the effects of the encoder's error on a wall and on a motor with this number of pole pairs.
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
            // Beyond a quarter of an electrical turn no torque is left to lose.
            torque_lost: 1.0 - electrical.min(TAU / 4.0).cos(),
            stiffness_off: slope,
        }
    }

    /// The largest error of a measured position that the energy guard has to allow for, rad: the amplitudes of the two orders, and
    /// their uncertainties. It is 0 if neither order stands out. Orders above the second are not measured.
    #[must_use]
    pub fn position_error_rad(&self) -> f64 {
        let stand_out = (0..self.harmonics.len()).any(|index| self.stands_out(index));
        let largest = |it: &Harmonic| it.amplitude_rad + it.uncertainty_rad;
        match stand_out {
            true => self.harmonics.iter().map(largest).sum(),
            false => 0.0,
        }
    }

    /// Slope of the encoder's error at an angle: the fraction by which the reading turns faster than the shaft.
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
    /// Reason to mount the encoder's magnet again; `None` if the error is acceptable.
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
