//! Builds ELF files of invented programs for the tests: parts for the flash, symbols, and log messages (defmt format).

/// RAM address of the log's control block in the invented programs.
pub const CONTROL_BLOCK: u32 = 0x2000_4000;

/// An invented program for the tests.
#[derive(Default)]
pub struct Program {
    parts: Vec<(u32, Vec<u8>)>,
    /// Name and value of each symbol. The flag is true for a log message, which lies in the section `.defmt`.
    symbols: Vec<(String, u32, bool)>,
}

impl Program {
    /// Adds a part that is loaded into the flash at `address`.
    pub fn with(mut self, address: u32, bytes: Vec<u8>) -> Self {
        self.parts.push((address, bytes));
        self
    }

    /// Adds an ELF symbol.
    pub fn with_symbol(mut self, name: &str, value: u32) -> Self {
        self.symbols.push((name.into(), value, false));
        self
    }

    /// Adds log messages, each a level and a format text, numbered from 1. `clock` is the format text of the board's time.
    pub fn with_messages(mut self, messages: &[(&str, &str)], clock: Option<&str>) -> Self {
        self = self
            .with_symbol("_SEGGER_RTT", CONTROL_BLOCK)
            .with_symbol("_defmt_version_ = 4", 0)
            .with_symbol("_defmt_encoding_ = rzcobs", 0);
        let clock = clock.map(|format| ("timestamp", format));
        for (place, (level, format)) in messages.iter().copied().chain(clock).enumerate() {
            let name = format!(
                r#"{{"package":"made-up","tag":"defmt_{level}","data":"{format}","disambiguator":"{place}","crate_name":"made_up"}}"#
            );
            self.symbols.push((name, place as u32 + 1, true));
        }
        self
    }

    /// Returns the bytes of the program's ELF file.
    pub fn elf(&self) -> Vec<u8> {
        const HEADER: usize = 52;
        let mut content = vec![0; HEADER + 32 * self.parts.len()];
        let mut segments = Vec::new();
        for (address, bytes) in &self.parts {
            let size = bytes.len() as u32;
            // Program header: PT_LOAD, offset in the file, address when running and address when loading, two sizes, flags R and X,
            // alignment.
            segments.extend([
                1,
                content.len() as u32,
                *address,
                *address,
                size,
                size,
                5,
                4,
            ]);
            content.extend(bytes);
        }
        let mut names = vec![0];
        let mut symbols = vec![0; 16];
        for (name, value, message) in &self.symbols {
            // Symbol: name, value, size; global data; in `.defmt` or with an absolute value.
            for word in [names.len() as u32, *value, 1] {
                symbols.extend(word.to_le_bytes());
            }
            symbols.extend([0x11, 0]);
            symbols.extend(if *message { 1_u16 } else { 0xfff1 }.to_le_bytes());
            names.extend(name.as_bytes());
            names.push(0);
        }
        let section_names = b"\0.defmt\0.symtab\0.strtab\0.shstrtab\0";
        let has_messages = self.symbols.iter().any(|(.., message)| *message);
        let mut sections = vec![0_u32; 10];
        let pieces: [(u32, u32, Vec<u8>, u32, u32, u32); 4] = [
            (u32::from(has_messages), 1, vec![0; 64], 0, 0, 0),
            (8, 2, symbols, 3, 1, 16),
            (16, 3, names, 0, 0, 0),
            (24, 3, section_names.to_vec(), 0, 0, 0),
        ];
        for (name, kind, bytes, link, info, entry) in pieces {
            while !content.len().is_multiple_of(4) {
                content.push(0);
            }
            let (offset, size) = (content.len() as u32, bytes.len() as u32);
            sections.extend([name, kind, 0, 0, offset, size, link, info, 4, entry]);
            content.extend(bytes);
        }
        while !content.len().is_multiple_of(4) {
            content.push(0);
        }
        let table = content.len() as u32;
        content.extend(sections.iter().flat_map(|word| word.to_le_bytes()));
        for (place, word) in segments.iter().enumerate() {
            content[HEADER + 4 * place..][..4].copy_from_slice(&word.to_le_bytes());
        }
        let mut header = b"\x7fELF\x01\x01\x01\0\0\0\0\0\0\0\0\0".to_vec();
        // An executable for Arm.
        header.extend([2, 0, 40, 0]);
        for word in [1, 0x0800_0101, HEADER as u32, table, 0x0500_0000] {
            header.extend(word.to_le_bytes());
        }
        for half in [52, 32, self.parts.len() as u16, 40, 5, 4] {
            header.extend(half.to_le_bytes());
        }
        content[..HEADER].copy_from_slice(&header);
        content
    }
}

/// Returns `size` bytes of invented program code without early repetition. They begin with a stack address and an entry point.
pub fn code(size: usize) -> Vec<u8> {
    let mut bytes = 0x2000_8000_u32.to_le_bytes().to_vec();
    bytes.extend(0x0800_0101_u32.to_le_bytes());
    let mut state = 1_u32;
    while bytes.len() < size {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        bytes.push((state >> 24) as u8);
    }
    bytes.truncate(size);
    bytes
}
