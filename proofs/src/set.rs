//! P11 (refinement): the coefficients of guard and estimator follow from settings as their specification says, at 32 bits.
//!
//! `V` is how far a device with a displacement of 1 per tick moves in a time, `X` how far an acceleration of 1 per tick² moves it.
//!
//! ```text
//! Guard::new(settings, device) = spec(settings, device)              p11_guard_validated32, p11_guard_settings32
//! its warnings                                                       p11_guard_warned64
//! settings.estimator(rate, limit) = spec(settings, rate, limit)      p11_estimator_validated32, p11_estimator_settings32
//! its predictions, of any device                                     p11_flow_tick32, p11_flow_ahead32
//! its correction, of any device and angle                            p11_correction32
//! V, X of two devices                                                p11_integrals64
//! ```

use crate::source::Source;
use crate::spec::{Int, estimator_settings as estimator, guard_settings as guard};
use crate::{
    assume, cover, estimated, flow_property, property, reckoned, reckoned_property, specified,
    timed_property, validated_property,
};
use touchstone_control::estimator::{DeviceInTicks, ratio_of_bits};
use touchstone_control::number::Exact;
use touchstone_control::{
    ChangeOfForce, EstimatorSettings, Fixed32, Guard, GuardSettings, GuardedDevice, Si,
};

type N = Fixed32;

/// Any number as a setting; in random tests mostly from 0 to `most`.
pub fn setting<S: Source>(s: &mut S, most: i64) -> Si {
    let bits = s.i64();
    Si::from_bits(if s.shortcut() {
        (bits & i64::MAX) % (most + 1)
    } else {
        bits
    })
}

/// A setting as an integer, in units of 2^-32.
#[must_use]
pub fn bits(x: Si) -> Int {
    x.to_bits().into()
}

/// Any settings of the guard for any device; in random tests often ones that are accepted.
pub fn any_guard_settings<S: Source>(s: &mut S) -> (GuardSettings, GuardedDevice) {
    const ONE: i64 = 1 << 32;
    let rate_hz = s.u32();
    // For random tests only: the checker need not follow a division.
    let (rate_hz, tick) = if s.shortcut() {
        let rate_hz = 1 + rate_hz % 10_000;
        (rate_hz, ONE / i64::from(rate_hz))
    } else {
        (rate_hz, 0)
    };
    let settings = GuardSettings {
        on: true,
        capacity: setting(s, 2 * ONE),
        refill: setting(s, ONE),
        share_of_damping: setting(s, ONE),
        damping: setting(s, ONE),
        overspeed: setting(s, 100 * ONE),
        delay: setting(s, tick / 2),
        lag: setting(s, tick / 2),
        change: if s.bool() {
            ChangeOfForce::Measured
        } else {
            ChangeOfForce::Estimated
        },
    };
    let device = GuardedDevice {
        rate_hz,
        force_limit: setting(s, 100 * ONE),
        count: setting(s, ONE / 100),
    };
    (settings, device)
}

/// Converts a user's guard settings and device to the specification's type.
#[must_use]
pub fn specified_settings(
    settings: &GuardSettings,
    device: &GuardedDevice,
) -> (guard::Settings, guard::Told) {
    (
        guard::Settings {
            capacity: bits(settings.capacity),
            refill: bits(settings.refill),
            share: bits(settings.share_of_damping),
            damping: bits(settings.damping),
            overspeed: bits(settings.overspeed),
            delay: bits(settings.delay),
            lag: bits(settings.lag),
            measured: settings.change == ChangeOfForce::Measured,
        },
        guard::Told {
            rate: device.rate_hz.into(),
            limit: bits(device.force_limit),
            count: bits(device.count),
        },
    )
}

reckoned_property! {
    /// P11 (refinement): validation of the guard's settings accepts exactly the settings that the specification accepts.
    equation "accepted = spec(settings, device)"
    over "settings of the guard, rate, force limit, count"
    by minisat fn p11_guard_validated32(s) {
        let (settings, device) = any_guard_settings(s);
        let accepted = settings.validate(&device).is_ok();
        reckoned::of_specification();
        let (set, told) = specified_settings(&settings, &device);
        assert!(accepted == guard::in_ranges(&set, &told));
        cover!(s, accepted && settings.lag > Si::ZERO, "accepted");
        cover!(s, !accepted, "refused");
    }
}
reckoned_property! {
    /// P11 (refinement): the warnings for the guard's settings equal the specification's.
    equation "needed > capacity, refill = 0; needed = f D (1 + late) + f δ/2"
    over "settings of the guard in their ranges, rate, force limit, count"
    by minisat fn p11_guard_warned64(s) {
        let (settings, device) = any_guard_settings(s);
        let (set, told) = specified_settings(&settings, &device);
        assume!(s, guard::in_ranges(&set, &told), "GuardSettings::validate");
        let found = settings.warnings(&device).map(|warning| warning.is_some());
        reckoned::of_specification();
        assert!(found == guard::warned(&set, &told));
        cover!(s, found == [true, false], "softens");
        cover!(s, found == [false, true], "never refilled");
    }
}
validated_property! {
    /// P11 (refinement): for accepted settings, the guard that `Guard::new` makes, or its refusal, equals the specification's.
    equation "Guard::new(settings, device) = spec(settings, device)"
    over "settings of the guard, rate, force limit, count"
    by minisat fn p11_guard_settings32(s) {
        let (settings, device) = any_guard_settings(s);
        let found = Guard::<N>::new(&settings, &device).ok();
        reckoned::of_specification();
        let (set, told) = specified_settings(&settings, &device);
        assume!(s, guard::in_ranges(&set, &told), "case; the other is p11_guard_validated32");
        let expected = guard::made(&set, &told);
        assert!(found.as_ref().map(specified::at32::guard) == expected);
        cover!(s, found.is_some(), "made");
        cover!(s, found.is_none(), "refused");
    }
}
fn any_device<S: Source>(s: &mut S) -> (DeviceInTicks, estimator::Device) {
    let mut long = |most: Int| {
        let bits = s.i64();
        Exact::from_bits(if s.shortcut() {
            (bits & i64::MAX) % (most as i64 + 1)
        } else {
            bits
        })
    };
    let device = DeviceInTicks {
        loss: long(estimator::LONG_ONE * 5 / 4),
        per_torque: long(estimator::LONG_ONE / 2),
        delay: long(2 * estimator::LONG_ONE),
    };
    let bits = |x: Exact| Int::from(x.to_bits());
    let specified = estimator::Device {
        loss: bits(device.loss),
        per_torque: bits(device.per_torque),
        delay: bits(device.delay),
    };
    (device, specified)
}

timed_property! {
    /// P11 (refinement): the coefficients that predict a device's motion over a tick equal the specification's. Both refuse the
    /// same devices, whose coefficients do not fit words.
    equation "V, X, β V, q (X(s) - X(r)), q (V(s) - V(r)) of a tick"
    over "loss, q, delay"
    by minisat fn p11_flow_tick32(s) {
        let (device, specified) = any_device(s);
        let found = device.tick::<N>();
        reckoned::of_specification();
        let expected = estimator::over_a_tick(&specified);
        assert!(found.as_ref().map(estimated::flow) == expected);
        cover!(s, found.is_some_and(|flow| flow.commands[1][0] > 0), "two commands");
        cover!(s, expected.is_none(), "refused");
    }
}
timed_property! {
    /// P11 (refinement): the coefficients that predict a device's motion from a sample to the next command's start equal the
    /// specification's. Both refuse the same devices, whose coefficients do not fit words.
    equation "V, X, β V, q (X(s) - X(r)), q (V(s) - V(r)) of the delay"
    over "loss, q, delay"
    by minisat fn p11_flow_ahead32(s) {
        let (device, specified) = any_device(s);
        let found = device.ahead::<N>();
        reckoned::of_specification();
        let expected = estimator::ahead(&specified);
        assert!(found.as_ref().map(estimated::flow) == expected);
        cover!(s, found.is_some_and(|flow| flow.commands[1][0] > 0), "two commands");
        cover!(s, expected.is_none(), "refused");
    }
}
timed_property! {
    /// P11 (refinement): the estimator's correction gains equal the specification's. Both refuse the same devices, whose gains do
    /// not fit words.
    equation "α = 1 - z³/ρ, V γ = (1 - z)³, V β = 2 + ρ - 3z - α - X γ"
    over "loss, angle of the poles"
    by minisat fn p11_correction32(s) {
        let (device, specified) = any_device(s);
        let angle = s.i64();
        let angle = if s.shortcut() { angle.rem_euclid(estimator::LONG_ONE as i64 * 5 / 4) } else { angle };
        let found = device.correction::<N>(Exact::from_bits(angle));
        reckoned::of_specification();
        let expected = specified.correction(angle.into());
        assert!(found.map(|words| words.map(Int::from)) == expected);
        cover!(s, found.is_some_and(|words| words[2] > 0), "a push");
        cover!(s, expected.is_none(), "refused");
    }
}
/// Any settings of the estimator and a control rate in Hz; in random tests many of them are valid.
fn any_estimator_settings<S: Source>(s: &mut S) -> (EstimatorSettings, u32) {
    const ONE: i64 = 1 << 32;
    let rate = s.u32();
    let (rate, tick) = if s.shortcut() {
        let rate = 1 + rate % 10_000;
        (rate, ONE / i64::from(rate))
    } else {
        (rate, 0)
    };
    let settings = EstimatorSettings {
        bandwidth_hz: setting(s, i64::from(rate >> 3) << 32),
        inertia: setting(s, ONE / 100),
        damping: setting(s, ONE / 100),
        delay_s: setting(s, 3 * tick),
    };
    (settings, rate)
}
/// Converts a user's estimator settings to the specification's type.
fn specified_estimator(settings: &EstimatorSettings) -> estimator::Settings {
    estimator::Settings {
        bandwidth: bits(settings.bandwidth_hz),
        inertia: bits(settings.inertia),
        damping: bits(settings.damping),
        delay: bits(settings.delay_s),
    }
}

reckoned_property! {
    /// P11 (refinement): validation of the estimator's settings accepts exactly the settings that the specification accepts.
    equation "accepted = spec(settings, rate, limit)"
    over "settings of the estimator, rate, force limit"
    by minisat fn p11_estimator_validated32(s) {
        let (settings, rate) = any_estimator_settings(s);
        let limit = setting(s, 200 << 32);
        assume!(s, limit >= Si::ZERO, "Settings::validate");
        let accepted = settings.validate(rate, limit).is_ok();
        reckoned::of_specification();
        assert!(accepted == estimator::in_ranges(&specified_estimator(&settings), rate.into(), bits(limit)));
        cover!(s, accepted && settings.damping > Si::ZERO, "accepted");
        cover!(s, !accepted, "refused");
    }
}
property! {
    /// P8 (settings): a ratio of the estimator's settings is rounded down to its last digit, and limited to the largest number.
    /// This holds for any numerator with the denominator 1.
    equation "r = floor(a 2^56 / b), or highest"
    over "number not negative, to a setting of one"
    by kissat fn p8_ratio64(s) {
        let of = s.i64() & i64::MAX;
        let ratio = ratio_of_bits(of, 1 << 32).to_bits();
        assert!(ratio == of.saturating_mul(1 << 24));
        cover!(s, ratio > 1 && ratio < i64::MAX, "a number");
        cover!(s, ratio == i64::MAX, "the largest");
    }
}
flow_property! {
    /// P11 (refinement): for accepted settings the estimator, or its refusal, equals the specification's. In an accepted estimator
    /// no sum can overflow.
    equation "settings.estimator(rate, limit) = spec(settings, rate, limit)"
    over "settings of the estimator, rate, force limit"
    by minisat fn p11_estimator_settings32(s) {
        let (settings, rate) = any_estimator_settings(s);
        let limit = setting(s, 200 << 32);
        assume!(s, limit >= Si::ZERO, "Settings::validate");
        let accepted = settings.validate(rate, limit).is_ok();
        let found = settings.estimator::<N>(rate, limit).ok();
        reckoned::of_specification();
        let set = specified_estimator(&settings);
        let expected = if accepted { estimator::made(&set, rate.into(), bits(limit)) } else { None };
        assert!(found.as_ref().map(estimated::specified) == expected);
        cover!(s, found.is_some(), "made");
        cover!(s, found.is_none() && accepted, "accepted, and not made");
    }
}
property! {
    /// P11 (refinement): how far a device moves in a time by its displacement per tick (`V`) and by a push (`X`) equals the
    /// specification's sums to the last digit. Proved for two devices, each with one time.
    equation "V = Σ (-β)^k t^(k+1)/(k+1)!, X = Σ (-β)^k t^(k+2)/(k+2)!"
    over "loss 5/4 over one tick, 1/8 over two"
    by minisat fn p11_integrals64(s) {
        let one = estimator::LONG_ONE;
        for (loss, time) in [(one / 8, 2 * one), (one * 5 / 4, one)] {
            let long = |x: Int| Exact::from_bits(x as i64);
            let device = DeviceInTicks { loss: long(loss), per_torque: Exact::ZERO, delay: Exact::ZERO };
            let (reach, drift) = device.integrals(long(time));
            assert!((Int::from(reach.to_bits()), Int::from(drift.to_bits())) == estimator::integrals(loss, time));
            cover!(s, reach < long(time) && drift > Exact::ZERO, "damped");
        }
    }
}
