//! Tests of `touchstone monitor`.

use crate::fake::{Fake, Trouble};
use crate::{folder, program};
use touchstone_protocol::FaultCode;

/// Header line of a CSV recording, and the number of the control period in each row.
fn ticks(text: &str) -> (String, Vec<u32>) {
    let mut lines = text.lines();
    let header = lines.next().unwrap().to_owned();
    let ticks = lines.map(|line| line.split(',').next().unwrap().parse().unwrap());
    (header, ticks.collect())
}

#[test]
fn every_record_is_kept_and_what_is_missing_is_counted() {
    let device = Fake::with(Trouble {
        drops_every: Some(10),
        ..Trouble::default()
    });
    let file = folder("monitor").join("run.csv");
    let name = file.to_str().unwrap();
    let said = device
        .run(&["monitor", "--seconds", "1.2", "--csv", name])
        .done();
    let (header, ticks) = ticks(&std::fs::read_to_string(&file).unwrap());
    assert!(
        header.starts_with("tick,time_s,count,penetration_rad,force_n_m"),
        "{header}"
    );
    assert!(ticks.len() > 20, "{said}");
    let missing: u32 = ticks.windows(2).map(|pair| pair[1] - pair[0] - 1).sum();
    assert!(missing > 0);
    let summary = format!("{} records, {missing} lost (", ticks.len());
    assert!(said.contains(&summary), "{summary} is not in {said}");
    assert!(said.contains("boot") && said.contains("-0.250"), "{said}");
}

#[test]
fn a_decimation_is_asked_for_and_taken_back() {
    let device = Fake::new();
    let file = folder("decimation").join("run.csv");
    let said = device
        .run(&[
            "monitor",
            "--seconds",
            "0.5",
            "--decimation",
            "4",
            "--csv",
            file.to_str().unwrap(),
        ])
        .done();
    let (_, ticks) = ticks(&std::fs::read_to_string(&file).unwrap());
    assert!(
        ticks.windows(2).all(|pair| pair[1] - pair[0] == 4),
        "{ticks:?}"
    );
    assert!(said.contains(" 0 lost"), "{said}");
    // The device's decimation is 1 again, so nearly every tick sends a record.
    let before = ticks.len();
    let again = device.run(&["monitor", "--seconds", "0.5"]).done();
    assert!(again.contains("records, 0 lost"), "{again}");
    assert!(before > 0);
}

#[test]
fn a_fault_is_seen_and_silence_is_an_error() {
    let device = Fake::new();
    device.fault(FaultCode::OverSpeed, 61_000);
    let said = device.run(&["monitor", "--seconds", "0.3"]).done();
    assert!(said.contains("13 over-speed"), "{said}");
    let device = Fake::with(Trouble {
        records: Some(20),
        ..Trouble::default()
    });
    device
        .run(&["monitor", "--seconds", "20"])
        .failed(1, &["no telemetry for 2 s"]);
    device
        .run(&["monitor", "--seconds", "0"])
        .failed(2, &["--seconds"]);
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_it_with_a_whole_file() {
    let device = Fake::new();
    let file = folder("interrupt").join("run.csv");
    let mut command = program(&[
        "monitor",
        "--port",
        &device.address,
        "--csv",
        file.to_str().unwrap(),
    ]);
    let child = command
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(800));
    let sent = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(sent.success());
    let said = crate::Said::from(child.wait_with_output().unwrap()).done();
    assert!(said.contains(" records, 0 lost"), "{said}");
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.ends_with('\n') && ticks(&text).1.len() > 20, "{said}");
}

#[test]
fn it_ends_when_nobody_reads_it_any_more() {
    let device = Fake::new();
    // The command would run for twenty seconds if it did not notice the closed pipe.
    let mut child = program(&["monitor", "--seconds", "20", "--port", &device.address])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let begun = std::time::Instant::now();
    let mut first = [0; 16];
    std::io::Read::read_exact(child.stdout.as_mut().unwrap(), &mut first).unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
    assert!(begun.elapsed().as_secs() < 10);
}

#[test]
fn a_board_is_armed_for_as_long_as_it_is_watched() {
    for command in [
        &["monitor", "--arm", "--seconds", "0.4"][..],
        &["events", "--arm", "--pitch", "10", "--seconds", "0.4"],
    ] {
        let device = Fake::new();
        device
            .run(command)
            .failed(1, &["state `boot`", "touchstone device calibrate"]);
        device.run(&["device", "calibrate"]).done();
        let said = device.run(command).done();
        assert!(said.contains("armed"), "{said}");
        let status = device.run(&["device", "status"]).done();
        assert!(status.contains("state     ready"), "{status}");
    }
}
