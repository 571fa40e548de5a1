//! Zip archives without compression.

/// Date of every file, 1 January 1980 in the format of zip. It is fixed, so that the same FMU has the same bytes.
const DATE: u16 = 0x21;
/// Version of the zip format that a reader needs, 1.0.
const NEEDS: u16 = 10;

/// Packs files into an archive. `files` are names, with `/` between folders, and contents.
///
/// # Errors
/// The name of a file that is too large for the archive.
pub fn pack<'a>(files: &[(&'a str, &[u8])]) -> Result<Vec<u8>, &'a str> {
    let mut archive = Vec::new();
    let mut directory = Vec::new();
    for (name, content) in files {
        let begins = u32::try_from(archive.len()).map_err(|_| *name)?;
        let size = u32::try_from(content.len()).map_err(|_| *name)?;
        let length = u16::try_from(name.len()).map_err(|_| *name)?;
        let mut common = Vec::new();
        for half in [NEEDS, 0, 0, 0, DATE] {
            common.extend(half.to_le_bytes());
        }
        for word in [check_sum(content), size, size] {
            common.extend(word.to_le_bytes());
        }
        common.extend(length.to_le_bytes());
        common.extend([0; 2]);

        archive.extend(*b"PK\x03\x04");
        archive.extend(&common);
        archive.extend(name.bytes());
        archive.extend(*content);

        directory.extend(*b"PK\x01\x02");
        directory.extend(NEEDS.to_le_bytes());
        directory.extend(&common);
        // No comment, first disk, no attributes.
        directory.extend([0; 10]);
        directory.extend(begins.to_le_bytes());
        directory.extend(name.bytes());
    }
    let last = files.last().map_or("", |(name, _)| *name);
    let begins = u32::try_from(archive.len()).map_err(|_| last)?;
    let length = u32::try_from(directory.len()).map_err(|_| last)?;
    let count = u16::try_from(files.len()).map_err(|_| last)?;
    archive.extend(directory);
    archive.extend(*b"PK\x05\x06\0\0\0\0");
    archive.extend(count.to_le_bytes());
    archive.extend(count.to_le_bytes());
    archive.extend(length.to_le_bytes());
    archive.extend(begins.to_le_bytes());
    archive.extend([0; 2]);
    Ok(archive)
}

/// CRC-32 of zip archives.
fn check_sum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| {
            (sum >> 1) ^ (0xEDB8_8320 & (sum & 1).wrapping_neg())
        })
    })
}

#[cfg(test)]
mod tests {
    use super::{check_sum, pack};

    /// Checks this CRC against the check value that catalogues of CRCs list for it.
    #[test]
    fn the_check_sum_is_that_of_zip() {
        assert_eq!(check_sum(b"123456789"), 0xCBF4_3926);
    }

    /// Python's zip module reads the archive, and compares every check sum.
    #[test]
    fn another_program_unpacks_the_archive() {
        let file = std::env::temp_dir().join(format!("touchstone-zip-{}.zip", std::process::id()));
        let archive = pack(&[("a/b.txt", b"one"), ("c", &[0, 255, 7])]).unwrap();
        std::fs::write(&file, archive).unwrap();
        let text = "import sys, zipfile
z = zipfile.ZipFile(sys.argv[1])
assert z.testzip() is None
print({n: list(z.read(n)) for n in z.namelist()})";
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
        let expected = "{'a/b.txt': [111, 110, 101], 'c': [0, 255, 7]}\n";
        assert_eq!(said, expected, "{complaint}");
    }
}
