//! The cases of three axes on a Cortex-M4F: the digests, which are those of `tests/vectors/examples/space.rs`, and what a tick costs.
#![no_std]
#![no_main]

#[path = "../ruler.rs"]
mod ruler;

use core::hint::black_box;
use core::panic::PanicInfo;

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use ruler::{Ruler, Tally};
use touchstone_control::space::Vector;
use touchstone_control::{Fixed32, Force, Position};
use touchstone_vectors::space::{SPACE_CASES, SPACE_TICKS, Wall, play_space};

/// What firmware would call, counted with its call and return.
#[inline(never)]
fn tick_space(wall: &mut Wall, at: Vector<Position<Fixed32>>) -> Vector<Force<Fixed32>> {
    wall.tick(at).unwrap_or_default()
}

type Tick = fn(&mut Wall, Vector<Position<Fixed32>>) -> Vector<Force<Fixed32>>;

#[entry]
fn main() -> ! {
    let Some(ruler) = Ruler::take() else {
        hprintln!("the clock does not count instructions: run with -icount shift=10");
        stop(debug::EXIT_FAILURE)
    };
    let tick: Tick = tick_space;
    for case in SPACE_CASES {
        let mut ticks = Tally::default();
        let played = play_space(case, |wall, at| {
            let call = || black_box(tick)(black_box(wall), black_box(at));
            let (force, instructions) = ruler.count(call);
            ticks.add(instructions);
            force
        });
        match played {
            Some((digest, pushing)) => {
                hprintln!(
                    "space {} {:016x} pushing {} of {} instructions {}",
                    case,
                    digest,
                    pushing,
                    SPACE_TICKS,
                    ticks
                )
            }
            None => hprintln!("refused {}", case),
        }
    }
    stop(debug::EXIT_SUCCESS)
}

/// Ends QEMU.
fn stop(status: debug::ExitStatus) -> ! {
    debug::exit(status);
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    hprintln!("{}", info);
    stop(debug::EXIT_FAILURE)
}
