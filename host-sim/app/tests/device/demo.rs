//! A simulated knob, whole, that a test starts and turns.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

const PROGRAM: &str = env!("CARGO_BIN_EXE_touchstone");

/// `touchstone demo --port-only`, ended with the test.
pub struct Demo {
    pub process: Child,
    address: String,
}

impl Demo {
    pub fn new() -> Self {
        Self::with_input(Stdio::piped())
    }

    /// The same, with another standard input.
    pub fn with_input(input: Stdio) -> Self {
        let mut process = Command::new(PROGRAM)
            .args(["--quiet", "demo", "--port-only", "--listen", "127.0.0.1:0"])
            .stdin(input)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut address = String::new();
        let said = process.stdout.take().unwrap();
        BufReader::new(said).read_line(&mut address).unwrap();
        Self {
            process,
            address: address.trim().into(),
        }
    }

    /// The program with these words, at the knob's port.
    pub fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(PROGRAM);
        command.args(words).args(["--port", &self.address]);
        command
    }

    /// Something happens to the knob: a line of the demo's standard input.
    pub fn happens(&mut self, what: &str) {
        use std::io::Write;
        let input = self.process.stdin.as_mut().unwrap();
        writeln!(input, "{what}").unwrap();
    }

    /// What the program says with these words.
    pub fn run(&self, words: &[&str]) -> String {
        let output = self.command(words).output().unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        let why = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{words:?}: {said}{why}");
        said
    }
}

impl Drop for Demo {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
