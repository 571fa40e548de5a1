//! Tests of the omega.3 through the maker's interface, with a mock library that behaves as the maker's and has faults on demand.
//! Every fault must end with no force and the device closed within two control intervals of the device (0.5 ms) after the failing
//! call returns.
//!
//! Time is that of the mock's own clock, on which a call over USB takes 60 µs. So the results do not depend on the machine's load.
#![cfg(target_os = "linux")]

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use touchstone_device::Omega3;
use touchstone_device::haptic::{HapticDevice, HapticFault, SwitchOff};
use touchstone_device::servo::{
    Ending, ForceLaw, Pace, RealTime, ServoLimits, ServoReport, ServoTick, Waited, play,
};
use touchstone_dhd::LibrarySearch;
use touchstone_mock_dhd::door::Door;

const RATE_HZ: u32 = 4000;
const INTERVAL_S: f64 = 250e-6;
const TWO_TICKS_S: f64 = 2.0 * INTERVAL_S;

fn door(plan: &[&str]) -> Door {
    Door::new(Path::new(env!("CARGO_TARGET_TMPDIR")), plan)
}

fn opened(door: &Door) -> Result<Omega3, HapticFault> {
    let library = LibrarySearch::new(Some(door.path()))
        .load()
        .expect("the mock loads");
    Omega3::open(Arc::new(library))
}

/// A pace of the servo loop that follows the mock library's clock.
struct MockPace<'d> {
    door: &'d Door,
    due: f64,
    first: bool,
}

impl<'d> MockPace<'d> {
    fn of(door: &'d Door) -> Self {
        Self {
            door,
            due: 0.0,
            first: true,
        }
    }
}

impl Pace for MockPace<'_> {
    fn start(&mut self) {
        self.due = self.door.ask("now");
    }
    fn wait(&mut self) -> Waited {
        if !std::mem::take(&mut self.first) {
            self.due += INTERVAL_S;
        }
        let left = self.due - self.door.ask("now");
        if left > 0.0 {
            assert!(self.door.ask(&format!("wait {left:e}")) == 1.0);
        }
        let late_s = (-left).max(0.0);
        let missed_ticks = (late_s / INTERVAL_S) as u64;
        self.due += missed_ticks as f64 * INTERVAL_S;
        Waited {
            late_s,
            missed_ticks,
        }
    }
    fn late_s(&self) -> f64 {
        (self.door.ask("now") - self.due - INTERVAL_S).max(0.0)
    }
}

/// A force law: a spring of 2 N/mm that pushes upwards below the centre.
struct Spring {
    tick: u64,
    breaks_at: u64,
}

impl ForceLaw for Spring {
    fn tick(&mut self, position_m: [f64; 3]) -> Result<[f64; 3], HapticFault> {
        self.tick += 1;
        assert!(self.tick <= self.breaks_at, "the law breaks");
        Ok([0.0, 0.0, (-2000.0 * position_m[2]).max(0.0)])
    }
}

fn spring() -> Spring {
    Spring {
        tick: 0,
        breaks_at: u64::MAX,
    }
}

fn limits(omega: &Omega3) -> ServoLimits {
    ServoLimits {
        ramp_s: 0.05,
        ..ServoLimits::of(omega.sheet())
    }
}

/// Runs the servo loop for 2 s on the mock's clock.
fn played(door: &Door) -> Result<ServoReport, HapticFault> {
    let mut omega = opened(door)?;
    let limits = limits(&omega);
    let more = |tick: &ServoTick| tick.number < 8000;
    let pace = &mut MockPace::of(door);
    Ok(play(
        &mut omega,
        &mut spring(),
        &limits,
        RATE_HZ,
        pace,
        more,
    ))
}

/// Checks that within two control intervals after the fault the force is 0 and the device closed, and that both stay so.
#[track_caller]
fn released(door: &Door, what: &str) -> f64 {
    let [wrong, zero, closed] = ["wrong", "zero", "released"].map(|time| door.ask(time));
    assert!(wrong.is_finite(), "{what}: it did not happen");
    let took = zero.max(closed) - wrong;
    assert!(took <= TWO_TICKS_S, "{what}: {:.0} µs", took * 1e6);
    assert_eq!(door.ask("force"), 0.0, "{what}");
    assert_eq!(door.ask("late"), 0.0, "{what}");
    took
}

#[test]
fn without_a_fault_there_is_a_wall_and_a_released_device() {
    let door = door(&["own-clock"]);
    let report = played(&door).unwrap();
    assert_eq!((report.ending, report.release), (Ending::Asked, Ok(())));
    assert_eq!((report.ticks, report.missed_ticks), (8001, 0));
    assert!(report.force_max_n > 2.0, "{}", report.force_max_n);
    assert!((door.ask("longest") - report.force_max_n).abs() < 1e-12);
    // In addition to the loop's limit, the device's own force limit is set.
    assert_eq!(door.ask("max"), 12.0);
    assert_eq!((door.ask("open"), door.ask("force")), (0.0, 0.0));
    // The loop does not switch off any of the device's own safety functions.
    for call in [
        "dhdSetVelocityThreshold",
        "dhdSetWatchdog",
        "dhdSetTimeGuard",
        "drdAutoInit",
    ] {
        assert_eq!(door.ask(&format!("count {call}")), 0.0);
    }
}

/// Makes each call before and in the servo loop fail: at its first call, in the loop also at its second and a later one; once,
/// twice and permanently. Checks that the force is zero and the device closed within two control intervals.
#[test]
fn every_call_that_fails_ends_with_no_force_and_a_closed_device_within_two_ticks() {
    let calls = [
        ("dhdGetSystemType", 0),
        ("dhdSetMaxForce", 0),
        ("dhdEnableForce", 0),
        ("dhdGetStatus", 0),
        ("dhdGetStatus", 1),
        ("dhdGetStatus", 300),
        ("dhdSetForce", 0),
        ("dhdSetForce", 1),
        ("dhdSetForce", 3000),
        ("dhdGetPosition", 0),
        ("dhdGetPosition", 1),
        ("dhdGetPosition", 3000),
    ];
    let (mut worst, mut tried) = (0.0_f64, 0);
    for (call, at) in calls {
        for plan in [
            format!("fail {call} {at} 1 2"),
            format!("fail {call} {at} 2 7"),
            format!("unplug {call} {at}"),
        ] {
            let door = door(&["own-clock", &plan]);
            match played(&door) {
                Err(fault) => assert!(matches!(fault, HapticFault::Lost(..)), "{plan}: {fault:?}"),
                Ok(report) => assert!(
                    matches!(report.ending, Ending::Fault(HapticFault::Lost(..))),
                    "{plan}: {:?}",
                    report.ending
                ),
            }
            worst = worst.max(released(&door, &plan));
            tried += 1;
        }
    }
    println!(
        "{tried} faults, released after at most {:.0} µs",
        worst * 1e6
    );
}

/// Makes `dhdStop` or `dhdClose` fail in the release. Checks that a failing call is tried again, and that the other calls are made.
#[test]
fn a_release_goes_on_whatever_of_it_fails() {
    for (plan, closed) in [
        ("fail dhdStop 0 1 2", true),
        ("fail dhdStop 0 9 2", true),
        ("fail dhdClose 0 1 2", true),
        ("fail dhdClose 0 9 2", false),
    ] {
        let door = door(&["own-clock", plan]);
        let report = played(&door).unwrap();
        assert_eq!(report.ending, Ending::Asked);
        assert_eq!(report.release.is_err(), plan.contains(" 9 "), "{plan}");
        assert_eq!(door.ask("open") == 0.0, closed, "{plan}");
        assert_eq!(door.ask("force"), 0.0, "{plan}");
        assert!(door.ask("count dhdClose") <= 2.0, "{plan}: no endless stop");
    }
}

#[test]
fn results_above_zero_are_data_and_end_it_only_when_they_last() {
    // The library returns 1 for a few ticks: the positions are stale and are counted.
    let some = door(&["own-clock", "stale 1000 10"]);
    let report = played(&some).unwrap();
    assert_eq!((report.ending, report.stale_ticks), (Ending::Asked, 10));
    // The library returns 1 for longer than 5 ms, which is a fault.
    let many = door(&["own-clock", "stale 1000 9999"]);
    let report = played(&many).unwrap();
    assert!(
        matches!(report.ending, Ending::Fault(HapticFault::Stale(s)) if s > 5e-3 && s < 5.5e-3)
    );
    assert_eq!(many.ask("force"), 0.0);
    // The library returns 2 (saturated motors) for 100 ms. These ticks are counted, and the acting force is the one that the
    // library reports.
    let some = door(&["own-clock", "saturate 2000 400"]);
    let report = played(&some).unwrap();
    assert_eq!(
        (report.ending, report.saturated_ticks),
        (Ending::Asked, 400)
    );
    let many = door(&["own-clock", "saturate 2000 99999"]);
    let report = played(&many).unwrap();
    assert!(matches!(
        report.ending,
        Ending::Fault(HapticFault::Saturated(_))
    ));
    assert_eq!(many.ask("force"), 0.0);
}

#[test]
fn a_position_that_is_no_number_a_slow_call_and_the_devices_own_stop_end_it_at_once() {
    type Row = (&'static str, fn(&HapticFault) -> bool);
    let rows: [Row; 4] = [
        ("nan 3000", |fault| {
            *fault == HapticFault::NotFinite("position")
        }),
        (
            "slow dhdGetPosition 3000 30",
            |fault| matches!(fault, HapticFault::Late(late) if *late > 0.01),
        ),
        (
            "slow dhdSetForce 3000 30",
            |fault| matches!(fault, HapticFault::Late(late) if *late > 0.01),
        ),
        ("off 400 2", |fault| {
            *fault == HapticFault::SwitchedOff(SwitchOff::Velocity)
        }),
    ];
    for (plan, expected) in rows {
        let door = door(&["own-clock", plan]);
        let report = played(&door).unwrap();
        assert!(
            matches!(&report.ending, Ending::Fault(fault) if expected(fault)),
            "{plan}: {:?}",
            report.ending
        );
        released(&door, plan);
    }
}

#[test]
fn a_panic_of_the_law_closes_the_device() {
    let door = door(&["own-clock"]);
    let mut omega = opened(&door).unwrap();
    let limits = limits(&omega);
    let mut law = Spring {
        breaks_at: 3000,
        ..spring()
    };
    let pace = RefCell::new(MockPace::of(&door));
    let broke = catch_unwind(AssertUnwindSafe(|| {
        let pace = &mut *pace.borrow_mut();
        play(&mut omega, &mut law, &limits, RATE_HZ, pace, |_| true)
    }));
    assert!(broke.is_err());
    assert!(door.ask("longest") > 2.0, "there was a force before");
    assert_eq!((door.ask("open"), door.ask("force")), (0.0, 0.0));
}

#[test]
fn what_cannot_be_used_is_said_and_not_held() {
    for (plan, part) in [
        ("absent", "no device found on USB"),
        ("held", "another program holds it"),
        ("uncalibrated", "not calibrated"),
        ("type 63", "is not an omega.3"),
        ("fail dhdOpenID 0 1 20", "another program holds it"),
        ("fail dhdOpenID 0 1 12", "device not ready (12)"),
    ] {
        let door = door(&["own-clock", plan]);
        let fault = opened(&door).expect_err(plan);
        assert!(fault.to_string().contains(part), "{plan}: {fault}");
        assert_eq!(door.ask("open"), 0.0, "{plan}");
        assert_eq!(door.ask("count dhdEnableForce"), 0.0, "{plan}");
    }
}

/// Checks that older libraries, which write fewer status words and have fewer functions, can be used.
#[test]
fn older_libraries_do() {
    let door = door(&["own-clock", "status 12"]);
    assert_eq!(played(&door).unwrap().ending, Ending::Asked);
    for optional in [
        "dhdGetSDKVersion",
        "dhdGetAvailableCount",
        "dhdGetSystemName",
        "dhdGetForce",
        "dhdSetMaxForce",
    ] {
        let door = without(optional, &["own-clock", "saturate 2000 5"]);
        let report = played(&door).unwrap();
        assert_eq!(
            (report.ending, report.saturated_ticks),
            (Ending::Asked, 5),
            "{optional}"
        );
    }
    let door = without("dhdSetForce", &[]);
    let missing = LibrarySearch::new(Some(door.path()))
        .load()
        .expect_err("no library");
    assert!(
        missing
            .to_string()
            .contains("the library has no dhdSetForce"),
        "{missing}"
    );
}

/// The mock library with one of its functions renamed, so that the program does not find it.
fn without(function: &str, plan: &[&str]) -> Door {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    Door::changed(folder, plan, |mut bytes| {
        let name = [function.as_bytes(), b"\0"].concat();
        let mut at = 0;
        while let Some(found) = bytes[at..]
            .windows(name.len())
            .position(|part| part == name)
        {
            at += found;
            bytes[at] = b'x';
        }
        assert!(at > 0, "{function} is not in the library");
        bytes
    })
}

/// Runs 3 s at 4 kHz in real time. Checks that every control interval (tick) ran or was counted as missed, and that the mock got
/// the forces that the loop commanded. The lateness depends on the machine and is not checked.
#[test]
fn in_real_time_every_tick_is_played_or_counted_as_missed() {
    let door = door(&[]);
    let mut omega = opened(&door).unwrap();
    let limits = ServoLimits {
        late_s: 0.5,
        ..limits(&omega)
    };
    let mut seen: Option<(Instant, f64)> = None;
    let more = |_: &ServoTick| {
        let first = seen.map_or_else(Instant::now, |(first, _)| first);
        let took_s = first.elapsed().as_secs_f64();
        seen = Some((first, took_s));
        took_s < 3.0
    };
    let pace = &mut RealTime::new(RATE_HZ);
    let report = play(&mut omega, &mut spring(), &limits, RATE_HZ, pace, more);
    assert_eq!((&report.ending, &report.release), (&Ending::Asked, &Ok(())));
    // Time from the end of the first tick to the end of the last. It has one interval per further tick, run or missed, apart from
    // the lateness of the first and the last tick. 50 ms are added for unmeasured time within a tick.
    let took_s = seen.map_or(0.0, |(_, took_s)| took_s);
    let due_s = (report.ticks + report.missed_ticks - 1) as f64 * INTERVAL_S;
    assert!(
        (due_s - took_s).abs() < report.lateness.worst_s() + 0.05,
        "{due_s} s of ticks in {took_s} s"
    );
    assert_eq!(door.ask("count dhdGetPosition"), report.ticks as f64);
    // Besides one force per tick, one force is sent at the beginning and one at the end.
    assert_eq!(door.ask("count dhdSetForce"), report.ticks as f64 + 2.0);
    assert_eq!(
        report
            .lateness
            .classes()
            .map(|class| class.ticks)
            .sum::<u64>(),
        report.ticks
    );
    assert_eq!((door.ask("open"), door.ask("force")), (0.0, 0.0));
    println!(
        "{} ticks, {} missed, 99 % within {:?} µs, latest {:.0} µs",
        report.ticks,
        report.missed_ticks,
        report.lateness.quantile_us(0.99),
        report.lateness.worst_s() * 1e6
    );
}
