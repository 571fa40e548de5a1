//! The linear parts of a drive train (motor current, transmission, hand) and their equations of motion.
//!
//! The drive vector of a train with `N` states has `N + 4` entries: the states, then four values that are held during a substep.
//! These values are the commanded torque, the hand's rest point, the torque that the transmission's play removes, and any further
//! torque on the motor's shaft.

use nalgebra::SMatrix;

use crate::plant::device::{Device, Invalid, not_negative, positive};
use crate::plant::hand::Hand;

/// Index of the commanded torque in the drive vector, counted after the states.
pub(super) const TORQUE: usize = 0;
/// Index of the hand's rest point in the drive vector, counted after the states.
pub(super) const REST: usize = 1;
/// Index in the drive vector, counted after the states, of the torque that the transmission's play removes (positive on the motor,
/// negative on the knob).
pub(super) const GAP: usize = 2;
/// Index in the drive vector, counted after the states, of any further torque on the motor's shaft.
pub(super) const SHAFT: usize = 3;

/// Motor torque `tau` that follows its command `u` with a lag of first order: `tau' = 2 pi f (u - tau - D v)`. `f` is the
/// bandwidth, `v` the velocity of the shaft, `D` the damping by the back-EMF.
///
/// A current controller has its bandwidth `f` and `D = 0`. Windings driven by a voltage have `f = R/(2 pi L)` with phase resistance
/// `R` and inductance `L`. With brushes their damping is `D = k_t^2/R`, with the torque constant `k_t`. With three phases it is `D
/// = k_t^2/(1.5 R)`, where `k_t` is for an amplitude of 1 A.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Current {
    /// Bandwidth of the lag, Hz; above zero.
    pub bandwidth_hz: f64,
    /// Damping `D` of the back-EMF, N·m·s/rad; zero or more.
    pub back_emf: f64,
}

impl Current {
    /// Rate of the lag, `2 pi f` for the bandwidth `f`, 1/s.
    #[must_use]
    pub fn rate(&self) -> f64 {
        std::f64::consts::TAU * self.bandwidth_hz
    }
}

/// A compliant transmission between the motor's shaft and a knob.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transmission {
    /// Stiffness of the transmission, N·m/rad; above zero.
    pub stiffness: f64,
    /// Damping of the transmission, N·m·s/rad; zero or more.
    pub damping: f64,
    /// Inertia of the knob, kg·m²; above zero and below the device's inertia, which includes it.
    pub knob_inertia: f64,
    /// Play of the transmission, rad, zero or more. While the twist is within half the play to either side, the spring transmits no
    /// torque.
    pub gap: f64,
}

impl Transmission {
    /// Torque that the play removes at this twist in rad, N·m: torque of a spring without play minus torque of the spring with
    /// play.
    #[inline(always)]
    pub(super) fn free_play_torque(&self, twist: f64) -> f64 {
        self.stiffness * twist.clamp(-0.5 * self.gap, 0.5 * self.gap)
    }

    /// Energy stored in the transmission's spring at this twist, J.
    pub(super) fn spring_energy_j(&self, twist: f64) -> f64 {
        let beyond = (twist.abs() - 0.5 * self.gap).max(0.0);
        0.5 * self.stiffness * beyond * beyond
    }
}

/// The linear parts of a drive train: device, motor current, transmission and hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Links {
    /// Device with the inertia of everything that turns with the knob, and the damping at the motor's shaft. The device's friction
    /// is ignored: a drive train has its friction in [`Shaft`](super::Shaft).
    pub device: Device,
    /// Lag of the motor's torque; `None`: the torque equals the command.
    pub current: Option<Current>,
    /// The transmission; `None`: knob and motor are one body.
    pub transmission: Option<Transmission>,
    /// The hand; `None` if nobody holds the knob.
    pub hand: Option<Hand>,
}

impl Links {
    /// Number of linear states of the drive train.
    #[must_use]
    pub fn states(&self) -> usize {
        let pairs = 1 + usize::from(self.transmission.is_some()) + usize::from(self.hand.is_some());
        2 * pairs + usize::from(self.current.is_some())
    }

    /// Play of the transmission, rad; zero without a transmission.
    pub(super) fn gap(&self) -> f64 {
        self.transmission
            .map_or(0.0, |transmission| transmission.gap)
    }

    fn validate(&self) -> Result<(), Invalid> {
        self.device.validate()?;
        if let Some(current) = &self.current {
            positive("bandwidth_hz", current.bandwidth_hz)?;
            not_negative("back_emf", current.back_emf)?;
        }
        if let Some(transmission) = &self.transmission {
            positive("transmission.stiffness", transmission.stiffness)?;
            not_negative("transmission.damping", transmission.damping)?;
            not_negative("transmission.gap", transmission.gap)?;
            positive("transmission.knob_inertia", transmission.knob_inertia)?;
            positive(
                "transmission.knob_inertia",
                self.device.inertia - transmission.knob_inertia,
            )?;
        }
        self.hand.map_or(Ok(()), |hand| hand.validate())
    }

    /// Matrix `A` of the state's rates, 1/s: `z' = A z + …` for the state `z`. Its eigenvalues are the poles of the drive train.
    ///
    /// # Errors
    /// [`Invalid`] when a value is out of range, or when the links do not have `N` states.
    pub fn matrix<const N: usize, const K: usize>(&self) -> Result<SMatrix<f64, N, N>, Invalid> {
        let made = assemble::<N, K>(self)?;
        Ok(made.matrix.fixed_view::<N, N>(0, 0).into_owned())
    }
}

/// Linear equations `y' = M y` of the drive vector `y`, and dissipated powers as quadratic forms of `y`.
pub(super) struct Assembled<const K: usize> {
    pub matrix: SMatrix<f64, K, K>,
    pub device_loss: SMatrix<f64, K, K>,
    pub hand_loss: SMatrix<f64, K, K>,
    pub motor_power: SMatrix<f64, K, K>,
}

/// Adds `factor (y_a - y_b)²` to a quadratic form of the vector `y`, such as the power of a damper between two bodies.
fn add_slip<const K: usize>(form: &mut SMatrix<f64, K, K>, factor: f64, a: usize, b: usize) {
    form[(a, a)] += factor;
    form[(b, b)] += factor;
    form[(a, b)] -= factor;
    form[(b, a)] -= factor;
}

/// Adds a spring with a damper between two bodies to the equations. The two indices are those of the bodies' angles in the state;
/// each velocity follows its angle.
fn couple<const K: usize>(
    matrix: &mut SMatrix<f64, K, K>,
    [stiffness, damping]: [f64; 2],
    [(a, inertia_a), (b, inertia_b)]: [(usize, f64); 2],
) {
    for (own, inertia, other) in [(a, inertia_a, b), (b, inertia_b, a)] {
        matrix[(own + 1, own)] -= stiffness / inertia;
        matrix[(own + 1, other)] += stiffness / inertia;
        matrix[(own + 1, own + 1)] -= damping / inertia;
        matrix[(own + 1, other + 1)] += damping / inertia;
    }
}

pub(super) fn assemble<const N: usize, const K: usize>(
    links: &Links,
) -> Result<Assembled<K>, Invalid> {
    links.validate()?;
    if links.states() != N || N + 4 != K {
        return Err(Invalid {
            field: "states",
            value: N as f64,
            needs: "as many as the links have",
        });
    }
    let mut matrix = SMatrix::<f64, K, K>::zeros();
    let mut device_loss = SMatrix::<f64, K, K>::zeros();
    let mut hand_loss = SMatrix::<f64, K, K>::zeros();
    let mut motor_power = SMatrix::<f64, K, K>::zeros();
    let knob_inertia = links.transmission.map_or(0.0, |it| it.knob_inertia);
    let motor_inertia = links.device.inertia - knob_inertia;
    let mut angle = 0;
    while angle + 1 < N {
        matrix[(angle, angle + 1)] = 1.0;
        angle += 2;
    }
    matrix[(1, 1)] -= links.device.damping / motor_inertia;
    device_loss[(1, 1)] += links.device.damping;
    matrix[(1, N + SHAFT)] = 1.0 / motor_inertia;
    match links.current {
        None => matrix[(1, N + TORQUE)] = 1.0 / motor_inertia,
        Some(current) => {
            let torque = N - 1;
            matrix[(1, torque)] = 1.0 / motor_inertia;
            matrix[(torque, torque)] = -current.rate();
            matrix[(torque, 1)] = -current.rate() * current.back_emf;
            matrix[(torque, N + TORQUE)] = current.rate();
            motor_power[(1, torque)] = 0.5;
            motor_power[(torque, 1)] = 0.5;
        }
    }
    // Index of the body that the hand holds, and the body's inertia.
    let mut held = (0, motor_inertia);
    if let Some(transmission) = &links.transmission {
        let knob = (2, knob_inertia);
        let given = [transmission.stiffness, transmission.damping];
        couple(&mut matrix, given, [held, knob]);
        add_slip(&mut device_loss, transmission.damping, 1, 3);
        matrix[(1, N + GAP)] = 1.0 / motor_inertia;
        matrix[(3, N + GAP)] = -1.0 / knob_inertia;
        held = knob;
    }
    if let Some(hand) = &links.hand {
        let at = held.0 + 2;
        let pad = [hand.pad_stiffness, hand.pad_damping];
        couple(&mut matrix, pad, [held, (at, hand.inertia)]);
        matrix[(at + 1, at)] -= hand.stiffness / hand.inertia;
        matrix[(at + 1, N + REST)] = hand.stiffness / hand.inertia;
        matrix[(at + 1, at + 1)] -= hand.damping / hand.inertia;
        add_slip(&mut hand_loss, hand.pad_damping, held.0 + 1, at + 1);
        hand_loss[(at + 1, at + 1)] += hand.damping;
    }
    Ok(Assembled {
        matrix,
        device_loss,
        hand_loss,
        motor_power,
    })
}
