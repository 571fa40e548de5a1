//! Key presses of a turned knob: a key for each position up and another for each position down.
//!
//! [`KeyPair`] turns changes of position into presses and releases. [`open`] creates a virtual keyboard of the Linux kernel
//! (`/dev/uinput`), whose key presses reach every program like those of a real keyboard. [`open`] needs the feature `uinput`;
//! without that feature, and on other systems, it returns an error that says what to do instead.

#[cfg(any(not(all(feature = "uinput", target_os = "linux")), test))]
mod absent;
#[cfg(all(feature = "uinput", target_os = "linux"))]
mod present;

#[cfg(not(all(feature = "uinput", target_os = "linux")))]
pub use absent::open;
#[cfg(all(feature = "uinput", target_os = "linux"))]
pub use present::open;

use std::fmt;
use std::str::FromStr;

/// Option of the program that names the keys, for errors.
const OPTION: &str = "--keys";

/// A keyboard on which keys can be pressed, by their names.
pub trait Keyboard {
    /// Presses a key (`true`) or releases it.
    ///
    /// # Errors
    /// The system does not take the press.
    fn set(&mut self, key: &str, is_down: bool) -> std::io::Result<()>;
}

impl fmt::Debug for dyn Keyboard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Keyboard")
    }
}

/// Names of the keys for one position up and one position down.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyPair {
    /// Key for a position with a higher number.
    pub up: String,
    /// Key for a position with a lower number.
    pub down: String,
}

impl FromStr for KeyPair {
    type Err = String;

    /// Reads `UP,DOWN`, such as `volumeup,volumedown`. [`open`] checks whether the system has keys of these names.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let is_name = |it: &str| {
            !it.is_empty()
                && it
                    .bytes()
                    .all(|it| it.is_ascii_alphanumeric() || it == b'_')
        };
        match text
            .split_once(',')
            .map(|(up, down)| (up.trim(), down.trim()))
        {
            Some((up, down)) if is_name(up) && is_name(down) => Ok(Self {
                up: up.to_lowercase(),
                down: down.to_lowercase(),
            }),
            _ => Err(format!(
                "must be two names of keys, is {text}; give two names with a comma, such as volumeup,volumedown"
            )),
        }
    }
}

impl KeyPair {
    /// Presses and releases the key for the direction of `change` as many times as the number of positions changed.
    ///
    /// # Errors
    /// The keyboard's error. A key that was pressed is released nevertheless.
    pub fn press(&self, keyboard: &mut dyn Keyboard, change: i64) -> std::io::Result<()> {
        let key = if change > 0 { &self.up } else { &self.down };
        for _ in 0..change.unsigned_abs() {
            let pressed = keyboard.set(key, true);
            keyboard.set(key, false)?;
            pressed?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Error, ErrorKind};

    /// A keyboard that records what is pressed, and fails at presses of one key.
    #[derive(Default)]
    struct Written(Vec<String>, &'static str);

    impl Keyboard for Written {
        fn set(&mut self, key: &str, is_down: bool) -> std::io::Result<()> {
            self.0
                .push(format!("{key} {}", if is_down { "down" } else { "up" }));
            match key == self.1 && is_down {
                true => Err(Error::from(ErrorKind::BrokenPipe)),
                false => Ok(()),
            }
        }
    }

    #[test]
    fn each_position_presses_and_releases_a_key_once() {
        let keys: KeyPair = "VolumeUp, volumedown".parse().unwrap();
        let mut keyboard = Written::default();
        for change in [1, 0, -3] {
            keys.press(&mut keyboard, change).unwrap();
        }
        assert_eq!(
            keyboard.0,
            [
                "volumeup down",
                "volumeup up",
                "volumedown down",
                "volumedown up",
                "volumedown down",
                "volumedown up",
                "volumedown down",
                "volumedown up"
            ]
        );
    }

    #[test]
    fn a_key_that_fails_is_released() {
        let keys: KeyPair = "a,b".parse().unwrap();
        let mut keyboard = Written(Vec::new(), "b");
        assert!(keys.press(&mut keyboard, -3).is_err());
        assert_eq!(keyboard.0, ["b down", "b up"]);
    }

    #[test]
    fn two_names_are_needed() {
        for text in ["", "a", "a,", ",b", "a,b,c", "a b,c", "a,b c", "a-b,c"] {
            let read: Result<KeyPair, _> = text.parse();
            assert!(read.is_err(), "{text:?}");
        }
        for text in ["a_1,b\n", " A_1 , b"] {
            let read: Result<KeyPair, _> = text.parse();
            let [up, down] = ["a_1", "b"].map(str::to_owned);
            assert_eq!(read, Ok(KeyPair { up, down }), "{text:?}");
        }
    }

    #[test]
    fn without_the_feature_the_error_says_how_to_get_it() {
        let keys: KeyPair = "a,b".parse().unwrap();
        let said = absent::open(&keys).unwrap_err().to_string();
        assert!(
            said.starts_with("--keys: ") && said.contains("--websocket"),
            "{said}"
        );
        if cfg!(target_os = "linux") {
            assert!(said.contains("--features keys"), "{said}");
        }
    }
}
