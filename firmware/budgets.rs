//! The most instructions that each part of a control period may take on the microcontroller, a Cortex-M4F at 170 MHz: what
//! `cargo xtask thumb` and `cargo xtask cycles` hold the programs to. Each reads this file.

/// One tick of the enhanced law by itself, for any input. 600 is aimed at, 3.5 us at an instruction a cycle. It took 696 at worst
/// since the energy of the mass that is left behind is paid for, and 712 since the force limit bounds the offset, until that path is
/// shorter.
pub const ENHANCED: u64 = 720;

/// One tick of three axes: surface point, shell, friction and guard. A law an axis is the worst. 2,500 was aimed at; it takes 2,557
/// since the enhanced law has a damper.
/// Another compiler may take some more.
pub const SPACE: u64 = 2_620;

/// Bound for everything that the law's side of a control tick may run: the law, its estimator and the energy guard. 5
/// us.
pub const LAW: u64 = 850;

/// The control interrupt, in any state and with any fault. 20.6 us: with the current loop twice on top 32 of a period's 100 us at the
/// fastest rate, 10 kHz. While the frames of an encoder are on the bus the last tick's record is kept and sent. 3,400 is aimed
/// at, and 3,484 what it takes here: another compiler may take some more.
pub const CONTROL: u64 = 3_500;

/// How much of the processor control interrupt and current loop may take at 10 kHz, every run the worst, %: with wait states for all that
/// is fetched from flash, on a chip that runs them from a memory without.
pub const PROCESSOR_PERCENT: u64 = 80;

/// The current loop, 5.3 us of each PWM period of 50 us.
pub const CURRENT: u64 = 900;
