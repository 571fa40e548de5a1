//! Quantities as `f64` in SI units, for reports and for simulated devices.

use super::{Energy, Force, Position};
use crate::Reported;

macro_rules! signal_reported {
    ($quantity:ident) => {
        impl<N: Reported> $quantity<N> {
            /// The value in SI units.
            #[inline(always)]
            #[must_use]
            pub fn to_f64(self) -> f64 {
                N::signal_to_f64(self.0)
            }
            /// The value nearest to a number in SI units, saturating.
            #[inline(always)]
            #[must_use]
            pub fn from_f64(x: f64) -> Self {
                Self(N::signal_from_f64(x))
            }
        }
    };
}
signal_reported!(Position);
signal_reported!(Force);

impl<N: Reported> Energy<N> {
    /// The value in J.
    #[inline(always)]
    #[must_use]
    pub fn to_f64(self) -> f64 {
        N::energy_to_f64(self.0)
    }
}
