//! The hand's motion at an object, as its rest point over time (position to which the person pulls the hand).

use super::{Object, RADIUS_MM};
use touchstone_world::plant::FIRM_TRANSLATION;

/// A part of the hand's motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// The hand moves from outside into the object, a little out, and in again.
    Probe,
    /// The hand rests with the full push.
    Hold,
    /// The hand slides along the surface.
    Slide,
    /// The hand lets go.
    Release,
}

/// Speed of the hand along the surface, mm/s.
pub const SLIDE_MM_PER_S: f64 = 50.0;
/// Force of the push, N, unless another one is set.
const PUSH_N: f64 = 6.0;
/// Time for which the hand moves in, out and in again, s.
pub(super) const PROBE_S: f64 = 1.2;
/// Time for which the hand holds still, s.
pub(super) const HOLD_S: f64 = 2.0;
const SLIDE_S: f64 = 1.6;
const RELEASE_S: f64 = 0.6;

/// The motion of the hand's rest point at an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProbingMotion {
    object: Object,
    normal: [f64; 3],
    side: [f64; 3],
    slide_mm_per_s: f64,
    push_n: f64,
}

/// A smooth rise from 0 to 1 as `t` goes from 0 to 1, without jumps of speed.
fn smooth(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

impl ProbingMotion {
    /// Creates the hand's motion at this object.
    #[must_use]
    pub fn of(object: Object) -> Self {
        let n = object.normal();
        // Direction of the slide. On the sphere the slide passes a point at which one component of the normal changes its sign.
        let towards = match object {
            Object::Sphere => [1.0, 0.0, 0.2],
            Object::Horizontal | Object::Inclined => [1.0, 0.4, 0.0],
        };
        let along = (0..3).map(|i| towards[i] * n[i]).sum::<f64>();
        let across: [f64; 3] = std::array::from_fn(|i| towards[i] - along * n[i]);
        let length = across.iter().map(|x| x * x).sum::<f64>().sqrt();
        Self {
            object,
            normal: n,
            side: across.map(|x| x / length),
            slide_mm_per_s: SLIDE_MM_PER_S,
            push_n: PUSH_N,
        }
    }

    /// The same motion with another sliding speed, for a smaller workspace.
    #[must_use]
    pub fn at_speed(mut self, slide_mm_per_s: f64) -> Self {
        self.slide_mm_per_s = slide_mm_per_s;
        self
    }

    /// The same motion with another push force, for weaker motors.
    #[must_use]
    pub fn with_push(mut self, push_n: f64) -> Self {
        self.push_n = push_n;
        self
    }

    /// Number of ticks (control periods) of the whole motion.
    #[must_use]
    pub fn ticks(&self) -> u32 {
        let seconds = PROBE_S + HOLD_S + SLIDE_S + RELEASE_S;
        (seconds * f64::from(super::RATE_HZ)) as u32
    }

    /// The part of the hand's motion at a time.
    #[must_use]
    pub fn phase(&self, time_s: f64) -> Phase {
        match time_s {
            t if t < PROBE_S => Phase::Probe,
            t if t < PROBE_S + HOLD_S => Phase::Hold,
            t if t < PROBE_S + HOLD_S + SLIDE_S => Phase::Slide,
            _ => Phase::Release,
        }
    }

    /// Rest point of the hand at a time, mm.
    #[must_use]
    pub fn rest_mm(&self, time_s: f64) -> [f64; 3] {
        // Depth below the surface at which the hand's spring gives the push.
        let deep = self.push_n / FIRM_TRANSLATION.stiffness * 1e3;
        let height = 3.0;
        let below = |share: f64| height - (height + deep) * share;
        let t = time_s;
        let above = if t < PROBE_S {
            // The rest point moves in, part of the way out, and in again, so that the first contact ends with an outward motion.
            let first = smooth(t / 0.5) * 0.6;
            let back = smooth((t - 0.5) / 0.2) * 0.2;
            let again = smooth((t - 0.8) / 0.4) * 0.6;
            below(first - back + again)
        } else if t < PROBE_S + HOLD_S + SLIDE_S {
            below(1.0)
        } else {
            below(1.0 - 1.3 * smooth((t - PROBE_S - HOLD_S - SLIDE_S) / RELEASE_S))
        };
        let along_s = (t - PROBE_S - HOLD_S).clamp(0.0, SLIDE_S);
        // The slide approaches its speed with a time constant of 0.05 s.
        let way = self.slide_mm_per_s * (along_s - 0.05 + 0.05 * (-along_s / 0.05).exp());
        match self.object {
            Object::Horizontal | Object::Inclined => {
                std::array::from_fn(|i| above * self.normal[i] + way * self.side[i])
            }
            Object::Sphere => {
                let phi = way / RADIUS_MM;
                let radius = RADIUS_MM + above;
                std::array::from_fn(|i| {
                    radius * (phi.cos() * self.normal[i] + phi.sin() * self.side[i])
                })
            }
        }
    }
}
