//! Prints results of the code, which the Python model of the integer obligations (lemmas of the proofs) must reproduce. At 8 bits
//! it prints every force and displacement for a grid of energies, at 32 bits seeded samples.

use std::io::{BufWriter, Write};
use touchstone_control::magnitude::{affordable, passivity_step, root, scale};

macro_rules! print_case {
    ($out:expr, $word:ident, $wide:ident, $energy:expr, $force:expr, $moved:expr) => {{
        let (energy, force, moved): ($wide, $word, $word) = ($energy, $force, $moved);
        let bits = $word::BITS;
        for inward in [false, true] {
            let step = passivity_step::<$word>(energy, force, moved, inward);
            writeln!(
                $out,
                "step {bits} {energy} {force} {moved} {} {} {}",
                u8::from(inward),
                step.energy,
                step.force
            )?;
        }
        let retreat = affordable::<$word>(energy, force);
        writeln!(
            $out,
            "affordable {bits} {energy} {force} {} {}",
            retreat.moved, retreat.rest
        )?;
        let found = root::<$word>(energy);
        writeln!($out, "root {bits} {energy} {} {}", found.root, found.square)?;
        let scaled = scale::<$word>(force, moved, bits * 3 / 4);
        writeln!($out, "scale {bits} {force} {moved} {scaled}")?;
    }};
}

fn main() -> std::io::Result<()> {
    let mut out = BufWriter::new(std::io::stdout().lock());
    for force in (0..=128_u8).step_by(3).chain([1, 127, 128]) {
        for moved in (0..=128_u8).step_by(3).chain([1, 127, 128]) {
            for energy in [0_u16, 1, 2, 127, 128, 1_000, 8_191, 16_384, 32_767] {
                print_case!(out, u8, u16, energy, force, moved);
            }
        }
    }
    let mut state = 1_u64;
    let mut next = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let mixed = state ^ (state >> 29);
        mixed >> (mixed % 64)
    };
    for _ in 0..50_000 {
        let energy = next() >> 1;
        let force = (next() as u32).min(1 << 31);
        let moved = (next() as u32).min(1 << 31);
        print_case!(out, u32, u64, energy, force, moved);
    }
    out.flush()
}
