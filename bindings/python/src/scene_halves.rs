//! The two halves of a scene of one axis as Python classes, step by step: device with hand, and control law with its sensor.

use crate::plain;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::{PyOverflowError, PyValueError};
use pyo3::prelude::*;
use std::sync::Mutex;
use touchstone_sim::run::chain::{Answer, Control};
use touchstone_sim::run::plan;
use touchstone_sim::run::plant_half::PlantHalf;
use touchstone_sim::scene::Scene;

/// Loads a scene by its name or path, and changes fields as `--set` does.
fn load(scene: &str, changes: &[String]) -> PyResult<Scene> {
    Scene::load(scene)
        .and_then(|scene| scene.with_overrides(changes))
        .map_err(wrong)
}

fn wrong(error: touchstone_sim::error::Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Largest torque (N·m) or angle (rad) that the simulation accepts.
const MOST: f64 = 1e6;

fn within(name: &str, value: f64) -> PyResult<f64> {
    if plain(name, value)?.abs() <= MOST {
        return Ok(value);
    }
    Err(PyValueError::new_err(format!(
        "{name} = {value}: give a number from -1e6 to 1e6"
    )))
}

/// Device and hand of a scene, without its control law: step by step, with a torque that the caller computes.
#[pyclass(name = "Plant", module = "touchstone", subclass)]
pub struct PyPlant {
    // The `Mutex` only makes the class `Sync`, which PyO3 requires. It is never locked, because every method has exclusive access
    // (`&mut self`).
    half: Mutex<PlantHalf>,
    scene: Scene,
    ticks: u64,
    absorbed_j: f64,
}

impl PyPlant {
    fn made(scene: Scene) -> PyResult<Self> {
        Ok(Self {
            half: Mutex::new(PlantHalf::new(&scene).map_err(wrong)?),
            scene,
            ticks: 0,
            absorbed_j: 0.0,
        })
    }

    fn half(&mut self) -> &mut PlantHalf {
        self.half
            .get_mut()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    fn advance(&mut self, torque_n_m: f64, hand_offset_rad: f64) -> PyResult<f64> {
        let tick = self.half().tick(torque_n_m, hand_offset_rad);
        self.ticks += 1;
        self.absorbed_j += tick.absorbed_j;
        let angle_rad = self.half().standing().angle_rad;
        if angle_rad.is_finite() && self.absorbed_j.is_finite() {
            return Ok(angle_rad);
        }
        Err(PyOverflowError::new_err(format!(
            "the device is at {angle_rad} rad after {} steps: give smaller torques, and call reset()",
            self.ticks
        )))
    }
}

#[pymethods]
impl PyPlant {
    #[new]
    #[pyo3(signature = (scene="thesis-knob", changes=Vec::new()))]
    #[allow(clippy::needless_pass_by_value)]
    fn new(scene: &str, changes: Vec<String>) -> PyResult<Self> {
        Self::made(load(scene, &changes)?)
    }

    /// Simulates one control period under a torque command, N·m in the direction of positive angles. Returns the device's true
    /// angle at its end, rad.
    ///
    /// `hand_offset_rad` is added to the point to which the scene's hand is pulled.
    #[pyo3(signature = (torque_n_m, hand_offset_rad=0.0))]
    fn step(&mut self, torque_n_m: f64, hand_offset_rad: f64) -> PyResult<f64> {
        let torque_n_m = within("torque_n_m", torque_n_m)?;
        self.advance(torque_n_m, within("hand_offset_rad", hand_offset_rad)?)
    }

    /// Simulates many control periods: takes an array of torque commands, returns an array of the angles after each.
    fn steps<'py>(
        &mut self,
        py: Python<'py>,
        torque_n_m: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let torques: Vec<f64> = torque_n_m
            .as_slice()?
            .iter()
            .map(|torque| within("torque_n_m", *torque))
            .collect::<PyResult<_>>()?;
        let angles: Vec<f64> = py.detach(|| {
            torques
                .into_iter()
                .map(|torque| self.advance(torque, 0.0))
                .collect::<PyResult<_>>()
        })?;
        Ok(PyArray1::from_vec(py, angles))
    }

    /// Puts device and hand back to their initial positions.
    fn reset(&mut self) -> PyResult<()> {
        *self = Self::made(self.scene.clone())?;
        Ok(())
    }

    /// True angle of the device, rad.
    #[getter]
    fn angle_rad(&mut self) -> f64 {
        self.half().standing().angle_rad
    }

    /// Velocity of the device, rad/s.
    #[getter]
    fn velocity_rad_per_s(&mut self) -> f64 {
        self.half().standing().velocity_rad_per_s
    }

    /// Angle of the hand's mass, rad; without a hand, the device's angle.
    #[getter]
    fn hand_rad(&mut self) -> f64 {
        self.half().standing().hand_rad
    }

    /// Velocity of the hand's mass, rad/s; without a hand, the device's velocity.
    #[getter]
    fn hand_velocity_rad_per_s(&mut self) -> f64 {
        self.half().standing().hand_velocity_rad_per_s
    }

    /// True angle at which the motor's torque changed in the last step, rad; `None` if the scene's guard does not measure it.
    #[getter]
    fn changed_at_rad(&mut self) -> Option<f64> {
        self.half().changed_at_rad()
    }

    /// Energy that the motor took from the device since the start, J; negative if it gave energy.
    #[getter]
    fn absorbed_j(&self) -> f64 {
        self.absorbed_j
    }

    /// Time since the start, s.
    #[getter]
    fn time_s(&self) -> f64 {
        self.ticks as f64 * self.scene.timing.period_s()
    }

    /// Control period, s.
    #[getter]
    fn period_s(&self) -> f64 {
        self.scene.timing.period_s()
    }

    /// Number of control periods that the scene lasts; more may be simulated.
    #[getter]
    fn scene_steps(&self) -> u64 {
        self.scene.timing.ticks()
    }
}

/// The controller of a scene: sensor, control law, energy guard and the effects on the torque command, step by step.
#[pyclass(name = "Law", module = "touchstone", subclass)]
pub struct PyLaw {
    control: Mutex<Box<dyn Control>>,
    scene: Scene,
    last: Option<Answer>,
}

impl PyLaw {
    fn made(scene: Scene) -> PyResult<Self> {
        Ok(Self {
            control: Mutex::new(plan::control(&scene).map_err(wrong)?),
            scene,
            last: None,
        })
    }

    fn control(&mut self) -> &mut dyn Control {
        self.control
            .get_mut()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
            .as_mut()
    }
}

#[pymethods]
impl PyLaw {
    #[new]
    #[pyo3(signature = (scene="thesis-knob", changes=Vec::new()))]
    #[allow(clippy::needless_pass_by_value)]
    fn new(scene: &str, changes: Vec<String>) -> PyResult<Self> {
        Self::made(load(scene, &changes)?)
    }

    /// Runs one control period: takes the device's true angle, rad, and returns the torque command, N·m in the direction of
    /// positive angles.
    ///
    /// `changed_at_rad` is `Plant.changed_at_rad`: the true angle at which the motor's torque last changed, rad; `None` if the
    /// scene's guard does not measure this angle. From the second tick on a guard that measures it needs it, unless the scene's
    /// torque changes at the sample.
    #[pyo3(signature = (angle_rad, changed_at_rad=None))]
    fn tick(&mut self, angle_rad: f64, changed_at_rad: Option<f64>) -> PyResult<f64> {
        let angle_rad = within("angle_rad", angle_rad)?;
        let changed = changed_at_rad.map(|angle| within("changed_at_rad", angle));
        let changed = changed.transpose()?;
        if changed.is_none() && self.last.is_some() && plan::tells_change(&self.scene) {
            return Err(PyValueError::new_err(
                "changed_at_rad is missing, and the scene has law.guard.change = \"measured\": give a number, Plant.changed_at_rad",
            ));
        }
        // Before the first tick no torque has changed.
        if let (Some(changed), Some(_)) = (changed, self.last) {
            self.control().changed_at(changed);
        }
        let answer = self.control().answer(angle_rad);
        self.last = Some(answer);
        Ok(answer.torque_n_m)
    }

    /// Puts the controller back to its initial state, with a full energy account.
    fn reset(&mut self) -> PyResult<()> {
        *self = Self::made(self.scene.clone())?;
        Ok(())
    }

    /// Penetration that the law got from the sensor, rad; `None` before the first tick.
    #[getter]
    fn penetration_rad(&self) -> Option<f64> {
        self.last.map(|it| it.told_rad)
    }

    /// Energy in the guard's account, J; `None` without a guard or before the first tick.
    #[getter]
    fn account_j(&self) -> Option<f64> {
        self.last?.inside.guard.map(|guard| guard.account_j)
    }

    /// Whether the guard passed less torque than the law requested.
    #[getter]
    fn limited(&self) -> bool {
        self.last
            .and_then(|it| it.inside.guard)
            .is_some_and(|guard| guard.limited)
    }

    /// Whether the guard has switched the torque off.
    #[getter]
    fn tripped(&self) -> bool {
        self.last
            .and_then(|it| it.inside.guard)
            .is_some_and(|guard| guard.tripped)
    }
}
