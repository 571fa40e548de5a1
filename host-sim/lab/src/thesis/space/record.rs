//! The record of a run in three degrees of freedom, and values that are computed from it.

use super::port_energy::PortEnergy;
use super::{Cell, Object, Phase, RADIUS_MM};

/// The record of a run in three degrees of freedom, one entry per tick (control period).
#[derive(Debug, Clone)]
pub struct Record {
    /// The cell of the comparison that was simulated.
    pub cell: Cell,
    /// Time of each tick, s.
    pub time_s: Vec<f64>,
    /// Part of the hand's motion in each tick.
    pub phase: Vec<Phase>,
    /// True position of the effector in each tick, mm.
    pub hip_mm: Vec<[f64; 3]>,
    /// Force on the effector in each tick, N.
    pub force_n: Vec<[f64; 3]>,
    /// Whether the run ended because the mechanism could not reach a position.
    pub stopped: bool,
    /// Largest error of the energy balance of device and hand, J.
    pub audit_j: f64,
    /// Energy through the ports of wall and user.
    pub energy: PortEnergy,
    pub(super) start_energy_j: Option<f64>,
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

impl Record {
    pub(super) fn new(cell: Cell) -> Self {
        Self {
            cell,
            time_s: Vec::new(),
            phase: Vec::new(),
            hip_mm: Vec::new(),
            force_n: Vec::new(),
            stopped: false,
            audit_j: 0.0,
            energy: PortEnergy::default(),
            start_energy_j: None,
        }
    }

    pub(super) fn keep(&mut self, time_s: f64, phase: Phase, hip_mm: [f64; 3], force_n: [f64; 3]) {
        self.time_s.push(time_s);
        self.phase.push(phase);
        self.hip_mm.push(hip_mm);
        self.force_n.push(force_n);
    }

    /// Normal of the true surface at the effector's position in a tick.
    #[must_use]
    pub fn normal(&self, tick: usize) -> [f64; 3] {
        match self.cell.object {
            Object::Horizontal | Object::Inclined => self.cell.object.normal(),
            Object::Sphere => {
                let here = self.hip_mm[tick];
                let r = length(here).max(1e-9);
                here.map(|x| x / r)
            }
        }
    }

    /// True depth below the surface in a tick, with its texture, mm.
    #[must_use]
    pub fn depth_mm(&self, tick: usize) -> f64 {
        let texture = self.cell.feel.texture;
        let above_mm = texture.map_or(0.0, |texture| texture.above_mm(self.hip_mm[tick]));
        let smooth_mm = match self.cell.object {
            Object::Horizontal | Object::Inclined => -dot(self.normal(tick), self.hip_mm[tick]),
            Object::Sphere => RADIUS_MM - length(self.hip_mm[tick]),
        };
        smooth_mm + above_mm
    }

    /// Component of the force out of the surface in a tick, N.
    #[must_use]
    pub fn normal_force_n(&self, tick: usize) -> f64 {
        dot(self.normal(tick), self.force_n[tick])
    }

    /// Component of the force along the surface in a tick, N.
    #[must_use]
    pub fn tangential_n(&self, tick: usize) -> f64 {
        let n = self.normal(tick);
        let out = self.normal_force_n(tick);
        length(std::array::from_fn(|i| self.force_n[tick][i] - out * n[i]))
    }

    /// Ticks of the last part of a phase of the hand's motion. `share` is the length of that part as a fraction of the whole phase.
    #[must_use]
    pub fn late(&self, phase: Phase, share: f64) -> std::ops::Range<usize> {
        let all: Vec<usize> = (0..self.phase.len())
            .filter(|tick| self.phase[*tick] == phase)
            .collect();
        let (Some(first), Some(last)) = (all.first(), all.last()) else {
            return 0..0;
        };
        let end = last + 1;
        end - ((end - first) as f64 * share) as usize..end
    }

    fn mean(ticks: std::ops::Range<usize>, of: impl Fn(usize) -> f64) -> f64 {
        let count = ticks.len().max(1) as f64;
        ticks.map(of).sum::<f64>() / count
    }

    /// Displayed stiffness over some ticks, N/mm: mean force out of the surface divided by mean depth.
    #[must_use]
    pub fn displayed_n_per_mm(&self, ticks: std::ops::Range<usize>) -> f64 {
        Self::mean(ticks.clone(), |t| self.normal_force_n(t))
            / Self::mean(ticks, |t| self.depth_mm(t))
    }

    /// Ripple of the depth over some ticks, mm: root mean square deviation from a moving mean over 50 ticks; NaN over no ticks.
    #[must_use]
    pub fn ripple_mm(&self, ticks: std::ops::Range<usize>) -> f64 {
        if ticks.is_empty() {
            return f64::NAN;
        }
        let mut sum = 0.0;
        let mut count = 0.0_f64;
        for tick in ticks.clone() {
            let from = tick.saturating_sub(25).max(ticks.start);
            let to = (tick + 25).min(ticks.end);
            let off = self.depth_mm(tick) - Self::mean(from..to, |t| self.depth_mm(t));
            sum += off * off;
            count += 1.0;
        }
        (sum / count).sqrt()
    }

    /// Mean speed of the effector over some ticks, mm/s.
    #[must_use]
    pub fn speed_mm_per_s(&self, ticks: std::ops::Range<usize>) -> f64 {
        if ticks.len() < 2 {
            return 0.0;
        }
        let seconds = self.time_s[ticks.end - 1] - self.time_s[ticks.start];
        let way: f64 = ticks
            .skip(1)
            .map(|t| {
                length(std::array::from_fn(|i| {
                    self.hip_mm[t][i] - self.hip_mm[t - 1][i]
                }))
            })
            .sum();
        way / seconds
    }

    /// Largest ratio of tangential to normal force, over the ticks with more than 0.5 N of normal force.
    #[must_use]
    pub fn most_tangential(&self, ticks: std::ops::Range<usize>) -> f64 {
        ticks
            .filter(|t| self.normal_force_n(*t) > 0.5)
            .map(|t| self.tangential_n(t) / self.normal_force_n(t))
            .fold(0.0, f64::max)
    }

    /// Largest change of the tangential force from tick to tick, divided by the normal force, over the ticks with more than 0.5 N
    /// of normal force.
    #[must_use]
    pub fn largest_jump(&self, ticks: std::ops::Range<usize>) -> f64 {
        ticks
            .skip(1)
            .filter(|t| self.normal_force_n(*t) > 0.5)
            .map(|t| {
                let n = self.normal(t);
                let change: [f64; 3] =
                    std::array::from_fn(|i| self.force_n[t][i] - self.force_n[t - 1][i]);
                let out = dot(change, n);
                length(std::array::from_fn(|i| change[i] - out * n[i])) / self.normal_force_n(t)
            })
            .fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::super::texture::Texture;
    use super::super::{Approach, Mechanism, SurfaceFeel};
    use super::*;

    /// A quarter of a period past the origin is the top of a ridge, three quarters the bottom of a groove.
    #[test]
    fn depth_counts_from_the_textured_surface() {
        let texture = Texture {
            height_mm: 0.2,
            period_mm: 4.0,
            along: [1.0, 0.0, 0.0],
        };
        let inside_mm = |object, texture, hip_mm| {
            let mut record = Record::new(Cell {
                mechanism: Mechanism::Cartesian,
                object,
                k_desired_n_per_mm: 25.0,
                approach: Approach::Shipped,
                feel: SurfaceFeel {
                    impact: None,
                    texture,
                },
            });
            record.keep(0.0, Phase::Slide, hip_mm, [0.0; 3]);
            record.depth_mm(0)
        };
        for (x_mm, above_mm) in [(0.0, 0.0), (1.0, 0.1), (2.0, 0.0), (3.0, -0.1)] {
            for object in [Object::Horizontal, Object::Sphere] {
                // A point that is 0.3 mm below the smooth surface.
                let z_mm = match object {
                    Object::Sphere => (29.7_f64.powi(2) - x_mm * x_mm).sqrt(),
                    Object::Horizontal | Object::Inclined => -0.3,
                };
                let hip_mm = [x_mm, 7.0 * f64::from(object != Object::Sphere), z_mm];
                let smooth_mm = inside_mm(object, None, hip_mm);
                assert!((smooth_mm - 0.3).abs() < 1e-9, "{object:?}: {smooth_mm}");
                let found_mm = inside_mm(object, Some(texture), hip_mm);
                assert!(
                    (found_mm - 0.3 - above_mm).abs() < 1e-9,
                    "{object:?}, {x_mm} mm: {found_mm}"
                );
            }
        }
    }
}
