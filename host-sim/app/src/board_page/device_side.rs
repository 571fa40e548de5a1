//! The device's side of the page that shows a board: reads the device's records, runs a simulated copy of the device beside them,
//! and connects again after a lost connection.

use crate::config;
use crate::device::status_of;
use crate::stream::SILENCE_LIMIT;
use std::time::{Duration, Instant};
use touchstone_device::{Address, Client, MAY_BE_ON};
use touchstone_drive::twin::Twin;
use touchstone_link::rows::{RecordRows, decimation};
use touchstone_link::setting::parsed;
use touchstone_link::told;
use touchstone_link::words::described;
use touchstone_protocol::{
    DeviceCommand, DeviceSettings, Phase, Reply, Request, Status, Telemetry,
};
use touchstone_sim::error::{Error, Result};

/// Time between two attempts to connect again after the connection to the device was lost.
const AGAIN: Duration = Duration::from_secs(1);
/// After a command is sent, records that arrive within this time may still show the device's state before the command.
const OLD_RECORD: Duration = Duration::from_secs(1);
/// What changed about the device in one pass of the loop.
#[derive(Debug, Clone, PartialEq)]
pub enum News {
    /// Nothing changed, except that a record may have come.
    None,
    /// The device's phase or its fault changed.
    State,
    /// The connection was lost; holds the reason.
    Lost(String),
    /// The connection is restored; holds a description of how the device was switched off, if it had to be.
    Back(Option<String>),
}

/// Connection to the device, with the settings and records that the page shows.
pub struct DeviceSide {
    address: Address,
    client: Option<Client>,
    /// All settings of the device, as last read from it.
    pub settings: DeviceSettings,
    /// Control periods between two telemetry records.
    pub decimation: u16,
    /// Records received since the last batch that was sent to the page.
    pub rows: RecordRows,
    state: Option<(Phase, u8)>,
    /// Whether the device drove the motor, or could have, according to its last record and the commands since. The value is kept
    /// after a lost connection.
    was_on: bool,
    /// When the last command was sent that lets the device drive the motor. Its answer may be lost.
    asked_on: Option<Instant>,
    heard: Instant,
    tried: Instant,
}

impl DeviceSide {
    pub fn new(address: Address, client: Client) -> Result<Self> {
        let mut link = Self {
            address,
            settings: DeviceSettings::defaults(client.identity().board),
            client: None,
            decimation: 1,
            rows: RecordRows::default(),
            state: None,
            was_on: false,
            asked_on: None,
            heard: Instant::now(),
            tried: Instant::now(),
        };
        link.begin(client)?;
        Ok(link)
    }

    /// Reads the settings over a new connection, switches telemetry on, and uses the connection from now on.
    fn begin(&mut self, mut client: Client) -> Result<()> {
        self.settings = client.settings()?;
        self.decimation = decimation(&self.settings);
        client.tell(&Request::Telemetry {
            decimation: self.decimation,
        })?;
        client.forget_telemetry();
        self.client = Some(client);
        self.heard = Instant::now();
        self.state = None;
        self.model();
        Ok(())
    }

    /// Starts the simulated copy of the device with the device's present settings.
    fn model(&mut self) {
        let twin = self
            .client
            .as_ref()
            .and_then(|client| Twin::new(&self.settings, client.identity().board).ok());
        self.rows.begin(twin, self.decimation, &self.settings);
    }

    /// Runs one pass of the loop: waits at most about 20 ms for a record, or tries to connect again.
    pub fn turn(&mut self) -> News {
        let Some(client) = &mut self.client else {
            return self.again();
        };
        match client.next_telemetry() {
            Ok(Some(record)) => {
                self.heard = Instant::now();
                self.take(&record)
            }
            Ok(None) if self.heard.elapsed() > SILENCE_LIMIT => {
                let silent = "the device sends nothing any more; check it with `touchstone device status`, or reset it";
                self.lost(&format!("{}: {silent}", self.address))
            }
            Ok(None) => News::None,
            Err(error) => self.lost(&error.to_string()),
        }
    }

    fn take(&mut self, record: &Telemetry) -> News {
        let was_calibrating = self
            .state
            .is_some_and(|(phase, _)| phase == Phase::Calibrating);
        // Changed settings take effect from the next calibration on.
        if record.phase == Phase::Calibrating && !was_calibrating {
            self.model();
        }
        self.rows.push(record);
        let now = (record.phase, record.fault);
        let is_on = told::switched_off(record.phase).is_some();
        // A record may have been under way before the device got the command.
        let is_old = |asked: Instant| asked.elapsed() < OLD_RECORD;
        if is_on || !self.asked_on.is_some_and(is_old) {
            self.was_on = is_on;
        }
        if self.state.replace(now) == Some(now) {
            News::None
        } else {
            News::State
        }
    }

    fn lost(&mut self, why: &str) -> News {
        self.client = None;
        self.state = None;
        self.tried = Instant::now();
        News::Lost(why.to_owned())
    }

    fn again(&mut self) -> News {
        std::thread::sleep(Duration::from_millis(20));
        if self.tried.elapsed() < AGAIN {
            return News::None;
        }
        let made = Client::connect(&self.address).and_then(|client| self.begin(client));
        self.tried = Instant::now();
        match made {
            // What the device did without a connection is unknown: it is switched off, and a person must arm it again.
            Ok(()) => News::Back(self.off_in_words()),
            Err(_) => {
                self.client = None;
                News::None
            }
        }
    }

    /// Switches the device off if it drives the motor or could do so, and checks that it is off. Returns a description of what was
    /// done; `None` if there was nothing to switch off.
    ///
    /// # Errors
    /// The device may still be on: a request failed, or there is no connection to a device that was on.
    pub fn off(&mut self) -> Result<Option<&'static str>> {
        if self.client.is_none() {
            // Without a connection, one more attempt to connect is made, because no other program switches the device off.
            self.client = Client::connect(&self.address).ok();
        }
        let done = match &mut self.client {
            Some(client) => client.switch_off(),
            None if self.was_on => Err(self.may_be_on("it was on when the connection was lost")),
            None => Ok(None),
        };
        self.was_on &= done.is_err();
        done
    }

    fn may_be_on(&self, why: &str) -> Error {
        Error::device(
            self.address.to_string(),
            format!("{MAY_BE_ON}: {why}"),
            "switch its power off, or pull its plug",
        )
    }

    /// Does the same as [`DeviceSide::off`], but returns an error as text that the page shows.
    fn off_in_words(&mut self) -> Option<String> {
        match self.off() {
            Ok(done) => done.map(str::to_owned),
            Err(error) => Some(error.to_string()),
        }
    }

    /// Sets the device's telemetry rate back to that of its settings, when the command ends.
    pub fn leave(&mut self) {
        let decimation = self.settings.telemetry.decimation;
        if let Some(client) = &mut self.client {
            // An error means that the device is gone, so there is no setting to restore.
            let _ = client.tell(&Request::Telemetry { decimation });
        }
    }

    /// Runs a request on the connection. If the connection breaks during the request, the next call of [`DeviceSide::turn`] reports
    /// the loss.
    fn with<T>(&mut self, ask: impl FnOnce(&mut Client) -> Result<T>) -> Result<T> {
        match &mut self.client {
            Some(client) => ask(client),
            None => Err(Error::device(
                self.address.to_string(),
                "there is no connection",
                "connect the board; the program tries again every second",
            )),
        }
    }

    pub fn status(&mut self) -> Result<Status> {
        self.with(status_of)
    }

    /// Requests the device's status. The device switches the motor off if the computer sends no request for too long. A device that
    /// does not answer counts as lost.
    pub fn sign_of_life(&mut self) -> News {
        let is_there = self.client.is_some();
        match self.status() {
            Err(error) if is_there => self.lost(&error.to_string()),
            _ => News::None,
        }
    }

    pub fn command(&mut self, command: DeviceCommand) -> Result<()> {
        match command {
            DeviceCommand::Stop | DeviceCommand::Disarm => {
                if self.client.is_none() && self.was_on {
                    return Err(self.may_be_on("there is no connection"));
                }
                self.with(|client| client.stop_by(command))
            }
            DeviceCommand::Calibrate | DeviceCommand::Arm => {
                self.was_on |= self.client.is_some();
                self.asked_on = Some(Instant::now());
                self.with(|client| client.tell(&Request::Command(command)))
            }
            _ => self.with(|client| client.tell(&Request::Command(command))),
        }
    }

    pub fn save(&mut self) -> Result<()> {
        self.with(|client| client.tell(&Request::Save))
    }

    pub fn defaults(&mut self) -> Result<()> {
        self.settings = self.with(|client| {
            client.tell(&Request::Defaults)?;
            client.settings()
        })?;
        Ok(())
    }

    /// Changes one setting of the device; path and value are given as text.
    pub fn set(&mut self, path: &str, text: &str) -> Result<()> {
        let setting = parsed(path, text)?;
        let (_, after) = self.with(|client| config::set(client, &setting))?;
        self.settings = after;
        Ok(())
    }

    /// Number of telemetry records that the device dropped because its port was too slow, and number of frames that arrived
    /// damaged.
    pub fn troubles(&mut self) -> Result<(u32, u32)> {
        self.with(|client| match client.ask(&Request::Counters)? {
            Reply::Counters(counters) => Ok((counters.telemetry_dropped, client.decode_errors())),
            other => Err(client.odd(&other)),
        })
    }

    /// The device's identity and all its settings, as JSON.
    pub fn hello(&self) -> serde_json::Value {
        let known = self.client.as_ref().map(|client| client.identity());
        let device = known.map_or_else(|| "no device".to_owned(), described);
        told::hello(&device, &self.settings, self.decimation)
    }
}
