//! Force Dimension's library, `libdhd` or `libdrd`, found and loaded when the program runs.
//!
//! The library is not part of this program and cannot be: whoever has a device has it from its maker. What is here is
//! the search for it, the calls that a wall and a survey need, and what they return, as data. Positive results are
//! none of the errors: 1 says that a position was not read again, 2 that the motors give less than asked. Nothing of a call that
//! failed is believed, as such calls leave what they should have filled untouched, and a call that succeeds does not clear the last error.

mod code;
mod search;
mod symbols;

pub use code::{DhdError, DhdModel, DhdStatus, OMEGA3_TYPES, STATUS_INTS};
pub use search::{ENVIRONMENT, LibrarySearch, NotLoaded};
pub use symbols::Dhd;

/// A call of the library that did not fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DhdOutcome {
    /// 0: done.
    Done,
    /// 1: the time guard kept the last position.
    NotReadAgain,
    /// 2: the motors are saturated; all were scaled alike.
    Saturated,
    /// Any other number above 0.
    Other(i32),
}

/// Three of a kind.
type Three = [f64; 3];

impl Dhd {
    /// The meaning of a call's return value. The error's number is fetched at once, as any later call may replace it.
    fn checked(&self, call: &'static str, number: i32) -> Result<DhdOutcome, DhdError> {
        match number {
            0 => Ok(DhdOutcome::Done),
            1 => Ok(DhdOutcome::NotReadAgain),
            2 => Ok(DhdOutcome::Saturated),
            n if n > 0 => Ok(DhdOutcome::Other(n)),
            _ => Err(self.last_error(call)),
        }
    }

    fn last_error(&self, call: &'static str) -> DhdError {
        DhdError {
            call,
            number: (self.calls().error_get_last)(),
        }
    }

    /// A call that an older library does not have.
    fn lacks(call: &'static str) -> DhdError {
        DhdError {
            call,
            number: DhdError::NOT_IN_LIBRARY,
        }
    }

    /// Version of the library, as `3.17.6`; `None` where it has none.
    #[must_use]
    pub fn version(&self) -> Option<String> {
        let ask = self.calls().get_sdk_version?;
        let mut numbers = [0; 4];
        let [a, b, c, d] = &mut numbers;
        ask(a, b, c, d);
        let [major, minor, release, _] = numbers;
        Some(format!("{major}.{minor}.{release}"))
    }

    /// Number of devices, and how many of them no other program holds.
    ///
    /// # Errors
    /// The library's error.
    pub fn count(&self) -> Result<(u32, u32), DhdError> {
        let calls = self.calls();
        let whole = |call, number: i32| u32::try_from(number).map_err(|_| self.last_error(call));
        let all = whole("dhdGetDeviceCount", (calls.get_device_count)())?;
        let free = match calls.get_available_count {
            Some(ask) => whole("dhdGetAvailableCount", ask())?,
            None => all,
        };
        Ok((all, free))
    }

    /// Opens the device of this number among those that are free.
    ///
    /// # Errors
    /// The library says so.
    pub fn open(&self, index: i8) -> Result<i8, DhdError> {
        let id = (self.calls().open_id)(symbols::char_of(index));
        match i8::try_from(id) {
            Ok(id) if id >= 0 => Ok(id),
            _ => Err(self.last_error("dhdOpenID")),
        }
    }

    /// Closes it: others may have it.
    ///
    /// # Errors
    /// The library says so.
    pub fn close(&self, id: i8) -> Result<DhdOutcome, DhdError> {
        let done = (self.calls().close)(symbols::char_of(id));
        self.checked("dhdClose", done)
    }

    /// What kind of device it is.
    ///
    /// # Errors
    /// The library says so.
    pub fn model(&self, id: i8) -> Result<DhdModel, DhdError> {
        let id = symbols::char_of(id);
        let number = (self.calls().get_system_type)(id);
        if number < 0 {
            return Err(self.last_error("dhdGetSystemType"));
        }
        let mut serial = 0;
        let serial = self
            .calls()
            .get_serial_number
            .filter(|ask| ask(&mut serial, id) == 0)
            .map(|_| serial);
        Ok(DhdModel {
            number,
            name: self.system_name(id),
            serial,
        })
    }

    /// State of a device.
    ///
    /// # Errors
    /// The library's error.
    pub fn status(&self, id: i8) -> Result<DhdStatus, DhdError> {
        // Filled with what no status is, so that what an older library does not write is seen.
        let mut raw = [DhdStatus::NOT_WRITTEN; STATUS_INTS];
        let done = (self.calls().get_status)(&mut raw, symbols::char_of(id));
        self.checked("dhdGetStatus", done)?;
        Ok(DhdStatus(raw))
    }

    /// Position of a device, m.
    ///
    /// # Errors
    /// The library's error.
    pub fn position(&self, id: i8) -> Result<(Three, DhdOutcome), DhdError> {
        let mut at = [f64::NAN; 3];
        let [x, y, z] = &mut at;
        let done = (self.calls().get_position)(x, y, z, symbols::char_of(id));
        Ok((at, self.checked("dhdGetPosition", done)?))
    }

    /// The force from now on, N.
    ///
    /// # Errors
    /// The library says so.
    pub fn set_force(&self, [x, y, z]: Three, id: i8) -> Result<DhdOutcome, DhdError> {
        let done = (self.calls().set_force)(x, y, z, symbols::char_of(id));
        self.checked("dhdSetForce", done)
    }

    /// The force that acts, N; `None` where the library cannot say.
    #[must_use]
    pub fn force(&self, id: i8) -> Option<Three> {
        let ask = self.calls().get_force?;
        let mut force = [f64::NAN; 3];
        let [x, y, z] = &mut force;
        let done = ask(x, y, z, symbols::char_of(id));
        (done >= 0 && force.iter().all(|f| f.is_finite())).then_some(force)
    }

    /// Motors on or off.
    ///
    /// # Errors
    /// The library says so.
    pub fn enable_force(&self, on: bool, id: i8) -> Result<DhdOutcome, DhdError> {
        let done = (self.calls().enable_force)(u8::from(on), symbols::char_of(id));
        self.checked("dhdEnableForce", done)
    }

    /// Motors off and braked.
    ///
    /// # Errors
    /// The library says so.
    pub fn stop(&self, id: i8) -> Result<DhdOutcome, DhdError> {
        let done = (self.calls().stop)(symbols::char_of(id));
        self.checked("dhdStop", done)
    }

    /// The longest force that the library lets through, N.
    ///
    /// # Errors
    /// The library says so, or does not have it.
    pub fn set_max_force(&self, force_n: f64, id: i8) -> Result<DhdOutcome, DhdError> {
        let call = "dhdSetMaxForce";
        let set = self.calls().set_max_force.ok_or(Self::lacks(call))?;
        self.checked(call, set(force_n, symbols::char_of(id)))
    }

    /// The mass that the library takes for its effector, kg; `None` where it cannot say.
    #[must_use]
    pub fn effector_mass_kg(&self, id: i8) -> Option<f64> {
        let mut mass = f64::NAN;
        let done = self.calls().get_effector_mass?(&mut mass, symbols::char_of(id));
        (done >= 0 && mass.is_finite()).then_some(mass)
    }

    /// Joint angles, rad.
    ///
    /// # Errors
    /// The library says so, or does not have it.
    pub fn joint_angles(&self, id: i8) -> Result<[f64; 8], DhdError> {
        let call = "dhdGetJointAngles";
        let ask = self.calls().get_joint_angles.ok_or(Self::lacks(call))?;
        let mut angles = [f64::NAN; 8];
        self.checked(call, ask(&mut angles, symbols::char_of(id)))?;
        Ok(angles)
    }

    /// The inertia at these joint angles, in Cartesian coordinates: kg in the upper left.
    ///
    /// # Errors
    /// The library says so, or does not have it.
    pub fn inertia(&self, angles: &[f64; 8], id: i8) -> Result<[[f64; 6]; 6], DhdError> {
        let call = "dhdJointAnglesToInertiaMatrix";
        let ask = self.calls().inertia_matrix.ok_or(Self::lacks(call))?;
        let mut inertia = [[f64::NAN; 6]; 6];
        self.checked(call, ask(angles, &mut inertia, symbols::char_of(id)))?;
        Ok(inertia)
    }

    /// The Jacobian of the delta part here: m/rad.
    ///
    /// # Errors
    /// The library says so, or does not have it.
    pub fn jacobian(&self, id: i8) -> Result<[Three; 3], DhdError> {
        let call = "dhdGetDeltaJacobian";
        let ask = self.calls().get_jacobian.ok_or(Self::lacks(call))?;
        let mut jacobian = [[f64::NAN; 3]; 3];
        self.checked(call, ask(&mut jacobian, symbols::char_of(id)))?;
        Ok(jacobian)
    }

    /// Ranges of the joint angles, rad: lower ends, upper ends.
    ///
    /// # Errors
    /// The library says so, or does not have it.
    pub fn joint_range(&self, id: i8) -> Result<([f64; 8], [f64; 8]), DhdError> {
        let call = "dhdGetJointAngleRange";
        let ask = self.calls().get_joint_range.ok_or(Self::lacks(call))?;
        let (mut low, mut high) = ([f64::NAN; 8], [f64::NAN; 8]);
        self.checked(call, ask(&mut low, &mut high, symbols::char_of(id)))?;
        Ok((low, high))
    }

    /// Calls for experts, for as long as `work` takes; nothing is changed by those that are here.
    ///
    /// # Errors
    /// The library says so, or does not have it.
    pub fn as_expert<T>(&self, work: impl FnOnce() -> T) -> Result<T, DhdError> {
        let call = "dhdEnableExpertMode";
        let (Some(on), Some(off)) = (self.calls().expert_on, self.calls().expert_off) else {
            return Err(Self::lacks(call));
        };
        self.checked(call, on())?;
        let done = work();
        off();
        Ok(done)
    }
}
