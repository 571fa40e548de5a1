//! Tests of choosing a debug probe, and of the messages if the choice is ambiguous or the probe cannot be used.

use touchstone_probe::{Fault, attach, choose};

use crate::lister::{Board, Trouble, connected};

const CHIP: &str = "STM32G474RETx";

#[track_caller]
fn refused(boards: &[&Board], wanted: Option<&str>, parts: &[&str]) -> Fault {
    let fault = choose::open(&connected(boards), wanted)
        .map(|(_, place)| place)
        .unwrap_err();
    said(&fault, parts);
    fault
}

#[track_caller]
fn said(fault: &Fault, parts: &[&str]) {
    let text = fault.to_string();
    assert_eq!(text.lines().count(), 1, "{text}");
    for part in parts {
        assert!(text.contains(part), "{text:?} does not name {part:?}");
    }
}

#[test]
fn without_a_probe_it_says_what_to_connect() {
    refused(
        &[],
        None,
        &["no debug probe is connected by USB", "carries data"],
    );
    refused(&[], Some("0483:374e"), &["0483:374e: is not connected"]);
}

#[test]
fn the_only_one_is_taken() {
    let (_, place) = choose::open(&connected(&[&Board::g474("A1")]), None).unwrap();
    assert_eq!(place, "probe 0483:374e:A1");
}

#[test]
fn of_several_one_has_to_be_named() {
    let boards = [&Board::g474("A1"), &Board::g431("B2")];
    let parts = [
        "there are 2",
        "0483:374e:A1 (STLINK-V3), 0483:374e:B2",
        "--probe 0483:374e:A1",
    ];
    refused(&boards, None, &parts);
    // Both probes have these USB vendor and product numbers.
    refused(&boards, Some("0483:374e"), &parts);
    let (_, place) = choose::open(&connected(&boards), Some("0483:374e:B2")).unwrap();
    assert_eq!(place, "probe 0483:374e:B2");
    let fault = refused(
        &boards,
        Some("0483:374e:C3"),
        &["0483:374e:C3: is not connected, but", "A1"],
    );
    assert!(!fault.asked);
    for wrong in ["st-link", "0483", "0483:hello", "99999:1"] {
        assert!(refused(&boards, Some(wrong), &["--probe", wrong, "0483:374e"]).asked);
    }
    let found = choose::found(&connected(&boards));
    assert_eq!(found[1].selector, "0483:374e:B2");
    assert!(found[1].usable);
}

#[test]
fn without_the_right_to_use_it_the_rule_is_named() {
    for trouble in [Trouble::NoRights, Trouble::NoRightsWhenOpened] {
        let board = Board::g474("A1").with(trouble);
        refused(
            &[&board],
            None,
            &["0483:374e:A1", "udev rule", "touchstone doctor"],
        );
    }
    let board = Board::g474("A1").with(Trouble::Busy);
    refused(
        &[&board],
        None,
        &["0483:374e:A1: cannot be opened", "end the other program"],
    );
}

#[test]
fn a_probe_behind_which_nothing_answers() {
    let board = Board::g474("A1").with(Trouble::Silent);
    let fault = attach(choose::open(&connected(&[&board]), None).unwrap(), CHIP).unwrap_err();
    said(
        &fault,
        &[
            "0483:374e:A1: no STM32G474RETx answers",
            "supply",
            "level 2",
        ],
    );
}

#[test]
fn another_chip_than_the_board_has() {
    let board = Board::g431("B2");
    let open = || choose::open(&connected(&[&board]), None).unwrap();
    let fault = attach(open(), CHIP).unwrap_err();
    said(
        &fault,
        &[
            "STM32G431 or G441 (device number 0x468)",
            "not the STM32G474RETx",
            "--board",
        ],
    );
    attach(open(), "STM32G431CBUx").unwrap();
    board.machine.lock().unwrap().memory.device = 0x123;
    said(&attach(open(), CHIP).unwrap_err(), &["device number 0x123"]);
    // The program on the board goes on running in each case.
    assert!(board.machine.lock().unwrap().runs());
}

#[test]
fn a_chip_that_is_protected() {
    let board = Board::g474("A1");
    board.machine.lock().unwrap().memory.flash.options &= !0xff;
    let fault = attach(choose::open(&connected(&[&board]), None).unwrap(), CHIP).unwrap_err();
    said(
        &fault,
        &[
            "protected against reading",
            "level 1",
            "STM32CubeProgrammer",
            "erases",
        ],
    );
}
