//! Build script. Passes the board's memory map (a file at the repository's top level) and the linker scripts to the linker. Passes
//! a hash of the source files to the program.

use std::path::{Path, PathBuf};

fn main() {
    let folder = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    let out = PathBuf::from(std::env::var("OUT_DIR").unwrap_or_default());
    // The larger chip has memory without wait states for the interrupts' code.
    let is_large = std::env::var_os("CARGO_FEATURE_G474RE").is_some();
    let map = if is_large {
        "memory-g474re.x"
    } else {
        "memory.x"
    };
    let map_file = Path::new(&folder).join("..").join(map);
    if let Err(error) = std::fs::copy(&map_file, out.join("memory.x")) {
        println!("cargo::error={}: {error}", map_file.display());
    }
    println!("cargo::rustc-link-search={}", out.display());
    println!("cargo::rustc-link-search={folder}");
    // If two linker scripts place the same section, the first one decides.
    let first = is_large.then_some("fast.x");
    for script in first.into_iter().chain(["link.x", "defmt.x"]) {
        println!("cargo::rustc-link-arg-bins=-T{script}");
    }
    // Sections need not be aligned to pages, because no operating system loads this image.
    println!("cargo::rustc-link-arg-bins=--nmagic");
    // A symbol that takes no flash. `touchstone flash` reads from it the board for which a program was built.
    let programs = Path::new(&folder).join("src/bin");
    for program in std::fs::read_dir(programs).into_iter().flatten().flatten() {
        let file = program.path();
        let symbol = file.file_stem().unwrap_or_default().to_string_lossy();
        let board = symbol.replace('_', "-");
        println!("cargo::rustc-link-arg-bin={board}=--defsym=touchstone_board_{symbol}=0");
    }
    let mut hash = FNV_BASIS;
    for part in [
        "firmware/src",
        "drive/src",
        "protocol/src",
        "control/src",
        map,
        "firmware/fast.x",
        "firmware/Cargo.lock",
    ] {
        let part = Path::new(&folder).join("..").join(part);
        println!("cargo::rerun-if-changed={}", part.display());
        add(&part, &mut hash);
    }
    println!("cargo::rustc-env=TOUCHSTONE_BUILD_HASH={hash:016x}");
}

const FNV_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const FNV_PRIME: u64 = 0x100_0000_01b3;

/// Adds a file, or the files of a folder in the order of their names, to an FNV-1a hash.
fn add(path: &Path, hash: &mut u64) {
    if let Ok(entries) = std::fs::read_dir(path) {
        let mut entries: Vec<_> = entries
            .filter_map(|entry| Some(entry.ok()?.path()))
            .collect();
        entries.sort();
        entries.iter().for_each(|entry| add(entry, hash));
    } else {
        for byte in std::fs::read(path).unwrap_or_default() {
            *hash = (*hash ^ u64::from(byte)).wrapping_mul(FNV_PRIME);
        }
    }
}
