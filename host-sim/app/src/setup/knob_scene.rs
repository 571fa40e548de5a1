//! Writes a scene file for a measured knob, which the simulator runs and `tune` uses to tune the wall.

use std::fmt::Write;
use touchstone_control::{ChangeOfForce, Choice as _};
use touchstone_drive::Hardware;
use touchstone_lab::identify::eccentricity::Eccentricity;
use touchstone_lab::identify::motor::MeasuredMotor;
use touchstone_protocol::DeviceSettings;

/// Delay from a position reading to the motor's response, in PWM periods: on average 0.5 until the current loop reads the command,
/// then 1 until the middle of the PWM period in which the compare values act.
const DELAY_PERIODS: f64 = 1.5;
/// Fraction of the measured damping that the energy guard may assume. The guard's energy bound holds only if the real damping is at
/// least the assumed damping.
const GUARD_SHARE: f64 = 0.8;
/// Number of standard uncertainties that are subtracted from the measured damping. The result is an upper limit of the damping that
/// the energy guard may assume.
const GUARD_UNCERTAINTIES: f64 = 2.0;
/// Torque with which the simulated hand presses, as a fraction of the motor's torque at its continuous current or its current
/// limit, whichever is smaller. The press has at most 0.1 N·m, as in the thesis.
const PRESS_SHARE: f64 = 0.6;

/// Damping that the energy guard may assume, N·m·s/rad.
pub fn sure_damping(motor: &MeasuredMotor) -> f64 {
    let it = &motor.mechanics.damping_n_m_s_per_rad;
    (GUARD_SHARE * it.value)
        .min(it.value - GUARD_UNCERTAINTIES * it.uncertainty)
        .max(0.0)
}

/// Text of the scene file for the measured knob. `position_error_rad` is the encoder's error for the energy guard's settings.
pub fn text(
    motor: &MeasuredMotor,
    position_error_rad: f64,
    settings: &DeviceSettings,
    hardware: &Hardware,
    who: &str,
) -> String {
    let guard = &settings.law.guard;
    let (it, constant) = (&motor.mechanics, motor.torque_constant_n_m_per_a.value);
    let current: f64 = settings.motor.current_limit_a.to_num();
    let continuous: f64 = settings.motor.continuous_current_a.to_num();
    let step: f64 = hardware.amps_per_code.to_num();
    let friction = it.friction_n_m.value.max(0.0);
    let press = (PRESS_SHARE * constant * continuous.min(current)).min(0.1);
    let damping = it.damping_n_m_s_per_rad.value.max(0.0);
    let inertia = it.inertia_kg_m2.value;
    // A board that reads the encoder a second time calculates the guard's delay itself, so its setting may be 0. The simulated guard
    // needs this scene's delay.
    let delay_s = DELAY_PERIODS / f64::from(hardware.pwm_hz);
    let told_s: f64 = guard.delay_s.to_num();
    let guard_delay_s = match guard.change {
        ChangeOfForce::Measured => told_s.max(delay_s),
        ChangeOfForce::Estimated => told_s,
    };
    let mut text = String::new();
    // Writing into a string cannot fail.
    let _ = write!(
        text,
        "# A knob as `touchstone setup` measured it: {who}.
name = \"knob\"
description = \"A medium grip touches the measured knob's wall lightly, presses it with {:.0} mN·m, holds and lets go.\"

[device]
inertia_kg_m2 = {inertia:.4e}
damping_n_m_s_per_rad = {damping:.4e}
# The current limit's.
torque_limit_n_m = {:.4e}
# A step of the converter that measures the current.
amplifier_step_n_m = {:.4e}

[device.friction]
kinetic_n_m = {friction:.4e}

[encoder]
counts_per_rev = {}

[timing]
rate_hz = {}
duration_s = 4.5
# Until the compare values act, {DELAY_PERIODS} PWM periods.
computational_delay_s = {delay_s:.4e}

[wall]
surface_rad = 0.5
k_desired_n_m_per_rad = {}

[law]
kind = \"enhanced-sfa\"
# The encoder's largest error besides the rounding to counts.
position_error_rad = {:.4e}

[law.estimator]
inertia_kg_m2 = {inertia:.4e}
damping_n_m_s_per_rad = {damping:.4e}

[law.guard]
# Rather less than more.
damping_n_m_s_per_rad = {:.4e}
# As the board has them; with a second reading at least the delay above.
change = \"{}\"
delay_s = {guard_delay_s:.4e}
lag_s = {:.4e}

[operator]
grip = \"medium\"

[operator.motion]
kind = \"touch-and-press\"
start_s = 0.1
touch_ramp_s = 0.05
touch_s = 2.0
touch_torque_n_m = {:.4e}
ramp_s = 0.3
hold_s = 1.5
release_s = 0.4
push_torque_n_m = {press:.4e}
",
        1e3 * press,
        constant * current,
        constant * step.abs(),
        settings.encoder.counts_per_rev,
        settings.timing.rate_hz,
        settings.wall.k_desired_n_m_per_rad,
        position_error_rad,
        sure_damping(motor),
        guard.change.word(),
        guard.lag_s.to_num::<f64>(),
        0.2 * press,
    );
    text
}

/// Lines of the scene file on the encoder's eccentricity error; empty if no component of the error is significant.
pub fn encoder_text(encoder: Option<&Eccentricity>) -> String {
    let Some(encoder) = encoder.filter(|it| it.stands_out(0) || it.stands_out(1)) else {
        return String::new();
    };
    let [once, twice] = [0, 1].map(|index| {
        let it = &encoder.harmonics[index];
        let is_seen = encoder.stands_out(index);
        let amplitude_rad = if is_seen { it.amplitude_rad } else { 0.0 };
        (amplitude_rad, it.phase_rad)
    });
    format!(
        "
# The encoder's error once and twice a turn. Its phases are those from the zero of the calibration that measured it; the next
# calibration's zero is another one.
[sensor.periodic]
periods_per_rev = 1
amplitude_rad = {:.4e}
phase_rad = {:.4}
second_amplitude_rad = {:.4e}
second_phase_rad = {:.4}
",
        once.0, once.1, twice.0, twice.1,
    )
}
