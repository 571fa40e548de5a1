//! Algorithm 2.1 as an instrument: bisects the damping that FBA may count on, and so measures what a device has.
//!
//! FBA shows at most `2 c_i/T` of whatever stiffness is asked for, and that is stable just as long as the device really
//! damps with `c_i`. So the largest `c_i` with which a press against a wall that is far too stiff still comes to rest is the
//! damping of the device and of whatever holds it, up to what dry friction adds.
//!
//! Near the limit a press neither grows nor dies quickly: net damping is what is left of `b - c_i`. So a trial is judged by
//! whether the motion grows from the second quarter of the hold to the last, not by how large it is.

use super::swing::Mechanics;
use touchstone_control::{LawKind, StatesKind};
use touchstone_sim::error::Result;
use touchstone_sim::run::{self, Recorder, Tick};
use touchstone_sim::scene::Scene;

/// Settings of the identification.
#[derive(Debug, Clone, Copy)]
pub struct Search {
    /// Lower end of the interval, N·m·s/rad.
    pub low: f64,
    /// Upper end of the interval, N·m·s/rad.
    pub high: f64,
    /// Bisections; the result is good to `(high - low)/2^steps`.
    pub steps: u32,
}

/// One step of the bisection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// Damping that FBA counted on, N·m·s/rad.
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

/// How the verdict changes over the interval that was given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bracket {
    /// The press settles at the lower end and grows at the upper one: the limit lies between.
    Holds,
    /// Settles at the upper end too: the device damps more than that.
    TooLow,
    /// Grows at the lower end already: the device damps less than that, or the press never rests.
    TooHigh,
}

/// Result of the identification.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified {
    /// Damping that FBA may count on, N·m·s/rad: the mean over the presses.
    pub damping: f64,
    /// Uncertainty of the damping, N·m·s/rad: the largest of half the last interval, the spread between the presses,
    /// and what dry friction adds.
    pub uncertainty: f64,
    /// What dry friction adds at the amplitude by which it was judged, N·m·s/rad: `4 F_k/(π A ω)` takes as much out of a cycle.
    pub friction_share: f64,
    /// The last interval's half width, N·m·s/rad.
    pub resolution: f64,
    /// What each press gave: its torque as a share of the scene's, and the damping, N·m·s/rad.
    pub presses: Vec<(f64, f64)>,
    /// The bisections of all presses, in order.
    pub trials: Vec<Trial>,
    /// True damping of the simulated plant: the device and, with a hand, its pad, N·m·s/rad.
    pub plant: f64,
}

/// The presses, as shares of the scene's push.
pub const PRESSES: [f64; 3] = [1.0, 0.6, 1.4];

/// Bisects. FBA against a wall of four times what it can show replaces the scene's law and stiffness.
///
/// With the result of [`super::swing`], dry friction's part is separated.
///
/// `Ok(Err(bracket))`: the verdict does not change within the interval, so nothing can be concluded.
///
/// # Errors
/// A scene that cannot run.
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
        // Without any damping to count on FBA shows nothing, and that settles.
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

/// One press with FBA that counts on this damping.
fn try_out(scene: &Scene, damping: f64) -> Result<Trial> {
    let mut scene = scene.clone();
    scene.law.kind = LawKind::Fba;
    // The algorithm asks what FBA makes of what is measured.
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
        // A quarter of a thousandth of a N·m makes half of the damping that FBA finds: that must be said.
        let found = found("thesis-knob", 0.0, 2e-3).unwrap();
        assert!(found.uncertainty > 10.0 * found.resolution, "{found:?}");
        assert!(
            (found.damping - found.plant).abs() <= 2.0 * found.uncertainty,
            "{found:?}"
        );
    }
}
