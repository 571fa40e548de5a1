//! Tests that the command-line program repeats a recorded run of the live page bit for bit, from the hand's recorded rest points.

use std::path::PathBuf;
use touchstone_live::desk::{Desk, ROW, TRACE_COLUMNS, scene};
use touchstone_sim::run;
use touchstone_sim::scene::Scene;

/// Rest point of the simulated hand's spring at a control period, in radians, as from a mouse: pushes in, trembles, lets go, each
/// jerkily.
fn pointer_rad(tick: u64, reach_rad: f64) -> f64 {
    let t = tick as f64 * 1e-3;
    // Steps of a pointer that is read 60 times a second.
    let seen = (t * 60.0).floor() / 60.0;
    let push = reach_rad * 0.08 * (2.1 * seen).sin().max(-0.02);
    0.45 + push + 0.003 * (31.0 * seen).sin()
}

struct File(PathBuf);

impl Drop for File {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// Simulates a scene (TOML text) as the page does, with the hand motion of `pointer_rad`. Replays the recorded motion with the
/// command-line program's code, and asserts equal columns. Returns the number of control periods with a force.
fn replayed(name: &str, text: &str) -> usize {
    let mut desk = Desk::default();
    let handle = desk.open(text).unwrap();
    let reach_rad = desk.facts(handle).unwrap()[4];
    let rows: Vec<[f64; ROW.len()]> = (0..3000)
        .map(|tick| {
            *desk
                .tick(handle, pointer_rad(tick, reach_rad))
                .expect("it is open")
        })
        .collect();
    let csv = std::env::temp_dir().join(format!("live-{}-{name}.csv", std::process::id()));
    let mut file = format!("{}\n", ROW[..TRACE_COLUMNS].join(","));
    for row in &rows {
        let cells: Vec<String> = row[..TRACE_COLUMNS].iter().map(f64::to_string).collect();
        file += &format!("{}\n", cells.join(","));
    }
    std::fs::write(&csv, file).unwrap();
    let csv = File(csv);
    let again = desk.replay(handle, &csv.0.to_string_lossy());
    let again = Scene::parse(&again, &PathBuf::from("again.toml")).unwrap();
    let trace = run::run(&again, true).unwrap().trace.unwrap();
    for (name, (column, values)) in ROW.iter().zip(trace.columns().iter().enumerate()) {
        assert_eq!(values.len(), rows.len());
        for (tick, (live, again)) in rows.iter().map(|row| row[column]).zip(*values).enumerate() {
            assert!(
                live.to_bits() == again.to_bits() || (live.is_nan() && again.is_nan()),
                "{name} at tick {tick}: {live:e} live, {again:e} again"
            );
        }
    }
    rows.iter().filter(|row| row[6] != 0.0).count()
}

#[test]
fn a_recorded_hand_gives_the_same_run_to_the_bit() {
    let laws = [
        "spring",
        "spring-damper",
        "tdpa",
        "fba",
        "sfa",
        "enhanced-sfa",
    ];
    for law in laws {
        for preset in ["thesis", "shipped"] {
            let text = format!("thesis-knob\0law.kind={law}\npreset={preset}\n");
            let touched = replayed(&format!("{law}-{preset}"), &text);
            assert!(
                touched > 100,
                "{law}, {preset}: a force in {touched} ticks only"
            );
        }
    }
}

#[test]
fn delay_friction_format_rate_and_grip_are_no_exceptions() {
    for (name, changes) in [
        ("delay", "timing.computational_delay_s=0.0013"),
        ("ideal", "device.friction=none\nencoder=none"),
        ("number", "law.number=f64"),
        // At this rate the estimator's default prediction time is more than two ticks.
        ("rate", "timing.rate_hz=3000\nlaw.states=measured"),
        ("guard", "law.guard.on=true\nlaw.kind=spring"),
        ("grip", "operator.grip=firm\nwall.k_desired_n_m_per_rad=20"),
    ] {
        let touched = replayed(name, &format!("thesis-knob\0{changes}\n"));
        assert!(touched > 100, "{name}: a force in {touched} ticks only");
    }
}

#[test]
fn a_change_keeps_device_and_hand_where_they_are() {
    let mut desk = Desk::default();
    let handle = desk.open("thesis-knob").unwrap();
    let mut last = [0.0; ROW.len()];
    for tick in 0..800 {
        last = *desk.tick(handle, pointer_rad(tick, 5.0)).unwrap();
    }
    desk.change(handle, "thesis-knob\0law.kind=spring\n")
        .unwrap();
    let next = *desk.tick(handle, last[5]).unwrap();
    assert_eq!(next[0], 0.0, "time starts again");
    assert!((next[1] - last[1]).abs() < 1e-2 && next[1] > 0.5);
    assert!((next[4] - last[4]).abs() < 1e-2);

    let error = desk
        .change(handle, "thesis-knob\0law.kind=rubber\n")
        .unwrap_err();
    assert!(
        error.to_string().starts_with("--set law.kind=rubber: "),
        "{error}"
    );
    let error = desk
        .open("thesis-knob\0wall.k_desired_n_m_per_rad=-1\n")
        .unwrap_err();
    assert!(
        error.to_string().contains("must be between 0 and 500000"),
        "{error}"
    );
    assert!(desk.tick(handle, 0.0).is_some(), "it goes on as it was");
    desk.close(handle);
    assert!(desk.tick(handle, 0.0).is_none());
}

#[test]
fn an_exact_record_refuses_to_be_moved() {
    let text = format!(
        "[operator]\ngrip = \"medium\"\n[operator.motion]\nkind = \"recorded\"\nfile = {:?}\nexact = true\nscale = 2.0\n",
        env!("CARGO_MANIFEST_PATH")
    );
    let error = scene(&text).unwrap_err().to_string();
    assert!(error.contains("operator.motion.exact"), "{error}");
}
