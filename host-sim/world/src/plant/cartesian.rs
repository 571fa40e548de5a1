//! A device with three translations, modelled as three independent axes, and the published limits of such a device.
//!
//! In its workspace the effector of a delta robot is to a first approximation a mass that is the same in every direction. The
//! inertia of the linkage varies, and is left out. Each axis is advanced by its own stepper. The step is therefore exact for linear
//! axes, and the energy balance closes as for one axis.

use super::device::{Device, Invalid};
use super::hand::Hand;
use super::held::HeldLinear;
use super::state::{Kinematics, State};
use super::stepper::{Loss, Stepper};

/// Published limits of a device with three translations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest force in any direction, N.
    pub force_n: f64,
    /// Radius of the workspace, m: a cylinder with a vertical axis.
    pub radius_m: f64,
    /// Half of the workspace's height, m.
    pub half_height_m: f64,
    /// Resolution of the measured position along each axis, m.
    pub count_m: f64,
    /// Slowest and fastest control rate, Hz.
    pub rates_hz: (u32, u32),
}

impl Limits {
    /// Limits a commanded force to the largest force of the motors, N. A larger force is scaled down and keeps its direction.
    #[must_use]
    pub fn limited(&self, force_n: [f64; 3]) -> [f64; 3] {
        let length = libm::sqrt(force_n.iter().map(|f| f * f).sum());
        if length <= self.force_n {
            return force_n;
        }
        force_n.map(|f| f * self.force_n / length)
    }

    /// Whether the position is in the workspace.
    #[must_use]
    pub fn reaches(&self, position_m: [f64; 3]) -> bool {
        let [x, y, z] = position_m;
        x * x + y * y <= self.radius_m * self.radius_m && z.abs() <= self.half_height_m
    }

    /// Measured position: the true position in whole steps of the resolution [`Limits::count_m`].
    #[must_use]
    pub fn counts(&self, position_m: [f64; 3]) -> [i32; 3] {
        position_m.map(|x| libm::round(x / self.count_m) as i32)
    }
}

/// The limits of Force Dimension's omega.3: 12 N, a workspace of 160 mm diameter and 110 mm height, positions to 0.01 mm, 1 to 4
/// kHz.
pub const OMEGA3: Limits = Limits {
    force_n: 12.0,
    radius_m: 0.08,
    half_height_m: 0.055,
    count_m: 1e-5,
    rates_hz: (1000, 4000),
};

/// Mass and damping of each axis of an omega.3: 0.148 kg (effector mass in its maker's library), and 2.5 N·s/m (thesis, §5.2).
pub const OMEGA3_AXIS: Device = Device {
    inertia: 0.148,
    damping: 2.5,
    friction: None,
};

/// A firm hand at the effector, for each axis: 0.8 kg, 5.5 N·s/m, 300 N/m, fingertip pad 2000 N/m and 0.5 N·s/m.
///
/// The values are chosen, not measured. The pad's damping is a fifth of the axis' damping, as the pad of [`super::MEDIUM`] has a
/// fifth of the thesis' damping `c_i` of 5e-4 N·m·s/rad.
pub const FIRM_TRANSLATION: Hand = Hand {
    inertia: 0.8,
    damping: 5.5,
    stiffness: 300.0,
    pad_damping: 0.5,
    pad_stiffness: 2000.0,
};

/// A light touch at the effector, for each axis: mass, damping and stiffness of [`super::LIGHT`]. The ratio of its pad damping to
/// that of [`FIRM_TRANSLATION`] is the ratio between the two grips of a knob.
pub const LIGHT_TRANSLATION: Hand = Hand {
    inertia: 0.1,
    damping: 1.0,
    stiffness: 30.0,
    pad_damping: 0.05,
    pad_stiffness: 300.0,
};

/// An ordinary grip at the effector, for each axis, derived from [`super::MEDIUM`] in the same way as [`LIGHT_TRANSLATION`] from
/// the light grip.
pub const MEDIUM_TRANSLATION: Hand = Hand {
    inertia: 0.3,
    damping: 3.0,
    stiffness: 100.0,
    pad_damping: 0.15,
    pad_stiffness: 700.0,
};

/// Three independent axes, each with its own stepper.
#[derive(Debug, Clone, PartialEq)]
pub struct Cartesian<S> {
    axes: [S; 3],
}

impl<S: Stepper> Cartesian<S> {
    /// Combines the steppers of three axes, which must have the same interval.
    ///
    /// # Errors
    /// [`Invalid`] if the intervals differ.
    pub fn new(axes: [S; 3]) -> Result<Self, Invalid> {
        let interval = axes[0].interval_s();
        match axes.iter().find(|axis| axis.interval_s() != interval) {
            None => Ok(Self { axes }),
            Some(other) => Err(Invalid {
                field: "interval_s",
                value: other.interval_s(),
                needs: "the same for all axes",
            }),
        }
    }

    /// States of the three axes for an effector at rest at a position in m.
    #[must_use]
    pub fn at_rest(position: [f64; 3]) -> [S::State; 3] {
        position.map(S::State::at_rest)
    }

    /// Position of the effector, m.
    #[must_use]
    pub fn position(state: &[S::State; 3]) -> [f64; 3] {
        state.map(|axis| axis.position())
    }

    /// Advances by one interval under a force on the effector (N) and a rest point of the hand (m).
    pub fn step(&self, state: &mut [S::State; 3], force: [f64; 3], rest: [f64; 3]) {
        for (i, axis) in self.axes.iter().enumerate() {
            axis.step(&mut state[i], force[i], rest[i]);
        }
    }

    /// Advances the same as [`Cartesian::step`], bit for bit, and returns the dissipated energy.
    pub fn step_with_loss(
        &self,
        state: &mut [S::State; 3],
        force: [f64; 3],
        rest: [f64; 3],
    ) -> Loss {
        let mut loss = Loss::default();
        for (i, axis) in self.axes.iter().enumerate() {
            loss += axis.step_with_loss(&mut state[i], force[i], rest[i]);
        }
        loss
    }

    /// Kinetic energy and energy of the springs of device and hand, J.
    #[must_use]
    pub fn stored_energy_j(&self, state: &[S::State; 3], rest: [f64; 3]) -> f64 {
        (0..3)
            .map(|i| self.axes[i].stored_energy_j(&state[i], rest[i]))
            .sum()
    }
}

impl Cartesian<HeldLinear> {
    /// Makes a device in a hand, with the same parameters along each axis, for intervals of `interval_s` seconds.
    ///
    /// # Errors
    /// [`Invalid`] for a device or hand that is out of range.
    pub fn held(device: &Device, hand: &Hand, interval_s: f64) -> Result<Self, Invalid> {
        let axis = HeldLinear::new(device, hand, interval_s)?;
        Self::new([axis.clone(), axis.clone(), axis])
    }

    /// Position of the hand's mass, m.
    #[must_use]
    pub fn hand(state: &[State<4>; 3]) -> [f64; 3] {
        state.map(|axis| axis.hand_position())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_force_is_shortened_in_its_direction() {
        let force = OMEGA3.limited([30.0, 0.0, 40.0]);
        assert!((force[0] - 7.2).abs() < 1e-12 && (force[2] - 9.6).abs() < 1e-12);
        assert_eq!(OMEGA3.limited([3.0, 4.0, 5.0]), [3.0, 4.0, 5.0]);
        assert!(OMEGA3.reaches([0.05, 0.06, -0.05]) && !OMEGA3.reaches([0.06, 0.06, 0.0]));
        assert_eq!(OMEGA3.counts([1.04e-5, -1.06e-5, 0.02]), [1, -1, 2000]);
    }

    /// Checks that an axis moves like a device with one axis, bit for bit, and that the energy balance of all three closes.
    #[test]
    fn the_axes_are_those_of_one_device_each_and_the_books_close() {
        let plant = Cartesian::held(&OMEGA3_AXIS, &FIRM_TRANSLATION, 2.5e-4).unwrap();
        let axis = HeldLinear::new(&OMEGA3_AXIS, &FIRM_TRANSLATION, 2.5e-4).unwrap();
        let mut state = Cartesian::<HeldLinear>::at_rest([0.01, -0.02, 0.0]);
        let mut alone = state[1];
        let mut worst = 0.0_f64;
        for tick in 0..4000 {
            let t = f64::from(tick) * 2.5e-4;
            let force = [libm::sin(40.0 * t), -2.0 * libm::cos(9.0 * t), 3.0];
            let rest = [0.02, -0.03 + 0.01 * libm::sin(3.0 * t), 0.01];
            let before = (
                plant.stored_energy_j(&state, rest),
                Cartesian::<HeldLinear>::position(&state),
            );
            let loss = plant.step_with_loss(&mut state, force, rest);
            axis.step(&mut alone, force[1], rest[1]);
            let after = Cartesian::<HeldLinear>::position(&state);
            let work: f64 = (0..3).map(|i| force[i] * (after[i] - before.1[i])).sum();
            let books = plant.stored_energy_j(&state, rest) - before.0 + loss.total_j() - work;
            worst = worst.max(books.abs());
        }
        assert_eq!(state[1], alone);
        // Sums of some ten terms of at most 1 J.
        assert!(worst < 1e-14, "{worst}");
    }
}
