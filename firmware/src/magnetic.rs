//! A magnetic encoder at SPI3, through its registers and with every wait bounded: the driver of embassy-stm32 waits for ever.

use core::sync::atomic::{AtomicU16, Ordering::Relaxed};

use embassy_stm32::pac::spi::vals::{Br, Cpha, Cpol, Ds, Frxth, Mstr};
use embassy_stm32::pac::{GPIOD, SPI3};
use embassy_stm32::{Peri, peripherals, rcc};
use touchstone_drive::encoder::{
    AS5047P_READ_ANGLE, EncoderKind, EncoderReading, Frames, Question,
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

/// Reads the encoder.
pub fn read(kind: EncoderKind) -> EncoderReading {
    drain();
    match kind {
        EncoderKind::Incremental => EncoderReading::Silent,
        EncoderKind::As5047p => as5047p(),
        EncoderKind::Mt6701 => mt6701(),
    }
}

/// The frame that the last tick sent to the AS5047P beside the angle's; 0 for none.
static ASKED: AtomicU16 = AtomicU16::new(0);

/// Each frame is answered by the next one. The first requests the angle and brings the answer to the last tick's
/// request; the second brings the present angle and requests the magnet's field or the error flags.
fn as5047p() -> EncoderReading {
    let frame = |word| {
        select();
        let answer = exchange16(word);
        (deselect(), answer)
    };
    let asked = Question::of(ASKED.swap(0, Relaxed));
    let (ended, Some(first)) = frame(AS5047P_READ_ANGLE) else {
        return EncoderReading::Silent;
    };
    let question = Question::after(first);
    settle(ended);
    let (_, Some(angle)) = frame(question.frame()) else {
        return EncoderReading::Silent;
    };
    ASKED.store(question.frame(), Relaxed);
    EncoderReading::As5047p(Frames {
        angle,
        before: asked.map(|asked| asked.answered(first)),
    })
}

fn mt6701() -> EncoderReading {
    select();
    let mut frame = Some(0);
    for _ in 0..3 {
        frame = frame.and_then(|frame| Some(frame << 8 | u32::from(exchange8(0)?)));
    }
    deselect();
    frame.map_or(EncoderReading::Silent, EncoderReading::Mt6701)
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

fn exchange16(word: u16) -> Option<u16> {
    wait(|| SPI3.sr().read().txe())?;
    SPI3.dr16().write_value(word);
    wait(|| SPI3.sr().read().rxne())?;
    Some(SPI3.dr16().read())
}

fn exchange8(byte: u8) -> Option<u8> {
    wait(|| SPI3.sr().read().txe())?;
    SPI3.dr8().write_value(byte);
    wait(|| SPI3.sr().read().rxne())?;
    Some(SPI3.dr8().read())
}
