//! Encodes and decodes the MIDI messages of a knob.

use touchstone_sim::positions::Place;

/// First byte of a control change on channel 1.
const CONTROL_CHANGE: u8 = 0xb0;
/// First byte of a program change on channel 1.
const PROGRAM_CHANGE: u8 = 0xc0;
/// With 14 bits, the controller of the lower seven bits is this much above that of the upper seven. Only controllers below this
/// number have such a partner.
pub const LOWER: u8 = 32;
/// Largest number of positions that one relative message can report, in either direction.
const MOST_STEPS: i64 = 63;
/// Meaning of the value in a control change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Kind {
    /// 0 at the first position to 127 at the last. Without end stops, each position up adds 1 and each down subtracts 1, within 0
    /// and 127.
    #[value(name = "7-bit")]
    Seven,
    /// As 7-bit, but from 0 to 16383, in two control changes.
    #[value(name = "14-bit")]
    Fourteen,
    /// The number of positions turned since the last message, as two's complement of 7 bits: 1 is one up, 127 is one down.
    #[value(name = "relative")]
    Relative,
}

/// The knob's MIDI channel and controller, the controller's value, and how the value is encoded.
#[derive(Debug, Clone, Copy)]
pub struct Knob {
    /// Channel from 0 to 15.
    pub channel: u8,
    pub controller: u8,
    pub kind: Kind,
    pub value: u16,
    /// Upper seven bits of the last received 14-bit value.
    pub upper: u8,
}

/// What a received message means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Heard {
    Nothing,
    Value(u16),
    Program(u8),
}

impl Knob {
    const fn most(self) -> u16 {
        match self.kind {
            Kind::Fourteen => 16_383,
            Kind::Seven | Kind::Relative => 127,
        }
    }

    pub fn within(self, value: i64) -> u16 {
        value.clamp(0, self.most().into()) as u16
    }

    /// Whether a received value equals the one that was sent. Programs send back the values that they receive.
    pub const fn is_own(self, value: u16) -> bool {
        // The upper seven bits of a 14-bit value arrive first, in a message of their own.
        let is_upper = matches!(self.kind, Kind::Fourteen) && value == self.value & !0x7f;
        value == self.value || is_upper
    }

    /// The bytes to send for a change of position; empty if the value does not change.
    pub fn turned(&mut self, place: &Place, ends: Option<(i64, i64)>) -> Vec<u8> {
        if place.change == 0 {
            return Vec::new();
        }
        if self.kind == Kind::Relative {
            return self.steps(place.change);
        }
        let value = match ends {
            Some((first, last)) if first < last => {
                let share = place.position.saturating_sub(first) as f64 / (last - first) as f64;
                self.within((share * f64::from(self.most())).round() as i64)
            }
            Some(_) => 0,
            None => self.within(i64::from(self.value).saturating_add(place.change)),
        };
        if std::mem::replace(&mut self.value, value) == value {
            return Vec::new();
        }
        let status = CONTROL_CHANGE | self.channel;
        let [upper, lower] = [value >> 7, value & 0x7f].map(|bits| bits as u8);
        match self.kind {
            Kind::Fourteen => vec![
                status,
                self.controller,
                upper,
                status,
                self.controller + LOWER,
                lower,
            ],
            Kind::Seven | Kind::Relative => vec![status, self.controller, lower],
        }
    }

    fn steps(self, mut change: i64) -> Vec<u8> {
        let mut bytes = Vec::new();
        while change != 0 {
            let step = change.clamp(-MOST_STEPS, MOST_STEPS);
            change -= step;
            bytes.extend([
                CONTROL_CHANGE | self.channel,
                self.controller,
                (step & 0x7f) as u8,
            ]);
        }
        bytes
    }

    pub fn heard(&mut self, [status, one, two]: [u8; 3]) -> Heard {
        if status == PROGRAM_CHANGE | self.channel {
            return Heard::Program(one);
        }
        if status != CONTROL_CHANGE | self.channel {
            return Heard::Nothing;
        }
        match self.kind {
            Kind::Seven if one == self.controller => Heard::Value(two.into()),
            Kind::Fourteen if one == self.controller => {
                self.upper = two;
                // The upper bits begin a new value, so the lower bits of an earlier value are dropped.
                Heard::Value(u16::from(two) << 7)
            }
            Kind::Fourteen if one == self.controller + LOWER => {
                Heard::Value(u16::from(self.upper) << 7 | u16::from(two))
            }
            _ => Heard::Nothing,
        }
    }
}

/// Finds channel messages in a stream of MIDI bytes. Supports running status; skips real-time bytes and system messages.
#[derive(Debug, Default)]
pub struct Parser {
    /// The status byte to which the next data bytes belong; 0 if there is none.
    status: u8,
    first: Option<u8>,
}

impl Parser {
    /// Takes one byte. Returns the channel message that the byte completes. The third byte is 0 in a message with only one data
    /// byte.
    pub fn push(&mut self, byte: u8) -> Option<[u8; 3]> {
        match byte {
            // Real-time bytes may occur inside any message.
            0xf8.. => None,
            0xf0..=0xf7 => {
                (self.status, self.first) = (0, None);
                None
            }
            0x80..=0xef => {
                (self.status, self.first) = (byte, None);
                None
            }
            _ if self.status == 0 => None,
            data => {
                // Program change and channel pressure have one data byte.
                if matches!(self.status & 0xf0, PROGRAM_CHANGE | 0xd0) {
                    return Some([self.status, data, 0]);
                }
                match self.first.take() {
                    Some(first) => Some([self.status, first, data]),
                    None => {
                        self.first = Some(data);
                        None
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Heard, Kind, Knob, Parser};
    use touchstone_sim::positions::Place;

    fn knob(kind: Kind) -> Knob {
        Knob {
            channel: 2,
            controller: 16,
            kind,
            value: 0,
            upper: 0,
        }
    }

    fn to(position: i64, change: i64) -> Place {
        Place {
            position,
            change,
            beside: 0.0,
        }
    }

    #[test]
    fn a_dial_goes_from_0_to_127() {
        let mut seven = knob(Kind::Seven);
        let ends = Some((-5, 5));
        for (position, value) in [(-4, 13), (0, 64), (5, 127), (-5, 0)] {
            let sent = seven.turned(&to(position, 1), ends);
            assert_eq!(sent, [0xb2, 16, value], "{position}");
        }
        // Nothing is sent for a renumbered position, nor for a value that does not change.
        assert!(seven.turned(&to(5, 0), ends).is_empty());
        assert!(seven.turned(&to(-5, -1), ends).is_empty());
        assert!(seven.turned(&to(0, 1), Some((0, 0))).is_empty());
    }

    #[test]
    fn a_dial_of_14_bits_sends_the_upper_seven_first() {
        let mut fourteen = knob(Kind::Fourteen);
        let ends = Some((0, 3));
        for (position, upper, lower) in [(1, 42, 85), (2, 85, 42), (3, 127, 127), (0, 0, 0)] {
            let sent = fourteen.turned(&to(position, 1), ends);
            assert_eq!(sent, [0xb2, 16, upper, 0xb2, 48, lower], "{position}");
        }
    }

    #[test]
    fn a_knob_without_ends_turns_back_at_once() {
        let mut seven = knob(Kind::Seven);
        seven.value = 125;
        let sent: Vec<_> = [1, 4, -1, -200]
            .map(|change| seven.turned(&to(0, change), None))
            .concat();
        assert_eq!(
            sent,
            [0xb2, 16, 126, 0xb2, 16, 127, 0xb2, 16, 126, 0xb2, 16, 0]
        );
    }

    #[test]
    fn relative_steps_are_twos_complement_and_lose_none() {
        let mut relative = knob(Kind::Relative);
        for (change, values) in [
            (1, &[1][..]),
            (-1, &[127]),
            (63, &[63]),
            (-64, &[65, 127]),
            (130, &[63, 63, 4]),
        ] {
            let sent = relative.turned(&to(0, change), Some((0, 9)));
            let expected: Vec<u8> = values.iter().flat_map(|it| [0xb2, 16, *it]).collect();
            assert_eq!(sent, expected, "{change}");
        }
    }

    #[test]
    fn messages_are_found_in_any_stream() {
        let mut parser = Parser::default();
        let stream = [
            5, 6, // data without a status
            0xb2, 16, 0xf8, 100, // a clock inside
            16, 101, // running status
            0xc2, 3, 4, // two program changes
            0xf0, 1, 2, 3, 0xf7, 9, // system exclusive, and data after it
            0xb2, 16, 0xb2, 16, 7, // a message that was cut
            0xd2, 8, 0x92, 60, 64, 0xe2, 0, 65, // what is not for a knob
        ];
        let found: Vec<_> = stream.iter().filter_map(|it| parser.push(*it)).collect();
        assert_eq!(
            found,
            [
                [0xb2, 16, 100],
                [0xb2, 16, 101],
                [0xc2, 3, 0],
                [0xc2, 4, 0],
                [0xb2, 16, 7],
                [0xd2, 8, 0],
                [0x92, 60, 64],
                [0xe2, 0, 65]
            ]
        );
    }

    #[test]
    fn a_value_that_a_program_sends_back_is_known() {
        let mut seven = knob(Kind::Seven);
        seven.value = 64;
        assert!(seven.is_own(64) && !seven.is_own(63) && !seven.is_own(0));
        // The upper seven bits of a 14-bit value arrive first, in a message of their own.
        let mut fourteen = knob(Kind::Fourteen);
        fourteen.value = (42 << 7) | 85;
        for (message, is_own) in [
            ([0xb2, 16, 42], true),
            ([0xb2, 48, 85], true),
            ([0xb2, 48, 84], false),
            ([0xb2, 16, 43], false),
        ] {
            match fourteen.heard(message) {
                Heard::Value(value) => assert_eq!(fourteen.is_own(value), is_own, "{message:x?}"),
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn a_message_is_for_this_knob_or_for_none() {
        let mut seven = knob(Kind::Seven);
        assert_eq!(seven.heard([0xb2, 16, 99]), Heard::Value(99));
        assert_eq!(seven.heard([0xc2, 4, 0]), Heard::Program(4));
        for other in [[0xb1, 16, 99], [0xb2, 17, 99], [0xc1, 4, 0], [0x92, 16, 9]] {
            assert_eq!(seven.heard(other), Heard::Nothing, "{other:x?}");
        }
        let mut fourteen = knob(Kind::Fourteen);
        assert_eq!(fourteen.heard([0xb2, 16, 1]), Heard::Value(128));
        assert_eq!(fourteen.heard([0xb2, 48, 3]), Heard::Value(131));
        assert_eq!(knob(Kind::Relative).heard([0xb2, 16, 1]), Heard::Nothing);
    }
}
