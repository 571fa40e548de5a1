//! Fault injections that differ between the encoders: MT6701 and incremental encoder.

use super::Expect::Off;
use super::When::{Calibrating, Free, Pressed};
use super::{Injection, OFF_AT_FIRST_BAD, TICK, row};
use crate::fil::fault::Fault;
use crate::peripheral::spi::SlaveFault;
use touchstone_protocol::FaultCode::*;

/// Injections with an MT6701 on the SPI bus.
pub const WITH_MT6701: &[Injection] = &[
    row(
        "encoder's check sum, bit 0",
        Free,
        12,
        Fault::Encoder(SlaveFault::FlipBit(0)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    ),
    row(
        "encoder's check sum, bit 15",
        Pressed,
        345,
        Fault::Encoder(SlaveFault::FlipBit(15)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    ),
    row(
        "encoder's check sum, bit 23",
        Calibrating,
        678,
        Fault::Encoder(SlaveFault::FlipBit(23)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    ),
    row(
        "encoder's line high",
        Free,
        910,
        Fault::Encoder(SlaveFault::High),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck, EncoderStatus]),
    ),
    row(
        "encoder loses its track",
        Pressed,
        150,
        Fault::Encoder(SlaveFault::SaysError),
        Off(OFF_AT_FIRST_BAD, &[EncoderStatus]),
    ),
    row(
        "magnet gone",
        Free,
        222,
        Fault::Encoder(SlaveFault::NoMagnet),
        Off(OFF_AT_FIRST_BAD, &[EncoderStatus]),
    ),
    row(
        "magnet too near",
        Pressed,
        707,
        Fault::Encoder(SlaveFault::MagnetTooNear),
        Off(OFF_AT_FIRST_BAD, &[EncoderStatus]),
    ),
    row(
        "encoder's bus hangs",
        Free,
        520,
        Fault::BusHangs,
        Off(OFF_AT_FIRST_BAD, &[EncoderSilent]),
    ),
    row(
        "encoder jumps a quarter turn",
        Pressed,
        33,
        Fault::Encoder(SlaveFault::Jump(0x4000)),
        Off(TICK, &[EncoderJump]),
    ),
];

/// Injections with an incremental encoder, whose edges a timer counts.
pub const WITH_TRACKS: &[Injection] = &[
    row(
        "encoder held",
        Calibrating,
        200,
        Fault::TrackHeld,
        Off(8_000_000, &[EncoderStuck]),
    ),
    row(
        "encoder jumps a quarter turn",
        Pressed,
        460,
        Fault::TrackJumps(4_096),
        Off(TICK, &[EncoderJump]),
    ),
    row(
        "encoder jumps back by 700",
        Free,
        860,
        Fault::TrackJumps(-700),
        Off(TICK, &[EncoderJump, OverSpeed]),
    ),
];
