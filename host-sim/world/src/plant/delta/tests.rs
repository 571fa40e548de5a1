use super::*;
use crate::plant::FIRM_TRANSLATION;
use nalgebra::Vector3;

const REST: [f64; 3] = [0.0; 3];

/// Positions all over the workspace, within 40 mm of the centre.
fn places() -> impl Iterator<Item = Vector3<f64>> {
    (0..2000_u32).map(|i| {
        let t = f64::from(i);
        let r = 0.04 * libm::cbrt((t + 0.5) / 2000.0);
        let (up, around) = (libm::sin(1.7 * t), 2.399_963 * t);
        let flat = libm::sqrt(1.0 - up * up);
        Vector3::new(flat * libm::cos(around), flat * libm::sin(around), up) * r
    })
}

#[test]
fn joints_and_back_are_the_place() {
    let mut worst = 0.0_f64;
    for place in places() {
        let pose = FALCON.geometry.pose(place).expect("inside");
        // Newton's method starts 10 mm away from the position.
        let near = place + Vector3::new(0.006, -0.006, 0.005);
        let found = FALCON.geometry.place(pose.joints_rad, near).expect("back");
        worst = worst.max((found.place_m - place).norm());
    }
    println!("forward after inverse: off by at most {worst:.1e} m of 2000 places");
    assert!(worst < 1e-13, "{worst}");
}

/// Checks that the forearms keep their length. The test computes the length from the joint angles, independently of the tested
/// code.
#[test]
fn the_loops_are_closed() {
    let geometry = FALCON.geometry;
    for place in places() {
        let pose = geometry.pose(place).expect("inside");
        for (leg, angle) in geometry.legs_rad.iter().zip(pose.joints_rad.iter()) {
            let (sin, cos) = leg.sin_cos();
            let out =
                cos * place.x + sin * place.y - (geometry.reach_m + geometry.arm_m * angle.cos());
            let up = place.z + geometry.height_m - geometry.arm_m * angle.sin();
            let aside = -sin * place.x + cos * place.y + geometry.aside_m;
            // The ends lie in the plane of the leg, the sides of the parallelogram lean out of it.
            let in_plane = out.hypot(up) - geometry.ends_m;
            assert!((in_plane.hypot(aside) - geometry.forearm_m).abs() < 1e-15);
        }
    }
}

#[test]
fn slopes_and_curvature_are_derivatives() {
    let geometry = FALCON.geometry;
    let (mut first, mut second) = (0.0_f64, 0.0_f64);
    for (i, place) in places().enumerate() {
        let pose = geometry.pose(place).expect("inside");
        let t = i as f64;
        let way = Vector3::new((0.3 * t).sin(), (0.7 * t).cos(), (1.1 * t).sin());
        let h = 1e-5;
        let at = |share: f64| geometry.pose(place + way * share).expect("near").joints_rad;
        let slope = (at(h) - at(-h)) / (2.0 * h);
        let bend = (at(h) - pose.joints_rad * 2.0 + at(-h)) / (h * h);
        first = first.max((slope - pose.slopes * way).amax() / slope.amax());
        second =
            second.max((bend - geometry.curvature(&pose, way)).amax() / bend.amax().max(100.0));
    }
    println!("slopes within {first:.1e}, curvature within {second:.1e} of differences");
    assert!(first < 1e-6 && second < 1e-3, "{first} {second}");
}

/// Checks that the motors' power `τ·dθ/dt` equals the effector's power `F·v`.
#[test]
fn power_is_the_same_on_both_sides() {
    for (i, place) in places().enumerate() {
        let pose = FALCON.geometry.pose(place).expect("inside");
        let t = i as f64;
        let velocity = Vector3::new(t.sin(), (2.0 * t).cos(), (0.5 * t).sin());
        let force = Vector3::new((1.3 * t).cos(), t.cos(), (0.9 * t).sin()) * 5.0;
        let torques = pose.torques_n_m(force);
        let apart = force.dot(&velocity) - torques.dot(&(pose.slopes * velocity));
        assert!(apart.abs() < 1e-13, "{apart}");
        assert!((pose.force_n(torques) - force).amax() < 1e-13);
    }
}

#[test]
fn a_force_beyond_a_motor_keeps_its_direction() {
    let mut shortened = 0;
    for place in places() {
        let pose = FALCON.geometry.pose(place).expect("inside");
        let wanted = Vector3::new(9.0, -20.0, 14.0);
        let torques = FALCON.limited_torques_n_m(&pose, wanted);
        let force = pose.force_n(torques);
        assert!(torques.amax() <= FALCON.torque_n_m * (1.0 + 1e-15));
        assert!(force.cross(&wanted).norm() < 1e-12 * wanted.norm_squared());
        assert!(force.dot(&wanted) > 0.0);
        shortened += usize::from(force.norm() < 0.99 * wanted.norm());
    }
    assert!(shortened > 1000, "{shortened}");
    // At the centre the motors must give 8 N in every direction, and only slightly more.
    let pose = FALCON.geometry.pose(Vector3::zeros()).expect("centre");
    let needed = |way: Vector3<f64>| pose.torques_n_m(way.normalize() * 8.0).amax();
    println!(
        "8 N at the centre take {:.4} N·m",
        places().map(needed).fold(0.0, f64::max)
    );
    for way in places().map(|place| place.normalize()) {
        let force = pose.force_n(FALCON.limited_torques_n_m(&pose, way * 8.0));
        let missing = (force - way * 8.0).amax();
        assert!(missing < 1e-12, "{missing} N of {way}");
    }
}

#[test]
fn singular_places_are_refused() {
    let geometry = FALCON.geometry;
    let refused = |x: f64, y: f64, z: f64| geometry.pose(Vector3::new(x, y, z)).err();
    assert!(matches!(
        refused(0.0, 0.0, 0.1),
        Some(Unreachable::TooFar(_))
    ));
    assert!(matches!(
        refused(0.0, 0.3, 0.0),
        Some(Unreachable::TooFar(_))
    ));
    assert!(refused(f64::NAN, 0.0, 0.0).is_some());
    // Moves straight up until arms and forearms are in line, 118 mm + 63 mm above the base.
    let mut last = None;
    for i in 0..1000 {
        let z = 1e-4 * f64::from(i);
        match geometry.pose(Vector3::new(0.0, 0.0, z)) {
            Ok(_) => assert_eq!(last, None, "usable again at {z}"),
            Err(why) => {
                last.get_or_insert((why, z));
            }
        }
    }
    let (why, z) = last.expect("a limit");
    assert!(matches!(why, Unreachable::Stretched(_)), "{why} at {z}");
    // Joint angles that point each arm inwards belong to no position either.
    assert!(
        geometry
            .place(Vector3::repeat(3.0), Vector3::zeros())
            .is_err()
    );
}

/// Checks that a free device without damping keeps its energy while its inertia changes with the position.
#[test]
fn free_motion_keeps_its_energy() {
    let device = DeltaDevice {
        joint_damping: 0.0,
        ..FALCON
    };
    let plant = DeltaPlant::new(&device, None, 1e-3).expect("plant");
    let mut state = DeltaState::at_rest([-0.02, 0.01, -0.02]);
    state.velocity = Vector3::new(0.4, -0.1, 0.3);
    let start = plant.stored_energy_j(&state, REST).expect("inside");
    let speed = state.velocity.norm();
    let mut slowest = speed;
    for _ in 0..100 {
        plant
            .step(&mut state, Vector3::zeros(), REST)
            .expect("inside");
        slowest = slowest.min(state.velocity.norm());
    }
    let now = plant.stored_energy_j(&state, REST).expect("inside");
    println!(
        "{:.1e} of the energy over 0.1 s, speed {speed:.3} to {slowest:.3} m/s",
        now / start - 1.0
    );
    assert!((now / start - 1.0).abs() < 1e-11, "{}", now / start - 1.0);
    // The inertia depends on the direction of motion: a constant mass would have kept its speed.
    assert!(slowest < 0.99 * speed, "{slowest}");
}

/// Checks the energy balance of a device in a hand under motor torques: work in equals losses plus the change of the stored energy.
#[test]
fn the_books_close_in_a_hand() {
    let plant = DeltaPlant::new(&FALCON, Some(&FIRM_TRANSLATION), 1e-3).expect("plant");
    let mut state = DeltaState::at_rest([0.0, 0.01, 0.0]);
    let (mut worst, mut worked) = (0.0_f64, 0.0_f64);
    for tick in 0..3000 {
        let t = f64::from(tick) * 1e-3;
        let rest = [0.02 * (3.0 * t).sin(), 0.01, 0.015 * (5.0 * t).cos()];
        let before = plant.stored_energy_j(&state, rest).expect("inside");
        let pose = FALCON.geometry.pose(state.place_m).expect("inside");
        let force = Vector3::new((40.0 * t).sin(), -2.0 * (9.0 * t).cos(), 3.0);
        let torques = FALCON.limited_torques_n_m(&pose, force);
        let work = plant.step(&mut state, torques, rest).expect("inside");
        let after = plant.stored_energy_j(&state, rest).expect("inside");
        assert!(work.loss.device_j >= 0.0 && work.loss.hand_j >= 0.0);
        worst = worst.max((after - before + work.loss.total_j() - work.motors_j).abs());
        worked += work.motors_j.abs();
    }
    println!("books off by at most {worst:.1e} J in a tick, {worked:.2} J of work");
    assert!(worst < 1e-12 && worked > 0.01, "{worst} {worked}");
}

/// Checks that the integration method is of fourth order: half the substep gives about a sixteenth of the error.
#[test]
fn the_method_is_of_fourth_order() {
    let end = |substeps: u32| {
        let plant = DeltaPlant::new(&FALCON, Some(&FIRM_TRANSLATION), 0.04).expect("plant");
        let plant = plant.in_substeps(substeps);
        let mut state = DeltaState::at_rest([0.01, 0.0, -0.01]);
        let torques = Vector3::new(0.05, -0.08, 0.1);
        plant
            .step(&mut state, torques, [0.03, 0.01, 0.0])
            .expect("inside");
        state.place_m
    };
    let exact = end(640);
    let (coarse, fine) = ((end(10) - exact).norm(), (end(20) - exact).norm());
    let order = (coarse / fine).log2();
    assert!((3.5..5.0).contains(&order), "{order}");
}

/// Checks that a slow push on the effector accelerates it by the inertia at its position. The curvature of the joint angles has no
/// effect at rest.
#[test]
fn a_push_accelerates_by_the_inertia_of_its_place() {
    let device = DeltaDevice {
        joint_damping: 0.0,
        ..FALCON
    };
    let plant = DeltaPlant::new(&device, None, 1e-4).expect("plant");
    for place in places().step_by(97) {
        let mut state = DeltaState::at_rest(place.into());
        let pose = device.geometry.pose(place).expect("inside");
        let force = Vector3::new(1.0, -0.5, 2.0);
        let torques = pose.torques_n_m(force);
        plant.step(&mut state, torques, REST).expect("inside");
        let expected = device.inertia_kg(&pose).try_inverse().expect("M") * force * 1e-4;
        assert!((state.velocity - expected).norm() < 1e-5 * expected.norm());
    }
    let centre = device.geometry.pose(Vector3::zeros()).expect("centre");
    let inertia = device.inertia_kg(&centre);
    let damping = centre.slopes.tr_mul(&centre.slopes) * FALCON.joint_damping;
    println!(
        "at the centre: {:.3?} kg, {:.2?} N·s/m",
        inertia.diagonal().as_slice(),
        damping.diagonal().as_slice()
    );
}
