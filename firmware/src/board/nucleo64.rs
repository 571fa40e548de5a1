//! What every NUCLEO with 64 pins has, whatever shield is on it: the encoder's inputs, the blue button, and the serial port through
//! the ST-LINK (UM2505). Both tracks of the incremental encoder and the encoder over SPI are set up; the settings choose one.

use embassy_stm32::gpio::{AfType, Flex, Level, Output, OutputType, Pull, Speed};
use embassy_stm32::interrupt::{self, InterruptExt, Priority};
use embassy_stm32::pac::gpio::vals::Idr;
use embassy_stm32::pac::{GPIOC, TIM2};
use embassy_stm32::peripherals::{LPUART1, PA2, PA3, PA15, PB3, PC10, PC11, PC12, PC13, PD2, SPI3};
use embassy_stm32::usart::{self, BufferedUart};
use embassy_stm32::{Peri, bind_interrupts};
use touchstone_drive::EncoderReading;

use crate::{encoder, magnetic, serial_port};

bind_interrupts!(struct Irqs {
    LPUART1 => usart::BufferedInterruptHandler<LPUART1>;
});

/// Pin number of the blue button, PC13: high while it is pressed (UM2505, "Push-buttons").
const STOP_BUTTON: usize = 13;

/// Sets up the pin of the stop button.
pub fn set_up_stop_button(pin: Peri<'static, PC13>) {
    let mut stop_button = Flex::new(pin);
    stop_button.set_as_input(Pull::Down);
    // The pin stays as it is until the next reset.
    core::mem::forget(stop_button);
}

/// Sets up the two tracks of an incremental encoder, which TIM2 counts.
pub fn set_up_tracks(a: Peri<'static, PA15>, b: Peri<'static, PB3>) {
    // Both tracks have pull-ups, which open-collector encoders need.
    let mut tracks = (Flex::new(a), Flex::new(b));
    tracks.0.set_as_af_unchecked(1, AfType::input(Pull::Up));
    tracks.1.set_as_af_unchecked(1, AfType::input(Pull::Up));
    encoder::count_edges!(TIM2);
    core::mem::forget(tracks);
}

/// Sets up the port for an encoder over SPI: clock, data from the encoder, data to the encoder, and chip select.
pub fn set_up_spi(
    port: Peri<'static, SPI3>,
    clock: Peri<'static, PC10>,
    from_encoder: Peri<'static, PC11>,
    to_encoder: Peri<'static, PC12>,
    select: Peri<'static, PD2>,
) {
    let output = AfType::output(OutputType::PushPull, Speed::High);
    let mut lines = (
        Flex::new(clock),
        Flex::new(from_encoder),
        Flex::new(to_encoder),
    );
    lines.0.set_as_af_unchecked(6, output);
    // The data line from the encoder has a pull-up, so a missing encoder reads as all ones. The parity of such a frame is right, but
    // its error bit is set, which causes fault 16.
    lines.1.set_as_af_unchecked(6, AfType::input(Pull::Up));
    lines.2.set_as_af_unchecked(6, output);
    let select = Output::new(select, Level::High, Speed::High);
    magnetic::start(port);
    core::mem::forget((lines, select));
}

/// Sets up the serial port to the computer, through the ST-LINK.
pub fn serial_port(
    port: Peri<'static, LPUART1>,
    receive: Peri<'static, PA3>,
    send: Peri<'static, PA2>,
) -> BufferedUart<'static> {
    interrupt::LPUART1.set_priority(Priority::P6);
    let serial = BufferedUart::new(
        port,
        receive,
        send,
        serial_port::SEND.take(),
        serial_port::RECEIVE.take(),
        Irqs,
        serial_port::config(),
    );
    defmt::unwrap!(serial)
}

/// Reads the counter of encoder edges in TIM2, which has 32 bits.
#[inline(always)]
pub fn encoder_count() -> EncoderReading {
    EncoderReading::Counter32(TIM2.cnt().read())
}

/// Whether the stop button is pressed. It is a convenience and no emergency stop: with a broken wire it does nothing.
#[inline(always)]
pub fn is_stop_pressed() -> bool {
    GPIOC.idr().read().idr(STOP_BUTTON) == Idr::HIGH
}
