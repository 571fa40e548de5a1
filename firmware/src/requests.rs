//! The main thread's part of the device: carries out the requests of a protocol session.

use core::sync::atomic::Ordering::Relaxed;

use touchstone_drive::config::Config;
use touchstone_drive::{CompactRecord, wire};
use touchstone_protocol::session::{Backend, FlashError, Session};
use touchstone_protocol::settings::{DeviceSettings, SettingsError};
use touchstone_protocol::{
    Command, Counters, DeviceCommand, Fault, FaultCode, Identity, PROTOCOL_VERSION, Phase,
    ResetReason, RingChunk, State, flash, stored,
};

use crate::control::{RING, control};
use crate::exchange::CURRENT_CYCLES_MAX;
use crate::shared::InThread;
use crate::storage::{self, Storage};
use crate::{analogue, board, pwm};

/// Access to the device from the main thread, which runs beside the control interrupt.
pub struct Thread {
    /// The flash pages in which the settings are stored.
    storage: Storage,
    /// Why the processor started.
    reset_reason: ResetReason,
    here: InThread,
    /// Whether the protocol session has new settings that the control interrupt does not have yet.
    new_settings: bool,
}

impl Thread {
    /// Makes the main thread's access to the device, at the start.
    pub const fn new(storage: Storage, reset_reason: ResetReason, here: InThread) -> Self {
        Self {
            storage,
            reset_reason,
            here,
            new_settings: false,
        }
    }

    /// The token that proves that the code runs in the main thread and in no interrupt.
    pub const fn here(&self) -> InThread {
        self.here
    }

    /// Whether the protocol session has new settings that the control interrupt does not have yet.
    pub fn has_new_settings(&self) -> bool {
        self.new_settings
    }

    /// Computes the coefficients of the settings and hands them to the control interrupt. The main thread computes them, because
    /// its run time is not critical. It does so after the answer was sent, when the stack no longer holds the answer.
    #[inline(never)]
    pub fn apply(&mut self, session: &Session) {
        self.new_settings = false;
        let settings = session.settings();
        match Config::new(settings, &board::HARDWARE) {
            Ok(config) => {
                control(self.here, |control| {
                    control.prepare(settings, config);
                    #[cfg(feature = "g474re")]
                    crate::autostart::give(control, session);
                });
                // The environment was checked together with these settings.
                #[cfg(feature = "g474re")]
                let _ = crate::surround::give(self.here, settings, session.environment());
                #[cfg(feature = "g474re")]
                crate::surround::play(self.here, settings, session.cogging(board::BOARD));
            }
            // The settings were checked before, so this does not happen.
            Err(_) => {
                control(self.here, |control| {
                    control.device.report_fault(FaultCode::SettingsInvalid, 0)
                });
            }
        }
    }

    /// Hands a command to the next control period; [`Self::accepted`] then has its result.
    fn give(&mut self, command: Command) {
        control(self.here, |control| {
            control.accepted = None;
            control.command = Some(command);
        });
    }

    /// Whether the last command had an effect; `None` until a control period has handled it.
    pub fn accepted(&self) -> Option<bool> {
        control(self.here, |control| control.accepted.take()).flatten()
    }

    /// Withdraws a command that no control period handled in time, so that no later control period carries it out.
    pub fn withdraw(&self) {
        control(self.here, |control| control.command = None);
    }
}

impl Backend for Thread {
    fn identity(&self) -> Identity {
        Identity {
            protocol_version: PROTOCOL_VERSION,
            settings_version: stored::LAYOUT_VERSION,
            firmware_version: env!("CARGO_PKG_VERSION").try_into().unwrap_or_default(),
            board: board::BOARD,
            unique_id: embassy_stm32::uid::uid(),
            reset_reason: self.reset_reason,
            build_hash: BUILD_HASH,
        }
    }

    fn phase(&self) -> Phase {
        control(self.here, |control| Phase::from(control.state)).unwrap_or(Phase::Boot)
    }

    fn fault(&self) -> Option<Fault> {
        control(self.here, |control| match control.state {
            State::Fault(context) => Some(Fault::from(context)),
            _ => None,
        })
        .flatten()
    }

    fn tick(&self) -> u32 {
        control(self.here, |control| control.tick).unwrap_or(0)
    }

    fn counters(&self) -> Counters {
        let counters = control(self.here, |control| Counters {
            decode_errors: 0,
            telemetry_dropped: control.dropped,
            ticks: control.tick,
            tick_cycles_max: control.cycles_max,
            lateness_cycles_max: control.lateness_max,
            current_loop_cycles_max: CURRENT_CYCLES_MAX.load(Relaxed),
        });
        counters.unwrap_or_default()
    }

    fn ring(&self, first: u16) -> Option<RingChunk> {
        RING.in_thread(self.here, |ring| {
            ring.is_frozen().then(|| {
                let mut chunk = RingChunk {
                    first,
                    total: ring.len() as u16,
                    records: heapless::Vec::new(),
                };
                for index in usize::from(first).. {
                    let Some(bytes) = ring.get(index) else { break };
                    if chunk
                        .records
                        .push(CompactRecord::from_bytes(bytes).into())
                        .is_err()
                    {
                        break;
                    }
                }
                chunk
            })
        })
    }

    fn check(&self, settings: &DeviceSettings) -> Result<(), SettingsError> {
        wire::checked(settings, board::BOARD)
    }

    fn use_settings(&mut self, _settings: &DeviceSettings) {
        self.new_settings = true;
    }

    fn save(&mut self, image: &[u8]) -> Result<(), FlashError> {
        flash::save(&mut self.storage, storage::pages(), image)
    }

    fn command(&mut self, command: DeviceCommand) -> Option<bool> {
        let command = match command {
            DeviceCommand::Calibrate => Command::Calibrate,
            DeviceCommand::Arm => Command::Arm,
            DeviceCommand::Disarm => Command::Disarm,
            DeviceCommand::Stop => Command::Stop,
            DeviceCommand::Zero => return control(self.here, |control| control.device.zero_here()),
            DeviceCommand::Reboot => {
                pwm::outputs_off();
                analogue::off();
                cortex_m::peripheral::SCB::sys_reset()
            }
        };
        self.give(command);
        None
    }

    fn telemetry(&mut self, decimation: u16) {
        control(self.here, |control| control.decimation = decimation);
    }
}

#[cfg(feature = "g474re")]
impl touchstone_protocol::session::LargeBackend for Thread {
    fn use_environment(
        &mut self,
        settings: &DeviceSettings,
        environment: &touchstone_protocol::Surround,
    ) -> Option<Result<touchstone_protocol::CountsFrom, SettingsError>> {
        crate::surround::give(self.here, settings, environment).transpose()
    }

    fn use_kept(&mut self, kept: Option<touchstone_protocol::KeptAlignment>) {
        // If new settings wait, `apply` hands the alignment over together with them.
        if !self.new_settings {
            control(self.here, |control| {
                control.device.keep(kept.map(Into::into))
            });
        }
    }

    fn use_cogging(
        &mut self,
        settings: &DeviceSettings,
        map: Option<&touchstone_protocol::CoggingMap>,
    ) {
        // If new settings wait, `apply` hands the cogging map over together with them.
        if !self.new_settings {
            crate::surround::play(self.here, settings, map);
        }
    }

    fn sweep(&mut self, sweep: touchstone_protocol::Sweep) {
        control(self.here, |control| control.device.sweep(sweep));
    }

    fn alignment(&self) -> Option<(u16, bool)> {
        let found = control(self.here, |control| control.device.found()).flatten();
        found
            .filter(|_| !self.new_settings)
            .map(|found| (found.offset.0, found.against))
    }

    fn started(&self) -> (bool, touchstone_protocol::SelfStart) {
        let started = control(self.here, |control| {
            (control.device.was_checked(), control.autostart.told())
        });
        started.unwrap_or_default()
    }
}

/// Hash of the program's source files, calculated by `build.rs`.
const BUILD_HASH: u64 = match u64::from_str_radix(env!("TOUCHSTONE_BUILD_HASH"), 16) {
    Ok(hash) => hash,
    Err(_) => 0,
};
