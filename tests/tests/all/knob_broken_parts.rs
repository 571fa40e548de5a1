//! Tests of parts that break while the motor is on: which fault the firmware raises, and the energy that the hand gets until then.

use touchstone_drive::calibration::Reason;
use touchstone_drive::encoder::Frames;
use touchstone_drive::{ControlInput, CurrentSample, DeviceSettings, EncoderReading, Si};
use touchstone_protocol::{Board, Command, FaultCode, State};
use touchstone_tests::knob::{Knob, Tamper};
use touchstone_world::motor::{GIMBAL, as5047p_frame};

fn settings() -> DeviceSettings {
    let mut settings = DeviceSettings::defaults(Board::NucleoG474re);
    settings.wall.surface_rad = Si::lit("0.2");
    settings
}

/// Falsifies the encoder as if its magnet had slipped by this many counts since the calibration.
struct Slip {
    counts: i64,
}
impl Slip {
    fn shift(&self, reading: EncoderReading) -> EncoderReading {
        match reading {
            EncoderReading::As5047p(Frames { angle, before }) => {
                let angle = as5047p_frame(i64::from(angle & 0x3fff) + self.counts);
                EncoderReading::As5047p(Frames { angle, before })
            }
            other => other,
        }
    }
}
impl Tamper for Slip {
    fn input(&mut self, _: u32, input: &mut ControlInput) -> bool {
        input.encoder = self.shift(input.encoder);
        true
    }
    fn change(&mut self, _: u32, reading: EncoderReading) -> Option<EncoderReading> {
        Some(self.shift(reading))
    }
}

/// Simulates a magnet that has slipped by this many electrical degrees. The motor is switched on, and a hand presses 1.5 rad
/// through the wall. Returns the most energy in J that the motor gave, the control ticks in which it pushed, and the fault.
fn pressed_after_slip(degrees: f64) -> (f64, u32, Option<FaultCode>) {
    let mut knob = Knob::new(&settings(), GIMBAL, 0.0, Slip { counts: 0 });
    assert_eq!(knob.calibrate(), State::Ready);
    // Slowly, so that neither a jump nor an over-speed is detected.
    for step in 1..=10 {
        knob.tamper.counts = (degrees / 360.0 / 7.0 * 16_384.0 * f64::from(step) / 10.0) as i64;
        for _ in 0..20 {
            knob.rest_rad = 0.0;
            knob.tick();
        }
    }
    knob.ask(Command::Arm);
    knob.tick();
    let (mut work, mut most) = (0.0, 0.0_f64);
    let mut last = knob.rig.now().angle_rad;
    let mut pushing = 0;
    for tick in 0..20_000_u32 {
        knob.rest_rad = f64::from(tick).min(1_000.0) * 0.0015;
        while !knob.period() {
            let now = knob.rig.now();
            work += now.torque_n_m * (now.angle_rad - last);
            last = now.angle_rad;
            most = most.max(work);
        }
        if knob.fault().is_some() {
            break;
        }
        pushing += u32::from(knob.record.force.0 != 0);
    }
    (most, pushing, knob.fault())
}

#[test]
fn a_slipped_magnet_is_found_before_the_motor_gives_a_fifth_of_a_joule() {
    for degrees in [-150.0, -120.0, -100.0, 100.0, 120.0, 150.0, 180.0] {
        let (most, pushing, fault) = pressed_after_slip(degrees);
        // The motor pushes for at most 50 ms.
        assert!(
            pushing <= 50,
            "{degrees} degrees: pushed for {pushing} ticks"
        );
        assert!(most < 0.2, "{degrees} degrees: {most:.3} J, {fault:?}");
        assert!(
            matches!(fault, Some(FaultCode::MotorModel | FaultCode::OverSpeed)),
            "{degrees} degrees: {fault:?}"
        );
    }
}

/// Loses encoder readings from control tick 8,000 on: every n-th one of the readings at the tick (`tick`), and of those taken when
/// the force changes (`change`).
struct Lossy {
    tick: Option<u32>,
    change: Option<u32>,
}
impl Tamper for Lossy {
    fn input(&mut self, tick: u32, input: &mut ControlInput) -> bool {
        if tick > 8_000 && self.tick.is_some_and(|every| tick.is_multiple_of(every)) {
            input.encoder = EncoderReading::Silent;
        }
        true
    }
    fn change(&mut self, tick: u32, reading: EncoderReading) -> Option<EncoderReading> {
        let lost = tick > 8_000 && self.change.is_some_and(|every| tick.is_multiple_of(every));
        (!lost).then_some(reading)
    }
}

/// Simulates lost encoder readings. Returns the fault's value, which names the sort of reading, and the number of control ticks
/// until the fault; `None` without a fault.
fn lost(tick: Option<u32>, change: Option<u32>) -> Option<(i32, u32)> {
    let mut knob = Knob::new(&settings(), GIMBAL, 0.0, Lossy { tick, change }).armed();
    for _ in 0..60_000 {
        knob.rest_rad = 1.0;
        knob.tick();
        if let Some(fault) = knob.device.fault() {
            assert_eq!(fault.code, FaultCode::EncoderUnsteady);
            return Some((fault.value, fault.tick - 8_000));
        }
    }
    None
}

#[test]
fn bad_readings_that_are_not_in_a_row_are_a_fault_and_a_few_are_not() {
    for (tick, change, kind, within) in [
        (Some(2), None, 1, 50),
        (Some(10), None, 1, 300),
        (Some(40), None, 1, 5_000),
        (None, Some(1), 2, 50),
        (None, Some(2), 2, 100),
        (None, Some(10), 2, 300),
        (None, Some(40), 2, 5_000),
    ] {
        let found = lost(tick, change);
        assert!(
            found.is_some_and(|(which, after)| which == kind && after < within),
            "{tick:?} {change:?}: {found:?}"
        );
    }
    assert_eq!(lost(Some(100), Some(100)), None);
}

/// A defect of a motor current sensor from control tick 8,000 on. Each variant holds the number of the phase.
#[derive(Debug, Clone, Copy)]
enum Sensor {
    /// The sensor always returns its value for zero current.
    Rests(usize),
    /// The sensor always returns the value that it had when it froze.
    Frozen(usize, Option<u16>),
    /// The sensor returns half of the true current.
    Half(usize),
    /// The sensor returns a sixteenth of the true current.
    Weak(usize),
}
impl Tamper for Sensor {
    fn sample(&mut self, tick: u32, sample: &mut CurrentSample) {
        if tick <= 8_000 {
            return;
        }
        let (Self::Rests(phase) | Self::Frozen(phase, _) | Self::Half(phase) | Self::Weak(phase)) =
            *self;
        let rest = [2_128, 2_100][phase];
        let code = if phase == 0 {
            &mut sample.phase_a
        } else {
            &mut sample.phase_b
        };
        let share = |by| ((i32::from(*code) - rest) / by + rest) as u16;
        *code = match self {
            Self::Rests(_) => rest as u16,
            Self::Half(_) => share(2),
            Self::Weak(_) => share(16),
            Self::Frozen(_, at) => *at.get_or_insert(*code),
        };
    }
}

#[test]
fn a_current_sensor_that_fails_under_a_pressing_hand_is_a_fault() {
    let mut found = Vec::new();
    for sensor in [
        Sensor::Rests(0),
        Sensor::Rests(1),
        Sensor::Half(0),
        Sensor::Half(1),
        Sensor::Weak(0),
        Sensor::Weak(1),
        Sensor::Frozen(0, None),
        Sensor::Frozen(1, None),
    ] {
        let mut knob = Knob::new(&settings(), GIMBAL, 0.0, sensor).armed();
        let (mut work, mut most) = (0.0, 0.0_f64);
        let mut last = knob.rig.now().angle_rad;
        for tick in 0..30_000 {
            // The hand's press varies, because a constant sensor value at a constant current is not a fault.
            let firm = f64::from(tick).min(3_000.0) * 0.001;
            knob.rest_rad = firm * (1.0 + 0.3 * (f64::from(tick) * 2.0e-3).sin());
            while !knob.period() {
                let now = knob.rig.now();
                if knob.record.tick > 8_000 {
                    work += now.torque_n_m * (now.angle_rad - last);
                    most = most.max(work);
                }
                last = now.angle_rad;
            }
            if knob.fault().is_some() {
                break;
            }
        }
        let fault = knob.device.fault();
        found.push((sensor, most, fault));
    }
    for (sensor, most, fault) in found {
        let code = fault.map(|fault| fault.code);
        // While the knob stands still, a stuck encoder would also explain a motor voltage without measured motion. So
        // `EncoderStuck` is accepted.
        assert!(
            matches!(
                code,
                Some(FaultCode::MotorModel | FaultCode::EncoderStuck | FaultCode::OverCurrent)
            ),
            "{sensor:?}: {code:?}"
        );
        assert!(most < 0.25, "{sensor:?}: {most} J");
    }
}

/// Current sensors that are defective from the start. The function falsifies their readings.
struct Always(fn(&mut CurrentSample));
impl Tamper for Always {
    fn sample(&mut self, _: u32, sample: &mut CurrentSample) {
        (self.0)(sample);
    }
}
fn gain(code: u16, rest: i32, percent: i32) -> u16 {
    ((i32::from(code) - rest) * percent / 100 + rest) as u16
}

#[test]
fn false_sensors_do_not_pass_the_calibration_and_nearly_equal_ones_do() {
    let calibrated = |falsify| Knob::new(&settings(), GIMBAL, 0.3, Always(falsify)).calibrate();
    let refused = |state, reasons: &[Reason]| {
        let State::Fault(fault) = state else {
            panic!("{state:?}");
        };
        assert_eq!(fault.code, FaultCode::CalibrationFailed);
        let reason = Reason::from_value(fault.value).expect("a reason");
        assert!(reasons.contains(&reason), "{reason:?}");
    };
    let unbalanced = &[Reason::Unbalanced];
    refused(
        calibrated(|s| s.phase_a = gain(s.phase_a, 2_128, 50)),
        unbalanced,
    );
    refused(
        calibrated(|s| s.phase_b = gain(s.phase_b, 2_100, 50)),
        unbalanced,
    );
    refused(
        calibrated(|s| s.phase_a = gain(s.phase_a, 2_128, 200)),
        unbalanced,
    );
    refused(
        calibrated(|s| s.phase_b = gain(s.phase_b, 2_100, 200)),
        unbalanced,
    );
    for percent in [
        |s: &mut CurrentSample| s.phase_a = gain(s.phase_a, 2_128, 90),
        |s: &mut CurrentSample| {
            s.phase_b = gain(s.phase_b, 2_100, 110);
        },
    ] {
        assert_eq!(calibrated(percent), State::Ready);
    }
    // Currents of the phases A and B exchanged: no current reaches its command.
    refused(
        calibrated(|s| core::mem::swap(&mut s.phase_a, &mut s.phase_b)),
        &[Reason::NoCurrent],
    );
}
