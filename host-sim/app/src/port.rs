//! The option `--port`, the same for every command that speaks to a device.

use touchstone_device::{Address, Client};
use touchstone_sim::error::Result;

/// Where the device is.
#[derive(Debug, Clone, clap::Args)]
pub struct PortOption {
    /// Serial port (/dev/ttyACM0, COM3) or tcp:HOST:PORT; without it, the one ST-LINK port that there is.
    #[arg(long, value_name = "PORT", global = true)]
    port: Option<Address>,
}

impl PortOption {
    /// Connects.
    pub fn connect(&self) -> Result<Client> {
        Client::connect(&self.address()?)
    }

    /// What was given, or found.
    pub fn address(&self) -> Result<Address> {
        Address::given_or_found(self.port.as_ref())
    }
}
