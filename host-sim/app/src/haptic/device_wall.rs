//! Chooses the wall that `touchstone device run` renders: tuned for the device, with the thesis' settings, or from a file.

use crate::law_name;
use crate::number;
use crate::out::path_line;
use clap::ValueEnum;
use std::path::PathBuf;
use touchstone_control::{EstimatorSettings, LawKind, Settings, Si, StatesKind};
use touchstone_device::haptic::DataSheet;
use touchstone_device::{WallSettings, guard_settings};
use touchstone_lab::identify::lever::{Lever, PRESS_SHARE};
use touchstone_lab::thesis::space;
use touchstone_lab::thesis::space::tuned_wall::TunedWall;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::Scene;
use touchstone_world::plant::OMEGA3_AXIS;

/// Source of the control law and the stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum WallPreset {
    /// Tuned for mass and damping of the device, with estimated velocities.
    Tuned,
    /// The thesis' settings (§5.2), with the law of --law and the stiffness of --k-desired N/mm.
    Thesis,
}

/// Options of the wall.
#[derive(Debug, Clone, clap::Args)]
pub struct WallOptions {
    /// Source of control law and stiffness; default: tuned, where a wall was tuned for such a device and rate, and --law and
    /// --k-desired are not given.
    #[arg(long, value_enum)]
    preset: Option<WallPreset>,
    /// The control law along the surface's normal, with the thesis' settings; default: enhanced-sfa.
    #[arg(long, value_parser = law_name::of_kind())]
    law: Option<LawKind>,
    /// Desired stiffness, N/mm, with the thesis' settings; default: 5, or 1 for a device of unknown mass and damping.
    #[arg(long, value_name = "N_PER_MM", allow_negative_numbers = true, value_parser = number::up_to(50.0, "of N/mm"))]
    k_desired: Option<f64>,
    /// Reads stiffness and control law from a settings file, as `touchstone tune --out` writes it for the scene of `device identify
    /// --scene`.
    #[arg(long, value_name = "FILE.toml", requires = "lever_mm", conflicts_with_all = ["preset", "law", "k_desired"])]
    settings: Option<PathBuf>,
    /// With --settings: the lever of the scene that `device identify --scene` wrote, as that command prints it, mm.
    #[arg(long, value_name = "MM", requires = "settings", allow_negative_numbers = true, value_parser = number::up_to(1000.0, "of millimetres"))]
    lever_mm: Option<f64>,
    /// One control law for each axis, instead of one along the surface's normal.
    #[arg(long)]
    per_axis: bool,
    /// Control rate, Hz; default: the device's fastest rate, or the device's own if it sets the rate itself.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, value_parser = number::within(100_u32, 10_000, "of Hz"))]
    pub rate_hz: Option<u32>,
    /// Largest force, N; default and largest value: the device's largest force.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number::up_to(100.0, "of newtons"))]
    force_limit_n: Option<f64>,
    /// Damping of the device's least damped axis, as `device identify` measures it, N·s/m. The energy guard relies on a fraction of it;
    /// default: the data sheet's, or an omega.3's for a device of unknown damping.
    #[arg(long, value_name = "N_S_PER_M", conflicts_with = "no_guard", allow_negative_numbers = true, value_parser = number::within(0.0, 50.0, "of N·s/m"))]
    damping: Option<f64>,
    /// Runs without the energy guard.
    #[arg(long)]
    pub no_guard: bool,
}

/// Default stiffness with the thesis' settings, N/mm. `UNKNOWN_N_PER_MM` is the default for a device of unknown mass and damping.
const THESIS_N_PER_MM: f64 = 5.0;
const UNKNOWN_N_PER_MM: f64 = 1.0;

/// The chosen wall: control rate, largest force, settings, and notes to print before the run.
pub struct ChosenWall {
    pub rate_hz: u32,
    pub force_n: f64,
    pub settings: WallSettings,
    /// Source of the control law and the stiffness, as text.
    pub source: String,
    /// Passivity or device limits that the wall is known to exceed, and why; `None` if there are none.
    pub caution: Option<String>,
}

/// The chosen control law, its estimators' settings, their source as text, and a note to print.
struct ChosenLaw {
    law: Settings,
    estimator: Option<[EstimatorSettings; 3]>,
    source: String,
    caution: Option<String>,
}

/// Control rate for a device, Hz: the one that `--rate-hz` gives, or else the device's fastest.
///
/// # Errors
/// A control rate that the device does not have.
pub fn control_rate_hz(given_hz: Option<u32>, sheet: &DataSheet) -> Result<u32> {
    let (slowest, fastest) = sheet.rates_hz;
    let rate_hz = given_hz.unwrap_or(fastest);
    match (slowest..=fastest).contains(&rate_hz) {
        true => Ok(rate_hz),
        false => Err(Error::Option {
            option: "--rate-hz".into(),
            problem: format!(
                "{} does {slowest} to {fastest} Hz, not {rate_hz}",
                sheet.name
            ),
            fix: "give one of these".into(),
        }),
    }
}

impl WallOptions {
    /// Chooses the wall for a device.
    ///
    /// # Errors
    /// A control rate or preset that the device does not have; a settings file that cannot be read or used.
    pub fn chosen(&self, sheet: &DataSheet) -> Result<ChosenWall> {
        let rate_hz = control_rate_hz(self.rate_hz, sheet)?;
        let force_n = self
            .force_limit_n
            .unwrap_or(sheet.force_n)
            .min(sheet.force_n);
        let chosen = self.law(sheet, rate_hz)?;
        let law = Settings {
            rate_hz,
            force_limit: Si::saturating_from_num(force_n),
            ..chosen.law
        };
        let known = self.damping.or(sheet.least_damping_n_s_per_m);
        let damping = known.unwrap_or(OMEGA3_AXIS.damping);
        let guard = guard_settings(damping, sheet.delay_s, rate_hz);
        let is_assumed = known.is_none() && !self.no_guard;
        let assumed = is_assumed.then(|| {
            format!(
                "the energy guard assumes that {} has at least {damping} N·s/m of damping, as an omega.3 has; with less its energy bound does not hold. Measure it by `touchstone device identify` and give --damping",
                sheet.name
            )
        });
        let cautions: Vec<String> = assumed.into_iter().chain(chosen.caution).collect();
        Ok(ChosenWall {
            rate_hz,
            force_n,
            settings: WallSettings {
                law,
                per_axis: self.per_axis,
                guard: (!self.no_guard).then_some(guard),
                estimator: chosen.estimator,
                count_m: sheet.count_m,
            },
            source: chosen.source,
            caution: (!cautions.is_empty()).then(|| cautions.join("; ")),
        })
    }

    fn law(&self, sheet: &DataSheet, rate_hz: u32) -> Result<ChosenLaw> {
        if let (Some(file), Some(lever_mm)) = (&self.settings, self.lever_mm) {
            return from_file(file, lever_mm, rate_hz);
        }
        let thesis = self.law.is_some() || self.k_desired.is_some();
        let tuned = sheet
            .axes
            .and_then(|axes| TunedWall::for_axes(&axes, rate_hz));
        match (self.preset, tuned) {
            (Some(WallPreset::Tuned), _) if thesis => Err(Error::Option {
                option: "--preset tuned".into(),
                problem: "--law and --k-desired are for the thesis' settings".into(),
                fix: "leave these out, or give --preset thesis".into(),
            }),
            (Some(WallPreset::Tuned), None) => Err(Error::Option {
                option: "--preset tuned".into(),
                problem: format!("there is no tuned law for {} at {rate_hz} Hz", sheet.name),
                fix: "give another --rate-hz, or tune one: touchstone device identify".into(),
            }),
            (Some(WallPreset::Tuned), Some(wall)) => Ok(of_tuned(&wall, sheet, rate_hz)),
            (None, Some(wall)) if !thesis => Ok(of_tuned(&wall, sheet, rate_hz)),
            _ => Ok(self.thesis(sheet, rate_hz, tuned.is_none() && self.preset.is_none())),
        }
    }

    /// Control law and estimators with the thesis' settings.
    fn thesis(&self, sheet: &DataSheet, rate_hz: u32, untuned: bool) -> ChosenLaw {
        let kind = self.law.unwrap_or_default();
        let unknown = sheet.axes.is_none() && self.preset.is_none();
        let k_desired = self.k_desired.unwrap_or(match unknown {
            true => UNKNOWN_N_PER_MM,
            false => THESIS_N_PER_MM,
        });
        let law = space::settings(kind, k_desired);
        let soft = law.k_soft.to_num::<f64>() * 1e-3;
        let caution = match (kind, k_desired > soft) {
            (LawKind::EnhancedSfa | LawKind::Sfa, true) => Some(format!(
                "above k_v = {soft} N/mm this law reaches its stiffness by an offset that adapts to the measured motion, so a press or a motion may exceed the scorecard's limits. --preset tuned keeps them on devices with a tuned law"
            )),
            _ if untuned => Some(format!(
                "no wall was tuned for {} at {rate_hz} Hz: identify and tune it (docs/devices.md#identify-and-tune)",
                sheet.name
            )),
            _ => None,
        };
        ChosenLaw {
            law,
            estimator: None,
            source: "the thesis' settings".into(),
            caution,
        }
    }
}

fn of_tuned(wall: &TunedWall, sheet: &DataSheet, rate_hz: u32) -> ChosenLaw {
    let count_n = wall.k_desired_n_per_m * sheet.count_m;
    ChosenLaw {
        law: wall.settings(rate_hz, sheet.force_n),
        estimator: Some([wall.estimator(); 3]),
        source: format!("tuned for {}", wall.name),
        // The displayed stiffness must be measured to 5 %. Warns if the force of half an encoder count of depth is above 5 % of the
        // press force.
        caution: (count_n > 0.1 * PRESS_SHARE * sheet.force_n).then(|| {
            format!(
                "one encoder count of {} is {count_n:.2} N in this wall: too coarse to measure the displayed stiffness",
                sheet.name
            )
        }),
    }
}

fn from_file(file: &std::path::Path, lever_mm: f64, rate_hz: u32) -> Result<ChosenLaw> {
    let lever = Lever {
        length_m: 1e-3 * lever_mm,
    };
    let scene = Scene::load("thesis-knob")?.with_settings(file)?;
    let knob = scene.settings()?;
    if knob.rate_hz != rate_hz {
        return Err(Error::Option {
            option: "--settings".into(),
            problem: format!("it was tuned for {} Hz, not {rate_hz}", knob.rate_hz),
            fix: format!("give --rate-hz {}, or tune it again", knob.rate_hz),
        });
    }
    let estimated = knob.states == StatesKind::Estimated;
    Ok(ChosenLaw {
        law: lever.settings(&knob),
        estimator: estimated.then(|| [lever.estimator(&knob.estimator); 3]),
        source: path_line(file),
        caution: None,
    })
}

#[cfg(test)]
mod tests {
    use super::WallOptions;
    use clap::Parser;
    use touchstone_device::haptic::{DataSheet, Workspace};

    #[derive(Parser)]
    struct Words {
        #[command(flatten)]
        wall: WallOptions,
    }

    /// What `device run` says of a wall on a device with this least damping, if anything.
    fn caution(words: &[&str], least_damping_n_s_per_m: Option<f64>) -> String {
        let sheet = DataSheet {
            name: "arm".into(),
            degrees: 3,
            force_n: 8.0,
            workspace: Workspace {
                radius_m: 0.1,
                half_height_m: 0.1,
            },
            count_m: 1e-5,
            rates_hz: (500, 4000),
            delay_s: 0.0,
            axes: None,
            least_damping_n_s_per_m,
            sets_the_pace: false,
        };
        let words = Words::parse_from([&["device"], words].concat());
        words
            .wall
            .chosen(&sheet)
            .unwrap()
            .caution
            .unwrap_or_default()
    }

    #[test]
    fn damping_that_the_guard_only_assumes_is_named() {
        let assumed = "assumes that arm has at least 2.5 N·s/m of damping";
        let said = caution(&[], None);
        assert!(
            said.contains(assumed) && said.contains("; no wall was tuned"),
            "{said}"
        );
        assert!(!caution(&[], Some(1.0)).contains("assumes"));
        assert!(!caution(&["--damping", "0.3"], None).contains("assumes"));
        assert!(!caution(&["--no-guard"], None).contains("assumes"));
    }
}
