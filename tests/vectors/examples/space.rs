//! Prints the digest of every case of three axes on this machine; `tests/thumb/src/bin/space.rs` prints the same words and its instructions.

use touchstone_vectors::space::{SPACE_CASES, SPACE_TICKS, play_space};

fn main() {
    for case in SPACE_CASES {
        let played = play_space(case, |wall, at| wall.tick(at).unwrap_or_default());
        let Some((digest, pushing)) = played else {
            println!("refused {case}");
            continue;
        };
        println!("space {case} {digest:016x} pushing {pushing} of {SPACE_TICKS}");
    }
}
