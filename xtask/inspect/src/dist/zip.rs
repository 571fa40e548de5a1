//! Packs files into a zip archive in the format that Arduino reads. The same files always give the same bytes.

use std::io::Write;

use flate2::write::DeflateEncoder;
use flate2::{Compression, Crc};

/// Date of every file, 1 January 1980 in the format of zip.
const DATE: u16 = 0x21;
/// Version of the zip format that a reader needs: 2.0. [`DEFLATE`] is the method of compression.
const NEEDS: u16 = 20;
const DEFLATE: u16 = 8;

/// Packs files into an archive. `files` are names, with `/` between folders, and contents. Errors: a file is too large for the format.
pub fn packed(files: &[(String, Vec<u8>)]) -> Result<Vec<u8>, String> {
    let (mut archive, mut directory) = (Vec::new(), Vec::new());
    for (name, content) in files {
        let wrong = |_| format!("{name}: too large for a zip archive");
        let mut crc = Crc::new();
        crc.update(content);
        let mut deflate = DeflateEncoder::new(Vec::new(), Compression::best());
        let compressed = deflate
            .write_all(content)
            .and_then(|()| deflate.finish())
            .map_err(|why| format!("{name}: {why}"))?;
        let begins = u32::try_from(archive.len()).map_err(wrong)?;
        let sizes = [compressed.len(), content.len()];
        let mut common = Vec::new();
        for half in [NEEDS, 0, DEFLATE, 0, DATE] {
            common.extend(half.to_le_bytes());
        }
        common.extend(crc.sum().to_le_bytes());
        for size in sizes {
            common.extend(u32::try_from(size).map_err(wrong)?.to_le_bytes());
        }
        common.extend(u16::try_from(name.len()).map_err(wrong)?.to_le_bytes());
        common.extend([0; 2]);

        archive.extend(*b"PK\x03\x04");
        archive.extend(&common);
        archive.extend(name.bytes());
        archive.extend(compressed);

        directory.extend(*b"PK\x01\x02");
        directory.extend(NEEDS.to_le_bytes());
        directory.extend(&common);
        // No comment, first disk, no attributes.
        directory.extend([0; 10]);
        directory.extend(begins.to_le_bytes());
        directory.extend(name.bytes());
    }
    let wrong = |_| "too much for a zip archive".to_owned();
    let begins = u32::try_from(archive.len()).map_err(wrong)?;
    let length = u32::try_from(directory.len()).map_err(wrong)?;
    let count = u16::try_from(files.len()).map_err(wrong)?;
    archive.extend(directory);
    archive.extend(*b"PK\x05\x06\0\0\0\0");
    for half in [count; 2] {
        archive.extend(half.to_le_bytes());
    }
    archive.extend(length.to_le_bytes());
    archive.extend(begins.to_le_bytes());
    archive.extend([0; 2]);
    Ok(archive)
}

#[cfg(test)]
mod tests {
    use super::packed;

    /// Python's zip module must be able to read the archive and find every checksum right.
    #[test]
    fn another_program_unpacks_the_archive() {
        let name = format!("touchstone-inspect-{}.zip", std::process::id());
        let file = std::env::temp_dir().join(name);
        let files = [
            ("a/b.txt".to_owned(), b"one".to_vec()),
            ("c".to_owned(), vec![7; 1000]),
        ];
        std::fs::write(&file, packed(&files).unwrap()).unwrap();
        let text = "import sys, zipfile
z = zipfile.ZipFile(sys.argv[1])
assert z.testzip() is None
print(z.namelist(), z.read('a/b.txt'), z.read('c') == bytes([7]) * 1000)";
        let ran = std::process::Command::new("python3")
            .args(["-c", text])
            .arg(&file)
            .output();
        let _ = std::fs::remove_file(&file);
        let Ok(ran) = ran else {
            println!("skipped: there is no python3");
            return;
        };
        let said = String::from_utf8_lossy(&ran.stdout);
        let complaint = String::from_utf8_lossy(&ran.stderr);
        assert_eq!(said, "['a/b.txt', 'c'] b'one' True\n", "{complaint}");
    }
}
