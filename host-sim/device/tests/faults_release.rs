//! Checks that any fault of a device, at any call, ends the servo loop by the next control interval (tick), with the force at zero
//! and the device released.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;
use touchstone_device::haptic::{
    Applied, DataSheet, DeviceCall, DeviceStanding, DeviceTwin, FaultInjection, FaultKind,
    HapticDevice, HapticFault, Injected, OneAxis, Sensed, SimulatedArm, SwitchOff,
};
use touchstone_device::servo::{
    Ending, ForceLaw, Pace, RealTime, ServoLimits, ServoReport, SimulatedPace, play,
};

const RATE_HZ: u32 = 4000;

/// A device that records the calls made to it.
struct Witness<D> {
    inner: D,
    force_n: [f64; 3],
    released: bool,
    /// Number of commands after the release.
    late_commands: u32,
    ticks: u64,
}

impl<D> Witness<D> {
    fn new(inner: D) -> Self {
        Self {
            inner,
            force_n: [0.0; 3],
            released: false,
            late_commands: 0,
            ticks: 0,
        }
    }
}

impl<D: HapticDevice> HapticDevice for Witness<D> {
    fn sheet(&self) -> &DataSheet {
        self.inner.sheet()
    }
    fn engage(&mut self) -> Result<(), HapticFault> {
        self.inner.engage()
    }
    fn sense(&mut self) -> Result<Sensed, HapticFault> {
        self.inner.sense()
    }
    fn command(&mut self, force_n: [f64; 3]) -> Result<Applied, HapticFault> {
        self.late_commands += u32::from(self.released);
        self.ticks += 1;
        self.force_n = force_n;
        self.inner.command(force_n)
    }
    fn standing(&mut self) -> Result<DeviceStanding, HapticFault> {
        self.inner.standing()
    }
    fn release(&mut self) -> Result<(), HapticFault> {
        self.force_n = [0.0; 3];
        self.released = true;
        self.inner.release()
    }
}

/// A force law of a spring that pushes up from the floor. In control intervals that a test selects, its function `trick` replaces
/// the spring's force.
struct Floor {
    tick: u64,
    trick: fn(u64) -> Option<[f64; 3]>,
    told: Vec<[f64; 3]>,
}

impl Floor {
    fn new(trick: fn(u64) -> Option<[f64; 3]>) -> Self {
        Self {
            tick: 0,
            trick,
            told: Vec::new(),
        }
    }
}

impl ForceLaw for Floor {
    fn tick(&mut self, position_m: [f64; 3]) -> Result<[f64; 3], HapticFault> {
        let number = self.tick;
        self.tick += 1;
        match (self.trick)(number) {
            Some(force) => Ok(force),
            None => Ok([0.0, 0.0, (-2000.0 * position_m[2]).max(0.0)]),
        }
    }
    fn commanded(&mut self, force_n: [f64; 3]) {
        self.told.push(force_n);
    }
}

/// A simulated device in a hand that comes from above and presses into the floor with up to 6 N.
fn pressed() -> SimulatedArm {
    let rest = |time_s: f64| [0.0, 0.0, 0.002 - 0.022 * (time_s / 0.1).min(1.0)];
    SimulatedArm::new(DeviceTwin::default(), RATE_HZ, Box::new(rest)).unwrap()
}

fn played(
    injection: Option<FaultInjection>,
    floor: &mut Floor,
    pace: &mut impl Pace,
    ticks: u64,
) -> (ServoReport, Witness<Injected<SimulatedArm>>) {
    let mut device = Witness::new(Injected::new(pressed(), injection));
    let limits = ServoLimits {
        ramp_s: 0.05,
        ..ServoLimits::of(device.sheet())
    };
    let more = |tick: &touchstone_device::servo::ServoTick| tick.number + 1 < ticks;
    let report = play(&mut device, floor, &limits, RATE_HZ, pace, more);
    (report, device)
}

#[test]
fn without_a_fault_the_wall_is_there_and_the_device_is_released() {
    let mut floor = Floor::new(|_| None);
    let (report, device) = played(None, &mut floor, &mut SimulatedPace, 4000);
    assert_eq!((report.ticks, report.missed_ticks), (4000, 0));
    assert_eq!(report.ending, Ending::Asked);
    assert!(report.force_max_n > 2.0 && report.force_max_n <= 12.0);
    assert!(device.released && device.late_commands == 0);
}

#[test]
fn the_force_fades_in() {
    let mut floor = Floor::new(|_| Some([0.0, 0.0, 2.0]));
    let (report, _) = played(None, &mut floor, &mut SimulatedPace, 400);
    assert_eq!(report.ending, Ending::Asked);
    // The fade-in takes 50 ms, which are 200 ticks.
    let told = [0, 100, 200, 399].map(|tick: usize| floor.told[tick][2]);
    assert_eq!(told, [0.0, 1.0, 2.0, 2.0]);
}

/// Injects every fault at the first, the second and the 301st call of its function. Checks that the device is released by the
/// control interval after the one in which the loop detects the fault.
#[test]
fn every_fault_at_every_call_ends_released_by_the_next_tick() {
    let lost = |fault: &HapticFault| matches!(fault, HapticFault::Lost(..));
    let held = |fault: &HapticFault| *fault == HapticFault::HeldElsewhere;
    let stale = |fault: &HapticFault| matches!(fault, HapticFault::Stale(_));
    let saturated = |fault: &HapticFault| matches!(fault, HapticFault::Saturated(_));
    let jumped = |fault: &HapticFault| matches!(fault, HapticFault::Jumped(v) if *v > 70.0);
    let nan = |fault: &HapticFault| *fault == HapticFault::NotFinite("position");
    let off = |fault: &HapticFault| *fault == HapticFault::SwitchedOff(SwitchOff::Velocity);
    type Row = (DeviceCall, FaultKind, fn(&HapticFault) -> bool, u64);
    // The last column: number of ticks from the injection to the fault, by the limits of the loop.
    let rows: [Row; 10] = [
        (DeviceCall::Engage, FaultKind::Held, held, 0),
        (DeviceCall::Engage, FaultKind::Fails, lost, 0),
        (DeviceCall::Sense, FaultKind::Unplugged, lost, 0),
        (DeviceCall::Sense, FaultKind::NotANumber, nan, 0),
        (DeviceCall::Sense, FaultKind::Jumps, jumped, 1),
        (DeviceCall::Sense, FaultKind::Stale, stale, 21),
        (DeviceCall::Command, FaultKind::Unplugged, lost, 0),
        (DeviceCall::Command, FaultKind::Fails, lost, 0),
        (DeviceCall::Command, FaultKind::Saturated, saturated, 1001),
        (
            DeviceCall::Standing,
            FaultKind::SwitchedOff(SwitchOff::Velocity),
            off,
            0,
        ),
    ];
    for (call, kind, expected, patience) in rows {
        for at in [0, 1, 300] {
            if call == DeviceCall::Engage && at > 0 {
                continue;
            }
            // A wrong first position cannot be detected.
            if kind == FaultKind::Jumps && at == 0 {
                continue;
            }
            let injection = FaultInjection { call, at, kind };
            let mut floor = Floor::new(|_| None);
            let (report, device) = played(Some(injection), &mut floor, &mut SimulatedPace, 20_000);
            let Ending::Fault(fault) = &report.ending else {
                panic!("{injection:?}: no fault");
            };
            assert!(expected(fault), "{injection:?}: {fault:?}");
            assert!(
                device.released && device.force_n == [0.0; 3],
                "{injection:?}"
            );
            assert_eq!(device.late_commands, 0, "{injection:?}");
            let every = if call == DeviceCall::Standing { 4 } else { 1 };
            assert!(
                device.ticks <= at * every + patience + 1,
                "{injection:?}: {} ticks",
                device.ticks
            );
        }
    }
}

#[test]
fn a_release_that_fails_is_said() {
    let injection = FaultInjection {
        call: DeviceCall::Release,
        at: 0,
        kind: FaultKind::Fails,
    };
    let mut floor = Floor::new(|_| None);
    let (report, device) = played(Some(injection), &mut floor, &mut SimulatedPace, 10);
    assert!(matches!(report.release, Err(HapticFault::Lost(..))));
    assert!(device.released);
}

#[test]
fn a_slow_call_ends_it_as_soon_as_it_returns() {
    for call in [DeviceCall::Sense, DeviceCall::Command] {
        let injection = FaultInjection {
            call,
            at: 50,
            kind: FaultKind::Slow(Duration::from_millis(80)),
        };
        let mut floor = Floor::new(|_| None);
        let mut device = Witness::new(Injected::new(pressed(), Some(injection)));
        let limits = ServoLimits {
            // This limit is far above the lateness on a busy machine and below the injected lateness.
            late_s: 0.06,
            ..ServoLimits::of(device.sheet())
        };
        let pace = &mut RealTime::new(RATE_HZ);
        let report = play(&mut device, &mut floor, &limits, RATE_HZ, pace, |_| true);
        assert!(
            matches!(report.ending, Ending::Fault(HapticFault::Late(late)) if late > 0.06),
            "{call:?}: {:?}",
            report.ending
        );
        assert!(device.released && device.ticks <= 51, "{}", device.ticks);
    }
}

#[test]
fn a_law_that_panics_leaves_the_device_released() {
    let mut device = Witness::new(pressed());
    let limits = ServoLimits::of(device.sheet());
    let mut floor = Floor::new(|tick| {
        assert!(tick < 200, "the law breaks");
        Some([1.0; 3])
    });
    let broke = catch_unwind(AssertUnwindSafe(|| {
        let pace = &mut SimulatedPace;
        play(&mut device, &mut floor, &limits, RATE_HZ, pace, |_| true)
    }));
    assert!(broke.is_err());
    assert!(device.released && device.force_n == [0.0; 3] && device.ticks == 200);
}

#[test]
fn forces_that_are_none_or_too_long_do_not_reach_the_device() {
    let mut floor = Floor::new(|tick| (tick == 9).then_some([0.0, f64::NAN, 0.0]));
    let (report, device) = played(None, &mut floor, &mut SimulatedPace, 100);
    assert_eq!(
        report.ending,
        Ending::Fault(HapticFault::NotFinite("force"))
    );
    assert!(device.ticks == 9 && device.released);
    // This force is ten times the limit. The limited force keeps its direction.
    let mut floor = Floor::new(|_| Some([72.0, 0.0, 96.0]));
    let (report, _) = played(None, &mut floor, &mut SimulatedPace, 300);
    assert!(report.force_max_n <= 12.0 + 1e-9, "{}", report.force_max_n);
    let last = floor.told[250];
    assert!((last[0] - 7.2).abs() < 1e-9 && (last[2] - 9.6).abs() < 1e-9);
}

/// Lets the hand carry the device out of its workspace. Checks that the force fades out, and that the control loop stops with a
/// fault when the device is far outside the workspace.
#[test]
fn outside_the_workspace_the_force_fades_and_far_outside_it_ends() {
    let rest = |time_s: f64| [0.3 * time_s, 0.0, 0.0];
    let mut device =
        Witness::new(SimulatedArm::new(DeviceTwin::default(), RATE_HZ, Box::new(rest)).unwrap());
    let limits = ServoLimits {
        ramp_s: 0.01,
        outside_m: 0.03,
        ..ServoLimits::of(device.sheet())
    };
    let mut floor = Floor::new(|_| Some([0.0, 0.0, 1.0]));
    let mut seen = Vec::new();
    let report = play(
        &mut device,
        &mut floor,
        &limits,
        RATE_HZ,
        &mut SimulatedPace,
        |tick| {
            seen.push((tick.position_m[0], tick.force_n[2]));
            true
        },
    );
    assert!(matches!(report.ending, Ending::Fault(HapticFault::Outside(far)) if far > 0.03));
    assert!(report.outside_ticks > 0 && device.released);
    for (x, force) in seen.into_iter().filter(|(x, _)| *x > 0.02) {
        let share = (1.0 - (x - 0.08) / 0.005).clamp(0.0, 1.0);
        assert!((force - share).abs() < 1e-9, "{force} at {x}");
    }
}

#[test]
fn one_axis_of_three_is_a_device_of_one() {
    let mut arm = OneAxis::new(pressed(), 2).unwrap();
    arm.device().engage().unwrap();
    let mut least = 0.0_f64;
    for _ in 0..4000 {
        let z = arm.sense().unwrap();
        least = least.min(z);
        arm.command((-2000.0 * z).max(0.0)).unwrap();
    }
    // The hand's spring of 300 N/m is displaced by 20 mm and presses against 2000 N/m. It rests 2.6 mm deep after some overshoot.
    assert!((-0.006..-0.002).contains(&least), "{least}");
    assert!(OneAxis::new(pressed(), 3).is_err());
}
