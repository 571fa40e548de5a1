//! Test problems for the integration methods: a plant, with given torque and rest point of the hand in every tick (control period).
//! All methods receive the same input.

use super::double::Double;
use super::reference::{Entries, Reference};
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::run::tick::{Recorder, Tick};
use touchstone_sim::scene::{Preset, Scene};
use touchstone_world::plant::{Coulomb, Device, Hand, MEDIUM};

/// Duration of a tick (control period) in the test problems, s.
pub const PERIOD_S: f64 = 1e-3;
/// Bandwidth of the current loop in the test problem `current-loop`, Hz.
pub const CURRENT_LOOP_HZ: f64 = 5000.0;

/// A test problem for integration methods.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Name of the test problem in tables and files.
    pub name: &'static str,
    /// The property that makes the problem difficult for an integration method.
    pub about: &'static str,
    /// The simulated device.
    pub device: Device,
    /// The hand that holds the device; `None` without a hand.
    pub hand: Option<Hand>,
    /// Bandwidth of a current controller in front of the device, Hz; `None` if the torque follows its command at once.
    pub current_loop_hz: Option<f64>,
    /// State of plant and hand at the start, in SI units; entries that the plant does not have are 0.
    pub start: [f64; 4],
    /// Torque in N·m and the hand's rest point in rad, constant during each tick.
    pub held: Vec<[f64; 2]>,
}

/// Angles of the reference solution, with their error.
#[derive(Debug, Clone)]
pub struct Known {
    /// Angle at the end of every tick, rad.
    pub angle_rad: Vec<f64>,
    /// Largest difference from a reference solution with half as many steps, rad.
    pub floor_rad: f64,
    /// Number of times that friction stops the knob or lets it start.
    pub events: u64,
}

const KNOB: Device = Device {
    inertia: 1e-4,
    damping: 4e-4,
    friction: None,
};

/// Recorder that collects torque and rest point of every tick of a run, as the plant received them.
struct Torques(Vec<[f64; 2]>);

impl Recorder for Torques {
    fn record(&mut self, tick: &Tick) {
        self.0.push([-tick.motor_force_n_m, tick.rest_rad]);
    }
}

impl Problem {
    /// Makes all test problems, each of `ticks` ticks (control periods).
    ///
    /// # Errors
    /// A shipped scene cannot be run.
    pub fn all(ticks: u32) -> Result<Vec<Problem>> {
        let time_s = |tick: u32| PERIOD_S * f64::from(tick);
        let each = |f: &dyn Fn(f64) -> [f64; 2]| (0..ticks).map(|i| f(time_s(i))).collect();
        let sticky = Device {
            friction: Some(Coulomb {
                kinetic: 2e-3,
                breakaway: 3e-3,
            }),
            ..KNOB
        };
        let smooth = Problem {
            name: "smooth",
            about: "a held knob without friction, driven by sines",
            device: KNOB,
            hand: Some(MEDIUM),
            current_loop_hz: None,
            start: [0.1, 2.0, 0.12, -1.0],
            held: each(&|t| [0.03 * (37.0 * t).sin(), 0.1 + 0.3 * (11.0 * t).sin()]),
        };
        let stick_slip = Problem {
            name: "stick-slip",
            about: "a held knob with friction, pulled to and fro slowly: it stops and starts again and again",
            device: sticky,
            start: [0.1, 0.0, 0.1, 0.0],
            held: each(&|t| [6e-3 * (23.0 * t).sin(), 0.1 + 0.15 * (9.0 * t).sin()]),
            ..smooth.clone()
        };
        let contact = contact(ticks)?;
        let current_loop = Problem {
            name: "current-loop",
            about: "a free knob behind a current loop of 5 kHz, torque in steps",
            device: KNOB,
            hand: None,
            current_loop_hz: Some(CURRENT_LOOP_HZ),
            start: [0.0; 4],
            held: (0..ticks)
                .map(|tick| [if tick / 8 % 2 == 0 { 0.02 } else { -0.02 }, 0.0])
                .collect(),
        };
        Ok(vec![smooth, stick_slip, contact, current_loop])
    }

    /// Number of entries in the state of the plant.
    #[must_use]
    pub fn states(&self) -> usize {
        match (&self.hand, self.current_loop_hz) {
            (Some(_), _) => 4,
            (None, Some(_)) => 3,
            (None, None) => 2,
        }
    }

    /// Solves the problem with the reference method; returns the angles and their error.
    #[must_use]
    pub fn solve(&self) -> Known {
        // A pole of a few thousand hertz needs short steps; the motion of a knob does not.
        let steps = if self.current_loop_hz.is_some() {
            64
        } else {
            4
        };
        let (coarse, _) = self.march(steps / 2);
        let (fine, events) = self.march(steps);
        let floor_rad = coarse
            .iter()
            .zip(&fine)
            .map(|(a, b)| (*a - *b).to_f64().abs())
            .fold(0.0, f64::max);
        Known {
            angle_rad: fine.iter().map(|angle| angle.to_f64()).collect(),
            floor_rad,
            events,
        }
    }

    fn march(&self, steps: u32) -> (Vec<Double>, u64) {
        let mut reference = Reference::new(
            &self.device,
            self.hand.as_ref(),
            self.current_loop_hz,
            steps,
        );
        let mut state: Entries = self.start.map(Double::from);
        let angles = self
            .held
            .iter()
            .map(|&held| {
                reference.tick(&mut state, held, PERIOD_S);
                state[0]
            })
            .collect();
        (angles, reference.events)
    }
}

/// Makes the test problem of a knob with friction that a hand presses into a wall of 0.8 N·m/rad. The torques come from a
/// simulated spring wall with an encoder.
fn contact(ticks: u32) -> Result<Problem> {
    let scene = Scene::load("press-wiggle-release")?
        .with_preset(Preset::Thesis)?
        .with_overrides(&[
            "law.kind=spring".to_owned(),
            "wall.k_desired_n_m_per_rad=0.8".to_owned(),
            "encoder.counts_per_rev=40000".to_owned(),
            "device.friction.kinetic_n_m=1e-3".to_owned(),
            "device.friction.static_n_m=1.5e-3".to_owned(),
            "operator.grip=medium".to_owned(),
        ])?;
    let device = run::plan::device(&scene);
    let hand = run::plan::hand(&scene);
    let motion = touchstone_sim::scene::RestPath::from_scene(&scene)?;
    let start = scene.start_rad(&motion);
    let mut held = run::watch(&scene, Torques(Vec::new()))?.0;
    // The problem begins shortly before the first force. Before that only the hand moves the knob.
    let touch = held
        .iter()
        .position(|[torque, _]| *torque != 0.0)
        .unwrap_or(0);
    let state = state_before(&scene, touch.saturating_sub(20), start)?;
    held.drain(..touch.saturating_sub(20));
    held.truncate(ticks as usize);
    Ok(Problem {
        name: "contact",
        about: "a held knob with friction in a wall of 0.8 N·m/rad that answers in steps of an encoder's count",
        device,
        hand,
        current_loop_hz: None,
        start: state,
        held,
    })
}

/// State of a scene's plant before the given tick, from a simulation that starts at rest at `start_rad`.
fn state_before(scene: &Scene, tick: usize, start_rad: f64) -> Result<[f64; 4]> {
    use touchstone_world::plant::{HeldCoulomb, Kinematics as _, State, Stepper as _};
    let torques = run::watch(scene, Torques(Vec::new()))?.0;
    let mut state = State::at_rest(start_rad);
    if let Some(hand) = run::plan::hand(scene)
        && let Ok(plant) =
            HeldCoulomb::new(&run::plan::device(scene), &hand, scene.timing.period_s())
    {
        for &[torque, rest] in torques.iter().take(tick) {
            plant.step(&mut state, torque, rest);
        }
    }
    Ok(state.to_array())
}
