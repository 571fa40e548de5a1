//! Tests of the thesis' comparison in three degrees of freedom.

use crate::common::{self, run_in};
use touchstone_report::plain_schema::misfit;

use std::path::PathBuf;

fn folder(test: &str) -> PathBuf {
    common::folder(&format!("cli-space-{test}"))
}

/// Checks that all claims of the thesis hold in the comparison, and that the report's page has the figures of every run.
#[test]
fn the_comparison_reproduces_what_the_thesis_claims() {
    let folder = folder("claims");
    let out = run_in(&folder, ["thesis", "--dof", "3", "--json"]);
    assert!(
        out.status.success(),
        "{}",
        String::from_utf8_lossy(&out.stderr)
    );
    let results: serde_json::Value = serde_json::from_slice(&out.stdout).expect("JSON");
    let mut kept = results.clone();
    kept.as_object_mut().expect("object").remove("report");
    let schema = touchstone_lab::space_report::schema::comparison();
    assert_eq!(misfit(&schema, &kept, "results"), None);
    kept["directions"][0]["more"] = 1.into();
    assert!(misfit(&schema, &kept, "results").is_some());
    let claims = results["claims"].as_array().expect("claims");
    assert!(claims.len() >= 9);
    for claim in claims {
        assert_eq!(claim["outcome"], "reproduced", "{claim}");
    }
    let runs = results["runs"].as_array().expect("runs");
    assert_eq!(runs.len(), 33);
    // The shipped wall is compared with the approaches of the thesis. It must display the requested stiffness.
    let ships: Vec<_> = runs
        .iter()
        .filter(|run| run["approach"] == "shipped")
        .collect();
    assert_eq!(ships.len(), 3);
    for run in ships {
        let shown = run["displayed_at_rest_n_per_mm"]
            .as_f64()
            .expect("a number");
        assert!((shown / 25.0 - 1.0).abs() < 0.05, "{run}");
    }
    for run in runs {
        for (name, value) in run.as_object().expect("a run") {
            assert!(
                // Each run is judged, on a smooth object without a vibration at the touch.
                (["not_judged", "texture", "material"].contains(&&**name) && value.is_null())
                    || value.is_string()
                    || value == &serde_json::Value::Bool(false)
                    || value.as_f64().is_some_and(f64::is_finite),
                "{name}: {value}"
            );
        }
    }
    let page = std::fs::read_to_string(folder.join("touchstone-report/index.html")).expect("page");
    assert_eq!(page.matches("<figure class=\"plot\">").count(), 4 * 33);
    let picture = page.find("class=\"picture\"").expect("a picture");
    assert!(picture < page.find("<table").expect("a table"));
    assert!(!page.contains("NaN") && !page.contains("http"));
    // The same command replaces its own results. Another command refuses to replace them.
    let again = run_in(&folder, ["thesis", "--dof", "3", "--json"]);
    assert!(again.status.success());
    let other = run_in(&folder, ["thesis", "--dof", "3", "--quiet"]);
    assert_eq!(
        other.status.code(),
        Some(2),
        "holds the results of another command"
    );
}

#[test]
fn what_has_no_meaning_is_refused_on_one_line() {
    let folder = folder("refused");
    for arguments in [
        &["thesis", "--dof", "2"][..],
        &["thesis", "--dof", "0"],
        &["thesis", "--dof", "3", "--set", "law.k_soft_n_m_per_rad=1"],
        &["thesis", "--dof", "3", "--strict-passive"],
        &["thesis", "--dof", "3", "--max-penetration", "0.1"],
    ] {
        let out = run_in(&folder, arguments);
        assert_eq!(out.status.code(), Some(2), "{arguments:?}");
        let text = String::from_utf8_lossy(&out.stderr);
        assert_eq!(text.lines().count(), 1, "{arguments:?}: {text}");
        assert!(text.contains("--dof") || text.contains("--set"), "{text}");
        assert!(!folder.join("touchstone-report").exists());
    }
}

/// Checks that a scene with the same object, law and material gives the forces of the live page bit for bit, with the settings that
/// the program writes into the page.
#[test]
fn the_live_page_plays_what_its_scene_plays() {
    use touchstone_lab::thesis::space::scene::SpaceScene;
    use touchstone_lab::thesis::space::{ProbingMotion, run};
    use touchstone_live::space_loop::{SPACE_ROW, SpaceChoice, SpaceLoop};
    let folder = folder("live-scene");
    let out = run_in(&folder, ["live", "--dof", "3", "inclined", "--no-open"]);
    assert!(out.status.success(), "{out:?}");
    let page = std::fs::read_to_string(folder.join("touchstone-live.html")).unwrap();
    let (_, content) = page.split_once("id=\"content\">").unwrap();
    let (content, _) = content.split_once("</script>").unwrap();
    let content: serde_json::Value = serde_json::from_str(content).unwrap();
    let text = |value: &serde_json::Value| value.as_str().unwrap().to_owned();
    let mut pairs = vec![(text(&content["shipped"]), "\"shipped\"".to_owned())];
    for material in content["materials"].as_array().unwrap() {
        let choice = text(&content["shipped"]) + &text(&material[1]);
        let law = format!("\"shipped\"\n[law.impact]\n{}", text(&material[2]));
        pairs.push((choice, law));
    }
    assert!(pairs.len() > 1);
    for (law, per_axis, approach) in [
        ("spring", false, "spring"),
        ("spring-damper", false, "spring-damper"),
        ("enhanced-sfa", false, "magnitude"),
        ("enhanced-sfa", true, "per-axis"),
    ] {
        let own = text(&content["thesis"][law]);
        let choice = format!("{own}guard=false\nper_axis={per_axis}\n");
        pairs.push((choice, format!("\"{approach}\"")));
    }
    let grooves = "[object]\nkind = \"inclined\"\ntexture = { height_mm = 0.1, period_mm = 2 }\n";
    let force = SPACE_ROW
        .iter()
        .position(|name| *name == "force_x_n")
        .unwrap();
    for (choice, law) in pairs {
        let scene = format!("dof = 3\n{grooves}[law]\napproach = {law}\n");
        let scene: SpaceScene = toml::from_str(&scene).unwrap();
        let cell = scene.completed().unwrap().cell();
        let record = run(&cell).unwrap();
        let motion = ProbingMotion::of(cell.object);
        let choice = choice + "texture_height_mm=0.1\ntexture_period_mm=2\n";
        let choice = SpaceChoice::of_text(&choice).unwrap();
        let mut page = SpaceLoop::at(choice, motion.rest_mm(0.0)).unwrap();
        for (tick, expected) in record.force_n.iter().enumerate() {
            let row = page.tick(motion.rest_mm(tick as f64 * 1e-3));
            assert_eq!(&row[force..force + 3], expected, "{law}, tick {tick}");
        }
        let touched = record
            .force_n
            .iter()
            .filter(|force| **force != [0.0; 3])
            .count();
        assert!(touched > 1000, "{law}: {touched}");
    }
}
