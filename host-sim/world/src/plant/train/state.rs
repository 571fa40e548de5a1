//! The state of a drive train, which each simulated interval changes.

use crate::plant::state::Kinematics;

/// State of a drive train: pairs of angle and velocity, rad and rad/s. The first pair is that of the motor's shaft. The pairs of
/// the knob behind a transmission and of the hand follow, if present. If `N` is odd, the last entry is the motor's torque, N·m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrainState<const N: usize> {
    pub(super) z: [f64; N],
    /// Mean deflection of the bristles of LuGre friction, rad; 0 with other friction.
    pub(super) bristle: f64,
}

impl<const N: usize> TrainState<N> {
    /// The state with these entries and undeflected bristles.
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

    /// Mean deflection of the bristles of LuGre friction, rad.
    #[must_use]
    pub const fn bristle_rad(&self) -> f64 {
        self.bristle
    }

    /// State with device and hand at the given angles and velocities, without motor torque. A knob behind a transmission moves with
    /// the device.
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

    /// Index of the last pair of angle and velocity.
    const LAST_PAIR: usize = (N / 2 - 1) * 2;

    /// Angle and velocity of the last body in the state, which is the hand if there is one.
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
