//! `touchstone flash`, with a probe-rs that only writes down what it was asked.
#![cfg(unix)]

use crate::{Said, folder, program, script};
use std::path::Path;
use std::process::Command;
use touchstone_protocol::Board;

/// The start of an ELF program for a 32-bit Arm.
fn elf(path: &Path) {
    let mut bytes = b"\x7fELF\x01\x01\x01".to_vec();
    bytes.resize(18, 0);
    bytes.extend([40, 0]);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, bytes).unwrap();
}

/// Runs the program in a folder, with its `bin` as the only PATH.
fn run(folder: &Path, arguments: &[&str]) -> Said {
    std::fs::create_dir_all(folder.join("bin")).unwrap();
    let mut command = program(arguments);
    command
        .current_dir(folder)
        .env("PATH", folder.join("bin"))
        .env_remove("CARGO_TARGET_DIR");
    command.output().unwrap().into()
}

#[test]
fn the_built_program_is_downloaded_verified_and_started() {
    let here = folder("flash");
    elf(&here.join("target/firmware/b-g431b-esc1/touchstone.elf"));
    let bin = here.join("bin");
    std::fs::create_dir_all(&bin).unwrap();
    script(&bin, "probe-rs", "echo \"$@\" >> asked");
    let said = run(&here, &["flash", "--board", "b-g431b-esc1"]).done();
    assert!(
        said.contains("STM32G431CBUx") && said.contains("flashed, verified and started"),
        "{said}"
    );
    elf(&here.join("own.elf"));
    run(
        &here,
        &[
            "flash",
            "own.elf",
            "--board",
            "nucleo-g474re",
            "--probe",
            "0483:374e:X",
        ],
    )
    .done();
    assert_eq!(
        std::fs::read_to_string(here.join("asked")).unwrap(),
        "download --chip STM32G431CBUx --verify target/firmware/b-g431b-esc1/touchstone.elf\n\
         reset --chip STM32G431CBUx\n\
         download --chip STM32G474RETx --probe 0483:374e:X --verify own.elf\n\
         reset --chip STM32G474RETx --probe 0483:374e:X\n"
    );
}

#[test]
fn what_is_missing_is_named() {
    let here = folder("flash-missing");
    run(&here, &["flash", "--board", "nucleo-g474re"]).failed(
        2,
        &[
            "nucleo-g474re/touchstone.elf",
            "cargo xtask firmware --board nucleo-g474re",
        ],
    );
    std::fs::write(here.join("text.elf"), "no program").unwrap();
    run(&here, &["flash", "text.elf", "--board", "nucleo-g474re"])
        .failed(2, &["is no ELF program for a 32-bit Arm"]);
    elf(&here.join("own.elf"));
    run(&here, &["flash", "own.elf", "--board", "nucleo-g474re"]).failed(
        1,
        &[
            "probe-rs: is not on the PATH",
            "cargo install probe-rs-tools",
        ],
    );
    script(&here.join("bin"), "probe-rs", "exit 3");
    run(&here, &["flash", "own.elf", "--board", "nucleo-g474re"])
        .failed(1, &["exit status: 3", "touchstone doctor"]);
    let said = run(&here, &["flash", "own.elf", "--board", "uno"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("b-g431b-esc1"), "{}", said.err);
}

/// As an archive of `cargo xtask dist` has it: no compiler, no probe-rs, nothing on the PATH, another folder to work in.
#[test]
fn the_programs_that_came_with_it_are_found_beside_it() {
    let here = folder("flash-archive");
    let archive = here.join("unpacked");
    for board in Board::ALL {
        let board = board.name();
        elf(&archive.join(format!("firmware/{board}/touchstone.elf")));
    }
    // What somebody built once, here: another version than the program that runs.
    elf(&here.join("target/firmware/nucleo-g474re/touchstone.elf"));
    let touchstone = archive.join("touchstone");
    std::fs::hard_link(env!("CARGO_BIN_EXE_touchstone"), &touchstone)
        .or_else(|_| std::fs::copy(env!("CARGO_BIN_EXE_touchstone"), &touchstone).map(drop))
        .unwrap();
    let asked = |arguments: &[&str]| -> Said {
        let mut command = Command::new(&touchstone);
        command.args(arguments).current_dir(&here).env("PATH", "");
        command
            .env_remove("CARGO_TARGET_DIR")
            .output()
            .unwrap()
            .into()
    };
    let said = asked(&["flash", "--board", "nucleo-g474re", "--dry-run"]).done();
    let program = archive.canonicalize().unwrap();
    let program = program.join("firmware/nucleo-g474re/touchstone.elf");
    let program = program.display();
    assert_eq!(
        said,
        format!(
            "{program} into STM32G474RETx\n\
             probe-rs download --chip STM32G474RETx --verify {program}\n\
             probe-rs reset --chip STM32G474RETx\n\
             nothing was written\n"
        )
    );
    asked(&["flash", "--board", "nucleo-g474re"]).failed(1, &["probe-rs: is not on the PATH"]);
    let doctor = asked(&["doctor", "--port", "tcp:127.0.0.1:1"]).out;
    assert!(
        doctor.contains("every board's program came with this one")
            && doctor.contains(&format!("nucleo-g474re: {program}")),
        "{doctor}"
    );
    // A file that is broken is found before it is needed.
    std::fs::write(archive.join("firmware/b-g431b-esc1/touchstone.elf"), "cut").unwrap();
    asked(&["flash", "--board", "b-g431b-esc1", "--dry-run"])
        .failed(2, &["is no ELF program", "from one archive"]);
}
