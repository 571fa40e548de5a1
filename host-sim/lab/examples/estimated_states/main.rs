//! Settings of laws on estimated states, found by covariance matrix adaptation and judged case by case:
//! `cargo run --release -p touchstone-lab --example estimated_states -- search spring 20`, `-- table`.
//!
//! Three grips, each of nominal, 16,384 counts, half and double inertia, and 0.1, 0.5 and 1 ms of delay, each alone; one
//! setting for all of them.

mod bench;
mod cma;
mod judge;

use bench::{Deed, Knob};
use judge::{Figures, figures};
use touchstone_control::{
    Controller, EstimatorSettings, FilterSettings, Fixed32, LawKind, Settings, Si,
};
use touchstone_world::plant::{FIRM, Hand, LIGHT, MEDIUM};

const NOMINAL: Knob = Knob {
    inertia_kg_m2: 1e-4,
    damping_n_m_s_per_rad: 4e-4,
    friction_n_m: 3e-4,
    counts_per_rev: 40_000,
    rate_hz: 1000,
    delay_ticks: 0.0,
};
const GRIPS: [(&str, Hand); 3] = [("light", LIGHT), ("medium", MEDIUM), ("firm", FIRM)];

fn cases(nominal: &Knob) -> [(&'static str, Knob); 7] {
    let delayed = |delay_ticks| Knob {
        delay_ticks,
        ..*nominal
    };
    let heavier = |by: f64| Knob {
        inertia_kg_m2: by * nominal.inertia_kg_m2,
        ..*nominal
    };
    let coarse = Knob {
        counts_per_rev: (0.4096 * f64::from(nominal.counts_per_rev)) as u32,
        ..*nominal
    };
    [
        ("nominal", *nominal),
        ("16,384 counts", coarse),
        ("J x 0.5", heavier(0.5)),
        ("J x 2", heavier(2.0)),
        ("0.1 tick", delayed(0.1)),
        ("0.5 tick", delayed(0.5)),
        ("1 tick", delayed(1.0)),
    ]
}

/// At 50 k_c the nominal knob alone, up to half a tick.
fn cases_of(knob: &Knob, k: f64) -> impl Iterator<Item = (&'static str, Knob)> {
    cases(knob)
        .into_iter()
        .filter(move |(name, _)| k < 50.0 || ["nominal", "0.1 tick", "0.5 tick"].contains(name))
}

/// A law and what it is told.
#[derive(Debug, Clone, Copy)]
struct Design {
    settings: Settings,
    estimator: Option<EstimatorSettings>,
}

fn si(x: f64) -> Si {
    Si::saturating_from_num(x)
}

impl Design {
    fn wall(&self) -> Option<Controller<Fixed32>> {
        let wall = Controller::new(&self.settings).ok()?;
        match &self.estimator {
            None => Some(wall),
            Some(estimator) => {
                let settings = Settings {
                    states: touchstone_control::StatesKind::Estimated,
                    estimator: *estimator,
                    ..self.settings
                };
                Controller::new(&settings).ok()
            }
        }
    }
}

/// `p`, assumed delay in ticks, assumed inertia over the nominal one.
fn estimator(knob: &Knob, bandwidth_hz: f64, delay_ticks: f64, inertia: f64) -> EstimatorSettings {
    EstimatorSettings {
        bandwidth_hz: si(bandwidth_hz),
        inertia: si(knob.inertia_kg_m2 * inertia),
        damping: si(knob.damping_n_m_s_per_rad),
        delay_s: si(delay_ticks / f64::from(knob.rate_hz)),
    }
}

fn damper(knob: &Knob, k: f64, b: f64, estimator: Option<EstimatorSettings>) -> Design {
    Design {
        settings: Settings {
            law: LawKind::SpringDamper,
            rate_hz: knob.rate_hz,
            k_desired: si(k),
            virtual_damping: si(b),
            ..Settings::default()
        },
        estimator,
    }
}

/// `a, b, c, m, k_f, c_f, c_env, k_v`.
fn enhanced(knob: &Knob, k: f64, p: &[f64], estimator: Option<EstimatorSettings>) -> Design {
    Design {
        settings: Settings {
            rate_hz: knob.rate_hz,
            k_desired: si(k),
            k_soft: si(p[7].min(0.98 * k)),
            limit_of_penetration: si(p[0].min(1.0)),
            limit_of_force: si(p[1].min(1.0)),
            step_of_ideal: si(p[2].min(1.0)),
            filter: FilterSettings {
                mass: si(p[3]),
                stiffness: si(p[4]),
                damping: si(p[5]),
                ground_damping: si(p[6]),
            },
            ..Settings::default()
        },
        estimator,
    }
}

const SHORT: Deed = Deed::Press {
    touch_s: 0.3,
    hold_s: 0.6,
};
/// The thesis' touch and press.
const LONG: Deed = Deed::Press {
    touch_s: 2.0,
    hold_s: 1.5,
};

/// What ripple may be at 40,000 counts; in proportion to the count.
fn ripple_limit(k: f64, knob: &Knob) -> f64 {
    let nominal = if k < 10.0 {
        1.1 * 1.2e-3
    } else {
        0.6 * 8.0e-3 * (k / 20.0)
    };
    nominal * 40_000.0 / f64::from(knob.counts_per_rev)
}

fn cost(design: &Design, knob: &Knob, k: f64) -> f64 {
    let Some(wall) = design.wall() else {
        return 1e6;
    };
    let (mut over, mut most) = (0.0, 0.0_f64);
    for (name, case) in cases_of(knob, k) {
        let late = case.delay_ticks >= 0.5;
        for (_, hand) in GRIPS {
            let f = figures(&case, &hand, k, &wall, &LONG, &[1.0, 4.0]);
            for share in f.shares(late, ripple_limit(k, &case)) {
                over += (share - 0.95).clamp(0.0, 20.0);
                most = most.max(share.min(20.0));
            }
            over += (-1e4 * f.hand_j).clamp(0.0, 20.0);
            if name == "nominal" {
                over += (-1e3 * f.wall_j).clamp(0.0, 20.0);
            }
            // A setting that fails badly needs no further case.
            if over > 60.0 {
                return 1e3 + over;
            }
        }
    }
    over + 0.1 * most
}

fn table(name: &str, design: &Design, knob: &Knob, k: f64, frequencies_hz: &[f64]) {
    println!("\n{name}, k_de {k}: worst of three grips");
    println!(
        "case            touch   peak   moment release  held   |F/x|  phase  ripple mN·m (limit)  wall mJ  hand mJ  counts  worst"
    );
    let Some(wall) = design.wall() else {
        println!("refused");
        return;
    };
    for (case, knob) in cases_of(knob, k) {
        let f = GRIPS
            .iter()
            .map(|(_, hand)| figures(&knob, hand, k, &wall, &LONG, frequencies_hz))
            .reduce(Figures::worst)
            .unwrap_or_default();
        let limit = ripple_limit(k, &knob);
        let shares = f.shares(knob.delay_ticks >= 0.5, limit);
        let (worst, share) = [
            "peak", "moment", "release", "held", "modulus", "phase", "ripple",
        ]
        .iter()
        .zip(shares)
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((&"", 0.0));
        println!(
            "{case:14} {:6.2} {:6.3} {:6.1}% {:6.1}% {:6.1}% {:6.1}% {:6.1} {:8.2} ({:5.2}) {:14.3} {:8.3} {:7.1}  {worst} {share:.2}{}",
            f.touch,
            f.peak,
            100.0 * f.moment,
            100.0 * f.release,
            100.0 * f.held,
            100.0 * f.modulus,
            f.phase_deg,
            1e3 * f.ripple_n_m,
            1e3 * limit,
            1e3 * f.wall_j,
            1e3 * f.hand_j,
            f.restless_counts,
            if share > 1.0 { "  FAILS" } else { "" }
        );
    }
}

fn spring_point(k: f64, x: &[f64]) -> Design {
    // B, p, delay, inertia.
    let e: Vec<f64> = x.iter().map(|x| x.exp()).collect();
    damper(
        &NOMINAL,
        k,
        e[0],
        Some(estimator(&NOMINAL, e[1], e[2].min(3.0), e[3])),
    )
}

fn enhanced_point(k: f64, x: &[f64]) -> Design {
    let e: Vec<f64> = x.iter().map(|x| x.exp()).collect();
    enhanced(
        &NOMINAL,
        k,
        &e[..8],
        Some(estimator(&NOMINAL, e[8], e[9].min(3.0), e[10])),
    )
}

/// The settings that the searches found, to three digits.
fn found(frequencies_hz: &[f64]) {
    let knob = &NOMINAL;
    let of = |p, delay, inertia| Some(estimator(knob, p, delay, inertia));
    for (name, k, design) in [
        (
            "spring-damper",
            5.0,
            damper(knob, 5.0, 0.0084, of(51.0, 0.5, 1.03)),
        ),
        (
            "spring-damper",
            20.0,
            damper(knob, 20.0, 0.0235, of(69.0, 0.64, 0.8)),
        ),
        (
            "enhanced",
            5.0,
            enhanced(
                knob,
                5.0,
                &[0.4, 0.41, 0.21, 6.8e-7, 29.6, 0.00655, 0.00356, 4.9],
                of(62.6, 1.52, 0.952),
            ),
        ),
        (
            "enhanced",
            20.0,
            enhanced(
                knob,
                20.0,
                &[0.068, 0.55, 0.43, 6.8e-6, 13.6, 0.0118, 0.219, 14.2],
                of(92.5, 0.778, 1.5),
            ),
        ),
    ] {
        table(name, &design, knob, k, frequencies_hz);
    }
    // As stiff as 50 k_c, for the nominal inertia only, up to half a tick.
    let k = 50.0;
    let parameters = [0.09, 0.607, 0.726, 9.3e-6, 17.9, 0.0113, 1.1, 31.9];
    let design = enhanced(knob, k, &parameters, of(155.0, 0.442, 0.885));
    table("enhanced", &design, knob, k, frequencies_hz);
}

/// A random device and its stiffness, and what a rule makes of them.
fn devices(seed: u64, count: usize) -> Vec<(Knob, f64, f64)> {
    let mut random = cma::Random::new(seed);
    let mut log = |low: f64, high: f64| low * (high / low).powf(random.unit());
    (0..)
        .map(|i| {
            let inertia = log(1e-5, 3e-4);
            let rate_hz = [1000, 1000, 2000, 4000][i % 4];
            // `T sqrt(k/J)`: the share of the stiffness that sampling lets through.
            let share = log(0.1, 0.4);
            let k = (share * f64::from(rate_hz)).powi(2) * inertia;
            let knob = Knob {
                inertia_kg_m2: inertia,
                damping_n_m_s_per_rad: inertia * log(0.5, 10.0),
                friction_n_m: log(3e-5, 1e-3),
                // So that stiffness can be told from counts: some forty to eighty deep at the press.
                counts_per_rev: (log(40.0, 80.0) * std::f64::consts::TAU * k / bench::PUSH_N_M)
                    .max(20_000.0) as u32,
                rate_hz,
                delay_ticks: 0.0,
            };
            (knob, k, share)
        })
        // Softer, the hand swings out of the wall by its own inertia; stiffer, no knob has the counts.
        .filter(|(_, k, _)| (2.0..100.0).contains(k))
        .take(count)
        .collect()
}

/// `B = 2 ζ sqrt(k J)`, `p = f sqrt(k/J)/2π` but at least so much.
fn spring_rule(knob: &Knob, k: f64, zeta: f64, factor: f64, least: f64) -> Design {
    let own = (k / knob.inertia_kg_m2).sqrt() / std::f64::consts::TAU;
    let p = (factor * own)
        .max(least)
        .min(0.19 * f64::from(knob.rate_hz));
    let b = 2.0 * zeta * (k * knob.inertia_kg_m2).sqrt();
    damper(knob, k, b, Some(estimator(knob, p, 1.0, 1.0)))
}

/// What was found for the thesis' knob at 20 k_c, made dimensionless by `k`, `J` and `T sqrt(k/J)`; the share of inertia
/// that the estimator is told is free.
fn enhanced_rule(knob: &Knob, k: f64, inertia: f64, factor: f64, least: f64) -> Design {
    let j = knob.inertia_kg_m2;
    let own = (k / j).sqrt();
    let unit = (k * j).sqrt();
    let per_tick = (own / f64::from(knob.rate_hz) / 0.447).min(1.0);
    let p = (factor * own / std::f64::consts::TAU)
        .max(least)
        .min(0.19 * f64::from(knob.rate_hz));
    let parameters = [
        0.068 * per_tick,
        0.55 * per_tick,
        0.43 * per_tick,
        0.068 * j,
        0.68 * k,
        0.264 * unit,
        4.9 * unit,
        0.71 * k,
    ];
    enhanced(knob, k, &parameters, Some(estimator(knob, p, 0.8, inertia)))
}

/// Worst figure over its limit (ripple apart) of one design on one device.
fn worst_share(knob: &Knob, k: f64, design: &Design) -> f64 {
    let Some(wall) = design.wall() else {
        return 99.0;
    };
    let mut worst = 0.0_f64;
    for (_, case) in cases(knob) {
        for (_, hand) in GRIPS {
            let f = figures(&case, &hand, k, &wall, &SHORT, &[1.0, 4.0]);
            let shares = f.shares(case.delay_ticks >= 0.5, f64::INFINITY);
            worst = shares.iter().fold(worst, |a, b| a.max(*b)).min(99.0);
        }
        if worst > 5.0 {
            break;
        }
    }
    worst
}

/// One rule for all devices.
fn rule(seed: u64) {
    use rayon::prelude::*;
    let devices = devices(seed, 24);
    let show = |name: String, design: &(dyn Fn(&Knob, f64) -> Design + Sync)| {
        let held: Vec<f64> = devices
            .par_iter()
            .map(|(knob, k, _)| worst_share(knob, *k, &design(knob, *k)))
            .collect();
        let below = |most: f64| held.iter().filter(|h| **h <= most).count();
        let fails: Vec<String> = held
            .iter()
            .zip(&devices)
            .filter(|(h, _)| **h > 1.5)
            .map(|(h, (knob, k, share))| {
                let (j, kilohertz) = (knob.inertia_kg_m2, knob.rate_hz / 1000);
                format!("{h:.1} (s {share:.2}, {kilohertz} kHz, k {k:.0}, J {j:.0e})")
            })
            .collect();
        println!(
            "{name}: {} of {} hold, {} within 1.5, {} within 2; beyond 1.5: {}",
            below(1.0),
            devices.len(),
            below(1.5),
            below(2.0),
            fails.join(", ")
        );
    };
    for (factor, least) in [(1.0, 50.0), (1.4, 50.0), (0.0, 60.0), (0.0, 100.0)] {
        for zeta in [0.25, 0.3, 0.4] {
            show(
                format!("spring, zeta {zeta}, p max({factor} f, {least} Hz)"),
                &|knob, k| spring_rule(knob, k, zeta, factor, least),
            );
        }
        for inertia in [1.0, 1.5] {
            show(
                format!("enhanced, J x {inertia}, p max({factor} f, {least} Hz)"),
                &|knob, k| enhanced_rule(knob, k, inertia, factor, least),
            );
        }
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let word = |i: usize| words.get(i).map_or("", String::as_str);
    let number = |i: usize| word(i).parse::<f64>().unwrap_or(0.0);
    let moving = [0.25, 0.5, 1.0, 2.0, 4.0];
    match word(0) {
        // show spring K B p delay inertia
        "show" => {
            let k = number(2);
            let x: Vec<f64> = (3..words.len()).map(|i| number(i).ln()).collect();
            let design = match word(1) {
                "spring" => spring_point(k, &x),
                "damper" => damper(&NOMINAL, k, number(3), None),
                _ if x.len() == 8 => {
                    let e: Vec<f64> = x.iter().map(|x| x.exp()).collect();
                    enhanced(&NOMINAL, k, &e, None)
                }
                _ => enhanced_point(k, &x),
            };
            table(word(1), &design, &NOMINAL, k, &moving);
            println!("cost {:.4}", cost(&design, &NOMINAL, k));
        }
        // search KIND K generations seed
        "search" => {
            let (k, generations, seed) = (number(2), number(3) as usize, number(4) as u64);
            let spring = word(1) == "spring";
            let zeta = 0.3;
            let b = 2.0 * zeta * (k * 1e-4_f64).sqrt();
            let start: Vec<f64> = if words.len() > 5 {
                (5..words.len()).map(&number).collect()
            } else if spring {
                vec![b, 60.0, 0.8, 1.0]
            } else {
                vec![
                    0.05,
                    0.05,
                    0.3,
                    1e-6,
                    4.0 * k,
                    b,
                    0.05,
                    0.87 * k,
                    70.0,
                    0.8,
                    1.0,
                ]
            };
            let start: Vec<f64> = start.iter().map(|x| x.ln()).collect();
            let point = |x: &[f64]| {
                if spring {
                    spring_point(k, x)
                } else {
                    enhanced_point(k, x)
                }
            };
            let (best, value) = cma::minimise(&start, 0.3, generations, seed, |x| {
                cost(&point(x), &NOMINAL, k)
            });
            let shown: Vec<String> = best.iter().map(|x| format!("{:.4e}", x.exp())).collect();
            println!("cost {value:.4} at {}", shown.join(" "));
            table(word(1), &point(&best), &NOMINAL, k, &moving);
        }
        "table" => found(&moving),
        "rule" => rule(number(1) as u64),
        _ => println!("show KIND K PARAMETERS | search KIND K GENERATIONS SEED [START]"),
    }
}
