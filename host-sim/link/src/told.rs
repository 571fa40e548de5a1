//! JSON messages from the program to a board's page, with texts for people.

use crate::fault_words::section;
use crate::value;
use crate::words::name_of;
use serde_json::{Value, json};
use touchstone_protocol::settings::fields::FIELDS;
use touchstone_protocol::{DeviceCommand, DeviceSettings, Limit, Phase, Status};

/// Beginning of an error message if it is unknown whether the device is off.
pub const MAY_BE_ON: &str = "THE DEVICE MAY STILL BE ON";

/// The JSON message with the device's identity and all its settings.
#[must_use]
pub fn hello(device: &str, settings: &DeviceSettings, decimation: u16) -> Value {
    let wall = &settings.wall;
    let entry = |field| {
        let mut entry = value::json(field);
        entry["shown"] = value::shown(settings, field).into();
        entry
    };
    json!({
        "type": "hello",
        "device": device,
        "rate_hz": f64::from(settings.timing.rate_hz),
        "decimation": decimation,
        "surface_rad": wall.surface_rad.to_num::<f64>(),
        "k_desired_n_m_per_rad": wall.k_desired_n_m_per_rad.to_num::<f64>(),
        "encoder_step_rad": std::f64::consts::TAU / f64::from(settings.encoder.counts_per_rev),
        "phases": Phase::ALL.map(Phase::name),
        "limits": Limit::ALL.map(limit_words),
        "fields": FIELDS.iter().map(entry).collect::<Vec<_>>(),
    })
}

/// The JSON message with the device's state, its fault and what the user can do next.
#[must_use]
pub fn state(status: &Status) -> Value {
    let fault = status.fault.map(|fault| {
        let text = |heading| plain(section(fault.code, heading).unwrap_or_default());
        json!({
            "name": name_of(&fault),
            "value": fault.value,
            "tick": fault.tick,
            "meaning": text("Meaning"),
            "check": text("What to check"),
            "clear": text("How to clear"),
        })
    });
    json!({
        "type": "state",
        "phase": status.phase.name(),
        "words": phase_words(status.phase),
        "fault": fault,
        "unsaved": status.unsaved,
    })
}

/// Removes the Markdown markup from a documentation page's text and puts each paragraph on one line.
fn plain(text: &str) -> String {
    text.replace("**", "")
        .replace('`', "")
        .replace("\n\n", "\n")
}

/// A sentence on a state of the device, with what the user can do next.
const fn phase_words(phase: Phase) -> &'static str {
    match phase {
        Phase::Boot => "Just switched on. Calibrate: the shaft will move.",
        Phase::Calibrating => "The shaft moves by itself. Keep your hand off.",
        Phase::Ready => "Calibrated, outputs off. Arm it to feel the wall.",
        Phase::Armed => "Armed: the motor pushes back.",
        Phase::Fault => "Switched off by a fault, which is explained below.",
        Phase::Stopped => "Stopped, outputs off. Calibrate: the shaft will move.",
    }
}

/// A sentence for each cause that reduces the commanded force, such as the current limit.
const fn limit_words(limit: Limit) -> &'static str {
    match limit {
        Limit::Temperature => "motor or power stage is hot",
        Limit::Current => "current limit",
        Limit::Voltage => "bus voltage too low for the current",
        Limit::Force => "force limit",
        Limit::FadeIn => "fading in",
        Limit::Encoder => "bad encoder reading",
        Limit::Beside => "the force of other walls or detents is added",
        Limit::Reach => {
            "a wall is off: the knob is more than 20 turns inside it; turn the knob back, or make this position zero"
        }
    }
}

/// The JSON message on the connection to the board. `lost` is the reason for its loss, `done` what the program did when the board
/// came back.
#[must_use]
pub fn connection(lost: Option<&str>, done: Option<&str>) -> Value {
    json!({ "type": "connection", "lost": lost, "done": done })
}

/// The JSON message with the number of records that the device's serial port dropped, and of frames that arrived damaged.
#[must_use]
pub fn troubles(dropped: u32, damaged: u32) -> Value {
    json!({ "type": "troubles", "dropped": dropped, "damaged": damaged })
}

/// The command that switches off a device in this state, and a message about it for the user. `None` if the device is already off.
#[must_use]
pub const fn switched_off(phase: Phase) -> Option<(DeviceCommand, &'static str)> {
    match phase {
        Phase::Armed => Some((
            DeviceCommand::Disarm,
            "the device was armed, and was disarmed now",
        )),
        Phase::Calibrating => Some((
            DeviceCommand::Stop,
            "the device was calibrating, and was stopped now",
        )),
        _ => None,
    }
}
