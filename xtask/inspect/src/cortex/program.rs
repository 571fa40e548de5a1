//! Reads from a Cortex-M's ELF file what is needed to follow all calls below a function.
//!
//! The symbols `$t` and `$d`, which the ABI requires, separate code from data.

use std::collections::BTreeMap;
use std::path::Path;

use object::elf::{SHF_ALLOC, SHF_EXECINSTR};
use object::read::elf::ElfFile32;
use object::{
    LittleEndian, Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, SymbolKind,
};

use super::instruction::{is_wide, loads_half};

/// A function of the program.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Function {
    name: String,
    size: u32,
}

/// The code of a program.
#[derive(Debug, Default)]
pub struct ProgramCode {
    functions: BTreeMap<u32, Function>,
    /// Addresses in the code at which data begins (`true`) or ends (`false`).
    data: BTreeMap<u32, bool>,
    sections: Vec<(u32, Vec<u8>)>,
    /// The ELF sections that take memory on the board, in the file's order.
    pub parts: Vec<Part>,
    /// All symbols other than functions, by name.
    symbols: BTreeMap<String, u32>,
}

/// An ELF section that takes memory on the board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    pub name: String,
    pub address: u32,
    pub size: u32,
    /// The section's bytes in the file; empty for memory that start-up clears.
    pub content: Vec<u8>,
    pub is_code: bool,
}

pub fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

fn half(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?).into())
}

impl ProgramCode {
    /// Reads the file of a program.
    pub fn open(path: &Path) -> Result<Self, String> {
        let file = std::fs::read(path).map_err(|why| format!("{}: {why}", path.display()))?;
        Self::read(&file)
            .map_err(|why| format!("{} is no ELF file of 32 bits: {why}", path.display()))
    }

    /// Reads a 32-bit little-endian ELF file.
    fn read(file: &[u8]) -> Result<Self, object::Error> {
        let file = ElfFile32::<LittleEndian>::parse(file)?;
        let mut program = Self::default();
        for section in file.sections() {
            let SectionFlags::Elf { sh_flags, .. } = section.flags() else {
                continue;
            };
            let has = |flag| sh_flags.contains(flag);
            // The board's addresses have 32 bits.
            let (address, size) = (section.address() as u32, section.size() as u32);
            let is_code = has(SHF_EXECINSTR);
            let content = section.data()?.to_vec();
            if section.kind() == SectionKind::Text {
                program.sections.push((address, content.clone()));
            }
            if has(SHF_ALLOC) {
                program.parts.push(Part {
                    name: section.name()?.to_owned(),
                    address,
                    size,
                    content,
                    is_code,
                });
            }
        }
        for symbol in file.symbols() {
            program.add(symbol.name()?, &symbol);
        }
        Ok(program)
    }

    fn add<'f>(&mut self, name: &str, symbol: &impl ObjectSymbol<'f>) {
        let (value, size) = (symbol.address() as u32, symbol.size() as u32);
        let is_mark = |mark: &str| {
            let rest = name.strip_prefix(mark);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        if symbol.kind() == SymbolKind::Text {
            let name = name.to_owned();
            self.functions.insert(value & !1, Function { name, size });
        } else if is_mark("$d") {
            self.data.insert(value, true);
        } else if is_mark("$t") {
            self.data.insert(value, false);
        } else if !name.is_empty() {
            self.symbols.insert(name.to_owned(), value);
        }
    }

    /// The value of a symbol that is not a function; `None` if there is no such symbol.
    pub fn symbol(&self, name: &str) -> Option<u32> {
        self.symbols.get(name).copied()
    }

    /// All functions: address, mangled name, size.
    pub fn all_functions(&self) -> impl Iterator<Item = (u32, &str, u32)> {
        let all = self.functions.iter();
        all.map(|(address, function)| (*address, function.name.as_str(), function.size))
    }

    /// A function's name and size by its start address; `None` if no function begins there.
    pub fn function(&self, address: u32) -> Option<(&str, u32)> {
        let function = self.functions.get(&(address & !1))?;
        Some((&function.name, function.size))
    }

    /// The name of the function that begins at an address.
    pub fn function_name(&self, address: u32) -> Option<&str> {
        self.function(address).map(|(name, _)| name)
    }

    /// Start addresses of all functions.
    pub fn starts(&self) -> impl Iterator<Item = u32> {
        self.functions.keys().copied()
    }

    /// The start address of the function with exactly this name.
    pub fn address(&self, name: &str) -> Option<u32> {
        let is_it = |(_, function): &(&u32, &Function)| function.name == name;
        Some(*self.functions.iter().find(is_it)?.0)
    }

    /// Target of a veneer, the linker's bridge to code that is too far for a call. A veneer consists of `MOVW` and `MOVT` to a
    /// register and a jump by that register. `None` for any other code.
    pub fn bridge(&self, start: u32) -> Option<u32> {
        let wide = |at: u32| loads_half(self.half(at)?, self.half(at + 2)?);
        let ((false, low, bottom), (true, high, top)) = (wide(start)?, wide(start + 4)?) else {
            return None;
        };
        let jumps = self.half(start + 8)? == 0x4700 | (low as u32) << 3;
        (low == high && jumps).then_some((top << 16 | bottom) & !1)
    }

    /// Calls `look` with each instruction of a function: its address and its two half-words.
    pub fn instructions(&self, start: u32, mut look: impl FnMut(u32, u32, u32)) {
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

    /// The names of all functions.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.functions
            .values()
            .map(|function| function.name.as_str())
    }

    /// The half-word (two bytes) of code at an address.
    pub fn half(&self, address: u32) -> Option<u32> {
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_program_is_refused() {
        assert!(ProgramCode::read(b"").is_err());
        assert!(ProgramCode::read(b"\x7fELF\x02\x01 of 64 bits").is_err());
    }

    #[test]
    fn a_linkers_bridge_is_followed_and_nothing_else() {
        // movw r12, #0x1235; movt r12, #0x0800; bx r12
        let bridge = [0xf241, 0x2c35, 0xf6c0, 0x0c00, 0x4760];
        let at = |halves: [u16; 5]| {
            let bytes = halves.into_iter().flat_map(u16::to_le_bytes).collect();
            let sections = vec![(0x100, bytes)];
            let program = ProgramCode {
                sections,
                ..ProgramCode::default()
            };
            program.bridge(0x100)
        };
        assert_eq!(at(bridge), Some(0x0800_1234));
        // Halves of two registers; a jump by another one; a call.
        assert_eq!(at([0xf241, 0x2c35, 0xf6c0, 0x0b00, 0x4760]), None);
        assert_eq!(at([0xf241, 0x2c35, 0xf6c0, 0x0c00, 0x4758]), None);
        assert_eq!(at([0xf241, 0x2c35, 0xf6c0, 0x0c00, 0x47e0]), None);
    }
}
