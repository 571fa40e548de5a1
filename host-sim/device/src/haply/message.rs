//! The JSON messages to and from the maker's service for an Inverse3.

use crate::haptic::DeviceStanding;
use serde_json::{Value, json};

/// The two formats of messages of Haply's service. They differ in the name of the JSON field that holds the force vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Generation {
    /// Service versions up to 3.4: the vector is called `values`.
    Values,
    /// Service versions from 3.5 on: the vector is called `vector`.
    Vector,
}

impl Generation {
    /// Reads the service's version from a text: the first number with a decimal point.
    ///
    /// # Errors
    /// The text has no such number, or the version is not 3.x, the only one whose messages are known.
    pub fn of(version: &str) -> Result<Self, String> {
        let (major, minor) = Self::numbers(version).ok_or("says no version")?;
        match (major, minor) {
            (3, ..5) => Ok(Self::Values),
            (3, _) => Ok(Self::Vector),
            _ => Err(format!("has version {major}.{minor}, and only 3 is known")),
        }
    }

    fn numbers(version: &str) -> Option<(u32, u32)> {
        let mut words = version.split(|letter: char| !letter.is_ascii_digit() && letter != '.');
        let numbers = words
            .find(|word| word.contains('.') && word.starts_with(|c: char| c.is_ascii_digit()))?;
        let mut parts = numbers.split('.').map(str::parse::<u32>);
        Some((parts.next()?.ok()?, parts.next()?.ok()?))
    }

    /// The message that commands a force, N.
    #[must_use]
    pub fn force(self, device: &str, [x, y, z]: [f64; 3]) -> String {
        let key = match self {
            Self::Values => "values",
            Self::Vector => "vector",
        };
        json!({ "inverse3": [{
            "device_id": device,
            "commands": { "set_cursor_force": { key: { "x": x, "y": y, "z": z } } },
        }] })
        .to_string()
    }
}

/// A device's state, as a message of the service reports it.
#[derive(Debug, Clone, PartialEq)]
pub struct CursorState {
    /// The name of the device.
    pub device: String,
    /// Position of the handle in the device's own frame, m.
    pub position_m: [f64; 3],
    /// Whether the device has its supply, is calibrated and has its motors on.
    pub standing: DeviceStanding,
}

impl CursorState {
    /// Reads a device's state from a message: that of the device with this name, or of the first device in the message.
    ///
    /// # Errors
    /// A description of what is wrong with the message.
    pub fn of(text: &str, device: Option<&str>) -> Result<Self, String> {
        let message: Value = serde_json::from_str(text).map_err(|why| why.to_string())?;
        let all = message["inverse3"]
            .as_array()
            .map_or(&[][..], Vec::as_slice);
        let named = |entry: &&Value| device.is_none_or(|name| entry["device_id"] == name);
        let entry = all.iter().find(named).ok_or("no Inverse3 in the message")?;
        let name = entry["device_id"]
            .as_str()
            .ok_or("a device without device_id")?;
        let place = &entry["state"]["cursor_position"];
        let axis = |name: &str| {
            place[name]
                .as_f64()
                .ok_or(format!("no cursor_position.{name}"))
        };
        // A status that a generation of messages does not contain counts as good.
        let says_no = |name: &str| entry["status"][name] == false;
        Ok(Self {
            device: name.to_owned(),
            position_m: [axis("x")?, axis("y")?, axis("z")?],
            standing: DeviceStanding {
                powered: !says_no("power_supply"),
                calibrated: !says_no("calibrated"),
                motors_on: !says_no("ready"),
                switched_off: None,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn generations_follow_the_version() {
        for (text, generation) in [
            ("3.1.4", Ok(Generation::Values)),
            (r#"{"version":"3.5.0","x":1}"#, Ok(Generation::Vector)),
            ("v3.10", Ok(Generation::Vector)),
            ("4.0", Err("has version 4.0, and only 3 is known".into())),
            ("2.0.1", Err("has version 2.0, and only 3 is known".into())),
            ("no number", Err("says no version".into())),
            ("3.99999999999", Err("says no version".into())),
        ] {
            assert_eq!(Generation::of(text), generation, "{text}");
        }
        let old = Generation::Values.force("049D", [0.0, 1.0, 0.5]);
        let new = Generation::Vector.force("049D", [0.0, 1.0, 0.5]);
        assert!(
            old.contains(r#""values":{"x":0.0,"y":1.0,"z":0.5}"#),
            "{old}"
        );
        assert!(
            new.contains(r#""vector":{"x":0.0,"y":1.0,"z":0.5}"#),
            "{new}"
        );
    }

    #[test]
    fn states_are_read_and_what_is_wrong_is_said() {
        let good = r#"{"inverse3":[{"device_id":"A","state":{"cursor_position":{"x":1,"y":2,"z":3}},"status":{"calibrated":false}}]}"#;
        let state = CursorState::of(good, Some("A")).unwrap();
        assert_eq!(state.position_m, [1.0, 2.0, 3.0]);
        assert!(state.standing.powered && !state.standing.calibrated);
        for (text, part) in [
            (good, "no Inverse3"),
            ("{}", "no Inverse3"),
            (
                r#"{"inverse3":[{"device_id":"B","state":{"cursor_position":{"x":null,"y":2,"z":3}}}]}"#,
                "cursor_position.x",
            ),
            ("{", "EOF"),
        ] {
            let said = CursorState::of(text, Some("B")).expect_err(text);
            assert!(said.contains(part), "{said}");
        }
    }
}
