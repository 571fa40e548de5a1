//! Tests of several virtual walls at once on the emulated device: detents, a wall on the other side and end stops. A hand presses
//! them. The device's forces must equal, bit for bit, those of the same environment computed on the host. The environment is also
//! changed while a hand holds the knob, stored in flash, and refused if it is invalid.

use touchstone_control::environment::{
    CentreSettings, ClickSettings, Counted, DrySettings, Environment, FeelSettings,
    InertiaSettings, MOST_POINTS, Shape, Spacing, ViscousSettings, WHOLE,
};
use touchstone_control::{CountScale, Fixed32, Force, Position, Si};
use touchstone_drive::around::built;
use touchstone_drive::change::ChangeConfig;
use touchstone_drive::wire::hardware;
use touchstone_protocol::settings::environment::{
    DetentsBeside, Points, ProfileBeside, TravelEnds, WallBeside,
};
use touchstone_protocol::settings::parts::Parts;
use touchstone_protocol::{
    Board, CountsFrom, Decimal, DeviceCommand, DeviceSettings, Limit, Limits, Phase, Refusal,
    Reply, Request, Surround, Telemetry,
};
use touchstone_world::plant::MEDIUM;

use super::press::board_named;
use super::tally::Tally;
use crate::bench::{Bench, MS, Setup};
use crate::chip::ResetCause;
use crate::cpu::elf::Program;

/// Largest rate at which the force may change when one environment (walls, detents) replaces another, N·m/s.
const CHANGE: &str = "0.5";
/// Largest number of control periods, after one environment (walls, detents) has replaced another, in which both may give the same
/// force.
const SAME_FORCES: usize = 50;
/// How far the hand turns the knob to each side, rad, if no force resists. Both end stops lie within this range.
const REACH_RAD: f64 = 0.35;

/// Runs the tests of several walls on boards with enough memory. On other boards it checks that the device refuses an environment.
pub fn around(program: &Program, setup: &Setup, tally: &mut Tally) {
    if !setup.board.is_large() {
        return tally.check("more than one wall", refused(program, setup));
    }
    tally.check("more than one wall", played(program, setup));
    tally.check("an environment in flash", kept(program, setup));
}

fn si(text: &str) -> Decimal {
    text.parse().unwrap_or_default()
}

/// An environment with every kind of element: detents all around, a force profile, a wall behind the hand, two end stops, and the
/// further parts of a feel.
fn all(setup: &Setup) -> Surround {
    let strength = Si::saturating_from_num(0.2 * setup.board.press_n_m);
    let [wall, ..] = setup.board.walls;
    Surround {
        further: [
            Some(WallBeside {
                at_rad: si("-0.25"),
                below: true,
                stiffness_n_m_per_rad: None,
            }),
            None,
            None,
        ],
        endstops: Some(TravelEnds {
            lower_rad: si("-0.3"),
            upper_rad: si("0.32"),
            stiffness_n_m_per_rad: Some(Decimal(wall)),
        }),
        detents: Some(DetentsBeside {
            per_rev: 48,
            pitch_rad: Decimal(Si::ZERO),
            strength_n_m: Decimal(strength),
            centre_rad: si("0.01"),
        }),
        // The torque of this profile rises, falls steeply from one limit to the other, and ends with a level part.
        profile: Shape::new(&[-3_000, WHOLE, -WHOLE, 500, 500])
            .ok()
            .map(|shape| ProfileBeside {
                per_rev: 5,
                start_rad: si("0.02"),
                end_rad: si("0"),
                strength_n_m: Decimal(strength),
                shape: Points(shape),
            }),
        change_n_m_per_s: si(CHANGE),
        parts: Parts(parts(strength)),
        ..Surround::default()
    }
}

/// The environment with the longest computing time in a control period: six walls, of which four are touched at a time, and every
/// other part. Distances are given as angles, whose computation is longer than that of numbers per turn.
#[must_use]
pub fn largest(setup: &Setup) -> Surround {
    let [softer, _] = setup.board.walls;
    let wall = |at| {
        Some(WallBeside {
            at_rad: si(at),
            below: true,
            stiffness_n_m_per_rad: Some(Decimal(softer / 4)),
        })
    };
    let strength = Decimal(Si::saturating_from_num(0.1 * setup.board.press_n_m));
    let points: [i16; MOST_POINTS] =
        core::array::from_fn(|i| (i as i32 * 613 % 10_001 - 5_000) as i16);
    let own = all(setup);
    Surround {
        further: ["-0.24", "-0.25", "-0.26"].map(wall),
        detents: Some(DetentsBeside {
            per_rev: 0,
            pitch_rad: si("0.13"),
            strength_n_m: strength,
            centre_rad: si("0.01"),
        }),
        profile: Shape::new(&points).ok().map(|shape| ProfileBeside {
            per_rev: 0,
            start_rad: si("-0.31"),
            end_rad: si("0.33"),
            strength_n_m: strength,
            shape: Points(shape),
        }),
        ..own
    }
}

/// Lets a hand sweep the knob to and fro between the end stops of this file's environments.
pub fn sweep(bench: &mut Bench) {
    let here = bench.machine.chip().world.angle_rad();
    // The hand's own deflection under this board's press is added to `REACH_RAD`.
    let give = 1.0 / MEDIUM.pad_stiffness + 1.0 / MEDIUM.stiffness;
    let reach = REACH_RAD + give * bench.machine.chip().board.press_n_m;
    let world = &mut bench.machine.chip_mut().world;
    world.hold(&MEDIUM, move |time| {
        here + reach * (std::f64::consts::TAU * time / 1.6).sin()
    });
}

/// All further parts of a feel: a spring to a centre, viscous and dry friction, clicks and an inertia. `strength` is the torque of
/// spring and clicks, N·m.
fn parts(strength: Si) -> FeelSettings {
    FeelSettings {
        spring: Some(CentreSettings {
            centre: Si::lit("0.03"),
            stiffness: Si::lit("0.05"),
            strength,
        }),
        viscous: Some(ViscousSettings {
            damping: Si::lit("0.0004"),
            bandwidth_hz: Si::lit("100"),
        }),
        dry: Some(DrySettings {
            strength: strength / 4,
            stretch: Si::lit("0.02"),
        }),
        click: Some(ClickSettings {
            spacing: Spacing::Pitch(Si::lit("0.07")),
            centre: Si::lit("0.015"),
            strength,
            duration_s: Si::lit("0.006"),
        }),
        inertia: Some(InertiaSettings {
            inertia: Si::lit("0.000003"),
            bandwidth_hz: Si::lit("12"),
        }),
    }
}

fn configured(program: &Program, setup: &Setup) -> Result<Bench, String> {
    let mut bench = Bench::new(program, setup)?;
    bench.boot()?;
    let kind = setup.board.encoder.kind();
    let [stiffness, _] = setup.board.walls;
    bench.configure(|settings| {
        settings.encoder.kind = kind;
        settings.wall.surface_rad = Si::lit("0.2");
        settings.wall.k_desired_n_m_per_rad = stiffness;
    })?;
    Ok(bench)
}

/// Sends an environment (walls, detents) to the device; returns from when on the device renders it.
pub fn set(bench: &mut Bench, environment: &Surround) -> Result<CountsFrom, String> {
    match bench.demand(Request::SetEnvironment(*environment))? {
        Reply::Taken(from) => Ok(from),
        other => Err(format!("{other:?} for an environment")),
    }
}

/// Lets a hand sweep to and fro through the environment (walls, detents), and changes the environment meanwhile.
fn played(program: &Program, setup: &Setup) -> Result<String, String> {
    let mut bench = configured(program, setup)?;
    bench.calibrate()?;
    let (alone, all) = (Surround::default(), all(setup));
    let mut steps = vec![(set(&mut bench, &alone)?, alone)];
    let from = bench.link.telemetry.len();
    bench.demand(Request::Command(DeviceCommand::Arm))?;
    bench.wait_for(Phase::Armed, 100 * MS)?;
    bench.run(250 * MS)?;
    sweep(&mut bench);
    // While the hand moves, all elements are set; then all but the wall are removed; then all are set again.
    let mut answered_after = 0;
    for environment in [all, alone, all] {
        let asked = bench.now();
        steps.push((set(&mut bench, &environment)?, environment));
        answered_after = answered_after.max((bench.now() - asked) / MS);
        bench.run(1_650 * MS)?;
    }
    let status = bench.status()?;
    if status.phase != Phase::Armed {
        return Err(format!("{} with {:?}", status.phase.name(), status.fault));
    }
    let whens: Vec<CountsFrom> = steps.iter().map(|(from, _)| *from).collect();
    let now = CountsFrom::NextTick;
    if whens != [CountsFrom::Arming, now, now, now] {
        return Err(format!("the environments count from {whens:?}"));
    }
    let gaps = bench.link.gaps(from);
    if gaps > 0 {
        return Err(format!("{gaps} records of telemetry are missing"));
    }
    let settings = bench.settings()?;
    let armed: Vec<Telemetry> = bench.link.telemetry[from..]
        .iter()
        .filter(|record| record.phase == Phase::Armed)
        .cloned()
        .collect();
    let board = board_named(bench.machine.chip().board.name)?;
    let environments: Vec<Surround> = steps.iter().map(|(_, environment)| *environment).collect();
    let compared = compared(&settings, board, &environments, &armed)?;
    Ok(format!("{compared}; answered within {answered_after} ms"))
}

/// Computes the forces of the environments (walls, detents) on the host from the device's encoder counts, and compares them with
/// the device's forces.
///
/// The telemetry does not say from which control period (tick) on a new environment is active. The function finds that period by
/// comparing forces: from there on, all forces must be those of the new environment.
fn compared(
    settings: &DeviceSettings,
    board: Board,
    environments: &[Surround],
    armed: &[Telemetry],
) -> Result<String, String> {
    let refused = |error| format!("refused here: {error:?}");
    let scale = CountScale::new(settings.encoder.counts_per_rev, Si::ZERO)
        .ok_or("the encoder's counts are refused here")?;
    let hardware = hardware(board);
    let built = |environment: &Surround| built(settings, hardware, environment).map_err(refused);
    let change = ChangeConfig::new(settings, hardware).map_err(refused)?;
    let mut left = environments.iter();
    let first = left.next().ok_or("nothing to compare")?;
    let mut running = built(first)?;
    let mut next = left.next();
    let (mut changes, mut pushed) = (Vec::new(), [0_u32; 2]);
    let mut most = 0.0_f64;
    // The environments as they were before each of the last control ticks.
    let mut before: Vec<Environment<Fixed32>> = Vec::new();
    let tick = |environment: &mut Environment<Fixed32>, record: &Telemetry| {
        let count = i64::from(record.count);
        let since_change = change.map(|_| Position(record.since_change_rad));
        environment.tick(&Counted { scale, count }, since_change)
    };
    for (index, record) in armed.iter().enumerate() {
        if Limits::from_wire(record.limits).has(Limit::Encoder) {
            return Err(format!(
                "tick {} had no reading to drive by, of an encoder without faults",
                record.tick
            ));
        }
        before.push(running);
        let force = tick(&mut running, record);
        if force.0 != record.force_n_m {
            let new = next.ok_or_else(|| differs(record, force))?;
            let fresh = built(new)?;
            // The new environment became active in one of the last `SAME_FORCES` ticks, and has given the same forces as the old
            // one since. The latest such tick that explains the forces is searched for.
            let found = (0..SAME_FORCES.min(index + 1)).find_map(|back| {
                let mut taken = fresh;
                taken.take_over(before.get(index - back)?, new.change_per_tick(settings));
                let since = armed.get(index - back..=index)?;
                let same = since
                    .iter()
                    .all(|record| tick(&mut taken, record).0 == record.force_n_m);
                same.then_some((taken, record.tick - back as u32))
            });
            let (taken, at) = found.ok_or_else(|| differs(record, force))?;
            (running, next) = (taken, left.next());
            changes.push(at);
        }
        let torque: f64 = record.force_n_m.to_num();
        pushed[usize::from(torque < 0.0)] += u32::from(torque != 0.0);
        most = most.max(torque.abs());
        // The fade-in reduces the torque after the law. The records lack the law's torque before the reduction, so there is nothing
        // to compare.
        if Limits::from_wire(record.limits).has(Limit::FadeIn) && record.force_n_m != 0 {
            return Err("a force while the torque fades in: nothing to compare with".into());
        }
    }
    let beside = |record: &&Telemetry| Limits::from_wire(record.limits).has(Limit::Beside);
    let told = armed.iter().find(beside).map(|record| record.tick);
    if told != changes.first().copied() {
        return Err(format!(
            "`Beside` from tick {told:?}, changes at {changes:?}"
        ));
    }
    if next.is_some() || pushed.iter().any(|ticks| *ticks < 300) {
        return Err(format!(
            "changes {changes:?}; pushed one way and the other {pushed:?}"
        ));
    }
    Ok(format!(
        "{} ticks equal to the bit, {} and {} of them pushing one way and the other, at most {most:.3} N·m; changed at ticks {changes:?}",
        armed.len(),
        pushed[0],
        pushed[1],
    ))
}

fn differs(record: &Telemetry, here: Force<Fixed32>) -> String {
    format!(
        "tick {}, count {}: force {} there and {} here",
        record.tick,
        record.count,
        record.force_n_m.to_bits(),
        here.0.to_bits()
    )
}

/// Checks that an invalid environment (walls, detents) is refused without effect, and that a saved environment is active after a
/// restart.
fn kept(program: &Program, setup: &Setup) -> Result<String, String> {
    let mut bench = configured(program, setup)?;
    // The largest possible environment takes longest to build. The watchdog already runs while the device builds it after the
    // restart.
    let [softer, stiffer] = setup.board.walls;
    let far = |k: Si, at| WallBeside {
        at_rad: si(at),
        below: true,
        stiffness_n_m_per_rad: Some(Decimal(k)),
    };
    let half = Si::lit("0.5");
    let all = Surround {
        further: [
            Some(far(stiffer, "-0.6")),
            Some(far(softer.saturating_mul(half), "-0.7")),
            Some(far(stiffer.saturating_mul(half), "-0.8")),
        ],
        ..all(setup)
    };
    set(&mut bench, &all)?;
    let wrong = Surround {
        endstops: Some(TravelEnds {
            lower_rad: si("0.3"),
            upper_rad: si("0.2"),
            stiffness_n_m_per_rad: None,
        }),
        ..all
    };
    match bench.ask(Request::SetEnvironment(wrong))? {
        Err(Refusal::Invalid(invalid)) if &*invalid.path == "environment.endstops.upper_rad" => {}
        other => return Err(format!("ends the wrong way round: {other:?}")),
    }
    // With this force limit the present environment would be invalid, so the device must refuse these settings.
    let mut settings = bench.settings()?;
    settings.law.force_limit_n_m = Si::lit("0.002");
    match bench.ask(Request::SetAll(settings))? {
        Err(Refusal::Invalid(invalid)) if invalid.path.starts_with("environment.detents") => {}
        other => return Err(format!("a limit below the detents' strength: {other:?}")),
    }
    bench.demand(Request::Save)?;
    bench.machine.power_on(ResetCause::PowerOn);
    bench.halted = None;
    bench
        .boot()
        .map_err(|error| format!("{error}; resets {:?}", bench.machine.resets))?;
    match bench.demand(Request::Environment)? {
        Reply::Environment(read) if read == all => {}
        other => return Err(format!("after a start: {other:?}")),
    }
    bench.arm()?;
    let at_work = |bench: &Bench| {
        let last = bench.link.telemetry.last();
        last.is_some_and(|record| Limits::from_wire(record.limits).has(Limit::Beside))
    };
    bench.run_until("the environment at work", 50 * MS, |bench| at_work(bench))?;
    Ok("saved, read and at work after a start; two wrong ones refused".into())
}

/// Checks that a board without memory for environments (walls, detents) answers `NotUnderstood`, and then works on.
fn refused(program: &Program, setup: &Setup) -> Result<String, String> {
    let mut bench = Bench::new(program, setup)?;
    bench.boot()?;
    for request in [Request::Environment, Request::SetEnvironment(all(setup))] {
        match bench.ask(request)? {
            Err(Refusal::NotUnderstood) => {}
            other => return Err(format!("{other:?} of a board without room for it")),
        }
    }
    bench.settings()?;
    Ok("not known here, as it should be".into())
}
