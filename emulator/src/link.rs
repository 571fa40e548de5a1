//! The computer's end of the serial port: frames, requests, answers and telemetry. It uses the same protocol crate as the firmware.

use touchstone_protocol::frame::{Decoder, FRAME_MAX, encode, message};
use touchstone_protocol::{FromDevice, Refusal, Reply, Request, Telemetry, ToDevice};

/// The computer's end of the serial link.
#[derive(Debug, Default)]
pub struct Link {
    decoder: Decoder,
    next_id: u8,
    answers: Vec<(u8, Result<Reply, Refusal>)>,
    /// Telemetry records received so far.
    pub telemetry: Vec<Telemetry>,
    /// Number of decoded frames whose content was not a valid message.
    pub not_understood: u64,
    /// Number of bytes received so far.
    pub bytes: u64,
}

impl Link {
    /// Decodes bytes from the device: stores answers and telemetry records.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.bytes += bytes.len() as u64;
        for byte in bytes {
            let Some(Ok(payload)) = self.decoder.push(*byte) else {
                continue;
            };
            match message::<FromDevice>(payload) {
                Some(FromDevice::Answer { id, answer }) => self.answers.push((id, answer)),
                Some(FromDevice::Telemetry(record)) => self.telemetry.push(record),
                None => self.not_understood += 1,
            }
        }
    }

    /// Encodes a request as a frame; returns the number that its answer will carry, and the frame.
    ///
    /// # Panics
    /// Never: every request of the protocol fits into a frame.
    pub fn ask(&mut self, request: Request<'_>) -> (u8, Vec<u8>) {
        self.next_id = self.next_id.wrapping_add(1);
        let id = self.next_id;
        let mut buffer = [0; FRAME_MAX];
        let frame = encode(&ToDevice { id, request }, &mut buffer).expect("every request fits");
        (id, frame.to_vec())
    }

    /// The answer to the request of this number; `None` before it has arrived.
    pub fn answer(&mut self, id: u8) -> Option<Result<Reply, Refusal>> {
        let at = self.answers.iter().position(|(other, _)| *other == id)?;
        Some(self.answers.swap_remove(at).1)
    }

    /// Number of frames from the device that could not be decoded.
    #[must_use]
    pub fn errors(&self) -> u32 {
        self.decoder.errors()
    }

    /// Number of telemetry records that are missing between the record at index `from` and the last one.
    #[must_use]
    pub fn gaps(&self, from: usize) -> u32 {
        let records = self.telemetry.get(from..).unwrap_or_default();
        let pairs = records.windows(2);
        pairs
            .map(|pair| pair[1].tick.wrapping_sub(pair[0].tick).saturating_sub(1))
            .sum()
    }
}
