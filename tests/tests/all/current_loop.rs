//! Tests of the firmware's current loop with a simulated motor: its speed, its accuracy, and what it does at its limits.

use touchstone_control::{Fixed32, Position, Si};
use touchstone_drive::change::ChangeConfig;
use touchstone_drive::hardware::IHM08M1;
use touchstone_drive::transform::Dq;
use touchstone_drive::{
    Amps, Angle, BridgeCommand as Out, CurrentCommand, CurrentConfig, CurrentLoop, CurrentMode,
    CurrentOutput, CurrentSample, DeviceSettings,
};
use touchstone_protocol::{Board, FaultCode};
use touchstone_world::motor::{Bridge, Drive, GIMBAL, KNOB, MotorParameters, Rig, Shunt};
use touchstone_world::plant::{BareLinear, Device, State};

const PERIOD_S: f64 = 50e-6;

/// The current loop and the simulated motor. Each command to the loop contains the rotor's true angle.
struct Setup {
    current: CurrentLoop,
    rig: Rig<BareLinear>,
    motor: MotorParameters,
    shunts: [Shunt; 2],
    preloaded: Drive,
    /// The command that the next control tick gives to the current loop.
    wanted: CurrentCommand,
    command: CurrentCommand,
    alive: bool,
    /// Whether the PWM compare values of the last period were written too late.
    late: bool,
}

impl Setup {
    fn new(device: &Device, bus_v: f64) -> Self {
        let settings = DeviceSettings::default();
        let mut setup = Self {
            current: CurrentLoop::new(CurrentConfig::new(&settings, &IHM08M1).unwrap()),
            rig: Rig::new(
                GIMBAL,
                Bridge::ideal(bus_v, IHM08M1.timer_top),
                BareLinear::new(device, PERIOD_S / 2.0).unwrap(),
                0.0,
            ),
            motor: GIMBAL,
            shunts: [2_128.3, 2_099.8]
                .map(|offset| Shunt::low_side(0.01, 5.7 * 6.8 / 7.48, offset)),
            preloaded: Drive::Off,
            wanted: CurrentCommand {
                mode: CurrentMode::Offsets,
                ..CurrentCommand::OFF
            },
            command: CurrentCommand::OFF,
            alive: true,
            late: false,
        };
        for _ in 0..1_100 {
            setup.period();
        }
        setup.wanted.mode = CurrentMode::Drive;
        setup.tick();
        setup
    }

    /// Runs one PWM period, and the control tick if one is due in this period.
    fn period(&mut self) -> CurrentOutput {
        let now = self.rig.now();
        let sample = CurrentSample {
            phase_a: self.shunts[0].code(now.currents_a[0]),
            phase_b: self.shunts[1].code(now.currents_a[1]),
            bus: (self.rig.bridge.bus_v / IHM08M1.volts_per_code.to_num::<f64>()) as u16,
            temperature: 1_300,
            hardware_break: false,
            late: self.late,
            command: self.command,
        };
        let out = self.current.tick(&sample);
        if out.pend_control && self.alive {
            self.control();
        }
        let (acting, next) = match out.bridge {
            Out::Off => (Drive::Off, Drive::Off),
            Out::On(duties) => (
                if self.preloaded == Drive::Off {
                    Drive::On(IHM08M1.modulator().zero())
                } else {
                    self.preloaded
                },
                Drive::On(duties),
            ),
        };
        // Currents are sampled at the counter's top; the timer takes over new compare values at the bottom.
        self.rig.step(acting, 0.0);
        self.preloaded = next;
        self.rig.step(next, 0.0);
        out
    }

    /// Runs the control tick, which gives the current loop a new command with the shaft's present angle.
    fn control(&mut self) {
        let now = self.rig.now();
        let turn = |rad: f64| rad / std::f64::consts::TAU;
        let angle = self.motor.electrical_rad(now.angle_rad);
        let speed = self.motor.electrical_rad(now.speed_rad_per_s) - self.motor.electrical_rad(0.0);
        self.command = CurrentCommand {
            tick: self.command.tick + 1,
            angle: Angle((turn(angle) * 65_536.0).rem_euclid(65_536.0) as u16),
            advance: (turn(speed) * PERIOD_S * 2f64.powi(32)) as i32,
            ..self.wanted
        };
    }

    /// Runs PWM periods up to and including the one with the next control tick.
    fn tick(&mut self) {
        while !self.period().pend_control {}
    }

    fn hold(&mut self, d: f64, q: f64) {
        self.wanted.current = Dq {
            d: Amps::from_num(d),
            q: Amps::from_num(q),
        };
    }
}

/// A knob whose inertia is so large that the shaft does not move.
const BLOCKED: Device = Device {
    inertia: 1e3,
    ..KNOB
};

#[test]
fn a_step_of_current_is_there_in_a_millisecond_without_overshoot() {
    for (d, q) in [(0.0, 0.5), (0.0, -0.5), (0.5, 0.0), (0.3, -0.4)] {
        let mut setup = Setup::new(&BLOCKED, 24.0);
        setup.period();
        setup.hold(d, q);
        setup.tick();
        let mut most: f64 = 0.0;
        for period in 0..400 {
            setup.period();
            let (is_d, is_q) = setup.rig.dq_a();
            let along = (is_d * d + is_q * q) / 0.5_f64.max((d * d + q * q).sqrt());
            most = most.max(along);
            let error = (is_d - d).hypot(is_q - q);
            if period >= 20 {
                // One code of the sensor is 15.6 mA.
                assert!(error < 0.02, "{period}: {is_d} {is_q} for {d} {q}");
            }
        }
        assert!(most < 0.5 * 1.0 + 0.02, "overshoot: {most}");
    }
}

/// Checks two assumptions of the energy guard with the simulated motor and bridge: how much of a change of force is still missing
/// when the encoder is read a second time, and the mean delay of the change. The encoder is read a quarter of a PWM period after
/// each current sample.
#[test]
fn a_step_of_current_comes_as_the_guard_counts_on() {
    let settings = DeviceSettings::defaults(Board::NucleoG474re);
    let change = ChangeConfig::new(&settings, &IHM08M1).unwrap().unwrap();
    let mut setup = Setup::new(&BLOCKED, 24.0);
    setup
        .current
        .reconfigure(CurrentConfig::new(&settings, &IHM08M1).unwrap());
    setup.wanted.mode = CurrentMode::Offsets;
    for _ in 0..1_100 {
        setup.period();
    }
    setup.wanted.mode = CurrentMode::Drive;
    setup.hold(0.0, 0.0);
    setup.tick();
    setup.hold(0.0, 1.0);
    setup.tick();
    // Current at the end of each half period since the sample of the tick that commands the change.
    let missing = |setup: &Setup| 1.0 - setup.rig.dq_a().1;
    let mut halves = vec![1.0, 1.0, missing(&setup)];
    for _ in 1..=20 {
        setup.period();
        halves.push(f64::NAN);
        halves.push(missing(&setup));
    }
    for at in (3..halves.len()).step_by(2) {
        halves[at] = (halves[at - 1] + halves[at + 1]) / 2.0;
    }
    // The loop's shunt values are not quite right, so currents are relative to the final value.
    for _ in 0..400 {
        setup.period();
    }
    let there = missing(&setup);
    let at = |t: f64| {
        let (whole, part) = ((2.0 * t) as usize, (2.0 * t).fract());
        let missing = halves[whole] * (1.0 - part) + halves[whole + 1] * part;
        (missing - there) / (1.0 - there)
    };
    let mean = |from: f64, to: f64| {
        let steps = 400;
        let h = (to - from) / f64::from(steps);
        (0..steps)
            .map(|i| at(from + h * (f64::from(i) + 0.5)))
            .sum::<f64>()
            / f64::from(steps)
    };
    let read = f64::from(change.read_at) + 0.25;
    let whole_s = mean(0.25, 20.25) * 20.0 * PERIOD_S;
    let told_s: f64 = change.delay_s.to_num::<f64>() + change.lag_s.to_num::<f64>();
    // Fraction of a displacement that the guard counts under the old force: for one entirely before the reading, and for one
    // entirely after it.
    let unit = Position::<Fixed32>::from_si(Si::ONE).unwrap();
    let lag = change.lag_s.to_num::<f64>();
    let own = lag / (1e-3 - change.delay_s.to_num::<f64>());
    let counted = |before, after| {
        let since = change.since_change(before, after).to_f64();
        1.0 - since * (1.0 - own)
    };
    let (first, second) = (
        counted(unit, Position::zero()),
        counted(Position::zero(), unit),
    );
    println!(
        "read after {} periods: {first:.3} and {second:.3} counted, {:.3} and {:.3} there; late by {:.1} us, {:.1} there; lag {:.2} us; rest {:.4}",
        change.read_at,
        mean(0.25, read),
        mean(read, 20.25),
        1e6 * told_s,
        1e6 * whole_s,
        1e6 * lag,
        at(20.25)
    );
    assert!((first - mean(0.25, read)).abs() < 0.02);
    assert!((second - mean(read, 20.25)).abs() < 0.01);
    assert!((told_s - whole_s).abs() < 5e-6);
    assert!(at(20.25).abs() < 0.02);
}

#[test]
fn a_large_step_meets_the_voltage_limit_and_does_not_wind_up() {
    let mut setup = Setup::new(&BLOCKED, 16.0);
    setup.period();
    // 1.9 A need 11.4 V; 16 V give at most 8.5 V. So the limit acts for as long as 1.9 A are commanded.
    setup.hold(0.0, 1.9);
    setup.period();
    let before = setup.current.report().saturated;
    for _ in 0..4_000 {
        setup.period();
    }
    setup.period();
    assert!(
        setup.current.report().saturated.wrapping_sub(before) > 3_900,
        "{:?}",
        setup.current.report()
    );
    let held = setup.rig.dq_a().1;
    assert!((1.35..1.45).contains(&held), "{held}");
    // Back below the limit: a wound-up integrator would hold the current up for longer than a step takes.
    setup.hold(0.0, 0.5);
    setup.tick();
    for _ in 0..20 {
        setup.period();
    }
    let mut least: f64 = 1.0;
    for _ in 0..200 {
        setup.period();
        least = least.min(setup.rig.dq_a().1);
    }
    assert!(
        (0.48..0.52).contains(&setup.rig.dq_a().1) && least > 0.48,
        "{least}"
    );
}

/// With both currents far from their commands, the voltage vector is as long as the bridge can make it, and no longer.
#[test]
fn both_voltages_together_stay_in_the_circle() {
    let mut longest: f64 = 0.0;
    for (d, q) in [(0.9, 0.9), (-0.9, 0.5), (0.2, -0.9), (0.5, 0.0)] {
        let mut setup = Setup::new(&BLOCKED, 5.0);
        setup.hold(d, q);
        setup.tick();
        for period in 0..200 {
            setup.period();
            let voltage = setup.current.report().voltage;
            let length = voltage.d.to_num::<f64>().hypot(voltage.q.to_num());
            // The inner circle of the bridge's hexagon.
            assert!(length < 5.0 / 3_f64.sqrt() + 0.01, "{period}: {voltage:?}");
            longest = longest.max(length);
        }
    }
    assert!(longest > 2.5, "{longest}");
}

#[test]
fn the_torque_stands_while_the_motor_turns() {
    // With this damping, 0.25 N·m turn the shaft at 40 rad/s, which is 280 rad/s electrically. This needs 6.7 V against the
    // back-EMF and 6 V for the resistance. Of 28 V, 14.4 V are available, because a part of each period is reserved for sampling.
    let mut setup = Setup::new(
        &Device {
            inertia: 1e-4,
            damping: 0.25 / 40.0,
            friction: None,
        },
        28.0,
    );
    setup.period();
    setup.hold(0.0, 1.0);
    for _ in 0..20_000 {
        setup.period();
    }
    assert!(
        (setup.rig.now().speed_rad_per_s - 40.0).abs() < 0.8,
        "{:?}",
        setup.rig.now()
    );
    for _ in 0..500 {
        setup.period();
        let (d, q) = setup.rig.dq_a();
        assert!(d.abs() < 0.04 && (q - 1.0).abs() < 0.03, "{d} {q}");
    }
}

#[test]
fn the_voltage_acts_at_the_angle_it_is_made_for() {
    // Turned from outside at 350 rad/s electrically: a PWM period is one degree.
    let omega = 350.0;
    let mut setup = Setup::new(
        &Device {
            inertia: 1e3,
            damping: 0.0,
            friction: None,
        },
        24.0,
    );
    setup.period();
    setup.hold(0.0, 0.5);
    *setup.rig.state_mut() = State::from_array([0.0, omega / f64::from(GIMBAL.pole_pairs)]);
    for _ in 0..4_000 {
        setup.period();
    }
    let mut mean = [0.0; 2];
    for _ in 0..1_000 {
        setup.period();
        let voltage = setup.current.report().voltage;
        mean[0] += voltage.d.to_num::<f64>() / 1_000.0;
        mean[1] += voltage.q.to_num::<f64>() / 1_000.0;
    }
    // v = R i + j ω (L i + λ), with i along q.
    let exact = [
        -omega * GIMBAL.inductance_h * 0.5,
        GIMBAL.resistance_ohm * 0.5 + omega * GIMBAL.flux_linkage_wb,
    ];
    // An angle error of half a period would turn 0.1 V from one axis into the other.
    for axis in 0..2 {
        assert!(
            (mean[axis] - exact[axis]).abs() < 0.02,
            "{mean:?} for {exact:?}"
        );
    }
}

#[test]
fn too_much_current_switches_off_in_the_same_period_and_stays_off_until_told() {
    let mut setup = Setup::new(&BLOCKED, 24.0);
    setup.hold(0.0, 0.5);
    for _ in 0..100 {
        assert!(matches!(setup.period().bridge, Out::On(_)));
    }
    // The over-current limit of 4 A is 258 codes.
    for (phase, codes) in [(0, 300.0), (1, -300.0), (0, -300.0), (1, 300.0)] {
        setup.period();
        let trips = setup.current.report().trips;
        let honest = setup.shunts;
        setup.shunts[phase].offset_code += codes;
        let out = setup.period();
        assert_eq!(out.bridge, Out::Off);
        assert_eq!(
            setup.current.report().trip.map(|trip| trip.code),
            Some(FaultCode::OverCurrent)
        );
        assert_eq!(setup.current.report().trips, trips.wrapping_add(1));
        setup.shunts = honest;
        for _ in 0..50 {
            assert_eq!(setup.period().bridge, Out::Off, "without being told");
        }
        setup.wanted.mode = CurrentMode::Off;
        setup.tick();
        setup.period();
        setup.wanted.mode = CurrentMode::Drive;
        setup.tick();
        assert!(matches!(setup.period().bridge, Out::On(_)));
    }
}

#[test]
fn an_old_command_switches_off_within_two_control_periods() {
    let mut setup = Setup::new(&BLOCKED, 24.0);
    setup.hold(0.0, 0.5);
    for _ in 0..100 {
        setup.period();
    }
    setup.tick();
    // The control tick is no longer running.
    setup.alive = false;
    for period in 1..=40 {
        assert!(matches!(setup.period().bridge, Out::On(_)), "{period}");
    }
    let out = setup.period();
    assert_eq!(out.bridge, Out::Off);
    assert_eq!(
        setup.current.report().trip.map(|trip| trip.code),
        Some(FaultCode::StaleCommand)
    );
    assert_eq!(setup.current.report().missed, 1);
}

#[test]
fn without_offsets_nothing_is_driven() {
    let settings = DeviceSettings::default();
    let mut current = CurrentLoop::new(CurrentConfig::new(&settings, &IHM08M1).unwrap());
    for tick in 1..100 {
        let command = CurrentCommand {
            tick,
            mode: CurrentMode::Drive,
            ..CurrentCommand::OFF
        };
        let sample = CurrentSample {
            bus: 1_500,
            command,
            ..CurrentSample::default()
        };
        assert_eq!(current.tick(&sample).bridge, Out::Off);
    }
}

#[test]
fn a_late_period_or_two_are_borne_and_the_third_in_a_row_switches_off() {
    let mut setup = Setup::new(&KNOB, 24.0);
    for late in [true, true, false, true, true, false] {
        setup.late = late;
        assert!(matches!(setup.period().bridge, Out::On(_)));
    }
    setup.late = true;
    assert!(matches!(setup.period().bridge, Out::On(_)));
    assert!(matches!(setup.period().bridge, Out::On(_)));
    let out = setup.period();
    assert_eq!(out.bridge, Out::Off);
    let trip = setup.current.report().trip.unwrap();
    assert_eq!((trip.code, trip.value), (FaultCode::DeadlineMiss, 3));
    // Compare values in time again: outputs stay off until the control tick switches them on.
    setup.late = false;
    assert_eq!(setup.period().bridge, Out::Off);
}
