//! What firmware uses of this crate, and nothing else: every law in the 32-bit and in the 16-bit format, set up from
//! settings and run tick by tick.
//!
//! It is a library, so that it builds without an operating system; `cargo xtask float-free` looks at the code that the
//! compiler makes of it.
#![no_std]

use touchstone_control::environment::{
    Counted, DetentSettings, Environment, Refused, WallSettings,
};
use touchstone_control::law::View;
use touchstone_control::observer::{ExactObserver, ThesisObserver};
use touchstone_control::{
    Controller, CountScale, Energy, Fixed16, Fixed32, Force, Position, Settings, SettingsError,
};

/// Validates settings and computes a law's coefficients.
///
/// # Errors
/// As [`Controller::new`].
#[inline(never)]
pub fn set_up(settings: &Settings) -> Result<Controller<Fixed32>, SettingsError> {
    Controller::new(settings)
}

/// The same in 16 bits.
///
/// # Errors
/// As [`Controller::new`].
#[inline(never)]
pub fn set_up_16(settings: &Settings) -> Result<Controller<Fixed16>, SettingsError> {
    Controller::new(settings)
}

/// How many passivity bounds the settings violate.
#[inline(never)]
pub fn bounds_left(settings: &Settings) -> usize {
    settings.warnings().count()
}

/// Encoder count to penetration.
#[inline(never)]
pub fn penetration(scale: &CountScale, count: i64) -> Position<Fixed32> {
    scale.penetration(count)
}

/// One control period: penetration to force.
#[inline(never)]
pub fn tick(wall: &mut Controller<Fixed32>, e: Position<Fixed32>) -> Force<Fixed32> {
    wall.tick(e)
}

/// The same in 16 bits.
#[inline(never)]
pub fn tick_16(wall: &mut Controller<Fixed16>, e: Position<Fixed16>) -> Force<Fixed16> {
    wall.tick(e)
}

/// What telemetry shows of a law.
#[inline(never)]
pub fn view(wall: &Controller<Fixed32>) -> View<Fixed32> {
    wall.view()
}

/// Walls and detents behind one guard.
///
/// # Errors
/// As [`Environment::new`].
#[inline(never)]
pub fn surround(
    settings: &Settings,
    walls: &[WallSettings],
    detents: Option<&DetentSettings>,
) -> Result<Environment<Fixed32>, Refused> {
    Environment::new(settings, walls, detents)
}

/// One control period among them: encoder count to force.
#[inline(never)]
pub fn surrounded_tick(
    environment: &mut Environment<Fixed32>,
    at: &Counted,
    since_change: Option<Position<Fixed32>>,
) -> Force<Fixed32> {
    environment.tick(at, since_change)
}

/// Both observers on their own.
#[inline(never)]
pub fn observe(
    exact: &mut ExactObserver<Fixed32>,
    thesis: &mut ThesisObserver<Fixed32>,
    e: Position<Fixed32>,
    f: Force<Fixed32>,
) -> (Energy<Fixed32>, Energy<Fixed32>) {
    (exact.tick(e, f), thesis.tick(e, f))
}
