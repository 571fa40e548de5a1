//! A torque profile: a torque drawn over the angle, given by points with straight lines between them.

use super::{Reading, Refused, detents::MOST, turn_of};
use crate::{Compliance, Force, Number, Si};

/// The most points that a torque profile can have.
pub const MOST_POINTS: usize = 96;

/// The largest value of a point of a torque profile. A point of this value gives the profile's largest force (strength).
pub const WHOLE: i16 = 10_000;

/// The smallest distance between the ends of a profile that is not repeated, rad (m).
pub(super) const SHORTEST: Si = Si::lit("0.001");

/// The largest distance between the ends of a profile that is not repeated, rad (m): 1,000 turns.
pub(super) const LONGEST: Si = Si::lit("6283.1853072");

/// Where a torque profile lies on the axis, and whether it is repeated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// The profile is repeated this number of times per turn, 1 to 6283. It is the same at every turn, bit for bit. The line from
    /// the last point leads to the first point of the next copy.
    PerTurn(u16),
    /// The profile exists once, from its start to this position, rad (m), at least 0.001 rad and at most 1,000 turns beyond the
    /// start. Outside, the torque is that of the nearer end point.
    Until(Si),
}

/// The points of a torque profile, at equal distances. Each is a fraction of the largest force in steps of 1/10,000, from -10,000
/// to 10,000; positive values push towards larger angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    points: [i16; MOST_POINTS],
    used: u8,
}

impl Shape {
    /// The shape with these points, 2 to [`MOST_POINTS`] of them.
    ///
    /// # Errors
    /// There are fewer or more points, or a point is outside -10,000 to 10,000.
    pub fn new(points: &[i16]) -> Result<Self, Refused> {
        let fits = (2..=MOST_POINTS).contains(&points.len());
        let used = u8::try_from(points.len()).ok().filter(|_| fits);
        let used = used.ok_or(Refused::Points(points.len()))?;
        let mut shape = Self {
            points: [0; MOST_POINTS],
            used,
        };
        for (place, point) in shape.points.iter_mut().zip(points) {
            if point.unsigned_abs() > WHOLE.unsigned_abs() {
                return Err(Refused::Point(*point));
            }
            *place = *point;
        }
        Ok(shape)
    }

    /// The points of the shape, as they were given.
    #[must_use]
    pub fn points(&self) -> &[i16] {
        self.points
            .get(..usize::from(self.used))
            .unwrap_or_default()
    }

    #[inline]
    fn point(&self, index: u32) -> i16 {
        let point = self.points.get(index as usize);
        point.copied().unwrap_or_default()
    }
}

/// The settings of a profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProfileSettings {
    /// Where the profile lies on the axis.
    pub extent: Extent,
    /// Position of the first point, rad (m).
    pub start: Si,
    /// The force at a point of the largest value (10,000), N·m (N), from 0 to the force limit.
    pub strength: Si,
    /// The points of the profile.
    pub shape: Shape,
}

/// A torque profile with computed coefficients: a force that depends on the position alone and has no memory.
///
/// Over one copy of the profile the work is zero if the copy's points add up to zero. Otherwise every copy gives or takes energy.
/// The energy guard counts that energy, and the energy that sampling adds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile<N: Number> {
    place: Place,
    shape: Shape,
    /// The profile's largest force, as a factor on the interpolated points: see [`Profile::drawn`] and `PER_WHOLE`.
    strength: Compliance<N>,
    most: Force<N>,
}

/// Where the points of a torque profile are: in repeated copies around a turn, or once.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// A repeated profile: number of copies per turn, and the position of the first point as a fraction of a copy in units of
    /// 2^-32.
    Turn { per_turn: i32, start: i32 },
    /// A profile that exists once: positions of its first and last point, and 2^32 divided by the distance between them.
    Once { start: Si, end: Si, per_length: u64 },
}

/// A position between two points of a torque profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Between {
    /// Index of the point on one side of the position, from which `way` is measured.
    pub before: u32,
    /// Index of the neighbouring point on the other side of the position.
    pub after: u32,
    /// Distance of the position from the point `before`, as a fraction of the distance to the point `after`, in units of 2^-32.
    pub way: u32,
}

/// Factor on the largest force in the computed coefficient, 16,384/10,000. [`Profile::drawn`] shifts instead of dividing, so it
/// turns a point of 10,000 into the fraction 10,000/16,384. This factor corrects that.
const PER_WHOLE: Si = Si::lit("1.6384");

impl ProfileSettings {
    /// Checks the settings, and computes the coefficients. `limit` is the force limit in N·m (N).
    ///
    /// # Errors
    /// The extent or the strength is outside its range.
    pub fn profile<N: Number>(&self, limit: Si) -> Result<Profile<N>, Refused> {
        let place = match self.extent {
            Extent::PerTurn(per_turn) => {
                if per_turn == 0 || per_turn > MOST {
                    return Err(Refused::PerTurn(per_turn));
                }
                let per_turn = i32::from(per_turn);
                Place::Turn {
                    per_turn,
                    start: turn_of(self.start).wrapping_mul(per_turn),
                }
            }
            Extent::Until(end) => {
                let length = end.saturating_sub(self.start);
                if length < SHORTEST || length > LONGEST {
                    return Err(Refused::Length(length));
                }
                let bits = u128::from(length.to_bits().unsigned_abs());
                let per_length = (1_u128 << 64)
                    .wrapping_add(bits / 2)
                    .checked_div(bits)
                    .and_then(|it| u64::try_from(it).ok());
                Place::Once {
                    start: self.start,
                    end,
                    per_length: per_length.unwrap_or_default(),
                }
            }
        };
        let refused = Refused::ProfileStrength {
            strength: self.strength,
            limit,
        };
        if self.strength > limit {
            return Err(refused);
        }
        let strength = N::ratio(self.strength.saturating_mul(PER_WHOLE)).ok_or(refused)?;
        Ok(Profile {
            place,
            shape: self.shape,
            strength: Compliance(strength),
            most: Force(N::saturating_signal(self.strength)),
        })
    }
}

impl<N: Number> Profile<N> {
    /// The profile's force at a position, positive against `+x` and at most the strength. The mirrored profile at the mirrored
    /// position gives the exact negative, bit for bit.
    #[inline]
    #[must_use]
    pub fn force(&self, at: &impl Reading<N>) -> Force<N> {
        let Between { before, after, way } = self.between(at);
        self.drawn([before, after].map(|index| self.shape.point(index)), way)
    }

    /// The profile's force between two points of the shape, positive against `+x`. `way` is the fraction of the distance from the
    /// first point to the second, in units of 2^-32.
    #[inline]
    #[must_use]
    pub fn drawn(&self, [before, after]: [i16; 2], way: u32) -> Force<N> {
        let (way, rest) = (i64::from(way), (1_i64 << 32).wrapping_sub(i64::from(way)));
        // Exact, because the sum is at most 10,000 times 2^32.
        let sum = i64::from(before)
            .wrapping_mul(rest)
            .wrapping_add(i64::from(after).wrapping_mul(way));
        // A point of 10,000 becomes 10,000/16,384. The absolute value is rounded and the sign restored, so that a mirrored profile
        // has mirrored roundings.
        let share = Si::from_bits((sum.unsigned_abs() >> 14).cast_signed());
        let size = Force(N::scale(self.strength.0, N::saturating_signal(share))).within(self.most);
        if sum > 0 { -size } else { size }
    }

    #[inline]
    fn between(&self, at: &impl Reading<N>) -> Between {
        let used = u32::from(self.shape.used);
        match self.place {
            Place::Turn { per_turn, start } => {
                let part = at.turn().wrapping_mul(per_turn).wrapping_sub(start);
                repeated_between(part.cast_unsigned(), used)
            }
            Place::Once {
                start,
                end,
                per_length,
            } => once_between(at.angle(), (start, end), per_length, used.wrapping_sub(1)),
        }
    }
}

/// Splits a distance into whole steps and the rest of a step. `fraction` is a fraction, in units of 2^-32, of a length of `steps`
/// steps; the rest is in units of 2^-32 of a step.
#[inline]
const fn steps_of(fraction: u32, steps: u32) -> (u32, u32) {
    let place = (fraction as u64).wrapping_mul(steps as u64);
    ((place >> 32) as u32, place as u32)
}

/// The position among the points of one copy of a repeated profile; `points` is their number. `part` is the fraction of the copy
/// before the position, in units of 2^-32.
#[inline]
#[must_use]
pub const fn repeated_between(part: u32, points: u32) -> Between {
    let (before, way) = steps_of(part, points);
    let next = before.wrapping_add(1);
    let after = if next == points { 0 } else { next };
    Between { before, after, way }
}

/// The position among the points of a profile that is not repeated. `per_length` is 2^32 over the length in rad (m), `last` the
/// index of the last point. The distance is measured from the nearer end, so that the mirrored profile has the mirrored
/// roundings.
#[cold]
#[inline(never)]
#[must_use]
pub fn once_between(angle: Si, (start, end): (Si, Si), per_length: u64, last: u32) -> Between {
    let [from_start, to_end] =
        [angle.saturating_sub(start), end.saturating_sub(angle)].map(|way| way.to_bits().max(0));
    let is_first_half = from_start <= to_end;
    let way = if is_first_half { from_start } else { to_end };
    // `way` is at most half of the length, so that the product fits; the product is in units of 2^-64 of the length, the fraction
    // in 2^-32.
    let fraction = way.unsigned_abs().wrapping_mul(per_length) >> 32;
    let fraction = if from_start == to_end {
        1 << 31
    } else {
        (fraction as u32).min(1 << 31)
    };
    let (near, way) = steps_of(fraction, last);
    let (near, far) = (near, near.wrapping_add(1).min(last));
    if is_first_half {
        Between {
            before: near,
            after: far,
            way,
        }
    } else {
        Between {
            before: last.wrapping_sub(near),
            after: last.wrapping_sub(far),
            way,
        }
    }
}
