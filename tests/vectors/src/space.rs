//! Test vectors for three axes: a hand with integer coordinates touches a ball of 30 mm radius and a corner, with friction and
//! energy guard. A digest (hash) covers every force.

use crate::digest::{Bits, Digest};
use touchstone_control::settings::FilterSettings;
use touchstone_control::space::environment::{Corner, Plane, Sphere};
use touchstone_control::space::{
    Direction, FrictionSettings, FrictionState, Leaving, LengthUnit, Magnitude, PerAxis, Rule,
    Shape, Shell, SpaceWall, SurfacePoint, Turn, Vector, VectorGuard,
};
use touchstone_control::{
    AnyLaw, EstimatorSettings, Fixed32, Force, GuardSettings, GuardedDevice, LawKind, Position,
    Settings, Si,
};

/// The type of the virtual wall in the three-axis cases.
pub type Wall = SpaceWall<Fixed32, Shape<Fixed32>, AnyLaw<Fixed32>>;

/// Names of the three-axis cases.
pub const SPACE_CASES: [&str; 7] = [
    "space-ball",
    "space-frictionless",
    "space-per-axis",
    "space-restricted",
    "space-corner",
    "space-estimated",
    "space-estimated-frictionless",
];
/// Duration of each three-axis case in control periods.
pub const SPACE_TICKS: u32 = 4000;

/// Converts a length in centimetres, given as text, to the value of a setting.
const fn cm(text: &str) -> Si {
    Si::lit(text)
}

fn place(x: Si, y: Si, z: Si) -> Vector<Position<Fixed32>> {
    Vector([x, y, z].map(|x| Position::from_si(x).unwrap_or_default()))
}

/// Settings of the thesis' control law for an omega.3 (haptic device with three axes), with a desired stiffness of 25 N/mm.
fn settings() -> Settings {
    Settings {
        law: LawKind::EnhancedSfa,
        k_desired: const { Si::lit("25000") },
        k_soft: const { Si::lit("4000") },
        device_damping: const { Si::lit("2.5") },
        force_limit: const { Si::lit("12") },
        energy_credit: const { Si::lit("0.0144") },
        filter: FilterSettings {
            mass: const { Si::lit("0.015") },
            stiffness: const { Si::lit("5000") },
            damping: Si::ZERO,
            ground_damping: const { Si::lit("50") },
        },
        ..Settings::thesis()
    }
}

/// The virtual wall of a three-axis case; `None` if its settings are refused.
#[must_use]
pub fn space_wall(case: &str) -> Option<Wall> {
    let unit = LengthUnit::Centimetre;
    let law = unit.law::<Fixed32>(&settings()).ok()?;
    let shell = match case {
        "space-per-axis" => Shell::PerAxis(PerAxis::new([law; 3], Leaving::Projection)),
        _ => Shell::Magnitude(Magnitude::new(law)),
    };
    let centre = Vector::default();
    let radius = Position::from_si(cm("3"))?;
    let plane = |normal, height| Position::from_si(height).map(|height| Plane { normal, height });
    let shape = if case == "space-corner" {
        let tilted = Direction::of(place(cm("1"), cm("-0.5"), cm("2")))?;
        Shape::Corner(Corner::new([
            plane(Direction::along(0, false), cm("2"))?,
            plane(tilted, cm("2.84"))?,
        ]))
    } else {
        Shape::Sphere(Sphere { centre, radius })
    };
    let rule = match case {
        "space-restricted" => Rule::Restricted(Turn::of_ratio(
            Position::<Fixed32>::from_si(Si::lit("0.00005"))?.0,
        )),
        _ => Rule::Closest,
    };
    let limit = Force::from_si(const { Si::lit("12") })?;
    let mut wall = SpaceWall::new(shape, SurfacePoint::new(rule), shell, limit);
    let friction = FrictionSettings {
        stiffness: const { Si::lit("2500") },
        static_coefficient: const { Si::lit("0.4") },
        kinetic_coefficient: const { Si::lit("0.3") },
    };
    let friction = friction.friction(unit, 1000, const { Si::lit("2") }).ok()?;
    if !case.ends_with("frictionless") {
        wall.friction = Some((friction, FrictionState::default()));
    }
    if case.starts_with("space-estimated") {
        let axis = EstimatorSettings {
            bandwidth_hz: const { Si::lit("62.6") },
            inertia: const { Si::lit("0.148") },
            damping: const { Si::lit("2.5") },
            delay_s: const { Si::lit("0.0005") },
        };
        let axes = [axis; 3];
        wall.estimator = Some(unit.estimator(&axes, 1000, const { Si::lit("12") }).ok()?);
    }
    let (guard, device) = unit.guard(
        &GuardSettings {
            capacity: const { Si::lit("0.02") },
            damping: const { Si::lit("2.5") },
            overspeed: const { Si::lit("1") },
            ..GuardSettings::default()
        },
        &GuardedDevice {
            rate_hz: 1000,
            force_limit: const { Si::lit("12") },
            count: const { Si::lit("0.00001") },
        },
    );
    let guard = VectorGuard::new(&guard, &device).ok()?;
    wall.guard = Some((guard, guard.full()));
    Some(wall)
}

/// A hand that presses and releases while it moves at random. `at` is in quarters of an encoder count of 10 µm.
struct Hand {
    seed: u32,
    at: [i32; 3],
}

impl Hand {
    /// The hand's position in a control period, around the point (2, -1, 2) cm of the ball's surface, rounded to 10 µm.
    fn go(&mut self, tick: u32) -> Vector<Position<Fixed32>> {
        for axis in &mut self.at {
            self.seed = self
                .seed
                .wrapping_mul(1_664_525)
                .wrapping_add(1_013_904_223);
            // Up to half an encoder count (2 quarters) per tick, drawn back to the middle.
            let step = ((self.seed >> 24) as i32 - 128) / 43;
            *axis = axis.wrapping_add(step).wrapping_sub(*axis / 256);
        }
        let beat = (tick % 1000) as i32;
        // In by 75 counts within 200 ticks, rest, out, rest.
        let press = match beat {
            0..200 => beat / 4,
            200..700 => 50,
            700..900 => 50 - (beat - 700) / 4,
            _ => 0,
        };
        let [x, y, z] = self.at;
        let from = [1996 - press, -996 + press / 2, 2010 - press];
        let count = |n: i32| Si::from_num(n) / 1000;
        place(
            count(from[0] + x / 4),
            count(from[1] + y / 4),
            count(from[2] + z / 4),
        )
    }
}

/// Runs a three-axis case; `tick` runs each control period. Returns the digest (hash) of all forces. `None` if the wall's settings
/// are refused, or if the wall pushes in no more than half of the control periods.
pub fn play_space(
    case: &str,
    mut tick: impl FnMut(&mut Wall, Vector<Position<Fixed32>>) -> Vector<Force<Fixed32>>,
) -> Option<u64> {
    let mut wall = space_wall(case)?;
    let mut hand = Hand {
        seed: 7,
        at: [0; 3],
    };
    let mut digest = Digest::default();
    let mut pushing = 0;
    for at in 0..SPACE_TICKS {
        let force = tick(&mut wall, hand.go(at));
        for part in force.0 {
            digest.bytes(&Fixed32::signal_bits(part.0).to_le_bytes());
        }
        pushing += u32::from(force != Vector::default());
    }
    (pushing > SPACE_TICKS / 2).then(|| digest.value())
}
