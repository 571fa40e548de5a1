//! Prints a digest (hash of all results) for every case, number format and segment of the test vectors, calculated on this machine.
//! Each is one line, in the format of the microcontroller's program, but without the counted instructions.

use touchstone_control::{Controller, CountScale, Fixed16, Fixed32, Force, Number, Position};
use touchstone_vectors::space::{SPACE_CASES, play_space};
use touchstone_vectors::{Bits, Case, Machine, Segment, cases, play};

struct Desktop;

impl<N: Number> Machine<N> for Desktop {
    fn penetration(&mut self, scale: &CountScale, count: i64) -> Position<N> {
        scale.penetration(count)
    }
    fn tick(&mut self, wall: &mut Controller<N>, e: Position<N>) -> Force<N> {
        wall.tick(e)
    }
    fn segment_done(&mut self, case: &Case, segment: &Segment, digest: u64) {
        println!(
            "golden {} {} {} {digest:016x}",
            case.name,
            N::NAME,
            segment.name
        );
    }
}

fn in_format<N: Bits>() {
    for case in cases() {
        if let Err(refused) = play::<N>(&case, &mut Desktop) {
            println!("refused {} {}: {refused}", case.name, N::NAME);
        }
    }
}

fn main() {
    in_format::<Fixed32>();
    in_format::<Fixed16>();
    for case in SPACE_CASES {
        match play_space(case, |wall, at| wall.tick(at).unwrap_or_default()) {
            Some(digest) => println!("golden {case} {} whole {digest:016x}", Fixed32::NAME),
            None => println!("refused {case}"),
        }
    }
}
