//! Tests which variants are judged, which of them a wall holds, and what is said of them.

use super::*;
use crate::scorecard::family_page::text;
use crate::scorecard::rivals::Rival;

fn knob(law: &str, k_desired: f64) -> Scene {
    let mut scene = Scene::load("thesis-knob").expect("a shipped scene");
    scene.wall.k_desired_n_m_per_rad = k_desired;
    Rival::named(law).expect("a law").of(&scene)
}

#[test]
fn corners_are_every_combination_and_a_seed_draws_the_same_between_them() {
    let scene = knob("enhanced", 20.0);
    let own = Around::default();
    let members = corners(&scene, &own);
    assert_eq!(members.len(), 216);
    let measured = Around {
        devices: Devices::Measured,
        ..Around::default()
    };
    assert_eq!(corners(&scene, &measured).len(), 81);
    let all = Around {
        devices: Devices::Corners,
        rates_hz: vec![1000, 2000, 5000, 10_000],
        noise_deg: vec![0.0, 0.03, 0.06],
    };
    let many = corners(&scene, &all);
    let mut names: Vec<&String> = many.iter().map(|member| &member.name).collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), 12 * 216);
    let drawn = sample(&scene, &all, 300, 7);
    assert_eq!(drawn[..100], sample(&scene, &all, 100, 7));
    assert_ne!(drawn[..100], sample(&scene, &all, 100, 8));
    for member in &drawn {
        let (device, own) = (&member.scene.device, &scene.device);
        for (one, nominal) in [
            (device.inertia_kg_m2, own.inertia_kg_m2),
            (device.damping_n_m_s_per_rad, own.damping_n_m_s_per_rad),
        ] {
            assert!((0.5..=2.0).contains(&(one / nominal)), "{}", member.name);
        }
        assert!((0.0..=1.0).contains(&member.delay_ticks));
        assert_eq!(member.scene.law, scene.law);
    }
    for rate_hz in &all.rates_hz {
        assert!(drawn.iter().any(|it| it.scene.timing.rate_hz == *rate_hz));
    }
    // Half the inertia with a whole tick of delay: three grips, two encoders, three dampings.
    let beyond = |members: &[Member]| members.iter().filter(|it| it.is_beyond_map()).count();
    assert_eq!(beyond(&members), 18);
    assert_eq!(beyond(&corners(&knob("enhanced", 14.0), &own)), 0);
}

/// The shipped settings over all combinations, without re-tuning: how many walls are lost, the deepest press or touch, and on
/// the nominal device the ripple in mN·m and the light touch.
#[test]
fn the_shipped_wall_keeps_its_family() {
    for (k_desired, most_lost, deepest, ripple_mn_m) in [
        (5.0, 0, 1.3, 1.0),
        (10.0, 0, 1.5, 2.0),
        (14.0, 0, 1.85, 3.0),
        (20.0, 12, 2.45, 4.0),
    ] {
        let (scene, own) = (knob("enhanced", k_desired), Around::default());
        let found = judge("enhanced", &scene, &own, &corners(&scene, &own), || ());
        let found = found.expect("runs");
        println!("{k_desired} N·m/rad: {found:?}");
        assert!(found.lost <= most_lost, "{k_desired}: {} lost", found.lost);
        assert_eq!(found.worst.len(), found.lost.max(WORST));
        let deep = found.deepest().expect("a wall that is held");
        assert!(deep <= deepest, "{k_desired}: {deep}");
        for nominal in &found.nominal {
            let ripple = nominal.ripple_rms_n_m.expect("a force");
            assert!(1e3 * ripple <= ripple_mn_m, "{k_desired}: {ripple}");
            let touch = nominal.touch.expect("a touch").penetration;
            assert!(touch <= 1.05, "{k_desired}: {touch}");
        }
    }
}

#[test]
fn an_ideal_wall_is_touched_once_by_each_hand_on_each_inertia_and_damping() {
    let scene = knob("enhanced", 10.0);
    let around = Around {
        devices: Devices::Measured,
        rates_hz: vec![1000, 2000],
        ..Around::default()
    };
    let members = corners(&scene, &around);
    let shared = ideal_touches(around.devices, &members).expect("runs");
    assert_eq!((members.len(), shared.len()), (2 * 81, 9));
    assert!(
        ideal_touches(Devices::Corners, &members)
            .expect("none")
            .is_empty()
    );
    // Variants with another delay and rate than the one that was simulated: its touches are theirs.
    for member in [&members[0], &members[40], &members[161]] {
        let own = IdealTouch::of(&member.scene, &Programme::of(&member.scene));
        assert_eq!(
            shared[&member.mechanics()],
            own.expect("runs"),
            "{}",
            member.name
        );
    }
}

#[test]
fn random_variants_have_lines_of_their_own_but_not_another_nominal_device() {
    let law = "spring-damper-estimated";
    let scene = knob(law, 5.0);
    let of = |devices, members: fn(&Scene, &Around) -> Vec<Member>| {
        let around = Around {
            devices,
            ..Around::default()
        };
        let members = members(&scene, &around);
        judge(law, &scene, &around, &members[..3], || ()).expect("runs")
    };
    let all = of(Devices::Corners, corners);
    let random = of(Devices::Random, |scene, around| sample(scene, around, 3, 1));
    assert_eq!((all.nominal.len(), random.nominal.len()), (1, 0));
    let json = serde_json::json!([all, random]);
    assert_eq!(
        (&json[1]["law"], &json[1]["devices"]),
        (&law.into(), &"random".into())
    );
    let text = text(&[all, random]);
    let lines = |start: &str| text.lines().filter(|line| line.starts_with(start)).count();
    // A line each in the first table and of three variants; the nominal device's has no name of the set.
    assert_eq!(lines("spring-damper-estimated corners  "), 4, "{text}");
    assert_eq!(lines("spring-damper-estimated random   "), 4, "{text}");
    assert_eq!(lines("spring-damper-estimated "), 9, "{text}");
}

#[test]
fn what_holds_loses_no_member_and_what_does_not_is_named() {
    let judged = |law, k_desired| {
        let scene = knob(law, k_desired);
        let own = Around::default();
        judge(law, &scene, &own, &corners(&scene, &own), || ()).expect("runs")
    };
    // This stiffness is below the critical stiffness of every variant. With half the damping and a tick of delay, the
    // critical stiffness is about a sixth of the nominal 1 N·m/rad.
    let soft = judged("spring", 0.1);
    assert_eq!((soft.members, soft.lost), (216, 0));
    // After a press as a step, an undamped spring would be twice as deep as at rest.
    assert!(soft.deepest_press.is_some_and(|it| it < 2.0), "{soft:?}");
    assert!(soft.nominal[0].motion_at_rest_rad.is_some());
    let hard = judged("spring", 20.0);
    assert_eq!(hard.lost, 216);
    assert_eq!(hard.lost_beyond_map, 18);
    // No variant holds the wall, so there is no depth that a demand could accept.
    assert_eq!((hard.deepest_press, hard.deepest()), (None, None));
    assert!(soft.deepest().is_some());
    assert_eq!((soft.worst.len(), hard.worst.len()), (5, 12));
    let text = text(&[soft, hard]);
    let lost = text.lines().nth(2).expect("the stiff wall's line");
    assert!(
        lost.split_whitespace().rev().take(2).all(|it| it == "lost"),
        "{lost}"
    );
    // Of the lost variants the heaviest comes first, because sampling limits it least.
    assert!(text.contains("2.00 J"));
}
