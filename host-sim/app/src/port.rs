//! The option `--port`, the same for every command that connects to a device.

use touchstone_device::{Address, Client};
use touchstone_sim::error::{Error, Result};

/// Option for the device's address: a serial port or a TCP address.
#[derive(Debug, Clone, clap::Args)]
pub struct PortOption {
    /// Serial port (/dev/ttyACM0, COM3) or tcp:HOST:PORT; without it, the only ST-LINK port of this machine.
    #[arg(long, value_name = "PORT", global = true)]
    port: Option<Address>,
}

impl PortOption {
    /// Returns an error if `--port` was given for a haptic device, which has no port.
    pub fn refuse(&self) -> Result<()> {
        match self.port {
            None => Ok(()),
            Some(_) => Err(Error::Option {
                option: "--port".into(),
                problem: "haptic devices have none".into(),
                fix: "leave it out, or see --device".into(),
            }),
        }
    }

    /// Connects to the device at the address from `--port` or at the port found by search.
    pub fn connect(&self) -> Result<Client> {
        Client::connect(&self.address()?)
    }

    /// Address from `--port`; without the option, the only ST-LINK port of this machine.
    pub fn address(&self) -> Result<Address> {
        Address::given_or_found(self.port.as_ref())
    }
}
