//! `touchstone config environment`: shows or changes what a board renders besides the wall (further walls, detents, end stops), in
//! the form of a scene file.

use crate::number;
use crate::out::{self, say, tell};
use touchstone_control::Si;
use touchstone_control::environment::Side;
use touchstone_device::Client;
use touchstone_protocol::settings::environment::{
    CountsFrom, DetentsBeside, Points, ProfileBeside, Surround, TravelEnds, WallBeside,
};
use touchstone_protocol::settings::parts::Parts;
use touchstone_protocol::{Board, Decimal, DeviceSettings, Reply, Request};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::{self, DetentRing, Endstops, FurtherWall, Scene, TorqueProfile};

/// Options of the command `touchstone config environment`.
#[derive(Debug, Clone, clap::Args)]
pub struct EnvironmentOptions {
    /// A scene, by file or name, whose `[environment]` (walls, detents, end stops) is sent. Without it, the options change the
    /// device's own environment.
    scene: Option<String>,
    /// Changes a field of the environment, e.g. environment.detents.strength_n_m=0.02; may be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Removes everything but the wall.
    #[arg(long, conflicts_with_all = ["scene", "sets"])]
    wall_alone: bool,
    /// Limit on the rate at which the force changes while the new environment replaces the old one under a hand, N·m/s.
    #[arg(long, value_name = "N_M_PER_S", allow_negative_numbers = true, value_parser = number::not_negative("in N·m/s"))]
    change: Option<f64>,
}

impl EnvironmentOptions {
    const fn changes(&self) -> bool {
        self.scene.is_some() || !self.sets.is_empty() || self.wall_alone || self.change.is_some()
    }
}

/// Prints the environment (walls, detents, end stops) of the device, or sends a new one to the device.
pub fn main(client: &mut Client, options: &EnvironmentOptions) -> Result<()> {
    let board = client.identity().board;
    if !board.is_large() {
        return Err(small(client.place(), board));
    }
    let before = match client.ask(&Request::Environment)? {
        Reply::Environment(environment) => environment,
        other => return Err(client.odd(&other)),
    };
    if !options.changes() {
        return out::result(|| json(&before), || shown(&before));
    }
    let settings = client.settings()?;
    let after = wanted(options, &before, &settings)?;
    // The device's own check, made here, so that the error names the option's path.
    if let Err(error) = after.check(&settings) {
        return Err(Error::Option {
            option: error.path.into(),
            problem: error.to_string(),
            fix: "choose another value; no setting was changed".into(),
        });
    }
    let from = match client.ask(&Request::SetEnvironment(after))? {
        Reply::Taken(from) => from,
        other => return Err(client.odd(&other)),
    };
    let when = match from {
        CountsFrom::NextTick => "at work now",
        CountsFrom::Arming => "takes effect when the device is armed next",
        CountsFrom::Calibration => {
            "takes effect from the next calibration on, with the settings that it was checked with"
        }
    };
    out::result(
        || serde_json::json!({ "environment": json(&after), "counts": when }),
        || {
            shown(&after)?;
            tell!("{when}; to keep it after a restart: touchstone config save");
            Ok(())
        },
    )
}

/// The error for a board without memory for an environment (further walls, detents, end stops), with the remedy.
fn small(place: &str, board: Board) -> Error {
    let fix = "use a NUCLEO-G474RE for it; on this board, `touchstone config set wall.surface_rad` moves its one wall";
    let problem = format!(
        "{} has one wall: further walls and detents do not fit into its 128 KiB of flash",
        board.name()
    );
    Error::device(place, problem, fix)
}

/// The environment (walls, detents, end stops) that the options request: the device's present one with the requested changes.
fn wanted(
    options: &EnvironmentOptions,
    before: &Surround,
    settings: &DeviceSettings,
) -> Result<Surround> {
    let mut after = if options.wall_alone {
        Surround::default()
    } else if options.scene.is_some() || !options.sets.is_empty() {
        let mut scene = match &options.scene {
            Some(name) => {
                let scene = Scene::load(name)?;
                crate::scene_options::say_notes(&scene);
                scene
            }
            None => {
                let mut scene = Scene::load("thesis-knob")?;
                scene.environment = Some(as_scene(before));
                scene
            }
        };
        // The environment is checked against the force limit of the device, not that of the scene.
        scene.law.force_limit_n_m = settings.law.force_limit_n_m.to_num();
        let scene = scene.with_overrides(&options.sets)?;
        of_scene(&scene.environment.unwrap_or_default())
    } else {
        *before
    };
    after.change_n_m_per_s = match options.change {
        Some(rate) => decimal(rate),
        None => before.change_n_m_per_s,
    };
    Ok(after)
}

fn decimal(value: f64) -> Decimal {
    Decimal(Si::saturating_from_num(value))
}

fn plain(value: Decimal) -> f64 {
    // Rounded to nine decimals, as a person wrote it: the fixed-point format has more digits.
    let value: f64 = value.0.to_num();
    format!("{value:.9}").parse().unwrap_or(value)
}

/// Converts the environment (walls, detents, end stops) of a scene file to the format of a board.
pub fn of_scene(named: &scene::Environment) -> Surround {
    let further = |wall: &Option<FurtherWall>| {
        wall.as_ref().map(|wall| WallBeside {
            at_rad: decimal(wall.at_rad),
            below: wall.solid == Side::Below,
            stiffness_n_m_per_rad: wall.stiffness_n_m_per_rad.map(decimal),
        })
    };
    Surround {
        first_wall: named.first_wall,
        further: [&named.wall2, &named.wall3, &named.wall4].map(further),
        endstops: named.endstops.as_ref().map(|ends| TravelEnds {
            lower_rad: decimal(ends.lower_rad),
            upper_rad: decimal(ends.upper_rad),
            stiffness_n_m_per_rad: ends.stiffness_n_m_per_rad.map(decimal),
        }),
        // Detents without torque are sent too: they number the positions of a knob that turns freely.
        detents: named.detents.as_ref().map(|ring| DetentsBeside {
            per_rev: u16::try_from(ring.per_rev).unwrap_or(u16::MAX),
            pitch_rad: decimal(ring.pitch_rad),
            strength_n_m: decimal(ring.strength_n_m),
            centre_rad: decimal(ring.centre_rad),
        }),
        profile: named.acting_profile().and_then(|profile| {
            Some(ProfileBeside {
                per_rev: u16::try_from(profile.per_rev).unwrap_or(u16::MAX),
                start_rad: decimal(profile.start_rad),
                end_rad: decimal(profile.end_rad),
                strength_n_m: decimal(profile.strength_n_m),
                // A scene's points are in their range.
                shape: Points(profile.points().ok()?),
            })
        }),
        parts: Parts(named.feel()),
        ..Surround::default()
    }
}

/// Converts the environment (walls, detents, end stops) of a board to the format of a scene file.
pub fn as_scene(there: &Surround) -> scene::Environment {
    let further = |wall: Option<WallBeside>| {
        wall.map(|wall| FurtherWall {
            at_rad: plain(wall.at_rad),
            solid: if wall.below { Side::Below } else { Side::Above },
            stiffness_n_m_per_rad: wall.stiffness_n_m_per_rad.map(plain),
        })
    };
    let [wall2, wall3, wall4] = there.further.map(further);
    scene::Environment {
        first_wall: there.first_wall,
        wall2,
        wall3,
        wall4,
        endstops: there.endstops.map(|ends| Endstops {
            lower_rad: plain(ends.lower_rad),
            upper_rad: plain(ends.upper_rad),
            stiffness_n_m_per_rad: ends.stiffness_n_m_per_rad.map(plain),
        }),
        detents: there.detents.map(|ring| DetentRing {
            per_rev: ring.per_rev.into(),
            // A board has the pitch 0 if the detents are given per turn; a scene may not have a pitch of 0.
            pitch_rad: match plain(ring.pitch_rad) {
                0.0 => DetentRing::default().pitch_rad,
                pitch_rad => pitch_rad,
            },
            strength_n_m: plain(ring.strength_n_m),
            centre_rad: plain(ring.centre_rad),
        }),
        profile: there.profile.map(|profile| TorqueProfile {
            per_rev: profile.per_rev.into(),
            start_rad: plain(profile.start_rad),
            end_rad: plain(profile.end_rad),
            strength_n_m: plain(profile.strength_n_m),
            shape: TorqueProfile::of_points(&profile.shape.0),
        }),
        ..scene::Environment::default()
    }
    .with_feel(&there.parts.0)
}

fn json(environment: &Surround) -> serde_json::Value {
    serde_json::json!({
        "environment": as_scene(environment),
        "change_n_m_per_s": plain(environment.change_n_m_per_s),
    })
}

/// Prints an environment (walls, detents, end stops) as TOML, in the form of a scene file.
fn shown(environment: &Surround) -> Result<()> {
    // Not through a JSON value, which stores numbers differently from TOML.
    let environment_table = toml::Value::try_from(as_scene(environment));
    let table: toml::Table = environment_table
        .into_iter()
        .map(|table| ("environment".to_owned(), table))
        .collect();
    let text = toml::to_string(&table).unwrap_or_default();
    say!("{}", text.trim_end());
    say!(
        "# a force changes by at most {} N·m/s under a hand",
        plain(environment.change_n_m_per_s)
    );
    Ok(())
}
