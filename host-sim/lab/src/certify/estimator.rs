//! The control crate's state estimator as a linear system, with its own coefficients in `f64`. The limits beyond which the
//! estimator restarts are left out.

use touchstone_control::estimator::EstimatedMotion;
use touchstone_control::law::Sample;
use touchstone_control::{Controller, Position, States};
use touchstone_sim::error::Result;
use touchstone_sim::run::settings;
use touchstone_sim::scene::Scene;

/// The state estimator of a scene as a linear system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimator(touchstone_control::Estimator<f64>);

impl Estimator {
    /// Number of states: penetration, displacement per tick, push of the hand, and the last three forces, the latest first.
    pub const ORDER: usize = 6;

    /// The state estimator of a scene's law; `None` if the law uses measured states.
    ///
    /// # Errors
    /// The estimator does not accept its settings.
    pub fn of(scene: &Scene) -> Result<Option<Self>> {
        let controller = Controller::<f64>::new(&scene.settings()?)
            .map_err(|error| settings::refused(scene, &error))?;
        Ok(match controller.states {
            States::Measured { .. } => None,
            States::Estimated(estimator, _) => Some(Self(estimator)),
        })
    }

    /// Updates the estimator's state by a measured penetration, and returns the control law's input. The caller must then pass the
    /// law's force to [`Estimator::command`].
    pub fn update(&self, state: &mut [f64], measured: f64) -> Sample<f64> {
        let (estimate, commands) = state.split_at_mut(3);
        let commands = [commands[0], commands[1], commands[2]];
        let before = EstimatedMotion {
            position: estimate[0],
            moved: estimate[1],
            pushed: estimate[2],
        };
        let (position, moved) = self.0.tick.apply(&before, &commands);
        let surprise = measured - position;
        let [of_position, of_moved, of_pushed] = self.0.correction;
        let after = EstimatedMotion {
            position: position + of_position * surprise,
            moved: moved + of_moved * surprise,
            pushed: before.pushed + of_pushed * surprise,
        };
        estimate.copy_from_slice(&[after.position, after.moved, after.pushed]);
        let (e, moved) = self.0.ahead.apply(&after, &commands);
        Sample {
            e: Position(e),
            moved: Position(moved),
        }
    }

    /// Passes to the estimator the force that the law commands for this sample, N·m (N on three axes).
    pub fn command(&self, state: &mut [f64], force: f64) {
        let forces = &mut state[3..];
        forces.rotate_right(1);
        forces[0] = force;
    }
}
