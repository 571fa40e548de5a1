//! The unit of length of a device, chosen when the coefficients are computed.
//!
//! The metre is too long a unit for a haptic device. [`Fixed32`](crate::Fixed32) has stiffnesses up to 524,287, but the effector
//! of an omega.3 at 4 kHz has a mass over squared control period of 2.4e6 N/m. Compliances have steps of 6e-8, so the inverse of
//! that device's soft stiffness, 2e-4 m/N, has three digits only. In centimetres the same values are 24,000 N/cm and 0.02 cm/N,
//! with six digits. Positions then reach ±1.28 m in steps of 0.6 nm, stiffnesses 52 kN/mm, and an energy is in units of 10 mJ. In
//! millimetres the energy guard's account would end at 32 mJ. So `Centimetre` is the unit of three axes. Knobs use the radian in
//! the place of the metre. Laws do not depend on the unit: newtons stay newtons, and a tick has no length.
//!
//! A value that still does not fit (0.7 kg at 10 kHz) is refused with an error that names its setting.

use super::number::Spatial;
use super::place_estimator::PlaceEstimator;
use crate::law::Impact;
use crate::{
    AnyLaw, EstimatorSettings, FilterSettings, GuardSettings, GuardedDevice, Number, Settings,
    SettingsError, Si, StatesKind, VelocityKind, VelocitySettings,
};

/// The length that counts as 1 in the number format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LengthUnit {
    /// Metre; energies are in J.
    Metre,
    /// Centimetre; energies are in 10 mJ.
    #[default]
    Centimetre,
    /// Millimetre; energies are in mJ. The energy guard's account then ends at 32 mJ.
    Millimetre,
}

impl LengthUnit {
    /// Number of these units per metre.
    #[must_use]
    pub fn per_metre(self) -> u32 {
        match self {
            Self::Metre => 1,
            Self::Centimetre => 100,
            Self::Millimetre => 1000,
        }
    }

    /// Converts a length, an energy, a speed or a power from SI units to this unit of length.
    #[must_use]
    pub fn of_length(self, si: Si) -> Si {
        si.saturating_mul(Si::saturating_from_num(self.per_metre()))
    }

    /// Converts a stiffness, a damping or a mass from SI units to this unit of length. Rounded down, so that no device counts as
    /// more damped than it is.
    #[must_use]
    pub fn per_length(self, si: Si) -> Si {
        si.saturating_div(Si::saturating_from_num(self.per_metre()))
    }

    /// Converts the settings of a law from SI units to this unit of length.
    #[must_use]
    pub fn settings(self, si: &Settings) -> Settings {
        let filter = FilterSettings {
            mass: self.per_length(si.filter.mass),
            stiffness: self.per_length(si.filter.stiffness),
            damping: self.per_length(si.filter.damping),
            ground_damping: self.per_length(si.filter.ground_damping),
        };
        Settings {
            k_desired: self.per_length(si.k_desired),
            k_soft: self.per_length(si.k_soft),
            device_damping: self.per_length(si.device_damping),
            virtual_damping: self.per_length(si.virtual_damping),
            energy_credit: self.of_length(si.energy_credit),
            filter,
            // A law's coefficients depend on these settings only; on three axes, guard and estimator have their own settings.
            guard: GuardSettings {
                on: false,
                ..GuardSettings::default()
            },
            states: StatesKind::Measured,
            // A velocity filter needs an axis with a fixed direction, and the normal turns.
            velocity: VelocitySettings {
                from: VelocityKind::Told,
                ..VelocitySettings::default()
            },
            ..*si
        }
    }

    /// Makes a law from settings in SI units; the law calculates in this unit of length.
    ///
    /// # Errors
    /// Same as [`AnyLaw::new`]. An error reports ranges in SI units, and a coefficient that does not fit in this unit of length.
    pub fn law<N: Number>(self, si: &Settings) -> Result<AnyLaw<N>, SettingsError> {
        let unit = self.settings(si);
        // Ranges are checked in SI units, without the guard and the estimator of one axis, which are not used here.
        Settings {
            guard: unit.guard,
            states: unit.states,
            ..*si
        }
        .validate()?;
        AnyLaw::new(&unit)
    }

    /// Makes pulse and vibration at the touch from settings in SI units; `None` if the settings have neither, or use measured
    /// states.
    ///
    /// # Errors
    /// A coefficient of pulse or vibration does not fit the number format in this unit.
    pub fn impact<N: Number>(self, si: &Settings) -> Result<Option<Impact<N>>, SettingsError> {
        let estimator = EstimatorSettings {
            inertia: self.per_length(si.estimator.inertia),
            ..si.estimator
        };
        Impact::pulse_of(&Settings {
            estimator,
            states: si.states,
            ..self.settings(si)
        })
    }

    /// Makes a state estimator for each axis, from settings in SI units.
    ///
    /// # Errors
    /// Same as [`EstimatorSettings::estimator`]; an error gives ranges in this unit of length.
    pub fn estimator<N: Spatial>(
        self,
        si: &[EstimatorSettings; 3],
        rate_hz: u32,
        force_limit: Si,
    ) -> Result<PlaceEstimator<N>, SettingsError> {
        let axis = |si: &EstimatorSettings| {
            let unit = EstimatorSettings {
                inertia: self.per_length(si.inertia),
                damping: self.per_length(si.damping),
                ..*si
            };
            unit.estimator(rate_hz, force_limit)
        };
        let [x, y, z] = si;
        Ok(PlaceEstimator::new([axis(x)?, axis(y)?, axis(z)?]))
    }

    /// Converts the settings of the energy guard, and the device's properties, from SI units to this unit of length.
    #[must_use]
    pub fn guard(
        self,
        si: &GuardSettings,
        device: &GuardedDevice,
    ) -> (GuardSettings, GuardedDevice) {
        (
            GuardSettings {
                capacity: self.of_length(si.capacity),
                refill: self.of_length(si.refill),
                overspeed: self.of_length(si.overspeed),
                damping: self.per_length(si.damping),
                ..*si
            },
            GuardedDevice {
                count: self.of_length(device.count),
                ..*device
            },
        )
    }
}
