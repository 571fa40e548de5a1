//! A simulated control loop of three axes for a web page: a virtual wall on a simulated omega.3 (haptic device with three axes),
//! held by a firm hand.

use std::fmt::Write as _;
use touchstone_control::space::environment::{Plane, Sphere};
use touchstone_control::space::{
    Direction, Leaving, LengthUnit, Magnitude, PerAxis, Rule, Shape, Shell, SpaceWall, Surface,
    SurfacePoint, Vector, VectorGuard,
};
use touchstone_control::{
    AnyLaw, Choice as _, Fixed32, Force, GuardSettings, GuardedDevice, LawKind, Position,
    PositionSettings, Reported, Settings, Si, StatesKind,
};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::list;
use touchstone_world::plant::{Cartesian, FIRM_TRANSLATION, HeldLinear, OMEGA3, OMEGA3_AXIS};

type N = Fixed32;
type Held = Cartesian<HeldLinear>;
const UNIT: LengthUnit = LengthUnit::Centimetre;
/// Length units of the control law per metre (it computes in centimetres). The constant `MM` is the number of millimetres per such
/// unit.
const PER_METRE: f64 = 100.0;
const MM: f64 = 10.0;

/// Names of the numbers that one tick (control period) returns, in their order. Positions are in mm, forces on the hand in N.
pub const SPACE_ROW: [&str; 20] = [
    "time_s",
    "hip_x_mm",
    "hip_y_mm",
    "hip_z_mm",
    "rest_x_mm",
    "rest_y_mm",
    "rest_z_mm",
    "surface_x_mm",
    "surface_y_mm",
    "surface_z_mm",
    "depth_mm",
    "force_x_n",
    "force_y_n",
    "force_z_n",
    "force_n",
    "energy_true_j",
    "energy_hand_j",
    "energy_device_loss_j",
    "guard_account_j",
    "speed_mm_per_s",
];

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
            law: Settings::thesis(),
            per_axis: false,
            guard: None,
        };
        let (mut sphere, mut radius, mut normal, mut guarded) =
            (true, 30.0, [0.0, 0.0, 1.0], false);
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
        choice.guard = guarded.then_some(choice.law.guard);
        Ok(choice)
    }

    fn shape(&self) -> Result<Shape<N>> {
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

/// The simulated control loop of three axes: device, hand, control law and energy guard.
pub struct SpaceLoop {
    /// The settings of the loop.
    pub choice: SpaceChoice,
    wall: SpaceWall<N, Shape<N>, AnyLaw<N>>,
    plant: Held,
    state: [<HeldLinear as touchstone_world::plant::Stepper>::State; 3],
    ticks: u64,
    force_n: [f64; 3],
    last_mm: Option<[f64; 3]>,
    /// Energy in the plant's springs at the end of the last tick, J; `None` before the first.
    stored_j: Option<f64>,
    energy_true_j: f64,
    energy_hand_j: f64,
    loss_j: f64,
    row: [f64; SPACE_ROW.len()],
}

/// Position in mm at which the hand rests at the start of the simulation.
#[must_use]
pub fn start_mm(object: SpaceObject) -> [f64; 3] {
    match object {
        SpaceObject::Sphere(radius_mm) => [0.0, 0.0, radius_mm + 8.0],
        SpaceObject::Plane(normal) => {
            let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
            normal.map(|n| 8.0 * n / length)
        }
    }
}

impl SpaceLoop {
    /// Opens a loop whose device and hand are at rest at the start position for the chosen object.
    ///
    /// # Errors
    /// Same as [`Self::at`].
    pub fn new(choice: SpaceChoice) -> Result<Self> {
        let start = start_mm(choice.object);
        Self::at(choice, start)
    }

    /// Opens a loop whose device and hand are at rest at the position `start_mm`, in mm.
    ///
    /// # Errors
    /// Settings that the control law or the energy guard refuses.
    pub fn at(choice: SpaceChoice, start_mm: [f64; 3]) -> Result<Self> {
        let refused = |why: &dyn std::fmt::Display| Error::Option {
            option: "law".to_owned(),
            problem: why.to_string(),
            fix: "choose another value".to_owned(),
        };
        let law = UNIT.law::<N>(&choice.law).map_err(|why| refused(&why))?;
        let shell = match choice.per_axis {
            true => Shell::PerAxis(PerAxis::new([law; 3], Leaving::Projection)),
            false => {
                let impact = UNIT.impact(&choice.law).map_err(|why| refused(&why))?;
                Shell::Magnitude(Magnitude::new(law).with_impact(impact))
            }
        };
        let limit = Force(N::signal_from_f64(choice.law.force_limit.to_num()));
        let point = SurfacePoint::new(Rule::Closest);
        let mut wall = SpaceWall::new(choice.shape()?, point, shell, limit);
        if choice.law.states == StatesKind::Estimated {
            let impact = choice.law.impact.validate(choice.law.rate_hz);
            impact.map_err(|why| refused(&why))?;
            let axes = [choice.law.estimator; 3];
            let estimator = UNIT.estimator(&axes, choice.law.rate_hz, choice.law.force_limit);
            wall.estimator = Some(estimator.map_err(|why| refused(&why))?);
        }
        if let Some(guard) = &choice.guard {
            let device = GuardedDevice {
                rate_hz: choice.law.rate_hz,
                force_limit: choice.law.force_limit,
                count: PositionSettings {
                    count: Si::saturating_from_num(OMEGA3.count_m),
                }
                .uncertainty(choice.law.position_error),
            };
            let (guard, device) = UNIT.guard(guard, &device);
            let guard = VectorGuard::new(&guard, &device).map_err(|why| refused(&why))?;
            let full = guard.full();
            wall.guard = Some((guard, full));
        }
        let interval_s = 1.0 / f64::from(choice.law.rate_hz);
        let plant =
            Held::held(&OMEGA3_AXIS, &FIRM_TRANSLATION, interval_s).map_err(|why| refused(&why))?;
        let state = Held::at_rest(start_mm.map(|x| x * 1e-3));
        Ok(Self {
            choice,
            wall,
            plant,
            state,
            ticks: 0,
            force_n: [0.0; 3],
            last_mm: None,
            stored_j: None,
            energy_true_j: 0.0,
            energy_hand_j: 0.0,
            loss_j: 0.0,
            row: [f64::NAN; SPACE_ROW.len()],
        })
    }

    /// Changes the settings of the running loop; device and hand keep their positions.
    ///
    /// # Errors
    /// Same as [`Self::new`]; the loop then keeps its old settings.
    pub fn change(&mut self, choice: SpaceChoice) -> Result<()> {
        let mut changed = Self::new(choice)?;
        changed.state = self.state;
        *self = changed;
        Ok(())
    }

    /// The values of the loop that change only with its settings, as JSON.
    #[must_use]
    pub fn facts(&self) -> String {
        let words: Vec<String> = LawKind::WORDS
            .iter()
            .map(|word| format!("\"{word}\""))
            .collect();
        let (radius_mm, normal) = match self.choice.object {
            SpaceObject::Sphere(radius_mm) => (radius_mm, [0.0; 3]),
            SpaceObject::Plane(normal) => (0.0, normal),
        };
        format!(
            "{{\"rate_hz\":{},\"radius_mm\":{radius_mm},\"normal\":{normal:?},\"start_mm\":{:?},\"k_desired_n_per_m\":{},\"law\":\"{}\",\"states\":\"{}\",\"laws\":[{}],\"per_axis\":{},\"guard\":{}}}",
            self.choice.law.rate_hz,
            start_mm(self.choice.object),
            self.choice.law.k_desired,
            self.choice.law.law.word(),
            self.choice.law.states.word(),
            words.join(","),
            self.choice.per_axis,
            self.choice.guard.is_some(),
        )
    }

    /// Runs one control period with the rest point of the hand's spring at `rest_mm`, in mm; returns the numbers named in
    /// [`SPACE_ROW`].
    pub fn tick(&mut self, rest_mm: [f64; 3]) -> &[f64; SPACE_ROW.len()] {
        let hip_m = Held::position(&self.state);
        let hip_mm = hip_m.map(|x| x * 1e3);
        let moved_mm: [f64; 3] =
            std::array::from_fn(|i| self.last_mm.map_or(0.0, |last| hip_mm[i] - last[i]));
        // Energy that the wall took since the last tick, while its force was constant.
        self.energy_true_j -= (0..3)
            .map(|i| self.force_n[i] * moved_mm[i] * 1e-3)
            .sum::<f64>();
        self.last_mm = Some(hip_mm);
        let counts = OMEGA3.counts(hip_m);
        let measured_mm = counts.map(|n| f64::from(n) * OMEGA3.count_m * 1e3);
        let at = Vector(measured_mm.map(|x| Position::<N>(N::signal_from_f64(x / MM))));
        // An over-speed switches the force off, as on a device.
        let force = self.wall.tick(at).unwrap_or_default();
        self.force_n = OMEGA3.limited(force.0.map(|f| N::signal_to_f64(f.0)));
        let commanded = self.force_n.map(|f| Force(N::signal_from_f64(f)));
        self.wall.commanded(Vector(commanded));
        let nearest = self.wall.surface.nearest(
            at,
            &Direction([<N as touchstone_control::Number>::Signal::default(); 3]),
        );
        let depth_mm = N::signal_to_f64(nearest.depth.0) * MM;
        let normal = nearest.normal.0.map(N::signal_to_f64);
        let surface_mm: [f64; 3] = std::array::from_fn(|i| measured_mm[i] + depth_mm * normal[i]);
        let rest_m = rest_mm.map(|x| x * 1e-3);
        // A rest point that jumps does work on the hand's spring.
        let before = self.plant.stored_energy_j(&self.state, rest_m);
        self.energy_hand_j += self.stored_j.map_or(0.0, |stored| before - stored);
        self.loss_j += self
            .plant
            .step_with_loss(&mut self.state, self.force_n, rest_m)
            .total_j();
        self.stored_j = Some(self.plant.stored_energy_j(&self.state, rest_m));
        let rate = f64::from(self.choice.law.rate_hz);
        let time_s = self.ticks as f64 / rate;
        self.ticks += 1;
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let account = self.wall.guard.as_ref().map_or(f64::NAN, |(_, state)| {
            N::energy_to_f64(state.account.0) / PER_METRE
        });
        let [hx, hy, hz] = hip_mm;
        let [rx, ry, rz] = rest_mm;
        let [sx, sy, sz] = surface_mm;
        let [fx, fy, fz] = self.force_n;
        self.row = [
            time_s,
            hx,
            hy,
            hz,
            rx,
            ry,
            rz,
            sx,
            sy,
            sz,
            depth_mm,
            fx,
            fy,
            fz,
            length(self.force_n),
            self.energy_true_j,
            self.energy_hand_j,
            self.loss_j,
            account,
            length(moved_mm) * rate,
        ];
        &self.row
    }
}
