//! Hard cases for each control law without a device, in every number format: situations in which laws tend to fail.

use super::random::Random;
use super::{Case, Effort, Finding};
use touchstone_control::{
    Choice as _, Controller, CountScale, Fixed16, Fixed32, Force, LawKind, Position, Reported,
    Settings, Si, StatesKind,
};
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
        oracle: "never beyond the limit, and after leaving the bits of a fresh law",
        unit: "ticks that break it",
        run: saturation,
    },
    Case {
        name: "windup",
        about: "a minute ten times as deep as the force limit reaches, with a jitter of a count: how much further outside the law still pushes than after the worst of four leans within the limit",
        oracle: "what the limit took away is not made up for afterwards",
        unit: "rad further outside",
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
        oracle: "never beyond the limit, and after leaving the bits of the last law afresh",
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
];

/// Runs a check on every control law in every number format: once alone with the thesis' settings, once with state estimator and
/// energy guard.
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

/// Runs a check on one control law in one number format. The check counts violations of the expected behaviour; none is allowed.
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

/// A control law in one number format, in the state before its first control period.
struct Subject<N: Reported> {
    fresh: Controller<N>,
    limit: Force<N>,
    settings: Settings,
}

impl<N: Reported> Subject<N> {
    /// Whether a force is within the force limit of the control law; false for NaN.
    fn is_within(&self, force: Force<N>) -> bool {
        force <= self.limit && force >= -self.limit
    }

    fn scale(&self) -> Option<CountScale> {
        CountScale::new(40_000, Si::ZERO)
    }

    /// Whether the law runs on measured states and without an energy guard. Outside the wall such a law must clear its memory,
    /// while estimator and guard keep their states.
    fn is_alone(&self) -> bool {
        self.settings.states == StatesKind::Measured && !self.settings.guard.on
    }

    fn is_spring(&self) -> bool {
        self.settings.law == LawKind::Spring && self.is_alone()
    }

    /// Moves the knob far out of the wall. A law that has moved its wall outwards may begin to push far outside the configured
    /// surface.
    fn leave(&self, law: &mut Controller<N>) {
        law.tick(Position::from_f64(-1e9));
    }

    /// Forces of the law in a press that goes `counts` encoder counts deep and out again in 200 ticks, with a jitter of one count.
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

    /// Number of ticks in which a law that was used, and then left the wall, gives another force than an unused law.
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
            // One step of force of the format, and half a step for the product.
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
            // From deep presses to slight touches.
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
            // A quarter of a turn inside: fifteen times the force limit at 5 N·m/rad.
            let count = i64::from(tick.min(10_000)) + (2.0 * random.uniform()).round() as i64;
            let force = law.tick(scale.penetration(count));
            broken += f64::from(u8::from(!subject.is_within(force)));
        }
        subject.leave(&mut law);
        broken + subject.remembers(&law)
    }
    every_law!(check)
}

/// Depths of long presses within the force limit, encoder counts. The limit is reached at 637 counts.
const WITHIN_THE_LIMIT: [u32; 4] = [75, 150, 300, 600];
/// Depth of a long press beyond the force limit, encoder counts: about ten times the depth at which the limit is reached.
const BEYOND_THE_LIMIT: u32 = 6_000;

fn windup(_: Effort) -> Result<Vec<Finding>> {
    /// Distance outside the wall's surface at which the law stops pushing, rad, after a press of one minute at `depth` encoder
    /// counts.
    fn outside<N: Reported>(subject: &Subject<N>, depth: u32) -> f64 {
        let (mut law, mut random) = (subject.fresh, Random::new(8));
        let Some(scale) = subject.scale() else {
            return f64::NAN;
        };
        for tick in 0..60_000_u32 {
            let count = i64::from(tick.min(depth)) + (2.0 * random.uniform()).round() as i64;
            law.tick(scale.penetration(count));
        }
        // The knob goes out as fast as a hand pulls, until the wall no longer pushes.
        for tick in 0..100_000_u32 {
            let count = i64::from(depth) - 10 * i64::from(tick);
            let e = scale.penetration::<N>(count);
            if law.tick(e) <= Force::zero() {
                return (-e.to_f64()).max(0.0);
            }
        }
        f64::INFINITY
    }
    fn more<N: Reported>(subject: &Subject<N>) -> f64 {
        let within = WITHIN_THE_LIMIT.map(|depth| outside(subject, depth));
        outside(subject, BEYOND_THE_LIMIT) - within.into_iter().fold(0.0, f64::max)
    }
    Ok(LawKind::ALL
        .iter()
        .map(|&law| {
            let settings = Settings {
                law,
                ..Settings::thesis()
            };
            let mut finding = subject::<Fixed32>("", &settings, more::<Fixed32>);
            // Ten counts for the knob's step per tick on the way out, and ten for the position of the surface.
            finding.bound = 20.0 * std::f64::consts::TAU / 40_000.0;
            finding.value = finding.value.max(0.0);
            finding
        })
        .collect())
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
        let mut last = (subject.fresh, subject.settings);
        let mut broken = 0.0;
        for tick in 0..20_000_u32 {
            if tick % 20 == 10 {
                let kind = LawKind::ALL[tick as usize / 20 % LawKind::ALL.len()];
                // Every change is one of the stiffness. Every second one also changes the law; the others return to the first
                // law.
                let other = Settings {
                    law: if tick % 40 == 10 {
                        kind
                    } else {
                        subject.settings.law
                    },
                    k_desired: Si::saturating_from_num(random.decades(0.5, 50.0)),
                    ..subject.settings
                };
                // If the format cannot hold the other settings, the law stays as it is.
                if let Ok(next) = Controller::<N>::new(&other) {
                    law.resume(&next);
                    last = (next, other);
                }
            }
            let count = (100.0 + 80.0 * (f64::from(tick) / 90.0).sin()).round() as i64;
            broken += f64::from(u8::from(
                !subject.is_within(law.tick(scale.penetration(count))),
            ));
        }
        subject.leave(&mut law);
        let (fresh, settings) = last;
        let last = Subject {
            fresh,
            limit: subject.limit,
            settings,
        };
        broken + last.remembers(&law)
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
            // These laws keep adjusting a bound or an offset. The force of one count at the requested stiffness is the least change
            // that they can react to.
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
