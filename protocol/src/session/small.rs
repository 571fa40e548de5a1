//! A session of chips without room for data beside the settings. `large.rs` has the same functions for larger chips.

use super::{Backend, Session};
use crate::reply::{Refusal, Reply};
use crate::request::Request;
use crate::settings::{DeviceSettings, SettingsError};
use crate::stored;

/// The functions of a device that a session calls only on larger chips: none here.
pub trait LargeBackend {}

impl<T> LargeBackend for T {}

/// The data that a session has beside the settings: none.
#[derive(Debug, Clone, Default)]
pub(super) struct BesideSettings;

impl BesideSettings {
    /// Finds nothing to check.
    pub(super) const fn check(&self, _settings: &DeviceSettings) -> Result<(), SettingsError> {
        Ok(())
    }

    /// Encodes the image of the settings for the flash.
    pub(super) fn encode<'b>(
        &self,
        settings: &DeviceSettings,
        buffer: &'b mut [u8],
    ) -> Result<&'b [u8], postcard::Error> {
        stored::encode(settings, buffer)
    }
}

impl Session {
    /// Passes on every request, as none concerns data beside the settings.
    pub(super) fn answer_beside(
        &mut self,
        request: &Request<'_>,
        decode_errors: u32,
        device: &mut impl Backend,
    ) -> Result<Reply, Refusal> {
        self.tell(request, decode_errors, device)
    }

    /// Refuses the requests that [`Session::tell`] does not answer.
    pub(super) const fn tell_beside(
        &self,
        _request: &Request<'_>,
        _device: &impl Backend,
    ) -> Result<Reply, Refusal> {
        Err(Refusal::NotUnderstood)
    }

    /// Has nothing to hand over.
    pub(super) const fn give_beside(&self, _device: &mut impl Backend) {}
}
