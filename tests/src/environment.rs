//! Walls, detents and an encoder for the tests of environments.

use crate::si::si;
use touchstone_control::environment::{
    Counted, DetentSettings, Environment, Face, Side, Spacing, WallSettings,
};
use touchstone_control::{CountScale, Reported, Settings, Si};

/// Encoder counts per turn.
pub const COUNTS: u32 = 40_000;

/// One encoder count, rad.
pub const COUNT_RAD: f64 = std::f64::consts::TAU / COUNTS as f64;

/// The encoder of the environment tests, with [`COUNTS`] per turn.
///
/// # Panics
/// Never.
#[must_use]
pub fn encoder() -> CountScale {
    CountScale::new(COUNTS, Si::ZERO).unwrap()
}

/// A reading of that encoder at a count.
#[must_use]
pub fn at(count: i64) -> Counted {
    Counted {
        scale: encoder(),
        count,
    }
}

/// Settings of a wall of 5 N·m/rad.
#[must_use]
pub fn wall(surface: &str, side: Side) -> WallSettings {
    WallSettings {
        face: Face {
            surface: si(surface),
            side,
        },
        k_desired: si("5"),
    }
}

/// Settings of the wall's mirror image.
#[must_use]
pub fn mirrored(wall: &WallSettings) -> WallSettings {
    let side = match wall.face.side {
        Side::Above => Side::Below,
        Side::Below => Side::Above,
    };
    let surface = -wall.face.surface;
    WallSettings {
        face: Face { surface, side },
        ..*wall
    }
}

/// Settings of detents, 12 in half a turn; one lies between two encoder counts.
#[must_use]
pub fn detents() -> DetentSettings {
    DetentSettings {
        spacing: Spacing::Pitch(si("0.2617994")),
        strength: si("0.03"),
        centre: si("0.01234567"),
    }
}

/// An environment built from walls and detents.
///
/// # Panics
/// The environment is refused.
#[must_use]
pub fn built<N: Reported>(
    settings: &Settings,
    walls: &[WallSettings],
    detents: Option<&DetentSettings>,
) -> Environment<N> {
    Environment::new(settings, walls, detents).unwrap_or_else(|e| panic!("{e}"))
}
