//! The machine: Unicorn with the emulated chip, the access to registers and memory, and power-on and reset.

use unicorn_engine::unicorn_const::{Arch, MemType, Mode, Prot, uc_error};
use unicorn_engine::{ArmCpuModel, HookType, RegisterARM, Unicorn};

use crate::chip::{Chip, ResetCause};
use crate::cpu::core::{Core, Stop};
use crate::cpu::decode::{decode, is_wide, reads_literal, with_block};
use crate::cpu::elf::Program;
use crate::cpu::{CCM, RAM};
use crate::peripheral::flash;

/// The registers R0 to R12.
const GENERAL: [RegisterARM; 13] = [
    RegisterARM::R0,
    RegisterARM::R1,
    RegisterARM::R2,
    RegisterARM::R3,
    RegisterARM::R4,
    RegisterARM::R5,
    RegisterARM::R6,
    RegisterARM::R7,
    RegisterARM::R8,
    RegisterARM::R9,
    RegisterARM::R10,
    RegisterARM::R11,
    RegisterARM::R12,
];

/// Size in bytes of the memory blocks whose access rights Unicorn can change.
const BLOCK: u64 = 4_096;

/// Value of each RAM byte after power-on. It shows which bytes of the stack were never written.
const UNTOUCHED: u8 = 0xa5;

/// Why a run ended before the requested time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Halt {
    /// The program returned from an exception that was not running. Either the emulator has a defect, or the program has corrupted
    /// its stack.
    BadReturn(String),
    /// The power was cut at a change of the flash, as a test had requested.
    PowerCut,
    /// The program used a feature of the chip that the emulator does not model.
    Unsupported(String),
}

/// The emulated chip with its processor.
pub struct Machine {
    pub(super) unicorn: Unicorn<'static, Chip>,
    pub(super) asleep: Option<Stop>,
    /// Whether the processor is in lockup: a fault that it could not handle has stopped it until the next reset.
    pub(super) locked: bool,
    behind_program: u32,
    /// Time in processor cycles and cause of each reset since power-on.
    pub resets: Vec<(u64, ResetCause)>,
}

/// Converts an error of Unicorn to a text that begins with `what`.
fn said(what: &str) -> impl Fn(uc_error) -> String {
    let what = what.to_owned();
    move |error| format!("Unicorn, {what}: {error:?}")
}

impl Machine {
    /// Creates a machine with a program in its flash. Its power is still off.
    ///
    /// # Errors
    /// Unicorn refuses the memory map, or a segment of the program lies outside flash.
    pub fn new(chip: Chip, program: &Program) -> Result<Self, String> {
        let flash_bytes = chip.board.flash_bytes;
        let memories = [(RAM, chip.board.ram_bytes), (CCM, chip.board.ccm_bytes)];
        let mut unicorn = Unicorn::new_with_data(Arch::ARM, Mode::THUMB | Mode::MCLASS, chip)
            .map_err(said("open"))?;
        unicorn
            .ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32)
            .map_err(said("model"))?;
        let map = said("map");
        unicorn
            .mem_map(
                u64::from(flash::BASE),
                flash_bytes as u64,
                Prot::READ | Prot::EXEC,
            )
            .map_err(&map)?;
        for (base, bytes) in memories.into_iter().filter(|(_, bytes)| *bytes > 0) {
            unicorn
                .mem_map(u64::from(base), bytes as u64, Prot::ALL)
                .map_err(&map)?;
        }
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
            move |uc: &mut Unicorn<'_, Chip>, _: MemType, address: u64, size: usize, value: i64| {
                let is_flash = (u64::from(flash::BASE)
                    ..u64::from(flash::BASE) + flash_bytes as u64)
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
        let on_torn = |uc: &mut Unicorn<'_, Chip>, _: MemType, address: u64, _: usize, _: i64| {
            let block = address & !(BLOCK - 1);
            let torn = &uc.get_data().flash.torn;
            let here = torn.range(block as u32..).next().copied();
            if let Some(place) = here.filter(|place| u64::from(*place) < block + BLOCK) {
                uc.get_data_mut().read_flash(place);
            }
            // The read instruction continues. It returns the bits that the power cut has left in the flash memory.
            uc.mem_protect(block, BLOCK, Prot::READ | Prot::EXEC)
                .is_ok()
        };
        unicorn
            .add_mem_hook(HookType::MEM_READ_PROT, 1, 0, on_torn)
            .map_err(said("hook"))?;
        unicorn
            .mem_write(u64::from(flash::BASE), &vec![0xff; flash_bytes])
            .map_err(said("flash"))?;
        for (address, content) in &program.segments {
            unicorn
                .mem_write(u64::from(*address), content)
                .map_err(said("a segment outside of flash"))?;
        }
        let ends = program.segments.iter();
        let ends = ends.map(|(address, content)| address + content.len() as u32);
        Ok(Self {
            unicorn,
            asleep: None,
            locked: false,
            behind_program: ends.max().unwrap_or(flash::BASE).next_multiple_of(8),
            resets: Vec::new(),
        })
    }

    /// The emulated chip.
    #[must_use]
    pub fn chip(&self) -> &Chip {
        self.unicorn.get_data()
    }

    /// The emulated chip, mutable.
    pub fn chip_mut(&mut self) -> &mut Chip {
        self.unicorn.get_data_mut()
    }

    pub(super) fn register(&self, register: RegisterARM) -> u32 {
        self.unicorn.reg_read(register).unwrap_or(0) as u32
    }

    pub(super) fn set_register(&mut self, register: RegisterARM, value: u32) {
        // Unicorn fails only for an unknown register.
        let _ = self.unicorn.reg_write(register, u64::from(value));
    }

    /// The 32-bit word at an address; 0 if no memory is mapped at that address.
    #[must_use]
    pub fn word(&self, address: u32) -> u32 {
        let mut bytes = [0; 4];
        let _ = self.unicorn.mem_read(u64::from(address), &mut bytes);
        u32::from_le_bytes(bytes)
    }

    /// `length` bytes of memory from an address on; empty if no memory is mapped there.
    #[must_use]
    pub fn memory(&self, address: u32, length: usize) -> Vec<u8> {
        self.unicorn
            .mem_read_as_vec(u64::from(address), length)
            .unwrap_or_default()
    }

    /// Overwrites memory, including flash, as a debugger or a bit flip would.
    pub fn set_memory(&mut self, address: u32, bytes: &[u8]) {
        let _ = self.unicorn.mem_write(u64::from(address), bytes);
    }

    /// Removes read access from the 4 KiB block around each torn double word of flash, so that its next read is noticed; later ones
    /// are not. A double word is torn if the power was cut while it was written. A hook on every read cannot be used: with such a
    /// hook Unicorn returns wrong values for some reads.
    pub fn guard_torn(&mut self) {
        for place in self.chip().flash.torn.clone() {
            let block = u64::from(place) & !(BLOCK - 1);
            let _ = self.unicorn.mem_protect(block, BLOCK, Prot::NONE);
        }
        // Unicorn would still read a block that it has read before.
        let _ = self.unicorn.ctl_flush_tlb();
    }

    /// Switches the chip's power on. RAM gets a fixed pattern, because its content after power-on is undefined.
    pub fn power_on(&mut self, cause: ResetCause) {
        let board = &self.chip().board;
        for (base, bytes) in [(RAM, board.ram_bytes), (CCM, board.ccm_bytes)] {
            self.set_memory(base, &vec![UNTOUCHED; bytes]);
        }
        self.reset(cause);
    }

    /// Cuts the supply: the processor stops, no pin is driven, and the encoder forgets the last request that it received. The flash
    /// keeps its content.
    pub fn power_off(&mut self) {
        let chip = self.chip_mut();
        chip.reset(ResetCause::PowerOn);
        chip.forget_encoder();
        self.asleep = None;
        self.locked = true;
    }

    /// Resets the chip. Flash, RAM and the simulated motor, knob and hand stay as they are.
    pub fn reset(&mut self, cause: ResetCause) {
        self.resets.push((self.chip().core.now, cause));
        self.chip_mut().reset(cause);
        self.guard_torn();
        self.asleep = None;
        self.locked = false;
        let (stack, start) = (self.word(flash::BASE), self.word(flash::BASE + 4));
        for register in GENERAL {
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

    /// First flash address after the program. From this address on, the program's file leaves the flash blank.
    #[must_use]
    pub fn behind_program(&self) -> u32 {
        self.behind_program
    }

    /// Number of stack bytes from the deepest that was ever written up to `top`. The stack grows down from `top` to the start of
    /// RAM.
    #[must_use]
    pub fn stack_used(&self, top: u32) -> u32 {
        let stack = self.memory(RAM, (top - RAM) as usize);
        let untouched = stack.iter().take_while(|byte| **byte == UNTOUCHED).count();
        top - RAM - untouched as u32
    }

    /// Puts the processor into lockup, and raises the chip's lockup signal. The signal triggers the break input of TIM1 if the
    /// program has enabled that.
    pub(super) fn lock_up(&mut self, what: String) {
        self.locked = true;
        let chip = self.chip_mut();
        chip.faults.push(format!("lockup: {what}"));
        chip.lock_up();
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

/// Decodes an instruction when it is executed for the first time, and stores the result.
#[cold]
fn learn(uc: &mut Unicorn<'_, Chip>, address: u32) {
    let mut bytes = [0; 20];
    let _ = uc.mem_read(u64::from(address), &mut bytes);
    let half = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
    let halves: Vec<u16> = (0..20).step_by(2).map(half).collect();
    let second = if is_wide(halves[0]) { halves[1] } else { 0 };
    let mut info = with_block(decode(halves[0], second), &halves[1..]);
    info.reads_literal = reads_literal(halves[0], second);
    uc.get_data_mut().core.learn(address, info);
}
