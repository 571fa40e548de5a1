//! The flash controller: unlocking, programming of double words and erasing of pages. The processor stands still during each
//! change, because it fetches from the same flash bank. A test may cut the power at any change.

use std::collections::BTreeSet;

use super::plain::Plain;
use super::{CYCLES_PER_US, NEVER, Peripheral};

const KEYR: u32 = 0x08;
const SR: u32 = 0x10;
const CR: u32 = 0x14;
const ECCR: u32 = 0x18;
const OPTR: u32 = 0x20;

const PG: u32 = 1;
const PER: u32 = 1 << 1;
const STRT: u32 = 1 << 16;
const LOCK: u32 = 1 << 31;
const EOP: u32 = 1;
const PROGERR: u32 = 1 << 3;
const PGSERR: u32 = 1 << 7;
const BSY: u32 = 1 << 16;
/// Bit ECCD of the register ECCR: a double word had two wrong bits. Writing a one clears it (together with ECCC).
const ECCD: u32 = 1 << 31;
const ECC_FLAGS: u32 = 3 << 30;

/// First address of the flash.
pub const BASE: u32 = 0x0800_0000;
/// Bytes per page in dual-bank mode.
pub const PAGE: u32 = 2048;
/// Time to program a double word in microseconds: typical value of the data sheet (DS12288, table 49).
const PROGRAM_US: u64 = 82;
const ERASE_US: u64 = 22_000;

/// A change of the flash that the program has requested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// Programs the double word at this address with these eight bytes.
    Program(u32, [u8; 8]),
    /// Erases the page at this address to 0xff.
    Erase(u32),
}

/// The flash controller. The content of the flash is in Unicorn's memory.
#[derive(Debug, Clone)]
pub struct Flash {
    registers: Plain,
    control: u32,
    status: u32,
    keys: u32,
    /// Address and value of the first word of a double word, while the second word has not been stored; otherwise `None`.
    half: Option<(u32, u32)>,
    busy_until: u64,
    /// Requested changes that the run loop has yet to apply to the memory.
    pub changes: Vec<Change>,
    /// Words that the program stored to flash: address and former value. The run loop restores the former value unless the flash
    /// model programs the word.
    pub stores: Vec<(u32, u32)>,
    /// Addresses of torn double words: their check bits are wrong, because the power was cut while they were written.
    pub torn: BTreeSet<u32>,
    error: u32,
    /// Number of programmed double words and erased pages since the emulator's start.
    pub count: u64,
    /// Number, counted from 0, of the change at which the power is cut; `None` for no cut.
    pub cut_at: Option<u64>,
}

impl Flash {
    /// A locked flash controller with these option bytes (register OPTR).
    #[must_use]
    pub fn new(option_bytes: u32) -> Self {
        Self {
            registers: Plain::default().with(OPTR, option_bytes),
            control: LOCK | 1 << 30,
            status: 0,
            keys: 0,
            half: None,
            busy_until: 0,
            changes: Vec::new(),
            stores: Vec::new(),
            torn: BTreeSet::new(),
            error: 0,
            count: 0,
            cut_at: None,
        }
    }

    /// Resets the registers of the controller; the content of the flash stays.
    pub fn reset(&mut self, option_bytes: u32) {
        let torn = std::mem::take(&mut self.torn);
        let (count, cut_at) = (self.count, self.cut_at);
        *self = Self::new(option_bytes);
        (self.torn, self.count, self.cut_at) = (torn, count, cut_at);
    }

    /// Time in processor cycles until which the processor stands still.
    #[must_use]
    pub fn busy_until(&self) -> u64 {
        self.busy_until
    }

    /// Handles a store instruction by which the processor writes the word `value` to the flash, at the time `now` in cycles.
    pub fn store(&mut self, address: u32, value: u32, now: u64) {
        if self.control & (LOCK | PG) != PG {
            self.status |= PGSERR;
            return;
        }
        match self.half.take() {
            None if address.is_multiple_of(8) => self.half = Some((address, value)),
            Some((first, low)) if address == first + 4 => {
                let mut bytes = [0; 8];
                bytes[..4].copy_from_slice(&low.to_le_bytes());
                bytes[4..].copy_from_slice(&value.to_le_bytes());
                self.changes.push(Change::Program(first, bytes));
                self.begin(PROGRAM_US, now);
            }
            _ => self.status |= PGSERR,
        }
    }

    /// Handles a read of the flash. Returns whether the double word is torn (written while the power was cut), so that the error
    /// correction cannot repair it.
    pub fn reads_torn(&mut self, address: u32) -> bool {
        let is_torn = self.torn.contains(&(address & !7));
        if is_torn && self.error & ECCD == 0 {
            self.error = ECCD | (address - BASE) >> 3;
        }
        is_torn
    }

    /// Whether the flag of an uncorrectable error (ECCD) is set.
    #[must_use]
    pub const fn has_error(&self) -> bool {
        self.error & ECCD != 0
    }

    /// Mask of the bits of a double word that keep their old value when the power is cut during its programming. The mask is a
    /// pseudo-random function of the number of the change.
    #[must_use]
    pub fn not_yet(&self) -> u64 {
        let mixed = (self.count + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ mixed >> 29
    }

    /// Sets the error flag PROGERR: the program wanted to program a word that was not erased.
    pub fn refuse(&mut self) {
        self.status |= PROGERR;
    }

    fn begin(&mut self, us: u64, now: u64) {
        self.count += 1;
        self.busy_until = now + us * CYCLES_PER_US;
        self.status |= BSY;
    }
}

impl Peripheral for Flash {
    fn read(&mut self, offset: u32, now: u64) -> u32 {
        self.advance(now);
        match offset {
            SR => self.status,
            CR => self.control,
            ECCR => self.error,
            _ => self.registers.get(offset),
        }
    }

    fn write(&mut self, offset: u32, value: u32, now: u64) {
        match (offset, value) {
            (KEYR, 0x4567_0123) => self.keys = 1,
            (KEYR, 0xcdef_89ab) if self.keys == 1 => {
                self.control &= !LOCK;
                self.keys = 0;
            }
            (SR, value) => self.status &= !(value & 0xffff),
            (ECCR, value) => self.error &= !(value & ECC_FLAGS),
            (CR, _) if self.control & LOCK != 0 => {}
            (CR, value) => {
                self.control = value & !STRT;
                self.half = None;
                if value & (PER | STRT) == PER | STRT {
                    let bank = if value >> 11 & 1 != 0 { 0x4_0000 } else { 0 };
                    let page = BASE + bank + (value >> 3 & 0x7f) * PAGE;
                    self.changes.push(Change::Erase(page));
                    self.begin(ERASE_US, now);
                }
            }
            _ => self.registers.write(offset, value, now),
        }
    }

    fn next_event(&self) -> u64 {
        if self.status & BSY != 0 {
            self.busy_until
        } else {
            NEVER
        }
    }

    fn advance(&mut self, now: u64) {
        if self.status & BSY != 0 && now >= self.busy_until {
            self.status &= !BSY;
            self.status |= EOP;
        }
    }

    fn lines(&self) -> u128 {
        // EOPIE, ERRIE.
        let done = self.control >> 24 & 1 != 0 && self.status & EOP != 0;
        let wrong = self.control >> 25 & 1 != 0 && self.status & (PROGERR | PGSERR) != 0;
        u128::from(done || wrong) << 4
    }
}
