//! The processor: Unicorn executes instructions; what it does not have of a Cortex-M is here.
//!
//! Unicorn 2.1.5 has no NVIC, and does not see `bx lr` as an exception's return when the host has changed IPSR. So it never
//! leaves thread mode: entry and return are done here, on its registers and memory ([`exception`]), and a jump to
//! EXC_RETURN is met as a fetch from an address where nothing can be. Interrupts are delivered between two
//! slices only, and a slice never ends inside of an IT block.

pub mod core;
pub mod decode;
pub mod elf;
pub mod exception;
pub mod nvic;

use unicorn_engine::unicorn_const::{Arch, MemType, Mode, Prot, uc_error};
use unicorn_engine::{ArmCpuModel, HookType, RegisterARM, Unicorn};

use self::core::{Core, Stop};
use crate::chip::{Chip, ResetCause};
use crate::peripheral::NEVER;
use crate::peripheral::flash::{self, Change};
use decode::{decode, is_wide, with_block};
use elf::Program;

/// Flash of the larger chip, bytes.
const FLASH_BYTES: usize = 512 * 1024;
/// Where RAM begins.
pub const RAM: u32 = 0x2000_0000;
/// RAM of the larger chip, bytes: SRAM1, SRAM2, and CCM behind them.
const RAM_BYTES: usize = 128 * 1024;
/// What [`Machine::extend_stack`] adds, bytes.
const EXTENSION: u64 = 0x4000;
/// What RAM holds before anything was written to it: for the stack's watermark.
pub const UNTOUCHED: u8 = 0xa5;

/// Why a run ended before its time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Halt {
    /// A return from an exception that does not run: a mistake of the emulator, or a program that has lost its stack.
    BadReturn(String),
    /// The power was cut at a write to flash, as asked for.
    PowerCut,
    /// Something that is not modelled.
    Unsupported(String),
}

/// The chip with its processor.
pub struct Machine {
    pub(crate) unicorn: Unicorn<'static, Chip>,
    asleep: Option<Stop>,
    /// A fault that could not be handled stopped the processor: only a reset helps.
    locked: bool,
    /// Resets since power came on: when, and why.
    pub resets: Vec<(u64, ResetCause)>,
}

/// What Unicorn said, as text.
fn said(what: &str) -> impl Fn(uc_error) -> String {
    let what = what.to_owned();
    move |error| format!("Unicorn, {what}: {error:?}")
}

impl Machine {
    /// A chip with a program in its flash, before power is on.
    ///
    /// # Errors
    /// What Unicorn refuses, or a segment outside of flash.
    pub fn new(chip: Chip, program: &Program) -> Result<Self, String> {
        let mut unicorn = Unicorn::new_with_data(Arch::ARM, Mode::THUMB | Mode::MCLASS, chip)
            .map_err(said("open"))?;
        unicorn
            .ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32)
            .map_err(said("model"))?;
        let map = said("map");
        unicorn
            .mem_map(
                u64::from(flash::BASE),
                FLASH_BYTES as u64,
                Prot::READ | Prot::EXEC,
            )
            .map_err(&map)?;
        unicorn
            .mem_map(u64::from(RAM), RAM_BYTES as u64, Prot::ALL)
            .map_err(&map)?;
        for (base, size) in [
            (0x4000_0000, 0x2000_0000),
            (0xe000_0000, 0x10_0000),
            (0x1fff_7000, 0x1000),
        ] {
            let read = move |uc: &mut Unicorn<'_, Chip>, offset: u64, size: usize| {
                u64::from(uc.get_data_mut().read((base + offset) as u32, size))
            };
            let write = move |uc: &mut Unicorn<'_, Chip>, offset: u64, size: usize, value: u64| {
                uc.get_data_mut()
                    .write((base + offset) as u32, value as u32, size);
            };
            unicorn
                .mmio_map(base, size, Some(read), Some(write))
                .map_err(&map)?;
        }
        unicorn
            .add_code_hook(1, 0, on_instruction)
            .map_err(said("hook"))?;
        let on_store =
            |uc: &mut Unicorn<'_, Chip>, _: MemType, address: u64, size: usize, value: i64| {
                let is_flash = (u64::from(flash::BASE)
                    ..u64::from(flash::BASE) + FLASH_BYTES as u64)
                    .contains(&address);
                if is_flash && size == 4 {
                    let mut before = [0; 4];
                    let _ = uc.mem_read(address, &mut before);
                    let before = u32::from_le_bytes(before);
                    uc.get_data_mut()
                        .store_to_flash(address as u32, before, value as u32);
                }
                is_flash
            };
        unicorn
            .add_mem_hook(HookType::MEM_WRITE_PROT, 1, 0, on_store)
            .map_err(said("hook"))?;
        unicorn
            .mem_write(u64::from(flash::BASE), &vec![0xff; FLASH_BYTES])
            .map_err(said("flash"))?;
        for (address, content) in &program.segments {
            unicorn
                .mem_write(u64::from(*address), content)
                .map_err(said("a segment outside of flash"))?;
        }
        Ok(Self {
            unicorn,
            asleep: None,
            locked: false,
            resets: Vec::new(),
        })
    }

    /// Gives the program memory below RAM, which no chip has: to find out how much stack a program would need that overflows it.
    ///
    /// # Errors
    /// What Unicorn refuses.
    pub fn extend_stack(&mut self) -> Result<(), String> {
        let below = u64::from(RAM) - EXTENSION;
        self.unicorn
            .mem_map(below, EXTENSION, Prot::ALL)
            .map_err(said("map"))?;
        self.set_memory(below as u32, &[UNTOUCHED; EXTENSION as usize]);
        Ok(())
    }

    /// Bytes of the stack, which begins at RAM's start or, extended, below it, that were ever used.
    #[must_use]
    pub fn stack_used(&self, top: u32) -> u32 {
        let start = RAM - EXTENSION as u32;
        let memory = self.memory(start, (top - start) as usize);
        let bottom = if memory.is_empty() { RAM } else { start };
        let memory = self.memory(bottom, (top - bottom) as usize);
        let untouched = memory.iter().take_while(|byte| **byte == UNTOUCHED).count();
        top - bottom - untouched as u32
    }

    /// The chip.
    #[must_use]
    pub fn chip(&self) -> &Chip {
        self.unicorn.get_data()
    }

    /// The chip, to be changed.
    pub fn chip_mut(&mut self) -> &mut Chip {
        self.unicorn.get_data_mut()
    }

    pub(crate) fn register(&self, register: RegisterARM) -> u32 {
        self.unicorn.reg_read(register).unwrap_or(0) as u32
    }

    pub(crate) fn set_register(&mut self, register: RegisterARM, value: u32) {
        // Only an unknown register is refused.
        let _ = self.unicorn.reg_write(register, u64::from(value));
    }

    /// A word of memory; 0 where there is none.
    #[must_use]
    pub fn word(&self, address: u32) -> u32 {
        let mut bytes = [0; 4];
        let _ = self.unicorn.mem_read(u64::from(address), &mut bytes);
        u32::from_le_bytes(bytes)
    }

    /// Bytes of memory.
    #[must_use]
    pub fn memory(&self, address: u32, length: usize) -> Vec<u8> {
        self.unicorn
            .mem_read_as_vec(u64::from(address), length)
            .unwrap_or_default()
    }

    /// Overwrites memory, flash too, as a debugger or a stray particle would.
    pub fn set_memory(&mut self, address: u32, bytes: &[u8]) {
        let _ = self.unicorn.mem_write(u64::from(address), bytes);
    }

    /// Switches the chip on: RAM is without a meaning.
    pub fn power_on(&mut self, cause: ResetCause) {
        self.set_memory(RAM, &vec![UNTOUCHED; RAM_BYTES]);
        self.reset(cause);
    }

    /// Resets; flash, RAM and the world around stay as they are.
    pub fn reset(&mut self, cause: ResetCause) {
        self.resets.push((self.chip().core.now, cause));
        self.chip_mut().reset(cause);
        self.asleep = None;
        self.locked = false;
        let (stack, start) = (self.word(flash::BASE), self.word(flash::BASE + 4));
        for register in exception::GENERAL {
            self.set_register(register, 0xdead_beef);
        }
        for mask in [
            RegisterARM::PRIMASK,
            RegisterARM::BASEPRI,
            RegisterARM::FAULTMASK,
            RegisterARM::CONTROL,
        ] {
            self.set_register(mask, 0);
        }
        self.set_register(RegisterARM::XPSR, 1 << 24);
        self.set_register(RegisterARM::SP, stack);
        self.set_register(RegisterARM::LR, 0xffff_ffff);
        self.set_register(RegisterARM::PC, start | 1);
    }

    /// Runs until a time.
    ///
    /// # Errors
    /// Why it ended before.
    pub fn run_until(&mut self, until: u64) -> Result<(), Halt> {
        while self.chip().core.now < until {
            self.slice(until)?;
        }
        Ok(())
    }

    fn slice(&mut self, until: u64) -> Result<(), Halt> {
        self.apply_flash_changes()?;
        self.chip_mut().advance();
        if let Some(cause) = self.chip_mut().reset_request.take() {
            self.reset(cause);
            return Ok(());
        }
        let chip = self.chip_mut();
        let next = chip.next_event().min(until);
        if chip.flash.busy_until() > chip.core.now {
            // Fetches from the bank that is written wait, and so does everything else.
            chip.core.now = next.min(chip.flash.busy_until());
            return Ok(());
        }
        if self.locked {
            let chip = self.chip_mut();
            let next = chip.next_event().min(until);
            chip.core.now = next.max(chip.core.now + 1);
            return Ok(());
        }
        self.deliver();
        if let Some(sleep) = self.asleep {
            let chip = self.chip_mut();
            let wakes = match sleep {
                Stop::WaitEvent => std::mem::take(&mut chip.core.event),
                _ => chip.nvic.any_pending(),
            };
            if !wakes {
                let next = chip.next_event().min(until);
                chip.core.now = next.max(chip.core.now + 1);
                return Ok(());
            }
            self.asleep = None;
        }
        self.execute(until)
    }

    fn execute(&mut self, until: u64) -> Result<(), Halt> {
        let chip = self.chip_mut();
        chip.core.interrupted = false;
        chip.core.limit = chip.next_event().min(until);
        chip.core.stop = Stop::Slice;
        let start = u64::from(self.register(RegisterARM::PC) | 1);
        let ended = self.unicorn.emu_start(start, NEVER >> 1, 0, 0);
        let pc = self.register(RegisterARM::PC);
        // Unicorn does not fetch from there, but raises an exception of its own.
        if pc & 0xffff_ff80 == 0xffff_ff80 {
            return self.leave(pc | 1);
        }
        if let Err(error) = ended {
            return self.fault(pc, &format!("{error:?}"));
        }
        match self.chip().core.stop {
            Stop::Slice => Ok(()),
            stop @ (Stop::WaitEvent | Stop::WaitInterrupt) => {
                self.set_register(RegisterARM::PC, (pc + 2) | 1);
                self.asleep = Some(stop);
                Ok(())
            }
            Stop::Unsupported => Err(Halt::Unsupported(format!("the instruction at 0x{pc:08x}"))),
        }
    }

    /// What was programmed and erased, done to the memory.
    fn apply_flash_changes(&mut self) -> Result<(), Halt> {
        for (address, before) in std::mem::take(&mut self.chip_mut().flash.stores) {
            self.set_memory(address, &before.to_le_bytes());
        }
        if self.chip().flash.changes.is_empty() {
            return Ok(());
        }
        let flash = &mut self.chip_mut().flash;
        let changes = std::mem::take(&mut flash.changes);
        let cut = flash.cut_at.is_some_and(|at| flash.count > at);
        for change in changes {
            match change {
                Change::Program(address, bytes) => {
                    let before = self.memory(address, 8);
                    // The error correction forbids to program twice, but for zeros.
                    if before.iter().any(|byte| *byte != 0xff) && bytes != [0; 8] {
                        self.chip_mut().flash.refuse();
                    } else if cut {
                        // Cut in the middle: some bits have fallen, and the check bits are wrong.
                        let torn: Vec<u8> = bytes.iter().map(|byte| byte | 0xa4).collect();
                        self.set_memory(address, &torn);
                    } else {
                        self.set_memory(address, &bytes);
                    }
                }
                Change::Erase(address) => {
                    let length = if cut { flash::PAGE / 2 } else { flash::PAGE };
                    self.set_memory(address, &vec![0xff; length as usize]);
                }
            }
        }
        if cut { Err(Halt::PowerCut) } else { Ok(()) }
    }
}

fn on_instruction(uc: &mut Unicorn<'_, Chip>, address: u64, size: u32) {
    let address = address as u32;
    let core: &mut Core = &mut uc.get_data_mut().core;
    let Some(info) = core.known(address) else {
        learn(uc, address);
        return on_instruction(uc, u64::from(address), size);
    };
    let stops = if core.may_be_watched(address) {
        let link = uc.reg_read(RegisterARM::LR).unwrap_or(0) as u32;
        let core = &mut uc.get_data_mut().core;
        core.watch_at(address, link);
        core.step(address, size, info)
    } else {
        core.step(address, size, info)
    };
    if stops {
        let _ = uc.emu_stop();
    }
}

/// Decodes an instruction that is met for the first time.
#[cold]
fn learn(uc: &mut Unicorn<'_, Chip>, address: u32) {
    let mut bytes = [0; 20];
    let _ = uc.mem_read(u64::from(address), &mut bytes);
    let half = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
    let halves: Vec<u16> = (0..20).step_by(2).map(half).collect();
    let second = if is_wide(halves[0]) { halves[1] } else { 0 };
    let info = with_block(decode(halves[0], second), &halves[1..]);
    uc.get_data_mut().core.learn(address, info);
}

impl Machine {
    /// Puts the thread's stack at its end: what comes next overflows it. While the thread runs or sleeps: a handler whose stack is
    /// moved would return to wherever the words there lead, which no overflow does.
    ///
    /// # Errors
    /// The thread does not run within 50 ms.
    pub fn exhaust_stack(&mut self) -> Result<(), String> {
        self.run_to(None)?;
        self.set_register(RegisterARM::SP, RAM + 8);
        Ok(())
    }

    /// Stops the processor for good, and tells what the chip has for that: the break of TIM1, where the program asked for it.
    pub(crate) fn lock_up(&mut self, what: String) {
        self.locked = true;
        let chip = self.chip_mut();
        chip.faults.push(format!("lockup: {what}"));
        chip.lock_up();
    }

    /// Runs until the handler of an exception runs (the thread for `None`), and lets it go on at another address.
    ///
    /// # Errors
    /// It does not run within 50 ms.
    pub fn divert(&mut self, exception: Option<usize>, address: u32) -> Result<(), String> {
        self.run_to(exception)?;
        self.asleep = None;
        self.set_register(RegisterARM::PC, address | 1);
        Ok(())
    }

    /// Masks a priority and all below it, as a thread does that shares their state, and forgets to end it.
    ///
    /// # Errors
    /// The thread does not run within 50 ms.
    pub fn mask(&mut self, priority: u32) -> Result<(), String> {
        self.run_to(None)?;
        self.set_register(RegisterARM::BASEPRI, priority);
        Ok(())
    }

    /// Ends that.
    pub fn unmask(&mut self) {
        self.set_register(RegisterARM::BASEPRI, 0);
    }

    /// Runs until the handler of an exception runs, or the thread.
    ///
    /// # Errors
    /// It does not run within 50 ms.
    pub fn run_to(&mut self, exception: Option<usize>) -> Result<(), String> {
        let end = self.chip().core.now + 50_000 * 170;
        while self.chip().core.now < end {
            let here = self.chip().running.last().map(|running| running.exception);
            if here == exception {
                return Ok(());
            }
            // In steps that are shorter than any handler.
            let next = self.chip().core.now + 20;
            self.run_until(next).map_err(|halt| format!("{halt:?}"))?;
        }
        Err(format!("exception {exception:?} did not run"))
    }
}
