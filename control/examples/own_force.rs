//! A user-defined force behind the energy guard. The force is a stiff end stop, sampled too slowly: without the guard the knob
//! rebounds faster than it arrived.

use touchstone_control::{
    Device, Fixed32, Force, Guard, GuardSettings, Guarded, Position, PositionSettings,
    SettingsError, Si,
};

/// Makes the guard from the device's properties. The energy bound holds for devices with at least this damping and exactly this
/// rate and delay.
fn guard() -> Result<Guarded<Fixed32>, SettingsError> {
    let device = Device {
        rate_hz: 1_000,               // ticks a second
        inertia: Si::lit("0.000005"), // of all that turns, kg·m²; the guard does not need it
        damping: Si::lit("0.0001"),   // of the device alone, as measured, N·m·s/rad
        position: PositionSettings::of_counts_per_rev(16_384),
        position_error: Si::ZERO,    // rad
        force_limit: Si::lit("0.5"), // the motor's torque, N·m
        delay: Si::lit("0.0001"),    // from reading the encoder until the torque acts, s
        lag: Si::ZERO,
    };
    let settings = GuardSettings {
        capacity: Si::lit("0.002"), // what a hand may get out at once, J
        ..device.guard_settings()
    };
    let guard = Guard::new(&settings, &device.guarded_device())?;
    Ok(Guarded::new(guard))
}

/// The user's own force in N·m, from angle and velocity: here a spring of 200 N·m/rad that pushes back at angles above 0.
fn own_force(angle_rad: f64, _velocity_rad_per_s: f64) -> f64 {
    (-200.0 * angle_rad.max(0.0)).max(-0.5)
}

/// Simulates a knob of 50 g·cm² that runs into the end stop at 10 rad/s. Returns the knob's kinetic energy in joules when it comes
/// out.
fn comes_out_with_j(mut guard: Option<Guarded<Fixed32>>) -> f64 {
    let (inertia_kg_m2, damping_n_m_s_per_rad, count_rad) = (5e-6, 1e-4, 0.000_383_5);
    let (mut angle_rad, mut velocity_rad_per_s) = (-0.02_f64, 10.0_f64);
    let mut back_j = 0.0_f64;
    for _ in 0..200 {
        // Each tick: read the encoder, calculate the force, let the guard limit it, command the motor.
        let measured_rad = (angle_rad / count_rad).floor() * count_rad;
        let mut torque_n_m = own_force(measured_rad, velocity_rad_per_s);
        if let Some(guard) = &mut guard {
            // The guard counts forces that resist a positive motion.
            let angle = Position::from_si(Si::from_num(measured_rad)).expect("within ±128 rad");
            let wanted = Force::from_si(Si::from_num(-torque_n_m)).expect("within ±128 N·m");
            torque_n_m = -guard.tick(angle, None, wanted).to_si().to_num::<f64>();
        }
        // The device, in a hundred steps a tick.
        for _ in 0..100 {
            let push = torque_n_m - damping_n_m_s_per_rad * velocity_rad_per_s;
            velocity_rad_per_s += push / inertia_kg_m2 * 1e-5;
            angle_rad += velocity_rad_per_s * 1e-5;
        }
        back_j = back_j.max(0.5 * inertia_kg_m2 * velocity_rad_per_s.min(0.0).powi(2));
    }
    back_j
}

fn main() -> Result<(), SettingsError> {
    let before_mj = 1e3 * 0.5 * 5e-6 * 100.0;
    let (bare_mj, guarded_mj) = (
        1e3 * comes_out_with_j(None),
        1e3 * comes_out_with_j(Some(guard()?)),
    );
    println!(
        "turned into the stop with {before_mj:.2} mJ; comes back with {bare_mj:.2} mJ without the guard, {guarded_mj:.2} mJ with it"
    );
    Ok(())
}
