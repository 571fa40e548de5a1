//! Tests a motor that is driven by voltage because the board has no current sensors: its torque, its errors, and the faults that go
//! unnoticed. `cargo test -p touchstone-tests voltage_mode:: -- --nocapture` prints the figures of docs/voltage-mode.md.

use touchstone_control::Si;
use touchstone_drive::change::ChangeConfig;
use touchstone_drive::hardware::SIMPLEFOC_MINI;
use touchstone_drive::transform::Dq;
use touchstone_drive::wire::checked;
use touchstone_drive::{
    Amps, BridgeCommand, CurrentCommand, CurrentConfig, CurrentLoop, CurrentMode, CurrentSample,
    Reason,
};
use touchstone_protocol::{Board, DeviceSettings, FaultCode, State};
use touchstone_sim::scene::Scene;
use touchstone_tests::knob::{Knob, PERIOD_S, Tamper};
use touchstone_world::motor::{Bridge, Drive, GIMBAL, MotorParameters, Rig};
use touchstone_world::plant::{BareLinear, Device, HeldLinear, MEDIUM, State as Motion};

const BOARD: Board = Board::NucleoG474reSimplefocMini;

/// The small gimbal motor. Its resistance includes that of a transistor of the driver.
const MOTOR: MotorParameters = MotorParameters {
    resistance_ohm: 5.53,
    inductance_h: 1.05e-3,
    flux_linkage_wb: 5.38e-3,
    ..GIMBAL
};

/// Inertia and damping of the simulated knob on the small gimbal motor, without dry friction.
const KNOB: Device = Device {
    inertia: 3e-5,
    damping: 9e-6,
    friction: None,
};

/// Settings of the board with the motor's values as a user enters them.
fn told() -> DeviceSettings {
    let mut settings = DeviceSettings::defaults(BOARD);
    settings.motor.resistance_ohm = Si::lit("5.53");
    settings.motor.inductance_h = Si::lit("0.00105");
    settings.motor.torque_constant_n_m_per_a = Si::lit("0.0565");
    settings.law.force_limit_n_m = Si::lit("0.045");
    assert_eq!(checked(&settings, BOARD), Ok(()));
    settings
}

/// The simulated motor. Its true resistance is `factor` times the one that the user entered.
fn of_resistance(factor: f64) -> MotorParameters {
    MotorParameters {
        resistance_ohm: MOTOR.resistance_ohm * factor,
        ..MOTOR
    }
}

/// Sets the simulated supply voltage to a constant 12 V.
struct Supply;
impl Tamper for Supply {
    fn bus_v(&mut self, _tick: u32) -> f64 {
        12.0
    }
}

/// Current loop, bridge and motor without the control tick; the test itself gives the current command.
struct Bare {
    current: CurrentLoop,
    rig: Rig<BareLinear>,
    command: CurrentCommand,
    preloaded: Drive,
    periods: u32,
}

impl Bare {
    fn new(motor: MotorParameters, knob: &Device, bus_v: f64) -> Self {
        let plant = BareLinear::new(knob, PERIOD_S / 2.0).unwrap();
        let config = CurrentConfig::new(&told(), &SIMPLEFOC_MINI).unwrap();
        Self {
            current: CurrentLoop::new(config),
            rig: Rig::new(
                motor,
                Bridge::ideal(bus_v, SIMPLEFOC_MINI.timer_top),
                plant,
                0.0,
            ),
            command: CurrentCommand {
                mode: CurrentMode::Drive,
                ..CurrentCommand::OFF
            },
            preloaded: Drive::Off,
            periods: 0,
        }
    }

    /// Runs one PWM period with the commanded torque-producing current `q` in A. Every 20th period gets a new command with the true
    /// angle. Returns the mean torque, N·m.
    fn period(&mut self, q: f64) -> f64 {
        if self.periods.is_multiple_of(20) {
            let now = self.rig.now();
            let turns = |rad: f64| rad / std::f64::consts::TAU;
            let pairs = f64::from(MOTOR.pole_pairs);
            let electrical = turns(now.angle_rad) * pairs + turns(MOTOR.electrical_zero_rad);
            self.command.tick += 1;
            self.command.angle =
                touchstone_drive::Angle((electrical.rem_euclid(1.0) * 65_536.0) as u16);
            let advance = turns(now.speed_rad_per_s) * pairs * PERIOD_S;
            self.command.advance = (advance * 4_294_967_296.0) as i32;
            self.command.current = Dq {
                d: Amps::ZERO,
                q: Amps::from_num(q),
            };
        }
        self.periods += 1;
        let volts: f64 = SIMPLEFOC_MINI.volts_per_code.to_num();
        let out = self.current.tick(&CurrentSample {
            bus: (self.rig.bridge.bus_v / volts).round() as u16,
            command: self.command,
            ..CurrentSample::default()
        });
        let (acting, next) = match (out.bridge, self.preloaded) {
            (BridgeCommand::Off, _) => (Drive::Off, Drive::Off),
            (BridgeCommand::On(duties), Drive::Off) => (
                Drive::On(SIMPLEFOC_MINI.modulator().zero()),
                Drive::On(duties),
            ),
            (BridgeCommand::On(duties), before) => (before, Drive::On(duties)),
        };
        self.preloaded = next;
        let halves = [acting, next].map(|drive| self.rig.step(drive, 0.0).torque_n_m);
        (halves[0] + halves[1]) / 2.0
    }

    /// Mean torque in N·m on a held shaft at the commanded current `q` in A.
    fn held(&mut self, q: f64) -> f64 {
        for _ in 0..100 {
            self.period(q);
        }
        (0..20).map(|_| self.period(q)).sum::<f64>() / 20.0
    }
}

const BLOCKED: Device = Device {
    inertia: 1e3,
    ..KNOB
};

#[test]
fn the_torque_is_as_right_as_the_resistance() {
    let constant = MOTOR.torque_constant_nm_per_a();
    println!("true R by that of the settings: torque by what was asked for");
    for factor in [0.7, 1.0, 1.3] {
        let mut bare = Bare::new(of_resistance(factor), &BLOCKED, 12.0);
        let shown = [0.1, 0.3, 0.6].map(|amps| bare.held(amps) / (constant * amps));
        println!("{factor}: {shown:.4?}");
        for shown in shown {
            assert!((shown * factor - 1.0).abs() < 0.005, "{factor}: {shown}");
        }
        // The loop does not measure the current: it reports the commanded one.
        let says: f64 = bare.current.report().current.q.to_num();
        assert!((says - 0.6).abs() < 0.001, "{says}");
    }
}

#[test]
fn the_supply_makes_no_difference_within_its_limits() {
    let at = |bus_v| Bare::new(MOTOR, &BLOCKED, bus_v).held(0.5);
    let (low, high) = (at(10.0), at(16.0));
    assert!((low / high - 1.0).abs() < 0.003, "{low} {high}");
}

#[test]
fn a_step_of_the_torque_is_a_count_of_the_timer() {
    let mut bare = Bare::new(MOTOR, &BLOCKED, 12.0);
    let constant = MOTOR.torque_constant_nm_per_a();
    // From 5 mN·m up, in fifths of the current that one step of the voltage, 12 V/4,250, gives.
    let step = 12.0 / 4_250.0 / MOTOR.resistance_ohm / 5.0;
    let (mut worst, mut squares): (f64, f64) = (0.0, 0.0);
    const STEPS: u32 = 200;
    for index in 0..STEPS {
        let amps = 0.09 + step * f64::from(index);
        let off = bare.held(amps) - constant * amps;
        worst = worst.max(off.abs());
        squares += off * off;
    }
    let rms = (squares / f64::from(STEPS)).sqrt();
    let count = constant * step * 5.0;
    println!(
        "a count is {:.4} mN·m; off by {:.4} mN·m rms, {:.4} at worst",
        1e3 * count,
        1e3 * rms,
        1e3 * worst
    );
    assert!(worst < 1.5 * count, "{worst} of {count}");
    assert!(rms > 0.05 * count, "nothing is rounded: {rms}");
}

/// Damping of a freely turning knob in N·m·s/rad, from its falling speed at two instants 30 ms apart. `drives` says whether the
/// bridge is on.
fn damping(motor: MotorParameters, drives: bool) -> f64 {
    let mut bare = Bare::new(motor, &KNOB, 12.0);
    if !drives {
        bare.command.mode = CurrentMode::Off;
    }
    *bare.rig.state_mut() = Motion::from_array([0.0, 20.0]);
    let mut speeds = Vec::new();
    for _ in 0..1_000 {
        bare.period(0.0);
        speeds.push(bare.rig.now().speed_rad_per_s);
    }
    KNOB.inertia * (speeds[200] / speeds[800]).ln() / (600.0 * PERIOD_S)
}

#[test]
fn the_back_emf_damps_by_what_the_model_says() {
    let scene = Scene::load("voltage-knob").unwrap();
    let model = scene.device.current_loop.as_ref().unwrap();
    let off = damping(MOTOR, false);
    assert!((off / KNOB.damping - 1.0).abs() < 0.01, "{off}");
    let constant = MOTOR.torque_constant_nm_per_a();
    println!(
        "true R by that of the settings: damping of the back-EMF, measured, and k_t²/(3/2 R), N·m·s/rad"
    );
    for factor in [0.7, 1.0, 1.3] {
        let motor = of_resistance(factor);
        let measured = damping(motor, true) - KNOB.damping;
        let exact = constant * constant / (1.5 * motor.resistance_ohm);
        println!(
            "{factor}: {measured:.4e} {exact:.4e} ({:+.2} %)",
            100.0 * (measured / exact - 1.0)
        );
        // The time constant `L/R` of the windings makes the slow decay a little faster, by the factor 1 + b L/(R J) (0.25 % more)
        // with the damping `b` by the back-EMF and the inertia `J`.
        assert!((measured / exact - 1.0).abs() < 0.01, "{measured} {exact}");
        if factor == 1.0 {
            let in_model = model.back_emf_n_m_s_per_rad;
            assert!((in_model / exact - 1.0).abs() < 0.005, "{in_model}");
            let pole = motor.resistance_ohm / (std::f64::consts::TAU * motor.inductance_h);
            assert!((model.bandwidth_hz / pole - 1.0).abs() < 0.005);
        }
    }
}

#[test]
fn no_less_of_a_change_is_missing_than_the_guard_counts_on() {
    let settings = told();
    let change = ChangeConfig::new(&settings, &SIMPLEFOC_MINI)
        .unwrap()
        .unwrap();
    let mut bare = Bare::new(MOTOR, &BLOCKED, 12.0);
    bare.held(0.0);
    bare.periods = 0;
    let torques: Vec<f64> = (0..400).map(|_| bare.period(0.4)).collect();
    let missing = torques.iter().map(|torque| 1.0 - torque / torques[399]);
    // In this test the loop takes a command in the PWM period in which the command is given, on a board in the next one. The
    // encoder is read a quarter of a period later.
    let there = missing.sum::<f64>() * PERIOD_S + 0.75 * PERIOD_S;
    let counted: f64 = change.delay_s.to_num::<f64>() + change.lag_s.to_num::<f64>();
    println!(
        "a change of force is late by {:.1} us; {:.1} counted, {:.1} of them as a lag; the encoder is read after {} periods",
        1e6 * there,
        1e6 * counted,
        1e6 * change.lag_s.to_num::<f64>(),
        change.read_at
    );
    assert!(counted > there - 2e-6 && counted < there + 15e-6);
}

#[test]
fn a_calibration_finds_the_rotor_whatever_the_resistance() {
    for factor in [0.7, 1.0, 1.3] {
        let plant = HeldLinear::new(&KNOB, &MEDIUM, PERIOD_S / 2.0).unwrap();
        let motor = of_resistance(factor);
        let mut knob = Knob::on(&SIMPLEFOC_MINI, &told(), motor, plant, 0.3, Supply);
        assert_eq!(
            knob.calibrate(),
            State::Ready,
            "{factor}: {:?}",
            knob.device.fault()
        );
    }
}

#[test]
fn a_motor_that_was_not_told_is_not_driven() {
    let settings = DeviceSettings::defaults(BOARD);
    assert_eq!(checked(&settings, BOARD), Ok(()));
    assert_eq!(settings.untold_motor(), Some("motor.resistance_ohm"));
    for path in ["motor.inductance_h", "motor.torque_constant_n_m_per_a"] {
        let mut settings = told();
        let untold = DeviceSettings::defaults(BOARD);
        if path == "motor.inductance_h" {
            settings.motor.inductance_h = untold.motor.inductance_h;
        } else {
            settings.motor.torque_constant_n_m_per_a = untold.motor.torque_constant_n_m_per_a;
            settings.law.force_limit_n_m = untold.law.force_limit_n_m;
        }
        assert_eq!(settings.untold_motor(), Some(path));
        let plant = BareLinear::new(&KNOB, PERIOD_S / 2.0).unwrap();
        let mut knob = Knob::on(&SIMPLEFOC_MINI, &settings, MOTOR, plant, 0.3, Supply);
        knob.calibrate();
        assert_eq!(knob.fault(), Some(FaultCode::CalibrationFailed));
        let value = knob.device.fault().map_or(0, |fault| fault.value);
        assert_eq!(Reason::from_value(value), Some(Reason::MotorUntold));
        assert_eq!(knob.rig.now().currents_a, [0.0; 3]);
    }
}

#[test]
fn it_measures_no_motor() {
    let mut settings = told();
    settings.calibration.measures = true;
    let refused = checked(&settings, BOARD).unwrap_err().to_string();
    assert_eq!(
        refused,
        "calibration.measures: this board does not measure its currents, and can measure no motor"
    );
}

#[test]
fn a_computed_current_trips_and_a_real_one_does_not() {
    // A shaft that is turned from outside. At 235 rad/s the back-EMF drives the trip current `limits.trip_current_a`, 1.6 A,
    // through the windings.
    for (speed, trips) in [(230.0, false), (240.0, true)] {
        let mut bare = Bare::new(MOTOR, &BLOCKED, 12.0);
        *bare.rig.state_mut() = Motion::from_array([0.0, speed]);
        for _ in 0..60 {
            bare.period(0.0);
        }
        let trip = bare.current.report().trip.map(|trip| trip.code);
        assert_eq!(trip, trips.then_some(FaultCode::OverCurrent), "{speed}");
    }
    // With a tenth of the winding's resistance ten times the commanded 0.8 A flow, which only the driver would notice.
    let mut bare = Bare::new(of_resistance(0.1), &BLOCKED, 12.0);
    bare.held(0.8);
    let largest = bare
        .rig
        .now()
        .currents_a
        .into_iter()
        .fold(0.0, |most: f64, a| most.max(a.abs()));
    assert_eq!(bare.current.report().trip, None);
    assert!(largest > 5.0, "{largest}");
}

/// Simulates a hand that moves to and fro about the wall's surface for four seconds at 3 Hz; `factor` scales the motor's true
/// resistance. Returns the most energy in mJ that the motor gave back from any moment on, and the same for the requested force.
fn given_back(factor: f64) -> [f64; 2] {
    let plant = HeldLinear::new(&KNOB, &MEDIUM, PERIOD_S / 2.0).unwrap();
    let mut settings = told();
    settings.wall.surface_rad = Si::lit("0.1");
    let mut knob = Knob::on(
        &SIMPLEFOC_MINI,
        &settings,
        of_resistance(factor),
        plant,
        0.3,
        Supply,
    )
    .armed();
    let here = knob.rest_rad;
    // Work so far, its least value so far, and the most above that value.
    let mut books = [[0.0_f64; 3]; 2];
    for period in 0..80_000 {
        let time = f64::from(period) * PERIOD_S;
        knob.rest_rad = here + 0.1 + 0.08 * (std::f64::consts::TAU * 3.0 * time).sin();
        let before = knob.rig.now().angle_rad;
        knob.period();
        let way = knob.rig.now().angle_rad - before;
        let asked = -knob.record.force.0.to_num::<f64>();
        for (book, torque) in books.iter_mut().zip([knob.rig.now().torque_n_m, asked]) {
            book[0] += torque * way;
            book[1] = book[1].min(book[0]);
            book[2] = book[2].max(book[0] - book[1]);
        }
    }
    assert_eq!(knob.device.state(), State::Armed);
    books.map(|book| 1e3 * book[2])
}

#[test]
fn the_guard_bounds_the_force_that_was_asked_for() {
    println!(
        "true R by that of the settings: given back after any moment, mJ: by the motor, and by what was asked of it"
    );
    let found = [0.7, 1.0, 1.3].map(|factor| {
        let [motor, asked] = given_back(factor);
        println!("{factor}: {motor:.3} {asked:.3}");
        motor / asked
    });
    // With less resistance than entered, the motor gives more torque than commanded, and nothing in the device notices. Otherwise
    // the motor gives back less than was requested, because of the damping by back-EMF, which the guard does not count.
    assert!(
        found[0] > 1.15 && found[1] < 1.0 && found[2] < found[1],
        "{found:?}"
    );
}

#[test]
fn the_board_starts_with_the_scenes_wall() {
    let scene = Scene::load("voltage-knob").unwrap();
    let settings = told();
    let mut law = settings.law();
    law.guard.change = touchstone_control::ChangeOfForce::Estimated;
    let mut wanted = scene.settings().unwrap();
    // A board calculates its own delay.
    (wanted.guard.delay, wanted.guard.refill) = (law.guard.delay, law.guard.refill);
    assert_eq!(law, wanted);
}
