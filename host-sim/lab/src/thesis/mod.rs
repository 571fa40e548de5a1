//! The thesis' comparison in one degree of freedom (§5.1), as the main job: four stiffnesses, five laws, one knob.
//!
//! The comparison itself (medium grip, 40,000 counts) keeps its traces for the plots; the same matrix for the other grips and
//! for a 14-bit encoder, and the row beyond the thesis at 20 `k_c`, run beside it for their numbers. [`claims`] then holds
//! each statement of the thesis against them.

pub mod claims;
pub mod space;

use rayon::prelude::*;
use touchstone_control::{LawKind, ObserverForm};
use touchstone_sim::error::Result;
use touchstone_sim::run::{self, record::Run};
use touchstone_sim::scene::{Grip, Scene};

/// Desired stiffnesses of §5.1, N·m/rad.
pub const STIFFNESSES: [f64; 4] = [0.5, 1.0, 2.5, 5.0];
/// Beyond the thesis: twenty times its critical stiffness, N·m/rad.
pub const BEYOND: f64 = 20.0;
/// Laws of §5.1, in its order.
pub const LAWS: [LawKind; 5] = [
    LawKind::Spring,
    LawKind::Tdpa,
    LawKind::Fba,
    LawKind::Sfa,
    LawKind::EnhancedSfa,
];
/// Grips, the thesis' first.
pub const GRIPS: [Grip; 3] = [Grip::Medium, Grip::Light, Grip::Firm];
/// Encoders, the finer one first.
pub const COUNTS: [u32; 2] = [40_000, 16_384];

/// Fields and tables of the base scene that every [`cell`] replaces, so that a change of them would be lost; each with
/// the values that it gets.
pub const REPLACED: [(&str, &str); 5] = [
    ("wall.k_desired_n_m_per_rad", "stiffnesses"),
    ("law.kind", "laws"),
    ("operator.grip", "grips"),
    ("operator.hand", "grips"),
    ("encoder", "encoders"),
];

/// A note for people on the field that a [`cell`] replaces for one law.
pub const TDPA_OBSERVES: &str = "TDPA runs with the thesis' observer, as it was published, whatever law.observer says; \
                                 the enhanced law runs with law.observer";

/// One cell of the comparison.
#[derive(Debug, Clone)]
pub struct Cell {
    /// The scene.
    pub scene: Scene,
    /// Whether its trace is kept for the plots.
    pub plotted: bool,
}

/// The scene of one cell: `base` with stiffness, law, grip and encoder.
///
/// [`TDPA_OBSERVES`], since the comparison is with the thesis' TDPA; every other choice is the scene's.
///
/// # Errors
/// A base scene that cannot have one of them.
pub fn cell(base: &Scene, k_desired: f64, law: LawKind, grip: Grip, counts: u32) -> Result<Scene> {
    base.with(|scene| {
        scene.wall.k_desired_n_m_per_rad = k_desired;
        scene.law.kind = law;
        scene.operator.grip = grip;
        scene.operator.hand = None;
        scene.encoder.get_or_insert_default().counts_per_rev = f64::from(counts);
        if law == LawKind::Tdpa {
            scene.law.observer = ObserverForm::Thesis;
        }
    })
}

/// All cells: the plotted comparison first, then the other grips and encoder, then the row beyond the thesis.
///
/// # Errors
/// Same as [`cell`].
pub fn cells(base: &Scene) -> Result<Vec<Cell>> {
    let mut cells = Vec::new();
    for counts in COUNTS {
        for grip in GRIPS {
            let plotted = counts == COUNTS[0] && grip == GRIPS[0];
            for k_desired in STIFFNESSES.into_iter().chain([BEYOND]) {
                for law in LAWS {
                    // Beyond the thesis only the enhanced law has something to show.
                    if k_desired != BEYOND || law == LawKind::EnhancedSfa {
                        cells.push(Cell {
                            scene: cell(base, k_desired, law, grip, counts)?,
                            plotted,
                        });
                    }
                }
            }
        }
    }
    Ok(cells)
}

/// Name of what ships in tables and figures.
pub const SHIPPED: &str = "Shipped";

/// The wall that ships, `base` with all its own settings, at every stiffness, grip and encoder of [`cells`].
///
/// # Errors
/// Same as [`cell`].
pub fn shipped_cells(base: &Scene) -> Result<Vec<Cell>> {
    let mut cells = Vec::new();
    for counts in COUNTS {
        for grip in GRIPS {
            let plotted = counts == COUNTS[0] && grip == GRIPS[0];
            for k_desired in STIFFNESSES.into_iter().chain([BEYOND]) {
                cells.push(Cell {
                    scene: cell(base, k_desired, base.law.kind, grip, counts)?,
                    plotted,
                });
            }
        }
    }
    Ok(cells)
}

/// Runs the cells on all cores, in their order; calls `done` after each.
///
/// # Errors
/// The first cell that cannot run.
pub fn run_all(cells: &[Cell], done: impl Fn() + Sync) -> Result<Vec<Run>> {
    cells
        .par_iter()
        .map(|cell| {
            let run = run::run(&cell.scene, cell.plotted);
            done();
            run
        })
        .collect()
}
