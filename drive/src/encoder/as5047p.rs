//! AS5047P: a frame of 16 bits, answered one frame later (data sheet, "SPI interface").
//!
//! | bit | answer |
//! |---|---|
//! | 15 | even parity over all bits |
//! | 14 | error flag: a frame before was wrong (framing, parity, command) |
//! | 13–0 | angle, 16,384 counts a turn |

use super::{EncoderError, Word};

/// The frame that asks for `ANGLECOM` (0x3FFF), the angle compensated for the filter's delay: read bit and even parity set.
pub const READ_ANGLE: u16 = 0xFFFF;
/// The frame that asks for `ERRFL` (0x0001), which clears the error flag: read bit set, parity even.
pub const READ_ERRORS: u16 = 0x4001;

const ERROR: u16 = 1 << 14;
const ANGLE: u16 = 0x3FFF;

pub(super) fn decode(frame: u16) -> Result<Word, EncoderError> {
    if !frame.count_ones().is_multiple_of(2) {
        return Err(EncoderError::Check(u32::from(frame)));
    }
    if frame & ERROR != 0 {
        return Err(EncoderError::Status(u32::from(frame)));
    }
    Ok(Word::new(u32::from(frame & ANGLE), 14))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_right_frame_and_every_single_flipped_bit() {
        for angle in [0_u16, 1, 0x1234, 0x3FFF] {
            let parity = ((angle.count_ones() & 1) as u16) << 15;
            let frame = angle | parity;
            assert_eq!(decode(frame).unwrap().value(), u32::from(angle));
            for bit in 0..16 {
                let flipped = frame ^ (1 << bit);
                assert_eq!(
                    decode(flipped),
                    Err(EncoderError::Check(u32::from(flipped)))
                );
            }
        }
    }

    #[test]
    fn the_error_flag_and_a_line_that_floats_high() {
        assert_eq!(decode(0xC000), Err(EncoderError::Status(0xC000)));
        assert_eq!(decode(0xFFFF), Err(EncoderError::Status(0xFFFF)));
    }

    #[test]
    fn commands_have_even_parity() {
        for command in [READ_ANGLE, READ_ERRORS] {
            assert_eq!(command.count_ones() & 1, 0);
            assert_ne!(command & (1 << 14), 0, "read bit");
        }
    }
}
