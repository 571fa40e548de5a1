//! The guard where it stands, between law and motor: what scenes and devices do with it.

use touchstone_control::{Controller, Fixed32, Force, Position, Settings, Si};
use touchstone_sim::run::{self};
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

/// Laws that ring and kick in the hands of three grips, with every delay: whatever they do, the hand gets out at most the account,
/// its refill and the encoder's share, and what the device's own motion held.
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
                    // Half a count at each end under the largest force, and nothing moved at the start.
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
    // Pressed in, and pulled out faster than it pays: the account sinks.
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
    // All other memory is that of a law which was never in a wall.
    assert_eq!(again.law, fresh.law);
    assert_eq!(again.states, fresh.states);
    // A smaller capacity caps what is taken over.
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
    // 0.07 rad in a millisecond: 70 rad/s where 60 are answered for.
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

#[test]
fn what_became_of_a_force_is_what_counts() {
    // Fading in: a tenth of the force acted. The books are of that, and so is the estimator's next expectation.
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
