//! The device's side: records as they come, the model beside them, and the connection that may break.

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

/// A connection that broke is tried again this often.
const AGAIN: Duration = Duration::from_secs(1);
/// What happened in a turn.
#[derive(Debug, Clone, PartialEq)]
pub enum News {
    /// Only records are requested.
    None,
    /// The device is in another state.
    State,
    /// The connection is gone.
    Lost(String),
    /// The connection is back; with what was done about the device.
    Back(Option<String>),
}

/// The connection to the device.
pub struct DeviceSide {
    address: Address,
    client: Option<Client>,
    /// All settings of the device.
    pub settings: DeviceSettings,
    /// Control ticks between two records.
    pub decimation: u16,
    /// Records since the last batch.
    pub rows: RecordRows,
    state: Option<(Phase, u8)>,
    /// Whether it moved or might have moved something when it was last heard of: kept when the connection breaks.
    was_on: bool,
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
            heard: Instant::now(),
            tried: Instant::now(),
        };
        link.begin(client)?;
        Ok(link)
    }

    /// Takes a connection that was just made.
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

    /// The model of these settings.
    fn model(&mut self) {
        let twin = self
            .client
            .as_ref()
            .and_then(|client| Twin::new(&self.settings, client.identity().board).ok());
        self.rows.begin(twin, self.decimation, &self.settings);
    }

    /// Waits some 20 ms at most for records, or tries to connect again.
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
                let silent = "the device says nothing any more; look with `touchstone device status`, or reset it";
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
        // Settings count from the next calibration on.
        if record.phase == Phase::Calibrating && !was_calibrating {
            self.model();
        }
        self.rows.push(record);
        let now = (record.phase, record.fault);
        self.was_on = told::switched_off(record.phase).is_some();
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
            // Nobody knows what happened meanwhile: whoever wants the wall arms it again.
            Ok(()) => News::Back(self.off_in_words()),
            Err(_) => {
                self.client = None;
                News::None
            }
        }
    }

    /// Switches the device off if it moves or may move something, and confirms it; returns what was done, in words.
    ///
    /// # Errors
    /// The device may still be on.
    pub fn off(&mut self) -> Result<Option<&'static str>> {
        if self.client.is_none() {
            // The page's connection is gone: one of its own is tried, since nobody else will switch it off.
            self.client = Client::connect(&self.address).ok();
        }
        let done = match &mut self.client {
            Some(client) => client.switch_off(),
            None if self.was_on => Err(Error::device(
                self.address.to_string(),
                format!("{MAY_BE_ON}: it was on when the connection was lost"),
                "switch its power off, or pull its plug",
            )),
            None => Ok(None),
        };
        self.was_on &= done.is_err();
        done
    }

    /// Same as [`DeviceSide::off`], with an error as words for a page that goes on.
    fn off_in_words(&mut self) -> Option<String> {
        match self.off() {
            Ok(done) => done.map(str::to_owned),
            Err(error) => Some(error.to_string()),
        }
    }

    /// Restores the device's own telemetry setting.
    pub fn leave(&mut self) {
        let decimation = self.settings.telemetry.decimation;
        if let Some(client) = &mut self.client {
            // A device that just left has nothing to be set back.
            let _ = client.tell(&Request::Telemetry { decimation });
        }
    }

    /// Sends a request to the device; the next turn notices a connection that breaks meanwhile.
    fn with<T>(&mut self, ask: impl FnOnce(&mut Client) -> Result<T>) -> Result<T> {
        match &mut self.client {
            Some(client) => ask(client),
            None => Err(Error::device(
                self.address.to_string(),
                "there is no connection",
                "connect the board; it is tried again every second",
            )),
        }
    }

    pub fn status(&mut self) -> Result<Status> {
        self.with(status_of)
    }

    /// The device hears of the desktop; one that does not answer is lost.
    pub fn sign_of_life(&mut self) -> News {
        let is_there = self.client.is_some();
        match self.status() {
            Err(error) if is_there => self.lost(&error.to_string()),
            _ => News::None,
        }
    }

    pub fn command(&mut self, command: DeviceCommand) -> Result<()> {
        self.with(|client| match command {
            DeviceCommand::Stop | DeviceCommand::Disarm => client.stop_by(command),
            _ => client.tell(&Request::Command(command)),
        })
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

    /// Changes a setting, given as text.
    pub fn set(&mut self, path: &str, text: &str) -> Result<()> {
        let setting = parsed(path, text)?;
        let (_, after) = self.with(|client| config::set(client, &setting))?;
        self.settings = after;
        Ok(())
    }

    /// Records that the device's port could not carry, and frames that came in damaged.
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
