//! Tests that the energy guard of three axes keeps its bound against simulated hands that try to get energy out, for any control
//! law.

use touchstone_control::GuardSettings;
use touchstone_control::space::{LengthUnit, Vector, VectorGuard};
use touchstone_control::{Fixed32, Force, GuardedDevice, Position, Si};
use touchstone_tests::si::si;
use touchstone_tests::space_port::{CAPACITY_MJ, COUNT_MM, Law, Port, Way, ball, whirl};

/// Energy of half an encoder count in each of three coordinates at each end of a time window, in mJ. The force is the largest that
/// the account allows: 20 mJ over the largest displacement of a control period, 1 mm, which is 20 N.
const ENCODER_MJ: f64 = 1.7320509 * COUNT_MM * 20.0;

fn port(law: Law, delay: f64, guard: Option<f64>) -> Port {
    Port {
        law,
        delay_ticks: delay,
        guard_delay: guard,
    }
}

#[test]
fn no_hand_in_space_gets_out_more_than_promised() {
    let (mut worst, mut worst_turn) = (0.0_f64, 0.0_f64);
    for (name, law) in [("ball", ball as Law), ("whirl", whirl)] {
        for delay in [0.0, 0.1, 0.5, 1.0] {
            for way in Way::ALL {
                let bare = port(law, delay, None).worst(way, 200, 500, 5).1;
                let guarded = port(law, delay, Some(delay));
                let (hand, got) = guarded.worst(way, 800, 500, 5);
                let long = guarded.play(way, &hand, 10_000);
                println!(
                    "{name}, delay {delay}, {way:?}: {:.2} mJ in half a second, {:.2} in 10 s of the worst, {:.0} without a guard",
                    got, long.above_refill, bare
                );
                let most = got.max(long.above_refill);
                assert!(
                    most <= CAPACITY_MJ + ENCODER_MJ,
                    "{most} mJ above the refill"
                );
                (worst, worst_turn) = (worst.max(most), worst_turn.max(long.turned));
            }
        }
    }
    println!(
        "most {worst:.3} mJ of {:.3}; a shortened force is turned by at most {worst_turn:.1e} rad",
        CAPACITY_MJ + ENCODER_MJ
    );
    // The search does find energy to get out.
    assert!(worst > 0.9 * CAPACITY_MJ, "{worst}");
    // Three steps of the number format (6e-8 N), at a force of a hundredth of a newton.
    assert!(worst_turn < 3.0 * 6e-8 / 0.01);
}

/// Shows that the tests in this file can fail: an energy guard that is configured for no delay does not keep its bound on a device
/// with a delay.
#[test]
fn a_guard_that_does_not_know_the_delay_does_not_hold() {
    let (_, got) = port(ball, 0.5, Some(0.0)).worst(Way::Policy, 1500, 500, 2);
    println!("half a tick late, set for none: {got:.1} mJ");
    assert!(got > 1.2 * CAPACITY_MJ, "{got}");
}

fn guard() -> VectorGuard<Fixed32> {
    let (settings, device) = LengthUnit::Centimetre.guard(
        &GuardSettings {
            capacity: si("0.02"),
            overspeed: si("1"),
            damping: si("2.5"),
            ..GuardSettings::default()
        },
        &GuardedDevice {
            rate_hz: 1000,
            force_limit: si("12"),
            count: si("0.00001"),
        },
    );
    VectorGuard::new(&settings, &device).expect("settings")
}

fn vector(x: &str, y: &str, z: &str) -> [Si; 3] {
    [si(x), si(y), si(z)]
}

#[test]
fn overspeed_in_any_direction_switches_off() {
    let guard = guard();
    let (f, d) = (
        Vector(vector("0", "3", "4").map(|x| Force::<Fixed32>::from_si(x).expect("fits"))),
        |v: [Si; 3]| Vector(v.map(|x| Position::<Fixed32>::from_si(x).expect("fits"))),
    );
    // 0.95 mm diagonally is no over-speed and 1.04 mm is, though no coordinate moves more than 0.6 mm.
    let mut state = guard.full();
    let slow = d(vector("0.055", "-0.055", "0.055"));
    assert_eq!(guard.tick(&mut state, slow, f), Ok(f));
    let fast = d(vector("0.06", "0.06", "-0.06"));
    assert!(guard.tick(&mut state, fast, f).is_err());
    assert_eq!(
        guard
            .tick(&mut state, d(vector("0", "0", "0")), f)
            .map(|force| force.length_up())
            .unwrap_or(Force::zero()),
        f.length_up(),
        "a full account answers for it again"
    );
}

/// Checks that the energy guard allows no force near the end of a coordinate's range, after it has counted the energy of the motion
/// under the earlier forces.
#[test]
fn the_end_of_positions_in_any_direction_takes_the_force_away() {
    let guard = guard();
    let place = |[x, y, z]: [&str; 3]| {
        Vector(vector(x, y, z).map(|x| Position::<Fixed32>::from_si(x).expect("fits")))
    };
    let force = Vector(vector("0", "3", "4").map(|x| Force::<Fixed32>::from_si(x).expect("fits")));
    let (still, none) = (Vector::default(), Vector::default());
    // Positions end at 128 cm. The guard allows no force within two of the largest displacements of a tick, 0.1 cm each, from
    // there.
    for (before, moved) in [
        (["127.79", "0", "5"], ["0.02", "0", "0"]),
        (["-3", "-127.79", "0"], ["0", "-0.02", "0"]),
        (["0", "9", "127.79"], ["0", "-0.03", "0.02"]),
    ] {
        let (before, moved) = (place(before), place(moved));
        let mut state = guard.full();
        let answer = guard.tick_at(&mut state, before, still, force);
        assert_eq!(answer, Ok(force));
        let mut booked = state;
        guard.tick(&mut booked, moved, none).expect("slow");
        let there = before + moved;
        assert!(guard.tick_at(&mut state, there, moved, force).is_err());
        assert_eq!(state, booked);
        // Without a requested force there is nothing to refuse.
        assert_eq!(guard.tick_at(&mut state, there, still, none), Ok(none));
    }
}

/// Checks that the energy guard counts less energy for a motion if a smaller force than the allowed one was commanded. A report of
/// a larger force has no effect.
#[test]
fn what_is_commanded_smaller_is_booked_smaller() {
    let guard = guard();
    let f = Vector(vector("1", "2", "2").map(|x| Force::<Fixed32>::from_si(x).expect("fits")));
    let zero = Vector::default();
    let mut one = guard.full();
    let mut other = guard.full();
    guard.tick(&mut one, zero, f).expect("slow");
    guard.tick(&mut other, zero, f).expect("slow");
    let half = f.map(|x| Force(x.0 / 2));
    guard.commanded(&mut other, half);
    // A report of a longer force has no effect.
    let longer = f + f;
    let before = one;
    guard.commanded(&mut one, longer);
    assert_eq!(one, before);
    // A motion along the force: the hand gets energy out, less with the smaller force.
    let along = Vector(
        vector("0.01", "0.02", "0.02").map(|x| Position::<Fixed32>::from_si(x).expect("fits")),
    );
    guard
        .tick(&mut one, along, Vector::default())
        .expect("slow");
    guard
        .tick(&mut other, along, Vector::default())
        .expect("slow");
    assert!(other.account > one.account);
    // 3 N over 0.3 mm are 0.9 mJ, less 0.16 mJ of trusted damping: 2 N/mm times the square of 0.28 mm, which is the motion less
    // an encoder count in each coordinate. The tolerance covers the charge of half a count for the change of force.
    let spent = (guard.of_length.capacity - one.account)
        .to_si()
        .to_num::<f64>()
        * 10.0;
    assert!((spent - 0.9 + 0.16).abs() < 0.04, "{spent} mJ");
}
