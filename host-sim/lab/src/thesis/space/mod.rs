//! The thesis' comparison in three degrees of freedom (§5.2): a plane, an inclined plane and a sphere, on a simulated omega.3.
//!
//! A firm hand probes each object, holds, slides along it at 50 mm/s and lets go. The motion between ticks (control periods) is
//! computed exactly, positions are rounded to counts, and forces are limited to those of the motors. [`claims`] compares the
//! thesis' statements with the results.

pub mod claims;
pub mod figures;
pub mod held_out;
pub mod held_out_cause;
mod held_out_draw;
mod mechanism;
mod motion;
mod port_energy;
pub mod pressed;
mod record;
pub mod scene;
mod stepwise;
pub mod surface_feel;
pub mod tuned;
pub mod tuned_wall;
pub mod verdict;

pub use mechanism::{Crossed, Deviation, HeldMechanism, Mechanism, Stopped};
pub use motion::{Phase, ProbingMotion, SLIDE_MM_PER_S};
pub use record::Record;
pub use stepwise::{CellPlant, CellWall, wall};
pub use surface_feel::SurfaceFeel;
pub use touchstone_sim::texture;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use touchstone_control::settings::FilterSettings;
use touchstone_control::space::environment::{Plane, Sphere};
use touchstone_control::space::{Direction, Shape, Spatial, Vector};
use touchstone_control::{Fixed32, LawKind, Position, Reported, Settings, SettingsError, Si};
use touchstone_world::plant::OMEGA3;

use tuned_wall::TunedWall;

/// Control rate of the thesis, Hz (§5).
pub const RATE_HZ: u32 = 1000;
/// Radius of the sphere, mm. The thesis gives no radius; this sphere is in the centre of the workspace, so that a hand can slide
/// around it.
pub const RADIUS_MM: f64 = 30.0;

type N = Fixed32;
/// An object in §5.2 of the thesis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Object {
    /// A plane that contains the first two axes (§5.2.1).
    #[default]
    #[serde(rename = "plane")]
    Horizontal,
    /// A plane whose normal is not parallel to any axis (§5.2.2).
    Inclined,
    /// A ball in the centre of the workspace (§5.2.3).
    Sphere,
}

/// Approach: way in which the force on the hand is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Approach {
    /// A spring along the surface's normal.
    Spring,
    /// A spring with virtual damping, along the normal.
    SpringDamper,
    /// Force bounding approach (FBA), applied to the force vector.
    Bounding,
    /// Enhanced successive force augmentation, applied to each axis separately.
    PerAxis,
    /// Enhanced successive force augmentation, applied along the normal.
    #[default]
    Magnitude,
    /// The shipped wall for the mechanism: tuned, with state estimator and energy guard. The thesis does not have this approach.
    Shipped,
}

/// One cell of the comparison: mechanism, object, stiffness and approach (way to compute the force).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// The mechanism of the run.
    pub mechanism: Mechanism,
    /// The object that the hand touches.
    pub object: Object,
    /// Requested stiffness, N/mm.
    pub k_desired_n_per_mm: f64,
    /// Way in which the force is computed.
    pub approach: Approach,
    /// What is added along the surface's normal.
    pub feel: SurfaceFeel,
}

impl Cell {
    /// The object for readers, with its texture and material.
    #[must_use]
    pub fn touched(&self) -> String {
        let object = self.object.name().to_owned();
        let parts = [
            self.feel.texture_text(),
            self.feel.material_text(self.mechanism),
        ];
        parts
            .into_iter()
            .flatten()
            .fold(object, |text, part| text + ", " + &part)
    }
}

impl Object {
    /// All objects that the hand can touch.
    pub const ALL: [Object; 3] = [Object::Horizontal, Object::Inclined, Object::Sphere];

    /// Name of the object for readers.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Horizontal => "horizontal plane",
            Self::Inclined => "inclined plane",
            Self::Sphere => "sphere",
        }
    }

    /// The object's surface in the laws' unit of length, centimetres.
    #[must_use]
    pub fn shape(self) -> Shape<N> {
        match self {
            Self::Horizontal => Shape::Plane(Plane {
                normal: Direction::along(2, false),
                height: Position::zero(),
            }),
            Self::Inclined => Shape::Plane(Plane {
                normal: Direction::of(place(self.normal().map(|n| 50.0 * n))).unwrap_or_default(),
                height: Position::zero(),
            }),
            Self::Sphere => Shape::Sphere(Sphere {
                centre: Vector::default(),
                radius: position(RADIUS_MM),
            }),
        }
    }

    /// Position at this depth below the probed point of the surface, m.
    #[must_use]
    pub fn at_depth_m(self, depth_m: f64) -> [f64; 3] {
        let radius_m = match self {
            Self::Sphere => 1e-3 * RADIUS_MM,
            Self::Horizontal | Self::Inclined => 0.0,
        };
        self.normal().map(|n| (radius_m - depth_m) * n)
    }

    /// Unit vector out of the object at the probed point.
    #[must_use]
    pub fn normal(self) -> [f64; 3] {
        match self {
            Self::Horizontal => [0.0, 0.0, 1.0],
            // A unit vector with a different component along every axis.
            Self::Inclined => [2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0],
            // No component is zero, and the first one changes its sign during a slide.
            Self::Sphere => [-3.0 / 7.0, 2.0 / 7.0, 6.0 / 7.0],
        }
    }
}

impl Approach {
    /// All approaches (ways to compute the force).
    pub const ALL: [Approach; 6] = [
        Approach::Spring,
        Approach::SpringDamper,
        Approach::Bounding,
        Approach::PerAxis,
        Approach::Magnitude,
        Approach::Shipped,
    ];

    /// Name of the approach (way to compute the force), for readers.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Spring => "spring",
            Self::SpringDamper => "spring-damper",
            Self::Bounding => "force bounding",
            Self::PerAxis => "per axis",
            Self::Magnitude => "magnitude",
            Self::Shipped => "shipped",
        }
    }

    fn law(self) -> LawKind {
        match self {
            Self::Spring => LawKind::Spring,
            Self::SpringDamper => LawKind::SpringDamper,
            Self::Bounding => LawKind::Fba,
            Self::PerAxis | Self::Magnitude | Self::Shipped => LawKind::EnhancedSfa,
        }
    }
}

/// Stiffness of the shipped wall for a mechanism, N/mm: the one for which it was tuned.
#[must_use]
pub fn shipped_n_per_mm(mechanism: Mechanism) -> f64 {
    1e-3 * TunedWall::of(mechanism, RATE_HZ).k_desired_n_per_m
}

/// All cells of a mechanism: the thesis' approaches at two stiffnesses, and the shipped wall at its own stiffness.
#[must_use]
pub fn cells(mechanism: Mechanism) -> Vec<Cell> {
    let mut cells = Vec::new();
    for object in Object::ALL {
        let mut add = |approach, k_desired_n_per_mm| {
            cells.push(Cell {
                mechanism,
                object,
                k_desired_n_per_mm,
                approach,
                feel: SurfaceFeel::default(),
            });
        };
        for k_desired_n_per_mm in mechanism.stiffnesses_n_per_mm() {
            for approach in Approach::ALL {
                if approach != Approach::Shipped {
                    add(approach, k_desired_n_per_mm);
                }
            }
        }
        add(Approach::Shipped, shipped_n_per_mm(mechanism));
    }
    cells
}

/// Settings of a control law for the omega.3, in SI units. They have the same ratios to the critical stiffness (largest stable
/// stiffness of a plain spring) as the settings for the knob. The critical stiffness of the omega.3 is 5 N/mm (§5.2).
#[must_use]
pub fn settings(law: LawKind, k_desired_n_per_mm: f64) -> Settings {
    let si = Si::from_num::<f64>;
    Settings {
        law,
        rate_hz: RATE_HZ,
        k_desired: si(1e3 * k_desired_n_per_mm),
        // As for the knob, 0.8 of the critical stiffness.
        k_soft: si(4000.0),
        device_damping: si(2.5),
        // 0.4 of the damping that the law assumes; the thesis' enhanced law has no damper.
        virtual_damping: if law == LawKind::SpringDamper {
            si(1.0)
        } else {
            Si::ZERO
        },
        force_limit: si(OMEGA3.force_n),
        // Four times the energy that a press of 6 N stores in the coupling k_f.
        energy_credit: si(0.0144),
        filter: FilterSettings {
            // The stiffness is the critical one. Mass and damping to ground let the virtual mass follow the hand with a time
            // constant of 12 ms, as for the knob.
            mass: si(0.015),
            stiffness: si(5000.0),
            damping: Si::ZERO,
            ground_damping: si(50.0),
        },
        ..Settings::thesis()
    }
}

/// Converts a length in mm to the laws' unit, centimetres.
fn position(mm: f64) -> Position<N> {
    Position(N::signal_from_f64(mm / 10.0))
}

fn place(mm: [f64; 3]) -> Vector<Position<N>> {
    Vector(mm.map(position))
}

/// Settings of a control law for a mechanism, in SI units.
///
/// The critical stiffness is proportional to the mechanism's damping. The law's stiffnesses, dampings and masses are proportional
/// to the critical stiffness, and the press is proportional to the mechanism's force.
#[must_use]
pub fn settings_for(mechanism: Mechanism, law: LawKind, k_desired_n_per_mm: f64) -> Settings {
    let omega = settings(law, k_desired_n_per_mm);
    if mechanism == Mechanism::Cartesian {
        return omega;
    }
    let share = mechanism.damping() / Mechanism::Cartesian.damping();
    let push = mechanism.push_n() / Mechanism::Cartesian.push_n();
    let times = |value: Si, by: f64| Si::from_num(value.to_num::<f64>() * by);
    let filter = omega.filter;
    Settings {
        k_soft: times(omega.k_soft, share),
        device_damping: times(omega.device_damping, share),
        virtual_damping: times(omega.virtual_damping, share),
        force_limit: Si::from_num(mechanism.force_n()),
        // In proportion to the energy that a press stores in the coupling k_f.
        energy_credit: times(omega.energy_credit, push * push / share),
        filter: FilterSettings {
            mass: times(filter.mass, share),
            stiffness: times(filter.stiffness, share),
            damping: times(filter.damping, share),
            ground_damping: times(filter.ground_damping, share),
        },
        ..omega
    }
}

/// Simulates one cell. If the mechanism cannot reach a position, the record ends there.
///
/// # Errors
/// The control law does not accept its settings; it accepts those of [`settings`].
pub fn run(cell: &Cell) -> Result<Record, SettingsError> {
    let mut wall = CellWall::new(cell)?;
    let mut record = Record::new(*cell);
    record.stopped = played(cell, &mut wall, &mut record).is_err();
    Ok(record)
}

fn played(cell: &Cell, wall: &mut CellWall, record: &mut Record) -> Result<(), Stopped> {
    let mut plant = CellPlant::new(cell)?;
    let (mut stored, mut loss, mut work) = (None, 0.0, 0.0);
    for _ in 0..plant.motion().ticks() {
        let time_s = plant.time_s();
        let hip_m = plant.held().place_m();
        let force_n = wall.tick(plant.measured_m()?);
        let rest_m = plant.rest_m();
        let before = plant.held().stored_j(rest_m)?;
        let jump = stored.map_or(0.0, |was| before - was);
        let crossed = plant.step(force_n, [0.0; 3])?;
        record.keep(
            time_s,
            plant.motion().phase(time_s),
            hip_m.map(|x| x * 1e3),
            crossed.force_n,
        );
        record.energy.add(crossed.motors_j, crossed.loss.device_j);
        loss += crossed.loss.total_j();
        work += jump + crossed.motors_j;
        let start = *record.start_energy_j.get_or_insert(before);
        let after = plant.held().stored_j(rest_m)?;
        record.audit_j = record.audit_j.max((after - start + loss - work).abs());
        stored = Some(after);
    }
    Ok(())
}

/// Simulates all cells on all cores; returns the records in the order of the cells. Calls `done` after each cell.
///
/// # Errors
/// The errors of [`run`].
pub fn run_all(cells: &[Cell], done: impl Fn() + Sync) -> Result<Vec<Record>, SettingsError> {
    cells
        .par_iter()
        .map(|cell| {
            let record = run(cell);
            done();
            record
        })
        .collect()
}

/// Checks at compile time that the resolution of the number format is `2^-24` of its unit, which is a centimetre here.
const _: () = assert!(N::ONE.to_bits() == 1 << 24);
