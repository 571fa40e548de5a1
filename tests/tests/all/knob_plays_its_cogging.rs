//! Tests that the cogging torque of a simulated motor is measured by a sweep and compensated, with only a small part of it left.
//! The firmware recognises a cogging map of another motor.

use nalgebra::Complex;
use std::f64::consts::TAU;
use touchstone_control::Si;
use touchstone_drive::cogging::Played;
use touchstone_drive::hardware::IHM08M1;
use touchstone_drive::{CurrentSample, DeviceSettings, Reason};
use touchstone_lab::identify::cogging::{KnownKnob, MeasuredCogging, NoMap, SweepTick, Swept};
use touchstone_protocol::settings::cogging::CoggingMap;
use touchstone_protocol::{Command, FaultCode, State, Sweep};
use touchstone_tests::knob::{Honest, Knob, PERIOD_S, Tamper};
use touchstone_tests::random::Random;
use touchstone_world::motor::{GIMBAL, MotorParameters};
use touchstone_world::plant::train::Harmonic;
use touchstone_world::plant::{
    BareCoulomb, Coulomb, Device, FIRM, HeldCoulomb, HeldLinear, LIGHT, Stepper,
};

/// The simulated knob of the DLR thesis, with some dry friction.
const KNOB: Device = Device {
    inertia: 1e-4,
    damping: 4e-4,
    friction: Some(Coulomb {
        kinetic: 1e-3,
        breakaway: 1e-3,
    }),
};

const fn part(amplitude: f64, per_rev: f64, phase: f64) -> Harmonic {
    Harmonic {
        amplitude,
        per_rev,
        phase,
    }
}

/// Cogging torque of a motor with 12 slots and 14 poles. It has 84 periods per turn (their least common multiple), 168, and those
/// that unequal slots (14) and magnets (12) add.
const COGGING: [Harmonic; 4] = [
    part(2e-3, 84.0, 0.4),
    part(4e-4, 168.0, 2.0),
    part(6e-4, 12.0, -1.0),
    part(5e-4, 14.0, 3.0),
];

fn settings() -> DeviceSettings {
    let mut settings = DeviceSettings::default();
    settings.law.estimator.inertia_kg_m2 = Si::from_num(KNOB.inertia);
    // Far from the knob, so that the wall is never touched.
    settings.wall.surface_rad = Si::from_num(90);
    settings
}

fn known(settings: &DeviceSettings, reversed: bool) -> KnownKnob {
    KnownKnob {
        rate_hz: f64::from(settings.timing.rate_hz),
        counts_per_rev: f64::from(settings.encoder.counts_per_rev),
        torque_constant_n_m_per_a: settings.motor.torque_constant_n_m_per_a.to_num(),
        inertia_kg_m2: settings.law.estimator.inertia_kg_m2.to_num(),
        against: reversed,
        most_a: settings.motor.current_limit_a.to_num::<f64>() / 4.0,
    }
}

/// Adds random noise of 1.15 converter codes rms to the readings of the current sensors.
struct Noisy(Random);

impl Tamper for Noisy {
    fn sample(&mut self, _: u32, sample: &mut CurrentSample) {
        for code in [&mut sample.phase_a, &mut sample.phase_b] {
            // 1.15 codes rms.
            *code = code.saturating_add_signed((self.0.whole(1) + self.0.whole(1)) as i16);
        }
    }
}

fn bare<T: Tamper>(
    settings: &DeviceSettings,
    motor: MotorParameters,
    cogging: &[Harmonic],
    tamper: T,
) -> Knob<T, BareCoulomb> {
    let plant = BareCoulomb::new(&KNOB, PERIOD_S / 2.0).unwrap();
    let mut knob = Knob::with_plant(settings, motor, plant, 0.3, tamper);
    knob.rig.bridge.dead_share = 0.01;
    knob.rig.cogging = cogging.to_vec();
    knob
}

/// Simulates a calibration with a sweep (a slow turn that measures the cogging torque); returns the sweep's telemetry.
fn sweep<T: Tamper, S: Stepper>(knob: &mut Knob<T, S>, sweep: Sweep) -> Vec<SweepTick> {
    knob.ask(Command::Stop);
    knob.tick();
    knob.device.sweep(sweep);
    knob.ask(Command::Calibrate);
    knob.tick();
    let mut ticks = vec![];
    while knob.device.state() == State::Calibrating {
        knob.tick();
        ticks.extend(told(knob));
    }
    ticks
}

/// Converts the present telemetry record to the form in which the desktop program evaluates a sweep; `None` outside of a sweep.
fn told<T: Tamper, S: Stepper>(knob: &Knob<T, S>) -> Option<SweepTick> {
    let record = knob.telemetry();
    record.measuring.map(|it| SweepTick {
        tick: record.tick,
        part: it.part,
        count: record.count,
        current_a: 1e-3 * f64::from(record.current_q_ma),
    })
}

fn play<T: Tamper, S: Stepper>(knob: &mut Knob<T, S>, map: &CoggingMap, settings: &DeviceSettings) {
    let played = Played::new(map, settings, &IHM08M1);
    knob.device.play(&mut knob.around, Some(&played));
}

/// Root mean square difference between a measured cogging map and the true cogging torque, N·m.
fn error(map: &CoggingMap, cogging: &[Harmonic], known: &KnownKnob) -> f64 {
    let places = 2_520;
    let squares: f64 = (0..places)
        .map(|place| TAU * f64::from(place) / f64::from(places))
        .map(|angle| {
            let torque: f64 = cogging.iter().map(|it| it.torque(angle)).sum();
            let played: f64 = map
                .harmonics
                .iter()
                // The torque from an offset of the current sensors is compensated as well, and is none of the motor's.
                .filter(|it| it.order != 7)
                .map(|it| {
                    let (sin, cos) = (f64::from(it.order) * angle).sin_cos();
                    f64::from(it.cos) * cos + f64::from(it.sin) * sin
                })
                .sum();
            (torque + played / 8192.0 * known.torque_constant_n_m_per_a).powi(2)
        })
        .sum();
    (squares / f64::from(places)).sqrt()
}

fn known_and_found(
    settings: &DeviceSettings,
    reversed: bool,
) -> (KnownKnob, Knob<Noisy, BareCoulomb>, Swept, MeasuredCogging) {
    let motor = MotorParameters { reversed, ..GIMBAL };
    let known = known(settings, reversed);
    let mut knob = bare(settings, motor, &COGGING, Noisy(Random::new(5)));
    let swept = Swept::new(&sweep(&mut knob, Sweep::Bare), &known).unwrap();
    assert_eq!(knob.device.state(), State::Ready);
    let found = swept.map(&known).unwrap();
    (known, knob, swept, found)
}

#[test]
fn a_sweep_finds_the_cogging_and_the_map_takes_the_ripple_away() {
    let settings = settings();
    for reversed in [false, true] {
        let (known, mut knob, before, found) = known_and_found(&settings, reversed);
        let error = error(&found.map, &COGGING, &known);
        let mut ripple = |map: &CoggingMap| {
            play(&mut knob, map, &settings);
            let after = sweep(&mut knob, Sweep::Compensated);
            Swept::new(&after, &known).unwrap().ripple_rad(&found.map)
        };
        let bare = before.ripple_rad(&found.map);
        let right = ripple(&found.map) / bare;
        let mut wrong = found.map.clone();
        for part in &mut wrong.harmonics {
            (part.cos, part.sin) = (-part.cos, -part.sin);
        }
        let wrong = ripple(&wrong) / bare;
        println!(
            "reversed {reversed}: map {:.3} mN·m rms, off by {:.3} at the orders of the cogging, unrepeated {:.0} %; ripple {bare:.2e} rad, with the map {right:.2} of it, with one half a period off {wrong:.2}",
            1e3 * found.rms_n_m,
            1e3 * error,
            100.0 * found.unrepeated,
        );
        // A fifth of the cogging's 1.54 mN·m rms; one code of this shield's sensors is 1.9 mN·m.
        assert!(error < 0.31e-3, "{error}");
        assert!(right < 0.5 && wrong > 1.5, "{right} {wrong}");
        // Friction and damping: 1e-3 N·m, and 4e-4 N·m·s/rad at a quarter of a turn per second.
        assert!((before.drag_n_m - 1.63e-3).abs() < 0.1e-3);
    }
}

/// Periods per turn of the cogging torque, and of the torque that an offset of the current sensors causes.
const ORDERS: [f64; 5] = [7.0, 12.0, 14.0, 84.0, 168.0];

/// Root mean square torque in N·m on a hand that turns the switched-on knob at a constant speed. Only the torque ripple of motor
/// and cogging at the periods in `ORDERS` counts.
fn felt(
    settings: &DeviceSettings,
    map: Option<&CoggingMap>,
    rad_per_s: f64,
    dead_share: f64,
) -> f64 {
    let plant = HeldLinear::new(&touchstone_world::motor::KNOB, &FIRM, PERIOD_S / 2.0).unwrap();
    let mut knob = Knob::with_plant(settings, GIMBAL, plant, 0.3, Noisy(Random::new(7)));
    knob.rig.bridge.dead_share = dead_share;
    knob.rig.cogging = COGGING.to_vec();
    if let Some(map) = map {
        play(&mut knob, map, settings);
    }
    let mut knob = knob.armed();
    let mut go = |turns: f64| {
        let periods = (turns * TAU / rad_per_s / PERIOD_S).round();
        let mut parts = [Complex::new(0.0, 0.0); 5];
        for _ in 0..periods as u32 {
            knob.rest_rad += rad_per_s * PERIOD_S;
            knob.period();
            let now = knob.rig.now();
            let cogging: f64 = COGGING.iter().map(|it| it.torque(now.angle_rad)).sum();
            for (part, order) in parts.iter_mut().zip(ORDERS) {
                *part += Complex::from_polar(2.0 / periods, -order * now.angle_rad)
                    * (now.torque_n_m + cogging);
            }
        }
        assert_eq!(knob.device.state(), State::Armed);
        let squares: f64 = parts.iter().map(|it| it.norm_sqr()).sum();
        (0.5 * squares).sqrt()
    };
    // Until the knob has its speed and the force has faded in.
    go(0.5_f64.max(0.1 * rad_per_s));
    go(rad_per_s.ceil())
}

#[test]
fn a_hand_that_turns_it_feels_less() {
    let settings = settings();
    let map = known_and_found(&settings, false).3.map;
    // With dead time, a current as small as one code of the sensors (which this cogging needs on this shield) lags behind.
    // Without dead time only the map's error remains.
    for (dead_share, most) in [(0.01, [0.25, 0.35, 0.55, 0.7]), (0.0, [0.2; 4])] {
        for (speed, most) in [1.0, 2.0, 5.0, 10.0].into_iter().zip(most) {
            let before = felt(&settings, None, speed, dead_share);
            let after = felt(&settings, Some(&map), speed, dead_share);
            println!(
                "dead time {dead_share}, {speed} rad/s: {:.2} -> {:.2} mN·m",
                1e3 * before,
                1e3 * after
            );
            assert!(after < most * before, "{before} {after}");
        }
    }
}

#[test]
fn a_motor_without_cogging_has_none_in_its_map() {
    let settings = settings();
    let known = known(&settings, false);
    // What is found comes from the current sensors' offsets, once per electrical turn.
    let mut knob = bare(&settings, GIMBAL, &[], Noisy(Random::new(5)));
    let swept = Swept::new(&sweep(&mut knob, Sweep::Bare), &known).unwrap();
    match swept.map(&known) {
        Err(NoMap::Nothing { .. }) => {}
        Ok(found) => assert!(
            found.map.harmonics.iter().all(|it| it.order == 7),
            "{found:?}"
        ),
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn a_hand_that_holds_on_is_refused_or_does_no_harm() {
    let settings = settings();
    let known = known(&settings, false);
    let mut refused = [false; 2];
    // The hand's rest point moves, by some degrees and by half a turn.
    for (refused, wander_rad) in refused.iter_mut().zip([4.0, 60.0]) {
        let plant = HeldCoulomb::new(&KNOB, &LIGHT, PERIOD_S / 2.0).unwrap();
        let mut knob = Knob::with_plant(&settings, GIMBAL, plant, 0.3, Noisy(Random::new(5)));
        knob.rig.cogging = COGGING.to_vec();
        knob.device.sweep(Sweep::Bare);
        knob.ask(Command::Calibrate);
        knob.tick();
        let (mut ticks, mut random, mut way) = (vec![], Random::new(3), 0.0);
        while knob.device.state() == State::Calibrating {
            way = 0.998 * way + 0.002 * random.real();
            let is_swept = knob.device.measuring().is_some();
            let beside = if is_swept { wander_rad * way } else { 0.0 };
            knob.rest_rad = knob.rig.now().angle_rad + beside;
            knob.tick();
            ticks.extend(told(&knob));
        }
        let fault = knob.device.fault().map(|it| (it.code, it.value));
        match Swept::new(&ticks, &known).and_then(|swept| swept.map(&known)) {
            Ok(found) => {
                let error = error(&found.map, &COGGING, &known);
                println!("a hand that wanders by {wander_rad}: off by {error:.2e} N·m");
                assert!(error < 0.31e-3, "{error}");
            }
            Err(NoMap::DoesNotRepeat { percent }) => {
                println!("a hand that wanders by {wander_rad}: refused, {percent:.0} %");
                *refused = true;
            }
            Err(other) => {
                println!("a hand that wanders by {wander_rad}: {other}, {fault:?}");
                assert_eq!(
                    fault,
                    Some((FaultCode::CalibrationFailed, Reason::Held as i32))
                );
                *refused = true;
            }
        }
    }
    assert_eq!(refused, [false, true]);
}

#[test]
fn without_a_map_every_tick_is_as_it_was() {
    let settings = settings();
    let run = |clear: bool| {
        let mut knob = bare(&settings, GIMBAL, &COGGING, Honest);
        if clear {
            let map = CoggingMap::default();
            play(&mut knob, &map, &settings);
            knob.device.play(&mut knob.around, None);
        }
        let mut knob = knob.armed();
        (0..500)
            .map(|_| (knob.tick(), knob.output.map(|it| it.drive)))
            .collect::<Vec<_>>()
    };
    assert_eq!(run(false), run(true));
}

#[test]
fn a_map_waits_for_the_settings_that_it_was_made_ready_with() {
    let settings = settings();
    let mut knob = bare(&settings, GIMBAL, &COGGING, Honest).armed();
    let map = CoggingMap {
        harmonics: [touchstone_protocol::CoggingHarmonic {
            order: 1,
            cos: 400,
            sin: 400,
        }]
        .into_iter()
        .collect(),
    };
    // Without a cogging map no current is commanded, because the wall is far away.
    let current = |knob: &mut Knob<Honest, BareCoulomb>| {
        (0..400)
            .map(|_| knob.tick().current_command.to_num::<f64>().abs())
            .fold(0.0, f64::max)
    };
    assert_eq!(current(&mut knob), 0.0);
    knob.device.configure(&settings, &IHM08M1).unwrap();
    play(&mut knob, &map, &settings);
    assert_eq!(current(&mut knob), 0.0);
    knob.ask(Command::Stop);
    knob.tick();
    let mut knob = knob.armed();
    assert!(current(&mut knob) > 0.03);
}
