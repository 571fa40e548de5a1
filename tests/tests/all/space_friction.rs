//! Tests the simulated friction along a surface: a stuck point does not creep, the sliding force is the kinetic coefficient times
//! the normal force, and friction gives no energy beyond what the device's own damping dissipates.

use touchstone_control::space::environment::{Plane, Sphere};
use touchstone_control::space::{
    Direction, Friction, FrictionError, FrictionSettings, FrictionState, Rule, Surface,
    SurfacePoint, Touch,
};
use touchstone_control::{Energy, Reported, Si};
use touchstone_tests::random::Random;
use touchstone_tests::si::{assert_one_line, si};
use touchstone_tests::space::{
    F, UNIT, at, direction, dot, in_mm, length, mm, newton, numbers, push_in_n,
};

const STATIC: f64 = 0.6;
const KINETIC: f64 = 0.4;
const RATE_HZ: u32 = 1000;
const DAMPING: &str = "2.5";

fn settings() -> FrictionSettings {
    FrictionSettings {
        // The largest stiffness that the device's damping `b` allows, 2 b/T at the control period `T`.
        stiffness: si("5000"),
        static_coefficient: si("0.6"),
        kinetic_coefficient: si("0.4"),
    }
}

fn friction() -> Friction<F> {
    settings()
        .friction(UNIT, RATE_HZ, si(DAMPING))
        .expect("settings")
}

fn floor(normal: Direction<F>) -> Plane<F> {
    Plane {
        normal,
        height: mm(0.0),
    }
}

/// Checks that a mass which is pushed along x and held by friction does not creep. The mass' motion between control periods is
/// integrated in steps of a fiftieth of a period.
#[test]
fn in_stick_nothing_creeps_over_a_million_ticks() {
    const MASS_KG: f64 = 0.148;
    // Half of the stiffness that the damping allows, because no hand damps this mass. At 2 b/T itself the oscillation of mass and
    // sampled spring would not decay.
    let law = FrictionSettings {
        stiffness: si("2500"),
        ..settings()
    };
    let law = law
        .friction::<F>(UNIT, RATE_HZ, si(DAMPING))
        .expect("settings");
    let plane = floor(Direction::along(2, false));
    let mut state = FrictionState::default();
    let mut point = SurfacePoint::new(Rule::Closest);
    let (mut x, mut v) = (0.0_f64, 0.0_f64);
    // 0.9 of the force at which friction starts to slide, and a tremor of 8 Hz.
    let (pressed, push) = (5.0, 0.9 * STATIC * 5.0);
    let mut early = None;
    for tick in 0..1_000_000_u32 {
        let count = (x * 100.0).round() / 100.0;
        let touch = point.tick(&plane, at(count, 0.0, -0.2));
        let force = push_in_n(law.tick(&mut state, &touch, newton(pressed)))[0];
        let tremor = 0.05 * push * (f64::from(tick) * 0.05).sin();
        let rise = (f64::from(tick) / 1000.0).min(1.0);
        for _ in 0..50 {
            let a = (rise * push + tremor + force - 2.5e-3 * v) / MASS_KG * 1e3;
            v += a * 2e-5;
            x += v * 2e-5;
        }
        assert!(!state.sliding, "it slides at tick {tick}");
        if tick == 10_000 {
            early = Some((x, touch.at));
        }
    }
    let (early, _) = early.expect("that tick was played");
    println!("held at {early:.5} mm after 10 s and {x:.5} mm after 1000 s");
    // Allowed: the spring's change of length by the tremor, peak to peak, and an encoder count.
    assert!((x - early).abs() < 2.0 * 0.05 * push / 2.5 + 0.01);
    // The anchor has not moved: back at the first place the force is exactly 0.
    let back = law.tick(
        &mut state,
        &point.tick(&plane, at(0.0, 0.0, -0.2)),
        newton(pressed),
    );
    assert_eq!(push_in_n(back), [0.0; 3]);
}

/// Checks a million control periods of tremor along an inclined plane: friction at the same position always has the same force.
#[test]
fn on_an_inclined_plane_the_same_place_has_the_same_force() {
    let law = friction();
    let plane = floor(direction(0.3, -0.2, 0.9));
    let mut state = FrictionState::default();
    let mut point = SurfacePoint::new(Rule::Closest);
    let mut random = Random::new(2);
    let home = at(1.0, -2.0, -1.0);
    law.tick(&mut state, &point.tick(&plane, home), newton(6.0));
    let test = at(1.2, -1.9, -0.97);
    let first = law.tick(&mut state, &point.tick(&plane, test), newton(6.0));
    assert!(length(push_in_n(first)) > 0.5);
    for _ in 0..1_000_000 {
        let shake = at(
            1.0 + 0.2 * random.real(),
            -2.0 + 0.2 * random.real(),
            -1.0 + 0.1 * random.real(),
        );
        law.tick(
            &mut state,
            &point.tick(&plane, shake),
            newton(6.0 + random.real()),
        );
        assert!(!state.sliding);
    }
    assert_eq!(
        law.tick(&mut state, &point.tick(&plane, test), newton(6.0)),
        first
    );
}

#[test]
fn it_slides_at_its_coefficient() {
    let law = friction();
    let ball = Sphere {
        centre: at(0.0, 0.0, 0.0),
        radius: mm(30.0),
    };
    let mut worst = 0.0_f64;
    for speed_mm_per_s in [1.0, 5.0, 50.0, 300.0] {
        for pressed in [0.2, 2.0, 11.0] {
            for on_ball in [false, true] {
                let plane = floor(direction(0.1, 0.4, 1.0));
                let across =
                    Direction::of(plane.normal.across(at(10.0, 0.0, 0.0))).expect("not parallel");
                let mut state = FrictionState::default();
                let mut point = SurfacePoint::new(Rule::Closest);
                let ticks = (20.0 / speed_mm_per_s * 1e3) as u32;
                let (mut peak, mut slid) = (0.0_f64, 0);
                for tick in 0..ticks {
                    let way = speed_mm_per_s * 1e-3 * f64::from(tick);
                    let here = if on_ball {
                        let phi = way / 29.8;
                        at(29.8 * phi.sin(), 0.0, 29.8 * phi.cos())
                    } else {
                        across.times(mm(way)) - plane.normal.times(mm(0.2))
                    };
                    let touch = if on_ball {
                        point.tick(&ball, here)
                    } else {
                        point.tick(&plane, here)
                    };
                    let force = push_in_n(law.tick(&mut state, &touch, newton(pressed)));
                    assert!(
                        dot(force, numbers(&touch.normal)).abs() < 1e-5,
                        "across the normal"
                    );
                    let ratio = length(force) / pressed;
                    if state.sliding {
                        slid += 1;
                        worst = worst.max((ratio / KINETIC - 1.0).abs());
                    } else {
                        peak = peak.max(ratio);
                    }
                    assert!(ratio <= STATIC * 1.001, "{ratio}");
                }
                assert!(slid > ticks / 4, "{slid} of {ticks} ticks slide");
                // In a control period the force over the normal force grows by `step`. So its largest value before sliding is at
                // most that far below the static coefficient.
                let step = 5.0 * speed_mm_per_s * 1e-3 / pressed;
                assert!(
                    peak > STATIC - step - 0.01,
                    "sticks up to {peak}, {speed_mm_per_s} mm/s, {pressed} N"
                );
            }
        }
    }
    println!(
        "while it slides, off its coefficient by at most {:.4} %",
        100.0 * worst
    );
    assert!(worst < 0.01);
}

/// A random path of the hand that ends where it began, as displacements from its start in mm.
fn closed_loop(random: &mut Random) -> Vec<[f64; 3]> {
    let ticks = 10 + (random.bits() % 50) as usize;
    let size = 2.0_f64.powf(4.0 * random.real() - 2.0);
    let mut path: Vec<[f64; 3]> = vec![[0.0; 3]];
    let mut here = [0.0; 3];
    for _ in 0..ticks {
        for x in &mut here {
            *x += size * 0.1 * random.real();
        }
        path.push(here);
    }
    // Back to the start in even steps.
    for step in (0..10).rev() {
        path.push(here.map(|x| x * f64::from(step) / 10.0));
    }
    path
}

/// Moves a hand around a closed path on a surface. Returns energies in mJ: what friction takes, what the device's damping
/// dissipates, and a bound of the sum's rounding error.
fn around(
    law: &Friction<F>,
    surface: &impl Surface<F>,
    home: [f64; 3],
    path: &[[f64; 3]],
    random: &mut Random,
) -> (f64, f64, f64) {
    const DAMPING_N_PER_MM: f64 = 2.5;
    let mut state = FrictionState::default();
    let mut point = SurfacePoint::new(Rule::Closest);
    let mut last: Option<(Touch<F>, _)> = None;
    let (mut taken, mut damped, mut slack) = (Energy::zero(), 0.0, 0.0);
    let pressed = 12.0 * random.real().abs();
    let even = random.bits().is_multiple_of(2);
    for step in path {
        let here = at(home[0] + step[0], home[1] + step[1], home[2] + step[2]);
        let touch = point.tick(surface, here);
        if let Some((before, force)) = last {
            let moved = here - before.at;
            let force: touchstone_tests::space::Push = force;
            taken = taken + (-force).work(moved);
            damped += DAMPING_N_PER_MM * moved.0.map(|x| in_mm(x).powi(2)).iter().sum::<f64>();
            // Bound of the rounding: four steps of the number format (2^-24 cm each) per tick, times the force.
            slack += 4.0 * length(push_in_n(force)) / 1_677_721.6;
        }
        let now = if even {
            pressed
        } else {
            pressed * random.real().abs()
        };
        let force = law.tick(&mut state, &touch, newton(now));
        last = Some((touch, force));
    }
    // The unit of an energy is 10 mJ.
    (10.0 * F::energy_to_f64(taken.0), damped, slack)
}

#[test]
fn around_closed_loops_it_never_adds_energy() {
    const LOOPS: u32 = 100_000;
    const SEED: u64 = 20_261;
    let law = friction();
    let mut random = Random::new(SEED);
    let (mut least, mut least_damped, mut gave, mut needed) = (f64::MAX, f64::MAX, 0, 0.0_f64);
    for i in 0..LOOPS {
        let path = closed_loop(&mut random);
        let (taken, damped, slack) = match i % 3 {
            0 => around(
                &law,
                &floor(Direction::along(2, false)),
                [0.0, 0.0, -5.0],
                &path,
                &mut random,
            ),
            1 => around(
                &law,
                &floor(direction(0.5, -0.3, 0.8)),
                [0.0, 0.0, -5.0],
                &path,
                &mut random,
            ),
            _ => {
                let ball = Sphere {
                    centre: at(0.0, 0.0, 0.0),
                    radius: mm(15.0),
                };
                around(&law, &ball, [3.0, -1.0, 9.0], &path, &mut random)
            }
        };
        least = least.min(taken);
        least_damped = least_damped.min(taken + damped + slack);
        gave += u32::from(taken < -slack);
        if damped > 0.0 {
            needed = needed.max(-taken / damped);
        }
        assert!(
            taken + damped >= -slack,
            "loop {i} of seed {SEED}: {taken} mJ taken, {damped} mJ damped"
        );
    }
    println!(
        "seed {SEED}, {LOOPS} closed loops: least taken {least:.4} mJ ({gave} loops give some back), least with the device's damping {least_damped:.2e} mJ; of the damping at most {:.1} % is needed",
        100.0 * needed
    );
    // The bound 2 b/T is needed: with four times this stiffness, loops do add energy.
    let stiff = Friction {
        stiffness: touchstone_control::Stiffness(law.stiffness.0 * 4),
        static_reach: touchstone_control::Compliance(law.static_reach.0 / 4),
        kinetic_reach: touchstone_control::Compliance(law.kinetic_reach.0 / 4),
    };
    let mut broken = 0;
    for _ in 0..2000 {
        let path = closed_loop(&mut random);
        let (taken, damped, slack) = around(
            &stiff,
            &floor(Direction::along(2, false)),
            [0.0, 0.0, -5.0],
            &path,
            &mut random,
        );
        broken += u32::from(taken + damped < -slack);
    }
    println!("at four times the stiffness {broken} of 2000 loops add energy");
    assert!(broken > 0);
}

#[test]
fn settings_that_would_be_active_are_refused() {
    let refused = |settings: FrictionSettings| {
        let why = settings
            .friction::<F>(UNIT, RATE_HZ, si(DAMPING))
            .expect_err("refused");
        assert_one_line(&why.to_string());
        why
    };
    let most = si("5000");
    let stiff = FrictionSettings {
        stiffness: Si::from_bits(most.to_bits() + 1),
        ..settings()
    };
    assert!(matches!(refused(stiff), FrictionError::Stiffness { .. }));
    let none = FrictionSettings {
        stiffness: Si::ZERO,
        ..settings()
    };
    assert!(matches!(refused(none), FrictionError::Stiffness { .. }));
    let grabbing = FrictionSettings {
        kinetic_coefficient: si("0.61"),
        ..settings()
    };
    assert!(matches!(
        refused(grabbing),
        FrictionError::Coefficients { .. }
    ));
    let pulling = FrictionSettings {
        kinetic_coefficient: si("-0.1"),
        ..settings()
    };
    assert!(matches!(
        refused(pulling),
        FrictionError::Coefficients { .. }
    ));
    let soft = FrictionSettings {
        stiffness: si("0.0001"),
        ..settings()
    };
    assert!(matches!(refused(soft), FrictionError::OutOfFormat { .. }));
}
