//! Tests of the curve through samples: smooth motion loses no more than the low-pass takes, and the curve never rings.

use std::f64::consts::TAU;

use super::super::resample::{Curve, SMOOTHING_HZ};

/// A hand's motion below 5 Hz, rad, at the time `t` in s.
fn hand(t: f64) -> f64 {
    0.2 * (TAU * 1.3 * t).sin() + 0.05 * (TAU * 3.1 * t + 0.4).sin()
}

/// Sample times in s whose intervals vary around 5 ms.
fn uneven(count: usize) -> Vec<f64> {
    (0..count)
        .map(|i| 0.005 * i as f64 + if i % 3 == 1 { 0.0015 } else { 0.0 })
        .collect()
}

fn worst(curve: &Curve, truth: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let count = 20_000;
    let times = (0..=count).map(|i| from + (to - from) * f64::from(i) / f64::from(count));
    times
        .map(|t| (curve.at(t) - truth(t)).abs())
        .fold(0.0, f64::max)
}

#[test]
fn a_smooth_motion_comes_back_within_the_known_loss_of_the_low_pass() {
    let even: Vec<f64> = (0..=600).map(|i| 0.005 * f64::from(i)).collect();
    for times in [even, uneven(601)] {
        let values: Vec<f64> = times.iter().map(|t| hand(*t)).collect();
        let curve = Curve::smooth(&times, &values);
        // A sine of frequency f loses 1 - exp(-ln 2 / 2 · (f/20)²): 0.15 % of 0.2 rad and 0.83 % of 0.05 rad.
        let loss = |f: f64| 1.0 - (-0.5 * 2.0_f64.ln() * (f / SMOOTHING_HZ).powi(2)).exp();
        let low_pass = 0.2 * loss(1.3) + 0.05 * loss(3.1);
        // The monotone cubic flattens turning points by at most an eighth of acceleration times interval².
        let cubic = 0.125
            * (0.2 * (TAU * 1.3_f64).powi(2) + 0.05 * (TAU * 3.1_f64).powi(2))
            * 0.0065
            * 0.0065;
        // Only away from the ends, beyond which the curve is constant.
        let error = worst(&curve, hand, 0.1, 2.9);
        assert!(error < low_pass + cubic, "{error} rad");
        assert!(
            error > 0.2 * low_pass,
            "{error} rad: the low-pass is not there"
        );
    }
}

#[test]
fn a_quantised_motion_is_nearer_to_the_truth_than_its_sensor() {
    let step = 0.049_f64.to_radians();
    let times: Vec<f64> = (0..=600).map(|i| 0.005 * f64::from(i)).collect();
    // Slow: 0.02 rad/s is one step of the sensor every nine samples, so the raw record stands still and jumps.
    let slow = |t: f64| 0.02 * t;
    let values: Vec<f64> = times
        .iter()
        .map(|t| (slow(*t) / step).round() * step)
        .collect();
    let curve = Curve::smooth(&times, &values);
    assert!(
        worst(&curve, slow, 0.1, 2.9) < 0.5 * step,
        "at most half a step off"
    );
    let speeds = (100..2900)
        .map(|ms| (curve.at(f64::from(ms) * 1e-3 + 1e-3) - curve.at(f64::from(ms) * 1e-3)) / 1e-3);
    let fastest = speeds.fold(0.0, f64::max);
    let raw = step / 0.005;
    assert!(
        fastest < 0.35 * raw,
        "the steps are smoothed: {fastest} of {raw} rad/s"
    );
}

#[test]
fn nothing_rings_or_overshoots() {
    // A step, the worst case for a resampler, then a rise of unequal steps.
    let times = uneven(400);
    let step: Vec<f64> = times
        .iter()
        .map(|t| if *t < 1.0 { -0.3 } else { 0.7 })
        .collect();
    let stairs: Vec<f64> = times
        .iter()
        .map(|t| (t * 3.0).floor() + (t * 17.0).floor() * 0.01)
        .collect();
    for values in [step, stairs] {
        let curve = Curve::smooth(&times, &values);
        let (first, last) = (values[0], values[values.len() - 1]);
        let path: Vec<f64> = (0..40_000).map(|i| curve.at(f64::from(i) * 5e-5)).collect();
        assert!(
            path.windows(2).all(|pair| pair[1] >= pair[0] - 1e-12),
            "a rising record gives a rising curve"
        );
        assert!(
            path.iter()
                .all(|x| (first - 1e-12..=last + 1e-12).contains(x)),
            "and stays within its range"
        );
        assert!((path[0] - first).abs() < 1e-9 && (path[39_999] - last).abs() < 1e-9);
    }
}

#[test]
fn what_is_faster_than_a_hand_is_taken_out_before_sampling() {
    // 999 Hz sampled at 1 kHz would show as 1 Hz; the record is at 10 kHz.
    let times: Vec<f64> = (0..20_000).map(|i| 1e-4 * f64::from(i)).collect();
    let values: Vec<f64> = times
        .iter()
        .map(|t| 0.1 * (TAU * 999.0 * t).sin())
        .collect();
    let curve = Curve::smooth(&times, &values);
    let error = worst(&curve, |_| 0.0, 0.1, 1.9);
    assert!(error < 1e-5, "{error} rad of 0.1 rad are left");
}

#[test]
fn the_low_pass_takes_3_db_at_its_frequency() {
    let times: Vec<f64> = (0..4000).map(|i| 1e-3 * f64::from(i)).collect();
    let values: Vec<f64> = times
        .iter()
        .map(|t| (TAU * SMOOTHING_HZ * t).sin())
        .collect();
    let curve = Curve::smooth(&times, &values);
    let peak = (1000..3000)
        .map(|i| curve.at(1e-3 * f64::from(i)).abs())
        .fold(0.0, f64::max);
    assert!((peak - 0.5_f64.sqrt()).abs() < 0.005, "{peak}");
}

#[test]
fn before_and_after_the_record_the_hand_stands_still() {
    let curve = Curve::smooth(&[0.0, 1.0], &[2.0, 3.0]);
    assert_eq!(
        (curve.at(-5.0), curve.at(0.0), curve.at(1.0), curve.at(9.0)),
        (curve.at(0.0), curve.at(0.0), curve.at(9.0), curve.at(1.0))
    );
    assert!((curve.at(0.0) - 2.0).abs() < 1e-3 && (curve.at(9.0) - 3.0).abs() < 1e-3);
    assert!((curve.at(0.5) - 2.5).abs() < 1e-9);
}
