//! The communication with a board for a browser's page that opens the serial port itself, without another program between them.
//!
//! Inputs are received bytes, a person's commands and the time. Outputs are bytes to send, messages and rows of numbers. The code
//! has no clock and no port: the page calls [`Talk::turn`] some fifty times a second.

mod questions;

pub use questions::{ANSWER_LIMIT_MS, OFF_LIMIT_MS, OFF_TRIES, TRIES};

use crate::rows::RecordRows;
use crate::told::MAY_BE_ON;
use crate::{setting, told, words};
use questions::{Purpose, Questions};
use serde_json::{Value, json};
use std::collections::VecDeque;
use touchstone_drive::twin::Twin;
use touchstone_protocol::frame::{self, Decoder};
use touchstone_protocol::reply::version_of_hello;
use touchstone_protocol::{
    DeviceCommand, DeviceSettings, FromDevice, Identity, PROTOCOL_VERSION, Phase, Refusal, Reply,
    Request, Telemetry,
};
use touchstone_sim::error::{Error, Result};

/// Time in ms without data after which a device that should send telemetry counts as disconnected.
const SILENCE_MS: f64 = 2000.0;
/// Time in ms between two attempts to reach a disconnected device.
const AGAIN_MS: f64 = 1000.0;
/// Longest time in ms without a request. The requests show the device that the desktop is still connected.
const SIGN_OF_LIFE_MS: f64 = 250.0;
/// Time in ms between two requests of the device's error counters (dropped records, damaged frames).
const LOOK_MS: f64 = 2000.0;

/// State of the communication with the device.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    /// No port is open.
    Closed,
    /// The connection begins: identity, settings and the start of the telemetry are requested one after the other.
    Asking,
    /// The device sends telemetry records.
    There,
    /// The device does not answer, or not as it should. Holds the time of the next attempt, ms.
    Gone(f64),
}

/// The communication with one device.
pub struct Talk {
    place: String,
    decoder: Decoder,
    questions: Questions,
    said: VecDeque<Value>,
    stage: Stage,
    /// Whether the device was connected before. After a new connection its state is then unknown and is requested.
    again: bool,
    identity: Option<Identity>,
    settings: DeviceSettings,
    decimation: u16,
    rows: RecordRows,
    state: Option<(Phase, u8)>,
    heard_ms: f64,
    spoken_ms: f64,
    looked_ms: f64,
}

impl Talk {
    /// Creates a communication without an open port. `place` names the device in messages.
    #[must_use]
    pub fn new(place: &str) -> Self {
        Self {
            place: place.to_owned(),
            decoder: Decoder::new(),
            questions: Questions::default(),
            said: VecDeque::new(),
            stage: Stage::Closed,
            again: false,
            identity: None,
            settings: DeviceSettings::defaults(touchstone_protocol::Board::NucleoG474re),
            decimation: 1,
            rows: RecordRows::default(),
            state: None,
            heard_ms: 0.0,
            spoken_ms: 0.0,
            looked_ms: 0.0,
        }
    }

    /// Call after the port was opened: requests the identity of the device.
    pub fn opened(&mut self, now_ms: f64) {
        self.questions.begin();
        self.state = None;
        self.stage = Stage::Asking;
        self.questions.ask(&Request::Hello, Purpose::Hello);
        self.questions.send(now_ms);
    }

    /// Call after the port was closed or lost, with the reason `why`.
    pub fn closed(&mut self, why: &str) {
        self.stage = Stage::Closed;
        self.lost(why);
    }

    /// Processes bytes that arrived from the device.
    pub fn take(&mut self, bytes: &[u8], now_ms: f64) {
        for &byte in bytes {
            let Some(Ok(payload)) = self.decoder.push(byte) else {
                continue;
            };
            if let Some(version) = version_of_hello(payload)
                && version != PROTOCOL_VERSION
            {
                let (problem, fix) = words::other_version(version, PROTOCOL_VERSION);
                self.gone(&format!("{problem}; {fix}"), now_ms);
                return;
            }
            match frame::message::<FromDevice>(payload) {
                Some(FromDevice::Telemetry(record)) => self.record(&record, now_ms),
                Some(FromDevice::Answer { id, answer }) => self.answered(id, answer, now_ms),
                None => self.decoder.count_error(),
            }
        }
        self.questions.send(now_ms);
    }

    /// Does what is due at the time `now_ms`: repeats an unanswered request, sends a request by which the device detects that the
    /// desktop is still connected, detects a device that sends nothing any more.
    pub fn turn(&mut self, now_ms: f64) {
        self.overdue(now_ms);
        match self.stage {
            Stage::Closed | Stage::Asking => {}
            Stage::Gone(until) if now_ms >= until => self.opened(now_ms),
            Stage::Gone(_) => {}
            Stage::There if now_ms - self.heard_ms > SILENCE_MS => {
                self.gone(
                    "the device says nothing any more; reset it if it stays so",
                    now_ms,
                );
            }
            Stage::There => {
                if now_ms - self.spoken_ms >= SIGN_OF_LIFE_MS && !self.questions.wait() {
                    self.spoken_ms = now_ms;
                    self.questions.ask(&Request::Status, Purpose::State);
                }
                if now_ms - self.looked_ms >= LOOK_MS {
                    self.looked_ms = now_ms;
                    self.questions.ask(&Request::Counters, Purpose::Troubles);
                }
            }
        }
        self.questions.send(now_ms);
    }

    /// Carries out a command of the page, JSON `{"do": …}`. The command that changes a setting also has `path` and `value`.
    pub fn order(&mut self, text: &str, now_ms: f64) {
        let order: Value = serde_json::from_str(text).unwrap_or_default();
        let text = |name: &str| order[name].as_str().unwrap_or_default().to_owned();
        let (what, path) = (text("do"), order["path"].as_str().map(str::to_owned));
        if let Err(error) = self.carry_out(&what, &text("path"), &text("value"), now_ms) {
            self.done(&what, path.as_deref(), Some(&error.to_string()));
        }
    }

    /// Returns the bytes to send to the device and removes them.
    pub fn out(&mut self) -> Vec<u8> {
        self.questions.out()
    }

    /// Removes and returns the next message for the page, as JSON; `None` if there is none.
    pub fn said(&mut self) -> Option<String> {
        self.said.pop_front().map(|message| message.to_string())
    }

    /// Returns the numbers of all telemetry rows that the page has not fetched yet, and removes the rows.
    pub fn rows(&mut self) -> Vec<f64> {
        self.rows.numbers()
    }

    fn carry_out(&mut self, what: &str, path: &str, value: &str, now_ms: f64) -> Result<()> {
        let is_off = is_off(what);
        // A device that does not answer may still hear, so a command that switches it off is sent nevertheless.
        let is_possible = match self.stage {
            Stage::There => true,
            Stage::Asking | Stage::Gone(_) => is_off,
            Stage::Closed => false,
        };
        if !is_possible {
            return Err(self.wrong("there is no connection", "connect the board"));
        }
        let command = |command| Request::Command(command);
        let bytes;
        let request = match what {
            "calibrate" => command(DeviceCommand::Calibrate),
            "arm" => command(DeviceCommand::Arm),
            "disarm" => command(DeviceCommand::Disarm),
            "stop" => command(DeviceCommand::Stop),
            "zero" => command(DeviceCommand::Zero),
            "save" => Request::Save,
            "defaults" => Request::Defaults,
            "set" => {
                let (field, value) = setting::parsed(path, value)?;
                let board = self.identity.as_ref().map(|identity| identity.board);
                let board = board
                    .ok_or_else(|| self.wrong("no board is connected", "connect the board"))?;
                setting::changed(&self.settings, &(field, value.clone()), board)?;
                bytes = value;
                Request::Set {
                    path: field.path,
                    value: &bytes,
                }
            }
            _ => return Err(self.wrong("the page sent an unknown command", "load the page again")),
        };
        let path = (what == "set").then(|| path.to_owned());
        let purpose = Purpose::Order(what.to_owned(), path);
        if is_off {
            // The commands that switch the device off are sent before all others.
            self.questions.overtake(&request, purpose, now_ms);
        } else {
            self.questions.ask(&request, purpose);
            self.questions.send(now_ms);
        }
        Ok(())
    }

    fn wrong(&self, problem: impl Into<String>, fix: &str) -> Error {
        Error::device(self.place.as_str(), problem.into(), fix)
    }

    fn overdue(&mut self, now_ms: f64) {
        while let Some(purpose) = self.questions.overdue(now_ms) {
            match purpose {
                Purpose::Order(what, path) => {
                    let error = if is_off(&what) {
                        self.may_be_on("no answer")
                    } else {
                        self.wrong(
                            "no answer: the device may or may not have carried out the command",
                            "check the device's state on this page",
                        )
                    };
                    self.done(&what, path.as_deref(), Some(&error.to_string()));
                }
                Purpose::Off(_) => {
                    self.connection(Some(&format!("{MAY_BE_ON}: no answer")));
                }
                Purpose::Hello => self.gone(
                    "no answer; check that the firmware is flashed and that this is the board's port",
                    now_ms,
                ),
                _ => self.gone("the device does not answer any more", now_ms),
            }
        }
    }

    fn gone(&mut self, why: &str, now_ms: f64) {
        self.stage = Stage::Gone(now_ms + AGAIN_MS);
        self.lost(why);
    }

    fn may_be_on(&self, why: &str) -> Error {
        self.wrong(
            format!("{MAY_BE_ON}: {why}"),
            "switch its power off, or pull its plug",
        )
    }

    fn lost(&mut self, why: &str) {
        self.state = None;
        // Each order without an answer is reported as failed. While the port is open, a command that switches the device off is
        // repeated further.
        let is_open = self.stage != Stage::Closed;
        for purpose in self.questions.forget(is_open) {
            if let Purpose::Order(what, path) = purpose {
                let why = match is_off(&what) {
                    true => self.may_be_on(why).to_string(),
                    false => why.to_owned(),
                };
                self.done(&what, path.as_deref(), Some(&why));
            }
        }
        self.said.push_back(told::connection(Some(why), None));
    }

    fn connection(&mut self, done: Option<&str>) {
        self.said.push_back(told::connection(None, done));
    }

    fn done(&mut self, what: &str, path: Option<&str>, error: Option<&str>) {
        self.said
            .push_back(json!({ "type": "done", "do": what, "path": path, "error": error }));
    }

    fn answered(&mut self, id: u8, answer: std::result::Result<Reply, Refusal>, now_ms: f64) {
        // Answers that came too late are dropped.
        let Some((purpose, is_off)) = self.questions.answered(id) else {
            return;
        };
        // A device that refuses to be switched off because it is off has done what was wanted, perhaps by an earlier attempt.
        let answer = match answer {
            Err(Refusal::NotNow(phase)) if is_off && told::switched_off(phase).is_none() => {
                Ok(Reply::Done)
            }
            answer => answer,
        };
        match (purpose, answer) {
            (Purpose::Order(what, path), answer) => self.order_answered(&what, path, answer),
            (purpose, Err(refusal)) => {
                let (problem, fix) = words::refused(&refusal);
                match purpose {
                    Purpose::Off(_) => {
                        self.connection(Some(&format!("{MAY_BE_ON}: {problem}; {fix}")));
                    }
                    _ => self.gone(&format!("{problem}; {fix}"), now_ms),
                }
            }
            (Purpose::Hello, Ok(Reply::Identity(identity))) => {
                self.identity = Some(identity);
                self.questions.ask(&Request::GetAll, Purpose::Begin);
            }
            (Purpose::Begin, Ok(Reply::Settings(settings))) => self.begin(settings, now_ms),
            (Purpose::Records, Ok(Reply::Done)) => {
                self.heard_ms = now_ms;
                self.stage = Stage::There;
                let purpose = match std::mem::replace(&mut self.again, true) {
                    true => Purpose::FoundAgain,
                    false => Purpose::State,
                };
                self.questions.ask(&Request::Status, purpose);
            }
            (Purpose::Settings, Ok(Reply::Settings(settings))) => {
                self.settings = settings;
                self.hello();
                self.questions.ask(&Request::Status, Purpose::State);
            }
            (Purpose::State, Ok(Reply::Status(status))) => {
                self.said.push_back(told::state(&status));
            }
            (Purpose::FoundAgain, Ok(Reply::Status(status))) => {
                match told::switched_off(status.phase) {
                    Some((command, done)) => {
                        self.questions
                            .ask(&Request::Command(command), Purpose::Off(done));
                    }
                    None => self.connection(None),
                }
                self.said.push_back(told::state(&status));
            }
            (Purpose::Off(done), Ok(Reply::Done)) => {
                self.connection(Some(done));
                self.questions.ask(&Request::Status, Purpose::State);
            }
            (Purpose::Troubles, Ok(Reply::Counters(counters))) => {
                let damaged = self.decoder.errors();
                self.said
                    .push_back(told::troubles(counters.telemetry_dropped, damaged));
            }
            (_, Ok(reply)) => {
                let (problem, fix) = words::odd(&reply);
                self.gone(&format!("{problem}; {fix}"), now_ms);
            }
        }
    }

    fn order_answered(
        &mut self,
        what: &str,
        path: Option<String>,
        answer: std::result::Result<Reply, Refusal>,
    ) {
        let wrong = match &answer {
            Ok(Reply::Done) => None,
            Ok(reply) => Some(words::odd(reply)),
            Err(refusal) => Some(words::refused(refusal)),
        };
        let error = wrong.map(|(problem, fix)| self.wrong(problem, fix).to_string());
        self.done(what, path.as_deref(), error.as_deref());
        // Records do not contain settings, so they are requested again. The page keeps a refused value in its field.
        if error.is_none() && matches!(what, "set" | "defaults") {
            self.questions.ask(&Request::GetAll, Purpose::Settings);
        } else {
            self.questions.ask(&Request::Status, Purpose::State);
        }
    }

    fn begin(&mut self, settings: DeviceSettings, now_ms: f64) {
        self.decimation = crate::rows::decimation(&settings);
        self.settings = settings;
        self.heard_ms = now_ms;
        self.looked_ms = now_ms;
        self.model();
        let decimation = self.decimation;
        self.hello();
        self.questions
            .ask(&Request::Telemetry { decimation }, Purpose::Records);
    }

    /// Starts the telemetry rows anew, with a simulated copy of the device that has the present settings.
    fn model(&mut self) {
        let twin = self
            .identity
            .as_ref()
            .and_then(|identity| Twin::new(&self.settings, identity.board).ok());
        self.rows.begin(twin, self.decimation, &self.settings);
    }

    fn hello(&mut self) {
        let device = self.identity.as_ref().map(words::described);
        self.said.push_back(told::hello(
            device.as_deref().unwrap_or("no device"),
            &self.settings,
            self.decimation,
        ));
    }

    fn record(&mut self, record: &Telemetry, now_ms: f64) {
        if self.stage != Stage::There {
            return;
        }
        self.heard_ms = now_ms;
        // Changed settings apply from the next calibration on.
        let calibrated = self
            .state
            .is_some_and(|(phase, _)| phase == Phase::Calibrating);
        if record.phase == Phase::Calibrating && !calibrated {
            self.model();
        }
        self.rows.push(record);
        let now = (record.phase, record.fault);
        if self.state.replace(now) != Some(now) {
            self.questions.ask(&Request::Status, Purpose::State);
        }
    }
}

/// Whether a command of the page switches the device off.
fn is_off(what: &str) -> bool {
    matches!(what, "stop" | "disarm")
}
