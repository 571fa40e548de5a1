//! The columns of a trace file (one row per control period), the same for every file format: name, unit, meaning and values.

use touchstone_sim::run::record::Trace;

/// One column of a trace file.
pub struct Column {
    /// Name of the column in CSV and Parquet: the name of the field in [`Trace`], whose ending is the unit.
    pub name: &'static str,
    /// Unit of the column, in the form used in metadata.
    pub unit: &'static str,
    /// Meaning of the column in a few words.
    pub meaning: &'static str,
    /// Returns the column's values from a trace.
    pub values: fn(&Trace) -> &[f64],
}

macro_rules! columns {
    ($($field:ident, $unit:literal, $meaning:literal;)*) => {
        /// Every column, in the order of the files.
        pub const COLUMNS: &[Column] = &[$(Column {
            name: stringify!($field),
            unit: $unit,
            meaning: $meaning,
            values: |trace| &trace.$field,
        }),*];

        // No `..` here: a field added to `Trace` and forgotten above does not compile.
        const _: fn(Trace) = |trace| {
            let Trace { $($field: _),* } = trace;
        };

        /// Builds a trace from columns of numbers in the order of [`COLUMNS`].
        #[cfg(test)]
        pub(super) fn from_columns(columns: Vec<Vec<f64>>) -> Trace {
            let mut columns = columns.into_iter();
            Trace { $($field: columns.next().expect("one vector for each column")),* }
        }
    };
}

columns! {
    time_s, "s", "time of the sample";
    angle_rad, "rad", "true angle of the device (HIP)";
    velocity_rad_per_s, "rad/s", "true velocity of the device";
    angle_measured_rad, "rad", "angle as the encoder gave it to the law";
    hand_rad, "rad", "angle of the hand's mass";
    rest_rad, "rad", "the hand's moving rest point";
    force_n_m, "N·m", "force of the law, pushing out of the wall, after its limit";
    surface_rad, "rad", "undeformed wall surface x_s";
    surface_shifted_rad, "rad", "shifted surface x_s - O";
    mass_rad, "rad", "virtual filter mass, else the HIP";
    energy_observed_j, "J", "energy that the law's own observer reports (NaN: it has none)";
    energy_true_j, "J", "true energy of the wall's port under the zero-order hold";
    energy_device_loss_j, "J", "energy that the device dissipated so far";
    guard_account_j, "J", "energy that the hand may still get out, by the energy guard's account (NaN: there is none)";
}

/// Number of samples in a trace. All columns of a [`Trace`] should have equal length; the shortest counts, so that no reader
/// panics.
pub fn len(trace: &Trace) -> usize {
    let len = COLUMNS
        .iter()
        .map(|column| (column.values)(trace).len())
        .min()
        .unwrap_or(0);
    debug_assert!(
        COLUMNS
            .iter()
            .all(|column| (column.values)(trace).len() == len)
    );
    len
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_end_in_their_unit() {
        for column in COLUMNS {
            let ending = column
                .unit
                .replace("N·m", "n_m")
                .replace('/', "_per_")
                .to_lowercase();
            assert!(
                column.name.ends_with(&format!("_{ending}")),
                "{} in {}",
                column.name,
                column.unit
            );
        }
    }
}
