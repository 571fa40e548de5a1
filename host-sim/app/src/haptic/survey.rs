//! `touchstone device survey`: records a device's mechanics (inertia, Jacobian, ranges) as its library reports them.

use super::choice::{HapticKind, WhichDevice};
use crate::out::{self, tell};
use crate::whole::{Named, Overwrite};
use crate::{interrupt, number};
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use touchstone_device::haptic::HapticDevice;
use touchstone_device::{Pose, Survey};
use touchstone_sim::error::{Error, Result};

/// Options of `device survey`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    #[command(flatten)]
    which: WhichDevice,
    /// The file to write.
    #[arg(long, value_name = "FILE.toml")]
    out: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
    /// Duration of the survey; move the effector through its whole workspace meanwhile.
    #[arg(long, value_name = "N", default_value_t = 20.0, allow_negative_numbers = true, value_parser = number::up_to(3600.0, "of seconds"))]
    seconds: f64,
}

/// Time between two recorded poses: short enough for a hand's motion, long enough for a file that people can read.
const PAUSE: Duration = Duration::from_millis(100);

/// Runs the survey. The motors are never switched on.
pub fn main(options: &Options) -> Result<()> {
    options.which.check()?;
    let model = options.which.model();
    if let Some(other) = model.filter(|kind| *kind != HapticKind::Omega3) {
        return Err(Error::Option {
            option: "--device".into(),
            problem: format!(
                "the program does not know the mechanism of {}, so it cannot survey it",
                other.word()
            ),
            fix: "survey an omega.3".into(),
        });
    }
    let place_of_file = Named {
        path: &options.out,
        option: "--out",
        replaces: options.overwrite.force,
    };
    place_of_file.check()?;
    let stop = interrupt::noted()?;
    let (mut omega, _) = options.which.omega3()?;
    let place = omega.sheet().name.clone();
    tell!(
        "{place}: move it through its whole workspace for {} s",
        options.seconds
    );
    let begun = Instant::now();
    let mut poses = Vec::new();
    while begun.elapsed().as_secs_f64() < options.seconds && !stop.load(Ordering::Relaxed) {
        poses.push(Pose::now(&mut omega).map_err(|fault| fault.at(&place))?);
        std::thread::sleep(PAUSE);
    }
    let survey = Survey::of(&mut omega, poses);
    omega.release().map_err(|fault| fault.at(&place))?;
    let survey = survey.map_err(|fault| fault.at(&place))?;
    let text = survey
        .to_toml()
        .map_err(|error| place_of_file.error(&std::io::Error::other(error)))?;
    place_of_file.write(text)?;
    out::result(
        || {
            serde_json::json!({
                "file": options.out.display().to_string(),
                "poses": survey.pose.len(),
                "inertia_kg": survey.inertia_kg,
            })
        },
        || {
            let [x, y, z] = survey.inertia_kg;
            tell!(
                "inertia   {x:.3} {y:.3} {z:.3} kg, mean of {} poses",
                survey.pose.len()
            );
            tell!(
                "file      {}; simulate it: touchstone device run plane --twin {0}",
                options.out.display()
            );
            Ok(())
        },
    )
}
