//! Runs the jobs of the fault-injection campaign on all processor cores of the host, and prints a table of the results.

use std::collections::BTreeSet;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use touchstone_protocol::{FaultCode, Request};

use super::jobs::{Asked, Programs, jobs};
use super::press;
use super::tally::Tally;
use crate::bench::{Bench, Setup};
use crate::board::Board;
use crate::cpu::elf::Program;

/// Exit code for a selection that matches no injection and no check.
const USAGE: u8 = 2;

/// Number of the slowest jobs that are listed with their times.
const SLOWEST: usize = 10;

/// Runs the selected jobs and returns the exit code. Progress goes to standard error, the table to standard output.
#[must_use]
pub fn run(programs: &Programs, asked: Asked<'_>) -> u8 {
    let started = Instant::now();
    let jobs = jobs(programs, asked);
    if let (Asked::Only(texts), true) = (asked, jobs.is_empty()) {
        eprintln!(
            "emulator: no injection or check has `{}` in its name; without --only the table shows them all",
            texts.join("` or `")
        );
        return USAGE;
    }
    let next = AtomicUsize::new(0);
    let done: Vec<Mutex<Option<(Tally, f64)>>> = jobs.iter().map(|_| Mutex::new(None)).collect();
    let threads =
        std::thread::available_parallelism().map_or(1, |count| count.get().min(jobs.len()));
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some((job, place)) = {
                    let at = next.fetch_add(1, Ordering::Relaxed);
                    jobs.get(at).zip(done.get(at))
                } {
                    let begun = Instant::now();
                    let tally = job.run();
                    if let Ok(mut place) = place.lock() {
                        *place = Some((tally, begun.elapsed().as_secs_f64()));
                    }
                }
            });
        }
    });
    let mut slowest: Vec<(f64, String)> = Vec::new();
    let mut tallies: Vec<Tally> = Vec::new();
    for (job, place) in jobs.iter().zip(done) {
        if let Some((tally, took_s)) = place.into_inner().ok().flatten() {
            tallies.push(tally);
            slowest.push((took_s, job.name()));
        }
    }
    slowest.sort_by(|one, other| other.0.total_cmp(&one.0));
    let mut wrong = Vec::new();
    if tallies.len() < jobs.len() {
        wrong.push("the emulator itself panicked".to_owned());
    }
    for tally in &tallies {
        tally.lines.iter().for_each(|line| println!("{line}"));
        wrong.extend(tally.wrong.iter().cloned());
    }
    println!();
    let all_boards = programs.count() == Board::all().len();
    if all_boards && !matches!(asked, Asked::Only(_)) {
        let latched = tallies.iter().flat_map(|tally| &tally.latched).collect();
        wrong.extend(codes(&latched));
    }
    let rows: usize = tallies.iter().map(|tally| tally.rows).sum();
    println!(
        "{:.1} s of the devices in {:.1} s, on {threads} threads",
        tallies.iter().map(|tally| tally.simulated_s).sum::<f64>(),
        started.elapsed().as_secs_f64()
    );
    println!("the slowest:");
    for (took_s, name) in slowest.iter().take(SLOWEST) {
        println!("{took_s:>8.1} s  {name}");
    }
    for line in &wrong {
        println!("WRONG: {line}");
    }
    let sample = if asked.is_sample() {
        "; a sample, all of it by cargo xtask fil"
    } else {
        ""
    };
    println!("{rows} injections, {} wrong{sample}", wrong.len());
    u8::from(!wrong.is_empty())
}

/// Prints how many fault codes the injections caused. Returns an error text for each fault code that no injection caused.
fn codes(latched: &BTreeSet<&FaultCode>) -> Vec<String> {
    let mut wrong = Vec::new();
    for code in FaultCode::ALL.iter().filter(|code| !latched.contains(code)) {
        wrong.push(format!("no row latched {code:?}"));
    }
    println!(
        "{} of {} codes were latched",
        latched.len(),
        FaultCode::ALL.len()
    );
    wrong
}

/// Boots a board's program, calibrates, arms and presses; prints the device's replies, and returns a summary.
///
/// # Errors
/// The step that fails.
pub fn boot(program: &Program, setup: &Setup) -> Result<String, String> {
    let mut bench = Bench::new(program, setup)?;
    println!("{:?}", bench.boot()?);
    let pressed = press::press(&mut bench, setup.board.walls[1])?;
    println!("{:?}", bench.demand(Request::Counters)?);
    println!(
        "not modelled, but used: {:x?}",
        bench.machine.chip().unknown
    );
    Ok(format!(
        "{} ticks equal to the bit; {:.1} s of the device; SYSCLK {} Hz",
        pressed.compared,
        bench.now() as f64 / 170e6,
        bench.machine.chip().sysclk_hz()
    ))
}
