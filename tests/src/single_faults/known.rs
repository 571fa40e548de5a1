//! What is known not to hold, with what was measured: faults of boards with current sensors that give a hand more than
//! [`MOST_J`](super::MOST_J), and faults of any board that give it more than the guard's bound and are not found.

use super::bench::{Grip, Moment};
use touchstone_protocol::Board;

/// A fault that gives a hand more than the limit.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    /// The board.
    pub board: Board,
    /// The fault's name.
    pub fault: &'static str,
    /// Moment, grip and quarter of the worst cell.
    pub place: (Moment, Grip, u8),
    /// The energy in that cell, mJ.
    pub most_mj: f64,
}

const fn known(
    board: Board,
    fault: &'static str,
    place: (Moment, Grip, u8),
    most_mj: f64,
) -> Known {
    Known {
        board,
        fault,
        place,
        most_mj,
    }
}

/// All of them.
pub const KNOWN: &[Known] = &[
    known(
        Board::BG431bEsc1,
        "phases one on",
        (Moment::Touching, Grip::Light, 1),
        4978.0,
    ),
    known(
        Board::BG431bEsc1,
        "magnet slips by 120 degrees in 0.2 s",
        (Moment::Touching, Grip::Light, 0),
        4964.0,
    ),
    known(
        Board::BG431bEsc1,
        "magnet slips by 180 degrees in 0.2 s",
        (Moment::Ready, Grip::Firm, 3),
        3433.0,
    ),
    known(
        Board::BG431bEsc1,
        "electrical angle wrong by 180 degrees",
        (Moment::Ready, Grip::Firm, 1),
        3246.0,
    ),
    known(
        Board::BG431bEsc1,
        "magnet slips by -120 degrees in 0.2 s",
        (Moment::Pressing, Grip::Firm, 0),
        2066.0,
    ),
    known(
        Board::BG431bEsc1,
        "magnet slips by 360 degrees in 1 s",
        (Moment::Ready, Grip::Firm, 2),
        1812.0,
    ),
    known(
        Board::BG431bEsc1,
        "encoder 10 ticks late",
        (Moment::Pressing, Grip::Firm, 2),
        1704.0,
    ),
    known(
        Board::BG431bEsc1,
        "magnet creeps, a count in 4 ms",
        (Moment::Pressing, Grip::Light, 2),
        1353.0,
    ),
    known(
        Board::BG431bEsc1,
        "electrical angle wrong by 120 degrees",
        (Moment::Ready, Grip::Firm, 2),
        1065.0,
    ),
    known(
        Board::BG431bEsc1,
        "sensor B stays at rest",
        (Moment::Touching, Grip::Firm, 0),
        682.0,
    ),
    known(
        Board::BG431bEsc1,
        "sensor B frozen",
        (Moment::Touching, Grip::Firm, 0),
        682.0,
    ),
    known(
        Board::BG431bEsc1,
        "encoder 3 ticks late",
        (Moment::Pressing, Grip::Firm, 3),
        391.0,
    ),
    known(
        Board::BG431bEsc1,
        "magnet loose by 10 degrees",
        (Moment::Pressing, Grip::Light, 1),
        363.0,
    ),
    known(
        Board::NucleoG474reIhm16m1,
        "magnet slips by 360 degrees in 1 s",
        (Moment::Ready, Grip::Light, 0),
        411.0,
    ),
    known(
        Board::NucleoG474reIhm16m1,
        "encoder 10 ticks late",
        (Moment::Pressing, Grip::Firm, 3),
        306.0,
    ),
    known(
        Board::NucleoG431rbIhm16m1,
        "electrical angle wrong by 120 degrees",
        (Moment::Pressing, Grip::Light, 1),
        582.0,
    ),
    known(
        Board::NucleoG431rbIhm16m1,
        "phases one on",
        (Moment::Pressing, Grip::Light, 3),
        567.0,
    ),
    known(
        Board::NucleoG431rbIhm16m1,
        "magnet slips by 180 degrees in 0.2 s",
        (Moment::Ready, Grip::Light, 2),
        482.0,
    ),
    known(
        Board::NucleoG431rbIhm16m1,
        "magnet slips by 120 degrees in 0.2 s",
        (Moment::Touching, Grip::Light, 0),
        464.0,
    ),
    known(
        Board::NucleoG431rbIhm16m1,
        "magnet slips by 360 degrees in 1 s",
        (Moment::Ready, Grip::Light, 0),
        411.0,
    ),
    known(
        Board::NucleoG431rbIhm16m1,
        "magnet slips by -120 degrees in 0.2 s",
        (Moment::Pressing, Grip::Light, 2),
        393.0,
    ),
    known(
        Board::NucleoG431rbIhm16m1,
        "encoder 10 ticks late",
        (Moment::Pressing, Grip::Firm, 3),
        306.0,
    ),
];

/// Faults that a board does not find in at least one cell in which the hand gets more than the guard's bound.
pub const UNFOUND: &[(Board, &[&str])] = &[
    (
        Board::NucleoG474re,
        &["encoder 3 ticks late", "magnet loose by 1 degree"],
    ),
    (
        Board::BG431bEsc1,
        &[
            "phases one on",
            "magnet creeps, a count in 4 ms",
            "sensor B stays at rest",
            "sensor B frozen",
            "encoder 3 ticks late",
            "magnet loose by 10 degrees",
            "encoder 10 ticks late",
            "sensor B off by a quarter of the trip current",
            "encoder counts half",
            "phase A open",
            "sensor A frozen",
            "phase B open",
            "phases A, B exchanged",
            "phase C open",
            "sensor A stays at rest",
            "magnet loose by 1 degree",
            "phases B, C exchanged",
            "encoder counts backwards",
        ],
    ),
    (
        Board::NucleoG474reIhm16m1,
        &[
            "encoder 10 ticks late",
            "encoder 3 ticks late",
            "magnet loose by 10 degrees",
            "magnet slips by 180 degrees in 0.2 s",
            "electrical angle wrong by 180 degrees",
        ],
    ),
    (
        Board::NucleoG474reSimplefocMini,
        &[
            "magnet slips by 180 degrees in 0.2 s",
            "electrical angle wrong by 180 degrees",
            "magnet slips by 360 degrees in 1 s",
            "encoder 10 ticks late",
            "electrical angle wrong by 120 degrees",
            "magnet slips by -120 degrees in 0.2 s",
            "magnet slips by 120 degrees in 0.2 s",
            "phases one on",
            "magnet loose by 10 degrees",
            "encoder 3 ticks late",
        ],
    ),
    (
        Board::NucleoG431rbIhm16m1,
        &[
            "magnet slips by 120 degrees in 0.2 s",
            "electrical angle wrong by 120 degrees",
            "phases one on",
            "encoder 10 ticks late",
            "encoder 3 ticks late",
            "sensor B stays at rest",
            "sensor A stays at rest",
            "sensor A frozen",
            "sensor B frozen",
            "magnet loose by 10 degrees",
            "magnet slips by 180 degrees in 0.2 s",
            "electrical angle wrong by 180 degrees",
            "magnet creeps, a count in 4 ms",
        ],
    ),
];
