//! Specification of a tick of the state estimator. Read it beside the equations in the header of `control/src/estimator/mod.rs`.
//!
//! States are displacements with 54 fractional bits. A weight is a factor of a state. Only the leading digits of a state, its
//! *part*, are multiplied: 28 fractional bits of a motion, 24 of a torque. A weight has the fractional bits that are missing to 54,
//! so every product is a state without rounding.

use super::{Int, signal};

/// One radian, with the 54 fractional bits of a state.
pub const RAD: Int = 1 << 54;
/// Number of binary digits of a motion's state below its part, the digits that are multiplied.
const BELOW_PART: u32 = 54 - 28;
/// Number of binary digits of a state that a position or force does not have.
const BELOW_SIGNAL: u32 = 54 - 24;
/// Number of past commands that the estimator remembers.
pub const REMEMBERED: usize = 3;

/// Product of a weight (coefficient) and a part (leading digits of a state). When the model checker runs, [`crate::weighed`]
/// replaces it.
#[must_use]
pub fn weighed(weight: Int, part: Int) -> Int {
    weight * part
}

/// The estimated motion: position `x`, displacement per tick `d`, and the hand's push `g` as an acceleration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Motion {
    /// Estimated position.
    pub x: Int,
    /// Estimated displacement per tick.
    pub d: Int,
    /// Push of the hand as an acceleration: by how much it changes the displacement per tick in one tick.
    pub g: Int,
}

/// How a motion evolves over a time, as weights of the displacement, the hand's push and the commanded forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Flow<const COMMANDS: usize> {
    /// Weight of the displacement per tick in the position at the end of the time.
    pub reach: Int,
    /// Weight of the hand's push in the position at the end of the time.
    pub drift: Int,
    /// Fraction of the velocity that damping takes over the time.
    pub loss: Int,
    /// For each command, its weights in position and in displacement per tick.
    pub commands: [[Int; 2]; COMMANDS],
}

impl<const COMMANDS: usize> Flow<COMMANDS> {
    /// Position and displacement per tick at the end of the time, from the motion `from` and the commands `f`.
    #[must_use]
    pub fn end(&self, from: Motion, f: [Int; REMEMBERED]) -> (Int, Int) {
        let (d, g) = (from.d >> BELOW_PART, from.g >> BELOW_PART);
        let mut x = from.x + weighed(self.reach, d) + weighed(self.drift, g);
        let mut moved = from.d - weighed(self.loss, d) + weighed(self.reach, g);
        let mut i = 0;
        while i < COMMANDS {
            let [of_position, of_velocity] = self.commands[i];
            x -= weighed(of_position, f[i]);
            moved -= weighed(of_velocity, f[i]);
            i += 1;
        }
        (x, moved)
    }
}

/// Coefficients of the estimator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Estimator {
    /// Prediction of the motion from one sample to the next.
    pub tick: Flow<REMEMBERED>,
    /// Prediction of the motion from a sample to the time at which the next command begins to act.
    pub ahead: Flow<2>,
    /// Gains by which the difference between measured and predicted position corrects the estimates of position, displacement and
    /// the hand's push.
    pub correction: [Int; 3],
    /// Largest command, in steps of the force format.
    pub limit: Int,
}

/// The estimator's memory: the motion at the last sample, and the last commands with the latest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Motion at the last sample; `None` before the first sample.
    pub motion: Option<Motion>,
    /// The last commands in steps of the force format, the latest first.
    pub commands: [Int; REMEMBERED],
}

/// Converts a position or force to the 54 fractional bits of a state.
#[must_use]
pub fn state(of: Int) -> Int {
    of << BELOW_SIGNAL
}

/// The position or force nearest to a state, halves rounded up, limited to the range of the format.
#[must_use]
pub fn shown(state: Int) -> Int {
    signal((state + (1 << (BELOW_SIGNAL - 1))) >> BELOW_SIGNAL)
}

/// Whether a state is within this many radians of 0, the lower end included.
#[must_use]
pub fn within(state: Int, rad: Int) -> bool {
    -rad * RAD <= state && state < rad * RAD
}

/// The motion after a measured position `e`. Position `x`, displacement `d` and the hand's push `g` are corrected by the difference
/// of measured and predicted position times their gains. `None` if no device can move like that.
#[must_use]
pub fn corrected(gains: [Int; 3], (x, d): (Int, Int), g: Int, e: Int) -> Option<Motion> {
    let r = state(e) - x;
    if !within(r, 8) {
        return None;
    }
    let r = r >> BELOW_PART;
    let [alpha, beta, gamma] = gains;
    let after = Motion {
        x: x + weighed(alpha, r),
        d: d + weighed(beta, r),
        g: g + weighed(gamma, r),
    };
    (within(after.d, 4) && within(after.g, 4)).then_some(after)
}

impl Estimator {
    /// The motion at the end of a tick, corrected by the measured position `e`.
    #[must_use]
    pub fn corrected(&self, before: Motion, f: [Int; REMEMBERED], e: Int) -> Option<Motion> {
        corrected(self.correction, self.tick.end(before, f), before.g, e)
    }

    /// One tick at a measured position `e`. Returns the memory, and position and displacement at the time when the next command
    /// begins to act.
    #[must_use]
    pub fn tick(&self, memory: &Memory, e: Int) -> (Memory, Int, Int) {
        let corrected = match memory.motion {
            Some(before) => self.corrected(before, memory.commands, e),
            None => None,
        };
        // Restart: at rest at the measured position.
        let motion = corrected.unwrap_or(Motion {
            x: state(e),
            d: 0,
            g: 0,
        });
        let (x, d) = self.ahead.end(motion, memory.commands);
        let after = Memory {
            motion: Some(motion),
            commands: memory.commands,
        };
        (after, shown(x), shown(d))
    }

    /// The estimator's memory after a force was commanded.
    #[must_use]
    pub fn commanded(&self, memory: &Memory, force: Int) -> Memory {
        let [last, before, _] = memory.commands;
        Memory {
            motion: memory.motion,
            commands: [force.clamp(-self.limit, self.limit), last, before],
        }
    }
}
