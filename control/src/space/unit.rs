//! The unit of length of a device, chosen when its coefficients are built.
//!
//! A metre is too long for a haptic device. [`Fixed32`](crate::Fixed32) has stiffnesses up to 524,287, and an omega.3's effector at 4 kHz is a `m/T²` of
//! 2.4e6 N/m; compliances in steps of 6e-8, and 1/k_v of that device is 2e-4 m/N, to three digits. In centimetres the same
//! are 24,000 N/cm and 0.02 cm/N to six digits. Positions reach ±1.28 m in steps of 0.6 nm, stiffnesses 52 kN/mm, and an energy is in
//! units of 10 mJ. In millimetres the energy guard's account would end at 32 mJ. So `Centimetre` is the unit of three axes, and a metre of arc, the radian, that of knobs. Laws do not
//! know: newtons stay newtons, and a tick is free of the unit.
//!
//! What still does not fit (0.7 kg at 10 kHz) is refused by the error of the coefficient's own field.

use super::number::Spatial;
use super::place_estimator::PlaceEstimator;
use crate::settings::{FilterSettings, Settings, Si};
use crate::{
    AnyLaw, EstimatorSettings, GuardSettings, GuardedDevice, Number, SettingsError, StatesKind,
    VelocityKind, VelocitySettings,
};

/// The length that counts as 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LengthUnit {
    /// Metre; energies are in J.
    Metre,
    /// cm: energies in 10 mJ.
    #[default]
    Centimetre,
    /// Millimetre; energies are in mJ.
    Millimetre,
}

impl LengthUnit {
    /// How many of these units are a metre.
    #[must_use]
    pub fn per_metre(self) -> u32 {
        match self {
            Self::Metre => 1,
            Self::Centimetre => 100,
            Self::Millimetre => 1000,
        }
    }

    /// A length, an energy, a speed or a power, given in SI, in this unit.
    #[must_use]
    pub fn of_length(self, si: Si) -> Si {
        si.saturating_mul(Si::saturating_from_num(self.per_metre()))
    }

    /// A stiffness, a damping or a mass, given in SI, in this unit. Rounded down: a device has not more damping by it.
    #[must_use]
    pub fn per_length(self, si: Si) -> Si {
        si.saturating_div(Si::saturating_from_num(self.per_metre()))
    }

    /// The settings of a law, given in SI, in this unit.
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
            // A law's coefficients are built of these alone; guard and estimator of three axes have their own.
            guard: GuardSettings {
                on: false,
                ..GuardSettings::default()
            },
            states: StatesKind::Measured,
            // A direction that turns is no axis whose velocity could be filtered.
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
    /// Same as [`AnyLaw::new`]. Ranges in the error are in SI units, a coefficient that does not fit in this unit of
    /// length.
    pub fn law<N: Number>(self, si: &Settings) -> Result<AnyLaw<N>, SettingsError> {
        let unit = self.settings(si);
        // Ranges are those of SI; the guard and the estimator of one axis are none of these.
        Settings {
            guard: unit.guard,
            states: unit.states,
            ..*si
        }
        .validate()?;
        AnyLaw::new(&unit)
    }

    /// An estimator for each axis, from settings in SI.
    ///
    /// # Errors
    /// Same as [`EstimatorSettings::estimator`]; ranges are given in this unit.
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

    /// The settings of the energy guard and its device, given in SI, in this unit.
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
