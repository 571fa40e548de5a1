//! Uses every part of this crate that firmware uses. Sets up each control law from settings, in the 32-bit and in the 16-bit number
//! format, and runs it tick by tick (a tick is one control period).
//!
//! The example is a library, so that it builds without an operating system. `cargo xtask float-free` checks that the compiled code
//! has no floating-point operations.
#![no_std]

use touchstone_control::environment::{
    Counted, DetentSettings, Environment, Refused, WallSettings,
};
use touchstone_control::law::View;
use touchstone_control::observer::{ExactObserver, ThesisObserver};
use touchstone_control::{
    Controller, CountScale, Device, Energy, Fixed16, Fixed32, Force, OwnForce, Position, Settings,
    SettingsError, Stiffness,
};

/// Validates settings and computes the coefficients of the control law that they choose.
///
/// # Errors
/// Same as [`Controller::new`].
#[inline(never)]
pub fn set_up(settings: &Settings) -> Result<Controller<Fixed32>, SettingsError> {
    Controller::new(settings)
}

/// Same as [`set_up`], in the 16-bit number format.
///
/// # Errors
/// Same as [`Controller::new`].
#[inline(never)]
pub fn set_up_16(settings: &Settings) -> Result<Controller<Fixed16>, SettingsError> {
    Controller::new(settings)
}

/// Makes estimator, limit and guard around a user-defined force.
///
/// # Errors
/// Same as [`Device::own_force`].
#[inline(never)]
pub fn own_force(device: &Device) -> Result<OwnForce<Fixed32>, SettingsError> {
    device.own_force()
}

/// Runs one control period with a spring as the user-defined force.
#[inline(never)]
pub fn own_tick(
    own: &mut OwnForce<Fixed32>,
    x: Position<Fixed32>,
    spring: Stiffness<Fixed32>,
) -> Force<Fixed32> {
    own.tick(x, |now| (spring * now.e).towards_zero())
}

/// Returns the number of warnings about the settings, for example about passivity bounds that they exceed.
#[inline(never)]
pub fn bounds_left(settings: &Settings) -> usize {
    settings.warnings().count()
}

/// Converts an encoder count to the penetration into the wall.
#[inline(never)]
pub fn penetration(scale: &CountScale, count: i64) -> Position<Fixed32> {
    scale.penetration(count)
}

/// Runs one control period in 32 bits: takes the penetration, returns the force.
#[inline(never)]
pub fn tick(wall: &mut Controller<Fixed32>, e: Position<Fixed32>) -> Force<Fixed32> {
    wall.tick(e)
}

/// Runs one control period in 16 bits: takes the penetration, returns the force.
#[inline(never)]
pub fn tick_16(wall: &mut Controller<Fixed16>, e: Position<Fixed16>) -> Force<Fixed16> {
    wall.tick(e)
}

/// Returns the control law's internal values (energy, offset, phase of the contact) for telemetry.
#[inline(never)]
pub fn view(wall: &Controller<Fixed32>) -> View<Fixed32> {
    wall.view()
}

/// Makes an environment of walls and detents whose forces pass one energy guard.
///
/// # Errors
/// Same as [`Environment::new`].
#[inline(never)]
pub fn surround(
    settings: &Settings,
    walls: &[WallSettings],
    detents: Option<&DetentSettings>,
) -> Result<Environment<Fixed32>, Refused> {
    Environment::new(settings, walls, detents)
}

/// Runs one control period of an environment: takes the encoder's count, returns the force.
#[inline(never)]
pub fn surrounded_tick(
    environment: &mut Environment<Fixed32>,
    at: &Counted,
    since_change: Option<Position<Fixed32>>,
) -> Force<Fixed32> {
    environment.tick(at, since_change)
}

/// Runs two energy observers for one control period, without a control law: the exact one and that of the thesis. Each sums the
/// energy that a force takes from the hand.
#[inline(never)]
pub fn observe(
    exact: &mut ExactObserver<Fixed32>,
    thesis: &mut ThesisObserver<Fixed32>,
    e: Position<Fixed32>,
    f: Force<Fixed32>,
) -> (Energy<Fixed32>, Energy<Fixed32>) {
    (exact.tick(e, f), thesis.tick(e, f))
}
