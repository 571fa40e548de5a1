//! The serial port to the computer: the ST-LINK's virtual port, 921,600 baud, 8N1. Receives requests, sends answers and telemetry.

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};

use embassy_futures::select::select;
use embassy_stm32::usart::BufferedUart;
use embassy_time::{Duration, Instant, Ticker, Timer};
use embedded_io_async::{Read, Write};
use static_cell::ConstStaticCell;
use touchstone_protocol::FromDevice;
use touchstone_protocol::frame::{self, Decoder, FRAME_MAX};
use touchstone_protocol::session::{Answered, Session};

use crate::control::control;
use crate::exchange::HEARD;
use crate::requests::Thread;
use crate::shared::InThread;

/// Largest number of telemetry records that are sent before the task handles received bytes again; sending them takes 4 ms.
const RECORDS_A_ROUND: usize = 8;

/// Longest wait for the result of a command. The next control period handles a command, at the slowest rate within 2 ms. [`LOOK`]
/// is the time between two checks for the result.
const PATIENCE: Duration = Duration::from_millis(20);
const LOOK: Duration = Duration::from_micros(250);

/// Buffer in which the frame to be sent next is encoded.
static FRAME: ConstStaticCell<[u8; FRAME_MAX]> = ConstStaticCell::new([0; FRAME_MAX]);
/// Decoder of received frames, with its buffer.
static DECODER: ConstStaticCell<Decoder> = ConstStaticCell::new(Decoder::new());

/// Whether the task that serves the serial port has run since the supervision task last checked.
pub static LINK_LIVES: AtomicBool = AtomicBool::new(false);

/// The task that serves the serial port: handles requests, and sends answers and telemetry.
#[embassy_executor::task]
pub async fn link(
    mut port: BufferedUart<'static>,
    session: &'static mut Session,
    mut device: Thread,
) {
    let (frame, decoder) = (FRAME.take(), DECODER.take());
    let mut ticker = Ticker::every(Duration::from_millis(1));
    let mut received = [0; 64];
    loop {
        LINK_LIVES.store(true, Relaxed);
        // An error on the line ends the read. The damaged frame fails its checksum and is counted.
        let count = match select(port.read(&mut received), ticker.next()).await {
            embassy_futures::select::Either::First(Ok(count)) => count,
            _ => 0,
        };
        for byte in received.iter().take(count) {
            let length = match take(*byte, decoder, session, &mut device, frame) {
                Taken::Nothing => continue,
                Taken::Answer(length) => length,
                Taken::Command => {
                    let accepted = looked_at(&device).await;
                    commanded(accepted, session, &device, frame)
                }
            };
            // Writing to this port cannot fail.
            let _ = port.write_all(&frame[..length]).await;
            // Before the next request, which may be the command to calibrate with the new settings.
            if device.has_new_settings() {
                device.apply(session);
            }
        }
        // Sends a limited number of records, not all: telemetry may arrive faster than the port sends, and requests must be read
        // too.
        for _ in 0..RECORDS_A_ROUND {
            let Some(length) = next_record(device.here(), frame) else {
                break;
            };
            let _ = port.write_all(&frame[..length]).await;
        }
    }
}

/// The message that a received byte completed.
enum Taken {
    /// No message is complete yet.
    Nothing,
    /// A request; the value is the length of its answer's frame in bytes.
    Answer(usize),
    /// A command, which the next control period will handle.
    Command,
}

/// Waits until a control period has handled the command, or until [`PATIENCE`] is over. Other tasks run meanwhile. Returns whether
/// the command had an effect.
async fn looked_at(device: &Thread) -> bool {
    let begun = Instant::now();
    loop {
        if let Some(accepted) = device.accepted() {
            return accepted;
        }
        if begun.elapsed() > PATIENCE {
            device.withdraw();
            return false;
        }
        Timer::after(LOOK).await;
    }
}

/// Handles a received byte. A separate function, not a part of the task, so that decoded messages are on the stack only while they
/// are needed.
#[inline(never)]
fn take(
    byte: u8,
    decoder: &mut Decoder,
    session: &mut Session,
    device: &mut Thread,
    frame: &mut [u8],
) -> Taken {
    let errors = decoder.errors();
    let Some(Ok(payload)) = decoder.push(byte) else {
        return Taken::Nothing;
    };
    HEARD.store(true, Relaxed);
    #[cfg(feature = "g474re")]
    crate::exchange::SPOKEN.store(true, Relaxed);
    // Not moved out of the `match`, because the answer is large.
    match &session.answer_payload(payload, errors, device) {
        Answered::Later => Taken::Command,
        Answered::Now(answer) => encoded(answer, frame).map_or(Taken::Nothing, Taken::Answer),
        Answered::Unreadable => {
            decoder.count_error();
            Taken::Nothing
        }
    }
}

/// Encodes the answer to a command into `frame` and returns the frame's length in bytes.
#[inline(never)]
fn commanded(accepted: bool, session: &mut Session, device: &Thread, frame: &mut [u8]) -> usize {
    match &session.commanded(accepted, device) {
        Answered::Now(answer) => encoded(answer, frame).unwrap_or(0),
        _ => 0,
    }
}

fn encoded(answer: &FromDevice, frame: &mut [u8]) -> Option<usize> {
    Some(frame::encode(answer, frame).ok()?.len())
}

/// Encodes the next telemetry record into `frame` and returns the frame's length in bytes; `None` if no record waits.
#[inline(never)]
fn next_record(here: InThread, frame: &mut [u8]) -> Option<usize> {
    let record = control(here, |control| control.telemetry.pop_front()).flatten()?;
    encoded(&FromDevice::Telemetry(record), frame)
}
