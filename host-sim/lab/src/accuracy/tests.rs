use super::*;
use crate::documented::is_documented;
use touchstone_report::plain_schema::misfit;

fn quick() -> Accuracy {
    let mut rounds = 0;
    let options = AccuracyOptions { quick: true };
    let found = measure(
        options,
        ProgramVersion::default(),
        Machine::here("rustc"),
        "touchstone accuracy --quick",
        || rounds += 1,
    )
    .unwrap();
    assert_eq!(rounds, options.rounds());
    found
}

#[test]
fn the_documented_schema_is_this_one() {
    is_documented("accuracy.schema.json", &schema::schema());
}

/// Checks the errors of a quick measurement against known values. Errors, unlike computing times, are nearly or exactly the same on
/// every machine.
#[test]
fn a_quick_run_says_what_is_known() {
    let found = quick();
    let value = serde_json::to_value(&found).unwrap();
    assert_eq!(misfit(&schema::schema(), &value, ""), None);

    let names: Vec<&str> = found.plant.iter().map(|diagram| diagram.problem).collect();
    assert_eq!(names, ["smooth", "stick-slip", "contact", "current-loop"]);
    for diagram in &found.plant {
        // The reference is far more exact than the methods. The closed-form solution is off by rounding only, over a thousand
        // steps with an angle below 1 rad.
        assert!(diagram.reference_floor_rad < 1e-17, "{diagram:?}");
        let exact = &diagram.points[0];
        assert!(exact.error_rad.unwrap() < 1e-13, "{exact:?}");
        assert!(exact.energy_gap.unwrap_or(0.0) < 1e-12, "{exact:?}");
        // With stops and starts no other method comes near the exact step with these substeps.
        if diagram.events > 0 {
            let best = diagram.points[1..]
                .iter()
                .filter_map(|point| point.error_rad)
                .fold(1.0, f64::min);
            assert!(best > 1e-9, "{best}");
        }
    }
    assert!(found.plant[1].events >= 4 && found.plant[2].events >= 4);
    let diverged = |index: usize| {
        found.plant[index]
            .points
            .iter()
            .filter(|point| point.error_rad.is_none())
            .count()
    };
    // Only the two explicit methods with one substep diverge, behind a current loop of 5 kHz.
    assert_eq!([0, 1, 2, 3].map(diverged), [0, 0, 0, 2]);

    // The whole diagram is drawn, with a sign for each point.
    for ((name, text), diagram) in figures::all(&found).iter().zip(&found.plant) {
        assert_eq!(
            text.matches("class=\"sign").count(),
            diagram.points.len(),
            "{name}"
        );
        assert!(!text.contains("NaN") && !text.contains("inf"), "{name}");
    }

    // `f64` is its own reference. A spring in fixed32 is within one step of force, plus 5 N·m/rad times one step of position.
    let law = |law: &str, number: &str| {
        found
            .law
            .iter()
            .find(|point| point.law == law && point.number == number)
            .unwrap()
    };
    assert_eq!(law("spring", "f64").force_error_n_m, Some(0.0));
    assert!(law("spring", "fixed32").force_error_n_m.unwrap() < 6.0 * FORCE_QUANTUM_N_M);
    assert!(law("spring", "fixed16").force_error_n_m.unwrap() > 6.0 * FORCE_QUANTUM_N_M);

    let exact = found
        .closed_loop
        .iter()
        .find(|point| point.method == "exact")
        .unwrap();
    assert_eq!(exact.path_difference_rad, 0.0);
    // The largest stable stiffness is b/(T/2), up to a relative error of b T/J for this device.
    assert!(
        (exact.k_max_n_m_per_rad.unwrap() / 0.8 - 1.0).abs() < 4e-3,
        "{exact:?}"
    );
    let text = table::render(&found);
    assert!(
        text.contains("to be within one encoder count") && text.contains("diverged"),
        "{text}"
    );
}
