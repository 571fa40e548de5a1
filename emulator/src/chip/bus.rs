//! Reads and writes of the program: which block answers, and what a write changes elsewhere.

use super::Chip;
use super::map::{Block, MAP};
use crate::peripheral::Peripheral;

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

    fn find(&mut self, address: u32) -> (Block, u32) {
        let found = MAP
            .iter()
            .find(|(base, size, _)| (*base..base + size).contains(&address));
        match found {
            Some((base, _, block)) => (*block, address - base),
            None => {
                self.unknown.insert(address);
                (Block::Other, address)
            }
        }
    }

    /// A read by the program.
    pub fn read(&mut self, address: u32, size: usize) -> u32 {
        let now = self.core.now;
        let word = match address & !3 {
            system if system >= 0xe000_0000 => self.read_system(system),
            rom @ 0x1fff_7000..0x1fff_8000 => self.board.system_memory(rom),
            register => {
                let (block, offset) = self.find(register);
                let value = self.peripheral(block).read(offset, now);
                let value = self.board.read_back(register, value);
                self.refresh();
                value
            }
        };
        let shifted = word >> (8 * (address & 3));
        match size {
            1 => shifted & 0xff,
            2 => shifted & 0xffff,
            _ => shifted,
        }
    }

    /// A write by the program.
    pub fn write(&mut self, address: u32, value: u32, size: usize) {
        let now = self.core.now;
        if address >= 0xe000_0000 {
            self.write_system(address, value, size);
        } else {
            let (block, offset) = self.find(address & !3);
            let shift = 8 * (address & 3);
            if block == Block::Tim1 {
                // What changes the bridge changes it from now on.
                self.drive_world();
            }
            self.peripheral(block)
                .write(offset & !3, value << shift, now);
            self.after_write(block);
        }
        self.refresh();
        self.core.limit = self.core.limit.min(self.next_event());
    }

    /// What a write has changed elsewhere.
    fn after_write(&mut self, block: Block) {
        match block {
            Block::AdcCommon => {
                let common = self.plain[0].get(0x08);
                self.adcs.iter_mut().for_each(|adc| adc.set_common(common));
            }
            Block::Port(_) => {
                if let Some((port, pin)) = self.board.chip_select {
                    let level = self.ports[port].level(pin);
                    self.spi3.set_select(level);
                }
            }
            Block::Pwr | Block::Syscfg | Block::Flash => self.update_break(self.core.now),
            Block::Tim1 => self.drive_world(),
            Block::Rcc => self.wwdg.set_clock(self.rcc.wwdg_hz(), self.core.now),
            _ => {}
        }
        if self.flash.busy_until() > self.core.now {
            self.core.interrupted = true;
        }
    }
}
