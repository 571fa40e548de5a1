//! Helpers for tests on three axes: positions in millimetres, forces in newtons, settings for an omega.3 (haptic device with three
//! axes).

use touchstone_control::settings::FilterSettings;
use touchstone_control::space::{Direction, LengthUnit, Vector};
use touchstone_control::{Fixed32, Force, LawKind, Position, Settings, Si};

use crate::si::si;

/// The number format of the tests on three axes.
pub type F = Fixed32;
/// A position or displacement on three axes.
pub type Place = Vector<Position<F>>;
/// A force on three axes.
pub type Push = Vector<Force<F>>;

/// Steps of the position's number format (2^-24 cm) per millimetre.
const QUANTA_PER_MM: f64 = 16_777_216.0 / 10.0;
/// Steps of the force's number format (2^-24 N) per newton.
const QUANTA_PER_N: f64 = 16_777_216.0;

/// Converts a length in mm to the tests' number format.
#[must_use]
pub fn mm(length: f64) -> Position<F> {
    Position(fixed::types::I8F24::from_bits(
        (length * QUANTA_PER_MM).round() as i32,
    ))
}

/// Converts a length from the tests' number format to mm.
#[must_use]
pub fn in_mm(length: Position<F>) -> f64 {
    f64::from(length.0.to_bits()) / QUANTA_PER_MM
}

/// Makes a position from coordinates in mm.
#[must_use]
pub fn at(x: f64, y: f64, z: f64) -> Place {
    Vector([mm(x), mm(y), mm(z)])
}

/// The coordinates of a position, in mm.
#[must_use]
pub fn place_in_mm(place: Place) -> [f64; 3] {
    place.0.map(in_mm)
}

/// Converts a force in N to the tests' number format.
#[must_use]
pub fn newton(force: f64) -> Force<F> {
    Force(fixed::types::I8F24::from_bits(
        (force * QUANTA_PER_N).round() as i32,
    ))
}

/// Converts a force from the tests' number format to N.
#[must_use]
pub fn in_n(force: Force<F>) -> f64 {
    f64::from(force.0.to_bits()) / QUANTA_PER_N
}

/// The components of a force, in N.
#[must_use]
pub fn push_in_n(force: Push) -> [f64; 3] {
    force.0.map(in_n)
}

/// The components of a unit vector as `f64`.
#[must_use]
pub fn numbers(direction: &Direction<F>) -> [f64; 3] {
    direction.0.map(|x| f64::from(x.to_bits()) / 16_777_216.0)
}

/// The unit vector with the direction of (x, y, z).
///
/// # Panics
/// The vector (x, y, z) is zero.
#[must_use]
pub fn direction(x: f64, y: f64, z: f64) -> Direction<F> {
    let longest = x.abs().max(y.abs()).max(z.abs());
    Direction::of(at(
        x / longest * 50.0,
        y / longest * 50.0,
        z / longest * 50.0,
    ))
    .expect("a direction")
}

/// Scalar product of two vectors.
#[must_use]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Length of a vector.
#[must_use]
pub fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// Angle between two directions, rad.
#[must_use]
pub fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let cross = [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ];
    length(cross).atan2(dot(a, b))
}

/// Settings of a control law in SI units for an omega.3 (haptic device with three axes) at 1 kHz. The device's largest stable
/// stiffness is 5 N/mm (§5.2 of the DLR thesis). The enhanced law's virtual mass and coupling are those of the knob, scaled in
/// proportion to this stiffness.
#[must_use]
pub fn omega(law: LawKind, k_desired_n_per_mm: f64) -> Settings {
    Settings {
        law,
        k_desired: Si::from_num(1e3 * k_desired_n_per_mm),
        k_soft: si("4000"),
        device_damping: si("2.5"),
        virtual_damping: if law == LawKind::SpringDamper {
            si("1")
        } else {
            Si::ZERO
        },
        force_limit: si("12"),
        energy_credit: si("0.0144"),
        filter: FilterSettings {
            mass: si("0.015"),
            stiffness: si("5000"),
            damping: si("0"),
            ground_damping: si("50"),
        },
        ..Settings::thesis()
    }
}

/// The unit in which the control laws of these tests measure lengths.
pub const UNIT: LengthUnit = LengthUnit::Centimetre;
