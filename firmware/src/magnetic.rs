//! A magnetic encoder at SPI3, through its registers and with every wait bounded: the driver of embassy-stm32 waits for ever.

use embassy_stm32::pac::spi::vals::{Br, Cpha, Cpol, Ds, Frxth, Mstr};
use embassy_stm32::pac::{GPIOD, SPI3};
use embassy_stm32::{Peri, peripherals, rcc};
use touchstone_drive::encoder::{
    AS5047P_READ_ANGLE, AS5047P_READ_ERRORS, EncoderKind, EncoderReading,
};

/// The chip select, PD2.
const SELECT: usize = 2;
/// 350 ns, the AS5047P's time between select and clock, and between two frames; cycles.
const SETTLE: u32 = 60;
/// Polls of a flag before the encoder counts as silent: a frame takes 512 cycles, a poll at least 8.
const POLLS: u32 = 130;

/// Takes the port.
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

/// What the encoder says now.
pub fn read(kind: EncoderKind) -> EncoderReading {
    drain();
    match kind {
        EncoderKind::Incremental => EncoderReading::Silent,
        EncoderKind::As5047p => as5047p(),
        EncoderKind::Mt6701 => mt6701(),
    }
}

/// Each frame is answered by the next: the first asks for the angle, the second brings that of now. It asks for the errors, which
/// the next tick's first frame brings: nobody looks at them, but reading clears them. Otherwise the encoder would mark every
/// angle as wrong after a single damaged frame.
fn as5047p() -> EncoderReading {
    let frame = |word| {
        select();
        let answer = exchange16(word);
        deselect();
        answer
    };
    let asked = frame(AS5047P_READ_ANGLE);
    cortex_m::asm::delay(SETTLE);
    let answer = asked.and_then(|_| frame(AS5047P_READ_ERRORS));
    answer.map_or(EncoderReading::Silent, EncoderReading::As5047p)
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
    cortex_m::asm::delay(SETTLE);
}

/// Until the next frame it must rest for [`SETTLE`]; until the next tick it does.
fn deselect() {
    GPIOD.bsrr().write(|w| w.set_bs(SELECT, true));
}

/// Takes away what a frame that was given up left behind: at most the four bytes of the queue.
fn drain() {
    for _ in 0..4 {
        if SPI3.sr().read().rxne() {
            let _ = SPI3.dr8().read();
        }
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
