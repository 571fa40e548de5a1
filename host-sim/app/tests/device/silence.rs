//! Tests that a knob switches itself off when the computer sends no request, however the program on the computer ended.

use crate::demo::Demo;
use crate::link_faults::page::Opened;
use crate::link_faults::proxy::{Fault, Proxy, Unit};
use crate::{folder, program};
use std::any::Any;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use touchstone_protocol::Phase;

/// Time within which the device must switch off without a request: its limit of 2 s, and a margin of 1.5 s for a busy machine.
const SILENT: Duration = Duration::from_millis(2_000 + 1_500);
/// Time for which a program must keep the motor on, longer than the device's limit.
const KEPT: Duration = Duration::from_millis(2_500);
/// Longest time until a program has switched the motor on, with a margin for a busy machine.
const BEGINS: Duration = Duration::from_secs(40);

/// A child process that ends with the test.
struct Ends(Child);

impl Drop for Ends {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A running program: the number of its process, and all that must live as long as the program.
type Running = (u32, Box<dyn Any>);

/// A program that uses a board while its motor is on.
struct Row {
    name: &'static str,
    /// Whether another command calibrates and arms the board before the program starts, because the program itself does not.
    armed_before: bool,
    /// State of the board while the program runs.
    phase: Phase,
    /// The board's limit on the time without a request, ms.
    limit_ms: u32,
    /// Starts the program at this port.
    starts: fn(&str) -> Running,
}

/// Starts a program without a page or client.
fn alone(words: &[&str], port: &str) -> Running {
    let mut command = program(&[words, &["--port", port]].concat());
    command.stdin(Stdio::null());
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let child = Ends(command.spawn().unwrap());
    (child.0.id(), Box::new(child))
}

/// Starts `live` with a page, on which a person presses "Arm".
fn live(port: &str) -> Running {
    let Opened {
        child, out, page, ..
    } = Opened::new(port);
    let mut page = page.expect("a page");
    page.says(&serde_json::json!({ "do": "arm" }));
    // The page shows records until the program ends.
    std::thread::spawn(move || page.hears(BEGINS, &mut String::new(), |_| false));
    (child.id(), Box::new((Ends(child), out)))
}

fn setup(port: &str) -> Running {
    let out = folder(&format!(
        "silent-setup-{}",
        port.rsplit(':').next().unwrap()
    ));
    let out = out.join("knob").display().to_string();
    alone(&["setup", "--quick", "--out", &out], port)
}

const ROWS: &[Row] = &[
    // `monitor` and `events` never arm a board, but keep an armed one on.
    Row {
        name: "monitor",
        armed_before: true,
        phase: Phase::Armed,
        limit_ms: 2_000,
        starts: |port| alone(&["monitor"], port),
    },
    Row {
        name: "events",
        armed_before: true,
        phase: Phase::Armed,
        limit_ms: 2_000,
        starts: |port| alone(&["events", "--pitch", "10"], port),
    },
    Row {
        name: "live",
        armed_before: false,
        phase: Phase::Armed,
        limit_ms: 2_000,
        starts: live,
    },
    #[cfg(target_os = "linux")]
    Row {
        name: "bridge",
        armed_before: false,
        phase: Phase::Armed,
        limit_ms: 2_000,
        starts: |port| {
            let (bridge, client) = crate::bridge::armed(port);
            (bridge.0.id(), Box::new((bridge, client)))
        },
    },
    // `setup` never arms a board. Its calibration turns the motor, with a limit of 1 s that it sets itself.
    Row {
        name: "setup",
        armed_before: false,
        phase: Phase::Calibrating,
        limit_ms: 1_000,
        starts: setup,
    },
];

/// How a program's requests stop.
#[derive(Debug, Clone, Copy)]
enum End {
    /// The program is killed.
    Killed,
    /// The program is stopped, and its connection stays open.
    Stopped,
    /// The cable between program and board is pulled.
    Pulled,
}

fn signal(process: u32, name: &str) {
    let sent = Command::new("kill")
        .args([name, &process.to_string()])
        .status();
    assert!(sent.unwrap().success());
}

/// Runs a program until it has kept the motor on for longer than the board's limit. After this `end`, the board must switch
/// off at its limit.
fn is_off_after(row: &Row, end: End) {
    let demo = Demo::new();
    if row.phase == Phase::Armed {
        demo.run(&["device", "calibrate"]);
    }
    if row.armed_before {
        demo.run(&["device", "arm"]);
    }
    let proxy = Proxy::new(demo.address(), Fault::none(), Unit::Chunk);
    let (process, _held) = (row.starts)(&proxy.address);
    let on = || proxy.phase() == Some(row.phase);
    let begun = Instant::now();
    while !on() {
        assert!(begun.elapsed() < BEGINS, "{} {end:?}: not on", row.name);
        std::thread::sleep(Duration::from_millis(10));
    }
    let begun = Instant::now();
    while begun.elapsed() < KEPT {
        assert!(on(), "{} {end:?}: {:?}", row.name, proxy.phase());
        std::thread::sleep(Duration::from_millis(10));
    }
    match end {
        End::Killed => signal(process, "-KILL"),
        End::Stopped => signal(process, "-STOP"),
        End::Pulled => proxy.end(),
    }
    std::thread::sleep(SILENT);
    let fault = demo.run(&["device", "fault"]);
    let silent = format!("value  {}\n", row.limit_ms);
    assert!(
        fault.contains("22 host-silent") && fault.contains(&silent),
        "{} {end:?}: {fault}",
        row.name
    );
}

/// Checks each program that switches a board's motor on, or keeps it on. Commands that arm and end at once are checked below.
#[test]
fn a_board_is_off_at_its_limit_after_its_program_or_cable_is_gone() {
    std::thread::scope(|scope| {
        for row in ROWS {
            scope.spawn(|| {
                for end in [End::Killed, End::Stopped, End::Pulled] {
                    is_off_after(row, end);
                }
            });
        }
    });
}

/// Checks that the demo keeps running if its standard input is endless and has no line ends, as `/dev/zero`.
#[cfg(target_os = "linux")]
#[test]
fn a_knob_whose_input_never_ends_a_line_goes_on_without_it() {
    let zeros = std::fs::File::open("/dev/zero").unwrap();
    let demo = Demo::with_input(zeros.into());
    std::thread::sleep(Duration::from_millis(500));
    let file = format!("/proc/{}/status", demo.process.id());
    let status = std::fs::read_to_string(file).unwrap();
    let peak = status.lines().find(|line| line.starts_with("VmHWM:"));
    let peak = peak
        .and_then(|line| line.split_whitespace().nth(1))
        .unwrap();
    assert!(peak.parse::<u64>().unwrap() < 100_000, "{peak} kB");
    assert_eq!(demo.run(&["device", "fault"]), "no fault\n");
}

#[test]
fn a_command_that_arms_and_ends_says_what_comes_and_it_comes() {
    let demo = Demo::new();
    demo.run(&["device", "calibrate"]);
    let said = demo.command(&["device", "arm"]).output().unwrap();
    let note = String::from_utf8(said.stderr).unwrap();
    assert!(
        note.contains("switches off if no program sends a request for 2 s"),
        "{note}"
    );
    std::thread::sleep(SILENT);
    assert!(demo.run(&["device", "fault"]).contains("22 host-silent"));
    // With a limit of 0 the device stays on without a computer.
    demo.run(&["device", "stop"]);
    demo.run(&["config", "set", "limits.host_silence_s", "0"]);
    demo.run(&["device", "calibrate"]);
    let said = demo.command(&["device", "arm"]).output().unwrap();
    let note = String::from_utf8(said.stderr).unwrap();
    assert!(note.contains("this device stays on"), "{note}");
    std::thread::sleep(SILENT);
    assert_eq!(demo.run(&["device", "fault"]), "no fault\n");
    assert_eq!(demo.run(&["device", "stop"]), "stopped\n");
}
