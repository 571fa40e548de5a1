//! Cases of every law in every number format, by itself.

use super::random::Random;
use super::{Case, Effort, Finding};
use touchstone_control::filter::{MassState, VirtualMass};
use touchstone_control::{
    Choice as _, Controller, CountScale, Divisor, Fixed16, Fixed32, Force, LawKind, Position,
    Reported, Settings, Si, StatesKind, Stiffness,
};
use touchstone_protocol::unwrap::{Unwrap16, Unwrap32};
use touchstone_sim::error::Result;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "zero-and-one-count",
        about: "penetrations of no count and of one, to and fro, 10^5 ticks",
        oracle: "no force at or outside the surface, none beyond the limit, and a spring's is k e",
        unit: "ticks that break it",
        run: zero_and_one_count,
    },
    Case {
        name: "thousand-bounces",
        about: "a thousand contacts of the same course, down to a graze of one count",
        oracle: "nothing is remembered after leaving: the thousandth has the bits of the first",
        unit: "ticks that differ",
        run: bounces,
    },
    Case {
        name: "saturation",
        about: "two minutes far beyond the force limit, with a jitter of a count",
        oracle: "never beyond the limit, and nothing is wound up: the next press has the bits of a fresh law",
        unit: "ticks that break it",
        run: saturation,
    },
    Case {
        name: "windup",
        about: "a minute ten times as deep as the force limit reaches, with a jitter of a count: where the law would still push",
        oracle: "a force of the limit at that depth leaves no surface outside the wall",
        unit: "rad outside",
        run: windup,
    },
    Case {
        name: "ends-of-the-format",
        about: "10^5 jumps between the ends of the format, the surface and a hair on either side",
        oracle: "never beyond the limit, never no number",
        unit: "ticks that break it",
        run: ends,
    },
    Case {
        name: "tiny-positions",
        about: "penetrations down to the last denormal",
        oracle: "a force between 0 and the limit, and a spring's at most k e",
        unit: "ticks that break it",
        run: tiny,
    },
    Case {
        name: "lost-and-doubled-ticks",
        about: "a press of which every tenth reading is lost and every seventh comes twice",
        oracle: "never beyond the limit, and after leaving the bits of a fresh law",
        unit: "ticks that break it",
        run: lost,
    },
    Case {
        name: "switching-in-contact",
        about: "law and stiffness changed 1000 times in the middle of a press",
        oracle: "never beyond the limit, and after leaving the bits of a fresh law",
        unit: "ticks that break it",
        run: switching,
    },
    Case {
        name: "no-drift",
        about: "10^7 ticks (10^9 in the long form) of one small motion inside the wall",
        oracle: "the last period has the forces of the thousandth; laws that go on adjusting stay within a count's worth of it",
        unit: "N·m",
        run: drift,
    },
    Case {
        name: "encoder-wrap",
        about: "counters of 16 and 32 bits that wrap around, 10^6 readings over thousands of turns",
        oracle: "the sum of the moves; the same penetration in every turn, to a step of the format",
        unit: "counts, or steps of the format",
        run: wrap,
    },
    Case {
        name: "virtual-mass",
        about: "the virtual mass over twelve decades, shaken at random",
        oracle: "backward Euler never gives energy; semi-implicit Euler is stable above k T²/4 and not below",
        unit: "of the throughput, or spectral radius",
        run: virtual_mass,
    },
];

/// A finding for every law in every format: by itself as the thesis builds it, and on estimated states behind the guard.
macro_rules! every_law {
    ($check:ident) => {{
        let mut found = Vec::new();
        for (stages, base) in [("", Settings::thesis()), (", shipped", Settings::default())] {
            for &law in LawKind::ALL {
                let settings = Settings { law, ..base };
                found.push(subject::<Fixed16>(stages, &settings, $check::<Fixed16>));
                found.push(subject::<Fixed32>(stages, &settings, $check::<Fixed32>));
                found.push(subject::<f32>(stages, &settings, $check::<f32>));
                found.push(subject::<f64>(stages, &settings, $check::<f64>));
            }
        }
        Ok(found)
    }};
}

/// What breaks the oracle, counted.
fn subject<N: Reported>(
    stages: &str,
    settings: &Settings,
    check: fn(&Subject<N>) -> f64,
) -> Finding {
    let name = format!("{} {}{stages}", settings.law.word(), N::NAME);
    match (
        Controller::<N>::new(settings),
        N::signal(settings.force_limit),
    ) {
        (Ok(fresh), Some(limit)) => {
            let subject = Subject {
                fresh,
                limit: Force(limit),
                settings: *settings,
            };
            Finding::new(name, check(&subject), 0.0)
        }
        (Err(error), _) => {
            Finding::new(name, f64::INFINITY, 0.0).failing(format!("refused: {error}"))
        }
        (_, None) => {
            Finding::new(name, f64::INFINITY, 0.0).failing("the limit is beyond the format")
        }
    }
}

/// A law, as it is before its first tick.
struct Subject<N: Reported> {
    fresh: Controller<N>,
    limit: Force<N>,
    settings: Settings,
}

impl<N: Reported> Subject<N> {
    /// Comparisons with what is no number are false.
    fn is_within(&self, force: Force<N>) -> bool {
        force <= self.limit && force >= -self.limit
    }

    fn scale(&self) -> Option<CountScale> {
        CountScale::new(40_000, Si::ZERO)
    }

    /// Whether the law is told what was measured and its force is what it gives: estimator and guard have memories of their own,
    /// which go on outside of the wall.
    fn is_alone(&self) -> bool {
        self.settings.states == StatesKind::Measured && !self.settings.guard.on
    }

    fn is_spring(&self) -> bool {
        self.settings.law == LawKind::Spring && self.is_alone()
    }

    /// Leaves the wall for good: an augmented surface may lie far outside of it.
    fn leave(&self, law: &mut Controller<N>) {
        law.tick(Position::from_f64(-1e9));
    }

    /// A press of some counts in so many ticks, as a fresh law answers it; then out.
    fn press(&self, law: &mut Controller<N>, counts: f64) -> Vec<Force<N>> {
        let Some(scale) = self.scale() else {
            return Vec::new();
        };
        (0..=200)
            .map(|tick| {
                let depth = counts * (std::f64::consts::PI * f64::from(tick) / 200.0).sin();
                let jitter = f64::from(tick % 3) - 1.0;
                law.tick(scale.penetration((depth + jitter).round() as i64))
            })
            .collect()
    }

    /// Ticks at which a law that has left the wall answers other than a fresh one.
    fn remembers(&self, law: &Controller<N>) -> f64 {
        if !self.is_alone() {
            return 0.0;
        }
        let (mut used, mut fresh) = (*law, self.fresh);
        let differ = |(a, b): (&Force<N>, &Force<N>)| f64::from(u8::from(a != b));
        let (a, b) = (self.press(&mut used, 300.0), self.press(&mut fresh, 300.0));
        a.iter().zip(&b).map(differ).sum()
    }
}

fn zero_and_one_count(_: Effort) -> Result<Vec<Finding>> {
    fn check<N: Reported>(subject: &Subject<N>) -> f64 {
        let (mut law, mut random) = (subject.fresh, Random::new(2));
        let Some(scale) = subject.scale() else {
            return f64::NAN;
        };
        let stiffness: f64 = subject.settings.k_desired.to_num();
        let mut broken = 0.0;
        for _ in 0..100_000 {
            let count = (1.5 * random.uniform()).round() as i64;
            let e = scale.penetration::<N>(count);
            let force = law.tick(e);
            let ideal = stiffness * e.to_f64();
            // A force step of the format, and half of it for the product.
            let step = 1.5 * Position::<N>::quantum().to_f64();
            let wrong = !subject.is_within(force)
                || (count <= 0 && subject.is_alone() && force != Force::zero())
                || (subject.is_spring() && count > 0 && (force.to_f64() - ideal).abs() > step);
            broken += f64::from(u8::from(wrong));
        }
        broken
    }
    every_law!(check)
}

fn bounces(_: Effort) -> Result<Vec<Finding>> {
    fn check<N: Reported>(subject: &Subject<N>) -> f64 {
        let mut law = subject.fresh;
        let mut broken = 0.0;
        for bounce in 0..1000 {
            // From deep presses to a graze.
            let counts = 500.0 * (-f64::from(bounce) / 120.0).exp();
            let mut fresh = subject.fresh;
            let (a, b) = (
                subject.press(&mut law, counts),
                subject.press(&mut fresh, counts),
            );
            subject.leave(&mut law);
            if subject.is_alone() {
                broken += a
                    .iter()
                    .zip(&b)
                    .map(|(a, b)| f64::from(u8::from(a != b)))
                    .sum::<f64>();
            }
            broken += f64::from(u8::from(a.iter().any(|force| !subject.is_within(*force))));
        }
        broken
    }
    every_law!(check)
}

fn saturation(_: Effort) -> Result<Vec<Finding>> {
    fn check<N: Reported>(subject: &Subject<N>) -> f64 {
        let (mut law, mut random) = (subject.fresh, Random::new(8));
        let Some(scale) = subject.scale() else {
            return f64::NAN;
        };
        let mut broken = 0.0;
        for tick in 0..120_000_u32 {
            // A turn's quarter inside: fifteen times the limit at 5 N·m/rad.
            let count = i64::from(tick.min(10_000)) + (2.0 * random.uniform()).round() as i64;
            let force = law.tick(scale.penetration(count));
            broken += f64::from(u8::from(!subject.is_within(force)));
        }
        subject.leave(&mut law);
        broken + subject.remembers(&law)
    }
    every_law!(check)
}

fn windup(_: Effort) -> Result<Vec<Finding>> {
    fn offset<N: Reported>(subject: &Subject<N>) -> f64 {
        let (mut law, mut random) = (subject.fresh, Random::new(8));
        let Some(scale) = subject.scale() else {
            return f64::NAN;
        };
        for tick in 0..60_000_u32 {
            let count = i64::from(tick.min(6_000)) + (2.0 * random.uniform()).round() as i64;
            law.tick(scale.penetration(count));
        }
        // Out again, as fast as a hand pulls, until nothing pushes any more.
        for tick in 0..100_000_u32 {
            let count = 6_000 - 10 * i64::from(tick);
            let e = scale.penetration::<N>(count);
            if law.tick(e) <= Force::zero() {
                return (-e.to_f64()).max(0.0);
            }
        }
        f64::INFINITY
    }
    let mut found = Vec::new();
    for &law in LawKind::ALL {
        let settings = Settings {
            law,
            ..Settings::thesis()
        };
        let mut finding = subject::<Fixed32>("", &settings, offset::<Fixed32>);
        // Ten counts a tick, and as much again for the surface itself.
        finding.bound = 20.0 * std::f64::consts::TAU / 40_000.0;
        let augments = matches!(
            law,
            LawKind::Sfa | LawKind::SfaContinuous | LawKind::EnhancedSfa
        );
        found.push(if augments {
            let grown = finding.value;
            finding.failing(format!(
                "above k_de e = the limit the offset goes on growing: pushes to {grown:.3} rad outside"
            ))
        } else {
            finding
        });
    }
    Ok(found)
}

fn ends(_: Effort) -> Result<Vec<Finding>> {
    fn check<N: Reported>(subject: &Subject<N>) -> f64 {
        let (mut law, mut random) = (subject.fresh, Random::new(4));
        let quantum = Position::<N>::quantum();
        let places = [
            Position::from_f64(1e9),
            Position::from_f64(-1e9),
            Position::zero(),
            quantum,
            -quantum,
            Position::from_f64(0.1),
        ];
        let mut broken = 0.0;
        for _ in 0..100_000 {
            let place = (3.0 * (random.uniform() + 1.0)) as usize;
            let force = law.tick(places[place.min(5)]);
            broken += f64::from(u8::from(!subject.is_within(force)));
        }
        subject.leave(&mut law);
        broken + subject.remembers(&law)
    }
    every_law!(check)
}

fn tiny(_: Effort) -> Result<Vec<Finding>> {
    fn check<N: Reported>(subject: &Subject<N>) -> f64 {
        let (mut law, mut random) = (subject.fresh, Random::new(6));
        let mut broken = 0.0;
        for tick in 0..20_000 {
            let e = random.decades(5e-324, 1e-3) * if tick % 3 == 0 { -1.0 } else { 1.0 };
            let position = Position::<N>::from_f64(e);
            let force = law.tick(position);
            let most = subject.settings.k_desired.to_num::<f64>() * position.to_f64().max(0.0);
            let too_much =
                subject.is_spring() && force.to_f64() > most * (1.0 + f64::from(f32::EPSILON));
            broken += f64::from(u8::from(!subject.is_within(force) || too_much));
        }
        subject.leave(&mut law);
        broken + subject.remembers(&law)
    }
    every_law!(check)
}

fn lost(_: Effort) -> Result<Vec<Finding>> {
    fn check<N: Reported>(subject: &Subject<N>) -> f64 {
        let mut law = subject.fresh;
        let Some(scale) = subject.scale() else {
            return f64::NAN;
        };
        let mut broken = 0.0;
        for tick in 0..50_000_i64 {
            // A press that wanders between 20 and 180 counts.
            let swing = (tick as f64 / 300.0).sin() + 0.3 * (tick as f64 / 17.0).sin();
            let e = scale.penetration::<N>((100.0 + 60.0 * swing).round() as i64);
            let times = match tick {
                tick if tick % 10 == 0 => 0,
                tick if tick % 7 == 0 => 2,
                _ => 1,
            };
            for _ in 0..times {
                broken += f64::from(u8::from(!subject.is_within(law.tick(e))));
            }
        }
        subject.leave(&mut law);
        broken + subject.remembers(&law)
    }
    every_law!(check)
}

fn switching(_: Effort) -> Result<Vec<Finding>> {
    fn check<N: Reported>(subject: &Subject<N>) -> f64 {
        let (mut law, mut random) = (subject.fresh, Random::new(12));
        let Some(scale) = subject.scale() else {
            return f64::NAN;
        };
        let mut broken = 0.0;
        for tick in 0..20_000_u32 {
            if tick % 20 == 10 {
                let kind = LawKind::ALL[tick as usize / 20 % LawKind::ALL.len()];
                // Every other change is one of this law's stiffness, the rest are of the law.
                let other = Settings {
                    law: if tick % 40 == 10 {
                        kind
                    } else {
                        subject.settings.law
                    },
                    k_desired: Si::saturating_from_num(random.decades(0.5, 50.0)),
                    ..subject.settings
                };
                law = Controller::new(&other).unwrap_or(law);
            }
            let count = (100.0 + 80.0 * (f64::from(tick) / 90.0).sin()).round() as i64;
            broken += f64::from(u8::from(
                !subject.is_within(law.tick(scale.penetration(count))),
            ));
        }
        let mut back = subject.fresh;
        back.tick(scale.penetration(150));
        subject.leave(&mut back);
        broken + subject.remembers(&back)
    }
    every_law!(check)
}

fn drift(effort: Effort) -> Result<Vec<Finding>> {
    const PERIOD: usize = 1000;
    let periods = if effort.long { 1_000_000 } else { 10_000 };
    use rayon::prelude::*;
    let laws: Vec<_> = LawKind::ALL.to_vec();
    Ok(laws
        .into_par_iter()
        .filter_map(|law| {
            let settings = Settings {
                law,
                ..Settings::thesis()
            };
            let mut controller = Controller::<Fixed32>::new(&settings).ok()?;
            let scale = CountScale::new(40_000, Si::ZERO)?;
            let path: Vec<Position<Fixed32>> = (0..PERIOD)
                .map(|tick| {
                    let phase = std::f64::consts::TAU * tick as f64 / PERIOD as f64;
                    scale.penetration((100.0 + 30.0 * phase.sin()).round() as i64)
                })
                .collect();
            let mut known = Vec::new();
            let mut worst = 0.0_f64;
            for period in 0..periods {
                if period == 1000 {
                    known = path.iter().map(|&e| controller.tick(e).to_f64()).collect();
                } else if period + 1 == periods {
                    for (&e, known) in path.iter().zip(&known) {
                        worst = worst.max((controller.tick(e).to_f64() - known).abs());
                    }
                } else {
                    for &e in &path {
                        std::hint::black_box(controller.tick(e));
                    }
                }
            }
            // These go on adjusting a bound or an offset; the force of one count at the desired stiffness is the least that they
            // can be told of.
            let adjusts = matches!(law, LawKind::Fba | LawKind::Sfa | LawKind::SfaContinuous);
            let count_n_m = settings.k_desired.to_num::<f64>() * std::f64::consts::TAU / 40_000.0;
            let bound = if adjusts { count_n_m } else { 0.0 };
            Some(Finding::new(
                format!("{} fixed32", law.word()),
                worst,
                bound,
            ))
        })
        .collect())
}

fn wrap(_: Effort) -> Result<Vec<Finding>> {
    let mut random = Random::new(16);
    let (mut short, mut long) = (Unwrap16::new(65_000, 0), Unwrap32::new(u32::MAX - 5, 0));
    let (mut true_short, mut true_long) = (0_i64, 0_i64);
    let (mut off_short, mut off_long) = (0_i64, 0_i64);
    for _ in 0..1_000_000 {
        let move_short = (32_767.0 * random.uniform()) as i64 + 3_000;
        let move_short = move_short.clamp(-32_767, 32_767);
        true_short += move_short;
        let reading = (65_000 + true_short).rem_euclid(1 << 16) as u16;
        off_short = off_short.max((short.update(reading) - true_short).abs());
        let move_long = (2_147_483_647.0 * random.uniform()) as i64;
        true_long += move_long;
        let reading = (i64::from(u32::MAX) - 5 + true_long).rem_euclid(1 << 32) as u32;
        off_long = off_long.max((long.update(reading) - true_long).abs());
    }
    let mut found = vec![
        Finding::new("16 bits", off_short as f64, 0.0),
        Finding::new("32 bits", off_long as f64, 0.0),
    ];
    // A wall in another turn: the scale is exact to 1.4e-10 rad a turn, and a position to its step.
    for turns in [-100_i64, -1, 1, 100] {
        let surface = Si::saturating_from_num(std::f64::consts::TAU * turns as f64);
        let (Some(near), Some(far)) = (
            CountScale::new(40_000, Si::ZERO),
            CountScale::new(40_000, surface),
        ) else {
            continue;
        };
        let worst = (-200..200_i64)
            .map(|count| {
                let here = near.penetration::<Fixed32>(count).to_f64();
                let there = far.penetration::<Fixed32>(count + 40_000 * turns).to_f64();
                (here - there).abs() * 16_777_216.0
            })
            .fold(0.0, f64::max);
        found.push(Finding::new(format!("{turns} turns away"), worst, 1.0));
    }
    Ok(found)
}

/// Shakes the mass and adds up what the HIP's port takes; the least of it over all that went through.
fn shaken(inertia: f64, stiffness: f64, damping: f64, ground: f64) -> f64 {
    let gain = |value: f64| Stiffness::<f64>(value);
    let total = gain(inertia + stiffness + damping + ground);
    let mass = VirtualMass::<f64> {
        inertia: gain(inertia),
        stiffness: gain(stiffness),
        damping: gain(damping),
        total,
        by_total: Divisor::of(total),
    };
    let mut random = Random::new(21);
    let (mut state, mut e) = (MassState::<f64>::default(), 0.0_f64);
    let (mut energy, mut least, mut throughput) = (0.0_f64, 0.0_f64, f64::MIN_POSITIVE);
    for tick in 0..20_000 {
        let moved = if tick % 50 < 40 {
            1e-3 * random.uniform()
        } else {
            0.0
        };
        // Kept near where it began, or sums of large numbers would hide what is looked for.
        let moved = moved - 0.01 * e;
        e += moved;
        let (position, change) = (Position::<f64>::from_f64(e), Position::from_f64(moved));
        let drive = mass.drive(&state, position, change);
        let step = mass.displacement(state.position, drive, Force::zero());
        state = state.moved_by(step);
        let work = mass.coupling(&state, position, change).to_f64() * moved;
        energy += work;
        throughput += work.abs();
        least = least.min(energy);
    }
    -least / throughput
}

fn virtual_mass(_: Effort) -> Result<Vec<Finding>> {
    let stiffness = 1.0;
    let mut found = Vec::new();
    for decade in -9..=3 {
        let inertia = stiffness * 10_f64.powi(decade);
        for (damping, ground) in [(0.0, 0.0), (0.3, 0.1)] {
            let name =
                format!("backward Euler, m = 1e{decade} k T², c = {damping}, c_env = {ground}");
            found.push(Finding::new(
                name,
                shaken(inertia, stiffness, damping, ground),
                1e-12,
            ));
        }
        // z² + (k/M - 2) z + 1 for a mass without damping: on the circle up to k/M = 4.
        let ratio = stiffness / inertia;
        let half = 1.0 - 0.5 * ratio;
        let radius = if half.abs() <= 1.0 {
            1.0
        } else {
            half.abs() + (half * half - 1.0).sqrt()
        };
        let grown = semi_implicit_growth(ratio);
        let name = format!("semi-implicit Euler, m = 1e{decade} k T²");
        // Bounded by the ratio of the axes of its ellipse.
        let bound = 4.0 / (1.0 - half * half).abs().sqrt().max(1e-3);
        let finding = Finding::new(name, grown, bound);
        found.push(if radius > 1.0 {
            finding.failing(format!("below k T²/4: radius {radius:.3}"))
        } else {
            finding
        });
    }
    Ok(found)
}

/// Largest position over 2000 ticks of a mass on a spring with `k T²/m`, from a position of 1.
fn semi_implicit_growth(ratio: f64) -> f64 {
    let (mut position, mut moved, mut largest) = (1.0_f64, 0.0_f64, 1.0_f64);
    for _ in 0..2000 {
        moved -= ratio * position;
        position += moved;
        largest = largest.max(position.abs());
        if !largest.is_finite() || largest > 1e100 {
            break;
        }
    }
    largest
}
