//! Tests the frame decoder with any bytes: errors are counted, no message is invented, and the next complete frame is decoded.

use touchstone_protocol::frame::{self, Decoder, FRAME_MAX, FrameError};
use touchstone_protocol::reply::{FromDevice, version_of_hello};
use touchstone_protocol::settings::fields::FIELDS;
use touchstone_protocol::{
    Board, Counters, Decimal, DeviceCommand, DeviceSettings, MeasuringPart, MeasuringTick, Phase,
    Reply, Request, Telemetry, ToDevice,
};
use touchstone_tests::random::Random;

const FRAMES: usize = 1_000_000;

/// Decodes bytes; returns the payloads of the frames, and the number of errors.
fn take(decoder: &mut Decoder, bytes: &[u8]) -> (Vec<Vec<u8>>, u32) {
    let (mut payloads, mut errors) = (Vec::new(), 0);
    for &byte in bytes {
        match decoder.push(byte) {
            Some(Ok(payload)) => payloads.push(payload.to_vec()),
            Some(Err(_)) => errors += 1,
            None => {}
        }
    }
    (payloads, errors)
}

/// A random telemetry record with numbers of all sizes.
fn telemetry(random: &mut Random) -> Telemetry {
    let mut word = || {
        let bits = random.bits();
        (bits as u32) >> ((bits >> 32) % 32)
    };
    Telemetry {
        tick: word(),
        count: word().cast_signed(),
        penetration_rad: fixed::types::I8F24::from_bits(word().cast_signed()),
        since_change_rad: fixed::types::I8F24::from_bits(word().cast_signed()),
        force_n_m: fixed::types::I8F24::from_bits(word().cast_signed()),
        offset_rad: fixed::types::I8F24::from_bits(word().cast_signed()),
        energy_j: Decimal::from_num(word()),
        phase: Phase::Armed,
        fault: 0,
        limits: word() as u8,
        cycles: word(),
        lateness_cycles: word(),
        current_q_ma: word().cast_signed(),
        measuring: None,
    }
}

/// A complete frame with a random message.
fn any_frame(random: &mut Random) -> Vec<u8> {
    let mut buffer = [0; FRAME_MAX];
    let id = random.bits() as u8;
    let request = |request| ToDevice { id, request };
    let field = &FIELDS[(random.bits() % FIELDS.len() as u64) as usize];
    let frame = match random.bits() % 6 {
        0 => frame::encode(&request(Request::Get { path: field.path }), &mut buffer),
        1 => frame::encode(&request(Request::Command(DeviceCommand::Arm)), &mut buffer),
        2 => {
            let settings = DeviceSettings::defaults(Board::NucleoG474re);
            frame::encode(&request(Request::SetAll(settings)), &mut buffer)
        }
        3 => {
            let counters = Counters {
                ticks: random.bits() as u32,
                ..Counters::default()
            };
            let answer = Ok(Reply::Counters(counters));
            frame::encode(&FromDevice::Answer { id, answer }, &mut buffer)
        }
        _ => frame::encode(&FromDevice::Telemetry(telemetry(random)), &mut buffer),
    };
    frame.expect("every message fits").to_vec()
}

/// Decodes a payload as a message of either direction. Asserts that nothing panics, and that a decoded message stays the same when
/// it is encoded and decoded again.
fn look_into(payload: &[u8]) {
    let mut buffer = [0; 4 * FRAME_MAX];
    if let Some(message) = frame::message::<ToDevice<'_>>(payload) {
        let again = postcard::to_slice(&message, &mut buffer)
            .expect("room")
            .to_vec();
        assert_eq!(frame::message::<ToDevice<'_>>(&again), Some(message));
    }
    if let Some(message) = frame::message::<FromDevice>(payload) {
        let again = postcard::to_slice(&message, &mut buffer)
            .expect("room")
            .to_vec();
        assert_eq!(frame::message::<FromDevice>(&again), Some(message));
    }
    let _ = version_of_hello(payload);
}

#[test]
fn garbage_is_nothing_but_counted_errors() {
    let mut random = Random::new(1);
    let mut decoder = Decoder::new();
    let mut ended = 0;
    let mut length = 0_usize;
    while ended < FRAMES {
        let mut word = random.bits();
        // One frame in 64 is longer than any buffer.
        let zero_in = if random.bits().is_multiple_of(64) {
            4096
        } else {
            48
        };
        for _ in 0..8 {
            let byte = if random.bits().is_multiple_of(zero_in) {
                0
            } else {
                word as u8
            };
            word >>= 8;
            let whole = byte == 0 && length > 0;
            length = if byte == 0 { 0 } else { length + 1 };
            match decoder.push(byte) {
                None => assert!(!whole),
                Some(Err(FrameError::TooLong)) => assert!(whole),
                Some(Err(_)) => assert!(whole),
                Some(Ok(payload)) => panic!("noise became the payload {payload:?}"),
            }
            ended += usize::from(whole);
        }
    }
    assert_eq!(decoder.errors() as usize, ended);
}

#[test]
fn a_frame_with_flipped_bits_is_never_taken_for_another() {
    let mut random = Random::new(2);
    let mut decoder = Decoder::new();
    let mut counted = 0;
    for _ in 0..FRAMES {
        let whole = any_frame(&mut random);
        let mut damaged = whole.clone();
        for _ in 0..=random.bits() % 8 {
            let bit = (random.bits() % (8 * damaged.len() as u64)) as usize;
            damaged[bit / 8] ^= 1 << (bit % 8);
        }
        if damaged == whole {
            continue;
        }
        // The frame's end may be lost, so one more zero is sent; or it may have come earlier.
        damaged.push(0);
        let before = decoder.errors();
        let (payloads, errors) = take(&mut decoder, &damaged);
        counted += errors;
        assert_eq!(decoder.errors(), before + errors);
        assert!(payloads.is_empty(), "{damaged:?} was taken");
        assert!(errors > 0, "{damaged:?} vanished");
    }
    assert_eq!(decoder.errors(), counted);
}

#[test]
fn a_payload_of_garbage_is_no_trap() {
    let mut random = Random::new(3);
    let mut understood = 0;
    for _ in 0..FRAMES {
        let length = (random.bits() % 64) as usize;
        let mut payload: Vec<u8> = (0..length).map(|_| random.bits() as u8).collect();
        // The first bytes choose the message; small numbers select more of them.
        for byte in payload.iter_mut().take(4) {
            *byte %= 16;
        }
        understood += u32::from(frame::message::<ToDevice<'_>>(&payload).is_some());
        look_into(&payload);
    }
    assert!(understood > 1000, "only {understood} reached the inside");
}

#[test]
fn a_payload_with_flipped_bits_is_no_trap() {
    let mut random = Random::new(4);
    let mut decoder = Decoder::new();
    for _ in 0..FRAMES / 4 {
        let frame = any_frame(&mut random);
        let (mut payloads, errors) = take(&mut decoder, &frame);
        let mut payload = payloads.pop().expect("a whole frame");
        assert_eq!(errors, 0);
        look_into(&payload);
        let bit = (random.bits() % (8 * payload.len() as u64)) as usize;
        payload[bit / 8] ^= 1 << (bit % 8);
        look_into(&payload);
        payload.truncate((random.bits() % (payload.len() as u64 + 1)) as usize);
        look_into(&payload);
    }
}

#[test]
fn after_garbage_the_next_whole_frame_is_understood() {
    let mut random = Random::new(5);
    let mut decoder = Decoder::new();
    for _ in 0..FRAMES / 10 {
        let length = random.bits() % 1500;
        let noise: Vec<u8> = (0..length).map(|_| random.bits() as u8).collect();
        assert!(take(&mut decoder, &noise).0.is_empty());
        // A sender that starts again sends a zero first.
        assert!(take(&mut decoder, &[0]).0.is_empty());
        let record = telemetry(&mut random);
        let mut buffer = [0; FRAME_MAX];
        let frame = frame::encode(&FromDevice::Telemetry(record), &mut buffer).expect("room");
        let (payloads, errors) = take(&mut decoder, frame);
        assert_eq!((payloads.len(), errors), (1, 0));
        assert_eq!(
            frame::message(&payloads[0]),
            Some(FromDevice::Telemetry(record))
        );
    }
}

#[test]
fn the_longest_messages_fit_into_a_frame() {
    use touchstone_protocol::{
        RingChunk, RingRecord, frame::PAYLOAD_MAX, telemetry::TELEMETRY_MAX,
    };
    let mut buffer = [0; 2 * FRAME_MAX];
    let size = |message: &dyn Fn(&mut [u8]) -> usize, buffer: &mut [u8]| message(buffer);

    let full = Telemetry {
        tick: u32::MAX,
        count: i32::MIN,
        penetration_rad: fixed::types::I8F24::MIN,
        since_change_rad: fixed::types::I8F24::MIN,
        force_n_m: fixed::types::I8F24::MIN,
        offset_rad: fixed::types::I8F24::MIN,
        energy_j: Decimal(touchstone_control::Si::MIN),
        phase: Phase::Stopped,
        fault: u8::MAX,
        limits: u8::MAX,
        cycles: u32::MAX,
        lateness_cycles: u32::MAX,
        current_q_ma: i32::MIN,
        measuring: Some(MeasuringTick {
            part: MeasuringPart::Coast,
            current_d_ma: i32::MIN,
            voltage_d_mv: i32::MIN,
            voltage_q_mv: i32::MIN,
        }),
    };
    let longest = size(
        &|b| postcard::to_slice(&full, b).expect("room").len(),
        &mut buffer,
    );
    assert_eq!(longest, TELEMETRY_MAX);

    // Every number of the settings with its longest encoding, whatever it means.
    let mut settings = DeviceSettings::defaults(Board::NucleoG474re);
    for field in FIELDS {
        let min = [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01];
        let word = [0xff, 0xff, 0xff, 0xff, 0x0f];
        let _ = settings
            .set(field.path, &min)
            .or_else(|_| settings.set(field.path, &word))
            .or_else(|_| settings.set(field.path, &[0xff, 0xff, 0x03]))
            .or_else(|_| settings.set(field.path, &[0xff]));
    }
    let request = ToDevice {
        id: 255,
        request: Request::SetAll(settings.clone()),
    };
    let longest = size(
        &|b| postcard::to_slice(&request, b).expect("room").len(),
        &mut buffer,
    );
    assert!((300..=PAYLOAD_MAX).contains(&longest), "{longest}");
    assert!(frame::encode(&request, &mut [0; FRAME_MAX]).is_ok());

    let record = RingRecord {
        tick: u16::MAX,
        count: i32::MIN,
        force: i16::MIN,
        current_q: i16::MIN,
        lateness_64: u8::MAX,
        limits: u8::MAX,
        phase: u8::MAX,
    };
    let records =
        core::iter::repeat_n(record, touchstone_protocol::telemetry::RING_CHUNK).collect();
    let chunk = RingChunk {
        first: u16::MAX,
        total: u16::MAX,
        records,
    };
    let answer = FromDevice::Answer {
        id: 255,
        answer: Ok(Reply::Ring(chunk)),
    };
    let longest = size(
        &|b| postcard::to_slice(&answer, b).expect("room").len(),
        &mut buffer,
    );
    assert!((300..=PAYLOAD_MAX).contains(&longest), "{longest}");
}

#[test]
fn the_version_is_read_from_a_hello_that_nothing_else_is_known_of() {
    let payload = [0, 77, 0, 0, 0xac, 0x02, 9, 9, 9, 255];
    assert_eq!(version_of_hello(&payload), Some(300));
    assert_eq!(version_of_hello(&[1, 77, 0, 0, 1]), None);
    assert_eq!(version_of_hello(&[0, 77, 1, 0, 1]), None);
    assert_eq!(version_of_hello(&[0, 77, 0, 0]), None);
}
