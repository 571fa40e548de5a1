//! Tests of the Inverse3 with a simulated maker's service, which speaks both generations of messages and simulates the device.

mod haply_mock;

use haply_mock::{Service, Wrong};
use std::io::Write;
use std::net::TcpListener;
use std::time::{Duration, Instant};
use touchstone_device::Inverse3;
use touchstone_device::haptic::{HapticDevice, HapticFault};
use touchstone_device::servo::{
    DevicePace, Ending, ForceLaw, ServoLimits, ServoReport, ServoTick, play,
};

struct Floor;

impl ForceLaw for Floor {
    fn tick(&mut self, [_, _, z]: [f64; 3]) -> Result<[f64; 3], HapticFault> {
        Ok([0.0, 0.0, (-1000.0 * z).max(0.0)])
    }
}

fn played(service: &Service) -> Result<ServoReport, HapticFault> {
    let mut inverse = Inverse3::connect(&service.address)?;
    let rate_hz = inverse.sheet().rates_hz.0;
    let limits = ServoLimits {
        ramp_s: 0.05,
        // Late ticks on a busy machine must not count as a fault of the device.
        late_s: 0.25,
        ..ServoLimits::of(inverse.sheet())
    };
    let more = |tick: &ServoTick| tick.number < 400;
    Ok(play(
        &mut inverse,
        &mut Floor,
        &limits,
        rate_hz,
        &mut DevicePace::new(rate_hz),
        more,
    ))
}

#[test]
fn both_generations_get_a_force_for_every_state_and_none_at_the_end() {
    for version in ["3.1.2", "3.5.0"] {
        let service = Service::new(version, Wrong::Nothing, 0);
        let report = played(&service).unwrap();
        assert_eq!(
            (&report.ending, &report.release),
            (&Ending::Asked, &Ok(())),
            "{version}"
        );
        assert_eq!(report.ticks, 401);
        let saw = service.saw();
        assert_eq!((saw.refused, saw.last_n), (0, 0.0), "{version}: {saw:?}");
        assert!(
            (saw.longest_n - report.force_max_n).abs() < 1e-9 && saw.longest_n > 1.0,
            "{saw:?}"
        );
        assert!(saw.longest_n <= 3.0 + 1e-9, "never more than was chosen");
        // The service receives 100 commands that measure the pace, one that catches up, one per tick and a last one.
        assert!(saw.commands >= 503, "{saw:?}");
    }
}

#[test]
fn whatever_goes_wrong_ends_with_no_force() {
    let lost = |fault: &HapticFault| matches!(fault, HapticFault::Lost(..));
    let off = |fault: &HapticFault| matches!(fault, HapticFault::SwitchedOff(_));
    let unpowered = |fault: &HapticFault| matches!(fault, HapticFault::Unusable(why, _) if why == "it has no supply");
    type Row = (Wrong, fn(&HapticFault) -> bool, bool);
    let rows: [Row; 6] = [
        (Wrong::Gone, lost, false),
        (Wrong::Silent, lost, true),
        (Wrong::Unlisted, lost, true),
        (Wrong::NoNumber, lost, true),
        (Wrong::NotReady, off, true),
        (Wrong::NoSupply, unpowered, true),
    ];
    for (wrong, expected, reachable) in rows {
        let service = Service::new("3.5.1", wrong, 250);
        let report = played(&service).unwrap();
        assert!(
            matches!(&report.ending, Ending::Fault(fault) if expected(fault)),
            "{:?}",
            report.ending
        );
        let saw = service.saw();
        assert!(saw.longest_n > 0.5, "a force was there");
        assert!(
            !reachable || saw.last_n == 0.0,
            "{:?}: {saw:?}",
            report.ending
        );
    }
}

/// Stops the service around the end of the run. Checks that a missing answer to the last command is reported, because the force of
/// the command before it may still act.
#[test]
fn a_force_that_nothing_ends_is_said() {
    let mut unconfirmed = 0;
    for at in 499..507 {
        let service = Service::new("3.5.1", Wrong::Gone, at);
        let report = played(&service).unwrap();
        let saw = service.saw();
        let is_said = report.release.is_err() || report.ending != Ending::Asked;
        assert!(is_said || saw.last_n == 0.0, "{at}: {saw:?}");
        unconfirmed += u32::from(report.ending == Ending::Asked && report.release.is_err());
    }
    assert!(unconfirmed > 0, "the service was there to the end");
    // A service that falls silent under a force ends the run with a fault, and the release must not count as confirmed either.
    let report = played(&Service::new("3.5.1", Wrong::Silent, 250)).unwrap();
    assert!(report.release.is_err(), "{report:?}");
}

/// Checks that messages without a device state do not delay the end of the servo loop.
#[test]
fn a_service_that_talks_without_a_state_is_left_as_a_silent_one() {
    for wrong in [Wrong::Pings, Wrong::Drip, Wrong::Binary] {
        let service = Service::new("3.5.1", wrong, 250);
        let report = played(&service).unwrap();
        assert!(
            matches!(&report.ending, Ending::Fault(HapticFault::Lost(..))),
            "{:?}",
            report.ending
        );
        // The limit allows for 0.3 s, a pause of the service, and delays of a busy machine.
        let saw = service.saw();
        assert!(saw.held_s < 1.5, "{saw:?}");
    }
}

/// Checks that the program gives up within seconds on a service that answers byte by byte, or never completes its answer.
#[test]
fn a_service_that_drips_its_first_answers_is_refused_within_seconds() {
    for begin in ["HTTP/1.1 200 OK\r\n\r\n", "HTTP/1.1 101 Switching", ""] {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        std::thread::spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            let _ = stream.write_all(begin.as_bytes());
            while stream.write_all(b" ").is_ok() {
                std::thread::sleep(Duration::from_millis(100));
            }
        });
        let begun = Instant::now();
        Inverse3::connect(&address).expect_err("no service");
        assert!(begun.elapsed() < Duration::from_secs(5), "{begin:?}");
    }
}

#[test]
fn what_cannot_be_used_is_said() {
    let service = Service::new("3.5.1", Wrong::Uncalibrated, 0);
    let fault = Inverse3::connect(&service.address).expect_err("not calibrated");
    assert!(
        fault.to_string().contains("049D is not calibrated"),
        "{fault}"
    );
    let service = Service::new("3.5.1", Wrong::NoSupply, 0);
    let fault = Inverse3::connect(&service.address).expect_err("no supply");
    assert!(fault.to_string().contains("049D has no supply"), "{fault}");
    assert!(fault.fix().contains("switch its supply on"), "{fault}");
    let service = Service::new("unknown", Wrong::Nothing, 0);
    let fault = Inverse3::connect(&service.address).expect_err("no version");
    assert!(fault.to_string().contains("says no version"), "{fault}");
    for other in ["2.1.0", "4.0.0"] {
        let service = Service::new(other, Wrong::Nothing, 0);
        let fault = Inverse3::connect(&service.address).expect_err("another version");
        let version = format!("has version {}, and only 3 is known", &other[..3]);
        assert!(fault.to_string().contains(&version), "{fault}");
        assert!(fault.fix().contains("of version 3"), "{fault}");
    }
    // A port that was free a moment ago.
    let free = TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap()
        .to_string();
    let fault = Inverse3::connect(&free).expect_err("nothing there");
    assert!(
        fault.to_string().contains("no service at 127.0.0.1"),
        "{fault}"
    );
    assert!(fault.fix().contains("--haply"));
}
