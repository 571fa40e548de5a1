//! The emulator's commands. `cargo xtask fil` and `cargo xtask cycles` build the firmware and call them.

use std::path::Path;
use std::process::ExitCode;

use touchstone_emulator::board::{Board, Encoder};
use touchstone_emulator::cpu::elf::Program;
use touchstone_emulator::{count, fil, serve};

const USAGE: &str = "Usage: touchstone-emulator COMMAND ELF

  fil ELF [--only TEXT]       boot, calibrate, arm, press, and all fault injections
  boot ELF [b-g431b-esc1]     boot, calibrate, arm, press; on the other board with its program
  cycles ELF                  instructions and table cycles of law, control interrupt, current loop; the stack
  noise ELF FRAMES            random frames at the serial port
  serve ELF --tcp HOST:PORT [--hand] [--for SECONDS]
                              the serial port on a socket, in real time; --hand: a hand presses now and then";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    let (Some(command), Some(elf)) = (words.first(), words.get(1)) else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let program = match Program::read(Path::new(elf)) {
        Ok(program) => program,
        Err(error) => {
            eprintln!("emulator: {error}; build it with cargo xtask firmware");
            return ExitCode::FAILURE;
        }
    };
    let said = |result: Result<String, String>| match result {
        Ok(text) => {
            println!("{text}");
            0
        }
        Err(error) => {
            println!("WRONG: {error}");
            1
        }
    };
    ExitCode::from(match (*command, &words[2..]) {
        ("fil", []) => fil::report::run(&program, None),
        ("fil", ["--only", text]) => fil::report::run(&program, Some(text)),
        ("boot", []) => said(fil::report::boot(
            &program,
            Board::nucleo_g474re(Encoder::As5047p),
        )),
        ("boot", ["b-g431b-esc1"]) => said(fil::report::boot(&program, Board::b_g431b_esc1())),
        ("cycles", []) => count::run(&program),
        ("serve", ["--tcp", address, more @ ..]) => {
            let (hand, for_s) = match serve_options(more) {
                Ok(options) => options,
                Err(error) => {
                    eprintln!("emulator: {error}");
                    return ExitCode::from(2);
                }
            };
            match serve::serve(&program, address, hand, for_s) {
                Ok(()) => 0,
                Err(error) => {
                    eprintln!("emulator: {error}");
                    1
                }
            }
        }
        ("noise", [frames]) => match frames.parse() {
            Ok(frames) => said(fil::report::noise(&program, frames)),
            Err(_) => {
                eprintln!(
                    "emulator: noise needs how many frames, as in noise ELF 1000000, not `{frames}`"
                );
                2
            }
        },
        _ => {
            eprintln!("{USAGE}");
            2
        }
    })
}

/// `--hand` and `--for SECONDS`, in any order.
fn serve_options(words: &[&str]) -> Result<(bool, Option<u64>), String> {
    let (mut hand, mut for_s) = (false, None);
    let mut words = words.iter();
    while let Some(word) = words.next() {
        match *word {
            "--hand" => hand = true,
            "--for" => {
                let seconds = words.next().and_then(|seconds| seconds.parse().ok());
                for_s = Some(seconds.ok_or("--for needs whole seconds, as in --for 60")?);
            }
            other => {
                return Err(format!(
                    "serve takes --hand and --for SECONDS, not `{other}`"
                ));
            }
        }
    }
    Ok((hand, for_s))
}
