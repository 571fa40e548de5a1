//! Between the tree and the settings of the control law.

use super::{Decimal, DeviceSettings, FilterSettings, WallSettings};
use touchstone_control as law;

impl WallSettings {
    /// The settings of a law and the place of its surface, rad.
    #[must_use]
    pub fn of(settings: &law::Settings, surface_rad: Decimal) -> Self {
        Self {
            surface_rad,
            law: settings.law.into(),
            k_desired_n_m_per_rad: Decimal(settings.k_desired),
            k_soft_n_m_per_rad: Decimal(settings.k_soft),
            device_damping_n_m_s_per_rad: Decimal(settings.device_damping),
            virtual_damping_n_m_s_per_rad: Decimal(settings.virtual_damping),
            observer: settings.observer.into(),
            count_device_damping: settings.count_device_damping,
            first_contact: settings.first_contact.into(),
            regulate: settings.regulate.into(),
            offset_update: settings.offset_update.into(),
            ideal_step: settings.ideal_step.into(),
            step_of_ideal: Decimal(settings.step_of_ideal),
            limit_of_force: Decimal(settings.limit_of_force),
            limit_of_penetration: Decimal(settings.limit_of_penetration),
            filter: FilterSettings {
                mass_kg_m2: Decimal(settings.filter.mass),
                stiffness_n_m_per_rad: Decimal(settings.filter.stiffness),
                damping_n_m_s_per_rad: Decimal(settings.filter.damping),
                ground_damping_n_m_s_per_rad: Decimal(settings.filter.ground_damping),
            },
            energy_credit_j: Decimal(settings.energy_credit),
            force_limit_n_m: Decimal(settings.force_limit),
        }
    }
}

impl DeviceSettings {
    /// What the control law needs; not validated.
    #[must_use]
    pub fn law(&self) -> law::Settings {
        let wall = &self.wall;
        law::Settings {
            law: wall.law.into(),
            rate_hz: self.control.rate_hz,
            k_desired: wall.k_desired_n_m_per_rad.0,
            k_soft: wall.k_soft_n_m_per_rad.0,
            device_damping: wall.device_damping_n_m_s_per_rad.0,
            virtual_damping: wall.virtual_damping_n_m_s_per_rad.0,
            observer: wall.observer.into(),
            count_device_damping: wall.count_device_damping,
            first_contact: wall.first_contact.into(),
            regulate: wall.regulate.into(),
            offset_update: wall.offset_update.into(),
            ideal_step: wall.ideal_step.into(),
            step_of_ideal: wall.step_of_ideal.0,
            limit_of_force: wall.limit_of_force.0,
            limit_of_penetration: wall.limit_of_penetration.0,
            filter: law::FilterSettings {
                mass: wall.filter.mass_kg_m2.0,
                stiffness: wall.filter.stiffness_n_m_per_rad.0,
                damping: wall.filter.damping_n_m_s_per_rad.0,
                ground_damping: wall.filter.ground_damping_n_m_s_per_rad.0,
            },
            energy_credit: wall.energy_credit_j.0,
            force_limit: wall.force_limit_n_m.0,
        }
    }
}
