//! Force Dimension's omega.3, through the maker's library.
//!
//! The program does not change the device's own safety functions: velocity limit, watchdog, time guard and gravity compensation. It
//! calls no function with which the library moves the arm. Each step of a release (force to zero, motors off, close) is tried at
//! most twice and then reported as failed. Then only the device's watchdog can switch the motors off.
//!
//! Every function here makes a bounded number of library calls. A library call itself has no deadline: the servo loop checks the
//! lateness after the call has returned, and after a call that never returns only the device's watchdog can switch the motors off.

use crate::haptic::{
    Applied, DataSheet, DeviceStanding, HapticDevice, HapticFault, Sensed, SwitchOff, Workspace,
};
use std::sync::Arc;
use std::time::Duration;
use touchstone_dhd::{Dhd, DhdError, DhdOutcome, DhdStatus, OMEGA3_TYPES};
use touchstone_world::plant::{OMEGA3, OMEGA3_AXIS};

/// An omega.3 that this program has opened.
#[derive(Debug)]
pub struct Omega3 {
    library: Arc<Dhd>,
    id: Option<i8>,
    sheet: DataSheet,
}

/// Time from reading the position over USB until the written force acts, s. It is assumed as one USB microframe (125 us) each for
/// reading and writing, and not measured.
const DELAY_S: f64 = 250e-6;
/// Number of attempts for each step of a release. More attempts would take longer than two control intervals of the device.
const RELEASE_TRIES: usize = 2;
/// Number of checks whether the motors are on, after they were switched on. `ENGAGE_PAUSE` is the time between two checks.
const ENGAGE_ASKS: usize = 50;
const ENGAGE_PAUSE: Duration = Duration::from_millis(2);

impl From<DhdError> for HapticFault {
    fn from(error: DhdError) -> Self {
        match error.number {
            DhdError::IN_USE => Self::HeldElsewhere,
            _ => Self::Lost(error.call, error.to_string()),
        }
    }
}

fn unusable(why: impl Into<String>, fix: impl Into<String>) -> HapticFault {
    HapticFault::Unusable(why.into(), fix.into())
}

impl Omega3 {
    /// Opens the first omega.3 that no other program uses. Its motors stay off.
    ///
    /// # Errors
    /// No device is found, or the device is in use, of another type, without supply or not calibrated.
    pub fn open(library: Arc<Dhd>) -> Result<Self, HapticFault> {
        match library.count()? {
            (0, _) => {
                return Err(unusable(
                    "no device found on USB",
                    "connect it, switch its supply on, and permit its use: docs/devices.md#permission",
                ));
            }
            (_, 0) => return Err(HapticFault::HeldElsewhere),
            _ => {}
        }
        let id = library.open(0)?;
        // From here on `Drop` closes the device after any error.
        let mut omega = Self {
            library,
            id: Some(id),
            sheet: DataSheet {
                name: String::new(),
                degrees: 3,
                force_n: OMEGA3.force_n,
                workspace: Workspace {
                    radius_m: OMEGA3.radius_m,
                    half_height_m: OMEGA3.half_height_m,
                },
                count_m: OMEGA3.count_m,
                rates_hz: OMEGA3.rates_hz,
                delay_s: DELAY_S,
                axes: Some([OMEGA3_AXIS; 3]),
                least_damping_n_s_per_m: Some(OMEGA3_AXIS.damping),
                sets_the_pace: false,
            },
        };
        omega.examine(id)?;
        Ok(omega)
    }

    fn examine(&mut self, id: i8) -> Result<(), HapticFault> {
        let model = self.library.model(id)?;
        if !OMEGA3_TYPES.contains(&model.number) {
            return Err(unusable(
                format!("{model} (type {}) is not an omega.3", model.number),
                "this program does not know its limits: docs/devices.md#other-devices-of-the-maker",
            ));
        }
        self.sheet.name = touchstone_sim::harmless::one_line(&model.to_string());
        let status = self.library.status(id)?;
        if status.power() == Some(false) {
            return Err(unusable(format!("{model} has no supply"), "switch it on"));
        }
        if status.reset() == Some(true) {
            return Err(unusable(
                format!("{model} is not calibrated"),
                "move its arm to its rest position and calibrate it with the maker's HapticInit",
            ));
        }
        match self.library.set_max_force(self.sheet.force_n, id) {
            // This force limit is in addition to that of the servo loop. A library without this function is accepted.
            Err(error) if error.number != DhdError::NOT_IN_LIBRARY => Err(error.into()),
            _ => Ok(()),
        }
    }

    /// The number under which the library knows the open device.
    ///
    /// # Errors
    /// The device was released.
    fn id(&self) -> Result<i8, HapticFault> {
        self.id
            .ok_or_else(|| unusable("it was released", "open it again"))
    }

    /// The maker's library and the number under which it knows the device, for calls beyond those of [`HapticDevice`].
    ///
    /// # Errors
    /// The device was released.
    pub fn library(&self) -> Result<(&Dhd, i8), HapticFault> {
        Ok((&self.library, self.id()?))
    }
}

fn cause(status: &DhdStatus) -> Option<SwitchOff> {
    Some(match status.off_cause()? {
        0 => return None,
        1 => SwitchOff::Button,
        2 => SwitchOff::Velocity,
        3 => SwitchOff::Watchdog,
        4 => SwitchOff::Software,
        5 => SwitchOff::Usb,
        6 => SwitchOff::DeadMan,
        other => SwitchOff::Other(other),
    })
}

impl HapticDevice for Omega3 {
    fn sheet(&self) -> &DataSheet {
        &self.sheet
    }

    fn engage(&mut self) -> Result<(), HapticFault> {
        let id = self.id()?;
        self.library.set_force([0.0; 3], id)?;
        self.library.enable_force(true, id)?;
        for _ in 0..ENGAGE_ASKS {
            // If the library does not say whether the motors are on, they count as on.
            if self.library.status(id)?.force() != Some(false) {
                return Ok(());
            }
            std::thread::sleep(ENGAGE_PAUSE);
        }
        Err(unusable(
            "its motors cannot be switched on",
            "press its force button if it has one",
        ))
    }

    fn sense(&mut self) -> Result<Sensed, HapticFault> {
        let (position_m, outcome) = self.library.position(self.id()?)?;
        Ok(Sensed {
            position_m,
            fresh: outcome != DhdOutcome::NotReadAgain,
        })
    }

    fn command(&mut self, force_n: [f64; 3]) -> Result<Applied, HapticFault> {
        let id = self.id()?;
        Ok(match self.library.set_force(force_n, id)? {
            DhdOutcome::Saturated => Applied::Saturated(self.library.force(id)),
            DhdOutcome::Done | DhdOutcome::NotReadAgain | DhdOutcome::Other(_) => Applied::Whole,
        })
    }

    fn standing(&mut self) -> Result<DeviceStanding, HapticFault> {
        let status = self.library.status(self.id()?)?;
        let motors_on = status.force().unwrap_or(true);
        Ok(DeviceStanding {
            powered: status.power().unwrap_or(true),
            calibrated: !status.reset().unwrap_or(false),
            motors_on,
            // While the motors are on, the reported cause is that of an earlier switch-off.
            switched_off: cause(&status).filter(|_| !motors_on),
        })
    }

    fn release(&mut self) -> Result<(), HapticFault> {
        let Some(id) = self.id.take() else {
            return Ok(());
        };
        let library = &self.library;
        let tried = |part: &dyn Fn() -> Result<DhdOutcome, DhdError>| {
            let mut done = part();
            for _ in 1..RELEASE_TRIES {
                if done.is_err() {
                    done = part();
                }
            }
            done
        };
        // All steps are done, even if an earlier one failed.
        let done = [
            tried(&|| library.set_force([0.0; 3], id)),
            tried(&|| library.stop(id)),
            tried(&|| library.close(id)),
        ];
        done.into_iter().collect::<Result<Vec<_>, _>>()?;
        Ok(())
    }
}

impl Drop for Omega3 {
    fn drop(&mut self) {
        // The result is ignored: a caller that needs it has released the device before.
        let _ = self.release();
    }
}
