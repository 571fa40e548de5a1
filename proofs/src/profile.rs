//! Properties of a torque profile (a torque drawn over the angle) at 32 bits. The force lies between the two points beside the
//! position, and never exceeds the largest force.
//!
//! `f` is the force, `A` the largest force, `i` a point's index, `x` the position, from `x_0` to `x_1`. A point above 0 pushes
//! towards larger angles, a force above 0 towards smaller ones.
//!
//! ```text
//! |f| <= A                                       p4_profile_force
//! both points >= 0  =>  f <= 0                   p4_profile_force
//! both points <= 0  =>  f >= 0
//! i = floor(part n), i+1 or 0 after it           p9_profile_repeated
//! x <= x_0: the first point, x >= x_1: the last  p4_profile_once
//! ```

use crate::source::Source;
use crate::{assume, cover, property};
use touchstone_control::environment::profile::{Between, once_between, repeated_between};
use touchstone_control::environment::{Extent, MOST_POINTS, ProfileSettings, Shape, WHOLE};
use touchstone_control::{Fixed32, Force, Number, Si};

type N = Fixed32;

/// A point of a torque profile from the source of inputs, in ten-thousandths of the profile's largest force: with a shortcut from
/// -10,000 to 10,000, else any `i16`, of which the property must reject the values outside.
fn profile_point<S: Source>(s: &mut S) -> i16 {
    let any = s.i16();
    if s.shortcut() { any % (WHOLE + 1) } else { any }
}

property! {
    /// P4: between two points a torque profile pushes with at most its largest force, and never in a direction in which neither
    /// point pushes.
    equation "|f| <= A; p, q >= 0 => f <= 0; p, q <= 0 => f >= 0"
    over "strength, two points, way between them"
    fn p4_profile_force(s) {
        let strength = Si::from_bits(s.bits(35).cast_signed());
        let shape = Shape::new(&[0, 0]);
        let Ok(shape) = shape else { return };
        let settings = ProfileSettings { extent: Extent::PerTurn(1), start: Si::ZERO, strength, shape };
        let accepted = settings.profile::<N>(const { Si::lit("8") });
        assume!(s, accepted.is_ok(), "ProfileSettings::profile");
        let Ok(profile) = accepted else { return };
        let points = [profile_point(s), profile_point(s)];
        assume!(s, points.iter().all(|point| point.unsigned_abs() <= WHOLE.unsigned_abs()), "Shape::new");
        let force = profile.drawn(points, s.u32());
        let most = Force(N::saturating_signal(strength));
        assert!(force <= most && force >= -most);
        assert!(points.iter().any(|point| *point < 0) || force <= Force::zero());
        assert!(points.iter().any(|point| *point > 0) || force >= Force::zero());
        cover!(s, force == most && force > Force::zero(), "the whole strength");
        cover!(s, force < Force::zero(), "towards larger angles");
        cover!(s, force > Force::zero() && force < most, "towards smaller ones");
    }
}
property! {
    /// P9: in every copy of a repeated torque profile, a given part of the copy is between the same two points. The last point is
    /// followed by the first of the next copy.
    equation "i = floor(part n / 2^32), way = part n - i 2^32, after = (i + 1) mod n"
    over "part of a copy, number of points"
    fn p9_profile_repeated(s) {
        let (part, points) = (s.u32(), s.bits(7) as u32 % MOST_POINTS as u32 + 1);
        let Between { before, after, way } = repeated_between(part, points);
        assert!(before < points && after < points);
        assert!(after == (before + 1) % points);
        // Point index and way are the high and low word of part times number of points, exactly.
        assert!(u64::from(before) << 32 | u64::from(way) == u64::from(part) * u64::from(points));
        cover!(s, after == 0 && points > 1, "to the next copy");
        cover!(s, after > before, "within a copy");
    }
}
property! {
    /// P4: a torque profile that is not repeated holds the first point before its start and the last point beyond its end. In
    /// between, a position is between two neighbouring points.
    equation "x <= x_0: i = 0, way = 0; x >= x_1: i = last, way = 0"
    over "position, number of points"
    fn p4_profile_once(s) {
        let (start, end) = (const { Si::lit("-0.7") }, const { Si::lit("2.3") });
        // 2^64 over the length of 3 with its 32 digits.
        const PER_LENGTH: u64 = (1 << 32) / 3;
        let last = 1 + s.bits(7) as u32 % (MOST_POINTS as u32 - 1);
        let angle = Si::from_bits(s.i64());
        let angle = if s.shortcut() { Si::from_bits(angle.to_bits() >> 29) } else { angle };
        let Between { before, after, way } = once_between(angle, (start, end), PER_LENGTH, last);
        assert!(before <= last && after <= last && before.abs_diff(after) <= 1);
        assert!(angle > start || (before, way) == (0, 0));
        assert!(angle < end || (before, way) == (last, 0));
        cover!(s, angle <= start, "before the start");
        cover!(s, angle >= end, "beyond the end");
        cover!(s, before < after && way > 0, "in the first half");
        cover!(s, before > after && way > 0, "in the second half");
    }
}
