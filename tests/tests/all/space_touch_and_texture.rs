//! Tests of what a scene of three axes adds along the normal: pulse and vibration at the touch (`[law.impact]`), and a texture
//! (`[object.texture]`). They are felt as their formulas say, and the energy guard bounds the energy that a hand gets from them.

use touchstone_control::estimator::EstimatorState;
use touchstone_control::law::Impact;
use touchstone_control::settings::ImpactSettings;
use touchstone_control::space::environment::{Plane, Sphere};
use touchstone_control::space::{Magnitude, Rule, Shape, Shell, SpaceWall, SurfacePoint, Vector};
use touchstone_control::{
    EstimatorSettings, Fixed32, Force, LawKind, Position, Settings, Si, StatesKind,
};
use touchstone_lab::thesis::space::texture::Texture;
use touchstone_lab::thesis::space::{
    Approach, Cell, Mechanism, Object, Phase, RADIUS_MM, Record, SurfaceFeel, run, wall,
};
use touchstone_sim::run::verdict::Verdict;
use touchstone_tests::search;
use touchstone_tests::si::si;
use touchstone_tests::space::{UNIT, at, direction, dot, length, mm, newton, omega, push_in_n};
use touchstone_world::plant::{FIRM_TRANSLATION, OMEGA3_AXIS};

const TICK_S: f64 = 1e-3;
/// Mass of the simulated device along every direction, kg.
const MASS_KG: f64 = 0.148;

fn axis() -> EstimatorSettings {
    EstimatorSettings {
        bandwidth_hz: si("62.6"),
        inertia: Si::from_num(MASS_KG),
        damping: si("2.5"),
        delay_s: si("0.0005"),
    }
}

/// A law with pulse and vibration for an omega.3 at 1 kHz.
fn settings(momentum: &str, vibration: &str) -> Settings {
    Settings {
        states: StatesKind::Estimated,
        estimator: axis(),
        impact: ImpactSettings {
            momentum: si(momentum),
            vibration: si(vibration),
            frequency_hz: si("60"),
            decay_s: si("0.03"),
        },
        ..omega(LawKind::Spring, 25.0)
    }
}

/// A wall of this object without a guard, and without estimators unless `estimated`.
fn bare(
    shape: Shape<Fixed32>,
    settings: &Settings,
    estimated: bool,
) -> SpaceWall<Fixed32, Shape<Fixed32>, touchstone_control::AnyLaw<Fixed32>> {
    let law = UNIT.law::<Fixed32>(settings).unwrap();
    let impact = UNIT.impact(settings).unwrap();
    let shell = Shell::Magnitude(Magnitude::new(law).with_impact(impact));
    let point = SurfacePoint::new(Rule::Closest);
    let mut wall = SpaceWall::new(shape, point, shell, newton(12.0));
    if estimated {
        let estimator = UNIT.estimator(&[axis(); 3], 1000, settings.force_limit);
        wall.estimator = Some(estimator.unwrap());
    }
    wall
}

fn plane(x: f64, y: f64, z: f64) -> Shape<Fixed32> {
    Shape::Plane(Plane {
        normal: direction(x, y, z),
        height: Position::zero(),
    })
}

/// Checks that on a floor pulse and vibration give the force of one axis, bit for bit, with the estimators in the loop.
#[test]
fn pulse_and_vibration_on_a_floor_are_those_of_one_axis_to_the_bit() {
    for (momentum, vibration) in [("1", "0"), ("0", "0.5"), ("0.5", "0.5")] {
        let settings = settings(momentum, vibration);
        let mut three = bare(plane(0.0, 0.0, 1.0), &settings, true);
        // The same settings converted to centimetres by hand.
        let one = EstimatorSettings {
            inertia: axis().inertia / 100,
            damping: axis().damping / 100,
            ..axis()
        };
        let estimator = one.estimator::<Fixed32>(1000, Si::from_num(12)).unwrap();
        let mut law = UNIT.law::<Fixed32>(&settings).unwrap();
        let mut impact = Impact::<Fixed32>::pulse_of(&Settings {
            estimator: one,
            ..settings
        })
        .unwrap()
        .unwrap();
        let (mut state, mut last, mut added) = (EstimatorState::default(), Force::zero(), 0);
        for tick in 0..2000 {
            let t = f64::from(tick) * TICK_S;
            let z = 0.3 - 0.8 * (9.0 * t).sin().max(-0.5);
            let (x, y) = (20.0 * (3.0 * t).sin(), -7.0 * (5.0 * t).sin());
            estimator.commanded(&mut state, last);
            let sample = estimator.tick(&mut state, mm(-z));
            let plain = law.tick(sample);
            last = impact
                .with_pulse_and_vibration(sample, plain)
                .min(newton(12.0));
            let force = three.tick(at(x, y, z)).unwrap();
            assert_eq!(
                force,
                Vector([Force::zero(), Force::zero(), last]),
                "{tick}"
            );
            added += u32::from(last != plain.min(newton(12.0)));
        }
        assert!(added > 2, "{momentum} {vibration}: {added}");
    }
}

/// Goes into a wall along its normal and stays there. Returns what the vibration adds to the force, N, in every control period from
/// the touch on.
fn vibration(
    shape: Shape<Fixed32>,
    surface_mm: f64,
    normal: [f64; 3],
    speed: f64,
) -> Vec<[f64; 3]> {
    let step_mm = 1e3 * speed * TICK_S;
    let walls = ["0", "0.2"].map(|share| bare(shape, &settings("0", share), false));
    let mut forces = walls.map(|mut wall| {
        (0..206).map(move |tick: u32| {
            // The first position inside is a whole step deep, so that the first displacement is the full speed.
            let depth_mm = step_mm * (f64::from(tick.min(10)) - 5.0);
            let [x, y, z] = normal.map(|n| (surface_mm - depth_mm) * n);
            push_in_n(wall.tick(at(x, y, z)).unwrap())
        })
    });
    let mut added = Vec::new();
    for _ in 0..206 {
        let [plain, with] = forces.each_mut().map(|it| it.next().unwrap());
        added.push(std::array::from_fn(|i| with[i] - plain[i]));
    }
    added.split_off(6)
}

#[test]
fn the_vibration_has_its_amplitude_frequency_and_decay_along_the_normal() {
    let (share, speed, hz, decay_s) = (0.2, 0.05, 60.0, 0.03);
    let omega = std::f64::consts::TAU * hz;
    let amplitude = share * MASS_KG * omega * speed;
    let ball = Shape::Sphere(Sphere {
        centre: Vector::default(),
        radius: mm(RADIUS_MM),
    });
    let (a, b) = (
        [2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0],
        [-3.0 / 7.0, 2.0 / 7.0, 6.0 / 7.0],
    );
    for (name, shape, surface_mm, normal) in [
        ("inclined plane", plane(a[0], a[1], a[2]), 0.0, a),
        ("ball", ball, RADIUS_MM, b),
    ] {
        let (mut worst, mut across) = (0.0_f64, 0.0_f64);
        for (n, force) in (1_u32..).zip(vibration(shape, surface_mm, normal, speed)) {
            let t = f64::from(n) * TICK_S;
            let ideal = amplitude * (-t / decay_s).exp() * (omega * t).sin();
            let out = dot(force, normal);
            worst = worst.max((out - ideal).abs() / amplitude);
            let side: [f64; 3] = std::array::from_fn(|i| force[i] - out * normal[i]);
            across = across.max(length(side));
        }
        println!(
            "{name}: off by {worst:.3} of the amplitude of {amplitude:.3} N; across {across:.1e} N"
        );
        // As on one axis: the recursion's error is of first order in the angle and the decay of a control period, and here the
        // displacement is rounded to 6e-8 cm of 5e-3 cm.
        assert!(worst < 0.25 * (omega + 1.0 / decay_s) * TICK_S, "{worst}");
        // Steps of the number format in force and direction.
        assert!(across < 2e-6, "{across} N");
    }
}

fn cell(object: Object, approach: Approach, feel: SurfaceFeel) -> Cell {
    Cell {
        mechanism: Mechanism::Cartesian,
        object,
        k_desired_n_per_mm: 25.0,
        approach,
        feel,
    }
}

fn material() -> SurfaceFeel {
    SurfaceFeel {
        impact: Some(ImpactSettings {
            momentum: si("0.3"),
            vibration: si("0.7"),
            frequency_hz: si("60"),
            decay_s: si("0.03"),
        }),
        texture: None,
    }
}

fn grooves(height_mm: f64) -> SurfaceFeel {
    SurfaceFeel {
        impact: None,
        texture: Some(Texture {
            height_mm,
            period_mm: 2.0,
            along: [1.0, 0.0, 0.0],
        }),
    }
}

/// Checks that the hand feels the vibration in the first 60 ms of a touch in a whole run, along the normal alone, and that the wall
/// stays passive.
#[test]
fn a_material_is_felt_in_a_run_and_stays_passive() {
    for object in Object::ALL {
        let [plain, with] = [SurfaceFeel::default(), material()]
            .map(|feel| run(&cell(object, Approach::Shipped, feel)).unwrap());
        let first = (0..plain.force_n.len())
            .find(|tick| plain.normal_force_n(*tick) > 0.0)
            .unwrap();
        let largest = (first..first + 60)
            .map(|tick| (with.normal_force_n(tick) - plain.normal_force_n(tick)).abs())
            .fold(0.0, f64::max);
        let across = with.most_tangential(first..first + 60);
        println!("{object:?}: {largest:.3} N, across the normal {across:.4} of it");
        assert!(largest > 0.1, "{object:?}: {largest} N");
        assert!(across < 0.01, "{object:?}: {across}");
        assert_eq!(with.judged().0, Verdict::Passive, "{object:?}");
    }
}

/// Amplitude of a column over some ticks at the phase of the grooves, as a complex number.
fn at_phase(ticks: &[(f64, f64)]) -> [f64; 2] {
    let share = 2.0 / ticks.len() as f64;
    let mean = ticks.iter().map(|(_, value)| value).sum::<f64>() / ticks.len() as f64;
    let sum = |wave: fn(f64) -> f64| {
        let terms = ticks
            .iter()
            .map(|(angle, value)| wave(*angle) * (value - mean));
        share * terms.sum::<f64>()
    };
    [sum(f64::cos), sum(f64::sin)]
}

/// Modulus of a device's mass and damping with a hand that rests, N/mm, at an angular frequency.
fn impedance(omega: f64) -> [f64; 2] {
    let hand = FIRM_TRANSLATION;
    // Force over displacement of hand behind pad, in N/m: the pad in series with the hand.
    let pad = [hand.pad_stiffness, omega * hand.pad_damping];
    let own = [
        hand.stiffness - hand.inertia * omega * omega,
        omega * hand.damping,
    ];
    let behind = over(times(pad, own), [pad[0] + own[0], pad[1] + own[1]]);
    [
        1e-3 * (behind[0] - OMEGA3_AXIS.inertia * omega * omega),
        1e-3 * (behind[1] + omega * OMEGA3_AXIS.damping),
    ]
}

fn times(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn over(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let size = b[0] * b[0] + b[1] * b[1];
    times(a, [b[0] / size, -b[1] / size])
}

/// Amplitude of the normal force, N, at a period along x, while the hand slides.
fn amplitude_n(record: &Record, period_mm: f64) -> f64 {
    let forces: Vec<(f64, f64)> = record
        .late(Phase::Slide, 0.6)
        .map(|tick| {
            let angle = std::f64::consts::TAU * record.hip_mm[tick][0] / period_mm;
            (angle, record.normal_force_n(tick))
        })
        .collect();
    let found = at_phase(&forces);
    found[0].hypot(found[1])
}

/// Checks the amplitude of the normal force at the period of the grooves, while the hand slides over a plane. The wall's spring `k`
/// and the device in the hand, with the complex stiffness `Z`, are in series under grooves of the amplitude `a`, so the force has
/// the amplitude `a |k Z/(k + Z)|`.
#[test]
fn a_texture_is_felt_along_the_normal_with_its_height() {
    for (object, height_mm) in [
        (Object::Horizontal, 0.1),
        (Object::Inclined, 0.1),
        (Object::Horizontal, 0.04),
    ] {
        let feel = grooves(height_mm);
        let record = run(&cell(object, Approach::Shipped, feel)).unwrap();
        let texture = feel.texture.unwrap();
        let slide = record.late(Phase::Slide, 0.6);
        let speed: f64 = {
            let x = |tick: usize| record.hip_mm[tick][0];
            (x(slide.end - 1) - x(slide.start)) / ((slide.len() - 1) as f64 * TICK_S)
        };
        let omega = std::f64::consts::TAU * speed / texture.period_mm;
        let period_mm = texture.period_mm;
        let found_n = amplitude_n(&record, period_mm);
        let (k, z) = ([25.0, 0.0], impedance(omega));
        let series = over(times(k, z), [k[0] + z[0], z[1]]);
        let ideal_n = 0.5 * height_mm * series[0].hypot(series[1]);
        let across = record.most_tangential(slide);
        println!(
            "{object:?}, {height_mm} mm: {found_n:.3} N at {:.1} Hz, series of springs {ideal_n:.3} N, across {across:.4}",
            omega / std::f64::consts::TAU
        );
        assert!(
            (found_n / ideal_n - 1.0).abs() < 0.15,
            "{found_n} N for {ideal_n} N"
        );
        assert!(across < 0.01, "{across}");
        let smooth = run(&cell(object, Approach::Shipped, SurfaceFeel::default())).unwrap();
        let smooth_n = amplitude_n(&smooth, period_mm);
        assert!(smooth_n < 0.2 * found_n, "{smooth_n} N without a texture");
        assert_eq!(record.judged().0, Verdict::Passive, "{object:?}");
    }
}

/// The shipped guard of the cells: capacity and refill in J and W, and the damping that it trusts, N·s/m.
const CAPACITY_J: f64 = 0.04;
const REFILL_W: f64 = 0.0005;
const TRUSTED_N_S_PER_M: f64 = 0.8 * 2.5;

/// A hand that moves over a plane in closed curves and touches it anew now and then.
fn hand_at(numbers: &[f64], tick: u32) -> [f64; 3] {
    let t = f64::from(tick) * TICK_S;
    let rate = |n: f64| 40.0 * (1.2 * n).clamp(-3.0, 2.0).exp();
    let wave = |size: f64, turns: f64, phase: f64| size * (turns * t + phase).sin();
    let across = rate(numbers[0]);
    let side_mm = wave(2.0 * numbers[1].tanh(), across, numbers[2]);
    // The motion along the normal has the frequency of the motion across, or a multiple of it.
    let times = (1.0 + 3.0 * numbers[3].abs().min(2.0)).round();
    let depth_mm =
        0.25 * (1.0 + numbers[4].tanh()) + wave(numbers[5].tanh(), times * across, numbers[6]);
    // Every 150 control periods the hand is outside for some 30.
    let away = (f64::from(tick % 150) - 120.0).max(0.0) / 30.0;
    let depth_mm = depth_mm - 3.0 * (std::f64::consts::PI * away).sin();
    [side_mm, 0.3 * side_mm, -depth_mm]
}

/// The most energy that a hand takes out in any time window, above the refill, J. With `account` the guard's account has this many
/// joules at the start, and every window begins there.
fn taken(cell: &Cell, numbers: &[f64], ticks: u32, account: Option<f64>) -> f64 {
    let mut wall = wall(cell).unwrap();
    if let (Some((_, state)), Some(joules)) = (&mut wall.guard, account) {
        // The wall's unit of energy is 10 mJ.
        state.account = touchstone_control::Energy::from_si(Si::from_num(100.0 * joules)).unwrap();
    }
    let (mut energy_j, mut least_j, mut most_j) = (0.0_f64, 0.0_f64, 0.0_f64);
    let (mut force, mut last): ([f64; 3], Option<[f64; 3]>) = ([0.0; 3], None);
    for tick in 0..ticks {
        let mut here = hand_at(numbers, tick);
        if let Some(last) = last {
            // Stays below the guard's speed limit of 1.5 mm in a control period.
            let step: [f64; 3] = std::array::from_fn(|i| here[i] - last[i]);
            let share = (1.4 / length(step).max(1e-9)).min(1.0);
            here = std::array::from_fn(|i| last[i] + share * step[i]);
        }
        let step = last.map_or([0.0; 3], |last| {
            std::array::from_fn(|i| 1e-3 * (here[i] - last[i]))
        });
        energy_j +=
            dot(force, step) - TRUSTED_N_S_PER_M * dot(step, step) / TICK_S - REFILL_W * TICK_S;
        most_j = most_j.max(energy_j - least_j);
        if account.is_none() {
            least_j = least_j.min(energy_j);
        }
        last = Some(here);
        let [x, y, z] = here;
        force = push_in_n(wall.tick(at(x, y, z)).expect("below the speed limit"));
    }
    most_j
}

fn worst(cell: &Cell, account: Option<f64>) -> f64 {
    let (hand, most) = search::largest(7, 0.5, 250, 11, |numbers| {
        taken(cell, numbers, 600, account)
    });
    most.max(taken(cell, &hand, 6_000, account))
}

#[test]
fn no_hand_gets_more_from_texture_and_touch_than_the_guard_promises() {
    // Energy of half an encoder count in each coordinate at each end of a window, under the largest force.
    let count_j = 3.0_f64.sqrt() * 1e-5 * 12.0;
    let both = SurfaceFeel {
        impact: Some(ImpactSettings {
            momentum: si("2"),
            vibration: si("1"),
            frequency_hz: si("60"),
            decay_s: si("0.1"),
        }),
        ..grooves(0.2)
    };
    let shipped = cell(Object::Horizontal, Approach::Shipped, both);
    let full = worst(&shipped, None);
    let empty = worst(&shipped, Some(0.0));
    // The thesis' spring has no guard and no pulse, but it has the texture.
    let unguarded = worst(
        &cell(Object::Horizontal, Approach::Spring, grooves(0.2)),
        None,
    );
    println!(
        "{:.2} mJ with a full account, {:.4} with an empty one, {:.0} without a guard; promised {:.2} and {:.4}",
        1e3 * full,
        1e3 * empty,
        1e3 * unguarded,
        1e3 * (CAPACITY_J + count_j),
        1e3 * count_j
    );
    assert!(full <= CAPACITY_J + count_j, "{full} J");
    assert!(empty <= count_j, "{empty} J");
    assert!(full > 0.4 * CAPACITY_J, "the hands are no test: {full} J");
    assert!(
        unguarded > 5.0 * CAPACITY_J,
        "the texture is no test: {unguarded} J"
    );
}

#[test]
fn a_smooth_surface_and_the_tuned_pulse_are_the_shipped_wall_to_the_bit() {
    for object in Object::ALL {
        let plain = run(&cell(object, Approach::Shipped, SurfaceFeel::default())).unwrap();
        let tuned =
            touchstone_lab::thesis::space::tuned_wall::TunedWall::of(Mechanism::Cartesian, 1000);
        let same = SurfaceFeel {
            impact: Some(tuned.settings(1000, 12.0).impact),
            texture: None,
        };
        let same = run(&cell(object, Approach::Shipped, same)).unwrap();
        assert_eq!(plain.force_n, same.force_n, "{object:?}");
    }
}
