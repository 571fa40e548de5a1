//! Tests of the Rust and C files that `touchstone tune` writes. A test of `bindings/c` compiles the committed samples.

use std::f64::consts::TAU;
use std::path::Path;
use touchstone_control::{ChangeOfForce, PositionSettings, Settings, Si};
use touchstone_lab::scorecard::reference::Reference;
use touchstone_lab::scorecard::rivals::Rival;
use touchstone_lab::tune::Tuned;
use touchstone_lab::tune::own_firmware::{CFile, OwnFirmware, settings};
use touchstone_sim::scene::Scene;

/// Folder of the committed sample files.
const SAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../bindings/c/tests/tuned");

/// A tuning result whose search changed no setting of the scene.
fn tuned(scene: &Scene) -> Tuned {
    let rival = Rival::named("enhanced").expect("a law");
    Tuned {
        rival,
        scene: rival.to_tune(scene),
        parameters: Vec::new(),
        worst: 0.5,
        evaluations: 1,
        reference: Reference::none(),
        seed: 1,
    }
}

fn scene(name: &str) -> Scene {
    Scene::load(name).expect("a shipped scene")
}

#[test]
fn the_committed_texts_are_those_that_the_program_writes() {
    let own = OwnFirmware::new(&tuned(&scene("voltage-knob"))).expect("settings");
    let texts = [
        ("sample.rs", own.rust()),
        ("sample.c", own.c(CFile::Source)),
        ("sample.h", own.c(CFile::Header)),
    ];
    for (name, text) in texts {
        let file = Path::new(SAMPLES).join(name);
        if std::env::var_os("TOUCHSTONE_WRITE_TUNED").is_some() {
            std::fs::write(&file, &text).expect("a file");
        }
        let kept = std::fs::read_to_string(&file).unwrap_or_default();
        assert!(
            kept == text,
            "{name} is old: TOUCHSTONE_WRITE_TUNED=1 cargo test -p touchstone --test scripts own_firmware"
        );
    }
    // A test of `bindings/c` compiles the files in both languages and compares them, so this test reads only one language.
    let mut read = Settings {
        position: PositionSettings::of_counts_per_rev(16_384),
        ..Settings::default()
    };
    let text = own.c(CFile::Source);
    let rows = text.lines().filter_map(|line| {
        let (row, _) = line.trim().strip_prefix("{\"")?.split_once("\"},")?;
        row.split_once("\", \"")
    });
    for (path, value) in rows {
        assert_eq!(read.set_by_path(path, value), Ok(()), "{path} {value}");
    }
    assert_eq!(read, own.settings);
    assert_ne!(read.guard, Settings::default().guard);
}

#[test]
fn the_guard_is_told_no_better_device_than_the_scene_has() {
    for name in ["thesis-knob", "gimbal-knob", "voltage-knob"] {
        for (delay_s, counts, damping, share) in [
            (0.0, 40_000.0, 3e-4, 0.8),
            (2e-4, 1000.7, 2e-5, 1.0),
            (5e-4, 16_384.0, 5e-4, 0.9),
        ] {
            let mut scene = scene(name);
            scene.timing.computational_delay_s = delay_s;
            scene.timing.latency_spread_s = Some(0.1 * delay_s);
            scene.encoder.as_mut().expect("an encoder").counts_per_rev = counts;
            scene.device.damping_n_m_s_per_rad = damping;
            scene.law.guard.share_of_damping = share;
            scene.law.guard.damping_n_m_s_per_rad = 9e-4;
            // The guard's delay must be the device's: neither a longer nor a shorter one is safe.
            scene.law.guard.delay_s = 8e-4;
            scene.law.guard.change = ChangeOfForce::Measured;
            let (settings, _) = settings(&tuned(&scene).scene).expect("settings");
            let guard = &settings.guard;
            let step = Si::DELTA.to_num::<f64>();
            assert!(guard.on);
            let delay_s = guard.delay.to_num::<f64>() - 1.1 * delay_s;
            assert!(delay_s.abs() <= step, "{name}: {delay_s}");
            let lag_s = scene.device.current_loop.as_ref();
            let lag_s = lag_s.map_or(0.0, |it| 1.0 / (TAU * it.bandwidth_hz));
            assert!((guard.lag.to_num::<f64>() - lag_s).abs() <= step, "{name}");
            let trusted = guard.share_of_damping.saturating_mul(guard.damping);
            assert!(trusted.to_num::<f64>() <= 0.8 * damping + step, "{name}");
            assert!(
                settings.position.count.to_num::<f64>() >= TAU / counts,
                "{name}"
            );
            assert_eq!(guard.change, ChangeOfForce::Estimated);
        }
    }
}

#[test]
fn what_the_libraries_cannot_hold_is_refused() {
    let mut blind = scene("thesis-knob");
    blind.encoder = None;
    let refused = settings(&blind).expect_err("no encoder").to_string();
    assert!(refused.contains("encoder.counts_per_rev"), "{refused}");
    // The delay alone is within a tick, but delay and current loop's lag together are not.
    let mut late = scene("voltage-knob");
    late.timing.computational_delay_s = 9e-4;
    let refused = settings(&tuned(&late).scene).expect_err("late").to_string();
    assert!(refused.contains("law.guard.lag_s"), "{refused}");
}

#[test]
fn a_name_ends_no_comment() {
    let mut odd = scene("thesis-knob");
    odd.name = "a\nb */ c\\".to_owned();
    let own = OwnFirmware::new(&tuned(&odd)).expect("settings");
    for text in [own.rust(), own.c(CFile::Source)] {
        let first = text.lines().next().unwrap_or_default();
        assert!(
            first.starts_with("// ") && first.ends_with("a b */ c/:"),
            "{first}"
        );
    }
}
