//! Tests of the commands around a knob's feel: the page that edits one, a profile from a CSV file, and the certificate.

use crate::{folder, names, run, run_in};

/// The page's data, as the page reads them.
fn content(page: &str) -> serde_json::Value {
    let (_, rest) = page.split_once("id=\"content\">").unwrap();
    let (text, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_feel_is_edited_on_the_live_page() {
    let here = folder("feels-edit");
    let made = run_in(
        &here,
        &[
            "feels",
            "edit",
            "on-off",
            "--no-open",
            "--set",
            "environment.detents.strength_n_m=0.02",
        ],
    )
    .ended(0);
    assert!(made.out.contains("touchstone-feel.html"), "{}", made.out);
    let page = std::fs::read_to_string(here.join("touchstone-feel.html")).unwrap();
    // The page names the command that sends its download to a board.
    assert!(page.contains("<code>touchstone config environment feel.toml</code>"));
    let edited = content(&page);
    assert_eq!(
        (&edited["name"], &edited["edits"]),
        (&"on-off".into(), &true.into())
    );
    let scene = edited["scene"].as_str().unwrap();
    assert!(scene.contains("strength_n_m = 0.02"), "{scene}");
    // The page's command has the name and the changes of the scene, but not the options for the page's file.
    assert_eq!(
        edited["source"],
        "on-off --set environment.detents.strength_n_m=0.02"
    );
    // The page of `live` differs only in the flag that opens the editor.
    let sets = ["--set", "environment.detents.strength_n_m=0.02"];
    run_in(
        &here,
        &[
            &["live", "on-off", "--no-open", "--out", "live.html"],
            &sets[..],
        ]
        .concat(),
    )
    .ended(0);
    let live = std::fs::read_to_string(here.join("live.html")).unwrap();
    let flag = ("\"edits\":false", "\"edits\":true");
    assert_eq!(live.replace(flag.0, flag.1), page);
    // A scene's file can also be edited, and the command prints JSON.
    std::fs::write(here.join("mine.toml"), "base = \"on-off\"\n").unwrap();
    let mine = run_in(
        &here,
        &["feels", "edit", "mine.toml", "--no-open", "--json"],
    )
    .ended(0);
    assert!(
        mine.json()["page"]
            .as_str()
            .unwrap()
            .ends_with("touchstone-feel.html")
    );
}

#[test]
fn a_feel_that_is_none_is_named_with_its_neighbour() {
    let here = folder("feels-edit-wrong");
    let wrong = |name: &str| run_in(&here, &["feels", "edit", name, "--no-open"]);
    wrong("ratchett").refused(&[
        "feels edit ratchett: no such feel or file",
        "did you mean ratchet?",
    ]);
    wrong("nothing-like-it")
        .refused(&["no such feel or file", "`touchstone feels` lists the feels"]);
    run(&["feels", "edits"]).refused(&["edits", "did you mean edit?"]);
    assert_eq!(names(&here), [""; 0]);
    // A file that is not a page of this program is not replaced.
    std::fs::write(here.join("touchstone-feel.html"), "mine").unwrap();
    wrong("ratchet").refused(&["touchstone-feel.html", "is not a page of `touchstone live`"]);
    let kept = std::fs::read_to_string(here.join("touchstone-feel.html")).unwrap();
    assert_eq!(kept, "mine");
}

/// Checks that a scene reads a profile from a file in the scene's folder, from any current folder. The printed scene has the points
/// and not the path.
#[test]
fn a_profile_comes_from_a_file_beside_the_scene() {
    let here = folder("profile-file");
    std::fs::create_dir(here.join("feels")).unwrap();
    let csv = "angle_deg,torque_mn_m\n0,0\n10,-12\n20,0\n30,12\n";
    std::fs::write(here.join("feels/drawn.csv"), csv).unwrap();
    let scene = "base = \"smooth\"\n[environment.profile]\nper_rev = 9\nfile = \"drawn.csv\"\n";
    std::fs::write(here.join("feels/mine.toml"), scene).unwrap();
    let printed = run_in(&here, &["run", "feels/mine.toml", "--print"]).ended(0);
    let wanted = [
        "shape = [0.0, -1.0, 0.0, 1.0]",
        "per_rev = 9",
        "strength_n_m = 0.012",
    ];
    for line in wanted {
        assert!(printed.out.contains(line), "{line}: {}", printed.out);
    }
    assert!(
        !printed.out.contains("drawn.csv") && printed.err.is_empty(),
        "{}",
        printed.err
    );
    // The printed scene needs no file.
    std::fs::write(here.join("alone.toml"), &printed.out).unwrap();
    let again = run_in(&here, &["run", "alone.toml", "--print"]).ended(0);
    let body = |text: &str| {
        text.lines()
            .skip_while(|it| !it.starts_with('['))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    assert_eq!(body(&again.out), body(&printed.out));
    // The page and its links contain only the points.
    run_in(
        &here,
        &[
            "feels",
            "edit",
            "feels/mine.toml",
            "--no-open",
            "--out",
            "p.html",
        ],
    )
    .ended(0);
    let page = std::fs::read_to_string(here.join("p.html")).unwrap();
    let edited = content(&page);
    assert!(!edited["scene"].as_str().unwrap().contains("drawn.csv"));
    assert!(
        edited["scene"]
            .as_str()
            .unwrap()
            .contains("shape = [0.0, -1.0, 0.0, 1.0]")
    );
}

#[test]
fn a_profile_s_mistakes_name_the_file_or_the_scene() {
    let here = folder("profile-wrong");
    let scene = |lines: &str| {
        let text = format!("base = \"smooth\"\n[environment.profile]\n{lines}\n");
        std::fs::write(here.join("s.toml"), text).unwrap();
        run_in(&here, &["run", "s.toml", "--print"])
    };
    scene("file = \"none.csv\"").refused(&["none.csv: no such file; give the path of a CSV file"]);
    scene("file = 3").refused(&["s.toml:3: environment.profile.file: must be text, is 3"]);
    std::fs::write(
        here.join("p.csv"),
        "angle_deg,torque_n_m\n0,0\n10,0.01\nx,0\n",
    )
    .unwrap();
    scene("file = \"p.csv\"").refused(&["p.csv:4: angle_deg: \"x\" is not a number"]);
    std::fs::write(
        here.join("p.csv"),
        "angle_deg,torque_n_m\n0,0\n10,0.01\n20,0\n",
    )
    .unwrap();
    scene("file = \"p.csv\"\nshape = [0.0, 1.0]")
        .refused(&["s.toml:4: environment.profile.shape: p.csv gives it too; leave it out"]);
    scene("file = \"p.csv\"\nper_rev = -1")
        .refused(&["s.toml:4: environment.profile.per_rev: must be between 0 and 6283"]);
    // The strength is checked against the force limit of the scene.
    std::fs::write(
        here.join("p.csv"),
        "angle_deg,torque_n_m\n0,0\n10,9.0\n20,0\n",
    )
    .unwrap();
    scene("file = \"p.csv\"").refused(&[
        "s.toml:3: environment.profile.strength_n_m: 9 is more than law.force_limit_n_m",
    ]);
    std::fs::write(here.join("p.csv"), vec![b'1'; 1_000_001]).unwrap();
    scene("file = \"p.csv\"").refused(&[
        "p.csv: is larger than 1 MB, the limit; give a file with one row for each point",
    ]);
    std::fs::write(here.join("p.csv"), b"PK\x03\x04\0").unwrap();
    scene("file = \"p.csv\"").refused(&[
        "p.csv: is not text in UTF-8: it is a zip archive",
        "save the profile as CSV",
    ]);
    run(&["run", "smooth", "--set", "environment.profile.file=p.csv"])
        .refused(&["only a scene's file names the file of a profile"]);
    // Unequal steps are accepted with a note, which `--quiet` leaves out.
    std::fs::write(
        here.join("p.csv"),
        "angle_deg,torque_n_m\n0,0\n10,0.01\n25,0\n",
    )
    .unwrap();
    let noted = scene("file = \"p.csv\"").ended(0);
    assert!(
        noted
            .err
            .contains("note: p.csv: 3 points, not equally spaced, became 96"),
        "{}",
        noted.err
    );
    let quiet = run_in(&here, &["run", "s.toml", "--print", "--quiet"]).ended(0);
    assert_eq!(quiet.err, "");
}

#[test]
fn the_stiffest_part_of_a_feel_is_certified() {
    let said = run(&["certify", "coarse-detents"]).ended(0).out;
    assert!(
        said.starts_with("coarse-detents: stiffest part environment.detents, "),
        "{said}"
    );
    assert!(
        said.contains("stable with the three grips") && said.contains("snaps"),
        "{said}"
    );
    let json = run(&["certify", "bounded-detents", "--json"])
        .ended(0)
        .json();
    let stiffest = &json["parts"][json["stiffest"].as_u64().unwrap() as usize];
    assert_eq!(stiffest["part"], "environment.endstops");
    assert_eq!(json["verdict"], "stable");
    let steep = run(&[
        "certify",
        "coarse-detents",
        "--set",
        "environment.detents.per_rev=400",
        "--set",
        "environment.detents.strength_n_m=0.045",
    ])
    .ended(0)
    .out;
    assert!(steep.contains("unstable with the three grips"), "{steep}");
    let none = run(&["certify", "smooth"]).ended(0).out;
    assert!(none.starts_with("smooth: nothing to certify"), "{none}");
    let json = run(&["certify", "smooth", "--json"]).ended(0).json();
    assert_eq!(json["verdict"], serde_json::Value::Null);
}

/// Checks that options that would change one scene are refused where all shipped feels are judged.
#[test]
fn all_feels_are_judged_as_they_are() {
    for lost in [
        &["on-off"][..],
        &["--set", "device.friction=none"],
        &["--k-desired", "20"],
        &["--settings", "mine.toml"],
    ] {
        let words = ["scorecard", "--feel", "--all-feels", "--crossings", "1"];
        let said = run(&[&words[..], lost].concat());
        said.refused(&["cannot be used together with", "--all-feels", "leave one"]);
    }
}
