//! Tests of the device with damaged bits in its settings in flash.

use touchstone_control::Si;
use touchstone_protocol::settings::DeviceSettings;
use touchstone_protocol::{DeviceCommand, FaultCode, Phase, Reply, Request};

use super::fault::Random;
use crate::bench::{Bench, MS, Setup};
use crate::chip::ResetCause;
use crate::cpu::elf::Program;

/// Address and length in bytes of the settings in flash, from symbols of the linker script `memory.x`.
fn place(program: &Program) -> Result<(u32, usize), String> {
    let named = |name: &str| {
        let missing = || format!("the program has no {name}");
        program.symbol(name).ok_or_else(missing)
    };
    let start = named("_settings_start")?;
    Ok((start, (named("_settings_end")? - start) as usize))
}

/// Sets the wall's stiffness to `k`, to make the settings differ from the defaults and from earlier ones.
///
/// # Errors
/// The device refuses the change.
pub fn changed(bench: &mut Bench, k: Si) -> Result<(), String> {
    bench.configure(|settings| settings.wall.k_desired_n_m_per_rad = k)
}

/// Switches the power off and on, and waits until the device has booted.
///
/// # Errors
/// The device does not answer.
pub fn restart(bench: &mut Bench) -> Result<(), String> {
    bench.machine.power_on(ResetCause::PowerOn);
    bench.halted = None;
    bench.boot().map(|_| ())
}

/// Damages the settings in flash `ways` times by flipping written bits, and restarts the device after each damage. The device must
/// then use another copy of the saved settings, or report `SettingsInvalid` and not arm. Returns how often the device reported the
/// damage.
///
/// # Errors
/// Another reaction of the device, with the damaged bits.
pub fn damage(program: &Program, setup: &Setup, ways: usize) -> Result<usize, String> {
    let (start, bytes) = place(program)?;
    let mut bench = Bench::new(program, setup)?;
    let Reply::Identity(identity) = bench.boot()? else {
        return Err("the device does not say who it is".into());
    };
    let defaults = DeviceSettings::defaults(identity.board);
    changed(&mut bench, Si::lit("2"))?;
    // Saved twice: damage to one of the two copies must have no effect.
    bench.demand(Request::Save)?;
    bench.demand(Request::Save)?;
    let saved = bench.settings()?;
    let clean = bench.machine.memory(start, bytes);
    let written: Vec<usize> = (0..clean.len()).filter(|at| clean[*at] != 0xff).collect();
    if written.is_empty() {
        return Err("nothing was written to flash".into());
    }
    let mut random = Random(0x2545_f491_4f6c_dd1d);
    let mut noticed = 0;
    for way in 0..ways {
        let mut bytes = clean.clone();
        // Flips one to sixteen bits.
        let mut places = Vec::new();
        for _ in 0..=(way % 16) {
            let at = written[(random.bits() % written.len() as u64) as usize];
            let bit = random.bits() % 8;
            bytes[at] ^= 1 << bit;
            places.push((at, bit));
        }
        bench.machine.set_memory(start, &bytes);
        restart(&mut bench)?;
        noticed += usize::from(
            is_safe(&mut bench, &saved, &defaults)
                .map_err(|error| format!("bits {places:?}: {error}"))?,
        );
    }
    bench.machine.set_memory(start, &clean);
    Ok(noticed)
}

/// Checks the device after its settings in flash were damaged. Returns whether it reported the damage; if it did not, all settings
/// must equal the saved ones.
fn is_safe(
    bench: &mut Bench,
    saved: &DeviceSettings,
    defaults: &DeviceSettings,
) -> Result<bool, String> {
    let status = bench.status()?;
    let code = status.fault.and_then(|fault| fault.known());
    let settings = bench.settings()?;
    match (status.phase, code) {
        (Phase::Boot, None) if settings == *saved => Ok(false),
        (Phase::Boot, None) => Err("other settings than the saved ones are used".into()),
        (Phase::Fault, Some(FaultCode::SettingsInvalid)) => {
            if settings != *defaults {
                return Err("neither the saved settings nor the defaults".into());
            }
            bench.demand(Request::Command(DeviceCommand::Stop))?;
            // The answer is ignored: a calibration with invalid settings ends in the same fault again.
            let _ = bench.command(DeviceCommand::Calibrate)?;
            bench.run(50 * MS)?;
            if bench.command(DeviceCommand::Arm)? || bench.is_on() {
                return Err("arms with refused settings".into());
            }
            Ok(true)
        }
        other => Err(format!("{other:?}")),
    }
}
