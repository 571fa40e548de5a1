//! The address of a device: a serial port, given by name or found automatically, or a TCP socket of an emulator or serial server.

use serialport::{SerialPortInfo, SerialPortType};
use std::fmt;
use std::str::FromStr;
use touchstone_sim::error::{Error, Result};

/// USB vendor number of STMicroelectronics.
const VENDOR_ST: u16 = 0x0483;

/// The address of a device: a serial port or a TCP socket.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Address {
    /// A serial port by its name, e.g. `/dev/ttyACM0` or `COM3`.
    Serial(String),
    /// A TCP address `HOST:PORT` of an emulator or a serial server.
    Tcp(String),
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Address::Serial(name) => f.write_str(name),
            Address::Tcp(socket) => write!(f, "tcp:{socket}"),
        }
    }
}

impl FromStr for Address {
    type Err = String;
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        match text.strip_prefix("tcp:") {
            None if text.is_empty() => {
                Err("is empty; give /dev/ttyACM0, COM3 or tcp:HOST:PORT".into())
            }
            None => Ok(Address::Serial(text.into())),
            Some(socket) => match socket.rsplit_once(':') {
                Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => {
                    Ok(Address::Tcp(socket.into()))
                }
                _ => Err("is not HOST:PORT; give e.g. tcp:localhost:4000".into()),
            },
        }
    }
}

/// A serial port of this machine, as the operating system lists it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Port {
    /// Name under which the operating system opens the port.
    pub name: String,
    /// Whether the port is the virtual serial port of an ST-LINK debug probe.
    pub st_link: bool,
    /// Description of the port, for people.
    pub about: String,
}

impl From<SerialPortInfo> for Port {
    fn from(info: SerialPortInfo) -> Self {
        match info.port_type {
            SerialPortType::UsbPort(usb) => Port {
                name: info.port_name,
                // The product number identifies an ST-LINK; ST's other virtual serial ports have the same vendor number.
                st_link: usb.vid == VENDOR_ST && is_st_link(usb.pid),
                // The product name comes from the device and may contain any characters.
                about: touchstone_sim::harmless::one_line(&format!(
                    "USB {:04x}:{:04x} {}",
                    usb.vid,
                    usb.pid,
                    usb.product.unwrap_or_default()
                )),
            },
            _ => Port {
                name: info.port_name,
                st_link: false,
                about: "no USB port".into(),
            },
        }
    }
}

/// Whether a USB product number is that of an ST-LINK of any version, with or without a virtual serial port.
#[must_use]
pub const fn is_st_link(product: u16) -> bool {
    matches!(
        product,
        0x3744 | 0x3748 | 0x374a | 0x374b | 0x374d | 0x374e | 0x374f | 0x3752..=0x3755 | 0x3757
    )
}

/// All serial ports of this machine, those of ST-LINKs first.
#[must_use]
pub fn ports() -> Vec<Port> {
    let mut ports: Vec<Port> = serialport::available_ports()
        .unwrap_or_default()
        .into_iter()
        .map(Port::from)
        .collect();
    ports.sort_by_key(|port| (!port.st_link, port.name.clone()));
    ports
}

impl Address {
    /// The given address, or else the only ST-LINK port of this machine.
    ///
    /// # Errors
    /// No address is given, and this machine has no ST-LINK port or more than one.
    pub fn given_or_found(given: Option<&Address>) -> Result<Address> {
        match given {
            Some(address) => Ok(address.clone()),
            None => Self::among(&ports()),
        }
    }

    /// The address of the only ST-LINK port in `ports`.
    ///
    /// # Errors
    /// `ports` has no ST-LINK port or more than one.
    fn among(ports: &[Port]) -> Result<Address> {
        let own: Vec<&Port> = ports.iter().filter(|port| port.st_link).collect();
        let wrong = |problem: String, fix: &str| Err(Error::device("port", problem, fix));
        match (own.as_slice(), ports) {
            ([one], _) => Ok(Address::Serial(one.name.clone())),
            ([], []) => wrong(
                "there is no serial port".into(),
                "connect the board, or see `touchstone doctor`",
            ),
            ([], _) => wrong(
                format!("no ST-LINK among {}", names(ports.iter())),
                "connect the board, or choose one with --port; see `touchstone doctor`",
            ),
            (several, _) => wrong(
                format!(
                    "{} ST-LINKs: {}",
                    several.len(),
                    names(several.iter().copied())
                ),
                "choose one with --port",
            ),
        }
    }
}

fn names<'p>(ports: impl Iterator<Item = &'p Port>) -> String {
    let names: Vec<String> = ports
        .map(|port| format!("{} ({})", port.name, port.about.trim()))
        .collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn port(name: &str, st_link: bool) -> Port {
        Port {
            name: name.into(),
            st_link,
            about: "USB".into(),
        }
    }

    #[test]
    fn the_one_st_link_is_taken_and_of_several_none() {
        let (a, b, c) = (port("a", true), port("b", false), port("c", true));
        let found = Address::among(&[a.clone(), b.clone()]);
        assert_eq!(found, Ok(Address::Serial("a".into())));
        for (ports, part) in [
            (vec![], "there is no serial port"),
            (vec![b], "no ST-LINK among b (USB)"),
            (vec![a, c], "2 ST-LINKs: a (USB), c (USB)"),
        ] {
            let error = Address::among(&ports).expect_err(part);
            assert!(error.to_string().contains(part), "{error}");
            assert_eq!(error.exit_code(), 1);
        }
    }

    #[test]
    fn addresses_come_back_as_written() {
        for text in [
            "/dev/ttyACM0",
            "COM3",
            "tcp:localhost:4000",
            "tcp:[::1]:4000",
        ] {
            assert_eq!(
                text.parse::<Address>().map(|a| a.to_string()),
                Ok(text.into())
            );
        }
        for text in [
            "",
            "tcp:",
            "tcp:host",
            "tcp::1",
            "tcp:host:x",
            "tcp:host:70000",
        ] {
            assert!(text.parse::<Address>().is_err(), "{text}");
        }
    }
}
