//! What an FMU calculates: the half of a scene, stepped from outside, with its variables.

use crate::description::token;
use crate::variables::{self, Causality, Name, Variable};
use crate::{Half, MARK};
use std::path::Path;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::input;
use touchstone_sim::run::chain::Control;
use touchstone_sim::run::plan;
use touchstone_sim::run::plant_half::PlantHalf;
use touchstone_sim::scene::{RestPath, Scene};

/// An instance of an FMU: one half of a scene's control loop, with the present values of its variables.
pub struct Model {
    scene: Scene,
    half: Half,
    running: Running,
    values: Values,
    /// Time at which the first step begins, s.
    start_s: f64,
    /// Number of ticks (control periods) since the start.
    ticks: u64,
}

enum Running {
    Law(Box<dyn Control>),
    Plant(Box<PlantHalf>),
}

/// Present values of all variables of both halves.
#[derive(Debug, Clone, Copy, Default)]
struct Values {
    time_s: f64,
    angle_rad: f64,
    change_rad: f64,
    /// Whether the importing program gave the angle at which the torque changed.
    has_change: bool,
    torque_n_m: f64,
    penetration_rad: f64,
    account_j: f64,
    is_limited: bool,
    is_tripped: bool,
    offset_rad: f64,
    velocity_rad_per_s: f64,
    hand_rad: f64,
    absorbed_j: f64,
}

/// Largest difference between a step and a whole number of periods that counts as rounding, in periods.
const ROUNDING: f64 = 1e-3;

/// The longest step, in periods. It bounds the computing time of a call with a wrong step.
const MOST_TICKS: f64 = 1e6;

impl Model {
    /// Makes the instance of an FMU from the folder of its resources.
    ///
    /// # Errors
    /// The folder has no scene, or one that cannot run; the token is that of another description.
    pub fn open(resources: &Path, given: &str) -> Result<Self> {
        let scenes = Half::ALL.map(|half| (half, resources.join(half.scene_file())));
        let Some((half, file)) = scenes.into_iter().find(|(_, file)| file.is_file()) else {
            return Err(refused(
                resources.display().to_string(),
                "there is neither law.toml nor plant.toml".to_owned(),
                "give the folder `resources` of the unpacked FMU as resourcePath",
            ));
        };
        let text = input::text(&file, input::MOST_OF_SCENE).map_err(|error| Error::Io {
            path: file.clone(),
            problem: error.to_string(),
            fix: "unpack the FMU again".to_owned(),
        })?;
        if given != token(&text, half) {
            return Err(refused(
                "instantiationToken".to_owned(),
                format!("{given} is not that of this scene and of {MARK}"),
                "export the FMU again",
            ));
        }
        Self::of(Scene::parse(&text, &file)?, half)
    }

    /// Makes the instance of one half of a scene.
    ///
    /// # Errors
    /// The scene cannot run.
    pub fn of(scene: Scene, half: Half) -> Result<Self> {
        let running = match half {
            Half::Law => Running::Law(plan::control(&scene)?),
            Half::Plant => Running::Plant(Box::new(PlantHalf::new(&scene)?)),
        };
        let start = plan::start(&scene, &RestPath::from_scene(&scene)?);
        let values = Values {
            angle_rad: start.angle_rad,
            change_rad: start.angle_rad,
            velocity_rad_per_s: start.velocity_rad_per_s,
            hand_rad: start.hand_rad,
            account_j: scene.law.guard.capacity_j,
            ..Values::default()
        };
        Ok(Self {
            scene,
            half,
            running,
            values,
            start_s: 0.0,
            ticks: 0,
        })
    }

    /// The half of the scene that the instance calculates.
    #[must_use]
    pub fn half(&self) -> Half {
        self.half
    }

    /// Starts anew, with the initial values of all variables.
    ///
    /// # Errors
    /// Same as [`Model::of`].
    pub fn reset(&mut self) -> Result<()> {
        *self = Self::of(self.scene.clone(), self.half)?;
        Ok(())
    }

    /// Sets the time at which the first step begins, s.
    ///
    /// # Errors
    /// The time is not a finite number.
    pub fn start_at(&mut self, start_s: f64) -> Result<()> {
        self.start_s = finite("startTime", start_s)?;
        self.values.time_s = start_s;
        Ok(())
    }

    fn variable(&self, number: u32) -> Result<&'static Variable> {
        let found = variables::of(&self.scene, self.half).find(|it| it.name as u32 == number);
        found.ok_or_else(|| {
            refused(
                format!("value reference {number}"),
                "this FMU has no such variable".to_owned(),
                "give one of modelDescription.xml",
            )
        })
    }

    /// Reads a number.
    ///
    /// # Errors
    /// There is no such number.
    pub fn number(&self, reference: u32) -> Result<f64> {
        let variable = self.variable(reference)?;
        let values = &self.values;
        Ok(match variable.name {
            Name::Time => values.time_s,
            Name::MeasuredAngle | Name::Angle => values.angle_rad,
            Name::MeasuredChange | Name::Change => values.change_rad,
            Name::Torque | Name::Command => values.torque_n_m,
            Name::Penetration => values.penetration_rad,
            Name::Account => values.account_j,
            Name::HandOffset => values.offset_rad,
            Name::Velocity => values.velocity_rad_per_s,
            Name::Hand => values.hand_rad,
            Name::Absorbed => values.absorbed_j,
            Name::Limited | Name::Tripped => return Err(other_type(variable, "Float64")),
        })
    }

    /// Reads a truth value.
    ///
    /// # Errors
    /// There is no such truth value.
    pub fn truth(&self, reference: u32) -> Result<bool> {
        let variable = self.variable(reference)?;
        match variable.name {
            Name::Limited => Ok(self.values.is_limited),
            Name::Tripped => Ok(self.values.is_tripped),
            _ => Err(other_type(variable, "Boolean")),
        }
    }

    /// Sets an input.
    ///
    /// # Errors
    /// There is no such input; the value is not a finite number.
    pub fn set(&mut self, reference: u32, value: f64) -> Result<()> {
        let variable = self.variable(reference)?;
        if variable.causality != Causality::Input {
            return Err(refused(
                variable.text.to_owned(),
                "it is not an input".to_owned(),
                "set inputs only",
            ));
        }
        let value = finite(variable.text, value)?;
        let values = &mut self.values;
        match variable.name {
            Name::MeasuredAngle => values.angle_rad = value,
            Name::MeasuredChange => {
                values.change_rad = value;
                values.has_change = true;
            }
            Name::Command => values.torque_n_m = value,
            Name::HandOffset => values.offset_rad = value,
            _ => {}
        }
        Ok(())
    }

    /// Number of ticks (control periods) of a step.
    ///
    /// # Errors
    /// The step does not begin where the last one ended, or is not a whole number of periods from 1 to 1,000,000.
    pub fn ticks_of(&self, begins_s: f64, step_s: f64) -> Result<u64> {
        let rate_hz = f64::from(self.scene.timing.rate_hz);
        let begins = (finite("currentCommunicationPoint", begins_s)? - self.start_s) * rate_hz;
        // The importing program may add up step sizes, so that its clock drifts. A quarter of a period of drift is accepted.
        if (begins - self.ticks as f64).abs() > 0.25 {
            return Err(refused(
                format!("currentCommunicationPoint = {begins_s}"),
                format!("the last step ended at {}", self.now_s()),
                "go on from there",
            ));
        }
        let ticks = finite("communicationStepSize", step_s)? * rate_hz;
        let whole = ticks.round();
        if (ticks - whole).abs() > ROUNDING || !(1.0..=MOST_TICKS).contains(&whole) {
            return Err(refused(
                format!("communicationStepSize = {step_s}"),
                "it is not a whole number of control periods".to_owned(),
                &format!("give {:?} s", self.scene.timing.period_s()),
            ));
        }
        Ok(whole as u64)
    }

    /// Whether the law is about to step without the angle at which the torque changed, on which the scene's guard relies. The guard
    /// then counts every torque as acting from the sample on, and its energy bound does not hold.
    #[must_use]
    pub fn lacks_change(&self) -> bool {
        // Before the first tick no torque has changed.
        let is_expected = self.half == Half::Law && self.ticks > 0;
        is_expected && !self.values.has_change && plan::tells_change(&self.scene)
    }

    /// Present time, s.
    #[must_use]
    pub fn now_s(&self) -> f64 {
        self.start_s + self.ticks as f64 * self.scene.timing.period_s()
    }

    /// Simulates ticks (control periods); the inputs stay as they are.
    ///
    /// # Errors
    /// Angle, velocity or energy of the device is not a finite number, after a huge torque.
    pub fn step(&mut self, ticks: u64) -> Result<()> {
        for _ in 0..ticks {
            self.tick();
        }
        let values = &mut self.values;
        values.time_s = self.start_s + self.ticks as f64 * self.scene.timing.period_s();
        let moved = [
            values.angle_rad,
            values.velocity_rad_per_s,
            values.hand_rad,
            values.absorbed_j,
        ];
        if moved.into_iter().all(f64::is_finite) {
            return Ok(());
        }
        Err(refused(
            "fmi3DoStep".to_owned(),
            format!("the device is at {} rad", values.angle_rad),
            "give a smaller torque, and start again with fmi3Reset",
        ))
    }

    fn tick(&mut self) {
        let values = &mut self.values;
        match &mut self.running {
            Running::Law(control) => {
                // Before the first tick no torque has changed.
                if values.has_change && self.ticks > 0 {
                    control.changed_at(values.change_rad);
                }
                let answer = control.answer(values.angle_rad);
                values.torque_n_m = answer.torque_n_m;
                values.penetration_rad = answer.told_rad;
                if let Some(guard) = answer.inside.guard {
                    values.account_j = guard.account_j;
                    values.is_limited = guard.limited;
                    values.is_tripped = guard.tripped;
                }
            }
            Running::Plant(plant) => {
                let tick = plant.tick(values.torque_n_m, values.offset_rad);
                let standing = plant.standing();
                values.angle_rad = standing.angle_rad;
                values.velocity_rad_per_s = standing.velocity_rad_per_s;
                values.hand_rad = standing.hand_rad;
                values.change_rad = plant.changed_at_rad().unwrap_or(standing.angle_rad);
                values.absorbed_j += tick.absorbed_j;
            }
        }
        self.ticks += 1;
    }
}

fn finite(name: &str, value: f64) -> Result<f64> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(refused(
        format!("{name} = {value}"),
        "it is not a finite number".to_owned(),
        "give a finite number",
    ))
}

fn other_type(variable: &Variable, wanted: &str) -> Error {
    refused(
        variable.text.to_owned(),
        format!("it is not of type {wanted}"),
        "read it by its type in modelDescription.xml",
    )
}

fn refused(option: String, problem: String, fix: &str) -> Error {
    Error::Option {
        option,
        problem,
        fix: fix.to_owned(),
    }
}
