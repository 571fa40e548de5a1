//! `touchstone events`: prints the position of a knob for other programs, a line on every change, and sends it as OSC messages.
//!
//! | OSC message | arguments | when |
//! |---|---|---|
//! | `/touchstone/position` | position, change, distance from it as a fraction | sent on every change |
//! | `/touchstone/state` | the device's state, its fault or an empty text | sent on every change |
//! | `/touchstone/position` | the number that the present position gets | received |
//! | `/touchstone/feel` | name of a shipped feel, which the device renders from now on | received |

use super::config::environment::{as_scene, of_scene};
use super::device::warn_unwatched;
use super::number;
use super::osc::{Message, Osc, Value};
use super::out::{self, note, print, say, tell};
use super::port::PortOption;
use super::stream::{self, Until};
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
}

/// Runs the command `touchstone events`.
pub fn main(options: &Options) -> Result<()> {
    let stop = super::interrupt::noted()?;
    let osc = Osc::open(options.osc.as_deref(), options.osc_listen)?;
    let mut client = options.port.connect()?;
    let settings = client.settings()?;
    warn_unwatched(&settings);
    let environment = environment(&mut client)?;
    // A program that chooses the feel may begin with a knob that has none.
    let mut positions = match positions(options, &environment) {
        Err(_) if osc.listens() => Positions::every(std::f64::consts::TAU, 0.0),
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
    let mut line = Lines {
        first: None,
        rate_hz,
        left: options.lines,
        state: None,
        osc,
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
            while let Some(message) = line.osc.next() {
                match wish(&message) {
                    Some(Wish::Number(number)) => called = Some(number),
                    Some(Wish::Feel(name)) => {
                        if let Some(mut after) = render(client, &settings, &name)? {
                            after.hysteresis = options.hysteresis;
                            positions = after;
                        }
                    }
                    None => note!("note: {} is no message for a knob", message.address),
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

/// What an OSC message asks for.
enum Wish {
    /// The number that the present position gets.
    Number(i64),
    /// The feel to render.
    Feel(String),
}

fn wish(message: &Message) -> Option<Wish> {
    match (&*message.address, &*message.values) {
        ("/touchstone/position", [Value::Int(number)]) => Some(Wish::Number((*number).into())),
        ("/touchstone/feel", [Value::Text(name)]) => Some(Wish::Feel(name.clone())),
        _ => None,
    }
}

/// Sends a shipped feel to the device and returns its positions. A feel that is none, or that the device refuses, is noted and
/// changes nothing.
fn render(client: &mut Client, settings: &DeviceSettings, name: &str) -> Result<Option<Positions>> {
    // Only shipped feels: a message must not make this program read a file.
    if !feels().contains(&name) {
        note!("note: there is no feel {name}; give {}", list(&feels()));
        return Ok(None);
    }
    if !client.identity().board.is_large() {
        note!("note: this board has no room for feels");
        return Ok(None);
    }
    let around = Scene::load(name)?.environment.unwrap_or_default();
    let environment = of_scene(&around);
    if let Err(error) = environment.check(settings) {
        note!("note: the device refuses the feel {name}: {error}");
        return Ok(None);
    }
    match client.ask(&Request::SetEnvironment(environment))? {
        Reply::Taken(_) => {}
        other => return Err(client.odd(&other)),
    }
    tell!("feel {name}");
    let unnumbered = Positions::every(std::f64::consts::TAU, 0.0);
    Ok(Some(Positions::of(&around).unwrap_or(unnumbered)))
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
}

impl Lines {
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
        if out::json() {
            let line = serde_json::json!({
                "event": "state", "time_s": time_s, "state": record.phase.name(), "fault": fault,
            });
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
        if out::json() {
            let (first, last) = positions.numbers().unzip();
            let line = serde_json::json!({
                "event": "position", "time_s": time_s, "position": position, "change": change,
                "beside": beside, "angle_rad": angle_rad, "first": first, "last": last,
            });
            return print(format_args!("{line}\n"));
        }
        say!("{time_s:>9.3} s  position {position:>5} ({change:+})  {degrees:>9.2}°");
        Ok(())
    }
}
