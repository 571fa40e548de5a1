//! Everything to touch on one axis, for C programs: walls, detents, a spring to a centre, friction, clicks and a drawn torque
//! profile, behind one energy guard.

use crate::memory::{self, Object, assert_room};
use crate::settings::ts_settings;
use crate::status::{Words, ts_status};
use crate::{ts_energy, ts_force, ts_si};
use core::ffi::c_char;
use core::fmt::Write as _;
use touchstone_control::environment::profile::Shape;
use touchstone_control::environment::{
    CentreSettings, ClickSettings, Counted, DetentSettings, DrySettings, Extent, Face,
    FeelSettings, ProfileSettings, Refused, Side, Spacing, ViscousSettings, WallSettings,
};
use touchstone_control::fixed::types::I8F24;
use touchstone_control::{
    CountScale, Environment, Fixed32, Force, PositionSettings, Settings, SettingsError, Si,
};

/// Size of a `ts_feel` in 64-bit words.
pub const TS_FEEL_WORDS: usize = 480;
/// The most walls of a feel.
pub const TS_FEEL_WALLS: usize = 6;
/// The most points of a torque profile.
pub const TS_FEEL_POINTS: usize = 96;

/// Walls, detents, spring, friction, clicks and torque profile, and the energy guard behind them. Initialise it with
/// `ts_feel_init`.
#[repr(C)]
#[allow(non_camel_case_types)]
pub struct ts_feel {
    memory: [u64; TS_FEEL_WORDS],
}

/// An environment (walls and other parts) with the scale of its encoder.
#[derive(Clone, Copy)]
pub struct Felt {
    environment: Environment<Fixed32>,
    scale: CountScale,
}

// SAFETY: `assert_room!` below checks size and alignment.
#[allow(unsafe_code)]
unsafe impl Object for ts_feel {
    type Value = Felt;
    const MARK: u64 = 0x7473_6665_656c_5f31;
}
assert_room!(ts_feel);

/// A wall; without stiffness there is none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_wall {
    /// Angle of the wall's surface, rad.
    pub surface: ts_si,
    /// Stiffness, N·m/rad.
    pub stiffness: ts_si,
    /// 0: the wall is solid at angles above its surface; 1: below.
    pub solid_below: u32,
}

/// Detents: positions to which the device is drawn; without strength there are none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_detents {
    /// Largest torque, N·m.
    pub strength: ts_si,
    /// Number of detents per turn, 1 to 6283; 0: `pitch` says how far apart they are.
    pub per_turn: u32,
    /// Distance between neighbours, rad, 0.001 to 6.283; used if `per_turn` is 0.
    pub pitch: ts_si,
    /// Angle of one of the detents, rad.
    pub centre: ts_si,
}

/// A spring that draws to a centre; without strength there is none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_spring {
    /// Largest torque, N·m.
    pub strength: ts_si,
    /// Stiffness, N·m/rad, 0 to 100.
    pub stiffness: ts_si,
    /// Angle at which the spring gives no torque, rad.
    pub centre: ts_si,
}

/// Friction in proportion to the speed; without damping there is none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_damper {
    /// Damping, N·m·s/rad. The largest value follows from the inertia and the delay in the settings.
    pub damping: ts_si,
    /// Bandwidth of the low-pass filter for the speed, Hz, 5 to 500.
    pub bandwidth_hz: ts_si,
}

/// Dry friction, of one size at every speed; without strength there is none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_dry_friction {
    /// Torque while the device slides, N·m.
    pub strength: ts_si,
    /// How far the device moves from rest until it slides, rad, 0.001 to 1.
    pub stretch: ts_si,
}

/// A short pulse when the device crosses one of many positions; without strength there is none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_click {
    /// Torque of the pulse, N·m: first against the motion, then as long with it.
    pub strength: ts_si,
    /// Number of clicks per turn, 1 to 6283; 0: `pitch` says how far apart they are.
    pub per_turn: u32,
    /// Distance between neighbours, rad, 0.001 to 6.283; used if `per_turn` is 0.
    pub pitch: ts_si,
    /// One of the angles that click, rad.
    pub centre: ts_si,
    /// Length of the pulse, s, 0.001 to 0.1.
    pub duration: ts_si,
}

/// A torque drawn over the angle, by points with straight lines between them; without strength there is none.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_profile {
    /// Torque at a point of 10,000, N·m.
    pub strength: ts_si,
    /// Copies of the profile per turn, 1 to 6283; 0: it is there once, from `start` to `end`.
    pub per_turn: u32,
    /// Angle of the first point, rad.
    pub start: ts_si,
    /// Angle of the last point, rad; used if `per_turn` is 0.
    pub end: ts_si,
    /// Number of points, 2 to `TS_FEEL_POINTS`.
    pub count: u32,
    /// The points at equal distances, each from -10,000 to 10,000. A positive one pushes to larger angles.
    pub points: [i16; TS_FEEL_POINTS],
}

/// All parts of a feel. Start from `ts_feel_defaults`, which has no part, and set those that you want.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct ts_feel_config {
    /// Counts of the encoder per turn with all edges counted, at least 1.
    pub counts_per_rev: u32,
    /// Walls, such as end stops.
    pub walls: [ts_feel_wall; TS_FEEL_WALLS],
    /// Detents.
    pub detents: ts_feel_detents,
    /// Spring to a centre.
    pub spring: ts_feel_spring,
    /// Friction in proportion to the speed.
    pub damper: ts_feel_damper,
    /// Dry friction.
    pub dry_friction: ts_feel_dry_friction,
    /// Clicks.
    pub click: ts_feel_click,
    /// Torque profile.
    pub profile: ts_feel_profile,
}

const NOWHERE: ts_feel_wall = ts_feel_wall {
    surface: 0,
    stiffness: 0,
    solid_below: 0,
};

const EMPTY: ts_feel_config = ts_feel_config {
    counts_per_rev: 0,
    walls: [NOWHERE; TS_FEEL_WALLS],
    detents: ts_feel_detents {
        strength: 0,
        per_turn: 0,
        pitch: 0,
        centre: 0,
    },
    spring: ts_feel_spring {
        strength: 0,
        stiffness: 0,
        centre: 0,
    },
    damper: ts_feel_damper {
        damping: 0,
        bandwidth_hz: 0,
    },
    dry_friction: ts_feel_dry_friction {
        strength: 0,
        stretch: 0,
    },
    click: ts_feel_click {
        strength: 0,
        per_turn: 0,
        pitch: 0,
        centre: 0,
        duration: 0,
    },
    profile: ts_feel_profile {
        strength: 0,
        per_turn: 0,
        start: 0,
        end: 0,
        count: 0,
        points: [0; TS_FEEL_POINTS],
    },
};

/// Why a feel is refused.
enum No {
    CountsPerRev,
    /// A wall, by its index in the configuration.
    Wall(usize, SettingsError),
    Part(Refused),
}

/// A number per turn in the range of the control crate's type; a larger one is refused there.
fn per_turn(number: u32) -> u16 {
    u16::try_from(number).unwrap_or(u16::MAX)
}

fn spacing(number: u32, pitch: ts_si) -> Spacing {
    if number == 0 {
        Spacing::Pitch(Si::from_bits(pitch))
    } else {
        Spacing::PerTurn(per_turn(number))
    }
}

impl ts_feel_detents {
    fn settings(&self) -> Option<DetentSettings> {
        (self.strength != 0).then(|| DetentSettings {
            spacing: spacing(self.per_turn, self.pitch),
            strength: Si::from_bits(self.strength),
            centre: Si::from_bits(self.centre),
        })
    }
}

impl ts_feel_profile {
    fn settings(&self) -> Result<Option<ProfileSettings>, Refused> {
        if self.strength == 0 {
            return Ok(None);
        }
        let count = usize::try_from(self.count).unwrap_or(usize::MAX);
        let points = self.points.get(..count).ok_or(Refused::Points(count))?;
        let extent = if self.per_turn == 0 {
            Extent::Until(Si::from_bits(self.end))
        } else {
            Extent::PerTurn(per_turn(self.per_turn))
        };
        Ok(Some(ProfileSettings {
            extent,
            start: Si::from_bits(self.start),
            strength: Si::from_bits(self.strength),
            shape: Shape::new(points)?,
        }))
    }
}

impl ts_feel_config {
    fn parts(&self) -> FeelSettings {
        let si = Si::from_bits;
        let Self {
            spring,
            damper,
            dry_friction,
            click,
            ..
        } = self;
        FeelSettings {
            spring: (spring.strength != 0).then(|| CentreSettings {
                centre: si(spring.centre),
                stiffness: si(spring.stiffness),
                strength: si(spring.strength),
            }),
            viscous: (damper.damping != 0).then(|| ViscousSettings {
                damping: si(damper.damping),
                bandwidth_hz: si(damper.bandwidth_hz),
            }),
            dry: (dry_friction.strength != 0).then(|| DrySettings {
                strength: si(dry_friction.strength),
                stretch: si(dry_friction.stretch),
            }),
            click: (click.strength != 0).then(|| ClickSettings {
                spacing: spacing(click.per_turn, click.pitch),
                centre: si(click.centre),
                strength: si(click.strength),
                duration_s: si(click.duration),
            }),
        }
    }

    /// The reason for a refusal, with a wall's index in this configuration: the environment counts only walls that exist.
    fn named(&self, refused: Refused) -> No {
        let Refused::Wall(place, problem) = refused else {
            return No::Part(refused);
        };
        let mut solid = (0..)
            .zip(&self.walls)
            .filter(|(_, wall)| wall.stiffness != 0);
        let index = solid.nth(usize::from(place)).map_or(0, |(index, _)| index);
        No::Wall(index, problem)
    }

    fn felt(&self, settings: &Settings) -> Result<Felt, No> {
        let scale = CountScale::new(self.counts_per_rev, Si::ZERO).ok_or(No::CountsPerRev)?;
        let settings = Settings {
            position: PositionSettings::of_counts_per_rev(self.counts_per_rev),
            ..*settings
        };
        let mut walls = [None; TS_FEEL_WALLS];
        let solid = self.walls.iter().filter(|wall| wall.stiffness != 0);
        for (place, wall) in walls.iter_mut().zip(solid) {
            let side = match wall.solid_below {
                0 => Side::Above,
                _ => Side::Below,
            };
            *place = Some(WallSettings {
                face: Face {
                    surface: Si::from_bits(wall.surface),
                    side,
                },
                k_desired: Si::from_bits(wall.stiffness),
            });
        }
        let environment = match walls {
            [None, ..] => Environment::new(&settings, &[], self.detents.settings().as_ref()),
            [Some(first), ..] => {
                let used = walls.iter().flatten().count();
                let walls = walls.map(|wall| wall.unwrap_or(first));
                let walls = walls.get(..used).unwrap_or_default();
                Environment::new(&settings, walls, self.detents.settings().as_ref())
            }
        };
        let mut environment = environment
            .map_err(|refused| self.named(refused))?
            .with_feel(&self.parts(), &settings)
            .map_err(No::Part)?;
        if let Some(profile) = self.profile.settings().map_err(No::Part)? {
            environment = environment
                .with_profile(&profile, settings.force_limit)
                .map_err(No::Part)?;
        }
        Ok(Felt { environment, scale })
    }
}

/// Sets a feel to no part at all, and the counts of the encoder to 0, which `ts_feel_init` refuses.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_defaults(config: *mut ts_feel_config) -> ts_status {
    memory::put(config, EMPTY)
}

/// Initialises a feel as at power-up, with a full energy account. Law, device and guard are those of the settings; the guard's
/// count follows from `counts_per_rev`. Call it once, because each call fills the account again.
///
/// Returns `TS_OUT_OF_RANGE` if a value is refused; the feel is then not initialised, and gives no force.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_init(
    feel: *mut ts_feel,
    settings: *mut ts_settings,
    config: *const ts_feel_config,
) -> ts_status {
    let made = memory::clear(feel)
        .and_then(|()| memory::value(settings))
        .and_then(|settings| memory::get(config).map(|config| config.felt(settings)));
    match made {
        Err(status) => status,
        Ok(Err(_)) => ts_status::TS_OUT_OF_RANGE,
        Ok(Ok(made)) => memory::initialise(feel, made),
    }
}

/// Checks a feel. If it is refused, `message` gets the reason in one line; `message` may be null.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_check(
    settings: *mut ts_settings,
    config: *const ts_feel_config,
    message: *mut c_char,
    length: usize,
) -> ts_status {
    let mut words = Words::new(memory::buffer(message, length));
    let made = memory::value(settings)
        .and_then(|settings| memory::get(config).map(|config| config.felt(settings)));
    // Writing to a buffer cuts the text; it never fails.
    match made {
        Err(status) => return status,
        Ok(Ok(_)) => return ts_status::TS_OK,
        Ok(Err(No::CountsPerRev)) => {
            let _ = write!(
                words,
                "counts_per_rev = 0: give the encoder's counts per turn"
            );
        }
        Ok(Err(No::Wall(index, problem))) => {
            let _ = write!(words, "walls[{index}]: {problem}");
        }
        Ok(Err(No::Part(problem))) => {
            let _ = write!(words, "{problem}");
        }
    }
    ts_status::TS_OUT_OF_RANGE
}

/// Runs one control period of a feel: takes the encoder's count, and gives the force against growing angles. Command the negative of
/// it along the angle, and hold it until the next call.
///
/// The hand gets out at most the guard's `capacity + refill * time` more energy than it put in, over all parts together.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_tick(feel: *mut ts_feel, count: i64, force: *mut ts_force) -> ts_status {
    let (answer, status) = match memory::value(feel) {
        Err(status) => (0, status),
        Ok(Felt { environment, scale }) => {
            let scale = *scale;
            let answer = environment.tick(&Counted { scale, count }, None);
            let status = if environment.tripped() {
                ts_status::TS_OVERSPEED
            } else {
                ts_status::TS_OK
            };
            (answer.0.to_bits(), status)
        }
    };
    match memory::put(force, answer) {
        ts_status::TS_OK => status,
        null => null,
    }
}

/// Reports to estimators and guard the commanded force, if it was smaller than the force that `ts_feel_tick` gave.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_commanded(feel: *mut ts_feel, force: ts_force) -> ts_status {
    memory::value(feel).map_or_else(
        |status| status,
        |Felt { environment, .. }| {
            environment.commanded(Force(I8F24::from_bits(force)));
            ts_status::TS_OK
        },
    )
}

/// Reports to the feel that the motor was switched off and that no call of `ts_feel_tick` follows until `ts_feel_resume`.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_switched_off(feel: *mut ts_feel) -> ts_status {
    memory::value(feel).map_or_else(
        |status| status,
        |Felt { environment, .. }| {
            environment.switched_off();
            ts_status::TS_OK
        },
    )
}

/// Resumes the feel when the motor is switched on again. All parts start anew; the energy guard's account keeps its level.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_resume(feel: *mut ts_feel) -> ts_status {
    memory::value(feel).map_or_else(
        |status| status,
        |Felt { environment, .. }| {
            environment.begin(None);
            ts_status::TS_OK
        },
    )
}

/// Reads the energy guard's account, the energy that the hand may still get out, in J times 2^48. It is 0 without a guard
/// (`law.guard.on`).
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_feel_account(feel: *mut ts_feel, account: *mut ts_energy) -> ts_status {
    let (energy, status) = match memory::value(feel) {
        Err(status) => (0, status),
        Ok(Felt { environment, .. }) => {
            let guard = environment.guard.as_ref();
            let energy = guard.map_or(0, |guard| guard.account().0.to_bits());
            (energy, ts_status::TS_OK)
        }
    };
    match memory::put(account, energy) {
        ts_status::TS_OK => status,
        null => null,
    }
}
