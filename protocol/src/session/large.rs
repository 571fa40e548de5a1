//! What a session of larger chips has beside the settings: the environment (walls, end stops, detents), the data for the next start,
//! and the map of the motor's cogging torque. `small.rs` replaces this module on other chips.

use super::{Backend, Session};
use crate::reply::{Refusal, Reply};
use crate::request::Request;
use crate::settings::cogging::{CoggingMap, CoggingReport, KeptCogging, Sweep};
use crate::settings::environment::{CountsFrom, Surround};
use crate::settings::kept::{KeptAlignment, KeptStart, SelfStart, StartReport};
use crate::settings::{DeviceSettings, SettingsError};
use crate::stored;

mod keeping;

/// The functions of a device that a session calls only on larger chips. Each has a default for a device without that ability.
pub trait LargeBackend {
    /// Hands over a new environment (walls, end stops, detents) for these settings. Returns the time from which it applies, or the
    /// setting that the device refuses. `None`: this device has no room for environments.
    fn use_environment(
        &mut self,
        _settings: &DeviceSettings,
        _environment: &Surround,
    ) -> Option<Result<CountsFrom, SettingsError>> {
        None
    }
    /// Hands over the stored encoder alignment that the next calibration only checks. With `None` the calibration searches for the
    /// alignment.
    fn use_kept(&mut self, _kept: Option<KeptAlignment>) {}
    /// The encoder alignment in use: the electrical angle at the encoder's own zero (turns/65,536), and whether the angle falls
    /// when the encoder count rises. `None` if no alignment was found with the settings in use.
    fn alignment(&self) -> Option<(u16, bool)> {
        None
    }
    /// Whether the encoder alignment in use is a stored one, and how the automatic start went.
    fn started(&self) -> (bool, SelfStart) {
        (false, SelfStart::Off)
    }
    /// Hands over the map of the motor's cogging torque that the device compensates from now on; `None`: no compensation.
    fn use_cogging(&mut self, _settings: &DeviceSettings, _map: Option<&CoggingMap>) {}
    /// Hands over whether and how the next calibration turns the shaft slowly to measure the cogging torque.
    fn sweep(&mut self, _sweep: Sweep) {}
}

/// The data that a session has beside the settings.
#[derive(Debug, Clone, Default)]
pub(super) struct BesideSettings {
    environment: Surround,
    kept: KeptStart,
    cogging: Option<KeptCogging>,
}

impl BesideSettings {
    /// Checks whether these data are valid with new settings.
    pub(super) fn check(&self, settings: &DeviceSettings) -> Result<(), SettingsError> {
        self.environment.check(settings)
    }

    /// Encodes the image of the settings and of these data for the flash.
    pub(super) fn encode<'b>(
        &self,
        settings: &DeviceSettings,
        buffer: &'b mut [u8],
    ) -> Result<&'b [u8], postcard::Error> {
        let (environment, kept) = (&self.environment, &self.kept);
        stored::encode_with(settings, environment, kept, self.cogging.as_ref(), buffer)
    }
}

impl Session {
    /// Sets the environment (walls, end stops, detents) that the device started with.
    #[must_use]
    pub const fn with_environment(mut self, environment: Surround) -> Self {
        self.beside.environment = environment;
        self
    }

    /// Sets the data that are stored for the next start: the encoder's alignment and whether the board starts by itself.
    #[must_use]
    pub const fn with_kept(mut self, kept: KeptStart) -> Self {
        self.beside.kept = kept;
        self
    }

    /// Sets the map of the motor's cogging torque that the device started with.
    #[must_use]
    pub fn with_cogging(mut self, cogging: Option<KeptCogging>) -> Self {
        self.beside.cogging = cogging;
        self
    }

    /// The stored cogging map, even if it was measured with other hardware than the settings in use describe.
    #[must_use]
    pub const fn kept_cogging(&self) -> Option<&KeptCogging> {
        self.beside.cogging.as_ref()
    }

    /// The stored map of the motor's cogging torque, if it was measured with the hardware that the settings in use describe.
    #[must_use]
    pub fn cogging(&self, board: crate::Board) -> Option<&CoggingMap> {
        let kept = self.beside.cogging.as_ref()?;
        kept.usable(&self.settings, board).ok()
    }

    /// The data that are stored for the next start.
    #[must_use]
    pub const fn kept(&self) -> &KeptStart {
        &self.beside.kept
    }

    /// The environment: the walls, end stops and detents that the knob renders.
    #[must_use]
    pub const fn environment(&self) -> &Surround {
        &self.beside.environment
    }

    /// Answers the requests that concern the data beside the settings, and passes on all others.
    pub(super) fn answer_beside(
        &mut self,
        request: &Request<'_>,
        decode_errors: u32,
        device: &mut impl Backend,
    ) -> Result<Reply, Refusal> {
        match request {
            Request::SetEnvironment(environment) => {
                self.surround(environment, device).map(Reply::Taken)
            }
            Request::KeepAlignment | Request::ForgetAlignment | Request::Autostart(_) => {
                self.keep(request, device).map(|()| Reply::Done)
            }
            Request::KeepCogging(_) | Request::ForgetCogging | Request::Sweep(_) => {
                self.keep_cogging(request, device).map(|()| Reply::Done)
            }
            _ => self.tell(request, decode_errors, device),
        }
    }

    /// Answers the requests that only read the data beside the settings. Names every request, so that the compiler reports a new
    /// one that nothing answers.
    pub(super) fn tell_beside(
        &self,
        request: &Request<'_>,
        device: &impl Backend,
    ) -> Result<Reply, Refusal> {
        match request {
            Request::Environment => Ok(Reply::Environment(self.beside.environment)),
            Request::Start => {
                let (was_checked, self_start) = device.started();
                Ok(Reply::Start(StartReport {
                    kept: self.beside.kept,
                    was_checked,
                    self_start,
                }))
            }
            Request::Cogging => Ok(Reply::Cogging(CoggingReport {
                kept: self.beside.cogging.clone(),
                against: device.alignment().map(|(_, against)| against),
            })),
            // `answer_beside` carries out these requests.
            Request::KeepCogging(_)
            | Request::ForgetCogging
            | Request::Sweep(_)
            | Request::SetEnvironment(_)
            | Request::KeepAlignment
            | Request::ForgetAlignment
            | Request::Autostart(_) => Err(Refusal::NotUnderstood),
            // `tell` answers these requests.
            Request::Hello
            | Request::Status
            | Request::Get { .. }
            | Request::GetAll
            | Request::Fault
            | Request::Ring { .. }
            | Request::Counters => Err(Refusal::NotUnderstood),
            // `act` carries out these requests; they return no data.
            Request::Set { .. }
            | Request::SetAll(_)
            | Request::Defaults
            | Request::Save
            | Request::Command(_)
            | Request::Telemetry { .. } => Err(Refusal::NotUnderstood),
        }
    }

    /// Hands the stored data to the device again, after new settings.
    pub(super) fn give_beside(&self, device: &mut impl Backend) {
        self.give_kept(device);
        device.use_cogging(&self.settings, self.cogging(device.identity().board));
    }
}
