//! Encoder faults: the reading that the firmware gets instead of the true one.

use crate::random::Random;
use std::collections::VecDeque;
use touchstone_drive::EncoderReading;
use touchstone_drive::encoder::Frames;
use touchstone_world::motor::{as5047p_frame, mt6701_frame};

/// Encoder counts per turn, in the default settings of all boards.
pub const COUNTS: f64 = 16_384.0;

/// An encoder's fault. Displacements are in counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Encoder {
    /// The encoder does not answer.
    Silent,
    /// No fault: noise of 0.7 counts rms, and one missing answer in a thousand readings.
    Usual,
    /// The encoder does not answer in one of this many ticks.
    SilentEvery(u32),
    /// A bit of the word is wrong on the wire.
    Damaged,
    /// The reading stands still.
    Frozen,
    /// The reading jumps by this many counts.
    Jump(i64),
    /// The magnet slips on its shaft by this electrical angle in degrees, within this many ticks.
    Slip(f64, u32),
    /// The magnet creeps: a count in this many ticks.
    Creep(u32),
    /// A bit of the angle is always 0 or always 1.
    Bit(u32, bool),
    /// The reading runs the wrong way.
    Mirrored,
    /// The reading moves by half of the shaft's displacement.
    Half,
    /// Noise with this root mean square.
    Noise(f64),
    /// The reading is this many ticks old.
    Old(usize),
    /// The magnet is loose on the shaft, by this many counts to either side.
    Loose(i64),
    /// The magnet is off its centre: an error with this amplitude, once in a turn.
    Eccentric(f64),
    /// The second reading of a tick does not come.
    SecondMissing,
    /// The second reading is missing in one of this many ticks.
    SecondEvery(u32),
    /// The second reading stands still.
    SecondFrozen,
    /// The second reading is that of the tick before.
    SecondOld,
    /// The second reading is the first one again.
    SecondSame,
}

/// The state of a broken encoder.
#[derive(Debug, Clone)]
pub struct Memory {
    /// The last true reading. `moved` is the true displacement since the encoder broke.
    last: Option<i64>,
    moved: i64,
    /// The true reading when the encoder broke.
    start: i64,
    /// Displacement of a loose magnet, which follows the shaft only at the ends of its play.
    held: i64,
    /// True displacements at the first reading of each tick, the newest last. The second list has those at the second reading.
    history: [VecDeque<i64>; 2],
    /// Displacement that the first reading of the tick reported.
    first: i64,
    random: Random,
}

impl Default for Memory {
    fn default() -> Self {
        Self {
            last: None,
            moved: 0,
            start: 0,
            held: 0,
            history: [VecDeque::new(), VecDeque::new()],
            first: 0,
            random: Random::new(48),
        }
    }
}

impl Memory {
    /// A sample of noise with this root mean square.
    fn noise(&mut self, counts: f64) -> i64 {
        // Twelve uniform numbers: nearly a normal distribution, with a variance of four.
        let sum: f64 = (0..12).map(|_| self.random.real()).sum();
        (counts * sum / 2.0).round() as i64
    }
}

/// Counts of an electrical angle in degrees of a motor with 7 pole pairs.
fn of_electrical(degrees: f64) -> f64 {
    degrees / 360.0 / 7.0 * COUNTS
}

fn value(reading: EncoderReading) -> Option<(i64, i64)> {
    Some(match reading {
        EncoderReading::Counter16(value) => (i64::from(value), 1 << 16),
        EncoderReading::As5047p(frames) => (i64::from(frames.angle & 0x3fff), 1 << 14),
        EncoderReading::Mt6701(frame) => (i64::from(frame >> 10 & 0x3fff), 1 << 14),
        EncoderReading::Counter32(_) | EncoderReading::Silent => return None,
    })
}

/// The reading with another value and correct check bits.
fn with(reading: EncoderReading, value: i64) -> EncoderReading {
    match reading {
        EncoderReading::Counter16(_) => EncoderReading::Counter16(value as u16),
        EncoderReading::As5047p(Frames { before, .. }) => EncoderReading::As5047p(Frames {
            angle: as5047p_frame(value),
            before,
        }),
        EncoderReading::Mt6701(_) => EncoderReading::Mt6701(mt6701_frame(value, 0)),
        other => other,
    }
}

impl Encoder {
    /// The reading that the firmware gets at the `n`-th tick since the encoder broke; `None` for a missing reading.
    pub(super) fn falsified(
        self,
        memory: &mut Memory,
        n: u32,
        is_second: bool,
        reading: EncoderReading,
    ) -> Option<EncoderReading> {
        match (self, is_second) {
            (Self::Silent | Self::SecondMissing, true) => return None,
            (Self::SecondEvery(every), true) if n.is_multiple_of(every) => return None,
            (Self::Silent, false) => return Some(EncoderReading::Silent),
            (Self::SilentEvery(every), false) if n.is_multiple_of(every) => {
                return Some(EncoderReading::Silent);
            }
            (Self::Usual, _) if memory.random.real() > 0.998 => {
                return (!is_second).then_some(EncoderReading::Silent);
            }
            (Self::Damaged, _) => {
                return Some(match reading {
                    EncoderReading::As5047p(Frames { angle, before }) => {
                        let angle = angle ^ 0x10;
                        EncoderReading::As5047p(Frames { angle, before })
                    }
                    EncoderReading::Mt6701(frame) => EncoderReading::Mt6701(frame ^ 0x10),
                    other => other,
                });
            }
            _ => {}
        }
        let Some((now, range)) = value(reading) else {
            return Some(reading);
        };
        let last = memory.last.replace(now).unwrap_or_else(|| {
            memory.start = now;
            now
        });
        memory.moved += (now - last + range / 2).rem_euclid(range) - range / 2;
        let x = memory.moved;
        let history = &mut memory.history[usize::from(is_second)];
        history.push_back(x);
        if history.len() > 64 {
            history.pop_front();
        }
        let old = |ticks: usize| {
            let at = history.len().saturating_sub(1 + ticks);
            history[at]
        };
        let says = match self {
            Self::Bit(bit, is_set) => {
                let value = now & !(1 << bit) | i64::from(is_set) << bit;
                return Some(with(reading, value));
            }
            Self::Frozen => 0,
            Self::Jump(counts) => x + counts,
            Self::Slip(degrees, ticks) => {
                let share = (f64::from(n) / f64::from(ticks)).min(1.0);
                x + (of_electrical(degrees) * share) as i64
            }
            Self::Creep(ticks) => x + i64::from(n / ticks),
            Self::Mirrored => -x,
            Self::Half => x / 2,
            Self::Noise(counts) => x + memory.noise(counts),
            Self::Usual => x + memory.noise(0.7),
            Self::Old(ticks) => old(ticks),
            Self::Loose(play) => {
                memory.held = memory.held.clamp(x - play, x + play);
                memory.held
            }
            Self::Eccentric(counts) => {
                x + (counts * (x as f64 / COUNTS * std::f64::consts::TAU).sin()) as i64
            }
            Self::SecondFrozen if is_second => 0,
            Self::SecondOld if is_second => old(1),
            Self::SecondSame if is_second => memory.first,
            _ => x,
        };
        if !is_second {
            memory.first = says;
        }
        Some(with(reading, memory.start + says))
    }
}
