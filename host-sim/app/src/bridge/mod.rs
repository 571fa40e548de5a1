//! `touchstone bridge`: lets programs that were written for a SmartKnob use a board.
//!
//! ```text
//! program <- SmartKnob's messages -> pseudo terminal <- this command -> board, by its own protocol
//! ```

mod feel;
mod messages;

use super::device::warn_unwatched;
use super::number;
use super::out::{self, note, say, tell};
use super::port::PortOption;
use super::stream::{self, Until};
use super::zero::{Angles, Zero};
use feel::{Played, Strength, played, refused};
use messages::{Ack, Answer, KnobConfig, KnobRequest, KnobState, Log, ToKnob, VERSION, answered};
use prost::Message;
use serialport::{SerialPort, TTYPort};
use std::io::{ErrorKind, Read, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};
use touchstone_device::Client;
use touchstone_protocol::frame::Decoder;
use touchstone_protocol::{DeviceSettings, Reply, Request, Telemetry};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::positions::Positions;

/// Shortest time between two state messages to the program, if the state keeps changing. Without changes a message is sent every
/// `PERIOD`. A SmartKnob uses the same two times.
const LEAST: Duration = Duration::from_millis(5);
const PERIOD: Duration = Duration::from_secs(5);
/// Telemetry records per second that this command requests from the board. It reads the position from them.
const RECORDS_PER_S: u32 = 250;
/// Largest length of the text in a SmartKnob `Log` message to the program, bytes. A longer text is cut.
const MOST_LOG: usize = 255;

/// Options of the command `touchstone bridge`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    #[command(flatten)]
    port: PortOption,
    /// Makes a link of this name to the pseudo terminal, for programs that want a fixed name.
    #[arg(long, value_name = "PATH")]
    link: Option<PathBuf>,
    /// Arms the board, which must be calibrated, with the first configuration that a program sends, and switches it off at the end.
    #[arg(long)]
    arm: bool,
    /// Stiffness of a detent of strength 1 at its middle, N·m/rad.
    #[arg(long, value_name = "N_M_PER_RAD", default_value_t = 0.2, allow_negative_numbers = true, value_parser = number::up_to(100.0, "in N·m/rad"))]
    detent_stiffness: f64,
    /// Ends after this many seconds; without this option, at Ctrl-C.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number::up_to(1e9, "of seconds"))]
    seconds: Option<f64>,
}

/// Runs the command `touchstone bridge`.
pub fn main(options: &Options) -> Result<()> {
    let stop = super::interrupt::noted()?;
    let mut client = options.port.connect()?;
    if !client.identity().board.is_large() {
        return Err(Error::device(
            client.place(),
            "this board has no memory for detents, only for one wall",
            "use a board with an STM32G474, or `touchstone demo`",
        ));
    }
    let settings = client.settings()?;
    warn_unwatched(&settings);
    let mut terminal = Terminal::open(options.link.as_deref())?;
    let path = terminal.path.clone();
    out::result(
        || serde_json::json!({ "terminal": path, "protocol": "smartknob", "version": VERSION }),
        || {
            say!("{path}");
            Ok(())
        },
    )?;
    tell!("uses SmartKnob's protocol on this port; Ctrl-C ends it");
    if !options.arm {
        tell!(
            "torque acts only if the board is already armed; --arm arms it with the first configuration"
        );
    }
    let rate_hz = settings.timing.rate_hz;
    let decimation = u16::try_from((rate_hz / RECORDS_PER_S).max(1)).unwrap_or(u16::MAX);
    let records = Request::Telemetry { decimation };
    client.tell(&records)?;
    client.forget_telemetry();
    let strength = Strength::of(&settings, options.detent_stiffness);
    let mut knob = SmartKnob::new(strength, settings.clone());
    knob.arms = options.arm;
    let until = Until {
        stop: &stop,
        seconds: options.seconds,
        unread: true,
    };
    let served = stream::records(&mut client, until, |client, record| {
        if matches!(
            knob.see(client, &mut terminal, record)?,
            Angles::Reset { .. }
        ) {
            client.tell(&records)?;
        }
        for payload in terminal.messages() {
            knob.take(client, &mut terminal, &payload)?;
        }
        knob.say(&mut terminal);
        Ok(true)
    });
    if options.arm {
        client.switch_off()?;
    }
    client.tell(&Request::Telemetry {
        decimation: settings.telemetry.decimation,
    })?;
    served
}

/// A pseudo terminal, and the symbolic link to it, which is removed when the terminal is closed.
struct Terminal {
    master: TTYPort,
    /// The program's end of the pseudo terminal, kept open here so that a program may close it and open it again.
    _slave: TTYPort,
    path: String,
    link: Option<PathBuf>,
    decoder: Decoder,
}

impl Terminal {
    fn open(link: Option<&std::path::Path>) -> Result<Self> {
        let failed = |problem: String, fix: &str| Error::device("bridge", problem, fix);
        let (mut master, slave) = TTYPort::pair().map_err(|error| {
            failed(
                format!("the system provides no pseudo terminal: {error}"),
                "close programs that use many pseudo terminals, and try again",
            )
        })?;
        let slave_path = slave.name().unwrap_or_default();
        master
            .set_timeout(Duration::from_millis(1))
            .map_err(|error| failed(error.to_string(), "try again"))?;
        if let Some(link) = link {
            std::os::unix::fs::symlink(&slave_path, link).map_err(|error| {
                failed(
                    format!("no link {}: {error}", link.display()),
                    "give --link a name that does not exist yet, in a folder that you can write to",
                )
            })?;
        }
        Ok(Self {
            master,
            _slave: slave,
            path: slave_path,
            link: link.map(std::path::Path::to_owned),
            decoder: Decoder::new(),
        })
    }

    /// Reads every complete message that has arrived. Damaged messages are dropped: programs repeat a message that is not
    /// acknowledged.
    fn messages(&mut self) -> Vec<Vec<u8>> {
        let mut bytes = [0; 512];
        let count = self.master.read(&mut bytes).unwrap_or_default();
        let mut whole = Vec::new();
        for byte in bytes.get(..count).unwrap_or_default() {
            if let Some(Ok(payload)) = self.decoder.push(*byte) {
                whole.push(payload.to_vec());
            }
        }
        whole
    }

    /// Sends a message to the program. Messages that no program reads are lost, as on a serial port.
    fn send(&mut self, answer: Answer) {
        let frame = answered(answer);
        match self.master.write_all(&frame) {
            Err(error) if error.kind() != ErrorKind::TimedOut => note!("note: bridge: {error}"),
            _ => {}
        }
    }

    fn log(&mut self, words: &str) {
        let end = (0..=words.len().min(MOST_LOG))
            .rev()
            .find(|end| words.is_char_boundary(*end))
            .unwrap_or(0);
        let msg = words.get(..end).unwrap_or_default().to_owned();
        self.send(Answer::Log(Log { msg }));
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        if let Some(link) = &self.link {
            let _ = std::fs::remove_file(link);
        }
    }
}

/// All data with which the board acts as a SmartKnob towards a program.
struct SmartKnob {
    strength: Strength,
    settings: DeviceSettings,
    config: KnobConfig,
    positions: Positions,
    angle_rad: f64,
    state: KnobState,
    last_nonce: Option<u32>,
    is_asked: bool,
    /// Whether the next configuration from a program arms the board.
    arms: bool,
    sent: Option<(KnobState, Instant)>,
    zero: Zero,
}

impl SmartKnob {
    /// The knob before a program has sent a configuration: positions 10° apart, without detents.
    fn new(strength: Strength, settings: DeviceSettings) -> Self {
        let config = KnobConfig {
            max_position: -1,
            position_width_radians: 10_f32.to_radians(),
            snap_point: 1.0,
            ..KnobConfig::default()
        };
        let rate_hz = settings.timing.rate_hz;
        Self {
            strength,
            settings,
            positions: Positions::every(config.position_width_radians.into(), 0.0),
            config,
            angle_rad: 0.0,
            state: KnobState::default(),
            last_nonce: None,
            is_asked: false,
            arms: false,
            sent: None,
            zero: Zero::new(rate_hz),
        }
    }

    fn see(
        &mut self,
        client: &mut Client,
        terminal: &mut Terminal,
        record: &Telemetry,
    ) -> Result<Angles> {
        let angles = self.zero.see(record);
        if angles == Angles::Calibrating {
            return Ok(angles);
        }
        let counts = f64::from(self.settings.encoder.counts_per_rev);
        self.angle_rad = f64::from(record.count) / counts * std::f64::consts::TAU;
        if angles != Angles::Same {
            self.begin_again(client, terminal)?;
        }
        if let Some(place) = self.positions.take(self.angle_rad) {
            let number = place
                .position
                .clamp(i64::from(i32::MIN), i64::from(i32::MAX));
            self.state.current_position = number as i32;
        }
        let beside = self.positions.beside(self.angle_rad) as f32;
        // A change of at most 0.005 of a position's width is not sent to the program.
        if (beside - self.state.sub_position_unit).abs() > 0.005 {
            self.state.sub_position_unit = beside;
        }
        Ok(angles)
    }

    /// Called when the board's angles count from another zero. The knob keeps its position number, and the board gets the
    /// configuration again. The motor stays off until a person arms the board.
    fn begin_again(&mut self, client: &mut Client, terminal: &mut Terminal) -> Result<()> {
        let (position, width) = (
            self.state.current_position,
            f64::from(self.config.position_width_radians),
        );
        let centre_rad = self.angle_rad - f64::from(self.state.sub_position_unit) * width;
        if self.state.config.is_some() {
            let config = self.config.clone();
            self.render(client, terminal, config, position, centre_rad)?;
        } else {
            let origin_rad = centre_rad - f64::from(position) * width;
            self.positions = Positions::every(width, origin_rad);
            self.positions.stand_at(position.into());
        }
        terminal.log("The board's zero has changed; the knob keeps its position number");
        Ok(())
    }

    fn take(&mut self, client: &mut Client, terminal: &mut Terminal, payload: &[u8]) -> Result<()> {
        let message = match ToKnob::decode(payload) {
            Ok(message) => message,
            Err(error) => {
                terminal.log(&format!("Decoding failed: {error}"));
                return Ok(());
            }
        };
        if message.protocol_version != VERSION {
            let words = format!(
                "Invalid protocol version. Expected {VERSION}, received {}",
                message.protocol_version
            );
            terminal.log(&words);
            return Ok(());
        }
        terminal.send(Answer::Ack(Ack {
            nonce: message.nonce,
        }));
        if self.last_nonce.replace(message.nonce) == Some(message.nonce) {
            terminal.log(&format!("Already handled nonce {}", message.nonce));
            return Ok(());
        }
        match message.payload {
            Some(KnobRequest::RequestState(_)) => self.is_asked = true,
            Some(KnobRequest::Config(config)) => self.configure(client, terminal, config)?,
            None => terminal.log("Unknown payload type"),
        }
        Ok(())
    }

    fn configure(
        &mut self,
        client: &mut Client,
        terminal: &mut Terminal,
        config: KnobConfig,
    ) -> Result<()> {
        if let Some(why) = refused(&config) {
            terminal.log(why);
            return Ok(());
        }
        let before = &self.config;
        let moves = config.position != before.position
            || config.sub_position_unit != before.sub_position_unit
            || config.position_nonce != before.position_nonce;
        let (mut position, beside) = match moves {
            true => (config.position, config.sub_position_unit),
            false => (self.state.current_position, self.state.sub_position_unit),
        };
        if config.min_position <= config.max_position {
            position = position.clamp(config.min_position, config.max_position);
        }
        let is_other_place =
            moves || config.position_width_radians != before.position_width_radians;
        let centre_rad = if is_other_place {
            self.angle_rad - f64::from(beside) * f64::from(config.position_width_radians)
        } else {
            // The centre of the knob's present position. If the new bounds exclude this position, its number changes, but the knob
            // is not pushed.
            self.positions.angle_of(self.state.current_position.into())
        };
        if self.render(client, terminal, config, position, centre_rad)?
            && std::mem::take(&mut self.arms)
        {
            // For example an uncalibrated board. The program keeps its knob, whose motor stays off.
            if let Err(refusal) = client.arm()? {
                note!("note: --arm: {refusal}");
                terminal.log(&format!("Not armed: {refusal}"));
            }
        }
        Ok(())
    }

    /// Sends a configuration to the board, with `position` at the angle `centre_rad`. Returns whether the board accepted it.
    fn render(
        &mut self,
        client: &mut Client,
        terminal: &mut Terminal,
        config: KnobConfig,
        position: i32,
        centre_rad: f64,
    ) -> Result<bool> {
        let Played {
            environment,
            positions,
            notes,
        } = played(&config, position, centre_rad, self.strength);
        // The board's own check, made here. This refusal, and the board's below, become log lines and do not end this command.
        if let Err(error) = environment.check(&self.settings) {
            terminal.log(&format!("Ignoring invalid config: {error}"));
            return Ok(false);
        }
        match client.ask_or_refusal(&Request::SetEnvironment(environment))? {
            Ok(Reply::Taken(_)) => {}
            Ok(other) => return Err(client.odd(&other)),
            // For example during a calibration.
            Err(refusal) => {
                terminal.log(&format!("Ignoring config: {refusal}"));
                return Ok(false);
            }
        }
        self.positions = positions;
        self.config = config;
        self.state.config = Some(self.config.clone());
        self.positions.stand_at(position.into());
        self.state.current_position = position;
        self.state.sub_position_unit = self.positions.beside(self.angle_rad) as f32;
        terminal.log("Got new config");
        for words in notes {
            terminal.log(&words);
        }
        Ok(true)
    }

    /// Sends a state message if the state changed, if the program requested it, or if the longest time between two messages has
    /// passed.
    fn say(&mut self, terminal: &mut Terminal) {
        let due = match &self.sent {
            None => true,
            Some((sent, at)) => {
                self.is_asked
                    || at.elapsed() > PERIOD
                    || (*sent != self.state && at.elapsed() >= LEAST)
            }
        };
        if due {
            self.is_asked = false;
            self.sent = Some((self.state.clone(), Instant::now()));
            terminal.send(Answer::State(self.state.clone()));
        }
    }
}
