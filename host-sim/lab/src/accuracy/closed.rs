//! Compares the integration methods in a closed loop of wall, knob and hand, by the results of a run (verdict, stiffness, energy).
//! Paths are not compared tick by tick, because rounding alone changes the path, even below one encoder count.

use rayon::prelude::*;
use serde::Serialize;
use touchstone_control::Choice as _;
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::scene::{Integrator, Preset, Scene};
use touchstone_world::integrator::{
    ImplicitEuler, ImplicitMidpoint, Method, Model, RungeKutta4, SemiImplicitEuler, Substepped,
};
use touchstone_world::plant::{
    Device, Invalid, LinearStepper, Loss, Stepper, closed_loop_matrix, critical_stiffness,
    spectral_radius,
};

/// Small change of the start angle, rad. The difference that it makes shows how much the loop amplifies errors.
pub const NUDGE_RAD: f64 = 1e-12;

/// Results of one closed-loop run.
#[derive(Debug, Clone, Serialize)]
pub struct ClosedPoint {
    /// Name of the simulated scene.
    pub scene: &'static str,
    /// Name of the integration method, or `exact, start moved by 1e-12 rad` for the closed-form solution with a changed start.
    pub method: String,
    /// Substeps per tick (control period); absent for the closed-form solution.
    pub substeps: Option<u32>,
    /// Verdict on the run, for example `passive` or `unstable`.
    pub verdict: &'static str,
    /// Displayed stiffness (force over penetration at the end of the hold), N·m/rad.
    pub k_displayed_n_m_per_rad: Option<f64>,
    /// Most energy that the hand got out of the device in any window of time, J.
    pub energy_out_worst_window_j: f64,
    /// Deepest penetration of the wall, rad.
    pub penetration_max_rad: f64,
    /// Largest difference of the angle from that of the closed-form solution in the same tick, rad.
    pub path_difference_rad: f64,
    /// Largest stiffness at which the sampled loop of wall and bare device is stable when this method simulates the device,
    /// N·m/rad. `None`: the loop is unstable even at a thousandth of `b/(T/2)` (damping `b`, control period `T`).
    pub k_max_n_m_per_rad: Option<f64>,
    /// Largest stable stiffness with this integration method, divided by that with the closed-form solution, minus 1.
    pub k_max_error: Option<f64>,
}

/// A closed-loop case: its name in the results, its scene, a preset of law parameters, and changes of scene fields.
type Closed = (&'static str, &'static str, Preset, &'static [&'static str]);

const SCENES: [Closed; 3] = [
    ("thesis-knob", "thesis-knob", Preset::Thesis, &[]),
    ("thesis-knob, shipped", "thesis-knob", Preset::Shipped, &[]),
    (
        "press-hold, spring",
        "press-hold",
        Preset::Thesis,
        &[
            "encoder.counts_per_rev=40000",
            "law.kind=spring",
            "wall.k_desired_n_m_per_rad=0.3",
        ],
    ),
];

/// A plant without friction, simulated in substeps, whose step is a linear function of state and force.
struct Linear<S>(S);

impl<S: Stepper> Stepper for Linear<S> {
    type State = S::State;
    fn interval_s(&self) -> f64 {
        self.0.interval_s()
    }
    fn step(&self, state: &mut S::State, force: f64, rest: f64) {
        self.0.step(state, force, rest);
    }
    fn step_with_loss(&self, state: &mut S::State, force: f64, rest: f64) -> Loss {
        self.0.step_with_loss(state, force, rest)
    }
    fn stored_energy_j(&self, state: &S::State, rest: f64) -> f64 {
        self.0.stored_energy_j(state, rest)
    }
}

impl<S: Stepper> LinearStepper for Linear<S> {}

/// Largest stiffness, N·m/rad, at which the sampled loop of wall and bare device is stable without delay.
///
/// `by` is the integration method with its substeps per tick (control period); `None` is the closed-form solution. Returns `None`
/// if the loop is unstable even at a thousandth of `b/(T/2)` (damping `b`, control period `T`).
///
/// # Errors
/// The plant's parameters are not valid.
pub fn k_max(
    device: &Device,
    period_s: f64,
    by: Option<(Integrator, u32)>,
) -> std::result::Result<Option<f64>, Invalid> {
    let Some((integrator, substeps)) = by else {
        return critical_stiffness(device, None, 1.0 / period_s, 0.0).map(Some);
    };
    let model = Model::bare(device)?;
    fn of<M: Method<2>>(
        model: &Model<2>,
        device: &Device,
        period_s: f64,
        substeps: u32,
    ) -> std::result::Result<Option<f64>, Invalid> {
        let plant = Linear(Substepped::<M, 2>::new(model, period_s, substeps)?);
        let none = Linear(Substepped::<M, 2>::new(model, 0.0, 1)?);
        let expected = device.damping / (0.5 * period_s);
        let stable = |k: f64| spectral_radius(&closed_loop_matrix(&none, &plant, 0, k)) < 1.0;
        if !stable(1e-3 * expected) {
            return Ok(None);
        }
        // The stiffness rises by a tenth in each step until the loop is unstable. Bisection then refines the limit.
        let mut low = 1e-3 * expected;
        while stable(1.1 * low) && low < 1e6 * expected {
            low *= 1.1;
        }
        let mut high = 1.1 * low;
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if stable(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(Some(low))
    }
    match integrator {
        Integrator::Exact => k_max(device, period_s, None),
        Integrator::ImplicitEuler => of::<ImplicitEuler<2>>(&model, device, period_s, substeps),
        Integrator::ImplicitMidpoint => {
            of::<ImplicitMidpoint<2>>(&model, device, period_s, substeps)
        }
        Integrator::SemiImplicitEuler => {
            of::<SemiImplicitEuler<2>>(&model, device, period_s, substeps)
        }
        Integrator::RungeKutta4 => of::<RungeKutta4<2>>(&model, device, period_s, substeps),
    }
}

/// Simulates each of the three closed-loop scenes with every integration method and number of substeps. Another run uses the
/// closed-form solution from a start angle moved by [`NUDGE_RAD`].
///
/// # Errors
/// A scene cannot be run.
pub fn points(substeps: &[u32]) -> Result<Vec<ClosedPoint>> {
    let mut points = Vec::new();
    for (name, shipped, preset, sets) in SCENES {
        let scene = Scene::load(shipped)?
            .with_preset(preset)?
            .with_overrides(sets)?;
        let exact = run::run(&scene, true)?;
        let angles = exact.trace.map(|trace| trace.angle_rad).unwrap_or_default();
        let mut wanted = vec![
            ("exact".to_owned(), None, scene.clone()),
            (
                "exact, start moved by 1e-12 rad".to_owned(),
                None,
                nudged(&scene)?,
            ),
        ];
        for integrator in Integrator::WORDS
            .iter()
            .filter(|word| **word != Integrator::Exact.word())
        {
            for count in substeps {
                let sets = [
                    format!("plant.integrator={integrator}"),
                    format!("plant.substeps={count}"),
                ];
                wanted.push((
                    (*integrator).to_owned(),
                    Some(*count),
                    scene.with_overrides(&sets)?,
                ));
            }
        }
        let device = Device {
            friction: None,
            ..run::plan::device(&scene)
        };
        let period_s = scene.timing.period_s();
        let k_exact = k_max(&device, period_s, None).ok().flatten();
        let found: Vec<ClosedPoint> = wanted
            .into_par_iter()
            .map(|(method, substeps, changed)| {
                let run = run::run(&changed, true)?;
                let path = run.trace.map(|trace| trace.angle_rad).unwrap_or_default();
                let path_difference_rad = path
                    .iter()
                    .zip(&angles)
                    .map(|(a, b)| (a - b).abs())
                    .fold(0.0, f64::max);
                let by = substeps
                    .zip(Integrator::of_word(&method))
                    .map(|(n, integrator)| (integrator, n));
                let k_max = k_max(&device, period_s, by).ok().flatten();
                Ok(ClosedPoint {
                    scene: name,
                    method,
                    substeps,
                    verdict: run.summary.verdict_name(),
                    k_displayed_n_m_per_rad: run.summary.k_displayed,
                    energy_out_worst_window_j: run.summary.energy_out_worst_window_j,
                    penetration_max_rad: run.summary.penetration_max,
                    path_difference_rad,
                    k_max_n_m_per_rad: k_max,
                    k_max_error: k_max.zip(k_exact).map(|(k, exact)| k / exact - 1.0),
                })
            })
            .collect::<Result<_>>()?;
        points.extend(found);
    }
    Ok(points)
}

/// The scene with its start angle moved by [`NUDGE_RAD`].
fn nudged(scene: &Scene) -> Result<Scene> {
    let motion = touchstone_sim::scene::RestPath::from_scene(scene)?;
    let start = scene.start_rad(&motion) + NUDGE_RAD;
    scene.with(|scene| scene.device.initial_angle_rad = Some(start))
}
