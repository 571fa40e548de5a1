//! A simulated control loop of three axes for a web page: a virtual wall on a simulated omega.3 (haptic device with three axes),
//! held by a firm hand.

use crate::space_choice::{MM, N};
pub use crate::space_choice::{SpaceChoice, SpaceObject};
use touchstone_control::space::{
    Direction, Leaving, LengthUnit, Magnitude, PerAxis, Rule, Shape, Shell, SpaceWall, Surface,
    SurfacePoint, Vector, VectorGuard,
};
use touchstone_control::{
    AnyLaw, Choice as _, Force, GuardedDevice, LawKind, Position, PositionSettings, Reported, Si,
    StatesKind,
};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::texture::Textured;
use touchstone_world::plant::{Cartesian, FIRM_TRANSLATION, HeldLinear, OMEGA3, OMEGA3_AXIS};

type Held = Cartesian<HeldLinear>;
const UNIT: LengthUnit = LengthUnit::Centimetre;
/// Length units of the control law per metre.
const PER_METRE: f64 = 100.0;

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

/// The simulated control loop of three axes: device, hand, control law and energy guard.
pub struct SpaceLoop {
    /// The settings of the loop.
    pub choice: SpaceChoice,
    wall: SpaceWall<N, Textured<Shape<N>>, AnyLaw<N>>,
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
        let surface = Textured {
            smooth: choice.shape()?,
            texture: choice.texture,
        };
        let mut wall = SpaceWall::new(surface, point, shell, limit);
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
