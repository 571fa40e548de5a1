//! The device's side of the protocol: how a request changes the settings, and which requests are passed on.
//!
//! The firmware and the fake device of the tests run the same code; only [`Backend`] differs.

use crate::frame;
use crate::reply::{Counters, FromDevice, Identity, Refusal, Reply, Status};
use crate::request::{DeviceCommand, Request, ToDevice};
#[cfg(feature = "large")]
use crate::settings::cogging::{CoggingMap, CoggingReport, KeptCogging, Sweep};
#[cfg(feature = "large")]
use crate::settings::environment::{CountsFrom, Surround};
#[cfg(feature = "large")]
use crate::settings::kept::{KeptAlignment, KeptStart, SelfStart, StartReport};
use crate::settings::{DeviceSettings, SettingsError, VALUE_MAX};
use crate::stored;
use crate::telemetry::{Fault, Phase, RingChunk};

/// The interface that a session needs from the device.
pub trait Backend {
    /// The identity of the device.
    fn identity(&self) -> Identity;
    /// State of the fault machine.
    fn phase(&self) -> Phase;
    /// The latched fault.
    fn fault(&self) -> Option<Fault>;
    /// Control ticks since the reset, modulo 2^32.
    fn tick(&self) -> u32;
    /// All counters except those of decoding errors.
    fn counters(&self) -> Counters;
    /// The ring from a record on; `None` while it runs.
    fn ring(&self, first: u16) -> Option<RingChunk>;
    /// Whether settings may be used here.
    ///
    /// # Errors
    /// The first setting that is refused.
    fn check(&self, settings: &DeviceSettings) -> Result<(), SettingsError>;
    /// Takes settings that were checked; they count from the next calibration.
    fn use_settings(&mut self, settings: &DeviceSettings);
    /// Writes an image of settings into flash.
    ///
    /// # Errors
    /// The flash refused; the settings stored before are still there.
    fn save(&mut self, image: &[u8]) -> Result<(), FlashError>;
    /// Carries out a command; returns whether it had an effect. `None`: [`Session::commanded`] will be told later.
    fn command(&mut self, command: DeviceCommand) -> Option<bool>;
    /// Starts telemetry, one record every given number of control ticks; 0 stops it.
    fn telemetry(&mut self, decimation: u16);
    /// Takes a new environment beside the wall of these settings. Returns from when on it is active, or the setting
    /// that is refused. `None`: this device has no room for environments.
    #[cfg(feature = "large")]
    fn use_environment(
        &mut self,
        _settings: &DeviceSettings,
        _environment: &Surround,
    ) -> Option<Result<CountsFrom, SettingsError>> {
        None
    }
    /// Takes the alignment that the next calibration is to check instead of looking for one; `None`: it is to look for one.
    #[cfg(feature = "large")]
    fn use_kept(&mut self, _kept: Option<KeptAlignment>) {}
    /// The alignment in use at the encoder's own zero, and its direction; `None` where none was found with the settings in use.
    #[cfg(feature = "large")]
    fn alignment(&self) -> Option<(u16, bool)> {
        None
    }
    /// Whether a kept alignment was used, and how the unattended start went.
    #[cfg(feature = "large")]
    fn started(&self) -> (bool, SelfStart) {
        (false, SelfStart::Off)
    }
    /// Takes the cogging map that is played from now on; `None`: no map.
    #[cfg(feature = "large")]
    fn use_cogging(&mut self, _settings: &DeviceSettings, _map: Option<&CoggingMap>) {}
    /// The measurement that the next calibration goes on with.
    #[cfg(feature = "large")]
    fn sweep(&mut self, _sweep: Sweep) {}
}

/// The flash could not be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FlashError;

/// The settings in use, and whether they are stored.
#[derive(Debug, Clone)]
pub struct Session {
    settings: DeviceSettings,
    #[cfg(feature = "large")]
    environment: Surround,
    #[cfg(feature = "large")]
    kept: KeptStart,
    #[cfg(feature = "large")]
    cogging: Option<KeptCogging>,
    unsaved: bool,
    /// A command whose result is not known yet, and the request's number.
    waiting: Option<(u8, DeviceCommand)>,
}

/// What becomes of a payload.
// One message is held at a time.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answered {
    /// The answer is ready.
    Now(FromDevice),
    /// The device has yet to carry out a command; [`Session::commanded`] will have the answer. No other request is
    /// taken meanwhile.
    Later,
    /// An unreadable frame is counted and not answered.
    Unreadable,
}

#[cfg(feature = "large")]
mod keeping;

impl Session {
    /// A session with the settings of the start; `saved` if they are those in flash.
    #[must_use]
    pub fn new(settings: DeviceSettings, saved: bool) -> Self {
        Self {
            settings,
            #[cfg(feature = "large")]
            environment: Surround::default(),
            #[cfg(feature = "large")]
            kept: KeptStart::default(),
            #[cfg(feature = "large")]
            cogging: None,
            unsaved: !saved,
            waiting: None,
        }
    }

    /// The session with the environment that the device started with.
    #[cfg(feature = "large")]
    #[must_use]
    pub const fn with_environment(mut self, environment: Surround) -> Self {
        self.environment = environment;
        self
    }

    /// The session with what is kept for the start.
    #[cfg(feature = "large")]
    #[must_use]
    pub const fn with_kept(mut self, kept: KeptStart) -> Self {
        self.kept = kept;
        self
    }

    /// The session with the cogging map that the device started with.
    #[cfg(feature = "large")]
    #[must_use]
    pub fn with_cogging(mut self, cogging: Option<KeptCogging>) -> Self {
        self.cogging = cogging;
        self
    }

    /// The map of the cogging that is kept, whether or not it may be played.
    #[cfg(feature = "large")]
    #[must_use]
    pub const fn kept_cogging(&self) -> Option<&KeptCogging> {
        self.cogging.as_ref()
    }

    /// The map of the cogging that may be played with the settings in use.
    #[cfg(feature = "large")]
    #[must_use]
    pub fn cogging(&self, board: crate::Board) -> Option<&CoggingMap> {
        self.cogging.as_ref()?.usable(&self.settings, board).ok()
    }

    /// The data that are kept for the next start.
    #[cfg(feature = "large")]
    #[must_use]
    pub const fn kept(&self) -> &KeptStart {
        &self.kept
    }

    /// What there is to touch.
    #[cfg(feature = "large")]
    #[must_use]
    pub const fn environment(&self) -> &Surround {
        &self.environment
    }

    /// The settings in use.
    #[must_use]
    pub const fn settings(&self) -> &DeviceSettings {
        &self.settings
    }

    /// Answers a whole frame's payload. A payload that is no request of this version is answered where its number can be
    /// read, as the frame was whole.
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

    /// What became of a command that was waited for: its answer.
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
    /// The reason for a refusal; nothing is changed then.
    // Not a part of its caller: see below.
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
            #[cfg(feature = "large")]
            Request::SetEnvironment(environment) => {
                self.surround(environment, device).map(Reply::Taken)
            }
            #[cfg(feature = "large")]
            Request::KeepAlignment | Request::ForgetAlignment | Request::Autostart(_) => {
                self.keep(request, device).map(|()| Reply::Done)
            }
            #[cfg(feature = "large")]
            Request::KeepCogging(_) | Request::ForgetCogging | Request::Sweep(_) => {
                self.keep_cogging(request, device).map(|()| Reply::Done)
            }
            _ => self.tell(request, decode_errors, device),
        }
    }

    // The following are functions of their own so that a device with a few kilobytes of stack has no more on it than it needs:
    // one copy of the settings, and no reply while a request is carried out.

    /// Carries out the requests that have parameters.
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
            #[cfg(feature = "large")]
            Request::Environment => Ok(Reply::Environment(self.environment)),
            #[cfg(feature = "large")]
            Request::Start => {
                let (was_checked, self_start) = device.started();
                Ok(Reply::Start(StartReport {
                    kept: self.kept,
                    was_checked,
                    self_start,
                }))
            }
            #[cfg(feature = "large")]
            Request::Cogging => Ok(Reply::Cogging(CoggingReport {
                kept: self.cogging.clone(),
                against: device.alignment().map(|(_, against)| against),
            })),
            #[cfg(feature = "large")]
            Request::KeepCogging(_)
            | Request::ForgetCogging
            | Request::Sweep(_)
            | Request::SetEnvironment(_)
            | Request::KeepAlignment
            | Request::ForgetAlignment
            | Request::Autostart(_) => Err(Refusal::NotUnderstood),
            // Nothing to tell: `act` has these.
            Request::Set { .. }
            | Request::SetAll(_)
            | Request::Defaults
            | Request::Save
            | Request::Command(_)
            | Request::Telemetry { .. } => Err(Refusal::NotUnderstood),
        }
    }

    /// The requests that do something.
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

    /// Takes settings, in the states in which no output depends on them.
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
        #[cfg(feature = "large")]
        self.environment.check(settings).map_err(refused)?;
        if *settings != self.settings {
            self.unsaved = true;
            self.settings.clone_from(settings);
        }
        device.use_settings(&self.settings);
        #[cfg(feature = "large")]
        {
            self.give_kept(device);
            device.use_cogging(&self.settings, self.cogging(device.identity().board));
        }
        Ok(())
    }

    /// Writes the settings. Not in `Ready`: the erase of a page stalls the processor for longer than a command to arm takes.
    #[inline(never)]
    fn save(&mut self, device: &mut impl Backend) -> Result<(), Refusal> {
        match device.phase() {
            Phase::Boot | Phase::Stopped | Phase::Fault => {}
            phase @ (Phase::Ready | Phase::Calibrating | Phase::Armed) => {
                return Err(Refusal::NotNow(phase));
            }
        }
        let mut buffer = [0; stored::IMAGE_MAX];
        #[cfg(not(feature = "large"))]
        let image = stored::encode(&self.settings, &mut buffer);
        #[cfg(feature = "large")]
        let image = stored::encode_with(
            &self.settings,
            &self.environment,
            &self.kept,
            self.cogging.as_ref(),
            &mut buffer,
        );
        let image = image.map_err(|_| Refusal::Flash)?;
        device.save(image).map_err(|FlashError| Refusal::Flash)?;
        self.unsaved = false;
        Ok(())
    }
}
/// Whether a command without an effect counts as done because the state is already the wanted one. Only for commands
/// that switch off: they are confirmed.
const fn is_so(command: DeviceCommand, phase: Phase) -> bool {
    match command {
        DeviceCommand::Stop => matches!(phase, Phase::Stopped),
        DeviceCommand::Disarm => matches!(phase, Phase::Ready | Phase::Stopped | Phase::Boot),
        _ => false,
    }
}
