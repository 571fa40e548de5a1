//! Effects on the angle before it reaches the law, and on the torque before it reaches the motor.

use super::control::{Answer, Control};

/// An effect around the law: it changes the angle on its way in, the torque on its way out, or both.
pub trait Stage {
    /// Whether the law is informed of the changed torque. A torque limit is known to a device, an error of its current sensor is
    /// not.
    const TOLD: bool = true;

    /// Returns the angle to pass on to the law, rad.
    #[inline(always)]
    fn angle_rad(&mut self, angle_rad: f64) -> f64 {
        angle_rad
    }

    /// Returns the torque to pass on to the motor, N·m along `+x`.
    #[inline(always)]
    fn torque_n_m(&mut self, torque_n_m: f64) -> f64 {
        torque_n_m
    }
}

/// One effect around the rest of the controller side. Effects that are physically nearer to the device are further outside.
pub struct Staged<S> {
    stage: S,
    inner: Box<dyn Control>,
}

impl<S: Stage + 'static> Staged<S> {
    /// Puts an effect around the present controller side.
    #[must_use]
    pub fn around(inner: Box<dyn Control>, stage: S) -> Box<dyn Control> {
        Box::new(Self { stage, inner })
    }
}

impl<S: Stage> Staged<S> {
    /// Torque after this effect, N·m. If it differs from `wanted_n_m`, the inner effects and the law are informed.
    #[inline(always)]
    fn passed_on(&mut self, wanted_n_m: f64) -> f64 {
        let torque_n_m = self.stage.torque_n_m(wanted_n_m);
        if S::TOLD && torque_n_m != wanted_n_m {
            tell(self.inner.as_mut(), torque_n_m);
        }
        torque_n_m
    }
}

/// Informs the law of a changed torque. A separate function, so that ticks without a change do not pay for the call.
#[cold]
#[inline(never)]
fn tell(inner: &mut dyn Control, torque_n_m: f64) {
    inner.commanded(torque_n_m);
}

impl<S: Stage> Control for Staged<S> {
    fn torque_n_m(&mut self, angle_rad: f64) -> f64 {
        let wanted_n_m = self.inner.torque_n_m(self.stage.angle_rad(angle_rad));
        self.passed_on(wanted_n_m)
    }

    fn answer(&mut self, angle_rad: f64) -> Answer {
        let answer = self.inner.answer(self.stage.angle_rad(angle_rad));
        Answer {
            torque_n_m: self.passed_on(answer.torque_n_m),
            ..answer
        }
    }

    fn commanded(&mut self, torque_n_m: f64) {
        self.inner.commanded(torque_n_m);
    }

    fn changed_at(&mut self, angle_rad: f64) {
        self.inner.changed_at(self.stage.angle_rad(angle_rad));
    }
}

/// Limits the torque.
#[derive(Debug, Clone, Copy)]
pub struct Limited {
    /// Largest torque, N·m.
    pub limit_n_m: f64,
}

impl Stage for Limited {
    #[inline(always)]
    fn torque_n_m(&mut self, torque_n_m: f64) -> f64 {
        torque_n_m.clamp(-self.limit_n_m, self.limit_n_m)
    }
}

/// An amplifier with discrete steps: rounds the torque to the nearest step.
#[derive(Debug, Clone, Copy)]
pub struct Stepped {
    /// Step, N·m.
    pub step_n_m: f64,
}

impl Stage for Stepped {
    #[inline(always)]
    fn torque_n_m(&mut self, torque_n_m: f64) -> f64 {
        (torque_n_m / self.step_n_m).round() * self.step_n_m
    }
}
