//! Tests that `--operator-motion` reads the files that the program itself writes.

use crate::{folder, names, run_in};

#[test]
fn a_run_moves_the_hand_of_another() {
    let here = folder("motion");
    run_in(&here, &["run", "thesis-knob", "--out", "out"]).ended(0);
    let csv = names(&here.join("out/traces"))
        .into_iter()
        .find(|name| name.ends_with(".csv"))
        .unwrap();
    let trace = format!("out/traces/{csv}");
    let replayed = |options: &[&str]| {
        let mut arguments = vec!["run", "thesis-knob", "--json", "--operator-motion", &trace];
        arguments.extend(options);
        run_in(&here, &arguments).ended(0)
    };
    let said = replayed(&[]);
    assert!(
        said.err.starts_with("note: ") && said.err.contains(", rest_rad: 4500 samples"),
        "{}",
        said.err
    );
    // With an offset that moves the recorded rest point back to its place, the largest force is nearly the same. Smoothing changes
    // it slightly.
    let text = std::fs::read_to_string(here.join(&trace)).unwrap();
    let mut rows = text.lines().filter(|line| !line.starts_with('#'));
    let place = rows
        .next()
        .unwrap()
        .split(',')
        .position(|name| name == "rest_rad")
        .unwrap();
    let rest: Vec<f64> = rows
        .map(|row| row.split(',').nth(place).unwrap().parse().unwrap())
        .collect();
    let mean = rest.iter().sum::<f64>() / rest.len() as f64 - 0.5;
    let again = replayed(&["--set", &format!("motion.offset_rad={mean}")]).json();
    let before = run_in(&here, &["run", "thesis-knob", "--json"])
        .ended(0)
        .json();
    let force = |results: &serde_json::Value| results["runs"][0]["force_max"].as_f64().unwrap();
    let ratio = force(&again) / force(&before);
    assert!((0.9..1.1).contains(&ratio), "{ratio}");
}

#[test]
fn records_of_a_device_move_a_hand_by_their_new_and_old_names() {
    let here = folder("records");
    for energy in ["energy_observed_j", "energy_j"] {
        let mut text = format!(
            "tick,time_s,count,penetration_rad,force_n_m,offset_rad,{energy},state,fault,limits,cycles,lateness_cycles,current_q_a\n"
        );
        for tick in 0..1000 {
            let angle = 0.1 * (f64::from(tick) * 0.01).sin();
            text += &format!(
                "{tick},{},0,{angle},0,0.5,0,armed,,,100,1,0\n",
                f64::from(tick) * 1e-3
            );
        }
        std::fs::write(here.join("device.csv"), text).unwrap();
        let said = run_in(
            &here,
            &[
                "run",
                "tap",
                "--operator-motion",
                "device.csv",
                // This hand moves until the end of the run, so there is no hold to judge.
                "--expect",
                "not-judged",
            ],
        )
        .ended(0);
        assert!(
            said.err
                .contains("device.csv, penetration_rad: 1000 samples"),
            "{}",
            said.err
        );
    }
}
