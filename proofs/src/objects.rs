//! Properties of virtual objects at 8 bits: closest surface point, and way out in a direction. Each is compared with the exact
//! surface by Pythagoras.
//!
//! All inputs of each object are tried (`cargo xtask prove --every objects`), because solvers cannot follow products and roots on
//! three axes. `R` is a radius, `h` a half length, `v` and `x` are places relative to the centre, `z` the part along the axis.
//!
//! ```text
//! ball       R - depth = floor |v|, normal along v          p4_ball_nearest
//! box        depth = min (h_i - |x_i|), outside -floor |..| p4_box_nearest
//! cylinder   depth = min (R - |v|, h - |z|), less at a rim  p4_cylinder_nearest
//! plate      depth below the face on the side of entry      p4_plate_keeps_its_side
//! way out    the longest that stays inside                  p4_*_exit
//! ```

use crate::format::Format;
use crate::source::Source;
use crate::{assume, cover, property};
use touchstone_control::space::environment::{Cuboid, Cylinder, Plate, Sphere};
use touchstone_control::space::{Direction, Surface, Vector};
use touchstone_control::{Fixed8, Number, Position};

pub(crate) type N = Fixed8;

/// The length 1 as an integer, in steps of the position format. Components of directions are at most one step less.
pub(crate) const ONE: i64 = 1 << <N as Format>::SIGNAL_BITS;
/// The centre of every object in these properties, in steps of the number format.
const CENTRE: [i64; 3] = [3, -6, 3];

pub(crate) fn position(bits: i64) -> Position<N> {
    Position(<N as Number>::Signal::from_bits(bits as i8))
}
pub(crate) fn vector(bits: [i64; 3]) -> Vector<Position<N>> {
    Vector(bits.map(position))
}
pub(crate) fn bits(x: Position<N>) -> i64 {
    N::of_signal(x.0)
}
/// A signed integer of this many bits, from the source of inputs.
pub(crate) fn signed<S: Source>(s: &mut S, width: u32) -> i64 {
    s.bits(width).cast_signed() - (1 << (width - 1))
}
/// A place with three signed coordinates of this many bits, from the source of inputs.
pub(crate) fn place<S: Source>(s: &mut S, width: u32) -> [i64; 3] {
    [signed(s, width), signed(s, width), signed(s, width)]
}
/// The direction of an arbitrary vector, whose components of `width` bits the source of inputs gives; `None` for the zero vector.
pub(crate) fn direction<S: Source>(s: &mut S, width: u32) -> Option<Direction<N>> {
    Direction::of(vector(place(s, width)))
}
/// One of the six directions along the coordinate axes, from the source of inputs.
pub(crate) fn axis<S: Source>(s: &mut S) -> Direction<N> {
    Direction::along((s.bits(2) % 3) as usize, s.bool())
}
pub(crate) fn squares(v: [i64; 3]) -> i64 {
    v.iter().map(|x| x * x).sum()
}
/// The components of a direction, in steps of the number format.
pub(crate) fn parts(u: &Direction<N>) -> [i64; 3] {
    u.0.map(N::of_signal)
}
/// A place relative to [`CENTRE`], in steps of the number format.
fn from_centre(at: [i64; 3]) -> [i64; 3] {
    let ([x, y, z], [a, b, c]) = (at, CENTRE);
    [x - a, y - b, z - c]
}
/// Whether `length` is the square root of `square`, rounded down.
pub(crate) fn is_root(length: i64, square: i64) -> bool {
    length >= 0 && length * length <= square && (length + 1) * (length + 1) > square
}
/// End point of a way of this length along a direction, in steps of the position format divided by [`ONE`].
pub(crate) fn end(from: [i64; 3], way: i64, u: &Direction<N>) -> [i64; 3] {
    let ([x, y, z], [a, b, c]) = (from, parts(u));
    [x * ONE + way * a, y * ONE + way * b, z * ONE + way * c]
}
/// Whether a point has this distance from the centre, to within the given number of steps of the position format.
fn is_at(end: [i64; 3], radius: i64, quanta: i64) -> bool {
    let (least, most) = ((radius - quanta).max(0) * ONE, (radius + quanta) * ONE);
    (least * least..=most * most).contains(&squares(end))
}
/// The directions that an object reports as possible ways out.
pub(crate) fn ways(object: &impl Surface<N>) -> Vec<Direction<N>> {
    let mut found = Vec::new();
    object.ways(&mut |way| found.push(way));
    found
}
/// The direction along a coordinate axis, and the opposite one.
fn both(axis: usize) -> [Direction<N>; 2] {
    [false, true].map(|against| Direction::along(axis, against))
}

property! {
    /// P4 (geometry): the depth in a ball is the radius minus the distance from the centre, and the normal points from the centre
    /// to the place. At the centre the normal is that of the last tick, or up if there was none.
    equation "depth = R - floor |v|, normal = v/|v|"
    over "places of 5 bits an axis from the centre, radius up to 31 quanta, side or none"
    by sampled fn p4_ball_nearest(s) {
        // The place is drawn relative to the centre; places relative to the origin would hardly ever hit the ball.
        let (radius, v, side) = (s.bits(5).cast_signed(), place(s, 5), axis(s));
        let none = Direction([position(0).0; 3]);
        let side = if s.bool() { none } else { side };
        let ball = Sphere { centre: vector(CENTRE), radius: position(radius) };
        let ([x, y, z], [a, b, c]) = (v, CENTRE);
        let seen = ball.nearest(vector([x + a, y + b, z + c]), &side);
        assert!(is_root(radius - bits(seen.depth), squares(v)));
        let at_centre = if side == none { Direction::along(2, false) } else { side };
        let along = Direction::of(vector(v)).unwrap_or(at_centre);
        assert!(seen.normal == along);
        assert!(Surface::<N>::is_round(&ball) && ways(&ball).is_empty());
        cover!(s, v == [0; 3], "the centre");
        cover!(s, bits(seen.depth) < 0, "outside");
    }
}
property! {
    /// P4 (geometry): from inside a ball the way out ends on its surface, to within three steps of the number format.
    equation "| |v + t u| - R | <= 3 quanta"
    over "inside; even places of 5 bits an axis, even radii up to 30 quanta, directions of 3 bits an axis"
    by sampled fn p4_ball_exit(s) {
        let (radius, at) = (2 * s.bits(4).cast_signed(), place(s, 4).map(|x| 2 * x));
        let v = from_centre(at);
        assume!(s, squares(v) <= radius * radius, "case: inside, as SurfacePoint::tick asks");
        let Some(u) = direction(s, 3) else {
            return;
        };
        let ball = Sphere { centre: vector(CENTRE), radius: position(radius) };
        let way = ball.exit(vector(at), &u, &u);
        let Some(way) = way else {
            panic!("no way out of a ball");
        };
        assert!(is_at(end(v, bits(way), &u), radius, 3));
        cover!(s, bits(way) > radius, "past the middle");
    }
}
property! {
    /// P4 (geometry): outside a box the depth is minus the distance, rounded down. Inside it is the distance to the nearest face,
    /// and the normal is along that face's axis.
    equation "inside: depth = min (h_i - |x_i|); outside: -floor sqrt Σ max(|x_i| - h_i, 0)²"
    over "places of 4 bits an axis, half lengths from 1 to 8 quanta, side"
    by sampled fn p4_box_nearest(s) {
        let half = [1 + s.bits(3).cast_signed(), 1 + s.bits(3).cast_signed(), 1 + s.bits(3).cast_signed()];
        let (at, side) = (place(s, 4), axis(s));
        let body = Cuboid { centre: vector(CENTRE), half: vector(half) };
        let x = from_centre(at);
        let seen = body.nearest(vector(at), &side);
        let mut beyond = [0; 3];
        let mut gap = i64::MAX;
        for i in 0..3 {
            beyond[i] = x[i].signum() * (x[i].abs() - half[i]).max(0);
            gap = gap.min(half[i] - x[i].abs());
        }
        if let Some(away) = Direction::of(vector(beyond)) {
            assert_reached!(is_root(-bits(seen.depth), squares(beyond)) && seen.normal == away);
        } else {
            assert!(bits(seen.depth) == gap);
            let faces = (0..3).filter(|i| half[*i] - x[*i].abs() == gap);
            let mut normals = faces.map(|i| {
                let middle = x[i] == 0 && parts(&side)[i] < 0;
                Direction::along(i, x[i] < 0 || middle)
            });
            assert_reached!(normals.any(|normal| seen.normal == normal));
        }
        for i in 0..3 {
            assert_reached!(both(i).iter().all(|way| ways(&body).contains(way)));
        }
        assert!(ways(&body).len() == 6 && !Surface::<N>::is_round(&body));
        cover!(s, x == [0; 3], "the middle");
        cover!(s, beyond.iter().all(|x| *x != 0), "off a vertex");
        cover!(s, bits(seen.depth) == 0, "on a face");
    }
}
property! {
    /// P4 (geometry): from inside a box the way out along a direction is the longest that passes no face, rounded towards zero.
    equation "t = min floor((h_i ∓ x_i) / |u_i|) over u_i ≠ 0"
    over "inside; places of 4 bits an axis, half lengths from 1 to 4 quanta, directions of 3 bits an axis"
    by sampled fn p4_box_exit(s) {
        let half = [1 + s.bits(2).cast_signed(), 1 + s.bits(2).cast_signed(), 1 + s.bits(2).cast_signed()];
        let at = place(s, 4);
        let x = from_centre(at);
        assume!(s, x.iter().zip(half).all(|(x, half)| x.abs() <= half), "case: inside, as SurfacePoint::tick asks");
        let Some(u) = direction(s, 3) else {
            return;
        };
        let body = Cuboid { centre: vector(CENTRE), half: vector(half) };
        let way = body.exit(vector(at), &u, &u);
        let Some(way) = way else {
            panic!("no way out of a box");
        };
        let way = bits(way);
        let room = |i: usize, way: i64| {
            let u = parts(&u)[i];
            // A direction's largest component is one step of the format less than 1.
            way * u.abs() <= (half[i] - x[i] * u.signum()) * (ONE - 1)
        };
        assert!(way >= 0 && (0..3).all(|i| parts(&u)[i] == 0 || room(i, way)));
        assert!(way == ONE - 1 || !(0..3).all(|i| parts(&u)[i] == 0 || room(i, way + 1)));
        cover!(s, way > 0 && parts(&u).iter().all(|u| *u < 0), "against all axes");
        cover!(s, way == 0, "from a face");
    }
}

/// Largest sideways error, in steps of the number format, of the point to which a normal at a cylinder's rim leads.
const RIM: f64 = 2.5;
/// Step between the sizes of cylinders, in steps of the number format.
const STEP: i64 = 3;

/// A cylinder and a place, from the source of inputs, and that place seen from the cylinder's centre: the part across the axis and
/// the coordinate along it.
fn round<S: Source>(s: &mut S) -> (Cylinder<N>, [i64; 3], [i64; 3], i64) {
    let mut size = || position(STEP * (1 + s.bits(2).cast_signed()));
    let (radius, half) = (size(), size());
    let (axis, at) = (s.bits(2) as usize, place(s, 4).map(|x| STEP * x));
    let body = Cylinder {
        centre: vector(CENTRE),
        radius,
        half,
        axis,
    };
    let mut across = from_centre(at);
    let along = std::mem::take(&mut across[axis.min(2)]);
    (body, at, across, along)
}

property! {
    /// P4 (geometry): a cylinder's surface is a radius from its axis and a half length from its middle. Outside of both, at the
    /// rim, the depth is right to within three steps of the number format.
    equation "depth = min (R - floor |v|, h - |z|); at a rim -3 <= |depth| - sqrt((floor |v| - R)² + (|z| - h)²) <= 0"
    over "places of 4 bits an axis, three times as large, radii and half lengths from 3 to 12 quanta, axis, side"
    by sampled fn p4_cylinder_nearest(s) {
        let (body, at, across, along) = round(s);
        let side = axis(s);
        let seen = body.nearest(vector(at), &side);
        let (radius, half) = (bits(body.radius), bits(body.half));
        let axis = body.axis.min(2);
        let depth = bits(seen.depth);
        let mut length = 0;
        while (length + 1) * (length + 1) <= squares(across) {
            length += 1;
        }
        let (wall, cap) = (radius - length, half - along.abs());
        let mut was = parts(&side);
        was[axis] = 0;
        let any = Direction::along(usize::from(axis == 0), false);
        let around = Direction::of(vector(across)).or(Direction::of(vector(was))).unwrap_or(any);
        if wall < 0 && cap < 0 {
            let square = wall * wall + cap * cap;
            assert!(depth <= 0 && depth * depth <= square && (3 - depth) * (3 - depth) >= square);
            // The normal is compared with the exact way from the rim. Its components were shortened by up to two steps of the
            // format.
            let mut way = across.map(|x| x as f64 * -wall as f64 / (squares(across) as f64).sqrt());
            way[axis] = (along.signum() * -cap) as f64;
            let size = way.iter().map(|x| x * x).sum::<f64>().sqrt();
            let normal = parts(&seen.normal).map(|x| x as f64 / ONE as f64 * size);
            assert_reached!(way.iter().zip(normal).all(|(way, normal)| (way - normal).abs() <= RIM));
        } else {
            assert!(depth == wall.min(cap));
            let end = Direction::along(axis, along < 0);
            assert_reached!(seen.normal == if wall < cap { around } else { end });
        }
        assert!(ways(&body) == both(axis) && !Surface::<N>::is_round(&body));
        cover!(s, wall < 0 && cap < 0, "off the rim");
        cover!(s, across == [0; 3] && wall < cap && was != [0; 3], "on the axis");
    }
}
property! {
    /// P4 (geometry): from inside a cylinder the way out ends on its wall or on an end face, to within three steps of the number
    /// format, and beyond neither.
    equation "| |v + t u| - R | <= 3 quanta, or | |z + t u_z| - h | <= 3 quanta"
    over "inside; places of 4 bits an axis, three times as large, radii and half lengths from 3 to 12 quanta, axis, directions of 3 bits an axis"
    by sampled fn p4_cylinder_exit(s) {
        let (body, at, across, along) = round(s);
        let (radius, half) = (bits(body.radius), bits(body.half));
        assume!(s, squares(across) <= radius * radius && along.abs() <= half, "case: inside, as SurfacePoint::tick asks");
        let Some(u) = direction(s, 3) else {
            return;
        };
        let way = body.exit(vector(at), &u, &u);
        let Some(way) = way else {
            panic!("no way out of a cylinder");
        };
        let mut left = end(from_centre(at), bits(way), &u);
        let height = std::mem::take(&mut left[body.axis.min(2)]).abs();
        let (wall, cap) = (is_at(left, radius, 3), (height - half * ONE).abs() <= 3 * ONE);
        let within = height <= (half + 3) * ONE && squares(left) <= ((radius + 3) * ONE) * ((radius + 3) * ONE);
        assert!((wall || cap) && within);
        cover!(s, wall && !cap, "through the wall");
        cover!(s, cap && !wall, "through an end");
    }
}

/// A plate and a place, from the source of inputs, and that place seen from the plate's centre.
fn plate<S: Source>(s: &mut S, width: u32, at: u32) -> (Plate<N>, [i64; 3], [i64; 3]) {
    let mut half = || 1 + s.bits(width).cast_signed();
    let half = [half(), half(), half()];
    let (axis, at) = (s.bits(2) as usize, place(s, at));
    let body = Cuboid {
        centre: vector(CENTRE),
        half: vector(half),
    };
    (Plate { body, axis }, at, from_centre(at))
}
/// Whether a place is over a plate, so that a way along its normal meets the plate.
fn is_over(plate: &Plate<N>, x: [i64; 3]) -> bool {
    let half = plate.body.half.0.map(bits);
    (0..3).all(|i| i == plate.axis.min(2) || x[i].abs() <= half[i])
}

property! {
    /// P4 (geometry): over a plate the hand's point is held on the side from which it came, however deep it is below that face.
    /// Elsewhere a plate acts as a box.
    equation "depth = h - x, normal = e (from above); h + x, -e (from below)"
    over "places of 4 bits an axis, half lengths from 1 to 8 quanta, axis, side: above, below, none"
    by sampled fn p4_plate_keeps_its_side(s) {
        let (plate, at, x) = plate(s, 3, 4);
        let axis = plate.axis.min(2);
        let came = (s.bits(2) % 3).cast_signed() - 1;
        let mut side = [0; 3];
        side[axis] = came * (ONE - 1);
        side[(axis + 1) % 3] = 1;
        let side = Direction(side.map(|x| position(x).0));
        let seen = plate.nearest(vector(at), &side);
        if is_over(&plate, x) {
            let below = came < 0 || came == 0 && x[axis] < 0;
            let height = if below { -x[axis] } else { x[axis] };
            assert!(seen.normal == Direction::along(axis, below));
            assert_reached!(bits(seen.depth) == bits(plate.body.half.0[axis]) - height);
        } else {
            assert_reached!(seen == plate.body.nearest(vector(at), &side));
        }
        assert!(ways(&plate) == both(axis));
        cover!(s, is_over(&plate, x) && came > 0 && x[axis] < 0, "pressed through");
        cover!(s, !is_over(&plate, x), "beside");
    }
}
property! {
    /// P4 (geometry): through a plate the way out leads to the face on the side from which the hand came; if the direction does not
    /// lead there, there is none.
    equation "t = depth / floor(normal·u) towards zero, of an axis of 127/128; none for normal·u <= 0 or beside"
    over "places of 3 bits an axis, half lengths from 1 to 4 quanta, axis, side, directions of 3 bits an axis"
    by sampled fn p4_plate_exit(s) {
        let (plate, at, x) = plate(s, 2, 3);
        let axis = plate.axis.min(2);
        let side = Direction::along(axis, s.bool());
        let Some(u) = direction(s, 3) else {
            return;
        };
        let way = plate.exit(vector(at), &u, &side).map(bits);
        let seen = plate.nearest(vector(at), &side);
        // The axis' direction is one step of the format shorter than 1; the cosine is rounded down.
        let cosine = (parts(&u)[axis] * parts(&side)[axis]).div_euclid(ONE);
        if !is_over(&plate, x) || cosine <= 0 {
            assert_reached!(way.is_none());
            return;
        }
        let depth = bits(seen.depth);
        let exact = depth.signum() * (depth.abs() * (ONE - 1) / cosine).min(ONE - 1);
        assert!(way == Some(exact));
        cover!(s, exact > depth, "aslant");
    }
}
