//! The cost of law settings, which a search minimises: one number from the scorecard's measures.

use super::outcome;
use crate::scorecard::cases::{CASES, Case, Deed, GRIPS, Programme};
use crate::scorecard::measure::{Beside, Figures, Measure};
use crate::scorecard::reference::Reference;
use crate::scorecard::touch::IdealTouch;
use crate::scorecard::{asked, watch};
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::run::terms::Terms;
use touchstone_sim::scene::{Grip, Scene, SensorNoise};

/// Largest cost of a measure, as a multiple of its limit. A measure further beyond its limit does not cost more.
const WORST_SHARE: f64 = 20.0;
/// Fraction of its limit up to which a measure costs nothing. It is below 1, so that tuned settings have a margin.
const NEAR: f64 = 0.95;
/// Sum of costs above which settings are so bad that no further device is simulated.
const HOPELESS: f64 = 60.0;
/// Cost of settings that cannot be run at all.
pub const REFUSED: f64 = 1e6;

/// Depth of a touch, as a multiple of the ideal damped wall's, up to which a touch hardly adds to the cost of settings.
const TOUCH: f64 = 1.5;
/// Sensor noise with which the nominal device should still rest if the scene gives none, degrees, root mean square; the noise of
/// the magnetic sensor AS5046.
pub const NOISE_DEG: f64 = 0.03;
/// Largest allowed motion at rest with sensor noise, peak to peak, rad. Four encoder counts are allowed if these are larger.
const NOISY_REST_RAD: f64 = 6e-4;
/// Weight of goals without a limit. Each goal adds at most `WISH · MOST_WISH` to the cost, so that a search never exceeds a limit
/// in favour of such a goal.
const WISH: f64 = 0.25;
const MOST_WISH: f64 = 3.0;

/// Evaluates settings of a control law by simulated runs.
#[derive(Debug, Clone)]
pub struct Judgement {
    programme: Programme,
    cases: Vec<&'static Case>,
    reference: Reference,
    aim: Aim,
    /// Touches of the ideal wall on every device, in the order of `cases`; empty if touches do not count.
    ideal: Vec<IdealTouch>,
}

/// The measures by which settings are evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Aim {
    /// Settings are evaluated by every measure of the scorecard.
    Scorecard,
    /// Settings are evaluated only by whether a press comes to rest and an oscillating hand meets the requested stiffness, see
    /// [`super::outcome`].
    Outcome,
}

/// Cost of the settings of a law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// The cost of the settings, which the search minimises.
    pub value: f64,
    /// Largest ratio of a measure to its limit; infinite if not every device was simulated.
    pub worst: f64,
}

impl Judgement {
    /// Makes an evaluation for a scene's device by the scorecard's measures. `quick` uses only the most decisive devices, and
    /// shorter presses.
    #[must_use]
    pub fn new(scene: &Scene, reference: Reference, quick: bool) -> Self {
        let programme = match quick {
            true => Programme::of(scene).shortened(),
            false => Programme::of(scene).with_fewer_motions(),
        };
        let mut cases: Vec<&Case> = asked(scene).collect();
        // For very stiff walls only few devices count. All of them are kept, because the one with the longest delay decides.
        if quick && cases.len() > DECISIVE.len() {
            cases.retain(|case| DECISIVE.contains(&case.name));
        }
        let touches = cases
            .iter()
            .map(|case| IdealTouch::of(&case.of(scene), &programme));
        // If a device cannot be simulated, the list is empty; `cost` then returns `REFUSED` at this device.
        let ideal = touches.collect::<Result<_>>().unwrap_or_default();
        Self {
            programme,
            cases,
            reference,
            aim: Aim::Scorecard,
            ideal,
        }
    }

    /// Makes an evaluation on the nominal device alone, by the limits of [`super::outcome`]. A press should come to rest at the
    /// requested stiffness, and a hand that oscillates at 4 Hz should meet that stiffness.
    #[must_use]
    pub fn at_rest(scene: &Scene, reference: Reference) -> Self {
        let mut programme = Programme::of(scene);
        programme.frequencies_hz = vec![4.0];
        Self {
            programme,
            cases: vec![&CASES[0]],
            reference,
            aim: Aim::Outcome,
            ideal: Vec::new(),
        }
    }

    /// Number of simulated ticks (control periods) that the evaluation of one set of law settings takes.
    #[must_use]
    pub fn ticks(&self, scene: &Scene) -> f64 {
        self.programme.seconds(scene)
            * f64::from(scene.timing.rate_hz)
            * (GRIPS.len() * (self.cases.len() + usize::from(self.is_shaken(scene)))) as f64
    }

    /// Computes the cost of a scene with its control law.
    #[must_use]
    pub fn cost(&self, scene: &Scene) -> Cost {
        let (mut over, mut most, mut wishes) = (0.0, 0.0_f64, 0.0);
        let mut wish = |share: f64| wishes += WISH * (share - NEAR).clamp(0.0, MOST_WISH);
        for (at, case) in self.cases.iter().enumerate() {
            let changed = case.of(scene);
            for (hand, grip) in GRIPS.into_iter().enumerate() {
                let shares = match self.aim {
                    Aim::Scorecard => self.of_scorecard(&changed, case, grip).map(|it| {
                        if let Some(ideal) = self.ideal.get(at) {
                            let deep = ideal.ratios(hand, &it.1).penetration;
                            wish((deep - 1.0) / (TOUCH - 1.0));
                        }
                        it.0
                    }),
                    Aim::Outcome => self.of_outcome(&changed, grip),
                };
                let Ok(shares) = shares else {
                    return Cost {
                        value: REFUSED,
                        worst: f64::INFINITY,
                    };
                };
                for share in shares {
                    over += (share - NEAR).clamp(0.0, WORST_SHARE);
                    most = most.max(share);
                }
                if over > HOPELESS {
                    // All figures of a lost wall are infinite. Eigenvalues show how far it is from stable.
                    let radius = super::eigenvalue::radius(scene).min(10.0);
                    return Cost {
                        value: 1e3 + over + 1e2 * radius,
                        worst: f64::INFINITY,
                    };
                }
            }
        }
        if self.is_shaken(scene) {
            for share in self.of_noise(scene) {
                wish(share);
            }
        }
        Cost {
            value: over + wishes + 0.1 * most.min(WORST_SHARE),
            worst: most,
        }
    }

    /// Whether settings are also evaluated on the nominal device with sensor noise. This is so for the scorecard's measures, if
    /// the scene has an encoder.
    fn is_shaken(&self, scene: &Scene) -> bool {
        self.aim == Aim::Scorecard && scene.encoder.is_some()
    }

    /// Motion at rest and ripple with the scene's sensor noise, or without it with [`NOISE_DEG`], each divided by its limit, for
    /// every grip.
    fn of_noise(&self, scene: &Scene) -> Vec<f64> {
        let usual_rad = NOISE_DEG.to_radians();
        let own = scene.sensor.noise.as_ref().map(|it| it.rms_rad);
        let rms_rad = own.unwrap_or(usual_rad);
        let mut noisy = scene.clone();
        noisy.sensor.noise = Some(SensorNoise { rms_rad });
        let count_rad = scene.encoder.as_ref().map_or(0.0, |it| it.step_rad());
        // More noise than usual moves the knob more in the same proportion.
        let allowed_rad = NOISY_REST_RAD * (rms_rad / usual_rad).max(1.0);
        let rest_rad = allowed_rad.max(4.0 * count_rad);
        let mut shares = Vec::new();
        for grip in GRIPS {
            let Ok((figures, beside)) = self.felt(&noisy, grip) else {
                return vec![f64::INFINITY; 2 * GRIPS.len()];
            };
            let counts = beside.motion_at_rest_counts.unwrap_or(f64::INFINITY);
            shares.push(counts * count_rad / rest_rad);
            shares.push(figures.get(Measure::RippleRmsNM) / self.reference.limit_n_m);
        }
        shares
    }

    /// Measures of all actions of the hand in a grip, and the measures of the press that have no limit.
    fn felt(&self, scene: &Scene, grip: Grip) -> Result<(Figures, Beside)> {
        let (mut figures, mut beside) = (Figures::NONE, Beside::default());
        for deed in self.programme.deeds() {
            let of_deed = self.programme.scene(scene, grip, deed);
            let (felt, shown) = watch::watch(&of_deed, deed, false)?;
            figures = figures.worst(&felt);
            if deed == Deed::Press {
                beside = shown;
            }
        }
        Ok((figures, beside))
    }

    /// Each measure divided by its limit, and the measures of the press that have no limit.
    fn of_scorecard(&self, scene: &Scene, case: &Case, grip: Grip) -> Result<(Vec<f64>, Beside)> {
        let (figures, beside) = self.felt(scene, grip)?;
        Ok((
            figures.shares(&self.reference.limits(case)).to_vec(),
            beside,
        ))
    }

    /// Motion at rest, stiffness error, and amplitude and phase error for an oscillating hand, each divided by its limit.
    fn of_outcome(&self, scene: &Scene, grip: Grip) -> Result<Vec<f64>> {
        let mut shares = Vec::with_capacity(4);
        for deed in self.programme.deeds() {
            let of_deed = self.programme.scene(scene, grip, deed);
            if deed == Deed::Press {
                let most_rad = Terms::of(&of_deed).limit_cycle_rad;
                let pressed = run::run(&of_deed, false)?.summary;
                let motion = pressed.limit_cycle_peak_to_peak.unwrap_or(f64::INFINITY);
                let error = pressed.k_displayed.map_or(f64::INFINITY, |k| {
                    (k / scene.wall.k_desired_n_m_per_rad - 1.0).abs()
                });
                shares.extend([motion / most_rad, error / outcome::RESTING]);
            } else {
                let (figures, _) = watch::watch(&of_deed, deed, false)?;
                shares.extend([
                    figures.get(Measure::ModulusError) / outcome::MODULUS,
                    figures.get(Measure::PhaseDeg) / outcome::PHASE_DEG,
                ]);
            }
        }
        // NaN counts as the worst value.
        Ok(shares
            .into_iter()
            .map(|share| if share.is_nan() { f64::INFINITY } else { share })
            .collect())
    }

    /// Measures on the nominal device, if the wall is within all limits on every device (except that of the ripple); else `None`.
    /// The table of trade-offs uses them.
    #[must_use]
    pub fn holds(&self, scene: &Scene) -> Option<Figures> {
        let mut nominal = None;
        for case in &self.cases {
            let (figures, _) =
                crate::scorecard::figures(scene, &self.programme, case, false).ok()?;
            let limits = self.reference.limits(case);
            let held = Measure::ALL
                .into_iter()
                .zip(figures.shares(&limits))
                .all(|(measure, share)| measure == Measure::RippleRmsNM || share <= 1.0);
            if !held {
                return None;
            }
            nominal.get_or_insert(figures);
        }
        nominal
    }

    /// The actions of the hand in the simulated runs.
    #[must_use]
    pub fn programme(&self) -> &Programme {
        &self.programme
    }
}

/// Names of the devices that most often determine whether settings pass.
const DECISIVE: [&str; 5] = [
    "0.41 of the counts",
    "half the inertia",
    "double inertia",
    "nominal",
    "1 tick of delay",
];
