//! `touchstone device list`, `info`, `run`, `identify` and `survey`: haptic devices whose control law runs in this program.

mod account;
mod choice;
mod device_wall;
mod ended;
mod identify;
mod run;
mod scorecard;
mod survey;
mod trace;

pub use choice::{described, library};

use super::out::{self, say};
use choice::WhichDevice;
use clap::Subcommand;
use std::process::ExitCode;
use touchstone_device::haptic::HapticDevice;
use touchstone_device::ports;
use touchstone_sim::error::Result;

/// The actions on a haptic device.
#[derive(Debug, Clone, Subcommand)]
pub enum Action {
    /// Lists haptic devices, and boards at serial ports.
    List(WhichDevice),
    /// Shows a haptic device's identity, position and state. Its motors stay off.
    Info(WhichDevice),
    /// Renders a wall on a haptic device: THE MOTORS ARE ON until it ends, at the latest by Ctrl-C.
    Run(run::Options),
    /// Moves a haptic device that no hand holds by some millimetres, and measures mass, damping and friction of each axis: THE
    /// MOTORS ARE ON.
    Identify(identify::Options),
    /// Writes a haptic device's inertia, Jacobian and ranges to a file that can be simulated. Its motors stay off.
    Survey(survey::Options),
}

/// Runs the chosen action.
pub fn main(action: &Action) -> Result<ExitCode> {
    let done = match action {
        Action::Run(options) => return run::main(options),
        Action::Identify(options) => return identify::main(options),
        Action::List(which) => list(which),
        Action::Info(which) => info(which),
        Action::Survey(options) => survey::main(options),
    };
    done.map(|()| ExitCode::SUCCESS)
}

/// Lists the devices found. For each type of which none was found, gives the reason.
fn list(which: &WhichDevice) -> Result<()> {
    which.check()?;
    let found = which.all();
    let boards = ports();
    let entry = |(kind, found): &(choice::HapticKind, Result<String>)| match found {
        Ok(text) => serde_json::json!({ "device": kind.word(), "there": true, "text": text }),
        Err(error) => {
            serde_json::json!({ "device": kind.word(), "there": false, "text": error.to_string() })
        }
    };
    out::result(
        || {
            serde_json::json!({
                "devices": found.iter().map(entry).collect::<Vec<_>>(),
                "boards": boards.iter().map(|port| &port.name).collect::<Vec<_>>(),
            })
        },
        || {
            for (kind, found) in &found {
                match found {
                    Ok(text) => say!("there    {:<10} {text}", kind.word()),
                    Err(error) => say!("-        {:<10} {error}", kind.word()),
                }
            }
            for port in &boards {
                let about = port.about.trim();
                say!(
                    "board    {:<10} {about}; it runs the control law itself: touchstone device status --port {0}",
                    port.name
                );
            }
            Ok(())
        },
    )
}

/// Opens a device, prints its properties, and releases it.
fn info(which: &WhichDevice) -> Result<()> {
    let mut device = which.open(choice::SimulatedHand::Still)?;
    let place = device.sheet().name.clone();
    let seen = device
        .standing()
        .and_then(|standing| device.sense().map(|sensed| (standing, sensed)));
    let released = device.release();
    let (standing, sensed) = seen.map_err(|fault| fault.at(&place))?;
    released.map_err(|fault| fault.at(&place))?;
    let sheet = device.sheet();
    let (slowest, fastest) = sheet.rates_hz;
    out::result(
        || {
            serde_json::json!({
                "device": sheet.name,
                "degrees_of_freedom": sheet.degrees,
                "force_limit_n": sheet.force_n,
                "workspace_radius_m": sheet.workspace.radius_m,
                "workspace_half_height_m": sheet.workspace.half_height_m,
                "count_m": sheet.count_m,
                "rates_hz": [slowest, fastest],
                "position_m": sensed.position_m,
                "powered": standing.powered,
                "calibrated": standing.calibrated,
                "motors_on": standing.motors_on,
            })
        },
        || {
            say!("device     {}", sheet.name);
            say!(
                "freedom    {} axes, up to {} N",
                sheet.degrees,
                sheet.force_n
            );
            say!(
                "workspace  {:.0} mm across, {:.0} mm of height, in steps of {:.3} mm",
                2e3 * sheet.workspace.radius_m,
                2e3 * sheet.workspace.half_height_m,
                1e3 * sheet.count_m
            );
            say!("rate       {slowest} to {fastest} Hz");
            let [x, y, z] = sensed.position_m.map(|x| 1e3 * x);
            say!("position   {x:.2} {y:.2} {z:.2} mm");
            let yes = |is: bool| if is { "yes" } else { "no" };
            say!(
                "state      supply {}, calibrated {}, motors on {}",
                yes(standing.powered),
                yes(standing.calibrated),
                yes(standing.motors_on)
            );
            Ok(())
        },
    )
}
