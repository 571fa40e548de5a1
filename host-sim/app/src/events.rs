//! `touchstone events`: prints the position of a knob for other programs, a line on every change, and sends it as OSC messages and
//! to the clients of a WebSocket.
//!
//! | OSC message | arguments | when |
//! |---|---|---|
//! | `/touchstone/position` | position, change, distance from it as a fraction | sent on every change |
//! | `/touchstone/state` | the device's state, its fault or an empty text | sent on every change |
//! | `/touchstone/position` | the number that the present position gets | received |
//! | `/touchstone/feel` | name of a shipped feel, which the device renders from now on | received |
//!
//! A client of the WebSocket gets the lines of `events --json`, and sends the same requests as `{"position": 3}` and
//! `{"feel": "on-off"}`.

use super::config::environment::{as_scene, of_scene};
use super::device::warn_unwatched;
use super::number;
use super::osc::{Message, Osc, Value};
use super::out::{self, note, print, say, tell};
use super::port::PortOption;
use super::stream::{self, Until};
use super::websocket::WebSocketServer;
use serde_json::{Value as Json, json};
use touchstone_device::Client;
use touchstone_link::words::name_of;
use touchstone_protocol::settings::environment::Surround;
use touchstone_protocol::{DeviceSettings, Fault, Phase, Reply, Request, Telemetry};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::positions::{HYSTERESIS, Place, Positions};
use touchstone_sim::scene::{Scene, feels, list};

/// Telemetry records per second from which the position is read: enough for a hand that turns 20 positions a second.
const RECORDS_PER_S: u32 = 250;

/// Options of the command `touchstone events`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    #[command(flatten)]
    port: PortOption,
    /// Distance between two positions, degrees. Default: that of the device's detents, or of its torque profile.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = number::up_to(360.0, "in degrees"))]
    pitch: Option<f64>,
    /// How far beyond the middle between two positions the number changes, as a fraction of their distance, 0 to 0.49.
    #[arg(long, value_name = "FRACTION", default_value_t = HYSTERESIS, allow_negative_numbers = true, value_parser = number::within(0.0, 0.49, "of the distance between two positions"))]
    hysteresis: f64,
    /// The number of the position in which the knob is now. Default: position 0 is at the scene's `centre_rad` or `start_rad`.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    position: Option<i64>,
    /// Ends after this many seconds; without this option, at Ctrl-C.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number::up_to(1e9, "of seconds"))]
    seconds: Option<f64>,
    /// Ends after this many lines.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number::within(1_u64, 1_000_000_000, "of lines"))]
    lines: Option<u64>,
    /// Also sends every change as an OSC message over UDP, to a port on this computer or to HOST:PORT.
    #[arg(long, value_name = "PORT")]
    osc: Option<String>,
    /// Takes OSC messages from this computer: /touchstone/feel NAME renders a shipped feel, /touchstone/position N numbers the
    /// present position.
    #[arg(long, value_name = "PORT")]
    osc_listen: Option<u16>,
    /// Also gives every change, as --json prints it, to clients of a WebSocket on a port of this computer, and takes their requests
    /// {"position": N} and {"feel": "NAME"}. Prints its address, which has a secret token. With HOST:PORT other computers can
    /// connect.
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "0")]
    websocket: Option<String>,
    /// Lets pages of this web site connect as well, e.g. `https://example.org`; `null` is a page opened from a file. Without this
    /// option only programs and pages of http://localhost may.
    #[arg(long, value_name = "ORIGIN", requires = "websocket")]
    websocket_origin: Vec<String>,
}

/// Runs the command `touchstone events`.
pub fn main(options: &Options) -> Result<()> {
    let stop = super::interrupt::noted()?;
    let osc = Osc::open(options.osc.as_deref(), options.osc_listen)?;
    let websocket = options.websocket.as_deref();
    let websocket = websocket.map(|place| WebSocketServer::open(place, &options.websocket_origin));
    let websocket = websocket.transpose()?;
    let mut client = options.port.connect()?;
    let settings = client.settings()?;
    warn_unwatched(&settings);
    let environment = environment(&mut client)?;
    // A program that chooses the feel may begin with a knob that has none.
    let mut positions = match positions(options, &environment) {
        Err(_) if osc.listens() || websocket.is_some() => {
            Positions::every(std::f64::consts::TAU, 0.0)
        }
        positions => positions?,
    };
    positions.hysteresis = options.hysteresis;
    let rate_hz = settings.timing.rate_hz;
    let decimation = u16::try_from((rate_hz / RECORDS_PER_S).max(1)).unwrap_or(u16::MAX);
    let counts = f64::from(settings.encoder.counts_per_rev);
    client.tell(&Request::Telemetry { decimation })?;
    client.forget_telemetry();
    if let Some((first, last)) = positions.numbers() {
        tell!("positions {first} to {last}, Ctrl-C ends");
    }
    if let Some(websocket) = &websocket {
        let address = &websocket.address;
        match out::json() {
            true => {
                let line = json!({ "event": "websocket", "address": address });
                print(format_args!("{line}\n"))?;
            }
            false => say!("websocket  {address}"),
        }
    }
    let mut line = Lines {
        first: None,
        rate_hz,
        left: options.lines,
        state: None,
        osc,
        websocket,
        told: [const { None }; 2],
    };
    let mut called = options.position;
    let watched = stream::records(
        &mut client,
        Until {
            stop: &stop,
            seconds: options.seconds,
            unread: false,
        },
        |client, record| {
            for (from, wish) in line.wishes() {
                match wish {
                    Wish::Position(number) => called = Some(number.into()),
                    Wish::Feel(name) => match render(client, &settings, &name)? {
                        Ok(mut after) => {
                            after.hysteresis = options.hysteresis;
                            positions = after;
                        }
                        Err(problem) => line.refuse(from, &problem),
                    },
                }
            }
            let angle_rad = f64::from(record.count) / counts * std::f64::consts::TAU;
            line.state(record)?;
            let mut place = positions.take(angle_rad);
            if let Some(number) = called.take() {
                positions.call(number);
                place = Some(Place {
                    position: number,
                    change: 0,
                    beside: positions.beside(angle_rad),
                });
            }
            let Some(place) = place else {
                return Ok(line.goes_on());
            };
            line.position(record, &place, angle_rad, &positions)?;
            Ok(line.goes_on())
        },
    );
    client.tell(&Request::Telemetry {
        decimation: settings.telemetry.decimation,
    })?;
    watched
}

/// Requests the device's detents, end stops and further walls. A board without memory for them has only its single wall.
fn environment(client: &mut Client) -> Result<Surround> {
    if !client.identity().board.is_large() {
        return Ok(Surround::default());
    }
    match client.ask(&Request::Environment)? {
        Reply::Environment(environment) => Ok(environment),
        other => Err(client.odd(&other)),
    }
}

/// A request of a program.
#[derive(Debug, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
enum Wish {
    /// The number that the present position gets.
    Position(i32),
    /// The feel to render.
    Feel(String),
}

impl Wish {
    fn of_message(message: &Message) -> Option<Self> {
        match (&*message.address, &*message.values) {
            ("/touchstone/position", [Value::Int(number)]) => Some(Self::Position(*number)),
            ("/touchstone/feel", [Value::Text(name)]) => Some(Self::Feel(name.clone())),
            _ => None,
        }
    }
}

/// The sender of a request.
#[derive(Debug, Clone, Copy)]
enum Asker {
    Osc,
    /// The WebSocket's client with this number.
    Client(u64),
}

/// Sends a shipped feel to the device and returns its positions. A feel that is none, or that the device refuses, changes nothing;
/// the reason is returned.
fn render(
    client: &mut Client,
    settings: &DeviceSettings,
    name: &str,
) -> Result<std::result::Result<Positions, String>> {
    // Only shipped feels: a message must not make this program read a file.
    if !feels().contains(&name) {
        return Ok(Err(format!(
            "there is no feel {name}; give {}",
            list(&feels())
        )));
    }
    if !client.identity().board.is_large() {
        return Ok(Err("this board has no room for feels".to_owned()));
    }
    let around = Scene::load(name)?.environment.unwrap_or_default();
    let environment = of_scene(&around);
    if let Err(error) = environment.check(settings) {
        return Ok(Err(format!("the device refuses the feel {name}: {error}")));
    }
    match client.ask(&Request::SetEnvironment(environment))? {
        Reply::Taken(_) => {}
        other => return Err(client.odd(&other)),
    }
    tell!("feel {name}");
    let unnumbered = Positions::every(std::f64::consts::TAU, 0.0);
    Ok(Ok(Positions::of(&around).unwrap_or(unnumbered)))
}

fn positions(options: &Options, environment: &Surround) -> Result<Positions> {
    let environment = as_scene(environment);
    let own = Positions::of(&environment);
    match options.pitch {
        Some(degrees) => {
            let origin_rad = own.map_or(0.0, |it| it.origin_rad);
            Ok(Positions::every(degrees.to_radians(), origin_rad).between(&environment))
        }
        None => own.ok_or_else(|| Error::Option {
            option: "--pitch".into(),
            problem: "the device has no detents, no repeated profile and no clicks, so it has no positions of its own"
                .into(),
            fix: "give the distance between two positions, e.g. --pitch 10, or send it a feel with `touchstone config environment coarse-detents`"
                .into(),
        }),
    }
}

/// State of the printed lines: when they began, and how many are left to print.
struct Lines {
    /// Number of the control period in which the first telemetry record was made.
    first: Option<u32>,
    rate_hz: u32,
    /// Number of lines that are still to be printed; `None` without a limit.
    left: Option<u64>,
    state: Option<(Phase, u8)>,
    osc: Osc,
    websocket: Option<WebSocketServer>,
    /// The newest lines of state and position, for the WebSocket's next client.
    told: [Option<Json>; 2],
}

impl Lines {
    /// The wishes of all programs since the last call. A message without a wish is noted, or answered by an error.
    fn wishes(&mut self) -> Vec<(Asker, Wish)> {
        let mut wishes = Vec::new();
        while let Some(message) = self.osc.next() {
            match Wish::of_message(&message) {
                Some(wish) => wishes.push((Asker::Osc, wish)),
                None => note!("note: {} is no message for a knob", message.address),
            }
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
                Err(error) => self.refuse(from, &format!("this is no request: {error}")),
            }
        }
        wishes
    }

    /// Tells a program why its wish was refused.
    fn refuse(&mut self, from: Asker, problem: &str) {
        match (from, &mut self.websocket) {
            (Asker::Client(client), Some(websocket)) => {
                websocket.answer(client, &json!({ "event": "error", "problem": problem }));
            }
            _ => note!("note: {problem}"),
        }
    }

    fn goes_on(&self) -> bool {
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

    /// Prints a line if the device's state or its fault has changed.
    fn state(&mut self, record: &Telemetry) -> Result<()> {
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
    fn position(
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
            // A client that comes later has seen no change.
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
