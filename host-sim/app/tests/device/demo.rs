//! Helpers for tests with `touchstone demo`: a complete simulated knob, which a test starts and turns.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

const PROGRAM: &str = env!("CARGO_BIN_EXE_touchstone");

/// A running `touchstone demo --port-only`; its process ends with the test.
pub struct Demo {
    pub process: Child,
    address: String,
}

impl Demo {
    pub fn new() -> Self {
        Self::with_input(Stdio::piped())
    }

    /// Starts the demo with this standard input.
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

    /// The program's command with these arguments, connected to the demo's port; not yet run.
    pub fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(PROGRAM);
        command.args(words).args(["--port", &self.address]);
        command
    }

    /// Writes a line to the demo's standard input, which moves or disturbs the simulated knob.
    pub fn happens(&mut self, what: &str) {
        use std::io::Write;
        let input = self.process.stdin.as_mut().unwrap();
        writeln!(input, "{what}").unwrap();
    }

    /// Runs the program with these arguments at the demo's port; returns its standard output.
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
