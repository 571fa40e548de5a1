//! Tests of `touchstone device`: from power-on to a fault and back.

use crate::fake::{Fake, Trouble};
use crate::folder;
use touchstone_protocol::{FaultCode, PROTOCOL_VERSION};

#[test]
fn a_device_is_calibrated_armed_disarmed_and_stopped() {
    let device = Fake::new();
    let status = device.run(&["device", "status"]).done();
    for part in [
        &format!("nucleo-g474re, firmware 0.1.0 (0000000000001234), protocol {PROTOCOL_VERSION}"),
        "state     boot",
        "after: power on",
        "as after a restart",
    ] {
        assert!(status.contains(part), "{status}");
    }
    device
        .run(&["device", "arm"])
        .failed(1, &["state `boot`", "touchstone device calibrate"]);
    assert_eq!(device.run(&["device", "calibrate"]).done(), "ready\n");
    assert_eq!(device.run(&["device", "zero"]).done(), "ready\n");
    let armed = device.run(&["device", "arm"]);
    assert_eq!((armed.code, armed.out.as_str()), (Some(0), "armed\n"));
    assert!(armed.err.contains("limits.host_silence_s"), "{}", armed.err);
    device
        .run(&["device", "zero"])
        .failed(1, &["state `armed`"]);
    // Disarming a device that is not armed succeeds, too.
    for _ in 0..2 {
        assert_eq!(device.run(&["device", "disarm"]).done(), "ready\n");
    }
    for _ in 0..2 {
        assert_eq!(device.run(&["device", "stop"]).done(), "stopped\n");
    }
    assert_eq!(device.run(&["device", "disarm"]).done(), "stopped\n");
    assert_eq!(
        device.run(&["device", "calibrate", "--no-wait"]).done(),
        "calibrating\n"
    );
    assert_eq!(device.run(&["device", "reboot"]).done(), "restarting\n");
    assert!(device.world().1.rebooted);
}

#[test]
fn a_fault_is_shown_with_its_page_and_its_last_second() {
    let device = Fake::new();
    let file = folder("ring").join("ring.csv");
    let name = file.to_str().unwrap();
    assert_eq!(device.run(&["device", "fault"]).done(), "no fault\n");
    device
        .run(&["device", "ring", "--out", name])
        .failed(1, &["no record of a fault yet"]);
    assert!(!file.exists());
    device.fault(FaultCode::EncoderJump, 812);
    let fault = device.run(&["device", "fault"]).done();
    for part in [
        "06 encoder-jump",
        "value  812",
        "docs/faults/06-encoder-jump.md",
        "touchstone device stop",
    ] {
        assert!(fault.contains(part), "{fault}");
    }
    device
        .run(&["device", "arm"])
        .failed(1, &["state `fault`", "touchstone device fault"]);
    let said = device.run(&["device", "ring", "--out", name]).done();
    assert!(said.contains("1000 ticks"), "{said}");
    let text = std::fs::read_to_string(&file).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 1001);
    assert_eq!(lines[1], "0,-500,0.5,-0.5,128,0,armed");
    assert_eq!(lines[1000], "999,499,0.5,-0.5,128,0,fault");
    assert_eq!(device.run(&["device", "stop"]).done(), "stopped\n");
    assert_eq!(device.run(&["device", "fault"]).done(), "no fault\n");
}

#[test]
fn a_calibration_that_fails_is_a_failure() {
    let device = Fake::with(Trouble {
        calibration_fails: true,
        ..Trouble::default()
    });
    device
        .run(&["device", "calibrate"])
        .failed(1, &["10 calibration-failed", "touchstone device fault"]);
}
