//! What is known not to hold, with what was measured: faults of boards with current sensors that give a hand more than
//! [`MOST_J`](super::MOST_J), and faults of any board that give it more than the guard's bound and are not found.

use touchstone_protocol::Board;

/// By how much the energy of a known fault may differ from the figure, as a share of it. A knob that runs away takes another course
/// after any change of a law: then the figures have to be measured anew.
pub const SPREAD: f64 = 0.05;

/// A fault that gives a hand more than the limit.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    /// The board.
    pub board: Board,
    /// The fault's name.
    pub fault: &'static str,
    /// The energy in its worst cell, mJ.
    pub most_mj: f64,
}

const fn known(board: Board, fault: &'static str, most_mj: f64) -> Known {
    Known {
        board,
        fault,
        most_mj,
    }
}

/// All of them.
pub const KNOWN: &[Known] = &[
    known(Board::BG431bEsc1, "phases one on", 4973.1),
    known(
        Board::BG431bEsc1,
        "magnet slips by 120 degrees in 0.2 s",
        4969.8,
    ),
    known(
        Board::BG431bEsc1,
        "magnet slips by 180 degrees in 0.2 s",
        3433.2,
    ),
    known(
        Board::BG431bEsc1,
        "electrical angle wrong by 180 degrees",
        3249.7,
    ),
    known(
        Board::BG431bEsc1,
        "magnet slips by -120 degrees in 0.2 s",
        2066.5,
    ),
    known(
        Board::BG431bEsc1,
        "magnet slips by 360 degrees in 1 s",
        1812.3,
    ),
    known(Board::BG431bEsc1, "magnet creeps, a count in 4 ms", 1352.6),
    known(Board::BG431bEsc1, "encoder 10 ticks late", 1170.4),
    known(
        Board::BG431bEsc1,
        "electrical angle wrong by 120 degrees",
        1066.4,
    ),
    known(Board::BG431bEsc1, "sensor B stays at rest", 502.7),
    known(Board::BG431bEsc1, "sensor B frozen", 441.8),
    known(Board::BG431bEsc1, "encoder 3 ticks late", 391.9),
    known(Board::BG431bEsc1, "sensor A stays at rest", 357.1),
    known(Board::BG431bEsc1, "sensor A frozen", 357.1),
    known(Board::BG431bEsc1, "magnet loose by 10 degrees", 333.5),
    known(
        Board::NucleoG474reIhm16m1,
        "magnet slips by 360 degrees in 1 s",
        411.0,
    ),
    known(Board::NucleoG474reIhm16m1, "encoder 10 ticks late", 305.7),
    known(
        Board::NucleoG431rbIhm16m1,
        "electrical angle wrong by 120 degrees",
        580.7,
    ),
    known(Board::NucleoG431rbIhm16m1, "phases one on", 565.7),
    known(
        Board::NucleoG431rbIhm16m1,
        "magnet slips by 180 degrees in 0.2 s",
        481.5,
    ),
    known(
        Board::NucleoG431rbIhm16m1,
        "magnet slips by 120 degrees in 0.2 s",
        463.3,
    ),
    known(
        Board::NucleoG431rbIhm16m1,
        "magnet slips by 360 degrees in 1 s",
        411.0,
    ),
    known(
        Board::NucleoG431rbIhm16m1,
        "magnet slips by -120 degrees in 0.2 s",
        393.0,
    ),
    known(Board::NucleoG431rbIhm16m1, "encoder 10 ticks late", 305.7),
];

/// Faults that a board does not find in at least one cell in which the hand gets more than the guard's bound.
pub const UNFOUND: &[(Board, &[&str])] = &[
    (Board::NucleoG474re, &["magnet loose by 1 degree"]),
    (
        Board::BG431bEsc1,
        &[
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
