//! The simulated processor as a debugger sees it: the debug registers of the Armv7-M manual (chapter C1), and the effects of a
//! reset.

use crate::cpu::{Cpu, Stop};
use crate::flash_memory::FLASH;
use crate::memory::{Memory, RAM};

const CPUID: u32 = 0xe000_ed00;
const AIRCR: u32 = 0xe000_ed0c;
const DFSR: u32 = 0xe000_ed30;
const DHCSR: u32 = 0xe000_edf0;
const DCRSR: u32 = 0xe000_edf4;
const DCRDR: u32 = 0xe000_edf8;
const DEMCR: u32 = 0xe000_edfc;
const MVFR0: u32 = 0xe000_ef40;
/// Address of the control register of the breakpoint unit. The unit compares six instruction addresses and two literal addresses.
const FP_CTRL: u32 = 0xe000_2000;
const FP_COMP: u32 = 0xe000_2008;
const FP_COMP_END: u32 = 0xe000_2028;

const DEBUG_ENABLED: u32 = 1;
const HALT: u32 = 1 << 1;
const STEP: u32 = 1 << 2;
const CATCH_RESET: u32 = 1;
/// Bits of the debug register that says why the processor halted: a halt request; `BREAKPOINT`: a breakpoint; `CAUGHT`: a reset.
const HALTED: u32 = 1;
const BREAKPOINT: u32 = 1 << 1;
const CAUGHT: u32 = 1 << 3;
/// Largest number of instructions that a call of the flash algorithm may take. A longer call counts as an endless loop.
const INSTRUCTIONS_MAX: u32 = 10_000_000;

/// A function that stands for the program in flash. The simulation calls it whenever the probe accesses the running processor, with
/// `true` right after the start.
pub type Played = Box<dyn FnMut(&mut Memory, bool) + Send>;

/// A simulated microcontroller with its debug registers.
pub struct Machine {
    pub memory: Memory,
    /// Number of resets that started the program in flash.
    pub starts: u32,
    /// Number of times that the processor was halted.
    pub halts: u32,
    /// Message of the fault that stopped the processor; `None` after a breakpoint.
    pub fault: Option<String>,
    pub played: Option<Played>,
    cpu: Cpu,
    control: u32,
    halted: bool,
    was_reset: bool,
    demcr: u32,
    dfsr: u32,
    dcrdr: u32,
    breakpoints: [u32; 8],
    begun: bool,
}

impl Machine {
    /// A microcontroller whose processor runs the program in flash.
    pub fn new(memory: Memory) -> Self {
        Self {
            memory,
            starts: 0,
            halts: 0,
            fault: None,
            played: None,
            cpu: Cpu::default(),
            control: 0,
            halted: false,
            was_reset: false,
            demcr: 0,
            dfsr: 0,
            dcrdr: 0,
            breakpoints: [0; 8],
            begun: true,
        }
    }

    /// Whether the processor runs the program in flash, rather than being halted.
    pub fn runs(&self) -> bool {
        !self.halted && self.fault.is_none() && self.cpu.r[15] < RAM
    }

    /// Reads 1, 2 or 4 bytes for the probe; returns `None` for an address that gives a bus fault.
    pub fn load(&mut self, address: u32, bytes: u32) -> Option<u32> {
        self.play();
        let protected = self.memory.flash.is_protected();
        Some(match address {
            CPUID => 0x410f_c241,
            AIRCR => 0xfa05_0000,
            DFSR => self.dfsr,
            DHCSR => {
                let bit = |set: bool, place: u32| u32::from(set) << place;
                let reset = std::mem::take(&mut self.was_reset);
                self.control
                    | bit(true, 16)
                    | bit(self.halted, 17)
                    | bit(self.fault.is_some(), 19)
                    | bit(reset, 25)
            }
            DCRDR => self.dcrdr,
            DEMCR => self.demcr,
            MVFR0 => 0x1011_0021,
            FP_CTRL => 0x260,
            FP_COMP..FP_COMP_END => self.breakpoints[(address - FP_COMP) as usize / 4],
            FLASH..RAM if protected && address < 0x1000_0000 => return None,
            _ => return self.memory.load(address, bytes),
        })
    }

    /// Writes 1, 2 or 4 bytes for the probe; returns `None` for an address that gives a bus fault.
    pub fn store(&mut self, address: u32, bytes: u32, value: u32) -> Option<()> {
        match address {
            AIRCR if value >> 16 == 0x05fa && value & 4 != 0 => self.reset(),
            DFSR => self.dfsr &= !value,
            DHCSR if value >> 16 == 0xa05f => self.controlled(value & 0xf),
            DCRSR => self.register((value & 0x7f) as usize, value >> 16 & 1 == 1),
            DCRDR => self.dcrdr = value,
            DEMCR => self.demcr = value,
            AIRCR | DHCSR | FP_CTRL => {}
            FP_COMP..FP_COMP_END => self.breakpoints[(address - FP_COMP) as usize / 4] = value,
            _ => return self.memory.store(address, bytes, value),
        }
        Some(())
    }

    fn word(&mut self, address: u32) -> u32 {
        self.memory.load(address, 4).unwrap_or(0)
    }

    fn play(&mut self) {
        if self.halted || self.fault.is_some() {
            return;
        }
        if let Some(played) = &mut self.played {
            played(&mut self.memory, std::mem::take(&mut self.begun));
        }
    }

    /// Resets the microcontroller. All but the state of its power supply is then as after power-on.
    pub fn reset(&mut self) {
        self.memory.flash.reset();
        self.cpu = Cpu::default();
        self.cpu.r[13] = self.word(FLASH);
        self.cpu.r[15] = self.word(FLASH + 4) & !1;
        self.cpu.xpsr = 1 << 24;
        self.was_reset = true;
        self.fault = None;
        self.control &= !(HALT | STEP);
        if self.demcr & CATCH_RESET != 0 && self.control & DEBUG_ENABLED != 0 {
            self.halt(CAUGHT);
        } else {
            self.halted = false;
            self.starts += 1;
            self.begun = true;
        }
    }

    /// Handles a write to the debug register DHCSR, which halts, steps or runs the processor.
    fn controlled(&mut self, control: u32) {
        self.control = control;
        if control & DEBUG_ENABLED == 0 {
            self.control = 0;
            self.halted = false;
            return;
        }
        if control & HALT != 0 {
            self.halts += u32::from(!self.halted);
            self.halt(HALTED);
            return;
        }
        if !self.halted {
            return;
        }
        self.halted = false;
        if self.cpu.r[15] < RAM {
            // The board's own program is not simulated. For the probe it runs, and a step halts again.
            if control & STEP != 0 {
                self.halt(HALTED);
            }
            return;
        }
        let count = if control & STEP != 0 {
            1
        } else {
            INSTRUCTIONS_MAX
        };
        for _ in 0..count {
            match self.cpu.step(&mut self.memory) {
                Ok(()) => {}
                Err(Stop::Breakpoint) => return self.halt(BREAKPOINT),
                Err(Stop::Fault(why)) => {
                    eprintln!("the processor stopped: {why}");
                    self.fault = Some(why);
                    return;
                }
            }
        }
        match count {
            1 => self.halt(HALTED),
            _ => self.fault = Some("an endless loop".into()),
        }
    }

    /// Halts the processor and sets the bit `reason` in the debug register that says why.
    fn halt(&mut self, reason: u32) {
        self.halted = true;
        self.control |= HALT;
        self.dfsr |= reason;
    }

    /// Handles a write to the debug register DCRSR: copies a processor register to the register DCRDR, or DCRDR to it if `write` is
    /// true.
    fn register(&mut self, which: usize, write: bool) {
        let place = match which {
            0..16 => &mut self.cpu.r[which],
            16 => &mut self.cpu.xpsr,
            17 => &mut self.cpu.r[13],
            _ => {
                self.dcrdr = 0;
                return;
            }
        };
        match write {
            true => *place = self.dcrdr,
            false => self.dcrdr = *place,
        }
        // An instruction's address is even, whatever is written.
        self.cpu.r[15] &= !1;
    }
}
