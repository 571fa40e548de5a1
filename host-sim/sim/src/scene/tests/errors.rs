//! Tests of invalid scenes: each type of mistake gets its own error message of one line.

use super::*;

#[track_caller]
fn refused(text: &str, expected: &str) {
    assert_eq!(refusal(text), expected);
}

#[test]
fn misspelt_fields_and_tables() {
    refused(
        "[wall]\nsuface_rad = 0.5",
        "s.toml:2: wall.suface_rad: unknown field; did you mean surface_rad?",
    );
    refused(
        "[wall]\nk_desird = 0.5",
        "s.toml:2: wall.k_desird: unknown field; did you mean k_desired_n_m_per_rad?",
    );
    refused(
        "\n\n[encodr]\ncounts_per_rev = 1",
        "s.toml:3: encodr: unknown table; did you mean encoder?",
    );
    refused(
        "[law.fliter]",
        "s.toml:1: law.fliter: unknown table; did you mean filter?",
    );
    refused(
        "nmae = \"x\"",
        "s.toml:1: nmae: unknown field; did you mean name?",
    );
    refused(
        "[wall]\ncolour = 3",
        "s.toml:2: wall.colour: unknown field; [wall] has surface_rad or k_desired_n_m_per_rad",
    );
    refused(
        "[gravity]",
        "s.toml:1: gravity: unknown table; the top of the scene has name, description, seed, device, encoder, sensor, plant, timing, wall, environment, law or operator",
    );
}

#[test]
fn the_first_of_several_problems_in_the_file_is_reported() {
    refused(
        "[wall]\nsuface_rad = 1\n[device]\ninertia_kg_m2 = -1\n",
        "s.toml:2: wall.suface_rad: unknown field; did you mean surface_rad?",
    );
    refused(
        "[wall]\nsurface_rad = true\nk_desired_n_m_per_rad = 0\n",
        "s.toml:2: wall.surface_rad: must be a number, is true; give the wall's surface in rad",
    );
}

#[test]
fn fields_in_the_wrong_table_or_motion() {
    refused(
        "[device]\nk_soft_n_m_per_rad = 0.8",
        "s.toml:2: device.k_soft_n_m_per_rad: unknown field in [device]; move it to [law]",
    );
    refused(
        "[law]\nk_v_n_m_per_rad = 0.8",
        "s.toml:2: law.k_v_n_m_per_rad: this setting has a new name; write law.k_soft_n_m_per_rad",
    );
    refused(
        "rate_hz = 1000",
        "s.toml:1: rate_hz: unknown field in the top of the scene; move it to [timing]",
    );
    refused(
        "[operator]\ngrip = \"light\"\n[operator.motion]\nkind = \"tap\"\nhold_s = 1",
        "s.toml:5: operator.motion.hold_s: the motion `tap` has no such field; \
         remove it, or use it with ramp-and-hold, press-wiggle-release or touch-and-press",
    );
}

#[test]
fn wrong_units() {
    refused(
        "[device]\ninertia_g_cm2 = 100",
        "s.toml:2: device.inertia_g_cm2: wrong unit, this field is in kg·m²; write inertia_kg_m2 = 1e-5",
    );
    refused(
        "[timing]\nrate_khz = 1",
        "s.toml:2: timing.rate_khz: wrong unit, this field is in Hz; write rate_hz = 1000",
    );
    refused(
        "[wall]\nsurface_deg = \"9\"",
        "s.toml:2: wall.surface_deg: wrong unit, this field is in rad; write surface_rad (1 ° = 0.0174532925199 rad)",
    );
    // Units of another dimension: no factor converts them.
    refused(
        "[wall]\nk_desired_n_per_mm = 5",
        "s.toml:2: wall.k_desired_n_per_mm: wrong unit, this field is in N·m/rad; \
         write k_desired_n_m_per_rad and give the value in N·m/rad",
    );
    refused(
        "[law.filter]\nground_damping_n_m_per_rad = 5",
        "s.toml:2: law.filter.ground_damping_n_m_per_rad: wrong unit, this field is in N·m·s/rad; \
         write ground_damping_n_m_s_per_rad and give the value in N·m·s/rad",
    );
    refused(
        "[device]\ninertia = 1e-4",
        "s.toml:2: device.inertia: the unit is missing, this field is in kg·m²; write inertia_kg_m2",
    );
}

#[test]
fn wrong_types() {
    refused(
        "[device]\ninertia_kg_m2 = \"small\"",
        "s.toml:2: device.inertia_kg_m2: must be a number, is \"small\"; give the device's moment of inertia in kg·m²",
    );
    refused(
        "[timing]\nrate_hz = 1000.5",
        "s.toml:2: timing.rate_hz: must be a whole number, is 1000.5; give the control rate in Hz",
    );
    refused(
        "[law]\ncount_device_damping = 1",
        "s.toml:2: law.count_device_damping: must be true or false, is 1; give whether tdpa counts c_i as dissipation (2.6)",
    );
    refused(
        "name = 3",
        "s.toml:1: name: must be text in quotes, is 3; give the scene's name",
    );
    refused(
        "[wall]\nsurface_rad = [1]",
        "s.toml:2: wall.surface_rad: must be a number, is a list; give the wall's surface in rad",
    );
    refused(
        "[wall]\nsurface_rad = 1979-05-27",
        "s.toml:2: wall.surface_rad: must be a number, is a date or time; give the wall's surface in rad",
    );
    refused(
        "[wall.surface_rad]",
        "s.toml:1: wall.surface_rad: must be a number, is a table; give the wall's surface in rad",
    );
    refused(
        "encoder = 4096",
        "s.toml:1: encoder: must be a table, is 4096; write a table [encoder] with counts_per_rev",
    );
    refused(
        "[law]\nkind = 3",
        "s.toml:2: law.kind: must be one of spring, spring-damper, tdpa, fba, sfa, sfa-continuous, enhanced-sfa, in quotes, is 3; \
         give the control law",
    );
}

#[test]
fn unknown_words() {
    refused(
        "[law]\nkind = \"enhanced-sfs\"",
        "s.toml:2: law.kind: unknown value \"enhanced-sfs\"; did you mean enhanced-sfa?",
    );
    refused(
        "[law]\nnumber = \"decimal\"",
        "s.toml:2: law.number: unknown value \"decimal\"; give fixed32, fixed16, f32 or f64",
    );
    refused(
        "[operator.motion]\nkind = \"wave\"\nspeed = 3",
        "s.toml:2: operator.motion.kind: unknown value \"wave\"; give none, ramp-and-hold, tap, press-wiggle-release, touch-and-press, turn or recorded",
    );
}

#[test]
fn numbers_out_of_range() {
    for (value, is) in [
        ("nan", "NaN"),
        ("inf", "inf"),
        ("-inf", "-inf"),
        ("1e999", "inf"),
    ] {
        refused(
            &format!("[device]\ninertia_kg_m2 = {value}"),
            &format!(
                "s.toml:2: device.inertia_kg_m2: must be a finite number, is {is}; give the device's moment of inertia in kg·m²"
            ),
        );
    }
    for value in ["-0.0001", "0"] {
        refused(
            &format!("[device]\n# a comment\ninertia_kg_m2 = {value}"),
            &format!(
                "s.toml:3: device.inertia_kg_m2: must be above 0, is {value}; give the device's moment of inertia in kg·m²"
            ),
        );
    }
    refused(
        "[device]\ndamping_n_m_s_per_rad = -1e-3",
        "s.toml:2: device.damping_n_m_s_per_rad: must be 0 or more, is -0.001; give the device's viscous damping in N·m·s/rad",
    );
    for value in ["0", "-1000", "2000000"] {
        refused(
            &format!("[timing]\nrate_hz = {value}"),
            &format!(
                "s.toml:2: timing.rate_hz: must be between 1 and 100000, is {value}; give the control rate in Hz"
            ),
        );
    }
    for value in ["-1", "1e9"] {
        refused(
            &format!("[wall]\nk_desired_n_m_per_rad = {value}"),
            &format!(
                "s.toml:2: wall.k_desired_n_m_per_rad: must be between 0 and 500000, is {}; give the desired stiffness k_de in N·m/rad",
                value.parse::<f64>().unwrap()
            ),
        );
    }
    refused(
        "[timing]\nrate_hz = 99999999999999999999",
        "s.toml:2: timing.rate_hz: must be a whole number, is 100000000000000000000.0; give the control rate in Hz",
    );
    for value in ["0", "-4096"] {
        refused(
            &format!("[encoder]\ncounts_per_rev = {value}"),
            &format!(
                "s.toml:2: encoder.counts_per_rev: must be above 0, is {value}; give the encoder's counts in one turn"
            ),
        );
    }
    refused(
        "[timing]\nduration_s = -1",
        "s.toml:2: timing.duration_s: must be above 0 and at most 86400, is -1; give the simulated time in s",
    );
    refused(
        "[timing]\ncomputational_delay_s = -1e-3",
        "s.toml:2: timing.computational_delay_s: must be between 0 and 1, is -0.001; give the delay from sample to command in s",
    );
    refused(
        "[operator]\ngrip = \"light\"\nmotion = { kind = \"ramp-and-hold\", ramp_s = 0.01 }",
        "s.toml:3: operator.motion.ramp_s: must be at least 0.05, is 0.01; give the time from rest to the full push in s",
    );
    refused(
        "[law]\nstep_of_ideal_per_ms = 1.5",
        "s.toml:2: law.step_of_ideal_per_ms: must be between 0 and 1, is 1.5; give the step of the offset each millisecond as a share of the ideal one, c of (3.8)",
    );
}

#[test]
fn fields_that_contradict_each_other() {
    refused(
        "[device.friction]\nkinetic_n_m = 2e-3\nstatic_n_m = 1e-3",
        "s.toml:3: device.friction.static_n_m: must be at least kinetic_n_m, is 0.001 below 0.002; \
         write static_n_m = 0.002 or leave it out",
    );
    refused(
        "[operator]\ngrip = \"custom\"",
        "s.toml:2: operator.grip: a custom grip needs the hand's values; \
         add a table [operator.hand], or give light, medium or firm",
    );
    refused(
        "[operator]\ngrip = \"firm\"\n[operator.hand]\ninertia_kg_m2 = 1e-5",
        "s.toml:2: operator.grip: the grip firm contradicts the table [operator.hand]; remove one of the two",
    );
    refused(
        "[operator.motion]\nkind = \"ramp-and-hold\"",
        "s.toml:2: operator.motion.kind: no hand holds the device, so there is no hand for the motion ramp-and-hold; \
         give operator.grip = \"medium\", or the motion none",
    );
    refused(
        "[timing]\nduration_s = 2\n[operator]\ngrip = \"light\"\nmotion.kind = \"ramp-and-hold\"",
        "s.toml:2: timing.duration_s: 2 s is too short for the motion, which needs 2.1 s; \
         give duration_s = 2.1 or more, or shorten the motion",
    );
    refused(
        "[operator]\ngrip = \"light\"\nmotion.kind = \"tap\"\nmotion.velocity_rad_per_s = 30",
        "s.toml:4: operator.motion.velocity_rad_per_s: 30 rad/s from 0.1 rad outside is a tap of 35.6 Hz, but a hand moves at most at 10 Hz; \
         lower it, or give approach_rad = 0.356 or more",
    );
}

#[test]
fn the_fix_for_a_fast_tap_is_accepted() {
    let tap = "[operator]\ngrip = \"light\"\nmotion.kind = \"tap\"\nmotion.velocity_rad_per_s = 30\nmotion.approach_rad = ";
    assert!(parse(&format!("{tap}0.356")).is_ok());
    assert!(parse(&format!("{tap}0.355")).is_err());
}

#[test]
fn missing_parts_and_files() {
    refused(
        "[operator]\ngrip = \"light\"\n[operator.motion]\nhold_s = 1",
        "s.toml:3: operator.motion.kind: missing; give none, ramp-and-hold, tap, press-wiggle-release, touch-and-press, turn or recorded",
    );
    refused(
        "[operator]\ngrip = \"light\"\n[operator.motion]\nkind = \"recorded\"",
        "s.toml:3: operator.motion.file: missing; give the recording, a CSV file with time and angle",
    );
    let text =
        "[operator]\ngrip = \"light\"\n[operator.motion]\nkind = \"recorded\"\nfile = \"gone.csv\"";
    let message = Scene::parse(text, Path::new("lab/s.toml"))
        .unwrap_err()
        .to_string();
    let expected = "lab/s.toml:5: operator.motion.file: no file lab/gone.csv; \
                    give the path of a CSV file, relative to the scene's folder";
    assert_eq!(message, expected);
}

#[test]
fn text_that_is_no_toml() {
    refused(
        "[wall]\nsurface_rad = 0,5 # half",
        "s.toml:2: surface_rad: a comma in a number; write surface_rad = 0.5",
    );
    refused(
        "[law]\nkind = tdpa",
        "s.toml:2: kind: text without quotes; write kind = \"tdpa\"",
    );
    refused(
        "[wall]\nsurface_rad = 1\nsurface_rad = 2",
        "s.toml:3: surface_rad: not valid TOML: duplicate key; write key = value lines under [table] headings, text in quotes",
    );
    // The TOML parser gives the words; this program adds place and remedy.
    let message = refusal("name = \"x\"\n[wall\nsurface_rad = 1");
    assert!(
        message.starts_with("s.toml:2: scene: not valid TOML: "),
        "{message}"
    );
    assert!(
        message.ends_with("; write key = value lines under [table] headings, text in quotes"),
        "{message}"
    );
}

#[test]
fn scenes_that_do_not_exist() {
    let message = |name| Scene::load(name).unwrap_err().to_string();
    assert_eq!(
        message("thesis-knb"),
        "thesis-knb: no such scene or file; did you mean the shipped scene thesis-knob?"
    );
    assert_eq!(
        message("no/such.toml"),
        "no/such.toml: no such scene or file; give the path of a scene's file, or a shipped scene: \
         thesis-knob, press-hold, press-wiggle-release, tap, free-release, low-stiffness, gimbal-knob, voltage-knob or identify"
    );
}

#[test]
fn late_errors_still_know_the_place() {
    let scene = parse("[law]\nk_soft_n_m_per_rad = 0.8").unwrap();
    let message = |path| scene.error(path, "is too large", "lower it").to_string();
    assert_eq!(
        message("law.k_soft_n_m_per_rad"),
        "s.toml:2: law.k_soft_n_m_per_rad: is too large; lower it"
    );
    assert_eq!(
        message("law.device_damping_n_m_s_per_rad"),
        "s.toml:1: law.device_damping_n_m_s_per_rad: is too large; lower it"
    );
    // The text does not give the field, so the error names the line of the innermost table around the field, or else line 1.
    let later = parse("\n[law]\nk_soft_n_m_per_rad = 0.8").unwrap().error(
        "law.filter.mass_kg_m2",
        "is heavy",
        "lower it",
    );
    assert_eq!(
        later.to_string(),
        "s.toml:2: law.filter.mass_kg_m2: is heavy; lower it"
    );
    let later = parse("\n[law]")
        .unwrap()
        .error("device.inertia_kg_m2", "is heavy", "lower it");
    assert_eq!(
        later.to_string(),
        "s.toml:1: device.inertia_kg_m2: is heavy; lower it"
    );
    let scene = scene.with_overrides(&["k_soft_n_m_per_rad=0.9"]).unwrap();
    let message = scene
        .error("law.k_soft_n_m_per_rad", "is too large", "lower it")
        .to_string();
    assert_eq!(
        message,
        "--set k_soft_n_m_per_rad=0.9: is too large; lower it"
    );
}

#[test]
fn scenes_made_in_code_are_checked_too() {
    let mut scene = Scene::default();
    assert_eq!(scene.check(), Ok(()));
    scene.device.inertia_kg_m2 = f64::NAN;
    let expected = "device.inertia_kg_m2: must be a finite number, is NaN; give the device's moment of inertia in kg·m²";
    assert_eq!(scene.check().unwrap_err().to_string(), expected);
}

/// An unknown name is compared with all known ones, so a sent text with thousands of unknown names would take seconds if each was
/// explained.
#[test]
fn of_many_unknown_names_only_one_is_explained() {
    use super::super::draft::Draft;
    let fields: String = (0..20_000)
        .map(|n| format!("environment.detents.field_{n} = {n}\n"))
        .collect();
    let tables: String = (0..20_000)
        .map(|n| format!("[environment.table_{n}]\n"))
        .collect();
    for text in [fields, tables] {
        let of_text = Draft::of_text(&text, Path::new("s.toml")).unwrap();
        let of_tables = Draft::of_tables(text.parse().unwrap());
        for draft in [of_text, of_tables] {
            let said = draft.problems();
            assert_eq!(said.len(), 1, "{:?}", &said[..2]);
            assert!(said[0].problem.starts_with("unknown"), "{:?}", said[0]);
        }
    }
}

/// A scene may call its table `environment` also `feel`.
#[test]
fn a_feel_is_an_environment() {
    let of = |table: &str| {
        format!(
            "[{table}]\nfirst_wall = false\n[{table}.detents]\nper_rev = 7\nstrength_n_m = 0.02\n"
        )
    };
    let [feel, environment] =
        ["feel", "environment"].map(|table| parse(&of(table)).unwrap().environment);
    assert!(feel.is_some() && feel == environment, "{feel:?}");
    // Errors name the table of the documentation, with the line of the file.
    refused(
        "[feel.detents]\n\nper_revs = 7",
        "s.toml:3: environment.detents.per_revs: unknown field; did you mean per_rev?",
    );
    refused(
        "[environment]\n[feel.detents]\nper_rev = 7",
        "s.toml:2: feel: [environment] is the same table; move its fields there",
    );
}
