//! The parts of a feel as C structures, and as settings of the control crate.

use crate::ts_si;
use touchstone_control::Si;
use touchstone_control::environment::profile::Shape;
use touchstone_control::environment::{
    CentreSettings, ClickSettings, DetentSettings, DrySettings, Extent, Face, FeelSettings,
    InertiaSettings, ProfileSettings, Refused, Side, Spacing, ViscousSettings, WallSettings,
};

/// The most walls of a feel.
pub const TS_FEEL_WALLS: usize = 6;
/// The most points of a torque profile.
pub const TS_FEEL_POINTS: usize = 96;

/// A wall; without stiffness there is none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_wall {
    /// Angle of the wall's surface, rad.
    pub surface: ts_si,
    /// Stiffness, N·m/rad.
    pub stiffness: ts_si,
    /// 0: the wall is solid at angles above its surface; 1: below.
    pub solid_below: u32,
}

/// Detents: positions to which the device is drawn; without strength there are none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_detents {
    /// Largest torque, N·m.
    pub strength: ts_si,
    /// Number of detents per turn, 1 to 6283; 0: `pitch` says how far apart they are.
    pub per_turn: u32,
    /// Distance between neighbours, rad, 0.001 to 6.283; used if `per_turn` is 0.
    pub pitch: ts_si,
    /// Angle of one of the detents, rad.
    pub centre: ts_si,
}

/// A spring that draws to a centre; without strength there is none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_spring {
    /// Largest torque, N·m.
    pub strength: ts_si,
    /// Stiffness, N·m/rad, 0 to 100.
    pub stiffness: ts_si,
    /// Angle at which the spring gives no torque, rad.
    pub centre: ts_si,
}

/// Friction in proportion to the speed; without damping there is none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_damper {
    /// Damping, N·m·s/rad. The largest value follows from the inertia and the delay in the settings.
    pub damping: ts_si,
    /// Bandwidth of the low-pass filter for the speed, Hz, 5 to 500.
    pub bandwidth_hz: ts_si,
}

/// Dry friction, of one size at every speed; without strength there is none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_dry_friction {
    /// Torque while the device slides, N·m.
    pub strength: ts_si,
    /// How far the device moves from rest until it slides, rad, 0.001 to 1.
    pub stretch: ts_si,
}

/// A short pulse when the device crosses one of many positions; without strength there is none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_click {
    /// Torque of the pulse, N·m: first against the motion, then as long with it.
    pub strength: ts_si,
    /// Number of clicks per turn, 1 to 6283; 0: `pitch` says how far apart they are.
    pub per_turn: u32,
    /// Distance between neighbours, rad, 0.001 to 6.283; used if `per_turn` is 0.
    pub pitch: ts_si,
    /// One of the angles that click, rad.
    pub centre: ts_si,
    /// Length of the pulse, s, 0.001 to 0.1.
    pub duration: ts_si,
}

/// An added inertia, rendered as a virtual mass that the device drags by a damper; without inertia there is none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_inertia {
    /// The mass, kg·m². The largest value follows from the inertia and the delay in the settings.
    pub inertia: ts_si,
    /// Frequency below which motions feel the mass, Hz, 5 to 30.
    pub bandwidth_hz: ts_si,
}

/// A torque drawn over the angle, by points with straight lines between them; without strength there is none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_profile {
    /// Torque at a point of 10,000, N·m.
    pub strength: ts_si,
    /// Copies of the profile per turn, 1 to 6283; 0: it is there once, from `start` to `end`.
    pub per_turn: u32,
    /// Angle of the first point, rad.
    pub start: ts_si,
    /// Angle of the last point, rad; used if `per_turn` is 0.
    pub end: ts_si,
    /// Number of points, 2 to `TS_FEEL_POINTS`.
    pub count: u32,
    /// The points at equal distances, each from -10,000 to 10,000. A positive one pushes to larger angles.
    pub points: [i16; TS_FEEL_POINTS],
}

/// All parts of a feel. Start from `ts_feel_defaults`, which has no part, and set those that you want.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_config {
    /// Counts of the encoder per turn with all edges counted, at least 1.
    pub counts_per_rev: u32,
    /// Walls, such as end stops.
    pub walls: [ts_feel_wall; TS_FEEL_WALLS],
    /// Detents.
    pub detents: ts_feel_detents,
    /// Spring to a centre.
    pub spring: ts_feel_spring,
    /// Friction in proportion to the speed.
    pub damper: ts_feel_damper,
    /// Dry friction.
    pub dry_friction: ts_feel_dry_friction,
    /// Clicks.
    pub click: ts_feel_click,
    /// Torque profile.
    pub profile: ts_feel_profile,
    /// Added inertia.
    pub inertia: ts_feel_inertia,
}

const NOWHERE: ts_feel_wall = ts_feel_wall {
    surface: 0,
    stiffness: 0,
    solid_below: 0,
};

pub(crate) const EMPTY: ts_feel_config = ts_feel_config {
    counts_per_rev: 0,
    walls: [NOWHERE; TS_FEEL_WALLS],
    detents: ts_feel_detents {
        strength: 0,
        per_turn: 0,
        pitch: 0,
        centre: 0,
    },
    spring: ts_feel_spring {
        strength: 0,
        stiffness: 0,
        centre: 0,
    },
    damper: ts_feel_damper {
        damping: 0,
        bandwidth_hz: 0,
    },
    dry_friction: ts_feel_dry_friction {
        strength: 0,
        stretch: 0,
    },
    click: ts_feel_click {
        strength: 0,
        per_turn: 0,
        pitch: 0,
        centre: 0,
        duration: 0,
    },
    profile: ts_feel_profile {
        strength: 0,
        per_turn: 0,
        start: 0,
        end: 0,
        count: 0,
        points: [0; TS_FEEL_POINTS],
    },
    inertia: ts_feel_inertia {
        inertia: 0,
        bandwidth_hz: 0,
    },
};

/// Converts a number per turn to the control crate's type. A number that is too large becomes `u16::MAX`, which the control crate
/// refuses.
fn per_turn(number: u32) -> u16 {
    u16::try_from(number).unwrap_or(u16::MAX)
}

fn spacing(number: u32, pitch: ts_si) -> Spacing {
    if number == 0 {
        Spacing::Pitch(Si::from_bits(pitch))
    } else {
        Spacing::PerTurn(per_turn(number))
    }
}

impl ts_feel_detents {
    pub(crate) fn settings(&self) -> Option<DetentSettings> {
        (self.strength != 0).then(|| DetentSettings {
            spacing: spacing(self.per_turn, self.pitch),
            strength: Si::from_bits(self.strength),
            centre: Si::from_bits(self.centre),
        })
    }
}

impl ts_feel_profile {
    pub(crate) fn settings(&self) -> Result<Option<ProfileSettings>, Refused> {
        if self.strength == 0 {
            return Ok(None);
        }
        let count = usize::try_from(self.count).unwrap_or(usize::MAX);
        let points = self.points.get(..count).ok_or(Refused::Points(count))?;
        let extent = if self.per_turn == 0 {
            Extent::Until(Si::from_bits(self.end))
        } else {
            Extent::PerTurn(per_turn(self.per_turn))
        };
        Ok(Some(ProfileSettings {
            extent,
            start: Si::from_bits(self.start),
            strength: Si::from_bits(self.strength),
            shape: Shape::new(points)?,
        }))
    }
}

impl ts_feel_config {
    pub(crate) fn parts(&self) -> FeelSettings {
        let si = Si::from_bits;
        let Self {
            spring,
            damper,
            dry_friction,
            click,
            inertia,
            ..
        } = self;
        FeelSettings {
            spring: (spring.strength != 0).then(|| CentreSettings {
                centre: si(spring.centre),
                stiffness: si(spring.stiffness),
                strength: si(spring.strength),
            }),
            viscous: (damper.damping != 0).then(|| ViscousSettings {
                damping: si(damper.damping),
                bandwidth_hz: si(damper.bandwidth_hz),
            }),
            dry: (dry_friction.strength != 0).then(|| DrySettings {
                strength: si(dry_friction.strength),
                stretch: si(dry_friction.stretch),
            }),
            click: (click.strength != 0).then(|| ClickSettings {
                spacing: spacing(click.per_turn, click.pitch),
                centre: si(click.centre),
                strength: si(click.strength),
                duration_s: si(click.duration),
            }),
            inertia: (inertia.inertia != 0).then(|| InertiaSettings {
                inertia: si(inertia.inertia),
                bandwidth_hz: si(inertia.bandwidth_hz),
            }),
        }
    }

    /// The walls that have a stiffness, and their number. The rest of the array is filled with a wall that is not used.
    pub(crate) fn solid(&self) -> ([WallSettings; TS_FEEL_WALLS], usize) {
        let unused = WallSettings {
            face: Face {
                surface: Si::ZERO,
                side: Side::Above,
            },
            k_desired: Si::ZERO,
        };
        let mut walls = [unused; TS_FEEL_WALLS];
        let mut used = 0_usize;
        let solid = self.walls.iter().filter(|wall| wall.stiffness != 0);
        for (place, wall) in walls.iter_mut().zip(solid) {
            let side = match wall.solid_below {
                0 => Side::Above,
                _ => Side::Below,
            };
            *place = WallSettings {
                face: Face {
                    surface: Si::from_bits(wall.surface),
                    side,
                },
                k_desired: Si::from_bits(wall.stiffness),
            };
            used = used.saturating_add(1);
        }
        (walls, used)
    }

    /// Index in this configuration of a wall, given its place among the walls that have a stiffness.
    pub(crate) fn index_of(&self, place: u8) -> usize {
        let mut solid = (0..)
            .zip(&self.walls)
            .filter(|(_, wall)| wall.stiffness != 0);
        solid.nth(usize::from(place)).map_or(0, |(index, _)| index)
    }
}
