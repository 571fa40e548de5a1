//! Packs the command and the report of the two mailboxes between current loop and control interrupt into 32-bit words. The firmware
//! passes the words through atomics. Every bit pattern decodes to a valid value: an unknown mode becomes [`CurrentMode::Off`], an
//! unknown trip (reason for switching off) becomes none.

use crate::Volts;
use crate::angle::Angle;
use crate::current::{CurrentCommand, CurrentMode, CurrentReport, Offsets, Trip};
use crate::transform::Dq;
use fixed::types::I16F16;
use touchstone_protocol::FaultCode;

/// A [`CurrentCommand`] as 32-bit words.
pub type CommandWords = [u32; 5];
/// A [`CurrentReport`] as 32-bit words.
pub type ReportWords = [u32; 12];

const fn bits(value: I16F16) -> u32 {
    value.to_bits().cast_unsigned()
}

const fn value(bits: u32) -> I16F16 {
    I16F16::from_bits(bits.cast_signed())
}

const fn pair(low: u16, high: u16) -> u32 {
    low as u32 | (high as u32) << 16
}

const fn low(word: u32) -> u16 {
    word as u16
}

const fn high(word: u32) -> u16 {
    (word >> 16) as u16
}

impl CurrentCommand {
    /// Packs the command into words for the exchange between interrupts.
    #[inline]
    #[must_use]
    pub const fn to_words(&self) -> CommandWords {
        [
            self.tick,
            pair(self.angle.0, self.mode as u16),
            self.advance.cast_unsigned(),
            bits(self.current.d),
            bits(self.current.q),
        ]
    }

    /// Unpacks a command from the words of the exchange between interrupts.
    #[inline]
    #[must_use]
    pub const fn from_words(words: &CommandWords) -> Self {
        let [tick, angle_mode, advance, d, q] = *words;
        Self {
            tick,
            mode: match high(angle_mode) {
                1 => CurrentMode::Offsets,
                2 => CurrentMode::Drive,
                _ => CurrentMode::Off,
            },
            angle: Angle(low(angle_mode)),
            advance: advance.cast_signed(),
            current: Dq {
                d: value(d),
                q: value(q),
            },
        }
    }
}

impl CurrentReport {
    /// Packs the report into words for the exchange between interrupts.
    #[inline]
    #[must_use]
    pub fn to_words(&self) -> ReportWords {
        let (code, trip) = self
            .trip
            .map_or((0, 0), |trip| (trip.code.to_wire(), trip.value));
        let offsets = self.offsets.unwrap_or_default();
        let flags = pair(
            u16::from(code) | u16::from(self.trips) << 8,
            // The spread of the offsets has 12 bits.
            offsets.spread.min(0x7FFF) << 1 | u16::from(self.offsets.is_some()),
        );
        [
            self.periods,
            bits(self.current.d),
            bits(self.current.q),
            bits(self.voltage.d),
            bits(self.voltage.q),
            bits(self.bus),
            pair(self.temperature, self.missed),
            pair(self.saturated, 0),
            flags,
            trip.cast_unsigned(),
            pair(offsets.a, offsets.b),
            0,
        ]
    }

    /// Unpacks a report from the words of the exchange between interrupts.
    #[inline]
    #[must_use]
    pub fn from_words(words: &ReportWords) -> Self {
        let [
            periods,
            d,
            q,
            v_d,
            v_q,
            bus,
            temperature_missed,
            saturated,
            flags,
            trip,
            offsets,
            _,
        ] = *words;
        let [code, trips] = low(flags).to_le_bytes();
        Self {
            periods,
            current: Dq {
                d: value(d),
                q: value(q),
            },
            voltage: Dq {
                d: value(v_d),
                q: value(v_q),
            },
            bus: Volts::from_bits(bus.cast_signed()),
            temperature: low(temperature_missed),
            missed: high(temperature_missed),
            saturated: low(saturated),
            trips,
            trip: FaultCode::from_wire(code).map(|code| Trip {
                code,
                value: trip.cast_signed(),
            }),
            offsets: (high(flags) & 1 != 0).then_some(Offsets {
                a: low(offsets),
                b: high(offsets),
                spread: high(flags) >> 1,
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_in_comes_out() {
        let dq = |d, q| Dq {
            d: I16F16::from_bits(d),
            q: I16F16::from_bits(q),
        };
        let command = CurrentCommand {
            tick: 0xDEAD_BEEF,
            mode: CurrentMode::Drive,
            angle: Angle(0xABCD),
            advance: -12_345,
            current: dq(-1, i32::MAX),
        };
        assert_eq!(CurrentCommand::from_words(&command.to_words()), command);
        let report = CurrentReport {
            periods: 7,
            current: dq(-5, 6),
            voltage: dq(i32::MIN, 8),
            bus: Volts::from_num(24),
            temperature: 1_200,
            missed: 65_535,
            saturated: 3,
            trips: 255,
            trip: Some(Trip {
                code: FaultCode::StaleCommand,
                value: -41,
            }),
            offsets: Some(Offsets {
                a: 30_000,
                b: 31_000,
                spread: 12,
            }),
        };
        assert_eq!(CurrentReport::from_words(&report.to_words()), report);
        let empty = CurrentReport::default();
        assert_eq!(CurrentReport::from_words(&empty.to_words()), empty);
    }

    #[test]
    fn an_unknown_mode_is_off() {
        for mode in 3..100 {
            let command = CurrentCommand::from_words(&[1, pair(0, mode), 0, 0, 0]);
            assert_eq!(command.mode, CurrentMode::Off);
        }
    }
}
