//! Compares the register values that the program leaves after its start with those that the manuals require.
//!
//! The tables `registers.tsv` and `pins.tsv` are a second source for the wiring: what each register should hold, and why. They
//! were written from memory of the reference manual (RM0440) and the boards' schematics, not from the firmware. The position of each field,
//! and the number of each pin's alternate function, come from the vendor's description (`vendor.tsv`, written by `vendor.py`).
//!
//! Every register that the program writes must be in the tables, with every bit that the program changes. A register that is not in
//! the tables is an error.

use std::collections::{BTreeMap, BTreeSet};

use super::tally::Tally;
use crate::bench::{Bench, MS, Setup};
use crate::chip::Chip;
use crate::cpu::elf::Program;

const REGISTERS: &str = include_str!("../../registers/registers.tsv");
const PINS: &str = include_str!("../../registers/pins.tsv");
const VENDOR: &str = include_str!("../../registers/vendor.tsv");

const PORTS: std::ops::Range<u32> = 0x4800_0000..0x4800_1c00;

/// Checks the chip's registers against the tables `registers.tsv` and `pins.tsv`.
pub fn registers(program: &Program, setup: &Setup, tally: &mut Tally) {
    tally.check("registers after the start", compared(program, setup));
}

fn compared(program: &Program, setup: &Setup) -> Result<String, String> {
    let mut bench = Bench::new(program, setup)?;
    bench.boot()?;
    bench.run(20 * MS)?;
    let mut fresh = Bench::new(program, setup)?;
    let vendor = Vendor::of(setup.board.name);
    let written = bench.machine.chip().written.clone();
    let (chip, at_reset) = (bench.machine.chip_mut(), fresh.machine.chip_mut());

    let mut wrong = Vec::new();
    let mut seen = BTreeMap::<u32, u32>::new();
    let mut fields = 0;
    for row in lines(REGISTERS) {
        let [on, register, settings, why] = row[..] else {
            return Err(format!("registers.tsv: {row:?}"));
        };
        if on != "all" && !on.split(' ').any(|on| on == setup.board.name) {
            continue;
        }
        let address = vendor.address(register)?;
        let is = chip.peek(address);
        let covered = seen.entry(address).or_default();
        for setting in settings.split(' ') {
            let Some((field, wanted)) = setting.split_once('=') else {
                *covered = u32::MAX;
                continue;
            };
            let mask = vendor.mask(register, field)?;
            *covered |= mask;
            if wanted == "*" {
                continue;
            }
            fields += 1;
            let wanted = number(wanted)?;
            let found = (is & mask) >> mask.trailing_zeros();
            if found != wanted {
                wrong.push(format!(
                    "{register}.{field}: {found:#x} instead of {wanted:#x} ({why})"
                ));
            }
        }
    }
    for address in written.iter().filter(|at| !PORTS.contains(*at)) {
        let name = vendor.name(*address);
        let Some(covered) = seen.get(address) else {
            wrong.push(format!("{name}: written, and in no table"));
            continue;
        };
        let changed = (chip.peek(*address) ^ at_reset.peek(*address)) & !covered;
        if changed != 0 {
            wrong.push(format!(
                "{name}: changed in {changed:#x}, which no table has"
            ));
        }
    }
    let pins = pins(chip, at_reset, &vendor, setup.board.name, &mut wrong)?;
    match wrong.as_slice() {
        [] => Ok(format!(
            "{} registers with {fields} fields and {pins} pins as the manuals want them; no other was written",
            seen.len()
        )),
        _ => Err(wrong.join("; ")),
    }
}

/// Checks the pins in use against the table, and all other pins against their state after a reset. Returns the number of pins in
/// use.
fn pins(
    chip: &mut Chip,
    at_reset: &mut Chip,
    vendor: &Vendor,
    board: &str,
    wrong: &mut Vec<String>,
) -> Result<usize, String> {
    let mut used = BTreeSet::new();
    for row in lines(PINS) {
        let [on, pin, signal, mode, speed, pull, why] = row[..] else {
            return Err(format!("pins.tsv: {row:?}"));
        };
        if !on.split(' ').any(|on| on == board) {
            continue;
        }
        let at = Pin::named(pin)?;
        used.insert(at);
        let mut expect = |what: &str, is: u32, wanted: u32| {
            if is != wanted {
                wrong.push(format!(
                    "{signal} at {pin}: {what} {is} instead of {wanted} ({why})"
                ));
            }
        };
        let wanted = ["input", "output", "function", "analogue"];
        let wanted = wanted.iter().position(|name| *name == mode);
        let wanted = wanted.ok_or(format!("{pin}: no mode {mode}"))?;
        expect("mode", at.mode(chip), wanted as u32);
        if mode == "function" {
            let function = vendor.function(pin, signal)?;
            expect("function", at.function(chip), function);
        }
        if speed != "*" {
            expect("speed", at.field(chip, 0x08), number(speed)?);
        }
        if let Some(wanted) = ["none", "up", "down"].iter().position(|name| *name == pull) {
            expect("pull", at.field(chip, 0x0c), wanted as u32);
        }
        expect(
            "open drain",
            chip.peek(at.base() + 0x04) >> at.number & 1,
            0,
        );
    }
    for port in 0..7 {
        for pin in (0..16).map(|number| Pin { port, number }) {
            let (is, was) = (pin.mode(chip), pin.mode(at_reset));
            if is != was && !used.contains(&pin) {
                wrong.push(format!(
                    "P{}{}: mode {is} instead of {was}, and in no table",
                    char::from(b'A' + port as u8),
                    pin.number
                ));
            }
        }
    }
    Ok(used.len())
}

/// A pin of the chip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Pin {
    port: u32,
    number: u32,
}

impl Pin {
    /// Parses a pin's name, for example `PA8`.
    fn named(name: &str) -> Result<Self, String> {
        let port = name.as_bytes().get(1);
        let port = port.map(|letter| u32::from(letter - b'A'));
        let number = name.get(2..).and_then(|digits| digits.parse().ok());
        let pin = port.zip(number).map(|(port, number)| Self { port, number });
        pin.ok_or(format!("{name} is no pin"))
    }

    fn base(self) -> u32 {
        PORTS.start + 0x400 * self.port
    }

    fn field(self, chip: &mut Chip, register: u32) -> u32 {
        chip.peek(self.base() + register) >> (2 * self.number) & 3
    }

    fn mode(self, chip: &mut Chip) -> u32 {
        self.field(chip, 0)
    }

    fn function(self, chip: &mut Chip) -> u32 {
        chip.peek(self.base() + 0x20 + 4 * (self.number / 8)) >> (4 * (self.number % 8)) & 15
    }
}

/// Numbers from the vendor's description. The key is (register or pin, field or signal, possibly empty); the value is an address, a
/// mask or the number of an alternate function.
struct Vendor(BTreeMap<(&'static str, &'static str), u32>);

impl Vendor {
    fn of(board: &str) -> Self {
        let rows = lines(VENDOR).filter(|row| row[0] == board);
        let known = rows.filter_map(|row| Some(((row[1], row[2]), number(row[3]).ok()?)));
        Self(known.collect())
    }

    fn get(&self, name: &str, part: &str) -> Result<u32, String> {
        let found = self.0.get(&(name, part)).copied();
        found.ok_or(format!("vendor.tsv has no {name} {part}: run vendor.py"))
    }

    fn address(&self, register: &str) -> Result<u32, String> {
        self.get(register, "")
    }

    /// Mask of a register's field. Without a name of a field, it covers the whole register.
    fn mask(&self, register: &str, field: &str) -> Result<u32, String> {
        match field {
            "" => Ok(u32::MAX),
            _ => self.get(register, field),
        }
    }

    fn function(&self, pin: &str, signal: &str) -> Result<u32, String> {
        self.get(pin, signal)
    }

    fn name(&self, address: u32) -> String {
        let found = self
            .0
            .iter()
            .find(|((_, part), at)| part.is_empty() && **at == address);
        found.map_or(format!("{address:#010x}"), |((name, _), _)| {
            (*name).to_owned()
        })
    }
}

fn lines(text: &'static str) -> impl Iterator<Item = Vec<&'static str>> {
    text.lines().map(|line| line.split('\t').collect())
}

fn number(text: &str) -> Result<u32, String> {
    let parsed = match text.strip_prefix("0x") {
        Some(digits) => u32::from_str_radix(digits, 16),
        None => text.parse(),
    };
    parsed.map_err(|why| format!("{text}: {why}"))
}
