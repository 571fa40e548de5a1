//! Tests of the proxy (the point that follows the hand on a surface) in eight standard cases on meshes.

mod shapes;

use shapes::{Soup, ball, block, mm, prism, pyramid, valley};
use touchstone_control::space::{LengthUnit, Rule, SurfacePoint, Touch, Turn};
use touchstone_control::{Fixed32, Position, Reported};
use touchstone_mesh::{Mesh, MeshSurface, Proxy, Vector};

/// Moves the hand along straight lines from corner to corner, each in `ticks` ticks. Returns the positions of hand and proxy in
/// every tick.
fn along(mesh: &Mesh, corners: &[Vector], ticks: u32) -> Vec<(Vector, Vector)> {
    let mut proxy = Proxy::new(mesh, corners[0]);
    let mut course = Vec::new();
    for leg in corners.windows(2) {
        for tick in 0..=ticks {
            let hand = leg[0] + f64::from(tick) / f64::from(ticks) * (leg[1] - leg[0]);
            course.push((hand, proxy.follow(mesh, hand)));
        }
    }
    course
}

fn last(course: &[(Vector, Vector)]) -> (Vector, Vector) {
    *course.last().expect("a tick")
}

/// Distance of two points, mm.
fn apart(a: Vector, b: Vector) -> f64 {
    1e3 * (a - b).length()
}

/// Tangent of half the cone's angle in the control crate's restricted rule, which limits how fast the force direction turns.
const CONE: f64 = 0.02;

/// Moves the hand along a path and computes the contact by the control crate's restricted rule, which limits how fast the force
/// direction turns. Lengths are in centimetres.
fn touched(mesh: &Mesh, corners: &[Vector], ticks: u32) -> Vec<Touch<Fixed32>> {
    let surface = MeshSurface::new(mesh, LengthUnit::Centimetre);
    let turn = Turn::of_ratio(<Fixed32 as Reported>::signal_from_f64(CONE));
    let mut point = SurfacePoint::new(Rule::Restricted(turn));
    along(mesh, corners, ticks)
        .into_iter()
        .map(|(hand, _)| {
            let at = hand
                .to_array()
                .map(|x| Position(<Fixed32 as Reported>::signal_from_f64(100.0 * x)));
            point.tick(&surface, touchstone_control::space::Vector(at))
        })
        .collect()
}

fn numbers(touch: &Touch<Fixed32>) -> [f64; 3] {
    touch.normal.0.map(<Fixed32 as Reported>::signal_to_f64)
}

/// Largest turn of the force direction per tick while the hand is inside.
fn largest_turn(touches: &[Touch<Fixed32>]) -> f64 {
    let inside = |touch: &Touch<Fixed32>| touch.depth > Position::zero();
    touches
        .windows(2)
        .filter(|pair| pair.iter().all(inside))
        .map(|pair| {
            let [a, b] = [&pair[0], &pair[1]].map(|touch| Vector::from_array(numbers(touch)));
            a.cross(b).length().atan2(a.dot(b))
        })
        .fold(0.0, f64::max)
}

/// Tolerance for the proxy's gap and rounding, mm.
const NEAR: f64 = 1e-4;

#[test]
fn case_1_no_pop_through_a_thin_plate() {
    let plate = block(30.0, 30.0, 0.1).mesh();
    let (hand, proxy) = last(&along(
        &plate,
        &[mm(3., 2., 1.), mm(3., 2., -0.6), mm(4., -2., -5.0)],
        100,
    ));
    assert!(apart(proxy, mm(4., -2., 0.1)) < NEAR, "{proxy}");
    assert!((apart(hand, proxy) - 5.1).abs() < NEAR);
    // Around the rim the proxy reaches the other side.
    let around = [
        mm(0., 0., 1.),
        mm(31., 0., 1.),
        mm(31., 0., -1.),
        mm(0., 0., -1.),
        mm(0., 0., 0.05),
    ];
    assert!(apart(last(&along(&plate, &around, 100)).1, mm(0., 0., -0.1)) < NEAR);
    // Without the earlier positions the hand counts as outside here, on the plate's other side. So the case is a real test.
    let hand = mm(4., -2., -0.6);
    assert!(apart(Proxy::new(&plate, hand).follow(&plate, hand), hand) < NEAR);
}

#[test]
fn case_2_pressed_towards_an_edge_it_stays_on_its_face() {
    let cube = block(20.0, 20.0, 20.0).mesh();
    let course = along(
        &cube,
        &[mm(17., 0., 21.), mm(17., 0., 18.), mm(19.5, 0., 15.)],
        300,
    );
    for (hand, proxy) in &course {
        if hand.z < 20e-3 {
            assert!(
                (1e3 * proxy.z - 20.0).abs() < NEAR
                    && apart(*proxy, Vector::new(hand.x, hand.y, proxy.z)) < NEAR
            );
        }
    }
}

#[test]
fn case_3_in_a_concave_corner_it_lies_on_the_crease() {
    for slope in [0.1_f64, 0.6, 1.2] {
        let mesh = valley(slope).mesh();
        let (hand, proxy) = last(&along(&mesh, &[mm(0.2, 3., 10.), mm(0.2, 3., -4.)], 50));
        // The crease is at the origin; both planes are lifted by the gap.
        assert!(
            proxy.x.abs() < 1e-6 && proxy.z.abs() < 1e-6,
            "{slope}: {proxy}"
        );
        assert!(
            (proxy.y - hand.y).abs() < 1e-12,
            "the force lies in the plane of both normals"
        );
    }
    // Far to one side, only the plane of that side stops the proxy.
    let mesh = valley(0.6).mesh();
    let (hand, proxy) = last(&along(&mesh, &[mm(10., 0., 10.), mm(10., 0., 5.)], 50));
    let normal = Vector::new(-0.6_f64.sin(), 0.0, 0.6_f64.cos());
    assert!(((proxy - hand).normalize() - normal).length() < 1e-6);
}

/// Tests a convex edge, over which the proxy alone jumps by the depth times the sine of the edge's angle. With the restricted rule
/// the force direction turns by at most the cone's angle per tick.
#[test]
fn case_4_over_a_convex_edge_the_force_turns_continuously() {
    let roof = prism(&[[-30., -20.], [30., -20.], [30., 0.], [0., 12.], [-30., 0.]]).mesh();
    let path = [mm(-10., 0., 12.), mm(-10., 0., 6.), mm(10., 0., 6.)];
    let jump = |course: &[(Vector, Vector)]| {
        let jumps = course.windows(2).map(|pair| apart(pair[0].1, pair[1].1));
        jumps.fold(0.0, f64::max)
    };
    assert!(jump(&along(&roof, &path, 400)) > 1.0, "the case is a case");
    let touches = touched(&roof, &path, 400);
    assert!(largest_turn(&touches) <= CONE.atan() + 1e-6);
    // The direction turns from one face's normal to the other's, and in between it equals neither.
    let normals: Vec<f64> = touches.iter().map(|touch| numbers(touch)[0]).collect();
    let [least, most] = [f64::min, f64::max].map(|of| normals.iter().copied().fold(0.0, of));
    assert!(least < -0.37 && most > 0.37, "{least} {most}");
}

#[test]
fn case_5_a_seam_between_coplanar_faces_is_not_felt() {
    let cube = block(20.0, 20.0, 20.0).mesh();
    // Across the diagonal of the upper face.
    for (hand, proxy) in along(
        &cube,
        &[mm(-9., 8., 21.), mm(-9., 8., 19.), mm(8., -9., 19.)],
        500,
    ) {
        if hand.z < 20e-3 {
            let depth = apart(hand, proxy);
            assert!((depth - 1e3 * (20e-3 - hand.z)).abs() < NEAR, "{depth}");
            assert!((proxy.x - hand.x).abs() < 1e-12 && (proxy.y - hand.y).abs() < 1e-12);
        }
    }
}

#[test]
fn case_6_vertices_of_three_to_twelve_faces() {
    for faces in 3..=12 {
        let mesh = pyramid(faces).mesh();
        // The hand goes around below the apex, through all faces, then up the middle and out.
        let mut path: Vec<Vector> = (0..=24)
            .map(|i| 0.53 * f64::from(i))
            .map(|phi: f64| mm(0.5 * phi.cos(), 0.5 * phi.sin(), -1.5))
            .collect();
        path.insert(0, mm(0.0, 0.0, 1.0));
        path.extend([mm(0., 0., -1.5), mm(0., 0., 1.0)]);
        let course = along(&mesh, &path, 100);
        // While the hand is inside, the proxy is not above the apex, which is the highest point of the surface.
        for (hand, proxy) in &course {
            let inside = apart(*hand, *proxy) > 0.0;
            assert!(!inside || 1e3 * proxy.z <= NEAR, "{faces} faces: {proxy}");
        }
        assert!(
            course
                .iter()
                .filter(|(hand, proxy)| apart(*hand, *proxy) > 0.1)
                .count()
                > 2000
        );
        assert_eq!(last(&course).0, last(&course).1, "{faces} faces: out again");
        let touches = touched(&mesh, &path, 100);
        assert!(
            largest_turn(&touches) <= CONE.atan() + 1e-6,
            "{faces} faces"
        );
    }
}

#[test]
fn case_7_degenerate_and_duplicate_triangles_change_next_to_nothing() {
    let clean = pyramid(5);
    let mut spoilt = clean.clone();
    let corner = clean.vertices[0];
    for triangle in &clean.triangles {
        spoilt.triangles.push(*triangle);
        spoilt
            .triangles
            .push([triangle[0], triangle[0], triangle[1]]);
    }
    spoilt.triangle([corner, corner, corner]);
    spoilt.triangle([mm(0., 0., 0.), mm(1., 0., -1.), mm(2., 0., -2.)]);
    let (clean, spoilt) = (clean.mesh(), spoilt.mesh());
    assert_eq!(spoilt.left_out(), 12);
    let path = [
        mm(0.2, 0.1, 1.),
        mm(0.2, 0.1, -1.),
        mm(-0.4, 0.3, -1.),
        mm(0., 0., -2.),
    ];
    for (a, b) in along(&clean, &path, 200)
        .iter()
        .zip(along(&spoilt, &path, 200))
    {
        assert!(apart(a.1, b.1) < NEAR, "{} and {}", a.1, b.1);
    }
    let nothing = Soup {
        vertices: vec![corner],
        triangles: vec![[0, 0, 0]],
    };
    assert!(Mesh::new(&nothing.vertices, &nothing.triangles).is_err());
    assert!(Mesh::new(&nothing.vertices, &[[0, 0, 7]]).is_err());
}

#[test]
fn case_8_faster_than_it_is_thick() {
    let plate = block(30.0, 30.0, 0.1).mesh();
    let (_, proxy) = last(&along(&plate, &[mm(0., 0., 2.5), mm(1., 1., -2.5)], 1));
    assert!((1e3 * proxy.z - 0.1).abs() < NEAR, "{proxy}");
    // The hand moves 100 mm in one tick, obliquely through a ball.
    let (_, proxy) = last(&along(
        &ball(20.0, 32).mesh(),
        &[mm(50., 3., 40.), mm(-5., -1., -4.)],
        1,
    ));
    assert!(
        proxy.x > 0.0 && (1e3 * proxy.length() - 20.0).abs() < 0.2,
        "{proxy}"
    );
}

/// Tests ten thousand random positions with jumps of up to 30 mm around a ball. The proxy is never inside, and it is at the hand
/// when the hand is outside.
#[test]
fn it_never_gets_inside() {
    let mesh = ball(20.0, 32).mesh();
    // Inner radius of the facets, from the angles of sector and ring.
    let inner = 20.0 * (std::f64::consts::PI / 64.0).cos().powi(2);
    let mut state = 1_u64;
    let mut real = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    };
    let mut proxy = Proxy::new(&mesh, mm(0., 0., 30.));
    let (mut hand, mut held) = (mm(0., 0., 30.), 0);
    for _ in 0..10_000 {
        let wild = if real() > 0.9 { 30.0 } else { 1.0 };
        hand = 0.98 * hand + wild * mm(real(), real(), real());
        let at = proxy.follow(&mesh, hand);
        assert!(1e3 * at.length() > inner - NEAR, "{at} is inside");
        held += u32::from(at != hand);
    }
    assert!(held > 3000, "{held} ticks in contact only");
}
