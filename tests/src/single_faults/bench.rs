//! Simulates each board with its motor, knob and hand up to the moment at which a part breaks.

use super::encoder::Encoder;
use super::tamper::{Analogue, Breaks, Broken};
use crate::knob::{Knob, PERIOD_S};
use touchstone_drive::calibration::Alignment;
use touchstone_drive::wire::{checked, hardware};
use touchstone_drive::{Device, DeviceSettings, Hardware, Si};
use touchstone_protocol::{Board, Command, State};
use touchstone_world::motor::{GIMBAL, KNOB, MotorParameters};
use touchstone_world::plant::{Device as Shaft, FIRM, Hand, HeldLinear, LIGHT};

/// The simulated knob in which a part breaks.
pub type Played = Knob<Broken, HeldLinear>;

/// When a part breaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Moment {
    /// The board is ready, and is armed 50 ms later; then the hand presses.
    Ready,
    /// The hand goes in and out of the wall, twice a second.
    Touching,
    /// The hand presses; its rest point's depth varies by ±30 % at 1.5 Hz.
    Pressing,
}

impl Moment {
    /// All moments.
    pub const ALL: [Self; 3] = [Self::Ready, Self::Touching, Self::Pressing];

    /// The moment's name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ready => "ready",
            Self::Touching => "touching",
            Self::Pressing => "pressing",
        }
    }
}

/// How firmly the hand holds the knob.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grip {
    /// With a fingertip.
    Light,
    /// With the whole hand.
    Firm,
}

impl Grip {
    /// Both grips.
    pub const ALL: [Self; 2] = [Self::Light, Self::Firm];

    /// The grip's name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Firm => "firm",
        }
    }
}

/// Time from the beginning of the hand's motion to the fault, s.
pub const BEFORE_S: f64 = 1.0;
/// Time from the fault until the hand goes out of the wall, s.
pub const STAYS_S: f64 = 2.2;
/// [`STAYS_S`] in the longer repetition of a run in which the board found no fault.
pub const LONG_STAYS_S: f64 = 32.2;
/// Time from when the hand goes out of the wall until the run ends, s.
pub const LEAVES_S: f64 = 0.8;
/// Time from the fault to the arming of a board that is ready, s.
pub const ARMS_AFTER_S: f64 = 0.05;
/// How far outside of the wall's surface the hand begins and ends, rad.
const OUTSIDE_RAD: f64 = 0.3;

/// A board at the moment before a part breaks.
#[derive(Clone)]
pub struct Bench {
    /// The board.
    pub board: Board,
    /// The moment.
    pub moment: Moment,
    /// The grip.
    pub grip: Grip,
    /// Quarter of an electrical turn in which the wall's surface lies, from 0 to 3. It decides which phases drive the motor there.
    pub quarter: u8,
    pub(super) settings: DeviceSettings,
    pub(super) motor: MotorParameters,
    pub(super) shaft: Shaft,
    pub(super) hand: Hand,
    pub(super) alignment: Option<Alignment>,
    pub(super) knob: Played,
    /// Shaft angle at the device's zero, rad.
    pub(super) zero_rad: f64,
    /// Least energy that knob and hand had got from the motor in total, at any time since the hand began to move, J.
    pub(super) least_j: f64,
    /// [`super::Cell::course`] of a healthy board: without a restart, and with one.
    pub(super) healthy: [u64; 2],
}

/// A board's settings, motor, shaft with knob, and supply voltage in V.
fn parts(board: Board) -> (DeviceSettings, MotorParameters, Shaft, f64) {
    let mut settings = DeviceSettings::defaults(board);
    // The small gimbal motor's knob as in the scene `gimbal-knob`. A phase's resistance includes half of the driver's and half of
    // the shunt's resistance.
    let small = MotorParameters {
        inductance_h: 1.05e-3,
        flux_linkage_wb: 5.38e-3,
        ..GIMBAL
    };
    let knob = Shaft {
        inertia: 3e-5,
        damping: 9e-6,
        friction: None,
    };
    match board {
        Board::NucleoG474re | Board::BG431bEsc1 => (settings, GIMBAL, KNOB, 24.0),
        Board::NucleoG474reIhm16m1 | Board::NucleoG431rbIhm16m1 => (settings, small, knob, 12.0),
        Board::NucleoG474reSimplefocMini => {
            // Values that a user enters by hand (docs/voltage-mode.md).
            settings.motor.resistance_ohm = Si::lit("5.53");
            settings.motor.inductance_h = Si::lit("0.00105");
            settings.motor.torque_constant_n_m_per_a = Si::lit("0.0565");
            settings.law.force_limit_n_m = Si::lit("0.045");
            let motor = MotorParameters {
                resistance_ohm: 5.53,
                ..small
            };
            (settings, motor, knob, 12.0)
        }
    }
}

/// A calibrated and armed board without a fault, with the noise and the rare bad readings that an encoder has. The four factors
/// multiply resistance, flux linkage and inductance of the motor and the inertia of the knob. Also returns the angle of the wall's
/// surface, rad.
///
/// # Panics
/// The board is not armed.
#[must_use]
pub fn good(board: Board, factors: [f64; 4], hand: &Hand) -> (Played, f64) {
    let mut knob = ready(board, factors, hand);
    let surface_rad = knob.rig.now().angle_rad + 0.2;
    knob.ask(Command::Arm);
    knob.tick();
    assert_eq!(
        knob.device.state(),
        State::Armed,
        "{:?}",
        knob.device.fault()
    );
    knob.tamper.breaks = Breaks::Encoder(Encoder::Usual);
    knob.tamper.is_broken = true;
    (knob, surface_rad)
}

/// A calibrated board without a fault, with its outputs off. The wall's surface is 0.2 rad from the shaft. The four factors are those
/// of [`good`].
///
/// # Panics
/// The calibration fails.
#[must_use]
pub fn ready(board: Board, [ohms, flux, henries, inertia]: [f64; 4], hand: &Hand) -> Played {
    let (mut settings, motor, shaft, bus_v) = parts(board);
    settings.wall.surface_rad = Si::lit("0.2");
    let motor = MotorParameters {
        resistance_ohm: motor.resistance_ohm * ohms,
        flux_linkage_wb: motor.flux_linkage_wb * flux,
        inductance_h: motor.inductance_h * henries,
        ..motor
    };
    let shaft = Shaft {
        inertia: shaft.inertia * inertia,
        ..shaft
    };
    calibrated(board, &settings, motor, &shaft, hand, bus_v)
}

fn calibrated(
    board: Board,
    settings: &DeviceSettings,
    motor: MotorParameters,
    shaft: &Shaft,
    hand: &Hand,
    bus_v: f64,
) -> Played {
    let plant = HeldLinear::new(shaft, hand, PERIOD_S / 2.0).expect("a plant");
    let hardware = hardware(board);
    let broken = Broken::new(analogue(board, hardware, settings, bus_v));
    let mut knob = Knob::on(hardware, settings, motor, plant, 0.0, broken);
    knob.restart(Device::new(settings, hardware).expect("settings"));
    assert_eq!(knob.calibrate(), State::Ready, "{:?}", knob.device.fault());
    knob
}

impl Bench {
    /// See [`Bench::new`], which also records what a healthy board does.
    pub(super) fn begun(board: Board, moment: Moment, grip: Grip, quarter: u8) -> Self {
        let (mut settings, motor, shaft, bus_v) = parts(board);
        let turn = std::f64::consts::TAU / f64::from(motor.pole_pairs);
        let surface_rad = 0.2 + f64::from(quarter) * turn / 4.0;
        settings.wall.surface_rad = Si::from_num(surface_rad);
        assert_eq!(checked(&settings, board), Ok(()));
        let hand = match grip {
            Grip::Light => LIGHT,
            Grip::Firm => FIRM,
        };
        let knob = calibrated(board, &settings, motor, &shaft, &hand, bus_v);
        let zero_rad = knob.rig.now().angle_rad;
        let mut bench = Self {
            board,
            moment,
            grip,
            quarter,
            settings,
            motor,
            shaft,
            hand,
            alignment: knob.device.found(),
            knob,
            zero_rad,
            least_j: 0.0,
            healthy: [0; 2],
        };
        bench.begin();
        bench
    }

    /// All combinations of moment, grip and quarter.
    pub fn places() -> impl Iterator<Item = (Moment, Grip, u8)> {
        Moment::ALL
            .into_iter()
            .flat_map(|moment| Grip::ALL.map(|grip| (moment, grip)))
            .flat_map(|(moment, grip)| [0, 1, 2, 3].map(|quarter| (moment, grip, quarter)))
    }

    fn begin(&mut self) {
        let mut knob = self.knob.clone();
        if self.moment != Moment::Ready {
            knob.ask(Command::Arm);
        }
        self.least_j = knob.rig.given_j;
        for tick in 0..(BEFORE_S * 1e3) as u32 {
            let since_s = f64::from(tick) * 1e-3 - BEFORE_S;
            knob.rest_rad = self.rest_rad(since_s, -BEFORE_S, self.zero_rad, STAYS_S);
            while !knob.period() {
                self.least_j = self.least_j.min(knob.rig.given_j);
            }
        }
        let wanted = match self.moment {
            Moment::Ready => State::Ready,
            Moment::Touching | Moment::Pressing => State::Armed,
        };
        assert_eq!(knob.device.state(), wanted, "{:?}", knob.device.fault());
        self.knob = knob;
    }

    /// The board's control code with these settings.
    pub(super) fn device(&self, settings: &DeviceSettings) -> Device {
        Device::new(settings, hardware(self.board)).expect("settings")
    }

    /// The simulated mechanics with this shaft and hand. `factor` makes the time step longer.
    pub(super) fn plant(&self, shaft: &Shaft, hand: &Hand, factor: f64) -> HeldLinear {
        HeldLinear::new(shaft, hand, factor * PERIOD_S / 2.0).expect("a plant")
    }

    /// Most energy in J that the guard lets a hand get in one run with `STAYS_S`.
    #[must_use]
    pub fn promise_j(&self) -> f64 {
        let law = touchstone_drive::change::law_settings(&self.settings, hardware(self.board));
        let (law, _) = law.expect("settings");
        let count: f64 = std::f64::consts::TAU / super::encoder::COUNTS;
        let force: f64 = law.force_limit.to_num();
        let (capacity, refill): (f64, f64) =
            (law.guard.capacity.to_num(), law.guard.refill.to_num());
        capacity + force * count / 2.0 + refill * (BEFORE_S + STAYS_S + LEAVES_S)
    }

    /// Rest point of the hand, rad, at the time `since_s` after the fault. The hand begins to move at `began_s` (not used for
    /// [`Moment::Ready`]) and goes out of the wall at `stays_s`, both times after the fault.
    pub(super) fn rest_rad(&self, since_s: f64, began_s: f64, zero_rad: f64, stays_s: f64) -> f64 {
        use std::f64::consts::TAU;
        let surface = zero_rad + self.settings.wall.surface_rad.to_num::<f64>();
        let outside = surface - OUTSIDE_RAD;
        let limit: f64 = self.settings.law.force_limit_n_m.to_num();
        // Mean depth of the hand's rest point, at most 3 rad: the hand's spring then gives four tenths of the force limit. The
        // motion below is added to this depth.
        let deep = (0.4 * limit / self.hand.stiffness).min(3.0);
        let begins = match self.moment {
            Moment::Ready => ARMS_AFTER_S + 0.05,
            Moment::Touching | Moment::Pressing => began_s,
        };
        let time = since_s - begins;
        let goes_in = (time / 0.5).clamp(0.0, 1.0);
        let wanted = match self.moment {
            Moment::Touching => surface + goes_in * 0.1 * (2.0 * TAU * time).sin(),
            Moment::Ready | Moment::Pressing => {
                surface + deep * (1.0 + 0.3 * (1.5 * TAU * time).sin())
            }
        };
        let goes_out = ((since_s - stays_s) / 0.2).clamp(0.0, 1.0);
        let there = outside + goes_in * (wanted - outside);
        there + goes_out * (outside - there)
    }
}

fn analogue(board: Board, hardware: &Hardware, settings: &DeviceSettings, bus_v: f64) -> Analogue {
    let rest = f64::from(hardware.offset_code);
    Analogue {
        bus_v,
        // The codes at zero current of the simulated sensors (`shunts` in `host-sim/knob`).
        rest: match board {
            Board::NucleoG474re | Board::NucleoG474reSimplefocMini => [2_128.3, 2_099.8],
            _ => [rest + 6.3, rest - 22.2],
        },
        amps_per_code: hardware.amps_per_code.to_num(),
        limit_a: settings.motor.current_limit_a.to_num(),
        trip_a: settings.limits.trip_current_a.to_num(),
        top: hardware.timer_top,
        has_line: matches!(
            board,
            Board::NucleoG474reIhm16m1
                | Board::NucleoG431rbIhm16m1
                | Board::NucleoG474reSimplefocMini
        ),
    }
}
