//! Messages to the page, with texts for people.

use crate::fault_words::section;
use crate::value;
use crate::words::name_of;
use serde_json::{Value, json};
use touchstone_protocol::settings::fields::FIELDS;
use touchstone_protocol::{DeviceCommand, DeviceSettings, Limit, Phase, Status};

/// The device's identity and all its settings, as JSON.
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

/// The device's state and what to do next, as text for people.
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

/// A documentation page's text without its markup, one paragraph per line.
fn plain(text: &str) -> String {
    text.replace("**", "")
        .replace('`', "")
        .replace("\n\n", "\n")
}

/// A state of the device, with what to do next, as text.
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

/// A limit that reduces the force, as text.
const fn limit_words(limit: Limit) -> &'static str {
    match limit {
        Limit::Temperature => "the power stage is warm",
        Limit::Current => "current limit",
        Limit::Voltage => "bus voltage too low for the current",
        Limit::Force => "force limit",
        Limit::FadeIn => "fading in",
        Limit::Encoder => "bad encoder reading",
        Limit::Beside => "more than the wall to touch",
        Limit::Reach => {
            "a wall is off: the knob is more than 20 turns inside of it; turn it back, or zero it here"
        }
    }
}

/// The message on the connection: why it was lost, or what was done after it came back.
#[must_use]
pub fn connection(lost: Option<&str>, done: Option<&str>) -> Value {
    json!({ "type": "connection", "lost": lost, "done": done })
}

/// The message with the number of records that the device's serial port dropped, and of frames that arrived damaged.
#[must_use]
pub fn troubles(dropped: u32, damaged: u32) -> Value {
    json!({ "type": "troubles", "dropped": dropped, "damaged": damaged })
}

/// The command that switches a device off in this state, and the text for what was done. `None` if the device is off.
#[must_use]
pub const fn switched_off(phase: Phase) -> Option<(DeviceCommand, &'static str)> {
    match phase {
        Phase::Armed => Some((
            DeviceCommand::Disarm,
            "the device was armed, and is disarmed",
        )),
        Phase::Calibrating => Some((
            DeviceCommand::Stop,
            "the device was calibrating, and is stopped",
        )),
        _ => None,
    }
}
