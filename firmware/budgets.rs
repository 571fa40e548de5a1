//! The most instructions that each part of a control period may take on the microcontroller, a Cortex-M4F at 170 MHz: what
//! `cargo xtask thumb` and `cargo xtask cycles` hold the programs to. Each reads this file.

/// One tick of the enhanced law by itself, for any input. 600 is aimed at, 3.5 us at an instruction a cycle; it took 696 at worst
/// since the energy of the mass that is left behind is paid for, and 712 since the force limit bounds the offset, until that path is
/// shorter.
pub const ENHANCED: u64 = 720;

/// One tick of three axes: surface point, shell, friction and guard, or the law along the normal on estimated states. A law an axis is the worst, 2,498.
pub const SPACE: u64 = 2_500;

/// All that the law's side of a control tick may choose: the law, the estimator of its states and the guard of its energy. 5 us.
pub const LAW: u64 = 850;

/// The control interrupt, in any state and with any fault. 21.5 us: with the current loop twice on top 32 of a period's 100 us at the
/// fastest rate, 10 kHz. It was 3,400 before the motor's heat, the desktop's silence and the magnet's field were watched, which take some
/// 210 together, and 3,550 before more than one wall and the position at the change of force, 120 to 130 each. Some 1,080 are waiting for a
/// magnetic encoder.
pub const CONTROL: u64 = 3_650;

/// The current loop, 5.3 us of each PWM period of 50 us.
pub const CURRENT: u64 = 900;
