//! Tests of the map of tuned walls: damping limits a spring, inertia limits a tuned wall, and cells in the file are not computed
//! again.

use super::map::{figures, picture, words};
use super::*;
use std::fs;

fn plan(law: &str, size: [usize; 2]) -> BoundaryPlan {
    let mut plan = BoundaryPlan::new(
        Scene::load("thesis-knob").unwrap(),
        Rival::named(law).unwrap(),
        size,
    );
    plan.delays = vec![0.0];
    plan.ticks = 2e5;
    plan
}

fn computed(plan: &BoundaryPlan) -> Vec<BoundaryCell> {
    plan.places()
        .into_par_iter()
        .map(|place| plan.cell(place).unwrap())
        .collect()
}

#[test]
fn a_place_is_the_device_that_its_two_numbers_say() {
    let plan = plan("spring", [3, 4]);
    for place in plan.places() {
        let scene = plan.scene(place);
        let (period_s, inertia) = (scene.timing.period_s(), scene.device.inertia_kg_m2);
        let damping = scene.device.damping_n_m_s_per_rad * period_s / inertia;
        assert!((damping / place.damping_per_tick - 1.0).abs() < 1e-12);
        let stiffness = crate::scorecard::stiffness_per_tick(&scene);
        assert!((stiffness / place.stiffness_per_tick - 1.0).abs() < 1e-12);
        let MotionSpec::TouchAndPress(press) = &scene.operator.motion else {
            panic!("{:?}", scene.operator.motion)
        };
        let depth = press.push_torque_n_m / scene.wall.k_desired_n_m_per_rad;
        let counts = depth / scene.encoder.as_ref().unwrap().step_rad();
        assert!(counts > 19.999, "{counts} counts deep");
        assert!(scene.law.force_limit_n_m >= 4.9 * press.push_torque_n_m);
    }
}

#[test]
fn damping_limits_a_spring_and_inertia_a_tuned_wall() {
    let narrow = |law| {
        let mut plan = plan(law, [2, 8]);
        plan.dampings = vec![0.003, 0.03];
        plan.stiffnesses = even_ratios([0.06, 1.9], 8);
        let cells = computed(&plan);
        let limits = limits(&plan, &cells);
        println!("{:?}", words(&plan, &cells));
        // The matrices alone would call two of the tuned walls at a stiffness of 1.9 rad per period stable. The matrices do not
        // describe a device that leaves the wall.
        let wrong = |cell: &&BoundaryCell| cell.is_certified() && cell.ended > TunedEnding::Rests;
        assert_eq!(cells.iter().find(wrong), None);
        let slope = slope(&limits, 0.0, 1.0);
        (slope.unwrap(), limits)
    };
    let (spring, of_spring) = narrow("spring");
    let (tuned, of_tuned) = narrow("spring-damper-estimated");
    // The slope of a spring is nearer to 0.5 than to 0, that of a tuned wall nearer to 0. If the limit differs by one row of the
    // map over this decade of damping, the slope is 0.21.
    assert!((0.25..0.75).contains(&spring), "{spring} {of_spring:?}");
    assert!(tuned.abs() < 0.25, "{tuned} {of_tuned:?}");
    for (spring, tuned) in of_spring.iter().zip(&of_tuned) {
        assert!(spring.rests_up_to < tuned.rests_up_to);
        assert!(tuned.highest_at_rest < Some(1.9), "the plane ends above");
        // Tuned walls are certified up to at least 0.3 of the stiffness at which they rest, and further than springs.
        assert!(tuned.certified_up_to >= tuned.rests_up_to.map(|most| 0.3 * most));
        assert!(spring.certified_up_to < tuned.certified_up_to);
    }
}

#[test]
fn the_drawing_has_every_cell_once_and_a_panel_a_delay() {
    let mut plan = plan("fba", [3, 4]);
    plan.delays = vec![0.0, 1.0];
    plan.ticks = 1.0;
    let cells = computed(&plan);
    // No program that reads the table may take a digest for a number.
    assert!(cells.iter().all(|cell| cell.plan.starts_with("plan-")));
    let figures = figures(&plan, &cells);
    assert_eq!(figures.len(), 2);
    for figure in &figures {
        let tiles: usize = figure
            .lines
            .iter()
            .map(|line| match &line.shape {
                touchstone_report::figure::Shape::Tiles(tiles) => tiles.len(),
                _ => 0,
            })
            .sum();
        assert_eq!(tiles, 12);
    }
    let drawn = picture(&plan, &cells);
    assert!(drawn.starts_with("<svg ") && !drawn.contains("NaN"));
    assert_eq!(words(&plan, &cells).len(), 2);
}

#[test]
fn a_boundary_that_was_ended_goes_on_and_a_strange_file_is_refused() {
    let file = std::env::temp_dir().join(format!("touchstone-boundary-{}", std::process::id()));
    let _ = fs::remove_file(&file);
    let mut plan = plan("spring", [2, 5]);
    let mut first = Vec::new();
    let cells = plan.fill(&file, |done| first.push(done)).unwrap();
    assert_eq!((first[0], cells.len()), (0, 10));
    // The file as it is after an interruption in the middle of a line.
    let whole = fs::read(&file).unwrap();
    fs::write(&file, &whole[..whole.len() - 5]).unwrap();
    let mut again = Vec::new();
    assert_eq!(plan.fill(&file, |done| again.push(done)).unwrap(), cells);
    assert_eq!(again, [9, 10]);
    assert_eq!(fs::read(&file).unwrap(), whole);
    plan.seed = 2;
    let refused = plan.fill(&file, |_| ()).unwrap_err();
    assert!(refused.to_string().contains("another scene"), "{refused}");
    fs::remove_file(&file).unwrap();
}
