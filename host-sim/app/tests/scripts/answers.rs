//! Tests of the program's output: JSON, `--quiet`, completions, manual pages, and one line of error for a mistake.

use crate::{folder, names, run, run_in};
use touchstone_protocol::Board;

#[test]
fn json_and_silence_go_with_every_command() {
    let here = folder("answers");
    let scenes = run(&["scenes", "--json"]).ended(0).json();
    assert_eq!(scenes["scenes"][0]["name"], "thesis-knob");
    assert!(scenes["scenes"][0]["description"].is_string());
    let printed = run(&["run", "tap", "--print", "--json"]).ended(0).json();
    assert_eq!(printed["timing"]["rate_hz"], 1000);
    let schema = run(&["config", "schema", "--json"]).ended(0).json();
    assert!(schema[0]["path"].is_string() && schema[0].get("unit").is_some());
    let found = run_in(&here, &["identify", "--steps", "2", "--json"]).ended(0);
    assert!(found.json()["damping_n_m_s_per_rad"]["value"].is_f64() && found.err.is_empty());
    // Which parts are missing depends on the machine. The test checks only that present and missing parts are reported.
    let doctor = run_in(&here, &["doctor", "--json", "--port", "tcp:127.0.0.1:9"]).ended(1);
    let doctor = doctor.json();
    assert_eq!(doctor["all_there"], false);
    let states: Vec<&str> = doctor["things"]
        .as_array()
        .unwrap()
        .iter()
        .map(|thing| thing["state"].as_str().unwrap())
        .collect();
    assert!(states.contains(&"there") && states.contains(&"missing"));

    let results = run_in(&here, &["thesis", "--json"]).ended(0).json();
    assert_eq!(results["runs"].as_array().unwrap().len(), 156);
    assert!(results["claims"][0]["outcome"].is_string());
    assert!(here.join(results["report"].as_str().unwrap()).is_file());

    for arguments in [
        &["run", "tap", "--quiet"][..],
        &[
            "run",
            "tap",
            "-q",
            "--set",
            "law.k_soft_n_m_per_rad=1.01",
            "--out",
            "out",
        ],
        &["--quiet", "thesis", "--out", "comparison"],
    ] {
        let said = run_in(&here, arguments).ended(0);
        assert_eq!(
            (said.out.as_str(), said.err.as_str()),
            ("", ""),
            "{arguments:?}"
        );
    }
    let quiet = run(&["identify", "--steps", "2", "--quiet"]).ended(0).out;
    // Seven lines: inertia, damping, friction, the unexplained remainder, the damping that FBA may rely on, the critical stiffness,
    // and the plant's own damping.
    assert_eq!(quiet.lines().count(), 7, "{quiet}");
    // With `--quiet` the explicitly requested output is still printed, and so is every error.
    assert!(!run(&["scenes", "--quiet"]).ended(0).out.is_empty());
    run(&["run", "tapp", "--quiet"]).refused(&["tapp", "did you mean the shipped scene tap?"]);
    for command in [
        &["completions", "bash"][..],
        &["man"],
        &["config", "export"],
    ] {
        let mut arguments = command.to_vec();
        arguments.push("--json");
        run(&arguments).refused(&["--json", command[0]]);
    }
}

/// Every command, a command inside another one with a hyphen.
const COMMANDS: &str = "
    accuracy boundary bridge certify compare completions
    config config-defaults config-environment config-export config-get config-import config-save config-schema config-set
    demo
    device device-alignment device-alignment-forget device-alignment-keep device-arm device-autostart device-calibrate
    device-cogging device-cogging-check device-cogging-forget device-cogging-measure device-disarm device-eccentricity
    device-eccentricity-measure device-fault device-identify device-info device-list device-reboot device-ring device-run
    device-status device-stop device-survey device-zero
    doctor events export-fmu feels feels-edit flash hard identify live log man monitor plan run scenes scorecard setup
    sweep sweep-merge thesis tune";

#[test]
fn shells_and_manuals_know_every_command() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let text = run(&["completions", shell]).ended(0).out;
        for word in ["thesis", "operator-motion", "max-energy-out"] {
            assert!(text.contains(word), "{shell}: {word}");
        }
    }
    // Not every shell's completion script contains the values of the options.
    let text = run(&["completions", "bash"]).ended(0).out;
    assert!(text.contains("enhanced-sfa") && text.contains("no-contact"));
    run(&["completions", "bahs"]).refused(&["bahs", "did you mean bash?"]);
    let page = run(&["man"]).ended(0).out;
    assert!(
        page.contains(".TH touchstone 1") && page.contains("Exit codes"),
        "{page}"
    );
    let here = folder("man");
    run_in(&here, &["man", "pages/man1"]).ended(0);
    let pages = names(&here.join("pages/man1"));
    let known = COMMANDS.split_whitespace();
    let mut known: Vec<String> = known.map(|it| format!("touchstone-{it}.1")).collect();
    known.push("touchstone.1".to_owned());
    known.sort();
    // A command that is missing here is lost for its users; a new one is added to the list.
    assert_eq!(pages, known);
    std::fs::write(here.join("file"), "").unwrap();
    run_in(&here, &["man", "file"]).refused(&["file", "another folder"]);
}

#[test]
fn the_help_defines_codes_and_verdicts() {
    let help = run(&["run", "--help"]).ended(0).out;
    for part in [
        "3    done, but a demand is not met",
        "130  interrupted",
        "passive:",
        "came to rest; the hand never got out more energy than it had put in",
        "no-contact:",
        "--max-penetration <RAD>",
        "--min-stiffness <N_M_PER_RAD>",
        "--max-energy-out <J>",
    ] {
        assert!(help.contains(part), "{part:?} is not in {help}");
    }
    assert!(
        run(&["--help"])
            .ended(0)
            .out
            .contains("3    done, but a demand is not met")
    );
}

#[test]
fn a_slip_gets_a_suggestion() {
    for (arguments, parts) in [
        (
            &["run", "tap", "--law", "FBA"][..],
            &["--law", "did you mean fba?"][..],
        ),
        (
            &["run", "tap", "--law", "enhanced_sfa"],
            &["did you mean enhanced-sfa?"],
        ),
        (
            &["run", "tap", "--set", "operator.motion.kind=Tapp"],
            &["did you mean tap?"],
        ),
        (
            &["run", "Thesis-Knob"],
            &["did you mean the shipped scene thesis-knob?"],
        ),
        (
            &["run", "tap", "--set", "grip=Firm"],
            &["did you mean firm?"],
        ),
        (
            &["run", "tap", "--lawx", "fba"],
            &["--lawx", "did you mean --law?"],
        ),
        (&["rnu", "tap"], &["rnu", "did you mean run?"]),
        (&["run"], &["<SCENE> is missing"]),
    ] {
        run(arguments).refused(parts);
    }
}

#[test]
fn a_range_is_said_in_one_way_and_a_long_value_is_cut() {
    for (arguments, parts) in [
        (
            &["identify", "--steps", "41"][..],
            &["--steps: must be between 1 and 40, is 41"][..],
        ),
        (
            &["identify", "--steps", "few"],
            &["--steps: must be between 1 and 40, is few"],
        ),
        (
            &["identify", "--low", "-1"],
            &["--low: must be 0 or more, is -1"],
        ),
        (
            &["monitor", "--decimation", "0"],
            &["--decimation: must be between 1 and 1000, is 0"],
        ),
        (
            &["monitor", "--seconds", "0"],
            &["--seconds: must be above 0 and at most 1000000000, is 0"],
        ),
    ] {
        run(arguments).refused(parts);
    }
    // These arguments are as long as every operating system permits.
    let long = "9".repeat(100_000);
    let set = format!("wall.k_desired_n_m_per_rad={long}");
    let text = format!("description={}", "long ".repeat(20_000));
    for arguments in [
        &["run", "tap", "--law", &long][..],
        &["run", "tap", "--k-desired", &long],
        &["run", "tap", "--set", &set],
        &["run", "tap", "--set", &text, "--set", "law.kind=x"],
        &["run", &long],
        &["identify", "--steps", &long],
        &["run", "tap", "--expect", &long],
        &[
            "config",
            "set",
            "wall.surface_rad",
            &long,
            "--port",
            "tcp:127.0.0.1:9",
        ],
    ] {
        let said = run(arguments);
        assert!(
            said.err.len() < 2000,
            "{}: {} bytes",
            arguments[1],
            said.err.len()
        );
        assert!(!said.err.contains(&long[..300]), "{}", said.err);
        said.refused(&[]);
    }
}

#[test]
fn the_comparison_says_what_it_cannot_change() {
    let here = folder("fixed");
    for (set, what) in [
        ("law.kind=fba", "laws"),
        ("kind=fba", ""),
        ("k_desired_n_m_per_rad=3", "stiffnesses"),
        ("operator.grip=firm", "grips"),
        ("operator.hand.inertia_kg_m2=1e-4", "grips"),
        ("encoder=none", "encoders"),
        ("encoder.counts_per_rev=1000", "encoders"),
    ] {
        let said = run_in(&here, &["thesis", "--set", set, "--out", "out"]);
        if what.is_empty() {
            // This ending matches a field of the law and one of the motion, so the full path is required. With the full path it is
            // refused for the same reason as the others.
            said.refused(&["several fields end so"]);
        } else {
            said.refused(&[set, "thesis cannot change it", what, "touchstone run"]);
        }
    }
    for options in [
        &["--law", "sfa"][..],
        &["--k-desired", "3"],
        &["--set", "law.device_damping_n_m_s_per_rad=1e-3"],
    ] {
        let mut arguments = vec!["identify"];
        arguments.extend(options);
        run(&arguments).refused(&[options[0], "identify cannot change it"]);
    }
    assert!(names(&here).is_empty());
}

/// Checks the scorecard of a feel: a good feel passes, failed demands end with exit code 3, and a scene without a feel is refused.
#[test]
fn a_feel_is_judged_and_what_has_none_is_refused() {
    let card = |words: &[&str]| {
        let mut all = vec!["scorecard"];
        all.extend(words);
        run(&all)
    };
    let good = card(&["on-off", "--feel", "--no-buzz", "--positions", "--as-drawn"]).ended(0);
    assert!(good.out.contains("positions crossed"), "{}", good.out);
    // A demand on positions fails if no position was crossed.
    let none = card(&["smooth", "--feel", "--positions"]).ended(3);
    assert!(
        none.err.contains("no grip crossed a position"),
        "{}",
        none.err
    );
    let steep = card(&[
        "coarse-detents",
        "--feel",
        "--no-buzz",
        "--set",
        "environment.detents.per_rev=400",
        "--set",
        "environment.detents.strength_n_m=0.045",
        "--set",
        "device.friction=none",
    ])
    .ended(3);
    assert!(steep.err.contains("counts at rest"), "{}", steep.err);
    let wall = card(&["thesis-knob", "--feel"]).ended(2);
    assert!(wall.err.contains("has no feel"), "{}", wall.err);
}

/// Checks the scorecard of a feel on the five boards: every board is listed with its own figures, and a failed demand names its
/// board.
#[test]
fn a_feel_is_judged_on_each_board() {
    let words = [
        "scorecard",
        "on-off",
        "--feel",
        "--boards",
        "--crossings",
        "20",
    ];
    let asked = |more: &[&str]| run(&[&words[..], more].concat());
    let json = asked(&["--json"]).ended(0).json();
    let cards = json["feels"].as_array().unwrap();
    let boards: Vec<&str> = cards
        .iter()
        .map(|card| card["board"].as_str().unwrap())
        .collect();
    let all: Vec<&str> = Board::ALL.iter().map(|board| board.name()).collect();
    assert_eq!(boards, all);
    for (index, card) in cards.iter().enumerate() {
        let grips = card["grips"].as_array().unwrap();
        let crossed = |grip: &serde_json::Value| grip["crossings"].as_u64().unwrap();
        assert!(
            grips.len() == 3 && grips.iter().map(crossed).sum::<u64>() >= 20,
            "{card}"
        );
        // Power stage, encoder, rate or delay differ between any two boards, except the two NUCLEOs with an IHM16M1.
        let is_ihm16m1 = |name: &str| name.ends_with("-ihm16m1");
        for (other, name) in cards[..index].iter().zip(&boards) {
            let are_alike = is_ihm16m1(name) && is_ihm16m1(boards[index]);
            assert_eq!(card["grips"] == other["grips"], are_alike, "{card}");
        }
    }
    let table = asked(&["--no-buzz", "--positions"]).ended(0).out;
    for board in all {
        let heading = format!("on-off on {board}");
        assert!(table.lines().any(|line| line == heading), "{table}");
    }
    // A feel without positions meets no demand on positions, on no board.
    let none = run(&["scorecard", "smooth", "--feel", "--boards", "--positions"])
        .ended(3)
        .err;
    for board in Board::ALL {
        let named = format!("(smooth on {})", board.name());
        assert!(none.contains(&named), "{none}");
    }
    run(&["scorecard", "on-off", "--boards"]).refused(&["--feel"]);
}

#[test]
fn feels_are_listed_and_run() {
    let feels = run(&["feels", "--json"]).ended(0).json();
    let names: Vec<_> = feels["feels"]
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it["name"].as_str().unwrap())
        .collect();
    assert_eq!(names.len(), 23);
    assert!(names.contains(&"on-off"));
    let listed = run(&["feels"]).ended(0).out;
    assert!(
        listed.contains("24 clear clicks a turn")
            && listed.contains("touchstone config environment NAME"),
        "{listed}"
    );
    let report = run(&["run", "on-off", "--json"]).ended(0).json();
    let summary = report.to_string();
    assert!(
        summary.contains("\"rate_hardness\":null"),
        "a feel has no wall to be hard: {summary}"
    );
    assert!(
        run(&["on-off"])
            .ended(2)
            .err
            .contains("it is a scene: touchstone run on-off")
    );
}

/// A survey of a device with this name, as TOML.
fn survey_named(name: &str) -> String {
    format!(
        "device = \"{name}\"\nlibrary = \"\"\ninertia_kg = [0.1, 0.1, 0.1]\ndamping_n_s_per_m = [2.5, 2.5, 2.5]\n\
         position_min_m = [-0.1, -0.1, -0.1]\nposition_max_m = [0.1, 0.1, 0.1]\njoint_angle_min_rad = []\njoint_angle_max_rad = []\n\
         pose = []\n"
    )
}

/// Checks that no text from a scene file, a survey or a file's name reaches a log with characters that could do harm. A CI system
/// executes log lines that begin like its commands, and a terminal executes control characters.
#[test]
fn no_name_of_a_scene_reaches_a_log_as_a_command() {
    let here = folder("name-as-command");
    let name = r"a\n::error::b\r::warning::\u001b[31m\u007f\u009bc\u202e\u2028";
    let scene = include_str!("../../../../scenes/tap.toml");
    let rest: String = scene
        .lines()
        .filter(|line| !line.starts_with("name") && !line.starts_with("description"))
        .map(|line| format!("{line}\n"))
        .collect();
    let text = format!("name = \"{name}\"\ndescription = \"{name}\"\n{rest}");
    std::fs::write(here.join("scene.toml"), text).unwrap();
    let three = format!("name = \"{name}\"\ndescription = \"{name}\"\ndof = 3\n");
    std::fs::write(here.join("three.toml"), three).unwrap();
    let mesh = "a\n::error::b\u{1b}[31m.obj";
    std::fs::write(here.join(mesh), "v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n").unwrap();
    let survey = survey_named(name);
    std::fs::write(here.join("survey.toml"), survey).unwrap();
    let device = ["device", "run", "--fast", "--seconds", "0.1"];
    let of_mesh = [&device[..], &[mesh, "--device", "simulated"]].concat();
    let of_survey = [&device[..], &["plane", "--twin", "survey.toml"]].concat();
    let harmful = |text: &str| {
        let is_harmful =
            |letter: char| letter != '\n' && touchstone_sim::harmless::is_harmful(letter);
        text.lines().any(|line| line.starts_with("::")) || text.contains(is_harmful)
    };
    for words in [
        &["run", "scene.toml"][..],
        &["run", "scene.toml", "--json"],
        &["run", "scene.toml", "--print"],
        &["run", "scene.toml", "--print", "--json"],
        &["run", "scene.toml", "--expect", "unstable"],
        &["run", "scene.toml", "--out", "report"],
        &["run", "three.toml"],
        &["run", "three.toml", "--json"],
        &["run", "three.toml", "--print"],
        &[
            "run",
            "three.toml",
            "--expect",
            "unstable",
            "--out",
            "three",
        ],
        &of_mesh,
        &of_survey,
        &["plan", "scene.toml", "--no-times", "--no-omitted"],
        &["certify", "scene.toml"],
        &["certify", "scene.toml", "--json"],
        &["live", "scene.toml", "--no-open", "--out", "page.html"],
    ] {
        let said = run_in(&here, words);
        assert!(matches!(said.code, Some(0 | 3)), "{words:?}: {}", said.err);
        assert!(
            !harmful(&said.out) && !harmful(&said.err),
            "{words:?}: {:?}",
            said.out
        );
        if words.contains(&"--json") {
            said.json();
        }
    }
}

#[test]
fn a_wall_that_is_further_than_positions_reach_is_named_once() {
    let here = folder("beyond-reach");
    let detents = "environment.detents.strength_n_m=0.01";
    for (surface, others, notes) in [
        ("wall.surface_rad=-130", &[][..], 1),
        ("wall.surface_rad=-130", &["--set", detents], 1),
        ("wall.surface_rad=-120", &[], 0),
        // The device is outside this wall, at whatever distance, so no wall is off.
        ("wall.surface_rad=130", &[], 0),
    ] {
        let start = "device.initial_angle_rad=0";
        let words = [
            "run", "tap", "--set", surface, "--set", start, "--out", "page", "--force",
        ];
        let said = run_in(&here, &[&words[..], others].concat()).ended(0);
        let page = std::fs::read_to_string(here.join("page/index.html")).unwrap();
        for text in [&said.err, &page] {
            let note = "a wall is off from 0.000 s on, because the device is deeper inside it than";
            assert_eq!(
                text.matches(note).count(),
                notes,
                "{surface} {others:?}: {}",
                said.err
            );
        }
    }
}

#[test]
fn a_demand_that_three_axes_do_not_have_is_refused_by_its_name() {
    for option in ["--max-penetration", "--min-stiffness", "--baseline"] {
        run(&["run", "delta-ball", option, "0.01"]).refused(&[option, "three axes"]);
    }
    run(&["run", "delta-ball", "--junit", "tests.xml"]).refused(&["--junit", "there is no demand"]);
}
