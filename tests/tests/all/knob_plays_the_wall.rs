//! Tests the whole simulated knob, from encoder frame to motor current. Its force equals that of the simulator's controller bit for
//! bit at the same encoder counts, the motor gives this force as torque, and the wall holds the hand.

use touchstone_control::{ChangeOfForce, Controller, CountScale, Fixed32, Force, Position, Si};
use touchstone_drive::change::law_settings;
use touchstone_drive::hardware::IHM08M1;
use touchstone_drive::{DeviceSettings, EncoderKind, Record};
use touchstone_protocol::{Board, Limit, State};
use touchstone_tests::knob::{Honest, Knob, honest};

fn settings(k_desired: &str, rate_hz: u32, kind: EncoderKind) -> DeviceSettings {
    let mut settings = DeviceSettings::defaults(Board::NucleoG474re);
    if rate_hz > 1_000 {
        // In so short a tick the current loop does not complete a change of force.
        settings.law.guard.change = ChangeOfForce::Estimated;
    }
    settings.wall.k_desired_n_m_per_rad = Si::from_str(k_desired).unwrap();
    settings.timing.rate_hz = rate_hz;
    settings.encoder.kind = kind;
    if kind == EncoderKind::Incremental {
        settings.encoder.counts_per_rev = 40_000;
    }
    settings.wall.surface_rad = Si::lit("0.3");
    settings.limits.fade_in_s = Si::lit("0.05");
    settings
}

/// Lets a hand press into the wall from the present angle, hold, and come out again, within two seconds. Returns the record of
/// every control tick.
fn press(knob: &mut Knob<Honest>, into_rad: f64, rate_hz: u32) -> Vec<Record> {
    let start = knob.rig.now().angle_rad;
    knob.rest_rad = start;
    let ticks = rate_hz * 2;
    let mut records = vec![knob.record];
    for tick in 0..ticks {
        let share = f64::from(tick) / f64::from(ticks);
        let way = (4.0 * share).min(1.0).min(4.0 * (1.0 - share));
        knob.rest_rad = start + into_rad * way;
        records.push(knob.tick());
    }
    records
}

/// Runs a new controller on the recorded encoder counts; asserts that each of its forces equals the recorded one.
fn replayed(settings: &DeviceSettings, records: &[Record]) {
    let (law, change) = law_settings(settings, &IHM08M1).unwrap();
    let mut wall = Controller::<Fixed32>::new(&law).unwrap();
    let scale =
        CountScale::new(settings.encoder.counts_per_rev, settings.wall.surface_rad).unwrap();
    let (mut felt, mut held, mut told) = (0, false, false);
    for record in records {
        assert!(record.law_ran && record.state == State::Armed, "{record:?}");
        let e = scale.penetration::<Fixed32>(record.count);
        let at_change = change.map(|_| e - record.since_change);
        let force = wall.tick_with_change(e, at_change);
        wall.commanded(Force::zero() - record.torque);
        assert_eq!(
            (record.penetration, record.force),
            (e, force),
            "tick {}",
            record.tick
        );
        let view = wall.view();
        assert_eq!((record.offset, record.energy), (view.offset, view.energy));
        felt += u32::from(force != Force::zero());
        held |= wall.guard.is_some_and(|guard| guard.limited);
        told |= record.since_change != Position::zero();
    }
    assert!(felt > 500, "{felt} ticks in the wall");
    assert!(!held, "the guard made the wall softer");
    assert_eq!(told, change.is_some());
}

#[test]
fn the_force_is_the_simulators_to_the_bit() {
    for (k, rate, kind) in [
        ("1", 1_000, EncoderKind::As5047p),
        ("5", 1_000, EncoderKind::Incremental),
        ("5", 1_000, EncoderKind::Mt6701),
        ("5", 10_000, EncoderKind::Incremental),
    ] {
        let settings = settings(k, rate, kind);
        let mut knob = honest(&settings).armed();
        let records = press(&mut knob, 3.0, rate);
        replayed(&settings, &records);
        assert_eq!(knob.fault(), None);
    }
}

/// Checks that the energy guard does not reduce the force of an ordinary press if it is configured for the board's delay and reads
/// the encoder a second time when the force changes.
#[test]
fn a_guard_that_is_told_changes_no_force_of_a_press() {
    for (k, kind) in [
        ("1", EncoderKind::As5047p),
        ("5", EncoderKind::Incremental),
        ("5", EncoderKind::Mt6701),
    ] {
        let forces = |change: ChangeOfForce, capacity: &str| {
            let mut settings = settings(k, 1_000, kind);
            settings.law.guard.change = change;
            settings.law.guard.capacity_j = Si::from_str(capacity).unwrap();
            let mut knob = honest(&settings).armed();
            let mut records = press(&mut knob, 3.0, 1_000);
            // To and fro in the wall, at 4 Hz.
            let start = knob.rig.now().angle_rad;
            for tick in 0..1_000 {
                let turns = f64::from(tick) / 250.0;
                knob.rest_rad = start + 3.0 + (std::f64::consts::TAU * turns).sin();
                records.push(knob.tick());
            }
            let forces = records.iter().map(|record| record.force);
            forces.collect::<Vec<_>>()
        };
        let untold = forces(ChangeOfForce::Estimated, "0.045");
        assert!(
            forces(ChangeOfForce::Measured, "0.045") == untold,
            "{k} {kind:?}"
        );
        // A wall that gives way would be detected.
        assert!(k == "5" || forces(ChangeOfForce::Measured, "0.015") != untold);
    }
}

#[test]
fn the_motor_gives_the_force_of_the_law() {
    let settings = settings("5", 1_000, EncoderKind::Incremental);
    let mut knob = honest(&settings).armed();
    let records = press(&mut knob, 3.0, 1_000);
    let mut compared = 0;
    let mut worst: f64 = 0.0;
    for pair in records.windows(2) {
        let [before, now] = pair else { unreachable!() };
        // While the force is constant, the current of the next tick is its torque over the torque constant.
        if before.limits.has(Limit::FadeIn)
            || before.force != now.force && (before.force - now.force).modulus().0 > 0.002
        {
            continue;
        }
        let wanted = before.torque.0.to_num::<f64>() / 0.25;
        let along = if knob.device.alignment().against {
            -1.0
        } else {
            1.0
        };
        worst = worst.max((now.current.q.to_num::<f64>() * along - wanted).abs());
        compared += 1;
    }
    assert!(compared > 500, "{compared}");
    // Two codes of 15.6 mA in Park's frame, and the error of a change of 2 mN·m in a tick.
    assert!(worst < 0.06, "{worst} A");
}

#[test]
fn the_wall_holds_the_hand() {
    for k in ["1", "5"] {
        let settings = settings(k, 1_000, EncoderKind::Incremental);
        let mut knob = honest(&settings).armed();
        let stiffness: f64 = settings.wall.k_desired_n_m_per_rad.to_num();
        let start = knob.rig.now().angle_rad;
        // The hand's spring of 0.0225 N·m/rad has its rest point 4 rad inside.
        for tick in 0..3_000_u32 {
            knob.rest_rad = start + 4.3 * (f64::from(tick) / 500.0).min(1.0);
            knob.tick();
        }
        let mut penetration = Vec::new();
        for _ in 0..500 {
            let record = knob.tick();
            penetration.push(record.penetration.0.to_num::<f64>());
            assert_eq!(record.state, State::Armed);
        }
        let mean = penetration.iter().sum::<f64>() / penetration.len() as f64;
        // The hand's spring and the pad in series, against the wall: k (x - s) = k_s (r - x), with r - s = 4 rad.
        let series = 0.0225 * 0.1575 / (0.0225 + 0.1575);
        let expected = series * 4.0 / (stiffness + series);
        assert!(
            (mean / expected - 1.0).abs() < 0.03,
            "k = {k}: {mean} rad for {expected}"
        );
        let spread = penetration
            .iter()
            .fold(0.0_f64, |most, x| most.max((x - mean).abs()));
        // In the thesis' verdicts a degree is the limit of perceptible trembling.
        assert!(spread < 0.0175 / 2.0, "k = {k}: {spread} rad around {mean}");
    }
}

#[test]
fn arming_inside_the_wall_fades_in() {
    let mut settings = settings("1", 1_000, EncoderKind::Incremental);
    settings.wall.surface_rad = Si::lit("-0.2");
    settings.limits.fade_in_s = Si::lit("0.2");
    let mut knob = honest(&settings).armed();
    // The hand leans on the wall, so that the knob stays inside.
    knob.rest_rad += 6.0;
    let mut felt = 0;
    for tick in 1..=200 {
        let record = if tick == 1 { knob.record } else { knob.tick() };
        let (force, torque) = (
            record.force.0.to_num::<f64>(),
            -record.torque.0.to_num::<f64>(),
        );
        assert!(
            (torque - force * f64::from(tick) / 200.0).abs() < 1e-5,
            "{tick}: {torque} of {force}"
        );
        assert!(record.limits.has(Limit::FadeIn));
        felt += u32::from(force > 0.1);
    }
    assert!(felt > 100, "{felt}");
    let record = knob.tick();
    assert!(!record.limits.has(Limit::FadeIn));
    assert_eq!(record.torque, -record.force);
}

#[test]
fn disarmed_and_armed_again_the_law_begins_anew() {
    use touchstone_protocol::Command;
    let settings = settings("5", 1_000, EncoderKind::Incremental);
    let mut knob = honest(&settings).armed();
    press(&mut knob, 3.0, 1_000);
    knob.ask(Command::Disarm);
    assert_eq!(knob.tick().state, State::Ready);
    assert!(!knob.record.law_ran && knob.record.force == Force::zero());
    for _ in 0..50 {
        knob.tick();
    }
    knob.ask(Command::Arm);
    knob.tick();
    let records = press(&mut knob, 3.0, 1_000);
    replayed(&settings, &records);
}
