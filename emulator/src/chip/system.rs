//! The processor's own registers: interrupt controller, system control, cycle counter.

use super::{Chip, ResetCause};
use crate::cpu::nvic::FIRST;
use crate::peripheral::Peripheral;

impl Chip {
    pub(super) fn read_system(&mut self, address: u32) -> u32 {
        const CPUID_M4: u32 = 0x410f_c241;
        match address {
            0xe000_1000 => self.system.get(0x1000) | 0x4000_0000,
            0xe000_1004 => (self.core.now as u32).wrapping_sub(self.cycle_offset),
            0xe000_e100..0xe000_e500 => self.nvic.read(address - 0xe000_e100),
            0xe000_ed00 => CPUID_M4,
            0xe000_ed04 => {
                let active = self.running.last().map_or(0, |running| running.exception);
                active as u32
            }
            0xe000_ed18..0xe000_ed24 => {
                let first = (address - 0xe000_ed18) as usize + 4;
                u32::from_le_bytes([0, 1, 2, 3].map(|byte| self.nvic.system_priority(first + byte)))
            }
            0xe004_2000 => self.board.device_id,
            _ => self.system.get(address & 0xffff),
        }
    }

    pub(super) fn write_system(&mut self, address: u32, value: u32, size: usize) {
        let now = self.core.now;
        match address {
            0xe000_1004 => self.cycle_offset = (now as u32).wrapping_sub(value),
            0xe000_e100..0xe000_e500 => self.nvic.write(address - 0xe000_e100, value, size),
            0xe000_ef00 => self.nvic.pend(FIRST + (value & 0x1ff) as usize),
            0xe000_ed04 => {
                for (bit, exception) in [(31, 2), (28, 14), (26, 15)] {
                    if value >> bit & 1 != 0 {
                        self.nvic.pend(exception);
                    }
                }
                for (bit, exception) in [(27, 14), (25, 15)] {
                    if value >> bit & 1 != 0 {
                        self.nvic.unpend(exception);
                    }
                }
            }
            0xe000_ed0c if value >> 16 == 0x05fa && value & 4 != 0 => {
                self.reset_request = Some(ResetCause::Software);
            }
            0xe000_ed18..0xe000_ed24 => {
                let first = (address - 0xe000_ed18) as usize + 4;
                for (byte, priority) in value.to_le_bytes().into_iter().take(size).enumerate() {
                    self.nvic.set_system_priority(first + byte, priority);
                }
            }
            _ => self.system.write(address & 0xffff, value, now),
        }
        self.core.interrupted = true;
    }
}
