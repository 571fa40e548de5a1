//! A magnetic encoder at SPI3, through its registers and with every wait bounded: the driver of embassy-stm32 waits for ever.

use core::sync::atomic::{AtomicU16, Ordering::Relaxed};

use embassy_stm32::pac::spi::vals::{Br, Cpha, Cpol, Ds, Frxth, Mstr};
use embassy_stm32::pac::{GPIOD, SPI3};
use embassy_stm32::{Peri, peripherals, rcc};
use touchstone_drive::encoder::{
    AS5047P_READ_ANGLE, Asked, EncoderKind, EncoderReading, Frames, Question,
};

use crate::cycles;

/// The chip select, PD2.
const SELECT: usize = 2;
/// 350 ns, the AS5047P's time between select and clock, and between two frames; cycles.
const SETTLE: u32 = 60;
/// Polls of a flag before the encoder counts as silent: a frame takes 512 cycles, a poll at least 8.
const POLLS: u32 = 130;

/// Takes the port into use.
pub fn start(_spi: Peri<'static, peripherals::SPI3>) {
    rcc::enable_and_reset::<peripherals::SPI3>();
}

/// Sets the port up for an encoder: 5.3 MHz, data changing on the rising and read on the falling edge.
pub fn prepare(kind: EncoderKind) {
    let (size, threshold) = match kind {
        EncoderKind::Incremental => return,
        EncoderKind::As5047p => (Ds::BITS16, Frxth::HALF),
        // 24 bits are three times eight.
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

/// What the tick before asked the AS5047P for, beside the angle: 0 for nothing, else its frame.
static ASKED: AtomicU16 = AtomicU16::new(0);

/// A reading of which the last frame is on the bus.
pub enum Last {
    /// What it asks for, and what the first brought of what was asked in the tick before.
    As5047p(Question, Option<Asked>),
    /// The bytes so far.
    Mt6701(u32),
}

/// Puts a reading's first frame on the bus, which takes 512 cycles (256 for the MT6701): time for something else.
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

/// Waits for that frame, and puts the last on the bus.
///
/// Each frame of the AS5047P is answered by the next: the first asks for the angle and brings what the tick before asked for, the
/// second brings the angle of now and asks for the magnet's field, or for what was wrong with a frame.
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

/// Waits for the last frame: what the encoder says now.
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

/// When that was: until the next frame it must rest for [`SETTLE`]; until the next tick it does.
fn deselect() -> u32 {
    GPIOD.bsrr().write(|w| w.set_bs(SELECT, true));
    cycles::now()
}

/// Waits until [`SETTLE`] has passed. By the cycle counter, as a counted loop takes five times as long; and where a debugger has
/// stopped that counter, by one.
fn settle(since: u32) {
    let _ = (0..SETTLE).any(|_| cycles::now().wrapping_sub(since) >= SETTLE);
}

/// Removes what an abandoned frame left in the queue: at most four bytes.
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
