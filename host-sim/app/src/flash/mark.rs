//! Reads from a firmware's ELF file for which board it was built. The board's name is part of the name of an undefined symbol,
//! which `firmware/build.rs` makes the linker add. The symbol is only in the ELF file and takes no space in flash.

/// Beginning of the name of the symbol that holds the board's name in the ELF file. The board's name follows, with `_` for `-`.
const BEGIN: &[u8] = b"touchstone_board_";
/// Type number of an ELF section that is a symbol table.
const SYMBOLS: u32 = 2;
/// Size in bytes of a symbol in a 32-bit ELF file.
const SYMBOL: usize = 16;

/// Names of the boards for which a 32-bit little-endian ELF file was built; empty if the file has no symbol table.
pub fn boards(elf: &[u8]) -> Vec<String> {
    let mut found: Vec<String> = sections(elf)
        .filter(|section| section.kind == SYMBOLS)
        .flat_map(|symbols| {
            let names = sections(elf).nth(symbols.link).and_then(|it| it.of(elf));
            let table = symbols.of(elf).unwrap_or_default();
            table.chunks_exact(SYMBOL).filter_map(move |symbol| {
                let name = names?.get(word(symbol, 0)? as usize..)?;
                let name = name.strip_prefix(BEGIN)?;
                let end = name.iter().position(|byte| *byte == 0)?;
                let name = std::str::from_utf8(&name[..end]).ok()?;
                Some(name.replace('_', "-"))
            })
        })
        .collect();
    found.sort();
    found.dedup();
    found
}

/// An ELF section: its type, place and size in the file, and the index of the section that it refers to.
struct Section {
    kind: u32,
    begin: usize,
    size: usize,
    link: usize,
}

impl Section {
    fn of<'a>(&self, elf: &'a [u8]) -> Option<&'a [u8]> {
        elf.get(self.begin..self.begin.checked_add(self.size)?)
    }
}

fn sections(elf: &[u8]) -> impl Iterator<Item = Section> {
    let (begin, size, number) = match (word(elf, 32), half(elf, 46), half(elf, 48)) {
        (Some(begin), Some(size), Some(number)) => (begin as usize, size, number),
        _ => (0, 0, 0),
    };
    (0..number).map_while(move |index| {
        let header = elf.get(begin.checked_add(index * size)?..)?;
        Some(Section {
            kind: word(header, 4)?,
            begin: word(header, 16)? as usize,
            size: word(header, 20)? as usize,
            link: word(header, 24)? as usize,
        })
    })
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let word = bytes.get(at..at + 4)?;
    Some(u32::from_le_bytes(word.try_into().ok()?))
}

fn half(bytes: &[u8], at: usize) -> Option<usize> {
    let half = bytes.get(at..at + 2)?;
    Some(usize::from(u16::from_le_bytes(half.try_into().ok()?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_cut_or_random_has_no_mark_and_does_no_harm() {
        let mut bytes = b"\x7fELF\x01\x01\x01".to_vec();
        bytes.resize(4096, 0);
        assert!(boards(&bytes).is_empty());
        let mut state = 51_u64;
        for _ in 0..2000 {
            for byte in &mut bytes[16..] {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                *byte = (state >> 56) as u8;
            }
            // The section table must be inside the file, so that the function has a table to read.
            bytes[32..36].copy_from_slice(&64_u32.to_le_bytes());
            bytes[46..50].copy_from_slice(&[40, 0, 90, 0]);
            assert!(boards(&bytes).is_empty());
        }
        assert!(boards(&bytes[..40]).is_empty());
    }
}
