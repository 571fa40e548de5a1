//! Reads a magnetic encoder at the SPI port SPI3. The code uses the registers itself and bounds every wait, because embassy-stm32's
//! driver waits without a time limit.

use core::sync::atomic::{AtomicU16, Ordering::Relaxed};

use embassy_stm32::pac::spi::vals::{Br, Cpha, Cpol, Ds, Frxth, Mstr};
use embassy_stm32::pac::{GPIOD, SPI3};
use embassy_stm32::{Peri, peripherals, rcc};
use touchstone_drive::encoder::{
    AS5047P_READ_ANGLE, Asked, EncoderKind, EncoderReading, Frames, Question,
};

use crate::cycles;

/// Pin number of the chip select, PD2.
const SELECT: usize = 2;
/// The AS5047P's shortest time between chip select and clock and between two frames: 350 ns, in processor cycles.
const SETTLE: u32 = 60;
/// Number of polls of a flag after which a reading is given up and the encoder counts as silent. A frame takes 512 processor
/// cycles, a poll at least 8.
const POLLS: u32 = 130;

/// Switches the clock of the SPI port on and resets the port.
pub fn start(_spi: Peri<'static, peripherals::SPI3>) {
    rcc::enable_and_reset::<peripherals::SPI3>();
}

/// Configures the port for an encoder: clock 5.3 MHz; data change on the rising clock edge and are read on the falling edge.
pub fn prepare(kind: EncoderKind) {
    let (size, threshold) = match kind {
        EncoderKind::Incremental => return,
        EncoderKind::As5047p => (Ds::BITS16, Frxth::HALF),
        // A frame of 24 bits is sent as three times eight bits.
        EncoderKind::Mt6701 => (Ds::BITS8, Frxth::QUARTER),
    };
    ASKED.store(0, Relaxed);
    SPI3.cr1().modify(|w| w.set_spe(false));
    SPI3.cr1().write(|w| {
        w.set_mstr(Mstr::MASTER);
        w.set_br(Br::DIV32);
        w.set_cpol(Cpol::IDLE_LOW);
        w.set_cpha(Cpha::SECOND_EDGE);
        w.set_ssm(true);
        w.set_ssi(true);
    });
    SPI3.cr2().write(|w| {
        w.set_ds(size);
        w.set_frxth(threshold);
    });
    SPI3.cr1().modify(|w| w.set_spe(true));
}

/// The frame with which the previous control period requested another register of the AS5047P besides the angle; 0 for none.
static ASKED: AtomicU16 = AtomicU16::new(0);

/// An encoder reading in progress, whose last frame is on the bus.
pub enum Last {
    /// AS5047P: the register that the last frame requests, and the answer to the previous control period's request.
    As5047p(Question, Option<Asked>),
    /// MT6701: the bytes received up to now.
    Mt6701(u32),
}

/// Sends the first frame of a reading. The transfer takes 512 processor cycles (256 for the MT6701), in which the caller can do
/// other work. `None`: no frame was sent.
#[inline]
pub fn begin(kind: EncoderKind) -> Option<()> {
    if kind == EncoderKind::Incremental {
        return None;
    }
    drain();
    select();
    match kind {
        EncoderKind::Incremental => None,
        EncoderKind::As5047p => send16(AS5047P_READ_ANGLE),
        EncoderKind::Mt6701 => send8(0),
    }
}

/// Waits for the first frame and sends the last one. `None`: the encoder is silent, or has no SPI.
///
/// The AS5047P answers each frame in the next one. The first frame requests the angle, and its answer is that to the previous
/// control period's request. The second frame's answer is the present angle. It requests another register: the magnet's field, or
/// the errors of earlier frames.
#[inline]
pub fn go_on(kind: EncoderKind) -> Option<Last> {
    match kind {
        EncoderKind::Incremental => None,
        EncoderKind::As5047p => {
            let asked = Question::of(ASKED.swap(0, Relaxed));
            let first = receive16()?;
            settle(deselect());
            select();
            let question = Question::after(first);
            send16(question.frame())?;
            Some(Last::As5047p(
                question,
                asked.map(|asked| asked.answered(first)),
            ))
        }
        EncoderKind::Mt6701 => {
            let first = receive8()?;
            send8(0)?;
            let second = receive8()?;
            send8(0)?;
            Some(Last::Mt6701(u32::from(first) << 8 | u32::from(second)))
        }
    }
}

/// Waits for the last frame and returns the encoder's reading; `Silent` if the frame does not end.
#[inline]
pub fn end(last: Option<Last>) -> EncoderReading {
    let reading = last.and_then(|last| {
        Some(match last {
            Last::As5047p(question, before) => {
                let angle = receive16()?;
                ASKED.store(question.frame(), Relaxed);
                EncoderReading::As5047p(Frames { angle, before })
            }
            Last::Mt6701(bytes) => EncoderReading::Mt6701(bytes << 8 | u32::from(receive8()?)),
        })
    });
    deselect();
    reading.unwrap_or(EncoderReading::Silent)
}

fn select() {
    GPIOD.bsrr().write(|w| w.set_br(SELECT, true));
    settle(cycles::now());
}

/// Sets chip select inactive, which ends a frame. Returns the cycle counter's value. Chip select must stay inactive for [`SETTLE`]
/// cycles before the next frame; the time between two readings is always longer.
fn deselect() -> u32 {
    GPIOD.bsrr().write(|w| w.set_bs(SELECT, true));
    cycles::now()
}

/// Waits until [`SETTLE`] cycles have passed since the cycle counter had the value `since`. A loop of 60 passes without the cycle
/// counter would take five times as long. The number of polls is bounded, because a debugger can stop the cycle counter.
fn settle(since: u32) {
    let _ = (0..SETTLE).any(|_| cycles::now().wrapping_sub(since) >= SETTLE);
}

/// Empties the receive queue: an abandoned frame may have left up to four bytes.
fn drain() {
    for _ in 0..4 {
        if !SPI3.sr().read().rxne() {
            return;
        }
        let _ = SPI3.dr8().read();
    }
}

fn wait(is_there: impl Fn() -> bool) -> Option<()> {
    (0..POLLS).any(|_| is_there()).then_some(())
}

fn send16(word: u16) -> Option<()> {
    wait(|| SPI3.sr().read().txe())?;
    SPI3.dr16().write_value(word);
    Some(())
}

fn receive16() -> Option<u16> {
    wait(|| SPI3.sr().read().rxne())?;
    Some(SPI3.dr16().read())
}

fn send8(byte: u8) -> Option<()> {
    wait(|| SPI3.sr().read().txe())?;
    SPI3.dr8().write_value(byte);
    Some(())
}

fn receive8() -> Option<u8> {
    wait(|| SPI3.sr().read().rxne())?;
    Some(SPI3.dr8().read())
}
