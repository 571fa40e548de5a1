//! Walls, detents and an encoder that the tests of environments (several walls and detents on one knob) share.

use crate::si::si;
use touchstone_control::environment::{
    Counted, DetentSettings, Environment, Face, FeelSettings, Side, Spacing, WallSettings,
};
use touchstone_control::{CountScale, Reported, Settings, Si};

/// Encoder counts per turn in the tests of environments (several walls and detents on one knob).
pub const COUNTS: u32 = 40_000;

/// One encoder count, rad.
pub const COUNT_RAD: f64 = std::f64::consts::TAU / COUNTS as f64;

/// The scale of the tests' encoder: [`COUNTS`] per turn, angle 0 at count 0.
///
/// # Panics
/// Never.
#[must_use]
pub fn encoder() -> CountScale {
    CountScale::new(COUNTS, Si::ZERO).unwrap()
}

/// The encoder reading at a count of the encoder returned by [`encoder`].
#[must_use]
pub fn at(count: i64) -> Counted {
    Counted {
        scale: encoder(),
        count,
    }
}

/// Settings of a virtual wall of 5 N·m/rad with its surface at `surface` (rad) and solid on `side`.
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

/// Settings of a wall mirrored at angle 0: the surface at the negative angle, solid on the other side.
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

/// Settings of 12 detents in half a turn. The centre of one of them lies between two encoder counts.
#[must_use]
pub fn detents() -> DetentSettings {
    DetentSettings {
        spacing: Spacing::Pitch(si("0.2617994")),
        strength: si("0.03"),
        centre: si("0.01234567"),
    }
}

/// Builds an environment: several walls and, if given, detents on one knob.
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

/// Settings of the thesis without the energy guard, which would change the force of a feel's part.
#[must_use]
pub fn unguarded() -> Settings {
    let mut settings = Settings::thesis();
    settings.guard.on = false;
    settings
}

/// Builds an environment of a feel's parts alone, with the settings [`unguarded`].
///
/// # Panics
/// The feel is refused.
#[must_use]
pub fn feeling<N: Reported>(feel: &FeelSettings) -> Environment<N> {
    let settings = unguarded();
    built::<N>(&settings, &[], None)
        .with_feel(feel, &settings)
        .unwrap_or_else(|e| panic!("{e}"))
}
