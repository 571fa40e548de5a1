//! Motor, bridge, knob and hand as one simulated system, which the caller advances by one PWM period per call.

use super::bridge::{Bridge, Drive};
use super::windings::{MotorParameters, Windings};
use crate::plant::train::Harmonic;
use crate::plant::{Device, Kinematics, Stepper};

/// True values at the end of a PWM period: currents, angle, speed and torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Phase currents into the motor, A.
    pub currents_a: [f64; 3],
    /// Shaft angle, rad.
    pub angle_rad: f64,
    /// Shaft speed, rad/s.
    pub speed_rad_per_s: f64,
    /// Mean torque of the motor over the last PWM period in the direction of positive angles, N·m.
    pub torque_n_m: f64,
}

/// A motor with its bridge on a mechanical plant.
#[derive(Debug, Clone)]
pub struct Rig<S: Stepper> {
    /// The bridge. The bus voltage may be changed between two periods.
    pub bridge: Bridge,
    /// Harmonics of the motor's cogging torque over the shaft angle; their torques are added.
    pub cogging: Vec<Harmonic>,
    windings: Windings,
    plant: S,
    state: S::State,
    torque_n_m: f64,
}

impl<S: Stepper> Rig<S> {
    /// A motor at rest at an angle, without current. The interval of `plant` must be one PWM period.
    #[must_use]
    pub fn new(motor: MotorParameters, bridge: Bridge, plant: S, angle_rad: f64) -> Self {
        Self {
            bridge,
            cogging: Vec::new(),
            windings: Windings::new(motor, plant.interval_s()),
            plant,
            state: S::State::at_rest(angle_rad),
            torque_n_m: 0.0,
        }
    }

    /// True values at the present time: currents, angle, speed and the mean torque of the last PWM period.
    #[must_use]
    pub fn now(&self) -> Reading {
        Reading {
            currents_a: self.windings.currents_a(),
            angle_rad: self.state.position(),
            speed_rad_per_s: self.state.velocity(),
            torque_n_m: self.torque_n_m,
        }
    }

    /// Advances by one PWM period and returns the true values at its end. `drive` is the state of the bridge; `rest_rad` is the
    /// hand's rest point, which a plant without a hand ignores.
    pub fn step(&mut self, drive: Drive, rest_rad: f64) -> Reading {
        let angle = self.state.position();
        let torque_n_m = match drive {
            Drive::Off => self
                .windings
                .freewheel(self.bridge.bus_v, self.bridge.diode_v, angle),
            Drive::On(duties) => {
                let voltages = self.bridge.voltages(duties, self.windings.currents_a());
                // The mean speed in this period comes from a trial step with the torque of the last period.
                let mut ahead = self.state;
                let turning = self.with_cogging(self.torque_n_m, angle);
                self.plant.step(&mut ahead, turning, rest_rad);
                let speed = (ahead.position() - angle) / self.plant.interval_s();
                self.windings.step(voltages, angle, speed)
            }
        };
        self.torque_n_m = torque_n_m;
        let turning = self.with_cogging(torque_n_m, angle);
        self.plant.step(&mut self.state, turning, rest_rad);
        self.now()
    }

    /// The sum of a torque and the cogging torque at an angle, N·m.
    fn with_cogging(&self, torque_n_m: f64, angle_rad: f64) -> f64 {
        self.cogging
            .iter()
            .fold(torque_n_m, |sum, it| sum + it.torque(angle_rad))
    }

    /// Currents `(i_d, i_q)` along and across the rotor's flux, at the rotor's true angle, A.
    #[must_use]
    pub fn dq_a(&self) -> (f64, f64) {
        self.windings.dq_a(self.state.position())
    }

    /// The plant's state, so that a caller can set or disturb it.
    pub fn state_mut(&mut self) -> &mut S::State {
        &mut self.state
    }
}

/// The knob of the thesis that describes the control laws, without its dry friction: 1e-4 kg·m², 4e-4 N·m·s/rad.
pub const KNOB: Device = Device {
    inertia: 1e-4,
    damping: 4e-4,
    friction: None,
};
