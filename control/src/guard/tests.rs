use super::*;
use crate::{Field, Fixed16, Fixed32, SettingsError, Si, Warning};
use fixed::types::I8F24;

fn device() -> GuardedDevice {
    GuardedDevice {
        rate_hz: 1000,
        force_limit: Si::lit("0.3"),
        count: Si::lit("0.000157079633"),
    }
}
fn settings(delay: &str) -> GuardSettings {
    GuardSettings {
        capacity: Si::lit("0.02"),
        delay: Si::from_str(delay).unwrap(),
        ..GuardSettings::default()
    }
}
fn guard(delay: &str) -> Guard<Fixed32> {
    Guard::new(&settings(delay), &device()).unwrap()
}
fn position(quanta: i64) -> Position<Fixed32> {
    Position(I8F24::from_bits(i32::try_from(quanta).unwrap()))
}
fn force(quanta: i64) -> Force<Fixed32> {
    Force(I8F24::from_bits(i32::try_from(quanta).unwrap()))
}

/// A pseudo-random number generator: a linear congruential sequence with its high bits mixed into the low ones.
struct Random(u64);
impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0 ^ self.0 >> 31
    }
    /// A random integer in `-size..=size`.
    fn within(&mut self, size: i64) -> i64 {
        (self.next() >> 20) as i64 % (2 * size + 1) - size
    }
}

/// The true energy that the guard's account is compared with: the work of each force over its displacement, and what the trusted
/// damping dissipated. The value is an exact integer in units of 2^-48 J. The damping comes from the settings and not from the
/// guard's stored coefficient.
struct Truth {
    joules: i128,
}
const JOULE: i128 = 1 << 48;

impl Truth {
    /// Adds the work and the dissipation of one displacement, which lasts `thousandths`/1000 of a tick. The dissipation is
    /// rounded down.
    fn moved(&mut self, force: i64, moved: i64, thousandths: i128) {
        let (force, moved) = (i128::from(force), i128::from(moved));
        // The trusted damping per tick is 0.32 N·m/rad: 0.8 of 4e-4 N·m·s/rad, at 1 kHz.
        let damped = if thousandths == 0 {
            assert!(moved == 0);
            0
        } else {
            moved * moved * 320 / thousandths
        };
        self.joules += force * moved + damped;
    }
}

/// Checks that a hand never gets out more energy than was taken from the guard's energy account. The motions are random and
/// hostile.
///
/// The true position is anywhere within half an encoder count of the measured one. The force acts at once, or a tenth, a half or
/// a whole tick late.
#[test]
fn the_account_is_never_above_the_truth() {
    // The largest error of a measured position, half an encoder count, in steps of the position format.
    let half_count = (0.000_157_079_633 / 2.0 * f64::from(1 << 24)) as i64;
    for (delay, late) in [
        ("0", 0),
        ("0.0001", 100),
        ("0.0005", 500),
        ("0.001", 1000_i128),
    ] {
        let guard = guard(delay);
        let furthest = i64::from(guard.furthest.0.to_bits());
        let mut random = Random(late as u64 + 1);
        let mut lowest_free = i64::MAX;
        for round in 0..40_u64 {
            let mut state = guard.full();
            let mut truth = Truth {
                joules: i128::from(guard.capacity.0.to_bits()),
            };
            let (mut shown, mut before) = (0_i64, 0_i64);
            let (mut at, mut told) = (0_i64, 0_i64);
            for tick in 0..2_000_u64 {
                // The hand moves at random, or alternates between inward and outward motion at a nearly constant speed. The part
                // of the displacement before the force changes differs at random from the mean part.
                let speed = furthest >> (round % 6 * 2 + 1);
                let part = |thousandths: i128| (i128::from(furthest) * thousandths / 1000) as i64;
                let whole = if round % 2 == 0 {
                    random.within(speed)
                } else if (tick / (1 + round)) % 2 == 0 {
                    speed - random.within(2).abs()
                } else {
                    -speed + random.within(2).abs()
                };
                let stray = random.within(part(late * (1000 - late) / 1000) / 4);
                let early = ((i128::from(whole) * late / 1000) as i64 + stray)
                    .clamp(-part(late), part(late));
                let rest = (whole - early).clamp(-part(1000 - late), part(1000 - late));
                truth.moved(before, early, late);
                truth.moved(shown, rest, 1000 - late);
                truth.joules += i128::from(guard.refill.0.to_bits());
                at += early + rest;
                if at.abs() > 1 << 29 {
                    break;
                }
                // The position is measured with an error that the hand may choose.
                let error = if round % 3 == 0 {
                    random.within(half_count)
                } else {
                    (shown - before).signum() * half_count
                };
                let next_told = at + error;
                let moved = next_told - told;
                told = next_told;
                if moved.abs() > furthest {
                    break;
                }
                // The force that the law requests: random, rising with the position, or falling with it.
                let wanted = match round % 4 {
                    0 => random.within(1 << 23),
                    1 => told.clamp(0, 1 << 28) >> 1,
                    2 => -told >> 2,
                    _ => 4_000_000 + random.within(1 << 20),
                };
                let next = guard
                    .tick(
                        &mut state,
                        position(moved),
                        force(wanted.clamp(-(1 << 28), 1 << 28)),
                    )
                    .unwrap();
                // The account counts the force at the measured position, which is within half a count of the true one.
                let error_now = -i128::from(error) * i128::from(shown);
                let account = i128::from(state.account.0.to_bits());
                assert!(
                    account <= truth.joules - error_now,
                    "delay {delay}, round {round}, tick {tick}: {account} above {} - {error_now}",
                    truth.joules
                );
                assert!(account >= i128::from(guard.reserve(force(shown)).0.to_bits()));
                assert!(account <= i128::from(guard.capacity.0.to_bits()));
                assert!(truth.joules >= 0, "more than the capacity got out");
                assert!(next.modulus() <= force(wanted.clamp(-(1 << 28), 1 << 28)).modulus());
                // At the account's capacity, energy above the capacity is lost, so the true energy is set to the account as well.
                if state.account == guard.capacity {
                    truth.joules = account + error_now;
                }
                lowest_free = lowest_free.min(state.account.0.to_bits());
                before = shown;
                shown = i64::from(next.0.to_bits());
            }
        }
        assert!(
            i128::from(lowest_free) < JOULE / 1000,
            "delay {delay}: no hand emptied the account below {lowest_free}"
        );
    }
}

/// Checks the largest force for random energies in the account: the work of that force over the largest displacement is never
/// more than that energy, and no allowed force is wasted. There is no delay and no position error.
#[test]
fn every_displacement_up_to_overspeed_is_paid() {
    let exact = GuardedDevice {
        count: Si::ZERO,
        ..device()
    };
    let guard = Guard::<Fixed32>::new(&settings("0"), &exact).unwrap();
    let mut random = Random(7);
    for _ in 0..100_000 {
        let account = Energy(fixed::types::I16F48::from_bits(
            (random.next() >> 20 >> (random.next() % 44)) as i64 % guard.capacity.0.to_bits(),
        ));
        let force = guard.largest_force(account);
        let cost = force * guard.furthest;
        assert!(
            cost <= account,
            "{force:?} over {:?} costs {cost:?} of {account:?}",
            guard.furthest
        );
        // The guard allows nearly all the force that it could: a little more force (0.1 % and 64 steps) would cost more than the
        // account holds.
        let more = force + Force(I8F24::from_bits(force.0.to_bits() / 1000 + 64));
        assert!(more * (guard.furthest + guard.count + guard.count) > account);
    }
}

#[test]
fn the_force_is_never_larger_nor_turned_round() {
    let guard = guard("0.0005");
    let mut random = Random(3);
    let mut state = guard.full();
    let mut cut = 0;
    for _ in 0..100_000 {
        let wanted = force(random.within(1 << 24));
        let Ok(shown) = guard.tick(&mut state, position(random.within(1 << 19)), wanted) else {
            unreachable!("31 mrad are no overspeed")
        };
        assert!(shown.modulus() <= wanted.modulus());
        assert!(shown == Force::zero() || (shown < Force::zero()) == (wanted < Force::zero()));
        cut += i32::from(shown != wanted);
    }
    assert!(cut > 50_000);
}

#[test]
fn it_is_refilled_by_so_much_and_no_more() {
    let guard = guard("0");
    let mut state = guard.full();
    state.account = Energy::zero();
    for _ in 0..1000 {
        guard
            .tick(&mut state, Position::zero(), force(1 << 24))
            .unwrap();
    }
    // The refill of a second is half a millijoule; less of it is left, since changes of the allowed force are charged.
    let full = fixed::types::I16F48::lit("0.0005");
    assert!(state.account.0 <= full && state.account.0 > full * 99 / 100);
}

#[test]
fn overspeed_takes_the_force_off_and_costs_what_it_can_have_cost() {
    let guard = guard("0.0005");
    let mut state = guard.full();
    for tick in 1..=40 {
        guard
            .tick(&mut state, Position::zero(), force(tick << 16))
            .unwrap();
    }
    let before = state;
    assert_eq!(before.force, force(40 << 16));
    let far = guard.furthest + Position::quantum();
    for moved in [
        far,
        Position::zero() - far,
        Position(I8F24::MIN),
        Position(I8F24::MAX),
    ] {
        state = before;
        assert_eq!(
            guard.tick(&mut state, moved, force(1 << 22)),
            Err(Overspeed)
        );
        assert_eq!(state.force, Force::zero());
        // For 0.156 N·m overspeed costs f² (1 + s)/4c = 29 mJ, more than the account held: a deficit.
        let lost = (before.account - state.account).0.to_num::<f64>();
        assert!(
            (lost - 0.15625 * 0.15625 * 1.5 / (4.0 * 0.32)).abs() < 1e-4,
            "{lost}"
        );
        // No force is allowed until the deficit is made up, and without a force another overspeed costs nothing.
        assert_eq!(guard.tick(&mut state, far, force(1 << 22)), Err(Overspeed));
        let deficit = state.account;
        assert_eq!(
            guard.tick(&mut state, Position::zero(), force(1 << 22)),
            Ok(Force::zero())
        );
        assert_eq!(state.account - deficit, guard.refill);
        for _ in 0..200_000 {
            guard
                .tick(&mut state, Position::zero(), force(1 << 22))
                .unwrap();
        }
        assert!(state.force > Force::zero());
    }
    // Without a force overspeed costs nothing.
    let mut state = guard.full();
    assert_eq!(guard.tick(&mut state, far, Force::zero()), Err(Overspeed));
    assert_eq!(state.account, guard.capacity);
}

#[test]
fn what_was_commanded_in_the_end_is_what_is_booked() {
    let guard = guard("0");
    let mut told = guard.full();
    let mut untold = guard.full();
    for state in [&mut told, &mut untold] {
        state.account = Energy(fixed::types::I16F48::lit("0.01"));
        guard.tick(state, Position::zero(), force(1 << 20)).unwrap();
    }
    guard.commanded(&mut told, force(1 << 19));
    assert_eq!(told.force, force(1 << 19));
    let (a, b) = (told.account, untold.account);
    guard
        .tick(&mut told, position(1 << 14), Force::zero())
        .unwrap();
    guard
        .tick(&mut untold, position(1 << 14), Force::zero())
        .unwrap();
    // Half the force does half the work, and less is charged for its change.
    let (half, full) = ((told.account - a).0, (untold.account - b).0);
    assert!(
        half > full * 49 / 100 && half < full * 53 / 100,
        "{half} of {full}"
    );
    // A reported force larger than the allowed one is limited to the allowed one.
    guard.commanded(&mut told, force(1 << 23));
    assert_eq!(told.force, Force::zero());
}

#[test]
fn settings_are_validated_from_both_sides() {
    type Change = fn(&mut GuardSettings, &mut GuardedDevice);
    let refused: [(Field, Change); 12] = [
        (Field::RateHz, |_, d| d.rate_hz = 0),
        (Field::RateHz, |_, d| d.rate_hz = 100_001),
        (Field::GuardDamping, |s, _| s.damping = -Si::DELTA),
        (Field::ForceLimit, |_, d| d.force_limit = -Si::DELTA),
        (Field::GuardCapacity, |s, _| s.capacity = Si::lit("16.1")),
        (Field::GuardCapacity, |s, _| s.capacity = -Si::DELTA),
        (Field::GuardRefill, |s, _| s.refill = Si::lit("1.1")),
        (Field::GuardShare, |s, _| {
            s.share_of_damping = Si::lit("1.1")
        }),
        (Field::GuardOverspeed, |s, _| s.overspeed = Si::ZERO),
        (Field::GuardDelay, |s, _| s.delay = Si::lit("0.0011")),
        (Field::GuardLag, |s, _| {
            s.delay = Si::lit("0.0006");
            s.lag = Si::lit("0.0005");
        }),
        (Field::ForceLimit, |_, d| d.force_limit = Si::lit("129")),
    ];
    for (field, change) in refused {
        let (mut s, mut d) = (settings("0"), device());
        change(&mut s, &mut d);
        let error = Guard::<Fixed32>::new(&s, &d).unwrap_err();
        let (SettingsError::OutOfRange { field: named, .. }
        | SettingsError::OutOfFormat { field: named, .. }) = error
        else {
            panic!("{error}")
        };
        assert_eq!(named, field);
    }
    let coarse = GuardedDevice {
        count: Si::lit("0.2"),
        ..device()
    };
    assert!(matches!(
        Guard::<Fixed32>::new(&settings("0"), &coarse),
        Err(SettingsError::TooCoarse { .. })
    ));
    for delay in ["0", "0.0001", "0.0005", "0.001"] {
        assert!(Guard::<Fixed32>::new(&settings(delay), &device()).is_ok());
        assert!(Guard::<Fixed16>::new(&settings(delay), &device()).is_ok());
    }
    // Without damping and without delay the guard works. With a delay and no damping, nothing bounds the motion between two
    // samples.
    let undamped = GuardSettings {
        share_of_damping: Si::ZERO,
        ..settings("0")
    };
    assert!(Guard::<Fixed32>::new(&undamped, &device()).is_ok());
    let late = GuardSettings {
        delay: Si::lit("0.0005"),
        ..undamped
    };
    assert!(Guard::<Fixed32>::new(&late, &device()).is_err());
}

/// Checks at every control rate that the guard accepts a delay and lag of together one tick, and refuses a longer delay. The value
/// of a tick is rounded up at some rates and down at others.
#[test]
fn a_delay_of_a_whole_tick_is_taken_at_every_rate_and_a_longer_one_at_none() {
    let rates = (1..=200)
        .map(|i| 50 * i)
        .chain([7, 333, 1201, 44_100, 100_000]);
    for rate_hz in rates {
        let d = GuardedDevice {
            rate_hz,
            ..device()
        };
        let tick = 1.0 / f64::from(rate_hz);
        for (delay, lag) in [(1.0, 0.0), (0.0, 1.0), (0.25, 0.75), (0.7, 0.3)] {
            for change in [ChangeOfForce::Estimated, ChangeOfForce::Measured] {
                let s = GuardSettings {
                    delay: Si::from_num(delay * tick),
                    lag: Si::from_num(lag * tick),
                    change,
                    // At 7 Hz a tick is so long that the default overspeed gives too large a displacement.
                    overspeed: Si::from_num(0.01 / tick).min(Si::ONE),
                    ..settings("0")
                };
                let made = Guard::<Fixed32>::new(&s, &d);
                assert!(made.is_ok(), "{rate_hz} Hz, {delay} and {lag}: {made:?}");
            }
        }
        let longer = GuardSettings {
            delay: Si::from_num(tick) + Si::DELTA + Si::DELTA,
            ..settings("0")
        };
        let field = match Guard::<Fixed32>::new(&longer, &d) {
            Err(SettingsError::OutOfRange { field, .. }) => field,
            other => panic!("{rate_hz} Hz: {other:?}"),
        };
        assert!(
            matches!(field, Field::GuardDelay),
            "{rate_hz} Hz: {field:?}"
        );
    }
}

#[test]
fn warnings_name_what_is_given_away() {
    let quiet = GuardSettings {
        capacity: Si::lit("0.02"),
        ..settings("0")
    };
    let d = device();
    assert_eq!(quiet.warnings(&d), [None, None]);
    // With a delay of a tick the account needs twice the energy.
    assert!(matches!(
        settings("0.001").warnings(&d),
        [Some(Warning::GuardSoftensAtForceLimit { .. }), None]
    ));
    let dry = GuardSettings {
        refill: Si::ZERO,
        ..quiet
    };
    assert_eq!(dry.warnings(&d), [None, Some(Warning::GuardNeverRefilled)]);
    // With the capacity that the warning gives, a full account allows the force limit.
    for delay in ["0", "0.0005", "0.001"] {
        let Some(Warning::GuardSoftensAtForceLimit { needed, .. }) = (GuardSettings {
            capacity: Si::ZERO,
            ..settings(delay)
        })
        .warnings(&d)[0] else {
            panic!("a capacity of 0 covers nothing")
        };
        let enough = GuardSettings {
            capacity: needed + Si::lit("0.00001"),
            ..settings(delay)
        };
        assert_eq!(enough.warnings(&d)[0], None);
        let guard = Guard::<Fixed32>::new(&enough, &d).unwrap();
        let mut state = guard.full();
        let limit = 0.3_f64.mul_add(f64::from(1 << 24), 0.0) as i64;
        // The force limit is reached within 20 ticks, and held.
        for tick in 0..50 {
            let ramp = force(limit / 20 * (tick + 1).min(20));
            let shown = guard.tick(&mut state, Position::zero(), ramp).unwrap();
            assert!(
                tick < 40 || shown == ramp,
                "delay {delay}: {shown:?} of {ramp:?}"
            );
            state.account = state.account.max(guard.capacity);
        }
    }
}
