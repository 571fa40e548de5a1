//! Tells the linker where `memory.x` is, and to lay out the program by the linker script of cortex-m-rt.

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
