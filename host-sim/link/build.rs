//! Build script: compiles the documentation pages of the device's faults (`docs/faults`) into the crate.

use std::path::Path;

/// Writes the file `faults.rs` with number and text of each fault page, ordered by number.
fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let folder = Path::new("../../docs/faults");
    println!("cargo::rerun-if-changed={}", folder.display());
    let mut pages: Vec<(u8, String)> = std::fs::read_dir(folder)
        .expect("the pages of faults")
        .filter_map(|entry| {
            let path = entry.ok()?.path();
            let name = path.file_name()?.to_str()?;
            let code = name.split_once('-')?.0.parse().ok()?;
            Some((code, std::fs::read_to_string(&path).ok()?))
        })
        .collect();
    pages.sort();
    let out = std::env::var_os("OUT_DIR").expect("cargo sets it");
    std::fs::write(Path::new(&out).join("faults.rs"), format!("&{pages:?}")).expect("its folder");
}
