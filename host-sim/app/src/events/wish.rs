//! Requests of other programs to a knob.

use super::midi::MidiRequest;
use crate::osc::{Message, Value};
use serde_json::Value as Json;
use touchstone_sim::scene::feels;

/// A request of a program.
#[derive(Debug, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Wish {
    /// Gives the present position this number.
    Position(i32),
    /// Renders the shipped feel of this name, or the feel in this text or object.
    Feel(Json),
}

impl Wish {
    /// The request in an OSC message; `None` if the message is not a request.
    pub fn of_message(message: &Message) -> Option<Self> {
        match (&*message.address, &*message.values) {
            ("/touchstone/position", [Value::Int(number)]) => Some(Self::Position(*number)),
            ("/touchstone/feel", [Value::Text(feel)]) => Some(Self::Feel(feel.as_str().into())),
            _ => None,
        }
    }

    /// The request of a MIDI program change. A number beyond the last feel gives a name that no feel has, so the request is
    /// refused.
    pub fn of_midi(MidiRequest::Program(number): MidiRequest) -> Self {
        let name = feels().get(usize::from(number)).copied();
        Self::Feel(name.map_or_else(|| format!("number {number}").into(), Json::from))
    }
}

/// The sender of a request.
#[derive(Debug, Clone, Copy)]
pub enum Asker {
    Osc,
    Midi,
    /// The WebSocket's client with this number.
    Client(u64),
}
