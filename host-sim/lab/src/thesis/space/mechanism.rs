//! The device in three degrees of freedom, nominal or varied: a mass that is the same in every direction, or a delta mechanism.

use crate::scorecard::cases::Change;
use serde::{Deserialize, Serialize};
use touchstone_world::plant::{
    Cartesian, DeltaDevice, DeltaPlant, DeltaPose, DeltaState, Device, FALCON, Hand, HeldLinear,
    Kinematics, Loss, OMEGA3, OMEGA3_AXIS, State,
};

/// Type of the device's mechanism.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mechanism {
    /// An omega.3, modelled as three axes that do not influence each other.
    #[default]
    Cartesian,
    /// A delta mechanism with the lengths of the Novint Falcon.
    Delta,
}

/// Largest force of the Novint Falcon, N, as the library CHAI3D gives it.
const FALCON_FORCE_N: f64 = 8.0;
/// Least damping of the delta mechanism within 35 mm of its centre, N·s/m, rounded down. A test computes this value.
pub const DELTA_DAMPING: f64 = 0.5;

impl Mechanism {
    /// All types of mechanisms.
    pub const ALL: [Mechanism; 2] = [Mechanism::Cartesian, Mechanism::Delta];

    /// Name of the mechanism on the command line and in scene files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Cartesian => "cartesian",
            Self::Delta => "delta",
        }
    }

    /// Description of the mechanism for readers.
    #[must_use]
    pub fn about(self) -> &'static str {
        match self {
            Self::Cartesian => "an omega.3 as three equal axes",
            Self::Delta => "a delta mechanism of a Falcon's lengths",
        }
    }

    /// Largest force that the motors can give in every direction, N.
    #[must_use]
    pub fn force_n(self) -> f64 {
        match self {
            Self::Cartesian => OMEGA3.force_n,
            Self::Delta => FALCON_FORCE_N,
        }
    }

    /// Least damping in any direction, N·s/m. Control law and energy guard assume this value.
    #[must_use]
    pub fn damping(self) -> f64 {
        match self {
            Self::Cartesian => OMEGA3_AXIS.damping,
            Self::Delta => DELTA_DAMPING,
        }
    }

    /// Resolution of the measured position, m. For the delta it is the largest motion of the effector per joint count, at the
    /// centre.
    #[must_use]
    pub fn count_m(self) -> f64 {
        match self {
            Self::Cartesian => OMEGA3.count_m,
            Self::Delta => {
                let centre = FALCON.geometry.pose([0.0; 3].into());
                let slopes = centre.map(|pose| pose.metres_per_radian());
                let furthest = slopes.map_or(0.0, |slopes| slopes.amax());
                furthest * FALCON.count_rad
            }
        }
    }

    /// Requested stiffnesses of a comparison, N/mm: the critical stiffness `2 b/T` (damping `b`, control period `T`), and five
    /// times that. For the omega.3 they are those of §5.2 of the thesis.
    #[must_use]
    pub fn stiffnesses_n_per_mm(self) -> [f64; 2] {
        let critical = 2e-3 * self.damping() * f64::from(super::RATE_HZ);
        [critical, 5.0 * critical]
    }

    /// Force with which the hand pushes, N: half of the largest motor force.
    #[must_use]
    pub fn push_n(self) -> f64 {
        0.5 * self.force_n()
    }

    /// Speed at which the hand slides along a surface, mm/s: the thesis' 50 mm/s for the omega.3. For the delta the speed keeps the
    /// motion within 40 mm of the centre.
    #[must_use]
    pub fn slide_mm_per_s(self) -> f64 {
        match self {
            Self::Cartesian => super::SLIDE_MM_PER_S,
            Self::Delta => 20.0,
        }
    }
}

/// How a device differs from its nominal values: factors on its properties, and a delay.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Deviation {
    /// Factor on the device's inertia.
    pub inertia: f64,
    /// Factor on the device's damping.
    pub damping: f64,
    /// Factor on the number of position counts.
    pub counts: f64,
    /// Delay from a sample until its command acts, in ticks (control periods). `HeldMechanism::new` limits the delay to 0 to 1.
    pub delay_ticks: f64,
}

impl Deviation {
    /// No deviation: the nominal device.
    pub const NONE: Self = Self {
        inertia: 1.0,
        damping: 1.0,
        counts: 1.0,
        delay_ticks: 0.0,
    };

    /// The device's deviation from the nominal one for a case of the scorecard.
    #[must_use]
    pub fn of(change: Change) -> Self {
        let mut deviation = Self::NONE;
        match change {
            Change::Nothing => {}
            Change::Counts(share) => deviation.counts = share,
            Change::Inertia(times) => deviation.inertia = times,
            Change::Damping(times) => deviation.damping = times,
            Change::Delay(ticks) => deviation.delay_ticks = ticks,
        }
        deviation
    }
}

/// Mean force, work and losses of one simulated tick (control period).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Crossed {
    /// Mean force on the effector during the tick, N.
    pub force_n: [f64; 3],
    /// Work of the motors during the tick, J.
    pub motors_j: f64,
    /// Energy dissipated during the tick, J.
    pub loss: Loss,
}

/// Error: the simulation cannot continue, because the plant cannot be built or the mechanism cannot reach the position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stopped;

#[derive(Debug, Clone)]
#[expect(
    clippy::large_enum_variant,
    reason = "there is one in a run, and it stays where it is"
)]
enum Body {
    Cartesian {
        plants: [Cartesian<HeldLinear>; 2],
        state: [State<4>; 3],
        mass_kg: f64,
        last: [f64; 3],
    },
    Delta {
        device: DeltaDevice,
        plants: [DeltaPlant; 2],
        state: DeltaState,
        measured: DeltaPose,
        last: [f64; 3],
    },
}

/// A device in a hand, simulated tick by tick (per control period).
#[derive(Debug, Clone)]
pub struct HeldMechanism {
    body: Body,
    count_m: f64,
    late: f64,
}

type Held = Cartesian<HeldLinear>;

impl HeldMechanism {
    /// Makes a mechanism at rest at the hand's rest point.
    ///
    /// # Errors
    /// [`Stopped`]: device or hand are not possible, or the position is out of reach.
    pub fn new(
        mechanism: Mechanism,
        deviation: &Deviation,
        hand: &Hand,
        interval_s: f64,
        rest_m: [f64; 3],
    ) -> Result<Self, Stopped> {
        let late = deviation.delay_ticks.clamp(0.0, 1.0);
        let spans = [late * interval_s, (1.0 - late) * interval_s];
        let body = match mechanism {
            Mechanism::Cartesian => {
                let axis = Device {
                    inertia: OMEGA3_AXIS.inertia * deviation.inertia,
                    damping: OMEGA3_AXIS.damping * deviation.damping,
                    ..OMEGA3_AXIS
                };
                let plant = |span| Held::held(&axis, hand, span).map_err(|_| Stopped);
                Body::Cartesian {
                    plants: [plant(spans[0])?, plant(spans[1])?],
                    state: Held::at_rest(rest_m),
                    mass_kg: axis.inertia,
                    last: [0.0; 3],
                }
            }
            Mechanism::Delta => {
                let mut device = FALCON;
                for mass in [
                    &mut device.masses.arm_kg_m2,
                    &mut device.masses.elbow_kg,
                    &mut device.masses.forearm_kg,
                    &mut device.masses.effector_kg,
                ] {
                    *mass *= deviation.inertia;
                }
                device.joint_damping *= deviation.damping;
                device.count_rad /= deviation.counts;
                let plant = |span| DeltaPlant::new(&device, Some(hand), span).map_err(|_| Stopped);
                let pose = device.geometry.pose(rest_m.into()).map_err(|_| Stopped)?;
                Body::Delta {
                    device,
                    plants: [plant(spans[0])?, plant(spans[1])?],
                    state: DeltaState::at_rest(rest_m),
                    measured: device.measured(&pose).map_err(|_| Stopped)?,
                    last: [0.0; 3],
                }
            }
        };
        Ok(Self {
            body,
            count_m: mechanism.count_m() / deviation.counts,
            late,
        })
    }

    /// Resolution of the measured position, m.
    #[must_use]
    pub fn count_m(&self) -> f64 {
        self.count_m
    }

    /// True position of the effector, m.
    #[must_use]
    pub fn place_m(&self) -> [f64; 3] {
        match &self.body {
            Body::Cartesian { state, .. } => Held::position(state),
            Body::Delta { state, .. } => state.place_m.into(),
        }
    }

    /// Position that the encoders measure, m.
    ///
    /// # Errors
    /// [`Stopped`]: the counts belong to no position of the mechanism.
    pub fn measured_m(&mut self) -> Result<[f64; 3], Stopped> {
        match &mut self.body {
            Body::Cartesian { state, .. } => {
                Ok(Held::position(state).map(|x| (x / self.count_m).round() * self.count_m))
            }
            Body::Delta {
                device,
                state,
                measured,
                ..
            } => {
                let pose = device.geometry.pose(state.place_m);
                *measured = pose
                    .and_then(|pose| device.measured(&pose))
                    .map_err(|_| Stopped)?;
                Ok(measured.place_m.into())
            }
        }
    }

    /// Simulates one tick (control period). The previous command acts until the new one takes effect after the delay.
    ///
    /// # Errors
    /// [`Stopped`]: the mechanism cannot reach the position.
    pub fn step(&mut self, force_n: [f64; 3], rest_m: [f64; 3]) -> Result<Crossed, Stopped> {
        let mut crossed = Crossed::default();
        let shares = [self.late, 1.0 - self.late];
        match &mut self.body {
            Body::Cartesian {
                plants,
                state,
                last,
                ..
            } => {
                let acts = OMEGA3.limited(force_n);
                for ((plant, force), share) in plants.iter().zip([*last, acts]).zip(shares) {
                    if share == 0.0 {
                        continue;
                    }
                    let was = Held::position(state);
                    crossed.loss += plant.step_with_loss(state, force, rest_m);
                    let is = Held::position(state);
                    crossed.motors_j += (0..3).map(|i| force[i] * (is[i] - was[i])).sum::<f64>();
                    (0..3).for_each(|i| crossed.force_n[i] += share * force[i]);
                }
                *last = acts;
            }
            Body::Delta {
                device,
                plants,
                state,
                measured,
                last,
            } => {
                // As in a driver: the Jacobian is taken at the position that the encoders measure.
                let acts = device.limited_torques_n_m(measured, force_n.into());
                for ((plant, torques), share) in
                    plants.iter().zip([(*last).into(), acts]).zip(shares)
                {
                    if share == 0.0 {
                        continue;
                    }
                    let work = plant.step(state, torques, rest_m).map_err(|_| Stopped)?;
                    crossed.loss += work.loss;
                    crossed.motors_j += work.motors_j;
                    let force = measured.force_n(torques);
                    (0..3).for_each(|i| crossed.force_n[i] += share * force[i]);
                }
                *last = acts.into();
            }
        }
        Ok(crossed)
    }

    /// Kinetic energy of the device without the hand, J.
    ///
    /// # Errors
    /// [`Stopped`]: the mechanism cannot reach the position.
    pub fn moving_j(&self) -> Result<f64, Stopped> {
        match &self.body {
            Body::Cartesian { state, mass_kg, .. } => {
                let squares = state.iter().map(|axis| axis.velocity() * axis.velocity());
                Ok(0.5 * mass_kg * squares.sum::<f64>())
            }
            Body::Delta { device, state, .. } => {
                let pose = device.geometry.pose(state.place_m).map_err(|_| Stopped)?;
                Ok(0.5
                    * state
                        .velocity
                        .dot(&(device.inertia_kg(&pose) * state.velocity)))
            }
        }
    }

    /// Kinetic and spring energy of device and hand, J.
    ///
    /// # Errors
    /// [`Stopped`]: the mechanism cannot reach the position.
    pub fn stored_j(&self, rest_m: [f64; 3]) -> Result<f64, Stopped> {
        match &self.body {
            Body::Cartesian { plants, state, .. } => Ok(plants[1].stored_energy_j(state, rest_m)),
            Body::Delta { plants, state, .. } => plants[1]
                .stored_energy_j(state, rest_m)
                .map_err(|_| Stopped),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_delta_has_the_damping_that_is_promised_wherever_it_is_used() {
        let mut least = f64::INFINITY;
        for i in 0..4000 {
            let angle = f64::from(i) * 2.399_963;
            let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / 4000.0;
            let across = (1.0 - z * z).sqrt();
            let radius = 0.035 * f64::from(i % 8) / 7.0;
            let at = [across * angle.cos(), across * angle.sin(), z].map(|x| radius * x);
            let pose = FALCON.geometry.pose(at.into()).expect("in reach");
            let damping = FALCON.damping_n_s_per_m(&pose);
            least = least.min(damping.symmetric_eigenvalues().min());
        }
        println!("least {least}");
        assert!(
            (DELTA_DAMPING..DELTA_DAMPING + 0.1).contains(&least),
            "{least}"
        );
    }
}
