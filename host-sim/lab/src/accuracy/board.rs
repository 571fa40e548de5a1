//! Instruction counts of the control laws on the board, a Cortex-M4F at 170 MHz. The counts come from an emulator and are stored in
//! `board.txt`.

// The file is shared with the firmware. Only the tests use its budgets of the control laws.
#[allow(dead_code)]
#[path = "../../../../firmware/budgets.rs"]
mod budgets;

/// Table of instruction counts per control law and number format, written by `cargo xtask thumb` and `cargo xtask cycles`.
const COUNTED: &str = include_str!("board.txt");
/// Clock frequency of the board's processor, Hz.
const CLOCK_HZ: f64 = 170e6;
/// Rate of the motor's current controller on the board, Hz.
const CURRENT_LOOP_HZ: f64 = 20_000.0;
/// Fastest control rate that a board accepts, Hz.
const FASTEST_HZ: u32 = 10_000;

/// Instructions that the control law takes per control period (tick).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instructions {
    /// Mean number of instructions per tick over the test vectors of `cargo xtask thumb`; `None` if it was not measured.
    pub mean: Option<f64>,
    /// Largest number of instructions in any tick.
    pub worst: u32,
}

/// Instruction counts of a control law in a number format. `None` if they were not counted; the board has no control laws in
/// floating point.
#[must_use]
pub fn instructions(law: &str, number: &str) -> Option<Instructions> {
    COUNTED.lines().find_map(|line| {
        let mut words = line.split(' ');
        (words.next() == Some(law) && words.next() == Some(number)).then_some(())?;
        Some(Instructions {
            mean: words.next()?.parse().ok(),
            worst: words.next()?.parse().ok()?,
        })
    })
}

/// Largest fraction (0 to 1) of the processor's time that control interrupt and current controller take, at one instruction per
/// cycle. It follows from the instruction budgets against which the firmware is tested. `None` at a rate that no board accepts.
#[must_use]
pub fn load_at_most(rate_hz: u32) -> Option<f64> {
    let each_s =
        budgets::CONTROL as f64 * f64::from(rate_hz) + budgets::CURRENT as f64 * CURRENT_LOOP_HZ;
    (rate_hz <= FASTEST_HZ).then_some(each_s / CLOCK_HZ)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_control::{Choice as _, LawKind};

    #[test]
    fn every_law_was_counted_in_both_formats_of_the_board() {
        for law in LawKind::WORDS {
            for number in ["fixed16", "fixed32"] {
                let found = instructions(law, number).unwrap_or_else(|| panic!("{law} {number}"));
                assert!(
                    found.mean.unwrap() <= f64::from(found.worst),
                    "{law} {number}"
                );
            }
        }
        let shipped = instructions("shipped", "fixed32").unwrap();
        assert!(u64::from(shipped.worst) <= budgets::LAW);
        let enhanced = instructions("enhanced-sfa", "fixed32").unwrap();
        assert!(u64::from(enhanced.worst) <= budgets::ENHANCED);
        assert_eq!(instructions("spring", "f64"), None);
    }

    #[test]
    fn the_load_grows_with_the_rate_and_ends_with_the_board() {
        // 3,500 instructions 1,000 times per second and 900 instructions 20,000 times per second, of 170 million.
        assert!((load_at_most(1_000).unwrap() - 0.1265).abs() < 1e-4);
        assert!(load_at_most(10_000).unwrap() < 0.8);
        assert_eq!(load_at_most(20_000), None);
    }
}
