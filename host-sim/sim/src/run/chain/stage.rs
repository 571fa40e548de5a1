//! Effects on the angle before it reaches the control law, and on the torque before it reaches the motor.

use super::control::{Answer, Control};

/// An effect between device and control law. It changes the angle that the law receives, the torque that the motor receives, or
/// both.
pub trait Stage: Send {
    /// Whether the control law is informed of the changed torque. A real controller knows its torque limit, but not the error of
    /// its current sensor.
    const TOLD: bool = true;

    /// Returns the angle to pass on to the control law, rad.
    #[inline(always)]
    fn angle_rad(&mut self, angle_rad: f64) -> f64 {
        angle_rad
    }

    /// Returns the torque to pass on to the motor, N·m in the direction of positive angles.
    #[inline(always)]
    fn torque_n_m(&mut self, torque_n_m: f64) -> f64 {
        torque_n_m
    }
}

/// One effect around the rest of the controller side. The effect that is physically nearest to the device is the outermost.
pub struct Staged<S> {
    stage: S,
    inner: Box<dyn Control>,
}

impl<S: Stage + 'static> Staged<S> {
    /// Puts an effect around the controller side `inner`.
    #[must_use]
    pub fn around(inner: Box<dyn Control>, stage: S) -> Box<dyn Control> {
        Box::new(Self { stage, inner })
    }
}

impl<S: Stage> Staged<S> {
    /// Torque after this effect, N·m. If it differs from the requested torque `wanted_n_m` and [`Stage::TOLD`] is true, the inner
    /// effects and the control law are informed.
    #[inline(always)]
    fn passed_on(&mut self, wanted_n_m: f64) -> f64 {
        let torque_n_m = self.stage.torque_n_m(wanted_n_m);
        if S::TOLD && torque_n_m != wanted_n_m {
            tell(self.inner.as_mut(), torque_n_m);
        }
        torque_n_m
    }
}

/// Informs the control law of a changed torque. The function is separate, so that ticks without a change do not take the time of
/// the call.
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

/// Limits the motor's torque to a largest absolute value.
#[derive(Debug, Clone, Copy)]
pub struct Limited {
    /// Largest absolute torque, N·m.
    pub limit_n_m: f64,
}

impl Stage for Limited {
    #[inline(always)]
    fn torque_n_m(&mut self, torque_n_m: f64) -> f64 {
        torque_n_m.clamp(-self.limit_n_m, self.limit_n_m)
    }
}

/// An amplifier with finite resolution: rounds the torque to the nearest step.
#[derive(Debug, Clone, Copy)]
pub struct Stepped {
    /// Resolution of the amplifier's torque, N·m.
    pub step_n_m: f64,
}

impl Stage for Stepped {
    #[inline(always)]
    fn torque_n_m(&mut self, torque_n_m: f64) -> f64 {
        (torque_n_m / self.step_n_m).round() * self.step_n_m
    }
}
