//! Receives a device's telemetry, record by record, until a command's end condition is met.

use super::out::is_read;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use touchstone_device::Client;
use touchstone_protocol::{Request, Telemetry};
use touchstone_sim::error::{Error, Result};

/// Time without telemetry after which a device that should send telemetry counts as disconnected.
pub const SILENCE_LIMIT: Duration = Duration::from_secs(2);

/// Time after which the next request is sent to the device, so that it does not switch off for lack of requests. A device's limit,
/// `limits.host_silence_s`, should be at least twice as long.
pub const SIGN_OF_LIFE: Duration = Duration::from_millis(250);

/// Conditions that end the reception of a device's telemetry.
#[derive(Debug, Clone, Copy)]
pub struct Until<'a> {
    /// Ends the reception when true; set by Ctrl-C.
    pub stop: &'a AtomicBool,
    /// Time after which the reception ends, s; `None` for no time limit.
    pub seconds: Option<f64>,
    /// Whether to continue after the reader of standard output has closed the pipe.
    pub unread: bool,
}

/// Passes every telemetry record to `take`, until `take` returns false or an end condition in `until` is met. Meanwhile sends
/// requests to the device, which would otherwise switch off after its limit on the time without a request.
///
/// # Errors
/// The device fails, or sends nothing for two seconds; `take` returns an error.
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
                    "check it with `touchstone device status`",
                ));
            }
            None => {}
        }
    }
    Ok(())
}

/// Runs `work` with the motor on if `arms` is true, and switches the motor off afterwards, after an error as well.
///
/// # Errors
/// The board refused to be armed, did not confirm that it is off, or `work` failed.
pub fn armed<T>(
    client: &mut Client,
    arms: bool,
    work: impl FnOnce(&mut Client) -> Result<T>,
) -> Result<T> {
    if !arms {
        return work(client);
    }
    client.arm()??;
    match work(client) {
        Ok(done) => client.switch_off().map(|_| done),
        Err(error) => Err(client.left_off(error)),
    }
}
