//! Standard output.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use touchstone_sim::error::{Error, Result};

/// Whether somebody still reads standard output; prints nothing.
pub fn is_read() -> bool {
    !CLOSED.load(Ordering::Relaxed)
}

/// A reader has gone away.
static CLOSED: AtomicBool = AtomicBool::new(false);

/// Prints. A reader that has had enough (`| head`) is no error, and must not keep a report from being written.
pub fn print(text: Arguments<'_>) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_fmt(text).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error::Io {
            path: "standard output".into(),
            problem: error.to_string(),
            fix: "give it room, or another place".to_owned(),
        }),
        Err(_) => {
            CLOSED.store(true, Ordering::Relaxed);
            Ok(())
        }
        Ok(()) => Ok(()),
    }
}

/// `println!` without the panic.
macro_rules! say {
    ($($text:tt)*) => { $crate::out::print(format_args!("{}\n", format_args!($($text)*)))? };
}
pub(crate) use say;
