//! Tests of `touchstone device eccentricity` and `touchstone setup` with an encoder whose magnet is off the axis. The error is
//! measured, reported and written into the scene for the simulator; a large error causes a warning.

use super::spun::Spun;
use super::{folder, run};
use serde_json::Value;
use touchstone_protocol::Phase;
use touchstone_tests::knob::EncoderError;
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

/// A device whose encoder error has these amplitudes in degrees, once and twice per turn.
fn spun(number: u8, degrees: [f64; 2]) -> Spun {
    let motor = MotorParameters {
        electrical_zero_rad: 2.0,
        ..GIMBAL
    };
    let device = Spun::new(motor, &KNOB, number);
    device.world().1.knob.encoder_error = (1..)
        .zip(degrees)
        .map(|(order, degrees)| EncoderError {
            amplitude_rad: degrees.to_radians(),
            per_rev: f64::from(order),
            phase_rad: 0.4,
        })
        .collect();
    device
}

/// Amplitudes of the measured encoder error, once and twice per turn, in degrees.
fn amplitudes(found: &Value) -> [f64; 2] {
    [0, 1].map(|index| {
        let it = &found["harmonics"][index]["amplitude_rad"];
        it.as_f64().unwrap().to_degrees()
    })
}

/// Checks that the measured amplitudes are within one encoder count, 0.022 degrees, of the true ones.
fn near(found: [f64; 2], truth: [f64; 2]) {
    for (found, truth) in found.into_iter().zip(truth) {
        assert!((found - truth).abs() < 0.022, "{found} for {truth}");
    }
}

#[test]
fn a_magnet_is_measured_and_nothing_of_the_device_is_changed() {
    let device = spun(31, [0.5, 0.3]);
    let before = device
        .run(&["config", "get", "calibration.measures"])
        .done();
    let said = device.run(&["device", "eccentricity", "measure", "--json"]);
    let found: Value = serde_json::from_str(said.done().trim()).unwrap();
    near(amplitudes(&found), [0.5, 0.3]);
    assert!(found["reseat_magnet"].is_null(), "{found}");
    {
        let (session, world) = &*device.world();
        assert_eq!(
            Phase::from(world.knob.device.state()),
            Phase::Stopped,
            "it ends at rest"
        );
        assert_eq!(session.settings().limits.host_silence_s, 2);
    }
    let after = device
        .run(&["config", "get", "calibration.measures"])
        .done();
    assert_eq!(before, after);

    device.run(&["device", "calibrate"]).done();
    device.run(&["--quiet", "device", "arm"]).done();
    device
        .run(&["device", "eccentricity", "measure"])
        .failed(1, &["the wall is on", "touchstone device stop"]);
}

#[test]
fn a_magnet_that_is_far_out_is_warned_of_with_the_reason() {
    let said = spun(32, [2.2, 0.3]).run(&["device", "eccentricity", "measure"]);
    assert!(
        said.err.contains("mount the encoder's magnet again"),
        "{}",
        said.err
    );
    assert!(said.err.contains("electrical degrees off"), "{}", said.err);
    assert_eq!(said.code, Some(0));
    assert!(
        said.out.contains("once a turn") && said.out.contains("2.2"),
        "{}",
        said.out
    );
    let said = spun(33, [0.0, 1.8]).run(&["device", "eccentricity", "measure"]);
    assert!(said.err.contains("stiffness is 6 % off"), "{}", said.err);
    let centred = spun(34, [0.0, 0.0]).run(&["device", "eccentricity", "measure"]);
    assert!(!centred.err.contains("mount the"), "{}", centred.err);
    assert!(centred.done().contains("none above 0.0"));
}

#[test]
fn setup_tells_it_and_the_simulator_plays_it() {
    let folder = folder("eccentricity-setup");
    let law = folder.join("given.toml");
    std::fs::write(&law, "[law.estimator]\ninertia_kg_m2 = 0.0001\n").unwrap();
    let (law, out) = (law.display().to_string(), folder.join("knob"));
    let device = spun(35, [0.7, 0.4]);
    let place = out.display().to_string();
    let setup = ["setup", "--out", &place, "--law", &law];
    device.run(&setup).done();
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let kept: Value = serde_json::from_str(&read("setup.json")).unwrap();
    near(amplitudes(&kept["encoder"]), [0.7, 0.4]);
    let page = read("report/index.html");
    assert!(page.contains("encoder's error twice a turn") || page.contains("error twice a turn"));

    // The scene contains the same values, and it can be run.
    let scene = read("knob.toml");
    let of = |name: &str| -> f64 {
        let line = scene.lines().find(|line| line.starts_with(name)).unwrap();
        line.rsplit(' ').next().unwrap().parse().unwrap()
    };
    near(
        [of("amplitude_rad"), of("second_amplitude_rad")].map(f64::to_degrees),
        [0.7, 0.4],
    );
    let phase = kept["encoder"]["harmonics"][1]["phase_rad"]
        .as_f64()
        .unwrap();
    assert!((of("second_phase_rad") - phase).abs() < 1e-3);
    let knob = out.join("knob.toml").display().to_string();
    let said = run(&["run", &knob]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    // The energy guard of scene and board is configured for the whole error. An error of this size leaves too little energy for
    // hard presses.
    let told = of("position_error_rad").to_degrees();
    assert!((1.1..1.2).contains(&told), "{told}");
    assert!(said.err.contains("law.guard.capacity_j"), "{}", said.err);
    let of_board = device
        .run(&["config", "get", "law.position_error_rad"])
        .done();
    assert!(
        of_board.contains("0.0193") || of_board.contains("0.0192"),
        "{of_board}"
    );

    // A second setup reports the stored measurement and does not measure again.
    let calibrations = device.world().1.counted().1;
    let said = device.run(&[&setup[..], &["--json"]].concat()).done();
    assert_eq!(device.world().1.counted().1, calibrations + 1);
    let again: Value = serde_json::from_str(said.trim()).unwrap();
    assert_eq!(again["encoder"], kept["encoder"]);
    // For an encoder without this error, the scene contains none.
    let centred = spun(36, [0.0, 0.0]);
    let place = folder.join("centred").display().to_string();
    centred
        .run(&["setup", "--out", &place, "--law", &law])
        .done();
    let scene = std::fs::read_to_string(folder.join("centred/knob.toml")).unwrap();
    assert!(!scene.contains("[sensor.periodic]"), "{scene}");
}
