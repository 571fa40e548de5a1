//! Properties at 8 bits of virtual objects made of planes: half-spaces, bodies of many planes, edges and concave corners.
//!
//! All inputs of each object are tried (`cargo xtask prove --every planes`).
//!
//! ```text
//! plane      depth = h - floor(n·x)                          p4_plane_nearest
//! facets     nearest plane; at a tie the last tick's         p4_facets_nearest
//! edge       below both: the higher; else the distance       p4_edge_nearest
//! corner     its free space is an edge                       p4_corner_nearest
//! ```

use crate::objects::{N, ONE, axis, bits, direction, parts, place, position, signed, vector, ways};
use crate::source::Source;
use crate::{assume, cover, property};
use touchstone_control::space::environment::{
    Corner, Cuboid, Cylinder, Edge, Facets, Plane, Plate, Sphere,
};
use touchstone_control::space::{Direction, Nearest, Shape, Surface};

/// The scalar product of a direction and a vector, rounded down.
fn along(u: &Direction<N>, v: [i64; 3]) -> i64 {
    let ([a, b, c], [x, y, z]) = (parts(u), v);
    (a * x + b * y + c * z).div_euclid(ONE)
}
/// Way along a slanted direction, `depth / cosine`, rounded towards zero and limited to the format; `None` if the direction does
/// not lead out.
fn slanted(depth: i64, cosine: i64) -> Option<i64> {
    (cosine > 0).then(|| depth.signum() * (depth.abs() * (ONE - 1) / cosine).min(ONE - 1))
}
fn plane(normal: Direction<N>, height: i64) -> Plane<N> {
    Plane {
        normal,
        height: position(height),
    }
}

property! {
    /// P4 (geometry): the depth of a place below a plane is the plane's height minus the place's component along the normal,
    /// rounded down. A plane seen from below has the opposite normal and height.
    equation "depth = h - floor(n·x)"
    over "normals and places of 3 bits an axis, heights of 6 bits"
    by sampled fn p4_plane_nearest(s) {
        let Some(normal) = direction(s, 3) else {
            return;
        };
        let (at, height) = (place(s, 3), signed(s, 6));
        let (plane, side) = (plane(normal, height), Direction::default());
        let above = along(&normal, at) - height;
        assert!(bits(plane.above(vector(at))) == above);
        assert!(plane.nearest(vector(at), &side) == Nearest { normal, depth: position(-above) });
        let flipped = plane.flipped();
        assert!(parts(&flipped.normal) == parts(&normal).map(|x| -x) && bits(flipped.height) == -height);
        assert!(ways(&plane) == [normal] && !Surface::<N>::is_round(&plane));
        cover!(s, above < 0, "below");
    }
}
property! {
    /// P4 (geometry): the way out through a plane along a direction is the depth divided by the cosine of the angle between
    /// direction and normal. For a direction along the plane or inwards there is no way out.
    equation "t = depth / floor(n·u) towards zero, of a 1 of 127/128"
    over "normals and directions of 3 bits an axis, depths of 7 bits"
    by sampled fn p4_plane_exit(s) {
        let (Some(normal), Some(u)) = (direction(s, 3), direction(s, 3)) else {
            return;
        };
        let depth = signed(s, 7);
        let way = plane(normal, depth).exit(vector([0; 3]), &u, &u);
        assert!(way.map(bits) == slanted(depth, along(&normal, parts(&u))));
        cover!(s, way.is_some_and(|way| bits(way) > depth && depth > 0), "aslant");
        cover!(s, way.is_none(), "inwards");
    }
}

/// Three planes perpendicular to coordinate axes, from the source of inputs; some have no direction.
fn facets<S: Source>(s: &mut S) -> [Plane<N>; 3] {
    [(); 3].map(|()| {
        let normal = match s.bits(2) {
            0 => Direction([position(0).0; 3]),
            1 => Direction::along(0, false),
            2 => Direction::along(1, false),
            _ => Direction::along(0, true),
        };
        plane(normal, signed(s, 3))
    })
}

property! {
    /// P4 (geometry): in a body of many planes the plane nearest to the surface counts. At a tie it is the plane of the last tick,
    /// otherwise the first one. A plane without a direction does not count.
    equation "depth = min depth_i"
    over "three planes along x, y, against x or none, heights and places of 3 bits along two axes, side"
    by sampled fn p4_facets_nearest(s) {
        let planes = facets(s);
        let at = [signed(s, 3), signed(s, 3), 0];
        let side = axis(s);
        let body = Facets { planes: &planes };
        let seen = body.nearest(vector(at), &side);
        let real = || planes.iter().filter(|plane| parts(&plane.normal) != [0; 3]);
        let depths = || real().map(|plane| (bits(plane.height) - along(&plane.normal, at), plane.normal));
        let Some(least) = depths().map(|(depth, _)| depth).min() else {
            assert_reached!(seen == Nearest { normal: side, depth: position(-1) } && ways(&body).is_empty());
            return;
        };
        let mut nearest = depths().filter(|(depth, _)| *depth == least).map(|(_, normal)| normal);
        let was = nearest.clone().any(|normal| normal == side);
        assert!(bits(seen.depth) == least);
        assert!(Some(seen.normal) == if was { Some(side) } else { nearest.next() });
        assert!(ways(&body) == real().map(|plane| plane.normal).collect::<Vec<_>>());
        cover!(s, real().count() == 2, "one that is none");
        cover!(s, was && depths().next() != Some((least, side)), "not the first");
    }
}
property! {
    /// P4 (geometry): the way out of a body of planes along a direction is the shortest of the ways through its planes.
    equation "t = min t_i"
    over "three planes along x, y, against x or none, heights and places of 3 bits along two axes, directions of 2 bits along them"
    by sampled fn p4_facets_exit(s) {
        let planes = facets(s);
        let at = [signed(s, 3), signed(s, 3), 0];
        let Some(u) = Direction::of(vector([signed(s, 2), signed(s, 2), 0])) else {
            return;
        };
        let body = Facets { planes: &planes };
        let out = |plane: &Plane<N>| {
            slanted(bits(plane.height) - along(&plane.normal, at), along(&plane.normal, parts(&u)))
        };
        let least = planes.iter().filter_map(out).min();
        assert!(body.exit(vector(at), &u, &u).map(bits) == least);
        cover!(s, planes.iter().filter_map(out).count() > 1, "several");
        cover!(s, least.is_none(), "no way out");
    }
}

/// Two planes, and a place in the plane of their normals, from the source of inputs.
fn two<S: Source>(s: &mut S, width: u32) -> Option<([Plane<N>; 2], [i64; 3])> {
    let mut one = || {
        let normal = Direction::of(vector([signed(s, 3), 0, signed(s, 3)]))?;
        Some(plane(normal, 4 * signed(s, 2)))
    };
    let planes = [one()?, one()?];
    Some((planes, [3 * signed(s, width), 0, 3 * signed(s, width)]))
}
/// Heights of a place above two planes, the cosine of the angle between the normals, and the square of its sine.
fn seen_from(planes: &[Plane<N>; 2], at: [i64; 3]) -> ([i64; 2], i64, i64) {
    let above = planes
        .each_ref()
        .map(|plane| along(&plane.normal, at) - bits(plane.height));
    let [one, other] = planes;
    let cosine = along(&one.normal, parts(&other.normal));
    (above, cosine, ONE * ONE - cosine * cosine)
}
/// The product `a b` of two signals (positions and forces), rounded towards zero.
fn times(a: i64, b: i64) -> i64 {
    a * b / ONE
}

/// Bound, in steps of the number format, of two errors near an edge: of the distance to the edge, and of the normal sideways, times
/// that distance.
const EDGE: i64 = 7;

property! {
    /// P4 (geometry): at a place below both planes of an edge, the nearer plane counts. At a place above one plane, that plane
    /// counts if the foot of the perpendicular on it is below the other plane. Otherwise the edge counts, with a normal between
    /// those of the planes. The depth is then right to seven steps of the number format if the planes meet at more than 30 degrees.
    equation "depth = -max(a, b);  a > 0 and b - (n·m) a <= 0: -a;  else depth² = (a² + b² - 2 (n·m) a b)/(1 - (n·m)²), to 7 quanta"
    over "normals of 3 bits along two axes, heights of 2 bits, four times as large, places of 4 bits along two axes, three times as large"
    by sampled fn p4_edge_nearest(s) {
        let Some((planes, at)) = two(s, 4) else {
            return;
        };
        let edge = Edge::new(planes);
        let seen = edge.nearest(vector(at), &Direction::default());
        let ([a, b], cosine, sine2) = seen_from(&planes, at);
        let [one, other] = planes.map(|plane| plane.normal);
        let depth = bits(seen.depth);
        assert!(ways(&edge) == [one, other] && !Surface::<N>::is_round(&edge));
        let normal = if a <= 0 && b <= 0 {
            assert_reached!(depth == -a.max(b));
            if b > a { other } else { one }
        } else if a > 0 && b - times(cosine, a) <= 0 {
            assert_reached!(depth == -a);
            one
        } else if b > 0 && a - times(cosine, b) <= 0 {
            assert_reached!(depth == -b);
            other
        } else {
            assume!(s, sine2 > ONE * ONE / 4, "Edge::new: flatter edges are less exact, as it says");
            // Square of the distance to the edge from both heights, by the law of cosines.
            let (square, far) = (ONE * ONE * (a * a + b * b) - 2 * cosine * ONE * a * b, -depth);
            assert!(far >= 0 && (far + EDGE) * (far + EDGE) * sine2 >= square);
            assert!((far - EDGE).max(0) * (far - EDGE).max(0) * sine2 <= square);
            // The normal lies between those of both planes.
            let turn = |u: &Direction<N>, v: &Direction<N>| parts(u)[0] * parts(v)[2] - parts(u)[2] * parts(v)[0];
            let sign = turn(&one, &other).signum();
            let aside = EDGE * ONE * ONE;
            assert!(far * sign * turn(&one, &seen.normal) >= -aside && far * sign * turn(&seen.normal, &other) >= -aside);
            cover!(s, far > 2 * EDGE, "the edge itself");
            return;
        };
        assert_reached!(seen.normal == normal);
    }
}
property! {
    /// P4 (geometry): the way out of a convex edge along a direction is the shorter of the ways through its two planes.
    equation "t = min(t_1, t_2)"
    over "normals of 3 bits along two axes, heights of 2 bits, four times as large, places of 3 bits along two axes, three times as large, an axis"
    by sampled fn p4_edge_exit(s) {
        let Some((planes, at)) = two(s, 3) else {
            return;
        };
        let u = axis(s);
        let out = |plane: &Plane<N>| {
            slanted(bits(plane.height) - along(&plane.normal, at), along(&plane.normal, parts(&u)))
        };
        let least = planes.iter().filter_map(out).min();
        assert!(Edge::new(planes).exit(vector(at), &u, &u).map(bits) == least);
        cover!(s, planes.iter().filter_map(out).count() > 1, "two ways");
    }
}
property! {
    /// P4 (geometry): the free space of a concave corner is the edge of both planes seen from below. A place is inside the corner
    /// if it is below one of the planes. The corner's normal is the opposite of that edge's.
    equation "nearest = -(nearest of the free space)"
    over "normals of 3 bits along two axes, heights of 2 bits, four times as large, places of 4 bits along two axes, three times as large"
    by sampled fn p4_corner_nearest(s) {
        let Some((planes, at)) = two(s, 4) else {
            return;
        };
        let corner = Corner::new(planes);
        let seen = corner.nearest(vector(at), &Direction::default());
        let free = Edge::new(planes.map(|plane| plane.flipped())).nearest(vector(at), &Direction::default());
        assert!(bits(seen.depth) == -bits(free.depth));
        assert!(parts(&seen.normal) == parts(&free.normal).map(|x| -x));
        // With the opposite normal the part along it is rounded the other way.
        let below = |plane: &Plane<N>| -along(&plane.normal.opposite(), at) - bits(plane.height);
        let inside = planes.iter().any(|plane| below(plane) < 0);
        assert!(inside == (bits(seen.depth) > 0) || inside && bits(seen.depth) == 0);
        let normals: Vec<_> = planes.iter().map(|plane| plane.normal).collect();
        assert!(ways(&corner) == normals);
        cover!(s, inside, "inside");
    }
}
property! {
    /// P4 (geometry): the way out of a concave corner is the longer of the ways through the planes that the place is below. It
    /// exists only if it ends above both planes, to four steps of the number format.
    equation "t = max over planes below of depth / (n·u)"
    over "normals of 3 bits along two axes, heights of 2 bits, four times as large, places of 3 bits along two axes, three times as large, an axis"
    by sampled fn p4_corner_exit(s) {
        let Some((planes, at)) = two(s, 3) else {
            return;
        };
        let u = axis(s);
        let mut longest = Some(0);
        for plane in &planes {
            let free = plane.normal.opposite();
            let below = along(&free, at) + bits(plane.height);
            if below > 0 {
                // The cosine with the normal, which the code has reversed twice.
                let out = slanted(below, along(&plane.normal, parts(&u)));
                longest = longest.and_then(|longest| Some(out?.max(longest)));
            }
        }
        let ends_free = |way: i64| {
            let ([x, y, z], [a, b, c]) = (at, parts(&u));
            let there = [x + times(way, a), y + times(way, b), z + times(way, c)];
            planes.iter().all(|plane| along(&plane.normal.opposite(), there) + bits(plane.height) <= 4)
        };
        let expected = longest.filter(|way| ends_free(*way));
        assert!(Corner::new(planes).exit(vector(at), &u, &u).map(bits) == expected);
        cover!(s, expected.is_some_and(|way| way > 0), "a way out");
        cover!(s, longest.is_some() && expected.is_none(), "one plane is above already, and would not stay so");
    }
}
property! {
    /// P4 (geometry): an object whose shape is chosen at run time acts as the object of that shape.
    equation "shape(object) = object"
    over "each of the seven, places of 4 bits an axis, an axis, a side"
    by sampled fn p4_shape_is_its_object(s) {
        let (at, u, side) = (vector(place(s, 4)), axis(s), axis(s));
        let (centre, three) = (vector([1, -2, 3]), position(3));
        let planes = [plane(Direction::along(0, false), 2), plane(Direction::along(2, true), -3)];
        let body = Cuboid { centre, half: vector([2, 3, 4]) };
        fn is<O: Surface<N>>(shape: &Shape<N>, object: &O, at: touchstone_control::space::Vector<touchstone_control::Position<N>>, u: &Direction<N>, side: &Direction<N>) -> bool {
            shape.nearest(at, side) == object.nearest(at, side)
                && shape.exit(at, u, side) == object.exit(at, u, side)
                && ways(shape) == ways(object)
                && Surface::<N>::is_round(shape) == Surface::<N>::is_round(object)
        }
        let (ball, one) = (Sphere { centre, radius: three }, planes[0]);
        let cylinder = Cylinder { centre, radius: three, half: three, axis: 1 };
        let plate = Plate { body, axis: 1 };
        let (edge, corner) = (Edge::new(planes), Corner::new(planes));
        assert!(is(&Shape::Plane(one), &one, at, &u, &side));
        assert!(is(&Shape::Sphere(ball), &ball, at, &u, &side));
        assert!(is(&Shape::Cuboid(body), &body, at, &u, &side));
        assert!(is(&Shape::Cylinder(cylinder), &cylinder, at, &u, &side));
        assert!(is(&Shape::Plate(plate), &plate, at, &u, &side));
        assert!(is(&Shape::Edge(edge), &edge, at, &u, &side));
        assert!(is(&Shape::Corner(corner), &corner, at, &u, &side));
        cover!(s, bits(ball.nearest(at, &side).depth) > 0, "in the ball");
    }
}
