//! Noise in the sensors: the device calibrates, arms, and a hand presses, as without it.

use super::press;
use super::tally::Tally;
use crate::bench::{Bench, Setup, number};
use crate::cpu::elf::Program;
use crate::world::Noise;

/// 0.03 degrees of the encoder (the AS5046's data sheet, as in the effects of a scene), and of the converters what `docs/firmware.md` takes for theirs.
pub const NOISE: Noise = Noise {
    encoder_rad: 5.2e-4,
    converter_codes: 1.15,
};
/// Largest error of the wall's stiffness: that of the scorecard, under a hand that rests.
const STIFFNESS_OFF_MOST: f64 = 0.05;

/// Runs on the reference board.
pub fn noisy(program: &Program, setup: &Setup, tally: &mut Tally) {
    if setup.board.name != "nucleo-g474re-ihm16m1" {
        return;
    }
    let mut bench = match Bench::new(program, setup) {
        Ok(bench) => bench,
        Err(error) => return tally.check("noise in the sensors", Err(error)),
    };
    bench.machine.chip_mut().world.sensors.noise = Some(NOISE);
    if let Err(error) = bench.boot() {
        return tally.check("noise in the sensors", Err(error));
    }
    for k in setup.board.walls {
        let pressed = press::press(&mut bench, k).and_then(|press| {
            let off = press.shown / number(k) - 1.0;
            let words = format!(
                "{} ticks equal to the bit; shows {:.3} N·m/rad, moves {} counts in the hold",
                press.compared, press.shown, press.moves
            );
            match off.abs() < STIFFNESS_OFF_MOST && press.moves > 0 {
                true => Ok(words),
                false => Err(words),
            }
        });
        let name = format!("noise in the sensors, a press into {k} N·m/rad");
        tally.check(&name, pressed);
    }
    tally.ran(&bench);
}
