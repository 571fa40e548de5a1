//! The boards for which there is firmware.

/// The boards for which there is firmware.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Board {
    /// NUCLEO-G474RE with the motor driver shield X-NUCLEO-IHM08M1.
    NucleoG474re,
    /// B-G431B-ESC1, a board with microcontroller and motor driver.
    BG431bEsc1,
    /// NUCLEO-G474RE with the motor driver shield X-NUCLEO-IHM16M1.
    NucleoG474reIhm16m1,
    /// NUCLEO-G474RE with the motor driver board SimpleFOC Mini, which measures no current.
    NucleoG474reSimplefocMini,
    /// NUCLEO-G431RB with the motor driver shield X-NUCLEO-IHM16M1: the kit P-NUCLEO-IHM03.
    NucleoG431rbIhm16m1,
}

impl Board {
    /// All boards for which there is firmware.
    pub const ALL: [Self; 5] = [
        Self::NucleoG474re,
        Self::BG431bEsc1,
        Self::NucleoG474reIhm16m1,
        Self::NucleoG474reSimplefocMini,
        Self::NucleoG431rbIhm16m1,
    ];

    /// The board's name on the command line and in file names.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NucleoG474re => "nucleo-g474re",
            Self::BG431bEsc1 => "b-g431b-esc1",
            Self::NucleoG474reIhm16m1 => "nucleo-g474re-ihm16m1",
            Self::NucleoG474reSimplefocMini => "nucleo-g474re-simplefoc-mini",
            Self::NucleoG431rbIhm16m1 => "nucleo-g431rb-ihm16m1",
        }
    }

    /// Names of the products of which the board consists.
    #[must_use]
    pub const fn parts(self) -> &'static str {
        match self {
            Self::NucleoG474re => "NUCLEO-G474RE with an X-NUCLEO-IHM08M1",
            Self::BG431bEsc1 => "B-G431B-ESC1",
            Self::NucleoG474reIhm16m1 => "NUCLEO-G474RE with an X-NUCLEO-IHM16M1",
            Self::NucleoG474reSimplefocMini => "NUCLEO-G474RE with a SimpleFOC Mini",
            Self::NucleoG431rbIhm16m1 => "NUCLEO-G431RB with an X-NUCLEO-IHM16M1",
        }
    }

    /// Name of the board's microcontroller in the flashing tool `probe-rs`.
    #[must_use]
    pub const fn chip(self) -> &'static str {
        match self {
            Self::BG431bEsc1 => "STM32G431CBUx",
            Self::NucleoG431rbIhm16m1 => "STM32G431RBTx",
            Self::NucleoG474re | Self::NucleoG474reIhm16m1 | Self::NucleoG474reSimplefocMini => {
                "STM32G474RETx"
            }
        }
    }

    /// Whether the board's connectors have the SPI bus for a magnetic encoder.
    #[must_use]
    pub const fn has_bus(self) -> bool {
        !matches!(self, Self::BG431bEsc1)
    }

    /// Whether the board's flash has room for the program that renders more than one wall. The STM32G431's flash does not.
    #[must_use]
    pub const fn is_large(self) -> bool {
        !matches!(self, Self::BG431bEsc1 | Self::NucleoG431rbIhm16m1)
    }

    /// Whether the board measures its motor's currents.
    ///
    /// A board without current sensors controls the motor's voltage. The voltage makes a known torque only if the motor's settings
    /// are right. Such a board cannot measure a motor.
    #[must_use]
    pub const fn senses_current(self) -> bool {
        !matches!(self, Self::NucleoG474reSimplefocMini)
    }

    /// Whether the board has an analogue output for an external amplifier.
    #[must_use]
    pub const fn has_analogue(self) -> bool {
        matches!(self, Self::NucleoG474re)
    }
}
