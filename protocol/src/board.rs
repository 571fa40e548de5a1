//! The boards.

/// The boards that there is firmware for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Board {
    /// NUCLEO-G474RE with an X-NUCLEO-IHM08M1.
    NucleoG474re,
    /// B-G431B-ESC1.
    BG431bEsc1,
}

impl Board {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::NucleoG474re, Self::BG431bEsc1];

    /// Its name on the command line and in file names.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NucleoG474re => "nucleo-g474re",
            Self::BG431bEsc1 => "b-g431b-esc1",
        }
    }
}
