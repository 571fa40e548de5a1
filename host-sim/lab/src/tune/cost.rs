//! How bad a setting is: the scorecard as one number to be made small.

use super::outcome;
use crate::scorecard::cases::{CASES, Case, Deed, GRIPS, Programme};
use crate::scorecard::measure::{Beside, Figures, Measure};
use crate::scorecard::reference::Reference;
use crate::scorecard::touch::IdealTouch;
use crate::scorecard::{asked, watch};
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::run::judge::Judge;
use touchstone_sim::run::terms::Terms;
use touchstone_sim::scene::{Grip, Scene, SensorNoise};

/// A figure this many times beyond its limit costs no more if it goes further.
const WORST_SHARE: f64 = 20.0;
/// From this share of its limit on a figure counts: a setting that just holds is not tuned.
const NEAR: f64 = 0.95;
/// Beyond this sum a setting fails badly, and needs no further device.
const HOPELESS: f64 = 60.0;
/// What cannot be run at all.
pub const REFUSED: f64 = 1e6;

/// Depth of a touch over the ideal damped wall's up to which a touch costs nothing that counts.
const TOUCH: f64 = 1.5;
/// Noise of the position sensor under which the nominal device should still rest, degrees rms: that of a magnetic
/// sensor (AS5046).
const NOISE_DEG: f64 = 0.03;
/// Largest allowed motion at rest with noise, peak to peak, rad; four counts where these are coarser.
const NOISY_REST_RAD: f64 = 6e-4;
/// Weight of a wish beside a limit, and the largest share that it counts for: a search never gives up a limit for a
/// wish.
const WISH: f64 = 0.25;
const MOST_WISH: f64 = 3.0;

/// The figures by which a search judges settings.
#[derive(Debug, Clone)]
pub struct Judgement {
    programme: Programme,
    cases: Vec<&'static Case>,
    reference: Reference,
    aim: Aim,
    /// The ideal touch on every device, in the order of `cases`; none where touches are not judged.
    ideal: Vec<IdealTouch>,
}

/// The goals of a setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Aim {
    /// Every figure of the scorecard.
    Scorecard,
    /// A press that comes to rest, and a hand that moves: see [`super::outcome`].
    Outcome,
}

/// The findings on a setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// The value that the search makes small.
    pub value: f64,
    /// The largest share of a limit; infinite where not every device was examined.
    pub worst: f64,
}

impl Judgement {
    /// The judgement for a scene's device. `quick` tries the most decisive devices, and shorter presses.
    #[must_use]
    pub fn new(scene: &Scene, reference: Reference, quick: bool) -> Self {
        let programme = match quick {
            true => Programme::of(scene).shortened(),
            false => Programme::of(scene).with_fewer_motions(),
        };
        let mut cases: Vec<&Case> = asked(scene).collect();
        // Where sampling ends few are asked for, and the latest of them decides.
        if quick && cases.len() > DECISIVE.len() {
            cases.retain(|case| DECISIVE.contains(&case.name));
        }
        let touches = cases
            .iter()
            .map(|case| IdealTouch::of(&case.of(scene), &programme));
        // A device that no run can be made of is refused by every other judgement too.
        let ideal = touches.collect::<Result<_>>().unwrap_or_default();
        Self {
            programme,
            cases,
            reference,
            aim: Aim::Scorecard,
            ideal,
        }
    }

    /// The judgement on the nominal device alone: a press that comes to rest at `k_de`, its touch, and a hand that
    /// moves at 4 Hz; by the limits of [`super::outcome`] only.
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

    /// Ticks of one look at all devices.
    #[must_use]
    pub fn ticks(&self, scene: &Scene) -> f64 {
        self.programme.seconds(scene)
            * f64::from(scene.timing.rate_hz)
            * (GRIPS.len() * (self.cases.len() + usize::from(self.is_shaken(scene)))) as f64
    }

    /// Judges a scene with its law.
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
                    // Lost is lost by every figure; by how much, the eigenvalues say.
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

    /// Whether the nominal device is also judged with noise: where the scene says nothing of any.
    fn is_shaken(&self, scene: &Scene) -> bool {
        self.aim == Aim::Scorecard && scene.sensor.noise.is_none() && scene.encoder.is_some()
    }

    /// Motion at rest and ripple under noise, each over what it should be, in every grip.
    fn of_noise(&self, scene: &Scene) -> Vec<f64> {
        let mut noisy = scene.clone();
        noisy.sensor.noise = Some(SensorNoise {
            rms_rad: NOISE_DEG.to_radians(),
        });
        let count_rad = scene.encoder.as_ref().map_or(0.0, |it| it.step_rad());
        let rest_rad = NOISY_REST_RAD.max(4.0 * count_rad);
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

    /// Figures of all actions in a grip, and those of a press without a limit.
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

    /// Each figure over its limit, and those of a press without a limit.
    fn of_scorecard(&self, scene: &Scene, case: &Case, grip: Grip) -> Result<(Vec<f64>, Beside)> {
        let (figures, beside) = self.felt(scene, grip)?;
        Ok((
            figures.shares(&self.reference.limits(case)).to_vec(),
            beside,
        ))
    }

    /// Motion at rest and displayed stiffness of the press, modulus and phase of the motion, each over its limit.
    fn of_outcome(&self, scene: &Scene, grip: Grip) -> Result<Vec<f64>> {
        let mut shares = Vec::with_capacity(4);
        for deed in self.programme.deeds() {
            let of_deed = self.programme.scene(scene, grip, deed);
            if deed == Deed::Press {
                let terms = Terms::of(&of_deed);
                let most_rad = terms.limit_cycle_rad;
                let judged = run::watch(&of_deed, Judge::new(terms))?.finish();
                let motion = judged.limit_cycle_peak_to_peak.unwrap_or(f64::INFINITY);
                let error = judged.k_displayed.map_or(f64::INFINITY, |k| {
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
        // What is no number is as bad as can be.
        Ok(shares
            .into_iter()
            .map(|share| if share.is_nan() { f64::INFINITY } else { share })
            .collect())
    }

    /// Whether a wall holds apart from its ripple: for the Pareto table.
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

    /// The hand's actions.
    #[must_use]
    pub fn programme(&self) -> &Programme {
        &self.programme
    }
}

/// Devices that decide most.
const DECISIVE: [&str; 5] = [
    "0.41 of the counts",
    "half the inertia",
    "double inertia",
    "nominal",
    "1 tick of delay",
];
