//! Turns the shaft at constant speed, against any torque of the motor, and measures the torque of motor and cogging that resists
//! the turn. All values come from the simulation of motor and knob, none from the device.

use std::f64::consts::TAU;

use touchstone_protocol::{DeviceCommand, Phase, Request};

use crate::bench::{Bench, MS, US};

/// Time between two samples of the torque, in processor cycles. At 168 cogging periods per turn and 10 rad/s, the cogging's phase
/// moves by 0.17 rad between two samples.
const SLICE: u64 = 100 * US;
/// Time from arming until the force has faded in (`limits.fade_in_s` is 0.2 s) and the shaft turns evenly, in processor cycles.
const FADED_IN: u64 = 400 * MS;

/// Torque that resists the shaft over one slow turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Felt {
    /// Root mean square of the summed torque of motor and cogging, without its mean, N·m.
    pub ripple_n_m: f64,
    /// Root mean square of the cogging torque alone in the same turn, without its mean, N·m.
    pub cogging_n_m: f64,
}

impl Felt {
    /// The ripple as a fraction of the cogging torque. 1: nothing was compensated.
    #[must_use]
    pub fn left(&self) -> f64 {
        self.ripple_n_m / self.cogging_n_m
    }
}

/// Arms a calibrated device, turns its shaft once at a speed in rad/s, and disarms it. The wall must be far away from the shaft's
/// position.
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

/// Collects values and computes their root mean square without the mean.
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
