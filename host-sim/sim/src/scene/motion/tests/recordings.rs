//! Tests of recordings: reading, bad input, placement on the wall, and one real recording.

use std::path::{Path, PathBuf};

use crate::scene::{MotionSpec, Recording, RestPath, SMOOTHING_HZ, Scene};

fn parse(text: &str) -> Recording {
    Recording::parse(text, Path::new("m.csv")).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn refused(text: &str, expected: &str) {
    let message = Recording::parse(text, Path::new("m.csv"))
        .expect_err("this must be refused")
        .to_string();
    assert_eq!(message, expected);
}

#[test]
fn units_come_from_the_header() {
    let close = |a: &[f64], b: &[f64]| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
    };
    for (header, time, angle) in [
        ("time_s,angle_rad", 1.0, 1.0),
        ("t_ms,position_mrad", 1e-3, 1e-3),
        ("timestamp_us,theta_deg", 1e-6, std::f64::consts::PI / 180.0),
        ("Time [s], Knob turn (rev)", 1.0, std::f64::consts::TAU),
        ("s,deg", 1.0, std::f64::consts::PI / 180.0),
    ] {
        let recording = parse(&format!("{header}\n10,1\n20,3\n40,-2\n"));
        assert!(
            close(recording.times_s(), &[0.0, 10.0 * time, 30.0 * time]),
            "{header}: {recording:?}"
        );
        assert!(
            close(recording.angles_rad(), &[angle, 3.0 * angle, -2.0 * angle]),
            "{header}: {recording:?}"
        );
    }
}

#[test]
fn other_columns_comments_and_order_do_not_matter() {
    let text = "\u{feff}# paddle\nforce_n_m,angle_rad,speed_deg_per_s,remark,time_s\n9,1,7,,0\n# pause\n9,2,7,\"a, b\",1\r\n";
    let recording = parse(text);
    assert_eq!(
        (recording.times_s(), recording.angles_rad()),
        (&[0.0, 1.0][..], &[1.0, 2.0][..])
    );
}

#[test]
fn the_programs_own_files_have_several_angles_and_one_of_them_is_meant() {
    // A simulation's trace, a trace without the hand's columns, a device's records, and a device's records in an older format.
    for (text, expected) in [
        (
            "time_s,angle_rad,velocity_rad_per_s,angle_measured_rad,hand_rad,rest_rad,force_n_m,surface_rad\n\
             0,1,2,3,4,5,6,7\n1,11,12,13,14,15,16,17\n",
            [5.0, 15.0],
        ),
        (
            "time_s,angle_rad,angle_measured_rad,force_n_m,surface_rad\n0,1,2,3,4\n1,11,12,13,14\n",
            [1.0, 11.0],
        ),
        (
            "tick,time_s,count,penetration_rad,force_n_m,offset_rad,energy_observed_j,state\n\
             9,0,4,0.5,0,0.25,0,armed\n10,1,4,-0.5,0,0.25,0,armed\n",
            [0.5, -0.5],
        ),
        (
            "tick,time_s,count,penetration_rad,force_n_m,offset_rad,energy_j,state\n\
             9,0,4,0.5,0,0.25,0,armed\n10,1,4,-0.5,0,0.25,0,armed\n",
            [0.5, -0.5],
        ),
    ] {
        let recording = parse(text);
        assert_eq!(recording.angles_rad(), expected, "{text}");
        assert_eq!(recording.times_s(), [0.0, 1.0], "{text}");
    }
    // In other files two columns of angles are ambiguous.
    refused(
        "time_s,angle_rad,rest_rad\n0,1,1\n1,2,2\n",
        "m.csv:1: angle: both angle_rad and rest_rad fit; keep one of the two columns",
    );
}

#[test]
fn the_mean_is_over_time_not_over_samples() {
    // One second at angle 0 with many samples, then one second of a straight rise to 1.
    let recording = parse("time_s,angle_rad\n0,0\n0.25,0\n0.5,0\n0.75,0\n1,0\n2,1\n");
    assert!((recording.mean_rad() - 0.25).abs() < 1e-12);
}

#[test]
fn bad_headers() {
    refused(
        "",
        "m.csv:1: header: the file is empty; give a header such as time_s,angle_deg and one row for each sample",
    );
    refused(
        "time,angle_deg\n0,1\n1,2\n",
        "m.csv:1: time: no column with a time unit among time, angle_deg; end the column's name in one of _s, _ms, _us, _ns",
    );
    refused(
        "# made by hand\ntime_s,angle\n0,1\n1,2\n",
        "m.csv:2: angle: no column with an angle unit among time_s, angle; end the column's name in one of _rad, _mrad, _deg, _rev",
    );
    refused(
        "time_s,speed_deg_per_s\n0,1\n1,2\n",
        "m.csv:1: angle: no column with an angle unit among time_s, speed_deg_per_s; \
         end the column's name in one of _rad, _mrad, _deg, _rev",
    );
    refused(
        "time_s,angle_deg,target_deg\n0,1,1\n1,2,2\n",
        "m.csv:1: angle: both angle_deg and target_deg fit; keep one of the two columns",
    );
    refused(
        "time_s;angle_deg\n0;1\n",
        "m.csv:1: header: time_s;angle_deg is one column; separate time and angle by commas, with a point in the numbers",
    );
}

#[test]
fn bad_rows() {
    let head = "time_s,angle_deg\n";
    let bad = |rows: &str, expected: &str| refused(&format!("{head}{rows}"), expected);
    bad(
        "",
        "m.csv:1: time_s: no row of numbers is not a motion; give two rows or more, one for each sample",
    );
    bad(
        "0,1\n",
        "m.csv:2: time_s: one row of numbers is not a motion; give two rows or more, one for each sample",
    );
    bad(
        "0,1\n1,NaN\n2,3\n",
        "m.csv:3: angle_deg: NaN is not a finite number; remove the row or fill the gap",
    );
    bad(
        "0,1\n-inf,2\n",
        "m.csv:3: time_s: -inf is not a finite number; remove the row or fill the gap",
    );
    bad(
        "0,1\n1,two\n",
        "m.csv:3: angle_deg: \"two\" is not a number; write numbers such as 0.25 or 2.5e-1",
    );
    bad(
        "0,1\n1,\n",
        "m.csv:3: angle_deg: is empty; complete or remove the row",
    );
    bad(
        "0,1\n1\n",
        "m.csv:3: row: 1 cells, where the header has 2; put texts and numbers with commas in quotes, or write decimals with a point",
    );
    bad(
        "0,1\n2,1\n1,1\n",
        "m.csv:4: time_s: 1 comes after 2, but times must rise; sort the rows by time and remove repeated ones",
    );
    bad(
        "0,1\n2,1\n\n2,1\n",
        "m.csv:5: time_s: 2 comes after 2, but times must rise; sort the rows by time and remove repeated ones",
    );
    bad(
        "0,1\n1e9,1\n",
        "m.csv:1: time_s: the recording takes 1000000000 s, too long to smooth in steps of at most 1 ms; \
         check the unit of time, or cut the recording to an hour",
    );
}

#[test]
fn files_that_cannot_be_read() {
    let message = Recording::read(Path::new("no/such.csv"))
        .unwrap_err()
        .to_string();
    assert_eq!(
        message,
        "no/such.csv: no such file; give the path of a CSV file with time and angle"
    );
    let folder = TempFolder::new("latin");
    let path = folder.write("latin.csv", b"time_s,angle_\xb0\n0,1\n1,2\n");
    let message = Recording::read(&path).unwrap_err().to_string();
    assert_eq!(
        message,
        format!(
            "{}: is not text in UTF-8: line 1 has the byte 0xb0; export the recording as CSV in UTF-8",
            path.display()
        )
    );
}

#[test]
fn a_recording_named_in_a_scene_lies_beside_it_and_is_placed_on_the_wall() {
    let folder = TempFolder::new("placed");
    let rows: String = (0..=400)
        .map(|i| format!("{},{}\n", 5 * i, if i < 200 { -100 } else { 300 }))
        .collect();
    folder.write("hand.csv", format!("time_ms,angle_mrad\n{rows}").as_bytes());
    let text = b"[operator]\ngrip = \"light\"\n[operator.motion]\nkind = \"recorded\"\nfile = \"hand.csv\"\nscale = -2\noffset_rad = 0.1\n";
    let scene = Scene::load(folder.write("s.toml", text).to_str().expect("a plain path")).unwrap();
    let motion = RestPath::from_scene(&scene).unwrap();
    // Area -0.1 · 0.995 + 0.1 · 0.005 + 0.3 · 1 over 2 s: mean 0.1005 rad; then 0.6 - 2·(angle - mean).
    assert!(
        (motion.rest_rad(0.5) - 1.001).abs() < 1e-9,
        "{}",
        motion.rest_rad(0.5)
    );
    assert!(
        (motion.rest_rad(1.5) - 0.201).abs() < 1e-9,
        "{}",
        motion.rest_rad(1.5)
    );
    assert!((scene.start_rad(&motion) - 1.001).abs() < 1e-9);
    let note = motion.note().expect("a recording says what was chosen");
    let expected = "401 samples, 2.00 s at 200 Hz; rest point = surface 0.500 rad + offset 0.100 rad + -2 × (angle - mean 0.101 rad), \
                    from 0.201 to 1.001 rad, inside the wall 50 % of the time";
    // The step between two samples is faster than any hand.
    let odd = "; 80 rad/s near 1.000 s is faster than a hand";
    assert!(note.contains(&format!("{expected}{odd}")), "{note}");
    assert!(!note.contains("plays the first"), "{note}");
    // A shorter run says which part it plays, also of a recording that is played unchanged.
    let said = |sets: &[&str]| {
        let path = RestPath::from_scene(&scene.with_overrides(sets).unwrap()).unwrap();
        path.note().map(str::to_owned)
    };
    let cut = "the run plays the first 0.8 s: give timing.duration_s = 2.000 for all of it";
    let note = said(&["timing.duration_s=0.8"]).expect("a note");
    assert!(
        note.contains(odd) && note.ends_with(&format!("; {cut}")),
        "{note}"
    );
    let exact = [
        "operator.motion.scale=1",
        "operator.motion.offset_rad=0",
        "operator.motion.exact=true",
    ];
    assert_eq!(said(&exact), None);
    let note = said(&[&exact[..], &["timing.duration_s=0.8"]].concat()).expect("a note");
    assert!(note.ends_with(cut), "{note}");
}

#[test]
fn a_recording_replaces_a_scenes_motion() {
    let folder = TempFolder::new("replaces");
    let file = folder.write("hand.csv", b"time_s,angle_deg\n0,0\n1,10\n2.5,0\n");
    let press = Scene::load("thesis-knob").unwrap();
    let scene = press.with_recording(&file).unwrap();
    assert_eq!(
        (scene.timing.duration_s, scene.hold_window_s()),
        (2.5, None)
    );
    assert_eq!(
        (&scene.device, &scene.wall, &scene.law),
        (&press.device, &press.wall, &press.law)
    );
    let bigger = scene.with_overrides(&["motion.scale=3"]).unwrap();
    let reach = |scene| {
        RestPath::from_scene(scene)
            .map(|motion| motion.rest_rad(1.0) - 0.5)
            .unwrap()
    };
    assert!((reach(&bigger) - 3.0 * reach(&scene)).abs() < 1e-9);
    assert!(matches!(bigger.operator.motion, MotionSpec::Recorded(_)));

    let option = format!("--operator-motion {}", file.display());
    let message = Scene::load("free-release")
        .unwrap()
        .with_recording(&file)
        .unwrap_err()
        .to_string();
    let expected = "no hand holds the device in the scene free-release; add --set operator.grip=medium before it";
    assert_eq!(message, format!("{option}: {expected}"));
}

/// Tests a real recording of a hand on a paddle: 15.2 s at 200 Hz, sensor step 0.049°. The recording is not part of the repository;
/// the test passes without it.
#[test]
fn the_paddle_recording_drives_the_hand_in_and_out_of_the_wall() {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data/paddle-hand-motion-200hz.csv");
    if !file.is_file() {
        println!("skipped: the recording paddle-hand-motion-200hz.csv is not on this machine");
        return;
    }
    let recording = Recording::read(&file).unwrap();
    assert_eq!(recording.times_s().len(), 3046);
    assert!(
        (recording.length_s() - 15.225).abs() < 1e-9
            && (recording.interval_s() - 0.005).abs() < 1e-9
    );

    let scene = Scene::load("thesis-knob")
        .and_then(|scene| scene.with_recording(&file))
        .unwrap();
    let motion = RestPath::from_scene(&scene).unwrap();
    println!("{}", motion.note().unwrap());
    let path: Vec<f64> = (0..scene.timing.ticks())
        .map(|tick| motion.rest_rad(tick as f64 * 1e-3))
        .collect();
    let crossings = path
        .windows(2)
        .filter(|pair| (pair[0] < 0.5) != (pair[1] < 0.5))
        .count();
    assert!(crossings >= 20, "in and out: {crossings} crossings");

    // The curve stays near the samples, because a low-pass at 20 Hz hardly changes a hand's motion.
    let mean = recording.mean_rad();
    let samples = recording.times_s().iter().zip(recording.angles_rad());
    let off: Vec<f64> = samples
        .map(|(t, x)| motion.rest_rad(*t) - 0.5 - (x - mean))
        .collect();
    let rms = (off.iter().map(|d| d * d).sum::<f64>() / off.len() as f64).sqrt();
    assert!(rms < 0.5_f64.to_radians(), "rms {} deg", rms.to_degrees());

    // No step of the sensor is left: the slope never changes faster than the low-pass allows. A record
    // that spans S and passes a Gaussian of standard deviation σ has no second derivative above S/2 · 0.968/σ² (the
    // Gaussian's own variation).
    let sigma = 2.0_f64.ln().sqrt() / (std::f64::consts::TAU * SMOOTHING_HZ);
    let span = (24.192_730_f64 + 21.640_961).to_radians();
    let bend = path
        .windows(3)
        .map(|p| (p[2] - 2.0 * p[1] + p[0]).abs() / 1e-6)
        .fold(0.0, f64::max);
    assert!(bend < 0.5 * span * 0.968 / (sigma * sigma), "{bend} rad/s²");
    let jumps = recording
        .angles_rad()
        .windows(3)
        .map(|p| (p[2] - 2.0 * p[1] + p[0]).abs() / 25e-6)
        .fold(0.0, f64::max);
    assert!(
        bend < 0.5 * jumps,
        "{bend} against {jumps} rad/s² in the record"
    );
}

/// A temporary folder that is deleted when the value is dropped.
struct TempFolder(PathBuf);

impl TempFolder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("touchstone-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a temporary folder");
        TempFolder(path)
    }

    fn write(&self, name: &str, content: &[u8]) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, content).expect("a temporary file");
        path
    }
}

impl Drop for TempFolder {
    fn drop(&mut self) {
        // An error is ignored: the folder then stays in the system's temporary folder.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
