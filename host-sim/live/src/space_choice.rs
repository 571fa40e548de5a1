//! The settings of a loop of three axes, as text that the page sends.

use std::fmt::Write as _;
use touchstone_control::space::environment::{Plane, Sphere};
use touchstone_control::space::{Direction, Shape, Vector};
use touchstone_control::{
    Choice as _, Fixed32, GuardSettings, LawKind, Position, Reported, Settings, Si, StatesKind,
};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::list;
use touchstone_sim::texture::Texture;

pub(crate) type N = Fixed32;
/// Millimetres per length unit of the control law, which computes in centimetres.
pub(crate) const MM: f64 = 10.0;

/// The virtual object in the workspace.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SpaceObject {
    /// The half-space below a plane through the centre of the workspace, given by its outward normal.
    Plane([f64; 3]),
    /// A ball around the centre of the workspace, given by its radius in mm.
    Sphere(f64),
}

/// The settings of a loop of three axes, as the user chose them on the page.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceChoice {
    /// The virtual object that the hand touches.
    pub object: SpaceObject,
    /// Grooves in the object's surface; `None` for a smooth one.
    pub texture: Option<Texture>,
    /// Settings of the control law, in SI units. With estimated states its estimator is that of each axis.
    pub law: Settings,
    /// True: one control law for each axis. False: one control law along the normal of the surface.
    pub per_axis: bool,
    /// Settings of the energy guard in SI units; `None` runs the loop without a guard.
    pub guard: Option<GuardSettings>,
}

/// Lists the number settings that the page can change, each with its name: all numbers in which the control law of three axes may
/// differ from [`Settings::thesis`], or with estimated states from the default settings.
macro_rules! numbers {
    ($settings:expr, $with:ident) => {{
        let settings = $settings;
        $with!(k_desired_n_per_m, settings.k_desired);
        $with!(k_soft_n_per_m, settings.k_soft);
        $with!(device_damping_n_s_per_m, settings.device_damping);
        $with!(virtual_damping_n_s_per_m, settings.virtual_damping);
        $with!(force_limit_n, settings.force_limit);
        $with!(energy_credit_j, settings.energy_credit);
        $with!(filter_mass_kg, settings.filter.mass);
        $with!(filter_stiffness_n_per_m, settings.filter.stiffness);
        $with!(filter_damping_n_s_per_m, settings.filter.damping);
        $with!(
            filter_ground_damping_n_s_per_m,
            settings.filter.ground_damping
        );
        $with!(guard_capacity_j, settings.guard.capacity);
        $with!(guard_refill_w, settings.guard.refill);
        $with!(guard_damping_n_s_per_m, settings.guard.damping);
        $with!(guard_overspeed_m_per_s, settings.guard.overspeed);
        $with!(step_of_ideal_per_ms, settings.step_of_ideal);
        $with!(limit_of_force_per_ms, settings.limit_of_force);
        $with!(limit_of_penetration_per_ms, settings.limit_of_penetration);
        $with!(impact_momentum, settings.impact.momentum);
        $with!(impact_vibration, settings.impact.vibration);
        $with!(impact_vibration_hz, settings.impact.frequency_hz);
        $with!(impact_vibration_decay_s, settings.impact.decay_s);
        $with!(estimator_bandwidth_hz, settings.estimator.bandwidth_hz);
        $with!(estimator_mass_kg, settings.estimator.inertia);
        $with!(estimator_damping_n_s_per_m, settings.estimator.damping);
        $with!(estimator_delay_s, settings.estimator.delay_s);
    }};
}

impl SpaceChoice {
    /// The settings as text in the page's format: `key=value`, one per line.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = match self.object {
            SpaceObject::Sphere(radius_mm) => format!("object=sphere\nradius_mm={radius_mm}\n"),
            SpaceObject::Plane([x, y, z]) => {
                format!("object=plane\nnormal_x={x}\nnormal_y={y}\nnormal_z={z}\n")
            }
        };
        // Writing into a string cannot fail.
        if let Some(texture) = self.texture {
            let [x, y, z] = texture.along;
            let _ = writeln!(
                text,
                "texture_height_mm={}\ntexture_period_mm={}\ntexture_along_x={x}\ntexture_along_y={y}\ntexture_along_z={z}",
                texture.height_mm, texture.period_mm
            );
        }
        let _ = writeln!(text, "states={}", self.law.states.word());
        let _ = writeln!(text, "law={}", self.law.law.word());
        let _ = writeln!(text, "rate_hz={}", self.law.rate_hz);
        let _ = writeln!(text, "per_axis={}", self.per_axis);
        let _ = writeln!(text, "guard={}", self.guard.is_some());
        let mut all = self.law;
        if let Some(guard) = &self.guard {
            all.guard = *guard;
        }
        macro_rules! say {
            ($name:ident, $value:expr) => {
                let _ = writeln!(text, "{}={}", stringify!($name), $value);
            };
        }
        numbers!(&all, say);
        text
    }

    /// Reads the settings from the page's text (`key=value`, one per line). If a key occurs twice, the last value counts. The key
    /// `states` sets all settings of the law to their defaults, or with measured states to the thesis', so it comes first.
    ///
    /// # Errors
    /// An unknown key, or a value that its key does not allow.
    pub fn of_text(text: &str) -> Result<Self> {
        let mut choice = Self {
            object: SpaceObject::Sphere(30.0),
            texture: None,
            law: Settings::thesis(),
            per_axis: false,
            guard: None,
        };
        let (mut sphere, mut radius, mut normal, mut guarded) =
            (true, 30.0, [0.0, 0.0, 1.0], false);
        let mut texture = Texture {
            height_mm: 0.0,
            period_mm: 1.0,
            along: [1.0, 0.0, 0.0],
        };
        for line in text.lines().filter(|line| !line.is_empty()) {
            let (key, value) = line.split_once('=').unwrap_or((line, ""));
            let wrong = |fix: &str| Error::Option {
                option: key.to_owned(),
                problem: format!("`{value}` is not an allowed value"),
                fix: fix.to_owned(),
            };
            let number = || value.parse::<f64>().ok().filter(|x| x.is_finite());
            let flag = || {
                value
                    .parse::<bool>()
                    .map_err(|_| wrong("give true or false"))
            };
            let si = || {
                let read = value.parse::<Si>().ok().filter(|read| *read >= 0);
                read.ok_or_else(|| wrong("give a number that is not negative"))
            };
            match key {
                "object" => {
                    sphere = match value {
                        "sphere" => true,
                        "plane" => false,
                        _ => return Err(wrong("give sphere or plane")),
                    }
                }
                "radius_mm" => {
                    let within = |mm: &f64| (5.0..=50.0).contains(mm);
                    radius = number()
                        .filter(within)
                        .ok_or_else(|| wrong("give 5 to 50"))?;
                }
                "normal_x" | "normal_y" | "normal_z" => {
                    let axis = usize::from(key.as_bytes()[7] - b'x');
                    normal[axis] = number().ok_or_else(|| wrong("give a number"))?;
                }
                "texture_along_x" | "texture_along_y" | "texture_along_z" => {
                    let axis = usize::from(key.as_bytes()[14] - b'x');
                    texture.along[axis] = number().ok_or_else(|| wrong("give a number"))?;
                }
                "texture_height_mm" => {
                    texture.height_mm = number().ok_or_else(|| wrong("give a number"))?;
                }
                "texture_period_mm" => {
                    texture.period_mm = number().ok_or_else(|| wrong("give a number"))?;
                }
                "states" => {
                    let states = StatesKind::of_word(value)
                        .ok_or_else(|| wrong(&format!("give {}", list(StatesKind::WORDS))))?;
                    choice.law = Settings {
                        states,
                        ..match states {
                            StatesKind::Estimated => Settings::default(),
                            StatesKind::Measured => Settings::thesis(),
                        }
                    };
                }
                "law" => {
                    choice.law.law = LawKind::of_word(value)
                        .ok_or_else(|| wrong(&format!("give {}", list(LawKind::WORDS))))?;
                }
                "rate_hz" => {
                    let within = |hz: &u32| (100..=10_000).contains(hz);
                    let rate = value.parse().ok().filter(within);
                    choice.law.rate_hz = rate.ok_or_else(|| wrong("give 100 to 10000"))?;
                }
                "per_axis" => choice.per_axis = flag()?,
                "guard" => guarded = flag()?,
                _ => {
                    let mut known = false;
                    macro_rules! take {
                        ($name:ident, $place:expr) => {
                            if key == stringify!($name) {
                                $place = si()?;
                                known = true;
                            }
                        };
                    }
                    numbers!(&mut choice.law, take);
                    if !known {
                        return Err(wrong("there is no such setting"));
                    }
                }
            }
        }
        choice.object = match sphere {
            true => SpaceObject::Sphere(radius),
            false => SpaceObject::Plane(normal),
        };
        // A height of 0, the default, is a smooth surface.
        if texture.height_mm != 0.0 {
            let texture = texture.validated();
            choice.texture = Some(texture.map_err(|(field, range)| Error::Option {
                option: format!("texture_{field}"),
                problem: range,
                fix: "choose another texture".to_owned(),
            })?);
        }
        choice.guard = guarded.then_some(choice.law.guard);
        Ok(choice)
    }

    pub(crate) fn shape(&self) -> Result<Shape<N>> {
        let signal = N::signal_from_f64;
        Ok(match self.object {
            SpaceObject::Sphere(radius_mm) => Shape::Sphere(Sphere {
                centre: Vector::default(),
                radius: Position(signal(radius_mm / MM)),
            }),
            SpaceObject::Plane(normal) => {
                let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
                let along = normal.map(|n| Position(signal(5.0 * n / length)));
                Shape::Plane(Plane {
                    normal: Direction::of(Vector(along)).ok_or_else(|| Error::Option {
                        option: "normal".to_owned(),
                        problem: "is not a direction".to_owned(),
                        fix: "give one that is not 0".to_owned(),
                    })?,
                    height: Position::zero(),
                })
            }
        })
    }
}
