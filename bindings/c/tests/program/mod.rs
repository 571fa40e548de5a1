//! Compiles C and C++ programs with the library, as a user's build does, and runs them.
#![allow(dead_code, reason = "each test file uses a part of it")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// The sanitizers under which the programs run. Errors that they find end the program with an error code.
pub const SANITIZERS: [&str; 2] = [
    "-fsanitize=address,undefined,float-cast-overflow",
    "-fno-sanitize-recover=all",
];

/// A program that is compiled from C or C++ sources.
pub struct Program {
    name: &'static str,
    compiler: &'static str,
    arguments: Vec<String>,
}

/// Path of the static C library, which cargo builds next to this test and in the same profile.
pub fn library() -> PathBuf {
    let test = std::env::current_exe().expect("this test's path");
    let folder = test.parent().expect("deps");
    let built = std::fs::read_dir(folder).expect("deps can be read");
    let newest = built
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with("libtouchstone_c") && name.ends_with(".a")
        })
        .max_by_key(|path| path.metadata().and_then(|it| it.modified()).ok());
    newest.expect("libtouchstone_c.a beside the test")
}

/// Whether a program of the system can be started. Prints a note if not.
pub fn is_here(program: &str) -> bool {
    let here = Command::new(program).arg("--version").output().is_ok();
    if !here {
        eprintln!("not run: no `{program}` here");
    }
    here
}

/// A number that a user of the tests gives in an environment variable, or the default.
pub fn number(variable: &str, default: u64) -> u64 {
    std::env::var(variable).map_or(default, |text| {
        let number = text.replace('_', "").parse();
        number.unwrap_or_else(|_| panic!("{variable} = {text}: give a whole number"))
    })
}

impl Program {
    /// A program in C99; warnings are errors.
    pub fn c(name: &'static str, sources: &[&str]) -> Self {
        Self::new(name, "cc", &["-std=c99"], sources)
    }

    /// A program in C++17, also from sources with Arduino's ending `.ino`; warnings are errors.
    pub fn cpp(name: &'static str, sources: &[&str]) -> Self {
        Self::new(name, "c++", &["-std=c++17", "-x", "c++"], sources)
    }

    fn new(name: &'static str, compiler: &'static str, first: &[&str], sources: &[&str]) -> Self {
        let mut arguments: Vec<String> = ["-Wall", "-Wextra", "-Werror", "-O1", "-g"]
            .iter()
            .chain(first)
            .map(ToString::to_string)
            .collect();
        arguments.push(format!("-I{ROOT}/include"));
        arguments.extend(sources.iter().map(|source| format!("{ROOT}/{source}")));
        Self {
            name,
            compiler,
            arguments,
        }
    }

    /// This program with further arguments for the compiler.
    pub fn with(mut self, arguments: &[&str]) -> Self {
        self.arguments
            .extend(arguments.iter().map(ToString::to_string));
        self
    }

    /// This program with a folder of headers, relative to the crate.
    pub fn with_headers(self, folder: &str) -> Self {
        let folder = format!("-I{ROOT}/{folder}");
        self.with(&[&folder])
    }

    /// Compiles the program and runs it with these arguments. Returns `None`, with a note, where the compiler is missing.
    pub fn run(&self, arguments: &[&str]) -> Option<Output> {
        if !is_here(self.compiler) {
            return None;
        }
        let name = format!("touchstone-c-{}-{}", self.name, std::process::id());
        let program = std::env::temp_dir().join(name);
        let built = Command::new(self.compiler)
            .args(&self.arguments)
            .args(["-x", "none"])
            .arg(library())
            .args(["-lpthread", "-ldl", "-lm", "-o"])
            .arg(&program)
            .output()
            .expect("the compiler can be started");
        assert!(
            built.status.success(),
            "{}",
            String::from_utf8_lossy(&built.stderr)
        );
        let ran = Command::new(&program)
            .args(arguments)
            .output()
            .expect("the program can be started");
        std::fs::remove_file(&program).expect("the program can be removed");
        Some(ran)
    }

    /// Compiles and runs the program, which must end without an error. Returns what it printed.
    pub fn said(&self, arguments: &[&str]) -> Option<String> {
        self.run(arguments).map(|ran| {
            let said = String::from_utf8_lossy(&ran.stdout).into_owned();
            let complaint = String::from_utf8_lossy(&ran.stderr);
            assert!(
                ran.status.success(),
                "{}: {}: {said}{complaint}",
                self.name,
                ran.status
            );
            print!("{said}");
            said
        })
    }
}

/// The path of a file of this crate.
pub fn file(name: &str) -> PathBuf {
    Path::new(ROOT).join(name)
}
