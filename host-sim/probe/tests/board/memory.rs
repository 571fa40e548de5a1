//! The address space of a simulated STM32G4, as far as writing the flash and reading a log need it.

use crate::flash_memory::{CONTROLLER, FLASH, FlashMemory};

/// First address of the RAM.
pub const RAM: u32 = 0x2000_0000;
/// Address of the register `DBGMCU_IDCODE` with the device number; `DEBUG_CONTROL` is the address of its control register.
const IDCODE: u32 = 0xe004_2000;
const DEBUG_CONTROL: u32 = 0xe004_2004;
/// Address of the word that holds the size of the flash in KiB.
const FLASH_SIZE: u32 = 0x1fff_75e0;

/// The memory of a simulated microcontroller: flash, RAM and a few registers.
pub struct Memory {
    /// The flash with its controller.
    pub flash: FlashMemory,
    /// The RAM.
    pub ram: Vec<u8>,
    /// The chip's device number, as read from the register `DBGMCU_IDCODE`.
    pub device: u32,
    debug_control: u32,
}

impl Memory {
    /// The memory of a microcontroller with this device number.
    pub fn new(device: u32, flash: FlashMemory, ram_bytes: usize) -> Self {
        Self {
            flash,
            ram: vec![0xa5; ram_bytes],
            device,
            debug_control: 0,
        }
    }

    /// Reads 1, 2 or 4 bytes; `None` at an address without memory or register.
    pub fn load(&mut self, address: u32, bytes: u32) -> Option<u32> {
        if let Some(register) = self.controller(address) {
            return Some(self.flash.read(register));
        }
        match address {
            IDCODE => return Some(0x2019_0000 | self.device),
            DEBUG_CONTROL => return Some(self.debug_control),
            FLASH_SIZE => return Some(self.flash.bytes.len() as u32 / 1024),
            _ => {}
        }
        let (memory, offset) = match address {
            RAM.. => (&self.ram, address - RAM),
            FLASH.. => (&self.flash.bytes, address - FLASH),
            _ => return None,
        };
        let cells = memory.get(offset as usize..(offset + bytes) as usize)?;
        Some(
            cells
                .iter()
                .rev()
                .fold(0, |value, cell| value << 8 | u32::from(*cell)),
        )
    }

    /// Writes 1, 2 or 4 bytes; `None` at an address without memory or register.
    pub fn store(&mut self, address: u32, bytes: u32, value: u32) -> Option<()> {
        if let Some(register) = self.controller(address) {
            self.flash.write(register, value);
            return Some(());
        }
        if address == DEBUG_CONTROL {
            self.debug_control = value;
            return Some(());
        }
        let flash = FLASH..FLASH + self.flash.bytes.len() as u32;
        if flash.contains(&address) {
            self.flash.program(address - FLASH, bytes, value);
            return Some(());
        }
        let offset = address.checked_sub(RAM)? as usize;
        let cells = self.ram.get_mut(offset..offset + bytes as usize)?;
        cells.copy_from_slice(&value.to_le_bytes()[..bytes as usize]);
        Some(())
    }

    /// Writes bytes into RAM. Used by a function that stands for the running program.
    pub fn put(&mut self, address: u32, bytes: &[u8]) {
        let offset = (address - RAM) as usize;
        self.ram[offset..offset + bytes.len()].copy_from_slice(bytes);
    }

    fn controller(&self, address: u32) -> Option<u32> {
        let offset = address.checked_sub(CONTROLLER)?;
        (offset < 0x400).then_some(offset)
    }
}
