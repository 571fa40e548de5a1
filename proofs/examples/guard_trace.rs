//! Prints ticks of the shipped guard, for the extracted specification of `proofs/coq/` to reproduce: of each guard its coefficients,
//! of each tick what came in, and memory and answer after it. `cargo run --release -p touchstone-proofs --example guard_trace -- TICKS`.

use std::io::{BufWriter, Write};
use touchstone_control::{ChangeOfForce, Fixed32, Force, Guard, Position};
use touchstone_proofs::spec::hands::{Random, any_settings, bits, memory, moved, specified};

fn main() -> std::io::Result<()> {
    let wanted_ticks = std::env::args().nth(1).and_then(|text| text.parse().ok());
    let wanted_ticks: u64 = wanted_ticks.unwrap_or(20_000);
    let mut out = BufWriter::new(std::io::stdout().lock());
    let mut random = Random(3);
    let mut ticks = 0;
    while ticks < wanted_ticks {
        let (settings, device) = any_settings(&mut random);
        let Ok(law) = Guard::<Fixed32>::new(&settings, &device) else {
            continue;
        };
        let g = specified(&law);
        let coefficients = [
            g.capacity,
            g.refill,
            g.damping,
            g.furthest,
            g.count,
            g.late,
            g.stray,
            g.slack,
            g.per_reach,
            g.in_flight,
            g.overrun,
        ];
        write!(out, "guard")?;
        for value in coefficients {
            write!(out, " {value}")?;
        }
        writeln!(out)?;
        let mut state = law.full();
        let habit = random.any() >> 16;
        for tick in 0..200 {
            ticks += 1;
            let furthest = i64::from(law.furthest.0.to_bits());
            let moved = bits(moved(&mut random, habit, tick, &memory(&state), furthest));
            let wanted = bits(random.signed(31));
            let before_change = if settings.change == ChangeOfForce::Measured {
                bits(random.signed(31 - habit % 12))
            } else {
                bits(0)
            };
            let told = bits(random.signed(31));
            let answer = law.tick_with_change(
                &mut state,
                Position(moved),
                Position(before_change),
                Force(wanted),
            );
            let (after, fine) = (memory(&state), answer.is_ok());
            law.commanded(&mut state, Force(told));
            let force = memory(&state).force;
            writeln!(
                out,
                "tick {} {} {} {} {} {} {} {} {force}",
                moved.to_bits(),
                before_change.to_bits(),
                wanted.to_bits(),
                told.to_bits(),
                after.account,
                after.force,
                after.older,
                u8::from(fine),
            )?;
        }
    }
    out.flush()
}
