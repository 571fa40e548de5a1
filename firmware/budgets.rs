//! Limits for the number of instructions or cycles of each part of a control period on the microcontroller, a Cortex-M4F at 170
//! MHz. `cargo xtask thumb` and `cargo xtask cycles` read this file and fail where a program exceeds a limit.

/// Largest allowed number of instructions of one run of the enhanced control law alone, for any input.
///
/// The goal is 600 (3.5 us at an instruction per cycle). The measured worst case is 712. It exceeds the goal because the law counts
/// the energy of its virtual mass and bounds its offset by the force limit.
pub const ENHANCED: u64 = 720;

/// Largest allowed number of instructions of one control period on three axes. The parts are: surface point, force vector from one
/// control law per axis, friction, energy guard.
///
/// Measured worst case: 2,557, with the damper of the enhanced law. The limit leaves room for other compilers.
pub const SPACE: u64 = 2_620;

/// Largest allowed number of instructions of the control law with its estimator and the energy guard in one control period: 5 us at
/// an instruction per cycle.
pub const LAW: u64 = 850;

/// Largest allowed number of instructions of the control interrupt, in any state and with any fault: 20.6 us at an instruction per
/// cycle.
///
/// At the fastest control rate, 10 kHz, a control period has 100 us. The control interrupt and two runs of the current loop take 31
/// us of it. The measured worst case of the control interrupt is 3,484; the limit leaves room for other compilers.
///
/// While the processor waits for the encoder's frames, the interrupt stores and sends the last period's record.
pub const CONTROL: u64 = 3_500;

/// Largest part of the processor's time, in %, that control interrupt and current loop may take at 10 kHz if every run takes its
/// longest time. Checked on chips whose interrupts run from memory without wait states. The cycles include wait states for code
/// that is in flash nevertheless.
pub const PROCESSOR_PERCENT: u64 = 80;

/// Largest allowed number of instructions of one run of the current loop: 5.3 us of each PWM period of 50 us.
pub const CURRENT: u64 = 900;
