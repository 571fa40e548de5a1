//! The simulated world around the board: motor, knob, hand and supply.
//!
//! The knob and the hand move in steps of half a PWM period, by the exact models of `host-sim/world`. The phase currents are
//! updated at every change of the power bridge and at every sample of a converter.

mod sensors;
mod short;

use std::fmt;

use touchstone_world::motor::{Bridge, Drive, GIMBAL, MotorParameters, Windings};
use touchstone_world::plant::train::Harmonic;
use touchstone_world::plant::{
    BareCoulomb, Coulomb, Device, Hand, HeldCoulomb, Kinematics as _, Port, State, Stepper,
};

use crate::peripheral::CORE_HZ;
use crate::peripheral::timer::gates::Leg;
pub use short::{Short, Touched};

pub use sensors::{EncoderError, Noise, Sensors};

/// Processor cycles per step of the mechanical simulation, 25 µs.
const STEP: u64 = 4_250;

/// Compare value at which a phase is always connected to the bus voltage.
const TOP: u16 = 4_250;

/// The usual motor. Its electrical angle at the encoder's zero is 1 rad, so that it is no special angle.
const MOTOR: MotorParameters = MotorParameters {
    electrical_zero_rad: 1.0,
    ..GIMBAL
};

fn seconds(cycles: u64) -> f64 {
    cycles as f64 / CORE_HZ as f64
}

/// The knob of the thesis, with the dry friction of a small motor.
const KNOB: Device = Device {
    inertia: 1e-4,
    damping: 4e-4,
    friction: Some(Coulomb {
        kinetic: 1e-3,
        breakaway: 1e-3,
    }),
};

/// The gimbal motor GBM2804H-100T with the values of NuttX's table of motors. Each phase's resistance includes half of the driver's
/// 1 ohm and half of a shunt of 0.33 ohm.
const KIT_MOTOR: MotorParameters = MotorParameters {
    resistance_ohm: 5.29 + 0.5 + 0.165,
    inductance_h: 1.05e-3,
    flux_linkage_wb: 5.38e-3,
    pole_pairs: 7,
    electrical_zero_rad: 1.0,
    reversed: false,
};

/// The kit motor's rotor with a light knob: the scene `gimbal-knob`.
const KIT_KNOB: Device = Device {
    inertia: 3e-5,
    damping: 9e-6,
    friction: Some(Coulomb {
        kinetic: 5e-4,
        breakaway: 5e-4,
    }),
};

/// Parameters of the motor and of the knob on its shaft.
#[derive(Debug, Clone, Copy)]
pub struct Parts {
    /// Parameters of the motor.
    pub motor: MotorParameters,
    /// Inertia, damping and friction of the knob with the motor's rotor.
    pub knob: Device,
}

impl Default for Parts {
    fn default() -> Self {
        Self {
            motor: MOTOR,
            knob: KNOB,
        }
    }
}

impl Parts {
    /// The small motor that the X-NUCLEO-IHM16M1 is sold with.
    #[must_use]
    pub fn gimbal_kit() -> Self {
        Self {
            motor: KIT_MOTOR,
            knob: KIT_KNOB,
        }
    }

    /// The motor of [`Parts::gimbal_kit`] on a driver DRV8313, without shunts. The driver's transistors add 0.24 ohm to each phase.
    #[must_use]
    pub fn gimbal_on_mini() -> Self {
        let mut parts = Self::gimbal_kit();
        parts.motor.resistance_ohm = 5.29 + 0.24;
        parts
    }

    /// The usual motor and knob, with these properties multiplied by a factor each: resistance, inductance, flux, inertia, damping,
    /// friction.
    #[must_use]
    pub fn scaled([resistance, inductance, flux, inertia, damping, friction]: [f64; 6]) -> Self {
        let mut parts = Self::default();
        parts.motor.resistance_ohm *= resistance;
        parts.motor.inductance_h *= inductance;
        parts.motor.flux_linkage_wb *= flux;
        parts.knob.inertia *= inertia;
        parts.knob.damping *= damping;
        if let Some(coulomb) = &mut parts.knob.friction {
            coulomb.kinetic *= friction;
            coulomb.breakaway *= friction;
        }
        parts
    }
}

/// Runs one step of the mechanical simulation. Returns impulse and energies at the motor's port if `is_wanted`, otherwise zeros.
fn step<S: Stepper>(
    plant: &S,
    state: &mut S::State,
    torque: f64,
    rest: f64,
    is_wanted: bool,
) -> Port {
    if is_wanted {
        return plant.step_with_port(state, torque, rest);
    }
    plant.step(state, torque, rest);
    Port::default()
}

/// Rest point of the hand's spring in rad, as a function of the time in seconds since the hand took hold.
type RestPoint = Box<dyn Fn(f64) -> f64>;

// Only one value of this type exists and it is never moved, so its size costs nothing.
#[allow(clippy::large_enum_variant)]
enum Grip {
    Free(BareCoulomb, State<2>),
    Held {
        plant: HeldCoulomb,
        state: State<4>,
        since: u64,
        rest: RestPoint,
    },
    /// The shaft is turned from outside at `rad_per_s`, against any torque of the motor. `reverses`, if the speed alternates in
    /// sign: number of mechanical steps between two reversals, and until the next one.
    Forced {
        angle_rad: f64,
        rad_per_s: f64,
        reverses: Option<(u64, u64)>,
    },
}

/// Energy balance of the shaft: its state at the end of a mechanical step, and impulse and energies since recording began.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ShaftBooks {
    /// Angle of the shaft, rad.
    pub angle_rad: f64,
    /// Speed of the shaft, rad/s.
    pub rad_per_s: f64,
    /// Integral of the motor's torque over time, N·m·s.
    pub impulse_n_m_s: f64,
    /// The motor's work on the shaft, J.
    pub motor_j: f64,
    /// Energy dissipated in the knob, J.
    pub loss_j: f64,
}

/// The simulated world around the board.
pub struct World {
    knob: Device,
    now: u64,
    /// Time of the knob's next simulation step, in processor cycles.
    step_at: u64,
    motor: MotorParameters,
    windings: Windings,
    /// The supply and the transistors of the motor's power bridge.
    pub bridge: Bridge,
    drive: Drive,
    grip: Grip,
    /// Integral of the motor's torque since the knob's last simulation step, N·m·s. `torque_n_m` is the mean torque over the step
    /// before.
    impulse: f64,
    torque_n_m: f64,
    /// Energy balance of the shaft; `None` unless a test has started it.
    books: Option<ShaftBooks>,
    /// Temperature of the driver and the motor, °C.
    pub temperature_c: f64,
    /// Phase current in A at which the gate drivers' own protection acts.
    pub break_a: f64,
    /// Harmonics of the motor's cogging torque.
    pub cogging: Vec<Harmonic>,
    /// A short circuit at a motor wire; `None` if there is none.
    pub short: Option<Short>,
    /// Injected faults of the sensors.
    pub sensors: Sensors,
}

impl fmt::Debug for World {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("World")
            .field("now", &self.now)
            .finish_non_exhaustive()
    }
}

impl Default for World {
    fn default() -> Self {
        Self::new(&Parts::default(), 0.3)
    }
}

impl World {
    /// A simulated world without a hand, with a knob that rests at an angle.
    ///
    /// # Panics
    /// The knob's parameters are out of range.
    #[must_use]
    pub fn new(parts: &Parts, angle_rad: f64) -> Self {
        let plant = BareCoulomb::new(&parts.knob, seconds(STEP)).expect("the knob is in range");
        Self {
            knob: parts.knob,
            now: 0,
            step_at: STEP,
            motor: parts.motor,
            windings: Windings::new(parts.motor, seconds(STEP)),
            bridge: Bridge {
                dead_share: 0.01,
                ..Bridge::ideal(24.0, TOP)
            },
            drive: Drive::Off,
            grip: Grip::Free(plant, State::at_rest(angle_rad)),
            impulse: 0.0,
            torque_n_m: 0.0,
            books: None,
            temperature_c: 25.0,
            break_a: 20.0,
            cogging: Vec::new(),
            short: None,
            sensors: Sensors::default(),
        }
    }

    fn angle_and_speed(&self) -> (f64, f64) {
        match &self.grip {
            Grip::Free(_, state) => (state.position(), state.velocity()),
            Grip::Held { state, .. } => (state.position(), state.velocity()),
            Grip::Forced {
                angle_rad,
                rad_per_s,
                ..
            } => (*angle_rad, *rad_per_s),
        }
    }

    /// Lets a simulated hand take hold of the knob. The rest point of its spring is `rest`: the shaft's angle in rad as a function
    /// of the time from now, s.
    ///
    /// # Panics
    /// The hand's parameters are out of range.
    pub fn hold(&mut self, hand: &Hand, rest: impl Fn(f64) -> f64 + 'static) {
        let plant =
            HeldCoulomb::new(&self.knob, hand, seconds(STEP)).expect("the hand is in range");
        let (x, v) = self.angle_and_speed();
        let state = State::from_array([x, v, x, v]);
        self.grip = Grip::Held {
            plant,
            state,
            since: self.now,
            rest: Box::new(rest),
        };
    }

    /// Moves the rest point of the hand's spring: its angle in rad as a function of the time from now, s. Without a hand nothing
    /// changes.
    pub fn lead(&mut self, to: impl Fn(f64) -> f64 + 'static) {
        if let Grip::Held { since, rest, .. } = &mut self.grip {
            *since = self.now;
            *rest = Box::new(to);
        }
    }

    /// Rest point of the hand's spring, rad; `None` if no hand holds the knob.
    #[must_use]
    pub fn rest_rad(&self) -> Option<f64> {
        match &self.grip {
            Grip::Held { since, rest, .. } => Some(rest(seconds(self.now - since))),
            _ => None,
        }
    }

    /// Starts the energy balance of the shaft.
    pub fn keep_books(&mut self) {
        self.books = Some(ShaftBooks::default());
    }

    /// The energy balance of the shaft at the last mechanical step; all values are 0 if it was not started.
    #[must_use]
    pub fn books(&self) -> ShaftBooks {
        self.books.unwrap_or_default()
    }

    /// Lets the simulated hand release the knob.
    ///
    /// # Panics
    /// Never: the constants are in range.
    pub fn release(&mut self) {
        let plant = BareCoulomb::new(&self.knob, seconds(STEP)).expect("the knob is in range");
        let (x, v) = self.angle_and_speed();
        self.grip = Grip::Free(plant, State::from_array([x, v]));
    }

    /// Lets the encoder's magnet slip on the shaft by this electrical angle of the motor, rad. No current may flow meanwhile.
    pub fn slip(&mut self, electrical_rad: f64) {
        self.mount(MotorParameters {
            electrical_zero_rad: self.motor.electrical_zero_rad + electrical_rad,
            ..self.motor
        });
    }

    /// Mounts another motor. No current may flow meanwhile.
    pub fn mount(&mut self, motor: MotorParameters) {
        self.motor = motor;
        self.windings = Windings::new(motor, seconds(STEP));
    }

    /// Turns the shaft from outside at this speed, against any torque of the motor; 0 holds the shaft.
    pub fn force(&mut self, rad_per_s: f64) {
        let (angle_rad, _) = self.angle_and_speed();
        self.grip = Grip::Forced {
            angle_rad,
            rad_per_s,
            reverses: None,
        };
    }

    /// Turns the shaft from outside to and fro at this speed, each way for this number of cycles.
    pub fn shake(&mut self, rad_per_s: f64, cycles: u64) {
        self.force(rad_per_s);
        if let Grip::Forced { reverses, .. } = &mut self.grip {
            let steps = cycles / STEP;
            *reverses = Some((steps, steps));
        }
    }

    /// Sets how the power bridge drives each phase from now on: the duty cycle (0 to 1), or `None` for off.
    pub fn drive(&mut self, now: u64, duty: [Option<f64>; 3]) {
        self.advance(now);
        self.drive = match duty {
            [Some(a), Some(b), Some(c)] => {
                Drive::On([a, b, c].map(|part| (part * f64::from(TOP)).round() as u16))
            }
            _ => Drive::Off,
        };
    }

    /// Simulates up to the time `until`, in processor cycles.
    pub fn advance(&mut self, until: u64) {
        while self.now < until {
            let next = self.step_at.min(until);
            let interval = seconds(next - self.now);
            let (angle, speed) = (self.angle_rad(), self.angle_and_speed().1);
            let mut windings = self.windings.with_interval(interval);
            let torque = match self.drive {
                Drive::Off => windings.freewheel(self.bridge.bus_v, self.bridge.diode_v, angle),
                Drive::On(duties) => {
                    let volts = self.bridge.voltages(duties, windings.currents_a());
                    windings.step(volts, angle, speed)
                }
            };
            self.windings = windings;
            self.impulse += torque * interval;
            self.now = next;
            if self.now == self.step_at {
                self.move_knob();
                self.step_at += STEP;
            }
        }
    }

    fn move_knob(&mut self) {
        self.torque_n_m = std::mem::take(&mut self.impulse) / seconds(STEP);
        let (cogging, from) = (self.cogging_n_m(), self.angle_and_speed().0);
        let (now, torque) = (self.now, self.torque_n_m + cogging);
        let keeps = self.books.is_some();
        let port = match &mut self.grip {
            Grip::Free(plant, state) => step(plant, state, torque, 0.0, keeps),
            Grip::Held {
                plant,
                state,
                since,
                rest,
            } => step(plant, state, torque, rest(seconds(now - *since)), keeps),
            Grip::Forced {
                angle_rad,
                rad_per_s,
                reverses,
            } => {
                if let Some((steps, left)) = reverses {
                    if *left == 0 {
                        *rad_per_s = -*rad_per_s;
                        *left = *steps;
                    }
                    *left -= 1;
                }
                *angle_rad += *rad_per_s * seconds(STEP);
                Port::default()
            }
        };
        let (angle_rad, rad_per_s) = self.angle_and_speed();
        if let Some(books) = &mut self.books {
            *books = ShaftBooks {
                angle_rad,
                rad_per_s,
                impulse_n_m_s: books.impulse_n_m_s + self.torque_n_m * seconds(STEP),
                motor_j: books.motor_j + port.work_j - cogging * (angle_rad - from),
                loss_j: books.loss_j + port.loss.device_j,
            };
        }
    }

    /// Torque of the cogging at the last mechanical step, N·m.
    #[must_use]
    pub fn cogging_n_m(&self) -> f64 {
        let (angle, _) = self.angle_and_speed();
        self.cogging.iter().map(|it| it.torque(angle)).sum()
    }

    /// Angle of the shaft, rad.
    #[must_use]
    pub fn angle_rad(&self) -> f64 {
        let (angle, speed) = self.angle_and_speed();
        angle + speed * seconds(self.now - (self.step_at - STEP))
    }

    /// Angle that the encoder reports, turns.
    #[must_use]
    pub fn encoder_turns(&self) -> f64 {
        self.sensors.shown_turns(self.angle_rad())
    }

    /// Current into a phase of the motor, A.
    #[must_use]
    pub fn current_a(&self, phase: usize) -> f64 {
        self.windings.currents_a()[phase]
    }

    /// Mean torque of the motor on the shaft over the last simulation step, N·m.
    #[must_use]
    pub fn torque_n_m(&self) -> f64 {
        self.torque_n_m
    }

    /// Current in A from a phase's transistors into everything connected to the phase: the winding and a short circuit.
    #[must_use]
    pub fn leg_a(&self, phase: usize) -> f64 {
        let short = self.short.filter(|short| short.phase == phase);
        self.current_a(phase) + short.map_or(0.0, |short| short.current_a)
    }

    /// Advances a short circuit's current to the time `now`, with the given states of the transistors.
    pub fn advance_short(&mut self, now: u64, legs: [Leg; 3]) {
        let (bus_v, diode_v) = (self.bridge.bus_v, self.bridge.diode_v);
        if let Some(short) = &mut self.short {
            short.advance(now, legs[short.phase], bus_v, diode_v);
        }
    }

    /// Whether a phase current is high enough for the gate drivers' own protection to act.
    #[must_use]
    pub fn hardware_over_current(&self) -> bool {
        (0..3).any(|phase| self.leg_a(phase).abs() > self.break_a)
    }
}
