//! Progress file of `touchstone setup` in the setup's folder. An interruption loses only the results of the unfinished step.

use crate::device::eccentricity;
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use touchstone_lab::identify::eccentricity::Eccentricity;
use touchstone_lab::identify::motor::MeasuredMotor;
use touchstone_lab::identify::{Estimate, Mechanics};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::output;

/// Name of the progress file.
const NAME: &str = "setup.json";
/// Keys of the progress file: the text of the scene for which the law in the folder was tuned, and whether by a quick search.
const TUNED_FOR: &str = "tuned_for";
const TUNED_QUICKLY: &str = "tuned_quickly";
/// Files, and a folder, that a setup writes in addition to its progress file.
const FILES: [&str; 6] = [
    super::BEFORE,
    "knob.toml",
    "law.toml",
    super::RUST,
    super::C,
    super::REPORT,
];

/// The finished steps of a setup, with their results.
pub struct Kept {
    file: PathBuf,
    done: Map<String, Value>,
    /// Whether the folder has no results yet.
    is_new: bool,
}

/// Names of the values of a measured motor in the progress file.
pub const VALUES: [&str; 7] = [
    "resistance_ohm",
    "inductance_h",
    "flux_linkage_wb",
    "torque_constant_n_m_per_a",
    "inertia_kg_m2",
    "damping_n_m_s_per_rad",
    "friction_n_m",
];

/// The motor's values in the order of their names.
pub fn values(motor: &MeasuredMotor) -> [Estimate; 7] {
    let Mechanics {
        inertia_kg_m2,
        damping_n_m_s_per_rad,
        friction_n_m,
        ..
    } = motor.mechanics;
    [
        motor.resistance_ohm,
        motor.inductance_h,
        motor.flux_linkage_wb,
        motor.torque_constant_n_m_per_a,
        inertia_kg_m2,
        damping_n_m_s_per_rad,
        friction_n_m,
    ]
}

/// Returns an error for a folder that has a file with the name of a setup's file, but no progress file: the file is not from a
/// setup.
fn untouched(folder: &Path) -> Result<()> {
    let taken = FILES
        .into_iter()
        .find(|name| output::is_free(&folder.join(name)).is_err());
    match taken {
        None => Ok(()),
        Some(name) => Err(Error::Io {
            path: folder.join(name),
            problem: "exists, and was not written by `touchstone setup`".into(),
            fix: "choose another folder with --out, or move it away".into(),
        }),
    }
}

impl Kept {
    /// Reads the progress from the folder. A folder that does not exist has none; it is created with the first file.
    pub fn open(folder: &Path) -> Result<Self> {
        let file = folder.join(NAME);
        let done = match touchstone_sim::input::text(&file, touchstone_sim::input::MOST_OF_SETTINGS)
        {
            Ok(text) => serde_json::from_str(&text).map_err(|error| Error::Io {
                path: file.clone(),
                problem: error.to_string(),
                fix: "remove it, or choose another folder with --out".into(),
            })?,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                untouched(folder)?;
                Map::new()
            }
            Err(error) => return Err(io(&file, &error)),
        };
        let is_new = done.keys().all(|key| key == "device");
        Ok(Self { file, done, is_new })
    }

    /// Whether the setup had no results when it was opened. The board then still has its settings from before the setup.
    pub fn is_new(&self) -> bool {
        self.is_new
    }

    /// Serial number of the device that is set up.
    pub fn device(&self) -> Option<&str> {
        self.done.get("device")?.as_str()
    }

    /// Records the serial number of the device that is set up. This is the first file of a setup. After an interruption it shows
    /// that the other files in the folder belong to this setup.
    ///
    /// # Errors
    /// Another setup began in this folder meanwhile, or the file cannot be written.
    pub fn begin(&mut self, device: &str) -> Result<()> {
        self.done.insert("device".into(), device.into());
        output::write_new(&self.file, self.text()).map_err(|error| match error.kind() {
            std::io::ErrorKind::AlreadyExists => Error::Io {
                path: self.file.clone(),
                problem: "exists: another setup is in progress in this folder".into(),
                fix: "choose another folder with --out".into(),
            },
            _ => io(&self.file, &error),
        })
    }

    /// Discards the results of all steps, but keeps the device's serial number.
    pub fn again(&mut self) {
        self.done.retain(|key, _| key == "device");
    }

    /// The measured motor; `None` before the measurement.
    pub fn measured(&self) -> Option<MeasuredMotor> {
        let all = self.done.get("measured")?;
        let number = |name: &str, what: &str| all.get(name)?.get(what)?.as_f64();
        let mut found = VALUES.iter().map(|name| {
            Some(Estimate {
                value: number(name, "value")?,
                uncertainty: number(name, "uncertainty")?,
            })
        });
        let mut next = || found.next().flatten();
        Some(MeasuredMotor {
            resistance_ohm: next()?,
            inductance_h: next()?,
            flux_linkage_wb: next()?,
            torque_constant_n_m_per_a: next()?,
            mechanics: Mechanics {
                inertia_kg_m2: next()?,
                damping_n_m_s_per_rad: next()?,
                friction_n_m: next()?,
                residual_rms_rad: all.get("residual_rms_rad")?.as_f64()?,
            },
        })
    }

    /// The encoder's measured eccentricity; `None` if it was not measured.
    pub fn encoder(&self) -> Option<Eccentricity> {
        eccentricity::from_json(self.done.get("encoder")?)
    }

    /// Records the measured motor and, if measured, the eccentricity of its encoder.
    pub fn keep_measured(
        &mut self,
        motor: &MeasuredMotor,
        encoder: Option<serde_json::Value>,
    ) -> Result<()> {
        self.done.insert("measured".into(), as_json(motor));
        self.done.insert("encoder".into(), encoder.into());
        self.write()
    }

    /// Whether the law in the folder was tuned for this scene. The law of a quick search counts only if a quick one is asked for
    /// again (`quick`); that of a full search counts for both.
    pub fn is_tuned_for(&self, scene: &str, quick: bool) -> bool {
        let of = |key| self.done.get(key);
        let is_of_scene = of(TUNED_FOR).and_then(Value::as_str) == Some(scene);
        let was_quick = of(TUNED_QUICKLY).and_then(Value::as_bool) == Some(true);
        is_of_scene && (quick || !was_quick)
    }

    /// Records that a wall was tuned for this scene, by a quick or a full search.
    pub fn keep_tuned_for(&mut self, scene: &str, quick: bool) -> Result<()> {
        self.done.insert(TUNED_FOR.into(), scene.into());
        self.done.insert(TUNED_QUICKLY.into(), quick.into());
        self.write()
    }

    /// Records that the law in the folder is not one that was tuned. Called before another law is written there, so that an
    /// interruption leaves no law that counts as tuned.
    pub fn forget_tuned(&mut self) -> Result<()> {
        self.done
            .retain(|key, _| key != TUNED_FOR && key != TUNED_QUICKLY);
        self.write()
    }

    /// Writes the progress file in one step: after a power cut, the file has either the earlier or the new content.
    fn write(&self) -> Result<()> {
        output::write(&self.file, self.text()).map_err(|error| io(&self.file, &error))
    }

    fn text(&self) -> String {
        format!("{:#}\n", Value::Object(self.done.clone()))
    }
}

/// The measured motor's values with their uncertainties, as JSON.
pub fn as_json(motor: &MeasuredMotor) -> Value {
    let mut all: Map<String, Value> = VALUES
        .into_iter()
        .zip(values(motor))
        .map(|(name, it)| {
            let entry = json!({ "value": it.value, "uncertainty": it.uncertainty });
            (name.to_owned(), entry)
        })
        .collect();
    let residual = motor.mechanics.residual_rms_rad;
    all.insert("residual_rms_rad".into(), residual.into());
    all.into()
}

/// Error for a file of the setup that cannot be read or written.
pub fn io(path: &Path, error: &std::io::Error) -> Error {
    Error::Io {
        path: path.to_owned(),
        problem: error.to_string(),
        fix: "choose another folder with --out".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::{Kept, Map};

    #[test]
    fn a_quick_law_does_not_count_where_a_full_search_is_asked_for() {
        let file = std::env::temp_dir().join(format!("touchstone-kept-{}", std::process::id()));
        let mut kept = Kept {
            file: file.clone(),
            done: Map::new(),
            is_new: false,
        };
        // Whether the search was quick, and whether its law counts where a quick and where a full search is asked for.
        for (was_quick, counts) in [(true, [true, false]), (false, [true, true])] {
            kept.keep_tuned_for("a", was_quick).unwrap();
            let found = [true, false].map(|quick| kept.is_tuned_for("a", quick));
            assert_eq!(found, counts, "{was_quick}");
            assert!(!kept.is_tuned_for("b", true));
        }
        kept.forget_tuned().unwrap();
        assert!(!kept.is_tuned_for("a", true));
        std::fs::remove_file(file).unwrap();
    }
}
