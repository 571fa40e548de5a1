//! Records every control period (tick) of a run on a haptic device. Memory is reserved before the motors are on; the file is
//! written after they are off.

use crate::whole::Named;
use touchstone_device::servo::ServoTick;
use touchstone_report::csv::decimal;
use touchstone_sim::error::{Error, Result};

/// Column names: time, positions and forces along the three axes.
const COLUMNS: [&str; 7] = [
    "time_s",
    "position_x_m",
    "position_y_m",
    "position_z_m",
    "force_x_n",
    "force_y_n",
    "force_z_n",
];

/// The recorded control periods (ticks) of a run on a device.
pub struct DeviceTrace {
    ticks: Vec<ServoTick>,
}

impl DeviceTrace {
    /// Reserves memory for `most` control periods (ticks); further ones are not recorded.
    ///
    /// # Errors
    /// The computer has too little memory for them.
    pub fn for_ticks(most: u64) -> Result<Self> {
        let mut ticks = Vec::new();
        let count = usize::try_from(most).unwrap_or(usize::MAX);
        ticks.try_reserve_exact(count).map_err(|_| Error::Option {
            option: "--seconds".into(),
            problem: format!(
                "a recording of this length needs {:.0} GB of memory, more than there is",
                most as f64 * size_of::<ServoTick>() as f64 / 1e9
            ),
            fix: "give a shorter time, or leave out --csv and --out".into(),
        })?;
        Ok(Self { ticks })
    }

    /// Records a control period (tick), without allocating memory.
    pub fn keep(&mut self, tick: &ServoTick) {
        if self.ticks.len() < self.ticks.capacity() {
            self.ticks.push(*tick);
        }
    }

    /// All recorded control periods (ticks).
    pub fn ticks(&self) -> &[ServoTick] {
        &self.ticks
    }

    /// Writes the trace as CSV. Missed control periods have no row, so the times of neighbouring rows are then further apart.
    pub fn write(&self, place: &Named<'_>, rate_hz: u32) -> Result<()> {
        let wrong = |error: csv::Error| place.error(&error.into());
        let mut file = csv::Writer::from_writer(Vec::new());
        file.write_record(COLUMNS).map_err(wrong)?;
        for tick in &self.ticks {
            let time_s = tick.due as f64 / f64::from(rate_hz);
            let numbers = [time_s]
                .into_iter()
                .chain(tick.position_m)
                .chain(tick.force_n);
            file.write_record(numbers.map(decimal)).map_err(wrong)?;
        }
        let text = file
            .into_inner()
            .map_err(|error| place.error(&error.into_error()))?;
        place.write(text)
    }
}

#[cfg(test)]
mod tests {
    use super::DeviceTrace;

    #[test]
    fn a_recording_that_fits_no_memory_is_refused() {
        // No computer can address so many records, whatever its memory.
        let refused = DeviceTrace::for_ticks(u64::MAX / 64).err().unwrap();
        let words = refused.to_string();
        for part in ["--seconds", "GB of memory", "leave out --csv and --out"] {
            assert!(words.contains(part), "{words}");
        }
        assert!(DeviceTrace::for_ticks(1000).is_ok());
    }
}
