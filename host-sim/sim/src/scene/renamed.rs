//! Other names in scene files and on devices: former names of renamed settings, and `feel` for the table `environment`.

use std::borrow::Cow;
use touchstone_control::Field;

/// Pairs of the former and the present path of a renamed setting.
const RENAMED: &[(&str, &str)] = &[
    ("law.k_v_n_m_per_rad", "law.k_soft_n_m_per_rad"),
    ("law.c_i_n_m_s_per_rad", "law.device_damping_n_m_s_per_rad"),
    (
        "law.limit_a_of_penetration",
        "law.limit_of_penetration_per_ms",
    ),
    ("law.limit_b_of_force", "law.limit_of_force_per_ms"),
    ("law.step_c_of_ideal", "law.step_of_ideal_per_ms"),
    (
        "law.limit_of_penetration",
        "law.limit_of_penetration_per_ms",
    ),
    ("law.limit_of_force", "law.limit_of_force_per_ms"),
    ("law.step_of_ideal", "law.step_of_ideal_per_ms"),
    (
        "law.filter.damping_to_ground_n_m_s_per_rad",
        "law.filter.ground_damping_n_m_s_per_rad",
    ),
    ("wall.law", "law.kind"),
    ("control.rate_hz", "timing.rate_hz"),
];

/// Returns the present path of a setting, given its former path or the end of its former path.
pub fn renamed(old: &str) -> Option<&'static str> {
    // Devices formerly had the law's settings in the table `wall`.
    let moved = |path: &&'static str| {
        let new = path.strip_prefix("law.")?;
        (old.strip_prefix("wall.")? == new).then_some(*path)
    };
    let name = |path: &'static str| path.rsplit('.').next();
    // The end of a former path is accepted only if no present field has that name.
    let was = |path: &'static str, new: &'static str| {
        let end = path.strip_suffix(old);
        end == Some("") || name(path) != name(new) && end.is_some_and(|rest| rest.ends_with('.'))
    };
    RENAMED
        .iter()
        .find(|(path, new)| was(path, new))
        .map(|(_, new)| *new)
        .or_else(|| {
            Field::ALL
                .iter()
                .map(|field| field.path())
                .find_map(|path| moved(&path))
        })
}

/// Path of a field or table in which the table `environment` has this name, and not its other name `feel`.
pub(crate) fn environment_of_feel(path: &str) -> Cow<'_, str> {
    match path.strip_prefix("feel") {
        Some(rest) if rest.is_empty() || rest.starts_with('.') => {
            Cow::Owned(format!("environment{rest}"))
        }
        _ => Cow::Borrowed(path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::schema;

    #[test]
    fn old_names_lead_to_names_of_today() {
        for (old, new) in RENAMED {
            assert!(schema::at(old).is_none() && schema::at(new).is_some());
            assert_eq!(renamed(old), Some(*new));
        }
        assert_eq!(
            renamed("wall.filter.mass_kg_m2"),
            Some("law.filter.mass_kg_m2")
        );
        assert_eq!(renamed("k_v_n_m_per_rad"), Some("law.k_soft_n_m_per_rad"));
        assert_eq!(renamed("wall.k_desired_n_m_per_rad"), None);
        assert_eq!(renamed("rate_hz"), None);
        assert_eq!(renamed("hz"), None);
    }
}
