//! Reads a board's program from an ELF file: the parts for the flash, and the RAM address of the log's control block.

use object::elf::{PT_LOAD, ProgramHeader32};
use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Endianness, Object, ObjectSymbol};
use probe_rs::config::{MemoryRegion, Registry};

/// Name of the ELF symbol of the control block of a log in RAM (SEGGER's RTT).
const CONTROL_BLOCK: &str = "_SEGGER_RTT";

/// A contiguous part of a program: its address in flash and its bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Part {
    pub address: u64,
    pub bytes: Vec<u8>,
}

impl Part {
    fn end(&self) -> u64 {
        self.address + self.bytes.len() as u64
    }
}

/// A board's program, as the parts that are written into the flash.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    pub(super) parts: Vec<Part>,
    /// RAM address of the control block of the program's log (RTT); `None` for a program without one.
    pub(super) control_block: Option<u64>,
}

impl Image {
    /// Reads a program for the flash of the microcontroller `chip` from an ELF file.
    ///
    /// # Errors
    /// What is wrong with the file, as text without the file's name.
    pub fn read(elf: &[u8], chip: &str) -> Result<Self, String> {
        let image = Self::parsed(elf)?;
        image.is_within(chip)?;
        Ok(image)
    }

    /// Number of bytes that the program takes in the flash.
    #[must_use]
    pub fn size_bytes(&self) -> usize {
        self.parts.iter().map(|part| part.bytes.len()).sum()
    }

    /// Address range of each part of the program: its first address, and the address after its last byte.
    pub fn ranges(&self) -> impl Iterator<Item = (u64, u64)> {
        self.parts.iter().map(|part| (part.address, part.end()))
    }

    fn parsed(elf: &[u8]) -> Result<Self, String> {
        let file = ElfFile32::<Endianness>::parse(elf)
            .map_err(|why| format!("is not a complete ELF program: {why}"))?;
        let endian = file.endian();
        let loaded = |header: &&ProgramHeader32<Endianness>| {
            header.p_type(endian) == PT_LOAD && header.p_filesz(endian) > 0
        };
        let mut parts = Vec::new();
        for header in file.elf_program_headers().iter().filter(loaded) {
            let bytes = header
                .data(endian, elf)
                .map_err(|()| "is truncated: a part of the program is missing".to_owned())?;
            parts.push(Part {
                // The load address in flash, not the address at which the part is used.
                address: header.p_paddr(endian).into(),
                bytes: bytes.to_vec(),
            });
        }
        if parts.is_empty() {
            return Err("contains nothing for the flash".to_owned());
        }
        parts.sort_by_key(|part| part.address);
        for pair in parts.windows(2) {
            if pair[0].end() > pair[1].address {
                let address = pair[1].address;
                return Err(format!(
                    "has two parts for the same flash at {address:#010x}"
                ));
            }
        }
        let symbol = file
            .symbols()
            .find(|symbol| symbol.name() == Ok(CONTROL_BLOCK));
        Ok(Self {
            parts,
            control_block: symbol.map(|symbol| symbol.address()),
        })
    }

    /// Checks that every part of the program lies in the flash of the microcontroller `chip`.
    fn is_within(&self, chip: &str) -> Result<(), String> {
        let target = Registry::from_builtin_families()
            .get_target_by_name(chip)
            .map_err(|why| format!("is for an unknown chip, {chip}: {why}"))?;
        let flash = target
            .memory_map
            .iter()
            .filter_map(MemoryRegion::as_nvm_region)
            .map(|region| region.range.clone())
            .collect::<Vec<_>>();
        for part in &self.parts {
            let fits = |range: &std::ops::Range<u64>| {
                range.contains(&part.address) && part.end() <= range.end
            };
            if !flash.iter().any(fits) {
                let (begin, end) = (part.address, part.end());
                return Err(format!(
                    "has a part for {begin:#010x} to {end:#010x}, which is not in the flash of the {chip}"
                ));
            }
        }
        Ok(())
    }
}
