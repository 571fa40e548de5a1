//! A state estimator that predicts, as a linear system.
//!
//! It knows inertia `J`, damping `b`, the forces that the law answered with, and when they act; it estimates penetration, its
//! rate and the hand's push as an acceleration `h`, with three equal poles `z = exp(-2π p T)`. With `f_a` the mean force that
//! acted over the last tick and `y` the measured penetration:
//!
//! ```text
//! a = (-f_a - b v)/J + h,  x⁻ = x + T v + T² a/2,  v⁻ = v + T a,  r = y - x⁻          (13)
//! x = x⁻ + (1 - z³) r,  v = v⁻ + 1.5 (1 - z)² (1 + z) r/T,  h += (1 - z)³ r/T²        (14)
//! ```
//!
//! Then, from `(y, v)`, (13) again over the assumed delay with the forces that are on their way (15).

/// Parameters of the estimator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimator {
    /// Control period `T`, s.
    pub period_s: f64,
    /// Assumed inertia `J`, kg·m² (kg).
    pub inertia: f64,
    /// Assumed damping `b`, N·m·s/rad (N·s/m).
    pub damping: f64,
    /// Three equal poles `p`, Hz.
    pub poles_hz: f64,
    /// Assumed time from sample to command, ticks; 0 for none, and no prediction.
    pub delay_ticks: f64,
}

/// What the law is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predicted {
    /// Penetration, rad (m).
    pub position: f64,
    /// Its rate, rad/s (m/s).
    pub velocity: f64,
}

impl Estimator {
    fn whole(&self) -> usize {
        self.delay_ticks.floor() as usize
    }

    /// Number of states: penetration, rate and push, then the forces that may still act or acted over the last tick, the
    /// latest first.
    #[must_use]
    pub fn order(&self) -> usize {
        3 + self.whole() + 1 + usize::from(self.delay_ticks.fract() > 0.0)
    }

    /// (13): over `ticks` of time.
    fn flow(&self, at: Predicted, push: f64, force: f64, ticks: f64) -> Predicted {
        let time = ticks * self.period_s;
        let acceleration = (-force - self.damping * at.velocity) / self.inertia + push;
        Predicted {
            position: at.position + time * at.velocity + 0.5 * time * time * acceleration,
            velocity: at.velocity + time * acceleration,
        }
    }

    /// Takes a measured penetration: (13) to (15). The law's answer must follow by [`Estimator::command`].
    pub fn update(&self, state: &mut [f64], measured: f64) -> Predicted {
        let (whole, fraction) = (self.whole(), self.delay_ticks.fract());
        let z = (-std::f64::consts::TAU * self.poles_hz * self.period_s).exp();
        let (estimate, forces) = state.split_at_mut(3);
        // forces[i] was answered i + 1 samples ago.
        let mut acted = (1.0 - fraction) * forces[whole];
        if fraction > 0.0 {
            acted += fraction * forces[whole + 1];
        }
        let before = Predicted {
            position: estimate[0],
            velocity: estimate[1],
        };
        let expected = self.flow(before, estimate[2], acted, 1.0);
        let r = measured - expected.position;
        let t = self.period_s;
        estimate[0] = expected.position + (1.0 - z * z * z) * r;
        estimate[1] = expected.velocity + 1.5 * (1.0 - z).powi(2) * (1.0 + z) * r / t;
        estimate[2] += (1.0 - z).powi(3) * r / (t * t);
        let mut ahead = Predicted {
            position: measured,
            velocity: estimate[1],
        };
        if fraction > 0.0 {
            ahead = self.flow(ahead, estimate[2], forces[whole], fraction);
        }
        for age in (0..whole).rev() {
            ahead = self.flow(ahead, estimate[2], forces[age], 1.0);
        }
        ahead
    }

    /// Takes the law's answer to the sample, N·m (N).
    pub fn command(&self, state: &mut [f64], force: f64) {
        let forces = &mut state[3..];
        forces.rotate_right(1);
        forces[0] = force;
    }
}
