//! Requests and their answers, and the telemetry between them.

use super::{Address, Received, Transport, open};
use std::collections::VecDeque;
use std::time::{Duration, Instant};
use touchstone_protocol::frame::{self, Decoder, FRAME_MAX};
use touchstone_protocol::reply::version_of_hello;
use touchstone_protocol::settings::KeyError;
use touchstone_protocol::{
    DeviceSettings, FromDevice, Identity, PROTOCOL_VERSION, Phase, Refusal, Reply, Request,
    Telemetry, ToDevice,
};
use touchstone_sim::error::{Error, Result};

/// An answer takes some milliseconds, the erase of a flash page 25.
const ANSWER_LIMIT: Duration = Duration::from_millis(500);
/// Once more where the answer was lost or damaged.
const TRIES: u32 = 3;

/// A connection to a device that was identified.
pub struct Client {
    transport: Box<dyn Transport>,
    place: String,
    decoder: Decoder,
    next_id: u8,
    telemetry: VecDeque<Telemetry>,
    identity: Identity,
}

impl Client {
    /// Connects, and asks who is there.
    ///
    /// # Errors
    /// No connection, no answer, or a device of another version.
    pub fn connect(address: &Address) -> Result<Self> {
        let mut client = Client {
            transport: open(address)?,
            place: address.to_string(),
            decoder: Decoder::new(),
            next_id: 0,
            telemetry: VecDeque::new(),
            identity: nobody(),
        };
        // Ends whatever noise or half a frame was before.
        client.transport.send(&[0])?;
        match client.ask(&Request::Hello)? {
            Reply::Identity(identity) => client.identity = identity,
            other => return Err(client.odd(&other)),
        }
        Ok(client)
    }

    /// Who is there.
    #[must_use]
    pub const fn identity(&self) -> &Identity {
        &self.identity
    }

    /// The address, for messages.
    #[must_use]
    pub fn place(&self) -> &str {
        &self.place
    }

    /// Frames that this side could not decode.
    #[must_use]
    pub const fn decode_errors(&self) -> u32 {
        self.decoder.errors()
    }

    /// Asks, and waits for the answer. A request without a lasting effect is repeated if its answer is lost.
    ///
    /// # Errors
    /// No connection, no answer, or a refusal.
    pub fn ask(&mut self, request: &Request<'_>) -> Result<Reply> {
        // A command that is carried out twice is another command; a second `Save` wears the flash.
        let tries = match request {
            Request::Command(_) | Request::Save => 1,
            _ => TRIES,
        };
        for _ in 0..tries {
            let id = self.next_id;
            self.next_id = id.wrapping_add(1);
            let mut buffer = [0; FRAME_MAX];
            let message = ToDevice {
                id,
                request: request.clone(),
            };
            let frame = frame::encode(&message, &mut buffer)
                .map_err(|_| self.wrong("the request is too long", "report this as a bug"))?;
            self.transport.send(frame)?;
            if let Some(answer) = self.answer(id)? {
                return answer.map_err(|refusal| self.refused(&refusal));
            }
        }
        Err(self.silent(request))
    }

    /// The same, of a request whose answer is `Done`.
    ///
    /// # Errors
    /// As [`Self::ask`].
    pub fn tell(&mut self, request: &Request<'_>) -> Result<()> {
        match self.ask(request)? {
            Reply::Done => Ok(()),
            other => Err(self.odd(&other)),
        }
    }

    /// The next telemetry record; `None` if none came for a while.
    ///
    /// # Errors
    /// No connection.
    pub fn next_telemetry(&mut self) -> Result<Option<Telemetry>> {
        if self.telemetry.is_empty() {
            self.receive(&mut None)?;
        }
        Ok(self.telemetry.pop_front())
    }

    /// Drops the records that came in and were not taken: those from before a change of the decimation.
    pub fn forget_telemetry(&mut self) {
        self.telemetry.clear();
    }

    /// Waits for the answer with this number.
    fn answer(&mut self, id: u8) -> Result<Option<std::result::Result<Reply, Refusal>>> {
        let until = Instant::now() + ANSWER_LIMIT;
        let mut wanted = Some((id, None));
        while Instant::now() < until {
            self.receive(&mut wanted)?;
            if let Some((_, Some(answer))) = wanted {
                return Ok(Some(answer));
            }
        }
        Ok(None)
    }

    /// Takes what came in: telemetry into the queue, the wanted answer into its place. Answers that came too late are dropped.
    fn receive(&mut self, wanted: &mut Wanted) -> Result<()> {
        let mut bytes = [0; 4096];
        let Received::Bytes(count) = self.transport.receive(&mut bytes)? else {
            return Ok(());
        };
        for &byte in bytes.get(..count).unwrap_or_default() {
            let Some(Ok(payload)) = self.decoder.push(byte) else {
                continue;
            };
            if let Some(version) = version_of_hello(payload)
                && version != PROTOCOL_VERSION
            {
                return Err(Error::device(
                    &*self.place,
                    format!(
                        "the device speaks version {version} of the protocol, this program {PROTOCOL_VERSION}"
                    ),
                    "flash the firmware of this version: touchstone flash",
                ));
            }
            match frame::message::<FromDevice>(payload) {
                Some(FromDevice::Telemetry(record)) => self.telemetry.push_back(record),
                Some(FromDevice::Answer { id, answer }) => {
                    if let Some((asked, place)) = wanted
                        && *asked == id
                    {
                        *place = Some(answer);
                    }
                }
                None => self.decoder.count_error(),
            }
        }
        Ok(())
    }

    fn wrong(&self, problem: impl Into<String>, fix: impl Into<String>) -> Error {
        Error::device(&*self.place, problem, fix)
    }

    fn silent(&self, request: &Request<'_>) -> Error {
        let damaged = match self.decoder.errors() {
            0 => String::new(),
            count => format!(" ({count} frames came in damaged)"),
        };
        match request {
            Request::Hello => self.wrong(
                format!("no answer{damaged}"),
                "is the firmware flashed, is this its port? see `touchstone doctor`",
            ),
            Request::Command(_) | Request::Save => self.wrong(
                format!("no answer{damaged}: it may have been carried out or not"),
                "look with `touchstone device status`",
            ),
            _ => self.wrong(
                format!("no answer{damaged}"),
                "look with `touchstone device status`",
            ),
        }
    }

    /// All settings of the device.
    ///
    /// # Errors
    /// As [`Client::ask`].
    pub fn settings(&mut self) -> Result<DeviceSettings> {
        match self.ask(&Request::GetAll)? {
            Reply::Settings(settings) => Ok(settings),
            other => Err(self.odd(&other)),
        }
    }

    /// An answer to another question.
    pub fn odd(&self, reply: &Reply) -> Error {
        let kind = format!("{reply:?}");
        let kind = kind.split(['(', ' ']).next().unwrap_or_default().to_owned();
        self.wrong(
            format!("answered something else ({kind})"),
            "flash the firmware of this version: touchstone flash",
        )
    }

    fn refused(&self, refusal: &Refusal) -> Error {
        match refusal {
            Refusal::NotNow(phase) => self.wrong(
                format!("the device refuses this in state `{}`", phase.name()),
                next_step(*phase),
            ),
            Refusal::Key(KeyError::NoSuchField) => self.wrong(
                "the device knows no such setting",
                "`touchstone config schema` lists them",
            ),
            Refusal::Key(KeyError::NotAValue) => self.wrong(
                "this is no value of this setting",
                "`touchstone config schema` shows what it may be",
            ),
            Refusal::Invalid(invalid) => {
                self.wrong(format!("refused: {invalid}"), "choose another value")
            }
            Refusal::Flash => self.wrong(
                "the flash could not be written",
                "the settings before are still there; try again",
            ),
            Refusal::RingRuns => self.wrong(
                "the ring is still running: it stops at a fault",
                "watch live values with `touchstone monitor`",
            ),
            Refusal::NotUnderstood => self.wrong(
                "the device does not know this request",
                "flash the firmware of this version: touchstone flash",
            ),
        }
    }
}

/// The number of the answer that is waited for, and its place.
type Wanted = Option<(u8, Option<std::result::Result<Reply, Refusal>>)>;

/// The command that leads on.
const fn next_step(phase: Phase) -> &'static str {
    match phase {
        Phase::Boot => "calibrate first: touchstone device calibrate",
        Phase::Calibrating => "wait for its end, or: touchstone device stop",
        Phase::Ready => "stop first: touchstone device stop",
        Phase::Armed => "disarm first: touchstone device disarm",
        Phase::Fault => "look at it and clear it: touchstone device fault, touchstone device stop",
        Phase::Stopped => "calibrate first: touchstone device calibrate",
    }
}

/// Before anybody answered.
fn nobody() -> Identity {
    Identity {
        protocol_version: 0,
        settings_version: 0,
        firmware_version: Default::default(),
        board: touchstone_protocol::Board::NucleoG474re,
        unique_id: [0; 12],
        reset_reason: touchstone_protocol::ResetReason::PowerOn,
        build_hash: 0,
    }
}
