//! Measures the plant's integration methods: for every method on every test problem, the error against a reference and the
//! computing time.

use serde::Serialize;
use touchstone_control::Choice as _;
use touchstone_sim::scene::Integrator;
use touchstone_world::integrator::{
    ExactLinear, ImplicitEuler, ImplicitMidpoint, Method, Model, RungeKutta4, SemiImplicitEuler,
    Substepped,
};
use touchstone_world::plant::{HeldCoulomb, HeldLinear, Invalid, Kinematics as _, State, Stepper};

use super::clock::{Spread, Work, race};
use super::problem::{Known, PERIOD_S, Problem};

/// Results of one integration method with one number of substeps on one problem.
#[derive(Debug, Clone, Serialize)]
pub struct Point {
    /// Name of the integration method, as in scene files.
    pub method: &'static str,
    /// Substeps per tick (control period); absent for the closed-form solution.
    pub substeps: Option<u32>,
    /// Largest error of the angle at the end of any tick, rad; absent if the method diverged.
    pub error_rad: Option<f64>,
    /// Root mean square of the angle's error at the ends of ticks, rad.
    pub error_rms_rad: Option<f64>,
    /// Largest error of the energy balance, divided by the sum of all exchanged energies. `None` if the method computes no
    /// energies.
    pub energy_gap: Option<f64>,
    /// Computing time per simulated millisecond.
    pub time: Spread,
}

/// Results of every method on one problem.
#[derive(Debug, Clone, Serialize)]
pub struct Diagram {
    /// Name of the test problem.
    pub problem: &'static str,
    /// The property that makes the problem difficult for an integration method.
    pub about: &'static str,
    /// Number of ticks (control periods) of the problem, each of one simulated millisecond.
    pub ticks: usize,
    /// Number of times that friction stops the knob or lets it start during the problem.
    pub events: u64,
    /// Largest error of the reference solution itself, rad.
    pub reference_floor_rad: f64,
    /// Results of every method with every number of substeps.
    pub points: Vec<Point>,
}

/// Simulates one test problem by one integration method. Writes the angle at each tick's end into the slice, and returns the
/// largest error of the energy balance, or `None` if the method computes no energies.
type March<'a> = Box<dyn Fn(&mut [f64]) -> Option<f64> + 'a>;

fn march<'a, S, const N: usize>(plant: S, problem: &'a Problem) -> (March<'a>, March<'a>)
where
    S: Stepper<State = State<N>> + Clone + 'a,
{
    let start: [f64; N] = std::array::from_fn(|i| problem.start[i]);
    let audited = plant.clone();
    let fast = move |angles: &mut [f64]| {
        let mut state = State::from_array(start);
        for (angle, &[torque, rest]) in angles.iter_mut().zip(&problem.held) {
            plant.step(&mut state, torque, rest);
            *angle = state.position();
        }
        None
    };
    let audit = move |angles: &mut [f64]| {
        let mut state = State::from_array(start);
        let (mut gap, mut throughput, mut worst) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (angle, &[torque, rest]) in angles.iter_mut().zip(&problem.held) {
            let (stored, from) = (audited.stored_energy_j(&state, rest), state.position());
            let loss = audited.step_with_loss(&mut state, torque, rest).total_j();
            let work = torque * (state.position() - from);
            let gained = audited.stored_energy_j(&state, rest) - stored;
            gap += work - gained - loss;
            throughput += work.abs() + gained.abs() + loss.abs();
            worst = worst.max(gap.abs());
            *angle = state.position();
        }
        Some(worst / throughput.max(f64::MIN_POSITIVE))
    };
    (Box::new(fast), Box::new(audit))
}

fn by<'a, const N: usize>(
    integrator: Integrator,
    model: &Model<N>,
    substeps: u32,
    problem: &'a Problem,
) -> Result<(March<'a>, March<'a>), Invalid> {
    fn of<'a, M: Method<N> + Clone + 'a, const N: usize>(
        model: &Model<N>,
        substeps: u32,
        problem: &'a Problem,
    ) -> Result<(March<'a>, March<'a>), Invalid> {
        Ok(march(
            Substepped::<M, N>::new(model, PERIOD_S, substeps)?,
            problem,
        ))
    }
    match integrator {
        Integrator::ImplicitEuler | Integrator::Exact => {
            of::<ImplicitEuler<N>, N>(model, substeps, problem)
        }
        Integrator::ImplicitMidpoint => of::<ImplicitMidpoint<N>, N>(model, substeps, problem),
        Integrator::SemiImplicitEuler => of::<SemiImplicitEuler<N>, N>(model, substeps, problem),
        Integrator::RungeKutta4 => of::<RungeKutta4<N>, N>(model, substeps, problem),
    }
}

fn exact(problem: &Problem) -> Result<(March<'_>, March<'_>), Invalid> {
    let device = &problem.device;
    if let (Some(hand), friction) = (&problem.hand, device.friction) {
        return Ok(match friction {
            None => march(HeldLinear::new(device, hand, PERIOD_S)?, problem),
            Some(_) => march(HeldCoulomb::new(device, hand, PERIOD_S)?, problem),
        });
    }
    let model = Model::with_current_loop(device, problem.current_loop_hz.unwrap_or(1.0))?;
    let step = ExactLinear::new(&model, PERIOD_S)?;
    let start = [problem.start[0], problem.start[1], problem.start[2]];
    let make = || {
        let (model, step) = (model.clone(), step.clone());
        let march = move |angles: &mut [f64]| {
            let mut state = start;
            for (angle, &held) in angles.iter_mut().zip(&problem.held) {
                step.step(&model, &mut state, held);
                *angle = state[0];
            }
            None
        };
        Box::new(march) as March<'_>
    };
    Ok((make(), make()))
}

/// Largest and root mean square error of the angles against the reference solution, rad. `None` if the method diverged: an angle is
/// off by a whole turn or is not a number.
fn error(angles: &[f64], known: &Known) -> Option<(f64, f64)> {
    let (mut largest, mut squares) = (0.0_f64, 0.0);
    for (angle, known) in angles.iter().zip(&known.angle_rad) {
        let off = (angle - known).abs();
        // The method has diverged if the angle is off by a whole turn.
        if off.is_nan() || off >= std::f64::consts::TAU {
            return None;
        }
        largest = largest.max(off);
        squares += off * off;
    }
    Some((largest, (squares / angles.len() as f64).sqrt()))
}

/// Measures every integration method on a test problem with each number of substeps; calls `on_round` once per round of timing.
///
/// # Errors
/// The plant's parameters are not valid.
pub fn diagram(
    problem: &Problem,
    substeps: &[u32],
    repeats: u32,
    on_round: impl FnMut(),
) -> Result<Diagram, Invalid> {
    let known = problem.solve();
    let mut named = vec![(Integrator::Exact.word(), None, exact(problem)?)];
    for integrator in [
        Integrator::ImplicitEuler,
        Integrator::ImplicitMidpoint,
        Integrator::SemiImplicitEuler,
        Integrator::RungeKutta4,
    ] {
        for &count in substeps {
            let made = match &problem.hand {
                Some(hand) => {
                    let model = Model::held(&problem.device, hand)?;
                    by(integrator, &model, count, problem)?
                }
                None => {
                    let hz = problem.current_loop_hz.unwrap_or(1.0);
                    let model = Model::with_current_loop(&problem.device, hz)?;
                    by(integrator, &model, count, problem)?
                }
            };
            named.push((integrator.word(), Some(count), made));
        }
    }
    let ticks = problem.held.len();
    let mut angles = vec![0.0; ticks];
    let mut errors = Vec::new();
    for (_, _, (fast, audit)) in &named {
        fast(&mut angles);
        let error = error(&angles, &known);
        // A plant with three states has a current loop, whose electrical energy is not calculated.
        let gap = if problem.states() == 3 {
            None
        } else {
            audit(&mut angles)
        };
        errors.push((error, gap.filter(|gap| gap.is_finite())));
    }
    let mut work: Vec<Work> = named
        .iter()
        .map(|(_, _, (fast, _))| {
            let mut angles = vec![0.0; ticks];
            Box::new(move || {
                fast(&mut angles);
                angles[ticks - 1]
            }) as Work
        })
        .collect();
    let times = race(&mut work, ticks as f64, repeats, on_round);
    drop(work);
    let points = named
        .iter()
        .zip(errors)
        .zip(times)
        .map(
            |(((method, substeps, _), (error, energy_gap)), time)| Point {
                method,
                substeps: *substeps,
                error_rad: error.map(|(largest, _)| largest),
                error_rms_rad: error.map(|(_, rms)| rms),
                energy_gap: error.and(energy_gap),
                time,
            },
        )
        .collect();
    Ok(Diagram {
        problem: problem.name,
        about: problem.about,
        ticks,
        events: known.events,
        reference_floor_rad: known.floor_rad,
        points,
    })
}
