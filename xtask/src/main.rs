//! The commands behind `cargo xtask`: set-up, test, measure.
//!
//! This crate decides which programs run and with which compiler, and prints the results. It uses only the standard library, so
//! that the first command starts within seconds. The crate `inspect/` reads the files that other programs write (firmware,
//! assembly, lists, reports); only the steps that need it build it.

mod ahead;
mod arduino;
mod bench;
mod board_scorecard;
mod changes;
mod chips;
mod counted;
mod cycles;
mod deny;
mod dist;
mod doc;
mod emulator;
mod faults;
mod fil;
mod firmware;
mod float_free;
mod fmt;
mod inspect;
mod ladder;
mod links;
mod lint;
mod live;
mod machine;
mod marked;
mod memo;
mod outcome;
mod packages;
mod page;
mod probe;
mod prove;
mod sabotage;
mod schema;
mod setup;
mod shell;
mod site;
mod smartknob;
mod step;
mod test;
mod thumb;
mod toolchain;
mod traces;
mod unit;
mod wasm;
mod wheel;

use std::process::ExitCode;

use step::{Gate, Gates, Share, Step};

/// Every `cargo xtask` command. A new command needs a `mod` above and an entry here.
const STEPS: &[Step] = &[
    Step {
        name: "test",
        about: "the steps marked `*` below, in order, with times and a summary of what ran and what was left out; exit code 1 if one \
                failed; `test --quick`: daily work; `test --full`: those marked `+` as well, for a night",
        gates: Gates::NONE,
        run: |args| test::run(STEPS, args),
    },
    Step {
        name: "machine",
        about: "what this machine has, and which compiler each step takes: for reports of failures",
        gates: Gates::ALL,
        run: machine::run,
    },
    Step {
        name: "setup",
        about: "what is installed, what is missing, what it is for and how to get it: `setup [--install [--full]]`",
        gates: Gates {
            quick: Share::LeftOut,
            test: Share::Whole,
            full: Share::Whole,
        },
        run: setup::run,
    },
    Step {
        name: "fmt",
        about: "the code is formatted (`fmt --write` formats it)",
        gates: Gates::ALL,
        run: fmt::run,
    },
    Step {
        name: "lint",
        about: "clippy on everything, warnings denied (`lint --workspace`: without the probe's crate, whose dependencies nothing else needs)",
        gates: lint::GATES,
        run: lint::run,
    },
    Step {
        name: "unit",
        about: "all tests of all crates, documentation examples included",
        gates: unit::GATES,
        run: unit::run,
    },
    Step {
        name: "schema",
        about: "results obey the documented JSON schema, under Python's validator",
        gates: Gates::FULL_ONLY,
        run: schema::run,
    },
    Step {
        name: "doc",
        about: "the documentation builds without a warning; README examples of the published crates run in a crate outside",
        gates: Gates::FULL_ONLY,
        run: doc::run,
    },
    Step {
        name: "float-free",
        about: "control and drive, as firmware builds them, have no float in their source, and neither float nor panic in their code",
        gates: float_free::GATES,
        run: float_free::run,
    },
    Step {
        name: "wasm",
        about: "control and the simulator's crates that a browser needs compile for wasm32-unknown-unknown; the live page's module is what \
                its source gives",
        gates: Gates::FULL_ONLY,
        run: wasm::run,
    },
    Step {
        name: "live",
        about: "makes the live page's WebAssembly anew, `host-sim/live/module`: after every change of what it is made of",
        gates: Gates::NONE,
        run: live::run,
    },
    Step {
        name: "page",
        about: "the live pages in Chromium and Firefox without a window: every control and preset, frames and ticks in real time, a record \
                that replays to the bit, a board's page before simulated knob and emulated firmware: `page [--short | SECONDS [FOLDER FOR PICTURES]]`",
        gates: Gates {
            quick: Share::LeftOut,
            test: page::SHORT_RUN,
            full: Share::Whole,
        },
        run: page::run,
    },
    Step {
        name: "thumb",
        about: "every law on an emulated Cortex-M4F: its bits are this machine's; instructions per tick, size, no panic",
        gates: Gates {
            quick: Share::LeftOut,
            test: Share::Whole,
            full: Share::Whole,
        },
        run: thumb::run,
    },
    Step {
        name: "chips",
        about: "the C library on emulated Cortex-M0, M4F and M33: its bits are this machine's; a table of sizes and instructions",
        gates: Gates::FULL_ONLY,
        run: chips::run,
    },
    Step {
        name: "firmware",
        about: "all boards' programs: sizes, stack, no panic, heap or float in their interrupts: `firmware [--board BOARD]`",
        gates: Gates {
            quick: Share::LeftOut,
            test: firmware::ONE_BOARD,
            full: Share::Whole,
        },
        run: firmware::run,
    },
    Step {
        name: "fil",
        about: "all boards' programs on an emulated chip with motor and hand; all fault injections: `fil [--sample | --brief | --only TEXT] [--board BOARD]`; parts of \
                their safety taken out, which rows must notice: `fil --sabotage [--only TEXT]`; a board's scorecard beside the desktop's: \
                `fil --scorecard [press]`",
        gates: Gates {
            quick: Share::LeftOut,
            test: fil::ONE_BOARD,
            full: fil::SAMPLED,
        },
        run: fil::run,
    },
    Step {
        name: "smartknob",
        about: "a program for a SmartKnob configures, turns and reads a knob through `touchstone bridge`, before the emulated firmware",
        gates: Gates::FULL_ONLY,
        run: smartknob::run,
    },
    Step {
        name: "faults",
        about: "what a hand gets from a knob on the desktop in which one part breaks, on all boards: the tables of docs/faults.md are still \
                right; `faults --write` writes them",
        gates: Gates::FULL_ONLY,
        run: faults::run,
    },
    Step {
        name: "links",
        about: "the link to a board or haptic device has 100 to 1,000 random faults, and no program leaves the device on \
                without saying so: `links [SEEDS]`",
        gates: Gates::FULL_ONLY,
        run: links::run,
    },
    Step {
        name: "traces",
        about: "what is expected at a first power-up, as pictures of the build guide made by the emulator: the same as those that are kept; \
                `traces --write` keeps them",
        gates: Gates::NONE,
        run: traces::run,
    },
    Step {
        name: "cycles",
        about: "instructions and table cycles of law, control interrupt and current loop in that program; its stack",
        gates: Gates::FULL_ONLY,
        run: cycles::run,
    },
    Step {
        name: "bench",
        about: "instructions per tick of an example, counted by valgrind: `bench [EXAMPLE [TICKS MORE_TICKS]] [-- ARGS]`; of every effect of a scene alone and in \
                pairs: `bench --ladder [--write]`",
        gates: Gates::FULL_ONLY,
        run: bench::run,
    },
    Step {
        name: "deny",
        about: "what the project depends on: crates that stand twice; licences and advisories, where cargo-deny is installed",
        gates: Gates::FULL_ONLY,
        run: deny::run,
    },
    Step {
        name: "probe",
        about: "boards behind a probe by the crate probe-rs, which `dist` builds with and nothing else: clippy, and tests on a chip in software",
        gates: Gates::NONE,
        run: probe::run,
    },
    Step {
        name: "dist",
        about: "an archive with which a maker needs no compiler, in `target/dist`: program, every board's firmware, guide, licences, \
                checksums; unpacked and tried",
        gates: Gates::NONE,
        run: dist::run,
    },
    Step {
        name: "arduino",
        about: "the C library for Arduino and PlatformIO, compiled for Cortex-M0 to M33, `target/arduino`; its sketches compile with it",
        gates: Gates::FULL_ONLY,
        run: arduino::run,
    },
    Step {
        name: "wheel",
        about: "the Python package with the program in it, `target/wheel`: built by maturin, installed, its tests run",
        gates: Gates::FULL_ONLY,
        run: wheel::run,
    },
    Step {
        name: "site",
        about: "book, live pages, a report and the API's documentation in one folder for any static host, `target/site`; links and loads checked",
        gates: Gates::FULL_ONLY,
        run: site::run,
    },
    Step {
        name: "prove",
        about: "the proofs: `prove [--harness NAME] [--bless] [--resume] [--theorems]`, or wrong changes that they must find: `prove --mutants [--tests] [--shard I/N]`, `--mutants --theorems`",
        gates: prove::GATES,
        run: prove::run,
    },
];

fn help() -> String {
    let mut text = String::from("Usage: cargo xtask COMMAND\n\n");
    for step in STEPS {
        let mark = match step.gates {
            gates if gates.test != Share::LeftOut => '*',
            gates if gates.full != Share::LeftOut => '+',
            _ => ' ',
        };
        text += &format!("{mark} {:<11}{}\n", step.name, step.about);
    }
    text += "\n* is a step of `cargo xtask test`, + of `cargo xtask test --full` alone. Exit code: 0 done, 1 failed, 2 wrong usage, 77 not run.\n";
    text += "\n`cargo xtask test` leaves out:\n";
    text += &test::left_out(STEPS, Gate::Test);
    text += "\n`cargo xtask test --quick` leaves out:\n";
    text + &test::left_out(STEPS, Gate::Quick)
}

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let name = args.first().map_or("help", String::as_str);
    if matches!(name, "help" | "-h" | "--help") {
        print!("{}", help());
        return ExitCode::SUCCESS;
    }
    let Some(step) = STEPS.iter().find(|step| step.name == name) else {
        eprint!("xtask: there is no command `{name}`\n\n{}", help());
        return ExitCode::from(2);
    };
    let outcome = (step.run)(&args[1..]);
    eprintln!("{name}: {outcome}");
    outcome.exit_code()
}
