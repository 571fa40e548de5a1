//! What the page is told in words.

use super::device_side::DeviceSide;
use crate::device::name_of;
use crate::fault_words::section;
use serde_json::{Value, json};
use touchstone_protocol::{Limit, Phase, Status};

/// Who is there, and everything that can be set.
pub fn hello(link: &DeviceSide) -> Value {
    let wall = &link.settings.wall;
    let rate_hz = f64::from(link.settings.timing.rate_hz);
    json!({
        "type": "hello",
        "device": link.described(),
        "rate_hz": rate_hz,
        "decimation": link.decimation,
        "surface_rad": wall.surface_rad.to_num::<f64>(),
        "k_desired_n_m_per_rad": wall.k_desired_n_m_per_rad.to_num::<f64>(),
        "encoder_step_rad": std::f64::consts::TAU / f64::from(link.settings.encoder.counts_per_rev),
        "phases": Phase::ALL.map(Phase::name),
        "limits": Limit::ALL.map(limit_words),
        "fields": link.fields(),
    })
}

/// Where the device stands, and what to do next.
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

/// A page's text without its marks, its paragraphs one below the other.
fn plain(text: &str) -> String {
    text.replace("**", "")
        .replace('`', "")
        .replace("\n\n", "\n")
}

/// A state, and what leads on.
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

/// What holds the force back.
const fn limit_words(limit: Limit) -> &'static str {
    match limit {
        Limit::Temperature => "the power stage is warm",
        Limit::Current => "current limit",
        Limit::Voltage => "bus voltage too low for the current",
        Limit::Force => "force limit",
        Limit::FadeIn => "fading in",
        Limit::Encoder => "bad encoder reading",
    }
}

/// The connection to the device.
pub fn connection(lost: Option<&str>, done: Option<&str>) -> Value {
    json!({ "type": "connection", "lost": lost, "done": done })
}
