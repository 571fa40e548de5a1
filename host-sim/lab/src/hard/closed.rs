//! Hard cases of the closed loop of control law, plant and hand: situations in which simulators and laws tend to fail.

use super::plant::KNOB;
use super::random::Random;
use super::{Case, Effort, Finding};
use rayon::prelude::*;
use touchstone_control::{
    Choice as _, Controller, CountScale, Fixed16, Fixed32, LawKind, Reported, Settings, Si,
};
use touchstone_sim::error::Result;
use touchstone_sim::run::chain::{Crossing, Delayed};
use touchstone_sim::scene::{Preset, Scene};
use touchstone_world::plant::{
    BareCoulomb, BareLinear, Coulomb, Device, Kinematics as _, State, Stepper, critical_stiffness,
};

const PERIOD_S: f64 = 1e-3;
const COUNTS: u32 = 40_000;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "k-max",
        about: "the least unstable stiffness found by running the loop, with delays from none to 2.5 ticks",
        oracle: "the eigenvalues of its matrix; b/(T/2 + t_d)",
        unit: "off, share",
        run: k_max,
    },
    Case {
        name: "k-max-of-the-wall",
        about: "a spring in a hand, held for 40 s at nine and at eleven tenths of its critical stiffness, in every format",
        oracle: "the eigenvalues of the loop with the hand",
        unit: "verdict, 0 for a wall that comes to rest",
        run: wall,
    },
    Case {
        name: "hundred-k_c",
        about: "every law by itself at a hundred times the critical stiffness of knob and hand",
        oracle: "FBA stays; every other law is known to leave, from a stiffness that bisection of its runs finds",
        unit: "verdict, 2 for a limit cycle, 3 for unstable",
        run: hundred,
    },
    Case {
        name: "guard",
        about: "every law behind the energy guard, at 1, 5 and 100 times the critical stiffness",
        oracle: "the guard's account: what the hand gets out in any window is at most C + P t",
        unit: "of C + P t",
        run: guarded,
    },
    Case {
        name: "estimated-states",
        about: "the law as it is shipped from 0.5 to 14 N·m/rad in three grips",
        oracle: "it comes to rest",
        unit: "verdict, 0 for a wall that comes to rest",
        run: shipped,
    },
    Case {
        name: "one-count",
        about: "a pressed wall of one count's grain on a device with dry friction",
        oracle: "below 2 b/T and with friction above k res/2 it comes to rest, at the press over k",
        unit: "rad",
        run: one_count,
    },
    Case {
        name: "random-intervals",
        about: "intervals from a tenth of a tick to three: late, early and lost ones",
        oracle: "a spring of at most 2 b/h gives nothing that the damper does not take, at every tick",
        unit: "of the throughput",
        run: intervals,
    },
    Case {
        name: "long-press",
        about: "a press of 10^7 ticks (10^9 in the long form)",
        oracle: "where it rests after 10^5 ticks, it rests at the end, to the bit",
        unit: "rad",
        run: long_press,
    },
];

/// Whether a motion grows in the loop of the device without a hand and a sampled spring of this stiffness in N·m/rad, with this
/// delay in s.
fn grows(device: &Device, stiffness: f64, delay_s: f64) -> bool {
    let whole = (delay_s / PERIOD_S).floor();
    let fraction = delay_s - whole * PERIOD_S;
    let (Ok(before), Ok(after)) = (
        BareLinear::new(device, fraction),
        BareLinear::new(device, PERIOD_S - fraction),
    ) else {
        return true;
    };
    let mut crossing = Delayed::new(before, after, whole as usize);
    let mut state = State::from_array([1.0, 0.0]);
    let mut largest = [0.0_f64; 2];
    const HALF: usize = 20_000;
    for tick in 0..2 * HALF {
        let command = -stiffness * state.position();
        crossing.cross(&mut state, command, 0.0);
        // The amplitudes at the end of both halves are compared, because motions that decay quickly are over by then.
        if tick % HALF >= HALF / 2 {
            largest[tick / HALF] = largest[tick / HALF].max(state.position().abs());
        }
        if state.position().is_nan() || state.position().abs() >= 1e6 {
            return true;
        }
    }
    largest[1] >= largest[0]
}

fn k_max(_: Effort) -> Result<Vec<Finding>> {
    let mut found = Vec::new();
    for ticks in [0.0, 0.3, 0.5, 1.0, 2.5] {
        let delay_s = ticks * PERIOD_S;
        let formula = KNOB.damping / (0.5 * PERIOD_S + delay_s);
        let (mut stable, mut unstable) = (0.5 * formula, 2.0 * formula);
        for _ in 0..30 {
            let middle = 0.5 * (stable + unstable);
            if grows(&KNOB, middle, delay_s) {
                unstable = middle;
            } else {
                stable = middle;
            }
        }
        let eigenvalue =
            critical_stiffness(&KNOB, None, 1.0 / PERIOD_S, delay_s).unwrap_or(f64::NAN);
        let off = |expected: f64| (stable / expected - 1.0).abs();
        found.push(Finding::new(
            format!("{ticks} ticks, eigenvalues"),
            off(eigenvalue),
            1e-6,
        ));
        // The formula neglects terms of the relative size b T/J (1/2 + delay).
        let share = KNOB.damping * PERIOD_S / KNOB.inertia * (0.5 + ticks);
        found.push(Finding::new(
            format!("{ticks} ticks, formula"),
            off(formula),
            share,
        ));
    }
    Ok(found)
}

fn verdict(scene: &Scene) -> Result<f64> {
    Ok(
        match touchstone_sim::run::run(scene, false)?
            .summary
            .verdict_name()
        {
            "passive" => 0.0,
            "active" => 1.0,
            "limit-cycle" => 2.0,
            "unstable" => 3.0,
            _ => f64::NAN,
        },
    )
}

/// Smallest stiffness in N·m/rad at which a spring on the scene's device and hand is unstable, computed from eigenvalues.
fn critical(scene: &Scene) -> f64 {
    let device = Device {
        friction: None,
        ..touchstone_sim::run::plan::device(scene)
    };
    let hand = touchstone_sim::run::plan::hand(scene);
    critical_stiffness(&device, hand.as_ref(), f64::from(scene.timing.rate_hz), 0.0)
        .unwrap_or(f64::NAN)
}

fn wall(_: Effort) -> Result<Vec<Finding>> {
    // The hold is long enough for a motion to die out that decays by a third per second.
    let scene = Scene::load("press-hold")?
        .with_preset(Preset::Thesis)?
        .with_overrides(&["operator.motion.hold_s=40", "timing.duration_s=45"])?;
    let critical = critical(&scene);
    let mut found = Vec::new();
    for number in ["fixed16", "fixed32", "f32", "f64"] {
        for share in [0.9, 1.1] {
            let stiffness = share * critical;
            let changed = scene.with_overrides(&[
                "law.kind=spring".to_owned(),
                format!("law.number={number}"),
                format!("wall.k_desired_n_m_per_rad={stiffness}"),
            ])?;
            let subject = format!("spring {number}, {share} k_crit");
            let finding = Finding::new(subject, verdict(&changed)?, 1.0);
            found.push(if share > 1.0 {
                finding.failing(format!(
                    "k_crit is {critical:.4} N·m/rad by the eigenvalues"
                ))
            } else {
                finding
            });
        }
    }
    Ok(found)
}

/// Smallest stiffness at which a run of the scene is unstable, N·m/rad. The search raises the stiffness from 0.1 by a quarter each
/// time, then bisects.
fn unstable_from(scene: &Scene, most: f64) -> Result<f64> {
    let unstable = |stiffness: f64| -> Result<bool> {
        let set = format!("wall.k_desired_n_m_per_rad={stiffness}");
        Ok(verdict(&scene.with_overrides(&[set])?)? > 2.0)
    };
    let mut low = 0.1;
    while low < most && !unstable(1.25 * low)? {
        low *= 1.25;
    }
    let mut high = 1.25 * low;
    for _ in 0..8 {
        let middle = 0.5 * (low + high);
        if unstable(middle)? {
            high = middle;
        } else {
            low = middle;
        }
    }
    Ok(high)
}

/// Control laws that are at worst in a limit cycle at a hundred times the largest stable stiffness of a plain spring. Every other
/// law is expected to be unstable.
const HOLDS_HUNDRED: &[LawKind] = &[LawKind::Fba];

fn hundred(_: Effort) -> Result<Vec<Finding>> {
    let scene = Scene::load("thesis-knob")?.with_preset(Preset::Thesis)?;
    let critical = critical(&scene);
    LawKind::ALL
        .par_iter()
        .flat_map(|&law| ["fixed32", "f64"].map(|number| (law, number)))
        .map(|(law, number)| {
            let scene = scene.with_overrides(&[
                format!("law.kind={}", law.word()),
                format!("law.number={number}"),
            ])?;
            let stiffness = 100.0 * critical;
            let at = scene.with_overrides(&[format!("wall.k_desired_n_m_per_rad={stiffness}")])?;
            let finding = Finding::new(format!("{} {number}", law.word()), verdict(&at)?, 2.0);
            if HOLDS_HUNDRED.contains(&law) {
                return Ok(finding);
            }
            let from = unstable_from(&scene, stiffness)?;
            Ok(finding.failing(format!(
                "its runs are unstable from {from:.3} N·m/rad on, {:.2} of the loop's critical {critical:.3}",
                from / critical
            )))
        })
        .collect()
}

fn guarded(_: Effort) -> Result<Vec<Finding>> {
    let scene = Scene::load("thesis-knob")?;
    let critical = critical(&scene);
    let guard = &scene.law.guard;
    let most = guard.capacity_j + guard.refill_w * scene.timing.duration_s;
    LawKind::ALL
        .par_iter()
        .flat_map(|&law| [(law, 1.0), (law, 5.0), (law, 100.0)])
        .map(|(law, times)| {
            let changed = scene.with_overrides(&[
                format!("law.kind={}", law.word()),
                format!("wall.k_desired_n_m_per_rad={}", times * critical),
            ])?;
            let summary = touchstone_sim::run::run(&changed, false)?.summary;
            let subject = format!("{} fixed32, {times} k_crit", law.word());
            Ok(Finding::new(
                subject,
                summary.energy_out_worst_window_j / most,
                1.0,
            ))
        })
        .collect()
}

fn shipped(_: Effort) -> Result<Vec<Finding>> {
    let scene = Scene::load("thesis-knob")?;
    let grips = ["light", "medium", "firm"];
    grips
        .par_iter()
        .flat_map(|&grip| [0.5, 1.0, 5.0, 14.0].map(|stiffness| (grip, stiffness)))
        .map(|(grip, stiffness)| {
            let changed = scene.with_overrides(&[
                format!("operator.grip={grip}"),
                format!("wall.k_desired_n_m_per_rad={stiffness}"),
            ])?;
            let subject = format!("enhanced-sfa fixed32, {grip}, {stiffness} N·m/rad");
            Ok(Finding::new(subject, verdict(&changed)?, 1.0))
        })
        .collect()
}

/// Simulates a knob that a constant torque presses into a spring wall at angle 0. The control law computes in the number format
/// `N`. Calls `at` with the state at every tick (control period).
fn pressed<N: Reported>(
    plant: &BareCoulomb,
    stiffness: f64,
    press_n_m: f64,
    ticks: u64,
    mut at: impl FnMut(u64, &State<2>),
) -> Option<()> {
    let settings = Settings {
        law: LawKind::Spring,
        k_desired: Si::saturating_from_num(stiffness),
        ..Settings::thesis()
    };
    let mut law = Controller::<N>::new(&settings).ok()?;
    let scale = CountScale::new(COUNTS, Si::ZERO)?;
    let per_rad = f64::from(COUNTS) / std::f64::consts::TAU;
    let mut state = State::from_array([-0.01, 0.5]);
    for tick in 0..ticks {
        let count = (state.position() * per_rad).round() as i64;
        let force = law.tick(scale.penetration(count)).to_f64();
        plant.step(&mut state, press_n_m - force, 0.0);
        at(tick, &state);
    }
    Some(())
}

fn one_count(_: Effort) -> Result<Vec<Finding>> {
    let count_rad = std::f64::consts::TAU / f64::from(COUNTS);
    let critical = 2.0 * KNOB.damping / PERIOD_S;
    let mut found = Vec::new();
    for share in [0.3, 0.6, 0.9] {
        let stiffness = share * critical;
        let least = 0.5 * stiffness * count_rad;
        for times in [1.1, 3.0, 10.0] {
            let friction = Coulomb {
                kinetic: times * least,
                breakaway: times * least,
            };
            let device = Device {
                friction: Some(friction),
                ..KNOB
            };
            let Ok(plant) = BareCoulomb::new(&device, PERIOD_S) else {
                continue;
            };
            let press = 0.05;
            let mut moved = 0.0_f64;
            let mut end = 0.0;
            let mut last = f64::NAN;
            let ran = pressed::<Fixed32>(&plant, stiffness, press, 60_000, |tick, state| {
                if tick >= 50_000 {
                    if tick > 50_000 {
                        moved = moved.max((state.position() - last).abs());
                    }
                    last = state.position();
                    end = state.position();
                }
            });
            if ran.is_some() {
                let name = format!("{share} k_c, friction {times} k res/2");
                found.push(Finding::new(format!("{name}, moves"), moved, 0.0));
                // The knob rests where friction holds the rest of the torque, within half a count by rounding. The stiffness is
                // rounded to steps of 2^-12.
                let bound = (friction.breakaway + press * 0.000_244_140_625 / stiffness)
                    / stiffness
                    + 0.5 * count_rad;
                found.push(Finding::new(
                    format!("{name}, place"),
                    (end - press / stiffness).abs(),
                    bound,
                ));
            }
        }
    }
    Ok(found)
}

fn intervals(_: Effort) -> Result<Vec<Finding>> {
    let longest = 3.0 * PERIOD_S;
    let bound = 2.0 * KNOB.damping / longest;
    let mut found = Vec::new();
    for share in [0.1, 0.5, 1.0, 4.0] {
        let stiffness = share * bound;
        let mut random = Random::new(33);
        let mut state = State::from_array([0.05, 2.0]);
        let (mut energy, mut least, mut throughput) = (0.0_f64, 0.0_f64, 0.0_f64);
        for _ in 0..5_000 {
            let interval = random.decades(0.1 * PERIOD_S, longest);
            let Ok(plant) = BareLinear::new(&KNOB, interval) else {
                continue;
            };
            let force = stiffness * state.position();
            let from = state.position();
            let loss = plant.step_with_loss(&mut state, -force, 0.0).device_j;
            // What wall and damper took, less what an ideal spring would store. It must not become negative.
            let taken = force * (state.position() - from);
            let stored = 0.5 * stiffness * (state.position().powi(2) - from * from);
            energy += taken + loss - stored;
            throughput += taken.abs() + loss;
            least = least.min(energy);
        }
        let finding = Finding::new(format!("{share} of 2 b/(3 T)"), -least / throughput, 1e-12);
        found.push(if share > 1.0 {
            finding.failing(format!(
                "{stiffness:.3} N·m/rad is above 2 b/h = {bound:.3}"
            ))
        } else {
            finding
        });
    }
    Ok(found)
}

fn long_press(effort: Effort) -> Result<Vec<Finding>> {
    fn moved<N: Reported>(ticks: u64) -> Option<Finding> {
        let device = Device {
            friction: Some(Coulomb {
                kinetic: 1e-3,
                breakaway: 1e-3,
            }),
            ..KNOB
        };
        let plant = BareCoulomb::new(&device, PERIOD_S).ok()?;
        let (mut early, mut late) = (f64::NAN, f64::NAN);
        pressed::<N>(&plant, 0.5, 0.05, ticks, |tick, state| {
            if tick == 100_000 {
                early = state.position();
            }
            late = state.position();
        })?;
        Some(Finding::new(
            format!("spring {}", N::NAME),
            (late - early).abs(),
            0.0,
        ))
    }
    let ticks = if effort.long {
        1_000_000_000
    } else {
        10_000_000
    };
    let formats: [fn(u64) -> Option<Finding>; 4] = [
        moved::<Fixed16>,
        moved::<Fixed32>,
        moved::<f32>,
        moved::<f64>,
    ];
    Ok(formats
        .into_par_iter()
        .filter_map(|moved| moved(ticks))
        .collect())
}
