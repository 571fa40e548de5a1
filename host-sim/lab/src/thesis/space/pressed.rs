//! A surface on a device with three degrees of freedom that a simulated hand presses and oscillates in, as for the scorecard.

use super::mechanism::{Deviation, HeldMechanism, Mechanism, Stopped};
use super::record::dot;
use super::{N, RADIUS_MM, place};
use crate::scorecard::cases::Deed;
use crate::scorecard::direction::{Approach, DirectionFigures};
use crate::scorecard::measure::{Figures, Measure};
use touchstone_control::space::environment::{Plane, Sphere};
use touchstone_control::space::{
    Direction, LengthUnit, Magnitude, Rule, Shape, Shell, SpaceWall, Surface, SurfacePoint, Vector,
    VectorGuard,
};
use touchstone_control::{
    AnyLaw, EstimatorSettings, Force, GuardSettings, GuardedDevice, Position, Reported, Settings,
    SettingsError, Si,
};
use touchstone_world::plant::Hand;

/// The surface that the hand presses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PressedSurface {
    /// A plane: a point in it in m, and its outward unit normal.
    Plane([f64; 3], [f64; 3]),
    /// A ball with a radius of 30 mm in the centre of the workspace. The vector is its outward unit normal at the pressed point.
    Ball([f64; 3]),
}

impl PressedSurface {
    /// Outward unit normal at the pressed point.
    #[must_use]
    pub fn normal(&self) -> [f64; 3] {
        match self {
            Self::Plane(_, normal) | Self::Ball(normal) => *normal,
        }
    }

    fn shape(&self) -> Shape<N> {
        match self {
            Self::Plane(through_m, normal) => Shape::Plane(Plane {
                // A vector of 50 mm fits the number format; only its direction matters.
                normal: Direction::of(place(normal.map(|n| 50.0 * n))).unwrap_or_default(),
                height: Position(N::signal_from_f64(100.0 * dot(*through_m, *normal))),
            }),
            Self::Ball(_) => Shape::Sphere(Sphere {
                centre: Vector::default(),
                radius: Position(N::signal_from_f64(RADIUS_MM / 10.0)),
            }),
        }
    }

    /// Rest point of a hand at the depth `depth_m` below the surface, m.
    fn at_depth_m(&self, depth_m: f64) -> [f64; 3] {
        match self {
            Self::Plane(through_m, normal) => {
                std::array::from_fn(|i| through_m[i] - depth_m * normal[i])
            }
            Self::Ball(normal) => normal.map(|n| (1e-3 * RADIUS_MM - depth_m) * n),
        }
    }

    /// Depth of a position below the surface in m, and the normal there.
    fn beneath(&self, at: [f64; 3]) -> (f64, [f64; 3]) {
        match self {
            Self::Plane(through_m, normal) => {
                (dot(*through_m, *normal) - dot(at, *normal), *normal)
            }
            Self::Ball(_) => {
                let radius = dot(at, at).sqrt();
                let out = at.map(|x| x / radius.max(1e-9));
                (1e-3 * RADIUS_MM - radius, out)
            }
        }
    }
}

/// A surface that a control law renders, on a device in a hand.
#[derive(Debug, Clone, PartialEq)]
pub struct PressedWall {
    /// The surface that the hand presses.
    pub surface: PressedSurface,
    /// Settings of the law in SI units; they include the control rate.
    pub law: Settings,
    /// Settings of the state estimators; absent if the law uses measured positions.
    pub estimator: Option<EstimatorSettings>,
    /// The mechanism of the device.
    pub mechanism: Mechanism,
    /// How the device differs from its nominal values, as factors and a delay.
    pub deviation: Deviation,
    /// The hand that holds the device.
    pub hand: Hand,
    /// Force of the press, N.
    pub push_n: f64,
}

/// Force of the light touch before a press, as a fraction of the press.
const TOUCH_SHARE: f64 = 0.2;

/// Settings of the energy guard for a mechanism, SI units.
#[must_use]
pub fn guard(mechanism: Mechanism) -> GuardSettings {
    GuardSettings {
        capacity: Si::from_num(0.04),
        damping: Si::from_num(mechanism.damping()),
        overspeed: Si::from_num(1.5),
        ..GuardSettings::default()
    }
}

/// Makes a wall with a control law along its normal and the energy guard. It uses estimated states if `estimator` is given.
///
/// # Errors
/// Control law or energy guard do not accept their settings.
pub(super) fn guarded<S: Surface<N>>(
    surface: S,
    law: &Settings,
    estimator: Option<&EstimatorSettings>,
    mechanism: Mechanism,
) -> Result<SpaceWall<N, S, AnyLaw<N>>, SettingsError> {
    let unit = LengthUnit::Centimetre;
    let mut wall = SpaceWall::new(
        surface,
        SurfacePoint::new(Rule::Closest),
        Shell::Magnitude(Magnitude::new(unit.law::<N>(law)?).with_impact(unit.impact(law)?)),
        Force::from_f64(law.force_limit.to_num()),
    );
    if let Some(estimator) = estimator {
        let axes = [*estimator; 3];
        wall.estimator = Some(unit.estimator(&axes, law.rate_hz, law.force_limit)?);
    }
    let (guard, device) = unit.guard(
        &guard(mechanism),
        &GuardedDevice {
            rate_hz: law.rate_hz,
            force_limit: law.force_limit,
            count: Si::from_num(mechanism.count_m()),
        },
    );
    let guard = VectorGuard::new(&guard, &device)?;
    wall.guard = Some((guard, guard.full()));
    Ok(wall)
}

impl PressedWall {
    fn wall(&self) -> Result<SpaceWall<N, Shape<N>, AnyLaw<N>>, SettingsError> {
        let (law, estimator) = (&self.law, self.estimator.as_ref());
        guarded(self.surface.shape(), law, estimator, self.mechanism)
    }

    /// Wall and forces of the hand along the surface's normal, for the scorecard.
    #[must_use]
    pub fn approach(&self) -> Approach {
        let count_m = self.mechanism.count_m() / self.deviation.counts;
        let across: f64 = self.surface.normal().iter().map(|n| n.abs()).sum();
        Approach {
            k_desired_n_per_m: self.law.k_desired.to_num(),
            push_n: self.push_n,
            touch_n: TOUCH_SHARE * self.push_n,
            count_m,
            unsure_m: 0.5 * count_m * across,
            rate_hz: self.law.rate_hz,
        }
    }

    /// Simulates an action of the hand; returns the scorecard's measures.
    ///
    /// # Errors
    /// Control law or energy guard do not accept their settings.
    pub fn played(&self, deed: Deed) -> Result<DirectionFigures, SettingsError> {
        self.played_with_force(deed).map(|(found, _)| found)
    }

    /// Simulates an action of the hand; returns the scorecard's measures and the largest force that was requested of the motors,
    /// N. If the mechanism cannot reach a position, all measures are infinite and the force is 0.
    ///
    /// # Errors
    /// Control law or energy guard do not accept their settings.
    pub fn played_with_force(&self, deed: Deed) -> Result<(DirectionFigures, f64), SettingsError> {
        let mut wall = self.wall()?;
        let lost = DirectionFigures {
            figures: Figures::LOST,
            settle_s: None,
        };
        Ok(self.looped(&mut wall, deed).unwrap_or((lost, 0.0)))
    }

    fn looped(
        &self,
        wall: &mut SpaceWall<N, Shape<N>, AnyLaw<N>>,
        deed: Deed,
    ) -> Result<(DirectionFigures, f64), Stopped> {
        let interval_s = 1.0 / f64::from(self.law.rate_hz);
        let approach = self.approach();
        let rest_m = |tick: u64| {
            let time_s = tick as f64 * interval_s;
            self.surface
                .at_depth_m(approach.rest_depth_m(&self.hand, deed, time_s))
        };
        let mut held = HeldMechanism::new(
            self.mechanism,
            &self.deviation,
            &self.hand,
            interval_s,
            rest_m(0),
        )?;
        let mut watch = approach.watch(deed);
        let (mut energy_j, mut least_j, mut longest_n) = (0.0_f64, 0.0_f64, 0.0_f64);
        for tick in 0..approach.ticks(deed) {
            let here = held.place_m();
            let measured = held.measured_m()?.map(|x| 1e3 * x);
            let force = wall.tick(place(measured)).unwrap_or_default();
            let force = force.0.map(Force::to_f64);
            longest_n = longest_n.max(dot(force, force).sqrt());
            let crossed = held.step(force, rest_m(tick))?;
            energy_j += crossed.loss.device_j - crossed.motors_j;
            least_j = least_j.min(energy_j + held.moving_j()?);
            let (before, was) = self.surface.beneath(here);
            let (after, is) = self.surface.beneath(held.place_m());
            let middle = std::array::from_fn(|i| 0.5 * (was[i] + is[i]));
            watch.take(tick, 0.5 * (before + after), dot(crossed.force_n, middle));
        }
        let mut found = watch.finish();
        found.figures.raise(Measure::EnergyOutJ, -least_j);
        Ok((found, longest_n))
    }
}
