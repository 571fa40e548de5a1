//! Tests with faults of the link between program and device. After every fault the device is off, or the program has printed that
//! the device may still be on.
//!
//! A proxy between program and device drops, damages or delays frames, blocks one direction, or cuts the connection. A seed chooses
//! the fault, its time and its strength. `TOUCHSTONE_LINK_FAULTS` is the number of seeds. `cargo xtask links`, a step of `cargo xtask
//! test --full`, sets 100 to 1000. This runs 1000 seeds with each program:
//!
//! ```text
//! TOUCHSTONE_LINK_FAULTS=1000 cargo test -p touchstone --test device link_faults -- --nocapture --test-threads 1
//! ```

pub mod page;
pub mod proxy;

use crate::fake::Fake;
use crate::haply_mock::{Service, Wrong};
use crate::{Said, folder, program};
use page::PageEnd;
use proxy::{Fault, Proxy, Unit};
use std::collections::BTreeMap;
use std::process::{Child, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use touchstone_control::Si;
use touchstone_protocol::{Machine, Phase, State};

/// Text by which a program says that a device may be on.
const MAY_BE_ON: &str = "THE DEVICE MAY STILL BE ON";
/// Warning of a program that uses a board whose host watchdog is off.
const UNWATCHED: &str = "this device stays on when the computer hangs";
/// Number of seeds for each program in an ordinary run of the tests.
const FEW: u64 = 10;
/// Number of programs that run at the same time: in an ordinary run, and with `TOUCHSTONE_LINK_FAULTS`. They wait most of the time.
const AT_ONCE: [usize; 2] = [10, 24];
/// Longest allowed time of a program, with a margin for a busy machine.
const LONGEST: Duration = Duration::from_secs(90);

/// Runs `case` for all seeds, several at a time, and prints how often each ending occurred. `case` returns the ending as text. It
/// panics if a device was left on without a message.
fn each(name: &str, case: impl Fn(u64) -> String + Sync) {
    let asked = std::env::var("TOUCHSTONE_LINK_FAULTS").ok();
    let at_once = AT_ONCE[usize::from(asked.is_some())];
    let seeds = asked.map_or(FEW, |count| count.parse().expect("a number of seeds"));
    let next = AtomicU64::new(0);
    let endings = Mutex::new(BTreeMap::<(&str, String), u32>::new());
    std::thread::scope(|scope| {
        for _ in 0..at_once {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= seeds {
                        return;
                    }
                    let ending = case(seed);
                    let fault = Fault::of(seed).kind();
                    let mut endings = endings.lock().unwrap();
                    *endings.entry((fault, ending)).or_default() += 1;
                }
            });
        }
    });
    for ((fault, ending), count) in endings.into_inner().unwrap() {
        println!("{name}: {fault:<9} {count:>5}  {ending}");
    }
}

/// Waits for the end of a program.
fn ended(mut child: Child, seed: u64) -> Said {
    let begun = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begun.elapsed() > LONGEST {
            child.kill().unwrap();
            panic!("seed {seed}: the program did not end");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    child.wait_with_output().unwrap().into()
}

/// Asserts that a program printed an error. Notes and warnings may come before it.
fn has_error(said: &Said, seed: u64) {
    let found = said.err.lines().any(|line| line.starts_with("error: "));
    assert!(found, "seed {seed}: {}", said.err);
}

fn started(arguments: &[&str]) -> Child {
    let mut command = program(arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

fn is_on(device: &Fake) -> bool {
    let phase = Phase::from(device.world().1.machine.state());
    matches!(phase, Phase::Armed | Phase::Calibrating)
}

/// Returns the ending as text: whether the device is on, and what program and page said. Panics if the device is on without a
/// message.
fn judged(seed: u64, said: &Said, shown: &str, device: &Fake) -> String {
    let on = is_on(device);
    let told = said.err.contains(MAY_BE_ON) || shown.contains(MAY_BE_ON);
    if on {
        assert!(
            told,
            "seed {seed}: on and silent: {} {}",
            said.out, said.err
        );
        assert_eq!(said.code, Some(1), "seed {seed}: {}", said.err);
    }
    let state = if on { "on" } else { "off" };
    match (told, said.code) {
        (true, Some(1)) => format!("{state}, said that it may be on"),
        (true, _) => format!("{state}, said that it may be on, then that it is off"),
        (false, Some(0)) => format!("{state}, exit code 0"),
        (false, _) => format!("{state}, an error"),
    }
}

#[test]
fn a_monitor_says_that_an_armed_device_may_still_be_on() {
    each("monitor", |seed| {
        let device = Fake::new();
        {
            let (session, world) = &mut *device.world();
            let mut settings = session.settings().clone();
            // For every second seed the host watchdog is off, so a silent computer does not switch the device off.
            settings.limits.host_silence_s = if seed % 2 == 0 {
                Si::ZERO
            } else {
                Si::lit("2")
            };
            *session = touchstone_protocol::session::Session::new(settings, true);
            world.machine = Machine::at(State::Armed);
        }
        let proxy = Proxy::new(&device.address, Fault::of(seed), Unit::Frame);
        let said = ended(
            started(&["monitor", "--seconds", "0.8", "--port", &proxy.address]),
            seed,
        );
        let (session, _) = &*device.world();
        let watched = session.settings().limits.host_silence_s != Si::ZERO;
        match (said.code, said.err.contains(MAY_BE_ON)) {
            (Some(1), true) => "on, said that it may be on".into(),
            // A monitor switches nothing off. It ended at its time limit, and its records had shown that the device is armed.
            (Some(0), _) if watched => "on as before, the watchdog ends it".into(),
            (Some(0), _) => {
                assert!(said.err.contains(UNWATCHED), "seed {seed}: {}", said.err);
                "on as before, warned that nothing ends it".into()
            }
            (Some(1), false) => {
                // No record arrived: the program does not know that the device is armed, and reports that there is no answer.
                assert!(
                    !said.out.contains("armed"),
                    "seed {seed}: {} {}",
                    said.out,
                    said.err
                );
                has_error(&said, seed);
                "on as before, an error before the first record".into()
            }
            _ => panic!("seed {seed}: {:?} {}", said.code, said.err),
        }
    });
}

#[test]
fn a_page_s_program_leaves_no_device_on_in_silence() {
    each("live", |seed| {
        let device = Fake::new();
        let proxy = Proxy::new(&device.address, Fault::of(seed), Unit::Frame);
        let (said, shown) = page::played(&proxy.address, seed, PageEnd::of(seed));
        judged(seed, &said, &shown, &device)
    });
}

#[test]
fn a_setup_leaves_no_device_on_in_silence() {
    each("setup", |seed| {
        let device = Fake::new();
        let place = folder(&format!("link-setup-{seed}"));
        let law = place.join("given.toml");
        std::fs::write(&law, "[law.estimator]\ninertia_kg_m2 = 0.00007\n").unwrap();
        let out = place.join("knob");
        // Every second setup continues after the measurement: only settings, flash and calibration are left.
        if seed % 2 == 1 {
            crate::setup::goes_on(&device, &out);
        }
        let proxy = Proxy::new(&device.address, Fault::of(seed), Unit::Frame);
        let (out, law) = (out.display().to_string(), law.display().to_string());
        let said = ended(
            started(&[
                "setup",
                "--out",
                &out,
                "--law",
                &law,
                "--port",
                &proxy.address,
            ]),
            seed,
        );
        let _ = std::fs::remove_dir_all(&place);
        judged(seed, &said, "", &device)
    });
}

#[test]
fn a_run_on_a_haptic_device_leaves_no_force_in_silence() {
    each("device run", |seed| {
        let service = Service::new("3.1.0", Wrong::Nothing, 0);
        let proxy = Proxy::new(&service.address, Fault::of(seed), Unit::Chunk);
        let address = proxy.address.trim_start_matches("tcp:").to_owned();
        let said = ended(
            started(&[
                "device",
                "run",
                "plane",
                "--device",
                "inverse3",
                "--haply",
                &address,
                "--seconds",
                "0.8",
                "--late-limit-ms",
                "1000",
            ]),
            seed,
        );
        proxy.end();
        let last_n = service.saw_at_all().map(|saw| saw.last_n);
        match (said.code, last_n) {
            (Some(0), Some(0.0)) => "no force, exit code 0".into(),
            (Some(0), other) => panic!("seed {seed}: {other:?} N and silent: {}", said.out),
            (Some(1), force) => {
                has_error(&said, seed);
                match force {
                    Some(0.0) => "no force, an error".into(),
                    Some(_) => "a last force, an error".into(),
                    None => "the service never saw the program, or broke; an error".into(),
                }
            }
            _ => panic!("seed {seed}: {:?} {}", said.code, said.err),
        }
    });
}
