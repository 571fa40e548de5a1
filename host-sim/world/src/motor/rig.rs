//! Motor, bridge, knob and hand as one simulated system, which the caller advances by one PWM period per call.

use super::bridge::{Bridge, Drive};
use super::windings::{MotorParameters, Windings};
use crate::plant::train::Harmonic;
use crate::plant::{Device, Kinematics, Stepper};

/// True values at the end of a PWM period: currents, angle, speed and torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Currents of the bridge's legs A, B, C into the motor, A.
    pub currents_a: [f64; 3],
    /// Shaft angle, rad.
    pub angle_rad: f64,
    /// Shaft speed, rad/s.
    pub speed_rad_per_s: f64,
    /// Mean torque of the motor over the last PWM period in the direction of positive angles, N·m.
    pub torque_n_m: f64,
}

/// How the bridge's legs A, B, C are connected to the motor's phases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wires {
    /// The phase of each leg.
    pub order: [usize; 3],
    /// The phase without a connection, if there is one.
    pub open: Option<usize>,
}

impl Wires {
    /// Each leg on its own phase.
    pub const RIGHT: Self = Self {
        order: [0, 1, 2],
        open: None,
    };
}

/// A motor with its bridge on a mechanical plant.
#[derive(Debug, Clone)]
pub struct Rig<S: Stepper> {
    /// The bridge. The bus voltage may be changed between two periods.
    pub bridge: Bridge,
    /// Harmonics of the motor's cogging torque over the shaft angle; their torques are added.
    pub cogging: Vec<Harmonic>,
    /// The wires between bridge and motor. They may be changed between two periods.
    pub wires: Wires,
    /// The motor's work on the shaft since the beginning, less what the device's own damping and friction took, J: what knob and
    /// hand got.
    pub given_j: f64,
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
            wires: Wires::RIGHT,
            given_j: 0.0,
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
            currents_a: self.legs_a(),
            angle_rad: self.state.position(),
            speed_rad_per_s: self.state.velocity(),
            torque_n_m: self.torque_n_m,
        }
    }

    /// Advances by one PWM period and returns the true values at its end. `drive` is the state of the bridge; `rest_rad` is the
    /// hand's rest point, which a plant without a hand ignores.
    pub fn step(&mut self, drive: Drive, rest_rad: f64) -> Reading {
        let angle = self.state.position();
        if let Some(phase) = self.wires.open {
            self.windings.cut(phase);
        }
        let torque_n_m = match drive {
            Drive::Off => self
                .windings
                .freewheel(self.bridge.bus_v, self.bridge.diode_v, angle),
            Drive::On(duties) => {
                let legs = self.bridge.voltages(duties, self.legs_a());
                let mut voltages = [0.0; 3];
                for (leg, phase) in self.wires.order.into_iter().enumerate() {
                    voltages[phase] = legs[leg];
                }
                // The mean speed in this period comes from a trial step with the torque of the last period.
                let mut ahead = self.state;
                let turning = self.with_cogging(self.torque_n_m, angle);
                self.plant.step(&mut ahead, turning, rest_rad);
                let speed = (ahead.position() - angle) / self.plant.interval_s();
                match self.wires.open {
                    None => self.windings.step(voltages, angle, speed),
                    Some(open) => self.windings.step_without(open, voltages, angle, speed),
                }
            }
        };
        self.torque_n_m = torque_n_m;
        let turning = self.with_cogging(torque_n_m, angle);
        let loss = self
            .plant
            .step_with_loss(&mut self.state, turning, rest_rad);
        self.given_j += torque_n_m * (self.state.position() - angle) - loss.device_j;
        self.now()
    }

    /// Currents of the bridge's legs into the motor, A.
    fn legs_a(&self) -> [f64; 3] {
        let phases = self.windings.currents_a();
        self.wires.order.map(|phase| phases[phase])
    }

    /// The motor's parameters.
    #[must_use]
    pub const fn motor(&self) -> &MotorParameters {
        self.windings.motor()
    }

    /// Changes motor and plant while they run: angles, speeds and currents are kept. The interval may change too.
    pub fn change(&mut self, motor: MotorParameters, plant: S) {
        self.windings = self.windings.of_motor(motor, plant.interval_s());
        self.plant = plant;
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
