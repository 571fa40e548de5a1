//! Tests of the warnings that a run gives if the energy guard is configured for another device than the scene's.

use touchstone_sim::run;
use touchstone_sim::scene::Scene;

fn with(scene: &Scene, sets: &[&str]) -> Scene {
    scene.with_overrides(sets).unwrap()
}

/// Text of the warning that the energy guard is configured for a smaller error than the sensor's; `None` without the warning.
fn told_too_little(scene: &Scene) -> Option<String> {
    let all = run::spoken_warnings(scene).unwrap().into_iter();
    let mut all = all.map(|warning| warning.to_string());
    all.find(|text| text.contains("the energy guard is configured for an encoder error of"))
}

#[test]
fn a_guard_that_is_told_less_than_noise_and_periodic_error_is_warned_of() {
    for name in touchstone_sim::scene::names() {
        let shipped = Scene::load(name).unwrap();
        assert_eq!(told_too_little(&shipped), None, "{name}");
    }
    let knob = Scene::load("thesis-knob").unwrap();
    // Four times the rms of the noise, and the amplitudes of both periodic errors.
    let noise = "sensor.noise.rms_rad=5e-4";
    let periodic = [
        "sensor.periodic.amplitude_rad=6.05e-3",
        "sensor.periodic.second_amplitude_rad=1e-3",
    ];
    let both = [noise, periodic[0], periodic[1]];
    for (sensor, enough, too_little) in [
        (&[noise][..], "0.0020", "0.0019"),
        (&periodic, "0.0071", "0.0070"),
        (&both, "0.0091", "0.0090"),
    ] {
        let told = |error: &str| {
            let told = format!("law.position_error_rad={error}");
            with(&with(&knob, sensor), &[&told])
        };
        for less in ["0", too_little] {
            let text = told_too_little(&told(less)).unwrap();
            assert!(text.contains("law.position_error_rad"), "{text}");
            assert!(text.ends_with(&format!("give {enough} or more")), "{text}");
            assert_eq!(text.contains("noise"), sensor.contains(&noise), "{text}");
        }
        assert_eq!(told_too_little(&told(enough)), None, "{sensor:?}");
        let unguarded = with(&told("0"), &["law.guard.on=false"]);
        assert_eq!(told_too_little(&unguarded), None, "{sensor:?}");
    }
}

#[test]
fn a_guard_configured_for_more_damping_or_another_delay_is_warned_of() {
    let said = |scene: &Scene| {
        let all = run::spoken_warnings(scene).unwrap().into_iter();
        let all = all.map(|warning| warning.to_string());
        all.filter(|text| text.contains("more energy than the guard's bound"))
            .collect::<Vec<_>>()
    };
    for name in touchstone_sim::scene::names() {
        assert!(said(&Scene::load(name).unwrap()).is_empty(), "{name}");
    }
    let knob = Scene::load("thesis-knob").unwrap();
    for (sets, part) in [
        (
            &["device.damping_n_m_s_per_rad=3e-4"][..],
            "law.guard.damping_n_m_s_per_rad",
        ),
        (
            &[
                "device.damping_n_m_s_per_rad=5e-4",
                "law.guard.damping_n_m_s_per_rad=6.3e-4",
            ],
            "give 0.0005 or less",
        ),
        (&["timing.computational_delay_s=1e-4"], "give 0.0001"),
        (&["law.guard.delay_s=1e-4"], "law.guard.delay_s"),
        (
            &[
                "timing.computational_delay_s=2e-4",
                "law.guard.delay_s=3e-4",
            ],
            "give 0.0002",
        ),
        (
            &["timing.computational_delay_s=0.0015"],
            "at most one control period",
        ),
        (
            &["timing.latency_spread_s=2e-4"],
            "for a delay that stays the same, and here it varies by up to 0.0002 s",
        ),
        // A guard that measures the position at the change of force still has to know how late the change can be.
        (
            &[
                "timing.computational_delay_s=1e-4",
                "law.guard.change=measured",
            ],
            "give 0.0001",
        ),
        (
            &[
                "timing.computational_delay_s=1e-4",
                "timing.latency_spread_s=2e-4",
                "law.guard.delay_s=1e-4",
                "law.guard.change=measured",
            ],
            "changes up to 0.0003 s after it",
        ),
        (
            &[
                "timing.computational_delay_s=9e-4",
                "timing.latency_spread_s=2e-4",
                "law.guard.delay_s=9e-4",
                "law.guard.change=measured",
            ],
            "at most one control period",
        ),
    ] {
        let scene = with(&knob, sets);
        let texts = said(&scene);
        assert!(
            texts.len() == 1 && texts[0].contains(part),
            "{sets:?}: {texts:?}"
        );
        assert!(said(&with(&scene, &["law.guard.on=false"])).is_empty());
    }
    for sets in [
        &["device.damping_n_m_s_per_rad=3.3e-4"][..],
        &[
            "timing.computational_delay_s=1e-4",
            "law.guard.delay_s=1e-4",
        ],
        // Configured with the lag of the current loop or without it.
        &["device.current_loop.bandwidth_hz=600"],
        &[
            "device.current_loop.bandwidth_hz=600",
            "law.guard.lag_s=2.6e-4",
        ],
        // With a measured position at the change, the guard may be configured for a later change than any that comes.
        &[
            "timing.computational_delay_s=1e-4",
            "timing.latency_spread_s=2e-4",
            "law.guard.delay_s=3e-4",
            "law.guard.change=measured",
        ],
        &["law.guard.delay_s=5e-4", "law.guard.change=measured"],
        // Jitter shifts sample and force together.
        &["timing.latency_spread_s=0", "timing.jitter_s=1e-4"],
    ] {
        let texts = said(&with(&knob, sets));
        assert!(texts.is_empty(), "{sets:?}: {texts:?}");
    }
}
