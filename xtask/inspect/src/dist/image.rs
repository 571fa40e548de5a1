//! Converts a board's program from ELF to a plain image of the flash memory. To flash an image, a user copies it to the drive that
//! an ST-LINK probe shows; no other tool is needed.

use object::elf::PT_LOAD;
use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Endianness, elf::ProgramHeader32};

/// Address at which the flash memory of all boards begins. An ST-LINK writes an image without addresses to it.
const FLASH: u32 = 0x0800_0000;
/// Value of each byte of erased flash memory.
const ERASED: u8 = 0xff;

/// Content of the flash memory, from its first byte to the last byte that the ELF program fills. Errors: the file is damaged,
/// empty, or loads to addresses below the flash.
pub fn of(elf: &[u8]) -> Result<Vec<u8>, String> {
    let file = ElfFile32::<Endianness>::parse(elf).map_err(|why| why.to_string())?;
    let endian = file.endian();
    let loaded = |header: &&ProgramHeader32<Endianness>| {
        header.p_type(endian) == PT_LOAD && header.p_filesz(endian) > 0
    };
    let mut image = Vec::new();
    for header in file.elf_program_headers().iter().filter(loaded) {
        let content = header
            .data(endian, elf)
            .map_err(|()| "a part of it is cut off".to_owned())?;
        let address = header.p_paddr(endian);
        let start = address
            .checked_sub(FLASH)
            .ok_or_else(|| format!("a part of it goes to {address:#x}, which is no flash"))?;
        let start = start as usize;
        if image.len() < start + content.len() {
            image.resize(start + content.len(), ERASED);
        }
        image[start..start + content.len()].copy_from_slice(content);
    }
    match image.is_empty() {
        true => Err("there is nothing in it for the flash".into()),
        false => Ok(image),
    }
}
