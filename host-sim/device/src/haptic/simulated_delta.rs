//! A simulated delta mechanism with three motors and three joint encoders, in a simulated hand. The hand is a spring whose rest
//! point moves.

use super::simulated::Rest;
use super::{
    Applied, DataSheet, DeviceStanding, HapticDevice, HapticFault, Sensed, Workspace, length,
};
use touchstone_world::plant::{
    DeltaDevice, DeltaPlant, DeltaPose, DeltaState, Device, FALCON, Hand, Unreachable,
};

/// A simulated delta mechanism. Every commanded force advances the simulation by one control interval under the motor torques of
/// that force.
pub struct SimulatedDelta {
    sheet: DataSheet,
    device: DeltaDevice,
    plant: DeltaPlant,
    state: DeltaState,
    /// The present pose as the joint encoders measure it: joint angles and the effector's position.
    measured: DeltaPose,
    rest: Rest,
    interval_s: f64,
    time_s: f64,
    engaged: bool,
}

/// Largest force of the Novint Falcon, N. The library CHAI3D gives this value and the workspace of 40 mm around the centre.
const FALCON_FORCE_N: f64 = 8.0;
const FALCON_REACH_M: f64 = 0.04;
const FALCON_WORKSPACE: Workspace = Workspace {
    radius_m: FALCON_REACH_M,
    half_height_m: FALCON_REACH_M,
};
/// Fastest control rate of the Falcon, Hz.
pub const FALCON_RATE_HZ: u32 = 1000;

/// The device fault for a position that the mechanism cannot reach.
fn left(why: Unreachable) -> HapticFault {
    HapticFault::Unusable(
        format!("it left the positions that its arms can reach: {why}"),
        "keep it nearer to the centre of its workspace".into(),
    )
}

/// Least damping over all directions at a grid of reachable positions of the workspace, N·s/m.
fn least_damping(device: &DeltaDevice) -> f64 {
    let steps = || (-4_i32..=4).map(|step| FALCON_REACH_M * f64::from(step) / 4.0);
    let places = steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| [x, y, z])));
    places
        .filter(|place_m| FALCON_WORKSPACE.outside_m(*place_m) <= 0.0)
        .filter_map(|place_m| device.geometry.pose(place_m.into()).ok())
        .map(|pose| {
            let damping = device.damping_n_s_per_m(&pose);
            damping.symmetric_eigenvalues().min()
        })
        .fold(f64::INFINITY, f64::min)
}

impl SimulatedDelta {
    /// A mechanism with the Falcon's geometry, at rest at the hand's rest point at time 0 (also if there is no hand).
    ///
    /// # Errors
    /// [`HapticFault::Unusable`] for settings that no hand can have, or a position out of reach.
    pub fn falcon(hand: Option<&Hand>, rate_hz: u32, mut rest: Rest) -> Result<Self, HapticFault> {
        let device = FALCON;
        let interval_s = 1.0 / f64::from(rate_hz);
        let plant = DeltaPlant::new(&device, hand, interval_s).map_err(|why| {
            HapticFault::Unusable(format!("no plant: {why}"), "correct the hand".into())
        })?;
        let state = DeltaState::at_rest(rest(0.0));
        let pose = device.geometry.pose(state.place_m).map_err(left)?;
        let measured = device.measured(&pose).map_err(left)?;
        // Displacement of the effector per encoder count at the centre, for the joint that moves it most.
        let centre = device.geometry.pose([0.0; 3].into()).map_err(left)?;
        let furthest = centre
            .metres_per_radian()
            .iter()
            .fold(0.0_f64, |a, x| a.max(x.abs()));
        let inertia_kg = device.inertia_kg(&centre);
        let damping = device.damping_n_s_per_m(&centre);
        let axes = std::array::from_fn(|i| Device {
            inertia: inertia_kg[(i, i)],
            damping: damping[(i, i)],
            friction: None,
        });
        Ok(Self {
            sheet: DataSheet {
                name: "simulated delta of a Falcon's geometry".into(),
                degrees: 3,
                force_n: FALCON_FORCE_N,
                workspace: FALCON_WORKSPACE,
                count_m: furthest * device.count_rad,
                rates_hz: (500, FALCON_RATE_HZ),
                delay_s: 0.0,
                axes: Some(axes),
                least_damping_n_s_per_m: Some(least_damping(&device)),
                sets_the_pace: false,
            },
            device,
            plant,
            state,
            measured,
            rest,
            interval_s,
            time_s: 0.0,
            engaged: false,
        })
    }
}

impl HapticDevice for SimulatedDelta {
    fn sheet(&self) -> &DataSheet {
        &self.sheet
    }

    fn engage(&mut self) -> Result<(), HapticFault> {
        self.engaged = true;
        Ok(())
    }

    fn sense(&mut self) -> Result<Sensed, HapticFault> {
        let pose = self.device.geometry.pose(self.state.place_m);
        self.measured = pose
            .and_then(|pose| self.device.measured(&pose))
            .map_err(left)?;
        Ok(Sensed {
            position_m: self.measured.place_m.into(),
            fresh: true,
        })
    }

    fn command(&mut self, force_n: [f64; 3]) -> Result<Applied, HapticFault> {
        let wanted = match self.engaged {
            true => force_n,
            false => [0.0; 3],
        };
        // A real driver computes the torques with the Jacobian at the measured pose, so this simulation does the same.
        let torques = self
            .device
            .limited_torques_n_m(&self.measured, wanted.into());
        let acts: [f64; 3] = self.measured.force_n(torques).into();
        let rest = (self.rest)(self.time_s);
        self.plant
            .step(&mut self.state, torques, rest)
            .map_err(left)?;
        self.time_s += self.interval_s;
        // A force that only rounding has shortened counts as the whole force.
        Ok(match length(acts) < length(wanted) * (1.0 - 1e-9) {
            true => Applied::Saturated(Some(acts)),
            false => Applied::Whole,
        })
    }

    fn standing(&mut self) -> Result<DeviceStanding, HapticFault> {
        Ok(DeviceStanding {
            powered: true,
            calibrated: true,
            motors_on: self.engaged,
            switched_off: None,
        })
    }

    fn release(&mut self) -> Result<(), HapticFault> {
        self.engaged = false;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_world::plant::FIRM_TRANSLATION;

    fn still() -> Rest {
        Box::new(|_| [0.01, 0.0, -0.005])
    }

    #[test]
    fn it_is_pushed_the_way_that_was_commanded_and_only_while_engaged() {
        let mut delta =
            SimulatedDelta::falcon(Some(&FIRM_TRANSLATION), 1000, still()).expect("delta");
        let start = delta.sense().expect("place").position_m;
        assert_eq!(delta.command([5.0, 0.0, 0.0]), Ok(Applied::Whole));
        for _ in 0..200 {
            delta.command([5.0, 0.0, 0.0]).expect("released");
        }
        assert_eq!(delta.sense().expect("place").position_m, start);
        delta.engage().expect("engaged");
        for _ in 0..3000 {
            delta.sense().expect("place");
            delta.command([3.0, -3.0, 0.0]).expect("engaged");
        }
        let moved = delta.sense().expect("place").position_m;
        let by: Vec<f64> = (0..3).map(|i| moved[i] - start[i]).collect();
        // 3 N move a hand with 300 N/m and a finger pad in series by 11.5 mm.
        assert!(
            (by[0] - 0.0115).abs() < 1e-3 && (by[1] + 0.0115).abs() < 1e-3,
            "{by:?}"
        );
        assert!(by[2].abs() < 1e-3, "{by:?}");
    }

    #[test]
    fn more_than_its_motors_have_is_said_with_what_acts() {
        let mut delta =
            SimulatedDelta::falcon(Some(&FIRM_TRANSLATION), 1000, still()).expect("delta");
        delta.engage().expect("engaged");
        delta.sense().expect("place");
        let Ok(Applied::Saturated(Some(acts))) = delta.command([0.0, 30.0, 40.0]) else {
            panic!("whole");
        };
        assert!(
            acts[1] > 5.0 && (acts[1] * 40.0 - acts[2] * 30.0).abs() < 1e-9,
            "{acts:?}"
        );
        assert!(acts[0].abs() < 1e-12);
    }

    #[test]
    fn out_of_reach_it_is_a_fault() {
        let run = |_| [0.0, 0.0, 0.2];
        let at: Rest = Box::new(run);
        assert!(SimulatedDelta::falcon(Some(&FIRM_TRANSLATION), 1000, at).is_err());
        let pulled: Rest = Box::new(|time_s| [0.0, 0.0, time_s]);
        let mut delta =
            SimulatedDelta::falcon(Some(&FIRM_TRANSLATION), 1000, pulled).expect("delta");
        let ended =
            (0..2000).find_map(|_| delta.sense().and_then(|_| delta.command([0.0; 3])).err());
        assert!(
            matches!(ended, Some(HapticFault::Unusable(..))),
            "{ended:?}"
        );
    }

    /// Checks that no position has less damping than the energy guard relies on, which is 80 % of the least damping on the grid.
    /// Between the grid's positions the damping differs a little.
    #[test]
    fn nowhere_in_the_workspace_has_less_damping_than_is_told() {
        let told = least_damping(&FALCON);
        let trusted = 0.8 * told;
        let mut seen = f64::INFINITY;
        for i in 0..20_000 {
            let turn = 2.399_963 * f64::from(i);
            let radius = FALCON_REACH_M * (f64::from(i % 101) / 100.0).sqrt();
            let height = FALCON_REACH_M * (f64::from(i) / 10_000.0 - 1.0);
            let place_m = [radius * turn.cos(), radius * turn.sin(), height];
            let Ok(pose) = FALCON.geometry.pose(place_m.into()) else {
                continue;
            };
            let damping = FALCON.damping_n_s_per_m(&pose);
            seen = seen.min(damping.symmetric_eigenvalues().min());
        }
        let centre = FALCON.geometry.pose([0.0; 3].into()).expect("in reach");
        let there = FALCON
            .damping_n_s_per_m(&centre)
            .symmetric_eigenvalues()
            .min();
        println!("told {told}, trusted {trusted}, seen {seen}, at the centre {there}");
        assert!(trusted < seen && seen < 0.7 * there, "{seen}");
    }
}
