//! Runs the environment of a scene (several walls, detents, a torque profile) in the loop, in any number format.

use super::chain::{Control, Counts, ExactPlace, Sampled};
use super::settings;
use super::wall::{Inside, Wall, inside};
use crate::error::{Error, Result};
use crate::scene::Scene;
use touchstone_control::environment::{
    Counted, DetentSettings, Environment, Extent, Face, ProfileSettings, Reached, Reading, Refused,
    Side, Spacing, WallSettings,
};
use touchstone_control::{CountScale, Field, Force, Position, Reported, Si};

/// An environment of several walls, with the scale from encoder counts to positions. It receives positions instead of penetrations,
/// because each wall has its own surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surroundings<N: Reported> {
    environment: Environment<N>,
    scale: CountScale,
    /// Position at which the motor's torque last changed; `None` if that position is not measured.
    changed: Option<Changed>,
}

/// Position at which the motor's torque changed: an encoder count, or an angle in rad.
#[derive(Debug, Clone, Copy)]
enum Changed {
    At(i64),
    AtPlace(f64),
}

/// A position in rad, for scenes without an encoder.
#[derive(Debug, Clone, Copy)]
pub struct Placed(pub f64);

impl<N: Reported> Reading<N> for Placed {
    fn angle(&self) -> Si {
        // The angle is NaN after the simulation diverged; the verdict of `Judge` is then unstable.
        match self.0.is_nan() {
            true => Si::ZERO,
            false => Si::saturating_from_num(self.0),
        }
    }

    fn penetration(&self, Reached { turns, face }: &Reached) -> Position<N> {
        let whole = f64::from(*turns) * std::f64::consts::TAU;
        let surface = whole + face.surface.to_num::<f64>();
        Position::from_f64(match face.side {
            Side::Above => self.0 - surface,
            Side::Below => surface - self.0,
        })
    }
}

impl<N: Reported> Surroundings<N> {
    fn counted(&self, count: i64) -> Counted {
        Counted {
            scale: self.scale,
            count,
        }
    }
}

impl<N: Reported> Wall for Surroundings<N> {
    fn at_count(&mut self, count: i64) -> f64 {
        let at = self.counted(count);
        let since_change = match self.changed {
            Some(Changed::At(changed)) => Some(self.scale.moved(count - changed)),
            _ => None,
        };
        self.environment.tick(&at, since_change).to_f64()
    }

    fn at_penetration(&mut self, place_rad: f64) -> f64 {
        let since_change = match self.changed {
            Some(Changed::AtPlace(changed)) => Some(Position::from_f64(place_rad - changed)),
            _ => None,
        };
        self.environment
            .tick(&Placed(place_rad), since_change)
            .to_f64()
    }

    fn commanded(&mut self, force_n_m: f64) {
        self.environment.commanded(Force::from_f64(force_n_m));
    }

    fn changed_at_count(&mut self, count: i64) {
        self.changed = Some(Changed::At(count));
    }

    fn changed_at_penetration(&mut self, place_rad: f64) {
        self.changed = Some(Changed::AtPlace(place_rad));
    }

    fn inside(&self) -> Inside {
        let view = self.environment.view();
        Inside {
            beyond_reach: self.environment.is_beyond_reach(),
            ..inside(view.as_ref(), self.environment.guard.as_ref())
        }
    }
}

/// The environment of a scene in a number format: its walls, detents, profile and the further parts of its feel.
///
/// # Errors
/// A setting that the control crate refuses, named by its field of the scene.
pub fn environment<N: Reported>(scene: &Scene) -> Result<Environment<N>> {
    let none = crate::scene::Environment::default();
    let named = scene.environment.as_ref().unwrap_or(&none);
    let own = scene.settings()?;
    let faces = faces(scene, named)?;
    let walls: Vec<WallSettings> = faces.iter().map(|(_, wall)| *wall).collect();
    let detents = match named.detents.as_ref().filter(|it| it.strength_n_m > 0.0) {
        None => None,
        Some(ring) => Some(DetentSettings {
            spacing: match ring.per_rev {
                0 => Spacing::Pitch(si(scene, "environment.detents.pitch_rad", ring.pitch_rad)?),
                per_rev => Spacing::PerTurn(u16::try_from(per_rev).unwrap_or(u16::MAX)),
            },
            strength: si(scene, "environment.detents.strength_n_m", ring.strength_n_m)?,
            centre: si(scene, "environment.detents.centre_rad", ring.centre_rad)?,
        }),
    };
    let refused = |refused| told(scene, &faces, &refused);
    let mut environment = Environment::new(&own, &walls, detents.as_ref()).map_err(refused)?;
    environment = environment
        .with_feel(&named.feel(), &own)
        .map_err(refused)?;
    if let Some(drawn) = named.acting_profile() {
        let profile = ProfileSettings {
            extent: match drawn.per_rev {
                0 => Extent::Until(si(scene, "environment.profile.end_rad", drawn.end_rad)?),
                per_rev => Extent::PerTurn(u16::try_from(per_rev).unwrap_or(u16::MAX)),
            },
            start: si(scene, "environment.profile.start_rad", drawn.start_rad)?,
            strength: si(
                scene,
                "environment.profile.strength_n_m",
                drawn.strength_n_m,
            )?,
            shape: drawn.points().map_err(refused)?,
        };
        environment = environment
            .with_profile(&profile, own.force_limit)
            .map_err(refused)?;
    }
    Ok(environment)
}

/// Builds the controller side of a scene that has an environment besides `[wall]`.
pub(super) fn surrounded<N: Reported + 'static>(
    scene: &Scene,
    scale: CountScale,
) -> Result<Box<dyn Control>>
where
    Surroundings<N>: Send,
{
    let wall = Surroundings::<N> {
        environment: environment(scene)?,
        scale: scale.before(Si::ZERO),
        changed: None,
    };
    let surface_rad = scene.wall.surface_rad;
    Ok(match &scene.encoder {
        None => Box::new(Sampled {
            sensor: ExactPlace { surface_rad },
            wall,
        }),
        Some(encoder) => Box::new(Sampled {
            sensor: Counts::of(encoder.step_rad(), surface_rad),
            wall,
        }),
    })
}

/// Settings of all walls in the scene, each with the name of the field that gives its stiffness.
fn faces(
    scene: &Scene,
    named: &crate::scene::Environment,
) -> Result<Vec<(&'static str, WallSettings)>> {
    let k = scene.wall.k_desired_n_m_per_rad;
    let mut places = Vec::new();
    if named.first_wall {
        let stiffness = "wall.k_desired_n_m_per_rad";
        places.push((
            "wall.surface_rad",
            scene.wall.surface_rad,
            Side::Above,
            stiffness,
            k,
        ));
    }
    for (table, wall) in named.further() {
        let [place, stiffness] = match table {
            "environment.wall2" => [
                "environment.wall2.at_rad",
                "environment.wall2.stiffness_n_m_per_rad",
            ],
            "environment.wall3" => [
                "environment.wall3.at_rad",
                "environment.wall3.stiffness_n_m_per_rad",
            ],
            _ => [
                "environment.wall4.at_rad",
                "environment.wall4.stiffness_n_m_per_rad",
            ],
        };
        let k = wall.stiffness_n_m_per_rad.unwrap_or(k);
        places.push((place, wall.at_rad, wall.solid, stiffness, k));
    }
    if let Some(stops) = &named.endstops {
        let k = stops.stiffness_n_m_per_rad.unwrap_or(k);
        let stiffness = "environment.endstops.stiffness_n_m_per_rad";
        let ends = [
            (
                "environment.endstops.lower_rad",
                stops.lower_rad,
                Side::Below,
            ),
            (
                "environment.endstops.upper_rad",
                stops.upper_rad,
                Side::Above,
            ),
        ];
        places.extend(ends.map(|(place, at, side)| (place, at, side, stiffness, k)));
    }
    let built = places.into_iter().map(|(place, at, side, stiffness, k)| {
        let wall = WallSettings {
            face: Face {
                surface: si(scene, place, at)?,
                side,
            },
            k_desired: si(scene, stiffness, k)?,
        };
        Ok((stiffness, wall))
    });
    built.collect()
}

fn si(scene: &Scene, path: &str, value: f64) -> Result<Si> {
    Si::checked_from_num(value)
        .ok_or_else(|| scene.error(path, "too large", "give a value below 2e9"))
}

/// Converts an error of the control crate about an environment to an error that names the field of the scene.
fn told(scene: &Scene, faces: &[(&'static str, WallSettings)], refused: &Refused) -> Error {
    match refused {
        Refused::Wall(place, error) => {
            let own = error
                .at(Field::KDesired)
                .then(|| faces.get(usize::from(*place)));
            match own.flatten() {
                Some((stiffness, _)) => scene.error(
                    stiffness,
                    error.to_string(),
                    "give a smaller value, or another law",
                ),
                None => settings::refused(scene, error),
            }
        }
        Refused::Law(error) => settings::refused(scene, error),
        Refused::Strength { .. } => scene.error(
            "environment.detents.strength_n_m",
            refused.to_string(),
            "give a value up to law.force_limit_n_m",
        ),
        Refused::ProfileStrength { .. }
        | Refused::Points(_)
        | Refused::Point(_)
        | Refused::Length(_) => scene.error(
            "environment.profile",
            refused.to_string(),
            "change that field of the profile",
        ),
        Refused::Part { path, .. } => {
            scene.error(path, refused.to_string(), "give a value in that range")
        }
        Refused::PartOfFormat { path, .. } => {
            scene.error(path, refused.to_string(), "give a smaller value")
        }
        // Too many walls, or detents with too small a pitch.
        _ => scene.error(
            "environment",
            refused.to_string(),
            "give fewer, or a coarser one",
        ),
    }
}
