//! The environment: what the knob renders beside the wall in the device's settings, on boards with room for it. It can have further
//! walls, end stops, detents, a torque profile, and the [further parts](super::parts) of a feel; one energy guard limits the sum of
//! their forces. Its fields are those of a scene file's `[environment]`.
//!
//! The environment is not a part of [`DeviceSettings`], because it may change while the knob is armed and because small boards have
//! none.

use super::parts::Parts;
use super::{Decimal, DeviceSettings, Reason, SettingsError, fields, refused};
use heapless::Vec;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use touchstone_control as law;
use touchstone_control::environment::{
    DetentSettings, Environment, Extent, Face, MOST_POINTS, MOST_WALLS, ProfileSettings, Refused,
    Shape, Side, Spacing, WallSettings,
};
use touchstone_control::{Fixed32, Force, Si};

/// Longest environment (walls, end stops, detents) on the serial link, in bytes (a test checks it).
pub const ENVIRONMENT_MAX: usize = 616;

/// The environment: whether the wall in the device's settings is rendered, and which walls, detents and profile are rendered beside
/// it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Surround {
    /// Whether the wall of the device's settings is rendered.
    pub first_wall: bool,
    /// The second, third and fourth wall, if they exist.
    pub further: [Option<WallBeside>; 3],
    /// Walls at both ends of the knob's travel.
    pub endstops: Option<TravelEnds>,
    /// Positions to which a torque draws the knob, evenly around a turn.
    pub detents: Option<DetentsBeside>,
    /// How fast the force changes to that of a new environment while the knob is armed, N·m/s.
    pub change_n_m_per_s: Decimal,
    /// A torque profile: a torque drawn over the angle.
    pub profile: Option<ProfileBeside>,
    /// A spring to a centre, viscous and dry friction, a click, and an added inertia.
    pub parts: Parts,
}

/// A further wall, beside the one in the device's settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct WallBeside {
    /// Position of the wall's surface, rad.
    pub at_rad: Decimal,
    /// Whether the wall is solid below its surface; otherwise it is solid above.
    pub below: bool,
    /// The wall's stiffness, N·m/rad; `None` means that of the wall in the device's settings.
    pub stiffness_n_m_per_rad: Option<Decimal>,
}

/// Walls at both ends of the knob's travel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct TravelEnds {
    /// Position of the lower end, rad; the wall is solid below it.
    pub lower_rad: Decimal,
    /// Position of the upper end, rad; the wall is solid above it.
    pub upper_rad: Decimal,
    /// Stiffness of the walls at both ends, N·m/rad; `None` means that of the wall in the device's settings.
    pub stiffness_n_m_per_rad: Option<Decimal>,
}

/// Detents: positions at equal distances to which a torque draws the knob.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct DetentsBeside {
    /// Number of detents in a turn. If it is 0, `pitch_rad` gives the distance of the detents.
    pub per_rev: u16,
    /// Distance between two detents if `per_rev` is 0, rad.
    pub pitch_rad: Decimal,
    /// Largest torque of a detent, N·m.
    pub strength_n_m: Decimal,
    /// Position of one of the detents, rad.
    pub centre_rad: Decimal,
}

/// A torque profile: a torque drawn over the angle, with straight lines between points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProfileBeside {
    /// Number of copies of the profile in a turn. If it is 0, the profile exists once, from `start_rad` to `end_rad`.
    pub per_rev: u16,
    /// Position of the first point, rad.
    pub start_rad: Decimal,
    /// Position of the last point, rad, for a profile that exists once.
    pub end_rad: Decimal,
    /// Torque of a point with the value 10,000, N·m.
    pub strength_n_m: Decimal,
    /// The points of the profile, in units of 1/10,000 of `strength_n_m`.
    pub shape: Points,
}

/// The points of a torque profile: on the wire a sequence of 2 to 96 numbers from -10,000 to 10,000.
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

/// The time from which an accepted environment (walls, end stops, detents) applies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum CountsFrom {
    /// The environment applies from the next control tick, because the device is armed.
    NextTick,
    /// The environment applies from the next time the device is armed.
    Arming,
    /// The environment applies from the next calibration on. It was checked against changed settings, which apply from then on too.
    Calibration,
}

/// Paths of the settings for position and stiffness of each of the six possible walls, in the order of [`Surround::walls`].
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

/// Smallest and largest allowed rate of change of the force, N·m/s. At the smallest rate, a force of 1 N·m fades in 100 s.
const CHANGE: (Si, Si) = (Si::lit("0.01"), Si::lit("100"));

impl Default for Surround {
    /// An environment with the wall in the device's settings and nothing else.
    fn default() -> Self {
        Self {
            first_wall: true,
            further: [None; 3],
            endstops: None,
            detents: None,
            change_n_m_per_s: Decimal(const { Si::lit("0.5") }),
            profile: None,
            parts: Parts::default(),
        }
    }
}

impl Surround {
    /// Whether the environment differs from the single wall in the device's settings.
    #[must_use]
    pub fn is_more_than_the_wall(&self) -> bool {
        !self.first_wall
            || self.endstops.is_some()
            || self.detents.is_some()
            || self.profile.is_some()
            || self.parts != Parts::default()
            || self.further.iter().any(Option::is_some)
    }

    /// The wall in the device's settings, which is solid above its surface.
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

    /// The six possible walls in a fixed order: the wall in the device's settings, three further ones, lower and upper end. `None`
    /// for a wall that does not exist.
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

    /// All walls that exist. The wall in the device's settings, if rendered, comes first.
    #[must_use]
    pub fn walls(&self, settings: &DeviceSettings) -> Vec<WallSettings, MOST_WALLS> {
        self.placed(settings).into_iter().flatten().collect()
    }

    /// Checks the environment together with the device's settings, and makes the object that calculates the force in each control
    /// tick.
    ///
    /// # Errors
    /// The first setting that is refused.
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
        let law = settings.law();
        let built = Environment::new(&law, &walls, detents.as_ref()).map_err(refused)?;
        let feel = &self.parts.0;
        if let Some(spring) = feel.spring {
            fields::within("environment.spring.centre_rad", spring.centre, surfaces)?;
        }
        if let Some(click) = feel.click {
            fields::within("environment.click.centre_rad", click.centre, surfaces)?;
        }
        let built = built.with_feel(feel, &law).map_err(refused)?;
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

    /// Checks the environment together with the device's settings.
    ///
    /// # Errors
    /// The first setting that is refused.
    // A separate function, so that the built object leaves the stack when the function ends.
    #[inline(never)]
    pub fn check(&self, settings: &DeviceSettings) -> Result<(), SettingsError> {
        self.built(settings).map(drop)
    }

    /// Largest change of the force in one control tick while this environment (walls, end stops, detents) replaces another.
    #[must_use]
    pub fn change_per_tick(&self, settings: &DeviceSettings) -> Force<Fixed32> {
        Environment::change_per_tick(self.change_n_m_per_s.0, settings.timing.rate_hz)
    }
}

/// Converts a refusal by the control law into an error with the path of the refused setting.
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
        // Only the profile's number per turn can be refused here; that of the detents was checked above.
        Refused::PerTurn(per_turn) => limit(
            "environment.profile.per_rev",
            Si::saturating_from_num(*per_turn),
        ),
        Refused::Pitch(pitch) => limit("environment.detents.per_rev", *pitch),
        Refused::PartOfFormat { path, value } => limit(path, *value),
        Refused::Part {
            path,
            value,
            least,
            most,
        } => SettingsError {
            path,
            value: Decimal(*value),
            reason: Reason::Outside {
                least: Decimal(*least),
                most: Decimal(*most),
            },
        },
        // An environment has no place for a seventh wall, and points are checked when they are read, so neither can be refused
        // here.
        _ => limit("environment", Si::ZERO),
    }
}
