//! Small motions of a haptic device that nobody holds, one axis after the other. The device's mass, damping and friction are
//! identified from these motions.
//!
//! A soft spring with a little damping holds the device at the position where its motors were switched on. A sum of three sines
//! pushes the device along one axis at a time by some millimetres. Force and position are recorded in every control interval.

use crate::haptic::{HapticFault, length};
use crate::servo::ForceLaw;

/// The settings of the small motions from which a device is identified.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmallMotions {
    /// Control rate, Hz.
    pub rate_hz: u32,
    /// Time for which each axis is pushed, s.
    pub axis_s: f64,
    /// Largest pushing force, N. The force of the spring and the damping that hold the device is added to it.
    pub push_n: f64,
    /// Distance from the start position at which the motion is aborted, m.
    pub furthest_m: f64,
}

/// Time before the first push, s, in which the force of the servo loop fades in. It is not recorded.
const QUIET_S: f64 = 1.2;
/// Stiffness of the spring that holds the device, N/m. `DAMPING_N_S_PER_M` is the damping that acts with it.
const SPRING_N_PER_M: f64 = 120.0;
const DAMPING_N_S_PER_M: f64 = 1.0;
/// Frequencies of the three sines, Hz, each with its amplitude as a fraction of [`SmallMotions::push_n`]. The frequencies are
/// chosen so that the sines rarely peak together.
const SINES: [(f64, f64); 3] = [(1.3, 0.4), (3.1, 0.3), (6.7, 0.3)];
/// Number of control intervals over which the velocity is averaged.
const WINDOW: usize = 16;

/// Position and force of one axis in every control interval in which the axis was pushed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AxisRecord {
    /// Positions along the axis, one per control interval, m.
    pub position_m: Vec<f64>,
    /// Force along the axis from the measurement of a position to the next one, N.
    pub force_n: Vec<f64>,
}

/// The force law that moves the device by small motions and records them.
#[derive(Debug, Clone)]
pub struct MovedAbout {
    motions: SmallMotions,
    home: Option<[f64; 3]>,
    past: [[f64; 3]; WINDOW],
    tick: u64,
    at: [f64; 3],
    /// The recorded positions and forces of each axis.
    pub axes: [AxisRecord; 3],
}

impl MovedAbout {
    /// Prepares the motions. The spring holds the device at the position that [`ForceLaw::tick`] gets first.
    #[must_use]
    pub fn new(motions: SmallMotions) -> Self {
        Self {
            motions,
            home: None,
            past: [[0.0; 3]; WINDOW],
            tick: 0,
            at: [0.0; 3],
            axes: Default::default(),
        }
    }

    fn quiet_ticks(&self) -> u64 {
        (QUIET_S * f64::from(self.motions.rate_hz)).ceil() as u64
    }

    fn axis_ticks(&self) -> u64 {
        (self.motions.axis_s * f64::from(self.motions.rate_hz)).ceil() as u64
    }

    /// Number of control intervals that all motions take.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.quiet_ticks() + 3 * self.axis_ticks()
    }

    /// The axis that is pushed in this control interval, and the time since its push began, s. `None` before the first and after
    /// the last push.
    fn pushed(&self, tick: u64) -> Option<(usize, f64)> {
        let since = tick.checked_sub(self.quiet_ticks())?;
        let axis = (since / self.axis_ticks()) as usize;
        let ticks = since % self.axis_ticks();
        (axis < 3).then_some((axis, ticks as f64 / f64::from(self.motions.rate_hz)))
    }
}

impl ForceLaw for MovedAbout {
    fn tick(&mut self, position_m: [f64; 3]) -> Result<[f64; 3], HapticFault> {
        let home = *self.home.get_or_insert_with(|| {
            self.past = [position_m; WINDOW];
            position_m
        });
        self.at = position_m;
        let from: [f64; 3] = std::array::from_fn(|i| position_m[i] - home[i]);
        let away = length(from);
        if away > self.motions.furthest_m {
            return Err(HapticFault::Outside(away - self.motions.furthest_m));
        }
        let slot = (self.tick % WINDOW as u64) as usize;
        let window_s = WINDOW as f64 / f64::from(self.motions.rate_hz);
        let was = std::mem::replace(&mut self.past[slot], position_m);
        let mut force: [f64; 3] = std::array::from_fn(|i| {
            -SPRING_N_PER_M * from[i] - DAMPING_N_S_PER_M * (position_m[i] - was[i]) / window_s
        });
        if let Some((axis, seconds)) = self.pushed(self.tick) {
            let sines: f64 = SINES
                .iter()
                .map(|(hz, share)| share * (std::f64::consts::TAU * hz * seconds).sin())
                .sum();
            force[axis] += self.motions.push_n * sines;
        }
        Ok(force)
    }

    fn commanded(&mut self, force_n: [f64; 3]) {
        if let Some((axis, _)) = self.pushed(self.tick) {
            self.axes[axis].position_m.push(self.at[axis]);
            self.axes[axis].force_n.push(force_n[axis]);
        }
        self.tick += 1;
    }
}
