//! Numbered positions of a knob, for programs that use the knob as a selector. Finds the position in which the knob is, with
//! hysteresis.

use crate::scene::{Environment, TorqueProfile};
use std::f64::consts::TAU;
use touchstone_control::environment::WHOLE;

/// Default hysteresis, as a fraction of the distance between two positions. The number changes at three quarters of the way to the
/// next detent, a quarter beyond the ridge between the two.
pub const HYSTERESIS: f64 = 0.25;

/// Largest hysteresis, or sum of hysteresis and bias, of positions with detents, as a fraction of the distance between two positions.
/// With more, the knob could rest in one detent under its neighbour's number.
pub const MOST_HYSTERESIS: f64 = 0.49;

/// The most positions of a list: a torque profile of 96 points has at most this number of places at which a knob rests.
pub const MOST_LISTED: usize = 48;

/// Positions of a knob, at equal distances or at listed angles. Their numbers rise with the angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Positions {
    /// Distance between two neighbouring positions, rad; of listed positions the smallest distance.
    pub pitch_rad: f64,
    /// Angle of position 0, rad.
    pub origin_rad: f64,
    /// The first and the last position between the end stops or of the list, counted from the origin; `None` without an end.
    pub ends: Option<(i64, i64)>,
    /// Distance beyond the middle between two positions at which the number changes, as a fraction of the positions' distance, 0 to
    /// 0.49.
    pub hysteresis: f64,
    /// Shift of each change of the number away from number 0, as a fraction of the positions' distance. A knob leaves number 0 later
    /// and comes back to it earlier; 0 shifts nothing.
    pub bias: f64,
    /// Angles of listed positions, rad, and their number; with fewer than two, positions are `pitch_rad` apart.
    listed: ([f64; MOST_LISTED], usize),
    /// The position in which the knob was last, counted from the origin; `None` before the first measured angle.
    now: Option<i64>,
    /// Added to a position, counted from the origin, to give the number that a program gets.
    shift: i64,
}

/// The position in which a knob is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// The number of the position, as a program gets it.
    pub position: i64,
    /// Difference of the number to the previous one; 0 for the first position.
    pub change: i64,
    /// Distance of the knob's angle from the position, positive above it, as a fraction of the distance between two positions.
    pub beside: f64,
}

impl Positions {
    /// Positions `pitch_rad` apart in both directions from position 0, which is at `origin_rad`.
    #[must_use]
    pub const fn every(pitch_rad: f64, origin_rad: f64) -> Self {
        Self {
            pitch_rad,
            origin_rad,
            ends: None,
            hysteresis: HYSTERESIS,
            bias: 0.0,
            listed: ([0.0; MOST_LISTED], 0),
            now: None,
            shift: 0,
        }
    }

    /// Positions at these rising angles, numbered from 0. Angles after the first [`MOST_LISTED`] are ignored. `None` without an
    /// angle.
    #[must_use]
    pub fn at(angles_rad: &[f64]) -> Option<Self> {
        let (first, angles_rad) = (
            angles_rad.first()?,
            angles_rad.get(..angles_rad.len().min(MOST_LISTED))?,
        );
        let gaps = angles_rad.windows(2).map(|pair| pair[1] - pair[0]);
        // A single position has no neighbour, so the distance is set to a whole turn.
        let pitch_rad = gaps.reduce(f64::min).unwrap_or(TAU);
        let mut positions = Self::every(pitch_rad, *first);
        positions.listed.1 = angles_rad.len();
        for (place, angle) in positions.listed.0.iter_mut().zip(angles_rad) {
            *place = *angle;
        }
        positions.ends = Some((0, angles_rad.len() as i64 - 1));
        Some(positions)
    }

    /// The listed angles; empty for positions at equal distances.
    fn list(&self) -> &[f64] {
        self.listed.0.get(..self.listed.1).unwrap_or_default()
    }

    /// The place of an angle among the positions: whole numbers are positions, counted from the origin. Between two listed angles
    /// the place is interpolated; beyond the list it is extrapolated from the last two angles.
    fn place_of(&self, angle_rad: f64) -> f64 {
        let list = self.list();
        if list.len() < 2 {
            return (angle_rad - self.origin_rad) / self.pitch_rad;
        }
        let above = list.partition_point(|at| *at <= angle_rad);
        let before = above.clamp(1, list.len() - 1) - 1;
        let [from, to] = [list[before], list[before + 1]];
        before as f64 + (angle_rad - from) / (to - from)
    }

    /// The positions of a scene's environment. They come from the first of these that acts: the listed detents, the equally spaced
    /// detents, the torque profile, the clicks. If none of them acts, they come from equally spaced detents without torque, which
    /// number the angles of a knob that turns freely.
    ///
    /// In a profile that is repeated around the turn, the point of least energy of each copy is a position. In any other profile,
    /// every angle at which the knob rests is a position. `None` if nothing gives a position.
    #[must_use]
    pub fn of(environment: &Environment) -> Option<Self> {
        let every = |per_rev: u32, pitch_rad: f64, centre_rad: f64| {
            let pitch_rad = match per_rev {
                0 => pitch_rad,
                per_rev => TAU / f64::from(per_rev),
            };
            Self::every(pitch_rad, centre_rad)
        };
        let detents = |felt: bool| {
            let it = environment.detents.as_ref()?;
            ((it.strength_n_m > 0.0) == felt)
                .then(|| every(it.per_rev, it.pitch_rad, it.centre_rad))
        };
        let listed = environment.acting_list();
        let listed = listed.and_then(|it| Self::at(it.rests()));
        let profile = || {
            let it = environment.acting_profile()?;
            if it.per_rev == 0 {
                return Self::at(&rests(&it));
            }
            let pitch_rad = TAU / f64::from(it.per_rev);
            let origin_rad = it.start_rad + pitch_rad * deepest(&it.shape);
            Some(Self::every(pitch_rad, origin_rad))
        };
        let clicks = || {
            let it = environment.click.as_ref()?;
            (it.strength_n_m > 0.0).then(|| every(it.per_rev, it.pitch_rad, it.centre_rad))
        };
        let felt = listed.or_else(|| detents(true)).or_else(profile);
        let positions = felt.or_else(clicks).or_else(|| detents(false))?;
        Some(positions.between(environment))
    }

    /// Limits the positions to those between the environment's end stops.
    #[must_use]
    pub fn between(mut self, environment: &Environment) -> Self {
        // An end stop exactly at a position still permits that position. This margin covers rounding errors.
        const NEARLY: f64 = 1e-6;
        let Some(stops) = &environment.endstops else {
            return self;
        };
        let [lower, upper] = [stops.lower_rad, stops.upper_rad].map(|at| self.place_of(at));
        let (first, last) = (
            (lower - NEARLY).ceil() as i64,
            (upper + NEARLY).floor() as i64,
        );
        self.ends = Some(match self.ends {
            Some((least, most)) => (first.max(least), last.min(most)),
            None => (first, last),
        });
        self
    }

    /// Gives the present position the number `number`; all other positions are renumbered to fit. Before the first
    /// [`Positions::take`] the position at the origin gets the number.
    pub fn call(&mut self, number: i64) {
        self.shift = number - self.now.unwrap_or(0);
    }

    /// Takes a measured angle. Returns the place if the position has changed since the last call, and at the first call.
    pub fn take(&mut self, angle_rad: f64) -> Option<Place> {
        let true_way = self.place_of(angle_rad);
        let shift = self.shift as f64;
        let from_zero = true_way + shift;
        let way = match self.bias > 0.0 {
            true => (from_zero.abs() - self.bias).max(0.0).copysign(from_zero) - shift,
            false => true_way,
        };
        let reach = 0.5 + self.hysteresis;
        let before = self.now;
        let now = match before.map(|now| now as f64) {
            Some(now) if (way - now).abs() <= reach => now,
            // The position that a slow turn to this angle would give, so that the hysteresis also applies after a fast turn.
            Some(now) if way > now => (way - reach).ceil(),
            Some(_) => (way + reach).floor(),
            None => way.round(),
        } as i64;
        let now = self
            .ends
            .map_or(now, |(first, last)| now.clamp(first, last.max(first)));
        self.now = Some(now);
        (before != Some(now)).then(|| Place {
            position: now + self.shift,
            change: before.map_or(0, |before| now - before),
            beside: true_way - now as f64,
        })
    }

    /// Finds the position at an angle anew, as at the first call of [`Positions::take`]. If the positions have no ends, this
    /// position then gets the number `number`, if given. Otherwise no position is renumbered.
    pub fn settle(&mut self, angle_rad: f64, number: Option<i64>) -> Place {
        self.now = None;
        let place = self.take(angle_rad);
        if let (None, Some(number)) = (self.ends, number) {
            self.call(number);
        }
        Place {
            position: self.number().unwrap_or(0),
            change: 0,
            beside: place.map_or(0.0, |place| place.beside),
        }
    }

    /// The number of the present position; `None` before the first measured angle.
    #[must_use]
    pub fn number(&self) -> Option<i64> {
        self.now.map(|now| now + self.shift)
    }

    /// Sets the position in which the knob is, counted from the origin.
    pub const fn stand_at(&mut self, position: i64) {
        self.now = Some(position);
    }

    /// Distance of an angle from the present position, positive above it, as a fraction of the distance between two positions.
    /// Before the first call of [`Positions::take`], it is the distance from the nearest position.
    #[must_use]
    pub fn beside(&self, angle_rad: f64) -> f64 {
        let way = self.place_of(angle_rad);
        way - self.now.map_or(way.round(), |now| now as f64)
    }

    /// The angle of a position, counted from the origin, rad.
    #[must_use]
    pub fn angle_of(&self, position: i64) -> f64 {
        match usize::try_from(position)
            .ok()
            .and_then(|it| self.list().get(it))
        {
            Some(angle_rad) => *angle_rad,
            None => self.origin_rad + position as f64 * self.pitch_rad,
        }
    }

    /// The first and the last angle of listed positions, rad; `None` for positions at equal distances.
    #[must_use]
    pub fn listed_between(&self) -> Option<(f64, f64)> {
        Some((*self.list().first()?, *self.list().last()?))
    }

    /// The position that is nearest to an angle, counted from the origin.
    #[must_use]
    pub fn nearest_to(&self, angle_rad: f64) -> i64 {
        let nearest = self.place_of(angle_rad).round() as i64;
        self.ends.map_or(nearest, |(first, last)| {
            nearest.clamp(first, last.max(first))
        })
    }

    /// The numbers of the first and the last position; `None` without end stops or a list.
    #[must_use]
    pub fn numbers(&self) -> Option<(i64, i64)> {
        self.ends
            .map(|(first, last)| (first + self.shift, last + self.shift))
    }
}

/// The angles at which a knob rests in a torque profile that is not repeated. There the torque falls through 0 as the angle rises,
/// from at least a tenth of the strength to at least a tenth in the other direction. Where the torque is 0 over a range, the angle
/// is the middle of the range.
fn rests(profile: &TorqueProfile) -> Vec<f64> {
    let last = profile.shape.len().saturating_sub(1);
    let angle_of = |place: f64| {
        let share = place / last.max(1) as f64;
        profile.start_rad + share * (profile.end_rad - profile.start_rad)
    };
    let mut found = Vec::new();
    // Index and torque of the last point with a positive torque, and the largest torque since the last point with a negative one.
    let (mut up, mut strongest) = (None, 0.0_f64);
    let mut pending: Option<f64> = None;
    for (i, torque) in profile.shape.iter().enumerate() {
        if *torque > 0.0 {
            (up, strongest, pending) = (Some((i, *torque)), strongest.max(*torque), None);
        } else if *torque < 0.0 {
            if let Some((before, push)) = up.take()
                && strongest >= LEAST_PUSH
            {
                let zeros = i - before - 1;
                let place = match zeros {
                    0 => before as f64 + push / (push - torque),
                    _ => before as f64 + 0.5 * (zeros as f64 + 1.0),
                };
                pending = Some(place);
            }
            if *torque <= -LEAST_PUSH
                && let Some(place) = pending.take()
            {
                found.push(angle_of(place));
            }
            strongest = 0.0;
        }
    }
    found
}

/// The least torque on either side of a rest, as a fraction of the profile's strength.
const LEAST_PUSH: f64 = 0.1;

/// The point of least energy in a repeated torque profile, at which the knob comes to rest, as a fraction (0 to 1) of a copy's
/// length.
fn deepest(points: &[f64]) -> f64 {
    let whole = |point: &f64| (point * f64::from(WHOLE)).round() as i64;
    let (mut height, mut least, mut place) = (0_i64, 0, 0);
    for (index, pair) in points.windows(2).enumerate() {
        // Adds twice the energy of one step: the mean of the two torques times the step, with the opposite sign because it is the
        // work against the torque.
        height -= pair.iter().map(whole).sum::<i64>();
        if height < least {
            (least, place) = (height, index + 1);
        }
    }
    place as f64 / points.len().max(1) as f64
}

#[cfg(test)]
mod tests;
