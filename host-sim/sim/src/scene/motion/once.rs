//! Keeps the recording that was read last. A command that runs many variants of a scene thus reads its recording once.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime};

use super::recording::Recording;
use crate::error::Result;

/// A recording, with the state of its file before it was read.
struct Kept {
    file: PathBuf,
    state: State,
    recording: Arc<Recording>,
}

/// The recording that was read last. One is enough, because all runs of a command use the same recording.
static LAST: Mutex<Option<Kept>> = Mutex::new(None);

/// State of a file, by which a changed content is noticed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    File {
        bytes: u64,
        modified: SystemTime,
    },
    /// A pipe or a device, whose content [`crate::input`] keeps.
    Pipe,
}

/// Age of a file below which its recording is not kept: two changes within one unit of the file system's time stamps look alike.
/// The largest usual unit is 2 s.
const SETTLED: Duration = Duration::from_secs(3);

/// State of a file; `None` for a file that has just changed or whose state is not known.
fn state(file: &Path) -> Option<State> {
    let meta = std::fs::metadata(file).ok()?;
    if !meta.is_file() {
        return Some(State::Pipe);
    }
    let modified = meta.modified().ok()?;
    let is_settled = modified.elapsed().is_ok_and(|age| age > SETTLED);
    is_settled.then_some(State::File {
        bytes: meta.len(),
        modified,
    })
}

impl Recording {
    /// Reads a recording from a CSV file.
    ///
    /// The file has a header line; lines that begin with `#` are skipped. One column's name must end in a unit of time (`time_s`,
    /// `t_ms`, `Time [us]`), one in a unit of angle (`angle_deg`, `position_rad`, `theta_mrad`, `turn_rev`). Other columns are
    /// ignored. Times must rise; their steps need not be equal. Time counts from the first sample.
    ///
    /// A trace of a simulation and a file of `touchstone monitor` have several columns of angles. From such a file the first
    /// existing column of `rest_rad`, `hand_rad`, `angle_rad`, `angle_measured_rad` and `penetration_rad` is read.
    ///
    /// The recording that was read last is kept, so that a command with many runs reads it once.
    ///
    /// # Errors
    /// [`Error::Io`](crate::error::Error::Io) if the file cannot be read. [`Error::File`](crate::error::Error::File) with line and
    /// column for a missing or ambiguous column, fewer than two rows, a row of another length than the header, a missing or
    /// non-finite number, an angle beyond 1e6 rad, times that do not rise, a duration below 10 µs, more than 3.6 million samples,
    /// or a duration above an hour.
    pub fn read(file: &Path) -> Result<Arc<Recording>> {
        kept_or_read(file, Recording::read_anew)
    }
}

/// Returns the kept recording, or reads it if another one is kept or the file has changed. Other threads wait in the meantime.
fn kept_or_read(file: &Path, read: impl Fn(&Path) -> Result<Recording>) -> Result<Arc<Recording>> {
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    let state = state(file);
    if let Some(kept) = &*last
        && kept.file == file
        && Some(kept.state) == state
    {
        return Ok(Arc::clone(&kept.recording));
    }
    // Frees the memory of the other recording before this one is read.
    *last = None;
    let recording = Arc::new(read(file)?);
    *last = state.map(|state| Kept {
        file: file.to_owned(),
        state,
        recording: Arc::clone(&recording),
    });
    Ok(recording)
}
