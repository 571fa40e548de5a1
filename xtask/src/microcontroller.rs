//! The compiler for the microcontroller, as `cargo xtask thumb` and `cargo xtask firmware` use it: rustup's with the target
//! installed; failing that, Debian's newer one, which has the library as source.

use std::path::Path;
use std::process::Command;
use std::sync::Once;

use crate::float_free::thumb::{self as compilers, Compiler};
use crate::outcome::Outcome;
use crate::{setup, shell};

/// The Cortex-M4 with its float unit.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// `cargo build` of the first compiler that can, and its options; [`Outcome::NotRun`] where there is none.
pub fn build() -> Result<(Command, Vec<String>), Outcome> {
    find().ok_or_else(|| {
        Outcome::NotRun(format!(
            "no compiler for {TARGET} (rustup target add {TARGET})"
        ))
    })
}

/// `cargo clippy` of the first compiler that has one for the target, and its options.
pub fn clippy() -> Option<(Command, Vec<String>)> {
    compilers::find_for(TARGET)?.clippy()
}

fn find() -> Option<(Command, Vec<String>)> {
    let chosen = |compiler: Compiler| {
        static SAID: Once = Once::new();
        SAID.call_once(|| println!("with {compiler}"));
        compiler.cargo()
    };
    if let Some(compiler) = compilers::find_for(TARGET) {
        return Some(chosen(compiler));
    }
    let _ = shell::run(shell::program("rustup").args(["target", "add", TARGET]));
    if let Some(compiler) = compilers::find_for(TARGET) {
        return Some(chosen(compiler));
    }
    debian()
}

/// Debian's newer Rust, which has the library as source only.
fn debian() -> Option<(Command, Vec<String>)> {
    const CARGO: &str = "/usr/bin/cargo";
    const CORE: &str = "/usr/lib/rustlib/src/rust/library/core";
    if !Path::new(CORE).is_dir() {
        setup::apt_get(&["rustc-web", "cargo-web", "rust-web-src", "lld"]);
    }
    if !Path::new(CORE).is_dir() {
        return None;
    }
    println!("with Debian's compiler, its `core` built from source");
    let mut cargo = shell::program(CARGO);
    cargo
        .arg("build")
        .env("RUSTC", "/usr/bin/rustc")
        .env("RUSTC_BOOTSTRAP", "1")
        .env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", "ld.lld")
        .env_remove("RUSTUP_TOOLCHAIN");
    let options = [&format!("--target={TARGET}"), "-Zbuild-std=core"];
    Some((cargo, options.map(str::to_owned).to_vec()))
}
