//! A drawn torque profile at 32 bits: what it asks for lies between the points beside the position, and never exceeds its strength.
//!
//! ```text
//! |f| <= A                                    p4_profile_repeated, p4_profile_once
//! points beside it >= 0  =>  f <= 0           p4_profile_repeated, p4_profile_once
//! points beside it <= 0  =>  f >= 0
//! at a point of 0        =>  f = 0
//! ```

use crate::source::Source;
use crate::{assume, cover, property};
use touchstone_control::environment::{
    Extent, MOST_POINTS, ProfileSettings, Reached, Reading, Shape, WHOLE,
};
use touchstone_control::{Fixed32, Force, Number, Position, Si};

type N = Fixed32;

/// A position: where in its turn, in 2^-32 of a turn, and along the axis.
struct ProfilePlace {
    turn: i32,
    angle: Si,
}

impl Reading<N> for ProfilePlace {
    fn angle(&self) -> Si {
        self.angle
    }
    fn turn(&self) -> i32 {
        self.turn
    }
    // A profile has no surface.
    fn penetration(&self, _: &Reached) -> Position<N> {
        Position::zero()
    }
}

/// Any shape of 2 to 64 points, and its number of points.
fn any_profile_shape<S: Source>(s: &mut S) -> Option<(Shape, u32)> {
    let mut points = [0_i16; MOST_POINTS];
    for point in &mut points {
        let any = s.i16();
        // Of samples, every second is 0, so that some are met.
        *point = if s.shortcut() {
            if any & 1 == 0 { 0 } else { any % (WHOLE + 1) }
        } else {
            any
        };
    }
    let used = 2 + s.bits(6) % 63;
    let used = if s.shortcut() && used > 8 { 3 } else { used };
    let shape = Shape::new(points.get(..used as usize)?).ok()?;
    Some((shape, used as u32))
}

/// Any strength from 0 to a limit of 8 N·m.
fn any_profile_strength<S: Source>(s: &mut S) -> Si {
    Si::from_bits(s.bits(35).cast_signed())
}

const PROFILE_LIMIT: Si = Si::lit("8");

/// The force against `+x`, and the two points beside the position.
fn profile_holds(force: Force<N>, strength: Si, beside: [i16; 2]) {
    let most = Force(N::saturating_signal(strength));
    assert_reached!(force <= most && force >= -most);
    assert_reached!(beside.iter().any(|point| *point < 0) || force <= Force::zero());
    assert_reached!(beside.iter().any(|point| *point > 0) || force >= Force::zero());
}

property! {
    /// P4: a profile that is repeated in a turn pushes with at most its strength, and no other way than the points beside the position.
    equation "|f| <= A, between(p(i), p(i+1)) has the sign of -f"
    over "shape, copies, strength, position in the turn"
    fn p4_profile_repeated(s) {
        let shape = any_profile_shape(s);
        assume!(s, shape.is_some(), "Shape::new");
        let Some((shape, used)) = shape else { return };
        let (strength, copies) = (any_profile_strength(s), 1 + (s.bits(13) % 6283) as u16);
        let settings = ProfileSettings { extent: Extent::PerTurn(copies), start: Si::ZERO, strength, shape };
        let accepted = settings.profile::<N>(PROFILE_LIMIT);
        assume!(s, accepted.is_ok(), "ProfileSettings::profile");
        let Ok(profile) = accepted else { return };
        let turn = s.i32();
        let force = profile.force(&ProfilePlace { turn, angle: Si::ZERO });
        // In integers without a bound: the part of a copy, of which a step is 2^32 over the number of points.
        let part = (i64::from(turn) * i64::from(copies)).rem_euclid(1 << 32) as u64;
        let place = (part * u64::from(used)) >> 32;
        let after = (place + 1) % u64::from(used);
        let of = |place: u64| shape.points().get(place as usize).copied().unwrap_or_default();
        profile_holds(force, strength, [of(place), of(after)]);
        cover!(s, force > Force::zero(), "one way");
        cover!(s, force < Force::zero(), "the other way");
        cover!(s, after == 0 && force != Force::zero(), "from the last point to the next copy");
    }
}
property! {
    /// P4: a profile that is there once pushes with at most its strength, and beyond an end as at that end.
    equation "|f| <= A, x <= x_0: f = f(x_0), x >= x_1: f = f(x_1)"
    over "shape, strength, position"
    fn p4_profile_once(s) {
        let shape = any_profile_shape(s);
        assume!(s, shape.is_some(), "Shape::new");
        let Some((shape, _)) = shape else { return };
        let strength = any_profile_strength(s);
        let (start, end) = (const { Si::lit("-0.7") }, const { Si::lit("2.3") });
        let settings = ProfileSettings { extent: Extent::Until(end), start, strength, shape };
        let accepted = settings.profile::<N>(PROFILE_LIMIT);
        assume!(s, accepted.is_ok(), "ProfileSettings::profile");
        let Ok(profile) = accepted else { return };
        let angle = Si::from_bits(s.i64());
        let angle = if s.shortcut() { Si::from_bits(angle.to_bits() >> 29) } else { angle };
        let force = profile.force(&ProfilePlace { turn: 0, angle });
        let ends = [shape.points().first(), shape.points().last()].map(|point| point.copied().unwrap_or_default());
        let most = Force(N::saturating_signal(strength));
        assert!(force <= most && force >= -most);
        if angle <= start {
            profile_holds(force, strength, [ends[0]; 2]);
            cover!(s, force != Force::zero(), "before the start");
        }
        if angle >= end {
            profile_holds(force, strength, [ends[1]; 2]);
            cover!(s, force != Force::zero(), "beyond the end");
        }
        cover!(s, angle > start && angle < end && force != Force::zero(), "between the ends");
    }
}
