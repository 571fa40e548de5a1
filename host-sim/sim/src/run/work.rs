//! Estimates the computing time of a run before it starts, from ticks and plant steps per tick, and names the setting that causes
//! it.

use super::crossed;
use super::train::Train;
use crate::error::Result;
use crate::scene::{Integrator, Scene};
use touchstone_world::plant::HeldCoulomb;

/// Computing time for one tick (control period) without its plant steps, on a slow machine, s. It covers sensor, control law and
/// record.
const TICK_S: f64 = 0.5e-6;
/// Computing time for one substep of a drive train or of an integration method, on a slow machine, s. A fast machine needs a
/// seventh.
const SUBSTEP_S: f64 = 0.35e-6;
/// Computing time of one power series, on a slow machine, s. A control period in which dry friction stops or starts the device needs
/// at least one, and one more for each stop or start.
const SERIES_S: f64 = 2.0e-6;
/// Computing time above which a note is printed before the run starts, s.
pub const LONG_S: f64 = 1.0;
/// Estimated computing time above which a run is refused, s: one day.
pub const MOST_S: f64 = 86_400.0;
/// Longest trace that is kept, in ticks (control periods). Its fourteen columns take 2.2 GB of memory.
pub const MOST_OF_TRACE: u64 = 20_000_000;

/// Estimated computing time of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Work {
    /// Number of ticks (control periods) in the run.
    pub ticks: u64,
    /// Largest number of plant steps per tick (control period).
    pub steps: u64,
    /// Estimated computing time on a slow machine, s. A fast machine needs a third of it.
    pub seconds: f64,
    /// Field of the scene that causes most of the computing time.
    path: &'static str,
    /// Explanation why the field causes the computing time.
    reason: Option<String>,
}

impl Work {
    /// Estimates the computing time of a scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let (steps, step_s, cause) = steps(scene);
        let ticks = scene.timing.ticks();
        // With few plant steps per tick, the number of ticks causes most of the cost.
        let (path, reason) = cause
            .filter(|_| steps > 32)
            .map_or(("timing.duration_s", None), |(path, reason)| {
                (path, Some(reason))
            });
        Self {
            ticks,
            steps,
            seconds: ticks as f64 * (TICK_S + step_s * steps as f64),
            path,
            reason,
        }
    }

    /// Whether the run may take so long that a note is printed before it starts.
    #[must_use]
    pub fn is_long(&self) -> bool {
        self.seconds > LONG_S
    }

    /// Note with the estimated computing time and its cause, for a run that [takes long](Self::is_long); else `None`.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        self.is_long().then(|| {
            let path = self.path;
            let why = match &self.reason {
                Some(reason) => format!(" ({path}: {reason})"),
                None => String::new(),
            };
            format!(
                "a run of this scene may take {}: {}{why}",
                spoken(self.seconds),
                self.counted()
            )
        })
    }

    /// Refuses a run that may take longer than [`MOST_S`].
    ///
    /// # Errors
    /// The field of the scene that causes the cost, the estimated time, and a remedy.
    pub fn check(&self, scene: &Scene) -> Result<()> {
        if self.seconds <= MOST_S {
            return Ok(());
        }
        let problem = match &self.reason {
            Some(reason) => format!(
                "{} may take {}: {reason}",
                self.counted(),
                spoken(self.seconds)
            ),
            None => format!("{} may take {}", self.counted(), spoken(self.seconds)),
        };
        let fix = match self.path {
            "timing.duration_s" => {
                "shorten it, or lower timing.rate_hz; the limit is a day of computing"
            }
            "plant.substeps" => {
                "give fewer, or shorten timing.duration_s; the limit is a day of computing"
            }
            _ => {
                "give a smaller value, set plant.substeps, or shorten timing.duration_s; the limit is a day of computing"
            }
        };
        Err(scene.error(self.path, problem, fix))
    }

    /// Refuses a trace of more than [`MOST_OF_TRACE`] ticks, which memory would not hold.
    ///
    /// # Errors
    /// The length of the trace and the longest that is allowed.
    pub fn check_trace(&self, scene: &Scene) -> Result<()> {
        if self.ticks <= MOST_OF_TRACE {
            return Ok(());
        }
        let problem = format!(
            "a trace of {} control periods is longer than the limit of {MOST_OF_TRACE}",
            self.ticks
        );
        let most_s = MOST_OF_TRACE as f64 / f64::from(scene.timing.rate_hz);
        let fix = format!("give at most {most_s}, or run it without --out");
        Err(scene.error("timing.duration_s", problem, fix))
    }

    fn counted(&self) -> String {
        match self.steps {
            1 => format!("{} ticks", self.ticks),
            steps => format!("{} ticks of {steps} steps", self.ticks),
        }
    }
}

/// Writes a duration in words, rounded to two digits.
fn spoken(seconds: f64) -> String {
    let (number, unit) = match seconds {
        s if s < 100.0 => (s, "s"),
        s if s < 6000.0 => (s / 60.0, "min"),
        s if s < 172_800.0 => (s / 3600.0, "h"),
        s => (s / 86_400.0, "days"),
    };
    match number < 10.0 {
        true => format!("{number:.1} {unit}"),
        false => format!("{number:.0} {unit}"),
    }
}

/// Returns the largest number of plant steps per tick, the computing time of one step in s, and the field and reason for the
/// number. Field and reason are `None` if nothing but delay or jitter divides the tick.
fn steps(scene: &Scene) -> (u64, f64, Option<(&'static str, String)>) {
    let parts = crossed::parts(scene);
    if let Some(train) = Train::of(scene) {
        let cause = train.cause.zip(train.reasons.first().cloned());
        return (u64::from(train.substeps) + parts - 1, SUBSTEP_S, cause);
    }
    if let Some(plant) = &scene.plant
        && plant.integrator != Integrator::Exact
    {
        let cause = ("plant.substeps", "as many as it says".to_owned());
        return (
            u64::from(plant.substeps) + parts - 1,
            SUBSTEP_S,
            Some(cause),
        );
    }
    if let (Some(hand), true) = (crossed::hand(scene), scene.device.friction.is_some()) {
        let device = crossed::device(scene);
        let series = HeldCoulomb::series(&device, &hand, scene.timing.period_s());
        let path = match scene.operator.hand {
            Some(_) => "operator.hand.pad_stiffness_n_m_per_rad",
            None => "device.inertia_kg_m2",
        };
        let reason = format!(
            "device and fingertip pad move so fast within a control period that friction needs {series} series"
        );
        // For a plant that is not stiff, nearly every tick is one product with a matrix.
        let step_s = if series > 2 { SERIES_S } else { SUBSTEP_S };
        return (series + parts - 1, step_s, Some((path, reason)));
    }
    (parts, SUBSTEP_S, None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{run, simulate};
    use crate::scene::{Preset, feels, names};

    fn of(name: &str, sets: &[&str]) -> Scene {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        let scene = Scene::load(name).unwrap().with_preset(Preset::Shipped);
        scene.unwrap().with_overrides(&sets).unwrap()
    }

    #[test]
    fn no_shipped_scene_is_long() {
        for name in names().into_iter().chain(feels()) {
            let scene = Scene::load(name).unwrap();
            let work = Work::of(&scene);
            assert!(work.note().is_none(), "{name}: {work:?}");
            work.check(&scene).unwrap();
            work.check_trace(&scene).unwrap();
        }
    }

    #[test]
    fn long_work_is_said_with_what_asks_for_it() {
        let stiff = "device.friction.bristle_stiffness_n_m_per_rad=1e6";
        let note = Work::of(&of("thesis-knob", &[stiff])).note().unwrap();
        assert!(
            note.contains("bristle_stiffness_n_m_per_rad: bristles of friction at")
                && note.contains(" steps"),
            "{note}"
        );
        let asked = ["plant.integrator=runge-kutta-4", "plant.substeps=9000"];
        let note = Work::of(&of("thesis-knob", &asked)).note().unwrap();
        assert!(
            note.contains("(plant.substeps: as many as it says)"),
            "{note}"
        );
        let hour = Work::of(&of("thesis-knob", &["timing.duration_s=3600"]));
        assert!(hour.note().unwrap().ends_with(" ticks"), "{hour:?}");
    }

    #[test]
    fn more_than_a_day_is_refused_in_a_line_before_it_begins() {
        let day = "timing.duration_s=86400";
        for (more, place) in [
            (
                "device.friction.bristle_stiffness_n_m_per_rad=1e7",
                "device.friction.bristle",
            ),
            ("plant.substeps=100000", "plant.substeps"),
        ] {
            let asked = [day, more, "device.cogging.torque_n_m=1e-3"];
            let error = simulate(&of("thesis-knob", &asked), None)
                .unwrap_err()
                .to_string();
            assert!(
                error.contains(place) && error.contains(" may take "),
                "{error}"
            );
            assert_eq!(error.lines().count(), 1, "{error}");
        }
        // A simulated day of an ordinary knob takes only minutes, but its trace is too long.
        let scene = of("thesis-knob", &[day]);
        Work::of(&scene).check(&scene).unwrap();
        let error = run(&scene, true).unwrap_err().to_string();
        assert!(
            error.contains("86400000 control periods") && error.contains("--out"),
            "{error}"
        );
    }
}
