//! The commands behind `cargo xtask`: set-up, test, measure. Little beyond the standard library, so that the first one starts
//! in seconds.

mod bench;
mod copy;
mod cycles;
mod doc;
mod emulator;
mod fil;
mod firmware;
mod float_free;
mod fmt;
mod lint;
mod microcontroller;
mod mutants;
mod outcome;
mod prove;
mod sabotage;
mod schema;
mod setup;
mod shell;
mod test;
mod thumb;
mod unit;

use std::process::ExitCode;

use outcome::Outcome;

/// One row of `cargo xtask`.
struct Command {
    name: &'static str,
    about: &'static str,
    /// `cargo xtask test` runs it, in the order of the table.
    in_test: bool,
    run: fn(&[String]) -> Outcome,
}

/// Every command. A new one is a `mod` above and a row here; a module that ends in an [`ExitCode`] gets its row as
/// `run: |args| module::run(args).into()`.
const COMMANDS: &[Command] = &[
    Command {
        name: "test",
        about: "all of the marked steps below, in order, with times and a summary; exit code 1 if one failed",
        in_test: false,
        run: test::run,
    },
    Command {
        name: "setup",
        about: "what is installed, what is missing, what it is for and how to get it",
        in_test: true,
        run: setup::run,
    },
    Command {
        name: "fmt",
        about: "the code is formatted (`fmt --write` formats it)",
        in_test: true,
        run: fmt::run,
    },
    Command {
        name: "lint",
        about: "clippy on everything, warnings denied",
        in_test: true,
        run: lint::run,
    },
    Command {
        name: "unit",
        about: "all tests of all crates, documentation examples included",
        in_test: true,
        run: unit::run,
    },
    Command {
        name: "schema",
        about: "results obey the documented JSON schema, under Python's validator",
        in_test: true,
        run: schema::run,
    },
    Command {
        name: "doc",
        about: "the documentation builds without a warning",
        in_test: true,
        run: doc::run,
    },
    Command {
        name: "float-free",
        about: "control and drive, as firmware builds them, have no float in their source, and neither float nor panic in their code",
        in_test: true,
        run: float_free::run,
    },
    Command {
        name: "thumb",
        about: "every law on an emulated Cortex-M4F: its bits are this machine's; instructions per tick, size, no panic",
        in_test: true,
        run: thumb::run,
    },
    Command {
        name: "firmware",
        about: "both boards' programs: sizes, stack, no panic, heap or float in their interrupts: `firmware [--board BOARD]`",
        in_test: true,
        run: firmware::run,
    },
    Command {
        name: "fil",
        about: "both boards' programs on an emulated chip with motor and hand; all fault injections: `fil [--only TEXT]`; parts of \
                their safety taken out, which rows must notice: `fil --sabotage [--only TEXT]`",
        in_test: true,
        run: fil::run,
    },
    Command {
        name: "cycles",
        about: "instructions and table cycles of law, control interrupt and current loop in that program; its stack",
        in_test: true,
        run: cycles::run,
    },
    Command {
        name: "bench",
        about: "instructions per tick of an example, counted by valgrind: `bench [EXAMPLE [TICKS MORE_TICKS]] [-- ARGS]`",
        in_test: true,
        run: bench::run,
    },
    Command {
        name: "prove",
        about: "the proofs: `prove [--harness NAME] [--bless]`, or wrong changes that they must find: `prove --mutants [--tests]`",
        in_test: true,
        run: prove::run,
    },
];

fn help() -> String {
    let mut text = String::from("Usage: cargo xtask COMMAND\n\n");
    for command in COMMANDS {
        let mark = if command.in_test { '*' } else { ' ' };
        text += &format!("{mark} {:<11}{}\n", command.name, command.about);
    }
    text + "\n* is a step of `cargo xtask test`. Exit code: 0 done, 1 failed, 2 wrong usage, 77 not run.\n"
}

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let name = args.first().map_or("help", String::as_str);
    if matches!(name, "help" | "-h" | "--help") {
        print!("{}", help());
        return ExitCode::SUCCESS;
    }
    let Some(command) = COMMANDS.iter().find(|command| command.name == name) else {
        eprint!("xtask: there is no command `{name}`\n\n{}", help());
        return ExitCode::from(2);
    };
    let outcome = (command.run)(&args[1..]);
    eprintln!("{name}: {outcome}");
    outcome.exit_code()
}
