//! Fault injections into the encoder AS5047P on the SPI bus.

use super::Expect::{GoesOn, Off, OffAtLast};
use super::When::{Calibrating, Free, Pressed, Ready};
use super::{FAST_SHAFT, Injection, OFF_AT_BAD_FIELD, OFF_AT_FIRST_BAD, OFF_AT_SHARE, TICK, row};
use crate::fil::fault::Fault;
use crate::peripheral::spi::SlaveFault;
use touchstone_protocol::FaultCode::*;

/// Injections into the encoder AS5047P, on a NUCLEO-G474RE.
pub const WITH_AS5047P: &[Injection] = &[
    // An answer of all zeros has the right parity. As an answer about the field it confirms no valid magnet; as an angle it is far
    // from the last one. The fault code depends on which of the two frames meets the fault first. So the fault begins at a control
    // tick and not at a fixed time, because programs read the encoder at different times in the tick.
    row(
        "encoder's line low",
        Pressed,
        15,
        Fault::EncoderAtTick(SlaveFault::Low),
        Off(TICK, &[EncoderStatus]),
    ),
    row(
        "encoder's line low between two frames",
        Pressed,
        15,
        Fault::EncoderAtTick(SlaveFault::LowFromAngle),
        Off(TICK, &[EncoderJump]),
    ),
    row(
        "encoder's line high",
        Pressed,
        350,
        Fault::Encoder(SlaveFault::High),
        Off(OFF_AT_FIRST_BAD, &[EncoderStatus]),
    ),
    row(
        "encoder's line high",
        Calibrating,
        888,
        Fault::Encoder(SlaveFault::High),
        Off(OFF_AT_FIRST_BAD, &[EncoderStatus]),
    ),
    row(
        "encoder's parity, bit 0",
        Free,
        21,
        Fault::Encoder(SlaveFault::FlipBit(0)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    ),
    row(
        "encoder's parity, bit 13",
        Pressed,
        512,
        Fault::Encoder(SlaveFault::FlipBit(13)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    ),
    row(
        "encoder's parity in every seventh frame",
        Pressed,
        310,
        Fault::Encoder(SlaveFault::FlipSeventh),
        OffAtLast(OFF_AT_SHARE, &[EncoderUnsteady]),
    ),
    row(
        "encoder's parity, bit 15",
        Calibrating,
        77,
        Fault::Encoder(SlaveFault::FlipBit(15)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    ),
    row(
        "encoder says it has an error",
        Free,
        640,
        Fault::Encoder(SlaveFault::SaysError),
        Off(OFF_AT_FIRST_BAD, &[EncoderStatus]),
    ),
    row(
        "magnet gone",
        Pressed,
        222,
        Fault::Encoder(SlaveFault::NoMagnet),
        Off(OFF_AT_BAD_FIELD, &[EncoderStatus]),
    ),
    row(
        "magnet gone",
        Calibrating,
        707,
        Fault::Encoder(SlaveFault::NoMagnet),
        Off(OFF_AT_BAD_FIELD, &[EncoderStatus]),
    ),
    row(
        "magnet too near",
        Free,
        431,
        Fault::Encoder(SlaveFault::MagnetTooNear),
        Off(OFF_AT_BAD_FIELD, &[EncoderStatus]),
    ),
    row(
        "one frame to the encoder damaged",
        Free,
        275,
        Fault::Encoder(SlaveFault::CommandDamaged),
        GoesOn,
    ),
    row(
        "encoder's bus hangs",
        Pressed,
        999,
        Fault::BusHangs,
        Off(OFF_AT_FIRST_BAD, &[EncoderSilent]),
    ),
    row(
        "encoder's bus hangs",
        Calibrating,
        1,
        Fault::BusHangs,
        Off(OFF_AT_FIRST_BAD, &[EncoderSilent]),
    ),
    row(
        "encoder jumps a quarter turn",
        Pressed,
        480,
        Fault::Encoder(SlaveFault::Jump(0x4000)),
        Off(TICK, &[EncoderJump]),
    ),
    row(
        "encoder jumps half a turn",
        Free,
        20,
        Fault::Encoder(SlaveFault::Jump(0x8000)),
        Off(TICK, &[EncoderJump]),
    ),
    row(
        "encoder jumps 14 degrees",
        Ready,
        130,
        Fault::Encoder(SlaveFault::Jump(0x0a00)),
        Off(TICK, &[EncoderJump, OverSpeed]),
    ),
    row(
        "encoder stuck",
        Calibrating,
        240,
        Fault::Encoder(SlaveFault::Stuck),
        Off(8_000_000, &[EncoderStuck]),
    ),
    row(
        "shaft turned at -150 rad/s",
        Pressed,
        880,
        Fault::Turned(-150.0),
        Off(FAST_SHAFT, &[OverSpeed]),
    ),
    row(
        "shaft turned at +150 rad/s",
        Ready,
        810,
        Fault::Turned(150.0),
        Off(FAST_SHAFT, &[OverSpeed]),
    ),
    row(
        "shaft held fast",
        Calibrating,
        300,
        Fault::Turned(0.0),
        Off(8_000_000, &[EncoderStuck]),
    ),
];
