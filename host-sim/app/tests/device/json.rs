//! Tests of `--json` and `--quiet` with the commands that connect to a device.

use crate::fake::Fake;
use crate::folder;
use touchstone_protocol::FaultCode;

fn json(device: &Fake, arguments: &[&str]) -> serde_json::Value {
    let mut all = arguments.to_vec();
    all.push("--json");
    serde_json::from_str(&device.run(&all).done()).unwrap()
}

#[test]
fn programs_get_the_same_as_people() {
    let device = Fake::new();
    let status = json(&device, &["device", "status"]);
    assert_eq!(status["state"], "boot");
    assert!(status["ticks"].is_u64() && status["fault"].is_null());
    assert!(status["board"].is_string() && status["settings_unsaved"].is_boolean());

    let wall = json(&device, &["config", "get", "wall.k_desired_n_m_per_rad"]);
    assert_eq!(wall["settings"][0]["path"], "wall.k_desired_n_m_per_rad");
    assert_eq!(wall["settings"][0]["unit"], "N·m/rad");
    let before = wall["settings"][0]["value"].as_f64().unwrap();
    let set = ["config", "set", "wall.k_desired_n_m_per_rad", "0.75"];
    assert!(before != 0.75);
    let changed = json(&device, &set);
    assert_eq!(changed["written"], true);
    assert_eq!(changed["changed"][0]["before"].as_f64(), Some(before));
    assert_eq!(changed["changed"][0]["after"].as_f64(), Some(0.75));
    assert_eq!(json(&device, &set)["changed"].as_array().unwrap().len(), 0);
    assert_eq!(json(&device, &["config", "save"])["saved"], true);

    assert!(json(&device, &["device", "fault"])["fault"].is_null());
    let file = folder("json").join("run.csv");
    let name = file.to_str().unwrap();
    let seen = json(&device, &["monitor", "--seconds", "0.3", "--csv", name]);
    let rows = std::fs::read_to_string(&file).unwrap().lines().count() as u64 - 1;
    assert_eq!(seen["records"].as_u64(), Some(rows));
    assert!(rows > 0 && seen["file"] == name);

    device.fault(FaultCode::OverSpeed, 61_000);
    let fault = json(&device, &["device", "fault"]);
    assert_eq!(fault["fault"]["name"], "over-speed");
    assert_eq!(fault["fault"]["code"], 13);
}

#[test]
fn silence_leaves_what_was_asked_for_by_name() {
    let device = Fake::new();
    let said = |arguments: &[&str]| {
        let mut all = arguments.to_vec();
        all.push("--quiet");
        device.run(&all).done()
    };
    assert_eq!(
        said(&["config", "set", "wall.k_desired_n_m_per_rad", "0.5"]),
        ""
    );
    assert_eq!(said(&["config", "save"]), "");
    assert_eq!(said(&["monitor", "--seconds", "0.2"]), "");
    assert_eq!(
        said(&["config", "get", "wall.k_desired_n_m_per_rad"])
            .lines()
            .count(),
        1
    );
    assert!(said(&["device", "status"]).contains("state     boot"));
}
