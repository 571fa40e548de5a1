//! Algorithm 2.1 as an instrument: bisects the damping that FBA may count on, and so measures what a device has.
//!
//! FBA shows at most `2 c_i/T` of whatever stiffness is asked for, and that is stable just as long as the device really
//! damps with `c_i`. So the largest `c_i` with which a press against a wall that is far too stiff still comes to rest is the
//! damping of the device and of whatever holds it, up to what dry friction adds.
//!
//! Near the limit a press neither grows nor dies quickly: net damping is what is left of `b - c_i`. So a trial is judged by
//! whether the motion grows from the second quarter of the hold to the last, not by how large it is.

use touchstone_sim::error::Result;
use touchstone_sim::run::{self, Recorder, Tick, record::LawKind};
use touchstone_sim::scene::Scene;

/// What is identified with.
#[derive(Debug, Clone, Copy)]
pub struct Search {
    /// Lower end of the interval, N·m·s/rad.
    pub low: f64,
    /// Upper end of the interval, N·m·s/rad.
    pub high: f64,
    /// Bisections; the result is good to `(high - low)/2^steps`.
    pub steps: u32,
}

/// One bisection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// Damping that FBA was told, N·m·s/rad.
    pub damping: f64,
    /// Motion in the second quarter of the hold, peak to peak, rad.
    pub early_rad: f64,
    /// Motion in the last quarter, rad.
    pub late_rad: f64,
    /// Whether the HIP stayed inside the wall in the last quarter.
    pub held: bool,
}

impl Trial {
    /// Whether the press comes to rest.
    #[must_use]
    pub fn settles(&self) -> bool {
        // An oscillation that throws the HIP out of the wall has stopped growing for another reason.
        self.held && (self.late_rad < self.early_rad || self.late_rad < REST_RAD)
    }
}

/// Motion that counts as rest, rad: a tenth of a step of a good encoder.
const REST_RAD: f64 = 1e-5;

/// The HIP's range in two windows of ticks.
struct Windows {
    bounds: [(u64, u64); 2],
    ranges: [(f64, f64); 2],
}

impl Windows {
    fn new(scene: &Scene) -> Self {
        // The hold's second half, as the scene gives it, and the quarter before.
        let (middle, end) = scene
            .hold_window_s()
            .unwrap_or((0.0, scene.timing.duration_s));
        let quarter = 0.5 * (end - middle);
        let tick = |seconds: f64| (seconds * f64::from(scene.timing.rate_hz)) as u64;
        Self {
            bounds: [
                (tick(middle - quarter), tick(middle)),
                (tick(end - quarter), tick(end)),
            ],
            ranges: [(f64::INFINITY, f64::NEG_INFINITY); 2],
        }
    }

    fn widths(&self) -> [f64; 2] {
        self.ranges.map(|(low, high)| (high - low).max(0.0))
    }
}

impl Recorder for Windows {
    fn record(&mut self, tick: &Tick) {
        for (bounds, range) in self.bounds.iter().zip(&mut self.ranges) {
            if (bounds.0..bounds.1).contains(&tick.index) {
                let angle = tick.angle_rad;
                *range = (range.0.min(angle), range.1.max(angle));
            }
        }
    }
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified {
    /// Damping, N·m·s/rad: the middle of the last interval.
    pub damping: f64,
    /// Half the width of the last interval, N·m·s/rad.
    pub uncertainty: f64,
    /// The bisections in order.
    pub trials: Vec<Trial>,
    /// What the simulated plant has: device and, behind a hand, its pad, N·m·s/rad.
    pub plant: f64,
}

/// Bisects. The scene's own law and stiffness are replaced by FBA against a wall of four times what it can show.
///
/// # Errors
/// A scene that cannot run.
pub fn identify(
    scene: &Scene,
    search: Search,
    mut progress: impl FnMut(&Trial),
) -> Result<Identified> {
    let (mut low, mut high) = (search.low, search.high);
    let mut trials = Vec::new();
    for _ in 0..search.steps {
        let damping = 0.5 * (low + high);
        let mut trial_scene = scene.clone();
        trial_scene.law.kind = LawKind::Fba;
        trial_scene.law.c_i_n_m_s_per_rad = damping;
        trial_scene.wall.k_desired_n_m_per_rad = 8.0 * damping * f64::from(scene.timing.rate_hz);
        let windows = run::watch(&trial_scene, Windows::new(&trial_scene))?;
        let [early_rad, late_rad] = windows.widths();
        let held = windows.ranges[1].0 > scene.wall.surface_rad;
        let trial = Trial {
            damping,
            early_rad,
            late_rad,
            held,
        };
        progress(&trial);
        trials.push(trial);
        if trial.settles() {
            low = damping;
        } else {
            high = damping;
        }
    }
    let pad = scene
        .operator
        .hand()
        .map_or(0.0, |hand| hand.pad_damping_n_m_s_per_rad);
    Ok(Identified {
        damping: 0.5 * (low + high),
        uncertainty: 0.5 * (high - low),
        trials,
        plant: scene.device.damping_n_m_s_per_rad + pad,
    })
}
