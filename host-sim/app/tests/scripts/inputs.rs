//! Gives every command that reads a file an unusable file. Each command must refuse the file in one line, within a short time.

use crate::{folder, run_in};
use std::path::Path;
use std::time::{Duration, Instant};

/// Every command that reads a file, with `IN` in place of the file. Each reads the file before it connects to a device.
const READERS: [&str; 23] = [
    "run IN",
    "plan IN",
    "certify IN",
    "identify IN",
    "live IN --no-open --out page.html",
    "sweep IN --no-certificate --x wall.k_desired_n_m_per_rad=1,2 --y timing.rate_hz=1000,2000 --out cells",
    "export-fmu IN --library right.csv",
    "export-fmu tap --library IN",
    "boundary IN --columns 2 --rows 2 --delays 0 --ticks 1000 --out map",
    "scorecard IN --grip light",
    "tune IN",
    "tune tap --noise-from IN",
    "run tap --settings IN",
    "run tap --baseline IN",
    "run tap --operator-motion IN",
    "sweep tap --overlay IN --no-certificate --x wall.k_desired_n_m_per_rad=1,2 --y timing.rate_hz=1000,2000 --out cells",
    "compare IN tap",
    "compare right.csv tap --hand programme --also IN",
    "device run IN --device simulated --fast --seconds 0.1",
    "device run plane --device simulated --twin IN --fast --seconds 0.1",
    "flash --board b-g431b-esc1 IN --dry-run",
    "log --board b-g431b-esc1 IN --seconds 1",
    "config import IN --port tcp:127.0.0.1:1",
];

/// Longest allowed time until a refusal, with a margin for a busy machine. Without a limit, a file without end would be read for
/// ever.
const SOON: Duration = Duration::from_secs(20);

/// Makes files that no command can use, and returns their paths.
fn odd_files(here: &Path) -> Vec<String> {
    let write = |name: &str, bytes: &[u8]| std::fs::write(here.join(name), bytes).unwrap();
    let utf_16: Vec<u8> = "\u{feff}name = \"x\"\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    write("utf-16", &utf_16);
    write("gzip", b"\x1f\x8b\x08\x00 no more");
    write("sheet", b"PK\x03\x04\x14\x00\x06\x00");
    write("zero-byte", b"name = \"a\0\"\n");
    write("latin-1", b"# Gr\xf6\xdfe\nname = \"x\"\n");
    write("page", b"<!DOCTYPE html>\n<html></html>\n");
    write("escape", b"\x1b]0;red\x07[31m\n::error::x\n");
    write(
        "one-quote",
        format!("\"{}", "x\n".repeat(20_000)).as_bytes(),
    );
    write("deep", "[".repeat(100_000).as_bytes());
    // A sparse file of ten gigabytes takes no space on the disk.
    let long = std::fs::File::create(here.join("ten-gigabytes")).unwrap();
    long.set_len(10_000_000_000).unwrap();
    std::fs::create_dir(here.join("folder")).unwrap();
    let mut names: Vec<String> = crate::names(here);
    names.retain(|name| name != "right.csv");
    names.push("none".to_owned());
    #[cfg(target_os = "linux")]
    {
        std::os::unix::fs::symlink("loop", here.join("loop")).unwrap();
        let _ = std::os::unix::net::UnixListener::bind(here.join("socket"));
        names.extend(["loop", "socket", "/dev/zero", "/dev/full"].map(str::to_owned));
    }
    names
}

#[test]
fn what_is_no_input_is_refused_soon_in_a_line() {
    let here = folder("inputs");
    std::fs::write(
        here.join("right.csv"),
        "time_s,angle_rad\n0,0\n1,0.1\n2,0\n",
    )
    .unwrap();
    let mut wrong = Vec::new();
    let files = odd_files(&here);
    for reader in READERS {
        for file in &files {
            let words: Vec<&str> = reader
                .split(' ')
                .map(|word| if word == "IN" { file.as_str() } else { word })
                .collect();
            let begun = Instant::now();
            let said = run_in(&here, &words);
            let is_line = said.err.lines().count() == 1 && said.err.starts_with("error: ");
            let is_harmless = !said.err.contains('\u{1b}') && said.err.len() < 1600;
            let is_soon = begun.elapsed() < SOON;
            if !(said.code == Some(2) && is_line && is_harmless && is_soon) {
                wrong.push(format!(
                    "{}: {:?} after {:?}: {}",
                    words.join(" "),
                    said.code,
                    begun.elapsed(),
                    said.err
                ));
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "{} wrong:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}
