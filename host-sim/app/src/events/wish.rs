//! What programs ask a knob for.

use super::midi::Asked;
use crate::osc::{Message, Value};
use touchstone_sim::scene::feels;

/// A request of a program.
#[derive(Debug, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Wish {
    /// The number that the present position gets.
    Position(i32),
    /// The feel to render.
    Feel(String),
}

impl Wish {
    /// The wish in an OSC message; `None` if it has none.
    pub fn of_message(message: &Message) -> Option<Self> {
        match (&*message.address, &*message.values) {
            ("/touchstone/position", [Value::Int(number)]) => Some(Self::Position(*number)),
            ("/touchstone/feel", [Value::Text(name)]) => Some(Self::Feel(name.clone())),
            _ => None,
        }
    }

    /// The wish of a MIDI message. A number beyond the last feel is a wish that will be refused.
    pub fn of_midi(Asked::Program(number): Asked) -> Self {
        let name = feels().get(usize::from(number)).copied();
        Self::Feel(name.map_or_else(|| format!("number {number}"), str::to_owned))
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
