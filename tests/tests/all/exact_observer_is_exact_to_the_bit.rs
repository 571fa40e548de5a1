//! Tests that the energy observers of the fixed-point formats add up exact products. Over ten million control periods the 32-bit
//! observer equals a sum of the raw integers in 128 bits, bit for bit. At the ends of their range the observers saturate and do not
//! wrap.

use touchstone_control::observer::{ExactObserver, ThesisObserver};
use touchstone_control::{Energy, Fixed8, Fixed16, Fixed32, Force, Number, Position};
use touchstone_tests::random::Random;

type Signal32 = <Fixed32 as Number>::Signal;
type Signal16 = <Fixed16 as Number>::Signal;
type Signal8 = <Fixed8 as Number>::Signal;

/// Largest distance of the motion from the wall's surface, on both sides: 2 rad in steps of the 32-bit format (2^-24 rad).
const REACH: i32 = 2 << 24;
/// Largest displacement per control period: 1/64 rad (about 15 rad/s at 1 kHz) in steps of 2^-24 rad. With forces of up to 128 N·m
/// the energy sum then stays far inside its format.
const STEP: i32 = 1 << 18;

#[test]
fn over_ten_million_ticks_of_random_motion_and_force() {
    let mut random = Random::new(1);
    let mut exact = ExactObserver::<Fixed32>::new(Position::zero());
    let mut thesis = ThesisObserver::<Fixed32>::new(Position::zero());
    let (mut position, mut held) = (0_i32, 0_i32);
    let (mut exact_sum, mut thesis_sum) = (0_i128, 0_i128);
    let mut largest = 0_i128;
    for tick in 0..10_000_000_u32 {
        // Reflected at the ends of [`REACH`].
        let step = random.whole(STEP);
        let next = if (position + step).abs() > REACH {
            position - step
        } else {
            position + step
        };
        // Forces from the whole format, with its ends and zero.
        let force = match random.bits() % 16 {
            0 => i32::MIN,
            1 => i32::MAX,
            2 => 0,
            _ => random.bits() as i32,
        };
        let moved = i128::from(next) - i128::from(position);
        exact_sum += i128::from(held) * moved;
        thesis_sum += i128::from(force) * moved;
        largest = largest.max(exact_sum.abs()).max(thesis_sum.abs());
        (position, held) = (next, force);
        let e = Position(Signal32::from_bits(next));
        let f = Force(Signal32::from_bits(force));
        let seen = exact.tick(e, f).0.to_bits();
        assert_eq!(i128::from(seen), exact_sum, "exact observer, tick {tick}");
        let seen = thesis.tick(e, f).0.to_bits();
        assert_eq!(i128::from(seen), thesis_sum, "thesis observer, tick {tick}");
    }
    // Neither very small nor near saturation, so that the test compared sums and not limits.
    assert!(largest > 1 << 50 && largest < 1 << 62, "{largest:e}");
}

/// The test of the energy observer for a narrower number format. The sum leaves the format's range now and then; the expected sum
/// saturates as well.
macro_rules! narrow {
    ($name:ident, $format:ty, $signal:ty, $int:ty, $wide:ty) => {
        #[test]
        fn $name() {
            let mut random = Random::new(2);
            let mut exact = ExactObserver::<$format>::new(Position::zero());
            let (mut position, mut held) = (0 as $int, 0 as $int);
            let mut sum = 0_i128;
            let mut saturated = 0_u32;
            for tick in 0..1_000_000_u32 {
                // Any position after any other, if the displacement between them fits the format.
                let next = loop {
                    let next = random.bits() as $int;
                    if next.checked_sub(position).is_some() {
                        break next;
                    }
                };
                let force = random.bits() as $int;
                sum += i128::from(held) * (i128::from(next) - i128::from(position));
                let limited = sum.clamp(<$wide>::MIN.into(), <$wide>::MAX.into());
                saturated += u32::from(limited != sum);
                sum = limited;
                (position, held) = (next, force);
                let e = Position(<$signal>::from_bits(next));
                let seen = exact.tick(e, Force(<$signal>::from_bits(force)));
                assert_eq!(i128::from(seen.0.to_bits()), sum, "tick {tick}");
            }
            assert!(saturated > 0, "the ends of the range were never reached");
        }
    };
}

narrow!(sixteen_bits, Fixed16, Signal16, i16, i32);
narrow!(eight_bits, Fixed8, Signal8, i8, i16);

#[test]
fn at_the_ends_of_its_range_the_sum_stops_and_comes_back() {
    let at = |rad: f64| Position::<Fixed32>::from_f64(rad);
    for (push, end) in [(127.0, i64::MAX), (-127.0, i64::MIN)] {
        let force = Force::<Fixed32>::from_f64(push);
        let mut observer = ExactObserver::<Fixed32>::new(at(-60.0));
        // A displacement of 120 rad against 127 N·m, again and again, with the force on in one direction only: 15 kJ each time.
        let mut energy = Energy::zero();
        for _ in 0..10 {
            observer.tick(at(-60.0), force);
            energy = observer.tick(at(60.0), Force::zero());
        }
        assert_eq!(energy.0.to_bits(), end);
        // After one motion the other way, the sum has left the end by exactly that work.
        observer.tick(at(60.0), force);
        let work = (127_i64 << 24) * (120_i64 << 24);
        let back = observer.tick(at(-60.0), Force::zero()).0.to_bits();
        assert_eq!(back, if push > 0.0 { end - work } else { end + work });
    }
}
