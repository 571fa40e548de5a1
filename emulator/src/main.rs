//! Runs a firmware ELF for a while and says what happened.
use touchstone_emulator::board::{Board, Encoder};
use touchstone_emulator::chip::{Chip, ResetCause};
use touchstone_emulator::cpu::{Machine, elf::Program};
use touchstone_emulator::world::World;
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let ms: u64 = std::env::args().nth(2).unwrap().parse().unwrap();
    let program = Program::read(std::path::Path::new(&path)).unwrap();
    let chip = Chip::new(
        Board::nucleo_g474re(Encoder::As5047p),
        World::default(),
        32_000,
    );
    let mut m = Machine::new(chip, &program).unwrap();
    m.power_on(ResetCause::PowerOn);
    let t = std::time::Instant::now();
    let r = m.run_until(ms * 170_000);
    println!("{r:?} {:?}", t.elapsed());
    let c = m.chip();
    println!(
        "now {} us, spent {:?}, resets {:?}, faults {:?}",
        c.core.now / 170,
        c.core.spent,
        m.resets,
        c.faults
    );
    println!("unknown {:x?}", c.unknown);
    for (n, h) in c.handlers.iter().enumerate().filter(|(_, h)| h.runs > 0) {
        println!("{} {h:?}", n as i32 - 16);
    }
    println!("sysclk {}", c.sysclk_hz());
}
