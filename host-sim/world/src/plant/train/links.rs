//! What a drive train is made of, and its linear equations.
//!
//! The drive of a train with `N` states has `N + 4` entries: the states, then what is held during a substep: the torque that is
//! commanded, the hand's rest point, the torque that the gap takes off the transmission, and further torque on the motor's shaft.

use nalgebra::SMatrix;

use crate::plant::device::{Device, Invalid, not_negative, positive};
use crate::plant::hand::Hand;

/// The commanded torque's place after the states.
pub(super) const TORQUE: usize = 0;
/// The rest point's.
pub(super) const REST: usize = 1;
/// The gap's torque, `+` on the motor and `-` on the knob.
pub(super) const GAP: usize = 2;
/// Further torque on the motor's shaft.
pub(super) const SHAFT: usize = 3;

/// Current that follows its command with one pole: `tau' = 2 pi f (u - tau - D v)`.
///
/// A current loop has its bandwidth `f` and no `D`. Windings at a voltage in place of a current have `f = R/(2 pi L)` and the
/// damping of their own voltage, `D = k_t^2/R` with brushes; with three phases, `k_t` for an amplitude of 1 A and `R` of a phase, `D = k_t^2/(1.5 R)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Current {
    /// `f`, Hz; above zero.
    pub bandwidth_hz: f64,
    /// `D`, N·m·s/rad; zero or more.
    pub back_emf: f64,
}

impl Current {
    /// `2 pi f`, 1/s.
    #[must_use]
    pub fn rate(&self) -> f64 {
        std::f64::consts::TAU * self.bandwidth_hz
    }
}

/// A transmission that gives, between the motor's shaft and a knob.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transmission {
    /// `k_t`, N·m/rad; above zero.
    pub stiffness: f64,
    /// `c_t`, N·m·s/rad; zero or more.
    pub damping: f64,
    /// Inertia of the knob, kg·m²; above zero and below the device's, of which it is a part.
    pub knob_inertia: f64,
    /// Play in all, rad: nothing is transmitted by the spring within half of it to either side. Zero or more.
    pub gap: f64,
}

impl Transmission {
    /// Torque that the spring would have without play and does not have, N·m.
    #[inline(always)]
    pub(super) fn free_play_torque(&self, twist: f64) -> f64 {
        self.stiffness * twist.clamp(-0.5 * self.gap, 0.5 * self.gap)
    }

    /// Energy in the spring, J.
    pub(super) fn spring_energy_j(&self, twist: f64) -> f64 {
        let beyond = (twist.abs() - 0.5 * self.gap).max(0.0);
        0.5 * self.stiffness * beyond * beyond
    }
}

/// The parts of a drive train.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Links {
    /// Inertia of everything that turns with the knob, and damping at the motor's shaft. Its friction is not read: a train's is in
    /// [`Shaft`](super::Shaft).
    pub device: Device,
    /// Absent: the torque is the command.
    pub current: Option<Current>,
    /// Absent: knob and motor are one.
    pub transmission: Option<Transmission>,
    /// The hand; `None` without one.
    pub hand: Option<Hand>,
}

impl Links {
    /// Linear states.
    #[must_use]
    pub fn states(&self) -> usize {
        let pairs = 1 + usize::from(self.transmission.is_some()) + usize::from(self.hand.is_some());
        2 * pairs + usize::from(self.current.is_some())
    }

    /// Play of the transmission, rad.
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

    /// `A` in `z' = A z + …`, for those who want its eigenvalues.
    ///
    /// # Errors
    /// [`Invalid`] when something is out of range, or when the links do not have `N` states.
    pub fn matrix<const N: usize, const K: usize>(&self) -> Result<SMatrix<f64, N, N>, Invalid> {
        let made = assemble::<N, K>(self)?;
        Ok(made.matrix.fixed_view::<N, N>(0, 0).into_owned())
    }
}

/// The linear equations `y' = M y` of the drive `y`, and powers as quadratic forms of it.
pub(super) struct Assembled<const K: usize> {
    pub matrix: SMatrix<f64, K, K>,
    pub device_loss: SMatrix<f64, K, K>,
    pub hand_loss: SMatrix<f64, K, K>,
    pub motor_power: SMatrix<f64, K, K>,
}

/// Adds `factor (e_a - e_b)(e_a - e_b)^T`.
fn add_slip<const K: usize>(form: &mut SMatrix<f64, K, K>, factor: f64, a: usize, b: usize) {
    form[(a, a)] += factor;
    form[(b, b)] += factor;
    form[(a, b)] -= factor;
    form[(b, a)] -= factor;
}

/// Puts a spring with a damper between two pairs, given by the place of their angles.
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
    // The pair that the hand holds, and its inertia.
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
