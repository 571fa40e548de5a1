use super::*;
use crate::documented::is_documented;
use touchstone_report::plain_schema::misfit;

#[test]
fn the_documented_schema_is_this_one() {
    is_documented("hard.schema.json", &schema::schema());
}

#[test]
fn every_case_comes_out_as_it_must() {
    let found = run(
        &cases(),
        Effort::default(),
        ProgramVersion::default(),
        |_| {},
    )
    .unwrap();
    println!("{}", table::render(&found));
    let value = serde_json::to_value(&found).unwrap();
    assert_eq!(misfit(&schema::schema(), &value, ""), None);
    assert!(found.passed, "{}", table::render(&found));
    for case in &found.cases {
        println!("{:22} {:.2} s", case.name, case.seconds);
        assert!(
            case.worst().is_some(),
            "{} has nothing that must hold",
            case.name
        );
    }
    let mut names: Vec<&str> = found.cases.iter().map(|case| case.name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), found.cases.len(), "two cases of one name");
}

#[test]
fn a_surprise_is_a_failure_either_way() {
    let within = Finding::new("a", 0.5, 1.0);
    let beyond = Finding::new("b", 2.0, 1.0);
    let no_number = Finding::new("c", f64::NAN, 1.0);
    assert!(within.is_as_expected() && !beyond.is_as_expected() && !no_number.is_as_expected());
    assert!(beyond.clone().failing("known").is_as_expected());
    assert!(!within.clone().failing("thought so").is_as_expected());
    assert_eq!((within.used(), beyond.used()), (0.5, 2.0));
    assert!(no_number.used().is_infinite());
}
