//! A user-defined force on a user-defined device, in fixed point: describe the device, then run the tick. The energy guard limits
//! the force.

use touchstone_control::{
    CountScale, Device, Fixed32, Force, Position, PositionSettings, SettingsError, Si,
};

const COUNTS_PER_REV: u32 = 16_384;

fn main() -> Result<(), SettingsError> {
    let device = Device {
        rate_hz: 1_000,             // ticks a second
        inertia: Si::lit("0.0001"), // of all that turns, kg·m²
        damping: Si::lit("0.0004"), // of the device alone, as measured, N·m·s/rad
        position: PositionSettings::of_counts_per_rev(COUNTS_PER_REV),
        position_error: Si::ZERO, // besides the rounding to counts, rad: an off-centre magnet has more
        force_limit: Si::lit("0.5"), // the motor's torque, N·m
        delay: Si::lit("0.0001"), // from reading the encoder until the torque begins to act, s
        lag: Si::ZERO,            // mean time from there until it acts, s
    };
    let mut knob = device.own_force::<Fixed32>()?;
    let spring = device.spring(Si::lit("5")).expect("fits"); // N·m/rad
    let damper = device.damper(Si::lit("0.01")).expect("fits"); // N·m·s/rad
    let encoder = CountScale::new(COUNTS_PER_REV, Si::ZERO).expect("counts");

    for count in (-60..60).chain((-60..60).rev()) {
        let angle: Position<Fixed32> = encoder.penetration(count); // each tick: read the encoder
        let force = knob.tick(angle, |now| {
            // Your force, against the angle: here a spring with a damper at angles above 0.
            if now.e > Position::zero() {
                (spring * now.e + damper * now.moved).outward()
            } else {
                Force::zero()
            }
        });
        let torque_n_m = (-force).to_si(); // command the motor, along the angle
        println!("{count} {torque_n_m}");
    }
    Ok(())
}
