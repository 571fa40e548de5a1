//! Tests of reading the log of a running program. The log's ring buffer in RAM follows the documentation of RTT and is filled as
//! the crate defmt-rtt fills it.

use std::sync::Mutex;
use std::time::Instant;

use touchstone_probe::{Attached, Event, Image, Words, attach, choose};

use crate::elf::{CONTROL_BLOCK, Program, code};
use crate::flash_memory::FLASH;
use crate::lister::{Board, connected};
use crate::machine::Played;
use crate::memory::{Memory, RAM};

const CHIP: &str = "STM32G474RETx";
/// RAM address of the text that names the log's ring buffer; `RING` and `RING_BYTES` are address and size of the buffer itself.
const NAME: u32 = CONTROL_BLOCK + 0x100;
const RING: u32 = CONTROL_BLOCK + 0x200;
const RING_BYTES: u32 = 64;
/// RAM address of the ring buffer's write position; `READ` is the address of its read position.
const WRITE: u32 = CONTROL_BLOCK + 24 + 12;
const READ: u32 = WRITE + 4;

/// The log messages of the invented programs, level and format text, numbered from 1.
const MESSAGES: [(&str, &str); 4] = [
    ("info", "boot"),
    ("error", "fault {=u8} at tick {=u32}"),
    ("warn", "said {=str}"),
    ("println", "as it is"),
];

fn program(clock: Option<&str>) -> Program {
    Program::default()
        .with(FLASH, code(4000))
        .with_messages(&MESSAGES, clock)
}

/// Encodes a log message in rzCOBS, a format without zero bytes: seven bytes, then a byte that says which of them were zero. Longer
/// runs without zeros are counted.
fn encoded(message: &[u8]) -> Vec<u8> {
    let (mut out, mut run, mut zeros) = (Vec::new(), 0_u8, 0_u8);
    for byte in message {
        if run < 7 {
            match byte {
                0 => zeros |= 1 << run,
                byte => out.push(*byte),
            }
            run += 1;
            if run == 7 && zeros != 0 {
                out.push(zeros);
                (run, zeros) = (0, 0);
            }
        } else if *byte == 0 {
            out.push((run - 7) | 0x80);
            (run, zeros) = (0, 0);
        } else {
            out.push(*byte);
            run += 1;
            if run == 134 {
                out.push(0xff);
                (run, zeros) = (0, 0);
            }
        }
    }
    match run {
        0 => {}
        1..7 => out.push((zeros | 0xff << run) & 0x7f),
        _ => out.push((run - 7) | 0x80),
    }
    out.push(0);
    out
}

/// The bytes of a log message before encoding: the message's number, then its values.
fn message(number: u16, rest: &[&[u8]]) -> Vec<u8> {
    encoded(&[&number.to_le_bytes()[..], &rest.concat()].concat())
}

/// Writes the control block of an empty ring buffer into RAM, as a program does right after its start.
fn control_block(memory: &mut Memory) {
    let words = |all: &[u32]| {
        all.iter()
            .flat_map(|word| word.to_le_bytes())
            .collect::<Vec<_>>()
    };
    memory.put(CONTROL_BLOCK, b"SEGGER RTT\0\0\0\0\0\0");
    // One buffer to the computer, none from it. Fields of the buffer: name, address, size, write and read position, mode.
    memory.put(
        CONTROL_BLOCK + 16,
        &words(&[1, 0, NAME, RING, RING_BYTES, 0, 0, 0]),
    );
    memory.put(NAME, b"defmt\0");
}

/// Writes as many of the bytes into the ring buffer as fit, like a program that waits for its reader. Returns how many.
fn into_ring(memory: &mut Memory, bytes: &[u8]) -> usize {
    let (mut write, read) = (
        memory.load(WRITE, 4).unwrap(),
        memory.load(READ, 4).unwrap(),
    );
    let mut count = 0;
    for byte in bytes {
        if (write + 1) % RING_BYTES == read {
            break;
        }
        memory.put(RING + write, &[*byte]);
        write = (write + 1) % RING_BYTES;
        count += 1;
    }
    memory.put(WRITE, &write.to_le_bytes());
    count
}

/// Returns a simulated program that logs these bytes after each start.
fn says(bytes: Vec<u8>) -> Played {
    let mut said = 0;
    Box::new(move |memory, begins| {
        if begins {
            control_block(memory);
            said = 0;
        }
        said += into_ring(memory, &bytes[said..]);
    })
}

/// Connects through a probe to a simulated board that runs the program `played`.
fn running(board: &Board, played: Played) -> Attached {
    {
        let mut machine = board.machine.lock().unwrap();
        machine.memory.flash.bytes[..4000].copy_from_slice(&code(4000));
        machine.played = Some(played);
    }
    attach(choose::open(&connected(&[board]), None).unwrap(), CHIP).unwrap()
}

/// Reads the log until it has had `count` events, and returns these events as text.
fn heard(attached: &mut Attached, program: &Program, count: usize) -> Vec<String> {
    let elf = program.elf();
    let (image, words) = (Image::read(&elf, CHIP).unwrap(), Words::read(&elf).unwrap());
    let events = Mutex::new(Vec::new());
    let tell = |event| {
        events.lock().unwrap().push(match event {
            Event::Line(line) => format!(
                "{}{} {}",
                line.time.map(|time| time + " ").unwrap_or_default(),
                line.level.unwrap_or("-"),
                line.text
            ),
            Event::Damaged => "damaged".into(),
            Event::Restarted => "restarted".into(),
        });
    };
    let begun = Instant::now();
    let enough = || events.lock().unwrap().len() < count && begun.elapsed().as_secs() < 10;
    attached.log(&image, &words, tell, enough).unwrap();
    events.into_inner().unwrap()
}

fn all_messages() -> Vec<u8> {
    [
        message(1, &[]),
        message(2, &[&[3], &70_000_u32.to_le_bytes()]),
        message(3, &[&5_u32.to_le_bytes(), b"a\nb\0c"]),
        message(4, &[]),
    ]
    .concat()
}

#[test]
fn messages_become_words() {
    let (board, program) = (Board::g474("A1"), program(None));
    let mut attached = running(&board, says(all_messages()));
    let halts = board.machine.lock().unwrap().halts;
    assert_eq!(
        heard(&mut attached, &program, 4),
        [
            "info boot",
            "error fault 3 at tick 70000",
            "warn said a b c",
            "- as it is"
        ]
    );
    // The processor is never halted while the log is read.
    assert_eq!(board.machine.lock().unwrap().halts, halts);
    // The end of the connection halts the processor once; after that the program goes on running.
    drop(attached);
    let machine = board.machine.lock().unwrap();
    assert_eq!(machine.halts, halts + 1);
    assert!(machine.runs() && machine.starts == 0);
}

#[test]
fn a_program_with_a_clock_has_its_time_before_the_message() {
    let (board, program) = (Board::g474("A1"), program(Some("{=u32:us}")));
    let time = 1_234_567_u32.to_le_bytes();
    let bytes = message(2, &[&time, &[9], &1_u32.to_le_bytes()]);
    let mut attached = running(&board, says(bytes));
    assert_eq!(
        heard(&mut attached, &program, 1),
        ["1.234567 error fault 9 at tick 1"]
    );
}

#[test]
fn a_ring_that_goes_round_many_times_loses_nothing() {
    let (board, program) = (Board::g474("A1"), program(None));
    let bytes = (0..200_u32).flat_map(|tick| message(2, &[&[7], &tick.to_le_bytes()]));
    let mut attached = running(&board, says(bytes.collect()));
    let lines = heard(&mut attached, &program, 200);
    for (tick, line) in lines.iter().enumerate() {
        assert_eq!(*line, format!("error fault 7 at tick {tick}"));
    }
}

#[test]
fn what_was_damaged_is_said_and_the_next_is_read() {
    let (board, program) = (Board::g474("A1"), program(None));
    // The end of a message, a message with an unknown number, and then a whole one.
    let bytes = [vec![0x33, 0x7f, 0], message(99, &[]), message(1, &[])].concat();
    let mut attached = running(&board, says(bytes));
    assert_eq!(
        heard(&mut attached, &program, 3),
        ["damaged", "damaged", "info boot"]
    );
}

#[test]
fn a_reset_in_between_is_followed() {
    let (board, program) = (Board::g474("A1"), program(None));
    let (mut once, mut looks) = (says(message(1, &[])), 0);
    let played: Played = Box::new(move |memory, begins| {
        // Some time after its message was read, the program restarts, as by the board's reset button.
        let read = memory.load(READ, 4).unwrap();
        looks += u32::from(!begins && read != 0 && memory.load(WRITE, 4) == Some(read));
        once(memory, begins || looks == 50);
    });
    let mut attached = running(&board, played);
    assert_eq!(
        heard(&mut attached, &program, 3),
        ["info boot", "restarted", "info boot"]
    );
}

#[test]
fn a_program_that_was_just_written_is_heard_from_its_start() {
    let (board, program) = (Board::g474("A1"), program(None));
    {
        let mut machine = board.machine.lock().unwrap();
        // The program sets up the ring buffer only after some time.
        let (mut looks, mut said) = (0, says(all_messages()));
        machine.played = Some(Box::new(move |memory, begins| {
            looks = if begins { 0 } else { looks + 1 };
            if looks >= 40 {
                said(memory, looks == 40);
            }
        }));
    }
    let image = Image::read(&program.elf(), CHIP).unwrap();
    let mut attached = attach(choose::open(&connected(&[&board]), None).unwrap(), CHIP).unwrap();
    attached.write(&image, |_| {}).unwrap();
    attached.start().unwrap();
    let lines = heard(&mut attached, &program, 4);
    assert_eq!(lines[0], "info boot");
    assert_eq!(board.machine.lock().unwrap().starts, 1);
}

#[test]
fn what_cannot_be_read_is_said() {
    let program = program(None);
    let elf = program.elf();
    let words = Words::read(&elf).unwrap();
    let refused = |attached: &mut Attached, elf: &[u8], parts: &[&str]| {
        let image = Image::read(elf, CHIP).unwrap();
        let fault = attached.log(&image, &words, |_| {}, || true).unwrap_err();
        let text = fault.to_string();
        assert_eq!(text.lines().count(), 1, "{text}");
        for part in parts {
            assert!(text.contains(part), "{text:?} does not name {part:?}");
        }
    };
    let board = Board::g474("A1");
    let mut attached = running(&board, Box::new(|_, _| {}));
    // The program does not set up the ring buffer within two seconds.
    refused(&mut attached, &elf, &["has no log yet", "device status"]);
    let mute = Program::default().with(FLASH, code(4000)).elf();
    refused(&mut attached, &mute, &["has no log"]);
    board.machine.lock().unwrap().memory.flash.bytes[900] ^= 1;
    refused(
        &mut attached,
        &elf,
        &["the program in the flash", "flash --log"],
    );
    let why = Words::read(&mute).err().unwrap();
    assert!(why.contains("no messages"), "{why}");
    assert!(Words::read(b"no program").is_err());
}

/// Decodes the messages that the boards' own firmware left in RAM after booting in the emulator. Runs only if a developer has made
/// these files: `touchstone-emulator ram ELF BOARD FILE` writes `touchstone.ram` next to the ELF file.
#[test]
fn the_boards_own_messages() {
    for (name, chip, board) in crate::writing::own_boards() {
        let folder = crate::writing::own_programs().join(name);
        let read = |file: &str| std::fs::read(folder.join(file)).ok();
        let (Some(elf), Some(ram)) = (read("touchstone.elf"), read("touchstone.ram")) else {
            eprintln!("not run: {name} is not built here, or its RAM was not kept");
            continue;
        };
        let image = Image::read(&elf, chip).unwrap();
        let words = Words::read(&elf).unwrap();
        board.machine.lock().unwrap().memory.put(RAM, &ram);
        let mut attached =
            attach(choose::open(&connected(&[&board]), None).unwrap(), chip).unwrap();
        attached.write(&image, |_| {}).unwrap();
        // The loader used the RAM, and the program then wrote its data there again.
        let mut machine = board.machine.lock().unwrap();
        machine.played = Some(Box::new(move |memory, begins| {
            if begins {
                memory.put(RAM, &ram);
            }
        }));
        drop(machine);
        attached.start().unwrap();
        let lines = Mutex::new(Vec::new());
        let begun = Instant::now();
        let tell = |event| lines.lock().unwrap().push(event);
        attached
            .log(&image, &words, tell, || begun.elapsed().as_millis() < 300)
            .unwrap();
        let lines = lines.into_inner().unwrap();
        println!("{name}: {lines:#?}");
        let first = lines.first().expect("a message");
        let Event::Line(line) = first else {
            panic!("{name}: {first:?}");
        };
        assert!(
            line.level == Some("info") && line.text.contains(name),
            "{line:?}"
        );
        let location = line.location.as_deref().unwrap_or_default();
        assert!(location.contains("run.rs:"), "{line:?}");
        assert!(!lines.contains(&Event::Damaged));
    }
}
