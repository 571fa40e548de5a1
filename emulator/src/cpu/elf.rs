//! Reads a firmware program from an ELF file: the bytes for the flash, and the symbols.

use std::collections::BTreeMap;
use std::path::Path;

use object::{Object, ObjectSymbol};

/// A firmware program read from an ELF file.
#[derive(Debug, Clone)]
pub struct Program {
    /// Start address and bytes of each segment, as a programming tool would write them to flash.
    pub segments: Vec<(u32, Vec<u8>)>,
    symbols: BTreeMap<String, u32>,
    functions: Vec<(u32, u32, String)>,
}

impl Program {
    /// Reads an ELF file.
    ///
    /// # Errors
    /// One line that names the file and says what is wrong with it.
    pub fn read(path: &Path) -> Result<Self, String> {
        let said = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let bytes = std::fs::read(path).map_err(|error| said(&error))?;
        Self::parse(&bytes).map_err(|error| said(&error))
    }

    fn parse(bytes: &[u8]) -> Result<Self, object::Error> {
        let file = object::read::elf::ElfFile32::<object::LittleEndian>::parse(bytes)?;
        let mut segments = Vec::new();
        for segment in file.elf_program_headers() {
            let little = object::LittleEndian;
            if segment.p_type.get(little) == object::elf::PT_LOAD
                && segment.p_filesz.get(little) > 0
            {
                let from = segment.p_offset.get(little) as usize;
                let content = bytes.get(from..from + segment.p_filesz.get(little) as usize);
                segments.push((
                    segment.p_paddr.get(little),
                    content.unwrap_or_default().to_vec(),
                ));
            }
        }
        let mut symbols = BTreeMap::new();
        let mut functions = Vec::new();
        for symbol in file.symbols() {
            let Ok(name) = symbol.name() else { continue };
            let address = symbol.address() as u32;
            if symbol.kind() == object::SymbolKind::Text && symbol.size() > 0 {
                functions.push((address & !1, symbol.size() as u32, name.to_owned()));
            }
            if !name.is_empty() && !name.starts_with('$') {
                symbols.insert(name.to_owned(), address);
            }
        }
        functions.sort();
        Ok(Self {
            segments,
            symbols,
            functions,
        })
    }

    /// Address of the symbol with exactly this name; `None` if the program has no such symbol.
    #[must_use]
    pub fn symbol(&self, name: &str) -> Option<u32> {
        self.symbols.get(name).copied()
    }

    /// Start address, length in bytes and name of each function whose mangled name contains all of `words`.
    #[must_use]
    pub fn functions(&self, words: &[&str]) -> Vec<(u32, u32, &str)> {
        let fits = |name: &str| words.iter().all(|word| name.contains(word));
        let found = self.functions.iter().filter(|(_, _, name)| fits(name));
        found
            .map(|(start, size, name)| (*start, *size, name.as_str()))
            .collect()
    }

    /// Name of the function whose code contains the address; `None` if no function does.
    #[must_use]
    pub fn function_at(&self, address: u32) -> Option<&str> {
        let at = self
            .functions
            .partition_point(|(start, _, _)| *start <= address);
        let (start, size, name) = self.functions.get(at.checked_sub(1)?)?;
        (address - start < *size).then_some(name)
    }
}
