//! Tests that a knob switches itself off when the computer sends no request, however the program on the computer ended.

use crate::demo::Demo;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Time within which the device must switch off without a request: its limit of 2 s, and a margin of 1.5 s for a busy machine.
const SILENT: Duration = Duration::from_millis(2_000 + 1_500);

/// Switches the knob's wall on and runs `touchstone monitor` for longer than the device's limit on the time without a request.
fn monitored(demo: &Demo) -> Child {
    demo.run(&["device", "calibrate"]);
    demo.run(&["device", "arm"]);
    let mut monitor = demo
        .command(&["monitor"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(monitor.stdout.take().unwrap()).lines();
    let until = Instant::now() + SILENT;
    let mut last = String::new();
    while Instant::now() < until {
        last = lines.next().expect("monitor ended").unwrap();
    }
    assert!(last.contains("armed"), "{last}");
    monitor
}

fn signal(process: &Child, name: &str) {
    let sent = Command::new("kill")
        .args([name, &process.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
}

#[test]
fn a_device_whose_desktop_is_gone_switches_itself_off() {
    for name in ["-KILL", "-STOP"] {
        let demo = Demo::new();
        let mut monitor = monitored(&demo);
        signal(&monitor, name);
        std::thread::sleep(SILENT);
        let fault = demo.run(&["device", "fault"]);
        assert!(fault.contains("22 host-silent"), "{name}: {fault}");
        let _ = monitor.kill();
        monitor.wait().unwrap();
    }
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
