//! From a scene's law to the control crate's settings.

use crate::error::{Error, Result};
use crate::run::record::LawKind;
use crate::scene::{FirstContact, IdealStep, Observer, OffsetUpdate, Regulate, Scene};
use touchstone_control::{self as control, Field, Settings, SettingsError, Si, Warning};

/// An SI value of a scene in the control crate's exact format.
fn si(scene: &Scene, path: &str, value: f64) -> Result<Si> {
    Si::checked_from_num(value).ok_or_else(|| {
        scene.error(
            path,
            format!("{value} is too large"),
            "give a value below 2e9",
        )
    })
}

/// The settings of the scene's law.
///
/// # Errors
/// A value that the control crate cannot hold.
pub fn settings(scene: &Scene) -> Result<Settings> {
    let law = &scene.law;
    let value = |path: &str, value: f64| si(scene, path, value);
    Ok(Settings {
        law: match law.kind {
            LawKind::Spring => control::LawKind::Spring,
            LawKind::SpringDamper => control::LawKind::SpringDamper,
            LawKind::Tdpa => control::LawKind::Tdpa,
            LawKind::Fba => control::LawKind::Fba,
            LawKind::Sfa => control::LawKind::Sfa,
            LawKind::SfaContinuous => control::LawKind::SfaContinuous,
            LawKind::EnhancedSfa => control::LawKind::EnhancedSfa,
        },
        rate_hz: scene.timing.rate_hz,
        k_desired: value(
            "wall.k_desired_n_m_per_rad",
            scene.wall.k_desired_n_m_per_rad,
        )?,
        k_soft: value("law.k_v_n_m_per_rad", law.k_v_n_m_per_rad)?,
        device_damping: value("law.c_i_n_m_s_per_rad", law.c_i_n_m_s_per_rad)?,
        virtual_damping: value(
            "law.virtual_damping_n_m_s_per_rad",
            law.virtual_damping_n_m_s_per_rad,
        )?,
        observer: match law.observer {
            Observer::Exact => control::ObserverForm::Exact,
            Observer::Thesis => control::ObserverForm::Thesis,
        },
        count_device_damping: law.count_device_damping,
        first_contact: match law.first_contact() {
            FirstContact::KeepForce => control::FirstContact::KeepForce,
            FirstContact::ZeroOffset => control::FirstContact::ZeroOffset,
        },
        regulate: match law.regulate {
            Regulate::Mass => control::Regulate::Mass,
            Regulate::MassCompensated => control::Regulate::MassCompensated,
            Regulate::Hip => control::Regulate::Hip,
        },
        offset_update: match law.offset_update {
            OffsetUpdate::Inward => control::OffsetUpdate::Inward,
            OffsetUpdate::EveryTick => control::OffsetUpdate::EveryTick,
        },
        ideal_step: match law.ideal_step {
            IdealStep::Position => control::IdealStep::Position,
            IdealStep::Force => control::IdealStep::Force,
        },
        step_of_ideal: value("law.step_c_of_ideal", law.step_c_of_ideal)?,
        limit_of_force: value("law.limit_b_of_force", law.limit_b_of_force)?,
        limit_of_penetration: value("law.limit_a_of_penetration", law.limit_a_of_penetration)?,
        filter: control::FilterSettings {
            mass: value("law.filter.mass_kg_m2", law.filter.mass_kg_m2)?,
            stiffness: value(
                "law.filter.stiffness_n_m_per_rad",
                law.filter.stiffness_n_m_per_rad,
            )?,
            damping: value(
                "law.filter.damping_n_m_s_per_rad",
                law.filter.damping_n_m_s_per_rad,
            )?,
            ground_damping: value(
                "law.filter.damping_to_ground_n_m_s_per_rad",
                law.filter.damping_to_ground_n_m_s_per_rad,
            )?,
        },
        energy_credit: value("law.energy_credit_j", law.energy_credit_j)?,
        force_limit: value("law.force_limit_n_m", law.force_limit_n_m)?,
    })
}

/// Dotted path in a scene of a setting.
fn path(field: Field) -> &'static str {
    match field {
        Field::RateHz => "timing.rate_hz",
        Field::KDesired => "wall.k_desired_n_m_per_rad",
        Field::KSoft => "law.k_v_n_m_per_rad",
        Field::DeviceDamping => "law.c_i_n_m_s_per_rad",
        Field::VirtualDamping => "law.virtual_damping_n_m_s_per_rad",
        Field::StepOfIdeal => "law.step_c_of_ideal",
        Field::LimitOfForce => "law.limit_b_of_force",
        Field::LimitOfPenetration => "law.limit_a_of_penetration",
        Field::FilterMass => "law.filter.mass_kg_m2",
        Field::FilterStiffness => "law.filter.stiffness_n_m_per_rad",
        Field::FilterDamping => "law.filter.damping_n_m_s_per_rad",
        Field::FilterGroundDamping => "law.filter.damping_to_ground_n_m_s_per_rad",
        Field::EnergyCredit => "law.energy_credit_j",
        Field::ForceLimit => "law.force_limit_n_m",
    }
}

/// The error of the control crate, at its place in the scene.
pub fn refused(scene: &Scene, error: &SettingsError) -> Error {
    match error {
        SettingsError::OutOfRange {
            field,
            value,
            min,
            max,
        } => scene.error(
            path(*field),
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
                path(*field),
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
    }
}

/// A value as a person would write it: the control crate's exact format has more digits than the scene did.
fn short(value: Si) -> f64 {
    let value = value.to_num::<f64>();
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// What a warning says, at its place in the scene: bound, value, what is lost.
pub fn warned(scene: &Scene, warning: &Warning) -> Error {
    let (path, problem, fix) = match *warning {
        Warning::SoftAboveCritical { k_soft, k_critical } => (
            "law.k_v_n_m_per_rad",
            format!(
                "k_v = {} is above k_c = 2 c_i/T = {}: the soft spring is then not stable by itself, and so nothing built on it",
                short(k_soft),
                short(k_critical)
            ),
            format!("give {} or less", short(k_critical)),
        ),
        Warning::CouplingAboveBound { k_filter, bound } => (
            "law.filter.stiffness_n_m_per_rad",
            format!(
                "k_f = {} is above 2 (c_i - c_f)/T = {}: the filter is then passive only with the hand's help",
                short(k_filter),
                short(bound)
            ),
            format!("give {} or less", short(bound)),
        ),
        Warning::GroundDampingBelowBound { .. } => {
            let least = 0.5 * scene.law.k_v_n_m_per_rad * scene.timing.period_s();
            (
                "law.filter.damping_to_ground_n_m_s_per_rad",
                format!(
                    "c_env = {:e} is below k_v T/2 = {least:e}: the virtual mass may then gain energy from its own delay",
                    scene.law.filter.damping_to_ground_n_m_s_per_rad
                ),
                format!("give {least:e} or more"),
            )
        }
        Warning::ThesisObserver => ("law.observer", warning.to_string(), "give exact".to_owned()),
        Warning::EnergyCredit { .. } => (
            "law.energy_credit_j",
            warning.to_string(),
            "give 0".to_owned(),
        ),
    };
    scene.error(path, problem, fix)
}
