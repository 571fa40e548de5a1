//! Loads Force Dimension's library and its functions. The desktop program's only `unsafe` code is in this module.
//!
//! Loaded functions get safe Rust types. Where C has a pointer to memory that the function fills, the Rust type has a reference to
//! as much memory as the function may write. A reference and a pointer are passed in the same way, and a reference cannot be null
//! or dangling. No struct is passed. Only the claim that a symbol has its Rust type is unsafe; the calls are safe.
#![allow(unsafe_code)]

use libloading::Library;
use std::ffi::{CStr, c_char, c_int, c_uchar, c_ushort};
use std::path::{Path, PathBuf};

use crate::code::STATUS_INTS;

/// Converts the library's number of a device to C's `char`, which is signed on some machines and unsigned on others. The bits stay
/// the same.
pub(crate) fn char_of(id: i8) -> c_char {
    id as c_char
}

type OfDevice = extern "system" fn(c_char) -> c_int;
type OfNothing = extern "system" fn() -> c_int;
type ToThree = extern "system" fn(&mut f64, &mut f64, &mut f64, c_char) -> c_int;

/// Declares the functions that are loaded from the library: `needed` ones that must exist and `optional` ones that may be missing.
macro_rules! functions {
    (needed { $($needed:ident $needed_name:literal $needed_type:ty;)* } optional { $($name:ident $symbol:literal $type:ty;)* }) => {
        /// The loaded functions. The headers `dhdc.h` and `drdc.h` declare the C functions of these names.
        #[derive(Clone, Copy)]
        pub(crate) struct Calls {
            $(pub(crate) $needed: $needed_type,)*
            $(pub(crate) $name: Option<$type>,)*
        }

        impl Calls {
            /// Loads all functions from a library.
            ///
            /// # Errors
            /// The name of the first required function that the library lacks.
            fn of(library: &Library) -> Result<Self, &'static str> {
                Ok(Self {
                    $($needed: {
                        // SAFETY: the type is that of the function in the vendor's header, with references for the pointers that it
                        // fills (the module's documentation). The pointer is used only while `Dhd` holds the library.
                        let found = unsafe { library.get::<$needed_type>($needed_name) };
                        *found.map_err(|_| $needed_name)?
                    },)*
                    $($name: {
                        // SAFETY: as above.
                        let found = unsafe { library.get::<$type>($symbol) };
                        found.ok().map(|function| *function)
                    },)*
                })
            }
        }
    };
}

functions! {
    needed {
        error_get_last "dhdErrorGetLast" OfNothing;
        get_device_count "dhdGetDeviceCount" OfNothing;
        open_id "dhdOpenID" OfDevice;
        close "dhdClose" OfDevice;
        stop "dhdStop" OfDevice;
        get_system_type "dhdGetSystemType" OfDevice;
        get_status "dhdGetStatus" extern "system" fn(&mut [c_int; STATUS_INTS], c_char) -> c_int;
        get_position "dhdGetPosition" ToThree;
        set_force "dhdSetForce" extern "system" fn(f64, f64, f64, c_char) -> c_int;
        enable_force "dhdEnableForce" extern "system" fn(c_uchar, c_char) -> c_int;
    }
    optional {
        get_sdk_version "dhdGetSDKVersion" extern "system" fn(&mut c_int, &mut c_int, &mut c_int, &mut c_int);
        get_available_count "dhdGetAvailableCount" OfNothing;
        get_system_name "dhdGetSystemName" extern "system" fn(c_char) -> *const c_char;
        get_serial_number "dhdGetSerialNumber" extern "system" fn(&mut c_ushort, c_char) -> c_int;
        get_force "dhdGetForce" ToThree;
        set_max_force "dhdSetMaxForce" extern "system" fn(f64, c_char) -> c_int;
        get_effector_mass "dhdGetEffectorMass" extern "system" fn(&mut f64, c_char) -> c_int;
        expert_on "dhdEnableExpertMode" OfNothing;
        expert_off "dhdDisableExpertMode" OfNothing;
        get_joint_angles "dhdGetJointAngles" extern "system" fn(&mut [f64; 8], c_char) -> c_int;
        inertia_matrix "dhdJointAnglesToInertiaMatrix" extern "system" fn(&[f64; 8], &mut [[f64; 6]; 6], c_char) -> c_int;
        get_jacobian "dhdGetDeltaJacobian" extern "system" fn(&mut [[f64; 3]; 3], c_char) -> c_int;
        get_joint_range "dhdGetJointAngleRange" extern "system" fn(&mut [f64; 8], &mut [f64; 8], c_char) -> c_int;
    }
}

/// Force Dimension's library, loaded, with its functions.
pub struct Dhd {
    calls: Calls,
    path: PathBuf,
    /// The library. The field comes after the functions, so that the functions are dropped before the library is unloaded.
    _library: Library,
}

impl std::fmt::Debug for Dhd {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Dhd({})", self.path.display())
    }
}

impl Dhd {
    /// Loads the library from a file, or by a name that the operating system's loader knows.
    ///
    /// # Errors
    /// The reason why the library cannot be loaded, as text.
    pub(crate) fn load(path: &Path) -> Result<Self, String> {
        // SAFETY: loading runs the library's initialisers, which nothing can check. The user named the file, or it has the vendor's
        // name in a place that only its owner or an administrator can write. The same holds for every program that is linked with
        // the library.
        let library = unsafe { Library::new(path) }.map_err(|why| why.to_string())?;
        let calls = Calls::of(&library).map_err(|name| {
            format!("the library has no {name}: it is not libdhd, or it is too old")
        })?;
        Ok(Self {
            calls,
            path: path.to_owned(),
            _library: library,
        })
    }

    /// The path from which the library was loaded.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn calls(&self) -> &Calls {
        &self.calls
    }

    pub(crate) fn system_name(&self, id: c_char) -> Option<String> {
        let name = (self.calls.get_system_name?)(id);
        if name.is_null() {
            return None;
        }
        // SAFETY: not null, so it is a constant text of the library that ends with a zero.
        let name = unsafe { CStr::from_ptr(name) };
        Some(name.to_string_lossy().into_owned())
    }
}
