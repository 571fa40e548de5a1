//! Made-up runs for tests of the report. They look like runs of the simulator but are not valid results.
//!
//! A knob and a hand are simulated in coarse steps with rough sketches of the control laws. They give data for every type of
//! picture: a clean press, a growing oscillation, a negative force, a stiffness that climbs. The real laws are in the control
//! crate, the real plant in `touchstone_world::plant`.

use touchstone_control::LawKind;
use touchstone_sim::run::record::{Run, Summary, Trace, Verdict};

/// Every control law, simplest first.
#[allow(dead_code, reason = "each user of this file needs another part of it")]
pub const ALL_LAWS: [LawKind; 7] = [
    LawKind::Spring,
    LawKind::SpringDamper,
    LawKind::Tdpa,
    LawKind::Fba,
    LawKind::Sfa,
    LawKind::SfaContinuous,
    LawKind::EnhancedSfa,
];

const TICK: f64 = 1e-3;
const SURFACE: f64 = 0.5;
const COUNTS: f64 = 16_384.0;
const K_V: f64 = 0.8;
const DAMPING: f64 = 5e-4;

/// State of a control law between ticks.
#[derive(Default)]
struct Memory {
    offset: f64,
    mass: f64,
    force: f64,
    e: f64,
    observed: f64,
    turned: bool,
}

/// Rest point of the hand in radians (angle to which the hand pulls the knob) at time `t` in seconds. The hand moves in, holds,
/// oscillates, holds and moves out.
fn rest(t: f64) -> f64 {
    let smooth = |from: f64, to: f64| {
        let s = ((t - from) / (to - from)).clamp(0.0, 1.0);
        s * s * (3.0 - 2.0 * s)
    };
    let wiggle = if (1.4..2.2).contains(&t) {
        0.02 * ((t - 1.4) * std::f64::consts::TAU * 2.5).sin()
    } else {
        0.0
    };
    0.42 + 0.20 * smooth(0.1, 0.5) - 0.24 * smooth(2.6, 2.9) + wiggle
}

/// Rough imitation of the control law `law` at penetration `e` in radians and stiffness `k`. Returns the force in N·m; `m` keeps
/// the law's state between ticks.
fn force(law: LawKind, k: f64, e: f64, velocity: f64, m: &mut Memory) -> f64 {
    let de = e - m.e;
    m.observed += m.force * de;
    if e <= 0.0 {
        m.turned = false;
        m.offset = 0.0;
        m.mass = e;
        m.observed = 0.0;
    }
    let spring = (k * e).max(0.0);
    let f = match law {
        LawKind::Spring => spring,
        LawKind::SpringDamper => (spring + if e > 0.0 { 2e-3 * velocity } else { 0.0 }).max(0.0),
        LawKind::Tdpa if e > 0.0 && m.observed < 0.0 && de.abs() > 1e-9 => {
            spring + (-m.observed / de).clamp(-0.12, 0.12)
        }
        LawKind::Tdpa => spring,
        LawKind::Fba => spring.min((4.0 * m.observed.max(2e-8) * DAMPING / TICK).sqrt()),
        LawKind::Sfa | LawKind::SfaContinuous | LawKind::EnhancedSfa if e <= 0.0 => 0.0,
        LawKind::Sfa | LawKind::SfaContinuous | LawKind::EnhancedSfa if k <= K_V => spring,
        LawKind::Sfa | LawKind::SfaContinuous => {
            if !m.turned && de >= 0.0 {
                spring
            } else {
                m.turned = true;
                if de > 0.0 && m.e > 0.0 {
                    m.offset += (0.5 * de).min((k * e - m.force).max(0.0) / K_V);
                }
                K_V * (e + m.offset)
            }
        }
        LawKind::EnhancedSfa => {
            m.mass += (e - m.mass) * 0.6;
            if !m.turned && de >= 0.0 && e < 0.01 {
                m.offset = (k / K_V - 1.0) * e;
                spring
            } else {
                m.turned = true;
                let wanted = (k / K_V - 1.0) * e;
                m.offset += (0.004 * (wanted - m.offset)).clamp(-2e-3, 2e-3);
                (K_V * (m.mass + m.offset) + 3e-3 * velocity).max(0.0)
            }
        }
    };
    (m.force, m.e) = (f.clamp(-0.4, 0.4), e);
    m.force
}

/// Made-up run of `seconds` at 1 kHz of the given law at the requested stiffness in N·m/rad.
pub fn run(law: LawKind, k_desired: f64, seconds: f64) -> Run {
    const SUBSTEPS: u32 = 20;
    let (inertia, friction, pad, pad_damping, hand, hand_damping, grip) =
        (1e-4, 5e-5, 4.0, 2e-4, 1e-3, 2e-2, 0.9);
    let (mut x, mut v, mut y, mut w) = (rest(0.0), 0.0, rest(0.0), 0.0);
    let (mut energy, mut loss) = (0.0, 0.0);
    let mut memory = Memory::default();
    let mut trace = Trace::default();
    let count = std::f64::consts::TAU / COUNTS;
    for tick in 0..(seconds / TICK).round() as u32 {
        let t = f64::from(tick) * TICK;
        let measured = (x / count).floor() * count;
        let f = force(law, k_desired, measured - SURFACE, v, &mut memory);
        trace.time_s.push(t);
        trace.angle_rad.push(x);
        trace.velocity_rad_per_s.push(v);
        trace.angle_measured_rad.push(measured);
        trace.hand_rad.push(y);
        trace.rest_rad.push(rest(t));
        trace.force_n_m.push(f);
        trace.surface_rad.push(SURFACE);
        trace.surface_shifted_rad.push(SURFACE - memory.offset);
        let filtered = law == LawKind::EnhancedSfa && memory.turned && k_desired > K_V;
        trace
            .mass_rad
            .push(if filtered { SURFACE + memory.mass } else { x });
        trace.energy_observed_j.push(if law == LawKind::Spring {
            f64::NAN
        } else {
            memory.observed
        });
        trace.energy_true_j.push(energy);
        trace.energy_device_loss_j.push(loss);
        trace.guard_account_j.push(f64::NAN);
        let before = x;
        for _ in 0..SUBSTEPS {
            let h = TICK / f64::from(SUBSTEPS);
            let touch = pad * (y - x) + pad_damping * (w - v);
            let drag = DAMPING * v + friction * (v / 0.2).tanh();
            v += h / inertia * (touch - f - drag);
            w += h / hand * (grip * (rest(t) - y) - hand_damping * w - touch);
            loss += h * drag * v;
            x += h * v;
            y += h * w;
        }
        energy += f * (x - before);
    }
    Run {
        summary: summarise(law, k_desired, &trace),
        trace: Some(trace),
    }
}

/// Estimates the summary of a made-up run roughly; real summaries are computed by the simulator.
fn summarise(law: LawKind, k: f64, trace: &Trace) -> Summary {
    let ticks = trace.time_s.len();
    let hold: Vec<usize> = (0..ticks)
        .filter(|&i| (2.3..2.6).contains(&trace.time_s[i]))
        .collect();
    let low = |values: &[f64]| {
        values
            .iter()
            .copied()
            .filter(|v| v.is_finite())
            .fold(0.0, f64::min)
    };
    let mean = |values: &dyn Fn(usize) -> f64| {
        hold.iter().map(|&i| values(i)).sum::<f64>() / hold.len() as f64
    };
    let shown = mean(&|i| trace.force_n_m[i]) / mean(&|i| trace.angle_measured_rad[i] - SURFACE);
    let high = hold
        .iter()
        .map(|&i| trace.angle_rad[i])
        .fold(f64::MIN, f64::max);
    let cycle = high
        - hold
            .iter()
            .map(|&i| trace.angle_rad[i])
            .fold(f64::MAX, f64::min);
    let user: Vec<f64> = trace
        .energy_true_j
        .iter()
        .zip(&trace.energy_device_loss_j)
        .map(|(a, b)| a + b)
        .collect();
    let verdict = match cycle {
        c if c > 0.03 => Verdict::Unstable,
        c if c > 0.003 => Verdict::LimitCycle,
        _ if low(&user) < -1e-5 => Verdict::Active,
        _ => Verdict::Passive,
    };
    let held = !hold.is_empty();
    Summary {
        scene: "synthetic".to_owned(),
        number: "f64".to_owned(),
        grip: "medium".to_owned(),
        encoder_counts_per_rev: Some(COUNTS),
        rate_hz: 1000,
        k_displayed: held.then_some(shown),
        peak_penetration_ratio: held.then_some(1.0),
        ripple_rms_n_m: held.then_some(1e-3),
        ripple_above_50_hz_rms_n_m: held.then_some(1e-3),
        release_speed_rad_per_s: held.then_some(1.0),
        release_excursion_rad: held.then_some(0.05),
        energy_out_worst_window_j: -low(&user),
        energy_out_wall_worst_window_j: -low(&trace.energy_true_j),
        settle_from_ramp_end_s: (held && verdict <= Verdict::Active).then_some(0.21),
        rate_hardness: held.then_some(if law == LawKind::Fba { k.min(1.0) } else { k }),
        extended_rate_hardness: held.then_some(k),
        touch_torque_n_m: held.then_some(5e-3 * k),
        limit_cycle_peak_to_peak: held.then_some(cycle),
        energy_true_min: low(&trace.energy_true_j),
        energy_user_min: low(&user),
        energy_out: (-low(&user)).max(0.0),
        energy_observed_min: (law != LawKind::Spring).then(|| low(&trace.energy_observed_j)),
        settle_time: (held && verdict <= Verdict::Active).then_some(0.21),
        penetration_max: trace.angle_rad.iter().copied().fold(SURFACE, f64::max) - SURFACE,
        force_max: trace.force_n_m.iter().copied().fold(0.0, f64::max),
        ticks: ticks as u64,
        contact_ticks: trace.force_n_m.iter().filter(|f| **f != 0.0).count() as u64,
        ..Summary::without_measures(law, k, verdict)
    }
}
