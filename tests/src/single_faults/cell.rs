//! Simulates one cell of the table: a fault on a board, with a moment, a grip and a quarter of an electrical turn.

use super::act::act;
use super::bench::{
    ARMS_AFTER_S, BEFORE_S, Bench, Grip, LEAVES_S, LONG_STAYS_S, Moment, Played, STAYS_S,
};
use super::broken::Memory;
use super::list::Fault;
use super::tamper::Breaks;
use touchstone_protocol::{Board, Command, FaultCode, State};
use touchstone_world::motor::Drive;

/// Number of ticks that a run goes on after the board found the fault. In this time the motor's current ends.
const TAIL: u32 = 20;

/// The result of a run with a fault.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Most energy that the motor gave to hand and knob, beyond what it took, in any time window, J. The window ends after the
    /// fault, and at most 20 ticks after the device is off.
    pub most_j: f64,
    /// Time from the fault until the device is off for good, s; `None` if the board found no fault.
    pub off_s: Option<f64>,
    /// Largest speed of the shaft from the fault until 20 ticks after the switch-off, or until the run's end, rad/s.
    pub fastest_rad_per_s: f64,
    /// The fault that the board found.
    pub code: Option<FaultCode>,
    /// Hash of shaft angle, bridge state and encoder readings at every tick. It is equal only for runs with the same course.
    pub course: u64,
}

/// A row of the table: a run with its result.
#[derive(Clone, Copy)]
pub struct Row<'b> {
    /// Board, moment, grip and quarter of an electrical turn.
    pub bench: &'b Bench,
    /// The fault.
    pub fault: &'static Fault,
    /// Result of the run.
    pub cell: Cell,
    /// Whether the run differs from that of a healthy board.
    pub differs: bool,
}

impl Row<'_> {
    /// Name of the row: fault, moment, grip, quarter.
    #[must_use]
    pub fn name(&self) -> String {
        let Bench {
            moment,
            grip,
            quarter,
            ..
        } = self.bench;
        format!(
            "{}, {}, {}, {quarter}",
            self.fault.name,
            moment.name(),
            grip.name()
        )
    }

    /// Moment, grip and quarter.
    #[must_use]
    pub const fn place(&self) -> (Moment, Grip, u8) {
        (self.bench.moment, self.bench.grip, self.bench.quarter)
    }

    /// Whether the board found no fault although the hand got more than the guard's bound.
    #[must_use]
    pub fn is_unfound(&self) -> bool {
        self.cell.off_s.is_none() && self.cell.most_j > self.bench.promise_j()
    }
}

/// Simulates a fault on a board, and compares the run with that of the healthy board.
#[must_use]
pub fn run<'b>(bench: &'b Bench, fault: &'static Fault) -> Row<'b> {
    let cell = play(bench, fault.breaks, STAYS_S);
    let restarts = matches!(fault.breaks, Breaks::Memory(_));
    let differs = cell.course != bench.healthy[usize::from(restarts)];
    Row {
        bench,
        fault,
        cell,
        differs,
    }
}

impl<'b> Row<'b> {
    /// The same row with a hand that stays in the wall for half a minute.
    #[must_use]
    pub fn goes_on(&self) -> Self {
        let cell = play(self.bench, self.fault.breaks, LONG_STAYS_S);
        Self { cell, ..*self }
    }
}

impl Bench {
    /// A calibrated board in a hand that has moved for `BEFORE_S`. The board is armed, except for [`Moment::Ready`].
    ///
    /// # Panics
    /// The healthy board does not reach this state.
    #[must_use]
    pub fn new(board: Board, moment: Moment, grip: Grip, quarter: u8) -> Self {
        let mut bench = Self::begun(board, moment, grip, quarter);
        bench.healthy = [Breaks::Nothing, Breaks::Memory(Memory::Right)]
            .map(|breaks| play(&bench, breaks, STAYS_S).course);
        bench
    }
}

fn play(bench: &Bench, breaks: Breaks, stays_s: f64) -> Cell {
    let mut knob = bench.knob.clone();
    knob.tamper.breaks = breaks;
    let mut course = Course::new(bench, &knob);
    if let Breaks::Memory(memory) = breaks {
        memory.restart(bench, &mut knob);
        course = Course::new(bench, &knob);
        // The energy that a calibration gives is left out, because the guard does not bound it.
        course.least_j = knob.rig.given_j;
        course.zero_rad = knob.rig.now().angle_rad;
        if bench.moment != Moment::Ready {
            knob.ask(Command::Arm);
        }
        course.began_s = 0.05;
    }
    knob.tamper.is_broken = true;
    let mut tail = 0;
    for tick in 0..((stays_s + LEAVES_S) * 1e3) as u32 {
        let since_s = f64::from(tick) * 1e-3;
        if bench.moment == Moment::Ready && tick == (ARMS_AFTER_S * 1e3) as u32 {
            knob.ask(Command::Arm);
        }
        knob.rest_rad = bench.rest_rad(since_s, course.began_s, course.zero_rad, stays_s);
        act(bench, breaks, &mut knob, tick);
        course.tick(&mut knob);
        if course.off(&knob) {
            course.found(&knob, since_s);
            tail += 1;
            if tail > TAIL {
                break;
            }
        }
    }
    course.cell
}

/// What is recorded of a simulated knob.
struct Course {
    cell: Cell,
    least_j: f64,
    zero_rad: f64,
    began_s: f64,
}

impl Course {
    fn new(bench: &Bench, knob: &Played) -> Self {
        Self {
            cell: Cell {
                most_j: 0.0,
                off_s: None,
                fastest_rad_per_s: 0.0,
                code: None,
                course: 0xcbf2_9ce4_8422_2325,
            },
            least_j: bench.least_j.min(knob.rig.given_j),
            zero_rad: bench.zero_rad,
            began_s: -BEFORE_S,
        }
    }

    /// Runs the PWM periods of one control tick. A tick in which the firmware's control code does not run counts, too.
    fn tick(&mut self, knob: &mut Played) {
        let mut is_due = false;
        while !is_due {
            is_due = knob.period();
            let now = knob.rig.now();
            let cell = &mut self.cell;
            self.least_j = self.least_j.min(knob.rig.given_j);
            cell.most_j = cell.most_j.max(knob.rig.given_j - self.least_j);
            cell.fastest_rad_per_s = cell.fastest_rad_per_s.max(now.speed_rad_per_s.abs());
        }
        let on = u64::from(knob.acting != Drive::Off);
        let angle = knob.rig.now().angle_rad.to_bits();
        let record = &knob.record;
        let read = record.count.cast_unsigned();
        let second = u64::from(record.since_change.0.to_bits().cast_unsigned());
        // FNV-1a.
        for word in [angle, on, read, second] {
            self.cell.course = (self.cell.course ^ word).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// Whether the device is off for good. If the control tick hangs, the device stays armed, but its current loop switches off.
    fn off(&self, knob: &Played) -> bool {
        matches!(knob.device.state(), State::Fault(_))
            || knob
                .report
                .trip
                .is_some_and(|_| knob.acting == Drive::Off && knob.device.state() == State::Armed)
    }

    fn found(&mut self, knob: &Played, since_s: f64) {
        self.cell.off_s.get_or_insert(since_s);
        let tripped = knob.report.trip.map(|trip| trip.code);
        self.cell.code = self.cell.code.or(knob.fault()).or(tripped);
    }
}
