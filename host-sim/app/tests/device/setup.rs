//! Tests of `touchstone setup` on a board whose motor differs from its settings. The setup must end with a tuned board. After an
//! interruption it must resume, or say why it cannot.

use super::fake::{Fake, Trouble};
use super::spun::{Pulled, Spun};
use super::{folder, run};
use std::path::{Path, PathBuf};
use touchstone_control::ChangeOfForce;
use touchstone_drive::change::law_settings;
use touchstone_drive::wire::hardware;
use touchstone_link::guard::bound;
use touchstone_protocol::{Board, DeviceSettings, MeasuringPart, Phase, stored};
use touchstone_world::motor::{GIMBAL, MotorParameters};
use touchstone_world::plant::{Coulomb, Device};

fn motor() -> MotorParameters {
    MotorParameters {
        resistance_ohm: 1.3 * GIMBAL.resistance_ohm,
        inductance_h: 0.7 * GIMBAL.inductance_h,
        flux_linkage_wb: 1.3 * GIMBAL.flux_linkage_wb,
        electrical_zero_rad: 2.0,
        ..GIMBAL
    }
}

fn knob(friction_n_m: f64) -> Device {
    Device {
        inertia: 0.7e-4,
        damping: 5.2e-4,
        friction: Some(Coulomb {
            kinetic: friction_n_m,
            breakaway: friction_n_m,
        }),
    }
}

/// Creates a file with a control law's settings. Returns the path for the setup's folder, and the path of the file.
fn place(test: &str) -> (PathBuf, String) {
    let folder = folder(test);
    let law = folder.join("given.toml");
    std::fs::write(&law, "[law.estimator]\ninertia_kg_m2 = 0.00007\n").unwrap();
    (folder.join("knob"), law.display().to_string())
}

fn setup(device: &Spun, out: &Path, law: &str) -> super::Said {
    device.run(&["setup", "--out", &out.display().to_string(), "--law", law])
}

fn kept(out: &Path) -> serde_json::Value {
    let text = std::fs::read_to_string(out.join("setup.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_board_becomes_a_tuned_knob() {
    let (out, law) = place("setup-whole");
    let device = Spun::new(motor(), &knob(1.3e-3), 1);
    let said = setup(&device, &out, &law).done();
    assert!(said.contains("ready; the wall is at 1 rad"), "{said}");

    let kept = kept(&out);
    for (name, truth, share, floor) in [
        ("resistance_ohm", 7.8, 0.05, 0.0),
        ("inductance_h", 2.1e-3, 0.05, 0.0),
        ("flux_linkage_wb", 1.3 * GIMBAL.flux_linkage_wb, 0.05, 0.0),
        ("torque_constant_n_m_per_a", 1.3 * 0.25, 0.05, 0.0),
        ("inertia_kg_m2", 0.7e-4, 0.05, 0.0),
        ("damping_n_m_s_per_rad", 5.2e-4, 0.2, 2e-6),
        ("friction_n_m", 1.3e-3, 0.05, 0.0),
    ] {
        let value = kept["measured"][name]["value"].as_f64().unwrap();
        let allowed = (share * truth).max(floor);
        assert!(
            (value - truth).abs() < allowed,
            "{name}: {value} for {truth}"
        );
    }

    {
        let (session, world) = &*device.world();
        let settings = session.settings();
        let measured = kept["measured"]["resistance_ohm"]["value"]
            .as_f64()
            .unwrap();
        assert!((settings.motor.resistance_ohm.to_num::<f64>() - measured).abs() < 1e-6);
        assert_eq!(settings.law.estimator.inertia_kg_m2.to_string(), "0.00007");
        assert!(!settings.calibration.measures);
        assert_eq!(settings.limits.host_silence_s, 2);
        assert!(world.saved);
        assert_eq!(Phase::from(world.knob.device.state()), Phase::Ready);
    }

    // The simulator can run this knob's scene, and the board's earlier settings were stored.
    let scene = out.join("knob.toml").display().to_string();
    run(&[
        "run",
        &scene,
        "--settings",
        &out.join("law.toml").display().to_string(),
    ])
    .done();
    let before = std::fs::read_to_string(out.join("before.toml")).unwrap();
    assert!(before.contains("resistance_ohm = 6\n"), "{before}");
    assert!(out.join("report/index.html").is_file());

    // A second setup does not spin the motor again.
    device.world().1.pulled_in = Some(Pulled::In(MeasuringPart::Low));
    let said = setup(&device, &out, &law).done();
    assert!(said.contains("measured before"), "{said}");

    // A settings file of a control law cannot weaken the guard's energy bound.
    let weaker =
        "[law.guard]\non = false\nchange = \"estimated\"\ncapacity_j = 1\nshare_of_damping = 1\n";
    std::fs::write(&law, weaker).unwrap();
    let said = setup(&device, &out, &law);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(
        said.err
            .contains("ignored for the energy guard: law.guard.on"),
        "{}",
        said.err
    );
    let (session, _) = &*device.world();
    let guard = &session.settings().law.guard;
    let shipped = DeviceSettings::defaults(Board::NucleoG474re).law.guard;
    assert!(guard.on && guard.change == shipped.change && guard.capacity_j == shipped.capacity_j);
    assert_eq!(guard.share_of_damping, shipped.share_of_damping);
    let measured = kept["measured"]["damping_n_m_s_per_rad"]["value"]
        .as_f64()
        .unwrap();
    assert!(guard.damping_n_m_s_per_rad.to_num::<f64>() <= 0.8 * measured);
}

/// The number after a text in a generated file.
fn number_after(text: &str, name: &str) -> f64 {
    let after = text
        .split_once(name)
        .unwrap_or_else(|| panic!("{name} in {text}"))
        .1;
    let number = after.trim_start_matches(|c: char| !c.is_ascii_digit());
    let end = number.find(|c: char| !(c.is_ascii_digit() || c == '.'));
    number[..end.unwrap_or(number.len())].parse().unwrap()
}

/// Checks that a setup that tunes the wall writes it for a firmware of one's own too, for no better a device than was measured, and
/// that no file of another law stays.
#[test]
fn a_tuned_wall_is_written_as_rust_and_c() {
    let (out, law) = place("setup-code");
    let device = Spun::new(motor(), &knob(1.3e-3), 1);
    let folder = out.display().to_string();
    let words = ["setup", "--quick", "--k-desired", "5", "--out", &folder];
    let said = device.run(&words);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let rust = std::fs::read_to_string(out.join("law.rs")).unwrap();
    let c = std::fs::read_to_string(out.join("law.h")).unwrap();
    assert!(c.contains("ts_status tuned_settings("), "{c}");
    let damping = kept(&out)["measured"]["damping_n_m_s_per_rad"]["value"]
        .as_f64()
        .unwrap();
    let scene: toml::Table = std::fs::read_to_string(out.join("knob.toml"))
        .unwrap()
        .parse()
        .unwrap();
    let delay_s = scene["timing"]["computational_delay_s"].as_float().unwrap();
    // The board's setting is 0, because it calculates the delay itself; the simulated guard is told the scene's.
    assert!(scene["law"]["guard"]["delay_s"].as_float().unwrap() >= delay_s);
    let device_text = rust.split_once("tuned_device").unwrap().1;
    assert!(number_after(device_text, "damping:") <= damping * 1.000001);
    assert!(number_after(device_text, "delay:") >= delay_s - 1e-9);
    assert_eq!(kept(&out)["tuned_quickly"], true);
    setup(&device, &out, &law).done();
    assert!(!out.join("law.rs").exists() && !out.join("law.h").exists());
    // The next setup without --law must not take the given law for a tuned one.
    assert!(kept(&out)["tuned_for"].is_null());
}

/// The measured values of a setup's progress file. Resistance, inductance and torque constant are those of the board's default
/// settings.
fn measured(board: Board, damping: f64, uncertainty: f64) -> serde_json::Value {
    let settings = DeviceSettings::defaults(board);
    let motor = &settings.motor;
    let sure = |value: f64| serde_json::json!({ "value": value, "uncertainty": 0.01 * value });
    serde_json::json!({
        "resistance_ohm": sure(motor.resistance_ohm.to_num()),
        "inductance_h": sure(motor.inductance_h.to_num()),
        "flux_linkage_wb": sure(5e-3),
        "torque_constant_n_m_per_a": sure(motor.torque_constant_n_m_per_a.to_num()),
        "inertia_kg_m2": sure(3e-5),
        "damping_n_m_s_per_rad": { "value": damping, "uncertainty": uncertainty },
        "friction_n_m": sure(1e-3),
        "residual_rms_rad": 1e-3,
    })
}

/// Makes the folder of a setup whose motor has been measured, with these values.
fn is_measured(device: &Fake, out: &Path, measured: serde_json::Value) {
    std::fs::create_dir(out).unwrap();
    let before = out.join("before.toml").display().to_string();
    device.run(&["config", "export", &before, "-q"]).done();
    let progress = serde_json::json!({ "device": "ab".repeat(12), "measured": measured });
    std::fs::write(out.join("setup.json"), progress.to_string()).unwrap();
}

/// Makes the folder of a setup whose motor has been measured, for tests of what follows.
#[cfg(unix)]
pub fn goes_on(device: &Fake, out: &Path) {
    is_measured(device, out, measured(Board::NucleoG474re, 1e-4, 1e-6));
}

/// Settings of a control law that claim a better device than any board is.
const TOO_GOOD: &str = "[encoder]\ncounts_per_rev = 1000000
[drive]\nkind = \"analogue\"
[limits]\nhost_silence_s = 0
[law.guard]\non = false\nchange = \"estimated\"\ndelay_s = 0\nlag_s = 0
damping_n_m_s_per_rad = 1\nshare_of_damping = 1\ncapacity_j = 1\nrefill_w = 1\n";

#[test]
fn what_is_left_on_every_board_is_within_the_conditions_of_the_bound() {
    // The second case has so large an uncertainty that twice its value is more than a fifth of the damping.
    let (damping, cases) = (1e-4, [(1e-6, 0.8e-4), (3e-5, 0.4e-4)]);
    for board in Board::ALL.into_iter().filter(|it| it.senses_current()) {
        for (uncertainty, sure) in cases {
            let device = Fake::with(Trouble {
                board: Some(board),
                ..Trouble::default()
            });
            let (out, law) = place("setup-left");
            std::fs::write(&law, TOO_GOOD).unwrap();
            is_measured(&device, &out, measured(board, damping, uncertainty));
            let out = out.display().to_string();
            let said = device.run(&["setup", "--out", &out, "--law", &law]);
            assert_eq!(said.code, Some(0), "{board:?}: {}", said.err);
            for path in ["encoder.counts_per_rev", "drive.kind", "law.guard.on"] {
                assert!(said.err.contains(path), "{board:?}: {}", said.err);
            }

            let (session, world) = &*device.world();
            let (left, shipped) = (session.settings(), DeviceSettings::defaults(board));
            let saved = stored::decode_with(world.saved.as_ref().unwrap(), &|_| Ok(()));
            assert_eq!(saved.unwrap().settings, *left, "{board:?}");
            let guard = &left.law.guard;
            assert!(guard.on, "{board:?}");
            assert_eq!(guard.change, ChangeOfForce::Measured, "{board:?}");
            let told: f64 = guard.damping_n_m_s_per_rad.to_num();
            assert!(told <= sure + 1e-9, "{board:?}: {told}");
            assert!(guard.share_of_damping <= shipped.law.guard.share_of_damping);
            assert!(guard.capacity_j <= shipped.law.guard.capacity_j);
            assert!(guard.refill_w <= shipped.law.guard.refill_w);
            assert_eq!(left.encoder, shipped.encoder, "{board:?}");
            assert_eq!(left.drive, shipped.drive, "{board:?}");
            assert_eq!(left.limits, shipped.limits, "{board:?}");
            // The settings as the board itself changes them: with its own delay, and with a count that is not too small.
            let (law, change) = law_settings(left, hardware(board)).unwrap();
            let (own, _) = law_settings(&shipped, hardware(board)).unwrap();
            assert!(change.is_some(), "{board:?}");
            assert!(law.guard.delay >= own.guard.delay && law.guard.delay > 0);
            assert!(law.guard.lag >= own.guard.lag);
            let count = std::f64::consts::TAU / f64::from(shipped.encoder.counts_per_rev);
            assert!(law.position.count.to_num::<f64>() >= count, "{board:?}");
            // At most 45.145 mJ, by `any_accepted_window` of proofs/coq/AcceptedWindow.v.
            let bound = bound(left, board).unwrap();
            assert!(bound.at_once_j <= 0.045_145, "{board:?}: {bound:?}");
        }
    }
}

#[test]
fn a_cable_that_is_pulled_while_it_spins_costs_that_step_alone() {
    let (out, law) = place("setup-cable");
    let device = Spun::new(motor(), &knob(1.3e-3), 2);
    for part in [MeasuringPart::High, MeasuringPart::Coast] {
        device.world().1.pulled_in = Some(Pulled::In(part));
        let said = setup(&device, &out, &law);
        said.failed(1, &["tcp:127.0.0.1:"]);
        assert!(kept(&out)["measured"].is_null());
        device.plug_in();
    }
    setup(&device, &out, &law).done();
    let (session, _) = &*device.world();
    assert!(!session.settings().calibration.measures);
    assert_eq!(session.settings().limits.host_silence_s, 2);
}

#[test]
fn a_hand_on_the_shaft_is_refused_and_another_try_goes_on() {
    let (out, law) = place("setup-hand");
    // This friction stops the push with a quarter of 1 A, but not the stronger alignment.
    let held = Spun::new(motor(), &knob(0.1), 3);
    setup(&held, &out, &law).failed(
        1,
        &[
            "fault: 10 calibration-failed",
            "take your hand off the knob",
        ],
    );
    assert!(kept(&out)["measured"].is_null());
    // The same board without the hand on the shaft.
    setup(&Spun::new(motor(), &knob(1.3e-3), 3), &out, &law).done();
}

#[test]
fn another_board_and_a_wall_that_is_on_are_refused() {
    let (out, law) = place("setup-other");
    let device = Spun::new(motor(), &knob(1.3e-3), 4);
    setup(&device, &out, &law).done();
    let other = Spun::new(motor(), &knob(1.3e-3), 5);
    setup(&other, &out, &law).failed(2, &["belongs to the board", "--out"]);

    device.run(&["--quiet", "device", "arm"]).done();
    setup(&device, &out, &law).failed(1, &["the wall is on", "touchstone device disarm"]);
    assert_eq!(
        Phase::from(device.world().1.knob.device.state()),
        Phase::Armed,
        "a refusal switches nothing"
    );
}

/// Cuts the supply in each step of the setup. The board then has only its saved settings, and the shaft stays where it came to
/// rest. Checks that only the interrupted step is repeated.
#[test]
fn a_supply_that_is_cut_in_any_step_costs_that_step_alone() {
    let (out, law) = place("setup-power");
    let device = Spun::new(motor(), &knob(1.3e-3), 6);
    let cut = |when: Pulled| {
        device.world().1.pulled_in = Some(when);
        let said = setup(&device, &out, &law);
        said.failed(1, &["tcp:127.0.0.1:", "the same command"]);
        device.power_up();
    };
    // The setup sends settings twice per measurement: first to request the measurement, then to withdraw the request.
    cut(Pulled::AtSettings(1));
    cut(Pulled::AtCalibration(1));
    cut(Pulled::In(MeasuringPart::Brake));
    cut(Pulled::In(MeasuringPart::Push));
    assert!(kept(&out)["measured"].is_null());
    let (given, _) = counted(&device);
    cut(Pulled::AtSettings(given + 2));
    // The telemetry was complete before the power cut, but its results were not recorded, so that the setup measures again.
    assert!(kept(&out)["measured"].is_null());
    let (given, _) = counted(&device);
    cut(Pulled::AtSettings(given + 3));
    let measured = kept(&out)["measured"].clone();
    assert!(!measured.is_null());

    // The setup does not spin the motor again from here on.
    for when in [Pulled::BeforeSaved, Pulled::AfterSaved] {
        cut(when);
        assert_eq!(kept(&out)["measured"], measured);
    }
    let (_, calibrated) = counted(&device);
    cut(Pulled::AtCalibration(calibrated + 1));
    let said = setup(&device, &out, &law).done();
    assert!(
        said.contains("measured before") && said.contains("ready; the wall is at 1 rad"),
        "{said}"
    );
    assert_eq!(kept(&out)["measured"], measured);
    let before = std::fs::read_to_string(out.join("before.toml")).unwrap();
    assert!(before.contains("resistance_ohm = 6\n"), "{before}");
    let (session, world) = &*device.world();
    let measured = measured["resistance_ohm"]["value"].as_f64().unwrap();
    assert!((session.settings().motor.resistance_ohm.to_num::<f64>() - measured).abs() < 1e-6);
    assert_eq!(Phase::from(world.knob.device.state()), Phase::Ready);
}

/// Number of times that settings were sent, and number of calibrations, since the device was created.
fn counted(device: &Spun) -> (u32, u32) {
    device.world().1.counted()
}

/// Cuts only the motor's supply. Checks that a board powered over USB keeps running and reports the fault, and that another try of
/// the setup succeeds.
#[test]
fn a_motor_without_its_supply_is_refused_and_another_try_goes_on() {
    let (out, law) = place("setup-supply");
    let device = Spun::new(motor(), &knob(1.3e-3), 7);
    device.world().1.supply_goes_in = Some(MeasuringPart::Coast);
    for _ in 0..2 {
        setup(&device, &out, &law).failed(1, &["fault", "voltage", "the same command"]);
        assert!(kept(&out)["measured"].is_null());
    }
    // This fault is latched, because nothing stops the board afterwards.
    device
        .run(&["device", "calibrate"])
        .failed(1, &["03 under-voltage"]);
    device.world().1.knob.tamper.0 = 24.0;
    let said = setup(&device, &out, &law);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(
        said.err.contains("was in fault 03 under-voltage"),
        "{}",
        said.err
    );
}

#[test]
fn a_board_without_current_sensors_is_not_set_up() {
    let device = Fake::with(Trouble {
        no_current: true,
        ..Trouble::default()
    });
    let out = folder("setup-no-current");
    device
        .run(&["setup", "--out", &out.display().to_string()])
        .failed(1, &["has no current sensors", "docs/voltage-mode.md"]);
    assert!(!out.join("before.toml").exists());
    // The setting that requests a motor measurement is refused, too.
    let failed = device.run(&["config", "set", "calibration.measures", "true"]);
    failed.failed(2, &["can measure no motor"]);
}
