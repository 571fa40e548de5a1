//! The device's side of the protocol: answers requests, changes the settings, and passes commands to the device.
//!
//! The firmware and the simulated device of the tests run this same code. They differ only in their [`Backend`].

use crate::frame;
use crate::reply::{Counters, FromDevice, Identity, Refusal, Reply, Status};
use crate::request::{DeviceCommand, Request, ToDevice};
use crate::settings::{DeviceSettings, SettingsError, VALUE_MAX};
use crate::stored;
use crate::telemetry::{Fault, Phase, RingChunk};

/// What a session of this chip has beside the settings.
#[cfg_attr(feature = "large", path = "session/large.rs")]
#[cfg_attr(not(feature = "large"), path = "session/small.rs")]
mod beside;

use beside::BesideSettings;
pub use beside::LargeBackend;

/// The functions of a device that a session calls.
pub trait Backend: LargeBackend {
    /// The identity of the device.
    fn identity(&self) -> Identity;
    /// State of the device's state machine.
    fn phase(&self) -> Phase;
    /// The stored fault, if there is one.
    fn fault(&self) -> Option<Fault>;
    /// Number of control ticks since the reset, modulo 2^32.
    fn tick(&self) -> u32;
    /// All counters except that of decoding errors.
    fn counters(&self) -> Counters;
    /// Records of the ring buffer (of the last second) from number `first` on; `None` while the buffer is still recording.
    fn ring(&self, first: u16) -> Option<RingChunk>;
    /// Checks whether the device accepts these settings.
    ///
    /// # Errors
    /// The first setting that the device refuses.
    fn check(&self, settings: &DeviceSettings) -> Result<(), SettingsError>;
    /// Hands over settings that were checked. The device uses them from the next calibration on.
    fn use_settings(&mut self, settings: &DeviceSettings);
    /// Writes an image of settings into flash.
    ///
    /// # Errors
    /// The flash could not be written. The settings stored before are still there.
    fn save(&mut self, image: &[u8]) -> Result<(), FlashError>;
    /// Carries out a command and returns whether the command had an effect. `None` means that the result comes later: the caller
    /// of the session then passes the result to [`Session::commanded`].
    fn command(&mut self, command: DeviceCommand) -> Option<bool>;
    /// Starts telemetry with one record every `decimation` control ticks; 0 stops it.
    fn telemetry(&mut self, decimation: u16);
}

/// The flash could not be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FlashError;

/// A session, which answers the desktop's requests: the settings in use, the data stored beside them, and whether all of it is in
/// flash.
#[derive(Debug, Clone)]
pub struct Session {
    settings: DeviceSettings,
    beside: BesideSettings,
    unsaved: bool,
    /// Number and command of a request whose result is not known yet, because the device has not carried it out.
    waiting: Option<(u8, DeviceCommand)>,
}

/// How a session answered the payload of a frame.
// A large variant is acceptable, because only one message exists at a time.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answered {
    /// The answer is ready to be sent.
    Now(FromDevice),
    /// The device has not carried out the command yet; [`Session::commanded`] will return the answer. Until that call the caller
    /// must pass no other request.
    Later,
    /// The payload has no request number, so there is no answer. The caller counts the frame as an error.
    Unreadable,
}

impl Session {
    /// A session with the settings that the device started with. `saved` says whether they are those in flash.
    #[must_use]
    pub fn new(settings: DeviceSettings, saved: bool) -> Self {
        Self {
            settings,
            beside: BesideSettings::default(),
            unsaved: !saved,
            waiting: None,
        }
    }

    /// The settings in use.
    #[must_use]
    pub const fn settings(&self) -> &DeviceSettings {
        &self.settings
    }

    /// Answers the payload of a frame whose CRC was right. A payload that is not a request of this version is answered with
    /// [`Refusal::NotUnderstood`] and its first byte as request number.
    #[inline(never)]
    pub fn answer_payload(
        &mut self,
        payload: &[u8],
        decode_errors: u32,
        device: &mut impl Backend,
    ) -> Answered {
        let message: Option<ToDevice<'_>> = frame::message(payload);
        match (&message, payload.first()) {
            (
                Some(ToDevice {
                    id,
                    request: Request::Command(command),
                }),
                _,
            ) => {
                self.waiting = Some((*id, *command));
                let known = device.command(*command);
                known.map_or(Answered::Later, |accepted| self.commanded(accepted, device))
            }
            (Some(ToDevice { id, request }), _) => Answered::Now(FromDevice::Answer {
                id: *id,
                answer: self.answer(request, decode_errors, device),
            }),
            (None, Some(&id)) => Answered::Now(FromDevice::Answer {
                id,
                answer: Err(Refusal::NotUnderstood),
            }),
            (None, None) => Answered::Unreadable,
        }
    }

    /// Returns the answer to the command that waits for the device, after the device has accepted or refused the command. Returns
    /// [`Answered::Unreadable`] if no command waits.
    #[inline(never)]
    pub fn commanded(&mut self, accepted: bool, device: &impl Backend) -> Answered {
        let Some((id, command)) = self.waiting.take() else {
            return Answered::Unreadable;
        };
        let phase = device.phase();
        let answer = if accepted || is_so(command, phase) {
            Ok(Reply::Done)
        } else {
            Err(Refusal::NotNow(phase))
        };
        Answered::Now(FromDevice::Answer { id, answer })
    }

    /// Answers a request other than a command.
    ///
    /// # Errors
    /// The reason for a refusal. A refused request changes nothing.
    // Never inlined into its caller, to save stack: see the comment below.
    #[inline(never)]
    pub fn answer(
        &mut self,
        request: &Request<'_>,
        decode_errors: u32,
        device: &mut impl Backend,
    ) -> Result<Reply, Refusal> {
        match request {
            Request::Set { .. }
            | Request::SetAll(_)
            | Request::Defaults
            | Request::Save
            | Request::Telemetry { .. } => self.act(request, device).map(|()| Reply::Done),
            _ => self.answer_beside(request, decode_errors, device),
        }
    }

    // The following functions are never inlined. So a device with a few kilobytes of stack has only one copy of the settings on it,
    // and no reply while a request is carried out.

    /// Answers the requests that only read data.
    #[inline(never)]
    fn tell(
        &self,
        request: &Request<'_>,
        decode_errors: u32,
        device: &impl Backend,
    ) -> Result<Reply, Refusal> {
        match request {
            Request::Hello => Ok(Reply::Identity(device.identity())),
            Request::Status => Ok(Reply::Status(Status {
                phase: device.phase(),
                fault: device.fault(),
                tick: device.tick(),
                unsaved: self.unsaved,
            })),
            Request::Get { path } => {
                let mut buffer = [0; VALUE_MAX];
                let value = self.settings.get(path, &mut buffer).map_err(Refusal::Key)?;
                Ok(Reply::Value(value.try_into().unwrap_or_default()))
            }
            Request::GetAll => Ok(Reply::Settings(self.settings.clone())),
            Request::Fault => Ok(Reply::Fault(device.fault())),
            Request::Ring { first } => match device.ring(*first) {
                Some(chunk) => Ok(Reply::Ring(chunk)),
                None => Err(Refusal::RingRuns),
            },
            Request::Counters => Ok(Reply::Counters(Counters {
                decode_errors,
                ..device.counters()
            })),
            _ => self.tell_beside(request, device),
        }
    }

    /// Carries out the requests that change settings, save them or start telemetry.
    #[inline(never)]
    fn act(&mut self, request: &Request<'_>, device: &mut impl Backend) -> Result<(), Refusal> {
        match request {
            Request::Set { path, value } => self.set(path, value, device),
            Request::SetAll(settings) => self.change(settings, device),
            Request::Defaults => self.defaults(device),
            Request::Save => self.save(device),
            Request::Telemetry { decimation } => {
                device.telemetry(*decimation);
                Ok(())
            }
            _ => Err(Refusal::NotUnderstood),
        }
    }

    #[inline(never)]
    fn set(&mut self, path: &str, value: &[u8], device: &mut impl Backend) -> Result<(), Refusal> {
        let mut changed = self.settings.clone();
        changed.set(path, value).map_err(Refusal::Key)?;
        self.change(&changed, device)
    }

    #[inline(never)]
    fn defaults(&mut self, device: &mut impl Backend) -> Result<(), Refusal> {
        self.change(&DeviceSettings::defaults(device.identity().board), device)
    }

    /// Changes the settings. Refused while calibrating or armed, the states in which outputs depend on the settings.
    #[inline(never)]
    fn change(
        &mut self,
        settings: &DeviceSettings,
        device: &mut impl Backend,
    ) -> Result<(), Refusal> {
        match device.phase() {
            Phase::Boot | Phase::Ready | Phase::Stopped | Phase::Fault => {}
            phase @ (Phase::Calibrating | Phase::Armed) => return Err(Refusal::NotNow(phase)),
        }
        let refused = |error: SettingsError| Refusal::Invalid(error.into());
        device.check(settings).map_err(refused)?;
        self.beside.check(settings).map_err(refused)?;
        if *settings != self.settings {
            self.unsaved = true;
            self.settings.clone_from(settings);
        }
        device.use_settings(&self.settings);
        self.give_beside(device);
        Ok(())
    }

    /// Writes the settings into flash. Refused while calibrating or armed. Also refused in `Ready`, where a command to arm may
    /// come: erasing a flash page stalls the processor for longer than such a command takes.
    #[inline(never)]
    fn save(&mut self, device: &mut impl Backend) -> Result<(), Refusal> {
        match device.phase() {
            Phase::Boot | Phase::Stopped | Phase::Fault => {}
            phase @ (Phase::Ready | Phase::Calibrating | Phase::Armed) => {
                return Err(Refusal::NotNow(phase));
            }
        }
        let mut buffer = [0; stored::IMAGE_MAX];
        let image = self.beside.encode(&self.settings, &mut buffer);
        let image = image.map_err(|_| Refusal::Flash)?;
        device.save(image).map_err(|FlashError| Refusal::Flash)?;
        self.unsaved = false;
        Ok(())
    }
}

/// Whether a command that changed nothing counts as done, because the device already is in the requested state. Only for commands
/// that switch off.
const fn is_so(command: DeviceCommand, phase: Phase) -> bool {
    match command {
        DeviceCommand::Stop => matches!(phase, Phase::Stopped),
        DeviceCommand::Disarm => matches!(phase, Phase::Ready | Phase::Stopped | Phase::Boot),
        _ => false,
    }
}
