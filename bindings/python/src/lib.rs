//! The energy guard and the virtual wall as Python classes. Methods run one control period, or many for whole arrays.

mod haptic;
mod scene_halves;
mod servo;
mod space;

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use touchstone_control::{
    ChangeOfForce, Choice as _, Controller, CountScale, Fixed32, Force, Guard, GuardSettings,
    Guarded, GuardedDevice, NotSet, Number, Position, PositionSettings, Settings, Si,
};

/// Converts a Python number to the value of a setting; `name` names the setting in the error.
fn si(name: &str, value: f64) -> PyResult<Si> {
    Si::checked_from_num(value).ok_or_else(|| {
        PyValueError::new_err(format!("{name} = {value}: give a finite number below 2e9"))
    })
}

/// Converts a Python number like [`si`], or returns `default` if there is none.
fn or(name: &str, value: Option<f64>, default: Si) -> PyResult<Si> {
    value.map_or(Ok(default), |it| si(name, it))
}

/// Checks that a Python number is finite; `name` names it in the error.
fn plain(name: &str, value: f64) -> PyResult<f64> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(PyValueError::new_err(format!(
        "{name} = {value}: give a finite number"
    )))
}

/// Converts a position in rad (m) to fixed point, rounded to the nearest 2^-24; it saturates at ±128.
fn position(value: f64) -> PyResult<Position<Fixed32>> {
    Ok(Position(Fixed32::saturating_signal(finite(
        "a position",
        value,
    )?)))
}

/// Converts a torque in N·m (force in N) to fixed point, rounded to the nearest 2^-24; it saturates at ±128.
fn force(value: f64) -> PyResult<Force<Fixed32>> {
    Ok(Force(Fixed32::saturating_signal(finite("a force", value)?)))
}

fn finite(what: &str, value: f64) -> PyResult<Si> {
    if value.is_nan() {
        return Err(PyValueError::new_err(format!("{what} is not a number")));
    }
    Ok(Si::saturating_from_num(value))
}

/// Converts a fixed-point value to a Python number. Positions and forces convert exactly, because they have 24 fractional bits.
fn number(value: impl Into<Si>) -> f64 {
    value.into().to_num()
}

/// Bounds the energy that a hand can get out of a haptic device, whatever force the control law requests.
///
/// Beyond what it put in and the device's kinetic energy, the hand gets at most `capacity_j + refill_w * time`, and half an encoder
/// count times the largest force. This holds if the device has the stated damping, encoder and delay, and its motor gives the
/// commanded torque. Units are rad and N·m; with m and N the same numbers serve a linear device.
#[pyclass(name = "Guard", module = "touchstone")]
struct PyGuard {
    inner: Guarded<Fixed32>,
    /// The largest force of the motor. A motor that gives less than the commanded force would break the bound.
    limit: Force<Fixed32>,
    /// Whether every tick needs the displacement before the change of force. Without it the guard would count the whole displacement
    /// under the new force, and the bound would not hold.
    change_is_measured: bool,
}

impl PyGuard {
    /// Converts a requested force, limited to what the motor can give.
    fn wanted(limit: Force<Fixed32>, value: f64) -> PyResult<Force<Fixed32>> {
        Ok(Force(force(value)?.0.clamp(-limit.0, limit.0)))
    }
}

#[pymethods]
impl PyGuard {
    #[new]
    #[pyo3(signature = (*, rate_hz, force_limit_n_m, count_rad, damping_n_m_s_per_rad, delay_s, share_of_damping=None, capacity_j=None,
        refill_w=None, overspeed_rad_per_s=None, lag_s=0.0, change_is_measured=false))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        rate_hz: u32,
        force_limit_n_m: f64,
        count_rad: f64,
        damping_n_m_s_per_rad: f64,
        delay_s: f64,
        share_of_damping: Option<f64>,
        capacity_j: Option<f64>,
        refill_w: Option<f64>,
        overspeed_rad_per_s: Option<f64>,
        lag_s: f64,
        change_is_measured: bool,
    ) -> PyResult<Self> {
        let shipped = GuardSettings::default();
        let settings = GuardSettings {
            on: true,
            capacity: or("capacity_j", capacity_j, shipped.capacity)?,
            refill: or("refill_w", refill_w, shipped.refill)?,
            damping: si("damping_n_m_s_per_rad", damping_n_m_s_per_rad)?,
            share_of_damping: or(
                "share_of_damping",
                share_of_damping,
                shipped.share_of_damping,
            )?,
            overspeed: or(
                "overspeed_rad_per_s",
                overspeed_rad_per_s,
                shipped.overspeed,
            )?,
            delay: si("delay_s", delay_s)?,
            lag: si("lag_s", lag_s)?,
            change: if change_is_measured {
                ChangeOfForce::Measured
            } else {
                ChangeOfForce::Estimated
            },
        };
        let device = GuardedDevice {
            rate_hz,
            force_limit: si("force_limit_n_m", force_limit_n_m)?,
            count: si("count_rad", count_rad)?,
        };
        let guard = Guard::new(&settings, &device)
            .map_err(|problem| PyValueError::new_err(problem.to_string()))?;
        Ok(Self {
            inner: Guarded::new(guard),
            limit: force(force_limit_n_m)?,
            change_is_measured,
        })
    }

    /// Runs one control period: takes the displacement since the last call and the requested force, returns the force to command.
    ///
    /// A force that resists a positive motion is positive. The returned force is at most `force_limit_n_m`. `before_change_rad` is
    /// for an encoder that is read a second time, when the last force begins to act: it is the part of `moved_rad` before that
    /// moment. Give it in every tick of a guard with `change_is_measured`, and to no other guard.
    #[pyo3(signature = (moved_rad, wanted_n_m, before_change_rad=None))]
    fn tick(
        &mut self,
        moved_rad: f64,
        wanted_n_m: f64,
        before_change_rad: Option<f64>,
    ) -> PyResult<f64> {
        let before = match (before_change_rad, self.change_is_measured) {
            (None, true) => {
                return Err(PyValueError::new_err(
                    "before_change_rad is missing, and the guard has change_is_measured=True: give it, or make the guard without",
                ));
            }
            (Some(before), false) => {
                return Err(PyValueError::new_err(format!(
                    "before_change_rad = {before}, but the guard does not use it: make the guard with change_is_measured=True"
                )));
            }
            (before, _) => position(before.unwrap_or(0.0))?,
        };
        let moved = position(moved_rad)?;
        let wanted = Self::wanted(self.limit, wanted_n_m)?;
        let allowed = self.inner.moved(moved, before, wanted);
        Ok(number(allowed.0))
    }

    /// Runs many control periods: takes arrays of displacements and requested forces, returns an array of the forces to command.
    /// Not for a guard with `change_is_measured`.
    fn ticks<'py>(
        &mut self,
        py: Python<'py>,
        moved_rad: PyReadonlyArray1<'py, f64>,
        wanted_n_m: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        if self.change_is_measured {
            return Err(PyValueError::new_err(
                "ticks takes no before_change_rad, and the guard has change_is_measured=True: call tick, or make the guard without",
            ));
        }
        let (moved, wanted) = (moved_rad.as_slice()?, wanted_n_m.as_slice()?);
        if moved.len() != wanted.len() {
            return Err(PyValueError::new_err(format!(
                "{} displacements and {} forces: give as many of each",
                moved.len(),
                wanted.len()
            )));
        }
        // All values are checked before the first tick, so that a refused call changes nothing.
        let pairs: Vec<_> = moved
            .iter()
            .zip(wanted)
            .map(|(moved, wanted)| Ok((position(*moved)?, Self::wanted(self.limit, *wanted)?)))
            .collect::<PyResult<_>>()?;
        let guard = &mut self.inner;
        let allowed: Vec<f64> = py.detach(|| {
            pairs
                .into_iter()
                .map(|(moved, wanted)| number(guard.moved(moved, Position::zero(), wanted).0))
                .collect()
        });
        Ok(PyArray1::from_vec(py, allowed))
    }

    /// Reports that the motor got the smaller force `force_n_m` instead of the allowed one.
    fn commanded(&mut self, force_n_m: f64) -> PyResult<()> {
        self.inner.commanded(force(force_n_m)?);
        Ok(())
    }

    /// Reports that the motor was switched off, and that no call of `tick` follows until `resume`.
    fn switched_off(&mut self) {
        self.inner.switched_off();
    }

    /// Resumes the energy guard after the motor was switched off or after an over-speed; the energy account keeps its level.
    fn resume(&mut self) {
        self.inner = Guarded::new(self.inner.guard).resumed(&self.inner);
    }

    /// Level of the energy guard's account: energy in J that the hand may still get out.
    #[getter]
    fn account_j(&self) -> f64 {
        self.inner.account().0.to_num()
    }

    /// Whether the device was faster than `overspeed_rad_per_s`; the allowed force is then 0 until `resume`.
    #[getter]
    fn tripped(&self) -> bool {
        self.inner.tripped
    }
}

/// A whole virtual wall: velocity estimator, control law and energy guard. It computes in the firmware's fixed-point arithmetic,
/// with results equal to the last bit.
#[pyclass(name = "Wall", module = "touchstone", subclass)]
struct PyWall {
    inner: Controller<Fixed32>,
    settings: Settings,
    scale: CountScale,
}

#[pymethods]
impl PyWall {
    #[new]
    #[pyo3(signature = (settings=None, *, counts_per_rev=40_000, surface_rad=0.0, preset="shipped"))]
    fn new(
        settings: Option<Vec<(String, String)>>,
        counts_per_rev: u32,
        surface_rad: f64,
        preset: &str,
    ) -> PyResult<Self> {
        let mut made = match preset {
            "shipped" => Settings::default(),
            "thesis" => Settings::thesis(),
            _ => {
                return Err(PyValueError::new_err(format!(
                    "preset = {preset:?}: give \"shipped\" or \"thesis\""
                )));
            }
        };
        for (path, text) in settings.unwrap_or_default() {
            made.set_by_path(&path, &text).map_err(|why| {
                PyValueError::new_err(match why {
                    NotSet::UnknownPath => {
                        format!("{path}: no such setting; `touchstone config schema` lists them")
                    }
                    _ => format!("{path} = {text}: no value of this setting"),
                })
            })?;
        }
        let scale = CountScale::new(counts_per_rev, si("surface_rad", surface_rad)?)
            .ok_or_else(|| PyValueError::new_err("counts_per_rev = 0: give at least 1"))?;
        made.position = PositionSettings::of_counts_per_rev(counts_per_rev);
        let inner =
            Controller::new(&made).map_err(|problem| PyValueError::new_err(problem.to_string()))?;
        // Without a second position the guard would count every displacement under the new force, and its bound would not hold.
        if made.guard.on && made.guard.change == ChangeOfForce::Measured {
            return Err(PyValueError::new_err(
                "law.guard.change = measured: a Wall gets one position a tick, so the energy bound would fail; give \"estimated\"",
            ));
        }
        Ok(Self {
            inner,
            settings: made,
            scale,
        })
    }

    /// Runs one control period: takes the penetration in rad, positive inside the wall, and returns the force in N·m that pushes
    /// out.
    fn tick(&mut self, penetration_rad: f64) -> PyResult<f64> {
        Ok(number(self.inner.tick(position(penetration_rad)?).0))
    }

    /// Runs one control period: takes an encoder count, and returns the torque to command until the next call, N·m along the angle.
    fn tick_count(&mut self, count: i64) -> f64 {
        let penetration = self.scale.penetration(count);
        -number(self.inner.tick(penetration).0)
    }

    /// Runs many control periods: takes an array of penetrations in rad, returns an array of forces in N·m that push out.
    fn ticks<'py>(
        &mut self,
        py: Python<'py>,
        penetration_rad: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let places: Vec<_> = penetration_rad
            .as_slice()?
            .iter()
            .map(|place| position(*place))
            .collect::<PyResult<_>>()?;
        let wall = &mut self.inner;
        let forces: Vec<f64> = py.detach(|| {
            places
                .into_iter()
                .map(|place| number(wall.tick(place).0))
                .collect()
        });
        Ok(PyArray1::from_vec(py, forces))
    }

    /// Reports to the wall's estimator and energy guard that the motor got the smaller force `force_n_m` instead of the wall's.
    fn commanded(&mut self, force_n_m: f64) -> PyResult<()> {
        self.inner.commanded(force(force_n_m)?);
        Ok(())
    }

    /// Reports that the motor was switched off, and that no call of `tick` follows until `resume`.
    fn switched_off(&mut self) {
        self.inner.switched_off();
    }

    /// Resumes the wall after the motor was switched off. Estimator and control law start anew; the energy guard's account keeps
    /// its level.
    fn resume(&mut self) -> PyResult<()> {
        let fresh = Controller::new(&self.settings)
            .map_err(|problem| PyRuntimeError::new_err(problem.to_string()))?;
        self.inner.resume(&fresh);
        Ok(())
    }

    /// Level of the energy guard's account: energy in J that the hand may still get out; `None` if the guard is off.
    #[getter]
    fn account_j(&self) -> Option<f64> {
        self.inner
            .guard
            .as_ref()
            .map(|guard| guard.account().0.to_num())
    }

    /// Whether the energy guard has switched the force off because the device was too fast.
    #[getter]
    fn tripped(&self) -> bool {
        self.inner.tripped()
    }

    /// Name of the control law.
    #[getter]
    fn law(&self) -> &'static str {
        self.settings.law.word()
    }

    /// Descriptions of the passivity conditions (bounds on stiffness and damping) that the settings violate.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.settings.warnings().map(|it| it.to_string()).collect()
    }
}

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyGuard>()?;
    module.add_class::<PyWall>()?;
    module.add_class::<scene_halves::PyPlant>()?;
    module.add_class::<scene_halves::PyLaw>()?;
    module.add_class::<space::PySpaceGuard>()?;
    module.add_class::<space::PySpacePlant>()?;
    module.add_class::<space::PySpaceWall>()?;
    module.add_class::<haptic::PyHapticDevice>()?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}
