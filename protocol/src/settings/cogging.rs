//! The map of a motor's cogging that a board keeps: the current that holds it, by the encoder's own angle, as a few harmonics.
//!
//! Harmonics, not a table: cogging has few (the least common multiple of slots and poles, and where slots or magnets differ, multiples of
//! either), a hundred bytes hold them, and their sum is zero over a turn by what they are. Currents, not torques: what was measured as a
//! current is played as a current, and a wrong torque constant falls out. Kept and bound as an alignment is ([`super::kept`]).

use super::DeviceSettings;
use super::kept::{MeasuredWith, Unkept};
use crate::Board;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// No map has more harmonics.
pub const HARMONICS: usize = 12;
/// Fractional bits of a harmonic's current: steps of 0.12 mA, at most 4 A.
pub const CURRENT_BITS: u32 = 13;
/// No [`KeptCogging`] takes more bytes in flash (a test).
pub const COGGING_MAX: usize = 120;

/// One harmonic, `cos·cos(n θ) + sin·sin(n θ)`, with `θ` from the encoder's zero in the direction in which it counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct CoggingHarmonic {
    /// `n`, periods in a turn, from 1.
    pub order: u8,
    /// A current that pushes along the count, 2^-13 A.
    pub cos: i16,
    /// Factor of the sine, in the same unit.
    pub sin: i16,
}

/// The current that holds the cogging.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct CoggingMap {
    /// The harmonics.
    pub harmonics: Vec<CoggingHarmonic, HARMONICS>,
}

/// A map, and what it was measured with.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeptCogging {
    /// The hardware with which it was measured.
    pub with: MeasuredWith,
    /// The map.
    pub map: CoggingMap,
}

impl KeptCogging {
    /// The map, if it was measured with the present settings.
    ///
    /// # Errors
    /// Why the map cannot be used.
    pub fn usable(&self, settings: &DeviceSettings, board: Board) -> Result<&CoggingMap, Unkept> {
        self.with.fits(settings, board).map(|()| &self.map)
    }
}

/// A measurement that the next calibration goes on with.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Sweep {
    /// No measurement is under way.
    #[default]
    None,
    /// The shaft is turned slowly, both ways, as if no map were kept.
    Bare,
    /// A sweep while the map is played.
    Compensated,
}

/// A board's report on its cogging map.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct CoggingReport {
    /// The kept map; `Save` writes it.
    pub kept: Option<KeptCogging>,
    /// Whether the electrical angle falls when the count rises; known once the device is calibrated.
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
