//! Known gaps: faults that give a hand more than the guard's bound and that a board does not find.

use touchstone_protocol::Board;

/// Faults that a board does not find in at least one run in which the hand gets more than the guard's bound.
pub const UNFOUND: &[(Board, &[&str])] = &[
    (
        Board::NucleoG474reIhm16m1,
        &[
            "encoder 10 ticks late",
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
            "encoder 10 ticks late",
            "electrical angle wrong by 120 degrees",
            "magnet slips by 120 degrees in 0.2 s",
            "phases one on",
            "magnet loose by 10 degrees",
        ],
    ),
    (
        Board::NucleoG431rbIhm16m1,
        &[
            "encoder 10 ticks late",
            "magnet loose by 10 degrees",
            "magnet slips by 180 degrees in 0.2 s",
            "electrical angle wrong by 180 degrees",
        ],
    ),
];
