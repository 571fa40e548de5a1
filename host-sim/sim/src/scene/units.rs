//! Units at the end of the names of scene fields and CSV columns, such as the `kg_m2` of `inertia_kg_m2`.

/// Physical quantity that a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dimension {
    Angle,
    Time,
    Velocity,
    Torque,
    Stiffness,
    Damping,
    Inertia,
    Frequency,
    Energy,
    Power,
}

/// One spelling of a unit, with its factor to SI.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unit {
    /// The unit as it appears at the end of a name, such as `kg_m2`.
    pub suffix: &'static str,
    /// The unit as printed for people, such as kg·m².
    pub shown: &'static str,
    /// The physical quantity that the unit measures.
    pub dimension: Dimension,
    /// Factor from the unit to the SI unit.
    pub si: f64,
}

const fn unit(dimension: Dimension, suffix: &'static str, shown: &'static str, si: f64) -> Unit {
    Unit {
        suffix,
        shown,
        dimension,
        si,
    }
}

const TAU: f64 = std::f64::consts::TAU;
const DEGREE: f64 = TAU / 360.0;

/// All spellings of units that can be read. The SI unit of each quantity comes first.
pub(crate) const UNITS: &[Unit] = &[
    unit(Dimension::Angle, "rad", "rad", 1.0),
    unit(Dimension::Angle, "mrad", "mrad", 1e-3),
    unit(Dimension::Angle, "deg", "°", DEGREE),
    unit(Dimension::Angle, "rev", "rev", TAU),
    unit(Dimension::Time, "s", "s", 1.0),
    unit(Dimension::Time, "ms", "ms", 1e-3),
    unit(Dimension::Time, "us", "µs", 1e-6),
    unit(Dimension::Time, "ns", "ns", 1e-9),
    unit(Dimension::Velocity, "rad_per_s", "rad/s", 1.0),
    unit(Dimension::Velocity, "mrad_per_s", "mrad/s", 1e-3),
    unit(Dimension::Velocity, "deg_per_s", "°/s", DEGREE),
    unit(Dimension::Velocity, "rev_per_s", "rev/s", TAU),
    unit(Dimension::Velocity, "rpm", "rpm", TAU / 60.0),
    unit(Dimension::Torque, "n_m", "N·m", 1.0),
    unit(Dimension::Torque, "nm", "N·m", 1.0),
    unit(Dimension::Torque, "mn_m", "mN·m", 1e-3),
    unit(Dimension::Torque, "mnm", "mN·m", 1e-3),
    unit(Dimension::Torque, "n_cm", "N·cm", 1e-2),
    unit(Dimension::Torque, "n_mm", "N·mm", 1e-3),
    unit(Dimension::Stiffness, "n_m_per_rad", "N·m/rad", 1.0),
    unit(Dimension::Stiffness, "nm_per_rad", "N·m/rad", 1.0),
    unit(Dimension::Stiffness, "mn_m_per_rad", "mN·m/rad", 1e-3),
    unit(Dimension::Stiffness, "n_mm_per_rad", "N·mm/rad", 1e-3),
    unit(Dimension::Stiffness, "n_m_per_deg", "N·m/°", 1.0 / DEGREE),
    unit(
        Dimension::Stiffness,
        "mn_m_per_deg",
        "mN·m/°",
        1e-3 / DEGREE,
    ),
    unit(Dimension::Damping, "n_m_s_per_rad", "N·m·s/rad", 1.0),
    unit(Dimension::Damping, "nms_per_rad", "N·m·s/rad", 1.0),
    unit(Dimension::Damping, "mn_m_s_per_rad", "mN·m·s/rad", 1e-3),
    unit(Dimension::Damping, "n_mm_s_per_rad", "N·mm·s/rad", 1e-3),
    unit(Dimension::Damping, "n_m_s_per_deg", "N·m·s/°", 1.0 / DEGREE),
    unit(Dimension::Inertia, "kg_m2", "kg·m²", 1.0),
    unit(Dimension::Inertia, "g_m2", "g·m²", 1e-3),
    unit(Dimension::Inertia, "kg_cm2", "kg·cm²", 1e-4),
    unit(Dimension::Inertia, "g_cm2", "g·cm²", 1e-7),
    unit(Dimension::Inertia, "kg_mm2", "kg·mm²", 1e-6),
    unit(Dimension::Inertia, "g_mm2", "g·mm²", 1e-9),
    unit(Dimension::Energy, "j", "J", 1.0),
    unit(Dimension::Energy, "mj", "mJ", 1e-3),
    unit(Dimension::Power, "w", "W", 1.0),
    unit(Dimension::Power, "mw", "mW", 1e-3),
    unit(Dimension::Frequency, "hz", "Hz", 1.0),
    unit(Dimension::Frequency, "khz", "kHz", 1e3),
];

/// Finds the unit with exactly this suffix.
pub(crate) fn by_suffix(suffix: &str) -> Option<&'static Unit> {
    UNITS.iter().find(|unit| unit.suffix == suffix)
}

/// The longest unit at the end of `name`, which may consist of only the unit. `None` if there is no known unit.
///
/// Also `None` if the unit is only the end of an unlisted rate, such as the `s` of `counts_per_s`.
pub(crate) fn at_end_of(name: &str) -> Option<&'static Unit> {
    let ends = |suffix: &str| {
        name.strip_suffix(suffix)
            .is_some_and(|stem| stem.is_empty() || stem.ends_with('_'))
    };
    let unit = UNITS
        .iter()
        .filter(|unit| ends(unit.suffix))
        .max_by_key(|unit| unit.suffix.len())?;
    let stem = &name[..name.len() - unit.suffix.len()];
    (!stem.ends_with("per_")).then_some(unit)
}

/// Whether every word of `end`, the end of a name, could belong to a unit, even to one that is not in the list (`lb_in2`,
/// `n_per_mm`).
pub(crate) fn looks_like_unit(end: &str) -> bool {
    const WORDS: &[&str] = &[
        "n", "mn", "un", "kn", "nm", "mnm", "ncm", "nms", "kgf", "lb", "lbf", "oz", "ozf", "in",
        "in2", "ft", "m", "mm", "cm", "um", "m2", "cm2", "mm2", "kg", "g", "mg", "s", "ms", "us",
        "ns", "sec", "seconds", "min", "minutes", "rad", "mrad", "urad", "radians", "deg",
        "degrees", "rev", "turn", "turns", "rpm", "hz", "khz", "counts", "percent", "per",
    ];
    end.split('_').all(|word| WORDS.contains(&word))
}

/// Writes `value` as the shortest decimal number after rounding to 12 digits, which removes the rounding errors of a unit
/// conversion.
pub(crate) fn tidy(value: f64) -> String {
    let rounded: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    format!("{rounded:?}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_unit_at_the_end_counts() {
        let suffix = |name| at_end_of(name).map(|unit| unit.suffix);
        assert_eq!(suffix("time_s"), Some("s"));
        assert_eq!(suffix("t_ms"), Some("ms"));
        assert_eq!(suffix("deg"), Some("deg"));
        assert_eq!(suffix("speed_deg_per_s"), Some("deg_per_s"));
        assert_eq!(suffix("k_n_m_per_rad"), Some("n_m_per_rad"));
        assert_eq!(
            suffix("acceleration_m_per_s"),
            None,
            "a linear rate is no time"
        );
        assert_eq!(suffix("status"), None);
        assert_eq!(suffix("time"), None);
    }

    #[test]
    fn factors_do_not_leave_rounding_behind() {
        assert_eq!(tidy(100.0 * by_suffix("g_cm2").unwrap().si), "1e-5");
        assert_eq!(tidy(180.0 * by_suffix("deg").unwrap().si), "3.14159265359");
        assert_eq!(tidy(1000.0), "1000.0");
    }
}
