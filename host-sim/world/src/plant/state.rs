//! The state of a plant, which each simulated interval changes.

/// Read access to a plant's state, the same for every plant.
pub trait Kinematics: Copy + Send {
    /// A state at rest, with device and hand at one angle and no strain in the fingertip pad.
    fn at_rest(position: f64) -> Self;
    /// Angle `x` of the device (the haptic interaction point), rad (m).
    fn position(&self) -> f64;
    /// Velocity `v` of the device, rad/s (m/s).
    fn velocity(&self) -> f64;
    /// Angle `x_h` of the hand's mass, rad (m); that of the device if there is no hand.
    fn hand_position(&self) -> f64;
    /// Velocity `v_h` of the hand's mass, rad/s (m/s); that of the device if there is no hand.
    fn hand_velocity(&self) -> f64;
}

/// State of a plant: `[x, v]` (angle, velocity) without a hand, `[x, v, x_h, v_h]` with a hand; rad and rad/s.
///
/// Angles are absolute, but only their differences enter the dynamics. Adding an angle to all positions changes nothing except the
/// rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<const N: usize>(pub(super) [f64; N]);

impl<const N: usize> State<N> {
    /// The state with these entries, in the order given at [`State`].
    #[must_use]
    pub const fn from_array(entries: [f64; N]) -> Self {
        Self(entries)
    }

    /// The entries, in the order given at [`State`].
    #[must_use]
    pub const fn to_array(self) -> [f64; N] {
        self.0
    }

    #[inline(always)]
    pub(super) fn add(&mut self, increment: &[f64; N]) {
        for (entry, change) in self.0.iter_mut().zip(increment) {
            *entry += change;
        }
    }
}

impl<const N: usize> Kinematics for State<N> {
    fn at_rest(position: f64) -> Self {
        Self(std::array::from_fn(|index| {
            if index % 2 == 0 { position } else { 0.0 }
        }))
    }

    #[inline(always)]
    fn position(&self) -> f64 {
        self.0[0]
    }

    #[inline(always)]
    fn velocity(&self) -> f64 {
        self.0[1]
    }

    // The last pair of angle and velocity belongs to the hand. If it is the only pair, it belongs to the device.
    #[inline(always)]
    fn hand_position(&self) -> f64 {
        self.0[N - 2]
    }

    #[inline(always)]
    fn hand_velocity(&self) -> f64 {
        self.0[N - 1]
    }
}
