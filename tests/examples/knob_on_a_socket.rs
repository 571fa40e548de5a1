//! A simulated knob as a board on a TCP port, with a hand that presses while it is armed:
//!
//! ```text
//! cargo run --release -p touchstone-tests --example knob_on_a_socket -- 127.0.0.1:4000
//! touchstone live --port tcp:127.0.0.1:4000
//! ```
//!
//! Lines of standard input are what happens to it: `gap 50`, `noise 100000`, `volts 60`, `pull`, `plug`; it ends with the input.

use std::net::TcpListener;
use std::sync::mpsc::channel;
use touchstone_tests::served_knob::serve;

fn main() -> std::io::Result<()> {
    let address = std::env::args().nth(1);
    let listener = TcpListener::bind(address.as_deref().unwrap_or("127.0.0.1:0"))?;
    println!("tcp:{}", listener.local_addr()?);
    let (sender, happens) = channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                break;
            }
        }
    });
    serve(&listener, &happens)
}
