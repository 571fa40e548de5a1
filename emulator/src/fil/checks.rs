//! Checks that are not fault injections: a hand's press on the wall, settings in flash, noise on the serial line, and the
//! repeatability of the emulator.

use touchstone_protocol::{DeviceCommand, FaultCode, Phase, Reply, Request};

use super::fault::Random;
use super::tally::Tally;
use super::{
    around, cogging, eccentricity, lasting, noisy, over_current, press, registers, starts, storage,
    supply,
};
use crate::bench::{Bench, MS, Setup};
use crate::cpu::RAM;
use crate::cpu::elf::Program;

/// A check: its name, by which it can be selected, and its function.
pub type Check = (&'static str, fn(&Program, &Setup, &mut Tally));

/// The checks that run on each board.
pub const CHECKS: &[Check] = &[
    ("boot and presses", presses),
    ("power cuts", supply::power_cuts),
    ("supply cut", supply::supply_cut),
    ("damaged settings", damaged_settings),
    ("more than one wall", around::around),
    ("random frames", random_frames),
    ("registers after the start", registers::registers),
    ("kept alignment", starts::kept_alignment),
    ("start by itself", starts::start_by_itself),
    ("cogging", cogging::cogging),
    (
        "over-current by the comparators",
        over_current::over_current,
    ),
    ("eccentricity", eccentricity::eccentricity),
    ("noise in the sensors", noisy::noisy),
    ("cable pulled", lasting::cable_pulled),
    ("a hand that leans", lasting::leaning_hand),
    (
        "a calibration that the motor does not bear",
        lasting::weak_motor,
    ),
];

/// The check that runs only once, because it tests the emulator and no board.
pub const OF_THE_EMULATOR: Check = ("the same twice", the_same_twice);

/// Number of random frames that the fault-injection campaign sends. `touchstone-emulator noise` sends as many as requested, for
/// instance a million.
const NOISE_FRAMES: u64 = 2_000;

fn presses(program: &Program, setup: &Setup, tally: &mut Tally) {
    let mut bench = match Bench::new(program, setup) {
        Ok(bench) => bench,
        Err(error) => return tally.check("emulator", Err(error)),
    };
    let boot = bench.boot().map(|identity| format!("{identity:?}"));
    tally.check("boot", boot);
    for k in setup.board.walls {
        let pressed = press::press(&mut bench, k).map(|press| {
            format!(
                "{} ticks equal to the bit, {} in contact; at most {:.3} N·m; shows {:.3} N·m/rad, moves {} counts in the hold",
                press.compared, press.in_contact, press.max_force, press.shown, press.moves
            )
        });
        tally.check(
            &format!("press of {} N·m into {k} N·m/rad", setup.board.press_n_m),
            pressed,
        );
    }
    let used = program.symbol("_stack_start").map(|top| {
        let bottom = program.symbol("_stack_end").unwrap_or(top);
        (bench.machine.stack_used(top), top - bottom)
    });
    tally.check(
        "stack",
        match used {
            Some((used, size)) if used <= size => Ok(format!("{used} of {size} bytes were used")),
            Some((used, size)) => Err(format!("{used} bytes were used, and there are {size}")),
            None => Err("the program has no _stack_start".into()),
        },
    );
    tally.ran(&bench);
}

fn damaged_settings(program: &Program, setup: &Setup, tally: &mut Tally) {
    const WAYS: usize = 24;
    let damage = storage::damage(program, setup, WAYS);
    if let Ok(1..) = damage {
        tally.latched.insert(FaultCode::SettingsInvalid);
    }
    tally.check("damaged settings", damage.map(|noticed| {
        format!("{WAYS} ways: {noticed} times SettingsInvalid and no arming, else the saved settings from another copy")
    }));
}

fn random_frames(program: &Program, setup: &Setup, tally: &mut Tally) {
    tally.check("random frames", noise(program, setup, NOISE_FRAMES));
}

/// Sends random frames to the device's serial port as fast as the port takes them. Each frame must cause one counted error and no
/// reply.
///
/// One third of the frames are random bytes, mostly invalid in the framing COBS. One third are valid COBS with random content. One
/// third are requests that would switch on, reset or write flash, with one flipped bit.
///
/// # Errors
/// The device's wrong reaction.
pub fn noise(program: &Program, setup: &Setup, frames: u64) -> Result<String, String> {
    let mut bench = Bench::new(program, setup)?;
    bench.boot()?;
    bench.demand(Request::Telemetry { decimation: 0 })?;
    let mut random = Random(0xdead_beef_cafe_f00d);
    let resets = bench.machine.resets.len();
    bench.run(20 * MS)?;
    let sent_before = bench.link.bytes;
    for _ in 0..frames.div_ceil(50) {
        let mut bytes = Vec::new();
        for _ in 0..50 {
            bytes.extend(bad_frame(&mut bench, &mut random));
        }
        bench.send(&bytes);
        bench.run_until("the line quiet", 5_000 * MS, |bench| {
            bench.machine.chip_mut().link().on_the_line() == 0
        })?;
    }
    bench.run(20 * MS)?;
    let frames = frames.div_ceil(50) * 50;
    let answers = bench.link.bytes - sent_before;
    if answers != 0 {
        return Err(format!("{answers} bytes of answers to {frames} bad frames"));
    }
    let Reply::Counters(counters) = bench.demand(Request::Counters)? else {
        return Err("no counters".into());
    };
    let status = bench.status()?;
    if u64::from(counters.decode_errors) != frames {
        return Err(format!(
            "{} counted errors in {frames} bad frames",
            counters.decode_errors
        ));
    }
    if bench.machine.resets.len() != resets || status.phase != Phase::Boot || bench.is_on() {
        return Err(format!("{status:?}"));
    }
    Ok(format!(
        "{frames} frames, {} counted errors, nothing else",
        counters.decode_errors
    ))
}

/// An invalid frame with its terminating zero, which no device may accept.
fn bad_frame(bench: &mut Bench, random: &mut Random) -> Vec<u8> {
    let length = 1 + random.bits() % 24;
    let mut content: Vec<u8> = (0..length).map(|_| random.byte().max(1)).collect();
    let mut frame = match random.bits() % 3 {
        0 => content,
        1 => {
            // COBS of content without zeros: the first byte is the distance to the end.
            content.insert(0, length as u8 + 1);
            content
        }
        _ => {
            let requests = [
                Request::Command(DeviceCommand::Calibrate),
                Request::Command(DeviceCommand::Reboot),
                Request::Save,
                Request::Telemetry { decimation: 1 },
            ];
            let request = requests[random.bits() as usize % requests.len()].clone();
            let (_, mut frame) = bench.link.ask(request);
            frame.pop();
            loop {
                let at = random.bits() as usize % frame.len();
                let turned = frame[at] ^ 1 << (random.bits() % 8);
                // A zero would split the frame in two.
                if turned != 0 {
                    frame[at] = turned;
                    break frame;
                }
            }
        }
    };
    frame.push(0);
    frame
}

/// Checks that two runs of the same program with the same steps give identical results, bit for bit.
fn the_same_twice(program: &Program, setup: &Setup, tally: &mut Tally) {
    let once = || -> Result<_, String> {
        let mut bench = Bench::new(program, setup)?;
        bench.boot()?;
        bench.configure(|_| ())?;
        bench.arm()?;
        bench.run(100 * MS)?;
        let chip = bench.machine.chip();
        let memory = bench.machine.memory(RAM, chip.board.ram_bytes);
        let world = (
            chip.world.angle_rad().to_bits(),
            chip.core.now,
            chip.core.spent,
        );
        Ok((
            memory,
            world,
            chip.bridge.changes.clone(),
            bench.link.telemetry.clone(),
        ))
    };
    let compared = once().and_then(|first| match first == once()? {
        true => Ok("RAM, world, times and telemetry are equal to the bit".into()),
        false => Err("two runs differ".into()),
    });
    tally.check("the same twice", compared);
}
