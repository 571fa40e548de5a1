//! Prints a line for every change of state or position, and reports the change to the programs that use the knob.

use super::feel::Refusal;
use super::midi::Midi;
use super::wish::{Asker, Wish};
use crate::osc::{Osc, Value};
use crate::out::{self, note, print, say};
use crate::websocket::WebSocketServer;
use serde_json::{Value as Json, json};
use touchstone_keys::{KeyPair, Keyboard};
use touchstone_link::words::name_of;
use touchstone_protocol::{Fault, Phase, Telemetry};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::positions::{Place, Positions};

/// Largest length of the problem in the answer to a refused request, characters.
const LONGEST_PROBLEM: usize = 1000;

/// The pair of keys that the knob presses, and the virtual keyboard that sends them.
#[derive(Debug)]
pub struct Keys {
    pair: KeyPair,
    keyboard: Box<dyn Keyboard>,
}

impl Keys {
    /// Opens the virtual keyboard.
    pub fn open(pair: KeyPair) -> Result<Self> {
        let keyboard = touchstone_keys::open(&pair)?;
        Ok(Self { pair, keyboard })
    }

    fn press(&mut self, change: i64) -> Result<()> {
        let pressed = self.pair.press(self.keyboard.as_mut(), change);
        pressed.map_err(|error| Error::Option {
            option: "--keys".into(),
            problem: format!("the system rejects further key presses: {error}"),
            fix: "start the command again".into(),
        })
    }
}

/// Address of the OSC message that says why another one was refused.
const ERROR: &str = "/touchstone/error";
/// Largest number of OSC messages that are read before the board is served again.
const OSC_AT_A_TIME: usize = 8;

/// State of the printed lines, and the connections on which changes are reported.
pub struct Lines {
    /// Number of the control period in which the first telemetry record was made.
    pub first: Option<u32>,
    pub rate_hz: u32,
    /// Number of lines that are still to be printed; `None` without a limit.
    pub left: Option<u64>,
    pub state: Option<(Phase, u8)>,
    pub osc: Osc,
    pub websocket: Option<WebSocketServer>,
    pub midi: Option<Midi>,
    pub keys: Option<Keys>,
    /// The newest state line and the newest position line, for a WebSocket client that connects later.
    pub told: [Option<Json>; 2],
}

impl Lines {
    /// The requests of all programs since the last call. Invalid ones are refused.
    pub fn wishes(&mut self, positions: &Positions) -> Vec<(Asker, Wish)> {
        let mut wishes = Vec::new();
        // A program that sends without pause must not hold up the board.
        for message in (0..OSC_AT_A_TIME)
            .map_while(|_| self.osc.next())
            .collect::<Vec<_>>()
        {
            match Wish::of_message(&message) {
                Some(wish) => wishes.push((Asker::Osc, wish)),
                // Never answered: two programs would answer each other for ever, and so would this one with its own port as receiver.
                None if message.address == ERROR => {}
                None => {
                    let problem = format!(
                        "{} is not a message that `events` takes, or its argument has the wrong type; send /touchstone/position with an integer or /touchstone/feel with a text",
                        message.address
                    );
                    self.refuse(Asker::Osc, &Refusal::of_request(problem));
                }
            }
        }
        if let Some(midi) = &mut self.midi {
            let asked = midi.asked(positions);
            wishes.extend(asked.into_iter().map(|it| (Asker::Midi, Wish::of_midi(it))));
        }
        let Some(websocket) = &mut self.websocket else {
            return wishes;
        };
        let news = websocket.turn();
        for client in news.arrived {
            for line in self.told.iter().flatten() {
                websocket.answer(client, line);
            }
        }
        for asked in news.asked {
            let from = Asker::Client(asked.client);
            match serde_json::from_str(&asked.text) {
                Ok(wish) => wishes.push((from, wish)),
                Err(error) => {
                    let problem = format!("this is not a valid request: {error}");
                    self.refuse(from, &Refusal::of_request(problem));
                }
            }
        }
        wishes
    }

    /// Reports which setting of a request was refused and why: to its WebSocket client, else as a printed note. The refusal
    /// of an OSC message is also sent to the program that receives all OSC messages.
    pub fn refuse(&mut self, from: Asker, refusal: &Refusal) {
        // A program may send a long text, which the problem quotes.
        let short = |text: &String| text.chars().take(LONGEST_PROBLEM).collect::<String>();
        let (setting, problem) = (refusal.setting.as_ref().map(short), short(&refusal.problem));
        if let (Asker::Client(client), Some(websocket)) = (from, &mut self.websocket) {
            let line = json!({ "event": "error", "setting": setting, "problem": problem });
            websocket.answer(client, &line);
            return;
        }
        if matches!(from, Asker::Osc) {
            let setting = setting.unwrap_or_default();
            let texts = [setting, problem.clone()].map(Value::Text);
            self.osc.send(ERROR, texts);
        }
        note!("note: {problem}");
    }

    /// Passes the new number of the present position to MIDI.
    pub fn number(&mut self, position: i64) {
        if let Some(midi) = &mut self.midi {
            midi.number(position);
        }
    }

    pub fn goes_on(&self) -> bool {
        self.left != Some(0)
    }

    fn count(&mut self) {
        if let Some(left) = &mut self.left {
            *left = left.saturating_sub(1);
        }
    }

    /// Time since the first record, s.
    fn time_s(&mut self, record: &Telemetry) -> f64 {
        let first = *self.first.get_or_insert(record.tick);
        f64::from(record.tick.wrapping_sub(first)) / f64::from(self.rate_hz)
    }

    /// Called after a reset of the board, which restarts the count of control periods. Makes the time continue from the control
    /// period `before`, the last one before the reset.
    pub fn go_on_from(&mut self, before: u32, record: &Telemetry) {
        let first = &mut self.first;
        *first = first.map(|first| record.tick.wrapping_sub(before.wrapping_sub(first)));
    }

    /// Prints a line if the device's state or its fault has changed.
    pub fn state(&mut self, record: &Telemetry) -> Result<()> {
        let now = (record.phase, record.fault);
        if self.state.replace(now) == Some(now) || !self.goes_on() {
            return Ok(());
        }
        self.count();
        let time_s = self.time_s(record);
        let fault = (record.fault != 0).then(|| {
            name_of(&Fault {
                code: record.fault,
                tick: record.tick,
                value: 0,
            })
        });
        self.osc.send(
            "/touchstone/state",
            [
                Value::Text(record.phase.name().into()),
                Value::Text(fault.clone().unwrap_or_default()),
            ],
        );
        let line = json!({
            "event": "state", "time_s": time_s, "state": record.phase.name(), "fault": fault,
        });
        if let Some(websocket) = &mut self.websocket {
            websocket.send(&line);
            self.told[0] = Some(line.clone());
        }
        if out::json() {
            return print(format_args!("{line}\n"));
        }
        say!(
            "{time_s:>9.3} s  {}{}",
            record.phase.name(),
            fault.map_or_else(String::new, |fault| format!(": {fault}"))
        );
        Ok(())
    }

    /// Prints a line for a new position of the knob.
    pub fn position(
        &mut self,
        record: &Telemetry,
        place: &Place,
        angle_rad: f64,
        positions: &Positions,
    ) -> Result<()> {
        if !self.goes_on() {
            return Ok(());
        }
        self.count();
        let time_s = self.time_s(record);
        let degrees = angle_rad.to_degrees();
        let Place {
            position,
            change,
            beside,
        } = *place;
        let whole = |number: i64| Value::Int(number.clamp(i32::MIN.into(), i32::MAX.into()) as i32);
        self.osc.send(
            "/touchstone/position",
            [whole(position), whole(change), Value::Float(beside as f32)],
        );
        if let Some(midi) = &mut self.midi {
            midi.send(place, positions);
        }
        if let Some(keys) = &mut self.keys {
            keys.press(change)?;
        }
        let (first, last) = positions.numbers().unzip();
        let mut line = json!({
            "event": "position", "time_s": time_s, "position": position, "change": change,
            "beside": beside, "angle_rad": angle_rad, "first": first, "last": last,
        });
        if let Some(websocket) = &mut self.websocket {
            websocket.send(&line);
        }
        if out::json() {
            print(format_args!("{line}\n"))?;
        }
        if self.websocket.is_some() {
            // For a client that connects later, this line is not a change.
            line["change"] = 0.into();
            self.told[1] = Some(line);
        }
        if out::json() {
            return Ok(());
        }
        say!("{time_s:>9.3} s  position {position:>5} ({change:+})  {degrees:>9.2}°");
        Ok(())
    }
}
