//! Command line of the emulator. `cargo xtask fil` and `cargo xtask cycles` build the firmware and run these commands.

use std::path::Path;
use std::process::ExitCode;

use touchstone_emulator::bench::{Bench, Setup};
use touchstone_emulator::board::Board;
use touchstone_emulator::cpu::RAM;
use touchstone_emulator::cpu::elf::Program;
use touchstone_emulator::fil::jobs::{Asked, Programs};
use touchstone_emulator::played::{HandProgramme, played};
use touchstone_emulator::traces::{self, Trace};
use touchstone_emulator::world::Parts;
use touchstone_emulator::{count, fil, serve};

const USAGE: &str = "Usage: touchstone-emulator COMMAND ELF

  fil [--BOARD ELF]... [--sample | --brief | --only TEXT...]
                              boot, calibrate, arm, press, and all fault injections, on the boards whose programs are named,
                              as in --nucleo-g474re ELF; those with one of the TEXTs in `BOARD, ENCODER: INJECTION, STATE`; --sample: one injection of three, few checks but on
                              nucleo-g474re-ihm16m1, no cogging; --brief: the same injections, and the checks that are done soon
  boot ELF [BOARD]            boot, calibrate, arm, press; nucleo-g474re if no other is named
  cycles [--BOARD ELF]...     instructions and table cycles of law, control interrupt, current loop; the stack
  noise ELF FRAMES            random frames at the serial port
  play ELF BOARD PROGRAMME.csv RECORDING.csv
                              a hand does what touchstone scorecard --programme wrote; what the board told and the shaft did, tick by tick,
                              for touchstone compare --hand programme
  trace ELF BOARD WHAT FILE.csv
                              what is seen at a first power-up: pwm, step, calibration, press
  ram ELF BOARD FILE          boot; then what the RAM holds, the log's ring among it: for the tests of touchstone-probe
  serve ELF --tcp HOST:PORT [--hand | --turned] [--for SECONDS] [--parts R,L,FLUX,J,B,FRICTION]
                              the serial port on a socket, in real time; --hand: a hand presses now and then; --turned: it turns the knob as
                              lines of the standard input say, `turn DEGREES`, `free` or `reset`; --parts: the usual motor and knob, each of these by
                              a factor";

/// Exit code for a command that failed. 0 means success.
const FAILED: u8 = 1;
const WRONG_USAGE: u8 = 2;

/// The checks and injections that the command line selects.
#[derive(Debug, Default)]
struct Wanted<'a> {
    sample: Option<Asked<'a>>,
    only: Vec<&'a str>,
}

impl Wanted<'_> {
    fn asked(&self) -> Asked<'_> {
        match (self.sample, self.only.as_slice()) {
            (Some(sample), _) => sample,
            (None, []) => Asked::Everything,
            (None, texts) => Asked::Only(texts),
        }
    }
}

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    let code = match words.split_first() {
        Some((&"fil", options)) => boards(options).map_or_else(
            |code| code,
            |(programs, wanted)| fil::report::run(&programs, wanted.asked()),
        ),
        Some((&"cycles", options)) => boards(options).map_or_else(
            |code| code,
            |(programs, wanted)| {
                if wanted.asked() == Asked::Everything {
                    count::run(&programs)
                } else {
                    usage()
                }
            },
        ),
        Some((command, [elf, more @ ..])) => match read(elf) {
            Ok(program) => other(command, &program, more),
            Err(code) => code,
        },
        _ => usage(),
    };
    ExitCode::from(code)
}

fn usage() -> u8 {
    eprintln!("{USAGE}");
    WRONG_USAGE
}

fn read(elf: &str) -> Result<Program, u8> {
    Program::read(Path::new(elf)).map_err(|error| {
        eprintln!("emulator: {error}; build it with cargo xtask firmware");
        FAILED
    })
}

/// Parses the options of `fil` and `cycles`: the program of each board, and the selection of checks, in any order.
fn boards<'a>(mut options: &[&'a str]) -> Result<(Programs, Wanted<'a>), u8> {
    let mut programs = Programs::default();
    let mut wanted = Wanted::default();
    while let [option, more @ ..] = options {
        options = more;
        let sample = match *option {
            "--sample" => Some(Asked::Sample),
            "--brief" => Some(Asked::Brief),
            _ => None,
        };
        if sample.is_some() {
            wanted.sample = sample;
            continue;
        }
        let [value, more @ ..] = options else {
            return Err(usage());
        };
        options = more;
        let name = option.strip_prefix("--");
        let board = name.and_then(board_of);
        match (*option, board) {
            ("--only", _) => wanted.only.push(*value),
            (_, Some(board)) => programs.add(board.name, read(value)?),
            _ => return Err(usage()),
        }
    }
    if programs.count() == 0 || wanted.sample.is_some() && !wanted.only.is_empty() {
        return Err(usage());
    }
    Ok((programs, wanted))
}

/// Runs a command that takes one firmware program, and returns the exit code.
fn other(command: &str, program: &Program, words: &[&str]) -> u8 {
    let said = |result: Result<String, String>| match result {
        Ok(text) => {
            println!("{text}");
            0
        }
        Err(error) => {
            println!("WRONG: {error}");
            FAILED
        }
    };
    match (command, words) {
        ("boot", []) => said(fil::report::boot(program, &Setup::default())),
        ("boot", [board]) => match board_of(board) {
            Some(board) => said(fil::report::boot(program, &Setup::on(board))),
            None => usage(),
        },
        ("play", [board, programme, recording]) => match board_of(board) {
            Some(board) => said(play(
                program,
                board,
                Path::new(programme),
                Path::new(recording),
            )),
            None => usage(),
        },
        ("trace", [board, what, file]) => match (board_of(board), Trace::by_name(what)) {
            (Some(board), Some(trace)) => said(traces::write(
                program,
                &Setup::on(board),
                trace,
                Path::new(file),
            )),
            _ => usage(),
        },
        ("ram", [board, file]) => match board_of(board) {
            Some(board) => said(ram(program, board, Path::new(file))),
            None => usage(),
        },
        ("serve", ["--tcp", address, more @ ..]) => {
            let wanted = match serve_options(more) {
                Ok(options) => options,
                Err(error) => {
                    eprintln!("emulator: {error}");
                    return WRONG_USAGE;
                }
            };
            match serve::serve(program, address, wanted) {
                Ok(()) => 0,
                Err(error) => {
                    eprintln!("emulator: {error}");
                    FAILED
                }
            }
        }
        ("noise", [frames]) => match frames.parse() {
            Ok(frames) => said(fil::checks::noise(program, &Setup::default(), frames)),
            Err(_) => {
                eprintln!(
                    "emulator: noise needs how many frames, as in noise ELF 1000000, not `{frames}`"
                );
                WRONG_USAGE
            }
        },
        _ => usage(),
    }
}

/// The board whose firmware program has this name.
fn board_of(name: &str) -> Option<Board> {
    Board::all().into_iter().find(|board| board.name == name)
}

/// Replays a file of recorded hand actions on the emulated device, and writes the recording to another file.
fn play(
    program: &Program,
    board: Board,
    programme: &Path,
    recording: &Path,
) -> Result<String, String> {
    let programme = HandProgramme::read(programme)?;
    let text = played(program, &Setup::on(board), &programme)?;
    let written = std::fs::write(recording, &text);
    written.map_err(|error| format!("{}: {error}", recording.display()))?;
    let deeds = programme.deeds.len();
    Ok(format!(
        "{deeds} deeds, {} ticks in {}",
        text.lines().count() - 1 - deeds,
        recording.display()
    ))
}

/// Boots the device, then writes the content of the device's RAM to a file.
fn ram(program: &Program, board: Board, file: &Path) -> Result<String, String> {
    let ram_bytes = board.ram_bytes;
    let mut bench = Bench::new(program, &Setup::on(board))?;
    bench.boot()?;
    let bytes = bench.machine.memory(RAM, ram_bytes);
    std::fs::write(file, &bytes).map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(format!("{} bytes in {}", bytes.len(), file.display()))
}

/// Parses the options of `serve`: `--hand`, `--turned`, `--for SECONDS` and `--parts FACTORS`, in any order.
fn serve_options(words: &[&str]) -> Result<serve::Wanted, String> {
    let mut wanted = serve::Wanted::default();
    let mut words = words.iter();
    while let Some(word) = words.next() {
        match *word {
            "--hand" => wanted.hand = true,
            "--turned" => wanted.turned = true,
            "--for" => {
                let seconds = words.next().and_then(|seconds| seconds.parse().ok());
                wanted.for_s = Some(seconds.ok_or("--for needs whole seconds, as in --for 60")?);
            }
            "--parts" => {
                let factors: Option<Vec<f64>> = words
                    .next()
                    .and_then(|list| list.split(',').map(|it| it.parse().ok()).collect());
                let factors = factors.and_then(|all| <[f64; 6]>::try_from(all).ok());
                wanted.parts = Parts::scaled(
                    factors
                        .filter(|all| all.iter().all(|it| *it > 0.0))
                        .ok_or("--parts needs six factors, as in --parts 1,1,1,1,1,1")?,
                );
            }
            other => {
                return Err(format!(
                    "serve takes --hand, --turned, --for SECONDS and --parts FACTORS, not `{other}`"
                ));
            }
        }
    }
    Ok(wanted)
}
