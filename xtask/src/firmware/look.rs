//! What a board's program must be: small enough, and its interrupts free of panics, floats, critical sections and calls that
//! lead nobody knows where.

use crate::thumb::elf::{Program, word};
use crate::thumb::stack::Depths;
use crate::thumb::{is_panic, is_soft_float};

/// Most flash for the program, bytes.
const FLASH: u32 = 96 * 1024;
/// Most memory, the stack included, bytes.
const MEMORY: u32 = 24 * 1024;
/// An exception's frame with the float unit's registers, and its alignment, bytes.
const EXCEPTION_FRAME: u32 = 26 * 4 + 4;

/// The interrupts that do the work, from the highest priority down: those of a row have the same.
const PRIORITIES: [&[&str]; 3] = [&["ADC1_2"], &["TIM1_BRK_TIM15", "PVD_PVM"], &["LPTIM1"]];

/// Names of an allocator's functions.
const HEAP: [&str; 4] = [
    "__rust_alloc",
    "__rust_realloc",
    "__rg_alloc",
    "alloc_error_handler",
];
/// Names of what an interrupt of these priorities must not enter.
const CRITICAL: [&str; 2] = [
    "_critical_section_1_0_acquire",
    "_critical_section_1_0_release",
];

/// What was found out about a program.
#[derive(Debug, Default)]
pub struct Report {
    /// Bytes of code and constants.
    pub text: u32,
    /// Bytes of variables with a value.
    pub data: u32,
    /// Bytes of all other variables.
    pub bss: u32,
    /// Bytes that the stack may need.
    pub stack: u32,
    /// Bytes that the stack has.
    pub stack_room: u32,
    /// What is not as it must be.
    pub wrong: Vec<String>,
}

impl Report {
    /// One line for people.
    pub fn line(&self) -> String {
        let Self {
            text,
            data,
            bss,
            stack,
            stack_room,
            ..
        } = self;
        format!(
            "flash {} of {FLASH} bytes (text {text}, data {data}); memory {} of {MEMORY} (data {data}, bss {bss}, stack \
             {stack_room}); worst-case stack {stack}",
            text + data,
            data + bss + stack_room,
        )
    }
}

/// Looks at a program.
pub fn look(program: &Program) -> Report {
    let mut report = Report::default();
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
    stack(program, &mut report);
    report
}

fn sizes(program: &Program, report: &mut Report) {
    for part in &program.parts {
        let is_variable = part.address >= 0x2000_0000;
        match (is_variable, part.content.is_empty()) {
            (false, _) => report.text += part.size,
            (true, false) => report.data += part.size,
            (true, true) => report.bss += part.size,
        }
    }
    let symbol = |name| program.symbol(name).unwrap_or(0);
    report.stack_room = symbol("_stack_start").saturating_sub(symbol("_stack_end"));
    if report.text + report.data > FLASH {
        report.wrong.push(format!(
            "{} bytes of flash are more than {FLASH}",
            report.text + report.data
        ));
    }
    let memory = report.data + report.bss + report.stack_room;
    if memory > MEMORY {
        report
            .wrong
            .push(format!("{memory} bytes of memory are more than {MEMORY}"));
    }
}

/// What an interrupt reaches.
fn interrupt(program: &Program, handler: &str, wrong: &mut Vec<String>) {
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
    list(
        "a critical section",
        named(&|name| CRITICAL.contains(&name)),
    );
    list("a trap", reach.traps.clone());
    list("the float unit", reach.float_unit.clone());
    list("a call to where?", reach.unknown.clone());
}

/// The stack: what the thread needs, and on top of it one handler of each priority, each with an exception's frame.
fn stack(program: &Program, report: &mut Report) {
    let mut depths = Depths::new(program);
    let Some(reset) = program.address("Reset") else {
        report.wrong.push("the program has no `Reset`".into());
        return;
    };
    // The executor calls a task, a task its wakers or a formatter: two calls through registers inside each other.
    let thread = depths.nested(reset, 2);
    let mut levels = vec![("thread", thread)];
    let working: Vec<&str> = PRIORITIES
        .iter()
        .flat_map(|row| row.iter().copied())
        .collect();
    // All other handlers have priority 6, below the three: drivers, which may wake tasks.
    let mut drivers = 0;
    for address in handlers(program) {
        let is_driver = program.function_name(address).is_some_and(|name| {
            !working.contains(&name)
                && !["DefaultHandler", "HardFault", "NonMaskableInt", "Reset"]
                    .iter()
                    .any(|other| name.contains(other))
        });
        if is_driver {
            drivers = drivers.max(depths.nested(address, 1));
        }
    }
    levels.push(("drivers", drivers + EXCEPTION_FRAME));
    for row in PRIORITIES.iter().rev() {
        let deepest = row
            .iter()
            .filter_map(|name| Some(depths.nested(program.address(name)?, 0)))
            .max()
            .unwrap_or(0);
        levels.push((row[0], deepest + EXCEPTION_FRAME));
    }
    let shown: Vec<String> = levels
        .iter()
        .map(|(name, bytes)| format!("{name} {bytes}"))
        .collect();
    println!("  stack: {}", shown.join(", "));
    report.stack = levels.iter().map(|(_, bytes)| bytes).sum();
    for what in &depths.unbounded {
        println!("  stack, not bounded: {what}");
    }
    if report.stack > report.stack_room {
        for address in [reset].into_iter().chain(handlers(program)) {
            let nested = if address == reset { 2 } else { 1 };
            if depths.nested(address, nested) > 400 {
                for (bytes, name) in depths.path(address, nested) {
                    println!("    {bytes:>6} {name}");
                }
                println!();
            }
        }
        report.wrong.push(format!(
            "the stack may need {} bytes and has {}",
            report.stack, report.stack_room
        ));
    }
}

/// The handlers that the vector table names.
fn handlers(program: &Program) -> Vec<u32> {
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
