//! The position of a knob as MIDI control changes, to and from a raw MIDI device of Linux, a FIFO or a pseudo terminal.
//!
//! | message | bytes | sent or received |
//! |---|---|---|
//! | control change | `Bn cc vv` | sent on every change of the value; when received, sets the value if the knob has no end stops |
//! | program change | `Cn pp` | when received, chooses the feel with the number `pp` in `touchstone feels`, counted from 0 |
//!
//! `n` is the channel minus 1. With 14 bits, controller `cc` carries the upper seven bits and is sent first; `cc` + 32 carries the
//! lower seven.

mod line;
mod messages;

use crate::number;
use crate::out::note;
use line::Line;
use messages::{Heard, Kind, Knob, LOWER, Parser};
use std::path::PathBuf;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::positions::{Place, Positions};

/// Options for MIDI.
#[derive(Debug, Clone, clap::Args)]
pub struct MidiOptions {
    /// Also sends every change as a MIDI control change to this raw MIDI device, FIFO or pseudo terminal (Linux). Takes control
    /// changes, which set the value of a knob without end stops, and program changes, which choose a shipped feel by its number.
    #[arg(long, value_name = "PATH")]
    midi: Option<PathBuf>,
    /// MIDI channel.
    #[arg(long, value_name = "N", default_value_t = 1, requires = "midi", value_parser = number::within(1_u8, 16, "of a channel"))]
    midi_channel: u8,
    /// MIDI controller; with --midi-value 14-bit at most 31.
    #[arg(long, value_name = "N", default_value_t = 16, requires = "midi", value_parser = number::within(0_u8, 119, "of a controller"))]
    midi_controller: u8,
    /// Meaning of the value in a control change.
    #[arg(long, value_name = "KIND", default_value = "7-bit", requires = "midi")]
    midi_value: Kind,
}

/// A request of a program by MIDI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MidiRequest {
    /// The shipped feel with this number, from 0.
    Program(u8),
}

/// The MIDI connection to the programs that use the knob.
#[derive(Debug)]
pub struct Midi {
    line: Line,
    knob: Knob,
    parser: Parser,
    has_noted: bool,
}

impl Midi {
    /// Opens the MIDI device; `None` if the options name none.
    ///
    /// # Errors
    /// The path is not a MIDI device or cannot be opened, or a 14-bit value is requested for a controller above 31.
    pub fn open(options: &MidiOptions) -> Result<Option<Self>> {
        let Some(path) = &options.midi else {
            return Ok(None);
        };
        if options.midi_value == Kind::Fourteen && options.midi_controller >= LOWER {
            return Err(Error::Option {
                option: "--midi-controller".into(),
                problem: format!(
                    "{} has no second controller for 14 bits",
                    options.midi_controller
                ),
                fix: "give one from 0 to 31".into(),
            });
        }
        Ok(Some(Self {
            line: Line::open(path)?,
            knob: Knob {
                channel: options.midi_channel - 1,
                controller: options.midi_controller,
                kind: options.midi_value,
                value: 0,
                upper: 0,
            },
            parser: Parser::default(),
            has_noted: false,
        }))
    }

    /// Sends a change of position.
    pub fn send(&mut self, place: &Place, positions: &Positions) {
        let bytes = self.knob.turned(place, positions.numbers());
        self.line.write(&bytes);
    }

    /// Sets the MIDI value of a knob without end stops to its position's number, limited to the value's range. Sends no message.
    pub fn number(&mut self, position: i64) {
        self.knob.value = self.knob.within(position);
    }

    /// The requests of programs since the last call. A received value becomes the value of a knob without end stops.
    pub fn asked(&mut self, positions: &Positions) -> Vec<MidiRequest> {
        let mut asked = Vec::new();
        for byte in self.line.read() {
            let Some(message) = self.parser.push(byte) else {
                continue;
            };
            match self.knob.heard(message) {
                Heard::Nothing => {}
                Heard::Program(number) => asked.push(MidiRequest::Program(number)),
                Heard::Value(value) if positions.numbers().is_none() => self.knob.value = value,
                Heard::Value(value) if !self.has_noted && !self.knob.is_own(value) => {
                    self.has_noted = true;
                    note!(
                        "note: --midi: received values are ignored, because between end stops the knob's angle gives the value"
                    );
                }
                Heard::Value(_) => {}
            }
        }
        asked
    }
}
