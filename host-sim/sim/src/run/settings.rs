//! Messages for the control crate's errors and warnings about settings. Each names the field of the scene. A warning stays a warning,
//! although its message has the type [`Error`].

use crate::error::Error;
use crate::scene::Scene;
use touchstone_control::{Field, SettingsError, Si, Warning};

/// Converts an error of the control crate to an error that names the field of the scene.
pub fn refused(scene: &Scene, error: &SettingsError) -> Error {
    match error {
        SettingsError::OutOfRange {
            field,
            value,
            min,
            max,
        } => scene.error(
            field.path(),
            format!("{} is out of range", short(*value)),
            format!("give a value from {} to {}", short(*min), short(*max)),
        ),
        SettingsError::OutOfFormat {
            field,
            value,
            format,
        } => {
            let wider = if *format == "fixed32" {
                "\"f64\""
            } else {
                "\"fixed32\" or \"f64\""
            };
            scene.error(
                field.path(),
                format!("its coefficient {value:.3} does not fit the number format {format}"),
                format!("give a smaller value, or law.number = {wider}"),
            )
        }
        SettingsError::NoCompensation { k_filter, .. } => scene.error(
            "law.regulate",
            "mass-compensated cannot reach k_de, which is not below k_f (thesis 3.5)",
            format!(
                "give k_desired_n_m_per_rad below {}, or regulate = \"hip\"",
                short(*k_filter)
            ),
        ),
        SettingsError::TooCoarse { count, coarsest } => scene.error(
            "encoder.counts_per_rev",
            format!(
                "a count of {} rad is too coarse for the energy guard",
                short(*count)
            ),
            format!(
                "give counts of at most {} rad, or law.guard.on = false",
                short(*coarsest)
            ),
        ),
        other => scene.error(
            Field::Law.path(),
            other.to_string(),
            "change the setting that this error names",
        ),
    }
}

/// Rounds a setting to six digits for messages, because its fixed-point format has more digits than the scene file.
fn short(value: Si) -> f64 {
    let value = value.to_num::<f64>();
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// Message of a passivity warning, with the field of the scene, the bound, the value and the consequence.
pub fn warned(scene: &Scene, warning: &Warning) -> Error {
    let (problem, fix) = match *warning {
        Warning::SoftAboveCritical { k_soft, k_critical } => (
            format!(
                "k_v = {} is above k_c = 2 c_i/T = {}: the law's soft spring is then unstable by itself, so the law may be unstable",
                short(k_soft),
                short(k_critical)
            ),
            format!("give {} or less", short(k_critical)),
        ),
        Warning::CouplingAboveBound { k_filter, bound } => (
            format!(
                "k_f = {} is above 2 (c_i - c_f - B)/T = {}: filter and damper are then passive only with the hand's help",
                short(k_filter),
                short(bound)
            ),
            format!("give {} or less", short(bound)),
        ),
        Warning::GroundDampingBelowBound { .. } => {
            let least = 0.5 * scene.law.k_soft_n_m_per_rad * scene.timing.period_s();
            (
                format!(
                    "c_env = {:e} is below k_v T/2 = {least:e}: the virtual mass may then gain energy from its own delay",
                    scene.law.filter.ground_damping_n_m_s_per_rad
                ),
                format!("give {least:e} or more"),
            )
        }
        Warning::ThesisObserver => (warning.to_string(), "give exact".to_owned()),
        Warning::ObservesEstimates => (warning.to_string(), "give measured".to_owned()),
        Warning::EnergyCredit { .. } => (warning.to_string(), "give 0".to_owned()),
        Warning::GuardSoftensAtForceLimit { needed, .. } => (
            warning.to_string(),
            format!("give {} or more", short(needed)),
        ),
        Warning::GuardNeverRefilled => (warning.to_string(), "give 0.0005".to_owned()),
        _ => (warning.to_string(), "give another value".to_owned()),
    };
    scene.error(warning.field().path(), problem, fix)
}
