//! The loops of a page: opened by a scene's text, moved by the hand's rest point, read as rows of numbers.

use std::path::Path;
use touchstone_control::Choice as _;
use touchstone_control::environment::Side;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::run;
use touchstone_sim::run::live::{Live, Moment};
use touchstone_sim::scene::{MotionSpec, Preset, RestPath, Scene};

/// Numbers of a tick, in their order: the columns of a trace, as files of this program have them, then what only the page shows.
pub const ROW: [&str; 17] = [
    "time_s",
    "angle_rad",
    "velocity_rad_per_s",
    "angle_measured_rad",
    "hand_rad",
    "rest_rad",
    "force_n_m",
    "surface_rad",
    "surface_shifted_rad",
    "mass_rad",
    "energy_observed_j",
    "energy_true_j",
    "energy_device_loss_j",
    "guard_account_j",
    "motor_force_n_m",
    "energy_hand_j",
    // 0: the guard lets the law's force through, or there is none; 1: it gives less; 2: it has switched the force off.
    "guard_acts",
];

/// How many of [`ROW`] are the columns of a trace.
pub const TRACE_COLUMNS: usize = 14;

/// Numbers of a loop that stay until it is changed.
pub const FACTS: [&str; 19] = [
    "rate_hz",
    "surface_rad",
    "k_desired_n_m_per_rad",
    "k_critical_n_m_per_rad",
    // Rest point's shift for one newton metre of static torque against the desired stiffness; 0 without a hand.
    "reach_rad_per_n_m",
    "angle_rad",
    // Length of the scene's own motion, s; 0 where it has none.
    "motion_s",
    "encoder_step_rad",
    // 1: there is a wall at `surface_rad`, solid above it; 0: there is none.
    "has_wall",
    // What there is beside it; NaN: it is not there. A side is 1 where a wall is solid above its surface, -1 where below.
    "wall2_rad",
    "wall2_side",
    "wall3_rad",
    "wall3_side",
    "wall4_rad",
    "wall4_side",
    "lower_end_rad",
    "upper_end_rad",
    // Detents in a turn; 0: none.
    "detents_per_rev",
    "detent_rad",
];

/// One loop.
struct Place {
    live: Live,
    /// The motion of the scene's own hand, and its length.
    motion: Option<(RestPath, f64)>,
    scene: Scene,
    row: [f64; ROW.len()],
    facts: [f64; FACTS.len()],
}

/// The loops of a page.
#[derive(Default)]
pub struct Desk {
    places: Vec<Option<Place>>,
}

/// Reads a scene from a page: its TOML text or the name of a shipped scene, a zero byte, and changes `key=value`, one a line. A
/// change `preset=NAME` comes before all others, as the option of that name does.
///
/// # Errors
/// The first problem in the text or in the changes.
pub fn scene(text: &str) -> Result<Scene> {
    let (base, changes) = text.split_once('\0').unwrap_or((text, ""));
    let base = if base.contains('=') {
        Scene::parse(base, Path::new("scene.toml"))?
    } else {
        Scene::load(base)?
    };
    let mut preset = Preset::default();
    let mut sets = Vec::new();
    for line in changes.lines().filter(|line| !line.is_empty()) {
        match line.strip_prefix("preset=") {
            Some(word) => {
                preset = Preset::of_word(word).ok_or_else(|| Error::Option {
                    option: format!("--preset {word}"),
                    problem: "there is none of this name".into(),
                    fix: format!("give {}", Preset::WORDS.join(" or ")),
                })?;
            }
            None => sets.push(line),
        }
    }
    base.with_preset(preset)?.with_overrides(&sets)
}

impl Place {
    fn of(scene: Scene, live: Live) -> Result<Self> {
        let motion = match &scene.operator.motion {
            // A page has no files.
            MotionSpec::None | MotionSpec::Recorded(_) => None,
            _ => Some((RestPath::from_scene(&scene)?, scene.timing.duration_s)),
        };
        let k_desired = scene.wall.k_desired_n_m_per_rad;
        let rate_hz = f64::from(scene.timing.rate_hz);
        let reach = scene
            .operator
            .hand()
            .map_or(0.0, |hand| hand.compliance_rad_per_n_m() + 1.0 / k_desired);
        let around = scene.environment.clone().unwrap_or_default();
        let [wall2, wall3, wall4] = [&around.wall2, &around.wall3, &around.wall4].map(|wall| {
            wall.as_ref()
                .map_or([f64::NAN; 2], |wall| [wall.at_rad, sign(wall.solid)])
        });
        let (lower, upper) = (around.endstops.as_ref()).map_or((f64::NAN, f64::NAN), |ends| {
            (ends.lower_rad, ends.upper_rad)
        });
        let (per_rev, detent) = (around.detents.as_ref()).map_or((0.0, 0.0), |ring| {
            let per_rev = match ring.per_rev {
                0 => std::f64::consts::TAU / ring.pitch_rad,
                per_rev => f64::from(per_rev),
            };
            (per_rev, ring.centre_rad)
        });
        let facts = [
            rate_hz,
            scene.wall.surface_rad,
            k_desired,
            2.0 * scene.law.device_damping_n_m_s_per_rad * rate_hz,
            reach,
            live.angle_rad(),
            motion.as_ref().map_or(0.0, |(_, length_s)| *length_s),
            scene
                .encoder
                .as_ref()
                .map_or(0.0, |encoder| encoder.step_rad()),
            f64::from(u8::from(around.first_wall)),
            wall2[0],
            wall2[1],
            wall3[0],
            wall3[1],
            wall4[0],
            wall4[1],
            lower,
            upper,
            per_rev,
            detent,
        ];
        Ok(Self {
            live,
            motion,
            scene,
            row: [f64::NAN; ROW.len()],
            facts,
        })
    }
}

fn sign(side: Side) -> f64 {
    match side {
        Side::Above => 1.0,
        Side::Below => -1.0,
    }
}

fn row(moment: &Moment, surface_rad: f64) -> [f64; ROW.len()] {
    let Moment { tick, energies } = moment;
    let guard = tick.inside.guard;
    [
        tick.time_s,
        tick.angle_rad,
        tick.velocity_rad_per_s,
        tick.told_rad + surface_rad,
        tick.hand_rad,
        tick.rest_rad,
        tick.force_n_m,
        surface_rad,
        surface_rad - tick.inside.offset_rad,
        tick.inside
            .mass_rad
            .map_or(tick.angle_rad, |mass| mass + surface_rad),
        tick.inside.energy_j,
        energies.wall_j,
        energies.device_loss_j,
        guard.map_or(f64::NAN, |guard| guard.account_j),
        tick.motor_force_n_m,
        energies.hand_j(),
        guard.map_or(0.0, |guard| match (guard.tripped, guard.limited) {
            (true, _) => 2.0,
            (false, limited) => f64::from(u8::from(limited)),
        }),
    ]
}

impl Desk {
    fn place(&mut self, handle: usize) -> Option<&mut Place> {
        self.places.get_mut(handle)?.as_mut()
    }

    /// Opens a loop at its scene's start; returns its handle.
    ///
    /// # Errors
    /// The problem of the scene.
    pub fn open(&mut self, text: &str) -> Result<usize> {
        let scene = scene(text)?;
        let live = Live::new(&scene)?;
        let place = Some(Place::of(scene, live)?);
        let free = self.places.iter().position(Option::is_none);
        let handle = free.unwrap_or(self.places.len());
        match free {
            Some(free) => self.places[free] = place,
            None => self.places.push(place),
        }
        Ok(handle)
    }

    /// Closes a loop; its handle may be given again.
    pub fn close(&mut self, handle: usize) {
        if let Some(place) = self.places.get_mut(handle) {
            *place = None;
        }
    }

    /// Goes on with another scene from where device and hand are.
    ///
    /// # Errors
    /// The problem of the scene; the loop goes on unchanged.
    pub fn change(&mut self, handle: usize, text: &str) -> Result<()> {
        let scene = scene(text)?;
        let place = self.place(handle).ok_or_else(|| closed(handle))?;
        let live = place.live.changed(&scene)?;
        *place = Place::of(scene, live)?;
        Ok(())
    }

    /// Starts again from the scene's start.
    ///
    /// # Errors
    /// No other errors than opening.
    pub fn reset(&mut self, handle: usize) -> Result<()> {
        let place = self.place(handle).ok_or_else(|| closed(handle))?;
        place.live = Live::new(&place.scene)?;
        place.row = [f64::NAN; ROW.len()];
        Ok(())
    }

    /// Runs one tick with the hand's rest point here, rad; returns the numbers of [`ROW`].
    pub fn tick(&mut self, handle: usize, rest_rad: f64) -> Option<&[f64; ROW.len()]> {
        let place = self.place(handle)?;
        let moment = place.live.tick(rest_rad);
        place.row = row(&moment, place.scene.wall.surface_rad);
        Some(&place.row)
    }

    /// The scene's own rest point at a time, rad; NaN where it has no motion.
    pub fn own_rest_rad(&mut self, handle: usize, time_s: f64) -> f64 {
        self.place(handle)
            .and_then(|place| place.motion.as_ref())
            .map_or(f64::NAN, |(motion, _)| motion.rest_rad(time_s))
    }

    /// The numbers of [`FACTS`].
    pub fn facts(&mut self, handle: usize) -> Option<&[f64; FACTS.len()]> {
        self.place(handle).map(|place| &place.facts)
    }

    /// The scene with all its values and their meanings, as TOML.
    #[must_use]
    pub fn printed(&mut self, handle: usize) -> String {
        self.place(handle)
            .map(|place| place.scene.to_toml())
            .unwrap_or_default()
    }

    /// The scene that repeats the ticks since the start, with this file of their rest points, as TOML.
    #[must_use]
    pub fn replay(&mut self, handle: usize, file: &str) -> String {
        self.place(handle)
            .map(|place| place.live.replay(Path::new(file)).to_toml())
            .unwrap_or_default()
    }

    /// The passivity bounds that the scene's settings violate, a line each.
    #[must_use]
    pub fn warnings(&mut self, handle: usize) -> String {
        let said = self
            .place(handle)
            .and_then(|place| run::spoken_warnings(&place.scene).ok());
        said.unwrap_or_default()
            .iter()
            .map(|message| format!("{message}\n"))
            .collect()
    }
}

fn closed(handle: usize) -> Error {
    Error::device(
        format!("loop {handle}"),
        "is not open",
        "open it with a scene",
    )
}
