//! Hard cases of a knob's feel: walls that overlap, torques with a cliff, fine detents, many turns.

use super::random::Random;
use super::{Case, Effort, Finding};
use crate::scorecard::feel::feel_card;
use std::f64::consts::TAU;
use touchstone_control::environment::{
    ClickSettings, Counted, DetentSettings, Environment, Extent, Face, FeelSettings,
    ProfileSettings, Shape, Side, Spacing, WallSettings,
};
use touchstone_control::{
    CountScale, Fixed16, Fixed32, LawKind, Position, Reported, Settings, Si, StatesKind,
};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::run::live::Live;
use touchstone_sim::scene::Scene;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "overlapping-walls",
        about: "a knob between two walls that overlap, each solid where the other is, at 10^5 random counts and in three grips",
        oracle: "the difference of two springs; the guard's bound; in a hand it rests where the springs and the hand balance",
        unit: "steps of the format, of the guard's bound, or rad",
        run: overlapping_walls,
    },
    Case {
        name: "cliff",
        about: "a profile whose torque falls from one limit to the other within 1.1 mrad, three encoder counts",
        oracle: "the straight line between the two points; the guard's bound; each position counted once",
        unit: "steps of the format, of the guard's bound, or positions",
        run: cliff,
    },
    Case {
        name: "narrow-detents",
        about: "detents 8.2 encoder counts wide, so that two of three counts lie beside the torque's peaks",
        oracle: "the triangle wave at the true angle; the guard's bound; each position counted once",
        unit: "steps of the format, of the guard's bound, or positions",
        run: narrow_detents,
    },
    Case {
        name: "ten-thousand-turns",
        about: "detents, profile and clicks after 10,000 turns to either side, and a knob that has turned there and back",
        oracle: "the torques of the first turn, bit for bit; each position counted once, and no buzz",
        unit: "ticks that differ, positions, or counts beyond two",
        run: ten_thousand_turns,
    },
];

/// Encoder counts per turn of the cases without a scene.
const COUNTS: u32 = 40_000;

fn settings() -> Settings {
    Settings {
        law: LawKind::Spring,
        states: StatesKind::Measured,
        ..Settings::thesis()
    }
}

/// Error for an environment that the control law refuses, which would be a mistake in a case.
fn refused(error: impl std::fmt::Display) -> Error {
    Error::Option {
        option: "hard".to_owned(),
        problem: error.to_string(),
        fix: "report this".to_owned(),
    }
}

fn bare<N: Reported>(walls: &[WallSettings]) -> Result<Environment<N>> {
    Environment::new(&settings(), walls, None).map_err(refused)
}

/// Input of a control law at this encoder count.
fn at(count: i64) -> Result<Counted> {
    let scale = CountScale::new(COUNTS, Si::ZERO).ok_or_else(|| refused("no scale"))?;
    Ok(Counted { scale, count })
}

fn angle(count: i64) -> f64 {
    TAU * count as f64 / f64::from(COUNTS)
}

/// Runs a check that is generic over the number format in fixed16, fixed32, f32 and f64.
macro_rules! formats {
    ($name:literal, $check:ident, $bound:expr) => {
        [
            Finding::new(concat!($name, " fixed16"), $check::<Fixed16>()?, $bound),
            Finding::new(concat!($name, " fixed32"), $check::<Fixed32>()?, $bound),
            Finding::new(concat!($name, " f32"), $check::<f32>()?, $bound),
            Finding::new(concat!($name, " f64"), $check::<f64>()?, $bound),
        ]
    };
}

/// Step of force and position in a number format, but at least 2^-30, the resolution of angles and coefficients.
fn step<N: Reported>() -> f64 {
    Position::<N>::quantum().to_f64().max(2f64.powi(-30))
}

const STIFF: [f64; 2] = [5.0, 10.0];

fn overlapping_walls(_: Effort) -> Result<Vec<Finding>> {
    /// Largest deviation from the difference of the two springs' forces, in steps of the number format. Each spring multiplies the
    /// rounding error of its penetration by its stiffness.
    fn error<N: Reported>() -> Result<f64> {
        let wall = |surface, side, k: f64| WallSettings {
            face: Face { surface, side },
            k_desired: Si::saturating_from_num(k),
        };
        let (low, high) = (Si::ZERO, Si::lit("0.02"));
        let mut both = bare::<N>(&[
            wall(low, Side::Above, STIFF[0]),
            wall(high, Side::Below, STIFF[1]),
        ])?;
        let mut random = Random::new(31);
        let mut worst = 0.0_f64;
        for _ in 0..100_000 {
            let count = (200.0 * random.uniform()).round() as i64;
            let x = angle(count);
            let limit = settings().force_limit.to_num::<f64>();
            let wanted = STIFF[0] * x.max(0.0) - STIFF[1] * (0.02 - x).max(0.0);
            let got = both.tick(&at(count)?, None).to_f64();
            worst = worst.max((got - wanted.clamp(-limit, limit)).abs());
        }
        Ok(worst / step::<N>())
    }
    // A penetration is rounded down, by less than a step, and so is each product. The two springs' errors have opposite signs.
    let mut found = formats!("springs", error, STIFF[1] + 1.0).to_vec();
    for grip in ["light", "medium", "firm"] {
        let scene = Scene::load("gimbal-knob")?.with_overrides(&[
            &format!("operator.grip={grip}"),
            "operator.motion.kind=none",
            "timing.duration_s=4",
            "device.initial_angle_rad=0.505",
            "wall.surface_rad=0.5",
            "environment.wall2.at_rad=0.52",
            "environment.wall2.solid=below",
        ])?;
        let mut live = Live::new(&scene)?;
        let (mut got_out, mut last) = (0.0_f64, [0.0_f64; 2]);
        let (centre, away) = (0.51, 0.006);
        for tick in 0..8000_u32 {
            // The hand moves to and fro through the overlap, then rests beside its middle.
            let way = if tick < 6000 {
                0.1 * (f64::from(tick) * TAU / 1500.0).sin()
            } else {
                away
            };
            let moment = live.tick(centre + way);
            got_out = got_out.max(-moment.energies.hand_j());
            last = [last[1], moment.tick.angle_rad];
        }
        let guard = &scene.law.guard;
        let allowed = guard.capacity_j + guard.refill_w * 8.0;
        found.push(Finding::new(
            format!("{grip} grip, energy"),
            got_out / allowed,
            1.0,
        ));
        // Both walls have the stiffness k. Together they pull to the middle with 2 k, against the hand. Friction and one count
        // are allowed as an error.
        let hand = scene.operator.hand().map(|it| it.compliance_rad_per_n_m());
        let hand = 1.0 / hand.unwrap_or(f64::INFINITY);
        let walls = 2.0 * scene.wall.k_desired_n_m_per_rad;
        let rests = centre + away * hand / (hand + walls);
        let friction = scene
            .device
            .friction
            .as_ref()
            .map_or(0.0, |it| it.kinetic_n_m);
        let count = scene.encoder.as_ref().map_or(0.0, |it| it.step_rad());
        found.push(Finding::new(
            format!("{grip} grip, place of rest"),
            (last[1] - rests).abs(),
            friction / (hand + walls) + count,
        ));
    }
    Ok(found)
}

/// Findings for a feel in three grips: energy that the hand got out, divided by what the guard allows, and number of positions
/// that were lost or counted twice.
fn played(name: &str, sets: &[&str]) -> Result<Vec<Finding>> {
    let scene = Scene::load(name)?.with_overrides(sets)?;
    let card = feel_card(&scene, 300)?;
    let of_grip = card.grips.iter().flat_map(|felt| {
        let energy = felt.energy_out_j.max(0.0) / felt.energy_allowed_j;
        // If no position was crossed, the case has tested nothing and fails.
        let wrong = match felt.crossings {
            0 => f64::NAN,
            _ => (felt.lost + felt.doubled) as f64,
        };
        [
            Finding::new(format!("{} grip, energy", felt.grip), energy, 1.0),
            Finding::new(format!("{} grip, positions", felt.grip), wrong, 0.0),
        ]
    });
    Ok(of_grip.collect())
}

/// Points of a profile that rise from -1 to 1 over one period and fall back to -1 in a single step.
fn cliff_points() -> Vec<f64> {
    (0..96).map(|i| 2.0 * f64::from(i) / 95.0 - 1.0).collect()
}

fn cliff(_: Effort) -> Result<Vec<Finding>> {
    const COPIES: u16 = 60;
    fn error<N: Reported>() -> Result<f64> {
        let whole: Vec<i16> = (cliff_points().iter())
            .map(|point| (10_000.0 * point).round() as i16)
            .collect();
        let strength = 0.02;
        let profile = ProfileSettings {
            extent: Extent::PerTurn(COPIES),
            start: Si::ZERO,
            strength: Si::saturating_from_num(strength),
            shape: Shape::new(&whole).map_err(refused)?,
        };
        let limit = settings().force_limit;
        let mut drawn = bare::<N>(&[])?
            .with_profile(&profile, limit)
            .map_err(refused)?;
        let mut worst = 0.0_f64;
        for count in -i64::from(COUNTS)..i64::from(COUNTS) {
            // Position in units of the 96 points of a period, without rounding.
            let place =
                count.rem_euclid(COUNTS.into()) as f64 * f64::from(COPIES) / f64::from(COUNTS);
            let place = 96.0 * place.fract();
            let (before, way) = (place.floor() as usize % 96, place.fract());
            let [low, high] = [before, (before + 1) % 96].map(|i| f64::from(whole[i]) / 10_000.0);
            let wanted = -strength * (low * (1.0 - way) + high * way);
            let got = drawn.tick(&at(count)?, None).to_f64();
            worst = worst.max((got - wanted).abs());
        }
        Ok(worst / step::<N>())
    }
    // The point's fraction and the product are rounded down, and the strength to a step.
    let mut found = formats!("the line", error, 3.0).to_vec();
    found.extend(played(
        "magnetic-detents",
        &[
            &format!("environment.profile.shape={:?}", cliff_points()),
            "environment.profile.per_rev=60",
            "environment.profile.strength_n_m=0.02",
        ],
    )?);
    Ok(found)
}

fn narrow_detents(_: Effort) -> Result<Vec<Finding>> {
    /// Detents per turn: 8.2 counts of 40,000 apart, as 2,000 detents are on an encoder with 16,384 counts.
    const PER_TURN: u16 = 4_878;
    fn error<N: Reported>() -> Result<f64> {
        let strength = 0.002;
        let ring = DetentSettings {
            spacing: Spacing::PerTurn(PER_TURN),
            strength: Si::saturating_from_num(strength),
            centre: Si::ZERO,
        };
        let mut detents = Environment::<N>::new(&settings(), &[], Some(&ring)).map_err(refused)?;
        let mut worst = 0.0_f64;
        for count in 0..i64::from(COUNTS) {
            let part =
                (count * i64::from(PER_TURN)).rem_euclid(COUNTS.into()) as f64 / f64::from(COUNTS);
            // The distance to the nearest detent as a fraction of the pitch: the peak is at a quarter.
            let beyond = part - part.round();
            let height = if beyond.abs() <= 0.25 {
                4.0 * beyond
            } else {
                (2.0 - 4.0 * beyond.abs()) * beyond.signum()
            };
            let got = detents.tick(&at(count)?, None).to_f64();
            worst = worst.max((got - strength * height).abs());
        }
        Ok(worst / step::<N>())
    }
    let mut found = formats!("the wave", error, 3.0).to_vec();
    found.extend(played(
        "fine-detents",
        &[
            "environment.detents.per_rev=2000",
            "environment.detents.strength_n_m=0.002",
        ],
    )?);
    Ok(found)
}

/// Number of turns by which the knob is away from the first turn, to either side.
const TURNS: i64 = 10_000;

fn ten_thousand_turns(_: Effort) -> Result<Vec<Finding>> {
    /// Number of ticks in which the torque 10,000 turns away differs from that in the first turn. A knob is moved there through
    /// all clicks, another one is placed there.
    fn differing<N: Reported>() -> Result<f64> {
        let limit = settings().force_limit;
        let ring = DetentSettings {
            spacing: Spacing::PerTurn(23),
            strength: Si::lit("0.02"),
            centre: Si::lit("0.1"),
        };
        let points: Vec<i16> = (0..31_i16).map(|i| i * 613 % 20_001 - 10_000).collect();
        let profile = ProfileSettings {
            extent: Extent::PerTurn(7),
            start: Si::lit("0.3"),
            strength: Si::lit("0.03"),
            shape: Shape::new(&points).map_err(refused)?,
        };
        let feel = FeelSettings {
            click: Some(ClickSettings {
                spacing: Spacing::PerTurn(17),
                centre: Si::lit("0.05"),
                strength: Si::lit("0.01"),
                duration_s: Si::lit("0.006"),
            }),
            ..FeelSettings::default()
        };
        let made = || -> Result<Environment<N>> {
            Environment::new(&settings(), &[], Some(&ring))
                .and_then(|it| it.with_profile(&profile, limit))
                .and_then(|it| it.with_feel(&feel, &settings()))
                .map_err(refused)
        };
        let around = |felt: &mut Environment<N>, turns: i64| -> Result<Vec<_>> {
            let first = turns * i64::from(COUNTS);
            // A turn and a half, to and fro, so that clicks come from both sides.
            (0..3000_i64)
                .map(|i| {
                    let way = if i < 1500 { i } else { 3000 - i };
                    Ok(felt.tick(&at(first + 41 * way)?, None))
                })
                .collect()
        };
        let here = around(&mut made()?, 0)?;
        let mut differ = 0_u32;
        for side in [1, -1] {
            let mut felt = made()?;
            // The knob moves there in steps of a hundredth of a turn, and so passes every click. The knob to compare with comes
            // to the first turn from two turns away. Both have then passed clicks in the same direction.
            let end = side * TURNS * i64::from(COUNTS);
            let mut fresh = made()?;
            for (knob, from, to) in [
                (&mut felt, 0, end),
                (&mut fresh, -2 * side * i64::from(COUNTS), 0),
            ] {
                let mut count = from;
                while count != to {
                    knob.tick(&at(count)?, None);
                    count += side * 400;
                }
                // Pulses of clicks that were passed on the way end.
                for _ in 0..20 {
                    knob.tick(&at(to)?, None);
                }
            }
            let there = around(&mut felt, side * TURNS)?;
            let again = around(&mut fresh, 0)?;
            differ += there.iter().zip(&again).filter(|(a, b)| a != b).count() as u32;
            let back = around(&mut made()?, side * TURNS)?;
            differ += back.iter().zip(&here).filter(|(a, b)| a != b).count() as u32;
        }
        Ok(f64::from(differ))
    }
    let mut found = formats!("all parts", differing, 0.0).to_vec();
    for name in ["coarse-detents", "clicker"] {
        for side in [1.0, -1.0] {
            let start = side * TAU * TURNS as f64;
            let set = format!("device.initial_angle_rad={start}");
            let card = feel_card(&Scene::load(name)?.with_overrides(&[set])?, 300)?;
            for felt in &card.grips {
                let wrong = match felt.crossings {
                    0 => f64::NAN,
                    _ => (felt.lost + felt.doubled) as f64,
                };
                let beyond = (felt.buzz_counts - 2.0).max(0.0);
                let subject = format!("{name}, {:+} turns, {} grip", side * 1e4, felt.grip);
                found.push(Finding::new(subject, wrong + beyond, 0.0));
            }
        }
    }
    Ok(found)
}
