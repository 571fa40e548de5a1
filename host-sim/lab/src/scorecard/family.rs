//! Judges one set of law settings on many device variants: grip, encoder counts, inertia, damping, delay, rate and noise all vary
//! together.
//!
//! The scorecard's devices differ in one property at a time, but a knob with half the inertia may also have a large delay. This
//! module therefore simulates every combination ([`corners`]), and random variants between them ([`sample`]). The law's settings
//! stay the same. Each variant is touched and pressed. A variant on which the wall is too stiff for any tuned law (docs/tuning,
//! "Where a tuned wall ends") is counted separately, because no settings would help.

use super::cases::{CASES, Deed, GRIPS, Programme};
use super::measure::Measure;
use super::touch::IdealTouch;
use super::touch_ratios::TouchRatios;
use super::watch::watch;
use super::{figures, stiffness_per_tick};
use crate::random_device::Random;
use crate::scene_hand::of_plant;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use touchstone_sim::error::Result;
use touchstone_sim::scene::{Grip, Scene, SensorNoise};
use touchstone_world::plant::{FIRM, Hand, LIGHT};

/// Relative depth above which a wall counts as lost: depth of a press or touch over the ideal depth (force of the press over
/// requested stiffness).
pub const LOST_DEPTH: f64 = 5.0;
/// Largest deviation of the stiffness in a hold, as a fraction of the requested stiffness; with a larger deviation the wall counts
/// as lost.
pub const LOST_ERROR: f64 = 0.5;
/// Relative depth above which a press or touch counts as deep: depth over the ideal depth (force of the press over requested
/// stiffness).
pub const DEEP: f64 = 1.3;
/// Number of the worst device variants that are named in the results.
const WORST: usize = 5;
/// Largest number of lost variants that are listed, if more than [`WORST`] are lost.
const MOST_LOST_LISTED: usize = 12;
/// Factors on the scene's encoder counts; the smaller one makes 16,384 of 40,000.
const COUNTS: [f64; 2] = [1.0, 0.4096];
/// Factors on the scene's inertia and damping.
const TIMES: [f64; 3] = [0.5, 1.0, 2.0];
/// Delays from sample to force of the device variants, in ticks (control periods).
const DELAYS: [f64; 4] = [0.0, 0.1, 0.5, 1.0];
/// Factors on inertia and damping of a device that was measured, whose encoder is known: within 10 %.
const MEASURED_TIMES: [f64; 3] = [0.9, 1.0, 1.1];
/// Delays of a device that was measured, in ticks (control periods).
const MEASURED_DELAYS: [f64; 3] = [0.0, 0.1, 0.5];
/// Fraction of the distance between light and firm grip by which random hands may lie outside the two, on logarithmic scales.
const BEYOND: f64 = 0.25;
/// Pairs of delay in ticks and stiffness up to which every tuned wall comes to rest, from the map in docs/tuning. Stiffness is the
/// angle in rad by which the device's oscillation on the wall advances per control period.
const MAP: [(f64, f64); 3] = [(0.0, 1.35), (0.5, 0.92), (1.0, 0.62)];

/// A device variant of the family, with the hand that holds it.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// The scene with the varied device.
    pub scene: Scene,
    /// Name of the grip, and the parameters of a random hand if it is none of the scorecard's grips.
    pub hand: (Grip, Option<Hand>),
    /// Description of the device variant in words.
    pub name: String,
    /// Delay from sample to force, in ticks (control periods).
    pub delay_ticks: f64,
}

/// How a variant's device differs from the scene's: factors, and the delay.
#[derive(Debug, Clone, Copy)]
struct Change {
    counts: f64,
    inertia: f64,
    damping: f64,
    delay_ticks: f64,
}

/// Which variants of the scene's device are judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Devices {
    /// Every combination of the factors and delays.
    #[default]
    Corners,
    /// Random variants between these.
    Random,
    /// Every combination within 10 % of a device that was measured. Their touches are compared with those of an ideal wall.
    Measured,
}

impl Devices {
    /// Name of the set, as in JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Corners => "corners",
            Self::Random => "random",
            Self::Measured => "measured",
        }
    }
}

/// Devices, control rates and noise levels of the variants; an empty list means the scene's own.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Around {
    /// Which variants of the device are judged.
    pub devices: Devices,
    /// Control rates, Hz.
    pub rates_hz: Vec<u32>,
    /// Noise of the position sensor, degrees, root mean square.
    pub noise_deg: Vec<f64>,
}

impl Around {
    /// Factors on counts, inertia and damping, and delays in ticks (control periods), of which the variants are made.
    fn changes(&self) -> (&'static [f64], &'static [f64], &'static [f64]) {
        match self.devices {
            Devices::Measured => (&COUNTS[..1], &MEASURED_TIMES, &MEASURED_DELAYS),
            Devices::Corners | Devices::Random => (&COUNTS, &TIMES, &DELAYS),
        }
    }

    /// The scene, repeated for every control rate and every noise level.
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

    /// Whether the wall is stiffer than any tuned law was found to handle at this delay.
    #[must_use]
    pub fn is_beyond_map(&self) -> bool {
        stiffness_per_tick(&self.scene) > most_stiffness_per_tick(self.delay_ticks)
    }

    /// Inertia and damping of the device, in bits: all on which the touch of an ideal wall depends besides the hand.
    fn mechanics(&self) -> [u64; 2] {
        let device = &self.scene.device;
        [device.inertia_kg_m2, device.damping_n_m_s_per_rad].map(f64::to_bits)
    }

    /// Deepest penetration of press and touch, each divided by the ideal depth (force of the press over requested stiffness).
    /// `None` if the wall is lost: press or touch too deep, or stiffness far off.
    ///
    /// Also the touch over that of an ideal wall, if `ideal` has this device and the hand is one of the scorecard's grips.
    fn depths(&self, ideal: &IdealTouches) -> Result<(Option<[f64; 2]>, Option<TouchRatios>)> {
        let (grip, hand) = self.hand;
        let programme = Programme::of(&self.scene);
        let mut pressed = programme.scene(&self.scene, grip, Deed::Press);
        pressed.operator.hand = hand.as_ref().map(of_plant);
        let (figures, beside) = watch(&pressed, Deed::Press, false)?;
        let depths = [
            figures.get(Measure::PeakPenetrationRatio),
            beside.touch_penetration_ratio,
        ];
        let held = figures.get(Measure::StiffnessErrorHeld) <= LOST_ERROR;
        let near = depths.iter().all(|depth| *depth <= LOST_DEPTH);
        let grip = GRIPS.iter().position(|it| *it == grip);
        let ideal = grip.zip(ideal.get(&self.mechanics()));
        let ratios = ideal.map(|(grip, ideal)| ideal.ratios(grip, &beside));
        Ok(((held && near).then_some(depths), ratios))
    }
}

/// Largest stiffness of a wall that a tuned law handles at this delay, interpolated linearly from [`MAP`]; beyond the map's
/// longest delay, its last value. Stiffness is the angle in rad by which the oscillation advances per control period.
fn most_stiffness_per_tick(delay_ticks: f64) -> f64 {
    let between = MAP.windows(2).find(|pair| delay_ticks <= pair[1].0);
    let Some([(from, start), (to, end)]) = between else {
        return MAP[MAP.len() - 1].1;
    };
    start + (end - start) * (delay_ticks - from) / (to - from)
}

/// All combinations of the varied properties: 216 variants for each rate and noise level, 81 of a measured device.
#[must_use]
pub fn corners(scene: &Scene, around: &Around) -> Vec<Member> {
    let (all_counts, times, delays) = around.changes();
    let mut members = Vec::new();
    for scene in around.scenes(scene) {
        for &counts in all_counts {
            for &inertia in times {
                for &damping in times {
                    for &delay_ticks in delays {
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

/// Random variants between the corners, with hands between the grips and slightly beyond. The same seed always gives the same
/// variants; a larger number begins with those of a smaller one.
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

/// A hand between two hands, each parameter interpolated on a logarithmic scale.
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

/// Results of the scene's own device at one rate and noise level; the worst of three simulated grips (light, medium, firm).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nominal {
    /// Control rate, Hz.
    pub rate_hz: u32,
    /// Noise of the position sensor, degrees, root mean square.
    pub noise_deg: f64,
    /// Deepest penetration of the light touch, divided by the ideal penetration of the press (force over requested stiffness).
    /// `None` if the run diverged.
    pub touch_penetration_ratio: Option<f64>,
    /// Measures of the light touch, divided by those of a touch of the ideal damped wall; `None` if they were not computed.
    pub touch: Option<TouchRatios>,
    /// Deepest penetration of the press, divided by the ideal penetration (force over requested stiffness). `None` if the run
    /// diverged.
    pub peak_penetration_ratio: Option<f64>,
    /// Root mean square change of the torque from tick to tick while the hand oscillates, N·m. `None` if the run diverged or no
    /// force acted.
    pub ripple_rms_n_m: Option<f64>,
    /// Motion of the knob at the end of the hold, peak to peak, rad. `None` if the run diverged or there is no encoder.
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

/// Results of one device variant with its hand.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judged {
    /// Description of the variant: hand, counts, inertia, damping, delay, rate and noise.
    pub member: String,
    /// Stiffness of the wall as the angle in rad by which the device's oscillation on the wall advances per control period.
    pub stiffness_per_tick: f64,
    /// Delay from sample to force, in ticks (control periods).
    pub delay_ticks: f64,
    /// Whether the wall is stiffer than any tuned law was found to handle at this delay.
    pub beyond_map: bool,
    /// Deepest penetration of the press over the ideal depth (force of the press over requested stiffness). Absent if the wall is
    /// lost: press or touch too deep, or stiffness far off.
    pub press: Option<f64>,
    /// Deepest penetration of the light touch over the ideal depth of the press (force over requested stiffness). Absent if the
    /// wall is lost: press or touch too deep, or stiffness far off.
    pub touch: Option<f64>,
}

impl Family {
    /// The larger of the relative depths of press and touch over the device variants on which the wall is not lost; `None` if it is
    /// lost on all of them.
    #[must_use]
    pub fn deepest(&self) -> Option<f64> {
        let both = self.deepest_press.zip(self.deepest_touch);
        both.map(|(press, touch)| press.max(touch))
    }
}

impl Judged {
    /// The larger of the relative depths of press and touch; infinite if the wall is lost (press or touch too deep, or stiffness
    /// far off).
    #[must_use]
    pub fn depth(&self) -> f64 {
        let both = self.press.zip(self.touch);
        both.map_or(f64::INFINITY, |(press, touch)| press.max(touch))
    }
}

/// Results of one set of law settings on all device variants.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Family {
    /// Name of the control law.
    pub law: String,
    /// Which variants of the device were simulated.
    pub devices: Devices,
    /// Requested stiffness `k_de`, N·m/rad.
    pub k_desired: f64,
    /// Number of device variants that were simulated.
    pub members: usize,
    /// Number of device variants on which the wall is lost (press or touch too deep, or stiffness far off).
    pub lost: usize,
    /// Number of device variants on which the wall is lost and would be lost with any tuned law, see [`Judged::beyond_map`].
    pub lost_beyond_map: usize,
    /// Number of device variants on which the wall is lost, or press or touch is deeper than [`DEEP`].
    pub deep: usize,
    /// Deepest press over the device variants on which the wall is not lost, divided by the ideal depth (force over requested
    /// stiffness). `None` if the wall is lost on all of them.
    pub deepest_press: Option<f64>,
    /// Deepest light touch over the device variants on which the wall is not lost, divided by the ideal depth of the press. `None` if
    /// the wall is lost on all of them.
    pub deepest_touch: Option<f64>,
    /// Measures of the light touch over those of an ideal wall, the worst of all variants of a measured device; `None` if the device
    /// was not measured.
    pub touch_over_ideal: Option<TouchRatios>,
    /// Results of the scene's own device, one entry per rate and noise level; empty for random variants, because those of the
    /// corners are the same.
    pub nominal: Vec<Nominal>,
    /// The worst variants, the worst one first.
    pub worst: Vec<Judged>,
}

/// Touches of the ideal wall on each device, by [`Member::mechanics`].
type IdealTouches = BTreeMap<[u64; 2], IdealTouch>;

/// Simulates the touches of the ideal wall on a measured device's variants: once for those that differ only in what an ideal wall
/// does not have, such as delay.
fn ideal_touches(devices: Devices, members: &[Member]) -> Result<IdealTouches> {
    if devices != Devices::Measured {
        return Ok(BTreeMap::new());
    }
    let distinct: BTreeMap<_, &Scene> = members
        .iter()
        .map(|member| (member.mechanics(), &member.scene))
        .collect();
    let touches = distinct
        .into_par_iter()
        .map(|(mechanics, scene)| Ok((mechanics, IdealTouch::of(scene, &Programme::of(scene))?)));
    touches.collect()
}

/// Simulates one set of law settings on all device variants; calls `done` after each variant.
///
/// # Errors
/// The control law does not accept the settings on one of the variants.
pub fn judge(
    law: &str,
    scene: &Scene,
    around: &Around,
    members: &[Member],
    done: impl Fn() + Sync,
) -> Result<Family> {
    let touches = ideal_touches(around.devices, members)?;
    let (mut judged, ideal): (Vec<Judged>, Vec<Option<TouchRatios>>) = members
        .par_iter()
        .map(|member| {
            let (depths, ideal) = member.depths(&touches)?;
            done();
            let judged = Judged {
                member: member.name.clone(),
                stiffness_per_tick: stiffness_per_tick(&member.scene),
                delay_ticks: member.delay_ticks,
                beyond_map: member.is_beyond_map(),
                press: depths.map(|[press, _]| press),
                touch: depths.map(|[_, touch]| touch),
            };
            Ok((judged, ideal))
        })
        .collect::<Result<Vec<_>>>()?
        .into_iter()
        .unzip();
    let nominal = match around.devices {
        Devices::Random => Vec::new(),
        Devices::Corners | Devices::Measured => around
            .scenes(scene)
            .par_iter()
            .map(Nominal::of)
            .collect::<Result<_>>()?,
    };
    let lost = |judged: &&Judged| judged.press.is_none();
    let deepest =
        |of: fn(&Judged) -> Option<f64>| judged.iter().filter_map(of).max_by(f64::total_cmp);
    let mut family = Family {
        law: law.to_owned(),
        devices: around.devices,
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
        touch_over_ideal: ideal
            .into_iter()
            .flatten()
            .reduce(|one, other| one.worst(&other)),
        nominal,
        worst: Vec::new(),
    };
    // Lost variants with the smallest stiffness per tick come first, because sampling limits these walls least.
    judged.sort_by(|a, b| {
        (b.depth().total_cmp(&a.depth()))
            .then(a.stiffness_per_tick.total_cmp(&b.stiffness_per_tick))
    });
    judged.truncate(WORST.max(family.lost.min(MOST_LOST_LISTED)));
    family.worst = judged;
    Ok(family)
}

#[cfg(test)]
mod tests;
