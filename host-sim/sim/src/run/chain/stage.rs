//! Effects on the way of the angle to the law and of the torque to the motor.

use super::control::{Answer, Control};

/// An effect around the law: it changes the angle on its way in, the torque on its way out, or both.
pub trait Stage {
    /// Whether the device knows the changed torque: it knows a limit, but not an error of a sensor.
    const TOLD: bool = true;

    /// The angle that is passed on to the law's side, rad.
    #[inline(always)]
    fn angle_rad(&mut self, angle_rad: f64) -> f64 {
        angle_rad
    }

    /// The torque that is passed on to the motor, N·m along `+x`.
    #[inline(always)]
    fn torque_n_m(&mut self, torque_n_m: f64) -> f64 {
        torque_n_m
    }
}

/// A stage around the rest of the law's side. The nearer to the world an effect is, the further outside it stands.
pub struct Staged<S> {
    stage: S,
    inner: Box<dyn Control>,
}

impl<S: Stage + 'static> Staged<S> {
    /// Puts a stage around the present loop.
    #[must_use]
    pub fn around(inner: Box<dyn Control>, stage: S) -> Box<dyn Control> {
        Box::new(Self { stage, inner })
    }
}

impl<S: Stage> Staged<S> {
    /// The torque after this stage; if it differs, the inner stages learn of it.
    #[inline(always)]
    fn passed_on(&mut self, wanted_n_m: f64) -> f64 {
        let torque_n_m = self.stage.torque_n_m(wanted_n_m);
        if S::TOLD && torque_n_m != wanted_n_m {
            tell(self.inner.as_mut(), torque_n_m);
        }
        torque_n_m
    }
}

/// Apart, so that a tick in which the stage changes nothing does not make room for the call.
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

/// A largest torque.
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

/// An amplifier with steps: the torque becomes the nearest step.
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
