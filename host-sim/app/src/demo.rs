//! `touchstone demo`: runs the firmware's control code with a simulated motor; programs reach it like a board.

use super::board_page;
use super::interrupt::noted;
use super::out::{note, result, say, tell};
use std::io::{BufRead as _, Read as _};
use std::net::{SocketAddr, TcpListener};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use touchstone_device::Address;
use touchstone_knob::served_knob::{ServedKnob, serve};
use touchstone_sim::error::{Error, Result};

/// Options of the command `touchstone demo`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = HAPPENS)]
pub struct Options {
    /// Opens no page: the simulated knob acts as a board that was just switched on, and waits for `setup`, `monitor`, `config`,
    /// `device` or `live --port`. Ctrl-C ends it.
    #[arg(long)]
    port_only: bool,
    /// TCP address at which the simulated knob listens; port 0 takes a free one.
    #[arg(
        long,
        value_name = "HOST:PORT",
        default_value = "127.0.0.1:0",
        default_value_if("port_only", "true", "127.0.0.1:4000")
    )]
    listen: SocketAddr,
    /// Prints the page's address and does not open it.
    #[arg(long, conflicts_with = "port_only")]
    no_open: bool,
}

/// Longest line of standard input, bytes.
const LINE_MAX: u64 = 1000;

/// Text that the help shows below the options.
const HAPPENS: &str = "\
A simulated hand presses the knob for as long as it is armed.
Lines of standard input are what happens to the board:
  turn DEGREES  the hand turns the knob there, and stays
  press         it presses into the wall again
  volts V       its supply has so many volts
  gap N         N records of telemetry are lost
  noise N       N bytes without a meaning arrive
  pull, plug    its cable";

/// Runs the simulated knob until Ctrl-C, with or without a page in the browser.
pub fn main(options: &Options) -> Result<()> {
    let place = options.listen;
    let failed = |error: std::io::Error| {
        Error::device(
            place.to_string(),
            format!("the simulated knob cannot listen there: {error}"),
            "choose another address with --listen, such as 127.0.0.1:0 for any free port",
        )
    };
    let listener = TcpListener::bind(place).map_err(failed)?;
    let address = format!("tcp:{}", listener.local_addr().map_err(failed)?);
    let happens = lines();
    if options.port_only {
        let stop = noted()?;
        result(
            || serde_json::json!({ "device": address }),
            || {
                say!("{address}");
                Ok(())
            },
        )?;
        tell!("Ctrl-C ends it; in another terminal, for instance:");
        tell!("    touchstone setup --quick --port {address}");
        tell!("    touchstone live --port {address}");
        return serve(ServedKnob::new(), &listener, &happens, &stop).map_err(failed);
    }
    tell!("calibrating a simulated knob");
    let knob = ServedKnob::new().calibrated();
    let stop = AtomicBool::new(false);
    let address = Address::Tcp(address.trim_start_matches("tcp:").to_owned());
    std::thread::scope(|threads| {
        let (listener, ends) = (&listener, &stop);
        threads.spawn(move || {
            if let Err(error) = serve(knob, listener, &happens, ends) {
                note!("note: {}", failed(error));
            }
        });
        tell!("in the page, \"Arm\" switches the wall on; a simulated hand then presses it");
        let done = board_page::main(&address, !options.no_open);
        stop.store(true, Ordering::Relaxed);
        done
    })
}

/// Starts to read standard input in a thread; returns the receiver of its lines.
fn lines() -> Receiver<String> {
    // A writer that is faster than the simulated knob has to wait.
    let (sender, happens) = sync_channel(16);
    std::thread::spawn(move || {
        let mut input = std::io::stdin().lock();
        let mut line = Vec::new();
        while let Ok(1..) = (&mut input).take(LINE_MAX).read_until(b'\n', &mut line) {
            if line.len() as u64 == LINE_MAX {
                note!("note: standard input is not text, and is ignored from now on");
                break;
            }
            let words = String::from_utf8_lossy(&line).trim_end().to_owned();
            if sender.send(words).is_err() {
                break;
            }
            line.clear();
        }
    });
    happens
}
