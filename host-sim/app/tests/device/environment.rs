//! Tests of `touchstone config environment`.

use crate::fake::{Fake, Trouble};
use crate::folder;
use std::path::PathBuf;
use touchstone_protocol::stored;

/// Scene of a knob with an end stop on each side and detents between the end stops.
const DIAL: &str = r#"
[environment]
first_wall = false
[environment.endstops]
lower_rad = -1.2
upper_rad = 1.2
[environment.detents]
per_rev = 36
strength_n_m = 0.02
centre_rad = 0.0
"#;

fn dial(test: &str) -> PathBuf {
    let path = folder(test).join("dial.toml");
    let scene = include_str!("../../../../scenes/thesis-knob.toml");
    std::fs::write(&path, format!("{scene}{DIAL}")).unwrap();
    path
}

#[test]
fn a_scene_is_sent_shown_changed_saved_and_taken_back() {
    let device = Fake::new();
    let ask = |more: &[&str]| device.run(&[&["config", "environment"], more].concat());
    let alone = ask(&[]).done();
    assert!(!alone.contains("endstops"), "{alone}");

    let path = dial("environment_is_sent");
    let said = ask(&[path.to_str().unwrap(), "--change", "0.25"]).done();
    for part in [
        "lower_rad = -1.2",
        "per_rev = 36",
        "strength_n_m = 0.02",
        "at most 0.25 N·m/s",
        "takes effect when the device is armed next",
        "touchstone config save",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let sent = *device.world().0.environment();
    assert!(!sent.first_wall);

    // The printed environment is a valid part of a scene. Sending it back to the device changes nothing.
    let shown = ask(&[]).done();
    let path = folder("environment_is_shown").join("again.toml");
    let scene = include_str!("../../../../scenes/thesis-knob.toml");
    std::fs::write(&path, format!("{scene}\n{shown}")).unwrap();
    ask(&[path.to_str().unwrap()]).done();
    assert_eq!(*device.world().0.environment(), sent);

    // Changes one field of the present environment.
    ask(&["--set", "environment.detents.per_rev=24"]).done();
    let mut expected = sent;
    expected.detents.as_mut().unwrap().per_rev = 24;
    assert_eq!(*device.world().0.environment(), expected);

    device.run(&["config", "save"]).done();
    let image = device.world().1.saved.clone().expect("saved");
    let start = stored::decode_with(&image, &|_| Ok(())).expect("readable");
    assert_eq!(start.environment, expected);

    ask(&["--wall-alone"]).done();
    assert_eq!(ask(&[]).done(), alone.replace("0.5 N·m/s", "0.25 N·m/s"));
}

/// Checks that every shipped haptic effect fits into a simulated knob, so that a user can try it there.
#[cfg(unix)]
#[test]
fn a_demo_knob_takes_every_shipped_feel() {
    let demo = crate::demo::Demo::new();
    let feels = touchstone_sim::scene::feels();
    assert_eq!(feels.len(), 23);
    for name in feels {
        let said = demo.run(&["config", "environment", name]);
        assert!(said.contains("takes effect"), "{name}: {said}");
        let shown = demo.run(&["config", "environment"]);
        let part = said.lines().take(shown.lines().count()).collect::<Vec<_>>();
        assert_eq!(part, shown.lines().collect::<Vec<_>>(), "{name}");
        let scene = touchstone_sim::scene::Scene::load(name).unwrap();
        let around = scene.environment.unwrap();
        for (is_there, part) in [
            (around.detents.is_some(), "[environment.detents]"),
            (around.endstops.is_some(), "[environment.endstops]"),
            (around.spring.is_some(), "[environment.spring]"),
            (around.damper.is_some(), "[environment.damper]"),
            (around.dry_friction.is_some(), "[environment.dry_friction]"),
            (around.click.is_some(), "[environment.click]"),
            (around.inertia.is_some(), "[environment.inertia]"),
            // A board stores a list of detents as the profile that it renders.
            (around.acting_profile().is_some(), "[environment.profile]"),
        ] {
            assert_eq!(shown.contains(part), is_there, "{name}: {shown}");
        }
    }
}

#[test]
fn an_armed_device_takes_it_at_once() {
    let device = Fake::new();
    for command in ["calibrate", "arm"] {
        device.run(&["--quiet", "device", command]).done();
    }
    let path = dial("environment_at_once");
    let said = device
        .run(&["config", "environment", path.to_str().unwrap()])
        .done();
    assert!(said.contains("at work now"), "{said}");
}

#[test]
fn what_cannot_be_is_refused_and_nothing_changes() {
    let device = Fake::new();
    let path = dial("environment_is_refused");
    let before = *device.world().0.environment();
    for (sets, parts) in [
        // The lower end of travel is above the upper end.
        (
            &["environment.endstops.lower_rad=1.5"][..],
            &["environment.endstops"][..],
        ),
        // This strength is above the device's torque limit.
        (
            &["environment.detents.strength_n_m=3"],
            &["environment.detents.strength_n_m"],
        ),
        (
            &["environment.detent.strength_n_m=0.1"],
            &["environment.detent"],
        ),
    ] {
        let mut arguments = vec!["config", "environment", path.to_str().unwrap()];
        for set in sets {
            arguments.extend(["--set", set]);
        }
        device.run(&arguments).failed(2, parts);
        assert_eq!(*device.world().0.environment(), before);
    }
    device
        .run(&["config", "environment", "no-such-scene"])
        .failed(2, &["no-such-scene"]);
    device
        .run(&["config", "environment", "--wall-alone", "--change", "-1"])
        .failed(2, &["N·m/s"]);
}

#[test]
fn the_board_without_room_says_so() {
    let device = Fake::with(Trouble {
        small: true,
        ..Trouble::default()
    });
    device
        .run(&["config", "environment"])
        .failed(1, &["one wall", "wall.surface_rad"]);
}
