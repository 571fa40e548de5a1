//! Tests of `touchstone device cogging` and `setup --cogging`: a cogging map is measured, tried, saved and used after the next
//! start; a wrong map is refused.

use crate::folder;
use crate::spun::{Pulled, Spun};
use touchstone_protocol::{KeptCogging, MeasuringPart, Phase, Sweep};
use touchstone_world::motor::{GIMBAL, MotorParameters};
use touchstone_world::plant::train::Harmonic;
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
        reversed: true,
        ..GIMBAL
    };
    let device = Spun::new(motor, &KNOB, number);
    cog(&device);
    device
}

/// Gives the simulated motor cogging torque, which also remains after a power cycle.
fn cog(device: &Spun) {
    let part = |amplitude, per_rev, phase| Harmonic {
        amplitude,
        per_rev,
        phase,
    };
    device.world().1.knob.rig.cogging = vec![part(2e-3, 84.0, 0.4), part(8e-4, 12.0, 1.0)];
}

fn shown(device: &Spun) -> serde_json::Value {
    let said = device.run(&["device", "cogging", "--json"]).done();
    serde_json::from_str(&said).unwrap()
}

#[test]
fn a_map_is_measured_kept_tried_and_forgotten() {
    let device = spun(21);
    device
        .run(&["device", "cogging", "check"])
        .failed(1, &["no map is stored", "cogging measure"]);
    let said = device.run(&["device", "cogging", "measure"]).done();
    assert!(
        said.contains("at most; 84, ") && said.contains(" 12,"),
        "{said}"
    );
    device.power_up();
    cog(&device);
    assert_eq!(shown(&device)["played"], true);
    let said = device.run(&["device", "cogging", "check", "--json"]).done();
    let tried: serde_json::Value = serde_json::from_str(said.trim()).unwrap();
    let of = |name: &str| tried[name].as_f64().unwrap();
    assert!(
        of("ripple_after_rad") < 0.6 * of("ripple_before_rad"),
        "{said}"
    );

    // A map shifted by half a cogging period makes the shaft's ripple larger. The check reports this and does not delete the map.
    let right = bent(&device, |kept| {
        for part in &mut kept.map.harmonics {
            (part.cos, part.sin) = (-part.cos, -part.sin);
        }
    });
    device
        .run(&["device", "cogging", "check"])
        .failed(1, &["% of the ripple without it", "cogging measure"]);
    bent(&device, |kept| *kept = right.clone());
    device.run(&["device", "cogging", "check"]).done();

    // With another number of pole pairs or another counting direction the map is not used; with the old value it is used again.
    for (name, other, back) in [
        ("motor.pole_pairs", "11", "7"),
        ("encoder.reversed", "true", "false"),
    ] {
        device.run(&["config", "set", name, other]).done();
        assert_eq!(shown(&device)["played"], false, "{name}");
        device.run(&["config", "set", name, back]).done();
        assert_eq!(shown(&device)["played"], true, "{name}");
    }
    device.run(&["device", "cogging", "forget"]).done();
    device.power_up();
    assert_eq!(shown(&device)["kept"], false);
}

/// Changes the saved cogging map with `how`; returns the map from before the change.
fn bent(device: &Spun, how: impl FnOnce(&mut KeptCogging)) -> KeptCogging {
    let (session, world) = &mut *device.world();
    let before = session.kept_cogging().cloned().unwrap();
    let mut kept = before.clone();
    how(&mut kept);
    *session = session.clone().with_cogging(Some(kept));
    world.show_map(session);
    before
}

#[test]
fn a_shaft_that_is_held_and_a_cable_that_is_pulled_keep_nothing() {
    let device = spun(22);
    device.world().1.pulled_in = Some(Pulled::In(MeasuringPart::Backward));
    device
        .run(&["device", "cogging", "measure"])
        .failed(1, &["tcp:127.0.0.1:"]);
    device.plug_in();
    assert_eq!(shown(&device)["kept"], false);
    // This friction is more than the sweep's 1 A can move. Current flows without encoder counts: the fault is a stuck encoder.
    let mut stiff = KNOB;
    stiff.friction = Some(Coulomb {
        kinetic: 0.3,
        breakaway: 0.3,
    });
    let held = Spun::new(GIMBAL, &stiff, 23);
    held.run(&["device", "cogging", "measure"])
        .failed(1, &["encoder-stuck"]);
    assert_eq!(shown(&held)["kept"], false);
    // Ends the interrupted sweep, so that it does not continue later.
    held.world().1.knob.device.sweep(Sweep::None);
}

#[test]
fn what_has_no_place_of_its_own_is_refused() {
    let device = spun(24);
    device
        .run(&["config", "set", "encoder.kind", "incremental"])
        .done();
    device.run(&["device", "cogging", "measure"]).failed(
        1,
        &["cannot store a map of the cogging", "magnetic encoder"],
    );
    let out = folder("cogging-incremental").display().to_string();
    device
        .run(&["setup", "--cogging", "--out", &out])
        .failed(2, &["--cogging", "incremental"]);
}

#[test]
fn setup_measures_it_as_its_last_step() {
    let folder = folder("cogging-setup");
    let law = folder.join("given.toml");
    std::fs::write(&law, "[law.estimator]\ninertia_kg_m2 = 0.0001\n").unwrap();
    let (law, out) = (
        law.display().to_string(),
        folder.join("knob").display().to_string(),
    );
    let device = spun(25);
    let said = device
        .run(&["setup", "--cogging", "--out", &out, "--law", &law])
        .done();
    assert!(said.contains("ripple   of a slow turn"), "{said}");
    assert_eq!(shown(&device)["played"], true);
    assert_eq!(
        Phase::from(device.world().1.knob.device.state()),
        Phase::Ready
    );
}
