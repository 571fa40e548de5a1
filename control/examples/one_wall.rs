//! From encoder count to motor torque: a simulated hand turns a knob into a virtual wall and out again.

use touchstone_control::{Controller, CountScale, Fixed32, Settings, SettingsError, Si};

fn main() -> Result<(), SettingsError> {
    let settings = Settings {
        rate_hz: 1_000,                    // ticks a second
        k_desired: Si::lit("5"),           // stiffness to show, N·m/rad
        device_damping: Si::lit("0.0005"), // damping of device and finger, N·m·s/rad
        force_limit: Si::lit("0.1"),       // the motor's torque, N·m
        ..Settings::default()
    };
    let encoder = CountScale::new(40_000, Si::lit("0.1")).expect("counts"); // the wall is at 0.1 rad
    let mut wall = Controller::<Fixed32>::new(&settings)?;

    for count in (600..720).chain((600..720).rev()) {
        let inside = encoder.penetration(count); // each tick: read the encoder
        let force = wall.tick(inside); //           the law
        let torque_n_m = (-force).to_si(); //       command the motor, along the angle
        println!("{count} {} {torque_n_m}", inside.to_si());
    }
    Ok(())
}
