//! Tests of `touchstone compare`: a recording of `touchstone monitor` against the simulation of a scene.

use super::spun::Spun;
use super::{Said, folder, program, run};
use std::path::Path;
use std::time::Duration;
use touchstone_world::motor::GIMBAL;
use touchstone_world::plant::{Coulomb, Device, State};

/// Records with `touchstone monitor` while a hand flicks the simulated knob.
pub fn recorded(file: &Path) -> u32 {
    let knob = Device {
        inertia: 1e-4,
        damping: 4e-4,
        friction: Some(Coulomb {
            kinetic: 1e-3,
            breakaway: 1e-3,
        }),
    };
    let device = Spun::new(GIMBAL, &knob, 9);
    device
        .run(&["config", "set", "wall.surface_rad", "0.3"])
        .done();
    device.run(&["device", "calibrate"]).done();
    device.run(&["--quiet", "device", "arm"]).done();
    let counts = device.world().0.settings().encoder.counts_per_rev;
    std::thread::scope(|threads| {
        let listening = threads.spawn(|| {
            let name = file.to_str().unwrap();
            device.run(&["monitor", "--seconds", "0.5", "--csv", name])
        });
        std::thread::sleep(Duration::from_millis(200));
        {
            let (_, world) = &mut *device.world();
            let angle = world.knob.rig.now().angle_rad;
            *world.knob.rig.state_mut() = State::from_array([angle, 6.0]);
        }
        listening.join().unwrap().done();
    });
    counts
}

#[test]
fn a_recording_of_a_flick_is_put_beside_its_scene() {
    let here = folder("compare");
    let file = here.join("flick.csv");
    let counts = format!("encoder.counts_per_rev={}", recorded(&file));
    let out = here.join("page");
    let compared = |more: &[&str]| -> Said {
        let all = [
            "compare",
            file.to_str().unwrap(),
            "thesis-knob",
            "--set",
            &counts,
            "--hand",
            "released",
            "--out",
            out.to_str().unwrap(),
            "--force",
        ];
        program(&[&all, more].concat()).output().unwrap().into()
    };
    let said = compared(&[]).done();
    for part in ["position  rms", "force     rms", "index.html"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    assert!(page.contains("recorded") && page.contains("simulated") && page.contains("<svg"));
    let said = compared(&["--json"]).done();
    let value: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(value["differences"][0]["what"], "position");
    assert_eq!(value["holds"], true);
    // With a tolerance of 0 the comparison fails, because recording and simulation are never exactly equal.
    let said = compared(&["--tolerance", "0", "--json"]);
    assert_eq!(said.code, Some(3), "{}", said.err);
    let value: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(value["holds"], false);

    // Without `--hand released` the command assumes that the scene's hand held the knob. The hand's motion, estimated from the
    // recording, can be run again.
    let held = [
        "compare",
        file.to_str().unwrap(),
        "thesis-knob",
        "--set",
        &counts,
    ];
    let held: Said = program(&[&held[..], &["--out", out.to_str().unwrap(), "--force"]].concat())
        .output()
        .unwrap()
        .into();
    held.done();
    let hand = out.join("hand.csv");
    let again = [
        "run",
        "thesis-knob",
        "--operator-motion",
        hand.to_str().unwrap(),
    ];
    assert_eq!(run(&again).code, Some(0));
}

#[test]
fn what_is_no_recording_is_named() {
    let here = folder("compare-wrong");
    let file = here.join("other.csv");
    std::fs::write(&file, "time_s,angle_rad\n0,1\n").unwrap();
    let name = file.to_str().unwrap();
    run(&["compare", name, "thesis-knob"]).failed(2, &["has no column tick", "monitor --csv"]);
    run(&["compare", "missing.csv", "thesis-knob"]).failed(2, &["missing.csv"]);
    run(&[
        "compare",
        name,
        "thesis-knob",
        "--set",
        "wall.surface_rad=1",
    ])
    .failed(2, &["the device's surface"]);
}

#[test]
fn a_programme_is_written_and_what_is_no_recording_of_it_is_named() {
    let here = folder("compare-programme");
    let file = here.join("hand.csv");
    let name = file.to_str().unwrap();
    let mut words = vec!["scorecard", "gimbal-knob", "--programme", name];
    words.extend(["--grip", "medium", "--deed", "press"]);
    let said = run(&words);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.starts_with("grip,deed,time_s,surface_rad,rest_rad\nmedium,press,0.0,0.5,"));
    // 4.45 s with one row per millisecond, and the header.
    assert_eq!(text.lines().count(), 4_451);
    let mut wrong = words.clone();
    wrong[7] = "hop";
    run(&wrong).failed(2, &["not one of press, move-0.25"]);
    let compare = ["compare", name, "gimbal-knob", "--hand", "programme"];
    run(&compare).failed(2, &["has no column penetration_rad"]);
    run(&[&compare[..], &["--from", "1"]].concat()).failed(2, &["--from", "action by action"]);
}
