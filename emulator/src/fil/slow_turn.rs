//! An even turn of the shaft by something stronger than the motor, and the torque of motor and cogging that it feels.
//! All values come from the simulated world, none from the device.

use std::f64::consts::TAU;

use touchstone_protocol::{DeviceCommand, Phase, Request};

use crate::bench::{Bench, MS, US};

/// How finely the torque is examined: 0.17 rad of 168 periods a turn at 10 rad/s.
const SLICE: u64 = 100 * US;
/// The force has faded in after this, by `limits.fade_in_s` of 0.2 s, and the shaft is past what came before.
const FADED_IN: u64 = 400 * MS;

/// The torque that is felt in such a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Felt {
    /// Effective value of the torque of motor and cogging together without its mean, all of it, N·m.
    pub ripple_n_m: f64,
    /// Largest torque of the cogging alone in the same turn, N·m.
    pub cogging_n_m: f64,
}

impl Felt {
    /// The remaining torque as a share of the cogging.
    #[must_use]
    pub fn left(&self) -> f64 {
        self.ripple_n_m / self.cogging_n_m
    }
}

/// Arms a calibrated device, whose wall must be far away, turns its shaft once at a speed, rad/s, and disarms it.
///
/// # Errors
/// The device does not arm, or does not stay armed.
pub fn slow_turn(bench: &mut Bench, rad_per_s: f64) -> Result<Felt, String> {
    bench.demand(Request::Command(DeviceCommand::Arm))?;
    bench.wait_for(Phase::Armed, 100 * MS)?;
    let world = &mut bench.machine.chip_mut().world;
    world.keep_books();
    world.force(rad_per_s);
    bench.run(FADED_IN)?;
    let slice_s = SLICE as f64 / (1_000 * MS) as f64;
    let slices = (TAU / rad_per_s.abs() / slice_s).round();
    let (mut felt, mut cogging) = (Ripple::default(), Ripple::default());
    let mut before = bench.machine.chip().world.books();
    for _ in 0..slices as u32 {
        bench.run(SLICE)?;
        let world = &bench.machine.chip().world;
        let after = world.books();
        let motor = (after.impulse_n_m_s - before.impulse_n_m_s) / slice_s;
        let middle = 0.5 * (before.angle_rad + after.angle_rad);
        let of_cogging = world.cogging.iter().map(|it| it.torque(middle)).sum();
        felt.add(motor + of_cogging);
        cogging.add(of_cogging);
        before = after;
    }
    let status = bench.status()?;
    bench.release();
    if status.phase != Phase::Armed {
        return Err(format!(
            "a turn at {rad_per_s} rad/s: {} with {:?}",
            status.phase.name(),
            status.fault
        ));
    }
    bench.demand(Request::Command(DeviceCommand::Disarm))?;
    bench.wait_for(Phase::Ready, 100 * MS)?;
    Ok(Felt {
        ripple_n_m: felt.value(),
        cogging_n_m: cogging.value(),
    })
}

/// Effective value without the mean.
#[derive(Debug, Default)]
struct Ripple {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Ripple {
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        self.sum += value;
        self.squares += value * value;
    }

    fn value(&self) -> f64 {
        let mean = self.sum / self.count;
        (self.squares / self.count - mean * mean).max(0.0).sqrt()
    }
}
