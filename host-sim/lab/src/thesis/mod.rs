//! The thesis' comparison in one degree of freedom (§5.1): five control laws at four stiffnesses on one knob.
//!
//! Runs with a medium grip and 40,000 encoder counts keep their traces for plots. Runs with the other grips or a 14-bit encoder
//! are simulated for their numbers only. Both sets include a stiffness beyond the thesis. [`claims`] compares the thesis'
//! statements with the results.

pub mod claims;
pub mod space;

use rayon::prelude::*;
use touchstone_control::{LawKind, ObserverForm};
use touchstone_sim::error::Result;
use touchstone_sim::run::{self, record::Run};
use touchstone_sim::scene::{Grip, Scene};

/// Requested stiffnesses of §5.1 of the thesis, N·m/rad.
pub const STIFFNESSES: [f64; 4] = [0.5, 1.0, 2.5, 5.0];
/// A stiffness beyond the thesis, N·m/rad: twenty times the largest stiffness that sampling allows a plain spring.
pub const BEYOND: f64 = 20.0;
/// Control laws of §5.1 of the thesis, in its order.
pub const LAWS: [LawKind; 5] = [
    LawKind::Spring,
    LawKind::Tdpa,
    LawKind::Fba,
    LawKind::Sfa,
    LawKind::EnhancedSfa,
];
/// Grips of the simulated hand; the grip that matches the thesis comes first.
pub const GRIPS: [Grip; 3] = [Grip::Medium, Grip::Light, Grip::Firm];
/// Encoder counts per turn, the finer encoder first.
pub const COUNTS: [u32; 2] = [40_000, 16_384];

/// Fields and tables of the base scene that every [`cell`] replaces, with the values that they get. A user's change of such a field
/// would have no effect.
pub const REPLACED: [(&str, &str); 5] = [
    ("wall.k_desired_n_m_per_rad", "stiffnesses"),
    ("law.kind", "laws"),
    ("operator.grip", "grips"),
    ("operator.hand", "grips"),
    ("encoder", "encoders"),
];

/// A note for readers: the time-domain passivity approach (TDPA) always runs with the thesis' observer, whatever the scene sets.
pub const TDPA_OBSERVES: &str = "TDPA runs with the thesis' observer, as it was published, whatever law.observer says; \
                                 the enhanced law runs with law.observer";

/// One cell of the comparison: a scene to simulate.
#[derive(Debug, Clone)]
pub struct Cell {
    /// The scene of the cell.
    pub scene: Scene,
    /// Whether the run's trace is kept for plots.
    pub plotted: bool,
}

/// The scene of one cell: `base` with this stiffness, law, grip and encoder.
///
/// The time-domain passivity approach (TDPA) gets the thesis' observer, see [`TDPA_OBSERVES`]; all other settings are those of
/// `base`.
///
/// # Errors
/// The base scene does not accept one of the values.
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

/// All cells of the comparison. The plotted cells come first, then those with other grips and the other encoder. Each of the two
/// parts includes the stiffness beyond the thesis.
///
/// # Errors
/// The errors of [`cell`].
pub fn cells(base: &Scene) -> Result<Vec<Cell>> {
    let mut cells = Vec::new();
    for counts in COUNTS {
        for grip in GRIPS {
            let plotted = counts == COUNTS[0] && grip == GRIPS[0];
            for k_desired in STIFFNESSES.into_iter().chain([BEYOND]) {
                for law in LAWS {
                    // At the stiffness beyond the thesis only the enhanced law is simulated.
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

/// Name of the wall with the shipped law and settings, in tables and figures.
pub const SHIPPED: &str = "Shipped";

/// Cells of the wall with the shipped law and settings: `base` with its own law, at every stiffness, grip and encoder of [`cells`].
///
/// # Errors
/// The errors of [`cell`].
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

/// Simulates the cells on all cores; returns the runs in the order of the cells. Calls `done` after each run.
///
/// # Errors
/// The error of the first cell that cannot run.
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
