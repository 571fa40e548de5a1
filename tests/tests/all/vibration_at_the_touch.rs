//! Compares the decaying vibration at the touch (`law.impact.vibration_*`) with its formula, and tests its bounds.

use touchstone_control::law::{Impact, Sample};
use touchstone_control::{Controller, Fixed32, Force, Position, Settings, SettingsError, Si};
use touchstone_sim::run;
use touchstone_sim::scene::Scene;

/// Speed of the vibration over the speed at the touch.
const SHARE: f64 = 0.2;

fn settings(rate_hz: u32, frequency_hz: f64, decay_s: f64) -> Settings {
    let mut settings = Settings {
        rate_hz,
        ..Settings::default()
    };
    settings.impact.momentum = Si::ZERO;
    settings.impact.vibration = Si::from_num(SHARE);
    settings.impact.frequency_hz = Si::from_num(frequency_hz);
    settings.impact.decay_s = Si::from_num(decay_s);
    settings
}

/// The vibration added to a constant force of 0.2 N·m inside a wall that was entered with a speed, N·m.
fn played(settings: &Settings, speed: f64, ticks: u32) -> Vec<f64> {
    let mut impact = Impact::<Fixed32>::pulse_of(settings).unwrap().unwrap();
    let position = |rad: f64| Position::<Fixed32>(fixed::types::I8F24::from_num(rad));
    let base = Force::<Fixed32>(fixed::types::I8F24::from_num(0.2));
    let sample = Sample {
        e: position(0.01),
        moved: position(speed / f64::from(settings.rate_hz)),
    };
    (0..ticks)
        .map(|_| {
            (impact.with_pulse_and_vibration(sample, base) - base)
                .0
                .to_num()
        })
        .collect()
}

/// Largest distance of the vibration from `s J ω v exp(-t/τ) sin(ω t)`, as a fraction of `s J ω v`, and the bound of this fraction.
/// `s` is [`SHARE`], `J` the inertia, `ω` the vibration's angular frequency, `v` the speed at the touch, `τ` the decay time.
fn error(rate_hz: u32, frequency_hz: f64, decay_s: f64) -> (f64, f64) {
    let speed = 2.0;
    let settings = settings(rate_hz, frequency_hz, decay_s);
    let rate = f64::from(rate_hz);
    let omega = std::f64::consts::TAU * frequency_hz;
    let amplitude = SHARE * settings.estimator.inertia.to_num::<f64>() * omega * speed;
    let mut worst: f64 = 0.0;
    for (n, force) in (1_u32..).zip(played(&settings, speed, (6.0 * decay_s * rate) as u32)) {
        let t = f64::from(n) / rate;
        let ideal = (-t / decay_s).exp() * (omega * t).sin();
        worst = worst.max((force / amplitude - ideal).abs());
    }
    // The recursion's error is of first order in the angle and the decay of a control period. A rounding by one digit (2^-24) in
    // every control period moves the middle of the swing by the digit over the square of the angle per period.
    let digit = 2.0_f64.powi(-24);
    let bound = 0.25 * (omega + 1.0 / decay_s) / rate + digit / amplitude * (rate / omega).powi(2);
    (worst, bound)
}

#[test]
fn the_vibration_is_a_decaying_sinusoid_of_the_speed() {
    println!("| rate, Hz | frequency, Hz | decay, s | largest error over the amplitude | bound |");
    for rate in [1_000, 4_000, 10_000] {
        for (frequency, decay_s) in [(18.0, 0.017), (30.0, 0.0125), (100.0, 0.011), (20.0, 0.003)] {
            let (found, bound) = error(rate, frequency, decay_s);
            println!("| {rate} | {frequency} | {decay_s} | {found:.3} | {bound:.3} |");
            assert!(found < bound, "{rate} {frequency} {decay_s}: {found}");
        }
    }
}

#[test]
fn the_vibration_ends_after_six_time_constants() {
    let settings = settings(1_000, 50.0, 0.01);
    let found = played(&settings, 5.0, 200);
    assert!(found[30..55].iter().any(|force| *force != 0.0));
    assert!(found[60..].iter().all(|force| *force == 0.0));
}

#[test]
fn no_amplitude_is_the_wall_without_vibration_to_the_bit() {
    let scene = Scene::load("tap").unwrap();
    let changed = [
        "law.impact.vibration_hz=40",
        "law.impact.vibration_decay_s=0.05",
    ];
    let changed = scene.with_overrides(&changed.map(str::to_owned)).unwrap();
    let forces = |scene: &Scene| run::run(scene, true).unwrap().trace.unwrap().force_n_m;
    assert_eq!(forces(&scene), forces(&changed));
}

#[test]
fn a_frequency_above_a_tenth_of_the_rate_is_refused_only_where_it_is_played() {
    let mut settings = settings(1_000, 101.0, 0.011);
    let refused = Controller::<Fixed32>::new(&settings).unwrap_err();
    assert!(matches!(refused, SettingsError::OutOfRange { .. }));
    assert!(
        refused
            .to_string()
            .contains("law.impact.vibration_hz = 101"),
        "{refused}"
    );
    settings.impact.vibration = Si::ZERO;
    assert!(Controller::<Fixed32>::new(&settings).is_ok());
}

/// Checks that the vibration is felt in the scene `tap`, and that the force stays between 0 and the limit.
#[test]
fn a_tap_vibrates_within_the_force_limit() {
    let scene = Scene::load("tap").unwrap();
    let set = [
        "law.impact.vibration_share_of_speed=0.5",
        "law.impact.vibration_hz=60",
        "law.impact.vibration_decay_s=0.03",
    ];
    let with = scene.with_overrides(&set.map(str::to_owned)).unwrap();
    let forces = |scene: &Scene| run::run(scene, true).unwrap().trace.unwrap().force_n_m;
    let (plain, with) = (forces(&scene), forces(&with));
    // The force limit of the default settings, which the scene has.
    let limit = 0.5;
    assert!(with.iter().all(|force| (0.0..=limit).contains(force)));
    let apart = plain.iter().zip(&with).map(|(a, b)| (a - b).abs());
    let largest = apart.fold(0.0, f64::max);
    assert!(largest > 0.01, "{largest}");
}

/// Checks that a vibration makes no tap deeper and adds no touch: a device that hopped would touch again, and so start another
/// vibration.
#[test]
fn no_vibration_makes_a_device_hop() {
    println!("| share of speed | Hz | most touches: without | with | deepest over without |");
    for (share, hz, decay_s) in [
        (0.3, 30, 0.02),
        (0.5, 60, 0.02),
        (1.0, 20, 0.1),
        (1.0, 100, 0.05),
    ] {
        let (mut without, mut with, mut deeper) = (0, 0, 0.0_f64);
        for grip in ["light", "medium", "firm"] {
            for (speed, inertia, stiffness) in [
                (1, 1.0, 14),
                (3, 0.5, 14),
                (3, 2.0, 14),
                (6, 1.0, 14),
                (3, 1.0, 5),
                (3, 1.0, 20),
            ] {
                let common = [
                    format!("wall.k_desired_n_m_per_rad={stiffness}"),
                    format!("operator.grip={grip}"),
                    format!("operator.motion.velocity_rad_per_s={speed}"),
                    format!("device.inertia_kg_m2={}", 1e-4 * inertia),
                ];
                let vibrating = [
                    format!("law.impact.vibration_share_of_speed={share}"),
                    format!("law.impact.vibration_hz={hz}"),
                    format!("law.impact.vibration_decay_s={decay_s}"),
                ];
                let scene = Scene::load("tap").unwrap().with_overrides(&common).unwrap();
                let [plain, vibrates] = [&[][..], &vibrating[..]].map(|set| {
                    let scene = scene.with_overrides(set).unwrap();
                    let trace = run::run(&scene, true).unwrap().trace.unwrap();
                    let touches = trace
                        .force_n_m
                        .windows(2)
                        .filter(|it| it[0] == 0.0 && it[1] > 0.0)
                        .count();
                    let deepest = trace
                        .angle_rad
                        .iter()
                        .fold(0.0_f64, |most, angle| most.max(*angle))
                        - scene.wall.surface_rad;
                    (touches, deepest)
                });
                without = without.max(plain.0);
                with = with.max(vibrates.0);
                if plain.1 > 1e-3 {
                    deeper = deeper.max(vibrates.1 / plain.1);
                }
            }
        }
        println!("| {share} | {hz} | {without} | {with} | {deeper:.2} |");
        assert!(with <= without && deeper <= 1.0, "{share} {hz}");
    }
}
