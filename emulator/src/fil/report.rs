//! All of it, as a table.

use std::time::Instant;

use touchstone_protocol::settings::Decimal;

use super::campaign::{Campaign, Outcome};
use super::fault::Random;
use super::list::{Expect, Injection, WITH_AS5047P, WITH_MT6701, WITH_TRACKS};
use super::{press, storage};
use crate::bench::{Bench, MS, Setup};
use crate::board::{Board, Encoder};
use crate::cpu::elf::Program;
use touchstone_protocol::{Reply, Request};

/// The slowest and the fastest clock that the watchdog may have, Hz.
const SLOW_LSI: u64 = 29_500;
const FAST_LSI: u64 = 34_000;

/// What was found.
#[derive(Debug, Default)]
struct Tally {
    lines: Vec<String>,
    wrong: Vec<String>,
    rows: usize,
    simulated_s: f64,
}

impl Tally {
    fn check(&mut self, what: &str, result: Result<String, String>) {
        eprintln!("{what}: {result:?}");
        match result {
            Ok(text) => self.lines.push(format!("{what}: {text}")),
            Err(error) => {
                self.lines.push(format!("{what}: WRONG, {error}"));
                self.wrong.push(format!("{what}: {error}"));
            }
        }
    }

    fn print(&mut self) {
        for line in self.lines.drain(..) {
            println!("{line}");
        }
    }
}

/// Runs everything whose name contains `only`; the exit code. Progress goes to standard error, the table to standard output.
#[must_use]
pub fn run(program: &Program, only: Option<&str>) -> u8 {
    let started = Instant::now();
    let slow = Setup {
        lsi_hz: SLOW_LSI,
        ..Setup::default()
    };
    let sets = [
        (WITH_AS5047P, slow),
        (
            WITH_MT6701,
            Setup {
                encoder: Encoder::Mt6701,
                lsi_hz: FAST_LSI,
            },
        ),
        (
            WITH_TRACKS,
            Setup {
                encoder: Encoder::Incremental(16_384),
                lsi_hz: FAST_LSI,
            },
        ),
    ];
    let mut tallies = std::thread::scope(|scope| {
        // Two threads, two processors; each device is a world of its own, so the order does not matter.
        let first = scope.spawn(|| injections(program, &sets[..1], only));
        let second = scope.spawn(|| {
            let mut tally = Tally::default();
            if only.is_none() {
                presses(program, &mut tally);
                others(program, &mut tally);
            }
            let more = injections(program, &sets[1..], only);
            tally.lines.extend(more.lines);
            tally.wrong.extend(more.wrong);
            tally.rows += more.rows;
            tally.simulated_s += more.simulated_s;
            tally
        });
        [second.join(), first.join()].map(|joined| {
            joined.unwrap_or_else(|_| Tally {
                wrong: vec!["the emulator itself panicked".into()],
                ..Tally::default()
            })
        })
    });
    tallies.iter_mut().for_each(Tally::print);
    let wrong: Vec<String> = tallies
        .iter_mut()
        .flat_map(|tally| tally.wrong.drain(..))
        .collect();
    let rows: usize = tallies.iter().map(|tally| tally.rows).sum();
    let simulated: f64 = tallies.iter().map(|tally| tally.simulated_s).sum();
    let wall = started.elapsed().as_secs_f64();
    println!("\n{simulated:.1} s of the device in {wall:.1} s, on two threads");
    for line in &wrong {
        println!("WRONG: {line}");
    }
    println!("{rows} injections, {} wrong", wrong.len());
    u8::from(!wrong.is_empty())
}

fn seconds(bench: &Bench) -> f64 {
    bench.now() as f64 / (1_000 * MS) as f64
}

fn injections(program: &Program, sets: &[(&[Injection], Setup)], only: Option<&str>) -> Tally {
    let mut tally = Tally::default();
    for (list, setup) in sets {
        let mut list: Vec<_> = list.to_vec();
        list.retain(|injection| only.is_none_or(|only| injection.name.contains(only)));
        if list.is_empty() {
            continue;
        }
        tally.lines.push(format!(
            "\nwith {:?}, the watchdog's clock at {} Hz",
            setup.encoder, setup.lsi_hz
        ));
        let head = [
            "injection",
            "state",
            "at us",
            "off after us",
            "allowed us",
            "latched",
        ];
        tally.lines.push(format!(
            "{:<38}{:<13}{:>6}{:>14}{:>12}  {}",
            head[0], head[1], head[2], head[3], head[4], head[5]
        ));
        let mut campaign = match Campaign::new(program, setup) {
            Ok(campaign) => campaign,
            Err(error) => {
                tally.check("boot", Err(error));
                continue;
            }
        };
        for injection in &list {
            let outcome = campaign.inject(injection);
            tally.rows += 1;
            row(&mut tally, injection, &outcome);
            let halted = campaign.bench().halted.is_some();
            if halted
                || outcome
                    .wrong
                    .as_ref()
                    .is_some_and(|wrong| wrong.starts_with("before"))
            {
                // The device is beyond help: the next one begins with another.
                tally.simulated_s += seconds(campaign.bench());
                match Campaign::new(program, setup) {
                    Ok(other) => campaign = other,
                    Err(_) => break,
                }
            }
        }
        tally.simulated_s += seconds(campaign.bench());
    }
    tally
}

fn row(tally: &mut Tally, injection: &Injection, outcome: &Outcome) {
    let off = match (injection.expect, outcome.off_us) {
        (_, Some(us)) => format!("{us:.1}"),
        (Expect::GoesOn, None) => "goes on".into(),
        (_, None) => "were off".into(),
    };
    let limit = match injection.expect {
        Expect::Off(us, _) | Expect::Reset(us, _) => us.to_string(),
        Expect::GoesOn => String::new(),
    };
    let code = outcome
        .code
        .map_or(String::from("-"), |code| format!("{code:?}"));
    let wrong = outcome
        .wrong
        .as_ref()
        .map_or(String::new(), |wrong| format!("  WRONG: {wrong}"));
    let state = format!("{:?}", injection.when).to_lowercase();
    let line = format!(
        "{:<38}{state:<13}{:>6}{off:>14}{limit:>12}  {code}{wrong}",
        injection.name, injection.moment_us
    );
    // Two threads take minutes: who watches sees them work.
    eprintln!("{line}");
    tally.lines.push(line);
    if !wrong.is_empty() {
        tally.wrong.push(format!(
            "{}, {state}:{}",
            injection.name,
            wrong.trim_start_matches("  WRONG:")
        ));
    }
}

fn presses(program: &Program, tally: &mut Tally) {
    let mut bench = match Bench::new(program, &Setup::default()) {
        Ok(bench) => bench,
        Err(error) => return tally.check("emulator", Err(error)),
    };
    let boot = bench.boot().map(|identity| format!("{identity:?}"));
    tally.check("boot", boot);
    for k in [Decimal::lit("1"), Decimal::lit("5")] {
        let pressed = press::press(&mut bench, k).map(|press| {
            format!(
                "{} ticks equal to the bit, {} in contact; at most {:.3} N·m; shows {:.3} N·m/rad, moves {} counts in the hold",
                press.compared, press.in_contact, press.max_force, press.shown, press.moves
            )
        });
        tally.check(&format!("thesis' press into {} N·m/rad", k.0), pressed);
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
    tally.simulated_s += seconds(&bench);
}

fn others(program: &Program, tally: &mut Tally) {
    let cuts = storage::power_cuts(program, 40);
    tally.check("power cut at writes to flash", cuts.map(|cuts| {
        format!("at each of the first {cuts} changes of a Save: the old or the new settings, each time")
    }));
    let damage = storage::damage(program, 24);
    tally.check("damaged settings", damage.map(|noticed| {
        format!("24 ways: {noticed} times SettingsInvalid and no arming, else the saved settings from another copy")
    }));
    tally.check("random frames", noise(program, 2_000));
    tally.check("the same twice", twice(program));
}

/// Random frames at the device's port, as fast as it takes them: nothing but counted errors.
///
/// # Errors
/// What became of the device.
pub fn noise(program: &Program, frames: u64) -> Result<String, String> {
    let mut bench = Bench::new(program, &Setup::default())?;
    bench.boot()?;
    bench.demand(Request::Telemetry { decimation: 0 })?;
    let mut random = Random(0xdead_beef_cafe_f00d);
    let resets = bench.machine.resets.len();
    for _ in 0..frames.div_ceil(50) {
        let mut bytes = Vec::new();
        for _ in 0..50 {
            let length = 1 + random.bits() % 24;
            bytes.extend((0..length).map(|_| random.byte().max(1)));
            bytes.push(0);
        }
        bench.send(&bytes);
        bench.run_until("the line quiet", 5_000 * MS, |bench| {
            bench.machine.chip_mut().link().on_the_line() == 0
        })?;
    }
    bench.run(20 * MS)?;
    let Reply::Counters(counters) = bench.demand(Request::Counters)? else {
        return Err("no counters".into());
    };
    let status = bench.status()?;
    let frames = frames.div_ceil(50) * 50;
    if bench.machine.resets.len() != resets || status.fault.is_some() || bench.is_on() {
        return Err(format!("{status:?}"));
    }
    if u64::from(counters.decode_errors) < frames * 9 / 10 {
        return Err(format!(
            "{} counted errors in {frames} frames",
            counters.decode_errors
        ));
    }
    Ok(format!(
        "{frames} frames, {} counted errors, nothing else",
        counters.decode_errors
    ))
}

/// Boots the program of a board, calibrates, arms, presses; what the device said, line by line.
///
/// # Errors
/// What fails.
pub fn boot(program: &Program, board: Board) -> Result<String, String> {
    let mut bench = Bench::on(board, program, &Setup::default())?;
    println!("{:?}", bench.boot()?);
    let pressed = press::press(&mut bench, Decimal::lit("5"))?;
    println!("{:?}", bench.demand(Request::Counters)?);
    println!(
        "not modelled, but used: {:x?}",
        bench.machine.chip().unknown
    );
    Ok(format!(
        "{} ticks equal to the bit; {:.1} s of the device; SYSCLK {} Hz",
        pressed.compared,
        seconds(&bench),
        bench.machine.chip().sysclk_hz()
    ))
}

/// The same program and the same steps give the same to the bit.
fn twice(program: &Program) -> Result<String, String> {
    let once = || -> Result<_, String> {
        let mut bench = Bench::new(program, &Setup::default())?;
        bench.boot()?;
        bench.arm()?;
        bench.run(100 * MS)?;
        let chip = bench.machine.chip();
        let memory = bench.machine.memory(crate::cpu::RAM, 24 * 1024);
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
    match once()? == once()? {
        true => Ok("RAM, world, times and telemetry are equal to the bit".into()),
        false => Err("two runs differ".into()),
    }
}
