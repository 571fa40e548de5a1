//! What switches the bridge off without the processor: the break pin, the comparators, a lockup.

use super::Chip;

/// Offset of the register with CLL, in the block of SYSCFG: a lockup of the processor pulls the break of TIM1.
const SYSCFG_CFGR2: u32 = 0x1c;
/// Offsets of the comparators' registers in the same block, COMP1 to COMP4.
const COMP_CSR: [u32; 4] = [0x200, 0x204, 0x208, 0x20c];
/// A comparator is on.
const COMP_EN: u32 = 1;

impl Chip {
    /// The processor has locked up: with SYSCFG_CFGR2.CLL that pulls the break of TIM1.
    pub fn lock_up(&mut self) {
        let now = self.core.now;
        if self.plain[2].get(SYSCFG_CFGR2) & 1 != 0 {
            self.drive_world();
            self.bridge.pull_break(now);
            self.drive_world();
        }
    }

    /// The break inputs as the board drives them now. A comparator that the program has not switched on says nothing.
    pub fn update_break(&mut self, now: u64) {
        let (pin, over) = self.board.break_input(&self.world);
        let mut comparators = 0;
        for (bit, offset) in COMP_CSR.into_iter().enumerate() {
            comparators |= (self.plain[2].get(offset) & COMP_EN) << bit;
        }
        self.bridge.set_break(pin, over & comparators, now);
        self.exti.set_detector(self.pwr.is_low());
        self.refresh();
    }
}
