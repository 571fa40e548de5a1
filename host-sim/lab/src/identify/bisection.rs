//! Measures the damping of a device by Algorithm 2.1 of the thesis: bisection on the damping `c_i` that the force bounding approach
//! (FBA) assumes.
//!
//! FBA limits the displayed stiffness to `2 c_i/T` (`T` is the control period), however stiff the requested wall is. The press is
//! stable as long as the real damping is at least `c_i`. So a press against a far too stiff wall comes to rest up to a certain
//! `c_i`. The largest such `c_i` is the damping of device and finger together, plus what dry friction adds.
//!
//! Near the limit a motion neither grows nor decays quickly, because the remaining damping (real damping minus `c_i`) is small. A
//! trial is therefore judged by whether the motion grows from the second quarter of the hold to the last, not by the size of the
//! motion.

use super::swing::Mechanics;
use touchstone_control::{LawKind, StatesKind};
use touchstone_sim::error::Result;
use touchstone_sim::run::{self, Recorder, Tick};
use touchstone_sim::scene::Scene;

/// Settings of the bisection for the device's damping.
#[derive(Debug, Clone, Copy)]
pub struct Search {
    /// Lower end of the searched interval of damping, N·m·s/rad.
    pub low: f64,
    /// Upper end of the searched interval of damping, N·m·s/rad.
    pub high: f64,
    /// Number of bisections per press. Half the width of the searched interval divided by `2^steps` remains as the error.
    pub steps: u32,
}

/// One step of the bisection: a press at one assumed damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// Damping that the control law (force bounding approach, FBA) assumed, N·m·s/rad.
    pub damping: f64,
    /// Motion in the second quarter of the hold, peak to peak, rad.
    pub early_rad: f64,
    /// Motion in the last quarter of the hold, peak to peak, rad.
    pub late_rad: f64,
    /// Whether the knob stayed inside the wall in the last quarter of the hold.
    pub held: bool,
}

impl Trial {
    /// Whether the press comes to rest.
    #[must_use]
    pub fn settles(&self) -> bool {
        // If the oscillation has thrown the knob out of the wall, a small motion afterwards does not show that the press comes to
        // rest.
        self.held && (self.late_rad < self.early_rad || self.late_rad < REST_RAD)
    }
}

/// Peak-to-peak motion below which the knob counts as at rest, rad: a sixteenth of an encoder count at 40,000 counts per turn.
const REST_RAD: f64 = 1e-5;

/// Recorder of the knob's range of motion in two windows of ticks.
struct Windows {
    bounds: [(u64, u64); 2],
    ranges: [(f64, f64); 2],
}

impl Windows {
    fn new(scene: &Scene) -> Self {
        // `middle` to `end` is the second half of the hold. The windows are the second and the last quarter of the hold.
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

/// Whether the searched interval contains the limit: the largest assumed damping with which a press comes to rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bracket {
    /// The press comes to rest with the least assumed damping, but not with the largest. The limit lies between.
    Holds,
    /// The press comes to rest even with the largest assumed damping: the device has more damping than the search allows.
    TooLow,
    /// The press does not come to rest even with the least assumed damping: the device has less damping than the search allows,
    /// or the press never rests.
    TooHigh,
}

/// Result of the identification: the device's damping with its uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified {
    /// Damping of the device, N·m·s/rad: the largest damping that the force bounding approach (FBA) may assume, as the mean over
    /// the presses.
    pub damping: f64,
    /// Uncertainty of the damping, N·m·s/rad: the largest of half the last interval, the spread between the presses, and the
    /// damping that dry friction adds.
    pub uncertainty: f64,
    /// Damping that dry friction adds at the amplitude of the last trial, N·m·s/rad. By its describing function it is `4 F_k/(π A
    /// ω)`, with the friction torque `F_k`, the amplitude `A` and the frequency `ω`. 0 if the friction is not known, or if the
    /// last trial came to rest.
    pub friction_share: f64,
    /// Resolution of the bisection, N·m·s/rad: half the width of the last interval of damping.
    pub resolution: f64,
    /// Results of the presses: the torque as a fraction of the scene's, and the damping in N·m·s/rad.
    pub presses: Vec<(f64, f64)>,
    /// The trials of all presses, in order.
    pub trials: Vec<Trial>,
    /// True damping of the simulated plant, N·m·s/rad: the device's, plus that of the finger pad if there is a hand.
    pub plant: f64,
}

/// Torques of the presses, as fractions of the scene's push.
pub const PRESSES: [f64; 3] = [1.0, 0.6, 1.4];

/// Runs the bisection for every press. The scene's law is replaced by the force bounding approach (FBA), and its wall by one of
/// four times the stiffness that FBA can display.
///
/// If `mechanics` from [`super::swing`] is given, the damping that dry friction adds is computed. `Ok(Err(bracket))`: the limit is
/// outside the searched interval, so there is no result.
///
/// # Errors
/// The scene cannot be run.
pub fn identify(
    scene: &Scene,
    search: Search,
    mechanics: Option<&Mechanics>,
    mut progress: impl FnMut(&Trial),
) -> Result<std::result::Result<Identified, Bracket>> {
    let mut trials = Vec::new();
    let mut presses = Vec::new();
    for share in PRESSES {
        let mut pressed = scene.clone();
        pressed.operator.motion.scale_push(share);
        let mut settles = |damping: f64| -> Result<bool> {
            let trial = try_out(&pressed, damping)?;
            progress(&trial);
            trials.push(trial);
            Ok(trial.settles())
        };
        let (mut low, mut high) = (search.low, search.high);
        // If FBA assumes no damping, it renders no force, and the press comes to rest.
        if low > 0.0 && !settles(low)? {
            return Ok(Err(Bracket::TooHigh));
        }
        if settles(high)? {
            return Ok(Err(Bracket::TooLow));
        }
        for _ in 0..search.steps {
            let damping = 0.5 * (low + high);
            if settles(damping)? {
                low = damping;
            } else {
                high = damping;
            }
        }
        presses.push((share, 0.5 * (low + high)));
    }
    let count = presses.len() as f64;
    let damping = presses.iter().map(|(_, damping)| damping).sum::<f64>() / count;
    let resolution = 0.5 * (search.high - search.low) / f64::from(search.steps).exp2();
    let spread = presses
        .iter()
        .map(|(_, found)| (found - damping).abs())
        .fold(0.0, f64::max);
    let pad = scene
        .operator
        .hand()
        .map_or(0.0, |hand| hand.pad_damping_n_m_s_per_rad);
    let friction_share = match (mechanics, trials.last()) {
        (Some(mechanics), Some(last)) if last.late_rad > REST_RAD => {
            let stiffness = 2.0 * damping * f64::from(scene.timing.rate_hz);
            let frequency = (stiffness / mechanics.inertia_kg_m2.value).sqrt();
            let amplitude = 0.5 * last.late_rad;
            4.0 * mechanics.friction_n_m.value / (std::f64::consts::PI * amplitude * frequency)
        }
        _ => 0.0,
    };
    Ok(Ok(Identified {
        damping,
        uncertainty: resolution.max(spread).max(friction_share),
        friction_share,
        resolution,
        presses,
        trials,
        plant: scene.device.damping_n_m_s_per_rad + pad,
    }))
}

/// Simulates one press with the force bounding approach (FBA) that assumes `damping` for the device.
fn try_out(scene: &Scene, damping: f64) -> Result<Trial> {
    let mut scene = scene.clone();
    scene.law.kind = LawKind::Fba;
    // The algorithm examines FBA on measured states.
    scene.law.states = StatesKind::Measured;
    scene.law.guard.on = false;
    scene.law.device_damping_n_m_s_per_rad = damping;
    scene.wall.k_desired_n_m_per_rad = 8.0 * damping * f64::from(scene.timing.rate_hz);
    let windows = run::watch(&scene, Windows::new(&scene))?;
    let [early_rad, late_rad] = windows.widths();
    Ok(Trial {
        damping,
        early_rad,
        late_rad,
        held: windows.ranges[1].0 > scene.wall.surface_rad,
    })
}

#[cfg(test)]
mod tests {
    use super::super::swing;
    use super::*;

    fn found(name: &str, low: f64, high: f64) -> std::result::Result<Identified, Bracket> {
        let search = Search {
            low,
            high,
            steps: 10,
        };
        let scene = Scene::load(name).unwrap();
        let swings = swing::swing(&scene, &swing::Swings::default())
            .unwrap()
            .unwrap();
        let mechanics =
            swing::mechanics(&swings, scene.timing.period_s(), swing::Torques::Exact).unwrap();
        identify(&scene, search, Some(&mechanics), |_| ()).unwrap()
    }

    #[test]
    fn without_friction_the_damping_is_found() {
        let found = found("identify", 0.0, 2e-3).unwrap();
        assert!(
            (found.damping - 4e-4).abs() <= found.uncertainty.max(4e-6),
            "{found:?}"
        );
        assert!(found.uncertainty < 8e-6, "{found:?}");
    }

    #[test]
    fn a_bracket_without_a_change_of_verdict_is_refused() {
        assert_eq!(found("identify", 0.0, 1e-4).unwrap_err(), Bracket::TooLow);
        assert_eq!(found("identify", 8e-4, 2e-3).unwrap_err(), Bracket::TooHigh);
    }

    #[test]
    fn dry_friction_shows_as_uncertainty() {
        // Dry friction of 0.3 mN·m accounts for half of the damping that FBA finds, so the uncertainty must include it.
        let found = found("thesis-knob", 0.0, 2e-3).unwrap();
        assert!(found.uncertainty > 10.0 * found.resolution, "{found:?}");
        assert!(
            (found.damping - found.plant).abs() <= 2.0 * found.uncertainty,
            "{found:?}"
        );
    }
}
