//! The linear parts of a drive train and their equations.
//!
//! The drive vector of a train with `N` states has `N + 4` entries: the states, then four values that are held during a substep.
//! These are the commanded torque, the hand's rest point, the torque that the transmission's play removes, and further torque on
//! the motor's shaft.

use nalgebra::SMatrix;

use crate::plant::device::{Device, Invalid, not_negative, positive};
use crate::plant::hand::Hand;

/// Index of the commanded torque in the drive vector, counted after the states.
pub(super) const TORQUE: usize = 0;
/// Index of the hand's rest point in the drive vector, counted after the states.
pub(super) const REST: usize = 1;
/// Index of the torque that the transmission's play removes (positive on the motor, negative on the knob), counted after the
/// states.
pub(super) const GAP: usize = 2;
/// Index of the further torque on the motor's shaft in the drive vector, counted after the states.
pub(super) const SHAFT: usize = 3;

/// A motor current that follows its command with one pole, as torque: `tau' = 2 pi f (u - tau - D v)`.
///
/// A current loop has its bandwidth `f` and `D = 0`. Windings that are driven by a voltage have `f = R/(2 pi L)` and the damping
/// `D` of their back-EMF. With brushes, `D = k_t^2/R`. With three phases, `D = k_t^2/(1.5 R)`, where `k_t` is for an amplitude of 1
/// A and `R` is that of a phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Current {
    /// Bandwidth `f`, Hz; above zero.
    pub bandwidth_hz: f64,
    /// Damping `D` of the back-EMF, N·m·s/rad; zero or more.
    pub back_emf: f64,
}

impl Current {
    /// Rate of the pole `2 pi f`, 1/s.
    #[must_use]
    pub fn rate(&self) -> f64 {
        std::f64::consts::TAU * self.bandwidth_hz
    }
}

/// A compliant transmission between the motor's shaft and a knob.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transmission {
    /// Stiffness `k_t`, N·m/rad; above zero.
    pub stiffness: f64,
    /// Damping `c_t`, N·m·s/rad; zero or more.
    pub damping: f64,
    /// Inertia of the knob, kg·m²; above zero and below the device's inertia, which includes it.
    pub knob_inertia: f64,
    /// Play of the transmission, rad: the spring transmits no torque within half of it to either side. Zero or more.
    pub gap: f64,
}

impl Transmission {
    /// Torque that the play removes at this twist, N·m: that of a spring without play minus that of the spring with it.
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

/// The linear parts of a drive train.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Links {
    /// Inertia of everything that turns with the knob, and damping at the motor's shaft. The device's friction is ignored: a train
    /// has its friction in [`Shaft`](super::Shaft).
    pub device: Device,
    /// The current's lag; `None`: the torque equals the command.
    pub current: Option<Current>,
    /// The transmission; `None`: knob and motor are one body.
    pub transmission: Option<Transmission>,
    /// The hand; `None` if nobody holds the knob.
    pub hand: Option<Hand>,
}

impl Links {
    /// Number of linear states.
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

    /// The matrix `A` in `z' = A z + …`, e.g. to calculate its eigenvalues.
    ///
    /// # Errors
    /// [`Invalid`] when a value is out of range, or when the links do not have `N` states.
    pub fn matrix<const N: usize, const K: usize>(&self) -> Result<SMatrix<f64, N, N>, Invalid> {
        let made = assemble::<N, K>(self)?;
        Ok(made.matrix.fixed_view::<N, N>(0, 0).into_owned())
    }
}

/// The linear equations `y' = M y` of the drive vector `y`, and powers as its quadratic forms.
pub(super) struct Assembled<const K: usize> {
    pub matrix: SMatrix<f64, K, K>,
    pub device_loss: SMatrix<f64, K, K>,
    pub hand_loss: SMatrix<f64, K, K>,
    pub motor_power: SMatrix<f64, K, K>,
}

/// Adds `factor (e_a - e_b)(e_a - e_b)^T` to a quadratic form.
fn add_slip<const K: usize>(form: &mut SMatrix<f64, K, K>, factor: f64, a: usize, b: usize) {
    form[(a, a)] += factor;
    form[(b, b)] += factor;
    form[(a, b)] -= factor;
    form[(b, a)] -= factor;
}

/// Adds a spring with a damper between two bodies to the equations. The indices are those of the bodies' angles; the velocities
/// follow them.
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
