//! Frames of the serial link: COBS-encoded, ended by a zero byte. A frame holds a message, encoded by the serialiser postcard, and
//! its CRC-32.
//!
//! COBS leaves no zero byte inside a frame. So after any noise the receiver finds the start of a frame behind the next zero byte.
//! The CRC is that of Ethernet and zip (ISO-HDLC), least significant byte first.

use crc::{CRC_32_ISO_HDLC, Crc};
use heapless::Vec;
use postcard::ser_flavors::crc::CrcModifier;
use postcard::ser_flavors::{Cobs, Slice};
use serde::{Deserialize, Serialize};

/// Longest payload of a frame in bytes. Tests check that all settings together fit, and with the feature `large` also an
/// environment.
pub const PAYLOAD_MAX: usize = if cfg!(feature = "large") { 640 } else { 512 };
/// Bytes of the CRC-32 in a frame.
const CRC_BYTES: usize = 4;
/// Longest COBS-encoded frame without its ending zero byte, in bytes. COBS adds one byte to a frame, and one more for every 254
/// bytes.
pub const ENCODED_MAX: usize = PAYLOAD_MAX + CRC_BYTES + 1 + (PAYLOAD_MAX + CRC_BYTES) / 254;
/// Longest frame with its ending zero byte, in bytes.
pub const FRAME_MAX: usize = ENCODED_MAX + 1;

/// The lookup table for the CRC-32, in flash, which encoder and decoder share.
static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// The CRC-32 of `bytes`.
#[must_use]
pub fn crc_of(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// Encodes a message into a frame with its ending zero byte. A buffer of [`FRAME_MAX`] bytes holds every message of this protocol.
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

/// Why a received frame cannot be decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum FrameError {
    /// The frame is longer than any frame of this protocol.
    TooLong,
    /// The frame is not valid COBS, or too short to hold a CRC.
    Malformed,
    /// The frame's CRC does not match its content.
    Damaged,
}

/// Collects received bytes and returns the payload of each complete frame.
#[derive(Debug, Clone)]
pub struct Decoder {
    buffer: Vec<u8, ENCODED_MAX>,
    /// Whether the buffer holds a finished frame, so that the next byte begins another one.
    over: bool,
    /// Whether the frame is longer than the buffer, so that the decoder ignores the rest of the frame.
    too_long: bool,
    errors: u32,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder that expects the beginning of a frame.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            buffer: Vec::new(),
            over: false,
            too_long: false,
            errors: 0,
        }
    }

    /// Number of frames that could not be decoded, plus the calls of [`Self::count_error`]. Saturates at `u32::MAX`.
    #[must_use]
    pub const fn errors(&self) -> u32 {
        self.errors
    }

    /// Counts a frame whose CRC was right but whose payload was no valid message.
    pub const fn count_error(&mut self) {
        self.errors = self.errors.saturating_add(1);
    }

    /// Adds one received byte. At the end of a frame returns its payload, or its error, which is also counted.
    pub fn push(&mut self, byte: u8) -> Option<Result<&[u8], FrameError>> {
        if core::mem::take(&mut self.over) {
            self.buffer.clear();
        }
        if byte != 0 {
            self.too_long |= self.buffer.push(byte).is_err();
            return None;
        }
        // A zero between frames has no meaning. A sender may begin with one to end noise that came before.
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

/// Decodes COBS and checks the CRC of a frame, in place. Returns the payload's length in bytes.
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

/// Decodes the message in a payload. `None` if the payload is not a valid message, or has bytes left after the message.
// A separate function, so that its stack is free again before the message is handled.
#[inline(never)]
#[must_use]
pub fn message<'p, T: Deserialize<'p>>(payload: &'p [u8]) -> Option<T> {
    match postcard::take_from_bytes(payload) {
        Ok((message, [])) => Some(message),
        _ => None,
    }
}
