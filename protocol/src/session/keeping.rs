//! What boards with enough flash store beside the settings: the environment (walls, end stops, detents), the encoder's alignment,
//! whether the board starts automatically, and the cogging map.

use super::Session;
use crate::reply::Refusal;
use crate::request::Request;
use crate::session::Backend;
use crate::settings::cogging::KeptCogging;
use crate::settings::environment::{CountsFrom, Surround};
use crate::settings::kept::{self, KeptAlignment, KeptStart, MeasuredWith, Unkept};
use crate::telemetry::Phase;

impl Session {
    /// Stores or discards the map of the motor's cogging torque, or has the next calibration turn the shaft slowly to measure it.
    /// Not while calibrating or armed.
    #[inline(never)]
    pub(super) fn keep_cogging(
        &mut self,
        request: &Request<'_>,
        device: &mut impl Backend,
    ) -> Result<(), Refusal> {
        match (device.phase(), request) {
            (phase @ (Phase::Calibrating | Phase::Armed), _) => return Err(Refusal::NotNow(phase)),
            (_, Request::Sweep(sweep)) => {
                kept::may_keep(&self.settings).map_err(Refusal::Unkept)?;
                device.sweep(*sweep);
                return Ok(());
            }
            (Phase::Ready, Request::KeepCogging(map)) => {
                kept::may_keep(&self.settings).map_err(Refusal::Unkept)?;
                if device.alignment().is_none() {
                    return Err(Refusal::Unkept(Unkept::SettingsWait));
                }
                let board = device.identity().board;
                self.beside.cogging = Some(KeptCogging {
                    with: MeasuredWith::new(&self.settings, board),
                    map: map.clone(),
                });
            }
            (phase, Request::KeepCogging(_)) => return Err(Refusal::NotNow(phase)),
            _ => self.beside.cogging = None,
        }
        self.unsaved = true;
        device.use_cogging(&self.settings, self.cogging(device.identity().board));
        Ok(())
    }

    /// Hands the stored encoder alignment to the device for the next calibration, if it was measured with the hardware that the
    /// present settings describe.
    pub(super) fn give_kept(&self, device: &mut impl Backend) {
        let usable = self
            .beside
            .kept
            .usable(&self.settings, device.identity().board);
        device.use_kept(usable.ok());
    }

    /// Stores or discards the encoder's alignment, or switches the automatic start on or off.
    #[inline(never)]
    pub(super) fn keep(
        &mut self,
        request: &Request<'_>,
        device: &mut impl Backend,
    ) -> Result<(), Refusal> {
        let board = device.identity().board;
        let kept = match request {
            Request::KeepAlignment => {
                let phase = device.phase();
                if phase != Phase::Ready {
                    return Err(Refusal::NotNow(phase));
                }
                kept::may_keep(&self.settings).map_err(Refusal::Unkept)?;
                let (offset, against) = device
                    .alignment()
                    .ok_or(Refusal::Unkept(Unkept::SettingsWait))?;
                let alignment = KeptAlignment::new(offset, against, &self.settings, board);
                KeptStart {
                    alignment: Some(alignment),
                    ..self.beside.kept
                }
            }
            Request::Autostart(autostart) => {
                if *autostart {
                    let usable = self.beside.kept.usable(&self.settings, board);
                    usable.map_err(Refusal::Unkept)?;
                }
                KeptStart {
                    autostart: *autostart,
                    ..self.beside.kept
                }
            }
            _ => KeptStart {
                alignment: None,
                ..self.beside.kept
            },
        };
        self.unsaved |= self.beside.kept != kept;
        self.beside.kept = kept;
        self.give_kept(device);
        Ok(())
    }

    /// Replaces the environment (walls, end stops, detents). Allowed in every state but the calibration, which itself turns the
    /// shaft.
    #[inline(never)]
    pub(super) fn surround(
        &mut self,
        environment: &Surround,
        device: &mut impl Backend,
    ) -> Result<CountsFrom, Refusal> {
        if let phase @ Phase::Calibrating = device.phase() {
            return Err(Refusal::NotNow(phase));
        }
        let from = device
            .use_environment(&self.settings, environment)
            .ok_or(Refusal::NotUnderstood)?
            .map_err(|error| Refusal::Invalid(error.into()))?;
        self.unsaved |= self.beside.environment != *environment;
        self.beside.environment = *environment;
        Ok(from)
    }
}
