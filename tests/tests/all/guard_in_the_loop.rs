//! Tests of the energy guard between control law and motor, in simulations and devices.

use touchstone_control::{
    Controller, CountScale, Fixed16, Fixed32, Force, LawKind, Position, Reported, Settings, Si,
};
use touchstone_sim::run::{self};
use touchstone_tests::random::Random;
use touchstone_tests::thesis;

fn wall(change: impl Fn(&mut Settings)) -> Controller<Fixed32> {
    let mut settings = Settings::thesis();
    settings.guard.on = true;
    change(&mut settings);
    Controller::new(&settings).unwrap()
}

fn at(rad: f64) -> Position<Fixed32> {
    Position::from_f64(rad)
}

/// Checks control laws that ring and kick, under three simulated grips (light, medium, firm) and without a hand, with several
/// delays. The hand gets out at most what the guard's energy account holds, what refills it, and the error of the encoder.
#[test]
fn no_law_gives_more_than_the_account() {
    let (capacity_j, refill_w) = (0.045, 0.0005);
    let mut acted = 0;
    for law in ["spring", "tdpa", "sfa", "spring-damper", "enhanced-sfa"] {
        for stiffness in [5, 20, 50] {
            for delay_s in [0.0, 1e-4, 5e-4, 1e-3] {
                for grip in ["light", "medium", "firm", "none"] {
                    let scene = thesis("thesis-knob")
                        .with_overrides(&[
                            "law.guard.on=true".to_owned(),
                            format!("law.kind={law}"),
                            format!("wall.k_desired_n_m_per_rad={stiffness}"),
                            format!("timing.computational_delay_s={delay_s}"),
                            format!("law.guard.delay_s={delay_s}"),
                            format!("operator.grip={grip}"),
                            "device.initial_angle_rad=0.5".to_owned(),
                            format!(
                                "operator.motion.kind={}",
                                if grip == "none" {
                                    "none"
                                } else {
                                    "touch-and-press"
                                }
                            ),
                        ])
                        .unwrap();
                    let run = run::run(&scene, false).unwrap().summary;
                    let seconds = run.ticks as f64 * 1e-3;
                    // Half a count at each end under the largest force; nothing moves at the start.
                    let bound_j = capacity_j + refill_w * seconds + 0.5 * 1.6e-4;
                    acted += u32::from(run.guard_limited_ticks.unwrap() > 0);
                    assert!(
                        run.energy_out_worst_window_j <= bound_j,
                        "{law} {stiffness} {delay_s} {grip}: {} J of {bound_j} J",
                        run.energy_out_worst_window_j
                    );
                }
            }
        }
    }
    assert!(
        acted > 40,
        "the guard acted in {acted} runs only: nothing was tested"
    );
}

#[test]
fn arming_again_does_not_fill_the_account() {
    let fresh = wall(|_| ());
    let mut used = fresh;
    // Pressed in slowly, and pulled out faster than the account is filled: the account sinks.
    let mut lowest = f64::INFINITY;
    for round in 0..400 {
        let x = 0.03 * (0.9 * f64::from(round)).sin() + 0.03;
        used.tick(at(x));
        lowest = lowest.min(used.guard.unwrap().account().to_f64());
    }
    let left = used.guard.unwrap().account();
    assert!(left.to_f64() < 0.044, "{left:?}");
    let mut again = used;
    again.resume(&fresh);
    assert_eq!(again.guard.unwrap().account(), left);
    // All other memory is that of a law that was never in a wall.
    assert_eq!(again.law, fresh.law);
    assert_eq!(again.states, fresh.states);
    // A smaller capacity limits the energy that is kept.
    let mut smaller = used;
    smaller.resume(&wall(|s| s.guard.capacity = Si::lit("0.001")));
    assert!(smaller.guard.unwrap().account().to_f64() <= 0.001);
}

#[test]
fn overspeed_switches_off_until_the_next_arming() {
    let fresh = wall(|_| ());
    let mut wall = fresh;
    let force = |wall: &mut Controller<Fixed32>, x: f64| wall.tick(at(x)).to_f64();
    assert!(force(&mut wall, 0.02) > 0.0 && !wall.tripped());
    // 0.07 rad in a millisecond are 70 rad/s; the bound holds up to 60 rad/s.
    assert_eq!(force(&mut wall, 0.09), 0.0);
    assert!(wall.tripped());
    for _ in 0..1_000 {
        assert_eq!(force(&mut wall, 0.09), 0.0);
    }
    let mut again = wall;
    again.resume(&fresh);
    assert!(!again.tripped());
    assert!(force(&mut again, 0.02) > 0.0);
}

/// Encoder counts per turn of the knob. The counter also counts beyond the range of the position format.
const COUNTS_PER_REV: u32 = 40_000;
const COUNT_RAD: f64 = std::f64::consts::TAU / COUNTS_PER_REV as f64;

fn counted<N: Reported>(wall: &mut Controller<N>, count: i64) -> f64 {
    let scale = CountScale::new(COUNTS_PER_REV, Si::ZERO).unwrap();
    wall.tick(scale.penetration(count)).to_f64()
}

/// Simulates a hand that moves to and fro at the end of the range of positions, and switches the motor on again after each
/// over-speed. Returns the most energy in J that it got in any time window beyond the refill of the guard's account, and how often
/// the motor was switched on again.
fn wandering<N: Reported>(settings: &Settings, end_rad: f64, seed: u64) -> (f64, u32) {
    let fresh = Controller::<N>::new(settings).unwrap();
    let mut wall = fresh;
    let mut random = Random::new(seed);
    let guard = &settings.guard;
    let trusted: f64 = (guard.share_of_damping * guard.damping).to_num::<f64>() * 1e3;
    let refill_j = guard.refill.to_num::<f64>() * 1e-3;
    let end = (end_rad / COUNT_RAD) as i64;
    let (mut at, mut speed, mut left) = (end - 3_000, 0, 0);
    let (mut out, mut least, mut most, mut force, mut armed) = (0.0_f64, 0.0, 0.0_f64, 0.0, 0);
    for _ in 0..100_000 {
        if left == 0 {
            left = 1 + random.bits() % (1 << (random.bits() % 10));
            speed = i64::from(random.whole(380)) >> (random.bits() % 6);
            if (at - end).abs() > 20_000 {
                speed = -speed.abs() * (at - end).signum();
            }
        }
        left -= 1;
        at += speed;
        let moved = speed as f64 * COUNT_RAD;
        out -= force * moved + trusted * moved * moved + refill_j;
        most = most.max(out - least);
        if wall.tripped() {
            armed += 1;
            wall.resume(&fresh);
        }
        force = counted(&mut wall, at);
        least = f64::min(least, out);
    }
    (most, armed)
}

/// Checks that the energy guard counts every motion under a force, in every number format, also for a hand that crosses the end of
/// the range of positions and switches the motor on again after each over-speed.
#[test]
fn no_way_across_the_end_of_positions_goes_uncounted() {
    let mut settings = Settings::thesis();
    settings.guard.on = true;
    settings.law = LawKind::Spring;
    let bound_j = settings.guard.capacity.to_num::<f64>() + 0.5 * COUNT_RAD;
    for seed in 0..3 {
        for (most, armed) in [
            wandering::<Fixed32>(&settings, 128.0, seed),
            wandering::<Fixed16>(&settings, 2.0, seed),
            wandering::<f32>(&settings, 128.0, seed),
            wandering::<f64>(&settings, 128.0, seed),
        ] {
            println!(
                "{:.3} of {:.3} mJ, armed {armed} times",
                1e3 * most,
                1e3 * bound_j
            );
            assert!(most <= bound_j, "{most} J of {bound_j} J");
            assert!(armed > 10_000 && most > 0.5 * bound_j);
        }
    }
}

/// Simulates a hand that has the motor switched off now and then; `told` says whether this is reported to the energy guard. Returns
/// the most energy in J that it got in any time window beyond the refill of the guard's account, and how much of it the hand got
/// under the last force before a switch-off.
fn switching_off(told: bool, seed: u64) -> (f64, f64) {
    let mut settings = Settings::thesis();
    settings.guard.on = true;
    settings.law = LawKind::Spring;
    let fresh = Controller::<Fixed32>::new(&settings).unwrap();
    let mut wall = fresh;
    let mut random = Random::new(seed);
    let guard = &settings.guard;
    let trusted: f64 = (guard.share_of_damping * guard.damping).to_num::<f64>() * 1e3;
    let refill_j = guard.refill.to_num::<f64>() * 1e-3;
    let (mut at, mut out, mut least, mut most, mut last) = (0_i64, 0.0_f64, 0.0, 0.0_f64, 0.0);
    for _ in 0..20_000 {
        // The hand goes in without a force, which costs nothing. It lets the force act for a tick, and goes out; on the way the
        // force is switched off.
        wall.resume(&fresh);
        at = 40 + i64::from(random.whole(100)).abs();
        let force = counted(&mut wall, at);
        least = f64::min(least, out);
        let moved = -(i64::from(random.whole(380)).abs() + 1);
        at += moved;
        let moved = moved as f64 * COUNT_RAD;
        out -= force * moved + trusted * moved * moved + refill_j;
        last += -force * moved;
        most = most.max(out - least);
        if told {
            counted(&mut wall, at);
            wall.commanded(Force::zero());
            wall.switched_off();
        }
    }
    assert!(at < 200);
    (most, last)
}

/// Checks that a hand gets no more energy by having the motor switched off, however often.
#[test]
fn what_the_last_force_of_an_arming_does_is_counted() {
    let capacity_j = Settings::thesis().guard.capacity.to_num::<f64>();
    for seed in 0..3 {
        let (most, _) = switching_off(true, seed);
        let (untold, last) = switching_off(false, seed);
        println!(
            "{:.3} mJ of {:.3}; untold {:.0} mJ, of {:.0} mJ by last forces without the damping",
            1e3 * most,
            1e3 * capacity_j,
            1e3 * untold,
            1e3 * last
        );
        assert!(most <= capacity_j + 0.5 * COUNT_RAD);
        assert!(most > 0.3 * capacity_j, "nothing was tried");
        assert!(untold > 10.0 * capacity_j, "it would not have shown");
    }
}

#[test]
fn the_end_of_positions_takes_the_force_away_until_the_next_arming() {
    let fresh = wall(|_| ());
    let at_rad = |rad: f64| (rad / COUNT_RAD) as i64;
    // Two displacements at 60 rad/s before the end: 127.88 rad.
    let mut inside = fresh;
    for tick in 0..=450 {
        let rad = 127.5 + 1.1e-3 * f64::from(tick);
        let force = counted(&mut inside, at_rad(rad));
        assert_eq!(inside.tripped(), rad > 127.88, "{rad} rad");
        assert_eq!(force > 0.0, rad < 127.88, "{rad} rad");
    }
    // The encoder counts on, far beyond the format's range, and comes back.
    let left = inside.guard.unwrap().account();
    for turns in [21, 30, 1_000, 100_000, 2_000_000, 40, 10] {
        assert_eq!(counted(&mut inside, 40_000 * turns), 0.0);
        assert!(inside.tripped());
    }
    // Armed again beyond the range, there is no force either, and the account is not filled.
    let mut again = inside;
    again.resume(&fresh);
    assert!(!again.tripped() && again.guard.unwrap().account() <= left);
    assert_eq!(counted(&mut again, at_rad(127.9)), 0.0);
    assert!(again.tripped());
    again.resume(&fresh);
    assert!(counted(&mut again, at_rad(120.0)) > 0.0 && !again.tripped());
}

/// Checks a knob that is turned out of the wall beyond the range of positions, 20 turns away. It gets no force and no fault, and
/// meets its wall again when it is turned back.
#[test]
fn a_free_knob_beyond_the_end_of_positions_is_no_fault() {
    let mut wall = wall(|_| ());
    let far = -1_000_000;
    let outwards = (0..=3_334).map(|tick| -300 * tick);
    for count in outwards.clone().chain(outwards.map(|count| far - count)) {
        counted(&mut wall, count);
        assert!(!wall.tripped(), "{count}");
    }
    assert!(counted(&mut wall, 300) > 0.0);
}

#[test]
fn what_became_of_a_force_is_what_counts() {
    // Fading in: a tenth of the force acted. The energy account uses that force, and so does the estimator's next prediction.
    let estimated = |s: &mut Settings| {
        *s = Settings::default();
    };
    let (mut told, mut untold) = (wall(estimated), wall(estimated));
    let mut last = 0.0;
    for tick in 0..20 {
        let x = at(0.001 * f64::from(tick));
        let force = told.tick(x);
        last = force.to_f64();
        if tick < 10 {
            assert_eq!(untold.tick(x), force);
        } else {
            untold.tick(x);
        }
        if tick >= 9 {
            told.commanded(Force::from_f64(0.1 * force.to_f64()));
        }
    }
    let booked = |wall: &Controller<Fixed32>| wall.guard.unwrap().state.force.to_f64();
    assert!(
        (booked(&told) - 0.1 * last).abs() < 1e-6 && booked(&untold) > 0.5 * last,
        "{} and {} of {last}",
        booked(&told),
        booked(&untold)
    );
    assert_ne!(told.states, untold.states);
}
