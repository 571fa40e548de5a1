//! Tests the firmware's two interrupt functions (control tick and current loop) with a million random inputs. Nothing panics or
//! overflows. Outputs are on only while calibrating or armed. Only stop and calibration lead from a fault back to armed.

use touchstone_drive::encoder::{Asked, Frames};
use touchstone_drive::hardware::{B_G431B_ESC1, IHM08M1, IHM16M1, SIMPLEFOC_MINI};
use touchstone_drive::settings::DriveKind;
use touchstone_drive::{
    BridgeCommand, ControlInput, CurrentCommand, CurrentLoop, CurrentMode, CurrentReport,
    CurrentSample, Device, DeviceSettings, EncoderKind, EncoderReading, Ring, Si, TickTiming,
};
use touchstone_protocol::{Board, Command, FaultCode, Outputs, State};
use touchstone_tests::random::Random;

/// A random integer with a random number of significant bits. The ends of the 32-bit range then occur as often as its middle.
fn bits(random: &mut Random) -> u32 {
    let word = random.bits();
    let shifted = (word >> 32) as u32 >> (word & 31);
    if word & 32 == 0 { shifted } else { !shifted }
}

/// Returns true in one of `times` calls on average.
fn once_in(random: &mut Random, times: u64) -> bool {
    (random.bits() >> 20).is_multiple_of(times)
}

fn reading(random: &mut Random, kind: EncoderKind, last: &mut u32) -> EncoderReading {
    if once_in(random, 400) {
        return EncoderReading::Silent;
    }
    // Mostly a shaft that moves a little.
    *last = if once_in(random, 4_000) {
        bits(random)
    } else {
        last.wrapping_add(bits(random) % 5).wrapping_sub(2)
    };
    let garbled = once_in(random, 400);
    let count = i64::from(*last);
    match kind {
        EncoderKind::As5047p if garbled => {
            EncoderReading::As5047p(Frames::alone(bits(random) as u16))
        }
        EncoderKind::As5047p => EncoderReading::As5047p(Frames {
            angle: touchstone_world::motor::as5047p_frame(count),
            before: once_in(random, 100).then(|| Asked::Field(bits(random) as u16)),
        }),
        EncoderKind::Mt6701 if garbled => EncoderReading::Mt6701(bits(random)),
        EncoderKind::Mt6701 => {
            EncoderReading::Mt6701(touchstone_world::motor::mt6701_frame(count, 0))
        }
        EncoderKind::Incremental if garbled => EncoderReading::Mt6701(0),
        EncoderKind::Incremental => EncoderReading::Counter16(*last as u16),
    }
}

fn command(random: &mut Random, state: State) -> Option<Command> {
    // Mostly the command that leads on to the next state, so that every state is reached often.
    let towards = match state {
        State::Boot | State::Stopped => Command::Calibrate,
        State::Calibrating | State::Ready => Command::Arm,
        State::Armed => Command::Disarm,
        State::Fault(_) => Command::Stop,
    };
    match (random.bits() >> 20) % 1_024 {
        0 => Some(Command::Calibrate),
        1 => Some(Command::Arm),
        2 if once_in(random, 4) => Some(Command::Disarm),
        3 if once_in(random, 4) => Some(Command::Stop),
        4..40 if state != State::Armed => Some(towards),
        _ => None,
    }
}

fn settings(kind: EncoderKind, drive: DriveKind, rate_hz: u32) -> DeviceSettings {
    let mut settings = DeviceSettings::default();
    settings.encoder.kind = kind;
    settings.drive.kind = drive;
    settings.timing.rate_hz = rate_hz;
    // A calibration that ends soon.
    settings.motor.pole_pairs = 1;
    settings.calibration.electrical_turns_per_s = Si::lit("20");
    settings.wall.surface_rad = Si::lit("-0.1");
    settings
}

#[derive(Debug, Default)]
struct Visits {
    armed: u32,
    calibrating: u32,
    faults: [u32; FaultCode::ALL.len() + 1],
    on: u32,
}

/// Feeds random current reports and encoder readings into the control code (`Device`), and its commands with random samples into
/// `CurrentLoop`. Checks the outputs and states.
fn run(settings: &DeviceSettings, ticks: u32, seed: u64, visits: &mut Visits) {
    let mut random = Random::new(seed);
    let mut device = Device::new(settings, &IHM08M1).unwrap();
    let mut current = CurrentLoop::new(device.current_config());
    let mut ring = Ring::new(settings.timing.rate_hz);
    let mut report = CurrentReport::default();
    let mut mailbox = CurrentCommand::OFF;
    let (mut last, mut since_fault) = (0, [false; 2]);
    for _ in 0..ticks {
        let before = device.state();
        let wild = once_in(&mut random, 5_000);
        if wild {
            // Any bits that fit through the mailbox.
            report = CurrentReport::from_words(&std::array::from_fn(|_| bits(&mut random)));
        }
        let rare = |random: &mut Random| once_in(random, 6_000);
        // A rotor that stands in the calibration's field, measured by an encoder of 14 bits.
        if before == State::Calibrating && mailbox.mode == CurrentMode::Drive {
            last = (last & !0x3FFF) | u32::from(mailbox.angle.0 >> 2);
        }
        let input = ControlInput {
            encoder: reading(&mut random, settings.encoder.kind, &mut last),
            current: report,
            command: command(&mut random, before),
            hardware_break: rare(&mut random),
            gate_driver_error: rare(&mut random),
            stop_button: rare(&mut random),
            host_heard: !rare(&mut random),
            timing: if rare(&mut random) {
                TickTiming {
                    lateness: bits(&mut random),
                    duration: bits(&mut random),
                }
            } else {
                TickTiming {
                    lateness: 30,
                    duration: 2_000,
                }
            },
        };
        let output = device.tick(&input);
        ring.push(&output.record);
        let after = device.state();
        let on = output.outputs == Outputs::On;
        assert!(
            !on || matches!(after, State::Armed | State::Calibrating),
            "{after:?}"
        );
        assert_eq!(on, output.drive != touchstone_drive::DriveCommand::Off);
        assert!(!(on && matches!(after, State::Fault(_))));
        if let State::Fault(context) = before {
            assert!(
                after == before || after == State::Stopped && input.command == Some(Command::Stop)
            );
            since_fault = [true, false];
            visits.faults[usize::from(context.code.to_wire())] += 1;
        }
        if after == State::Calibrating {
            since_fault[1] = true;
        }
        if after == State::Armed {
            assert!(
                matches!(before, State::Ready | State::Armed),
                "from {before:?}"
            );
            assert!(
                !since_fault[0] || since_fault[1],
                "armed after a fault without a calibration"
            );
            visits.armed += 1;
        }
        visits.calibrating += u32::from(after == State::Calibrating);
        let torque_limit = settings.law.force_limit_n_m.to_num::<f64>();
        assert!(output.record.torque.0.to_num::<f64>().abs() <= torque_limit);

        // The current loop under the device's command, with samples from quiet to wild.
        mailbox = CurrentCommand::from_words(&output.mailbox().to_words());
        if output.reconfigure {
            current.reconfigure(device.current_config());
        }
        for _ in 0..device.current_config().periods_per_tick {
            let noise = |random: &mut Random| {
                if once_in(random, 200_000) {
                    bits(random) as u16
                } else {
                    bits(random) as u16 % 16
                }
            };
            // A current as the calibration commands it while its field stands still: 1 A, which is 64 codes.
            let (a, b) = match (after, mailbox.mode) {
                (State::Calibrating, CurrentMode::Drive) => (64, 32),
                _ => (0, 0),
            };
            let sample = CurrentSample {
                phase_a: (1_920_u16 + a).wrapping_add(noise(&mut random)),
                phase_b: (1_920_u16 - b).wrapping_add(noise(&mut random)),
                bus: 1_550_u16.wrapping_add(noise(&mut random)),
                temperature: 1_300_u16.wrapping_add(noise(&mut random)),
                hardware_break: once_in(&mut random, 200_000),
                late: once_in(&mut random, 500),
                command: mailbox,
            };
            let out = current.tick(&sample);
            if let BridgeCommand::On(duties) = out.bridge {
                assert!(on, "the loop drives what the device has switched off");
                let modulator = IHM08M1.modulator();
                assert!(
                    duties.iter().all(
                        |d| (modulator.top - modulator.longest..=modulator.longest).contains(d)
                    )
                );
                visits.on += 1;
            }
            report = CurrentReport::from_words(&current.report().to_words());
        }
    }
}

#[test]
fn a_million_ticks_keep_the_promises() {
    let mut visits = Visits::default();
    let mut seed = 1;
    for (kind, drive, rate) in [
        (EncoderKind::As5047p, DriveKind::ThreePhase, 1_000),
        (EncoderKind::Mt6701, DriveKind::ThreePhase, 2_000),
        (EncoderKind::As5047p, DriveKind::Analogue, 10_000),
        (EncoderKind::Incremental, DriveKind::Analogue, 1_000),
    ] {
        for _ in 0..5 {
            let mut settings = settings(kind, drive, rate);
            settings.encoder.counts_per_rev = 16_384;
            run(&settings, 50_000, seed, &mut visits);
            seed += 1;
        }
    }
    println!("{visits:?}");
    assert!(
        visits.armed > 100_000 && visits.calibrating > 10_000 && visits.on > 100_000,
        "{} {} {}",
        visits.armed,
        visits.calibrating,
        visits.on
    );
    // Faults that occurred by chance; the others have tests of their own.
    let seen = visits.faults.iter().filter(|n| **n > 0).count();
    assert!(seen >= 10, "{:?}", visits.faults);
}

#[test]
fn wild_commands_into_the_loop() {
    let mut random = Random::new(77);
    let boards = [
        (Board::NucleoG474re, IHM08M1),
        (Board::BG431bEsc1, B_G431B_ESC1),
        (Board::NucleoG474reIhm16m1, IHM16M1),
        (Board::NucleoG474reSimplefocMini, SIMPLEFOC_MINI),
        (Board::NucleoG431rbIhm16m1, IHM16M1),
    ];
    for (board, hardware) in boards {
        let mut settings = DeviceSettings::defaults(board);
        // A supply voltage that all boards allow.
        settings.limits.bus_max_v = Si::lit("24");
        let device = Device::new(&settings, &hardware).unwrap();
        let mut current = CurrentLoop::new(device.current_config());
        let mut command = CurrentCommand::OFF;
        for period in 0..500_000_u32 {
            if period % 7 == 0 {
                command = CurrentCommand::from_words(&std::array::from_fn(|_| bits(&mut random)));
                if period < 20_000 {
                    command.mode = CurrentMode::Offsets;
                }
            }
            let out = current.tick(&CurrentSample {
                phase_a: bits(&mut random) as u16,
                phase_b: bits(&mut random) as u16,
                bus: bits(&mut random) as u16,
                temperature: bits(&mut random) as u16,
                hardware_break: once_in(&mut random, 256),
                late: once_in(&mut random, 4),
                command,
            });
            if let BridgeCommand::On(duties) = out.bridge {
                let modulator = hardware.modulator();
                assert!(
                    duties.iter().all(
                        |d| (modulator.top - modulator.longest..=modulator.longest).contains(d)
                    )
                );
            }
        }
    }
}
