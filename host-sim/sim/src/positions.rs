//! Numbered positions of a knob, for programs that use the knob as a selector: the detent in which it is, with hysteresis.

use crate::scene::Environment;
use std::f64::consts::TAU;
use touchstone_control::environment::WHOLE;

/// Default hysteresis, as a fraction of the distance between two positions. The number changes at three quarters of the way to the
/// next detent, a quarter beyond the ridge between the two.
pub const HYSTERESIS: f64 = 0.25;

/// Positions of a knob at equal distances, whose numbers rise with the angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Positions {
    /// Distance between two neighbouring positions, rad.
    pub pitch_rad: f64,
    /// Angle of position 0, rad.
    pub origin_rad: f64,
    /// The first and the last position between the end stops, counted from the origin; `None` without end stops.
    pub ends: Option<(i64, i64)>,
    /// Distance beyond the middle between two positions at which the number changes, as a fraction of the positions' distance, 0 to
    /// 0.49.
    pub hysteresis: f64,
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
    /// Distance of the knob's angle from the position, as a fraction of the distance between two positions.
    pub beside: f64,
}

impl Positions {
    /// Positions at this distance, the first at `origin_rad`.
    #[must_use]
    pub const fn every(pitch_rad: f64, origin_rad: f64) -> Self {
        Self {
            pitch_rad,
            origin_rad,
            ends: None,
            hysteresis: HYSTERESIS,
            now: None,
            shift: 0,
        }
    }

    /// The positions of a scene's environment: its detents, or else the points of least energy in the copies of its torque profile,
    /// or else its clicks. `None` if it has none of them.
    #[must_use]
    pub fn of(environment: &Environment) -> Option<Self> {
        let every = |per_rev: u32, pitch_rad: f64, centre_rad: f64| {
            let pitch_rad = match per_rev {
                0 => pitch_rad,
                per_rev => TAU / f64::from(per_rev),
            };
            Self::every(pitch_rad, centre_rad)
        };
        let detents = || {
            let it = environment.detents.as_ref()?;
            (it.strength_n_m > 0.0).then(|| every(it.per_rev, it.pitch_rad, it.centre_rad))
        };
        let profile = || {
            let it = environment.acting_profile().filter(|it| it.per_rev > 0)?;
            let pitch_rad = TAU / f64::from(it.per_rev);
            let origin_rad = it.start_rad + pitch_rad * deepest(&it.shape);
            Some(Self::every(pitch_rad, origin_rad))
        };
        let clicks = || {
            let it = environment.click.as_ref()?;
            (it.strength_n_m > 0.0).then(|| every(it.per_rev, it.pitch_rad, it.centre_rad))
        };
        let positions = detents().or_else(profile).or_else(clicks)?;
        Some(positions.between(environment))
    }

    /// Limits the positions to those between the environment's end stops.
    #[must_use]
    pub fn between(mut self, environment: &Environment) -> Self {
        // An end stop exactly at a position still permits that position. This margin covers rounding errors.
        const NEARLY: f64 = 1e-6;
        self.ends = environment.endstops.as_ref().map(|ends| {
            let place = |at: f64| (at - self.origin_rad) / self.pitch_rad;
            let [lower, upper] = [ends.lower_rad, ends.upper_rad].map(place);
            (
                (lower - NEARLY).ceil() as i64,
                (upper + NEARLY).floor() as i64,
            )
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
        let way = (angle_rad - self.origin_rad) / self.pitch_rad;
        let reach = 0.5 + self.hysteresis;
        let before = self.now;
        let now = match before.map(|now| now as f64) {
            Some(now) if (way - now).abs() <= reach => now,
            // The position that a slow turn would have reached: a fast one may end on a ridge, where it has to turn back as far.
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
            beside: way - now as f64,
        })
    }

    /// Sets the position in which the knob is, counted from the origin.
    pub const fn stand_at(&mut self, position: i64) {
        self.now = Some(position);
    }

    /// Distance of an angle from the present position, as a fraction of the distance between two positions. Before the first call
    /// of [`Positions::take`], it is the distance from the nearest position.
    #[must_use]
    pub fn beside(&self, angle_rad: f64) -> f64 {
        let way = (angle_rad - self.origin_rad) / self.pitch_rad;
        way - self.now.map_or(way.round(), |now| now as f64)
    }

    /// The angle of a position, counted from the origin, rad.
    #[must_use]
    pub fn angle_of(&self, position: i64) -> f64 {
        self.origin_rad + position as f64 * self.pitch_rad
    }

    /// The numbers of the first and the last position between the end stops.
    #[must_use]
    pub fn numbers(&self) -> Option<(i64, i64)> {
        self.ends
            .map(|(first, last)| (first + self.shift, last + self.shift))
    }
}

/// The point of a torque profile at which the knob comes to rest, as a fraction (0 to 1) of the profile's length. It is the point of
/// least energy.
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
mod tests {
    use super::{HYSTERESIS, Positions, deepest};
    use crate::scene::{DetentRing, Endstops, Environment};

    fn dial() -> Environment {
        Environment {
            detents: Some(DetentRing {
                strength_n_m: 0.012,
                ..DetentRing::default()
            }),
            endstops: Some(Endstops {
                lower_rad: -0.1309,
                upper_rad: 2.7489,
                stiffness_n_m_per_rad: None,
            }),
            ..Environment::default()
        }
    }

    #[test]
    fn a_position_changes_beyond_the_ridge_and_once() {
        let mut positions = Positions::of(&dial()).unwrap();
        let pitch = positions.pitch_rad;
        assert_eq!(positions.numbers(), Some((0, 10)));
        assert_eq!(positions.take(0.01).unwrap().change, 0);
        // Movement around the ridge between two positions reports no change.
        for way in [0.45, 0.55, 0.49, 0.7, 0.3, 0.74] {
            assert_eq!(positions.take(way * pitch), None, "{way}");
        }
        let place = positions.take(0.76 * pitch).unwrap();
        assert_eq!((place.position, place.change), (1, 1));
        assert!((place.beside + 0.24).abs() < 1e-9);
        // A fast turn over several positions is reported as one change that counts all of them.
        let place = positions.take(7.9 * pitch).unwrap();
        assert_eq!((place.position, place.change), (8, 7));
        // It ends just beyond a ridge; the hand then turns back over that ridge, and nothing changes.
        assert_eq!(positions.take(3.48 * pitch).unwrap().position, 4);
        assert_eq!(positions.take(8.51 * pitch).unwrap().position, 8);
        assert_eq!(positions.take(8.2 * pitch), None);
        // Beyond an end stop the position stays at the last one.
        assert_eq!(positions.take(13.0 * pitch).unwrap().position, 10);
        assert_eq!(positions.take(14.0 * pitch), None);
        assert_eq!(positions.take(-5.0 * pitch).unwrap().position, 0);
    }

    #[test]
    fn a_number_is_given_without_a_move() {
        let mut positions = Positions::of(&dial()).unwrap();
        positions.take(2.0 * positions.pitch_rad);
        positions.call(100);
        assert_eq!(positions.numbers(), Some((98, 108)));
        let place = positions.take(3.0 * positions.pitch_rad).unwrap();
        assert_eq!((place.position, place.change), (101, 1));
    }

    #[test]
    fn many_turns_lose_none() {
        let mut positions = Positions::every(0.1, 0.03);
        let (mut sum, mut seen) = (0, 0);
        for step in 0..200_000_i64 {
            if let Some(place) = positions.take(0.007 * step as f64) {
                sum += place.change;
                seen = place.position;
            }
        }
        assert_eq!(sum, seen);
        assert!((seen as f64 * 0.1 + 0.03 - 0.007 * 200_000.0).abs() < 0.1 * (0.5 + HYSTERESIS));
    }

    #[test]
    fn a_profile_draws_to_its_deepest_place() {
        // The profiles are a magnetic detent, a ridge in the middle like a plucked string, and a valley in the middle.
        for (points, place) in [
            (&[0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0][..], 0.0),
            (&[0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0], 0.0),
            (&[0.0, 1.0, 1.0, 1.0, 0.0, -1.0, -1.0, -1.0], 0.5),
        ] {
            assert_eq!(deepest(points), place, "{points:?}");
        }
    }
}
