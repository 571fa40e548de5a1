//! Tests decisions of the laws on three axes (shells): when a contact ends, which way out is taken, and the inputs of estimator and
//! guard. Test laws and test objects give fixed answers.

use touchstone_control::fixed::types::{I1F7, I5F3, I8F24, I20F12};
use touchstone_control::law::{Contact, Sample, View};
use touchstone_control::space::environment::{Cuboid, Edge, Plane};
use touchstone_control::space::{
    Along, Direction, Friction, FrictionState, Held, Leaving, Magnitude, Nearest, PerAxis,
    PlaceEstimator, Rule, Shell, SpaceWall, Surface, SurfacePoint, Touch, Turn, Vector,
    VectorGuard,
};
use touchstone_control::{
    Compliance, Estimator, EstimatorSettings, Fixed8, Fixed32, Force, GuardSettings, GuardedDevice,
    Position, Si, Stiffness,
};
use touchstone_proofs::spec::hands::Random;

type N = Fixed8;

fn position(quanta: i64) -> Position<N> {
    Position(I1F7::from_bits(quanta as i8))
}
fn force(quanta: i64) -> Force<N> {
    Force(I1F7::from_bits(quanta as i8))
}
fn vector(quanta: [i64; 3]) -> Vector<Position<N>> {
    Vector(quanta.map(position))
}
fn touch(normal: Direction<N>, depth: i64) -> Touch<N> {
    Touch {
        at: vector([0; 3]),
        normal,
        depth: position(depth),
        moved: None,
    }
}
fn direction(parts: [i64; 3]) -> Direction<N> {
    Direction(parts.map(|part| I1F7::from_bits(part as i8)))
}

/// A test law that always gives the same force, offset and contact phase.
#[derive(Debug, Clone, Copy)]
struct Says {
    force: i64,
    offset: i64,
    contact: Contact,
    was_reset: bool,
}
impl Along<N> for Says {
    fn tick(&mut self, _: Sample<N>) -> Force<N> {
        force(self.force)
    }
    fn view(&self) -> View<N> {
        View {
            contact: self.contact,
            energy: None,
            offset: position(self.offset),
            mass: None,
        }
    }
    fn reset(&mut self) {
        self.was_reset = true;
    }
}
fn says(force: i64, offset: i64, contact: Contact) -> Says {
    Says {
        force,
        offset,
        contact,
        was_reset: false,
    }
}

#[test]
fn a_contact_of_three_axes_ends_where_its_rule_says() {
    use Contact::{Augmenting, First, Free};
    let diagonal = direction([64, 64, 0]);
    // Each axis has half of the depth: with a depth of -16 the penetration is -8 along x and along y.
    let ends = |leaving, depth, offsets: [i64; 2], contacts: [Contact; 3]| {
        let laws = [
            says(5, offsets[0], contacts[0]),
            says(6, offsets[1], contacts[1]),
            says(7, 0, contacts[2]),
        ];
        let mut shell = PerAxis::new(laws, leaving);
        let pull = shell.tick(&touch(diagonal, depth));
        let resets = shell.laws.map(|law| law.was_reset);
        let kept = Vector([force(5), force(6), force(7)]);
        match resets {
            [true, true, true] => assert_eq!(pull, Vector::default()),
            [false, false, false] => assert_eq!(pull, kept),
            some => panic!("not all of them: {some:?}"),
        }
        resets[0]
    };
    let touching = [Augmenting, Augmenting, Free];
    for leaving in [Leaving::Decoupled, Leaving::AnyAxis, Leaving::Projection] {
        // Inside, on the surface, without contact, or where the offset reaches further on both axes, a contact never ends.
        assert!(!ends(leaving, 16, [0, 0], touching));
        assert!(!ends(leaving, 0, [0, 0], touching));
        assert!(!ends(leaving, -16, [0, 0], [Free; 3]));
        assert!(!ends(leaving, -16, [9, 9], touching));
        // Outside of both shifted surfaces; contact on any one axis is enough.
        let left = leaving != Leaving::Decoupled;
        assert_eq!(ends(leaving, -16, [2, 2], touching), left);
        for touches in 0..3 {
            let mut contacts = [Free; 3];
            contacts[touches] = First;
            assert_eq!(ends(leaving, -16, [2, 2], contacts), left);
        }
    }
    // A depth of one step outside is half a step on each axis, which is rounded to 0, so no axis has left. Two steps are one on
    // each axis.
    assert!(!ends(Leaving::AnyAxis, -1, [0, 0], touching));
    assert!(ends(Leaving::AnyAxis, -2, [0, 0], touching));
    // One axis has left: 8² + 8² against 8 (20 + 2).
    assert!(ends(Leaving::AnyAxis, -16, [20, 2], touching));
    assert!(!ends(Leaving::Projection, -16, [20, 2], touching));
    assert!(ends(Leaving::Projection, -16, [10, 5], touching));
    assert!(!ends(Leaving::Projection, -16, [10, 6], touching));
}

#[test]
fn where_a_coordinate_is_0_its_force_keeps_its_side() {
    let laws = [5, 6, 7].map(|force| says(force, 9, Contact::Augmenting));
    let pulls = |normals: &[[i64; 3]]| {
        let mut shell = PerAxis::new(laws, Leaving::Decoupled);
        let mut pull = Vector::default();
        for normal in normals {
            pull = shell.tick(&touch(direction(*normal), 16));
        }
        pull.0.map(|f| i64::from(f.0.to_bits()))
    };
    assert_eq!(pulls(&[[0, 0, 127]]), [5, 6, 7]);
    assert_eq!(pulls(&[[-90, 0, -90]]), [-5, 6, -7]);
    assert_eq!(pulls(&[[-90, 0, -90], [0, 127, 0]]), [-5, 6, -7]);
    assert_eq!(pulls(&[[0, 127, 0], [-90, 0, -90]]), [-5, 6, -7]);
    // Components as small as possible.
    assert_eq!(pulls(&[[-90, 0, -90], [1, 0, 1]]), [5, 6, 7]);
    assert_eq!(pulls(&[[90, 0, 90], [-1, 0, -1]]), [-5, 6, -7]);
}

/// A test object that reports given ways out in some directions, and none in any other.
struct Ways {
    round: bool,
    closest: Direction<N>,
    ways: Vec<Direction<N>>,
    exits: Vec<(Direction<N>, i64)>,
}
impl Surface<N> for Ways {
    fn nearest(&self, _: Vector<Position<N>>, _: &Direction<N>) -> Nearest<N> {
        Nearest {
            normal: self.closest,
            depth: position(3),
        }
    }
    fn exit(
        &self,
        _: Vector<Position<N>>,
        along: &Direction<N>,
        _: &Direction<N>,
    ) -> Option<Position<N>> {
        let known = self.exits.iter().find(|(way, _)| way == along);
        known.map(|(_, depth)| position(*depth))
    }
    fn ways(&self, visit: &mut dyn FnMut(Direction<N>)) {
        self.ways.iter().for_each(|way| visit(*way));
    }
    fn is_round(&self) -> bool {
        self.round
    }
}

#[test]
fn of_all_ways_out_in_the_cone_the_shortest_is_taken() {
    let (x, y, z) = (
        Direction::along(0, false),
        Direction::along(1, false),
        Direction::along(2, false),
    );
    let turn = Turn::of_ratio(position(64).0);
    let towards_closest = x.turned(&y, &turn);
    // A direction in the cone, one on its edge, and one outside.
    let (inside, outside) = (direction([124, 0, 30]), z.opposite());
    assert!(Position::<N>(x.cosine(&inside)) > Position(turn.cosine));
    let edge = [turn.cosine.to_bits().into(), 0, turn.sine.to_bits().into()];
    let mut edge = direction(edge);
    // The cosine of two directions is rounded down. The loop searches the direction whose cosine just equals that of the cone.
    while Position::<N>(x.cosine(&edge)) < Position(turn.cosine) {
        edge.0[0] += I1F7::DELTA;
    }
    // A smaller other component, which does not change that cosine.
    edge.0[2] -= I1F7::from_bits(4);
    assert_eq!(x.cosine(&edge), turn.cosine);
    let turned_outside = x.turned(&outside, &turn);
    let turned_edge = x.turned(&edge, &turn);
    assert_ne!(turned_edge, edge);

    let taken = |round, exits: &[(Direction<N>, i64)]| {
        let object = Ways {
            round,
            closest: x,
            ways: vec![inside, edge, outside],
            exits: exits.to_vec(),
        };
        let mut point = SurfacePoint::new(Rule::Restricted(turn));
        point.tick(&object, vector([0; 3]));
        let object = Ways {
            closest: y,
            ..object
        };
        let touch = point.tick(&object, vector([0; 3]));
        (touch.normal, i64::from(touch.depth.0.to_bits()))
    };
    let all = [x, towards_closest, inside, edge, turned_outside];
    for shortest in all {
        let exits = all.map(|way| (way, if way == shortest { 4 } else { 9 }));
        assert_eq!(taken(false, &exits), (shortest, 4));
    }
    // Of equally short ways the first is taken, which is straight on.
    assert_eq!(taken(false, &all.map(|way| (way, 5))), (x, 5));
    // Not tried: directions outside the cone as they are, and directions in the cone turned.
    for never in [outside, y, turned_edge] {
        assert_eq!(taken(false, &[(never, 1), (inside, 7)]), (inside, 7));
    }
    // Out of a round object only one direction is tried.
    for way in [x, inside, edge, turned_outside] {
        assert_eq!(
            taken(true, &[(way, 1), (towards_closest, 7)]),
            (towards_closest, 7)
        );
    }
    // If no way leads out, the direction stays.
    assert_eq!(taken(false, &[]), (x, 3));
}

#[test]
fn of_equally_close_faces_of_a_box_that_of_the_first_axis_is_taken() {
    let cube = Cuboid {
        centre: vector([0; 3]),
        half: vector([20; 3]),
    };
    let side = Direction::along(2, true);
    let nearest = |at| cube.nearest(vector(at), &side);
    for (at, axis, against) in [
        ([15, 15, 15], 0, false),
        ([-15, 15, 0], 0, true),
        ([3, -15, 15], 1, true),
    ] {
        assert_eq!(nearest(at).normal, Direction::along(axis, against));
        assert_eq!(nearest(at).depth, position(5));
    }
    // If a flat object is all surface, the side stays.
    let flat = Cuboid {
        centre: vector([0; 3]),
        half: vector([0, 0, 20]),
    };
    assert_eq!(flat.nearest(vector([0; 3]), &side).depth, position(0));
}

#[test]
fn beside_an_edge_the_way_to_it_leads_between_both_planes() {
    use wide::{W, at, place};
    let planes = [0, 1].map(|axis| Plane::<W> {
        normal: Direction::along(axis, false),
        height: Position::zero(),
    });
    let edge = Edge::new(planes);
    let (x, y) = (Direction::along(0, false), Direction::along(1, false));
    let of = |at| edge.nearest(place(at), &x);
    for size in [1, 2, 3, 1000] {
        let [a, b, c] = of([size, size, 0]).normal.0;
        assert!(a == b && a > I8F24::ZERO && c == I8F24::ZERO, "{size}");
        // On the surface of one plane, outside of the other.
        assert_eq!(of([0, size, 0]).normal, y);
        assert_eq!(of([size, 0, 0]).normal, x);
        assert_eq!(of([0, size, 0]).depth, at(-size));
        // Inside, below the closer plane.
        assert_eq!(of([-size, 0, 0]).normal, y);
        assert_eq!(of([0, -size, 0]).normal, x);
    }
}

#[test]
fn the_flattest_way_out_leads_out() {
    let wall = Plane {
        normal: Direction::along(0, false),
        height: position(0),
    };
    let side = Direction::along(0, false);
    let out = |at, u| wall.exit(vector(at), &direction(u), &side);
    // A direction that leads out very flatly: the way out is the longest that the format holds, or 0 from the surface.
    assert_eq!(out([-5, 0, 0], [2, 127, 0]), Some(position(127)));
    assert_eq!(out([0, 0, 0], [2, 127, 0]), Some(position(0)));
    assert_eq!(out([-5, 0, 0], [0, 127, 0]), None);
}

/// A friction whose spring stretches at the largest force by at most 60 (static) and 40 (kinetic) steps of the position format.
fn friction() -> Friction<N> {
    let reach = |bits| Compliance(I1F7::from_bits(bits));
    Friction {
        stiffness: Stiffness(I5F3::from_bits(40)),
        static_reach: reach(60),
        kinetic_reach: reach(40),
    }
}

#[test]
fn the_least_press_is_contact_for_friction() {
    let mut state = FrictionState::default();
    let seen = touch(Direction::along(2, false), 3);
    friction().tick(&mut state, &seen, force(1));
    assert!(state.contact.is_some());
    friction().tick(&mut state, &seen, force(0));
    assert_eq!(state, FrictionState::default());
}

fn si(text: &str) -> Si {
    text.parse().expect("a number")
}

/// Helpers for tests in the 32-bit format: positions in centimetres, forces in newtons, 1 kHz.
mod wide {
    use super::*;
    pub type W = Fixed32;

    pub fn at(x: i64) -> Position<W> {
        Position(I8F24::from_bits(x as i32))
    }
    pub fn place(x: [i64; 3]) -> Vector<Position<W>> {
        Vector(x.map(at))
    }
    pub fn pull(x: [i64; 3]) -> Vector<Force<W>> {
        Vector(x.map(|f| Force(I8F24::from_bits(f as i32))))
    }
    pub fn guard() -> VectorGuard<W> {
        let settings = GuardSettings {
            capacity: si("0.02"),
            ..GuardSettings::default()
        };
        let device = GuardedDevice {
            rate_hz: 1000,
            force_limit: si("5"),
            count: si("0.001"),
        };
        VectorGuard::new(&settings, &device).expect("accepted")
    }
}

#[test]
fn the_guard_of_three_axes_remembers_the_length_of_its_force() {
    use wide::{place, pull};
    let guard = wide::guard();
    let mut state = guard.full();
    for wanted in [[9, 9, 9], [3000, -4000, 0], [0; 3]] {
        let shown = guard.tick(&mut state, place([0; 3]), pull(wanted));
        assert_eq!(shown, Ok(pull(wanted)));
        assert_eq!(state.size, pull(wanted).length_up());
    }
    // A force that is too long is cut to what the account allows.
    let long = pull([1 << 29; 3]);
    let shown = guard
        .tick(&mut state, place([0; 3]), long)
        .expect("at rest");
    assert!(shown.length_up() <= state.size && state.size < long.length_up());
}

#[test]
fn a_wall_s_estimator_is_told_what_was_commanded_in_the_end() {
    use wide::{W, place, pull};
    let settings = EstimatorSettings {
        bandwidth_hz: si("60"),
        inertia: si("0.0001"),
        damping: si("0.0005"),
        delay_s: si("0.0003"),
    };
    let estimator: Estimator<W> = settings.estimator(1000, si("5")).expect("accepted");
    let mut random = Random(9);
    let (mut limited, mut changes) = (0, 0);
    for round in 0..200 {
        let law = touchstone_control::law::Spring::<W> {
            desired: Stiffness(I20F12::from_num(300)),
            damping: Stiffness::zero(),
            limit: Force(I8F24::from_num(5)),
        };
        let body = Plane::<W> {
            normal: Direction::along(0, true),
            height: Position::zero(),
        };
        let (mut point, mut shell) = (
            SurfacePoint::new(Rule::Closest),
            Shell::Magnitude(Magnitude::new(Held::new(law))),
        );
        let limit = Force(I8F24::from_num(2));
        let mut wall = SpaceWall::new(body, point, shell, limit);
        let mut place_estimator = PlaceEstimator::new([estimator; 3]);
        wall.estimator = Some(place_estimator);
        let mut guard = (round % 2 == 0).then(|| (wide::guard(), wide::guard().full()));
        wall.guard = guard;
        let mut commanded = Vector::default();
        let mut last: Option<Vector<Position<W>>> = None;
        let mut now = [0_i64; 3];
        for _ in 0..30 {
            now = now.map(|x| x + random.within(1 << 14));
            let at = place(now);
            place_estimator.commanded(commanded);
            let ahead = place_estimator.tick(at);
            let touch = Touch {
                moved: Some(ahead.moved),
                ..point.tick(&body, ahead.at)
            };
            let wanted = shell.tick(&touch);
            let within = wanted.within(limit);
            let moved = last.map_or(Vector::default(), |last| at - last);
            last = Some(at);
            let expected = match &mut guard {
                Some((guard, state)) => guard.tick_at(state, at, moved, within),
                None => Ok(within),
            };
            assert_eq!(wall.tick(at), expected);
            commanded = expected.unwrap_or_default();
            limited += u32::from(commanded != wanted);
            if random.below(3) == 0 {
                commanded = pull(commanded.0.map(|f| i64::from(f.0.to_bits()) / 2));
                wall.commanded(commanded);
                if let Some((guard, state)) = &mut guard {
                    guard.commanded(state, commanded);
                }
                changes += u32::from(commanded != Vector::default());
            }
            assert_eq!(wall.estimator, Some(place_estimator));
            assert_eq!(wall.guard, guard);
        }
    }
    assert!(limited > 100 && changes > 100, "{limited} {changes}");
}
