//! Generates bytes on the serial line between host and device: valid frames of both directions, damaged frames, and random bytes.
//! Checks that the decoder does not panic, and that every decoded message encodes to the same message.

use super::choices::Choices;
use touchstone_protocol::frame::{self, Decoder, FRAME_MAX};
use touchstone_protocol::reply::{FromDevice, version_of_hello};
use touchstone_protocol::settings::fields::FIELDS;
use touchstone_protocol::{
    Board, Counters, DeviceCommand, DeviceSettings, Reply, Request, ToDevice,
};

/// Makes a valid frame with a random message.
fn frame_of(seeded: &mut impl Choices) -> Vec<u8> {
    let mut buffer = [0; FRAME_MAX];
    let id = seeded.below(256) as u8;
    let request = |request| ToDevice { id, request };
    let field = &FIELDS[seeded.below(FIELDS.len())];
    let frame = match seeded.below(4) {
        0 => frame::encode(&request(Request::Get { path: field.path }), &mut buffer),
        1 => frame::encode(&request(Request::Command(DeviceCommand::Arm)), &mut buffer),
        2 => {
            let settings = DeviceSettings::defaults(Board::NucleoG474re);
            frame::encode(&request(Request::SetAll(settings)), &mut buffer)
        }
        _ => {
            let counters = Counters {
                ticks: seeded.below(65_536) as u32,
                ..Counters::default()
            };
            let answer = Ok(Reply::Counters(counters));
            frame::encode(&FromDevice::Answer { id, answer }, &mut buffer)
        }
    };
    frame.expect("every message fits").to_vec()
}

/// Makes several frames, some of them damaged.
pub fn made(seeded: &mut impl Choices) -> Vec<u8> {
    let mut bytes = Vec::new();
    for _ in 0..1 + seeded.below(3) {
        bytes.extend(frame_of(seeded));
    }
    for _ in 0..seeded.below(4) {
        let at = seeded.below(bytes.len());
        match seeded.below(4) {
            0 => bytes[at] ^= 1 << seeded.below(8),
            1 => bytes.insert(at, seeded.below(256) as u8),
            2 => bytes.truncate(at + 1),
            _ => bytes.extend_from_within(at..),
        }
    }
    bytes
}

/// Decodes bytes as host and device do; returns the number of messages. Asserts that each message stays the same when it is encoded
/// and decoded again.
pub fn messages(bytes: &[u8]) -> usize {
    let (mut decoder, mut count) = (Decoder::new(), 0);
    for &byte in bytes {
        if let Some(Ok(payload)) = decoder.push(byte) {
            count += usize::from(looked_into(payload));
        }
    }
    count
}

/// Whether a frame's payload is a message. Asserts that the message stays the same when it is encoded and decoded again.
pub fn looked_into(payload: &[u8]) -> bool {
    let mut buffer = [0; 4 * FRAME_MAX];
    let mut is_message = false;
    if let Some(message) = frame::message::<ToDevice<'_>>(payload) {
        let again = postcard::to_slice(&message, &mut buffer)
            .expect("room")
            .to_vec();
        assert_eq!(frame::message::<ToDevice<'_>>(&again), Some(message));
        is_message = true;
    }
    if let Some(message) = frame::message::<FromDevice>(payload) {
        let again = postcard::to_slice(&message, &mut buffer)
            .expect("room")
            .to_vec();
        assert_eq!(frame::message::<FromDevice>(&again), Some(message));
        is_message = true;
    }
    let _ = version_of_hello(payload);
    is_message
}
