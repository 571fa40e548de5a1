//! Measures computing time and error of the number formats: every control law in every format on the same recorded press.

use serde::Serialize;
use touchstone_control::{
    Choice as _, Controller, CountScale, Fixed16, Fixed32, LawKind, Position, Reported, Settings,
    Si,
};
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::run::tick::{Recorder, Tick};
use touchstone_sim::scene::{Preset, Scene};

use super::board;
use super::clock::{Spread, Work, race};

/// Counts per turn of the encoder with which the press was recorded.
pub const COUNTS_PER_REV: u32 = 40_000;

/// Results of one control law in one number format.
#[derive(Debug, Clone, Serialize)]
pub struct LawPoint {
    /// Name of the control law. `shipped` is enhanced successive force augmentation with state estimator and energy guard; the
    /// other laws have neither.
    pub law: &'static str,
    /// Name of the number format, for example `fixed32`.
    pub number: &'static str,
    /// Reason why there are no results: the format cannot hold the law's settings.
    pub refused: Option<String>,
    /// Largest difference of the force from that of the same law in `f64`, N·m.
    pub force_error_n_m: Option<f64>,
    /// Root mean square of the force's difference from that of the law in `f64`, N·m.
    pub force_error_rms_n_m: Option<f64>,
    /// Largest difference of the energy that the wall has absorbed since the start from that of the same law in `f64`, J.
    pub energy_error_j: Option<f64>,
    /// Largest change of the force, N·m, when the law in `f64` receives positions larger by one part in 10^12. It shows how much
    /// the law itself amplifies errors.
    pub force_floor_n_m: f64,
    /// Largest change of the energy that the wall has absorbed, J, when the law in `f64` receives positions larger by one part in
    /// 10^12. It shows how much the law itself amplifies errors.
    pub energy_floor_j: f64,
    /// Computing time of the control law per tick (control period).
    pub time: Option<Spread>,
    /// Mean number of instructions per tick (control period) on the board, over the test vectors of `cargo xtask thumb`.
    pub board_instructions: Option<f64>,
    /// Number of instructions in the most expensive tick (control period) on the board.
    pub board_instructions_worst: Option<u32>,
}

/// Recorder that collects the encoder counts of a run, one per tick.
struct Counted(Vec<i64>);

impl Recorder for Counted {
    fn record(&mut self, tick: &Tick) {
        let per_rad = f64::from(COUNTS_PER_REV) / std::f64::consts::TAU;
        self.0.push((tick.angle_rad * per_rad).round() as i64);
    }
}

/// Recorded encoder counts of a press into a wall and out again, with the settings of the control law.
struct Press {
    counts: Vec<i64>,
    scale: CountScale,
    settings: Settings,
}

impl Press {
    fn record() -> Result<Self> {
        let scene = Scene::load("press-wiggle-release")?.with_preset(Preset::Thesis)?;
        let surface = Si::checked_from_num(scene.wall.surface_rad);
        let scale = surface.and_then(|surface| CountScale::new(COUNTS_PER_REV, surface));
        Ok(Self {
            counts: run::watch(&scene, Counted(Vec::new()))?.0,
            scale: scale.ok_or_else(|| {
                scene.error("wall.surface_rad", "too large", "give a value below 2e9")
            })?,
            settings: scene.settings()?,
        })
    }

    fn positions<N: Reported>(&self) -> Vec<Position<N>> {
        self.counts
            .iter()
            .map(|&count| self.scale.penetration(count))
            .collect()
    }

    /// Forces of the control law in every tick of the press, N·m.
    fn forces<N: Reported>(&self, law: &Controller<N>, positions: &[Position<N>]) -> Vec<f64> {
        let mut law = *law;
        positions.iter().map(|&e| law.tick(e).to_f64()).collect()
    }

    /// Differences between two force sequences: largest in N·m, root mean square in N·m, and the largest difference of the absorbed
    /// energies, J.
    fn differences(&self, forces: &[f64], reference: &[f64]) -> [f64; 3] {
        let step = std::f64::consts::TAU / f64::from(COUNTS_PER_REV);
        let (mut largest, mut squares, mut energy, mut apart) = (0.0_f64, 0.0, 0.0, 0.0_f64);
        for (index, (a, b)) in forces.iter().zip(reference).enumerate() {
            let off = a - b;
            largest = largest.max(off.abs());
            squares += off * off;
            if let Some(next) = self.counts.get(index + 1) {
                energy += off * (next - self.counts[index]) as f64 * step;
                apart = apart.max(energy.abs());
            }
        }
        [largest, (squares / forces.len() as f64).sqrt(), apart]
    }
}

/// A control law in one number format, ready to be timed; `work` runs the law over the whole press.
struct Prepared<'a> {
    point: LawPoint,
    work: Option<Work<'a>>,
}

fn prepare<'a, N: Reported>(
    press: &'a Press,
    (law, settings): (&'static str, Settings),
    reference: &Reference,
) -> Prepared<'a> {
    let mut point = LawPoint {
        law,
        number: N::NAME,
        refused: None,
        force_error_n_m: None,
        force_error_rms_n_m: None,
        energy_error_j: None,
        force_floor_n_m: reference.floor[0],
        energy_floor_j: reference.floor[2],
        time: None,
        board_instructions: None,
        board_instructions_worst: None,
    };
    if let Some(counted) = board::instructions(law, N::NAME) {
        point.board_instructions = counted.mean;
        point.board_instructions_worst = Some(counted.worst);
    }
    let law = match Controller::<N>::new(&settings) {
        Ok(law) => law,
        Err(error) => {
            point.refused = Some(error.to_string());
            return Prepared { point, work: None };
        }
    };
    let positions = press.positions::<N>();
    let [force, rms, energy] =
        press.differences(&press.forces(&law, &positions), &reference.forces);
    point.force_error_n_m = Some(force);
    point.force_error_rms_n_m = Some(rms);
    point.energy_error_j = Some(energy);
    let work = move || {
        let mut law = law;
        positions.iter().map(|&e| law.tick(e).to_f64()).sum()
    };
    Prepared {
        point,
        work: Some(Box::new(work)),
    }
}

/// Forces of a law in `f64`, and their change when positions are larger by one part in 10^12.
struct Reference {
    forces: Vec<f64>,
    floor: [f64; 3],
}

impl Reference {
    fn of(press: &Press, settings: &Settings) -> Option<Self> {
        let law = Controller::<f64>::new(settings).ok()?;
        let positions = press.positions::<f64>();
        let moved: Vec<_> = positions
            .iter()
            .map(|e| Position::from_f64(e.to_f64() * (1.0 + 1e-12)))
            .collect();
        let forces = press.forces(&law, &positions);
        let floor = press.differences(&press.forces(&law, &moved), &forces);
        Some(Self { forces, floor })
    }
}

/// Measures every law in every number format; calls `on_round` once per round of timing.
///
/// # Errors
/// A shipped scene cannot be run.
pub fn points(repeats: u32, on_round: impl FnMut()) -> Result<Vec<LawPoint>> {
    let press = Press::record()?;
    let mut prepared = Vec::new();
    let alone = LawKind::ALL.iter().map(|&law| {
        let settings = Settings {
            law,
            ..press.settings
        };
        (law.word(), settings)
    });
    for named in alone.chain([("shipped", Settings::default())]) {
        let Some(reference) = Reference::of(&press, &named.1) else {
            continue;
        };
        prepared.push(prepare::<Fixed16>(&press, named, &reference));
        prepared.push(prepare::<Fixed32>(&press, named, &reference));
        prepared.push(prepare::<f32>(&press, named, &reference));
        prepared.push(prepare::<f64>(&press, named, &reference));
    }
    let (mut points, mut work, mut timed) = (Vec::new(), Vec::new(), Vec::new());
    for (index, Prepared { point, work: each }) in prepared.into_iter().enumerate() {
        points.push(point);
        if let Some(each) = each {
            work.push(each);
            timed.push(index);
        }
    }
    let times = race(&mut work, press.counts.len() as f64, repeats, on_round);
    for (index, time) in timed.into_iter().zip(times) {
        points[index].time = Some(time);
    }
    Ok(points)
}
