//! Tests the torque resolution of each board: the torque of one code of its current sensors, and the torque ripple that noise of
//! one code causes through current loop and motor. `cargo test -p touchstone-tests torque_resolution:: -- --nocapture` prints
//! the table.

use touchstone_drive::hardware::{B_G431B_ESC1, Hardware, IHM08M1, IHM16M1};
use touchstone_drive::transform::Dq;
use touchstone_drive::{
    Amps, BridgeCommand, CurrentCommand, CurrentConfig, CurrentLoop, CurrentMode, CurrentSample,
};
use touchstone_protocol::{Board, DeviceSettings};
use touchstone_tests::random::Random;
use touchstone_world::motor::{Bridge, Drive, GIMBAL, KNOB, MotorParameters, Rig, Shunt};
use touchstone_world::plant::{BareLinear, Device};

const PERIOD_S: f64 = 50e-6;

/// The motor that is sold with the shield X-NUCLEO-IHM16M1. Its resistance includes half of the driver's 1 Ω and half of the
/// shunt's 0.33 Ω.
const KIT: MotorParameters = MotorParameters {
    resistance_ohm: 5.955,
    inductance_h: 1.05e-3,
    flux_linkage_wb: 5.38e-3,
    ..GIMBAL
};

/// Torque resolution of a board with a motor, mN·m; `per_code` is the torque of one code of the current sensors.
struct TorqueResolution {
    per_code: f64,
    /// Root mean square change, mN·m, of the mean torque from one control period to the next.
    ripple: f64,
    /// Error of the mean torque over one second, mN·m.
    off: f64,
}

/// Simulates a held shaft at 0.3 of the largest current. Each current reading has Gaussian noise of `noise` codes rms.
fn held(
    hardware: &Hardware,
    settings: &DeviceSettings,
    motor: MotorParameters,
    noise: f64,
) -> TorqueResolution {
    let blocked = Device {
        inertia: 1e3,
        ..KNOB
    };
    let bus_v = if motor == KIT { 12.0 } else { 24.0 };
    let mut rig = Rig::new(
        motor,
        Bridge::ideal(bus_v, hardware.timer_top),
        BareLinear::new(&blocked, PERIOD_S / 2.0).unwrap(),
        0.0,
    );
    let mut current = CurrentLoop::new(CurrentConfig::new(settings, hardware).unwrap());
    let amps_per_code: f64 = hardware.amps_per_code.to_num();
    let shunts = [0.3, -0.2]
        .map(|between| Shunt::bits12(amps_per_code, f64::from(hardware.offset_code) + between));
    let mut random = Random::new(7);
    let wanted_a = 0.3 * settings.motor.current_limit_a.to_num::<f64>();
    let mut command = CurrentCommand {
        mode: CurrentMode::Offsets,
        ..CurrentCommand::OFF
    };
    let (mut preloaded, mut sum, mut periods) = (Drive::Off, 0.0, 0);
    let mut ticks = Vec::new();
    for period in 0..30_000 {
        let now = rig.now();
        let mut code = |phase: usize| {
            let noisy = now.currents_a[phase] + noise * amps_per_code * normal(&mut random);
            shunts[phase].code(noisy)
        };
        let out = current.tick(&CurrentSample {
            phase_a: code(0),
            phase_b: code(1),
            bus: (bus_v / hardware.volts_per_code.to_num::<f64>()) as u16,
            temperature: 1_300,
            hardware_break: false,
            late: false,
            command,
        });
        if out.pend_control {
            command.tick += 1;
            if period > 2_000 {
                command.mode = CurrentMode::Drive;
                command.current = Dq {
                    d: Amps::ZERO,
                    q: Amps::from_num(wanted_a),
                };
            }
            if periods == 20 {
                ticks.push(sum / 20.0);
            }
            (sum, periods) = (0.0, 0);
        }
        let (acting, next) = match (out.bridge, preloaded) {
            (BridgeCommand::Off, _) => (Drive::Off, Drive::Off),
            (BridgeCommand::On(duties), Drive::Off) => {
                (Drive::On(hardware.modulator().zero()), Drive::On(duties))
            }
            (BridgeCommand::On(duties), before) => (before, Drive::On(duties)),
        };
        for drive in [acting, next] {
            sum += rig.step(drive, 0.0).torque_n_m / 2.0;
        }
        preloaded = next;
        periods += 1;
    }
    let ticks = &ticks[ticks.len() - 1_000..];
    let mean = ticks.iter().sum::<f64>() / 1_000.0;
    let squares = ticks.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
    let k_t = motor.torque_constant_nm_per_a();
    TorqueResolution {
        per_code: 1e3 * amps_per_code.abs() * k_t,
        ripple: 1e3 * (squares.sum::<f64>() / 999.0).sqrt(),
        off: 1e3 * (mean - wanted_a * k_t).abs(),
    }
}

/// A random number of approximately normal distribution with mean 0 and variance 1: half the sum of twelve uniform numbers from -1
/// to 1.
fn normal(random: &mut Random) -> f64 {
    (0..12).map(|_| random.real()).sum::<f64>() / 2.0
}

#[test]
fn the_small_shield_is_ten_times_finer() {
    let small = DeviceSettings::defaults(Board::NucleoG474reIhm16m1);
    let large = DeviceSettings::defaults(Board::NucleoG474re);
    let boards = [
        ("IHM16M1", IHM16M1),
        ("IHM08M1", IHM08M1),
        ("B-G431B-ESC1", B_G431B_ESC1),
    ];
    let mut ripples = Vec::new();
    println!(
        "board          motor    mN·m a code   ripple at 1 code rms   without noise   mean off by"
    );
    for (motor, settings, parts) in [("kit", &small, KIT), ("0.25 N·m/A", &large, GIMBAL)] {
        for (name, hardware) in boards {
            if parts == GIMBAL && name == "IHM16M1" {
                // 2 A exceed what this shield is made for.
                continue;
            }
            let noisy = held(&hardware, settings, parts, 1.0);
            let quiet = held(&hardware, settings, parts, 0.0);
            println!(
                "{name:<14} {motor:<10} {:>8.3} {:>18.3} {:>18.3} {:>14.3}",
                noisy.per_code, noisy.ripple, quiet.ripple, noisy.off
            );
            // A calm loop gives no more torque noise than its readings have, and its mean is right to 0.6 of a code.
            assert!(noisy.ripple < noisy.per_code, "{name}: {}", noisy.ripple);
            assert!(noisy.off < 0.6 * noisy.per_code, "{name}: {}", noisy.off);
            ripples.push(noisy.ripple);
        }
    }
    // All three on the motor `KIT`.
    assert!(ripples[0] < 0.13 * ripples[1], "{ripples:?}");
    assert!(ripples[0] < 0.07 * ripples[2], "{ripples:?}");
}
