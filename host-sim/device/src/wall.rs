//! A wall of three axes on a device: metres and newtons outside, the law's fixed point inside.

use crate::haptic::HapticFault;
use crate::servo::ForceLaw;
use touchstone_control::space::{
    Leaving, LengthUnit, Magnitude, PerAxis, Rule, Shape, Shell, SpaceWall, SurfacePoint, Vector,
    VectorGuard,
};
use touchstone_control::{
    AnyLaw, Fixed32, Force, GuardSettings, GuardedDevice, Position, Reported, Settings,
    SettingsError, Si,
};

type N = Fixed32;
const UNIT: LengthUnit = LengthUnit::Centimetre;
/// Of the law's unit in a metre.
const PER_METRE: f64 = 100.0;

/// What a wall on a device is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct WallSettings {
    /// The law, SI; its rate is the loop's.
    pub law: Settings,
    /// The object, in centimetres.
    pub shape: Shape<N>,
    /// One law an axis instead of one along the normal.
    pub per_axis: bool,
    /// The guard, SI, where there is one.
    pub guard: Option<GuardSettings>,
    /// Step of a measured position, m.
    pub count_m: f64,
}

/// A wall, tick by tick.
#[derive(Debug, Clone)]
pub struct DeviceWall {
    wall: SpaceWall<N, Shape<N>, AnyLaw<N>>,
    least_account: Option<f64>,
}

impl DeviceWall {
    /// Outside the object, at rest; a full account.
    ///
    /// # Errors
    /// Settings that law or guard cannot have.
    pub fn new(settings: &WallSettings) -> Result<Self, SettingsError> {
        let law = UNIT.law::<N>(&settings.law)?;
        let shell = match settings.per_axis {
            true => Shell::PerAxis(PerAxis::new([law; 3], Leaving::Projection)),
            false => Shell::Magnitude(Magnitude::new(law)),
        };
        let limit = Force::from_f64(settings.law.force_limit.to_num());
        let point = SurfacePoint::new(Rule::Closest);
        let mut wall = SpaceWall::new(settings.shape, point, shell, limit);
        if let Some(guard) = &settings.guard {
            let device = GuardedDevice {
                rate_hz: settings.law.rate_hz,
                force_limit: settings.law.force_limit,
                count: Si::saturating_from_num(settings.count_m),
            };
            let (guard, device) = UNIT.guard(guard, &device);
            let guard = VectorGuard::new(&guard, &device)?;
            let full = guard.full();
            wall.guard = Some((guard, full));
        }
        Ok(Self {
            wall,
            least_account: None,
        })
    }

    /// What the guard's account held at least, J; `None` without a guard, or before the first tick.
    #[must_use]
    pub fn least_account_j(&self) -> Option<f64> {
        self.least_account
    }
}

impl ForceLaw for DeviceWall {
    fn tick(&mut self, position_m: [f64; 3]) -> Result<[f64; 3], HapticFault> {
        let at = Vector(position_m.map(|x| Position::<N>::from_f64(x * PER_METRE)));
        let force = self.wall.tick(at).map_err(|_| HapticFault::Overspeed)?;
        if let Some((_, state)) = &self.wall.guard {
            let account = N::energy_to_f64(state.account.0) / PER_METRE;
            self.least_account = Some(self.least_account.map_or(account, |e| e.min(account)));
        }
        Ok(force.0.map(Force::to_f64))
    }

    fn commanded(&mut self, force_n: [f64; 3]) {
        if let Some((guard, state)) = &mut self.wall.guard {
            guard.commanded(state, Vector(force_n.map(Force::from_f64)));
        }
    }
}
