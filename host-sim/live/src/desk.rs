//! The simulated control loops that a web page shows. A loop is opened from a scene (TOML text that describes a simulation). The
//! page moves the rest point of the hand's spring, and each tick (control period) returns a row of numbers.

use std::path::Path;
use touchstone_control::Choice as _;
use touchstone_control::environment::Side;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::run;
use touchstone_sim::run::live::{Live, Moment};
use touchstone_sim::scene::{MotionSpec, Preset, RestPath, Scene};

/// Names of the numbers that one tick (control period) returns, in their order. The columns of this program's trace files come
/// first, then the numbers that only the page shows.
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
    // 0: the energy guard changes nothing, or there is none; 1: it reduces the force; 2: it has switched the force off.
    "guard_acts",
];

/// Number of leading entries of [`ROW`] that are columns of a trace file.
pub const TRACE_COLUMNS: usize = 14;

/// Names of the numbers that describe a simulated loop and change only when its scene (description of the simulation) changes.
pub const FACTS: [&str; 19] = [
    "rate_hz",
    "surface_rad",
    "k_desired_n_m_per_rad",
    "k_critical_n_m_per_rad",
    // Shift of the hand's rest point for 1 N·m of static torque against a wall of the desired stiffness; 0 without a hand.
    "reach_rad_per_n_m",
    "angle_rad",
    // Duration of the hand motion in the scene file, s; 0 without one.
    "motion_s",
    "encoder_step_rad",
    // 1: there is a wall at `surface_rad`, solid above it; 0: there is none.
    "has_wall",
    // Further walls and end stops; NaN for one that does not exist. A side is 1 for a wall that is solid above its surface, -1 for
    // one that is solid below.
    "wall2_rad",
    "wall2_side",
    "wall3_rad",
    "wall3_side",
    "wall4_rad",
    "wall4_side",
    "lower_end_rad",
    "upper_end_rad",
    // Detents per turn; 0: none.
    "detents_per_rev",
    "detent_rad",
];

/// One simulated control loop of the page.
struct Place {
    live: Live,
    /// The hand motion that the simulation's scene file prescribes, and its duration in seconds; `None` without one, and for a
    /// recorded motion, which a page cannot read.
    motion: Option<(RestPath, f64)>,
    scene: Scene,
    row: [f64; ROW.len()],
    facts: [f64; FACTS.len()],
}

/// All simulated control loops of a page. Each loop is named by a number, its handle.
#[derive(Default)]
pub struct Desk {
    places: Vec<Option<Place>>,
}

/// Reads a scene (description of a simulation) that a page sent: its TOML text or the name of a shipped scene, a zero byte, then
/// changes `key=value`, one per line. A change `preset=NAME` is applied before all others, like the command line's option
/// `--preset`.
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
                    problem: "there is no preset of this name".into(),
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
            // A browser's page cannot read files.
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

    /// Opens a simulated loop at the start of the scene (TOML description of the simulation) in `text`; returns the loop's handle.
    ///
    /// # Errors
    /// The first problem in the description.
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

    /// Closes the simulated loop with this handle. A loop that is opened later may get the same handle.
    pub fn close(&mut self, handle: usize) {
        if let Some(place) = self.places.get_mut(handle) {
            *place = None;
        }
    }

    /// Replaces the scene (TOML description of the simulation) of a running loop by the one in `text`; the simulated device and
    /// hand keep their positions.
    ///
    /// # Errors
    /// The handle is unknown, or the first problem in the new description; the loop then continues with the old one.
    pub fn change(&mut self, handle: usize, text: &str) -> Result<()> {
        let scene = scene(text)?;
        let place = self.place(handle).ok_or_else(|| closed(handle))?;
        let live = place.live.changed(&scene)?;
        *place = Place::of(scene, live)?;
        Ok(())
    }

    /// Restarts a simulated loop from the beginning of its simulation.
    ///
    /// # Errors
    /// The handle is unknown, or the same as for opening the loop.
    pub fn reset(&mut self, handle: usize) -> Result<()> {
        let place = self.place(handle).ok_or_else(|| closed(handle))?;
        place.live = Live::new(&place.scene)?;
        place.row = [f64::NAN; ROW.len()];
        Ok(())
    }

    /// Runs one control period with the rest point of the hand's spring at `rest_rad`, in radians. Returns the numbers named in
    /// [`ROW`]; `None` for an unknown handle.
    pub fn tick(&mut self, handle: usize, rest_rad: f64) -> Option<&[f64; ROW.len()]> {
        let place = self.place(handle)?;
        let moment = place.live.tick(rest_rad);
        place.row = row(&moment, place.scene.wall.surface_rad);
        Some(&place.row)
    }

    /// Rest point of the hand's spring at `time_s`, in radians, in the hand motion that the loop's scene file prescribes. NaN
    /// without such a motion, for a recorded one, and for an unknown handle.
    pub fn own_rest_rad(&mut self, handle: usize, time_s: f64) -> f64 {
        self.place(handle)
            .and_then(|place| place.motion.as_ref())
            .map_or(f64::NAN, |(motion, _)| motion.rest_rad(time_s))
    }

    /// The numbers named in [`FACTS`], which describe the simulated loop and change only with its settings; `None` for an unknown
    /// handle.
    pub fn facts(&mut self, handle: usize) -> Option<&[f64; FACTS.len()]> {
        self.place(handle).map(|place| &place.facts)
    }

    /// The loop's scene (description of the simulation) as TOML text, with every value and a comment on its meaning.
    #[must_use]
    pub fn printed(&mut self, handle: usize) -> String {
        self.place(handle)
            .map(|place| place.scene.to_toml())
            .unwrap_or_default()
    }

    /// Returns a TOML description of a simulation that repeats the loop's control periods since its start. `file` is the name of
    /// the file that holds the rest point of the hand's spring in every control period.
    #[must_use]
    pub fn replay(&mut self, handle: usize, file: &str) -> String {
        self.place(handle)
            .map(|place| place.live.replay(Path::new(file)).to_toml())
            .unwrap_or_default()
    }

    /// The passivity conditions (bounds on stiffness and damping) that the loop's settings violate, as text, one per line.
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
