//! Settings in flash: damaged bits, and the power cut at each of the writes.

use touchstone_control::Si;
use touchstone_protocol::settings::DeviceSettings;
use touchstone_protocol::{DeviceCommand, FaultCode, Phase, Reply, Request};

use super::fault::Random;
use crate::bench::{Bench, MS, Setup};
use crate::chip::ResetCause;
use crate::cpu::elf::Program;
use crate::machine::Halt;

/// Where the program keeps its settings, and how many bytes: `memory.x` says it to the linker.
fn place(program: &Program) -> Result<(u32, usize), String> {
    let named = |name: &str| {
        let missing = || format!("the program has no {name}");
        program.symbol(name).ok_or_else(missing)
    };
    let start = named("_settings_start")?;
    Ok((start, (named("_settings_end")? - start) as usize))
}

/// Something to tell apart from the defaults, and from one another.
fn changed(bench: &mut Bench, k: Si) -> Result<(), String> {
    bench.configure(|settings| settings.wall.k_desired_n_m_per_rad = k)
}

fn k_of(bench: &mut Bench) -> Result<Si, String> {
    Ok(bench.settings()?.wall.k_desired_n_m_per_rad)
}

fn restart(bench: &mut Bench) -> Result<(), String> {
    bench.machine.power_on(ResetCause::PowerOn);
    bench.halted = None;
    bench.boot().map(|_| ())
}

/// The field turns when it is asked for, and ends when it is not.
fn starts(bench: &mut Bench) -> Result<(), String> {
    bench.demand(Request::Command(DeviceCommand::Calibrate))?;
    let on = bench.run_until("the outputs on", 200 * MS, |bench| bench.is_on());
    let status = bench.status()?;
    on.map_err(|error| format!("{error}: {} with {:?}", status.phase.name(), status.fault))?;
    bench
        .demand(Request::Command(DeviceCommand::Stop))
        .map(|_| ())
}

/// Cuts the power at each change of the flash during `Save` until one is not cut any more; how many cuts there were. Each time the
/// settings afterwards must be the old or the new ones, and the device must take and keep further ones.
///
/// # Errors
/// What is wrong after which cut.
pub fn power_cuts(program: &Program, setup: &Setup, at_most: u64) -> Result<u64, String> {
    let (old, new) = (Si::lit("2"), Si::lit("3"));
    let mut bench = Bench::new(program, setup)?;
    bench.boot()?;
    for cut in 0..at_most {
        let said = |error: String| format!("cut at change {cut}: {error}");
        changed(&mut bench, old)?;
        bench.demand(Request::Save).map_err(said)?;
        changed(&mut bench, new)?;
        let flash = &mut bench.machine.chip_mut().flash;
        flash.cut_at = Some(flash.count + cut);
        let saved = bench.demand(Request::Save);
        bench.machine.chip_mut().flash.cut_at = None;
        match (saved, bench.halted.take()) {
            // All its changes came before the cut.
            (Ok(_), None) => return Ok(cut),
            (Err(_), Some(Halt::PowerCut)) => {}
            (Err(error), _) => return Err(said(error)),
            (Ok(_), Some(halt)) => return Err(said(format!("{halt:?}"))),
        }
        restart(&mut bench).map_err(said)?;
        let status = bench.status()?;
        if status.phase != Phase::Boot {
            return Err(said(format!(
                "{} with {:?}",
                status.phase.name(),
                status.fault
            )));
        }
        // A word that was torn interrupts when it is read, and pulls the system's break: it must be over by now.
        starts(&mut bench).map_err(said)?;
        let k = k_of(&mut bench)?;
        if k != old && k != new {
            return Err(said(format!("k_desired is {k}")));
        }
    }
    Ok(at_most)
}

/// Damages the settings in flash in `ways` ways, one after the other: bits turned over in what was written. After each the
/// device has the saved settings (another copy holds), or says `SettingsInvalid` and does not arm.
///
/// # Errors
/// What is wrong after which damage. Else how many of them were noticed.
pub fn damage(program: &Program, setup: &Setup, ways: usize) -> Result<usize, String> {
    let (start, bytes) = place(program)?;
    let mut bench = Bench::new(program, setup)?;
    let Reply::Identity(identity) = bench.boot()? else {
        return Err("the device does not say who it is".into());
    };
    let defaults = DeviceSettings::defaults(identity.board);
    changed(&mut bench, Si::lit("2"))?;
    // Twice: what damages one copy only must do no harm.
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
        // From a single bit to sixteen of them.
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

/// Whether the damage was noticed. If it was not, everything must be as it was saved: not only the value that was changed.
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
            // A calibration with refused settings ends in the fault again.
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
