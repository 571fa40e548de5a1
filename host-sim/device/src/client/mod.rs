//! A client that sends requests to a board, receives their answers, and queues the telemetry between them.

mod switch_off;

pub use switch_off::{MAY_BE_ON, may_be_on};

use super::{Address, Received, Transport, open};
use std::collections::VecDeque;
use std::time::{Duration, Instant};
use touchstone_link::words;
use touchstone_protocol::frame::{self, Decoder, FRAME_MAX};
use touchstone_protocol::reply::version_of_hello;
use touchstone_protocol::{
    DeviceCommand, DeviceSettings, FromDevice, Identity, PROTOCOL_VERSION, Refusal, Reply, Request,
    Telemetry, ToDevice,
};
use touchstone_sim::error::{Error, Result};

/// Longest wait for an answer. An answer takes some milliseconds, the erase of a flash page 25 ms.
const ANSWER_LIMIT: Duration = Duration::from_millis(500);
/// Number of attempts for a request whose answer was lost or damaged.
const TRIES: u32 = 3;

/// A connection to a device that has identified itself.
pub struct Client {
    transport: Box<dyn Transport>,
    place: String,
    decoder: Decoder,
    next_id: u8,
    telemetry: VecDeque<Telemetry>,
    identity: Identity,
    answer_limit: Duration,
}

impl Client {
    /// Connects to a device and requests its identity.
    ///
    /// # Errors
    /// No connection, no answer, or a device with another protocol version.
    pub fn connect(address: &Address) -> Result<Self> {
        let mut client = Client {
            transport: open(address)?,
            place: address.to_string(),
            decoder: Decoder::new(),
            next_id: 0,
            telemetry: VecDeque::new(),
            identity: nobody(),
            answer_limit: ANSWER_LIMIT,
        };
        // A zero byte ends noise or half a frame that came before.
        client.transport.send(&[0])?;
        match client.ask(&Request::Hello)? {
            Reply::Identity(identity) => client.identity = identity,
            other => return Err(client.odd(&other)),
        }
        Ok(client)
    }

    /// Identity of the connected device.
    #[must_use]
    pub const fn identity(&self) -> &Identity {
        &self.identity
    }

    /// The device's address as text, for messages.
    #[must_use]
    pub fn place(&self) -> &str {
        &self.place
    }

    /// Number of received frames that the client could not decode.
    #[must_use]
    pub const fn decode_errors(&self) -> u32 {
        self.decoder.errors()
    }

    /// Sends a request and waits for its answer. If the answer is lost, the request is repeated, except commands and `Save`.
    ///
    /// # Errors
    /// No connection, no answer, or a refusal by the device.
    pub fn ask(&mut self, request: &Request<'_>) -> Result<Reply> {
        self.answer_to(request)?
            .map_err(|refusal| self.refused(&refusal))
    }

    /// Same as [`Self::ask`], but a refusal by the device is the inner error.
    ///
    /// # Errors
    /// No connection or no answer.
    pub fn ask_or_refusal(&mut self, request: &Request<'_>) -> Result<Result<Reply>> {
        let answer = self.answer_to(request)?;
        Ok(answer.map_err(|refusal| self.refused(&refusal)))
    }

    fn answer_to(&mut self, request: &Request<'_>) -> Result<std::result::Result<Reply, Refusal>> {
        // These requests are sent only once. A command that is carried out twice may have another effect, and a second `Save` wears
        // the flash.
        let tries = match request {
            Request::Command(_) | Request::Save => 1,
            _ => TRIES,
        };
        for _ in 0..tries {
            if let Some(answer) = self.exchange(request)? {
                return Ok(answer);
            }
        }
        Err(self.silent(request))
    }

    /// Sends a request once and waits for its answer; `None` if no answer arrived in time.
    fn exchange(
        &mut self,
        request: &Request<'_>,
    ) -> Result<Option<std::result::Result<Reply, Refusal>>> {
        let id = self.post(request)?;
        self.answer(id)
    }

    /// Sends a request without waiting. Returns the number that its answer will have.
    fn post(&mut self, request: &Request<'_>) -> Result<u8> {
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
        Ok(id)
    }

    /// Same as [`Self::ask`], for a request whose answer is `Done`. A command that switches the device off is sent as
    /// [`Self::stop_by`] does, until the device confirms that it is off.
    ///
    /// # Errors
    /// Same as [`Self::ask`]; the device may still be on.
    pub fn tell(&mut self, request: &Request<'_>) -> Result<()> {
        if let Request::Command(command @ (DeviceCommand::Stop | DeviceCommand::Disarm)) = request {
            return self.stop_by(*command);
        }
        match self.ask(request)? {
            Reply::Done => Ok(()),
            other => Err(self.odd(&other)),
        }
    }

    /// The next telemetry record; `None` if none arrived within some 20 ms.
    ///
    /// # Errors
    /// No connection.
    pub fn next_telemetry(&mut self) -> Result<Option<Telemetry>> {
        if self.telemetry.is_empty() {
            self.receive(&mut None)?;
        }
        Ok(self.telemetry.pop_front())
    }

    /// Drops the telemetry records in the queue, e.g. those from before a change of the decimation.
    pub fn forget_telemetry(&mut self) {
        self.telemetry.clear();
    }

    /// Waits for the answer to the request with this number; `None` if it does not arrive in time.
    fn answer(&mut self, id: u8) -> Result<Option<std::result::Result<Reply, Refusal>>> {
        let until = Instant::now() + self.answer_limit;
        let mut wanted = Some((id, None));
        while Instant::now() < until {
            self.receive(&mut wanted)?;
            if let Some((_, Some(answer))) = wanted {
                return Ok(Some(answer));
            }
        }
        Ok(None)
    }

    /// Handles the received bytes: queues telemetry, and stores the answer with the number in `wanted`. Answers with other numbers
    /// came too late and are dropped.
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
                let (problem, fix) = words::other_version(version, PROTOCOL_VERSION);
                return Err(self.wrong(problem, fix));
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
            count => format!(" ({count} damaged frames arrived)"),
        };
        match request {
            Request::Hello => self.wrong(
                format!("no answer{damaged}"),
                "check that the firmware is flashed and that this is the board's port; see `touchstone doctor`",
            ),
            Request::Command(_) | Request::Save => self.wrong(
                format!("no answer{damaged}: the device may or may not have carried out the command"),
                "check it with `touchstone device status`",
            ),
            _ => self.wrong(
                format!("no answer{damaged}"),
                "check it with `touchstone device status`",
            ),
        }
    }

    /// Requests all settings of the device.
    ///
    /// # Errors
    /// Same as [`Client::ask`].
    pub fn settings(&mut self) -> Result<DeviceSettings> {
        match self.ask(&Request::GetAll)? {
            Reply::Settings(settings) => Ok(settings),
            other => Err(self.odd(&other)),
        }
    }

    /// The error for an answer that is not of the type that the request needs.
    pub fn odd(&self, reply: &Reply) -> Error {
        let (problem, fix) = words::odd(reply);
        self.wrong(problem, fix)
    }

    fn refused(&self, refusal: &Refusal) -> Error {
        let (problem, fix) = words::refused(refusal);
        self.wrong(problem, fix)
    }
}

/// Number of the answer that is awaited, and the answer once it has arrived.
type Wanted = Option<(u8, Option<std::result::Result<Reply, Refusal>>)>;

/// A placeholder identity, used until the device has answered.
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
