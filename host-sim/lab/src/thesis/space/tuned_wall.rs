//! Settings of control law and estimator that were tuned for an axis, with the devices that may use them.
//!
//! Each set was found by `touchstone tune` on one axis, treated as a knob on a lever ([`crate::identify::lever`]), for the devices
//! of [`crate::scorecard::cases`]. Times, lengths and forces of the law do not change with the control rate, so one set serves a
//! range of rates. The scorecard's measures at these rates are in `docs/devices.md`.

use super::Mechanism;
use touchstone_control::settings::{FilterSettings, ImpactSettings};
use touchstone_control::{EstimatorSettings, Settings, Si, StatesKind};
use touchstone_world::plant::{Device, OMEGA3_AXIS};

/// A tuned wall: settings of control law and estimator, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TunedWall {
    /// Name of the device, for readers.
    pub name: &'static str,
    /// Requested stiffness, N/m.
    pub k_desired_n_per_m: f64,
    /// Lowest and highest control rate at which the wall is within its limits, Hz.
    pub rates_hz: (u32, u32),
    /// Mass of the axis for which the wall was tuned, kg. An axis with half to double this mass may use the wall.
    pub axis_kg: f64,
    /// Damping that the law assumes, N·s/m. An axis with at least half of it may use the wall.
    pub damping_n_s_per_m: f64,
    /// Largest damping of an axis that may use the wall, N·s/m.
    pub most_damping_n_s_per_m: f64,
    /// Stiffness of the soft spring on which the virtual mass of enhanced successive force augmentation presses,
    /// [`Settings::k_soft`], N/m.
    pub k_soft: f64,
    /// Fraction of the ideal step by which the law's offset moves per millisecond, [`Settings::step_of_ideal`].
    pub step_of_ideal: f64,
    /// Largest step of the force by the law's offset, as a fraction of the force, per millisecond, [`Settings::limit_of_force`].
    pub limit_of_force: f64,
    /// Largest step of the law's offset, as a fraction of the penetration, per millisecond, [`Settings::limit_of_penetration`].
    pub limit_of_penetration: f64,
    /// Virtual mass of enhanced successive force augmentation, [`FilterSettings::mass`], kg.
    pub filter_kg: f64,
    /// Stiffness of the spring that couples device and virtual mass, [`FilterSettings::stiffness`], N/m.
    pub filter_stiffness: f64,
    /// Damping of the damper that couples device and virtual mass, [`FilterSettings::damping`], N·s/m.
    pub filter_damping: f64,
    /// Damping from the virtual mass to ground, [`FilterSettings::ground_damping`], N·s/m.
    pub ground_damping: f64,
    /// Bandwidth of the state estimator, [`EstimatorSettings::bandwidth_hz`], Hz.
    pub bandwidth_hz: f64,
    /// Delay over which the state estimator predicts, [`EstimatorSettings::delay_s`], s.
    pub delay_s: f64,
    /// Mass that the state estimator assumes, [`EstimatorSettings::inertia`], kg.
    pub estimator_kg: f64,
    /// Share of the axis' momentum that the pulse at the touch takes away.
    pub pulse: f64,
}

/// The wall for an omega.3 at 1 kHz and a press of 8 N, from a search with seed 1 that examined 2,358 settings.
///
/// On a lever of 26.0 mm the axis' 0.148 kg are 1e-4 kg·m². 25 N/mm are 16.89 N·m/rad, 2.5 N·s/m are 1.689e-3 N·m·s/rad, 12 N are
/// 0.3119 N·m. A position count of 0.01 mm is one of 16,332 counts per turn.
///
/// The estimator's delay was changed by hand. With the 0.7143 ms from the search one measure is beyond its limit. A hand of 0.8
/// kg then gets 0.16 mJ out of a device with a whole control period of delay. That hand is heavier than any for which the knob
/// was tuned. Of the delays that were tried between 0.879 and 0.929 ms, only 0.907 ms brings a measure beyond its limit.
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
    pulse: 0.3,
};

/// The wall for the omega.3 at 2 kHz (`touchstone tune --quick`, seed 1, 187 examined settings). It is within every limit from 2 to
/// 4 kHz. At 1.5 kHz a device with a whole control period of delay oscillates in the wall.
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

/// The wall for the delta mechanism's lighter, sideways axes: 0.095 kg and 0.933 N·s/m as `touchstone device identify` measures
/// them, on a lever of 32.45 mm (`touchstone tune --quick`, seed 1). The upward axis has 0.132 kg and 2.65 N·s/m.
///
/// Bandwidth and pulse at the touch were changed by hand. With the 74.43 Hz from the search, one measure is beyond its limit:
/// with 0.41 of the position counts the stiffness error in a hold is 5.0 %. Settings for 5 N/mm hold the single axis, but on the
/// mechanism they give out energy in ±x. With settings for 3 N/mm and 0.41 of the counts the stiffness error is 6.4 %.
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
    // With a pulse of 0.3 and 0.41 of the counts, the stiffness error in a hold is 5.1 %; the limit is 5 %.
    pulse: 0.0,
};

/// All tuned walls.
pub const TUNED_WALLS: [TunedWall; 3] = [OMEGA3_WALL, OMEGA3_FAST_WALL, DELTA_WALL];

impl TunedWall {
    /// The wall for a mechanism at a control rate.
    #[must_use]
    pub fn of(mechanism: Mechanism, rate_hz: u32) -> Self {
        match mechanism {
            Mechanism::Cartesian if rate_hz >= OMEGA3_FAST_WALL.rates_hz.0 => OMEGA3_FAST_WALL,
            Mechanism::Cartesian => OMEGA3_WALL,
            Mechanism::Delta => DELTA_WALL,
        }
    }

    /// The tuned wall that all three axes of a device may use at a control rate; `None` if there is none.
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

    /// Settings of the law at a control rate, with the given largest force in N.
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
            estimator: self.estimator(),
            // The pulse is computed with the estimator's tuned mass. The factor makes it a share of the axis' own momentum.
            impact: ImpactSettings {
                momentum: si(self.pulse * self.axis_kg / self.estimator_kg),
                ..ImpactSettings::default()
            },
            ..Settings::default()
        }
    }

    /// Settings of the state estimator for the axis for which the wall was tuned, the same for every device.
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
