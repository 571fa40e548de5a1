//! The environment beside the wall of `wall`, on boards with room for it: further walls, endstops, detents, a profile, all behind
//! the law's one guard. It is the simulator's `[environment]`, field by field.
//!
//! Not a part of [`DeviceSettings`]: it may be changed while the knob is at work, and boards without room for it have
//! none.

use super::{Decimal, DeviceSettings, Reason, SettingsError, fields, refused};
use heapless::Vec;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use touchstone_control as law;
use touchstone_control::environment::{
    DetentSettings, Environment, Extent, Face, MOST_POINTS, MOST_WALLS, ProfileSettings, Refused,
    Shape, Side, Spacing, WallSettings,
};
use touchstone_control::{Fixed32, Force, Si};

/// No environment takes more bytes on the wire (a test).
pub const ENVIRONMENT_MAX: usize = 496;

/// What there is to touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Surround {
    /// Whether the wall of the settings is there itself.
    pub first_wall: bool,
    /// A second to a fourth wall.
    pub further: [Option<WallBeside>; 3],
    /// Both ends of the travel.
    pub endstops: Option<TravelEnds>,
    /// Places that the knob is drawn to.
    pub detents: Option<DetentsBeside>,
    /// How fast a force may change while the environment is changed under a hand, N·m/s.
    pub change_n_m_per_s: Decimal,
    /// A torque drawn over the angle.
    pub profile: Option<ProfileBeside>,
}

/// A [`Surround`] as devices stored it before there were profiles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct WithoutProfile {
    first_wall: bool,
    further: [Option<WallBeside>; 3],
    endstops: Option<TravelEnds>,
    detents: Option<(u16, Decimal, Decimal)>,
    change_n_m_per_s: Decimal,
}

impl From<WithoutProfile> for Surround {
    fn from(it: WithoutProfile) -> Self {
        Self {
            first_wall: it.first_wall,
            further: it.further,
            endstops: it.endstops,
            detents: it
                .detents
                .map(|(per_rev, strength_n_m, centre_rad)| DetentsBeside {
                    per_rev,
                    pitch_rad: Decimal(Si::ZERO),
                    strength_n_m,
                    centre_rad,
                }),
            change_n_m_per_s: it.change_n_m_per_s,
            profile: None,
        }
    }
}

/// A wall beside the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct WallBeside {
    /// Position of the wall's surface, rad.
    pub at_rad: Decimal,
    /// Whether it is solid below its surface, else above.
    pub below: bool,
    /// The wall's stiffness, N·m/rad; none: that of the first wall.
    pub stiffness_n_m_per_rad: Option<Decimal>,
}

/// Walls at both ends of the travel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct TravelEnds {
    /// The lower end, rad: solid below it.
    pub lower_rad: Decimal,
    /// The upper end, rad: solid above it.
    pub upper_rad: Decimal,
    /// Their stiffness, N·m/rad; none: that of the first wall.
    pub stiffness_n_m_per_rad: Option<Decimal>,
}

/// Detents at equal distances.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct DetentsBeside {
    /// How many in a turn; 0: `pitch_rad` apart.
    pub per_rev: u16,
    /// Distance between two detents where `per_rev` is 0, rad.
    pub pitch_rad: Decimal,
    /// The largest torque, N·m.
    pub strength_n_m: Decimal,
    /// Position of one of the detents, rad.
    pub centre_rad: Decimal,
}

/// A torque drawn over the angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProfileBeside {
    /// Copies in a turn; 0: once, from `start_rad` to `end_rad`.
    pub per_rev: u16,
    /// Position of the first point, rad.
    pub start_rad: Decimal,
    /// Position of the last point of a profile that is there once, rad.
    pub end_rad: Decimal,
    /// The torque of a point of 1, N·m.
    pub strength_n_m: Decimal,
    /// The points.
    pub shape: Points,
}

/// The points of a profile: on the wire a sequence of 2 to 64 numbers from -10,000 to 10,000.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Points(pub Shape);

impl Serialize for Points {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.points())
    }
}

impl<'de> Deserialize<'de> for Points {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let points = Vec::<i16, MOST_POINTS>::deserialize(deserializer)?;
        Shape::new(&points)
            .map(Self)
            .map_err(serde::de::Error::custom)
    }
}

impl ProfileBeside {
    const fn settings(&self) -> ProfileSettings {
        ProfileSettings {
            extent: match self.per_rev {
                0 => Extent::Until(self.end_rad.0),
                per_rev => Extent::PerTurn(per_rev),
            },
            start: self.start_rad.0,
            strength: self.strength_n_m.0,
            shape: self.shape.0,
        }
    }
}

/// The time from which an accepted environment applies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum CountsFrom {
    /// The device is armed: from its next tick on.
    NextTick,
    /// It applies from the next arming on.
    Arming,
    /// Settings that it was checked with wait for a calibration: from that on.
    Calibration,
}

/// The paths of the walls' positions and stiffnesses, in the order of [`Surround::walls`] when all are given.
const PLACES: [[&str; 2]; 6] = [
    ["wall.surface_rad", "wall.k_desired_n_m_per_rad"],
    [
        "environment.wall2.at_rad",
        "environment.wall2.stiffness_n_m_per_rad",
    ],
    [
        "environment.wall3.at_rad",
        "environment.wall3.stiffness_n_m_per_rad",
    ],
    [
        "environment.wall4.at_rad",
        "environment.wall4.stiffness_n_m_per_rad",
    ],
    [
        "environment.endstops.lower_rad",
        "environment.endstops.stiffness_n_m_per_rad",
    ],
    [
        "environment.endstops.upper_rad",
        "environment.endstops.stiffness_n_m_per_rad",
    ],
];

const STRENGTH: &str = "environment.detents.strength_n_m";
const PROFILE_STRENGTH: &str = "environment.profile.strength_n_m";
const PROFILE_END: &str = "environment.profile.end_rad";

/// How fast a force may change, N·m/s: the slowest lets go of the largest force in some minutes.
const CHANGE: (Si, Si) = (Si::lit("0.01"), Si::lit("100"));

impl Default for Surround {
    /// An environment with one wall and nothing else.
    fn default() -> Self {
        Self {
            first_wall: true,
            further: [None; 3],
            endstops: None,
            detents: None,
            change_n_m_per_s: Decimal(const { Si::lit("0.5") }),
            profile: None,
        }
    }
}

impl Surround {
    /// Whether there is anything that the wall alone is not.
    #[must_use]
    pub fn is_more_than_the_wall(&self) -> bool {
        !self.first_wall
            || self.endstops.is_some()
            || self.detents.is_some()
            || self.profile.is_some()
            || self.further.iter().any(Option::is_some)
    }

    /// The settings' own wall.
    #[must_use]
    pub const fn first(settings: &DeviceSettings) -> WallSettings {
        WallSettings {
            face: Face {
                surface: settings.wall.surface_rad,
                side: Side::Above,
            },
            k_desired: settings.wall.k_desired_n_m_per_rad,
        }
    }

    /// Every wall, by its place among the six that there can be.
    fn placed(&self, settings: &DeviceSettings) -> [Option<WallSettings>; MOST_WALLS] {
        let own = &settings.wall;
        let wall = |surface, below, stiffness: Option<Decimal>| WallSettings {
            face: Face {
                surface,
                side: if below { Side::Below } else { Side::Above },
            },
            k_desired: stiffness.map_or(own.k_desired_n_m_per_rad, |stiffness| stiffness.0),
        };
        let [second, third, fourth] = self
            .further
            .map(|further| further.map(|it| wall(it.at_rad.0, it.below, it.stiffness_n_m_per_rad)));
        let end = |below| {
            let ends = self.endstops?;
            let at = if below {
                ends.lower_rad
            } else {
                ends.upper_rad
            };
            Some(wall(at.0, below, ends.stiffness_n_m_per_rad))
        };
        let first = self.first_wall.then(|| Self::first(settings));
        [first, second, third, fourth, end(true), end(false)]
    }

    /// Every wall, the first one first.
    #[must_use]
    pub fn walls(&self, settings: &DeviceSettings) -> Vec<WallSettings, MOST_WALLS> {
        self.placed(settings).into_iter().flatten().collect()
    }

    /// Checks the environment with the settings that it stands beside, and builds what a control tick runs.
    ///
    /// # Errors
    /// The setting that is refused.
    #[cold]
    #[inline(never)]
    pub fn built(&self, settings: &DeviceSettings) -> Result<Environment<Fixed32>, SettingsError> {
        fields::within(
            "environment.change_n_m_per_s",
            self.change_n_m_per_s.0,
            CHANGE,
        )?;
        let placed = self.placed(settings);
        let surfaces = const { fields::range("wall.surface_rad") };
        let stiffnesses = const { fields::range("wall.k_desired_n_m_per_rad") };
        for (wall, [place, stiffness]) in placed.iter().zip(PLACES) {
            if let Some(wall) = wall {
                fields::within(place, wall.face.surface, surfaces)?;
                fields::within(stiffness, wall.k_desired, stiffnesses)?;
            }
        }
        if let Some(ends) = self.endstops {
            let above = (ends.lower_rad.0.saturating_add(Si::DELTA), surfaces.1);
            fields::within("environment.endstops.upper_rad", ends.upper_rad.0, above)?;
        }
        let detents = match self.detents {
            None => None,
            Some(ring) => {
                let spacing = match ring.per_rev {
                    0 => {
                        let pitches = const { (Si::lit("0.001"), Si::lit("6.2831853072")) };
                        fields::within("environment.detents.pitch_rad", ring.pitch_rad.0, pitches)?;
                        Spacing::Pitch(ring.pitch_rad.0)
                    }
                    per_rev => {
                        let most = const { Si::lit("6283") };
                        let count = Si::saturating_from_num(per_rev);
                        fields::within("environment.detents.per_rev", count, (Si::ONE, most))?;
                        Spacing::PerTurn(per_rev)
                    }
                };
                let (strength, centre) = (ring.strength_n_m.0, ring.centre_rad.0);
                fields::within("environment.detents.centre_rad", centre, surfaces)?;
                let limit = settings.law.force_limit_n_m;
                fields::within(STRENGTH, strength, (Si::ZERO, limit))?;
                Some(DetentSettings {
                    spacing,
                    strength,
                    centre,
                })
            }
        };
        let walls: Vec<WallSettings, MOST_WALLS> = placed.into_iter().flatten().collect();
        let limit = settings.law.force_limit_n_m;
        let refused = |error| why(&error, &placed);
        let built = Environment::new(&settings.law(), &walls, detents.as_ref()).map_err(refused)?;
        let Some(profile) = &self.profile else {
            return Ok(built);
        };
        let (start, end) = (profile.start_rad.0, profile.end_rad.0);
        fields::within("environment.profile.start_rad", start, surfaces)?;
        fields::within(PROFILE_END, end, surfaces)?;
        fields::within(PROFILE_STRENGTH, profile.strength_n_m.0, (Si::ZERO, limit))?;
        built
            .with_profile(&profile.settings(), limit)
            .map_err(refused)
    }

    /// Checks the environment with the settings that it stands beside.
    ///
    /// # Errors
    /// The setting that is refused.
    // What is built for it is gone from the stack with it.
    #[inline(never)]
    pub fn check(&self, settings: &DeviceSettings) -> Result<(), SettingsError> {
        self.built(settings).map(drop)
    }

    /// By how much a force may change in a tick while this takes the place of another.
    #[must_use]
    pub fn change_per_tick(&self, settings: &DeviceSettings) -> Force<Fixed32> {
        Environment::change_per_tick(self.change_n_m_per_s.0, settings.timing.rate_hz)
    }
}

/// Names the path of the setting that the law refused.
fn why(error: &Refused, placed: &[Option<WallSettings>; MOST_WALLS]) -> SettingsError {
    let limit = |path, value| SettingsError {
        path,
        value: Decimal(value),
        reason: Reason::OutOfFormat,
    };
    match error {
        Refused::Wall(place, error) => {
            let own = refused(error);
            let mut there = PLACES.iter().zip(placed).filter(|(_, wall)| wall.is_some());
            match there.nth(usize::from(*place)) {
                Some(([_, stiffness], _)) if error.at(law::Field::KDesired) => SettingsError {
                    path: stiffness,
                    ..own
                },
                _ => own,
            }
        }
        Refused::Law(error) => refused(error),
        Refused::Strength { strength, .. } => limit(STRENGTH, *strength),
        Refused::ProfileStrength { strength, .. } => limit(PROFILE_STRENGTH, *strength),
        Refused::Length(length) => limit(PROFILE_END, *length),
        // Those of detents have been looked at.
        Refused::PerTurn(per_turn) => limit(
            "environment.profile.per_rev",
            Si::saturating_from_num(*per_turn),
        ),
        Refused::Pitch(pitch) => limit("environment.detents.per_rev", *pitch),
        // There is no place for a seventh wall, and points are looked at when they are read.
        Refused::TooManyWalls | Refused::Points(_) | Refused::Point(_) => {
            limit("environment", Si::ZERO)
        }
    }
}
