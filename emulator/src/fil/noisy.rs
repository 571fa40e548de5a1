//! Tests with noise in the sensors: the device must calibrate, arm and render a press as without noise.

use super::press;
use super::tally::Tally;
use crate::bench::{Bench, Setup, number};
use crate::cpu::elf::Program;
use crate::world::Noise;

/// Noise of the encoder and of the converters, as root-mean-square values. The encoder's 0.03 degrees come from the data sheet of
/// the AS5046, those of the converters from `docs/firmware.md`.
pub const NOISE: Noise = Noise {
    encoder_rad: 5.2e-4,
    converter_codes: 1.15,
};
/// Largest relative error of the wall's stiffness while a hand holds its press; the scorecard of a device has the same limit.
const STIFFNESS_OFF_MOST: f64 = 0.05;

/// Tests presses with noise on the reference board.
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
