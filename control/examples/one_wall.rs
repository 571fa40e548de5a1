//! From encoder count to motor torque: a simulated hand turns a knob into a virtual wall and out again.

use touchstone_control::{
    Controller, CountScale, Fixed32, GuardSettings, PositionSettings, Settings, SettingsError, Si,
};

const COUNTS_PER_REV: u32 = 40_000;

fn main() -> Result<(), SettingsError> {
    let settings = Settings {
        rate_hz: 1_000,                    // ticks a second
        k_desired: Si::lit("5"),           // stiffness to show, N·m/rad
        device_damping: Si::lit("0.0005"), // damping of device and finger, N·m·s/rad
        force_limit: Si::lit("0.1"),       // the motor's torque, N·m
        position: PositionSettings::of_counts_per_rev(COUNTS_PER_REV),
        guard: GuardSettings {
            damping: Si::lit("0.00008"), // of the device alone, as measured, N·m·s/rad
            delay: Si::lit("0.0001"),    // from reading the encoder until the torque acts, s
            ..GuardSettings::default()
        },
        ..Settings::default()
    };
    let encoder = CountScale::new(COUNTS_PER_REV, Si::lit("0.1")).expect("counts"); // the wall is at 0.1 rad
    let mut wall = Controller::<Fixed32>::new(&settings)?;

    for count in (600..720).chain((600..720).rev()) {
        let inside = encoder.penetration(count); // each tick: read the encoder
        let force = wall.tick(inside); //           the law
        let torque_n_m = (-force).to_si(); //       command the motor, along the angle
        println!("{count} {} {torque_n_m}", inside.to_si());
    }
    Ok(())
}
