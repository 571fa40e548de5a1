//! Faults that act on the whole knob: of the motor and its wires, of the computer, and of the data stored for the next start.

use super::bench::{Bench, Played};
use super::tamper::{Breaks, Bridge, Timing};
use touchstone_drive::around::Surrounding;
use touchstone_drive::calibration::Alignment;
use touchstone_drive::wire::{checked, hardware};
use touchstone_drive::{Angle, DeviceSettings, ResetReason, Si};
use touchstone_protocol::settings::environment::{DetentsBeside, Surround, TravelEnds};
use touchstone_protocol::{Board, Command, Decimal, FaultCode, State, stored};
use touchstone_world::motor::MotorParameters;
use touchstone_world::plant::{Device as Shaft, Hand};

/// A fault of the motor, its wires, or what it turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motor {
    /// The wire of a phase is open.
    Open(usize),
    /// The wires are connected in this order.
    Order([usize; 3]),
    /// This fraction of the windings' turns is left; the others are shorted.
    Turns(f64),
    /// The windings' resistance is this many times the right one.
    Resistance(f64),
    /// The magnets have this fraction of their strength.
    Magnets(f64),
    /// The alignment becomes wrong by this many electrical degrees; the encoder's readings stay right.
    Angle(f64),
    /// The knob comes off: the hand no longer acts on the shaft, which keeps its inertia.
    KnobOff,
    /// The bearings lose all their damping.
    NoDamping,
    /// The bearings jam: their damping becomes 1 N·m·s/rad.
    Jams,
}

/// A fault of the computer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Host {
    /// The computer sends nothing more.
    Silent,
    /// The computer sends invalid settings, 100 times a second.
    Garbage,
    /// The computer sends valid settings with twice the wall's stiffness and another number of pole pairs, 100 times a second.
    Others,
    /// The computer sends the command to arm in every tick.
    Arms,
    /// The computer sends the commands to disarm and arm in turn, one every 10 ticks.
    ArmsAgain,
    /// The computer sends the command to calibrate in every tick.
    Calibrates,
    /// The computer makes the present position zero, in every tick.
    Zeros,
    /// The environment changes every 40 ms: walls, end stops and detents come and go.
    Environment,
}

/// Which stored data are wrong at the next start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Memory {
    /// None: the run with which the others are compared.
    Right,
    /// A bit of the stored settings is flipped.
    Damaged,
    /// The stored alignment is wrong by this many electrical degrees.
    Alignment(f64),
    /// The settings are those of another motor: resistance, inductance and torque constant are this many times the motor's.
    Motor(f64),
    /// The resistance in the settings is this many times the motor's.
    Resistance(f64),
    /// The settings have another number of pole pairs.
    PolePairs(u8),
    /// The settings have another number of encoder counts per turn.
    Counts(u32),
    /// The processor restarted for this reason.
    Reset(ResetReason),
}

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

/// Whether a board can have an environment (further walls, end stops, detents): only boards with a larger chip can.
pub(super) const fn has_environment(board: Board) -> bool {
    board.is_large()
}
