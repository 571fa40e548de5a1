//! Packs files into a compressed archive and unpacks it. The same files always give the same bytes.

use std::collections::BTreeMap;
use std::io::Result;
use std::path::Path;

use flate2::read::GzDecoder;
use flate2::{Compression, GzBuilder};
use tar::{Archive, Builder, EntryType, Header};

/// Content and access rights of a file in the archive.
pub struct Entry {
    pub content: Vec<u8>,
    mode: u32,
}

impl Entry {
    /// An entry for a file that is not executable.
    pub const fn text(content: Vec<u8>) -> Self {
        let mode = 0o644;
        Self { content, mode }
    }

    /// An entry for an executable file.
    pub const fn program(content: Vec<u8>) -> Self {
        let mode = 0o755;
        Self { content, mode }
    }
}

/// Packs all entries into one folder of an archive, in the order of their names, and returns the archive's bytes. Each file has the
/// time stamp `seconds`, counted from 1970.
pub fn packed(folder: &str, seconds: u64, entries: &BTreeMap<String, Entry>) -> Result<Vec<u8>> {
    // The gzip header has no time stamp, so that the bytes do not depend on the time of packing.
    let compressed = GzBuilder::new().write(Vec::new(), Compression::best());
    let mut archive = Builder::new(compressed);
    for (name, entry) in entries {
        let mut header = Header::new_gnu();
        header.set_entry_type(EntryType::Regular);
        header.set_size(entry.content.len() as u64);
        header.set_mode(entry.mode);
        header.set_mtime(seconds);
        header.set_uid(0);
        header.set_gid(0);
        archive.append_data(&mut header, format!("{folder}/{name}"), &*entry.content)?;
    }
    archive.into_inner()?.finish()
}

/// Unpacks an archive into a folder.
pub fn unpack(packed: &[u8], into: &Path) -> Result<()> {
    Archive::new(GzDecoder::new(packed)).unpack(into)
}
