//! Helpers for tests with a whole knob, which a test starts and turns: `touchstone demo`, or the emulated firmware.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

const PROGRAM: &str = env!("CARGO_BIN_EXE_touchstone");

/// A running `touchstone demo --port-only` or emulated board; its process ends with the test.
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

    /// Starts a board's firmware in the emulator. `cargo xtask smartknob` sets the environment variables with their paths.
    #[cfg(target_os = "linux")]
    pub fn emulated() -> Self {
        let path = |name| std::env::var_os(name).unwrap_or_else(|| panic!("{name} is no path"));
        let mut process = Command::new(path("TOUCHSTONE_EMULATOR"))
            .arg("serve")
            .arg(path("TOUCHSTONE_EMULATED_FIRMWARE"))
            .args(["--tcp", "127.0.0.1:0", "--turned"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(process.stdout.take().unwrap()).lines();
        let said = lines.next().expect("the emulator ended").unwrap();
        let (_, address) = said.split_once("tcp:").expect("an address");
        let address = format!("tcp:{address}");
        // Reads and prints all further output; otherwise the emulator would block when the pipe is full.
        std::thread::spawn(move || {
            for line in lines.map_while(Result::ok) {
                eprintln!("emulator: {line}");
            }
        });
        Self { process, address }
    }

    /// Address of the demo's port, as the option `--port` takes it.
    pub fn address(&self) -> &str {
        &self.address
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
