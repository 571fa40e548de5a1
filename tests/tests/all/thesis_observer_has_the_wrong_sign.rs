//! Shows that the energy observer in the DLR thesis (equation 2.1) has the wrong sign, by one press of 0.05 rad into 5 N·m/rad and
//! back in 0.2 s, at 1 kHz. The wall *gives* the user 0.154 mJ, because a held force lags behind the motion by half a control
//! period. The thesis' observer reports the same amount with the opposite sign, as if the wall had taken it. The exact observer
//! reports the true energy.

use touchstone_control::observer::{ExactObserver, ThesisObserver};
use touchstone_control::{Controller, Fixed32, Force, LawKind, Position, Reported, Settings, Si};
use touchstone_tests::motion::half_sine;

const DEPTH_RAD: f64 = 0.05;
const PRESS_S: f64 = 0.2;
const TICK_S: f64 = 1e-3;
const TICKS: u32 = 200;
const STIFFNESS_N_M_PER_RAD: f64 = 5.0;
const MILLI: f64 = 1e-3;

/// The energy sums after one press, J.
struct Press {
    /// True energy that the wall absorbed, J, calculated with the exact velocity between the samples.
    true_j: f64,
    thesis_j: f64,
    /// Sum of the exact energy observer after the hand has left the wall, J.
    exact_j: f64,
    /// Sum of the exact energy observer at the last sample inside the wall, J. It is the last sum for a control law that clears its
    /// memory when the hand leaves.
    exact_inside_j: f64,
}

/// Energy `∫ f v dt` in J of a held force `f` over one control period of the half-sine motion. Calculated by the midpoint rule with
/// more steps than needed.
fn held_force_energy_j(force_n_m: f64, tick: usize) -> f64 {
    const STEPS: u32 = 100;
    let step_s = TICK_S / f64::from(STEPS);
    let omega = std::f64::consts::PI / PRESS_S;
    (0..STEPS)
        .map(|step| {
            let t_s = tick as f64 * TICK_S + (f64::from(step) + 0.5) * step_s;
            force_n_m * DEPTH_RAD * omega * (omega * t_s).cos() * step_s
        })
        .sum()
}

fn press<N: Reported>() -> Press {
    let settings = Settings {
        law: LawKind::Spring,
        k_desired: Si::from_num(STIFFNESS_N_M_PER_RAD),
        ..Settings::thesis()
    };
    let mut wall = Controller::<N>::new(&settings).unwrap();
    let start = Position::zero();
    let (mut exact, mut thesis) = (
        ExactObserver::<N>::new(start),
        ThesisObserver::<N>::new(start),
    );
    let (mut true_j, mut exact_inside_j) = (0.0, 0.0);
    for (tick, angle) in half_sine(DEPTH_RAD, TICKS).into_iter().enumerate() {
        let e = Position::<N>::from_f64(angle);
        let f: Force<N> = wall.tick(e);
        exact.tick(e, f);
        thesis.tick(e, f);
        if e > Position::zero() {
            exact_inside_j = exact.energy.to_f64();
        }
        if tick < TICKS as usize {
            // The wall absorbs energy while the hand moves inwards against its force.
            true_j += held_force_energy_j(f.to_f64(), tick);
        }
    }
    Press {
        true_j,
        thesis_j: thesis.energy.to_f64(),
        exact_j: exact.energy.to_f64(),
        exact_inside_j,
    }
}

/// Asserts that a value in J equals the value in mJ that the documentation quotes, to three decimals.
fn assert_milli(what: &str, value_j: f64, quoted_mj: f64) {
    let value_mj = value_j / MILLI;
    assert!(
        (value_mj - quoted_mj).abs() < 0.000_5,
        "{what}: {value_mj:.4} mJ, quoted as {quoted_mj} mJ"
    );
}

fn quoted<N: Reported>() {
    let press = press::<N>();
    assert_milli("true", press.true_j, -0.154);
    assert_milli("thesis observer", press.thesis_j, 0.154);
    assert_milli("exact observer", press.exact_j, -0.154);
    // The last displacement, out of the wall, is missing: f·Δe = 5 N·m/rad · (7.9e-4 rad)² = 3.1 µJ.
    assert_milli("exact observer, inside", press.exact_inside_j, -0.151);
}

#[test]
fn in_f64() {
    quoted::<f64>();
}

#[test]
fn in_fixed_point() {
    quoted::<Fixed32>();
}

#[test]
fn the_leak_is_the_closed_form() {
    // A spring whose force is held for a control period `T` gives k/2 Σ Δe² per closed cycle. For a half sine of depth `A` and
    // duration `τ` that is k A² π² T/(4 τ) (1 + O(T²)).
    let closed_form_j =
        STIFFNESS_N_M_PER_RAD * DEPTH_RAD.powi(2) * std::f64::consts::PI.powi(2) * TICK_S
            / (4.0 * PRESS_S);
    let press = press::<f64>();
    assert!((press.true_j / -closed_form_j - 1.0).abs() < 1e-4);
    assert!((press.thesis_j / closed_form_j - 1.0).abs() < 1e-4);
}

#[test]
fn the_exact_observer_is_the_port_and_the_thesis_observer_its_mirror_image() {
    let press = press::<f64>();
    // Energy that flowed through the port, in and out: about k A². Errors below are rounding of sums of 200 products.
    let throughput_j = STIFFNESS_N_M_PER_RAD * DEPTH_RAD.powi(2);
    assert!((press.exact_j - press.true_j).abs() < 1e-5 * MILLI);
    assert!((press.exact_j + press.thesis_j).abs() < 1e-12 * throughput_j);
}

#[test]
fn fixed_point_adds_nothing_but_the_rounding_of_its_forces() {
    // Both formats get the same angles: those of the fixed-point format, which f64 holds exactly. A force is truncated by less than
    // one quantum q = 2^-24 N·m, over a path of 2 A, which is A each way. Products and sums are exact.
    let q = (2.0_f64).powi(-24);
    let bound_j = q * 2.0 * DEPTH_RAD;
    let mut fixed = ExactObserver::<Fixed32>::new(Position::zero());
    let mut exact_j = 0.0;
    let (mut last_rad, mut held_n_m) = (0.0, 0.0);
    // The format holds this stiffness exactly, but not its products with angles.
    let stiffness_n_m_per_rad = 19_253.0 / 4_096.0;
    let settings = Settings {
        law: LawKind::Spring,
        k_desired: Si::from_num(stiffness_n_m_per_rad),
        ..Settings::thesis()
    };
    let mut wall = Controller::<Fixed32>::new(&settings).unwrap();
    for angle in half_sine(DEPTH_RAD, TICKS) {
        let e = Position::<Fixed32>::from_f64(angle);
        fixed.tick(e, wall.tick(e));
        exact_j += held_n_m * (e.to_f64() - last_rad);
        last_rad = e.to_f64();
        held_n_m = stiffness_n_m_per_rad * last_rad;
    }
    let error_j = (fixed.energy.to_f64() - exact_j).abs();
    assert!(error_j <= bound_j, "{error_j:e} J, bound {bound_j:e} J");
    assert!(
        error_j > 0.0,
        "no rounding at all: the test looks at nothing"
    );
}
