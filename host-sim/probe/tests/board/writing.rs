//! Tests of writing a program into the flash: probe-rs's loader with the chip maker's flash algorithm, which runs on the simulated
//! processor.

use std::collections::BTreeMap;

use touchstone_probe::{Attached, Image, Phase, Step, attach, choose};

use crate::elf::{Program, code};
use crate::flash_memory::FLASH;
use crate::lister::{Board, connected};

fn attached(board: &Board, chip: &str) -> Attached {
    attach(choose::open(&connected(&[board]), None).unwrap(), chip).unwrap()
}

/// Writes a program into a simulated board's flash and checks every byte of the flash. Returns for each phase the bytes announced
/// and done.
fn written(board: &Board, chip: &str, program: &Program) -> BTreeMap<u8, (u64, u64)> {
    let before = board.machine.lock().unwrap().memory.flash.bytes.clone();
    let elf = program.elf();
    let image = Image::read(&elf, chip).unwrap();
    let mut phases = BTreeMap::new();
    let mut attached = attached(board, chip);
    let told = |step| {
        let number = |phase| match phase {
            Phase::Erase => 0_u8,
            Phase::Program => 1,
            Phase::Verify => 2,
        };
        match step {
            Step::Begins(phase, total) => {
                phases.insert(number(phase), (total.unwrap(), 0));
            }
            Step::Done(phase, bytes) => phases.get_mut(&number(phase)).unwrap().1 += bytes,
            Step::Ends(_) => {}
        }
    };
    attached.write(&image, told).unwrap();
    attached.start().unwrap();
    drop(attached);
    let machine = board.machine.lock().unwrap();
    assert_eq!(machine.fault, None);
    assert!(machine.runs(), "nothing holds it");
    assert_eq!(machine.starts, 1);
    let mut expected = before;
    for page in &machine.memory.flash.erased {
        expected[(page - FLASH) as usize..][..0x800].fill(0xff);
    }
    let mut size = 0;
    for (begin, end) in image.ranges() {
        let place = (begin - u64::from(FLASH)) as usize;
        let bytes = (end - begin) as usize;
        let cells = &machine.memory.flash.bytes[place..place + bytes];
        assert!(elf.windows(bytes).any(|part| part == cells), "{begin:#x}");
        expected[place..place + bytes].copy_from_slice(cells);
        size += bytes;
    }
    assert!(
        expected == machine.memory.flash.bytes,
        "a page that is not the program's was changed"
    );
    assert_eq!(size, image.size_bytes());
    phases
}

#[test]
fn a_program_is_erased_for_written_compared_and_started() {
    let board = Board::g474("A1");
    // Two parts in one page, one in the second bank, none of them whole pages.
    let program = Program::default()
        .with(FLASH, code(5000))
        .with(FLASH + 5000, code(700))
        .with(FLASH + 0x4_0000, code(2500));
    let phases = written(&board, "STM32G474RETx", &program);
    let machine = board.machine.lock().unwrap();
    let pages = [0, 0x800, 0x1000, 0x4_0000, 0x4_0800].map(|page| FLASH + page);
    assert_eq!(machine.memory.flash.erased, pages);
    // The reported progress: five pages are erased, then the parts are written in pieces of 1 KiB.
    assert_eq!(phases[&0], (0x2800, 0x2800));
    assert_eq!(phases[&1].0, phases[&1].1);
    assert_eq!(phases[&2].0, phases[&2].1);
    assert_eq!(phases.len(), 3);
}

#[test]
fn the_small_chip_has_one_bank() {
    let board = Board::g431("B2");
    let program = Program::default()
        .with(FLASH, code(3000))
        .with(FLASH + 0x1_f000, code(16));
    written(&board, "STM32G431CBUx", &program);
    let machine = board.machine.lock().unwrap();
    let pages = [0, 0x800, 0x1_f000].map(|page| FLASH + page);
    assert_eq!(machine.memory.flash.erased, pages);
}

#[test]
fn a_cell_that_does_not_take_what_is_written_is_found() {
    let board = Board::g474("A1");
    let program = Program::default().with(FLASH, code(4096));
    let image = Image::read(&program.elf(), "STM32G474RETx").unwrap();
    let place = (8..4096)
        .find(|place| program.elf()[84 + place] != 0xff)
        .unwrap();
    board.machine.lock().unwrap().memory.flash.stuck = Some(place as u32);
    let mut attached = attached(&board, "STM32G474RETx");
    let fault = attached.write(&image, |_| {}).unwrap_err().to_string();
    assert!(
        fault.contains("the data read back differ from the data written"),
        "{fault}"
    );
    assert!(fault.contains("program is incomplete now"), "{fault}");
}

#[test]
fn what_is_no_program_for_the_chip_is_refused_before_a_probe_is_looked_for() {
    let refused = |program: &Program, chip: &str, part: &str| {
        let why = Image::read(&program.elf(), chip).unwrap_err();
        assert!(why.contains(part) && why.lines().count() == 1, "{why}");
    };
    let at = |address| Program::default().with(address, code(64));
    let (large, small) = ("STM32G474RETx", "STM32G431RBTx");
    refused(
        &at(0x2000_0000),
        large,
        "0x20000000 to 0x20000040, which is not in the flash",
    );
    refused(
        &at(0x0808_0000),
        large,
        "not in the flash of the STM32G474RETx",
    );
    refused(
        &at(0x0801_fff0),
        small,
        "not in the flash of the STM32G431RBTx",
    );
    refused(&at(FLASH), "STM32X999", "not known, STM32X999");
    refused(&Program::default(), large, "nothing for the flash");
    let twice = at(FLASH).with(FLASH + 60, code(64));
    refused(&twice, large, "two parts for the same flash at 0x0800003c");
    Image::read(&at(0x0801_fff0).elf(), large).unwrap();
    let whole = at(FLASH).elf();
    for cut in [0, 3, 40, 60, 100] {
        assert!(Image::read(&whole[..cut], large).is_err(), "{cut}");
    }
}

/// For each type of chip that a supported board has: name of a board, name of its chip, and the simulated board.
pub fn own_boards() -> [(&'static str, &'static str, Board); 3] {
    [
        ("nucleo-g474re", "STM32G474RETx", Board::g474("A1")),
        ("nucleo-g431rb-ihm16m1", "STM32G431RBTx", Board::g431("B2")),
        ("b-g431b-esc1", "STM32G431CBUx", Board::g431("C3")),
    ]
}

/// Folder with the firmware of the boards: the one in the variable `TOUCHSTONE_FIRMWARE`, else that of `cargo xtask firmware`.
pub fn own_programs() -> std::path::PathBuf {
    std::env::var_os("TOUCHSTONE_FIRMWARE").map_or_else(
        || std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/firmware"),
        Into::into,
    )
}

/// Writes the boards' own firmware into simulated boards. Runs only if a developer has built the firmware.
#[test]
fn the_boards_own_programs() {
    for (name, chip, board) in own_boards() {
        let Ok(elf) = std::fs::read(own_programs().join(name).join("touchstone.elf")) else {
            eprintln!("not run: {name} is not built here");
            continue;
        };
        let image = Image::read(&elf, chip).unwrap();
        let mut attached = attached(&board, chip);
        attached.write(&image, |_| {}).unwrap();
        attached.start().unwrap();
        drop(attached);
        let machine = board.machine.lock().unwrap();
        assert!(machine.runs());
        for (begin, end) in image.ranges() {
            let place = (begin - u64::from(FLASH)) as usize;
            let cells = &machine.memory.flash.bytes[place..place + (end - begin) as usize];
            assert!(elf.windows(cells.len()).any(|part| part == cells), "{name}");
        }
    }
}
