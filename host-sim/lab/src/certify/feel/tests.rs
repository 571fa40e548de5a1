//! Tests of the certificate of a feel.

use super::*;
use std::f64::consts::TAU;

fn feel(name: &str, sets: &[&str]) -> Scene {
    Scene::load(name).unwrap().with_overrides(sets).unwrap()
}

fn certified(scene: &Scene) -> FeelCertificate {
    let options = CertifyOptions {
        margins: false,
        ..CertifyOptions::default()
    };
    certify_feel(scene, &options).unwrap().unwrap()
}

fn part<'a>(found: &'a FeelCertificate, name: &str, sign: f64) -> &'a PartAtSteepest {
    let mut of = found.parts.iter();
    of.find(|it| it.part == name && it.stiffness_n_m_per_rad * sign > 0.0)
        .unwrap_or_else(|| panic!("no {name} in {found:?}"))
}

/// Checks slope and cell of each part against differences of the control law's own torque.
#[test]
fn the_steepest_cell_is_that_of_the_drawn_torque() {
    use touchstone_control::environment::Environment as Drawn;
    use touchstone_sim::run::surroundings::{Placed, environment};
    for name in touchstone_sim::scene::feels() {
        let scene = feel(
            name,
            &[
                "law.guard.on=false",
                "encoder=none",
                "environment.endstops=none",
                "environment.dry_friction=none",
                "environment.damper=none",
                "environment.click=none",
            ],
        );
        let options = CertifyOptions {
            margins: false,
            ..CertifyOptions::default()
        };
        let Some(found) = certify_feel(&scene, &options).unwrap() else {
            continue;
        };
        let parts = found.parts.iter().filter(|it| it.part == "together");
        let sum: Vec<_> = match parts.clone().count() {
            0 => found.parts.iter().collect(),
            _ => parts.collect(),
        };
        let slope = |angle: f64, way: f64| {
            let mut drawn: Drawn<f64> = environment::<f64>(&scene).unwrap();
            let [low, high] = [-way, way].map(|by| drawn.tick(&Placed(angle + by), None).to_f64());
            (high - low) / (2.0 * way)
        };
        for it in sum {
            let [from, to] = it.cell_rad.unwrap();
            let got = slope(0.5 * (from + to), 0.2 * (to - from));
            let wanted = it.stiffness_n_m_per_rad;
            assert!((got / wanted - 1.0).abs() < 2e-3, "{name}: {got} {it:?}");
        }
        // The torque is not steeper at any other angle.
        let most = found.parts[found.stiffest].stiffness_n_m_per_rad;
        for i in 0..3000 {
            let angle = 0.0021 * f64::from(i);
            assert!(slope(angle, 1e-4) <= most * 1.01 + 1e-3, "{name} {angle}");
        }
    }
}

/// On a device with delay, a soft detent is stable; a steep one oscillates.
#[test]
fn a_steep_detent_is_unstable_and_named() {
    let soft = certified(&feel("coarse-detents", &[]));
    assert_eq!(soft.verdict, Verdict::Stable, "{soft:?}");
    assert_eq!(soft.parts[soft.stiffest].part, "environment.detents");
    let snaps = part(&soft, "environment.detents", -1.0);
    assert!(
        snaps
            .hands
            .iter()
            .any(|it| it.hand == "nobody" && it.rest == Rest::Snaps),
        "{snaps:?}"
    );
    let sets = [
        "environment.detents.per_rev=400",
        "environment.detents.strength_n_m=0.045",
    ];
    let steep = certified(&feel("coarse-detents", &sets));
    assert_eq!(steep.verdict, Verdict::Unstable, "{steep:?}");
    let worst = &steep.parts[steep.stiffest];
    assert_eq!(worst.part, "environment.detents");
    let pitch = TAU / 400.0;
    assert!((worst.stiffness_n_m_per_rad - 4.0 * 0.045 / pitch).abs() < 1e-9);
    let [from, to] = worst.cell_rad.unwrap();
    assert!((from + pitch / 4.0).abs() < 1e-12 && (to - pitch / 4.0).abs() < 1e-12);
    // The simulated knob also buzzes on the steep detent, and rests on the soft one.
    use crate::scorecard::feel::feel_card;
    let buzz = |sets: &[&str]| {
        let card = feel_card(&feel("coarse-detents", sets), 50).unwrap();
        card.grips
            .iter()
            .map(|it| it.buzz_counts)
            .fold(0.0, f64::max)
    };
    assert!(buzz(&[]) <= 2.0 && buzz(&sets) > 2.0);
}

#[test]
fn parts_that_meet_are_added() {
    let sets = [
        "environment.spring.stiffness_n_m_per_rad=0.1",
        "environment.spring.strength_n_m=0.03",
    ];
    let found = certified(&feel("coarse-detents", &sets));
    let [detents, spring, sum] = ["environment.detents", "environment.spring", "together"]
        .map(|name| part(&found, name, 1.0).stiffness_n_m_per_rad);
    assert!(
        (sum - detents - spring).abs() < 1e-12,
        "{sum} {detents} {spring}"
    );
    // Detents by pitch and a profile have no common period, so the slopes are added without a cell.
    let sets = [
        "environment.detents.per_rev=0",
        "environment.profile.per_rev=7",
    ];
    let found = certified(&feel("coarse-detents", &sets));
    assert_eq!(part(&found, "together", 1.0).cell_rad, None);
    assert!(
        found
            .not_covered
            .iter()
            .any(|it| it.contains("`together` adds"))
    );
}

#[test]
fn walls_count_and_a_feel_without_slope_has_no_certificate() {
    let stops = certified(&feel("hard-stops", &[]));
    assert_eq!(stops.parts[stops.stiffest].part, "environment.endstops");
    let hands: Vec<_> = stops.parts[0].hands.iter().map(|it| &*it.hand).collect();
    assert_eq!(hands, ["light", "medium", "firm", "nobody"]);
    let stiff = certified(&feel(
        "hard-stops",
        &["environment.endstops.stiffness_n_m_per_rad=60"],
    ));
    assert_ne!(stiff.verdict, Verdict::Stable);
    let options = CertifyOptions::default();
    assert_eq!(certify_feel(&feel("smooth", &[]), &options).unwrap(), None);
}
