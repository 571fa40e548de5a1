//! Tests of difficult cases for a proxy, the point on an object's surface to which the force pulls the hand's point (HIP). Each
//! test has the number of its case. Case 2 is in `space_surface_points`.

use touchstone_control::LawKind;
use touchstone_control::space::Magnitude;
use touchstone_control::space::environment::{Corner, Edge, Facets, Plane};
use touchstone_control::space::{Direction, Rule, Surface, SurfacePoint, Turn};
use touchstone_tests::random::Random;
use touchstone_tests::space::{
    F, UNIT, angle, at, direction, dot, in_mm, length, mm, numbers, omega, place_in_mm, push_in_n,
};
use touchstone_tests::surface_path::{
    RATIO, ROUNDING, along, inside, largest_turn, plane, restricted, thin,
};

/// Case 1: checks that the hand does not pop through a thin plate. The plate is thinner than the 0.48 mm that a force of 12 N
/// presses into a virtual wall of 25 N/mm.
#[test]
fn proxy_case_1_no_pop_through_a_thin_plate() {
    let press = [[3.0, 2.0, 1.0], [3.0, 2.0, -0.6], [4.0, -2.0, -0.6]];
    for rule in [Rule::Closest, restricted()] {
        let touches = along(rule, &thin(), &press, 100);
        let last = touches.last().expect("one");
        assert_eq!(
            last.normal,
            Direction::along(2, false),
            "pushed back to where it came from"
        );
        assert!((in_mm(last.depth) - 0.7).abs() < 1e-4);
        let from_below = along(rule, &thin(), &press.map(|[x, y, z]| [x, y, -z]), 100);
        assert_eq!(
            from_below.last().expect("one").normal,
            Direction::along(2, true)
        );
    }
    // A box of the same size lets the HIP through, so the case is a real one.
    let through = along(Rule::Closest, &thin().body, &press, 100);
    assert_eq!(
        through.last().expect("one").normal,
        Direction::along(2, true)
    );
    // Around the rim the HIP comes to the other side.
    let around = [
        [0.0, 0.0, 1.0],
        [31.0, 0.0, 1.0],
        [31.0, 0.0, -1.0],
        [0.0, 0.0, -1.0],
        [0.0, 0.0, -0.05],
    ];
    let touches = along(Rule::Closest, &thin(), &around, 100);
    assert_eq!(
        touches.last().expect("one").normal,
        Direction::along(2, true)
    );
}

#[test]
fn proxy_case_3_in_a_concave_corner_it_lies_on_the_crease() {
    let pairs = [
        [direction(1.0, 0.0, 0.0), direction(0.0, 0.0, 1.0)],
        [direction(1.0, 0.2, 0.5), direction(-0.3, 0.1, 1.0)],
        [direction(1.0, 0.0, 1.0), direction(-1.0, 0.3, 0.4)],
    ];
    for normals in pairs {
        let planes = normals.map(|normal| plane(normal, 1.0));
        let corner = Corner::new(planes);
        let (a, b) = (numbers(&normals[0]), numbers(&normals[1]));
        let mut random = Random::new(3);
        let mut in_both = 0;
        for _ in 0..20_000 {
            let here = at(
                5.0 * random.real(),
                5.0 * random.real(),
                5.0 * random.real(),
            );
            let nearest = corner.nearest(here, &Direction::default());
            let n = numbers(&nearest.normal);
            let point = place_in_mm(here + nearest.normal.times(nearest.depth));
            let below = |plane: &Plane<F>| in_mm(plane.above(here));
            let heights = [dot(a, point) - 1.0, dot(b, point) - 1.0];
            // The surface point is on the surface: on or above both planes, and on one of them.
            let lowest = heights[0].min(heights[1]);
            assert!(lowest.abs() < 1e-5, "{heights:?} of {point:?}");
            if below(&planes[0]) < -0.01 && below(&planes[1]) < -0.01 {
                let cross = [
                    a[1] * b[2] - a[2] * b[1],
                    a[2] * b[0] - a[0] * b[2],
                    a[0] * b[1] - a[1] * b[0],
                ];
                assert!(dot(n, cross).abs() < 1e-5, "in the plane of both normals");
                let on_crease = heights[0].abs() < 1e-5 && heights[1].abs() < 1e-5;
                let reaches_over = dot(a, b) * in_mm(nearest.depth) != 0.0 && !on_crease;
                assert!(on_crease || reaches_over);
                in_both += usize::from(on_crease);
            }
        }
        println!("{in_both} places below both planes are held on the crease");
        assert!(in_both > 1000);
    }
}

/// Case 4: checks that the force turns continuously while the hand's point (HIP) goes around an edge at 0.3 mm below both faces.
/// The cone that limits the turn keeps the first face until the way out through that face is `1/sin` of the cone's half angle times
/// the way out through the other face.
#[test]
fn proxy_case_4_over_a_convex_edge_the_force_turns_continuously() {
    let edge = Edge::new([
        plane(Direction::along(2, false), 0.0),
        plane(Direction::along(0, false), 0.0),
    ]);
    let law = UNIT
        .law::<F>(&omega(LawKind::Spring, 25.0))
        .expect("settings");
    let path = [
        [-5.0, 0.0, 0.1],
        [-5.0, 0.0, -0.3],
        [-0.3, 0.0, -0.3],
        [-0.3, 0.0, -5.0],
    ];
    for ratio in [0.1_f64, 0.3] {
        let rule = Rule::Restricted(Turn::of_ratio(mm(10.0 * ratio).0));
        let touches = along(rule, &edge, &path, 470);
        let mut shell = Magnitude::new(law);
        let forces: Vec<[f64; 3]> = touches
            .iter()
            .map(|touch| push_in_n(shell.tick(touch)))
            .collect();
        let pushing = |pair: &&[[f64; 3]]| pair.iter().all(|force| length(*force) > 1.0);
        let turns = forces.windows(2).filter(pushing);
        let worst = turns
            .map(|pair| angle(pair[0], pair[1]))
            .fold(0.0, f64::max);
        println!(
            "ratio {ratio}: the force turns by at most {worst:.5} of {:.5} rad in a tick",
            ratio.atan()
        );
        // A force of more than a newton has at least 24 binary digits, so it turns by no more than the direction.
        assert!(worst <= ratio.atan() + ROUNDING && worst > 0.9 * ratio.atan());
        let last = forces.last().expect("one");
        assert!(
            last[0] > 7.4 && last[2].abs() < 1e-4,
            "around the edge: {last:?}"
        );
        let switched = touches
            .iter()
            .find(|touch| numbers(&touch.normal)[0] > 0.05);
        let deep = -place_in_mm(switched.expect("it turns").at)[2];
        assert!((deep - 0.3 / ratio.atan().sin()).abs() < 0.02, "{deep}");
    }
    // With the rule `Closest` the force turns at once.
    assert!(largest_turn(&along(Rule::Closest, &edge, &path, 470)) > 1.5);
}

/// Case 5: checks that the seam between two coplanar faces of a convex body is not felt.
#[test]
fn proxy_case_5_a_seam_between_coplanar_faces_is_not_felt() {
    let top = plane(Direction::along(2, false), 0.0);
    let one = [top];
    let two = [top, top];
    for rule in [Rule::Closest, Rule::Penetration, restricted()] {
        let path = [[-5.0, 1.0, 0.1], [-5.0, 1.0, -0.4], [5.0, -1.0, -0.4]];
        let plain = along(rule, &Facets { planes: &one }, &path, 200);
        let seamed = along(rule, &Facets { planes: &two }, &path, 200);
        assert_eq!(plain, seamed, "not one bit");
    }
}

/// The faces of a pyramid with this many sides and its apex at the origin.
fn pyramid(faces: u32) -> Vec<Plane<F>> {
    (0..faces)
        .map(|i| {
            let phi = std::f64::consts::TAU * f64::from(i) / f64::from(faces);
            plane(direction(phi.cos(), phi.sin(), 0.8), 0.0)
        })
        .collect()
}

#[test]
fn proxy_case_6_vertices_of_three_to_twelve_faces() {
    for faces in 3..=12 {
        let planes = pyramid(faces);
        let body = Facets { planes: &planes };
        // The path goes around below the apex, through all faces, and up the middle.
        let mut path: Vec<[f64; 3]> = (0..=24)
            .map(|i| {
                let phi = f64::from(i) * 0.53;
                [0.5 * phi.cos(), 0.5 * phi.sin(), -1.5]
            })
            .collect();
        path.extend([[0.0, 0.0, -1.5], [0.0, 0.0, -0.1]]);
        for rule in [Rule::Closest, restricted()] {
            let touches = along(rule, &body, &path, 100);
            assert!(touches.iter().all(inside), "{faces} faces");
            for pair in touches.windows(2) {
                let step = length(std::array::from_fn(|i| {
                    place_in_mm(pair[1].at)[i] - place_in_mm(pair[0].at)[i]
                }));
                let change = (in_mm(pair[1].depth) - in_mm(pair[0].depth)).abs();
                // In the restricted direction the way out is longer than to the closest point, and the direction turns as well.
                // Three times the step and two turns are allowed.
                let most = if rule == Rule::Closest {
                    step
                } else {
                    3.0 * (step + 2.0 * RATIO)
                };
                assert!(
                    change <= most + 1e-5,
                    "{faces} faces: depth jumps by {change} mm in a step of {step} mm"
                );
            }
            if rule != Rule::Closest {
                assert!(
                    largest_turn(&touches) <= RATIO.atan() + ROUNDING,
                    "{faces} faces"
                );
            }
        }
    }
}

#[test]
fn proxy_case_7_degenerate_and_duplicate_faces_change_no_bit() {
    let planes = pyramid(5);
    let nothing = Plane {
        normal: Direction([Default::default(); 3]),
        height: mm(-3.0),
    };
    let mut spoilt = vec![nothing];
    for face in &planes {
        spoilt.extend([*face, nothing, *face]);
    }
    let path = [
        [0.2, 0.1, 1.0],
        [0.2, 0.1, -1.0],
        [-0.4, 0.3, -1.0],
        [0.0, 0.0, -2.0],
    ];
    for rule in [Rule::Closest, Rule::Penetration, restricted()] {
        let clean = along(rule, &Facets { planes: &planes }, &path, 200);
        let with = along(rule, &Facets { planes: &spoilt }, &path, 200);
        assert_eq!(clean, with);
    }
    // An object of degenerate faces only is no object.
    let none = Facets { planes: &[nothing] };
    assert!(!inside(
        &SurfacePoint::new(restricted()).tick(&none, at(0.0, 0.0, -5.0))
    ));
}

/// Case 8: checks motions that pass a plate of 0.2 mm within one control period: the hand or the plate moves by 5 mm. The force
/// stays on the side of the plate on which the hand was.
#[test]
fn proxy_case_8_faster_than_it_is_thick() {
    for rule in [Rule::Closest, restricted()] {
        let mut point = SurfacePoint::new(rule);
        assert!(!inside(&point.tick(&thin(), at(0.0, 0.0, 2.5))));
        let touch = point.tick(&thin(), at(0.0, 0.0, -2.5));
        assert!(
            inside(&touch) && touch.normal == Direction::along(2, false),
            "the HIP jumps"
        );

        let mut point = SurfacePoint::new(rule);
        let mut moving = thin();
        assert!(!inside(&point.tick(&moving, at(0.0, 0.0, 0.5))));
        moving.body.centre = at(0.0, 0.0, 5.5);
        let touch = point.tick(&moving, at(0.0, 0.0, 0.5));
        assert!(
            inside(&touch) && touch.normal == Direction::along(2, false),
            "the plate jumps"
        );
        assert!((in_mm(touch.depth) - 5.1).abs() < 1e-4);
    }
}
