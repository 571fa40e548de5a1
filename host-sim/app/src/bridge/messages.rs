//! The messages of version 1 of SmartKnob's serial protocol, as in its published `smartknob.proto`, and their frames.

use prost::{Message, Oneof};
use serde::ser::SerializeTuple;
use serde::{Serialize, Serializer};
use touchstone_protocol::frame::{self, FRAME_MAX};

/// Version of SmartKnob's serial protocol; there is only this one.
pub const VERSION: u32 = 1;

/// A message from the knob to a program.
#[derive(Clone, PartialEq, Message)]
pub struct FromKnob {
    /// Version of the protocol, always [`VERSION`].
    #[prost(uint32, tag = "1")]
    pub protocol_version: u32,
    /// Content of the message.
    #[prost(oneof = "Answer", tags = "2, 3, 4")]
    pub payload: Option<Answer>,
}

/// Content of a message from the knob to a program.
#[derive(Clone, PartialEq, Oneof)]
pub enum Answer {
    /// Acknowledges the message from the program that has this nonce.
    #[prost(message, tag = "2")]
    Ack(Ack),
    /// A line of text for a person.
    #[prost(message, tag = "3")]
    Log(Log),
    /// Position and configuration of the knob.
    #[prost(message, tag = "4")]
    State(KnobState),
}

/// Acknowledges the message from the program that has this nonce.
#[derive(Clone, PartialEq, Message)]
pub struct Ack {
    /// The nonce (a number chosen by the program) of the message that has arrived.
    #[prost(uint32, tag = "1")]
    pub nonce: u32,
}

/// A line of text for a person.
#[derive(Clone, PartialEq, Message)]
pub struct Log {
    /// The text, at most 255 bytes.
    #[prost(string, tag = "1")]
    pub msg: String,
}

/// Position and configuration of the knob, as it reports them to a program.
#[derive(Clone, PartialEq, Message)]
pub struct KnobState {
    /// Number of the position (detent) in which the knob is.
    #[prost(int32, tag = "1")]
    pub current_position: i32,
    /// Distance of the knob from the middle of its present position, as a fraction of a position's width.
    #[prost(float, tag = "2")]
    pub sub_position_unit: f32,
    /// The configuration that is in effect.
    #[prost(message, optional, tag = "3")]
    pub config: Option<KnobConfig>,
    /// A SmartKnob changes this number each time its knob is pressed. Always 0 here, since the boards have no sensor for a press.
    #[prost(uint32, tag = "4")]
    pub press_nonce: u32,
}

/// A message from a program to the knob.
#[derive(Clone, PartialEq, Message)]
pub struct ToKnob {
    /// Version of the protocol, always [`VERSION`].
    #[prost(uint32, tag = "1")]
    pub protocol_version: u32,
    /// A number chosen by the program; the knob's acknowledgement has the same one.
    #[prost(uint32, tag = "2")]
    pub nonce: u32,
    /// Content of the message.
    #[prost(oneof = "KnobRequest", tags = "3, 4")]
    pub payload: Option<KnobRequest>,
}

/// Request of a program to the knob.
#[derive(Clone, PartialEq, Oneof)]
pub enum KnobRequest {
    /// The program requests the knob's state.
    #[prost(message, tag = "3")]
    RequestState(RequestState),
    /// The program sends a configuration that the knob is to render.
    #[prost(message, tag = "4")]
    Config(KnobConfig),
}

/// Request for the knob's state; it has no fields.
#[derive(Clone, Copy, PartialEq, Message)]
pub struct RequestState {}

/// Configuration of a knob: its positions, detents and end stops.
#[derive(Clone, PartialEq, Message)]
pub struct KnobConfig {
    /// Number of the position in which the knob now is. The knob applies it only if `position`, `sub_position_unit` or
    /// `position_nonce` differs from the previous configuration.
    #[prost(int32, tag = "1")]
    pub position: i32,
    /// Distance of the knob from the middle of the position given in `position`, as a fraction of a position's width.
    #[prost(float, tag = "2")]
    pub sub_position_unit: f32,
    /// A number below 256. A new value makes the knob apply `position` again, even if that is unchanged.
    #[prost(uint32, tag = "3")]
    pub position_nonce: u32,
    /// Number of the first position.
    #[prost(int32, tag = "4")]
    pub min_position: i32,
    /// Number of the last position. A number below `min_position` means that the knob turns without end.
    #[prost(int32, tag = "5")]
    pub max_position: i32,
    /// Width of a position, rad.
    #[prost(float, tag = "6")]
    pub position_width_radians: f32,
    /// Strength of the detents without unit, 0 (no detents) to about 1.
    #[prost(float, tag = "7")]
    pub detent_strength_unit: f32,
    /// Strength of the end stops without unit, 0 (no end stops) to about 1.
    #[prost(float, tag = "8")]
    pub endstop_strength_unit: f32,
    /// Distance from the middle of a position at which the number changes, as a multiple of a position's width; at least 0.5.
    #[prost(float, tag = "9")]
    pub snap_point: f32,
    /// The program's name for the configuration, at most 50 bytes.
    #[prost(string, tag = "10")]
    pub text: String,
    /// Numbers of the positions that have detents, at most 5. If the list is empty, every position has a detent.
    #[prost(int32, repeated, tag = "11")]
    pub detent_positions: Vec<i32>,
    /// Shifts each change of the number away from position 0 by this fraction of a position's width, so that the knob stays longer
    /// at position 0.
    #[prost(float, tag = "12")]
    pub snap_point_bias: f32,
    /// Colour of the SmartKnob's lamps; boards ignore it.
    #[prost(int32, tag = "13")]
    pub led_hue: i32,
}

/// Wraps bytes that are already encoded, so that the encoder writes them without their length in front.
struct Raw<'a>(&'a [u8]);

impl Serialize for Raw<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        self.0
            .iter()
            .try_for_each(|byte| tuple.serialize_element(byte))?;
        tuple.end()
    }
}

/// A message in its frame: the encoded message and its CRC-32, in COBS, with a zero byte at the end. The boards' own protocol uses
/// the same frame.
pub fn framed(message: &impl Message) -> Vec<u8> {
    let bytes = message.encode_to_vec();
    let mut buffer = [0; FRAME_MAX];
    frame::encode(&Raw(&bytes), &mut buffer).map_or_else(|_| Vec::new(), <[u8]>::to_vec)
}

/// A message of the knob in its frame.
pub fn answered(answer: Answer) -> Vec<u8> {
    framed(&FromKnob {
        protocol_version: VERSION,
        payload: Some(answer),
    })
}
