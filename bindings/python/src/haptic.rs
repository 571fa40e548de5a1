//! A haptic device as a Python class: wall and guard run in a thread of their own, which never waits for Python.

use crate::plain;
use crate::servo::{Ended, Opened, Shared, Wanted, locked, played};
use crate::space::three;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, mpsc};
use std::thread::JoinHandle;
use std::time::Duration;
use touchstone_device::{Fading, FollowerForces};
use touchstone_lab::thesis::space::Object;

/// An omega.3, an Inverse3 or a simulated device, with a wall and the energy guard in a thread of their own. THE MOTORS ARE ON
/// until `close`.
#[pyclass(name = "HapticDevice", module = "touchstone", frozen)]
pub struct PyHapticDevice {
    shared: Arc<Shared>,
    forces: FollowerForces,
    opened: Opened,
    thread: Mutex<Option<JoinHandle<Ended>>>,
    ended: Mutex<Option<Ended>>,
}

impl PyHapticDevice {
    /// Waits for the end of the thread, and keeps its result. The thread must have a reason to end: `stop` is set, or a fault
    /// occurred.
    fn wait(&self) {
        let mut thread = locked(&self.thread);
        if let Some(thread) = thread.take() {
            let ended = thread
                .join()
                .unwrap_or_else(|_| Err("the servo loop ended by a bug: report it".into()));
            *locked(&self.ended) = Some(ended);
        }
    }

    fn stopped(&self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        self.wait();
    }

    /// Collects the thread's result if the thread has ended.
    fn look(&self) {
        let over = locked(&self.thread)
            .as_ref()
            .is_some_and(JoinHandle::is_finished);
        if over {
            self.wait();
        }
    }

    fn running(&self) -> bool {
        self.look();
        locked(&self.thread).is_some()
    }
}

impl Drop for PyHapticDevice {
    fn drop(&mut self) {
        self.stopped();
    }
}

#[pymethods]
impl PyHapticDevice {
    #[new]
    #[pyo3(signature = (device, *, wall, rate_hz, stiffness_n_per_mm, force_limit_n, stale_after_s, fade_s, late_limit_s, library, service,
        hand_m, priority))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        device: String,
        wall: Option<String>,
        rate_hz: u32,
        stiffness_n_per_mm: Option<f64>,
        force_limit_n: Option<f64>,
        stale_after_s: f64,
        fade_s: f64,
        late_limit_s: f64,
        library: Option<String>,
        service: Option<String>,
        hand_m: Option<PyReadonlyArray1<'_, f64>>,
        priority: bool,
    ) -> PyResult<Self> {
        let refused = |text: String| Err(PyValueError::new_err(text));
        if !["omega3", "inverse3", "simulated"].contains(&device.as_str()) {
            return refused(format!(
                "device = {device:?}: give \"omega3\", \"inverse3\" or \"simulated\""
            ));
        }
        let object = match wall.as_deref() {
            None => None,
            Some("plane") => Some(Object::Horizontal),
            Some("inclined") => Some(Object::Inclined),
            Some("sphere") => Some(Object::Sphere),
            Some(other) => {
                return refused(format!(
                    "wall = {other:?}: give \"plane\", \"inclined\", \"sphere\" or None"
                ));
            }
        };
        if !(100..=10_000).contains(&rate_hz) {
            return refused(format!("rate_hz = {rate_hz}: give 100 to 10000"));
        }
        let ranges = [
            ("stiffness_n_per_mm", stiffness_n_per_mm, 50.0),
            ("force_limit_n", force_limit_n, 100.0),
            ("late_limit_s", Some(late_limit_s), 1.0),
        ];
        for (name, value, most) in ranges {
            if value.is_some_and(|value| !(value > 0.0 && value <= most)) {
                let value = value.unwrap_or_default();
                return refused(format!("{name} = {value}: give above 0 and at most {most}"));
            }
        }
        for (name, value) in [("stale_after_s", stale_after_s), ("fade_s", fade_s)] {
            if !(0.0..=1.0).contains(&value) {
                return refused(format!("{name} = {value}: give 0 to 1 s"));
            }
        }
        let hand = hand_m.map(|place| three("hand_m", &place)).transpose()?;
        let wanted = Wanted {
            device,
            object,
            rate_hz,
            stiffness_n_per_mm,
            force_limit_n,
            fading: Fading {
                whole_s: stale_after_s,
                fade_s,
            },
            late_limit_s,
            library,
            service,
            hand,
            priority,
        };
        let (shared, forces) = (Arc::new(Shared::default()), FollowerForces::default());
        let (tell, heard) = mpsc::channel();
        let thread = {
            let (shared, forces) = (Arc::clone(&shared), forces.clone());
            // The device is opened in the thread that drives it.
            std::thread::Builder::new()
                .name("touchstone-servo".into())
                .spawn(move || played(&wanted, forces, &shared, &tell))
                .map_err(|why| PyRuntimeError::new_err(format!("no thread: {why}")))?
        };
        // Without a message, the thread ended before its first control period.
        match py.detach(move || heard.recv()) {
            Ok(opened) => Ok(Self {
                shared,
                forces,
                opened,
                thread: Mutex::new(Some(thread)),
                ended: Mutex::new(None),
            }),
            Err(_) => {
                let ended = py.detach(|| thread.join());
                let why = match ended {
                    Ok(Err(why)) => why,
                    _ => "the servo loop ended by a bug: report it".to_owned(),
                };
                Err(PyRuntimeError::new_err(why))
            }
        }
    }

    /// Replaces the follower's force on the hand, N, which is `age_s` old.
    #[pyo3(signature = (force_n, age_s=0.0))]
    fn send_force(&self, force_n: PyReadonlyArray1<'_, f64>, age_s: f64) -> PyResult<()> {
        let force_n = three("force_n", &force_n)?;
        let age_s = plain("age_s", age_s)?;
        let age = Duration::try_from_secs_f64(age_s)
            .map_err(|_| PyValueError::new_err(format!("age_s = {age_s}: give at least 0 s")))?;
        // Limited to 3 s: a force of this age has faded to 0 in any case (`stale_after_s` and `fade_s` are at most 1 s each).
        let taken = self.forces.send(force_n, age.min(Duration::from_secs(3)));
        debug_assert!(taken, "its components are finite");
        Ok(())
    }

    /// Position of the handle in the last control period, m: an array of x, y and z.
    #[getter]
    fn position_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &locked(&self.shared.seen).position_m)
    }

    /// Force on the hand in the last control period, N: an array of x, y and z; 0 once the loop has ended.
    #[getter]
    fn force_n<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let force_n = match self.running() {
            true => locked(&self.shared.seen).force_n,
            false => [0.0; 3],
        };
        PyArray1::from_slice(py, &force_n)
    }

    /// Energy in the guard's account, J: what the hand may still get out.
    #[getter]
    fn account_j(&self) -> f64 {
        locked(&self.shared.seen).account_j
    }

    /// Number of control periods so far.
    #[getter]
    fn ticks(&self) -> u64 {
        locked(&self.shared.seen).ticks
    }

    /// Whether the motors are on.
    #[getter]
    fn is_running(&self) -> bool {
        self.running()
    }

    /// Why the loop ended without `close`; `None` while it runs, and after a `close` that succeeded.
    #[getter]
    fn fault(&self) -> Option<String> {
        self.look();
        match &*locked(&self.ended) {
            Some(Err(fault)) => Some(fault.clone()),
            _ => None,
        }
    }

    /// Number of control periods that were skipped because the loop was late, and the largest lateness, s. `None` while the loop
    /// runs and after a fault.
    #[getter]
    fn lateness(&self) -> Option<(u64, f64)> {
        self.look();
        match &*locked(&self.ended) {
            Some(Ok(report)) => Some((report.missed_ticks, report.lateness.worst_s())),
            _ => None,
        }
    }

    /// Name of the device.
    #[getter]
    fn name(&self) -> &str {
        &self.opened.name
    }

    /// Control rate, Hz.
    #[getter]
    fn rate_hz(&self) -> u32 {
        self.opened.rate_hz
    }

    /// Largest force, N.
    #[getter]
    fn force_limit_n(&self) -> f64 {
        self.opened.force_limit_n
    }

    /// Description of the wall: object, stiffness, source of its settings.
    #[getter]
    fn wall(&self) -> &str {
        &self.opened.wall
    }

    /// Ends the loop, and waits until force and motors are off. Returns why the motors may still be on, or why the loop had ended
    /// before; `None` if all went well.
    fn close(&self, py: Python<'_>) -> Option<String> {
        py.detach(|| self.stopped());
        self.fault()
    }
}
