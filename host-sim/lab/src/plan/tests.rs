use super::*;
use touchstone_report::plain_schema::misfit;

const QUIET: PlanOptions = PlanOptions {
    tolerance: 0.05,
    times: false,
    omitted: false,
};

fn planned(sets: &[&str], asked: PlanOptions) -> Planned {
    let scene = Scene::load("press-hold")
        .unwrap()
        .with_overrides(sets)
        .unwrap();
    let mut done = 0;
    let mut step = || done += 1;
    let found = plan(&scene, asked, ProgramVersion::default(), &mut step).unwrap();
    assert_eq!(done, steps(&scene, asked));
    found
}

#[test]
fn the_documented_schema_is_this_one() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../docs/schema/plan.schema.json"
    );
    let text = format!("{:#}\n", schema::schema());
    if std::env::var_os("TOUCHSTONE_WRITE_SCHEMA").is_some() {
        std::fs::write(path, &text).unwrap();
    }
    assert!(
        std::fs::read_to_string(path).unwrap() == text,
        "write it anew: TOUCHSTONE_WRITE_SCHEMA=1 cargo test -p touchstone-lab schema"
    );
}

/// The rows that the table of effects in `docs/effects.md` must have.
fn rows() -> String {
    let row = |effect: &touchstone_sim::run::effects::Effect| {
        format!(
            "| {} | `{}` | {} | {} | {} |\n",
            effect.name,
            effect.field,
            effect.place.words(),
            effect.typical,
            effect.source
        )
    };
    let head = "\n| effect | named by | place in the loop | typical magnitude | who says so |\n|---|---|---|---|---|\n";
    format!("{head}{}\n", EFFECTS.iter().map(row).collect::<String>())
}

#[test]
fn the_page_of_the_effects_has_the_table_of_the_schema() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/effects.md");
    let page = std::fs::read_to_string(path).unwrap();
    let (before, rest) = page
        .split_once("cargo test -p touchstone-lab schema` -->\n")
        .unwrap();
    let (table, after) = rest.split_once("<!-- effects: end -->").unwrap();
    if std::env::var_os("TOUCHSTONE_WRITE_SCHEMA").is_some() {
        let text = format!(
            "{before}cargo test -p touchstone-lab schema` -->\n{}<!-- effects: end -->{after}",
            rows()
        );
        std::fs::write(path, text).unwrap();
        return;
    }
    assert!(
        table == rows(),
        "write it anew: TOUCHSTONE_WRITE_SCHEMA=1 cargo test -p touchstone-lab schema"
    );
}

#[test]
fn a_plan_obeys_its_schema_and_says_all_of_its_parts() {
    let found = planned(
        &["encoder.counts_per_rev=40000", "timing.duration_s=2.3"],
        PlanOptions::default(),
    );
    let value = serde_json::to_value(&found).unwrap();
    assert_eq!(misfit(&schema::schema(), &value, ""), None);
    assert!(found.measured.unwrap().least_ns > 0.0);
    assert_eq!(found.states.len(), 4);
    let named: Vec<_> = found.effects.iter().map(|effect| effect.name).collect();
    assert_eq!(named, ["encoder", "hand"]);
    // Every effect is in the scene, omitted, or excluded by one in the scene.
    assert_eq!(named.len() + found.omitted.len(), EFFECTS.len());
    let text = table::render(&found);
    assert!(text.contains("tier: exact step\n"), "{text}");
}

#[test]
fn eigenvalues_are_those_of_the_equations() {
    // A bare device: 0 and -b/J. With a current loop also its pole. With a transmission the oscillation of two inertias against
    // each other.
    let bare = ["operator.grip=none", "operator.motion.kind=none"];
    let of = |more: &[&str]| planned(&[&bare[..], more].concat(), QUIET).eigenvalues;
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs().max(1.0);
    let found = of(&[]);
    assert!(found.len() == 2 && close(found[0].re_per_s, 0.0) && close(found[1].re_per_s, -4.0));
    let found = of(&["device.current_loop.bandwidth_hz=600"]);
    assert!(
        close(found[2].re_per_s, -std::f64::consts::TAU * 600.0),
        "{found:?}"
    );
    let found = of(&[
        "device.transmission.spring_n_m_per_rad=20",
        "device.transmission.damper_n_m_s_per_rad=0",
        "device.damping_n_m_s_per_rad=0",
    ]);
    let swing = found.last().unwrap();
    let expected = (20.0_f64 / (1e-4 * 0.3 * 0.7)).sqrt();
    assert!(
        close(swing.im_rad_per_s, expected) && swing.re_per_s.abs() < 1e-6,
        "{found:?}"
    );
    assert!(close(
        swing.frequency_hz.unwrap(),
        expected / std::f64::consts::TAU
    ));
}

#[test]
fn the_tier_and_its_reasons_follow_the_effects() {
    let tier = |sets: &[&str]| {
        let found = planned(sets, QUIET);
        (found.tier, found.substeps, found.reasons.join("; "))
    };
    assert_eq!(tier(&[]).1, 1);
    assert!(
        tier(&["device.friction.kinetic_n_m=1e-3"])
            .0
            .contains("located")
    );
    let (words, substeps, _) = tier(&["device.current_loop.bandwidth_hz=600"]);
    assert_eq!((&*words, substeps), ("exact step", 1));
    let (words, substeps, reasons) = tier(&["device.cogging.torque_n_m=1e-3"]);
    assert!(
        words.contains("substeps") && substeps > 1 && reasons.contains("cogging"),
        "{reasons}"
    );
    let (_, substeps, _) = tier(&["device.cogging.torque_n_m=0"]);
    assert_eq!(substeps, 1);
    let (_, substeps, reasons) = tier(&[
        "device.cogging.torque_n_m=1e-3",
        "plant.integrator=exact",
        "plant.substeps=9",
    ]);
    assert!(substeps == 9 && reasons.contains("plant.substeps"));
    let (words, substeps, _) = tier(&["plant.integrator=implicit-euler", "plant.substeps=5"]);
    assert_eq!((&*words, substeps), ("implicit-euler", 5));
}

#[test]
fn what_is_omitted_is_told_where_it_matters_and_not_where_it_does_not() {
    let asked = PlanOptions {
        times: false,
        ..PlanOptions::default()
    };
    // A plain spring of half the critical stiffness, for which a control period of delay decides on stability.
    let sets = [
        "law.kind=spring",
        "law.guard.on=false",
        "law.states=measured",
        "wall.k_desired_n_m_per_rad=0.5",
    ];
    let found = planned(&sets, asked);
    let effect = |name: &str| {
        found
            .omitted
            .iter()
            .find(|effect| effect.name == name)
            .unwrap()
    };
    let delay = effect("delay");
    assert!(
        delay.verdict.is_some() || !delay.moves.is_empty(),
        "{delay:?}"
    );
    // A torque limit of five times the press changes nothing.
    let limit = effect("torque-limit");
    assert!(
        limit.verdict.is_none() && limit.moves.is_empty(),
        "{limit:?}"
    );
    assert!(effect("torque-limit").not_tried.is_none());
}

#[test]
fn the_ladder_names_every_effect_and_predicts_what_it_counted() {
    let ladder = cost::Ladder::known();
    let bare = Scene::default()
        .with_overrides(&[
            "law.kind=spring",
            "law.states=measured",
            "law.guard.on=false",
        ])
        .unwrap();
    let base = ladder.predicted(&bare, &[]).unwrap();
    for effect in EFFECTS {
        let alone = ladder.alone(effect.name);
        assert!(
            alone.is_some_and(|count| count > 2.0),
            "{}: {alone:?}",
            effect.name
        );
        let predicted = ladder.predicted(&bare, &[effect.name]).unwrap();
        assert!((predicted - base - alone.unwrap()).abs() < 1e-9);
    }
}
