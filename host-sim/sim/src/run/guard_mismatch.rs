//! Warnings if the energy guard is configured for another device than the scene's. Its energy bound does not hold then.

use crate::error::Error;
use crate::scene::Scene;
use std::f64::consts::TAU;
use touchstone_control::ChangeOfForce;

/// The warnings of a scene with an energy guard.
pub(super) fn warnings(scene: &Scene) -> impl Iterator<Item = Error> {
    let late = match scene.law.guard.change {
        ChangeOfForce::Estimated => delay(scene),
        ChangeOfForce::Measured => latest_change(scene),
    };
    let all = [encoder(scene), damping(scene), late, spread(scene)];
    let is_on = scene.law.guard.on;
    all.into_iter().flatten().filter(move |_| is_on)
}

/// Factor from the rms of a sensor's noise to the error that counts as its largest. One reading in 16,000 has a larger error.
///
/// The energy guard charges the configured error for each change of force, so a hand gains only by readings with a larger error.
/// Suppose a law that knows the noise and changes its force only at such readings. The hand's mean gain per control period is
/// the change of force times `2 (φ(4) - 4 Q(4)) = 1.4e-5` times the rms (`φ`, `Q`: density and tail of the normal distribution).
/// With the default noise of 0.52 mrad, changes of 0.6 N·m and 1 kHz, the gain is 4.5 µW: 1 % of the guard's refill power. With a
/// factor of 3 the gain would be half of that power.
const NOISE_LARGEST: f64 = 4.0;

/// A warning if the energy guard is configured for a smaller sensor error than the scene's sensor has.
fn encoder(scene: &Scene) -> Option<Error> {
    let periodic = scene.sensor.periodic.as_ref();
    let periodic = periodic.map_or(0.0, |it| it.amplitude_rad + it.second_amplitude_rad);
    let noise = scene.sensor.noise.as_ref();
    let noise = noise.map_or(0.0, |it| NOISE_LARGEST * it.rms_rad);
    let largest = periodic + noise;
    let told = scene.law.position_error_rad;
    (told < largest).then(|| {
        let by_noise = match noise > 0.0 {
            true => format!(", {NOISE_LARGEST} times the rms of its noise included"),
            false => String::new(),
        };
        // Rounded up to 0.1 mrad, so that the advised value covers the error.
        let enough = (1e4 * largest).ceil() / 1e4;
        scene.error(
            "law.position_error_rad",
            format!(
                "the energy guard is configured for an encoder error of {told} rad, but the sensor's error reaches {enough:.4} rad{by_noise}: a hand may get out more energy than the guard's bound"
            ),
            format!("give {enough:.4} or more"),
        )
    })
}

/// A warning if the energy guard relies on more damping than the scene's device has.
fn damping(scene: &Scene) -> Option<Error> {
    let guard = &scene.law.guard;
    let relied = guard.damping_n_m_s_per_rad * guard.share_of_damping;
    let device = scene.device.damping_n_m_s_per_rad;
    (relied > device).then(|| {
        scene.error(
            "law.guard.damping_n_m_s_per_rad",
            format!(
                "the energy guard relies on {relied} N·m·s/rad of damping, and the device has {device}: a hand may get out more energy than the guard's bound"
            ),
            format!("give {device} or less"),
        )
    })
}

/// Rounding of a delay to the number format of the settings, s.
const ROUNDING_S: f64 = 1e-9;

/// A warning if the force can change later after the sample than the energy guard is configured for, although the position at the
/// change is measured.
///
/// The measured position tells how far the device moved under the old force. But the guard has to keep energy for that motion before
/// it happens: the old force times the largest displacement in the configured delay (`Guard::reserve`). A shorter delay than the
/// configured one only makes that reserve larger than needed.
fn latest_change(scene: &Scene) -> Option<Error> {
    let timing = &scene.timing;
    let latest = timing.computational_delay_s + timing.latency_spread_s.unwrap_or(0.0);
    let told = scene.law.guard.delay_s;
    let is_beyond = latest > timing.period_s() + ROUNDING_S;
    (is_beyond || told < latest - ROUNDING_S).then(|| {
        // Rounded to a nanosecond: the sum of two floating-point numbers can have digits that neither has.
        let latest: f64 = format!("{latest:.9}").parse().unwrap_or(latest);
        let fix = match is_beyond {
            true => "the guard covers at most one control period: give a shorter timing.computational_delay_s or timing.latency_spread_s".to_owned(),
            false => format!("give {latest}"),
        };
        scene.error(
            "law.guard.delay_s",
            format!(
                "the energy guard is configured for a force that changes at most {told} s after the sample, and here it changes up to {latest} s after it: a hand may get out more energy than the guard's bound"
            ),
            fix,
        )
    })
}

/// A warning if the energy guard, which estimates the position at the change of force, is configured for another delay than the
/// scene's. It may be configured with the lag of the current loop or without it.
fn delay(scene: &Scene) -> Option<Error> {
    let guard = &scene.law.guard;
    let told = guard.delay_s + guard.lag_s;
    let delay = scene.timing.computational_delay_s;
    let lag = scene.device.current_loop.as_ref();
    let lag = lag.map_or(0.0, |current| 1.0 / (TAU * current.bandwidth_hz));
    let is_true = (delay - ROUNDING_S..=delay + lag + ROUNDING_S).contains(&told);
    (!is_true).then(|| {
        let fix = if delay <= scene.timing.period_s() {
            format!("give {delay}")
        } else {
            "the guard covers at most one control period: give a shorter timing.computational_delay_s".to_owned()
        };
        scene.error(
            "law.guard.delay_s",
            format!(
                "the energy guard is configured for a force that acts {told} s after the sample, and here it acts after {delay} s: a hand may get out more energy than the guard's bound"
            ),
            fix,
        )
    })
}

/// A warning if the delay of the force varies. The energy guard counts on the same delay in each control period, except if it gets
/// the position measured when the force changes. Jitter shifts sample and force together, so it does not change the delay.
fn spread(scene: &Scene) -> Option<Error> {
    let spread = scene.timing.latency_spread_s.unwrap_or(0.0);
    let is_covered = scene.law.guard.change == ChangeOfForce::Measured;
    (spread > 0.0 && !is_covered).then(|| {
        scene.error(
            "timing.latency_spread_s",
            format!(
                "the energy guard is configured for a delay that stays the same, and here it varies by up to {spread} s: a hand may get out more energy than the guard's bound"
            ),
            "give 0, or let the guard know the position when the force changes: law.guard.change = \"measured\"",
        )
    })
}
