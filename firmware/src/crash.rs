//! Stops a program that cannot continue: switches the outputs off, writes a record that survives the reset, then resets. The next
//! start reads that record.

use core::panic::PanicInfo;
use core::ptr::{addr_of_mut, read_volatile, write_volatile};
use core::sync::atomic::Ordering::Relaxed;

use cortex_m::peripheral::{NVIC, SCB};
use cortex_m_rt::{ExceptionFrame, exception};
use embassy_stm32::interrupt;
use embassy_stm32::pac::{FLASH, RCC};
use touchstone_drive::ResetFlags;

use crate::{analogue, pwm, storage};

/// The crash record: sixteen words at the end of RAM, which start-up does not clear. The board's memory map reserves them.
type Record = [u32; 16];

unsafe extern "C" {
    #[link_name = "_crash_record"]
    static mut RECORD: Record;
}

/// Value of the crash record's word `RUNNING` while the program runs. If the next start finds this value, the RAM kept its content.
const RUNNING: u32 = 0x7045_5001;
/// Value of the crash record's word `CRASHED` after a crash. It means that the other words are valid.
const CRASHED: u32 = 0xDEAD_C0DE;

/// Indices of the crash record's words.
mod word {
    pub const RUNNING: usize = 0;
    pub const CRASHED: usize = 1;
    pub const KIND: usize = 2;
    pub const PLACE: usize = 3;
    pub const FILE: usize = 4;
    pub const FILE_LENGTH: usize = 5;
    pub const STATUS: usize = 6;
    pub const SUM: usize = 7;
}

/// Numbers of the kinds of crash: a panic, or one of the processor's exceptions.
const PANIC: u32 = 1;
const FAULT: u32 = 2;
const UNEXPECTED: u32 = 3;

fn write(index: usize, value: u32) {
    // SAFETY: the record is 16 words of memory that nothing else uses, `index` is one of `word`.
    unsafe { write_volatile(addr_of_mut!(RECORD).cast::<u32>().add(index), value) };
}

fn read(index: usize) -> u32 {
    // SAFETY: as for `write`; any bits are a valid `u32`.
    unsafe { read_volatile(addr_of_mut!(RECORD).cast::<u32>().add(index)) }
}

fn sum() -> u32 {
    (word::CRASHED..word::SUM).fold(RUNNING, |sum, index| sum.rotate_left(5) ^ read(index))
}

/// Switches the outputs off, writes the crash record and resets the processor. It must not format text, wait or panic.
fn die(kind: u32, place: u32, file: &'static str, status: u32) -> ! {
    pwm::outputs_off();
    analogue::off();
    write(word::CRASHED, CRASHED);
    write(word::KIND, kind);
    write(word::PLACE, place);
    write(word::FILE, file.as_ptr() as u32);
    write(word::FILE_LENGTH, file.len() as u32);
    write(word::STATUS, status);
    write(word::SUM, sum());
    SCB::sys_reset()
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    pwm::outputs_off();
    match info.location() {
        // The names of source files are constants in flash.
        Some(place) => die(PANIC, place.line(), file_of(place), 0),
        None => die(PANIC, 0, "", 0),
    }
}

/// The file name in a panic's location, with the lifetime of the program.
fn file_of(place: &core::panic::Location<'_>) -> &'static str {
    let file = place.file();
    // SAFETY: `Location`s that panics carry are constants in flash, and so are their texts.
    unsafe { core::mem::transmute::<&str, &'static str>(file) }
}

/// Handles the processor's hard fault as a crash. Its record holds the address at which the processor faulted, and the fault status
/// register.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    pwm::outputs_off();
    // SAFETY: the register is there on every Cortex-M4 and reading it has no effect.
    let status = unsafe { (*SCB::PTR).cfsr.read() };
    die(FAULT, frame.pc(), "", status)
}

/// Handles a flash error: two wrong bits in a double word. While settings are read, the cause is an interrupted write, and the
/// CRC will reject that copy of the settings. At any other time the program is damaged, and this function resets the chip. It
/// also resets the chip if the interrupt has another cause.
#[exception]
unsafe fn NonMaskableInt() {
    let is_flash = FLASH.eccr().read().eccd();
    if !is_flash || !storage::READING.load(Relaxed) {
        pwm::outputs_off();
        die(FAULT, 0, "", 0);
    }
    FLASH.eccr().modify(|w| w.set_eccd(true));
    // The error has also triggered the timer's break (`supply`), and an interrupt stays pending when its flag is cleared (PM0214).
    // Without the last line a save, which reads all pages, would latch a hardware break. A true break cannot be lost: settings are
    // read only while the outputs are off, and a break that is still active sets its flag again.
    pwm::clear_break();
    NVIC::unpend(interrupt::TIM1_BRK_TIM15);
}

/// Handles an enabled interrupt without a handler as a crash: the program has a defect.
#[exception]
unsafe fn DefaultHandler(number: i16) {
    die(UNEXPECTED, number as u32, "", 0)
}

/// Reads the cause of the last reset and the crash record, and marks the record as that of a running program.
pub fn take_reset_flags() -> ResetFlags {
    let flags = RCC.csr().read();
    RCC.csr().modify(|w| w.set_rmvf(true));
    let memory_kept = read(word::RUNNING) == RUNNING;
    let crashed = memory_kept && read(word::CRASHED) == CRASHED && read(word::SUM) == sum();
    if crashed {
        log();
    }
    let panic = crashed.then(|| read(word::PLACE));
    write(word::RUNNING, RUNNING);
    write(word::CRASHED, 0);
    ResetFlags {
        brown_out: flags.borrstf(),
        pin: flags.pinrstf(),
        software: flags.sftrstf(),
        independent_watchdog: flags.iwdgrstf(),
        window_watchdog: flags.wwdgrstf(),
        option_bytes: flags.oblrstf(),
        low_power: flags.lpwrrstf(),
        memory_kept,
        panic,
    }
}

/// Writes the crash record to the debug log, which a debug probe shows.
fn log() {
    let place = read(word::PLACE);
    match read(word::KIND) {
        PANIC => {
            let (start, length) = (read(word::FILE), read(word::FILE_LENGTH));
            defmt::error!(
                "before this reset: a panic in line {=u32} of {=str}",
                place,
                text(start, length)
            );
        }
        FAULT => defmt::error!(
            "before this reset: a fault of the processor at {=u32:#x}, status {=u32:#x}",
            place,
            read(word::STATUS)
        ),
        _ => defmt::error!("before this reset: the unexpected interrupt {=u32}", place),
    }
}

/// The text at this address in flash. Empty if the text does not lie in the program's flash, for example because another program
/// was flashed since.
fn text(start: u32, length: u32) -> &'static str {
    let program = storage::FLASH..storage::FLASH + storage::pages().start;
    let is_inside = program.contains(&start)
        && length <= 200
        && program.contains(&start.saturating_add(length));
    if !is_inside {
        return "";
    }
    // SAFETY: these addresses are flash, which is never written while the program runs, apart from the settings beyond them.
    let bytes = unsafe { core::slice::from_raw_parts(start as *const u8, length as usize) };
    core::str::from_utf8(bytes).unwrap_or("")
}
