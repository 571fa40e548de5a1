//! Tests the direction of the force on three axes: Figs. 4.3 to 4.5 of the DLR thesis, and the bound on how fast the direction
//! turns if it may turn only within a cone (the "restricted" rule).

use touchstone_control::space::environment::{Corner, Cuboid, Cylinder, Edge, Shape, Sphere};
use touchstone_control::space::{Direction, Rule, Surface, SurfacePoint, Turn};
use touchstone_tests::random::Random;
use touchstone_tests::space::{F, Place, at, direction, in_mm, mm, numbers};
use touchstone_tests::surface_path::{
    RATIO, ROUNDING, along, inside, largest_turn, plane, restricted, thin,
};

fn block() -> Cuboid<F> {
    Cuboid {
        centre: at(0.0, 0.0, 0.0),
        half: at(20.0, 20.0, 20.0),
    }
}

/// Path of the hand in mm: into the box from above, 3 mm from the box's right face, and on until that face is the closest one.
const TOWARDS_AN_EDGE: [[f64; 3]; 3] = [[17.0, 0.0, 21.0], [17.0, 0.0, 18.0], [19.5, 0.0, 15.0]];

#[test]
fn figure_4_3_the_closest_point_jumps_to_the_other_face() {
    let touches = along(Rule::Closest, &block(), &TOWARDS_AN_EDGE, 300);
    assert!((largest_turn(&touches) - std::f64::consts::FRAC_PI_2).abs() < ROUNDING);
    assert_eq!(
        touches.last().expect("one").normal,
        Direction::along(0, false)
    );
}

#[test]
fn figure_4_4_the_point_of_penetration_pulls_back() {
    let flat = plane(Direction::along(2, false), 0.0);
    let touches = along(
        Rule::Penetration,
        &flat,
        &[[0.0, 0.0, 0.1], [0.0, 0.0, -1.0], [5.0, 0.0, -1.0]],
        300,
    );
    let last = touches.last().expect("one");
    // The direction points 5 mm back and 1 mm up, though the surface is flat.
    let [x, _, z] = numbers(&last.normal);
    assert!((x / z + 5.0).abs() < 0.01, "{x} {z}");
    assert!((in_mm(last.depth) - 26.0_f64.sqrt()).abs() < 0.01);
    // The HIP leaves at another place than where it came in: the force ends in a step.
    let out = along(
        Rule::Penetration,
        &flat,
        &[[0.0, 0.0, -0.01], [5.0, 0.0, -0.01], [5.0, 0.0, 0.01]],
        2,
    );
    let depths: Vec<f64> = out.iter().map(|touch| in_mm(touch.depth)).collect();
    assert!(
        depths
            .windows(2)
            .any(|pair| pair[0] > 4.9 && pair[1] <= 0.0),
        "{depths:?}"
    );
}

/// Checks Fig. 4.5 of the DLR thesis (case 2 of `space_proxy_cases`): while the hand is pressed towards an edge, the force keeps
/// the direction of the face through which the hand came in.
#[test]
fn figure_4_5_and_proxy_case_2_a_restricted_point_does_not_jump() {
    let touches = along(restricted(), &block(), &TOWARDS_AN_EDGE, 300);
    assert!(largest_turn(&touches) <= RATIO.atan() + ROUNDING);
    let last = touches.last().expect("one");
    assert!(
        numbers(&last.normal)[2] > 0.99,
        "still out of the top: {:?}",
        numbers(&last.normal)
    );
    assert!((in_mm(last.depth) - 5.0).abs() < 0.1, "5 mm below it");
    // Unlike the point of penetration, the restricted point allows sideways motion: along the top the force stays upright.
    let slide = along(
        restricted(),
        &block(),
        &[[0.0, 0.0, 21.0], [0.0, 0.0, 19.0], [15.0, 0.0, 19.0]],
        300,
    );
    assert_eq!(
        slide.last().expect("one").normal,
        Direction::along(2, false)
    );
}

fn shapes() -> Vec<(&'static str, Shape<F>)> {
    let tilted = [
        plane(direction(0.3, 0.1, 1.0), 4.0),
        plane(direction(1.0, -0.2, 0.3), 4.0),
    ];
    vec![
        ("plane", Shape::Plane(plane(direction(0.4, -0.3, 0.8), 5.0))),
        (
            "sphere",
            Shape::Sphere(Sphere {
                centre: at(1.0, 0.0, -1.0),
                radius: mm(9.0),
            }),
        ),
        (
            "box",
            Shape::Cuboid(Cuboid {
                centre: at(0.0, 1.0, 0.0),
                half: at(8.0, 6.0, 7.0),
            }),
        ),
        (
            "cylinder",
            Shape::Cylinder(Cylinder {
                centre: at(0.0, 1.0, 0.0),
                radius: mm(7.0),
                half: mm(9.0),
                axis: 1,
            }),
        ),
        ("plate", Shape::Plate(thin())),
        ("edge", Shape::Edge(Edge::new(tilted))),
        ("corner", Shape::Corner(Corner::new(tilted))),
    ]
}

/// A random motion of the hand in space, in sections with small steps and sections with steps of a few mm.
fn wander(seed: u64, ticks: usize) -> Vec<Place> {
    let mut random = Random::new(seed);
    let (mut here, mut speed) = ([0.0; 3], [0.0; 3]);
    (0..ticks)
        .map(|tick| {
            let wild = if tick % 1000 < 700 { 0.02 } else { 1.0 };
            for i in 0..3 {
                speed[i] = 0.9 * speed[i] + wild * random.real();
                here[i] = (here[i] + speed[i]) * 0.995;
            }
            at(here[0], here[1], here[2])
        })
        .collect()
}

#[test]
fn a_restricted_point_turns_by_at_most_its_cone() {
    for (name, shape) in shapes() {
        for (ratio, seed) in [(0.001, 1), (0.02, 2), (0.3, 3)] {
            let turn = Turn::of_ratio(mm(10.0 * ratio).0);
            let mut point = SurfacePoint::new(Rule::Restricted(turn));
            let touches: Vec<_> = wander(seed, 30_000)
                .into_iter()
                .map(|here| point.tick(&shape, here))
                .collect();
            let within = touches.iter().filter(|touch| inside(touch)).count();
            let turned = largest_turn(&touches);
            println!(
                "{name}, ratio {ratio}: {within} ticks inside, turns by at most {turned:.6} of {:.6}",
                ratio.atan()
            );
            assert!(within > 1000, "{name}: {within} inside");
            // The cosine of a small angle is imprecise: one quantum of it changes the angle by a quantum over the sine.
            assert!(turned <= ratio.atan() + ROUNDING + 1e-7 / ratio, "{name}");
        }
    }
}

/// Compares, for each object, the closest surface point and the way out in a direction with an independent search in floating
/// point.
#[test]
fn depths_are_those_of_the_signed_distance() {
    let mut random = Random::new(77);
    for (name, shape) in shapes() {
        let mut worst = 0.0_f64;
        for here in wander(11, 20_000) {
            let nearest = shape.nearest(here, &Direction::along(2, false));
            let depth = in_mm(nearest.depth);
            // Above and below its area, a plate's surface point is on the side that the given normal names. Beside its rim the
            // plate acts as a box, and is not compared.
            if name == "plate" && nearest.normal != Direction::along(2, false) {
                continue;
            }
            // Walking out along the normal by the depth comes to the surface: there the depth is 0.
            let surface = here + nearest.normal.times(nearest.depth);
            let rest = in_mm(shape.nearest(surface, &nearest.normal).depth).abs();
            worst = worst.max(rest);
            // A direction is up to 1.8 quanta short (two directions around a rim), and each step rounds five times by at most a
            // quantum.
            let allowed = 2.0 * 1.8 * depth.abs() / 16_777_216.0 + 5.0 / 1_677_721.6;
            // Around an edge, divided by the square of the sine of the angle between its planes, 0.73 here.
            let two_planes = matches!(shape, Shape::Edge(_) | Shape::Corner(_));
            let allowed = allowed / if two_planes { 0.73 } else { 1.0 };
            assert!(
                rest <= allowed,
                "{name}: {rest:.1e} mm at {depth} mm, {allowed:.1e} allowed"
            );
            if depth > 0.01 && name != "plate" {
                // No surface point is closer: a ball of the depth lies inside.
                let out = direction(random.real(), random.real(), random.real());
                let probe = here + out.times(mm(0.999 * depth));
                assert!(
                    in_mm(shape.nearest(probe, &nearest.normal).depth) > -1e-4,
                    "{name}"
                );
                if let Some(far) = shape.exit(here, &out, &nearest.normal) {
                    assert!(
                        in_mm(far) > depth - 1e-4,
                        "{name}: out at {} mm, {depth} mm deep",
                        in_mm(far)
                    );
                    if in_mm(far) < 60.0 {
                        let end = shape.nearest(here + out.times(far), &nearest.normal);
                        assert!(
                            in_mm(end.depth) < 1e-4,
                            "{name}: still {} mm inside",
                            in_mm(end.depth)
                        );
                    }
                }
            }
        }
        println!("{name}: surface points are off the surface by at most {worst:.1e} mm");
    }
}
