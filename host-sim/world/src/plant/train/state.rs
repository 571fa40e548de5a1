//! What changes in a tick of a drive train.

use crate::plant::state::Kinematics;

/// State of a drive train: pairs of angle and velocity, `[x, v]` of the motor's shaft first, then those of the knob behind a
/// transmission and of the hand, as far as there are any, and last, where `N` is odd, the motor's torque; rad, rad/s, N·m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrainState<const N: usize> {
    pub(super) z: [f64; N],
    /// Mean deflection of the bristles of LuGre friction, rad; 0 without it.
    pub(super) bristle: f64,
}

impl<const N: usize> TrainState<N> {
    /// The state with these entries, and bristles at ease.
    #[must_use]
    pub const fn from_array(entries: [f64; N]) -> Self {
        Self {
            z: entries,
            bristle: 0.0,
        }
    }

    /// The entries, in the order given at [`TrainState`].
    #[must_use]
    pub const fn to_array(self) -> [f64; N] {
        self.z
    }

    /// Deflection of the bristles, rad.
    #[must_use]
    pub const fn bristle_rad(&self) -> f64 {
        self.bristle
    }

    /// Device and hand at these angles and velocities, without torque; a knob behind a transmission moves with the device.
    #[must_use]
    pub fn moving(device: [f64; 2], hand: [f64; 2]) -> Self {
        let mut state = Self::from_array([0.0; N]);
        let last = Self::LAST_PAIR;
        for pair in (0..=last).step_by(2) {
            let [x, v] = if pair == last && last > 0 {
                hand
            } else {
                device
            };
            (state.z[pair], state.z[pair + 1]) = (x, v);
        }
        state
    }

    /// Where the last pair begins.
    const LAST_PAIR: usize = (N / 2 - 1) * 2;

    /// Angle and velocity of the last pair.
    #[inline(always)]
    pub(super) fn hand(&self) -> [f64; 2] {
        [self.z[Self::LAST_PAIR], self.z[Self::LAST_PAIR + 1]]
    }
}

impl<const N: usize> Kinematics for TrainState<N> {
    fn at_rest(position: f64) -> Self {
        Self::moving([position, 0.0], [position, 0.0])
    }

    #[inline(always)]
    fn position(&self) -> f64 {
        self.z[0]
    }

    #[inline(always)]
    fn velocity(&self) -> f64 {
        self.z[1]
    }

    #[inline(always)]
    fn hand_position(&self) -> f64 {
        self.hand()[0]
    }

    #[inline(always)]
    fn hand_velocity(&self) -> f64 {
        self.hand()[1]
    }
}
