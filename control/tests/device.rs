//! Tests [`Device`]: guard, estimator and limits follow from it, and an error of a value is safe on the side that its documentation
//! names. The tests sum the energy in floating point, independently of the guard.

use std::f64::consts::TAU;
use touchstone_control::law::Sample;
use touchstone_control::{
    Controller, Device, Fixed32, Force, GuardSettings, Guarded, LawKind, Number, OwnForce,
    Position, PositionSettings, Settings, SettingsError, Si, States, Stiffness,
};

const TICK_S: f64 = 1e-3;

/// A knob with 16,384 counts and half a tick of delay.
fn knob() -> Device {
    Device {
        rate_hz: 1_000,
        inertia: Si::lit("0.0001"),
        damping: Si::lit("0.0004"),
        position: PositionSettings::of_counts_per_rev(16_384),
        position_error: Si::ZERO, // rad
        force_limit: Si::lit("0.5"),
        delay: Si::lit("0.0005"),
        lag: Si::ZERO,
    }
}

fn position(rad: f64) -> Position<Fixed32> {
    Position::from_si(Si::from_num(rad)).expect("within 128 rad")
}

fn force(n_m: f64) -> Force<Fixed32> {
    Force::from_si(Si::from_num(n_m)).expect("within 128 N·m")
}

/// The true values of a device, which may differ from those in its description.
#[derive(Clone, Copy)]
struct Real {
    damping_n_m_s_per_rad: f64,
    count_rad: f64,
    delay_ticks: f64,
    /// Amplitude of the encoder's sinusoidal error, rad, and the number of its periods per turn.
    error: (f64, f64),
}

impl Real {
    /// A device that is as described.
    fn of(device: &Device) -> Self {
        Self {
            damping_n_m_s_per_rad: device.damping.to_num(),
            count_rad: device.position.count.to_num(),
            delay_ticks: device.delay.to_num::<f64>() / TICK_S,
            error: (0.0, 0.0),
        }
    }
}

/// Most energy, J, that a hand gets out of the device `real` in any window of time, beyond the refill. The guard is made for the
/// device description `told`.
///
/// `hand` gives the true position in each tick. `law` gives the force from the tick, the measured position and its change.
fn gets_j(
    told: &Device,
    real: Real,
    hand: impl Fn(u32) -> f64,
    law: impl Fn(u32, f64, f64) -> f64,
) -> f64 {
    let mut guard: Guarded<Fixed32> = told.guard().expect("valid");
    let refill_j = guard.guard.refill.to_si().to_num::<f64>();
    let measured = |rad: f64| {
        let (amplitude, periods) = real.error;
        let seen = rad + amplitude * (periods * rad).sin();
        (seen / real.count_rad).round() * real.count_rad
    };
    let mut before = hand(0);
    let (mut acts, mut acted) = (0.0, 0.0);
    let (mut window, mut best) = (0.0_f64, 0.0_f64);
    for tick in 0..20_000 {
        let now = hand(tick);
        let moved = now - before;
        // In the tick that ends now, the old force acted for the delay, then the new one.
        let work = (real.delay_ticks * acted + (1.0 - real.delay_ticks) * acts) * moved;
        let damped = real.damping_n_m_s_per_rad * moved * moved / TICK_S;
        window = (window - work - damped - refill_j).max(0.0);
        best = best.max(window);
        let (at, change) = (measured(now), measured(now) - measured(before));
        let wanted = force(law(tick, at, change).clamp(-0.5, 0.5));
        acted = acts;
        acts = guard.tick(position(at), None, wanted).to_si().to_num();
        before = now;
    }
    assert!(!guard.tripped);
    best
}

/// The bound: the account's capacity, plus the work of the largest force that a full account allows over half of the position's
/// uncertainty.
fn bound_j(device: &Device) -> f64 {
    let guard = device.guard::<Fixed32>().expect("valid").guard;
    let capacity_j = guard.capacity.to_si().to_num::<f64>();
    let largest_n_m = capacity_j * guard.per_reach.0.to_num::<f64>();
    capacity_j + largest_n_m * device.guarded_device().count.to_num::<f64>() / 2.0
}

/// Same as [`gets_j`], for a hand that swings as a sinusoid and a hostile law: a spring `k` and a damper `b`, which may be
/// negative.
fn swung_j(told: &Device, real: Real, amplitude_rad: f64, hz: f64, k: f64, b: f64) -> f64 {
    let hand = |tick: u32| amplitude_rad * (TAU * hz * f64::from(tick) * TICK_S).sin();
    gets_j(told, real, hand, |_, at, change| {
        k * at + b * change / TICK_S
    })
}

#[test]
fn less_damping_than_told_gives_energy_out_and_more_does_not() {
    let told = knob();
    let with = |share: f64| {
        let real = Real {
            damping_n_m_s_per_rad: 0.0004 * share,
            ..Real::of(&told)
        };
        swung_j(&told, real, 1.0, 4.0, 0.0, -0.0004)
    };
    for share in [0.8, 1.0, 2.0] {
        assert!(with(share) <= bound_j(&told), "{share}: {}", with(share));
    }
    assert!(with(0.4) > 2.0 * bound_j(&told), "{}", with(0.4));
}

#[test]
fn a_wrong_delay_gives_energy_out_on_either_side() {
    // Found by a search, for configured delays of a tick, half a tick and zero. The values are the configured delay in s, the real
    // one in ticks, the hand's amplitude and frequency, and the law's spring and damper.
    for (told_s, real_ticks, amplitude_rad, hz, k, b) in [
        ("0.001", 0.0, 0.195, 21.6, -1.45, -1.97e-3),
        ("0.0005", 0.0, 0.134, 17.2, -1.0, -1.09e-3),
        ("0", 0.5, 0.25, 8.0, 2.0, 5e-4),
    ] {
        let mut told = knob();
        told.delay = Si::from_str(told_s).expect("a number");
        let right = Real::of(&told);
        let wrong = Real {
            delay_ticks: real_ticks,
            ..right
        };
        let (as_told, otherwise) = (
            swung_j(&told, right, amplitude_rad, hz, k, b),
            swung_j(&told, wrong, amplitude_rad, hz, k, b),
        );
        let bound = bound_j(&told);
        println!(
            "told {told_s} s: {as_told} J; real {real_ticks} ticks: {otherwise} J of {bound} J"
        );
        assert!(as_told <= bound, "{told_s}: {as_told}");
        assert!(otherwise > 5.0 * bound, "{told_s}: {otherwise}");
    }
}

#[test]
fn fewer_counts_than_told_give_energy_out_and_more_do_not() {
    let mut told = knob();
    told.delay = Si::ZERO;
    let right = Real::of(&told);
    // The hand trembles over the edge of a count, and the law gives a force in one direction of the change only. The device hardly
    // moves, but the measured position changes by a count. Then the hand is pushed out, and comes back while the law gives no
    // force.
    let hand = |edge_rad: f64| {
        move |tick: u32| match tick % 1_000 {
            at @ 0..800 => edge_rad + f64::from(at % 2) * 1e-9,
            at @ 800..900 => edge_rad - 5e-4 * f64::from(at - 800),
            at => edge_rad - 5e-4 * f64::from(1_000 - at),
        }
    };
    let law = |tick: u32, _: f64, change: f64| match tick % 1_000 {
        // The force acts while the hand seems to move in.
        0..799 => {
            if change > 0.0 {
                0.0
            } else {
                0.3
            }
        }
        799..900 => 0.3,
        _ => 0.0,
    };
    let with = |real: Real| gets_j(&told, real, hand(0.5 * real.count_rad - 5e-10), law);
    let finer = Real {
        count_rad: right.count_rad / 4.0,
        ..right
    };
    let coarser = Real {
        count_rad: right.count_rad * 2.0,
        ..right
    };
    let bound = bound_j(&told);
    println!(
        "{} J as told, {} J finer, {} J coarser",
        with(right),
        with(finer),
        with(coarser)
    );
    assert!(with(right) <= bound && with(finer) <= bound);
    assert!(with(coarser) > 2.0 * bound, "{}", with(coarser));
}

#[test]
fn an_encoder_error_beyond_the_told_one_gives_energy_out() {
    let mut told = knob();
    told.delay = Si::ZERO;
    // At angles where the encoder shows less motion than there is, the law drives the hand; where the encoder shows more, the law
    // brakes the hand. `share` shifts the boundary between the two.
    let with = |told: &Device, error: (f64, f64), share: f64| {
        let real = Real {
            error,
            ..Real::of(told)
        };
        let hand = |tick: u32| (TAU * 0.5 * f64::from(tick) * TICK_S).sin();
        gets_j(told, real, hand, |_, at, change| {
            let drives = (error.1 * at).cos() < share;
            let along = change.signum() * f64::from(u8::from(change != 0.0));
            if drives { -0.5 * along } else { 0.5 * along }
        })
    };
    // Errors of a magnetic encoder: amplitude in degrees, and periods per turn.
    for (degrees, periods) in [
        (0.2_f64, 16.0),
        (0.4, 16.0),
        (0.1, 40.0),
        (0.8, 4.0),
        (1.0, 1.0),
    ] {
        let error = (degrees.to_radians(), periods);
        told.position_error = Si::ZERO;
        let most = |told: &Device| {
            let shares = (-9..10).map(|tenth| with(told, error, f64::from(tenth) / 10.0));
            shares.fold(0.0, f64::max)
        };
        let (untold, few) = (most(&told), bound_j(&told));
        told.position_error = Si::from_num(error.0) + Si::DELTA;
        let (as_told, bound) = (most(&told), bound_j(&told));
        println!(
            "{degrees} degrees, {periods} a turn: {as_told:.4} of {bound:.4} J as told, {untold:.4} of {few:.4} J untold"
        );
        assert!(as_told <= bound);
        // In 20 s, errors with few periods per turn do not yet give more than the bound.
        assert!(periods < 16.0 || untold > 1.5 * few);
    }
}

/// A pseudo-random number from -1 to 1.
fn random(state: &mut u64) -> f64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A force that depends on position and velocity and is not designed to be stable.
fn springy(now: Sample<Fixed32>) -> Force<Fixed32> {
    let k = Stiffness(Fixed32::gain(Si::lit("30")).expect("fits"));
    (k * now.e + k * now.moved + k * now.moved).towards_zero()
}

#[test]
fn an_own_force_is_estimator_limit_and_guard_bit_for_bit() {
    for delay in ["0", "0.0005", "0.001"] {
        let mut device = knob();
        device.delay = Si::from_str(delay).expect("a number");
        let mut own = device.own_force::<Fixed32>().expect("valid");
        let mut guard = device.guard::<Fixed32>().expect("valid");
        let mut states = device.states::<Fixed32>().expect("valid");
        let (mut state, mut at, mut last) = (7, 0.0, Force::zero());
        let (mut cut, mut reduced) = (0, 0);
        for tick in 0..20_000 {
            at = (at + 0.02 * random(&mut state)).clamp(-1.0, 1.0);
            let x = position(at);
            states.commanded(last);
            let wanted = springy(states.sample(x));
            cut += u32::from(wanted.modulus() > force(0.5));
            last = guard.tick(x, None, wanted.within(force(0.5)));
            assert_eq!(own.tick(x, springy), last, "{tick}");
            reduced += u32::from(guard.limited);
            if tick % 7 == 0 {
                last = last.within(force(0.1));
                own.commanded(last);
                guard.commanded(last);
            }
            if tick % 5_000 == 4_999 {
                let account = {
                    own.switched_off();
                    own.resume();
                    own.guard.account()
                };
                guard.switched_off();
                guard = device
                    .guard()
                    .map(|it: Guarded<_>| it.resumed(&guard))
                    .expect("valid");
                states = device.states().expect("valid");
                last = Force::zero();
                assert_eq!(account, guard.account());
                assert_eq!((own.guard, own.states), (guard, states));
            }
        }
        assert!(cut > 100 && reduced > 100, "{cut} {reduced}");
    }
}

#[test]
fn the_estimator_sees_a_velocity_that_two_counts_do_not() {
    for rate_hz in [1_000, 4_000, 20_000] {
        let mut device = knob();
        device.rate_hz = rate_hz;
        device.delay = Si::ZERO;
        let rate = f64::from(rate_hz);
        let count = device.position.count.to_num::<f64>();
        let mut states = device.states::<Fixed32>().expect("valid");
        let (mut told, mut differences, mut last) = (0.0, 0.0, 0.0);
        // A hand turns the knob at 0.3 rad/s.
        for tick in 0..rate_hz {
            let at = 0.3 / rate * f64::from(tick);
            let measured = (at / count).round() * count;
            let sample = states.sample(position(measured));
            let error = |moved: f64| (moved * rate - 0.3).powi(2);
            if tick > rate_hz / 2 {
                told += error(sample.moved.to_si().to_num());
                differences += error(measured - last);
            }
            last = measured;
        }
        let rms = |sum: f64| (2.0 * sum / rate).sqrt();
        let (told, differences) = (rms(told), rms(differences));
        println!("{rate_hz} Hz: {told} rad/s, by differences {differences} rad/s");
        assert!(
            told < 0.5 * differences && told < 0.1,
            "{rate_hz} Hz: {told}, {differences}"
        );
    }
}

#[test]
fn settings_become_no_less_cautious_than_the_device_and_no_more_than_they_were() {
    let device = knob();
    let bold = Settings {
        rate_hz: 2_000,
        force_limit: Si::lit("2"),
        position: PositionSettings { count: Si::ZERO },
        guard: GuardSettings {
            damping: Si::lit("0.001"),
            share_of_damping: Si::ONE,
            delay: Si::ZERO,
            lag: Si::ZERO,
            ..GuardSettings::default()
        },
        ..Settings::default()
    };
    let mut held = bold;
    device.hold(&mut held);
    assert_eq!(held.guard, device.guard_settings());
    assert_eq!(held.guarded_device(), device.guarded_device());
    // The law's other settings stay.
    let back = Settings {
        rate_hz: bold.rate_hz,
        force_limit: bold.force_limit,
        position: bold.position,
        guard: bold.guard,
        ..held
    };
    assert_eq!(back, bold);
    let mut cautious = Settings {
        force_limit: Si::lit("0.1"),
        position: PositionSettings::of_counts_per_rev(1_000),
        guard: GuardSettings {
            damping: Si::lit("0.0003"),
            share_of_damping: Si::ONE,
            delay: Si::lit("0.0006"),
            lag: Si::lit("0.0001"),
            ..GuardSettings::default()
        },
        ..Settings::default()
    };
    let mut expected = cautious;
    // A configured delay that is longer than the real one is not more cautious.
    (expected.guard.delay, expected.guard.lag) = (device.delay, device.lag);
    device.hold(&mut cautious);
    assert_eq!(cautious, expected);
}

#[test]
fn each_value_out_of_range_is_refused() {
    type Change = fn(&mut Device);
    let changes: [(&str, Change); 9] = [
        ("timing.rate_hz", |it| it.rate_hz = 0),
        ("timing.rate_hz", |it| it.rate_hz = 100_001),
        ("law.estimator.inertia_kg_m2", |it| it.inertia = Si::ZERO),
        ("law.guard.damping_n_m_s_per_rad", |it| {
            it.damping = -Si::DELTA
        }),
        ("law.guard.damping_n_m_s_per_rad", |it| {
            it.damping = Si::lit("1001")
        }),
        ("position", |it| it.position.count = Si::lit("0.11")),
        ("law.force_limit_n_m", |it| it.force_limit = Si::lit("129")),
        ("law.guard.delay_s", |it| it.delay = Si::lit("0.0011")),
        ("law.guard.lag_s", |it| it.lag = Si::lit("0.00051")),
    ];
    assert!(knob().own_force::<Fixed32>().is_ok());
    for (path, change) in changes {
        let mut device = knob();
        change(&mut device);
        let refused = device.own_force::<Fixed32>().expect_err(path);
        let text = refused.to_string();
        let is_named = match refused {
            SettingsError::TooCoarse { .. } => path == "position",
            _ => text.contains(path),
        };
        assert!(is_named, "{path}: {text}");
    }
    // Without any damping, no delay can be covered.
    let mut device = knob();
    device.damping = Si::ZERO;
    assert!(device.guard::<Fixed32>().is_err());
    device.delay = Si::ZERO;
    assert!(device.guard::<Fixed32>().is_ok());
    assert_eq!(device.damper::<Fixed32>(Si::MAX), None);
}

/// Checks that a spring as a user-defined force gives the same force as the law `spring` on the same device, up to the depth from which
/// on a wall's surface gives way.
#[test]
fn an_own_spring_is_the_shipped_spring_bit_for_bit() {
    let device = knob();
    let mut own: OwnForce<Fixed32> = device.own_force().expect("valid");
    let mut settings = Settings {
        law: LawKind::Spring,
        k_desired: Si::lit("5"),
        estimator: device.estimator_settings(),
        ..Settings::default()
    };
    settings.impact.momentum = Si::ZERO;
    settings.guard.damping = Si::lit("0.01");
    device.hold(&mut settings);
    let mut wall = Controller::<Fixed32>::new(&settings).expect("valid");
    assert!(matches!(wall.states, States::Estimated(..)));
    let spring = device.spring(Si::lit("5")).expect("fits");
    let (mut state, mut at, mut pushed) = (3, 0.05, 0);
    for tick in 0..20_000 {
        at = (at + 0.01 * random(&mut state)).clamp(-0.1, 0.12);
        let x = position(at);
        let force = own.tick(x, |now| {
            if now.e > Position::zero() {
                (spring * now.e).outward()
            } else {
                Force::zero()
            }
        });
        assert_eq!(force, wall.tick(x), "{tick}");
        pushed += u32::from(force > Force::zero());
    }
    assert!(pushed > 1_000, "{pushed}");
}
