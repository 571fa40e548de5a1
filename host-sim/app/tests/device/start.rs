//! Tests of `touchstone device alignment` and `autostart`: data that the device saves for its next start.

use crate::fake::{Fake, Trouble};
use crate::folder;
use crate::spun::Spun;
use touchstone_protocol::{KeptAlignment, KeptStart, Phase};
use touchstone_world::motor::{GIMBAL, MotorParameters};
use touchstone_world::plant::{Coulomb, Device};

const KNOB: Device = Device {
    inertia: 1e-4,
    damping: 4e-4,
    friction: Some(Coulomb {
        kinetic: 1e-3,
        breakaway: 1e-3,
    }),
};

fn spun(number: u8) -> Spun {
    let motor = MotorParameters {
        electrical_zero_rad: 2.0,
        ..GIMBAL
    };
    Spun::new(motor, &KNOB, number)
}

fn status(device: &Spun) -> serde_json::Value {
    let said = device.run(&["device", "status", "--json"]).done();
    serde_json::from_str(&said).unwrap()
}

#[test]
fn an_alignment_is_kept_checked_used_and_forgotten() {
    let device = spun(11);
    device
        .run(&["device", "alignment", "keep"])
        .failed(1, &["state `boot`", "touchstone device calibrate"]);
    device.run(&["device", "calibrate"]).done();
    assert_eq!(status(&device)["start"]["was_checked"], false);
    let said = device.run(&["device", "alignment", "keep"]).done();
    assert_eq!(said, "stored and saved; the check passed\nready\n");
    assert_eq!(status(&device)["start"]["was_checked"], true);

    // The next start uses the stored alignment.
    device.power_up();
    let said = device.run(&["device", "status"]).done();
    for part in [
        "alignment stored; the next calibration checks it",
        "autostart off",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    device.run(&["device", "calibrate"]).done();
    assert_eq!(status(&device)["start"]["was_checked"], true);
    // The alignment was measured with seven pole pairs, so it is not valid with eleven.
    device.run(&["device", "stop"]).done();
    device
        .run(&["config", "set", "motor.pole_pairs", "11"])
        .done();
    let said = device.run(&["device", "status"]).done();
    assert!(
        said.contains("NOT USED: it was measured with another number of pole pairs"),
        "{said}"
    );
    device.run(&["device", "autostart", "on"]).failed(
        1,
        &["another number of pole pairs", "device alignment keep"],
    );
    device
        .run(&["config", "set", "motor.pole_pairs", "7"])
        .done();

    device.run(&["device", "alignment", "forget"]).done();
    device.power_up();
    device.run(&["device", "calibrate"]).done();
    assert_eq!(status(&device)["start"]["alignment_is_kept"], false);
    assert_eq!(status(&device)["start"]["was_checked"], false);
}

/// Adds `by` to the saved alignment offset, in units of 1/65,536 turn.
fn bend(device: &Spun, by: u16) {
    let (session, world) = &mut *device.world();
    let mut kept = *session.kept();
    let alignment = kept.alignment.as_mut().unwrap();
    alignment.offset = alignment.offset.wrapping_add(by);
    world.knob.device.keep(Some((*alignment).into()));
    *session = session.clone().with_kept(kept);
}

#[test]
fn a_wrong_one_is_refused_and_looked_for_anew() {
    let device = spun(12);
    device.run(&["device", "calibrate"]).done();
    device.run(&["device", "alignment", "keep"]).done();
    device.run(&["device", "stop"]).done();
    // Changes the stored alignment by a quarter turn.
    bend(&device, 0x4000);
    device.run(&["device", "calibrate"]).failed(
        1,
        &["check of the stored alignment failed", "calibrate --anew"],
    );
    device.run(&["device", "arm"]).failed(1, &["state `fault`"]);
    let said = device.run(&["device", "fault"]).done();
    assert!(
        said.contains("10 calibration-failed") && said.contains("value  7"),
        "{said}"
    );
    device.run(&["device", "stop"]).done();
    device.run(&["device", "calibrate", "--anew"]).done();
    device.run(&["device", "alignment", "keep"]).done();
    let (_, world) = &*device.world();
    assert_eq!(Phase::from(world.knob.device.state()), Phase::Ready);
}

#[test]
fn a_start_by_itself_is_asked_for_saved_shown_and_taken_back() {
    let device = spun(13);
    device
        .run(&["device", "autostart", "on"])
        .failed(1, &["no alignment is stored", "device alignment keep"]);
    device.run(&["device", "calibrate"]).done();
    device.run(&["device", "alignment", "keep"]).done();
    // In the state `ready` the board cannot save, so that nothing is changed.
    device
        .run(&["device", "autostart", "on"])
        .failed(1, &["does not save in state `ready`", "device stop"]);
    assert_eq!(status(&device)["start"]["autostart"], false);
    device.run(&["device", "stop"]).done();
    let said = device.run(&["device", "autostart", "on"]).done();
    assert!(said.contains("THE SHAFT MOVES"), "{said}");
    // A board that starts without a computer must not switch off because it gets no requests.
    assert_eq!(device.world().0.settings().limits.host_silence_s, 0);
    device.power_up();
    let said = device.run(&["device", "autostart"]).done();
    assert!(said.contains("autostart  on; at this start:"), "{said}");
    // Other settings may change without an effect on autostart.
    device.run(&["config", "defaults"]).done();
    assert_eq!(status(&device)["start"]["autostart"], true);
    device
        .run(&["config", "set", "limits.host_silence_s", "0"])
        .done();
    device.run(&["device", "autostart", "off"]).done();
    device.power_up();
    assert_eq!(status(&device)["start"]["autostart"], false);
    assert_eq!(device.world().0.settings().limits.host_silence_s, 2);
}

#[test]
fn what_has_no_zero_of_its_own_is_refused_with_the_reason() {
    let device = spun(14);
    device
        .run(&["config", "set", "encoder.kind", "incremental"])
        .done();
    device.run(&["config", "save"]).done();
    // The board starts with the incremental encoder, which has no zero of its own.
    device.power_up();
    device.run(&["device", "calibrate"]).done();
    device
        .run(&["device", "alignment", "keep"])
        .failed(1, &["an incremental encoder counts from", "at each start"]);
    let small = Fake::with(Trouble {
        small: true,
        ..Trouble::default()
    });
    for command in ["alignment", "autostart"] {
        small
            .run(&["device", command])
            .failed(1, &["b-g431b-esc1", "no connector", "NUCLEO-G474RE"]);
    }
    let said = small.run(&["device", "status"]).done();
    assert!(
        said.contains("alignment cannot be stored on this board"),
        "{said}"
    );
    let law = folder("start-setup").join("law.toml");
    std::fs::write(&law, "[law.estimator]\ninertia_kg_m2 = 0.0001\n").unwrap();
    let out = law.with_file_name("knob").display().to_string();
    let law = law.display().to_string();
    small
        .run(&["setup", "--out", &out, "--law", &law, "--keep-alignment"])
        .failed(2, &["--keep-alignment", "incremental", "leave it out"]);
}

/// Checks the error if the encoder would allow a saved alignment, but the board has no memory for it.
#[test]
fn the_kits_board_says_that_it_has_no_room() {
    let kit = Fake::with(Trouble {
        kit: true,
        ..Trouble::default()
    });
    for command in ["alignment", "autostart"] {
        kit.run(&["device", command]).failed(
            1,
            &["nucleo-g431rb-ihm16m1", "too little flash", "NUCLEO-G474RE"],
        );
    }
    kit.run(&["device", "cogging", "measure"])
        .failed(1, &["too little flash", "NUCLEO-G474RE"]);
    kit.run(&["config", "set", "encoder.kind", "mt6701"]).done();
    let law = folder("start-kit").join("law.toml");
    std::fs::write(&law, "[law.estimator]\ninertia_kg_m2 = 0.0001\n").unwrap();
    let out = law.with_file_name("knob").display().to_string();
    let law = law.display().to_string();
    for option in ["--keep-alignment", "--cogging"] {
        kit.run(&["setup", "--out", &out, "--law", &law, option])
            .failed(2, &[option, "too little flash", "leave it out"]);
    }
}

#[test]
fn a_setup_keeps_it_where_it_is_asked_to() {
    let device = spun(15);
    let folder = folder("start-setup-keeps");
    let law = folder.join("law.toml");
    std::fs::write(&law, "[law.estimator]\ninertia_kg_m2 = 0.0001\n").unwrap();
    let (out, law) = (
        folder.join("knob").display().to_string(),
        law.display().to_string(),
    );
    let setup = |more: &[&str]| {
        let all = [&["setup", "--out", &out, "--law", &law], more].concat();
        device.run(&all).done()
    };
    assert!(setup(&[]).contains("touchstone device alignment keep"));
    assert_eq!(status(&device)["start"]["alignment_is_kept"], false);
    let said = setup(&["--keep-alignment"]);
    assert!(
        said.contains("stores the alignment and checks it"),
        "{said}"
    );
    device.power_up();
    assert_eq!(status(&device)["start"]["alignment_is_usable"], true);
}

/// Checks that `alignment keep` saves what the calibration found, and that its own stop and check do not change the saved
/// alignment.
#[test]
fn what_is_kept_is_what_the_calibration_found() {
    let device = spun(16);
    device.run(&["device", "calibrate"]).done();
    let found = device.world().1.knob.device.found().unwrap();
    device.run(&["device", "alignment", "keep"]).done();
    let (session, _) = &*device.world();
    let settings = session.settings();
    let board = touchstone_protocol::Board::NucleoG474re;
    assert_eq!(
        *session.kept(),
        KeptStart {
            alignment: Some(KeptAlignment::new(
                found.offset.0,
                found.against,
                settings,
                board
            )),
            autostart: false,
        }
    );
}
