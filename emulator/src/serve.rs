//! Serves the emulated device's serial port on a network socket in real time, so that programs on the computer run without a board.

use std::io::{BufRead, ErrorKind, Read, Write};
use std::net::TcpListener;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use touchstone_protocol::Phase;
use touchstone_world::plant::MEDIUM;

use crate::bench::{Bench, MS, Setup};
use crate::chip::ResetCause;
use crate::cpu::elf::Program;
use crate::world::Parts;

/// Counts of the board's encoder in a turn.
const COUNTS: f64 = 16_384.0;

/// Options of `touchstone-emulator serve`.
#[derive(Debug, Clone, Copy, Default)]
pub struct Wanted {
    /// True: a simulated hand presses into the wall every four seconds while the device is armed, and lets go when the device is no
    /// longer armed.
    pub hand: bool,
    /// True: lines `turn DEGREES` are read from the standard input. A simulated hand then turns the knob to that angle from the zero
    /// that the device reports, and stays; `free` lets go, `reset` presses the reset button.
    pub turned: bool,
    /// Seconds after which serving ends; `None` for no limit.
    pub for_s: Option<u64>,
    /// Properties of the motor and the knob.
    pub parts: Parts,
}

/// Serves one client after the other; the device keeps running between two clients.
///
/// # Errors
/// The address cannot be opened, or the machine halted.
pub fn serve(
    program: &Program,
    address: &str,
    Wanted {
        hand,
        turned,
        for_s,
        parts,
    }: Wanted,
) -> Result<(), String> {
    let listener = TcpListener::bind(address).map_err(|error| format!("{address}: {error}"))?;
    listener
        .set_nonblocking(true)
        .map_err(|error| error.to_string())?;
    let local = listener.local_addr().map_err(|error| error.to_string())?;
    println!("the serial port is at tcp:{local}");
    let setup = Setup {
        parts,
        ..Setup::default()
    };
    let mut bench = Bench::new(program, &setup)?;
    let mut client = None;
    let (started, mut told) = (Instant::now(), Instant::now());
    let orders = turned.then(lines);
    let (mut pressed, mut was_armed) = (0, false);
    let mut buffer = [0; 4_096];
    loop {
        let time = started.elapsed();
        if for_s.is_some_and(|limit| time > Duration::from_secs(limit)) {
            return Ok(());
        }
        if let Ok((stream, peer)) = listener.accept() {
            stream
                .set_nonblocking(true)
                .map_err(|error| error.to_string())?;
            println!("{peer} is connected");
            client = Some(stream);
        }
        if let Some(stream) = &mut client {
            match stream.read(&mut buffer) {
                Ok(0) => client = None,
                Ok(count) => bench.send(&buffer[..count]),
                Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                Err(_) => client = None,
            }
        }
        for order in orders.iter().flat_map(Receiver::try_iter) {
            if let Err(error) = obey(&mut bench, &order) {
                println!("{order}: {error}");
            }
        }
        let until = bench.now() + MS;
        let ran = bench.machine.run_until(until);
        let sent = std::mem::take(&mut bench.machine.chip_mut().link().sent);
        // The simulated hand needs the telemetry, so the bytes are also decoded here before they are sent on.
        bench.link.receive(&sent);
        let excess = bench.link.telemetry.len().saturating_sub(10);
        bench.link.telemetry.drain(..excess);
        ran.map_err(|halt| format!("the machine halted: {halt:?}"))?;
        if let Some(stream) = &mut client
            && let Err(error) = stream.write_all(&sent)
            && error.kind() != ErrorKind::WouldBlock
        {
            client = None;
        }
        let is_armed = bench
            .link
            .telemetry
            .last()
            .is_some_and(|record| record.phase == Phase::Armed);
        // A user who stops a device also takes the hand off the knob, because the next calibration turns the shaft.
        if hand && was_armed && !is_armed {
            bench.release();
        }
        was_armed = is_armed;
        if hand && bench.now() / (4_000 * MS) > pressed {
            pressed = bench.now() / (4_000 * MS);
            if is_armed {
                let _ = bench.press_at(&MEDIUM, 0.1, 0.6, 0.8, 1.0, COUNTS, 5.0);
            }
        }
        let device = Duration::from_millis(bench.now() / MS);
        match device.checked_sub(started.elapsed()) {
            Some(ahead) => std::thread::sleep(ahead),
            None if started.elapsed() - device > Duration::from_secs(1)
                && told.elapsed() > Duration::from_secs(10) =>
            {
                println!(
                    "slower than real time: {:.1} s behind",
                    (started.elapsed() - device).as_secs_f64()
                );
                told = Instant::now();
            }
            None => {}
        }
    }
}

/// Starts to read the standard input in a thread; returns the receiver of its lines.
fn lines() -> Receiver<String> {
    let (sender, lines) = channel();
    std::thread::spawn(move || {
        let read = std::io::stdin().lock().lines().map_while(Result::ok);
        for line in read {
            if sender.send(line).is_err() {
                break;
            }
        }
    });
    lines
}

/// Carries out a line of the standard input.
fn obey(bench: &mut Bench, order: &str) -> Result<(), String> {
    let known = "not known; give `turn DEGREES`, `free` or `reset`";
    match order.split_whitespace().collect::<Vec<_>>()[..] {
        ["turn", degrees] => {
            let degrees: f64 = degrees.parse().map_err(|_| known)?;
            bench.turn_to(&MEDIUM, degrees.to_radians(), COUNTS)
        }
        ["free"] => {
            bench.release();
            Ok(())
        }
        ["reset"] => {
            bench.machine.reset(ResetCause::Pin);
            Ok(())
        }
        _ => Err(known.into()),
    }
}
