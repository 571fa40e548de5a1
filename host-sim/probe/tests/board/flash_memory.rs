//! The simulated flash and its controller, after the chapters of RM0440 on the embedded flash memory of category 3 and 2 devices.

/// Address at which the flash begins.
pub const FLASH: u32 = 0x0800_0000;
/// Address of the flash controller's registers.
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
/// Error bits: programming a word that is not erased. The next lines: a wrong size or page; a wrong order of steps.
const PROGERR: u32 = 1 << 3;
const SIZERR: u32 = 1 << 6;
const PGSERR: u32 = 1 << 7;
/// Option bit for two banks, each with its own pages from 0 on.
const DUAL_BANK: u32 = 1 << 22;
/// Option bit: software starts the watchdog, not the reset.
const SOFTWARE_WATCHDOG: u32 = 1 << 16;

/// The flash of a chip with its controller.
pub struct FlashMemory {
    /// Content of the flash.
    pub bytes: Vec<u8>,
    /// Option bytes.
    pub options: u32,
    /// First addresses of the erased pages.
    pub erased: Vec<u32>,
    control: u32,
    status: u32,
    /// Number of right keys received so far. `None` after a wrong key: the flash then is locked until the next reset.
    keys: Option<usize>,
    /// Address and value of the first half of a double word, until the second half is written.
    half: Option<(u32, u32)>,
    /// Address of a defective cell, which does not store what is written, for a test.
    pub stuck: Option<u32>,
}

impl FlashMemory {
    /// A flash of this many bytes, none of it erased.
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

    /// Resets the controller.
    pub fn reset(&mut self) {
        (self.control, self.status) = (LOCK, 0);
        (self.keys, self.half) = (Some(0), None);
    }

    /// Whether the flash is protected against reading through a probe.
    pub fn is_protected(&self) -> bool {
        self.options & 0xff != 0xaa
    }

    /// Reads a register of the controller.
    pub fn read(&self, register: u32) -> u32 {
        match register {
            SR => self.status,
            CR => self.control,
            OPTR => self.options,
            _ => 0,
        }
    }

    /// Writes a register of the controller.
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

    /// Programs the flash. Accepts only double words that were erased before, in the right order, after the controller permitted
    /// it.
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
