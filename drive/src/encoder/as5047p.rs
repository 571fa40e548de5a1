//! The encoder AS5047P: 16-bit frames over SPI, each answered one frame later (data sheet, "SPI interface").
//!
//! | bit | answer |
//! |---|---|
//! | 15 | even parity over all bits |
//! | 14 | error flag: an earlier frame was wrong (framing, parity, command) |
//! | 13–0 | the requested data |
//!
//! The error flag concerns frames only. The register `DIAAGC`, which must be requested, reports whether there is a magnet. Without
//! that request, the angle of an encoder that has lost its magnet would look valid:
//!
//! | bit | `DIAAGC` |
//! |---|---|
//! | 11 | the field is too weak, and the gain at its largest |
//! | 10 | the field is too strong, and the gain at its smallest |
//! | 9 | the angle's calculation overflowed |
//! | 8 | the offsets are compensated: 0 while the encoder starts |
//! | 7–0 | the gain |

use super::{EncoderError, Word};

/// The frame that requests the register `ANGLECOM` (0x3FFF), the angle with the filter's delay compensated. Read bit and even
/// parity are set.
pub const READ_ANGLE: u16 = 0xFFFF;
/// The frame that requests the register `ERRFL` (0x0001) and so clears the error flag. The read bit is set, the parity even.
const READ_ERRORS: u16 = 0x4001;
/// The frame that requests the register `DIAAGC` (0x3FFC). The read bit is set, the parity even.
const READ_FIELD: u16 = 0xFFFC;

const ERROR: u16 = 1 << 14;
const DATA: u16 = 0x3FFF;
/// The bits of `DIAAGC` that report a field too weak, a field too strong, an overflow, and compensated offsets. In normal operation
/// their value is [`FIELD_IS_RIGHT`].
const FIELD: u16 = 0xF << 8;
const FIELD_IS_RIGHT: u16 = 1 << 8;

/// The encoder's answers to the two frames of a control period. An answer comes one frame late: the second frame requests the data
/// that the next period's first frame brings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frames {
    /// The answer to [`READ_ANGLE`].
    pub angle: u16,
    /// The answer to the previous control period's request of another register; `None` if it requested none.
    pub before: Option<Asked>,
}

impl Frames {
    /// The answers of a control period if the previous period requested no register besides the angle.
    #[must_use]
    pub const fn alone(angle: u16) -> Self {
        Self {
            angle,
            before: None,
        }
    }
}

/// The answer to the request at the end of the previous control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    /// The value of the register `DIAAGC`, which reports the magnet's field.
    Field(u16),
    /// The value of the register `ERRFL`. The value is not used: the register is read to clear the error flag.
    Errors(u16),
}

/// The register that a control period requests in addition to the angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Question {
    /// The register that reports whether the magnet's field is in order.
    Field,
    /// The register with the errors of earlier frames. Until it is read, the encoder sets the error flag in every answer.
    Errors,
}

impl Question {
    /// The register to request after the first answer of a control period: the errors if the answer has the error flag set.
    #[must_use]
    pub const fn after(answer: u16) -> Self {
        if answer & ERROR != 0 {
            Self::Errors
        } else {
            Self::Field
        }
    }

    /// The register that this frame requests; `None` for any other frame.
    #[must_use]
    pub const fn of(frame: u16) -> Option<Self> {
        match frame {
            READ_FIELD => Some(Self::Field),
            READ_ERRORS => Some(Self::Errors),
            _ => None,
        }
    }

    /// The frame that requests this register.
    #[must_use]
    pub const fn frame(self) -> u16 {
        match self {
            Self::Field => READ_FIELD,
            Self::Errors => READ_ERRORS,
        }
    }

    /// Joins an answer of the encoder with the register that was requested.
    #[must_use]
    pub const fn answered(self, answer: u16) -> Asked {
        match self {
            Self::Field => Asked::Field(answer),
            Self::Errors => Asked::Errors(answer),
        }
    }
}

pub(super) fn decode(frames: Frames) -> Result<Word, EncoderError> {
    let angle = whole(frames.angle)?;
    if let Some(Asked::Field(answer)) = frames.before
        && whole(answer)? & FIELD != FIELD_IS_RIGHT
    {
        return Err(EncoderError::Status(u32::from(answer)));
    }
    Ok(Word::new(u32::from(angle), 14))
}

/// The 14 data bits of a frame with right parity and without an error flag; else the error.
fn whole(frame: u16) -> Result<u16, EncoderError> {
    if !frame.count_ones().is_multiple_of(2) {
        return Err(EncoderError::Check(u32::from(frame)));
    }
    if frame & ERROR != 0 {
        return Err(EncoderError::Status(u32::from(frame)));
    }
    Ok(frame & DATA)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Makes a frame with this data and even parity, as the encoder answers.
    fn answer(data: u16) -> u16 {
        data | ((data.count_ones() & 1) as u16) << 15
    }

    #[test]
    fn a_right_frame_and_every_single_flipped_bit() {
        let field = answer(FIELD_IS_RIGHT | 0x7F);
        for angle in [0_u16, 1, 0x1234, 0x3FFF] {
            let right = Frames {
                angle: answer(angle),
                before: Some(Asked::Field(field)),
            };
            assert_eq!(decode(right).unwrap().value(), u32::from(angle));
            for bit in 0..16 {
                let flipped = right.angle ^ (1 << bit);
                let check = |word| Err(EncoderError::Check(u32::from(word)));
                assert_eq!(decode(Frames::alone(flipped)), check(flipped));
                let flipped = field ^ (1 << bit);
                let before = Some(Asked::Field(flipped));
                assert_eq!(decode(Frames { before, ..right }), check(flipped));
            }
        }
    }

    #[test]
    fn the_error_flag_and_a_line_that_floats_high() {
        assert_eq!(
            decode(Frames::alone(0xC000)),
            Err(EncoderError::Status(0xC000))
        );
        assert_eq!(
            decode(Frames::alone(0xFFFF)),
            Err(EncoderError::Status(0xFFFF))
        );
    }

    #[test]
    fn a_magnet_that_is_gone_too_near_or_not_yet_seen() {
        let with = |before| {
            decode(Frames {
                angle: answer(77),
                before,
            })
        };
        // Fields too weak and too strong, an overflow, and offsets that are not yet compensated.
        for field in [0x9FF, 0x500, 0x380, 0x080] {
            let word = answer(field);
            let status = Err(EncoderError::Status(u32::from(word)));
            assert_eq!(with(Some(Asked::Field(word))), status, "{field:x}");
            // The same bits in the register `ERRFL` do not concern the field.
            assert!(with(Some(Asked::Errors(word))).is_ok());
        }
        assert!(with(None).is_ok());
    }

    #[test]
    fn what_was_wrong_is_asked_for_once_the_flag_is_up_and_else_the_field() {
        assert_eq!(Question::after(answer(0x17F)), Question::Field);
        assert_eq!(Question::after(answer(0x4000)), Question::Errors);
    }

    #[test]
    fn commands_have_even_parity() {
        for command in [READ_ANGLE, READ_ERRORS, READ_FIELD] {
            assert_eq!(command.count_ones() & 1, 0);
            assert_ne!(command & (1 << 14), 0, "read bit");
        }
    }
}
