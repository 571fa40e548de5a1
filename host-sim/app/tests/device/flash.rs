//! Tests of `touchstone flash` and `log`, with a fake program probe-rs that only records its arguments, or with the probe-rs crate
//! and no debug probe.
#![cfg(unix)]

#[cfg(not(feature = "probe"))]
use crate::script;
use crate::{Said, folder, program};
use std::path::Path;
use std::process::Command;
use touchstone_protocol::Board;

/// Writes a 32-bit Arm ELF file with a board's name. The file has 16 bytes for the start of the flash.
fn elf_of(path: &Path, board: &str) {
    let mut bytes = b"\x7fELF\x01\x01\x01".to_vec();
    bytes.resize(16, 0);
    let words = |bytes: &mut Vec<u8>, all: &[u32]| {
        all.iter().for_each(|word| bytes.extend(word.to_le_bytes()));
    };
    let name = format!("\0touchstone_board_{}\0", board.replace('-', "_"));
    let names = name.len() as u32;
    // An ELF executable for Arm. After its headers it contains one program segment for the start of the flash memory. Then come the
    // symbol table, with an empty symbol and one without an address, and the symbol names. The headers of an empty section, of the
    // symbol table and of the names follow.
    words(
        &mut bytes,
        &[40 << 16 | 2, 1, 0x0800_0000, 52, 132 + names, 0],
    );
    words(&mut bytes, &[32 << 16 | 52, 40 << 16 | 1, 3]);
    words(&mut bytes, &[1, 84, 0x0800_0000, 0x0800_0000, 16, 16, 5, 4]);
    bytes.extend([7; 16]);
    words(&mut bytes, &[0, 0, 0, 0, 1, 0, 0, 0xfff1 << 16 | 0x10]);
    bytes.extend(name.bytes());
    words(&mut bytes, &[0; 10]);
    words(&mut bytes, &[0, 2, 0, 0, 100, 32, 2, 1, 4, 16]);
    words(&mut bytes, &[0, 3, 0, 0, 132, names, 0, 0, 1, 0]);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, bytes).unwrap();
}

/// Runs the program in a folder; PATH contains only the folder's `bin`.
fn run(folder: &Path, arguments: &[&str]) -> Said {
    std::fs::create_dir_all(folder.join("bin")).unwrap();
    let mut command = program(arguments);
    command
        .current_dir(folder)
        .env("PATH", folder.join("bin"))
        .env_remove("CARGO_TARGET_DIR");
    command.output().unwrap().into()
}

#[cfg(not(feature = "probe"))]
#[test]
fn the_built_program_is_downloaded_verified_and_started() {
    let here = folder("flash");
    let built = here.join("target/firmware/b-g431b-esc1/touchstone.elf");
    elf_of(&built, "b-g431b-esc1");
    let bin = here.join("bin");
    std::fs::create_dir_all(&bin).unwrap();
    script(&bin, "probe-rs", "echo \"$@\" >> asked");
    let said = run(&here, &["flash", "--board", "b-g431b-esc1"]).done();
    assert!(
        said.contains("STM32G431CBUx") && said.contains("flashed, verified and started"),
        "{said}"
    );
    elf_of(&here.join("own.elf"), "nucleo-g474re");
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

#[cfg(not(feature = "probe"))]
#[test]
fn a_log_is_shown_after_the_flash_and_by_itself() {
    let here = folder("flash-log");
    elf_of(&here.join("own.elf"), "b-g431b-esc1");
    std::fs::create_dir_all(here.join("bin")).unwrap();
    let asked = "echo \"$@\" >> asked\nif [ $1 = attach ]; then echo boot; fi";
    script(&here.join("bin"), "probe-rs", asked);
    let flash = ["flash", "own.elf", "--board", "b-g431b-esc1", "--log"];
    assert!(run(&here, &flash).done().ends_with("boot\n"));
    let log = [
        "log",
        "own.elf",
        "--board",
        "b-g431b-esc1",
        "--probe",
        "0483:374e",
    ];
    assert!(run(&here, &log).done().ends_with("boot\n"));
    assert_eq!(
        std::fs::read_to_string(here.join("asked")).unwrap(),
        "download --chip STM32G431CBUx --verify own.elf\n\
         reset --chip STM32G431CBUx\n\
         attach --chip STM32G431CBUx own.elf\n\
         attach --chip STM32G431CBUx --probe 0483:374e own.elf\n"
    );
    // In the first case `probe-rs` ends with exit code 3. In the second case `touchstone log` ends it after 0.2 s.
    script(&here.join("bin"), "probe-rs", "exit 3");
    run(&here, &log).failed(1, &["exit status: 3"]);
    script(&here.join("bin"), "probe-rs", "exec /bin/sleep 60");
    let began = std::time::Instant::now();
    run(&here, &[&log[..], &["--seconds", "0.2"]].concat()).done();
    assert!(began.elapsed().as_secs() < 30);
}

/// Requests a debug probe with USB numbers that no probe has. Checks that nothing is written, whatever is connected to the test
/// machine.
#[cfg(feature = "probe")]
#[test]
fn without_its_probe_nothing_is_written() {
    let here = folder("flash-no-probe");
    elf_of(&here.join("own.elf"), "b-g431b-esc1");
    let flash = ["flash", "own.elf", "--board", "b-g431b-esc1", "--probe"];
    let with = |probe| run(&here, &[&flash[..], &[probe]].concat());
    with("fffe:fffd:NONE").failed(1, &["probe fffe:fffd:NONE", "is not connected"]);
    with("st-link").failed(
        2,
        &[
            "--probe: \"st-link\" is not the name of a probe",
            "0483:374e",
        ],
    );
    let parts = ["own.elf", "has no messages in it"];
    let mut log = [
        "log",
        "own.elf",
        "--board",
        "b-g431b-esc1",
        "--probe",
        "fffe:fffd:NONE",
    ];
    run(&here, &log).failed(2, &parts);
    log[0] = "flash";
    run(&here, &[&log[..], &["--log"]].concat()).failed(2, &parts);
    // A program for a wrong address, and an incomplete file.
    let mut bytes = std::fs::read(here.join("own.elf")).unwrap();
    bytes[52 + 12 + 3] = 0x20;
    std::fs::write(here.join("own.elf"), &bytes).unwrap();
    with("fffe:fffd:NONE").failed(2, &["0x20000000", "not in the flash of the STM32G431CBUx"]);
    std::fs::write(here.join("own.elf"), &bytes[..90]).unwrap();
    with("fffe:fffd:NONE").failed(2, &["own.elf", "cut off"]);
}

/// Checks that firmware of another board is refused before the program looks for a debug probe.
#[test]
fn another_boards_program_is_refused_by_both_names() {
    let here = folder("flash-other-board");
    for board in Board::ALL {
        elf_of(&here.join(format!("{}.elf", board.name())), board.name());
    }
    let flash = |program: &str, board: Board, more: &[&str]| {
        let first = ["flash", program, "--board", board.name(), "--dry-run"];
        run(&here, &[&first[..], more].concat())
    };
    for program in Board::ALL {
        for board in Board::ALL {
            let file = format!("{}.elf", program.name());
            let said = flash(&file, board, &[]);
            if program == board {
                said.done();
                continue;
            }
            let problem = format!(
                "{file}: is the program of {}, not of {}; ",
                program.name(),
                board.name()
            );
            said.failed(2, &[&problem, "--force"]);
            // With `--force` the command accepts the program of another board. Whether the chip fits is only checked when the
            // program is written.
            flash(&file, board, &["--force"]).done();
        }
    }
    let own = here.join("own.elf");
    for mark in ["", "my-board"] {
        elf_of(&own, mark);
        let mut bytes = std::fs::read(&own).unwrap();
        if mark.is_empty() {
            // The file has no symbol table, as after `strip`.
            bytes[48..50].fill(0);
            std::fs::write(&own, &bytes).unwrap();
        }
        let problem = match mark {
            "" => "does not name its board",
            _ => "is the program of my-board, not of nucleo-g474re",
        };
        flash("own.elf", Board::NucleoG474re, &[]).failed(2, &["own.elf", problem, "--force"]);
        flash("own.elf", Board::NucleoG474re, &["--force"]).done();
    }
}

#[test]
fn what_is_missing_is_named() {
    let here = folder("flash-missing");
    let json = run(&here, &["log", "--board", "nucleo-g474re", "--json"]);
    json.failed(2, &["--json: log has nothing to print"]);
    run(&here, &["flash", "--board", "nucleo-g474re"]).failed(
        2,
        &[
            "nucleo-g474re/touchstone.elf",
            "cargo xtask firmware --board nucleo-g474re",
        ],
    );
    std::fs::write(here.join("text.elf"), "no program").unwrap();
    run(&here, &["flash", "text.elf", "--board", "nucleo-g474re"])
        .failed(2, &["is not an ELF program for a 32-bit Arm"]);
    #[cfg(not(feature = "probe"))]
    {
        elf_of(&here.join("own.elf"), "nucleo-g474re");
        for command in ["flash", "log"] {
            run(&here, &[command, "own.elf", "--board", "nucleo-g474re"]).failed(
                1,
                &[
                    "probe-rs: is not on the PATH",
                    "cargo install probe-rs-tools",
                ],
            );
        }
        script(&here.join("bin"), "probe-rs", "exit 3");
        run(&here, &["flash", "own.elf", "--board", "nucleo-g474re"])
            .failed(1, &["exit status: 3", "touchstone doctor"]);
    }
    let said = run(&here, &["flash", "own.elf", "--board", "uno"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("b-g431b-esc1"), "{}", said.err);
}

/// Checks that the program works from an archive of `cargo xtask dist`. It must find the firmware files beside itself, without
/// compiler, probe-rs or PATH, from any working folder.
#[test]
fn the_programs_that_came_with_it_are_found_beside_it() {
    let here = folder("flash-archive");
    let archive = here.join("unpacked");
    for board in Board::ALL {
        let board = board.name();
        elf_of(
            &archive.join(format!("firmware/{board}/touchstone.elf")),
            board,
        );
    }
    // A firmware file that the user built earlier in this folder. Its version differs from that of the running program.
    elf_of(
        &here.join("target/firmware/nucleo-g474re/touchstone.elf"),
        "nucleo-g474re",
    );
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
    #[cfg(not(feature = "probe"))]
    let how = format!(
        "probe-rs download --chip STM32G474RETx --verify {program}\n\
         probe-rs reset --chip STM32G474RETx\n"
    );
    #[cfg(feature = "probe")]
    let how = "16 bytes between 0x08000000 and 0x08000010, read back and started, by probe-rs 0.32.0 in this program\n";
    assert_eq!(
        said,
        format!("{program} into STM32G474RETx\n{how}nothing was written\n")
    );
    #[cfg(not(feature = "probe"))]
    asked(&["flash", "--board", "nucleo-g474re"]).failed(1, &["probe-rs: is not on the PATH"]);
    let doctor = asked(&["doctor", "--port", "tcp:127.0.0.1:1"]).out;
    assert!(
        doctor.contains("this program contains the firmware of every board")
            && doctor.contains(&format!("nucleo-g474re: {program}")),
        "{doctor}"
    );
    // A damaged file is found even in a dry run, before anything is written.
    std::fs::write(archive.join("firmware/b-g431b-esc1/touchstone.elf"), "cut").unwrap();
    asked(&["flash", "--board", "b-g431b-esc1", "--dry-run"])
        .failed(2, &["is not an ELF program", "from one archive"]);
}
