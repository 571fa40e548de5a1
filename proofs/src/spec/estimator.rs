//! Specification tick of the state estimator: read it beside the equations in the header of `control/src/estimator/mod.rs`.
//!
//! States are displacements with 54 fractional bits. What a state is multiplied with is a weight, and of the state the leading
//! digits are multiplied, its part: 28 fractional bits of a motion, 24 of a torque. A weight has what is missing to 54, so every
//! product is a state without any rounding.

use super::{Int, signal};

/// One radian, as a state.
pub const RAD: Int = 1 << 54;
/// Digits of a motion's state below its part.
const BELOW_PART: u32 = 54 - 28;
/// Digits of a state that a signal does not show.
const BELOW_SIGNAL: u32 = 54 - 24;
/// Commands that are remembered.
pub const REMEMBERED: usize = 3;

/// Weight times part; [`crate::weighed`] says what the checker puts in its place.
#[must_use]
pub fn weighed(weight: Int, part: Int) -> Int {
    weight * part
}

/// Position `x`, displacement per tick `d`, push of the hand `g`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Motion {
    /// `x`.
    pub x: Int,
    /// `d`.
    pub d: Int,
    /// `g`.
    pub g: Int,
}

/// A time, as weights: `V`, `X`, `1 - ρ`, and of each command `q x_i` and `q v_i`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Flow<const COMMANDS: usize> {
    /// Reach: `V`.
    pub reach: Int,
    /// Drift: `X`.
    pub drift: Int,
    /// Loss: `1 - ρ`.
    pub loss: Int,
    /// `q x_i`, `q v_i`.
    pub commands: [[Int; 2]; COMMANDS],
}

impl<const COMMANDS: usize> Flow<COMMANDS> {
    /// `x + V d + X g - Σ q x_i f_i` and `ρ d + V g - Σ q v_i f_i`.
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

/// Coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Estimator {
    /// From sample to sample.
    pub tick: Flow<REMEMBERED>,
    /// The motion from the sample to when the next command begins to act.
    pub ahead: Flow<2>,
    /// `α`, `β`, `γ`.
    pub correction: [Int; 3],
    /// Largest command.
    pub limit: Int,
}

/// Memory: the motion at the last sample, and the last commands, the latest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// `None` before the first sample.
    pub motion: Option<Motion>,
    /// The commands in quanta of a signal.
    pub commands: [Int; REMEMBERED],
}

/// The state of a signal.
#[must_use]
pub fn state(of: Int) -> Int {
    of << BELOW_SIGNAL
}

/// The signal nearest to a state, halves up; at the end of the format it stays there.
#[must_use]
pub fn shown(state: Int) -> Int {
    signal((state + (1 << (BELOW_SIGNAL - 1))) >> BELOW_SIGNAL)
}

/// Whether a state is within this many radians, the lower end included.
#[must_use]
pub fn within(state: Int, rad: Int) -> bool {
    -rad * RAD <= state && state < rad * RAD
}

/// `x = x⁻ + α r`, `d = d⁻ + β r`, `g = g + γ r` with `r = e - x⁻`; nothing where no device moves like that.
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
    /// The motion at the end of a tick's flow, corrected.
    #[must_use]
    pub fn corrected(&self, before: Motion, f: [Int; REMEMBERED], e: Int) -> Option<Motion> {
        corrected(self.correction, self.tick.end(before, f), before.g, e)
    }

    /// One tick at a measured position: the memory, and position and displacement at the time when the next command begins to act.
    #[must_use]
    pub fn tick(&self, memory: &Memory, e: Int) -> (Memory, Int, Int) {
        let corrected = match memory.motion {
            Some(before) => self.corrected(before, memory.commands, e),
            None => None,
        };
        // Anew: at rest where it was measured.
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

    /// The memory after a force was commanded.
    #[must_use]
    pub fn commanded(&self, memory: &Memory, force: Int) -> Memory {
        let [last, before, _] = memory.commands;
        Memory {
            motion: memory.motion,
            commands: [force.clamp(-self.limit, self.limit), last, before],
        }
    }
}
