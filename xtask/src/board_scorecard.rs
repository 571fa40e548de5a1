//! `cargo xtask fil --scorecard`: runs the scorecard (scripted actions of a simulated hand) on the firmware of the emulated
//! reference board. Compares the measured figures with those of the desktop simulation of the same scene.

use std::path::PathBuf;

use crate::firmware::REFERENCE;
use crate::outcome::Outcome;
use crate::{emulator, shell};

/// Name of the scene file that describes the reference board's knob.
const SCENE: &str = "gimbal-knob";
/// Settings of the board that the scene file lacks: bandwidth of the shipped current loop in hertz, and delay from the encoder's
/// reading to the new current command in seconds (one PWM period).
const LOOP: [&str; 2] = [
    "device.current_loop.bandwidth_hz=600",
    "timing.computational_delay_s=0.00005",
];
/// Positions of the wall's surface, in fractions of an encoder count from the scene file's position. The board runs once at each,
/// so that each figure has a range. With a single position, two of nine figures lay outside the desktop's range.
const PLACES: [&str; 4] = ["0", "0.25", "0.5", "0.75"];
/// Largest relative deviation (a tenth) at which a figure of the board still counts as equal to the desktop's.
const SAME: &str = "0.1";

/// Compares board and desktop for all grips and actions of the simulated hand if `is_whole`; otherwise only for a press with a
/// medium grip, which takes seconds.
pub fn run(is_whole: bool) -> Outcome {
    played(is_whole).unwrap_or_else(|outcome| outcome)
}

fn played(is_whole: bool) -> Result<Outcome, Outcome> {
    shell::built_with_tests()?;
    let (emulator, programs) = emulator::firmware_and_emulator(&[REFERENCE])?;
    let folder = shell::target("board-scorecard");
    let made = std::fs::create_dir_all(&folder);
    made.map_err(|why| Outcome::Failed(format!("{}: {why}", folder.display())))?;
    let mut recordings = Vec::new();
    for place in PLACES {
        let [programme, recording] =
            ["programme", "recording"].map(|name| folder.join(format!("{name}-{place}.csv")));
        let mut write = touchstone();
        write.args([
            "scorecard",
            SCENE,
            "--force",
            "--place",
            place,
            "--programme",
        ]);
        write.arg(&programme);
        if !is_whole {
            write.args(["--grip", "medium", "--deed", "press"]);
        }
        shell::run(&mut write).went_well()?;
        let mut play = shell::program(&emulator);
        play.arg("play").args(&programs).arg(REFERENCE);
        shell::run(play.arg(&programme).arg(&recording)).went_well()?;
        recordings.push(recording);
    }
    let compared = |name: &str| {
        let mut compare = touchstone();
        compare.arg("compare").arg(&recordings[0]).arg(SCENE);
        for also in &recordings[1..] {
            compare.arg("--also").arg(also);
        }
        compare.args(["--hand", "programme", "--force", "--out"]);
        compare.arg(folder.join(name));
        compare
    };
    if is_whole {
        println!("\nbeside the scene as it is");
        shell::run(&mut compared("as-it-is")).went_well()?;
        println!("\nbeside the scene with the board's current loop");
    }
    let mut with_loop = compared("with-loop");
    for field in LOOP {
        with_loop.args(["--set", field]);
    }
    with_loop.args(["--tolerance", SAME]);
    let mut last = String::new();
    let code = shell::exit_code(&mut with_loop, |line| {
        if line.contains("beyond both") {
            last = line.to_owned();
        }
    });
    match code {
        Ok(Some(0)) => Ok(Outcome::Ok(last)),
        Ok(_) => Ok(Outcome::Failed(format!(
            "the board's scorecard is not the desktop's: {last}"
        ))),
        Err(why) => Ok(Outcome::Failed(why.to_string())),
    }
}

fn touchstone() -> std::process::Command {
    let program: PathBuf = shell::target("debug").join("touchstone");
    shell::program(program)
}
