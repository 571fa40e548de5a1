//! Gives the linker the map of both boards' memory, `memory.x` at the repository's top level, and the scripts that use it.

use std::path::{Path, PathBuf};

fn main() {
    let folder = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    let out = PathBuf::from(std::env::var("OUT_DIR").unwrap_or_default());
    let map = Path::new(&folder).join("../memory.x");
    if let Err(error) = std::fs::copy(&map, out.join("memory.x")) {
        println!("cargo::error={}: {error}", map.display());
    }
    println!("cargo::rustc-link-search={}", out.display());
    for script in ["link.x", "defmt.x"] {
        println!("cargo::rustc-link-arg-bins=-T{script}");
    }
    // Sections start on no page of a file system: the image is for a flash memory.
    println!("cargo::rustc-link-arg-bins=--nmagic");
    println!("cargo::rerun-if-changed={}", map.display());
}
