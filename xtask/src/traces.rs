//! `cargo xtask traces [--write]`: draws the signals to expect at the first power-up of a board, as pictures for the build guide,
//! in the folder `docs/first-power`.
//!
//! The boards' firmware runs in the emulator, which records the signals as tables; an example program draws them. `--write`
//! replaces the committed pictures. Without it the step compares them with the new ones.

use std::path::Path;

use crate::outcome::Outcome;
use crate::{emulator, shell};

/// Folder of the committed pictures.
const KEPT: &str = "docs/first-power";
const PICTURES: [&str; 4] = ["pwm.svg", "step.svg", "calibration.svg", "press.svg"];
/// Largest allowed size of a picture file, in bytes.
const LARGEST: usize = 60_000;
const BOARDS: [&str; 2] = ["nucleo-g474re-ihm16m1", "nucleo-g474re"];
/// Recordings to make: index in `BOARDS`, signal, file name of the table.
const TABLES: [(usize, &str, &str); 5] = [
    (0, "pwm", "pwm.csv"),
    (1, "pwm", "pwm-ihm08m1.csv"),
    (0, "step", "step.csv"),
    (0, "calibration", "calibration.csv"),
    (0, "press", "press.csv"),
];

pub fn run(args: &[String]) -> Outcome {
    let write = match args {
        [] => false,
        [option] if option == "--write" => true,
        _ => return Outcome::Usage("cargo xtask traces [--write]".into()),
    };
    drawn(write).unwrap_or_else(|outcome| outcome)
}

fn drawn(write: bool) -> Result<Outcome, Outcome> {
    let (emulator, programs) = emulator::firmware_and_emulator(&BOARDS)?;
    let folder = shell::target("traces");
    std::fs::create_dir_all(&folder).map_err(|why| failed(&folder, &why))?;
    for (board, what, table) in TABLES {
        let mut trace = shell::program(&emulator);
        trace.arg("trace").arg(&programs[board]);
        trace.args([BOARDS[board], what]).arg(folder.join(table));
        shell::run(&mut trace).went_well()?;
    }
    let kept = shell::root().join(KEPT);
    let out = if write { &kept } else { &folder };
    let mut draw = shell::cargo_locked("run");
    draw.args(["--release", "--package", "touchstone-lab"]);
    draw.args(["--example", "first_power", "--"]);
    shell::run(draw.arg(&folder).arg(out)).went_well()?;
    let mut bytes = 0;
    for name in PICTURES {
        let read = |folder: &Path| {
            let file = folder.join(name);
            std::fs::read(&file).map_err(|why| failed(&file, &why))
        };
        let picture = read(out)?;
        bytes += picture.len();
        if picture.len() > LARGEST {
            let size = picture.len();
            return Err(Outcome::Failed(format!("{name} has {size} bytes")));
        }
        if picture != read(&kept)? {
            return Err(Outcome::Failed(format!(
                "{KEPT}/{name} is another than what the programs show now: look at {}, then cargo xtask traces --write",
                out.join(name).display()
            )));
        }
    }
    Ok(Outcome::Ok(format!(
        "{} pictures, {bytes} bytes, {}",
        PICTURES.len(),
        if write { "written" } else { "as they are kept" }
    )))
}

fn failed(place: &Path, why: &std::io::Error) -> Outcome {
    Outcome::Failed(format!("{}: {why}", place.display()))
}
