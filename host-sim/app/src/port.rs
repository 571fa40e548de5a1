//! The option `--port`, the same for every command that speaks to a device.

use touchstone_device::{Address, Client};
use touchstone_sim::error::{Error, Result};

/// Where the device is.
#[derive(Debug, Clone, clap::Args)]
pub struct PortOption {
    /// Serial port (/dev/ttyACM0, COM3) or tcp:HOST:PORT; without it, the one ST-LINK port that there is.
    #[arg(long, value_name = "PORT", global = true)]
    port: Option<Address>,
}

impl PortOption {
    /// Refuses the option where there is no port to speak to.
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

    /// Connects to the device.
    pub fn connect(&self) -> Result<Client> {
        Client::connect(&self.address()?)
    }

    /// The address that was given, or found.
    pub fn address(&self) -> Result<Address> {
        Address::given_or_found(self.port.as_ref())
    }
}
