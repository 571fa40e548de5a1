//! The map of a motor's cogging torque that a board stores. The map is the current that holds the shaft against the cogging
//! torque, as a function of the encoder's own angle. The current is a sum of a few harmonics of a turn.
//!
//! The map holds harmonics and not a table, because cogging has few harmonics: multiples of the least common multiple of slots
//! and poles. If slots or magnets differ from one another, multiples of the number of slots or of poles are added. The harmonics
//! take about a hundred bytes, and their mean over a turn is zero. The map holds currents and not torques: a current is measured
//! and a current is applied, so a wrong torque constant does no harm. Like a stored alignment a map is valid only for the
//! hardware with which it was measured ([`super::kept`]).

use super::DeviceSettings;
use super::kept::{MeasuredWith, Unkept};
use crate::Board;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Largest number of harmonics in a cogging map.
pub const HARMONICS: usize = 12;
/// Fractional bits of a harmonic's current in amperes: the current has steps of 0.12 mA and is at most 4 A.
pub const CURRENT_BITS: u32 = 13;
/// Most bytes that a [`KeptCogging`] takes in flash (a test checks it).
pub const COGGING_MAX: usize = 120;

/// One harmonic of the current: field `cos` times `cos(n θ)` plus field `sin` times `sin(n θ)`, with the order `n`. The angle `θ`
/// of the shaft is measured from the encoder's own zero in the direction of rising counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct CoggingHarmonic {
    /// Order `n` of the harmonic: its number of periods in a turn, 1 or more.
    pub order: u8,
    /// Factor of the cosine, in units of 2^-13 A; a positive current pushes in the direction of rising counts.
    pub cos: i16,
    /// Factor of the sine, in units of 2^-13 A.
    pub sin: i16,
}

/// The map of a motor's cogging torque: the current that holds the shaft against that torque, over a turn.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct CoggingMap {
    /// The harmonics whose sum is the current.
    pub harmonics: Vec<CoggingHarmonic, HARMONICS>,
}

/// A cogging map with the hardware with which it was measured.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeptCogging {
    /// The hardware with which the map was measured.
    pub with: MeasuredWith,
    /// The cogging map.
    pub map: CoggingMap,
}

impl KeptCogging {
    /// The cogging map, if it was measured with the hardware that the present settings describe.
    ///
    /// # Errors
    /// Why the map cannot be used.
    pub fn usable(&self, settings: &DeviceSettings, board: Board) -> Result<&CoggingMap, Unkept> {
        self.with.fits(settings, board).map(|()| &self.map)
    }
}

/// Whether and how the next calibration turns the shaft slowly both ways, to measure the cogging.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Sweep {
    /// The calibration does not turn the shaft to measure the cogging.
    #[default]
    None,
    /// The shaft is turned slowly both ways. A stored cogging map does not compensate meanwhile.
    Bare,
    /// The shaft is turned slowly both ways while the stored map compensates the cogging.
    Compensated,
}

/// A board's report on its cogging map.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct CoggingReport {
    /// The stored map; `Save` writes it to flash.
    pub kept: Option<KeptCogging>,
    /// Whether the motor's electrical angle falls when the encoder count rises; known once the device is calibrated.
    pub against: Option<bool>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn longest() -> KeptCogging {
        let mut settings = DeviceSettings::defaults(Board::NucleoG474reIhm16m1);
        settings.encoder.counts_per_rev = u32::MAX;
        let part = CoggingHarmonic {
            order: u8::MAX,
            cos: i16::MIN,
            sin: i16::MAX,
        };
        KeptCogging {
            with: MeasuredWith::new(&settings, Board::NucleoG474reIhm16m1),
            map: CoggingMap {
                harmonics: [part; HARMONICS].into_iter().collect(),
            },
        }
    }

    #[test]
    fn the_longest_map_fits() {
        let mut buffer = [0; COGGING_MAX];
        assert!(postcard::to_slice(&Some(longest()), &mut buffer).is_ok());
    }

    #[test]
    fn a_map_is_of_the_motor_encoder_and_direction_that_it_was_measured_with() {
        let board = Board::NucleoG474re;
        let settings = DeviceSettings::defaults(board);
        let kept = KeptCogging {
            with: MeasuredWith::new(&settings, board),
            ..longest()
        };
        assert_eq!(kept.usable(&settings, board), Ok(&kept.map));
        let mut other = settings.clone();
        other.motor.pole_pairs = 11;
        assert_eq!(kept.usable(&other, board), Err(Unkept::OtherPolePairs));
        other = settings.clone();
        other.encoder.reversed = true;
        assert_eq!(kept.usable(&other, board), Err(Unkept::OtherEncoder));
        let shield = Board::NucleoG474reIhm16m1;
        assert_eq!(kept.usable(&settings, shield), Err(Unkept::OtherBoard));
    }
}
