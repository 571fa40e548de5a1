//! The simulated flash of a chip with its controller, as STMicroelectronics' manual RM0440 describes it for devices of categories 2
//! and 3.

/// First address of the flash.
pub const FLASH: u32 = 0x0800_0000;
/// First address of the flash controller's registers.
pub const CONTROLLER: u32 = 0x4002_2000;

const KEYR: u32 = 0x08;
const SR: u32 = 0x10;
const CR: u32 = 0x14;
const OPTR: u32 = 0x20;

const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];
const LOCK: u32 = 1 << 31;
const START: u32 = 1 << 16;
const PROGRAM: u32 = 1;
const PAGE_ERASE: u32 = 1 << 1;
/// Error bits of the flash controller. `PROGERR`: a word was programmed that is not erased. `SIZERR`: a wrong size. `PGSERR`: a
/// wrong page or order of steps.
const PROGERR: u32 = 1 << 3;
const SIZERR: u32 = 1 << 6;
const PGSERR: u32 = 1 << 7;
/// Option bit of a flash with two banks, each of which numbers its pages from 0.
const DUAL_BANK: u32 = 1 << 22;
/// Option bit: 1 if software starts the watchdog, 0 if the watchdog runs from the reset on.
const SOFTWARE_WATCHDOG: u32 = 1 << 16;

/// The flash of a chip with its controller.
pub struct FlashMemory {
    /// Content of the flash.
    pub bytes: Vec<u8>,
    /// Option bytes (settings of the chip that survive a reset).
    pub options: u32,
    /// First addresses of the pages that were erased, in the order of erasing.
    pub erased: Vec<u32>,
    control: u32,
    status: u32,
    /// Number of correct unlock keys received so far. `None` after a wrong key: the flash is then locked until the next reset.
    keys: Option<usize>,
    /// Address and value of the first half of a double word (8 bytes), until the second half is written.
    half: Option<(u32, u32)>,
    /// Address of a simulated defective cell, which does not store what is written.
    pub stuck: Option<u32>,
}

impl FlashMemory {
    /// Creates a flash of `size` bytes, no page of it erased.
    pub fn new(size: usize, dual_bank: bool) -> Self {
        let bank = if dual_bank { DUAL_BANK } else { 0 };
        Self {
            bytes: vec![0x5a; size],
            options: SOFTWARE_WATCHDOG | bank | 0xaa,
            erased: Vec::new(),
            control: LOCK,
            status: 0,
            keys: Some(0),
            half: None,
            stuck: None,
        }
    }

    /// Resets the flash controller; the flash keeps its content.
    pub fn reset(&mut self) {
        (self.control, self.status) = (LOCK, 0);
        (self.keys, self.half) = (Some(0), None);
    }

    /// Whether the flash is protected against reading through a probe.
    pub fn is_protected(&self) -> bool {
        self.options & 0xff != 0xaa
    }

    /// Reads a register of the flash controller.
    pub fn read(&self, register: u32) -> u32 {
        match register {
            SR => self.status,
            CR => self.control,
            OPTR => self.options,
            _ => 0,
        }
    }

    /// Writes a register of the flash controller, with its effects such as erasing a page.
    pub fn write(&mut self, register: u32, value: u32) {
        match register {
            KEYR => self.key(value),
            SR => self.status &= !value,
            CR if self.control & LOCK != 0 => {}
            CR => {
                self.control = value & !START;
                if value & LOCK != 0 {
                    self.keys = Some(0);
                }
                if value & START != 0 && value & PAGE_ERASE != 0 {
                    self.erase(value >> 3 & 0x7f, value >> 11 & 1);
                }
            }
            _ => {}
        }
    }

    fn key(&mut self, value: u32) {
        self.keys = match self.keys {
            Some(count) if KEYS.get(count) == Some(&value) => Some(count + 1),
            _ => None,
        };
        if self.keys == Some(KEYS.len()) {
            self.control &= !LOCK;
        }
    }

    fn erase(&mut self, page: u32, bank: u32) {
        const PAGE: u32 = 0x800;
        let size = self.bytes.len() as u32;
        let banks = if self.options & DUAL_BANK != 0 { 2 } else { 1 };
        let begin = bank * (size / 2) + page * PAGE;
        if bank >= banks || page * PAGE >= size / banks {
            self.status |= PGSERR;
            return;
        }
        self.bytes[begin as usize..(begin + PAGE) as usize].fill(0xff);
        self.erased.push(FLASH + begin);
    }

    /// Programs a word of the flash. As a real flash does, it accepts only erased double words, half after half, once the
    /// controller permits programming.
    pub fn program(&mut self, offset: u32, size: u32, value: u32) {
        if self.control & (LOCK | PROGRAM) != PROGRAM {
            self.status |= PGSERR;
            return;
        }
        if size != 4 {
            self.status |= SIZERR;
            return;
        }
        match self.half.take() {
            None if offset.is_multiple_of(8) => self.half = Some((offset, value)),
            Some((first, low)) if first + 4 == offset => {
                let cells = &mut self.bytes[first as usize..first as usize + 8];
                if cells.iter().any(|cell| *cell != 0xff) {
                    self.status |= PROGERR;
                    return;
                }
                cells[..4].copy_from_slice(&low.to_le_bytes());
                cells[4..].copy_from_slice(&value.to_le_bytes());
                if let Some(stuck) = self.stuck {
                    self.bytes[stuck as usize] = 0xff;
                }
            }
            _ => self.status |= PGSERR,
        }
    }
}
