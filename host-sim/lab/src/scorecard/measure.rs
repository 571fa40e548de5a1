//! The figures of a scorecard and what each may be.

use super::touch::TouchRatios;
use serde::Serialize;
use touchstone_sim::run::measure::{Response, Ripple};

/// A figure with a limit. Less is better in all of them, and the worst of several is the largest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Deepest penetration from the start of the press' ramp on, over `F/k_de`.
    PeakPenetrationRatio,
    /// Largest deviation of the force from `k_de x` deeper than ten counts, after half a count, over `k_de x`: ramp and hold.
    StiffnessError,
    /// Error of the stiffness from 50 ms after the ramp to the end of the hold.
    StiffnessErrorHeld,
    /// Error of the stiffness while the hand lets go.
    StiffnessErrorRelease,
    /// Deviation of the modulus of `F/x` of a hand that moves, over `k_de`.
    ModulusError,
    /// Lead or lag of the force, degrees.
    PhaseDeg,
    /// Ripple of the torque from tick to tick while the hand moves, rms, N·m.
    RippleRmsNM,
    /// Most that the hand's port had given beyond what it took since the start, J.
    EnergyOutJ,
}

impl Measure {
    /// All figures, in the order of [`Figures`].
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

    /// Heading, with what multiplies a figure for people.
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

    /// The figure's meaning, in words.
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

/// A value for every [`Measure`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures(pub [f64; 8]);

impl Figures {
    /// A memory that has seen no tick yet.
    pub const NONE: Figures = Figures([0.0; 8]);
    /// The figures of a lost wall, all infinite.
    pub const LOST: Figures = Figures([f64::INFINITY; 8]);

    /// One of the figures.
    #[must_use]
    pub fn get(&self, measure: Measure) -> f64 {
        self.0[measure.index()]
    }

    /// Raises a figure to at least this value; a value that is no number counts as infinite.
    pub fn raise(&mut self, measure: Measure, value: f64) {
        let slot = &mut self.0[measure.index()];
        *slot = if value.is_nan() {
            f64::INFINITY
        } else {
            slot.max(value)
        };
    }

    /// Takes the response to a moving hand; infinite where the hand left the wall.
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

    /// Takes the ripple; infinite where no force was felt.
    pub fn raise_ripple(&mut self, ripple: &Ripple) {
        let rms = ripple.tick_to_tick_rms_n_m().unwrap_or(f64::INFINITY);
        self.raise(Measure::RippleRmsNM, rms);
    }

    /// The worst of each.
    #[must_use]
    pub fn worst(mut self, other: &Figures) -> Figures {
        for measure in Measure::ALL {
            self.raise(measure, other.get(measure));
        }
        self
    }

    /// Each over its limit, 1 and less is good.
    #[must_use]
    pub fn shares(&self, limits: &Limits) -> [f64; 8] {
        Measure::ALL.map(|measure| {
            let value = self.get(measure);
            match measure {
                // What is beyond 1 is the deviation.
                Measure::PeakPenetrationRatio => (value - 1.0).max(0.0) / (limits.peak - 1.0),
                // No share of nothing: beyond rounding it fails, and by a tenth of a millijoule as much as any other by its limit.
                Measure::EnergyOutJ if value <= limits.energy_j => 0.0,
                Measure::EnergyOutJ => 1.0 + value / GRAVE_ENERGY_J,
                _ => value / limits.of(measure),
            }
        })
    }
}

impl Serialize for Figures {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        // What left all numbers has none.
        let number = |value: f64| value.is_finite().then_some(value);
        to.collect_map(Measure::ALL.map(|measure| (measure, number(self.get(measure)))))
    }
}

/// What each figure of a case may be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limits {
    /// Peak penetration over `F/k_de`.
    pub peak: f64,
    /// Ripple, N·m.
    pub ripple_n_m: f64,
    /// Energy given, J: the rounding of the sums.
    pub energy_j: f64,
}

/// Accuracy of a run's energy sums, J: far below what a hand feels, far above the rounding of some thousand ticks.
pub const ENERGY_ROUNDING_J: f64 = 1e-9;

/// Energy given that counts as much as any other figure at twice its limit, J.
const GRAVE_ENERGY_J: f64 = 1e-4;

impl Limits {
    /// Limits of a case with or without delay, and with a limit of the ripple.
    #[must_use]
    pub fn new(late: bool, ripple_n_m: f64) -> Self {
        Self {
            peak: if late { 1.3 } else { 1.1 },
            ripple_n_m,
            energy_j: ENERGY_ROUNDING_J,
        }
    }

    /// The limit of a figure.
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

/// Figures without a limit: of each the worst.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Beside {
    /// Deepest penetration of the light touch over that of the press at `k_de`: a blow, which inertia carries in.
    pub touch_penetration_ratio: f64,
    /// Time from the end of the ramp until the stiffness is within 5 %, s; absent if it never is.
    pub settle_from_ramp_end_s: Option<f64>,
    /// Outward speed after release, rad/s.
    pub release_speed_rad_per_s: f64,
    /// Distance outside after release, rad.
    pub release_excursion_rad: f64,
    /// Least rate-hardness (1.5), N·m/rad.
    pub rate_hardness: Option<f64>,
    /// Least extended rate-hardness, N·m/rad.
    pub extended_rate_hardness: Option<f64>,
    /// Least of the largest torque in the first five milliseconds of a touch, N·m.
    pub touch_torque_n_m: Option<f64>,
    /// The touch over that of the ideal damped wall for the same hand; `None` if it was not computed.
    pub touch: Option<TouchRatios>,
    /// Most energy that the hand got out in any window of time, J.
    pub energy_out_worst_window_j: f64,
    /// The most energy that the wall's port gave since the start, J.
    pub energy_out_wall_j: f64,
    /// Motion at the end of the hold, peak to peak, counts; absent without an encoder.
    pub motion_at_rest_counts: Option<f64>,
}

impl Beside {
    /// The worst of each.
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
