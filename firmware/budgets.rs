//! Limits for the number of instructions or cycles of each part of a control period on the microcontroller, a Cortex-M4F at 170
//! MHz. `cargo xtask thumb` and `cargo xtask cycles` read this file and fail if a program exceeds a limit.

/// Largest allowed number of instructions of one run of the enhanced control law alone, for any input.
///
/// The goal is 600 (3.5 us at an instruction per cycle). The law exceeds it because it counts the energy of its virtual mass and
/// bounds its offset by the force limit. `docs/figures.md` has the measured worst case of each part.
pub const ENHANCED: u64 = 720;

/// Largest allowed number of instructions of one control period on three axes. The parts are: surface point, force vector from one
/// control law per axis, friction, energy guard.
///
/// The worst case has the damper of the enhanced law. The limit leaves room for other compilers.
pub const SPACE: u64 = 2_620;

/// Largest allowed number of instructions of the control law with its estimator and the energy guard in one control period: 5 us at
/// an instruction per cycle.
pub const LAW: u64 = 850;

/// Largest allowed number of instructions of the control interrupt, in any state and with any fault: 20.6 us at an instruction per
/// cycle.
///
/// At the fastest control rate, 10 kHz, a control period has 100 us. The control interrupt and two runs of the current loop take 31
/// us of it. The limit leaves room for other compilers.
///
/// The limit includes storing and queueing the last period's record, which the interrupt does while the encoder's frames are on
/// the bus.
pub const CONTROL: u64 = 3_500;

/// Largest allowed number of instructions of the control interrupt with the largest feel. Up to 9 kHz, control interrupt and current
/// loop then keep [`PROCESSOR_PERCENT`]. The limit leaves room for other compilers.
pub const FEEL: u64 = 7_000;

/// Largest part of the processor's time, in %, that control interrupt and current loop may take at 10 kHz if every run takes its
/// longest time. Checked on chips whose interrupts run from memory without wait states. The counted cycles include the wait
/// states of the remaining code in flash.
pub const PROCESSOR_PERCENT: u64 = 80;

/// Largest allowed number of instructions of one run of the current loop: 5.3 us of each PWM period of 50 us.
pub const CURRENT: u64 = 900;
