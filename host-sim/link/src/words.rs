//! Converts names, identities and refusals that a device sends to text for people.

use touchstone_protocol::settings::KeyError;
use touchstone_protocol::{Fault, FaultCode, Identity, Phase, Refusal, Reply, Unkept};

/// The unique number of the device's microcontroller, as hexadecimal text.
#[must_use]
pub fn number_of(identity: &Identity) -> String {
    use std::fmt::Write;
    let mut number = String::new();
    for byte in identity.unique_id {
        // Writing into a string cannot fail.
        let _ = write!(number, "{byte:02x}");
    }
    number
}

/// The device's identity on one line: board, firmware, protocol, settings version and unique number.
#[must_use]
pub fn described(identity: &Identity) -> String {
    let number = number_of(identity);
    format!(
        "{}, firmware {} ({:016x}), protocol {}, settings {}, number {number}",
        identity.board.name(),
        touchstone_sim::harmless::one_line(&identity.firmware_version),
        identity.build_hash,
        identity.protocol_version,
        identity.settings_version,
    )
}

/// Number and name of a device's fault, as text.
#[must_use]
pub fn name_of(fault: &Fault) -> String {
    match fault.known() {
        Some(code) => format!("{:02} {}", fault.code, page(code)),
        None => format!(
            "{:02}, which is unknown to this version of the program",
            fault.code
        ),
    }
}

/// Name of a fault's documentation page in `docs/faults/`, without the fault's number.
#[must_use]
pub fn page(code: FaultCode) -> String {
    let mut name = String::new();
    for letter in format!("{code:?}").chars() {
        if letter.is_ascii_uppercase() && !name.is_empty() {
            name.push('-');
        }
        name.push(letter.to_ascii_lowercase());
    }
    name
}

/// A problem with a device, and advice.
pub type ProblemAndFix = (String, &'static str);

/// The advice for a device that speaks another version of the protocol.
pub const OTHER_VERSION: &str = "flash the firmware of this version: touchstone flash";

/// Problem and advice if the device's answer is not of the type that the request needs.
#[must_use]
pub fn odd(reply: &Reply) -> ProblemAndFix {
    let kind = format!("{reply:?}");
    let kind = kind.split(['(', ' ']).next().unwrap_or_default();
    (format!("answered something else ({kind})"), OTHER_VERSION)
}

/// Problem and advice for a device that speaks another version of the protocol than this program (`own`).
#[must_use]
pub fn other_version(version: u16, own: u16) -> ProblemAndFix {
    (
        format!("the device speaks version {version} of the protocol, this program {own}"),
        OTHER_VERSION,
    )
}

/// The reason for which the device refused a request, and advice.
#[must_use]
pub fn refused(refusal: &Refusal) -> ProblemAndFix {
    match refusal {
        Refusal::NotNow(phase) => (
            format!(
                "the device rejects this command in state `{}`",
                phase.name()
            ),
            next_step(*phase),
        ),
        Refusal::Key(KeyError::NoSuchField) => (
            "the device has no such setting".into(),
            "`touchstone config schema` lists them",
        ),
        Refusal::Key(KeyError::NotAValue) => (
            "this is not a value of this setting".into(),
            "`touchstone config schema` shows the allowed values",
        ),
        Refusal::Invalid(invalid) => (format!("refused: {invalid}"), "choose another value"),
        Refusal::Flash => (
            "the flash could not be written".into(),
            "the old settings are still in the flash; try again",
        ),
        Refusal::RingRuns => (
            "there is no record of a fault yet: recording stops at a fault".into(),
            "watch live values with `touchstone monitor`",
        ),
        Refusal::NotUnderstood => (
            "the device does not know this request".into(),
            OTHER_VERSION,
        ),
        Refusal::Unkept(why) => (
            why.words().into(),
            match why {
                Unkept::Incremental | Unkept::NothingToAlign => {
                    "calibrate at each start: touchstone device calibrate"
                }
                _ => {
                    "calibrate, then store the alignment: touchstone device calibrate, touchstone device alignment keep"
                }
            },
        ),
        _ => ("the device rejects this command".into(), OTHER_VERSION),
    }
}

/// Advice for a command that the device refuses in this state: the command to give before it.
const fn next_step(phase: Phase) -> &'static str {
    match phase {
        Phase::Boot => "calibrate first: touchstone device calibrate",
        Phase::Calibrating => "wait until the calibration ends, or stop it: touchstone device stop",
        Phase::Ready => "stop first: touchstone device stop",
        Phase::Armed => "disarm first: touchstone device disarm",
        Phase::Fault => {
            "show the fault, then clear it: touchstone device fault, touchstone device stop"
        }
        Phase::Stopped => "calibrate first: touchstone device calibrate",
    }
}
