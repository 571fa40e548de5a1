//! How bad a setting is: the scorecard as one number to be made small.

use crate::scorecard::cases::{CASES, Case, GRIPS, Programme};
use crate::scorecard::measure::{Figures, Measure};
use crate::scorecard::reference::Reference;
use crate::scorecard::{asked, watch};
use touchstone_sim::scene::Scene;

/// A figure so far beyond its limit counts no more for going further.
const WORST_SHARE: f64 = 20.0;
/// From this share of its limit on a figure counts: a setting that just holds is not tuned.
const NEAR: f64 = 0.95;
/// Beyond this sum a setting fails badly, and needs no further device.
const HOPELESS: f64 = 60.0;
/// What cannot be run at all.
pub const REFUSED: f64 = 1e6;

/// What a search judges by.
#[derive(Debug, Clone)]
pub struct Judgement {
    programme: Programme,
    cases: Vec<&'static Case>,
    reference: Reference,
    /// How many times its limit each figure may be.
    allowances: [f64; 8],
}

/// What is known of a setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// To be made small.
    pub value: f64,
    /// The largest share of a limit; infinite where not every device was looked at.
    pub worst: f64,
}

impl Judgement {
    /// Of a scene's device. `quick` looks at the devices that decide most, and at shorter presses.
    #[must_use]
    pub fn new(scene: &Scene, reference: Reference, quick: bool) -> Self {
        let programme = match quick {
            true => Programme::of(scene).shortened(),
            false => Programme::of(scene).with_fewer_motions(),
        };
        let cases = asked(scene)
            .filter(|case| !quick || DECISIVE.contains(&case.name))
            .collect();
        Self {
            programme,
            cases,
            reference,
            allowances: [1.0; 8],
        }
    }

    /// Of the nominal device alone: a press that rests, and a hand that moves within 15 % and 15°; of nothing else.
    #[must_use]
    pub fn at_rest(scene: &Scene, reference: Reference) -> Self {
        Self {
            programme: Programme::of(scene).shortened(),
            cases: vec![&CASES[0]],
            reference,
            allowances: Measure::ALL.map(|measure| match measure {
                Measure::StiffnessErrorHeld => 1.0,
                Measure::ModulusError => 1.5,
                Measure::PhaseDeg => 1.25,
                _ => f64::INFINITY,
            }),
        }
    }

    /// Ticks of one look at all devices.
    #[must_use]
    pub fn ticks(&self, scene: &Scene) -> f64 {
        self.programme.seconds(scene)
            * f64::from(scene.timing.rate_hz)
            * (GRIPS.len() * self.cases.len()) as f64
    }

    /// Judges a scene with its law.
    #[must_use]
    pub fn cost(&self, scene: &Scene) -> Cost {
        let (mut over, mut most) = (0.0, 0.0_f64);
        for case in &self.cases {
            let changed = case.of(scene);
            let limits = self.reference.limits(case);
            for grip in GRIPS {
                let mut figures = Figures::NONE;
                for deed in self.programme.deeds() {
                    let of_deed = self.programme.scene(&changed, grip, deed);
                    match watch::watch(&of_deed, deed, false) {
                        Ok((seen, _)) => figures = figures.worst(&seen),
                        Err(_) => {
                            return Cost {
                                value: REFUSED,
                                worst: f64::INFINITY,
                            };
                        }
                    }
                }
                for (share, allowance) in figures.shares(&limits).iter().zip(&self.allowances) {
                    if allowance.is_infinite() {
                        continue;
                    }
                    let share = share / allowance;
                    over += (share - NEAR).clamp(0.0, WORST_SHARE);
                    most = most.max(share);
                }
                if over > HOPELESS {
                    return Cost {
                        value: 1e3 + over,
                        worst: f64::INFINITY,
                    };
                }
            }
        }
        Cost {
            value: over + 0.1 * most.min(WORST_SHARE),
            worst: most,
        }
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

    /// What a hand does in it.
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
