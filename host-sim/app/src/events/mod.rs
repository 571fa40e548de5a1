//! `touchstone events`: prints the position of a knob for other programs, a line on every change, and sends it as OSC messages and
//! to the clients of a WebSocket.
//!
//! | OSC message | arguments | when |
//! |---|---|---|
//! | `/touchstone/position` | position, change, distance from it as a fraction | sent on every change |
//! | `/touchstone/state` | the device's state, its fault or an empty text | sent on every change |
//! | `/touchstone/error` | the setting that is wrong or an empty text, the problem | sent for every refused message |
//! | `/touchstone/position` | the number that the present position gets | received |
//! | `/touchstone/feel` | name of a shipped feel or text of a scene, which the device renders from now on | received |
//!
//! A WebSocket client gets the lines that `events --json` prints, and sends the same requests as `{"position": 3}` and
//! `{"feel": "on-off"}`, or `{"feel": {"environment": {}}}` with the tables of a scene. For MIDI see [`midi`]. A change of position
//! can also press keys.

mod feel;
mod kept;
mod knob;
mod lines;
mod midi;
mod wish;

use super::device::warn_unwatched;
use super::number;
use super::osc::Osc;
use super::out::{self, print, say, tell};
use super::port::PortOption;
use super::stream::{self, Until};
use super::websocket::WebSocketServer;
use kept::Kept;
use knob::Knob;
use lines::{Keys, Lines};
use midi::{Midi, MidiOptions};
use serde_json::json;
use std::path::PathBuf;
use touchstone_keys::KeyPair;
use touchstone_protocol::Request;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::positions::{HYSTERESIS, MOST_HYSTERESIS};

/// Telemetry records per second, from which the position is read. This is enough for a hand that turns by 20 positions per second.
const RECORDS_PER_S: u32 = 250;

/// Options of the command `touchstone events`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    #[command(flatten)]
    port: PortOption,
    /// Distance between two positions, degrees. Default: that of the device's detents, torque profile or clicks.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = number::up_to(360.0, "in degrees"))]
    pitch: Option<f64>,
    /// How far beyond the midpoint between two positions the number changes, as a fraction of their distance, 0 to 0.49.
    #[arg(long, value_name = "FRACTION", default_value_t = HYSTERESIS, allow_negative_numbers = true, value_parser = number::within(0.0, MOST_HYSTERESIS, "of the distance between two positions"))]
    hysteresis: f64,
    /// Holds the knob longer at position 0: shifts each change of the number away from position 0 by this fraction of the distance
    /// between two positions, 0 to 0.49. With --hysteresis at most 0.49 in total. A SmartKnob calls it `snap_point_bias`.
    #[arg(long, value_name = "FRACTION", default_value_t = 0.0, allow_negative_numbers = true, value_parser = number::within(0.0, MOST_HYSTERESIS, "of the distance between two positions"))]
    bias: f64,
    /// Gives this number to the position in which the knob is now. Default: position 0 is the detent or click at `centre_rad`, the
    /// first detent of a list, or the first angle of a torque profile at which the knob rests.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    position: Option<i64>,
    /// Stores the position's number in this file for the next start, for a knob without end stops. At the next start, the position
    /// at which the knob then is gets the stored number.
    #[arg(long, value_name = "FILE", conflicts_with = "position")]
    keep: Option<PathBuf>,
    /// Arms the board, which must be calibrated, and switches it off at the end.
    #[arg(long)]
    arm: bool,
    /// Ends after this many seconds; without this option, at Ctrl-C.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number::up_to(1e9, "of seconds"))]
    seconds: Option<f64>,
    /// Ends after this many lines.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number::within(1_u64, 1_000_000_000, "of lines"))]
    lines: Option<u64>,
    /// Also sends every change as an OSC message over UDP, to a port on this computer or to HOST:PORT.
    #[arg(long, value_name = "PORT")]
    osc: Option<String>,
    /// Receives OSC messages from this computer on this port. /touchstone/feel FEEL renders a feel, by the name of a shipped one or
    /// as the TOML text of a scene with a table `environment`. /touchstone/position N gives the present position the number N. A
    /// refused message changes nothing; with --osc the answer is /touchstone/error SETTING PROBLEM.
    #[arg(long, value_name = "PORT", value_parser = number::within(1_u16, u16::MAX, "of a port"))]
    osc_listen: Option<u16>,
    /// Also sends every change, as --json prints it, to the clients of a WebSocket on a port of this computer. Accepts the requests
    /// {"position": N} and {"feel": FEEL} from them. FEEL is the name of a shipped feel, the TOML text of a scene with a
    /// table `environment`, or its tables, e.g. {"environment": {"detents": {"per_rev": 12}}}. A refused request changes nothing and
    /// is answered by a line with "event": "error", setting and problem. Prints the WebSocket's address, which has a secret token.
    /// With HOST:PORT other computers can connect.
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "0")]
    websocket: Option<String>,
    /// Also accepts connections from pages of this web site, e.g. `https://example.org`; `null` is a page opened from a file.
    /// Without this option only programs and pages of http://localhost can connect.
    #[arg(long, value_name = "ORIGIN", requires = "websocket")]
    websocket_origin: Vec<String>,
    #[command(flatten)]
    midi: MidiOptions,
    /// Also presses one key for each position up and another for each position down, e.g. volumeup,volumedown (Linux, feature
    /// `keys`).
    #[arg(long, value_name = "UP,DOWN")]
    keys: Option<KeyPair>,
}

impl Options {
    /// Refuses a bias and a hysteresis that are allowed each, but not together.
    fn check(&self) -> Result<()> {
        // The decimal fractions of the options are rounded to binary ones.
        const ROUNDING: f64 = 1e-9;
        let rest = MOST_HYSTERESIS - self.hysteresis;
        if self.bias <= rest + ROUNDING {
            return Ok(());
        }
        let (bias, hysteresis) = (self.bias, self.hysteresis);
        // Rounded down, so that the value is allowed.
        let most = ((rest.max(0.0) + ROUNDING) * 1e3).floor() / 1e3;
        Err(Error::Option {
            option: "--bias".into(),
            problem: format!(
                "{bias} and --hysteresis {hysteresis} are together more than {MOST_HYSTERESIS} of the distance between two positions, so the knob could rest in one position under another one's number"
            ),
            fix: format!("give --bias {most:.3} at most, or a smaller --hysteresis"),
        })
    }
}

/// Runs the command `touchstone events`.
pub fn main(options: &Options) -> Result<()> {
    options.check()?;
    let stop = super::interrupt::noted()?;
    let osc = Osc::open(options.osc.as_deref(), options.osc_listen)?;
    let websocket = options.websocket.as_deref();
    let websocket = websocket.map(|place| WebSocketServer::open(place, &options.websocket_origin));
    let websocket = websocket.transpose()?;
    let midi = Midi::open(&options.midi)?;
    let keys = options.keys.clone().map(Keys::open).transpose()?;
    let kept = options.keep.as_deref().map(Kept::open).transpose()?;
    let mut client = options.port.connect()?;
    let settings = client.settings()?;
    warn_unwatched(&settings);
    // A knob without positions is accepted if a program can choose another feel.
    let is_asked = osc.listens() || websocket.is_some() || midi.is_some();
    let mut knob = Knob::new(&mut client, options, &settings, kept, is_asked)?;
    knob.ask_for_records(&mut client)?;
    client.forget_telemetry();
    if let Some((first, last)) = knob.positions.numbers() {
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
    let mut lines = Lines {
        first: None,
        rate_hz: settings.timing.rate_hz,
        left: options.lines,
        state: None,
        osc,
        websocket,
        midi,
        keys,
        told: [const { None }; 2],
    };
    let until = Until {
        stop: &stop,
        seconds: options.seconds,
        unread: false,
    };
    let watched = stream::armed(&mut client, options.arm, |client| {
        stream::records(client, until, |client, record| {
            knob.take(client, &mut lines, record)?;
            Ok(lines.goes_on())
        })
    });
    // The board gets its own telemetry rate back even if the number cannot be stored.
    let stored = knob.keep();
    client.tell(&Request::Telemetry {
        decimation: settings.telemetry.decimation,
    })?;
    watched.and(stored)
}
