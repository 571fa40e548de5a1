//! Tests that the simulated control loop becomes unstable at the stiffness `K_max = b/(T/2 + t_d)`, with damping `b`, control
//! period `T` and delay `t_d`. The largest stable stiffness of the loop is found by bisection.
//!
//! The control law is a spring, computed in f64 from the exact angle. The knob has neither a hand nor dry friction. A wall pushes
//! one way only, so a constant torque presses the knob into it. The press moves the equilibrium inside the wall and changes nothing
//! else in a linear loop. A stiffness is stable if the oscillation around the equilibrium does not grow.

use touchstone_sim::run::chain::{Stage, Staged};
use touchstone_sim::run::plan::Plan;
use touchstone_sim::run::{Recorder, Tick};
use touchstone_sim::scene::Scene;
use touchstone_world::plant::{self, Device};

const INERTIA: f64 = 1e-4;
const DAMPING: f64 = 5e-4;
/// Penetration at which the constant torque holds the knob in the wall, rad.
const EQUILIBRIUM: f64 = 0.1;
/// Deflection of the knob from the equilibrium at the start, rad.
const DEFLECTION: f64 = 0.01;
/// Duration of a simulation. At a stiffness `K` the oscillation grows at `(K/K_max - 1) b/(2J)` (damping `b`, inertia `J`). This is
/// 2.5/s times the relative distance of `K` from the largest stable stiffness `K_max`.
const DURATION_S: f64 = 12.0;

/// A constant torque that is added to the motor's torque and presses the knob into the wall.
#[derive(Debug, Clone, Copy)]
struct Pressed {
    press_n_m: f64,
}

impl Stage for Pressed {
    fn torque_n_m(&mut self, torque_n_m: f64) -> f64 {
        torque_n_m + self.press_n_m
    }
}

/// Sums of squared deflections from the equilibrium in the second and in the last quarter of a simulation. They show whether the
/// oscillation grows.
struct Growth {
    quarter: u64,
    squares: [f64; 2],
    left: bool,
}

impl Recorder for Growth {
    fn record(&mut self, tick: &Tick) {
        let deflection = tick.told_rad - EQUILIBRIUM;
        self.left |= tick.told_rad <= 0.0;
        match tick.index / self.quarter {
            1 => self.squares[0] += deflection * deflection,
            3 => self.squares[1] += deflection * deflection,
            _ => {}
        }
    }
}

fn scene(rate_hz: u32, delay_s: f64, stiffness: f64) -> Scene {
    let text = format!(
        "name = \"spring\"\n\
         [device]\ninertia_kg_m2 = {INERTIA:e}\ndamping_n_m_s_per_rad = {DAMPING:e}\ninitial_angle_rad = {}\n\
         [timing]\nrate_hz = {rate_hz}\nduration_s = {DURATION_S:?}\ncomputational_delay_s = {delay_s:e}\n\
         [wall]\nsurface_rad = 0.5\nk_desired_n_m_per_rad = {stiffness:?}\n\
         [law]\nkind = \"spring\"\nnumber = \"f64\"\nforce_limit_n_m = 100.0\nstates = \"measured\"\n\
         [law.guard]\non = false\n\
         [operator]\ngrip = \"none\"\n",
        0.5 + EQUILIBRIUM + DEFLECTION
    );
    let scene = Scene::parse(&text, std::path::Path::new("spring.toml")).unwrap();
    assert!(scene.encoder.is_none() && scene.device.friction.is_none());
    scene
}

fn growth(rate_hz: u32, delay_s: f64, stiffness: f64) -> Growth {
    let scene = scene(rate_hz, delay_s, stiffness);
    let ticks = scene.timing.ticks();
    let mut growth = Growth {
        quarter: ticks / 4,
        squares: [0.0; 2],
        left: false,
    };
    let mut plan = Plan::of(&scene).unwrap();
    let press_n_m = stiffness * EQUILIBRIUM;
    let mut control = Staged::around(plan.control, Pressed { press_n_m });
    plan.mechanics.advance(
        control.as_mut(),
        &plan.motion,
        0..ticks,
        scene.timing.period_s(),
        Some(&mut growth),
    );
    growth
}

fn is_stable(rate_hz: u32, delay_s: f64, stiffness: f64) -> bool {
    let growth = growth(rate_hz, delay_s, stiffness);
    // A knob that is thrown out of the wall counts as growing, whatever its later motion.
    !growth.left && growth.squares[1] < growth.squares[0]
}

/// Finds the largest stable stiffness of the simulated loop by bisection, N·m/rad, to one part in 10,000.
fn found(rate_hz: u32, delay_s: f64) -> f64 {
    let expected = DAMPING / (0.5 / f64::from(rate_hz) + delay_s);
    let (mut stable, mut unstable) = (0.5 * expected, 1.5 * expected);
    assert!(is_stable(rate_hz, delay_s, stable), "{stable}");
    assert!(!is_stable(rate_hz, delay_s, unstable), "{unstable}");
    while unstable - stable > 1e-4 * expected {
        let middle = 0.5 * (stable + unstable);
        if is_stable(rate_hz, delay_s, middle) {
            stable = middle;
        } else {
            unstable = middle;
        }
    }
    0.5 * (stable + unstable)
}

#[track_caller]
fn assert_critical(rate_hz: u32, delay_s: f64, golden: f64) {
    let found = found(rate_hz, delay_s);
    let formula = DAMPING / (0.5 / f64::from(rate_hz) + delay_s);
    let device = Device {
        inertia: INERTIA,
        damping: DAMPING,
        friction: None,
    };
    let exact = plant::critical_stiffness(&device, None, f64::from(rate_hz), delay_s).unwrap();
    println!(
        "{rate_hz} Hz, {delay_s} s of delay: loop {found:.5}, eigenvalues {exact:.5}, formula {formula:.5} N·m/rad"
    );
    assert!((formula / golden - 1.0).abs() < 1e-12);
    // The formula leaves out terms of relative size b T/J = 5e-3.
    assert!((found / formula - 1.0).abs() < 0.02);
    // Allowed for bisection (1e-4) and for windows that cut an oscillation of some 30 periods (2e-4).
    assert!((found / exact - 1.0).abs() < 1e-3);
}

#[test]
fn the_knob_at_1_khz_is_stable_up_to_1_newton_metre_per_radian() {
    assert_critical(1_000, 0.0, 1.0);
}

#[test]
fn one_tick_of_computational_delay_leaves_a_third() {
    assert_critical(1_000, 1e-3, 1.0 / 3.0);
}

#[test]
fn half_a_tick_of_computational_delay_leaves_a_half() {
    assert_critical(1_000, 5e-4, 0.5);
}

#[test]
fn ten_times_the_rate_gives_ten_times_the_stiffness() {
    assert_critical(10_000, 0.0, 10.0);
}
