//! Replacements of validation, of damping and inertia per tick, and of a guard, when the model checker runs: they accept anything
//! and return any value.

use crate::answers::{double, roots};
use crate::spec::Int;
use core::sync::atomic::{AtomicI64, AtomicUsize, Ordering::Relaxed};
use fixed::FixedI32;
use fixed::types::extra::U12;
use touchstone_control::validate::Derived;
use touchstone_control::{
    ChangeOfForce, Compliance, Energy, Guard, GuardSettings, GuardedDevice, Number, Position,
    Ratio, Settings, SettingsError, Si, Stiffness,
};

/// Replaces [`touchstone_control::Settings::validate`] when the model checker runs: it accepts all settings.
pub fn law_accepted(_: &Settings) -> Result<(), SettingsError> {
    Ok(())
}
static DERIVED: [AtomicI64; 6] = [const { AtomicI64::new(0) }; 6];
static IS_DERIVED: AtomicUsize = AtomicUsize::new(0);

/// The values that follow from several settings (such as damping per tick): any numbers that are not negative, the same ones at
/// each call.
fn following() -> [i64; 6] {
    if IS_DERIVED.load(Relaxed) == 0 {
        IS_DERIVED.store(1, Relaxed);
        for value in &DERIVED {
            let any: i64 = kani::any();
            kani::assume(any >= 0);
            value.store(any, Relaxed);
        }
    }
    core::array::from_fn(|i| DERIVED[i].load(Relaxed))
}
/// Replaces [`Settings::derived`] when the model checker runs the code: any values that are not negative, the same ones at each
/// call.
pub fn derived(_: &Settings) -> Derived {
    let [k_critical, inertia, filter, ground, device, damper] = following().map(Si::from_bits);
    Derived {
        k_critical,
        mass_per_tick2: inertia,
        filter_damping_per_tick: filter,
        ground_damping_per_tick: ground,
        device_damping_per_tick: device,
        virtual_damping_per_tick: damper,
    }
}
/// Replaces [`crate::spec::law_settings::derived`] when the model checker runs the specification: the values that the code gets.
pub fn specified_derived(
    _: &crate::spec::law_settings::Settings,
) -> crate::spec::law_settings::Derived {
    let [k_critical, inertia, filter, ground, device, damper] = following().map(Int::from);
    crate::spec::law_settings::Derived {
        critical: k_critical,
        inertia,
        filter_damping: filter,
        ground_damping: ground,
        device_damping: device,
        virtual_damping: damper,
    }
}
/// Replaces [`Settings::is_plain_spring`] when the model checker runs, for properties of a spring: always `true`.
pub fn plain(_: &Settings) -> bool {
    true
}
/// Replaces [`Settings::is_plain_spring`] when the model checker runs, for properties of other laws than a spring: always `false`.
pub fn not_plain(_: &Settings) -> bool {
    false
}
/// Replaces [`Number::root_of_four`] of the damping when the model checker runs: any result, and the same one for equal arguments.
pub fn root_of_four(k: FixedI32<U12>) -> FixedI32<U12> {
    FixedI32::from_bits(roots::ask(k.to_bits().into(), 0) as i32)
}
/// Replaces [`crate::spec::fba::Fba::bound_of`] when the model checker runs the specification: returns the value that the code got
/// for equal arguments.
pub fn specified_root_of_four(k: Int) -> Int {
    Int::from(roots::ask(double(k), 0) as i32)
}
/// Replaces [`GuardSettings::validate`] when the model checker runs: it accepts all settings.
pub fn guard_accepted(_: &GuardSettings, _: &GuardedDevice) -> Result<(), SettingsError> {
    Ok(())
}
/// Replaces [`Guard::new`] when the model checker runs. It refuses an odd control rate, and returns a guard that holds the leading
/// digits of each argument.
pub fn told<N: Number>(
    settings: &GuardSettings,
    device: &GuardedDevice,
) -> Result<Guard<N>, SettingsError> {
    let word = N::saturating_signal;
    let ratio = |value| N::ratio(value).unwrap_or_default();
    let energy = |value| Energy(N::energy(value).unwrap_or_default());
    let gain = |value| Stiffness(N::gain(value).unwrap_or_default());
    let measured = settings.change == ChangeOfForce::Measured;
    let guard = Guard {
        capacity: energy(settings.capacity),
        refill: energy(settings.refill),
        damping: gain(settings.damping),
        furthest: Position(word(settings.overspeed)),
        count: Position(word(device.count)),
        late: Ratio(ratio(settings.delay)),
        stray: Compliance(ratio(settings.lag)),
        slack: Position(word(device.count)),
        per_reach: gain(settings.share_of_damping),
        in_flight: Position(word(device.force_limit)),
        overrun: Compliance(ratio(if measured { Si::ONE } else { Si::ZERO })),
    };
    match device.rate_hz & 1 {
        0 => Ok(guard),
        _ => Err(SettingsError::TooCoarse {
            count: device.count,
            coarsest: Si::ZERO,
        }),
    }
}
