//! Register reads and writes by the firmware: which peripheral block answers, and which other blocks a write affects.

use super::Chip;
use super::map::{Block, MAP};
use crate::peripheral::Peripheral;
use crate::peripheral::rcc::Rcc;

impl Chip {
    fn peripheral(&mut self, block: Block) -> &mut dyn Peripheral {
        match block {
            Block::Timer(index) => &mut self.timers[index],
            Block::Iwdg => &mut self.iwdg,
            Block::Wwdg => &mut self.wwdg,
            Block::Spi3 => &mut self.spi3,
            Block::Usart2 => &mut self.usart2,
            Block::Lpuart1 => &mut self.lpuart1,
            Block::Pwr => &mut self.pwr,
            Block::Exti => &mut self.exti,
            Block::Tim1 => &mut self.bridge,
            Block::Rcc => &mut self.rcc,
            Block::Flash => &mut self.flash,
            Block::Port(index) => &mut self.ports[index],
            Block::Adc(index) => &mut self.adcs[index],
            Block::AdcCommon => &mut self.plain[0],
            Block::Dac => &mut self.plain[1],
            Block::Syscfg => &mut self.plain[2],
            Block::Analog => &mut self.plain[3],
            Block::Dma => &mut self.plain[4],
            Block::Other => &mut self.plain[5],
        }
    }

    /// Whether an amplifier is on, with its output connected to a converter on the chip (RM0440, OPAMPx_CSR).
    pub(super) fn amplifies(&self, amplifier: usize) -> bool {
        const ON_AND_INSIDE: u32 = 1 | 1 << 8;
        self.plain[3].get(4 * amplifier as u32) & ON_AND_INSIDE == ON_AND_INSIDE
    }

    /// The peripheral block at an address, the register's offset in the block, and whether the block is clocked.
    fn find(&mut self, address: u32) -> (Block, u32, bool) {
        let at = MAP
            .iter()
            .position(|(base, size, ..)| (*base..base + size).contains(&address));
        match at {
            Some(at) => {
                let (base, _, block, _) = MAP[at];
                (block, address - base, self.clocked >> at & 1 != 0)
            }
            None => {
                self.unknown.insert(address);
                (Block::Other, address, true)
            }
        }
    }

    /// Bit mask of the peripheral blocks that RCC clocks now, by their row in the address map.
    pub(super) fn clocked(rcc: &Rcc) -> u64 {
        let clocked = |(.., clock): &(u32, u32, Block, Option<(u32, u32)>)| {
            clock.is_none_or(|(register, bit)| rcc.gives(register, bit))
        };
        (MAP.iter().enumerate()).fold(0, |all, (at, row)| all | u64::from(clocked(row)) << at)
    }

    /// The value of a register, for a test. The register's block needs no clock.
    pub fn peek(&mut self, address: u32) -> u32 {
        let (now, (block, offset, _)) = (self.core.now, self.find(address));
        self.peripheral(block).read(offset, now)
    }

    /// Carries out the firmware's read of `size` bytes from a register; returns the value.
    pub fn read(&mut self, address: u32, size: usize) -> u32 {
        let now = self.core.now;
        let word = match address & !3 {
            system if system >= 0xe000_0000 => self.read_system(system),
            rom @ 0x1fff_7000..0x1fff_8000 => self.board.system_memory(rom),
            register => {
                let (block, offset, clocked) = self.find(register);
                if clocked {
                    let value = self.peripheral(block).read(offset, now);
                    let value = self.board.read_back(register, value);
                    self.refresh();
                    value
                } else {
                    0
                }
            }
        };
        let shifted = word >> (8 * (address & 3));
        match size {
            1 => shifted & 0xff,
            2 => shifted & 0xffff,
            _ => shifted,
        }
    }

    /// Carries out the firmware's write of `size` bytes to a register.
    pub fn write(&mut self, address: u32, value: u32, size: usize) {
        let now = self.core.now;
        if address >= 0xe000_0000 {
            self.write_system(address, value, size);
        } else {
            let (block, offset, clocked) = self.find(address & !3);
            self.written.insert(address & !3);
            let shift = 8 * (address & 3);
            if block == Block::Tim1 {
                // A write to this timer may change the inverter's output. So the model first advances to the present time with the
                // old output.
                self.drive_world();
            }
            if clocked {
                self.peripheral(block)
                    .write(offset & !3, value << shift, now);
                self.after_write(block);
            }
        }
        self.refresh();
        self.core.limit = self.core.limit.min(self.next_event());
    }

    /// Passes the effects of a write to a block on to other blocks of the chip.
    fn after_write(&mut self, block: Block) {
        match block {
            Block::AdcCommon => {
                let common = self.plain[0].get(0x08);
                self.adcs.iter_mut().for_each(|adc| adc.set_common(common));
            }
            Block::Port(_) => {
                if let Some((port, pin)) = self.board.chip_select {
                    let level = self.ports[port].level(pin);
                    self.spi3.set_select(level, self.core.now);
                }
            }
            Block::Pwr | Block::Syscfg | Block::Flash => self.update_break(self.core.now),
            Block::Tim1 => self.drive_world(),
            Block::Rcc => {
                self.wwdg.set_clock(self.rcc.wwdg_hz(), self.core.now);
                self.clocked = Self::clocked(&self.rcc);
            }
            _ => {}
        }
        if self.flash.busy_until() > self.core.now {
            self.core.interrupted = true;
        }
    }
}
