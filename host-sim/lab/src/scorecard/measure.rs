//! The measures of a scorecard and their limits.

use super::touch_ratios::TouchRatios;
use serde::Serialize;
use touchstone_sim::run::measure::{Response, Ripple};

/// A measure of the scorecard that has a limit. Smaller is better for each measure, so the worst of several values is the largest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Deepest penetration after the start of the press' ramp, divided by the ideal penetration: force of the press over requested
    /// stiffness.
    PeakPenetrationRatio,
    /// Largest deviation of the force from that of an ideal spring of the requested stiffness, during ramp and hold, divided by the
    /// ideal force. Depths below ten encoder counts are left out, and an error of half a count is allowed for.
    StiffnessError,
    /// Largest deviation of the force from that of an ideal spring of the requested stiffness, divided by the ideal force.
    /// Measured from 50 ms after the ramp to the end of the hold; infinite if the depth falls below ten encoder counts there.
    StiffnessErrorHeld,
    /// Largest deviation of the force from that of an ideal spring of the requested stiffness, divided by the ideal force, while
    /// the hand lets go.
    StiffnessErrorRelease,
    /// Deviation of the amplitude ratio of force to penetration from the requested stiffness while the hand oscillates, divided by
    /// that stiffness.
    ModulusError,
    /// Phase between force and penetration while the hand oscillates, lead or lag, degrees.
    PhaseDeg,
    /// Root mean square change of the torque from tick to tick (ripple) while the hand oscillates, N·m.
    RippleRmsNM,
    /// Most energy that the hand got out beyond what it had put in since the start, J.
    EnergyOutJ,
}

impl Measure {
    /// All measures, in the order of the values in [`Figures`].
    pub const ALL: [Measure; 8] = [
        Measure::PeakPenetrationRatio,
        Measure::StiffnessError,
        Measure::StiffnessErrorHeld,
        Measure::StiffnessErrorRelease,
        Measure::ModulusError,
        Measure::PhaseDeg,
        Measure::RippleRmsNM,
        Measure::EnergyOutJ,
    ];

    /// Heading of the measure for readers, and the factor from its SI value to the displayed value.
    #[must_use]
    pub fn heading(self) -> (&'static str, f64) {
        match self {
            Measure::PeakPenetrationRatio => ("peak", 1.0),
            Measure::StiffnessError => ("moment %", 100.0),
            Measure::StiffnessErrorHeld => ("held %", 100.0),
            Measure::StiffnessErrorRelease => ("letting go %", 100.0),
            Measure::ModulusError => ("|F/x| %", 100.0),
            Measure::PhaseDeg => ("phase °", 1.0),
            Measure::RippleRmsNM => ("ripple mN·m", 1e3),
            Measure::EnergyOutJ => ("energy mJ", 1e3),
        }
    }

    /// Meaning of the measure, in words.
    #[must_use]
    pub fn about(self) -> &'static str {
        match self {
            Measure::PeakPenetrationRatio => "deepest penetration of the press over F/k_de",
            Measure::StiffnessError => {
                "largest deviation from k_de at any moment of the press deeper than ten counts, after half a count"
            }
            Measure::StiffnessErrorHeld => "the same from 50 ms after the ramp of the press on",
            Measure::StiffnessErrorRelease => "the same while the hand lets go",
            Measure::ModulusError => {
                "deviation of the modulus of F/x from k_de for a hand that moves"
            }
            Measure::PhaseDeg => "phase of F/x for a hand that moves",
            Measure::RippleRmsNM => {
                "ripple of the torque from tick to tick for a hand that moves, rms"
            }
            Measure::EnergyOutJ => {
                "energy that the hand got out beyond what it had put in since the start"
            }
        }
    }

    const fn index(self) -> usize {
        self as usize
    }
}

/// A value for every [`Measure`], in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures(pub [f64; 8]);

impl Figures {
    /// Start value: the measures before any tick.
    pub const NONE: Figures = Figures([0.0; 8]);
    /// Measures of a wall that cannot hold the device (lost wall): all infinite.
    pub const LOST: Figures = Figures([f64::INFINITY; 8]);

    /// Value of one measure, in SI units.
    #[must_use]
    pub fn get(&self, measure: Measure) -> f64 {
        self.0[measure.index()]
    }

    /// Raises a measure to at least `value`; NaN counts as infinite.
    pub fn raise(&mut self, measure: Measure, value: f64) {
        let slot = &mut self.0[measure.index()];
        *slot = if value.is_nan() {
            f64::INFINITY
        } else {
            slot.max(value)
        };
    }

    /// Adds the response to an oscillating hand. If the knob left the wall, the measures of the response become infinite.
    pub fn raise_moved(&mut self, response: &Response, k_desired: f64) {
        let (modulus, phase) = match response.stiffness() {
            Some(it) => (
                (it.modulus_n_m_per_rad / k_desired - 1.0).abs(),
                it.phase_deg.abs(),
            ),
            None => (f64::INFINITY, f64::INFINITY),
        };
        self.raise(Measure::ModulusError, modulus);
        self.raise(Measure::PhaseDeg, phase);
    }

    /// Adds the ripple of the torque. If there was no force, the measure becomes infinite.
    pub fn raise_ripple(&mut self, ripple: &Ripple) {
        let rms = ripple.tick_to_tick_rms_n_m().unwrap_or(f64::INFINITY);
        self.raise(Measure::RippleRmsNM, rms);
    }

    /// The worse value of each measure from two sets.
    #[must_use]
    pub fn worst(mut self, other: &Figures) -> Figures {
        for measure in Measure::ALL {
            self.raise(measure, other.get(measure));
        }
        self
    }

    /// Each measure divided by its limit; a value of at most 1 is within the limit.
    #[must_use]
    pub fn shares(&self, limits: &Limits) -> [f64; 8] {
        Measure::ALL.map(|measure| {
            let value = self.get(measure);
            match measure {
                // The deviation is the part beyond 1.
                Measure::PeakPenetrationRatio => (value - 1.0).max(0.0) / (limits.peak - 1.0),
                // The limit is nearly zero, so no fraction of it is taken. Beyond rounding the figure fails; a tenth of a
                // millijoule weighs as much as another figure at twice its limit.
                Measure::EnergyOutJ if value <= limits.energy_j => 0.0,
                Measure::EnergyOutJ => 1.0 + value / GRAVE_ENERGY_J,
                _ => value / limits.of(measure),
            }
        })
    }
}

/// Whether a measure divided by its limit is beyond the limit. The share of a lost wall can be NaN, which counts as beyond it.
#[must_use]
pub fn is_beyond(share: f64) -> bool {
    share > 1.0 || share.is_nan()
}

impl Serialize for Figures {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        // An infinite value has no number in JSON.
        let number = |value: f64| value.is_finite().then_some(value);
        to.collect_map(Measure::ALL.map(|measure| (measure, number(self.get(measure)))))
    }
}

/// Limits of the scorecard's measures for one device.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limits {
    /// Largest peak penetration, as a multiple of the ideal penetration (force of the press over requested stiffness).
    pub peak: f64,
    /// Largest ripple (change of the torque from tick to tick), root mean square, N·m.
    pub ripple_n_m: f64,
    /// Largest energy given to the hand, J; only rounding of the sums is allowed.
    pub energy_j: f64,
}

/// Rounding error that is allowed in a run's energy sums, J. It is far below what a hand feels and far above the rounding of some
/// thousand ticks.
pub const ENERGY_ROUNDING_J: f64 = 1e-9;

/// Energy given to the hand that counts as much as another measure at twice its limit, J.
const GRAVE_ENERGY_J: f64 = 1e-4;

impl Limits {
    /// Makes the limits of a device. `late` says whether the device has a delay of half a control period or more.
    #[must_use]
    pub fn new(late: bool, ripple_n_m: f64) -> Self {
        Self {
            peak: if late { 1.3 } else { 1.1 },
            ripple_n_m,
            energy_j: ENERGY_ROUNDING_J,
        }
    }

    /// Limit of one measure, in SI units.
    #[must_use]
    pub fn of(&self, measure: Measure) -> f64 {
        match measure {
            Measure::PeakPenetrationRatio => self.peak,
            Measure::StiffnessError | Measure::StiffnessErrorRelease => 0.15,
            Measure::StiffnessErrorHeld => 0.05,
            Measure::ModulusError => 0.1,
            Measure::PhaseDeg => 12.0,
            Measure::RippleRmsNM => self.ripple_n_m,
            Measure::EnergyOutJ => self.energy_j,
        }
    }
}

/// Measures without a limit; each is the worst over several runs.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Beside {
    /// Deepest penetration of the light touch, divided by the ideal penetration of the press. It may exceed the depth of a press,
    /// because the device's inertia carries it into the wall.
    pub touch_penetration_ratio: f64,
    /// Settling time, s: from the end of the ramp until the stiffness stays within 5 % of the requested one; absent if it never
    /// does.
    pub settle_from_ramp_end_s: Option<f64>,
    /// Largest outward speed after the release, rad/s.
    pub release_speed_rad_per_s: f64,
    /// Largest distance from the wall after the release, rad.
    pub release_excursion_rad: f64,
    /// Smallest rate-hardness over the runs (slope of the force just after contact over the speed of the touch), N·m/rad.
    pub rate_hardness: Option<f64>,
    /// Smallest extended rate-hardness over the runs (largest rise of the torque within a millisecond over the largest speed),
    /// N·m/rad.
    pub extended_rate_hardness: Option<f64>,
    /// Smallest value over the runs of the largest torque in the first five milliseconds of a touch, N·m.
    pub touch_torque_n_m: Option<f64>,
    /// Measures of the touch, divided by those of a touch of the ideal damped wall by the same hand; `None` if they were not
    /// computed.
    pub touch: Option<TouchRatios>,
    /// Most energy that the hand got out of the device in any window of time, J. The window may start at any tick.
    pub energy_out_worst_window_j: f64,
    /// Most energy that the wall gave out beyond what it had absorbed since the start, J.
    pub energy_out_wall_j: f64,
    /// Motion of the knob at the end of the hold, peak to peak, encoder counts; absent without an encoder.
    pub motion_at_rest_counts: Option<f64>,
}

impl Beside {
    /// The worse value of each measure from two sets.
    #[must_use]
    pub fn worst(self, other: &Beside) -> Beside {
        let either = |a: Option<f64>, b: Option<f64>, worse: fn(f64, f64) -> f64| match (a, b) {
            (Some(a), Some(b)) => Some(worse(a, b)),
            (one, other) => one.or(other),
        };
        Beside {
            touch_penetration_ratio: self
                .touch_penetration_ratio
                .max(other.touch_penetration_ratio),
            settle_from_ramp_end_s: self
                .settle_from_ramp_end_s
                .zip(other.settle_from_ramp_end_s)
                .map(|(a, b)| a.max(b)),
            release_speed_rad_per_s: self
                .release_speed_rad_per_s
                .max(other.release_speed_rad_per_s),
            release_excursion_rad: self.release_excursion_rad.max(other.release_excursion_rad),
            rate_hardness: either(self.rate_hardness, other.rate_hardness, f64::min),
            extended_rate_hardness: either(
                self.extended_rate_hardness,
                other.extended_rate_hardness,
                f64::min,
            ),
            touch_torque_n_m: either(self.touch_torque_n_m, other.touch_torque_n_m, f64::min),
            touch: match (self.touch, other.touch) {
                (Some(one), Some(other)) => Some(one.worst(&other)),
                (one, other) => one.or(other),
            },
            energy_out_worst_window_j: self
                .energy_out_worst_window_j
                .max(other.energy_out_worst_window_j),
            energy_out_wall_j: self.energy_out_wall_j.max(other.energy_out_wall_j),
            motion_at_rest_counts: either(
                self.motion_at_rest_counts,
                other.motion_at_rest_counts,
                f64::max,
            ),
        }
    }
}
