//! Telemetry of a device, record by record, for as long as a command wants it.

use super::out::is_read;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use touchstone_device::Client;
use touchstone_protocol::{Request, Telemetry};
use touchstone_sim::error::{Error, Result};

/// A device that should send and is silent for this long is taken to be gone.
pub const SILENCE_LIMIT: Duration = Duration::from_secs(2);

/// The device hears of the desktop at least this often: the shortest useful setting of its watchdog on the desktop is twice as long.
pub const SIGN_OF_LIFE: Duration = Duration::from_millis(250);

/// When a command has enough of a device's records.
#[derive(Debug, Clone, Copy)]
pub struct Until<'a> {
    /// Set by Ctrl-C.
    pub stop: &'a AtomicBool,
    /// After this many seconds, if given.
    pub seconds: Option<f64>,
    /// Whether to go on although nobody reads the standard output any more.
    pub unread: bool,
}

/// Hands every record to `take`, until that returns false or the end that was asked for; shows the device that the desktop is alive.
///
/// # Errors
/// The device fails, or sends nothing for two seconds; what `take` refuses.
pub fn records(
    client: &mut Client,
    until: Until<'_>,
    mut take: impl FnMut(&mut Client, &Telemetry) -> Result<bool>,
) -> Result<()> {
    let begun = Instant::now();
    let (mut heard, mut spoken) = (begun, begun);
    while !until.stop.load(Ordering::Relaxed)
        && (is_read() || until.unread)
        && until
            .seconds
            .is_none_or(|seconds| begun.elapsed().as_secs_f64() < seconds)
    {
        if spoken.elapsed() >= SIGN_OF_LIFE {
            spoken = Instant::now();
            client.ask(&Request::Status)?;
        }
        match client.next_telemetry()? {
            Some(record) => {
                heard = Instant::now();
                if !take(client, &record)? {
                    return Ok(());
                }
            }
            None if heard.elapsed() > SILENCE_LIMIT => {
                return Err(Error::device(
                    client.place(),
                    "no telemetry for 2 s",
                    "look with `touchstone device status`",
                ));
            }
            None => {}
        }
    }
    Ok(())
}
