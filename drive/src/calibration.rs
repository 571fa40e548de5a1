//! Calibration, before the first torque. It measures the current sensors' offsets, the encoder's direction, and which encoder count
//! belongs to which electrical angle, and checks the number of pole pairs.
//!
//! ```text
//! Offsets -> Raise -> Settle -> Forward -> Back -> done
//! ```
//!
//! 1. With the bridge off, the current loop takes the mean of 1,024 readings of each current sensor. The mean must be near the
//!    schematic's value.
//! 2. A current along a field that stands still is raised slowly. The rotor turns into the field, by at most half an electrical
//!    turn. A rotor that stood against the field begins to turn late, and then swings about the field. The field waits as long as
//!    the rotor swings, up to three seconds.
//! 3. The field turns one electrical turn and then one mechanical turn forward (`pole pairs` electrical turns), and all of it
//!    back; the rotor follows. In the first electrical turn of each direction no samples are taken: that turn frees a rotor that
//!    happened to stand against the field, and takes up friction. The counts moved in the mechanical turn give direction and pole
//!    pairs.
//! 4. In both directions, at each eighth of an electrical turn, the angle between field and rotor is sampled. Friction makes the
//!    rotor lag behind the field, in opposite directions on the way forward and back, so the mean of both is right. Because the
//!    mean is over a whole turn, an eccentric magnet does not change it.
//!
//! The result is used only if all of it is plausible. Every stage ends after a limited number of control periods.
//!
//! If the alignment of an absolute encoder is stored, the calibration checks that alignment instead (module `check`).

#[cfg(feature = "large")]
mod check;
mod config;
mod fit;
#[cfg(test)]
mod tests;

use crate::angle::Angle;
use crate::current::{CurrentCommand, CurrentMode, CurrentReport};
use crate::transform::Dq;
use crate::units::clamp_i32;
use crate::{Amps, Volts};
#[cfg(feature = "large")]
use check::Check;
pub use config::CalibrationConfig;
use fit::Fit;
use touchstone_protocol::FaultCode;

/// Why a calibration failed. The fault [`FaultCode::CalibrationFailed`] carries this number as its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Reason {
    /// The current loop did not report the current sensors' offsets in time.
    OffsetsLate = 1,
    /// The shaft did not move as far as the settings' number of pole pairs and counts per turn predict.
    PolePairs = 2,
    /// The shaft did not return to the position where it began: the rotor slipped by a pole.
    NotBack = 3,
    /// The shaft did not follow the field: it is held or loaded, or the encoder is not on the motor's shaft.
    Uneven = 4,
    /// The current did not reach its commanded value: a phase is open, or the bus voltage is too low.
    NoCurrent = 5,
    /// In the motor measurement a current pulse hardly moved the shaft: it is held, or its friction is larger than the motor's
    /// torque.
    Held = 6,
    /// The rotor was not near the field at the electrical angle that the stored alignment gives.
    KeptWrong = 7,
    /// While the stored alignment was checked, the shaft did not move with the field: it is held or loaded, or the alignment is
    /// wrong.
    KeptNotFollowed = 8,
    /// The shaft did not come to rest, so the stored alignment could not be checked.
    KeptTurning = 9,
    /// The board measures no current, so it needs the motor's resistance, inductance and torque constant, and one of them is not
    /// set.
    MotorUntold = 10,
    /// The same current needed a different voltage in another direction: the gain of a current sensor or the resistance of a phase
    /// is wrong.
    Unbalanced = 11,
}

impl Reason {
    /// All reasons, in the order of their numbers.
    pub const ALL: [Self; 11] = [
        Self::OffsetsLate,
        Self::PolePairs,
        Self::NotBack,
        Self::Uneven,
        Self::NoCurrent,
        Self::Held,
        Self::KeptWrong,
        Self::KeptNotFollowed,
        Self::KeptTurning,
        Self::MotorUntold,
        Self::Unbalanced,
    ];

    /// The reason with this number, which a fault carries as its value; `None` if no reason has the number.
    #[must_use]
    pub fn from_value(value: i32) -> Option<Self> {
        Self::ALL.into_iter().find(|reason| *reason as i32 == value)
    }
}

/// Result of a calibration: how the electrical angle follows from the encoder count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Alignment {
    /// Electrical angle in 1/65,536 of a turn at count 0 of the unwrapped encoder.
    pub offset: Angle,
    /// Whether the electrical angle falls when the encoder count rises.
    pub against: bool,
}

/// Progress of a calibration after a control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// The calibration continues; holds the command for the current loop.
    Running(CurrentCommand),
    /// The calibration is done; holds its result.
    Done(Alignment),
    /// The calibration failed; holds the fault's code and value.
    Failed(FaultCode, i32),
}

/// Number of samples per electrical turn, as a power of two (3: eight samples).
const SAMPLES_LOG2: u32 = 3;
/// Largest allowed spread (largest less smallest) of the sampled angles between field and rotor, in 1/65,536 electrical turns: a
/// quarter turn, the angle at which the torque is largest.
const SPREAD: i32 = 0x4000;

/// Longest time in quarters of a second that a rotor may swing in the field before the field turns.
const SWINGS: u8 = 12;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    Offsets,
    Raise,
    Settle,
    Forward,
    Back,
    #[cfg(feature = "large")]
    Rock,
}

/// The state of a running calibration, from one control period to the next.
#[derive(Debug, Clone, Copy)]
pub struct Calibration {
    config: CalibrationConfig,
    stage: Stage,
    /// Control periods since the present stage began.
    ticks: u32,
    current: Amps,
    /// Angle of the calibration's rotating field, 2^-32 electrical turns.
    field: i64,
    /// Speed of the calibration's rotating field, 2^-32 electrical turns per control period.
    speed: u32,
    /// `began` and `ended`: encoder counts at the start and the end of the examined forward turn. While the rotor settles: smallest
    /// and largest count of the last quarter of a second. On the way back, `ended` becomes the count at which the field is back at
    /// the start.
    began: i64,
    ended: i64,
    /// Time in quarters of a second for which the rotor has swung in the standing field.
    swung: u8,
    /// Angles between field and rotor, under the assumption that the count rises with the electrical angle; `against`: that it
    /// falls.
    along: Fit,
    against: Fit,
    samples: i32,
    /// Voltage along the rotating field, through a first-order low-pass filter with a time constant of 16 control periods. `least`
    /// and `most` are its extremes at the sampled positions.
    volts: Volts,
    least: Volts,
    most: Volts,
    #[cfg(feature = "large")]
    check: Option<Check>,
}

impl Calibration {
    /// Begins a calibration with its first stage, the current sensors' offsets.
    #[must_use]
    pub const fn new(config: CalibrationConfig) -> Self {
        Self {
            config,
            stage: Stage::Offsets,
            ticks: 0,
            current: Amps::ZERO,
            field: 0,
            speed: 0,
            began: 0,
            ended: 0,
            swung: 0,
            along: Fit::EMPTY,
            against: Fit::EMPTY,
            samples: 0,
            volts: Volts::ZERO,
            least: Volts::MAX,
            most: Volts::MIN,
            #[cfg(feature = "large")]
            check: None,
        }
    }

    /// Runs one control period (tick) of the calibration. Takes the unwrapped encoder count and the current loop's report.
    ///
    /// In a control period without a good encoder reading the caller does not call this function: the outputs are off, and the
    /// field stands still.
    pub fn tick(&mut self, tick: u32, count: i64, report: &CurrentReport) -> Progress {
        self.ticks = self.ticks.saturating_add(1);
        #[cfg(feature = "large")]
        if let Some(reason) = self.watch(count) {
            return failed(reason);
        }
        #[cfg(feature = "voltage")]
        if self.config.is_untold {
            return failed(Reason::MotorUntold);
        }
        self.follow(report.voltage.d);
        let done = match self.stage {
            Stage::Offsets => return self.offsets(tick, report),
            Stage::Raise => self.raise(),
            Stage::Settle => self.settle(count, report),
            Stage::Forward => self.forward(count),
            Stage::Back => self.back(count),
            #[cfg(feature = "large")]
            Stage::Rock => self.rock(count),
        };
        done.unwrap_or_else(|| self.drive(tick))
    }

    fn enter(&mut self, stage: Stage) {
        self.stage = stage;
        self.ticks = 0;
        self.speed = 0;
    }

    fn drive(&self, tick: u32) -> Progress {
        let advance = (u64::from(self.speed) * u64::from(self.config.per_period)) >> 16;
        let advance = i32::try_from(advance).unwrap_or(i32::MAX);
        Progress::Running(CurrentCommand {
            tick,
            mode: CurrentMode::Drive,
            angle: self.field_angle(),
            advance: if self.is_backward() {
                advance.saturating_neg()
            } else {
                advance
            },
            current: Dq {
                d: self.current,
                q: Amps::ZERO,
            },
        })
    }

    const fn is_backward(&self) -> bool {
        #[cfg(feature = "large")]
        if let Some(check) = &self.check {
            return check.is_backward();
        }
        matches!(self.stage, Stage::Back)
    }

    fn field_angle(&self) -> Angle {
        Angle((self.field >> 16) as u16)
    }

    fn offsets(&mut self, tick: u32, report: &CurrentReport) -> Progress {
        let config = &self.config;
        // The current loop discards old offsets in the first PWM period in which it reads the command, which is before the third
        // control period.
        if self.ticks >= 3
            && let Some(offsets) = report.offsets
            && self.may_begin()
        {
            // A board without current sensors has no offsets to check. The bridge was off for as long, and the check of a stored
            // alignment has waited until the shaft rests.
            #[cfg(feature = "voltage")]
            if !config.senses {
                self.enter(Stage::Raise);
                return self.drive(tick);
            }
            let off = |sixteenths: u16| (sixteenths >> 4).abs_diff(config.offset_code);
            let (a, b) = (off(offsets.a), off(offsets.b));
            if a.max(b) > config.offset_tolerance {
                let worst = if a >= b { offsets.a } else { offsets.b };
                return Progress::Failed(FaultCode::CurrentSensor, i32::from(worst >> 4));
            }
            if offsets.spread > config.offset_spread {
                return Progress::Failed(FaultCode::CurrentSensor, i32::from(offsets.spread));
            }
            self.enter(Stage::Raise);
            return self.drive(tick);
        }
        #[cfg(feature = "large")]
        if report.offsets.is_some() {
            // The check of a stored alignment waits for the shaft to rest. A bad encoder reading meanwhile discards the offsets, and
            // the time for new ones counts from there.
            self.ticks = self.ticks.min(3);
        }
        if self.ticks > config.settle && report.offsets.is_none() {
            return failed(Reason::OffsetsLate);
        }
        Progress::Running(CurrentCommand {
            tick,
            mode: CurrentMode::Offsets,
            ..CurrentCommand::default()
        })
    }

    #[cfg(not(feature = "large"))]
    const fn may_begin(&self) -> bool {
        true
    }

    fn raise(&mut self) -> Option<Progress> {
        self.current = self
            .current
            .saturating_add(self.config.current_step)
            .min(self.config.current);
        if self.current >= self.config.current {
            self.enter(Stage::Settle);
        }
        None
    }

    fn settle(&mut self, count: i64, report: &CurrentReport) -> Option<Progress> {
        let half = self.config.settle / 2;
        if self.ticks <= half {
            (self.began, self.ended) = (count, count);
        }
        (self.began, self.ended) = (self.began.min(count), self.ended.max(count));
        if self.ticks < self.config.settle {
            return None;
        }
        let swings = self.ended.saturating_sub(self.began) > self.config.rest;
        if swings && self.swung < SWINGS {
            self.swung = self.swung.saturating_add(1);
            self.ticks = half;
            (self.began, self.ended) = (count, count);
            return None;
        }
        // If the current follows its command, it is above three quarters of the commanded value even with ripple.
        let least = Amps::from_bits(self.config.current.to_bits() >> 2)
            .saturating_mul(Amps::const_from_int(3));
        if report.current.d < least {
            return Some(failed(Reason::NoCurrent));
        }
        #[cfg(feature = "large")]
        if self.check.is_some() {
            self.enter(Stage::Rock);
            return None;
        }
        self.enter(Stage::Forward);
        None
    }

    /// Moves the field by one control period towards the angle `target`. Returns whether the field has passed a position at which
    /// a sample is taken.
    fn turn(&mut self, forward: bool, target: i64) -> bool {
        self.speed = self
            .speed
            .saturating_add(self.config.speed_step)
            .min(self.config.speed);
        let before = self.field;
        let step = i64::from(self.speed);
        self.field = if forward {
            self.field.saturating_add(step).min(target)
        } else {
            self.field.saturating_sub(step).max(target)
        };
        const SHIFT: u32 = 32 - SAMPLES_LOG2;
        before >> SHIFT != self.field >> SHIFT
    }

    fn sample(&mut self, field: Angle, count: i64) {
        let rotor = self.config.scale.angle(count);
        self.along.add(Angle(field.0.wrapping_sub(rotor.0)));
        self.against.add(field.plus(rotor));
        self.samples = self.samples.saturating_add(1);
        self.least = self.least.min(self.volts);
        self.most = self.most.max(self.volts);
    }

    fn follow(&mut self, volts: Volts) {
        let step = volts.saturating_sub(self.volts).to_bits() >> 4;
        self.volts = self.volts.saturating_add(Volts::from_bits(step));
    }

    /// Whether the same current needed much more voltage in one direction of the field than in another.
    ///
    /// Let the sensor of phase A read `1/(1 + ε)` of its true current, and let `θ` be the direction of the field. Then the loop
    /// drives `1 + ε/2 (1 + cos 2θ + sin 2θ/√3)` of the commanded current along the field, so the voltage varies by `±0.58 ε`.
    /// The function allows a quarter of the voltage and half a volt (dead time, the rotor's swing, cogging). For the motor of the
    /// default settings this allows up to `ε = 0.3`. A warmer winding changes the voltage equally in all directions, so the
    /// resistance need not be known.
    fn is_unbalanced(&self) -> bool {
        let quarter = Volts::from_bits(self.least.max(Volts::ZERO).to_bits() >> 2);
        let half_volt = Volts::from_bits(1 << 15);
        self.most.saturating_sub(self.least) > quarter.saturating_add(half_volt)
    }

    fn forward(&mut self, count: i64) -> Option<Progress> {
        const TURN: i64 = 1 << 32;
        // The count belongs to the field of the previous control period, which has acted since.
        let (field, inside) = (self.field_angle(), self.field >= TURN);
        if !inside {
            self.began = count;
        }
        let end = self.config.turns.saturating_add(TURN);
        let passed = self.turn(true, end);
        if inside && passed {
            self.sample(field, count);
        }
        if self.field < end {
            return None;
        }
        self.ended = count;
        self.enter(Stage::Back);
        self.judge_distance()
    }

    /// Checks that the shaft moved one mechanical turn while the field turned forward; returns the failure if it did not.
    fn judge_distance(&self) -> Option<Progress> {
        let counts = i64::from(self.config.counts_per_rev);
        let moved = self.ended.saturating_sub(self.began).saturating_abs();
        if moved <= 1 {
            return Some(Progress::Failed(FaultCode::EncoderStuck, clamp_i32(moved)));
        }
        if moved < counts / 8 {
            return Some(failed(Reason::Uneven));
        }
        // If the motor had one pole pair more than the settings' p, the shaft would move a (p + 1)-th of a turn less. Half of that
        // is the limit.
        let twice = i64::from(self.config.pole_pairs)
            .saturating_add(1)
            .saturating_mul(2);
        let error = moved.saturating_sub(counts).saturating_abs();
        (error.saturating_mul(twice) >= counts).then(|| failed(Reason::PolePairs))
    }

    fn back(&mut self, count: i64) -> Option<Progress> {
        let (field, inside) = (self.field_angle(), self.field <= self.config.turns);
        let passed = self.turn(false, 0);
        if inside && passed {
            self.sample(field, count);
        }
        // `ended` follows the count until the field is back where the examined forward turn began.
        if field_turns(self.field) >= 1 {
            self.ended = count;
        }
        (self.field <= 0).then(|| self.judge())
    }

    /// Ends the calibration: checks that the shaft came back and that rotor and field agreed in all samples. Returns the alignment
    /// or the failure.
    fn judge(&self) -> Progress {
        let config = &self.config;
        let slipped = self.ended.saturating_sub(self.began).saturating_abs();
        // A quarter of an electrical turn.
        let quarter = i64::from(config.pole_pairs).saturating_mul(4);
        if slipped.saturating_mul(quarter) > i64::from(config.counts_per_rev) {
            return failed(Reason::NotBack);
        }
        if self.is_unbalanced() {
            return failed(Reason::Unbalanced);
        }
        let spread = |fit: &Fit| fit.most.saturating_sub(fit.least);
        // With the wrong direction of counting the angles differ by whole turns, so their spread is far larger.
        let against = spread(&self.against) < spread(&self.along);
        let fit = if against { &self.against } else { &self.along };
        if spread(fit) > SPREAD {
            return failed(Reason::Uneven);
        }
        Progress::Done(Alignment {
            offset: fit.mean(self.samples),
            against,
        })
    }
}

/// Number of whole electrical turns in an angle of the field, which is in 2^-32 electrical turns.
const fn field_turns(field: i64) -> i64 {
    field >> 32
}

pub(crate) fn failed(reason: Reason) -> Progress {
    Progress::Failed(FaultCode::CalibrationFailed, reason as i32)
}
