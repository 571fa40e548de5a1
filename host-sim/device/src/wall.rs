//! A wall on a haptic device with three axes. It converts between metres and newtons outside and the control law's fixed-point
//! numbers inside.

use crate::haptic::HapticFault;
use crate::servo::ForceLaw;
use touchstone_control::space::{
    Direction, Leaving, LengthUnit, Magnitude, Nearest, PerAxis, Rule, Shape, Shell, SpaceWall,
    Surface, SurfacePoint, Vector, VectorGuard, VectorGuardState,
};
use touchstone_control::{
    AnyLaw, EstimatorSettings, Fixed32, Force, GuardSettings, GuardedDevice, Position,
    PositionSettings, Reported, Settings, SettingsError, Si,
};
use touchstone_mesh::{Mesh, MeshSurface};

pub(crate) type N = Fixed32;
const UNIT: LengthUnit = LengthUnit::Centimetre;
/// Number of the control law's units of length (centimetres) in a metre.
const PER_METRE: f64 = 100.0;

/// Energy in the account of an energy guard that calculates in centimetres, J.
pub(crate) fn account_j(state: &VectorGuardState<N>) -> f64 {
    N::energy_to_f64(state.account.0) / PER_METRE
}

/// Converts a position in m to the control law's centimetres.
pub(crate) fn place(position_m: [f64; 3]) -> Vector<Position<N>> {
    Vector(position_m.map(|x| Position::<N>::from_f64(x * PER_METRE)))
}

/// The settings of a wall on a haptic device with three axes.
#[derive(Debug, Clone, PartialEq)]
pub struct WallSettings {
    /// Settings of the control law in SI units. Its rate is that of the servo loop.
    pub law: Settings,
    /// Whether each axis has a control law of its own, instead of one law along the surface's normal.
    pub per_axis: bool,
    /// Settings of the energy guard in SI units; `None` for no guard.
    pub guard: Option<GuardSettings>,
    /// Settings of each axis's motion estimator in SI units; `None` if the control law uses measured positions and velocities
    /// directly.
    pub estimator: Option<[EstimatorSettings; 3]>,
    /// Resolution of the measured position (distance per encoder count), m.
    pub count_m: f64,
}

/// Settings of the energy guard for a device with three axes, in SI units: capacity 40 mJ, refill 0.5 mW, over-speed limit 1.5 m/s.
/// The damping to give is that of the least damped axis; the guard relies on a fraction of it. A delay above one tick counts as
/// one tick.
#[must_use]
pub fn guard_settings(damping_n_s_per_m: f64, delay_s: f64, rate_hz: u32) -> GuardSettings {
    let si = Si::saturating_from_num::<f64>;
    // The tick is rounded down, as in the range check of the guard.
    let tick_s = Si::ONE.saturating_div(Si::saturating_from_num(rate_hz));
    GuardSettings {
        capacity: si(0.04),
        damping: si(damping_n_s_per_m),
        overspeed: si(1.5),
        delay: si(delay_s).min(tick_s),
        ..GuardSettings::default()
    }
}

/// An energy guard and its state, at first with a full account.
type FullGuard = (VectorGuard<N>, VectorGuardState<N>);

impl WallSettings {
    /// The energy guard with a full account, in centimetres; `None` without a guard.
    pub(crate) fn full_guard(&self) -> Result<Option<FullGuard>, SettingsError> {
        let Some(guard) = &self.guard else {
            return Ok(None);
        };
        let device = GuardedDevice {
            rate_hz: self.law.rate_hz,
            force_limit: self.law.force_limit,
            count: PositionSettings {
                count: Si::saturating_from_num(self.count_m),
            }
            .uncertainty(self.law.position_error),
        };
        let (guard, device) = UNIT.guard(guard, &device);
        let guard = VectorGuard::new(&guard, &device)?;
        Ok(Some((guard, guard.full())))
    }
}

/// The virtual object in the device's workspace.
#[derive(Debug, Clone)]
pub enum Obstacle<'m> {
    /// A geometric object of the control crate (plane, sphere, …), in centimetres.
    Shape(Shape<N>),
    /// A surface of triangles, for example from an STL file.
    Mesh(MeshSurface<'m>),
}

impl<'m> Obstacle<'m> {
    /// An obstacle of triangles, in the state before a first contact.
    #[must_use]
    pub fn of(mesh: &'m Mesh) -> Self {
        Self::Mesh(MeshSurface::new(mesh, UNIT))
    }

    /// Depth of a position below the surface, m, and the surface's normal there. `side` is the normal of the previous control
    /// interval; the function replaces it by the new normal.
    pub fn beneath(&self, position_m: [f64; 3], side: &mut Direction<N>) -> (f64, [f64; 3]) {
        let nearest = self.nearest(place(position_m), side);
        *side = nearest.normal;
        let depth_m = nearest.depth.to_f64() / PER_METRE;
        (depth_m, nearest.normal.0.map(N::signal_to_f64))
    }
}

impl Surface<N> for Obstacle<'_> {
    fn nearest(&self, at: Vector<Position<N>>, side: &Direction<N>) -> Nearest<N> {
        match self {
            Self::Shape(shape) => shape.nearest(at, side),
            Self::Mesh(mesh) => mesh.nearest(at, side),
        }
    }
    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        side: &Direction<N>,
    ) -> Option<Position<N>> {
        match self {
            Self::Shape(shape) => shape.exit(at, along, side),
            Self::Mesh(mesh) => mesh.exit(at, along, side),
        }
    }
    fn ways(&self, visit: &mut dyn FnMut(Direction<N>)) {
        match self {
            Self::Shape(shape) => shape.ways(visit),
            Self::Mesh(mesh) => Surface::<N>::ways(mesh, visit),
        }
    }
    fn is_round(&self) -> bool {
        match self {
            Self::Shape(shape) => shape.is_round(),
            Self::Mesh(mesh) => Surface::<N>::is_round(mesh),
        }
    }
}

/// A wall on a device, as the force law of the servo loop.
#[derive(Debug, Clone)]
pub struct DeviceWall<'m> {
    wall: SpaceWall<N, Obstacle<'m>, AnyLaw<N>>,
    least_account: Option<f64>,
}

impl<'m> DeviceWall<'m> {
    /// A wall in the state before contact: the device is at rest outside the object, and the energy guard has its full energy.
    ///
    /// # Errors
    /// The control law or the energy guard refuses the settings.
    pub fn new(settings: &WallSettings, obstacle: Obstacle<'m>) -> Result<Self, SettingsError> {
        let law = UNIT.law::<N>(&settings.law)?;
        let shell = match settings.per_axis {
            true => Shell::PerAxis(PerAxis::new([law; 3], Leaving::Projection)),
            false => {
                if settings.estimator.is_some() {
                    settings.law.impact.validate(settings.law.rate_hz)?;
                }
                let impact = UNIT.impact(&settings.law)?;
                Shell::Magnitude(Magnitude::new(law).with_impact(impact))
            }
        };
        let limit = Force::from_f64(settings.law.force_limit.to_num());
        let point = SurfacePoint::new(Rule::Closest);
        let mut wall = SpaceWall::new(obstacle, point, shell, limit);
        if let Some(axes) = &settings.estimator {
            let law = &settings.law;
            wall.estimator = Some(UNIT.estimator(axes, law.rate_hz, law.force_limit)?);
        }
        wall.guard = settings.full_guard()?;
        Ok(Self {
            wall,
            least_account: None,
        })
    }

    /// Lowest level of the energy account so far, J; `None` without an energy guard or before the first control interval.
    #[must_use]
    pub fn least_account_j(&self) -> Option<f64> {
        self.least_account
    }
}

impl ForceLaw for DeviceWall<'_> {
    fn tick(&mut self, position_m: [f64; 3]) -> Result<[f64; 3], HapticFault> {
        let force = self
            .wall
            .tick(place(position_m))
            .map_err(|_| HapticFault::Overspeed)?;
        if let Some((_, state)) = &self.wall.guard {
            let account = account_j(state);
            self.least_account = Some(self.least_account.map_or(account, |e| e.min(account)));
        }
        Ok(force.0.map(Force::to_f64))
    }

    fn commanded(&mut self, force_n: [f64; 3]) {
        self.wall.commanded(Vector(force_n.map(Force::from_f64)));
    }
}
