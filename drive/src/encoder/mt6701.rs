//! The encoder MT6701: 24-bit frames over SSI (data sheet, "SSI interface").
//!
//! | bit | content |
//! |---|---|
//! | 23–10 | angle, 16,384 counts a turn |
//! | 9 | track lost |
//! | 8 | push button: not examined |
//! | 7–6 | field: 0 right, 1 too strong, 2 too weak |
//! | 5–0 | CRC of bits 23–6, polynomial `x⁶ + x + 1`, starting at 0 |

use super::{EncoderError, Word};

const POLYNOMIAL: u32 = 0x43;
const TRACK_LOST: u32 = 1 << 9;
const FIELD: u32 = 3 << 6;

pub(super) fn decode(frame: u32) -> Result<Word, EncoderError> {
    // The whole frame, with its CRC, is divisible by the polynomial if it is right.
    if frame >> 24 != 0 || remainder(frame) != 0 {
        return Err(EncoderError::Check(frame));
    }
    if frame & (TRACK_LOST | FIELD) != 0 {
        return Err(EncoderError::Status(frame));
    }
    Ok(Word::new((frame >> 10) & 0x3FFF, 14))
}

/// Remainder of the frame's 24 bits divided by the CRC's polynomial; 0 for a right frame.
const fn remainder(frame: u32) -> u32 {
    let mut rest = frame;
    let mut bit = 23;
    while bit >= 6 {
        if rest & (1 << bit) != 0 {
            rest ^= POLYNOMIAL << (bit - 6);
        }
        bit -= 1;
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(angle: u32, status: u32) -> u32 {
        let data = (angle << 10) | (status << 6);
        // A second, independent calculation: the shift register that data sheets draw, bit by bit.
        let mut crc = 0_u32;
        for bit in (6..24).rev() {
            let feedback = ((crc >> 5) ^ (data >> bit)) & 1;
            crc = ((crc << 1) & 0x3F) ^ (feedback * 0x03);
        }
        data | crc
    }

    #[test]
    fn a_right_frame_and_every_one_or_two_flipped_bits() {
        for angle in [0, 1, 0x1234, 0x3FFF] {
            let right = frame(angle, 0);
            assert_eq!(decode(right).unwrap().value(), angle);
            for first in 0..24 {
                for second in 0..24 {
                    let wrong =
                        right ^ (1 << first) ^ if second == first { 0 } else { 1 << second };
                    assert_eq!(decode(wrong), Err(EncoderError::Check(wrong)));
                }
            }
        }
    }

    #[test]
    fn status_is_looked_at_and_the_button_is_not() {
        assert!(decode(frame(77, 0b0100)).is_ok());
        for status in [0b0001, 0b0010, 0b1000, 0b1100] {
            let frame = frame(77, status);
            assert_eq!(decode(frame), Err(EncoderError::Status(frame)));
        }
        assert_eq!(decode(0xFFFF_FFFF), Err(EncoderError::Check(0xFFFF_FFFF)));
        assert!(decode(0x00FF_FFFF).is_err());
    }
}
