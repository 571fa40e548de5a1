//! The GPIO ports A to G: outputs that the program drives, and inputs that the board pulls or drives.

use super::Peripheral;
use super::plain::Plain;

const MODER: u32 = 0x00;
const OSPEEDR: u32 = 0x08;
const PUPDR: u32 = 0x0c;
const IDR: u32 = 0x10;
const ODR: u32 = 0x14;
const BSRR: u32 = 0x18;
const BRR: u32 = 0x28;

/// A GPIO port of 16 pins.
#[derive(Debug, Clone)]
pub struct Port {
    registers: Plain,
    out: u32,
    /// Level that the board drives at each pin; `None` where the board does not drive the pin.
    driven: [Option<bool>; 16],
}

impl Port {
    /// A port after a reset. Ports A and B keep the debugger's pins configured (RM0440, 9.4.1, 9.4.3, 9.4.4).
    #[must_use]
    pub fn new(index: usize) -> Self {
        let (modes, speeds, pulls) = match index {
            0 => (0xabff_ffff, 0x0c00_0000, 0x6400_0000),
            1 => (0xffff_febf, 0x0000_00c0, 0x0000_0100),
            _ => (0xffff_ffff, 0, 0),
        };
        Self {
            registers: Plain::default()
                .with(MODER, modes)
                .with(OSPEEDR, speeds)
                .with(PUPDR, pulls),
            out: 0,
            driven: [None; 16],
        }
    }

    /// Lets the board drive a pin at a level; `None` means that the board does not drive it.
    pub fn drive(&mut self, pin: usize, level: Option<bool>) {
        self.driven[pin] = level;
    }

    /// Level at a pin: the program's output if the pin is an output. Otherwise the level that the board drives; if the board drives
    /// none, that of the pull-up or pull-down resistor.
    #[must_use]
    pub fn level(&self, pin: usize) -> bool {
        let field = |register| self.registers.get(register) >> (2 * pin) & 3;
        match (field(MODER), self.driven[pin], field(PUPDR)) {
            (1, ..) => self.out >> pin & 1 != 0,
            (_, Some(level), _) => level,
            (_, None, pull) => pull == 1,
        }
    }

    /// Mode of a pin in MODER: 0 input, 1 output, 2 alternate function, 3 analogue.
    #[must_use]
    pub fn mode(&self, pin: usize) -> u32 {
        self.registers.get(MODER) >> (2 * pin) & 3
    }
}

impl Peripheral for Port {
    fn read(&mut self, offset: u32, now: u64) -> u32 {
        match offset {
            IDR => (0..16).map(|pin| u32::from(self.level(pin)) << pin).sum(),
            ODR => self.out,
            BSRR | BRR => 0,
            _ => self.registers.read(offset, now),
        }
    }

    fn write(&mut self, offset: u32, value: u32, now: u64) {
        match offset {
            ODR => self.out = value & 0xffff,
            // A bit that is set and reset at once is set.
            BSRR => self.out = (self.out & !(value >> 16)) | (value & 0xffff),
            BRR => self.out &= !value,
            IDR => {}
            _ => self.registers.write(offset, value, now),
        }
    }
}
