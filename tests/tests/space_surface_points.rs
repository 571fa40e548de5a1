//! Where the force points: Figs. 4.3 to 4.5, the eight cases that a proxy has to pass, and the bound on how fast a restricted point turns.

use touchstone_control::space::Magnitude;
use touchstone_control::space::environment::{
    Corner, Cuboid, Cylinder, Edge, Facets, Plane, Plate, Shape, Sphere,
};
use touchstone_control::space::{Direction, Rule, Surface, SurfacePoint, Touch, Turn};
use touchstone_control::{LawKind, Position};
use touchstone_tests::random::Random;
use touchstone_tests::space::{
    F, Place, UNIT, angle, at, direction, dot, in_mm, length, mm, numbers, omega, place_in_mm,
    push_in_n,
};

/// The tangent of the cone's half angle, a degree or so.
const RATIO: f64 = 0.02;
/// Rounding of a direction and of the angle between two.
const ROUNDING: f64 = 1e-6;

fn restricted() -> Rule<F> {
    // 1 is 10 mm in centimetres.
    Rule::Restricted(Turn::of_ratio(mm(10.0 * RATIO).0))
}

fn block() -> Cuboid<F> {
    Cuboid {
        centre: at(0.0, 0.0, 0.0),
        half: at(20.0, 20.0, 20.0),
    }
}

fn plane(normal: Direction<F>, height: f64) -> Plane<F> {
    Plane {
        normal,
        height: mm(height),
    }
}

/// All touches along a path of straight lines, in mm, at so many ticks a leg.
fn along(
    rule: Rule<F>,
    surface: &impl Surface<F>,
    corners: &[[f64; 3]],
    ticks: u32,
) -> Vec<Touch<F>> {
    let mut point = SurfacePoint::new(rule);
    let mut touches = Vec::new();
    for leg in corners.windows(2) {
        for tick in 0..=ticks {
            let share = f64::from(tick) / f64::from(ticks);
            let here: [f64; 3] =
                std::array::from_fn(|i| leg[0][i] + share * (leg[1][i] - leg[0][i]));
            touches.push(point.tick(surface, at(here[0], here[1], here[2])));
        }
    }
    touches
}

fn inside(touch: &Touch<F>) -> bool {
    touch.depth > Position::zero()
}

/// The largest turn of the direction in a tick, while inside.
fn largest_turn(touches: &[Touch<F>]) -> f64 {
    touches
        .windows(2)
        .filter(|pair| pair.iter().all(inside))
        .map(|pair| angle(numbers(&pair[0].normal), numbers(&pair[1].normal)))
        .fold(0.0, f64::max)
}

/// Into the box from above 3 mm from its right face, and on until that face is closer.
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
    // 5 mm back and 1 mm up, though the surface is flat.
    let [x, _, z] = numbers(&last.normal);
    assert!((x / z + 5.0).abs() < 0.01, "{x} {z}");
    assert!((in_mm(last.depth) - 26.0_f64.sqrt()).abs() < 0.01);
    // Out at another place than in: the force ends in a step.
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

/// Fig. 4.5, and case 2 of the proxy: pressed towards an edge, the force stays on the face through which the HIP came in.
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
    // And unlike the point of penetration it lets go sideways: along the top the force stays upright.
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

fn thin() -> Plate<F> {
    Plate {
        body: Cuboid {
            centre: at(0.0, 0.0, 0.0),
            half: at(30.0, 30.0, 0.1),
        },
        axis: 2,
    }
}

/// Thinner than the 0.48 mm that 12 N press into 25 N/mm.
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
    // A box of the same size lets it through: the case is a case.
    let through = along(Rule::Closest, &thin().body, &press, 100);
    assert_eq!(
        through.last().expect("one").normal,
        Direction::along(2, true)
    );
    // Around the rim it comes to the other side.
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
            // The surface point is on the surface: above both planes or on them, and on one of them.
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

/// Around an edge at 0.3 mm below both faces. The cone keeps the first face until the way out of it is `1/sin` of its angle times that out of the other.
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
        // A newton has 24 binary digits; so a force of more than that is turned by no more than the direction.
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
    // The closest point turns the force at once.
    assert!(largest_turn(&along(Rule::Closest, &edge, &path, 470)) > 1.5);
}

/// Faces of a convex body; two of the top's halves are coplanar.
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

/// A pyramid of so many faces with its apex at the origin.
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
        // Around below the apex, through all faces, and up the middle.
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
                // The way out is longer by what the cone makes of it.
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
    // Nothing but degenerate faces is no object.
    let none = Facets { planes: &[nothing] };
    assert!(!inside(
        &SurfacePoint::new(restricted()).tick(&none, at(0.0, 0.0, -5.0))
    ));
}

/// 5 mm in a tick through a plate of 0.2 mm: by the HIP, or by the plate that moves or turns its face over.
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
        // Turned over in place: its two faces are the same, and the side stays.
        let centre = moving.body.centre;
        moving.body.centre = -centre;
        moving.body.centre = -moving.body.centre;
        assert_eq!(point.tick(&moving, at(0.0, 0.0, 0.5)).normal, touch.normal);
    }
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

/// Random motions, calm and wild, with steps of up to 3 mm.
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
            // The cosine of a small angle has few digits: a quantum of it is a quantum over the sine.
            assert!(turned <= ratio.atan() + ROUNDING + 1e-7 / ratio, "{name}");
        }
    }
}

/// Against an independent search: the closest surface point of each object, and the exit along a direction, in floats.
#[test]
fn depths_are_those_of_the_signed_distance() {
    let mut random = Random::new(77);
    for (name, shape) in shapes() {
        let mut worst = 0.0_f64;
        for here in wander(11, 20_000) {
            let nearest = shape.nearest(here, &Direction::along(2, false));
            let depth = in_mm(nearest.depth);
            // Beside its rim a plate is a box; over it, it has the side that it is told.
            if name == "plate" && nearest.normal != Direction::along(2, false) {
                continue;
            }
            // Walking out along the normal by the depth comes to the surface: there the depth is 0.
            let surface = here + nearest.normal.times(nearest.depth);
            let rest = in_mm(shape.nearest(surface, &nearest.normal).depth).abs();
            worst = worst.max(rest);
            // A direction is up to 1.8 quanta short, two of them around a rim; each step rounds five times by a quantum at most.
            let allowed = 2.0 * 1.8 * depth.abs() / 16_777_216.0 + 5.0 / 1_677_721.6;
            // Around an edge over the square of the sine of the angle between its planes, 0.73 here.
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
