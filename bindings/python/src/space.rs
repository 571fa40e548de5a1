//! Guard, wall and device on three axes as Python classes.

use crate::{or, plain, si};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyOverflowError, PyValueError};
use pyo3::prelude::*;
use touchstone_control::space::{LengthUnit, Vector, VectorGuard, VectorGuardState};
use touchstone_control::{
    ChangeOfForce, Energy, Fixed32, Force, GuardSettings, GuardedDevice, Position, Reported as _,
    Si,
};
use touchstone_lab::thesis::space::scene::SpaceScene;
use touchstone_lab::thesis::space::{Cell, CellPlant, CellWall, Phase};

type N = Fixed32;
const UNIT: LengthUnit = LengthUnit::Centimetre;
/// Number of the guard's units of length (centimetres) in a metre.
const PER_METRE: f64 = 100.0;

/// Converts an array of three numbers that are finite.
pub fn three(name: &str, values: &PyReadonlyArray1<f64>) -> PyResult<[f64; 3]> {
    let [x, y, z] = values.as_slice()? else {
        return Err(PyValueError::new_err(format!(
            "{name} has {} numbers: give three, x, y and z",
            values.len()
        )));
    };
    Ok([plain(name, *x)?, plain(name, *y)?, plain(name, *z)?])
}

/// Converts an array of rows of three numbers.
fn rows(name: &str, values: &PyReadonlyArray2<f64>) -> PyResult<Vec<[f64; 3]>> {
    let [_, 3] = values.shape() else {
        return Err(PyValueError::new_err(format!(
            "{name} has the shape {:?}: give rows of three, x, y and z",
            values.shape()
        )));
    };
    if !values.is_c_contiguous() {
        return Err(PyValueError::new_err(format!(
            "{name} is not stored row by row: give numpy.ascontiguousarray({name})"
        )));
    }
    values
        .as_slice()?
        .as_chunks::<3>()
        .0
        .iter()
        .map(|row| {
            plain(name, row[0])?;
            plain(name, row[1])?;
            plain(name, row[2])?;
            Ok(*row)
        })
        .collect()
}

fn array(py: Python<'_>, values: [f64; 3]) -> Bound<'_, PyArray1<f64>> {
    PyArray1::from_slice(py, &values)
}

/// Bounds the energy that a hand can get out of a haptic device with three axes, whatever force is requested.
///
/// Same promise and same conditions as `Guard`, for the sum of all axes. Units are m and N; positions reach to 1.28 m.
#[pyclass(name = "SpaceGuard", module = "touchstone")]
pub struct PySpaceGuard {
    guard: VectorGuard<N>,
    state: VectorGuardState<N>,
    limit: Force<N>,
    last: Option<Vector<Position<N>>>,
    tripped: bool,
}

impl PySpaceGuard {
    fn allowed(&mut self, position_m: [f64; 3], wanted_n: [f64; 3]) -> [f64; 3] {
        let at = Vector(position_m.map(|x| Position::<N>::from_f64(x * PER_METRE)));
        let wanted = Vector(wanted_n.map(Force::<N>::from_f64)).within(self.limit);
        let moved = self.last.map_or(Vector::default(), |last| at - last);
        self.last = Some(at);
        // After an over-speed, motions still fill and empty the account.
        let wanted = if self.tripped {
            Vector::default()
        } else {
            wanted
        };
        let allowed = self.guard.tick_at(&mut self.state, at, moved, wanted);
        self.tripped |= allowed.is_err();
        allowed.unwrap_or_default().0.map(Force::to_f64)
    }
}

#[pymethods]
impl PySpaceGuard {
    #[new]
    #[pyo3(signature = (*, rate_hz, force_limit_n, count_m, damping_n_s_per_m, delay_s, share_of_damping=None, capacity_j=None, refill_w=None,
        overspeed_m_per_s=1.5, lag_s=0.0))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        rate_hz: u32,
        force_limit_n: f64,
        count_m: f64,
        damping_n_s_per_m: f64,
        delay_s: f64,
        share_of_damping: Option<f64>,
        capacity_j: Option<f64>,
        refill_w: Option<f64>,
        overspeed_m_per_s: f64,
        lag_s: f64,
    ) -> PyResult<Self> {
        let shipped = GuardSettings::default();
        let settings = GuardSettings {
            on: true,
            capacity: or("capacity_j", capacity_j, Si::lit("0.04"))?,
            refill: or("refill_w", refill_w, shipped.refill)?,
            damping: si("damping_n_s_per_m", damping_n_s_per_m)?,
            share_of_damping: or(
                "share_of_damping",
                share_of_damping,
                shipped.share_of_damping,
            )?,
            overspeed: si("overspeed_m_per_s", overspeed_m_per_s)?,
            delay: si("delay_s", delay_s)?,
            lag: si("lag_s", lag_s)?,
            change: ChangeOfForce::Estimated,
        };
        let device = GuardedDevice {
            rate_hz,
            force_limit: si("force_limit_n", force_limit_n)?,
            count: si("count_m", count_m)?,
        };
        let (settings, device) = UNIT.guard(&settings, &device);
        let guard = VectorGuard::<N>::new(&settings, &device)
            .map_err(|problem| PyValueError::new_err(problem.to_string()))?;
        Ok(Self {
            state: guard.full(),
            guard,
            limit: Force::from_f64(force_limit_n),
            last: None,
            tripped: false,
        })
    }

    /// Runs one control period: takes the measured position, m, and the requested force on the hand, N; returns the force to
    /// command.
    ///
    /// The returned force has the direction of the requested one and at most the length `force_limit_n`. Both arguments and the
    /// result are arrays of x, y and z.
    fn tick<'py>(
        &mut self,
        py: Python<'py>,
        position_m: PyReadonlyArray1<'py, f64>,
        wanted_n: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let at = three("position_m", &position_m)?;
        let wanted = three("wanted_n", &wanted_n)?;
        Ok(array(py, self.allowed(at, wanted)))
    }

    /// Runs many control periods: takes arrays of rows (x, y, z), returns the rows of forces to command.
    fn ticks<'py>(
        &mut self,
        py: Python<'py>,
        position_m: PyReadonlyArray2<'py, f64>,
        wanted_n: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let places = rows("position_m", &position_m)?;
        let forces = rows("wanted_n", &wanted_n)?;
        if places.len() != forces.len() {
            return Err(PyValueError::new_err(format!(
                "{} positions and {} forces: give as many of each",
                places.len(),
                forces.len()
            )));
        }
        let allowed: Vec<Vec<f64>> = py.detach(|| {
            let pairs = places.into_iter().zip(forces);
            pairs
                .map(|(at, wanted)| self.allowed(at, wanted).to_vec())
                .collect()
        });
        // Without rows, `from_vec2` would make an array without columns.
        if allowed.is_empty() {
            return Ok(PyArray2::zeros(py, [0, 3], false));
        }
        Ok(PyArray2::from_vec2(py, &allowed)?)
    }

    /// Reports that the motors got the smaller force `force_n` instead of the allowed one.
    fn commanded(&mut self, force_n: PyReadonlyArray1<'_, f64>) -> PyResult<()> {
        let force = three("force_n", &force_n)?;
        let force = Vector(force.map(Force::<N>::from_f64));
        self.guard.commanded(&mut self.state, force);
        Ok(())
    }

    /// Reports that the motors were switched off, and that no call of `tick` follows until `resume`. The account is emptied,
    /// because it is unknown how long the last force acted.
    fn switched_off(&mut self) {
        self.state = VectorGuardState {
            account: self.state.account.min(Energy::zero()),
            ..VectorGuardState::default()
        };
        self.last = None;
    }

    /// Resumes the guard after the motors were switched off or after an over-speed; the account keeps its level.
    fn resume(&mut self) {
        self.last = None;
        self.tripped = false;
    }

    /// Level of the guard's account: energy in J that the hand may still get out.
    #[getter]
    fn account_j(&self) -> f64 {
        N::energy_to_f64(self.state.account.0) / PER_METRE
    }

    /// Whether the device was faster than `overspeed_m_per_s`, or near the end of the positions' range; the force is then 0 until
    /// `resume`.
    #[getter]
    fn tripped(&self) -> bool {
        self.tripped
    }
}

/// Reads a scene of three axes from JSON as the program prints it.
fn cell(scene_json: &str) -> PyResult<Cell> {
    let scene: SpaceScene = serde_json::from_str(scene_json)
        .map_err(|why| PyValueError::new_err(format!("scene of three axes: {why}")))?;
    let scene = scene
        .completed()
        .map_err(|(field, why)| PyValueError::new_err(format!("{field}: {why}")))?;
    Ok(scene.cell())
}

/// Device and hand of a scene of three axes, step by step, with a force that the caller computes.
#[pyclass(name = "SpacePlant", module = "touchstone", subclass)]
pub struct PySpacePlant {
    plant: CellPlant,
    cell: Cell,
    steps: u32,
}

fn stopped<T>(_: T) -> PyErr {
    PyOverflowError::new_err(
        "the device left the positions that its arms can reach: give smaller forces, and call reset()",
    )
}

#[pymethods]
impl PySpacePlant {
    #[new]
    fn new(scene_json: &str) -> PyResult<Self> {
        let cell = cell(scene_json)?;
        Ok(Self {
            plant: CellPlant::new(&cell).map_err(stopped)?,
            cell,
            steps: 0,
        })
    }

    /// Simulates one control period of 1 ms under a force on the hand, N. Returns the mean force that the motors gave, N.
    ///
    /// `hand_offset_m` is added to the point to which the scene's hand is pulled.
    #[pyo3(signature = (force_n, hand_offset_m=None))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        force_n: PyReadonlyArray1<'py, f64>,
        hand_offset_m: Option<PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let force_n = three("force_n", &force_n)?;
        let offset_m = match hand_offset_m {
            Some(offset) => three("hand_offset_m", &offset)?,
            None => [0.0; 3],
        };
        let crossed = self.plant.step(force_n, offset_m).map_err(stopped)?;
        self.steps += 1;
        Ok(array(py, crossed.force_n))
    }

    /// Puts device and hand back to their initial positions.
    fn reset(&mut self) -> PyResult<()> {
        self.plant = CellPlant::new(&self.cell).map_err(stopped)?;
        self.steps = 0;
        Ok(())
    }

    /// Position that the encoders measure, m: an array of x, y and z.
    #[getter]
    fn measured_m<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(array(py, self.plant.measured_m().map_err(stopped)?))
    }

    /// True position, m: an array of x, y and z.
    #[getter]
    fn position_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.plant.held().place_m())
    }

    /// Point to which the scene's hand is pulled in the coming step, m: an array of x, y and z.
    #[getter]
    fn rest_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.plant.rest_m())
    }

    /// Part of the hand's motion in the coming step: probe, hold, slide or release.
    #[getter]
    fn phase(&self) -> &'static str {
        match self.plant.motion().phase(self.plant.time_s()) {
            Phase::Probe => "probe",
            Phase::Hold => "hold",
            Phase::Slide => "slide",
            Phase::Release => "release",
        }
    }

    /// Time since the start, s.
    #[getter]
    fn time_s(&self) -> f64 {
        self.plant.time_s()
    }

    /// Control period, s.
    #[getter]
    fn period_s(&self) -> f64 {
        1.0 / f64::from(touchstone_lab::thesis::space::RATE_HZ)
    }

    /// Number of control periods that the scene lasts; more may be simulated.
    #[getter]
    fn scene_steps(&self) -> u32 {
        self.plant.motion().ticks()
    }
}

/// The wall of a scene of three axes: object, control law and, for the approach `shipped`, estimator and guard.
#[pyclass(name = "SpaceWall", module = "touchstone", subclass)]
pub struct PySpaceWall {
    wall: CellWall,
    cell: Cell,
}

fn refused(why: touchstone_control::SettingsError) -> PyErr {
    PyValueError::new_err(why.to_string())
}

#[pymethods]
impl PySpaceWall {
    #[new]
    fn new(scene_json: &str) -> PyResult<Self> {
        let cell = cell(scene_json)?;
        Ok(Self {
            wall: CellWall::new(&cell).map_err(refused)?,
            cell,
        })
    }

    /// Runs one control period: takes the measured position, m, and returns the force on the hand, N. Both are arrays of x, y and
    /// z.
    fn tick<'py>(
        &mut self,
        py: Python<'py>,
        measured_m: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(array(py, self.wall.tick(three("measured_m", &measured_m)?)))
    }

    /// Puts the wall back to its state before the first touch, with a full energy account.
    fn reset(&mut self) -> PyResult<()> {
        self.wall = CellWall::new(&self.cell).map_err(refused)?;
        Ok(())
    }

    /// Level of the guard's account, J; `None` for a wall without a guard.
    #[getter]
    fn account_j(&self) -> Option<f64> {
        self.wall.account_j()
    }

    /// Whether the device was faster than the guard's over-speed limit in the last tick; the force of such a tick is 0.
    #[getter]
    fn too_fast(&self) -> bool {
        self.wall.is_too_fast()
    }
}
