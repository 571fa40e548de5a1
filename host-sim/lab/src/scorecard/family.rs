//! The family of a device: grips, counts, inertia, damping, delay, rate and noise, all changed together, under one setting.
//!
//! A scorecard changes one thing at a time. A knob with half the inertia may also have a late loop, so here every combination counts:
//! the [`corners`], and a [`sample`] between them that a seed draws. What the law is told stays the same. Each member is touched and
//! pressed. Where `T sqrt(k_de/J)` is beyond what any tuned law was found to hold (docs/tuning, "Where a tuned wall ends"), the member is counted
//! apart: its loss is none of the setting's.

use super::cases::{CASES, Deed, GRIPS, Programme};
use super::measure::Measure;
use super::touch::TouchRatios;
use super::watch::watch;
use super::{figures, stiffness_per_tick};
use crate::certify::touch::of_plant;
use crate::random_device::Random;
use rayon::prelude::*;
use serde::Serialize;
use touchstone_sim::error::Result;
use touchstone_sim::scene::{Grip, Scene, SensorNoise};
use touchstone_world::plant::{FIRM, Hand, LIGHT};

/// A press deeper than this many times `F/k_de` counts as lost ...
pub const LOST_DEPTH: f64 = 5.0;
/// ... as is one that is held with less than half or more than one and a half of `k_de`.
pub const LOST_ERROR: f64 = 0.5;
/// A member that goes deeper than this is called deep.
pub const DEEP: f64 = 1.3;
/// Members that are named.
const WORST: usize = 5;
/// Counts over the scene's: 16,384 of 40,000 at the least.
const COUNTS: [f64; 2] = [1.0, 0.4096];
/// Inertia and damping over the scene's.
const TIMES: [f64; 3] = [0.5, 1.0, 2.0];
/// Delays, ticks.
const DELAYS: [f64; 4] = [0.0, 0.1, 0.5, 1.0];
/// How far a drawn hand may be beyond the light and the firm grip, of what lies between them on logarithmic scales.
const BEYOND: f64 = 0.25;
/// `T sqrt(k_de/J)` up to which every wall on the map of docs/tuning rests, at these delays in ticks.
const MAP: [(f64, f64); 3] = [(0.0, 1.35), (0.5, 0.92), (1.0, 0.62)];

/// One device in one hand.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// The scene with this device.
    pub scene: Scene,
    /// A grip of the scorecard, or a drawn hand.
    pub hand: (Grip, Option<Hand>),
    /// The name in words.
    pub name: String,
    /// Delay, ticks.
    pub delay_ticks: f64,
}

/// How a member differs from the scene.
#[derive(Debug, Clone, Copy)]
struct Change {
    counts: f64,
    inertia: f64,
    damping: f64,
    delay_ticks: f64,
}

/// Rates and noise of a family; empty: the scene's own.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Around {
    /// Control rates, Hz.
    pub rates_hz: Vec<u32>,
    /// Noise of the position sensor, degrees rms.
    pub noise_deg: Vec<f64>,
}

impl Around {
    /// The scene at every rate with every noise.
    fn scenes(&self, scene: &Scene) -> Vec<Scene> {
        let mut rates = self.rates_hz.clone();
        if rates.is_empty() {
            rates.push(scene.timing.rate_hz);
        }
        let mut scenes = Vec::new();
        for rate_hz in rates {
            let mut at_rate = scene.clone();
            at_rate.timing.rate_hz = rate_hz;
            if self.noise_deg.is_empty() {
                scenes.push(at_rate.clone());
            }
            for noise_deg in &self.noise_deg {
                let mut noisy = at_rate.clone();
                noisy.sensor.noise = (*noise_deg > 0.0).then_some(SensorNoise {
                    rms_rad: noise_deg.to_radians(),
                });
                scenes.push(noisy);
            }
        }
        scenes
    }
}

fn noise_deg(scene: &Scene) -> f64 {
    let noise = scene.sensor.noise.as_ref();
    noise.map_or(0.0, |noise| noise.rms_rad.to_degrees())
}

impl Member {
    fn new(scene: &Scene, change: Change, hand: (Grip, Option<Hand>), hand_name: &str) -> Self {
        let mut scene = scene.clone();
        if let Some(encoder) = &mut scene.encoder {
            encoder.counts_per_rev = (encoder.counts_per_rev * change.counts).round().max(1.0);
        }
        scene.device.inertia_kg_m2 *= change.inertia;
        scene.device.damping_n_m_s_per_rad *= change.damping;
        scene.timing.computational_delay_s = change.delay_ticks * scene.timing.period_s();
        let counts = scene.encoder.as_ref().map_or("no".to_owned(), |encoder| {
            encoder.counts_per_rev.to_string()
        });
        let name = format!(
            "{hand_name}, {counts} counts, {:.2} J, {:.2} b, {:.2} tick, {} Hz, {:.2}° noise",
            change.inertia,
            change.damping,
            change.delay_ticks,
            scene.timing.rate_hz,
            noise_deg(&scene)
        );
        Self {
            scene,
            hand,
            name,
            delay_ticks: change.delay_ticks,
        }
    }

    /// Whether `T sqrt(k_de/J)` is beyond what any tuned law holds at this delay.
    #[must_use]
    pub fn is_beyond_map(&self) -> bool {
        stiffness_per_tick(&self.scene) > most_stiffness_per_tick(self.delay_ticks)
    }

    /// Deepest of press and touch over `F/k_de` of the press, `None` where lost.
    fn depths(&self) -> Result<Option<[f64; 2]>> {
        let (grip, hand) = self.hand;
        let mut pressed = Programme::of(&self.scene).scene(&self.scene, grip, Deed::Press);
        pressed.operator.hand = hand.as_ref().map(of_plant);
        let (figures, beside) = watch(&pressed, Deed::Press, false)?;
        let depths = [
            figures.get(Measure::PeakPenetrationRatio),
            beside.touch_penetration_ratio,
        ];
        let held = figures.get(Measure::StiffnessErrorHeld) <= LOST_ERROR;
        let near = depths.iter().all(|depth| *depth <= LOST_DEPTH);
        Ok((held && near).then_some(depths))
    }
}

/// Straight between the delays of the map.
fn most_stiffness_per_tick(delay_ticks: f64) -> f64 {
    let between = MAP.windows(2).find(|pair| delay_ticks <= pair[1].0);
    let Some([(from, start), (to, end)]) = between else {
        return MAP[MAP.len() - 1].1;
    };
    start + (end - start) * (delay_ticks - from) / (to - from)
}

/// All corners: 216 with every rate and noise.
#[must_use]
pub fn corners(scene: &Scene, around: &Around) -> Vec<Member> {
    let mut members = Vec::new();
    for scene in around.scenes(scene) {
        for counts in COUNTS {
            for inertia in TIMES {
                for damping in TIMES {
                    for delay_ticks in DELAYS {
                        let change = Change {
                            counts,
                            inertia,
                            damping,
                            delay_ticks,
                        };
                        members
                            .extend(GRIPS.map(|grip| {
                                Member::new(&scene, change, (grip, None), grip.name())
                            }));
                    }
                }
            }
        }
    }
    members
}

/// This many members between the corners, in hands between and a little beyond the grips. A seed always draws the same
/// members, and a larger number begins with those of a smaller one.
#[must_use]
pub fn sample(scene: &Scene, around: &Around, members: usize, seed: u64) -> Vec<Member> {
    let scenes = around.scenes(scene);
    let mut random = Random::new(seed);
    let draw = |_| {
        let mut within = |low: f64, high: f64| low + (high - low) * random.unit();
        let scene = &scenes[(within(0.0, scenes.len() as f64) as usize).min(scenes.len() - 1)];
        let change = Change {
            counts: within(COUNTS[1].ln(), COUNTS[0].ln()).exp(),
            inertia: within(TIMES[0].ln(), TIMES[2].ln()).exp(),
            damping: within(TIMES[0].ln(), TIMES[2].ln()).exp(),
            delay_ticks: within(DELAYS[0], DELAYS[3]),
        };
        let place = within(-BEYOND, 1.0 + BEYOND);
        let hand = between(&LIGHT, &FIRM, place);
        let name = format!("hand {place:.2} from light to firm");
        Member::new(scene, change, (Grip::Custom, Some(hand)), &name)
    };
    (0..members).map(draw).collect()
}

/// A hand between two, each of its parameters geometrically.
fn between(one: &Hand, other: &Hand, place: f64) -> Hand {
    let of = |a: f64, b: f64| a * (b / a).powf(place);
    Hand {
        inertia: of(one.inertia, other.inertia),
        damping: of(one.damping, other.damping),
        stiffness: of(one.stiffness, other.stiffness),
        pad_damping: of(one.pad_damping, other.pad_damping),
        pad_stiffness: of(one.pad_stiffness, other.pad_stiffness),
    }
}

/// The scene's own device at a rate and a noise: the worst of three grips.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nominal {
    /// Control rate, Hz.
    pub rate_hz: u32,
    /// Noise of the position sensor, degrees rms.
    pub noise_deg: f64,
    /// Deepest penetration of the touch over `F/k_de` of the press; absent where it left all numbers, as below.
    pub touch_penetration_ratio: Option<f64>,
    /// The touch over that of the ideal damped wall.
    pub touch: Option<TouchRatios>,
    /// Deepest penetration of the press over the ideal one.
    pub peak_penetration_ratio: Option<f64>,
    /// Ripple of the torque from tick to tick while the hand moves, rms, N·m.
    pub ripple_rms_n_m: Option<f64>,
    /// Motion at the end of the hold, peak to peak, rad.
    pub motion_at_rest_rad: Option<f64>,
}

impl Nominal {
    fn of(scene: &Scene) -> Result<Self> {
        let (felt, beside) = figures(scene, &Programme::of(scene), &CASES[0], true)?;
        let count_rad = scene.encoder.as_ref().map(|encoder| encoder.step_rad());
        let number = |value: f64| Some(value).filter(|value| value.is_finite());
        Ok(Self {
            rate_hz: scene.timing.rate_hz,
            noise_deg: noise_deg(scene),
            touch_penetration_ratio: number(beside.touch_penetration_ratio),
            touch: beside.touch,
            peak_penetration_ratio: number(felt.get(Measure::PeakPenetrationRatio)),
            ripple_rms_n_m: number(felt.get(Measure::RippleRmsNM)),
            motion_at_rest_rad: beside
                .motion_at_rest_counts
                .zip(count_rad)
                .and_then(|(counts, count)| number(counts * count)),
        })
    }
}

/// One member and its result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judged {
    /// Hand, counts, inertia, damping, delay, rate and noise.
    pub member: String,
    /// `T sqrt(k_de/J)`.
    pub stiffness_per_tick: f64,
    /// Delay, ticks.
    pub delay_ticks: f64,
    /// Whether `T sqrt(k_de/J)` is beyond what any tuned law holds at this delay.
    pub beyond_map: bool,
    /// Deepest penetration of the press over `F/k_de`; absent where the wall is lost.
    pub press: Option<f64>,
    /// Depth of the touch, over the ideal depth of the press.
    pub touch: Option<f64>,
}

impl Judged {
    /// The deeper of the two; infinite where lost.
    #[must_use]
    pub fn depth(&self) -> f64 {
        let both = self.press.zip(self.touch);
        both.map_or(f64::INFINITY, |(press, touch)| press.max(touch))
    }
}

/// A setting on its family.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Family {
    /// The law.
    pub law: String,
    /// `k_de`, N·m/rad.
    pub k_desired: f64,
    /// Number of members.
    pub members: usize,
    /// Members whose wall is lost.
    pub lost: usize,
    /// How many of the lost members are beyond the map.
    pub lost_beyond_map: usize,
    /// Members that are lost or go deeper than [`DEEP`].
    pub deep: usize,
    /// Deepest press of the members that are not lost, over `F/k_de`.
    pub deepest_press: f64,
    /// Deepest touch of the same, over the same.
    pub deepest_touch: f64,
    /// The scene's own device.
    pub nominal: Vec<Nominal>,
    /// The worst, worst first.
    pub worst: Vec<Judged>,
}

/// Judges members; calls `done` after each.
///
/// # Errors
/// Settings that the law cannot have for one of them.
pub fn judge(
    law: &str,
    scene: &Scene,
    around: &Around,
    members: &[Member],
    done: impl Fn() + Sync,
) -> Result<Family> {
    let mut judged: Vec<Judged> = members
        .par_iter()
        .map(|member| {
            let depths = member.depths()?;
            done();
            Ok(Judged {
                member: member.name.clone(),
                stiffness_per_tick: stiffness_per_tick(&member.scene),
                delay_ticks: member.delay_ticks,
                beyond_map: member.is_beyond_map(),
                press: depths.map(|[press, _]| press),
                touch: depths.map(|[_, touch]| touch),
            })
        })
        .collect::<Result<_>>()?;
    let nominal = around
        .scenes(scene)
        .par_iter()
        .map(Nominal::of)
        .collect::<Result<_>>()?;
    let lost = |judged: &&Judged| judged.press.is_none();
    let deepest = |of: fn(&Judged) -> Option<f64>| judged.iter().filter_map(of).fold(0.0, f64::max);
    let mut family = Family {
        law: law.to_owned(),
        k_desired: scene.wall.k_desired_n_m_per_rad,
        members: judged.len(),
        lost: judged.iter().filter(lost).count(),
        lost_beyond_map: judged
            .iter()
            .filter(lost)
            .filter(|it| it.beyond_map)
            .count(),
        deep: judged.iter().filter(|it| it.depth() > DEEP).count(),
        deepest_press: deepest(|it| it.press),
        deepest_touch: deepest(|it| it.touch),
        nominal,
        worst: Vec::new(),
    };
    // Of the lost the least stiff for its tick first: it says most of the setting.
    judged.sort_by(|a, b| {
        (b.depth().total_cmp(&a.depth()))
            .then(a.stiffness_per_tick.total_cmp(&b.stiffness_per_tick))
    });
    judged.truncate(WORST);
    family.worst = judged;
    Ok(family)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scorecard::family_page::text;
    use crate::scorecard::rivals::Rival;

    fn knob(law: &str, k_desired: f64) -> Scene {
        let mut scene = Scene::load("thesis-knob").expect("a shipped scene");
        scene.wall.k_desired_n_m_per_rad = k_desired;
        Rival::named(law).expect("a law").of(&scene)
    }

    #[test]
    fn corners_are_every_combination_and_a_seed_draws_the_same_between_them() {
        let scene = knob("enhanced", 20.0);
        let own = Around::default();
        let members = corners(&scene, &own);
        assert_eq!(members.len(), 216);
        let all = Around {
            rates_hz: vec![1000, 2000, 5000, 10_000],
            noise_deg: vec![0.0, 0.03, 0.06],
        };
        let many = corners(&scene, &all);
        let mut names: Vec<&String> = many.iter().map(|member| &member.name).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), 12 * 216);
        let drawn = sample(&scene, &all, 300, 7);
        assert_eq!(drawn[..100], sample(&scene, &all, 100, 7));
        assert_ne!(drawn[..100], sample(&scene, &all, 100, 8));
        for member in &drawn {
            let (device, own) = (&member.scene.device, &scene.device);
            for (one, nominal) in [
                (device.inertia_kg_m2, own.inertia_kg_m2),
                (device.damping_n_m_s_per_rad, own.damping_n_m_s_per_rad),
            ] {
                assert!((0.5..=2.0).contains(&(one / nominal)), "{}", member.name);
            }
            assert!((0.0..=1.0).contains(&member.delay_ticks));
            assert_eq!(member.scene.law, scene.law);
        }
        for rate_hz in &all.rates_hz {
            assert!(drawn.iter().any(|it| it.scene.timing.rate_hz == *rate_hz));
        }
        // Half the inertia, a whole tick late: three grips, two encoders, three dampings.
        let beyond = |members: &[Member]| members.iter().filter(|it| it.is_beyond_map()).count();
        assert_eq!(beyond(&members), 18);
        assert_eq!(beyond(&corners(&knob("enhanced", 14.0), &own)), 0);
    }

    #[test]
    fn what_holds_loses_no_member_and_what_does_not_is_named() {
        let judged = |law, k_desired| {
            let scene = knob(law, k_desired);
            let own = Around::default();
            judge(law, &scene, &own, &corners(&scene, &own), || ()).expect("runs")
        };
        // Half of the critical stiffness of the least damped, with the latest: k_c of half the damping and a tick of delay is a sixth.
        let soft = judged("spring", 0.1);
        assert_eq!((soft.members, soft.lost), (216, 0));
        // At once an undamped spring would go twice as deep as it rests.
        assert!(soft.deepest_press < 2.0, "{soft:?}");
        assert!(soft.nominal[0].motion_at_rest_rad.is_some());
        let hard = judged("spring", 20.0);
        assert_eq!(hard.lost, 216);
        assert_eq!(hard.lost_beyond_map, 18);
        assert_eq!(hard.worst.len(), 5);
        // Of lost ones those first that sampling asks least of: the heaviest.
        assert!(text(&[soft, hard]).contains("2.00 J"));
    }
}
