//! The shared library inside Touchstone's FMUs: the functions of FMI 3.0 for co-simulation.
//!
//! [`calls`] has the functions that work, [`unsupported`] those of FMI's optional parts, which return an error. [`foreign`] is the
//! only module that follows a pointer. What an FMU calculates is in the crate `touchstone-fmu`.
//!
//! An instance is used by one thread at a time; several instances are independent of each other.
#![allow(non_snake_case, reason = "FMI's names")]

pub mod calls;
pub mod foreign;
pub mod unsupported;

/// FMI's result of a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
#[allow(non_camel_case_types)]
pub enum fmi3Status {
    /// The call succeeded.
    Ok = 0,
    /// The call succeeded; a message says what is doubtful.
    Warning = 1,
    /// Not used.
    Discard = 2,
    /// The call failed; a message says why. A part of its work may be done, such as the first of several inputs. The instance can
    /// be used further.
    Error = 3,
    /// The instance cannot be used any more.
    Fatal = 4,
}

/// Text with the version of the FMU code. The export refuses a library without this text.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub static TOUCHSTONE_FMI: &[u8] = touchstone_fmu::MARK.as_bytes();
