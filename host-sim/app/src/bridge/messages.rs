//! The messages of SmartKnob's serial protocol, version 1, as its published `smartknob.proto` has them, and their frames.

use prost::{Message, Oneof};
use serde::ser::SerializeTuple;
use serde::{Serialize, Serializer};
use touchstone_protocol::frame::{self, FRAME_MAX};

/// The only version of the protocol that there is.
pub const VERSION: u32 = 1;

/// A message from the knob to a program.
#[derive(Clone, PartialEq, Message)]
pub struct FromKnob {
    /// [`VERSION`].
    #[prost(uint32, tag = "1")]
    pub protocol_version: u32,
    /// The message itself.
    #[prost(oneof = "Answer", tags = "2, 3, 4")]
    pub payload: Option<Answer>,
}

/// What a knob says.
#[derive(Clone, PartialEq, Oneof)]
pub enum Answer {
    /// The message with this nonce has arrived.
    #[prost(message, tag = "2")]
    Ack(Ack),
    /// A line for people.
    #[prost(message, tag = "3")]
    Log(Log),
    /// Position and configuration.
    #[prost(message, tag = "4")]
    State(KnobState),
}

/// The message with this nonce has arrived.
#[derive(Clone, PartialEq, Message)]
pub struct Ack {
    /// The nonce.
    #[prost(uint32, tag = "1")]
    pub nonce: u32,
}

/// A line for people.
#[derive(Clone, PartialEq, Message)]
pub struct Log {
    /// At most 255 bytes.
    #[prost(string, tag = "1")]
    pub msg: String,
}

/// Position and configuration of a knob.
#[derive(Clone, PartialEq, Message)]
pub struct KnobState {
    /// The position.
    #[prost(int32, tag = "1")]
    pub current_position: i32,
    /// Distance from that position, in widths of a position.
    #[prost(float, tag = "2")]
    pub sub_position_unit: f32,
    /// The configuration that is in effect.
    #[prost(message, optional, tag = "3")]
    pub config: Option<KnobConfig>,
    /// Changes with each press of the knob; here always 0, since the boards have no such sensor.
    #[prost(uint32, tag = "4")]
    pub press_nonce: u32,
}

/// A message from a program to the knob.
#[derive(Clone, PartialEq, Message)]
pub struct ToKnob {
    /// [`VERSION`].
    #[prost(uint32, tag = "1")]
    pub protocol_version: u32,
    /// Chosen by the program; the answer to a message has the same.
    #[prost(uint32, tag = "2")]
    pub nonce: u32,
    /// The message itself.
    #[prost(oneof = "Asked", tags = "3, 4")]
    pub payload: Option<Asked>,
}

/// What a program asks of a knob.
#[derive(Clone, PartialEq, Oneof)]
pub enum Asked {
    /// The knob is to send its state.
    #[prost(message, tag = "3")]
    RequestState(RequestState),
    /// The knob is to be like this.
    #[prost(message, tag = "4")]
    Config(KnobConfig),
}

/// The knob is to send its state.
#[derive(Clone, Copy, PartialEq, Message)]
pub struct RequestState {}

/// How a knob is to feel.
#[derive(Clone, PartialEq, Message)]
pub struct KnobConfig {
    /// The number of the present position; applied where it, the two after it or the nonce differ from the configuration before.
    #[prost(int32, tag = "1")]
    pub position: i32,
    /// Distance of the knob from that position, in widths.
    #[prost(float, tag = "2")]
    pub sub_position_unit: f32,
    /// Another value applies an equal position again; below 256.
    #[prost(uint32, tag = "3")]
    pub position_nonce: u32,
    /// The first position.
    #[prost(int32, tag = "4")]
    pub min_position: i32,
    /// The last position; without bounds if it is below the first.
    #[prost(int32, tag = "5")]
    pub max_position: i32,
    /// Width of a position, rad.
    #[prost(float, tag = "6")]
    pub position_width_radians: f32,
    /// Strength of the detents, 0 to 1 and a little more; 0: none.
    #[prost(float, tag = "7")]
    pub detent_strength_unit: f32,
    /// Strength of the end stops, 0 to 1 and a little more; 0: none.
    #[prost(float, tag = "8")]
    pub endstop_strength_unit: f32,
    /// Distance from a position at which it changes, in widths, from 0.5 on.
    #[prost(float, tag = "9")]
    pub snap_point: f32,
    /// The program's name for this configuration, at most 50 bytes.
    #[prost(string, tag = "10")]
    pub text: String,
    /// Where there are any, only these positions have detents; at most 5.
    #[prost(int32, repeated, tag = "11")]
    pub detent_positions: Vec<i32>,
    /// Asymmetry of the snap points; not played.
    #[prost(float, tag = "12")]
    pub snap_point_bias: f32,
    /// Colour of lamps; not played.
    #[prost(int32, tag = "13")]
    pub led_hue: i32,
}

/// Bytes as they are, without their number.
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

/// A message in its frame: its bytes and their CRC-32, in COBS, ended by a zero. That is the frame of the boards' own protocol.
pub fn framed(message: &impl Message) -> Vec<u8> {
    let bytes = message.encode_to_vec();
    let mut buffer = [0; FRAME_MAX];
    frame::encode(&Raw(&bytes), &mut buffer).map_or_else(|_| Vec::new(), <[u8]>::to_vec)
}

/// The answer in its frame.
pub fn answered(answer: Answer) -> Vec<u8> {
    framed(&FromKnob {
        protocol_version: VERSION,
        payload: Some(answer),
    })
}
