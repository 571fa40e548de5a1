//! Frames: COBS, ended by a zero byte; inside a postcard value and its CRC-32.
//!
//! COBS leaves no zero in a frame, so that after whatever noise the next zero begins a new one. The CRC is that of Ethernet and
//! zip (ISO-HDLC), least significant byte first.

use crc::{CRC_32_ISO_HDLC, Crc};
use heapless::Vec;
use postcard::ser_flavors::crc::CrcModifier;
use postcard::ser_flavors::{Cobs, Slice};
use serde::{Deserialize, Serialize};

/// Longest payload, bytes: the whole of the settings fits (a test).
pub const PAYLOAD_MAX: usize = 512;
/// Bytes of the CRC.
const CRC_BYTES: usize = 4;
/// Longest frame without its zero, bytes: COBS adds one byte, and one for every 254.
pub const ENCODED_MAX: usize = PAYLOAD_MAX + CRC_BYTES + 1 + (PAYLOAD_MAX + CRC_BYTES) / 254;
/// Longest frame with its zero, bytes.
pub const FRAME_MAX: usize = ENCODED_MAX + 1;

/// The CRC's table, shared by encoder and decoder, in flash.
static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// The CRC-32 of bytes.
#[must_use]
pub fn crc_of(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// Encodes a message into a frame with its zero; [`FRAME_MAX`] bytes are always enough for this protocol's messages.
///
/// # Errors
/// The buffer is too small.
pub fn encode<'b>(message: &impl Serialize, buffer: &'b mut [u8]) -> Result<&'b [u8], NoRoom> {
    let cobs = Cobs::try_new(Slice::new(buffer)).map_err(|_| NoRoom)?;
    postcard::serialize_with_flavor(message, CrcModifier::new(cobs, CRC.digest()))
        .map(|frame| &*frame)
        .map_err(|_| NoRoom)
}

/// The buffer is too small for the frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoRoom;

/// The errors of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameError {
    /// Longer than any frame of this protocol.
    TooLong,
    /// No COBS, or too short for a CRC.
    Malformed,
    /// The CRC does not match.
    Damaged,
}

/// Takes bytes as they come and gives the payloads of whole frames.
#[derive(Debug, Clone)]
pub struct Decoder {
    buffer: Vec<u8, ENCODED_MAX>,
    /// The frame in the buffer is over: the next byte begins another.
    over: bool,
    /// The frame is longer than the buffer: it is ignored up to its end.
    too_long: bool,
    errors: u32,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder at the beginning of a frame.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            buffer: Vec::new(),
            over: false,
            too_long: false,
            errors: 0,
        }
    }

    /// Frames that could not be decoded, and those of [`Self::count_error`]. Stays at its largest value.
    #[must_use]
    pub const fn errors(&self) -> u32 {
        self.errors
    }

    /// Counts a frame that was whole but whose payload was no message.
    pub const fn count_error(&mut self) {
        self.errors = self.errors.saturating_add(1);
    }

    /// Takes one byte. At the end of a frame it returns the payload, or the frame's error, which is also counted.
    pub fn push(&mut self, byte: u8) -> Option<Result<&[u8], FrameError>> {
        if core::mem::take(&mut self.over) {
            self.buffer.clear();
        }
        if byte != 0 {
            self.too_long |= self.buffer.push(byte).is_err();
            return None;
        }
        // Zeros between frames mean nothing: a sender may begin with one to end whatever noise was before.
        if self.buffer.is_empty() {
            return None;
        }
        self.over = true;
        let length = if core::mem::take(&mut self.too_long) {
            Err(FrameError::TooLong)
        } else {
            payload_length(&mut self.buffer)
        };
        if length.is_err() {
            self.count_error();
        }
        Some(length.and_then(|length| self.buffer.get(..length).ok_or(FrameError::Malformed)))
    }
}

/// Takes COBS and CRC off a frame, in place.
fn payload_length(frame: &mut [u8]) -> Result<usize, FrameError> {
    let decoded = cobs::decode_in_place(frame).map_err(|_| FrameError::Malformed)?;
    let frame = frame.get(..decoded).ok_or(FrameError::Malformed)?;
    let (payload, sum) = frame
        .split_last_chunk::<CRC_BYTES>()
        .ok_or(FrameError::Malformed)?;
    if crc_of(payload).to_le_bytes() != *sum {
        return Err(FrameError::Damaged);
    }
    Ok(payload.len())
}

/// The message in a payload; `None` if it cannot be decoded, or bytes follow it.
// A function of its own: what it builds on its stack is gone before the message is worked on.
#[inline(never)]
#[must_use]
pub fn message<'p, T: Deserialize<'p>>(payload: &'p [u8]) -> Option<T> {
    match postcard::take_from_bytes(payload) {
        Ok((message, [])) => Some(message),
        _ => None,
    }
}
