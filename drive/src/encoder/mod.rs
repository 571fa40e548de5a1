//! Converts an encoder's raw word to a count that continues over its wrap, and names the errors of a reading.

mod as5047p;
mod mt6701;

pub use touchstone_protocol::settings::EncoderKind;

use touchstone_protocol::Unwrap32;

pub use as5047p::READ_ANGLE as AS5047P_READ_ANGLE;
pub use as5047p::{Asked, Frames, Question};

/// The encoder's raw reading in a control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EncoderReading {
    /// The value of a 16-bit timer that counts the edges of an incremental encoder.
    Counter16(u16),
    /// The value of a 32-bit timer that counts the edges of an incremental encoder.
    Counter32(u32),
    /// The AS5047P's answers to [`AS5047P_READ_ANGLE`] and to the previous control period's request of another register.
    As5047p(Frames),
    /// The MT6701's 24 bits over SSI, with the first received bit in bit 23.
    Mt6701(u32),
    /// No reading came in time.
    Silent,
}

/// Why an encoder reading is not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EncoderError {
    /// No answer came, or the answer comes from another type of encoder than the settings name.
    Silent,
    /// The parity or checksum is wrong; holds the raw word.
    Check(u32),
    /// The encoder reports an error; holds the raw word.
    Status(u32),
}

/// A good reading. The counter's value is shifted to the upper end of 32 bits, so that it wraps where the encoder does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Word {
    aligned: u32,
    shift: u32,
}

impl Word {
    const fn new(value: u32, bits: u32) -> Self {
        let shift = 32 - bits;
        Self {
            aligned: value << shift,
            shift,
        }
    }

    /// The encoder's counter as an ordinary number, with its lowest bit at bit 0 again.
    #[must_use]
    pub const fn value(self) -> u32 {
        self.aligned >> self.shift
    }
}

impl EncoderReading {
    /// Checks and decodes the reading.
    ///
    /// # Errors
    /// The reading does not come from an encoder of this kind, fails its checksum, or reports an error.
    #[inline]
    pub fn decode(self, kind: EncoderKind) -> Result<Word, EncoderError> {
        match (kind, self) {
            (EncoderKind::Incremental, Self::Counter16(value)) => {
                Ok(Word::new(u32::from(value), 16))
            }
            (EncoderKind::Incremental, Self::Counter32(value)) => Ok(Word::new(value, 32)),
            (EncoderKind::As5047p, Self::As5047p(frames)) => as5047p::decode(frames),
            (EncoderKind::Mt6701, Self::Mt6701(frame)) => mt6701::decode(frame),
            _ => Err(EncoderError::Silent),
        }
    }
}

/// Continues the count of any encoder over its wrap. The counters are shifted to the upper end of 32 bits, so all wrap at 2^32, and
/// no bit is lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unwrapped {
    aligned: Unwrap32,
    shift: u32,
    reversed: bool,
}

impl Unwrapped {
    /// Starts at count 0 with the first reading.
    #[must_use]
    pub const fn new(word: Word, reversed: bool) -> Self {
        Self {
            aligned: Unwrap32::new(word.aligned, 0),
            shift: word.shift,
            reversed,
        }
    }

    /// Takes the next reading; returns the continued count. The count is right if the shaft moved by less than half the counter's
    /// range since the last reading.
    #[inline]
    pub fn update(&mut self, word: Word) -> i64 {
        let count = self.aligned.update(word.aligned) >> (self.shift & 31);
        if self.reversed {
            count.wrapping_neg()
        } else {
            count
        }
    }

    /// Counts from the encoder's own zero to the last reading, positive in the direction of counting. The value has no meaning
    /// for an encoder without a zero of its own, which counts from the position at which it was switched on.
    #[cfg(feature = "large")]
    #[must_use]
    pub fn from_own_zero(&self) -> i64 {
        let value = i64::from(self.aligned.reading() >> (self.shift & 31));
        if self.reversed {
            value.wrapping_neg()
        } else {
            value
        }
    }

    /// The continued count at the last reading.
    #[must_use]
    pub const fn count(&self) -> i64 {
        let count = self.aligned.count() >> (self.shift & 31);
        if self.reversed {
            count.wrapping_neg()
        } else {
            count
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_width_wraps_where_its_encoder_does() {
        let word = |value: u32, bits| Word::new(value, bits);
        for bits in [14, 16, 32] {
            let range = 1_u64 << bits;
            let mut unwrapped = Unwrapped::new(word((range - 3) as u32, bits), false);
            assert_eq!(unwrapped.update(word(4, bits)), 7);
            assert_eq!(unwrapped.update(word((range - 10) as u32, bits)), -7);
            let mut reversed = Unwrapped::new(word(0, bits), true);
            assert_eq!(reversed.update(word(5, bits)), -5);
            assert_eq!(reversed.count(), -5);
        }
    }

    #[test]
    fn the_answer_of_another_encoder_is_none() {
        for kind in [
            EncoderKind::Incremental,
            EncoderKind::As5047p,
            EncoderKind::Mt6701,
        ] {
            assert_eq!(
                EncoderReading::Silent.decode(kind),
                Err(EncoderError::Silent)
            );
        }
        assert_eq!(
            EncoderReading::Counter16(1).decode(EncoderKind::As5047p),
            Err(EncoderError::Silent)
        );
        assert_eq!(
            EncoderReading::Mt6701(0).decode(EncoderKind::Incremental),
            Err(EncoderError::Silent)
        );
        assert_eq!(
            EncoderReading::Counter16(9)
                .decode(EncoderKind::Incremental)
                .unwrap()
                .value(),
            9
        );
    }
}
