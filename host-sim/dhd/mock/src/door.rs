//! A test's access to the mock library that the program has loaded: it plans faults and reads what the mock recorded.
#![allow(unsafe_code)] // To load the library: if the program has loaded the same file, both use one instance.

use crate::machine::machine;
use libloading::Library;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// Longest text that a test can send to the mock, bytes.
pub const TEXT: usize = 96;

/// Answers a test's question by a number, or adds a line to the plan of faults and returns 1. NaN for an unknown text.
///
/// Questions: `wrong`, `zero` and `released` (times in [`crate::machine::Noted`]), `now` (s), `force` and `longest` (acting and
/// largest force, N), `late` (forces after closing), `max` (force limit, N), `count CALL`, `open`. `wait S` advances a test's
/// clock.
pub(crate) fn answer(text: &[u8; TEXT]) -> f64 {
    let end = text.iter().position(|byte| *byte == 0).unwrap_or(TEXT);
    let Ok(text) = std::str::from_utf8(&text[..end]) else {
        return f64::NAN;
    };
    let mut machine = machine();
    let noted = machine.noted;
    let none = f64::INFINITY;
    match text.split_once(' ').unwrap_or((text, "")) {
        ("now", _) => machine.clock.now_s(),
        ("wait", seconds) => {
            machine.clock.pass(seconds.parse().unwrap_or(0.0), false);
            1.0
        }
        ("wrong", _) => noted.wrong_s.unwrap_or(none),
        ("zero", _) => noted.zero_s.unwrap_or(none),
        ("released", _) => noted.released_s.unwrap_or(none),
        ("force", _) => machine.acting_n().iter().map(|f| f * f).sum::<f64>().sqrt(),
        ("longest", _) => noted.longest_n,
        ("late", _) => noted.late_forces as f64,
        ("max", _) => machine.max_force_n,
        ("count", call) => machine.count(call) as f64,
        ("open", _) => f64::from(u8::from(machine.open)),
        _ if machine.plan(text) => 1.0,
        _ => f64::NAN,
    }
}

/// A test's own copy of the mock library. Because each test loads its own copy, tests that run at the same time do not share a
/// device.
#[derive(Debug)]
pub struct Door {
    library: Library,
    path: PathBuf,
}

/// Path of the mock library, which cargo builds next to the running test.
///
/// # Panics
/// The library is not there.
#[must_use]
pub fn built() -> PathBuf {
    let name = libloading::library_filename("touchstone_mock_dhd");
    let program = std::env::current_exe().expect("a program");
    let beside = program.with_file_name(&name);
    // Examples and the program itself lie one folder higher than tests.
    let deeper = program.with_file_name("deps").join(&name);
    let found = [beside, deeper].into_iter().find(|path| path.is_file());
    found.unwrap_or_else(|| panic!("no {} beside {}", name.display(), program.display()))
}

impl Door {
    /// Copies the mock library into a folder, loads the copy and gives it a plan of faults, one line per entry of `plan`.
    ///
    /// # Panics
    /// The library cannot be copied, or the plan is not understood.
    #[must_use]
    pub fn new(folder: &Path, plan: &[&str]) -> Self {
        Self::changed(folder, plan, |bytes| bytes)
    }

    /// Same as [`Door::new`], but applies `change` to the bytes of the copied library file.
    ///
    /// # Panics
    /// Same as [`Door::new`].
    #[must_use]
    pub fn changed(folder: &Path, plan: &[&str], change: impl Fn(Vec<u8>) -> Vec<u8>) -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        std::fs::create_dir_all(folder).expect("a folder");
        let name = format!("{}-{number}-libdhd.so", std::process::id());
        let path = folder.join(name);
        let bytes = std::fs::read(built()).expect("the library");
        std::fs::write(&path, change(bytes)).expect("a copy");
        // SAFETY: the library of this crate, whose initialisers do nothing.
        let library = unsafe { Library::new(&path) }.expect("the copy loads");
        let door = Self { library, path };
        for line in plan {
            assert!(door.ask(line) == 1.0, "no plan: {line}");
        }
        door
    }

    /// Path of the copied library.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Sends a question or a line of a fault plan to the mock and returns the mock's answer.
    ///
    /// # Panics
    /// The text is too long or not understood.
    #[must_use]
    pub fn ask(&self, text: &str) -> f64 {
        let mut bytes = [0; TEXT];
        bytes[..text.len()].copy_from_slice(text.as_bytes());
        type Answer = extern "system" fn(&[u8; TEXT]) -> f64;
        // SAFETY: the type of the function in `interface.rs` of this crate; called while the library is loaded.
        let answer = unsafe { self.library.get::<Answer>("touchstone_mock") };
        let said = answer.expect("the door")(&bytes);
        assert!(!said.is_nan(), "not understood: {text}");
        said
    }
}

impl Drop for Door {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}
