//! A TCP connection with one deadline for a whole message, in however many pieces its bytes arrive.

use std::io::{Error, ErrorKind, Read, Result, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// A TCP connection with one deadline for a whole message. The socket's own time limit would begin again with every byte.
#[derive(Debug)]
pub(super) struct Timed {
    stream: TcpStream,
    patience: Duration,
    until: Instant,
}

impl Timed {
    pub fn new(stream: TcpStream, patience: Duration) -> Self {
        Self {
            stream,
            patience,
            until: Instant::now() + patience,
        }
    }

    /// Sets the deadline for the next message, this long from now.
    pub fn begin(&mut self, patience: Duration) {
        self.patience = patience;
        self.until = Instant::now() + patience;
    }

    /// Whether the deadline has passed.
    pub fn is_over(&self) -> bool {
        Instant::now() >= self.until
    }

    pub fn over(&self) -> Error {
        let milliseconds = self.patience.as_millis();
        Error::new(
            ErrorKind::TimedOut,
            format!("no complete message within {milliseconds} ms"),
        )
    }

    /// Calls `work`, which reads or writes, with a time limit that ends at the deadline. `set` sets the limit of the stream.
    fn within(
        &mut self,
        set: fn(&TcpStream, Option<Duration>) -> Result<()>,
        work: impl FnOnce(&mut TcpStream) -> Result<usize>,
    ) -> Result<usize> {
        let left = self.until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(self.over());
        }
        set(&self.stream, Some(left))?;
        work(&mut self.stream).map_err(|error| match error.kind() {
            ErrorKind::WouldBlock | ErrorKind::TimedOut => self.over(),
            _ => error,
        })
    }
}

impl Read for Timed {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        self.within(TcpStream::set_read_timeout, |stream| stream.read(buffer))
    }
}

impl Write for Timed {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.within(TcpStream::set_write_timeout, |stream| stream.write(bytes))
    }

    fn flush(&mut self) -> Result<()> {
        self.stream.flush()
    }
}
