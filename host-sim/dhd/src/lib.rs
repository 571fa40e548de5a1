//! Access to Force Dimension's library (`libdhd` or `libdrd`), which the program finds and loads when it runs.
//!
//! The library is not part of this program; it comes from the maker with a device. This crate finds the library, calls the
//! functions that a virtual wall and a survey of the device need, and returns their results as data. A positive result is no error:
//! 1 means that the position was not read again, 2 that the motors give less force than commanded. After a failed call the program
//! uses none of its outputs, because the library leaves them unchanged. The program reads the error number only after a failure,
//! because a successful call does not clear it.

mod code;
mod search;
mod symbols;

pub use code::{DhdError, DhdModel, DhdStatus, OMEGA3_TYPES, STATUS_INTS};
pub use search::{ENVIRONMENT, LibrarySearch, NotLoaded};
pub use symbols::Dhd;

/// The result of a library call that did not fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DhdOutcome {
    /// Result 0: the call succeeded.
    Done,
    /// Result 1: the library returned the last position again, because its time guard limits how often the device is read.
    NotReadAgain,
    /// Result 2: a motor is saturated, and the library scaled the torques of all motors by the same factor.
    Saturated,
    /// Any other positive result of the library.
    Other(i32),
}

/// The x, y and z coordinates of a vector.
type Three = [f64; 3];

impl Dhd {
    /// Converts the number that a library call returned to a result. Reads the error number at once, because a later call may
    /// replace it.
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

    /// The error for a function that an older version of the library lacks.
    fn lacks(call: &'static str) -> DhdError {
        DhdError {
            call,
            number: DhdError::NOT_IN_LIBRARY,
        }
    }

    /// Version of the library, such as `3.17.6`; `None` if the library cannot report it.
    #[must_use]
    pub fn version(&self) -> Option<String> {
        let ask = self.calls().get_sdk_version?;
        let mut numbers = [0; 4];
        let [a, b, c, d] = &mut numbers;
        ask(a, b, c, d);
        let [major, minor, release, _] = numbers;
        Some(format!("{major}.{minor}.{release}"))
    }

    /// Number of connected devices, and number of those that no other program has open (all, if the library cannot report it).
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

    /// Opens the device with this index, counted among the devices that no other program has open. Returns the number by which the
    /// library then names the device.
    ///
    /// # Errors
    /// The library's error.
    pub fn open(&self, index: i8) -> Result<i8, DhdError> {
        let id = (self.calls().open_id)(symbols::char_of(index));
        match i8::try_from(id) {
            Ok(id) if id >= 0 => Ok(id),
            _ => Err(self.last_error("dhdOpenID")),
        }
    }

    /// Closes the device, so that other programs can open it.
    ///
    /// # Errors
    /// The library's error.
    pub fn close(&self, id: i8) -> Result<DhdOutcome, DhdError> {
        let done = (self.calls().close)(symbols::char_of(id));
        self.checked("dhdClose", done)
    }

    /// Type, name and serial number of an open device.
    ///
    /// # Errors
    /// The library's error.
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

    /// Reads the status words of an open device, such as power and motors on.
    ///
    /// # Errors
    /// The library's error.
    pub fn status(&self, id: i8) -> Result<DhdStatus, DhdError> {
        // Filled with a value that no status has, to recognise the words that an older library does not write.
        let mut raw = [DhdStatus::NOT_WRITTEN; STATUS_INTS];
        let done = (self.calls().get_status)(&mut raw, symbols::char_of(id));
        self.checked("dhdGetStatus", done)?;
        Ok(DhdStatus(raw))
    }

    /// Reads the position of the device's effector (x, y, z), m.
    ///
    /// # Errors
    /// The library's error.
    pub fn position(&self, id: i8) -> Result<(Three, DhdOutcome), DhdError> {
        let mut at = [f64::NAN; 3];
        let [x, y, z] = &mut at;
        let done = (self.calls().get_position)(x, y, z, symbols::char_of(id));
        Ok((at, self.checked("dhdGetPosition", done)?))
    }

    /// Commands a force in N at the effector, which acts until the next command.
    ///
    /// # Errors
    /// The library's error.
    pub fn set_force(&self, [x, y, z]: Three, id: i8) -> Result<DhdOutcome, DhdError> {
        let done = (self.calls().set_force)(x, y, z, symbols::char_of(id));
        self.checked("dhdSetForce", done)
    }

    /// The force in N that the library reports as acting; `None` if the library cannot report it.
    #[must_use]
    pub fn force(&self, id: i8) -> Option<Three> {
        let ask = self.calls().get_force?;
        let mut force = [f64::NAN; 3];
        let [x, y, z] = &mut force;
        let done = ask(x, y, z, symbols::char_of(id));
        (done >= 0 && force.iter().all(|f| f.is_finite())).then_some(force)
    }

    /// Switches the motors on or off.
    ///
    /// # Errors
    /// The library's error.
    pub fn enable_force(&self, on: bool, id: i8) -> Result<DhdOutcome, DhdError> {
        let done = (self.calls().enable_force)(u8::from(on), symbols::char_of(id));
        self.checked("dhdEnableForce", done)
    }

    /// Switches the motors off and brakes them.
    ///
    /// # Errors
    /// The library's error.
    pub fn stop(&self, id: i8) -> Result<DhdOutcome, DhdError> {
        let done = (self.calls().stop)(symbols::char_of(id));
        self.checked("dhdStop", done)
    }

    /// Sets the largest force in N that the library lets through to the motors.
    ///
    /// # Errors
    /// The library's error, or the library does not have this function.
    pub fn set_max_force(&self, force_n: f64, id: i8) -> Result<DhdOutcome, DhdError> {
        let call = "dhdSetMaxForce";
        let set = self.calls().set_max_force.ok_or(Self::lacks(call))?;
        self.checked(call, set(force_n, symbols::char_of(id)))
    }

    /// Mass of the effector that the library assumes, kg; `None` if the library cannot report it.
    #[must_use]
    pub fn effector_mass_kg(&self, id: i8) -> Option<f64> {
        let mut mass = f64::NAN;
        let done = self.calls().get_effector_mass?(&mut mass, symbols::char_of(id));
        (done >= 0 && mass.is_finite()).then_some(mass)
    }

    /// Reads the joint angles of the device, rad.
    ///
    /// # Errors
    /// The library's error, or the library does not have this function.
    pub fn joint_angles(&self, id: i8) -> Result<[f64; 8], DhdError> {
        let call = "dhdGetJointAngles";
        let ask = self.calls().get_joint_angles.ok_or(Self::lacks(call))?;
        let mut angles = [f64::NAN; 8];
        self.checked(call, ask(&mut angles, symbols::char_of(id)))?;
        Ok(angles)
    }

    /// The device's inertia matrix in Cartesian coordinates at the joint angles `angles` (rad). Its upper left 3 × 3 part is in kg.
    ///
    /// # Errors
    /// The library's error, or the library does not have this function.
    pub fn inertia(&self, angles: &[f64; 8], id: i8) -> Result<[[f64; 6]; 6], DhdError> {
        let call = "dhdJointAnglesToInertiaMatrix";
        let ask = self.calls().inertia_matrix.ok_or(Self::lacks(call))?;
        let mut inertia = [[f64::NAN; 6]; 6];
        self.checked(call, ask(angles, &mut inertia, symbols::char_of(id)))?;
        Ok(inertia)
    }

    /// The Jacobian at the device's present position, m/rad: movement of the effector per joint angle.
    ///
    /// # Errors
    /// The library's error, or the library does not have this function.
    pub fn jacobian(&self, id: i8) -> Result<[Three; 3], DhdError> {
        let call = "dhdGetDeltaJacobian";
        let ask = self.calls().get_jacobian.ok_or(Self::lacks(call))?;
        let mut jacobian = [[f64::NAN; 3]; 3];
        self.checked(call, ask(&mut jacobian, symbols::char_of(id)))?;
        Ok(jacobian)
    }

    /// The range of each joint angle, rad: first the lower ends of all joints, then the upper ends.
    ///
    /// # Errors
    /// The library's error, or the library does not have this function.
    pub fn joint_range(&self, id: i8) -> Result<([f64; 8], [f64; 8]), DhdError> {
        let call = "dhdGetJointAngleRange";
        let ask = self.calls().get_joint_range.ok_or(Self::lacks(call))?;
        let (mut low, mut high) = ([f64::NAN; 8], [f64::NAN; 8]);
        self.checked(call, ask(&mut low, &mut high, symbols::char_of(id)))?;
        Ok((low, high))
    }

    /// Enables the library's expert functions while `work` runs. The expert functions that this crate calls change nothing on the
    /// device.
    ///
    /// # Errors
    /// The library's error, or the library does not have this function.
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
