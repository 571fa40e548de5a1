//! Scene to plan: which plant and which once-per-tick effects the loop is compiled for.
//!
//! The plan picks types, one effect after the other; the loop at the end is a separate piece of code for each combination.
//! An effect that the scene does not name is therefore not a branch that is never taken: it is not there.

use super::chain::{
    Amplifier, Counts, Crossing, Delayed, ExactAngle, Ideal, Limited, Prompt, Sensor, Stepped,
};
use super::wall::Wall;
use crate::error::{Error, Result};
use crate::scene::{Motion, Scene};
use touchstone_world::plant::{
    self, BareCoulomb, BareLinear, HeldCoulomb, HeldLinear, Motion as _, State, Stepper,
};

/// The mechanical part with its effects chosen; what a [`Visitor`] gets.
pub struct Prepared<C: Crossing, S: Sensor, A: Amplifier> {
    /// Plant and computational delay.
    pub crossing: C,
    /// State at the start.
    pub state: <C::Plant as Stepper>::State,
    /// Encoder.
    pub sensor: S,
    /// Torque limit and amplifier steps.
    pub amplifier: A,
}

/// Something to be done with a prepared scene, whatever types it has come to.
pub trait Visitor {
    /// What it leaves.
    type Output;
    /// Does it. Compiled once for each combination of effects.
    fn visit<C: Crossing, S: Sensor, A: Amplifier>(
        self,
        prepared: Prepared<C, S, A>,
        wall: &mut dyn Wall,
        motion: &Motion,
    ) -> Self::Output;
}

/// Device of a scene, for the plant.
#[must_use]
pub fn device(scene: &Scene) -> plant::Device {
    plant::Device {
        inertia: scene.device.inertia_kg_m2,
        damping: scene.device.damping_n_m_s_per_rad,
        friction: scene
            .device
            .friction
            .as_ref()
            .map(|friction| plant::Coulomb {
                kinetic: friction.kinetic_n_m,
                breakaway: friction.static_n_m(),
            }),
    }
}

/// Hand of a scene, for the plant.
#[must_use]
pub fn hand(scene: &Scene) -> Option<plant::Hand> {
    scene.operator.hand().map(|hand| plant::Hand {
        inertia: hand.inertia_kg_m2,
        damping: hand.damping_n_m_s_per_rad,
        stiffness: hand.stiffness_n_m_per_rad,
        pad_damping: hand.pad_damping_n_m_s_per_rad,
        pad_stiffness: hand.pad_stiffness_n_m_per_rad,
    })
}

/// Prepares the scene and hands it to the visitor.
///
/// # Errors
/// A plant that cannot be built; a recording that cannot be read.
pub fn prepare<V: Visitor>(scene: &Scene, wall: &mut dyn Wall, visitor: V) -> Result<V::Output> {
    let motion = Motion::from_scene(scene)?;
    let device = device(scene);
    let hand = hand(scene);
    let rest = (
        scene.start_rad(&motion),
        scene.device.initial_velocity_rad_per_s,
    );
    let next = Next {
        scene,
        wall,
        visitor,
        motion: &motion,
    };
    let bare = |s: [f64; 2]| State::from_array(s);
    let held = |s: [f64; 4]| State::from_array(s);
    match (hand, device.friction.is_some()) {
        (None, false) => next.delay(|h| BareLinear::new(&device, h), bare([rest.0, rest.1])),
        (None, true) => next.delay(|h| BareCoulomb::new(&device, h), bare([rest.0, rest.1])),
        (Some(hand), false) => next.delay(
            |h| HeldLinear::new(&device, &hand, h),
            held([rest.0, rest.1, rest.0, rest.1]),
        ),
        (Some(hand), true) => next.delay(
            |h| HeldCoulomb::new(&device, &hand, h),
            held([rest.0, rest.1, rest.0, rest.1]),
        ),
    }
}

struct Next<'a, V> {
    scene: &'a Scene,
    wall: &'a mut dyn Wall,
    visitor: V,
    motion: &'a Motion,
}

impl<V: Visitor> Next<'_, V> {
    fn delay<S: Stepper>(
        self,
        plant: impl Fn(f64) -> std::result::Result<S, plant::Invalid>,
        state: S::State,
    ) -> Result<V::Output> {
        let scene = self.scene;
        let period = scene.timing.period_s();
        let delay = scene.timing.computational_delay_s;
        let built = |interval| plant(interval).map_err(|invalid| refused(scene, &invalid));
        debug_assert!(state.position().is_finite());
        if delay == 0.0 {
            return Ok(self.sensor(Prompt(built(period)?), state));
        }
        let whole = (delay / period).floor();
        let fraction = delay - whole * period;
        let crossing = Delayed::new(built(fraction)?, built(period - fraction)?, whole as usize);
        Ok(self.sensor(crossing, state))
    }

    fn sensor<C: Crossing>(self, crossing: C, state: <C::Plant as Stepper>::State) -> V::Output {
        let surface_rad = self.scene.wall.surface_rad;
        match &self.scene.encoder {
            None => self.limit(crossing, state, ExactAngle { surface_rad }),
            Some(encoder) => {
                let step_rad = encoder.step_rad();
                self.limit(
                    crossing,
                    state,
                    Counts {
                        per_rad: 1.0 / step_rad,
                        step_rad,
                        surface_rad,
                    },
                )
            }
        }
    }

    fn limit<C: Crossing, S: Sensor>(
        self,
        crossing: C,
        state: <C::Plant as Stepper>::State,
        sensor: S,
    ) -> V::Output {
        match self.scene.device.torque_limit_n_m {
            None => self.steps(crossing, state, sensor, Ideal),
            Some(limit_n_m) => self.steps(
                crossing,
                state,
                sensor,
                Limited {
                    inner: Ideal,
                    limit_n_m,
                },
            ),
        }
    }

    fn steps<C: Crossing, S: Sensor, A: Amplifier>(
        self,
        crossing: C,
        state: <C::Plant as Stepper>::State,
        sensor: S,
        amplifier: A,
    ) -> V::Output {
        match self.scene.device.amplifier_step_n_m {
            None => self.visit(Prepared {
                crossing,
                state,
                sensor,
                amplifier,
            }),
            Some(step_n_m) => self.visit(Prepared {
                crossing,
                state,
                sensor,
                amplifier: Stepped {
                    inner: amplifier,
                    step_n_m,
                },
            }),
        }
    }

    fn visit<C: Crossing, S: Sensor, A: Amplifier>(self, prepared: Prepared<C, S, A>) -> V::Output {
        self.visitor.visit(prepared, self.wall, self.motion)
    }
}

/// A plant's refusal, at its place in the scene.
fn refused(scene: &Scene, invalid: &plant::Invalid) -> Error {
    // The plant speaks of positions and forces of any kind, the scene of angles and torques.
    let path = match invalid.field {
        "inertia" => "device.inertia_kg_m2",
        "damping" => "device.damping_n_m_s_per_rad",
        "kinetic" => "device.friction.kinetic_n_m",
        "breakaway" => "device.friction.static_n_m",
        "hand.inertia" => "operator.hand.inertia_kg_m2",
        "hand.damping" => "operator.hand.damping_n_m_s_per_rad",
        "hand.stiffness" => "operator.hand.stiffness_n_m_per_rad",
        "hand.pad_damping" => "operator.hand.pad_damping_n_m_s_per_rad",
        "hand.pad_stiffness" => "operator.hand.pad_stiffness_n_m_per_rad",
        _ => "device",
    };
    scene.error(
        path,
        format!("{} is not usable", invalid.value),
        format!("give {}", invalid.needs),
    )
}
