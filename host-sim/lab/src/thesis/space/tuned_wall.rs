//! Walls that were tuned for a kind of axis: the law's settings, what its estimator is told, and which devices may have them.
//!
//! Each was found by `touchstone tune` on one axis as a knob on a lever ([`crate::identify::lever`]), for the devices of [`crate::scorecard::cases`].
//! Times, lengths and forces of the law do not change with the rate, so one setting serves a range of rates; the figures at its rates are in
//! `docs/devices.md`.

use super::Mechanism;
use touchstone_control::settings::FilterSettings;
use touchstone_control::{EstimatorSettings, Settings, Si, StatesKind};
use touchstone_world::plant::{Device, OMEGA3_AXIS};

/// A tuned wall, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TunedWall {
    /// The device, for people.
    pub name: &'static str,
    /// Desired stiffness, N/m.
    pub k_desired_n_per_m: f64,
    /// Slowest and fastest rate at which it is within its limits, Hz.
    pub rates_hz: (u32, u32),
    /// Mass of the axis that it was tuned for, kg; an axis of half to double of it may use the wall.
    pub axis_kg: f64,
    /// Damping that the law counts on, N·s/m; an axis with half of it or more may use the wall.
    pub damping_n_s_per_m: f64,
    /// The damping that an axis may have at most, N·s/m.
    pub most_damping_n_s_per_m: f64,
    /// [`Settings::k_soft`], N/m.
    pub k_soft: f64,
    /// [`Settings::step_of_ideal`].
    pub step_of_ideal: f64,
    /// [`Settings::limit_of_force`].
    pub limit_of_force: f64,
    /// [`Settings::limit_of_penetration`].
    pub limit_of_penetration: f64,
    /// [`FilterSettings::mass`], kg.
    pub filter_kg: f64,
    /// [`FilterSettings::stiffness`], N/m.
    pub filter_stiffness: f64,
    /// [`FilterSettings::damping`], N·s/m.
    pub filter_damping: f64,
    /// [`FilterSettings::ground_damping`], N·s/m.
    pub ground_damping: f64,
    /// [`EstimatorSettings::bandwidth_hz`].
    pub bandwidth_hz: f64,
    /// [`EstimatorSettings::delay_s`].
    pub delay_s: f64,
    /// [`EstimatorSettings::inertia`], kg.
    pub estimator_kg: f64,
}

/// Seed 1, 2,358 settings examined: 1e-4 kg·m² are 0.148 kg at 26.0 mm, and with it 25 N/mm are 16.89 N·m/rad, 2.5 N·s/m 1.689e-3 N·m·s/rad, 12 N 0.3119 N·m and
/// 0.01 mm a count of 16,332 a turn; a press of 8 N, at 1 kHz.
///
/// But for the estimator's delay: with the 0.7143 ms that were found every direction is within every limit but one, 0.16 mJ that a hand of 0.8 kg, heavier than the knob's, gets out of a
/// device that is a whole tick late. It was raised in steps of a hundredth in view of these runs: from 0.879 to 0.929 ms all is within, but at 0.907.
pub const OMEGA3_WALL: TunedWall = TunedWall {
    name: "an omega.3",
    k_desired_n_per_m: 25_000.0,
    rates_hz: (1000, 1500),
    axis_kg: OMEGA3_AXIS.inertia,
    damping_n_s_per_m: OMEGA3_AXIS.damping,
    most_damping_n_s_per_m: 2.0 * OMEGA3_AXIS.damping,
    k_soft: 20080.0,
    step_of_ideal: 0.3794,
    limit_of_force: 0.6864,
    limit_of_penetration: 0.08004,
    filter_kg: 0.003055,
    filter_stiffness: 26950.0,
    filter_damping: 7.362,
    ground_damping: 125.1,
    bandwidth_hz: 95.19,
    delay_s: 0.000893,
    estimator_kg: 0.2133,
};

/// The same axis at 2 kHz (`--quick`, seed 1, 187 settings examined). Within every limit from 2 to 4 kHz; at 1.5 kHz a device that is a whole tick late rings in it.
pub const OMEGA3_FAST_WALL: TunedWall = TunedWall {
    rates_hz: (2000, 4000),
    k_soft: 20570.0,
    step_of_ideal: 0.1159,
    limit_of_force: 0.2307,
    limit_of_penetration: 0.2338,
    filter_kg: 0.001717,
    filter_stiffness: 198600.0,
    filter_damping: 12.43,
    ground_damping: 8.868,
    bandwidth_hz: 111.3,
    delay_s: 0.0009003,
    estimator_kg: 0.1786,
    ..OMEGA3_WALL
};

/// Of the delta's lighter axes, across: 0.095 kg and 0.933 N·s/m as `touchstone device identify` finds them, on a lever of 32.45 mm; upwards it has 0.132 kg and 2.65 N·s/m (`--quick`, seed 1).
///
/// But for the bandwidth: with the 74.43 Hz that were found one figure of nine directions is beyond its limit, a wall of 0.41 of the counts held to 5.0 %. Settings for 5 N/mm that hold the axis give
/// energy in ±x on the mechanism, those for 3 N/mm are held to 6.4 % with 0.41 of the counts.
pub const DELTA_WALL: TunedWall = TunedWall {
    name: "a delta of a Falcon's lengths",
    k_desired_n_per_m: 2500.0,
    rates_hz: (1000, 1000),
    axis_kg: 0.095,
    damping_n_s_per_m: 0.933,
    most_damping_n_s_per_m: 5.3,
    k_soft: 2450.0,
    step_of_ideal: 0.1668,
    limit_of_force: 0.5106,
    limit_of_penetration: 0.3188,
    filter_kg: 0.0005034,
    filter_stiffness: 22790.0,
    filter_damping: 4.124,
    ground_damping: 2.123,
    bandwidth_hz: 71.5,
    delay_s: 0.001346,
    estimator_kg: 0.187,
};

/// All tuned walls.
pub const TUNED_WALLS: [TunedWall; 3] = [OMEGA3_WALL, OMEGA3_FAST_WALL, DELTA_WALL];

impl TunedWall {
    /// The wall of a mechanism at a rate.
    #[must_use]
    pub fn of(mechanism: Mechanism, rate_hz: u32) -> Self {
        match mechanism {
            Mechanism::Cartesian if rate_hz >= OMEGA3_FAST_WALL.rates_hz.0 => OMEGA3_FAST_WALL,
            Mechanism::Cartesian => OMEGA3_WALL,
            Mechanism::Delta => DELTA_WALL,
        }
    }

    /// The one that every axis of a device may have at a rate.
    #[must_use]
    pub fn for_axes(axes: &[Device; 3], rate_hz: u32) -> Option<Self> {
        let may = |wall: &&Self| {
            let (kg, damping) = (wall.axis_kg, wall.damping_n_s_per_m);
            axes.iter().all(|axis| {
                (0.5 * kg..=2.0 * kg).contains(&axis.inertia)
                    && (0.5 * damping..=wall.most_damping_n_s_per_m).contains(&axis.damping)
            }) && (wall.rates_hz.0..=wall.rates_hz.1).contains(&rate_hz)
        };
        TUNED_WALLS.iter().find(may).copied()
    }

    /// The law's settings at a rate, with a longest force.
    #[must_use]
    pub fn settings(&self, rate_hz: u32, force_n: f64) -> Settings {
        let si = Si::saturating_from_num::<f64>;
        Settings {
            rate_hz,
            k_desired: si(self.k_desired_n_per_m),
            k_soft: si(self.k_soft),
            device_damping: si(self.damping_n_s_per_m),
            virtual_damping: Si::ZERO,
            force_limit: si(force_n),
            energy_credit: si(0.02),
            step_of_ideal: si(self.step_of_ideal),
            limit_of_force: si(self.limit_of_force),
            limit_of_penetration: si(self.limit_of_penetration),
            filter: FilterSettings {
                mass: si(self.filter_kg),
                stiffness: si(self.filter_stiffness),
                damping: si(self.filter_damping),
                ground_damping: si(self.ground_damping),
            },
            states: StatesKind::Estimated,
            ..Settings::default()
        }
    }

    /// The estimator's settings for every device: those of the axis that the wall was tuned for.
    #[must_use]
    pub fn estimator(&self) -> EstimatorSettings {
        let si = Si::saturating_from_num::<f64>;
        EstimatorSettings {
            bandwidth_hz: si(self.bandwidth_hz),
            inertia: si(self.estimator_kg),
            damping: si(self.damping_n_s_per_m),
            delay_s: si(self.delay_s),
        }
    }
}
