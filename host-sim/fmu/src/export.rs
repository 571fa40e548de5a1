//! Packs an FMU: description, scene, recording and shared library in one archive.

use crate::{Half, MARK, archive, description};
use std::path::{Path, PathBuf};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::input;
use touchstone_sim::scene::{MotionSpec, Scene};

/// File name of the shared library that `cargo build -p touchstone-fmi` makes on this system.
#[must_use]
pub fn library_name() -> String {
    let (first, last) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    format!("{first}touchstone_fmi{last}")
}

/// Reads the shared library, and checks that it is this program's.
///
/// # Errors
/// The file cannot be read; it is not the shared library of this version.
pub fn library(file: &Path) -> Result<Vec<u8>> {
    let wrong = |problem: String| Error::Io {
        path: file.to_owned(),
        problem,
        fix: "build it in the same clone: cargo build --release -p touchstone-fmi".to_owned(),
    };
    let bytes = input::bytes(file, input::MOST_OF_RESULTS);
    let bytes = bytes.map_err(|error| wrong(error.to_string()))?;
    let has = |part: &[u8]| bytes.windows(part.len()).any(|window| window == part);
    if !has(b"fmi3InstantiateCoSimulation") || !has(MARK.as_bytes()) {
        return Err(wrong(format!("this is not the shared library of {MARK}")));
    }
    Ok(bytes)
}

/// Packs the FMU of one half of a scene. The name of its file is [`description::identifier`] with the ending `.fmu`.
///
/// # Errors
/// The scene's recording cannot be read; the archive would be too large.
pub fn fmu(scene: &Scene, half: Half, library: &[u8]) -> Result<Vec<u8>> {
    let (inside, recording) = moved_inside(scene)?;
    let text = inside.to_toml();
    let xml = description::xml(scene, half, &text)?;
    let identifier = description::identifier(scene, half);
    let binary = format!(
        "binaries/{}-{}/{identifier}{}",
        std::env::consts::ARCH,
        platform(),
        std::env::consts::DLL_SUFFIX
    );
    let named = format!("resources/{}", half.scene_file());
    let motion = format!("resources/{RECORDING}");
    let mut files: Vec<(&str, &[u8])> = vec![
        ("modelDescription.xml", xml.as_bytes()),
        (named.as_str(), text.as_bytes()),
        (binary.as_str(), library),
    ];
    if let Some(recording) = &recording {
        files.push((motion.as_str(), recording.as_bytes()));
    }
    archive::pack(&files).map_err(|file| {
        scene.error(
            "operator.motion.file",
            format!("{file} is too large for an FMU"),
            "give a shorter recording",
        )
    })
}

/// Name of a scene's recording in the FMU's resources.
const RECORDING: &str = "motion.csv";

/// The scene with the recording's path in the FMU's resources, and the recording's text; `None` if the scene has no recording.
fn moved_inside(scene: &Scene) -> Result<(Scene, Option<String>)> {
    let mut inside = scene.clone();
    let MotionSpec::Recorded(recorded) = &mut inside.operator.motion else {
        return Ok((inside, None));
    };
    let file = std::mem::replace(&mut recorded.file, PathBuf::from(RECORDING));
    let text = input::text(&file, input::MOST_OF_RECORDING).map_err(|error| Error::Io {
        path: file,
        problem: error.to_string(),
        fix: "give a readable recording".to_owned(),
    })?;
    Ok((inside, Some(text)))
}

/// FMI's name of this operating system.
const fn platform() -> &'static str {
    if cfg!(target_os = "macos") {
        "darwin"
    } else if cfg!(windows) {
        "windows"
    } else {
        "linux"
    }
}
