//! Build script: tells the linker where the memory layout `memory.x` is, and to use the linker script of the crate cortex-m-rt.

use std::path::Path;

fn main() {
    let folder = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    println!("cargo::rustc-link-search={folder}");
    println!("cargo::rustc-link-arg=-Tlink.x");
    println!(
        "cargo::rerun-if-changed={}",
        Path::new(&folder).join("memory.x").display()
    );
}
