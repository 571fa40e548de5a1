//! Tests of `touchstone config`.

use crate::fake::{Fake, Trouble};
use crate::{folder, run};
use touchstone_control::Si;
use touchstone_protocol::settings::fields::FIELDS;
use touchstone_protocol::{Board, DeviceSettings, Event, Machine, State, stored};

const STIFFNESS: &str = "wall.k_desired_n_m_per_rad";

#[test]
fn settings_are_shown_alone_by_table_and_all() {
    let device = Fake::new();
    let one = device.run(&["config", "get", STIFFNESS]).done();
    assert_eq!(one, "wall.k_desired_n_m_per_rad = 5 N·m/rad\n");
    let table = device.run(&["config", "get", "law.filter"]).done();
    assert_eq!(table.lines().count(), 4);
    assert!(
        table.contains("law.filter.mass_kg_m2 = 0.000009 kg·m²"),
        "{table}"
    );
    let all = device.run(&["config", "get"]).done();
    // One line per setting, and one line with the guard's energy bound.
    assert_eq!(all.lines().count(), FIELDS.len() + 1);
    let guard = device.run(&["config", "get", "law.guard"]).done();
    assert!(
        guard
            .contains("# with these settings a hand gets out at most 45.15 mJ at once and 0.50 mW"),
        "{guard}"
    );
    let wrong = device.run(&["config", "get", "wall.k_desired_nm_per_rad"]);
    wrong.failed(
        2,
        &[
            "no such setting",
            "did you mean wall.k_desired_n_m_per_rad?",
        ],
    );
}

#[test]
fn a_setting_is_changed_exactly_and_kept_by_save() {
    let device = Fake::new();
    let said = device.run(&["config", "set", STIFFNESS, "1.5"]).done();
    assert!(
        said.contains("wall.k_desired_n_m_per_rad: 5 -> 1.5 N·m/rad"),
        "{said}"
    );
    assert!(said.contains("touchstone config save"), "{said}");
    let expected = {
        let (session, world) = &*device.world();
        assert_eq!(
            session.settings().wall.k_desired_n_m_per_rad,
            Si::lit("1.5")
        );
        assert_eq!(&world.used, session.settings());
        assert_eq!(world.saved, None);
        session.settings().clone()
    };
    assert_eq!(device.run(&["config", "save"]).done(), "saved\n");
    let image = device.world().1.saved.clone().expect("saved");
    assert_eq!(stored::decode(&image, &|_| Ok(())), Ok(expected));
}

#[test]
fn words_flags_and_negative_numbers() {
    let device = Fake::new();
    device.run(&["config", "set", "law.kind", "tdpa"]).done();
    device
        .run(&["config", "set", "encoder.reversed", "true"])
        .done();
    device
        .run(&["config", "set", "wall.surface_rad", "-0.25"])
        .done();
    let shown = device
        .run(&[
            "config",
            "get",
            "law.kind",
            "encoder.reversed",
            "wall.surface_rad",
        ])
        .done();
    assert_eq!(
        shown,
        "law.kind = tdpa\nencoder.reversed = true\nwall.surface_rad = -0.25 rad\n"
    );
}

#[test]
fn what_is_no_value_is_refused_with_its_range_and_nothing_changes() {
    let device = Fake::new();
    for (path, value, parts) in [
        (
            STIFFNESS,
            "500001",
            &["500001 is outside 0 to 500000", "N·m/rad"][..],
        ),
        (STIFFNESS, "stiff", &["`stiff` is not a decimal number"]),
        (
            "motor.pole_pairs",
            "7.5",
            &["not a whole number", "1 to 50"],
        ),
        ("law.kind", "tpda", &["did you mean tdpa?"]),
        ("encoder.reversed", "yes", &["true or false"]),
        ("wall.law", "tdpa", &["did you mean law.kind?"]),
        ("control.rate_hz", "1000", &["did you mean timing.rate_hz?"]),
        ("motor.pole_pair", "7", &["did you mean motor.pole_pairs?"]),
        ("timing.rate_hz", "3000", &["no whole fraction of 20000 Hz"]),
        (
            "law.force_limit_n_m",
            "0.6",
            &["0.6 is outside 0.000001 to 0.5 N·m"],
        ),
        (
            "limits.bus_min_v",
            "40",
            &["40 is outside 10 to 30 V", "config import"],
        ),
    ] {
        device.run(&["config", "set", path, value]).failed(2, parts);
    }
    assert_eq!(
        device.world().0.settings(),
        &DeviceSettings::defaults(Board::NucleoG474re)
    );
}

#[test]
fn an_export_is_taken_back_and_shows_what_differs() {
    let device = Fake::new();
    let file = folder("export").join("settings.toml");
    let name = file.to_str().unwrap();
    device
        .run(&["config", "set", STIFFNESS, "2.000000001"])
        .done();
    let before = device.world().0.settings().clone();
    device.run(&["config", "export", name]).done();
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(
        text.contains(
            "# the desired stiffness k_de; 0 to 500000 N·m/rad\nk_desired_n_m_per_rad = 2.0000000"
        ),
        "{text}"
    );
    assert_eq!(device.run(&["config", "export"]).done(), text);

    let said = device.run(&["config", "defaults"]).done();
    assert!(
        said.contains(": 2.000000001 -> 5 N·m/rad") || said.contains("-> 5 N·m/rad"),
        "{said}"
    );
    let dry = device.run(&["config", "import", name, "--dry-run"]).done();
    assert!(
        dry.contains("wall.k_desired_n_m_per_rad: 5 -> 2.0000000"),
        "{dry}"
    );
    assert!(dry.contains("nothing was written"), "{dry}");
    assert_eq!(
        device.world().0.settings(),
        &DeviceSettings::defaults(Board::NucleoG474re)
    );
    device.run(&["config", "import", name]).done();
    assert_eq!(device.world().0.settings(), &before);
    let all = FIELDS.len();
    assert_eq!(
        device.run(&["config", "import", name]).done(),
        format!("{all} of {all} settings in the file\nnothing to change\n")
    );
}

#[test]
fn a_file_that_was_cut_changes_nothing() {
    let device = Fake::new();
    let file = folder("cut").join("settings.toml");
    let name = file.to_str().unwrap();
    device.run(&["config", "export", name]).done();
    let whole = std::fs::read_to_string(&file).unwrap();
    // The file is cut at many places. At some places, such as the middle of a number, the text before the cut is still valid TOML.
    for length in (0..whole.len() - 1).step_by(97) {
        if !whole.is_char_boundary(length) {
            continue;
        }
        std::fs::write(&file, &whole[..length]).unwrap();
        device.run(&["config", "import", name]).failed(2, &[name]);
    }
    // A file without settings is refused, too.
    std::fs::write(&file, "# nothing\n").unwrap();
    device
        .run(&["config", "import", name])
        .failed(2, &["the file contains no settings"]);
    assert_eq!(
        device.world().0.settings(),
        &DeviceSettings::defaults(Board::NucleoG474re)
    );
}

#[test]
fn what_is_wrong_for_every_device_needs_none() {
    let nowhere = ["--port", "tcp:127.0.0.1:1"];
    for (arguments, parts) in [
        (
            &["config", "get", "wall.nonsense"][..],
            &["wall.nonsense: there is no such setting"][..],
        ),
        (
            &["config", "import", "there-is-none.toml"],
            &["there-is-none.toml"],
        ),
    ] {
        run(&[arguments, &nowhere].concat()).failed(2, parts);
    }
}

#[test]
fn several_settings_that_need_each_other_come_in_one_import() {
    let device = Fake::new();
    let file = folder("together").join("bus.toml");
    std::fs::write(&file, "[limits]\nbus_min_v = 32\nbus_max_v = 40\n").unwrap();
    device
        .run(&["config", "import", file.to_str().unwrap()])
        .done();
    assert_eq!(device.world().0.settings().limits.bus_min_v, Si::lit("32"));
}

#[test]
fn one_wrong_line_and_nothing_is_written() {
    let device = Fake::new();
    let file = folder("import").join("wrong.toml");
    let name = file.to_str().unwrap();
    for (text, parts) in [
        (
            "[law]\nkind = \"tdpa\"\nk_soft = 1\n",
            &[":3: law.k_soft: there is no such setting"][..],
        ),
        (
            "[law]\nkind = \"tdpa\"\nk_soft_n_m_per_rad = \"1\"\n",
            &[":3: law.k_soft_n_m_per_rad", "0.01 to 500000"],
        ),
        ("[motor]\npole_pairs = 0x7\n", &[":2: motor.pole_pairs"]),
        (
            "[law]\nkind = \"tdpa\"\nforce_limit_n_m = 5\n",
            &[
                ":3: law.force_limit_n_m",
                "0.000001 to 0.5 N·m",
                "no setting was changed",
            ],
        ),
        ("[wall]\nlaw = tdpa\n", &[":2: TOML"]),
        (
            "[motor]\ncurrent_limit_a = 1\n",
            &["law.force_limit_n_m: 0.5 is outside"],
        ),
    ] {
        std::fs::write(&file, text).unwrap();
        device.run(&["config", "import", name]).failed(2, parts);
    }
    device
        .run(&["config", "import", "there-is-none.toml"])
        .failed(2, &["there-is-none.toml"]);
    assert_eq!(
        device.world().0.settings(),
        &DeviceSettings::defaults(Board::NucleoG474re)
    );
}

#[test]
fn an_armed_device_and_a_broken_flash_refuse() {
    let device = Fake::with(Trouble {
        flash_fails: true,
        ..Trouble::default()
    });
    device
        .run(&["config", "save"])
        .failed(1, &["flash could not be written"]);
    device.world().1.machine = Machine::at(State::Armed);
    device
        .run(&["config", "set", STIFFNESS, "1"])
        .failed(1, &["state `armed`", "touchstone device disarm"]);
    device
        .run(&["config", "defaults"])
        .failed(1, &["state `armed`"]);
    device.world().1.machine = Machine::at(State::Ready);
    device.run(&["config", "set", STIFFNESS, "1"]).done();
    device
        .run(&["config", "save"])
        .failed(1, &["state `ready`", "touchstone device stop"]);
    assert!(
        device
            .world()
            .1
            .machine
            .handle(Event::Command(touchstone_protocol::Command::Arm))
    );
}

#[test]
fn the_schema_needs_no_device() {
    let text = run(&["config", "schema"]).done();
    for field in FIELDS {
        assert!(
            text.contains(field.path) && text.contains(field.about),
            "{}",
            field.path
        );
    }
    let json: serde_json::Value =
        serde_json::from_str(&run(&["config", "schema", "--json"]).done()).unwrap();
    assert_eq!(json.as_array().map(Vec::len), Some(FIELDS.len()));
    assert_eq!(json[0]["path"], FIELDS[0].path);
}

#[test]
fn a_file_that_weakens_the_guard_is_refused_unless_that_is_asked_for() {
    let device = Fake::new();
    let file = folder("weaker").join("weaker.toml");
    let name = file.to_str().unwrap();
    let shipped = DeviceSettings::defaults(Board::NucleoG474re);
    for (guard, parts) in [
        ("on = false", &[":3: law.guard.on: off"][..]),
        ("change = \"estimated\"", &[":3: law.guard.change"]),
        (
            "damping_n_m_s_per_rad = 0.0005",
            &[":3: law.guard.damping_n_m_s_per_rad", "instead of 0.0003"],
        ),
        ("capacity_j = 0.1", &[":3: law.guard.capacity_j", "0.045"]),
        (
            "refill_w = 0.01\nshare_of_damping = 1",
            &[":4: law.guard.share_of_damping", "(and 1 more)"],
        ),
    ] {
        std::fs::write(
            &file,
            format!("wall.k_desired_n_m_per_rad = 2\n[law.guard]\n{guard}\n"),
        )
        .unwrap();
        for option in [None, Some("--dry-run")] {
            let asked = ["config", "import", name].into_iter().chain(option);
            let said = device.run(&asked.collect::<Vec<_>>());
            said.failed(
                2,
                &[parts, &["--weaken-guard", "no setting was changed"]].concat(),
            );
            assert_eq!(device.world().0.settings(), &shipped, "{guard}");
        }
        let said = device.run(&["config", "import", name, "--weaken-guard"]);
        let text = format!("{}{}", said.out, said.err);
        assert!(text.contains("warning: the guard is weaker"), "{text}");
        assert_ne!(device.world().0.settings().law.guard, shipped.law.guard);
        // There is no warning if the board already has the weaker guard.
        device.run(&["config", "import", name]).done();
        let said = device.run(&["config", "defaults"]);
        assert!(!said.err.contains("weaker"), "{}", said.err);
    }
    // If a user changes this setting explicitly, the command accepts it and prints a warning.
    let said = device.run(&["config", "set", "law.guard.on", "false"]);
    assert!(said.err.contains("law.guard.on: off"), "{}", said.err);
}
