//! Checks a board's compiled firmware: it fits flash and RAM, and its interrupts have no panics, floats, critical sections or calls
//! to an unknown target.

use std::path::Path;

use crate::answer::Answer;
use crate::cortex::{Depths, ProgramCode, is_panic, is_soft_float, word};

/// Sizes of flash and memory of a board's chip.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Room {
    /// Flash memory for the program in bytes, without the flash pages that store settings.
    flash: u32,
    /// RAM for variables and stack in bytes, without the part that holds the code of the interrupts.
    memory: u32,
}

/// Sizes of flash and RAM for each chip. The name of a board contains that of its chip.
const ROOMS: [(&str, Room); 2] = [("g474re", room(240, 96)), ("g431", room(112, 32))];

const fn room(flash_kib: u32, memory_kib: u32) -> Room {
    Room {
        flash: flash_kib * 1024,
        memory: memory_kib * 1024,
    }
}

/// Size in bytes of the crash record, which is at the end of RAM.
const CRASH: u32 = 64;
/// Address of the first byte of flash memory.
const FLASH_START: u32 = 0x0800_0000;
const MEMORY_START: u32 = 0x2000_0000;
/// Bytes that an exception puts on the stack: frame with the registers of the float unit, and up to 4 bytes of alignment.
const EXCEPTION_FRAME: u32 = 26 * 4 + 4;

/// The firmware's own interrupt handlers, from the highest priority to the lowest; handlers in one inner list have equal priority.
const PRIORITIES: [&[&str]; 3] = [&["ADC1_2"], &["TIM1_BRK_TIM15", "PVD_PVM"], &["LPTIM1"]];

/// Names of functions of a memory allocator, which firmware must not contain.
const HEAP: [&str; 4] = [
    "__rust_alloc",
    "__rust_realloc",
    "__rg_alloc",
    "alloc_error_handler",
];

/// Measured sizes and problems of a program.
#[derive(Debug, Default)]
struct Report {
    /// Available flash and RAM of the chip.
    room: Room,
    /// Bytes of code and constants.
    text: u32,
    /// Bytes of variables with an initial value, which are in flash and RAM.
    data: u32,
    /// Bytes of variables without a stored initial value, which are in RAM only.
    bss: u32,
    /// Largest depth of the stack in bytes, as computed from the program.
    stack: u32,
    /// Bytes of RAM reserved for the stack.
    stack_room: u32,
    /// Descriptions of the problems found in the program.
    wrong: Vec<String>,
}

impl Report {
    /// The sizes as one line of text.
    fn line(&self) -> String {
        let Self {
            text,
            data,
            bss,
            stack,
            stack_room,
            room: Room { flash, memory },
            ..
        } = self;
        format!(
            "flash {} of {flash} bytes (text {text}, data {data}); memory {} of {memory} (data {data}, bss {bss}, stack \
             {stack_room}); worst-case stack {stack}",
            text + data,
            data + bss + stack_room,
        )
    }
}

/// Checks the program of each board, given as `BOARD=ELF`, and prints sizes and problems.
pub fn inspect(programs: &[&str]) -> Result<Answer, String> {
    let (mut lines, mut wrong) = (Vec::new(), Vec::new());
    for named in programs {
        let (board, path) = named
            .split_once('=')
            .ok_or_else(|| format!("`{named}` is not BOARD=ELF"))?;
        let room = ROOMS.iter().find(|(chip, _)| board.contains(chip));
        let (_, room) = room.ok_or_else(|| format!("no chip is known for the board `{board}`"))?;
        let program = ProgramCode::open(Path::new(path))?;
        println!("{board}:");
        let mut report = examine(&program, *room);
        // `touchstone flash` reads this symbol to refuse firmware of another board.
        let mark = format!("touchstone_board_{}", board.replace('-', "_"));
        if program.symbol(&mark).is_none() {
            report.wrong.push(format!("no symbol {mark} is in it"));
        }
        lines.push(format!("{board}: {}", report.line()));
        wrong.extend(report.wrong.iter().map(|what| format!("{board}: {what}")));
    }
    println!("\n{}", lines.join("\n"));
    for what in &wrong {
        println!("WRONG: {what}");
    }
    Ok(match wrong.first() {
        None => Answer::Right(
            "budgets kept; no panic, heap, float or unknown call in the interrupts".into(),
        ),
        Some(first) => Answer::Wrong(format!("{} wrong, the first: {first}", wrong.len())),
    })
}

fn examine(program: &ProgramCode, room: Room) -> Report {
    let mut report = Report {
        room,
        ..Report::default()
    };
    sizes(program, &mut report);
    for handler in PRIORITIES.iter().flat_map(|row| row.iter()) {
        interrupt(program, handler, &mut report.wrong);
    }
    let named = |name: &str| HEAP.iter().any(|heap| name.contains(heap));
    report.wrong.extend(
        program
            .names()
            .filter(|name| named(name))
            .map(|name| format!("a heap: {name}")),
    );
    let float = |name: &str| is_soft_float(name);
    report.wrong.extend(
        program
            .names()
            .filter(|name| float(name))
            .map(|name| format!("a float: {name}")),
    );
    // The drivers' handlers do mask interrupts. If the check finds no masking there, it would also miss masking in other handlers.
    let mut masking = drivers(program).filter_map(|address| program.reach_from(address));
    if !masking.any(|reach| !reach.masks.is_empty()) {
        report
            .wrong
            .push("no critical section was found anywhere: the check is blind".into());
    }
    stack(program, &mut report);
    report
}

fn sizes(program: &ProgramCode, report: &mut Report) {
    for part in &program.parts {
        let is_variable = part.address >= MEMORY_START;
        match (is_variable, part.content.is_empty()) {
            (false, _) => report.text += part.size,
            (true, false) => report.data += part.size,
            (true, true) => report.bss += part.size,
        }
    }
    let symbol = |name| program.symbol(name).unwrap_or(0);
    report.stack_room = symbol("_stack_start").saturating_sub(symbol("_stack_end"));
    let Room { flash, memory } = report.room;
    let used = report.data + report.bss + report.stack_room;
    // The linker uses its memory map, so the map must cover exactly this chip's memory.
    let settings = symbol("_settings_start");
    let crash = symbol("_crash_record");
    for (what, bytes, most) in [
        ("flash", report.text + report.data, flash),
        ("memory", used, memory),
    ] {
        if bytes > most {
            let more = format!("{bytes} bytes of {what} are more than {most}");
            report.wrong.push(more);
        }
    }
    for (what, end, right) in [
        ("settings begin", settings, FLASH_START + flash),
        (
            "the crash record ends",
            crash + CRASH,
            MEMORY_START + memory,
        ),
    ] {
        if end != right {
            let wrong = format!("{what} at 0x{end:08x}, by the chip at 0x{right:08x}");
            report.wrong.push(wrong);
        }
    }
}

/// Searches an interrupt handler and all functions that it calls for panics, floats, critical sections, traps and calls to an
/// unknown target. Adds each to `wrong`.
fn interrupt(program: &ProgramCode, handler: &str, wrong: &mut Vec<String>) {
    let Some(reach) = program
        .address(handler)
        .and_then(|address| program.reach_from(address))
    else {
        wrong.push(format!("{handler} is not in the program"));
        return;
    };
    println!(
        "  {handler:<16}{:>7} bytes,{:>6} instructions in {:>3} functions",
        reach.bytes,
        reach.instructions,
        reach.functions.len()
    );
    let mut list = |what: &str, places: Vec<String>| {
        wrong.extend(
            places
                .into_iter()
                .map(|place| format!("{handler} reaches {what}: {place}")),
        );
    };
    let named = |is_bad: &dyn Fn(&str) -> bool| -> Vec<String> {
        reach
            .functions
            .iter()
            .filter(|name| is_bad(name))
            .cloned()
            .collect()
    };
    list(
        "a panic",
        named(&|name| is_panic(name) || name.contains("rust_begin_unwind")),
    );
    list("a float", named(&is_soft_float));
    list("a critical section", reach.masks.clone());
    list("a trap", reach.traps.clone());
    list("the float unit", reach.float_unit.clone());
    list("a call to where?", reach.unknown.clone());
}

/// Part of the mangled name of the firmware's start-up function, which returns before the firmware's own interrupts are enabled.
const START: &str = "touchstone_firmware3run5start";

/// Computes the largest depth of the stack: that of the main thread plus one interrupt handler per priority, each with an exception
/// frame. During start-up only the drivers' interrupts can occur.
fn stack(program: &ProgramCode, report: &mut Report) {
    let mut depths = Depths::new(program);
    let Some(reset) = program.address("Reset") else {
        report.wrong.push("the program has no `Reset`".into());
        return;
    };
    // Number of nested calls through registers. Main thread: two, because the executor calls a task, and the task calls a waker or
    // a formatter. A driver's handler: one, because it calls a waker.
    let starting = depths.nested(reset, 2);
    let starting_path = depths.path(reset, 2);
    depths.leave_out(START);
    let thread = depths.nested(reset, 2);
    let drivers = drivers(program)
        .map(|address| depths.nested(address, 1) + EXCEPTION_FRAME)
        .max()
        .unwrap_or(0);
    let mut levels = vec![("thread", thread), ("drivers", drivers)];
    for row in PRIORITIES.iter().rev() {
        let addresses = row.iter().filter_map(|name| program.address(name));
        let deepest = addresses.map(|address| depths.nested(address, 0)).max();
        levels.push((row[0], deepest.unwrap_or(0) + EXCEPTION_FRAME));
    }
    let shown: Vec<String> = levels
        .iter()
        .map(|(name, bytes)| format!("{name} {bytes}"))
        .collect();
    println!(
        "  stack: start {}; then {}",
        starting + drivers,
        shown.join(", ")
    );
    let running: u32 = levels.iter().map(|(_, bytes)| bytes).sum();
    report.stack = running.max(starting + drivers);
    for what in &depths.unbounded {
        println!("  stack, not bounded: {what}");
        report.wrong.push(format!("the stack has no bound: {what}"));
    }
    if report.stack > report.stack_room {
        for (bytes, name) in starting_path.iter().chain(&depths.path(reset, 2)) {
            println!("    {bytes:>6} {name}");
        }
        report.wrong.push(format!(
            "the stack may need {} bytes and has {}",
            report.stack, report.stack_room
        ));
    }
}

/// Addresses of the drivers' handlers, all of priority 6: entries of the vector table that are neither the processor's nor the
/// firmware's own.
fn drivers(program: &ProgramCode) -> impl Iterator<Item = u32> {
    const PROCESSOR: [&str; 4] = ["DefaultHandler", "HardFault", "NonMaskableInt", "Reset"];
    let is_ours = |name: &str| PRIORITIES.iter().any(|row| row.contains(&name));
    handlers(program).into_iter().filter(move |address| {
        program.function_name(*address).is_some_and(|name| {
            !is_ours(name) && !PROCESSOR.iter().any(|other| name.contains(other))
        })
    })
}

/// Addresses of all handlers in the vector table, each once.
fn handlers(program: &ProgramCode) -> Vec<u32> {
    let table = program
        .parts
        .iter()
        .find(|part| part.name == ".vector_table");
    let content = table.map_or(&[][..], |table| &table.content);
    let mut addresses: Vec<u32> = (4..content.len())
        .step_by(4)
        .filter_map(|at| word(content, at))
        .filter(|entry| entry & 1 == 1)
        .map(|entry| entry & !1)
        .collect();
    addresses.sort_unstable();
    addresses.dedup();
    addresses
}
