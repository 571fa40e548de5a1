//! The paths that switch the motor's power bridge off without the processor: the break pin, the comparators and the system break. A
//! lockup, the detector of low supply, or an error in flash raises the system break, if the register SYSCFG_CFGR2 enables it
//! (RM0440, 10.2.5).

use super::Chip;
use crate::board::BREAK_PIN;

/// Offset of the register SYSCFG_CFGR2, which connects the system's errors to the breaks of the timers.
const SYSCFG_CFGR2: u32 = 0x1c;
const CLL: u32 = 1;
const PVDL: u32 = 1 << 2;
const ECCL: u32 = 1 << 3;
/// Number of the non-maskable interrupt (NMI), the exception that an error in flash raises.
const NMI: usize = 2;

impl Chip {
    /// Raises the system break, if SYSCFG_CFGR2 enables it, because the processor has locked up.
    pub fn lock_up(&mut self) {
        let now = self.core.now;
        self.locked_up = true;
        self.drive_world();
        self.update_break(now);
        self.drive_world();
    }

    /// Called when the processor reads flash: an uncorrectable error there raises the NMI and, if SYSCFG_CFGR2 enables it, the
    /// system break.
    pub fn read_flash(&mut self, address: u32) {
        let before = self.flash.has_error();
        if self.flash.reads_torn(address) && !before {
            self.nvic.pend(NMI);
            self.update_break(self.core.now);
            self.core.interrupted = true;
        }
    }

    /// Updates the break inputs to the levels that the board and the comparators drive now.
    pub fn update_break(&mut self, now: u64) {
        let mut pin = self.board.break_pin(&self.world);
        if let Some((port, at)) = self.board.driver_line {
            let pulls = self.board.driver_pulls(&self.world);
            self.ports[port].drive(at, pulls.then_some(false));
            self.bridge.set_stage_off(!self.ports[port].level(at), now);
            let (port, at) = BREAK_PIN;
            pin = self.ports[port].level(at);
        }
        let comparators = self.compare(now);
        self.bridge.set_break(pin, comparators, now);
        let lets = self.plain[2].get(SYSCFG_CFGR2);
        let sources = [
            (CLL, self.locked_up),
            (PVDL, self.pwr.is_low()),
            (ECCL, self.flash.has_error()),
        ];
        let holds = sources.iter().any(|(bit, is_so)| lets & bit != 0 && *is_so);
        self.bridge.set_system_break(holds, now);
        self.exti.set_detector(self.pwr.is_low());
        self.refresh();
    }
}
