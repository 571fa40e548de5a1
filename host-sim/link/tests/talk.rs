//! Tests of `Talk`, the requests and answers between a browser page and a board. The simulated board loses frames, refuses
//! requests, is silent or sends damaged data.

use serde_json::Value;
use touchstone_link::talk::{ANSWER_LIMIT_MS, OFF_LIMIT_MS, OFF_TRIES, TRIES, Talk};
use touchstone_protocol::frame::{self, Decoder, FRAME_MAX};
use touchstone_protocol::{
    Board, DeviceCommand, DeviceSettings, FromDevice, Identity, PROTOCOL_VERSION, Phase, Refusal,
    Reply, Request, ResetReason, Status, Telemetry, ToDevice, stored,
};

/// A simulated device that records the requests that it receives.
struct Device {
    decoder: Decoder,
    settings: DeviceSettings,
    phase: Phase,
    tick: u32,
    asked: Vec<String>,
    /// Number of further answers that the device does not send.
    mute: u32,
    telemetry: bool,
}

impl Device {
    fn new() -> Self {
        Self {
            decoder: Decoder::new(),
            settings: DeviceSettings::defaults(Board::NucleoG474re),
            phase: Phase::Boot,
            tick: 0,
            asked: Vec::new(),
            mute: 0,
            telemetry: false,
        }
    }

    fn hears(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        for &byte in bytes {
            let Some(Ok(payload)) = self.decoder.push(byte) else {
                continue;
            };
            let payload = payload.to_vec();
            let Some(ToDevice { id, request }) = frame::message::<ToDevice>(&payload) else {
                continue;
            };
            self.asked.push(format!("{request:?}"));
            let answer = self.answer(&request);
            if self.mute > 0 {
                self.mute -= 1;
                continue;
            }
            out.extend(framed(&FromDevice::Answer { id, answer }));
        }
        out
    }

    fn answer(&mut self, request: &Request<'_>) -> Result<Reply, Refusal> {
        match request {
            Request::Hello => return Ok(Reply::Identity(identity())),
            Request::GetAll => return Ok(Reply::Settings(self.settings.clone())),
            Request::Status => {
                return Ok(Reply::Status(Status {
                    phase: self.phase,
                    fault: None,
                    tick: self.tick,
                    unsaved: false,
                }));
            }
            Request::Counters => return Ok(Reply::Counters(Default::default())),
            Request::Telemetry { .. } => self.telemetry = true,
            Request::Set { path, value } => self.settings.set(path, value).unwrap(),
            Request::Command(DeviceCommand::Arm) if self.phase != Phase::Ready => {
                return Err(Refusal::NotNow(self.phase));
            }
            Request::Command(DeviceCommand::Arm) => self.phase = Phase::Armed,
            Request::Command(DeviceCommand::Disarm) if self.phase != Phase::Armed => {
                return Err(Refusal::NotNow(self.phase));
            }
            Request::Command(DeviceCommand::Disarm) => self.phase = Phase::Ready,
            Request::Command(DeviceCommand::Stop) => self.phase = Phase::Stopped,
            _ => {}
        }
        Ok(Reply::Done)
    }

    fn record(&mut self) -> Vec<u8> {
        self.tick += 1;
        framed(&FromDevice::Telemetry(Telemetry {
            tick: self.tick,
            count: 0,
            penetration_rad: Default::default(),
            since_change_rad: Default::default(),
            force_n_m: Default::default(),
            offset_rad: Default::default(),
            energy_j: touchstone_protocol::settings::Decimal(Default::default()),
            phase: self.phase,
            fault: 0,
            limits: 0,
            cycles: 0,
            lateness_cycles: 0,
            current_q_ma: 0,
            measuring: None,
        }))
    }
}

fn identity() -> Identity {
    Identity {
        protocol_version: PROTOCOL_VERSION,
        settings_version: stored::LAYOUT_VERSION,
        firmware_version: "test".try_into().unwrap(),
        board: Board::NucleoG474re,
        unique_id: [0; 12],
        reset_reason: ResetReason::PowerOn,
        build_hash: 0,
    }
}

fn framed(message: &FromDevice) -> Vec<u8> {
    let mut buffer = [0; FRAME_MAX];
    frame::encode(message, &mut buffer).unwrap().to_vec()
}

/// The page's communication and the simulated device, with a clock.
struct Wire {
    talk: Talk,
    device: Device,
    /// Percentage of the transfers that are lost, in each direction, and the state of the random numbers that choose them.
    lost: u64,
    chance: u64,
    now_ms: f64,
    said: Vec<Value>,
}

impl Wire {
    fn new() -> Self {
        let mut wire = Self {
            talk: Talk::new("here"),
            device: Device::new(),
            lost: 0,
            chance: 1,
            now_ms: 0.0,
            said: Vec::new(),
        };
        wire.talk.opened(0.0);
        wire
    }

    fn connected() -> Self {
        let mut wire = Self::new();
        wire.pass(100.0, true);
        assert_eq!(wire.last("state")["phase"], "boot", "{:?}", wire.said);
        wire
    }

    /// Lets `ms` milliseconds pass. If `power` is true, the device sends a telemetry record every millisecond.
    fn pass(&mut self, ms: f64, power: bool) {
        let until = self.now_ms + ms;
        while self.now_ms < until {
            self.now_ms += 1.0;
            let mut out = self.talk.out();
            if self.loses() {
                out.clear();
            }
            if power {
                let mut answer = self.device.hears(&out);
                if self.loses() {
                    answer.clear();
                }
                if self.device.telemetry {
                    answer.extend(self.device.record());
                }
                self.talk.take(&answer, self.now_ms);
            }
            self.talk.turn(self.now_ms);
            while let Some(text) = self.talk.said() {
                self.said.push(serde_json::from_str(&text).unwrap());
            }
        }
    }

    /// Whether the next transfer is lost.
    fn loses(&mut self) -> bool {
        self.chance ^= self.chance << 13;
        self.chance ^= self.chance >> 7;
        self.chance ^= self.chance << 17;
        self.chance % 100 < self.lost
    }

    /// Answers to the command `what`: the error of each, if it failed.
    fn answers(&self, what: &str) -> Vec<Option<&str>> {
        let ours = self.said.iter().filter(|said| said["do"] == what);
        ours.map(|said| said["error"].as_str()).collect()
    }

    fn order(&mut self, text: &str) {
        self.said.clear();
        self.device.asked.clear();
        self.talk.order(text, self.now_ms);
    }

    /// The last message to the page whose `type` is `kind`.
    fn last(&self, kind: &str) -> &Value {
        let found = self.said.iter().rev().find(|said| said["type"] == kind);
        found.unwrap_or_else(|| panic!("no {kind} in {:?}", self.said))
    }
}

#[test]
fn a_device_is_introduced_and_its_records_are_rows() {
    let mut wire = Wire::connected();
    let hello = wire.last("hello");
    assert!(hello["fields"].as_array().unwrap().len() > 50 && hello["decimation"] == 1);
    wire.talk.rows();
    wire.pass(50.0, true);
    let columns = touchstone_link::rows::COLUMNS.len();
    let rows = wire.talk.rows();
    assert_eq!(rows.len(), 50 * columns);
    assert_eq!(rows[columns + 1] - rows[1], 1.0, "its ticks");
}

#[test]
fn a_setting_is_changed_by_the_table_and_told_back() {
    let mut wire = Wire::connected();
    wire.order(r#"{"do":"set","path":"wall.k_desired_n_m_per_rad","value":"12"}"#);
    wire.pass(20.0, true);
    assert_eq!(wire.last("done")["error"], Value::Null);
    assert_eq!(wire.last("hello")["k_desired_n_m_per_rad"], 12.0);
    wire.order(r#"{"do":"set","path":"wall.k_desired_n_m_per_rad","value":"-4"}"#);
    wire.pass(20.0, true);
    let error = wire.last("done")["error"].as_str().unwrap().to_owned();
    assert!(error.contains("outside 0 to 500000"), "{error}");
    assert!(!wire.device.asked.iter().any(|asked| asked.contains("Set")));
    wire.order(r#"{"do":"arm"}"#);
    wire.pass(20.0, true);
    let error = wire.last("done")["error"].as_str().unwrap();
    assert!(error.contains("in state `boot`"), "{error}");
    wire.order("nonsense");
    wire.pass(20.0, true);
    let error = wire.last("done")["error"].as_str().unwrap();
    assert!(
        error.contains("the page sent an unknown command"),
        "{error}"
    );
}

#[test]
fn the_stop_overtakes_what_waits_and_a_command_is_sent_once() {
    let mut wire = Wire::connected();
    wire.device.mute = 1;
    wire.order(r#"{"do":"save"}"#);
    wire.talk.order(r#"{"do":"defaults"}"#, wire.now_ms);
    wire.talk.order(r#"{"do":"stop"}"#, wire.now_ms);
    wire.pass(3.0, true);
    let ours: Vec<_> = wire
        .device
        .asked
        .iter()
        .filter(|asked| !asked.contains("Status"))
        .collect();
    assert_eq!(ours, ["Save", "Command(Stop)"]);
    assert_eq!(wire.device.phase, Phase::Stopped);
    // The answer to `Save` is lost: the request is not repeated, and the message says that its result is unknown.
    wire.pass(2.0 * ANSWER_LIMIT_MS, true);
    let saves = wire.device.asked.iter().filter(|asked| *asked == "Save");
    assert_eq!(saves.count(), 1);
    assert!(
        wire.said
            .iter()
            .any(|said| said["do"] == "save" && said["error"].as_str().is_some()),
        "{:?}",
        wire.said
    );
}

/// Over a link that loses up to nine of ten transfers in each direction, the commands that switch off are repeated until the device
/// is off, in each state of the conversation. The page never reads that it is off while it is armed.
#[test]
fn the_commands_that_switch_off_are_repeated_until_they_are_confirmed() {
    let mut unconfirmed = 0;
    for seed in 1..=1000_u64 {
        let mut wire = Wire::connected();
        wire.chance = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        wire.device.phase = Phase::Armed;
        match seed % 3 {
            0 => {}
            // The device was out of sight: the page asks for its identity, or waits to do so.
            1 => wire.pass(2500.0, false),
            _ => {
                wire.talk.closed("the cable was pulled");
                wire.talk.opened(wire.now_ms);
            }
        }
        wire.lost = [30, 60, 90][(seed / 3 % 3) as usize];
        let what = if seed % 2 == 0 { "stop" } else { "disarm" };
        wire.order(&format!(r#"{{"do":"{what}"}}"#));
        wire.pass(f64::from(OFF_TRIES + 1) * OFF_LIMIT_MS, true);
        let answers = wire.answers(what);
        assert_eq!(answers.len(), 1, "seed {seed}: {:?}", wire.said);
        match answers[0] {
            None => assert_ne!(wire.device.phase, Phase::Armed, "seed {seed}"),
            Some(error) => {
                assert!(
                    error.contains("THE DEVICE MAY STILL BE ON"),
                    "seed {seed}: {error}"
                );
                unconfirmed += 1;
            }
        }
    }
    assert!(unconfirmed < 500, "{unconfirmed}");
}

#[test]
fn a_stop_that_nothing_confirms_says_that_the_device_may_be_on() {
    let mut wire = Wire::connected();
    wire.device.phase = Phase::Armed;
    wire.order(r#"{"do":"stop"}"#);
    wire.pass(f64::from(OFF_TRIES + 1) * OFF_LIMIT_MS, false);
    let error = wire.answers("stop")[0].expect("not confirmed").to_owned();
    assert!(error.contains("THE DEVICE MAY STILL BE ON"), "{error}");
    // The same if the cable is pulled meanwhile.
    let mut wire = Wire::connected();
    wire.device.phase = Phase::Armed;
    wire.order(r#"{"do":"disarm"}"#);
    wire.talk.closed("the cable was pulled");
    wire.pass(1.0, false);
    let error = wire.answers("disarm")[0].expect("not confirmed").to_owned();
    assert!(
        error.contains("MAY STILL BE ON: the cable was pulled"),
        "{error}"
    );
    // A device that is off already, and refuses to disarm, is off.
    let mut wire = Wire::connected();
    wire.order(r#"{"do":"disarm"}"#);
    wire.pass(20.0, true);
    assert_eq!(wire.answers("disarm"), [None]);
}

#[test]
fn a_lost_answer_is_asked_for_again() {
    let mut wire = Wire::new();
    wire.device.mute = TRIES - 1;
    wire.pass(f64::from(TRIES) * ANSWER_LIMIT_MS + 100.0, true);
    assert_eq!(wire.last("state")["phase"], "boot");
    let hellos = wire.device.asked.iter().filter(|asked| *asked == "Hello");
    assert_eq!(hellos.count() as u32, TRIES);
}

#[test]
fn an_armed_device_that_was_out_of_sight_is_disarmed() {
    let mut wire = Wire::connected();
    wire.device.phase = Phase::Armed;
    wire.pass(2500.0, false);
    assert!(wire.last("connection")["lost"].is_string());
    wire.pass(1500.0, true);
    assert_eq!(wire.device.phase, Phase::Ready);
    let done = wire.last("connection")["done"].as_str().unwrap();
    assert!(done.contains("was disarmed"), "{done}");
    // The same for a port that is unplugged and plugged in again.
    wire.device.phase = Phase::Armed;
    wire.talk.closed("the cable was pulled");
    wire.pass(10.0, false);
    assert_eq!(wire.last("connection")["lost"], "the cable was pulled");
    wire.order(r#"{"do":"arm"}"#);
    wire.pass(10.0, false);
    assert!(wire.last("done")["error"].is_string());
    wire.talk.opened(wire.now_ms);
    wire.pass(100.0, true);
    assert_eq!(wire.device.phase, Phase::Ready);
}

#[test]
fn a_hundred_thousand_bytes_of_nonsense_change_nothing() {
    let mut wire = Wire::connected();
    wire.said.clear();
    let mut state = 15_u64;
    for _ in 0..1000 {
        let noise: Vec<u8> = (0..100)
            .map(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                (state >> 56) as u8
            })
            .collect();
        wire.talk.take(&noise, wire.now_ms);
        wire.pass(1.0, true);
    }
    wire.pass(2100.0, true);
    assert!(wire.said.iter().all(|said| said["type"] != "connection"));
    assert!(wire.last("troubles")["damaged"].as_u64().unwrap() > 100);
    assert_eq!(wire.last("state")["phase"], "boot");
}
