//! As much of an ELF file of a Cortex-M as it takes to follow a function through all that it calls.
//!
//! Code and data are told apart by the symbols `$t` and `$d` that the ABI asks for. Calls and jumps with a fixed goal are
//! followed; a call through a register cannot be, and is reported.

use std::collections::{BTreeMap, BTreeSet};

/// A function of the program.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Function {
    name: String,
    size: u32,
}

/// The code of a program.
#[derive(Debug, Default)]
pub struct Program {
    functions: BTreeMap<u32, Function>,
    /// Where data begins in the code (`true`) and where it ends.
    data: BTreeMap<u32, bool>,
    sections: Vec<(u32, Vec<u8>)>,
    /// The sections that take memory on the board, in the file's order.
    pub parts: Vec<Part>,
    /// All symbols that are no functions, by name.
    symbols: BTreeMap<String, u32>,
}

/// A section that takes memory on the board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    pub name: String,
    pub address: u32,
    pub size: u32,
    /// What is in the file; nothing for what start-up clears.
    pub content: Vec<u8>,
    pub is_code: bool,
}

/// What was met on the way from a function through all that it calls.
#[derive(Debug, Default)]
pub struct Reach {
    /// Names of the functions, the first among them.
    pub functions: BTreeSet<String>,
    /// Bytes of all of them, tables of constants included.
    pub bytes: u32,
    /// Instructions.
    pub instructions: usize,
    /// Instructions of the float unit, each as function and address.
    pub float_unit: Vec<String>,
    /// Calls and jumps that lead nobody knows where.
    pub unknown: Vec<String>,
    /// Where interrupts are held off.
    pub masks: Vec<String>,
    /// Traps: where the compiler wants execution to stop.
    pub traps: Vec<String>,
}

/// One instruction, as far as it matters here.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Instruction {
    /// `BL` or `B.W`, with or without a condition, and how far from the address after it.
    Branch(i32),
    /// `BLX` with a register.
    CallRegister,
    /// `BX` with another register than the link register.
    JumpRegister,
    /// Coprocessors 10 and 11.
    FloatUnit,
    /// `UDF`.
    Trap,
    /// Holds interrupts off: `CPSID`, or a write to `PRIMASK`, `BASEPRI` or `FAULTMASK`.
    Mask,
    Other,
}

pub fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

fn half(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?).into())
}

fn text(bytes: &[u8], at: usize) -> Option<String> {
    let rest = bytes.get(at..)?;
    let end = rest.iter().position(|byte| *byte == 0)?;
    Some(String::from_utf8_lossy(&rest[..end]).into_owned())
}

/// Whether a first half-word begins an instruction of two.
pub(super) fn is_wide(first: u32) -> bool {
    first >> 11 >= 0b11101
}

pub(super) fn decode(first: u32, second: u32) -> Instruction {
    if !is_wide(first) {
        let register = first >> 3 & 15;
        return match first & 0xff87 {
            0x4780 => Instruction::CallRegister,
            0x4700 if register != 14 => Instruction::JumpRegister,
            // `MOV PC, register`.
            0x4687 => Instruction::JumpRegister,
            _ if first & 0xff00 == 0xde00 => Instruction::Trap,
            _ if first & 0xfffc == 0xb670 => Instruction::Mask,
            _ => Instruction::Other,
        };
    }
    // `LDR PC, [..]` by another register than the stack pointer.
    if first & 0xff70 == 0xf850 && second >> 12 == 15 && first & 15 != 13 {
        return Instruction::JumpRegister;
    }
    if first & 0xfff0 == 0xf380 && matches!(second & 0xffff, 0x8810..=0x8813) {
        return Instruction::Mask;
    }
    if first & 0xec00 == 0xec00 && second >> 9 & 7 == 0b101 {
        return Instruction::FloatUnit;
    }
    if first & 0xf800 == 0xf000 && second & 0x8000 != 0 {
        let sign = first >> 10 & 1;
        let low = (second & 0x7ff) << 1;
        if second & 0x1000 != 0 {
            let bit = |at: u32| !(second >> at ^ sign) & 1;
            let far = sign << 24 | bit(13) << 23 | bit(11) << 22 | (first & 0x3ff) << 12 | low;
            return Instruction::Branch(((far << 7) as i32) >> 7);
        }
        let condition = first >> 6 & 15;
        if second & 0x4000 == 0 && condition < 14 {
            let bit = |at: u32| second >> at & 1;
            let far = sign << 20 | bit(11) << 19 | bit(13) << 18 | (first & 0x3f) << 12 | low;
            return Instruction::Branch(((far << 11) as i32) >> 11);
        }
    }
    Instruction::Other
}

impl Program {
    /// Reads a 32-bit little-endian ELF file.
    pub fn read(file: &[u8]) -> Option<Self> {
        if file.get(..6)? != b"\x7fELF\x01\x01" {
            return None;
        }
        let (table, size, count) = (word(file, 32)?, half(file, 46)?, half(file, 48)?);
        let section = |index: u32| -> Option<[u32; 10]> {
            let at = (table + index * size) as usize;
            let mut fields = [0; 10];
            for (field, at) in fields.iter_mut().zip((at..).step_by(4)) {
                *field = word(file, at)?;
            }
            Some(fields)
        };
        let content =
            |fields: &[u32; 10]| file.get(fields[4] as usize..)?.get(..fields[5] as usize);
        let mut program = Self::default();
        for index in 0..count {
            let fields = section(index)?;
            let (kind, flags, address, link) = (fields[1], fields[2], fields[3], fields[6]);
            if flags & 2 != 0 {
                let names = content(&section(half(file, 50)?)?)?;
                program.parts.push(Part {
                    name: text(names, fields[0] as usize)?,
                    address,
                    size: fields[5],
                    // NOBITS has none.
                    content: if kind == 8 {
                        Vec::new()
                    } else {
                        content(&fields)?.to_vec()
                    },
                    is_code: flags & 4 != 0,
                });
            }
            // PROGBITS that are executed.
            if kind == 1 && flags & 4 != 0 {
                program.sections.push((address, content(&fields)?.to_vec()));
            }
            if kind == 2 {
                let names = content(&section(link)?)?;
                for symbol in content(&fields)?.chunks_exact(16) {
                    program.add(names, symbol)?;
                }
            }
        }
        Some(program)
    }

    fn add(&mut self, names: &[u8], symbol: &[u8]) -> Option<()> {
        let name = text(names, word(symbol, 0)? as usize)?;
        let (value, size, kind) = (word(symbol, 4)?, word(symbol, 8)?, symbol.get(12)? & 15);
        if kind == 2 {
            let function = Function { name, size };
            self.functions.insert(value & !1, function);
        } else if name == "$d" || name.starts_with("$d.") {
            self.data.insert(value, true);
        } else if name == "$t" || name.starts_with("$t.") {
            self.data.insert(value, false);
        } else if !name.is_empty() {
            self.symbols.insert(name, value);
        }
        Some(())
    }

    /// The address of a symbol that is no function.
    pub fn symbol(&self, name: &str) -> Option<u32> {
        self.symbols.get(name).copied()
    }

    /// A function's name and size by its address.
    pub(super) fn function(&self, address: u32) -> Option<(&str, u32)> {
        let function = self.functions.get(&(address & !1))?;
        Some((&function.name, function.size))
    }

    /// The name of the function at an address.
    pub fn function_name(&self, address: u32) -> Option<&str> {
        self.function(address).map(|(name, _)| name)
    }

    /// Where the functions begin.
    pub(super) fn starts(&self) -> impl Iterator<Item = u32> {
        self.functions.keys().copied()
    }

    /// The address of the function with exactly this name.
    pub fn address(&self, name: &str) -> Option<u32> {
        let is_it = |(_, function): &(&u32, &Function)| function.name == name;
        Some(*self.functions.iter().find(is_it)?.0)
    }

    /// Calls `look` with each instruction of a function: its address and its two half-words.
    pub(super) fn instructions(&self, start: u32, mut look: impl FnMut(u32, u32, u32)) {
        let size = self.function(start).map_or(0, |(_, size)| size);
        let mut at = start;
        while at < start + size {
            if self.is_data(at) {
                at += 2;
                continue;
            }
            let first = self.half(at).unwrap_or(0);
            look(at, first, self.half(at + 2).unwrap_or(0));
            at += if is_wide(first) { 4 } else { 2 };
        }
    }

    /// All names.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.functions
            .values()
            .map(|function| function.name.as_str())
    }

    fn half(&self, address: u32) -> Option<u32> {
        self.sections
            .iter()
            .find_map(|(start, bytes)| half(bytes, address.checked_sub(*start)? as usize))
    }

    fn is_data(&self, address: u32) -> bool {
        self.data
            .range(..=address)
            .next_back()
            .is_some_and(|(_, data)| *data)
    }

    /// From the function whose name contains a text. `None` if there is none.
    pub fn reach(&self, name: &str) -> Option<Reach> {
        let is_it = |(_, function): &(&u32, &Function)| function.name.contains(name);
        self.reach_from(*self.functions.iter().find(is_it)?.0)
    }

    /// From the function at an address.
    pub fn reach_from(&self, address: u32) -> Option<Reach> {
        let mut reach = Reach::default();
        let mut waiting = vec![address];
        let mut seen: BTreeSet<u32> = waiting.iter().copied().collect();
        while let Some(start) = waiting.pop() {
            let function = &self.functions[&start];
            reach.functions.insert(function.name.clone());
            reach.bytes += function.size;
            for goal in self.goals(start, function, &mut reach)? {
                if seen.insert(goal) {
                    waiting.push(goal);
                }
            }
        }
        Some(reach)
    }

    /// Reads a function; the functions that it calls or jumps to.
    fn goals(&self, start: u32, function: &Function, reach: &mut Reach) -> Option<Vec<u32>> {
        let mut goals = Vec::new();
        let mut is_known = true;
        self.instructions(start, |at, first, second| {
            let place = || format!("{} at {at:#x}", function.name);
            reach.instructions += 1;
            match decode(first, second) {
                Instruction::Branch(far) => {
                    let goal = (at + 4).wrapping_add_signed(far);
                    if self.functions.contains_key(&goal) {
                        goals.push(goal);
                    } else if !(start..start + function.size).contains(&goal) {
                        reach.unknown.push(place());
                    }
                }
                Instruction::CallRegister | Instruction::JumpRegister => {
                    reach.unknown.push(place())
                }
                Instruction::FloatUnit => reach.float_unit.push(place()),
                Instruction::Trap => reach.traps.push(place()),
                Instruction::Mask => reach.masks.push(place()),
                Instruction::Other => {}
            }
            is_known &= self.half(at).is_some();
        });
        if !is_known {
            return None;
        }
        Some(goals)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instructions_are_told_apart() {
        for (first, second, expected) in [
            // nop; bx lr; bx r3; blx r2
            (0xbf00, 0, Instruction::Other),
            (0x4770, 0, Instruction::Other),
            (0x4718, 0, Instruction::JumpRegister),
            // mov pc, r3; ldr.w pc, [r0, r1, lsl #2]; pop.w {pc} as a load; udf #254
            (0x469f, 0, Instruction::JumpRegister),
            (0xf850, 0xf021, Instruction::JumpRegister),
            (0xf85d, 0xfb04, Instruction::Other),
            (0xdefe, 0, Instruction::Trap),
            // cpsid i; msr basepri_max, r0; msr primask, r0
            (0xb672, 0, Instruction::Mask),
            (0xf380, 0x8812, Instruction::Mask),
            (0xf380, 0x8810, Instruction::Mask),
            (0x4790, 0, Instruction::CallRegister),
            // bl to itself; bl forwards by 0x1000; b.w forwards by 8
            (0xf7ff, 0xfffe, Instruction::Branch(-4)),
            (0xf001, 0xf800, Instruction::Branch(0x1000)),
            (0xf000, 0xb804, Instruction::Branch(8)),
            // beq.w backwards by 2; msr apsr_nzcvq, r0; dsb
            (0xf43f, 0xafff, Instruction::Branch(-2)),
            (0xf380, 0x8800, Instruction::Other),
            (0xf3bf, 0x8f4f, Instruction::Other),
            // vadd.f32 s0, s0, s1; vldr s0, [r0]; vmov r0, s0
            (0xee30, 0x0a20, Instruction::FloatUnit),
            (0xed90, 0x0a00, Instruction::FloatUnit),
            (0xee10, 0x0a10, Instruction::FloatUnit),
            // udiv r0, r0, r1; umull r0, r1, r2, r3
            (0xfbb0, 0xf0f1, Instruction::Other),
            (0xfba2, 0x0103, Instruction::Other),
        ] {
            assert_eq!(decode(first, second), expected, "{first:04x} {second:04x}");
        }
    }

    #[test]
    fn what_is_no_program_is_refused() {
        assert!(Program::read(b"").is_none());
        assert!(Program::read(b"\x7fELF\x02\x01 of 64 bits").is_none());
    }
}
