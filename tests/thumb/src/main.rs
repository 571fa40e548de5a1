//! Runs the test vectors of `tests/vectors` on a Cortex-M4F, and counts the instructions of each control period. `cargo xtask
//! thumb` builds this program, runs it in QEMU and reads its output.
#![no_std]
#![no_main]

mod ruler;

use core::hint::black_box;
use core::panic::PanicInfo;

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use ruler::{Ruler, Tally};
use touchstone_control::law::{EnhancedSfa, EnhancedState, Law, Sample};
use touchstone_control::space::Vector;
use touchstone_control::{Controller, CountScale, Fixed16, Fixed32, Force, Number as _, Position};
use touchstone_vectors::space::{SPACE_CASES, Wall, play_space};
use touchstone_vectors::{Bits, Case, Machine, Segment, cases, play};

// Functions as firmware would call them. They are not inlined, so that a tick is counted with its call and return, and so that
// `cargo xtask thumb` finds them by name, with all that they call.

#[inline(never)]
fn tick_fixed32(wall: &mut Controller<Fixed32>, e: Position<Fixed32>) -> Force<Fixed32> {
    wall.tick(e)
}

#[inline(never)]
fn tick_fixed16(wall: &mut Controller<Fixed16>, e: Position<Fixed16>) -> Force<Fixed16> {
    wall.tick(e)
}

#[inline(never)]
fn penetration_fixed32(scale: &CountScale, count: i64) -> Position<Fixed32> {
    scale.penetration(count)
}

#[inline(never)]
fn penetration_fixed16(scale: &CountScale, count: i64) -> Position<Fixed16> {
    scale.penetration(count)
}

/// Runs the enhanced control law alone in 32-bit fixed point, so that its code size can be read from the program.
#[inline(never)]
fn enhanced_fixed32(
    law: &EnhancedSfa<Fixed32>,
    state: &mut EnhancedState<Fixed32>,
    sample: Sample<Fixed32>,
) -> Force<Fixed32> {
    law.tick(state, sample)
}

type Enhanced =
    fn(&EnhancedSfa<Fixed32>, &mut EnhancedState<Fixed32>, Sample<Fixed32>) -> Force<Fixed32>;
#[used]
static FOR_ITS_SIZE: Enhanced = enhanced_fixed32;

/// Runs a whole control period on three axes: surface point, control laws, friction and energy guard.
#[inline(never)]
fn tick_space(wall: &mut Wall, at: Vector<Position<Fixed32>>) -> Vector<Force<Fixed32>> {
    wall.tick(at).unwrap_or_default()
}

/// Runs control periods and conversions in one number format, and keeps the counted instructions of each.
struct Microcontroller<N: Bits> {
    ruler: Ruler,
    tick: fn(&mut Controller<N>, Position<N>) -> Force<N>,
    penetration: fn(&CountScale, i64) -> Position<N>,
    ticks: Tally,
    penetrations: Tally,
}

impl<N: Bits> Machine<N> for Microcontroller<N> {
    fn penetration(&mut self, scale: &CountScale, count: i64) -> Position<N> {
        let call = || black_box(self.penetration)(black_box(scale), black_box(count));
        let (e, instructions) = self.ruler.count(call);
        self.penetrations.add(instructions);
        e
    }

    fn tick(&mut self, wall: &mut Controller<N>, e: Position<N>) -> Force<N> {
        let call = || black_box(self.tick)(black_box(wall), black_box(e));
        let (force, instructions) = self.ruler.count(call);
        self.ticks.add(instructions);
        force
    }

    fn segment_done(&mut self, case: &Case, segment: &Segment, digest: u64) {
        hprintln!(
            "golden {} {} {} {:016x} {}",
            case.name,
            N::NAME,
            segment.name,
            digest,
            self.ticks
        );
        self.ticks = Tally::default();
    }
}

fn in_format<N: Bits>(
    ruler: Ruler,
    tick: fn(&mut Controller<N>, Position<N>) -> Force<N>,
    penetration: fn(&CountScale, i64) -> Position<N>,
) {
    let mut machine = Microcontroller {
        ruler,
        tick,
        penetration,
        ticks: Tally::default(),
        penetrations: Tally::default(),
    };
    for case in cases() {
        if let Err(refused) = play::<N>(&case, &mut machine) {
            hprintln!("refused {} {}: {}", case.name, N::NAME, refused);
        }
    }
    hprintln!("penetration {} {}", N::NAME, machine.penetrations);
}

/// Runs the three-axis cases of the test vectors.
fn in_space(
    ruler: Ruler,
    tick: fn(&mut Wall, Vector<Position<Fixed32>>) -> Vector<Force<Fixed32>>,
) {
    for case in SPACE_CASES {
        let mut ticks = Tally::default();
        let played = play_space(case, |wall, at| {
            let call = || black_box(tick)(black_box(wall), black_box(at));
            let (force, instructions) = ruler.count(call);
            ticks.add(instructions);
            force
        });
        match played {
            Some(digest) => hprintln!(
                "golden {} {} whole {:016x} {}",
                case,
                Fixed32::NAME,
                digest,
                ticks
            ),
            None => hprintln!("refused {}", case),
        }
    }
}

/// Ends the emulator QEMU with this exit status.
fn stop(status: debug::ExitStatus) -> ! {
    debug::exit(status);
    loop {
        cortex_m::asm::wfi();
    }
}

#[entry]
fn main() -> ! {
    let Some(ruler) = Ruler::take() else {
        hprintln!("the clock does not count instructions: run with -icount shift=10");
        stop(debug::EXIT_FAILURE)
    };
    in_format::<Fixed32>(ruler, tick_fixed32, penetration_fixed32);
    in_format::<Fixed16>(ruler, tick_fixed16, penetration_fixed16);
    in_space(ruler, tick_space);
    hprintln!("end");
    stop(debug::EXIT_SUCCESS)
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    hprintln!("{}", info);
    stop(debug::EXIT_FAILURE)
}
