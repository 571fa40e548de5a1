//! Faults that act on the whole knob: of the motor and its wires, of the computer, and of the data stored for the next start.

use super::bench::{Bench, Played};
use super::broken::{Host, Memory, Motor, has_environment};
use super::tamper::{Breaks, Bridge, Timing};
use touchstone_drive::around::Surrounding;
use touchstone_drive::calibration::Alignment;
use touchstone_drive::wire::{checked, hardware};
use touchstone_drive::{Angle, DeviceSettings, Si};
use touchstone_protocol::settings::environment::{DetentsBeside, Surround, TravelEnds};
use touchstone_protocol::{Command, Decimal, FaultCode, State, stored};
use touchstone_world::motor::MotorParameters;
use touchstone_world::plant::{Device as Shaft, Hand};

impl Memory {
    /// Restarts the board with its stored data, and calibrates it.
    pub(super) fn restart(self, bench: &Bench, knob: &mut Played) {
        let board = bench.board;
        let mut settings = bench.settings.clone();
        let alignment = knob.device.found().or(bench.alignment);
        match self {
            Self::Motor(factor) => {
                let factor = Si::from_num(factor);
                settings.motor.resistance_ohm *= factor;
                settings.motor.inductance_h *= factor;
                settings.motor.torque_constant_n_m_per_a *= factor;
            }
            Self::Resistance(factor) => settings.motor.resistance_ohm *= Si::from_num(factor),
            Self::PolePairs(pairs) => settings.motor.pole_pairs = pairs,
            Self::Counts(counts) => settings.encoder.counts_per_rev = counts,
            Self::Right | Self::Damaged | Self::Alignment(_) | Self::Reset(_) => {}
        }
        let mut image = [0; stored::IMAGE_MAX];
        let length = stored::encode(&settings, &mut image).map_or(0, <[u8]>::len);
        if self == Self::Damaged {
            image[length / 2] ^= 4;
        }
        let check = |settings: &DeviceSettings| checked(settings, board);
        let defaults = DeviceSettings::defaults(board);
        let start = stored::start(Some(&image[..length]), defaults, &check);
        let is_refused = start.refused.is_some();
        settings = start.settings;
        let mut device = bench.device(&settings);
        if let Self::Reset(reason) = self {
            device.started(reason);
        }
        if is_refused {
            device.report_fault(FaultCode::SettingsInvalid, 0);
        }
        if let (Self::Alignment(degrees), Some(kept)) = (self, alignment) {
            let wrong = Angle((degrees / 360.0 * 65_536.0) as i32 as u16);
            device.keep(Some(Alignment {
                offset: kept.offset.plus(wrong),
                ..kept
            }));
        }
        knob.restart(device);
        knob.calibrate();
    }
}

/// Applies the fault in the `n`-th tick since it began.
pub(super) fn act(bench: &Bench, breaks: Breaks, knob: &mut Played, n: u32) {
    match breaks {
        Breaks::Motor(motor) if n == 0 => motor.happens(bench, knob),
        Breaks::Bridge(Bridge::DeadTime(share)) => knob.rig.bridge.dead_share = share,
        Breaks::Timing(Timing::Clock(factor)) if n == 0 => {
            let motor = *knob.rig.motor();
            knob.rig
                .change(motor, bench.plant(&bench.shaft, &bench.hand, factor));
        }
        Breaks::Host(host) => host.acts(bench, knob, n),
        _ => {}
    }
}

impl Motor {
    fn happens(self, bench: &Bench, knob: &mut Played) {
        let mut motor: MotorParameters = bench.motor;
        let (mut shaft, mut hand): (Shaft, Hand) = (bench.shaft, bench.hand);
        match self {
            Self::Open(phase) => knob.rig.wires.open = Some(phase),
            Self::Order(order) => knob.rig.wires.order = order,
            Self::Turns(share) => {
                motor.resistance_ohm *= share;
                motor.inductance_h *= share * share;
                motor.flux_linkage_wb *= share;
            }
            Self::Resistance(factor) => motor.resistance_ohm *= factor,
            Self::Magnets(share) => motor.flux_linkage_wb *= share,
            Self::Angle(degrees) => motor.electrical_zero_rad += degrees.to_radians(),
            Self::KnobOff => (hand.pad_stiffness, hand.pad_damping) = (0.0, 0.0),
            Self::NoDamping => shaft.damping = 0.0,
            Self::Jams => shaft.damping = 1.0,
        }
        knob.rig.change(motor, bench.plant(&shaft, &hand, 1.0));
    }
}

/// The environment (walls, end stops, detents) in the `n`-th tick since the fault began.
fn environment(settings: &DeviceSettings, n: u32) -> Surround {
    let share = |of: Si, percent: i64| Decimal(of * Si::from_num(percent) / 100);
    let limit = settings.law.force_limit_n_m;
    let surface = settings.wall.surface_rad;
    let more = Surround {
        detents: Some(DetentsBeside {
            per_rev: 24,
            pitch_rad: Decimal(Si::ZERO),
            strength_n_m: share(limit, 20),
            centre_rad: Decimal(Si::ZERO),
        }),
        endstops: Some(TravelEnds {
            lower_rad: Decimal(surface - Si::lit("0.4")),
            upper_rad: Decimal(surface + Si::lit("0.01")),
            stiffness_n_m_per_rad: None,
        }),
        ..Surround::default()
    };
    match n / 40 % 3 {
        0 => more,
        1 => Surround::default(),
        _ => Surround {
            first_wall: false,
            ..Surround::default()
        },
    }
}

impl Host {
    fn acts(self, bench: &Bench, knob: &mut Played, n: u32) {
        let board = bench.board;
        match self {
            Self::Silent => {}
            Self::Garbage | Self::Others => {
                if !n.is_multiple_of(10) {
                    return;
                }
                let mut settings = bench.settings.clone();
                if self == Self::Garbage {
                    settings.law.force_limit_n_m = Si::lit("1000000");
                    settings.timing.rate_hz = 3;
                    settings.motor.pole_pairs = 0;
                } else {
                    settings.wall.k_desired_n_m_per_rad *= 2;
                    settings.motor.pole_pairs = 11;
                }
                // The firmware handles settings from the computer in the same way.
                if checked(&settings, board).is_ok() && knob.device.may_configure() {
                    let _ = knob.device.configure(&settings, hardware(board));
                }
            }
            Self::Arms => knob.ask(Command::Arm),
            Self::ArmsAgain => match (n.is_multiple_of(10), knob.device.state()) {
                (true, State::Armed) => knob.ask(Command::Disarm),
                (true, State::Ready) => knob.ask(Command::Arm),
                _ => {}
            },
            Self::Calibrates => knob.ask(Command::Calibrate),
            Self::Zeros => {
                knob.device.zero_here();
            }
            Self::Environment => {
                if n.is_multiple_of(40) && has_environment(board) {
                    let wanted = environment(&bench.settings, n);
                    let made = Surrounding::new(&bench.settings, hardware(board), &wanted);
                    let made = made.unwrap_or_else(|error| panic!("{error}"));
                    knob.device.surround(&mut knob.around, &made);
                }
            }
        }
    }
}
