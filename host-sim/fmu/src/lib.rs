//! FMUs of a scene: models of the Functional Mock-up Interface 3.0, which Simulink, OpenModelica and FMPy run.
//!
//! A scene gives two FMUs ([`Half`]): the control law with its energy guard, and the plant (device and hand). [`export::fmu`] packs
//! one into an archive with its [`description`], the scene and the shared library of `bindings/fmi`. That library reads the scene
//! again and calculates by [`model::Model`].

mod archive;
pub mod description;
pub mod export;
pub mod model;
pub mod variables;

/// Text that the shared library contains, so that an export refuses a library of another version.
pub const MARK: &str = concat!("touchstone-fmu ", env!("CARGO_PKG_VERSION"));

/// The half of the control loop that an FMU contains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Half {
    /// From the device's angle to the motor's torque: encoder, control law, energy guard, torque limit.
    Law,
    /// From the motor's torque to the device's angle: delays, device, hand.
    Plant,
}

impl Half {
    /// Both halves.
    pub const ALL: [Self; 2] = [Self::Law, Self::Plant];

    /// Name of the half in file names and on the command line.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Law => "law",
            Self::Plant => "plant",
        }
    }

    /// Name of the scene's file in the FMU's resources. The name tells the library which half (law or plant) it is.
    #[must_use]
    pub const fn scene_file(self) -> &'static str {
        match self {
            Self::Law => "law.toml",
            Self::Plant => "plant.toml",
        }
    }
}
