//! The mock's simulated device: its state, its mechanics, and a record of the calls.

use crate::clock::MockClock;
use crate::plan::{Planned, among};
use std::cell::Cell;
use std::collections::HashMap;
use std::fs::File;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Instant;
use touchstone_world::plant::{
    Cartesian, FIRM_TRANSLATION, HeldLinear, Kinematics, OMEGA3, OMEGA3_AXIS, State,
};

/// Time step of the device's simulation, s: one USB microframe.
const STEP_S: f64 = 125e-6;
/// Time by which a call over USB advances a test's clock, s. `LOCAL_S` is the time of a call that the library answers without USB.
const USB_S: f64 = 60e-6;
const LOCAL_S: f64 = 5e-6;

pub const COM: i32 = 2;
pub const NO_DEVICE: i32 = 5;
pub const EXPERT_DISABLED: i32 = 9;
pub const IN_USE: i32 = 20;

thread_local! {
    /// The number of the last error, one for each thread as in the real library. A successful call does not clear it.
    static LAST_ERROR: Cell<i32> = const { Cell::new(0) };
}

pub fn last_error() -> i32 {
    LAST_ERROR.get()
}

/// Stores the error number of the calling thread and returns -1, the result of a failed call.
pub fn failed(error: i32) -> i32 {
    LAST_ERROR.set(error);
    -1
}

/// What the mock has recorded for a test. Times are in seconds of the device's clock.
#[derive(Debug, Clone, Copy, Default)]
pub struct Noted {
    /// Time at which the first planned fault showed: a call failed, took long or returned wrong data.
    pub wrong_s: Option<f64>,
    /// Time since which the motors give no force; `None` while they give one.
    pub zero_s: Option<f64>,
    /// Time at which the program first tried to close the device.
    pub released_s: Option<f64>,
    /// Number of forces that the program commanded after it had closed the device.
    pub late_forces: u64,
    pub longest_n: f64,
}

pub struct Machine {
    pub clock: MockClock,
    plant: Option<Cartesian<HeldLinear>>,
    state: [State<4>; 3],
    stepped_s: f64,
    pub plans: Vec<Planned>,
    calls: HashMap<&'static str, u64>,
    /// The position that the last position call returned, m.
    pub read_m: [f64; 3],
    pub open: bool,
    pub gone: bool,
    pub expert: bool,
    pub motors_on: bool,
    pub brake: bool,
    pub off_cause: i32,
    pub force_n: [f64; 3],
    pub max_force_n: f64,
    lock: Option<File>,
    pub noted: Noted,
}

/// Number of a call that begins, and its planned error.
pub struct Entered {
    pub number: u64,
    /// The error number with which the call fails; `None` if it succeeds.
    pub error: Option<i32>,
}

static MACHINE: OnceLock<Mutex<Machine>> = OnceLock::new();

/// Locks the mock's only device and returns it.
pub fn machine() -> MutexGuard<'static, Machine> {
    MACHINE
        .get_or_init(|| Mutex::new(Machine::new()))
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
}

/// Rest point of the simulated hand's spring at `time_s`, m. It moves from above the centre down until the spring gives 5 N, then
/// up, down and sideways.
fn rest_m(time_s: f64) -> [f64; 3] {
    let down = (time_s / 0.3).min(1.0);
    let swing = 0.004 * (6.0 * time_s).sin();
    let around = 0.01 * (2.0 * time_s).sin();
    [around, 0.5 * around, 0.003 - 0.02 * down + swing * down]
}

impl Machine {
    fn new() -> Self {
        let mut machine = Self {
            clock: MockClock::Real(Instant::now()),
            plant: Cartesian::held(&OMEGA3_AXIS, &FIRM_TRANSLATION, STEP_S).ok(),
            state: Cartesian::<HeldLinear>::at_rest(rest_m(0.0)),
            stepped_s: 0.0,
            plans: Vec::new(),
            calls: HashMap::new(),
            read_m: rest_m(0.0),
            open: false,
            gone: false,
            expert: false,
            motors_on: false,
            brake: false,
            off_cause: 0,
            force_n: [0.0; 3],
            max_force_n: -1.0,
            lock: None,
            noted: Noted::default(),
        };
        // A test that starts a program gives it the fault plan by this variable.
        for line in std::env::var("TOUCHSTONE_MOCK_DHD")
            .unwrap_or_default()
            .split(';')
        {
            machine.plan(line);
        }
        machine
    }

    /// Adds a line to the fault plan; returns false if the line is not understood.
    pub fn plan(&mut self, line: &str) -> bool {
        match crate::plan::parse(line) {
            Some(Planned::OwnClock) => self.clock = MockClock::Own(self.clock.now_s()),
            Some(planned) => self.plans.push(planned),
            None => return false,
        }
        true
    }

    pub fn has(&self, planned: &Planned) -> bool {
        self.plans.contains(planned)
    }

    /// Records the present time as that of the first fault, unless one was recorded before.
    pub fn wrong(&mut self) {
        self.noted.wrong_s.get_or_insert(self.clock.now_s());
    }

    /// Begins a library call: counts it, lets its duration pass and returns the fault that is planned for it.
    pub fn enter(&mut self, call: &'static str) -> Entered {
        let count = self.calls.entry(call).or_default();
        let number = *count;
        *count += 1;
        let local = call.starts_with("dhdErrorGet") || call.contains("Count");
        self.clock.pass(if local { LOCAL_S } else { USB_S }, false);
        let mut error = None;
        for planned in self.plans.clone() {
            match planned {
                Planned::Fail(name, at, times, number_of)
                    if name == call && among(number, at, times) =>
                {
                    error = Some(number_of);
                }
                Planned::Unplug(name, at) if name == call && number == at => {
                    self.gone = true;
                    // The device loses its supply by USB, so no force acts.
                    self.motors_off(5);
                }
                Planned::Slow(name, at, seconds) if name == call && number == at => {
                    self.clock.pass(seconds, true);
                    self.wrong();
                }
                _ => {}
            }
        }
        self.advance();
        if self.gone && !local {
            error = Some(COM);
        }
        if error.is_some() {
            self.wrong();
        }
        Entered { number, error }
    }

    /// Number of times that the library function with this name was called.
    pub fn count(&self, call: &str) -> u64 {
        self.calls.get(call).copied().unwrap_or(0)
    }

    /// Force that the motors give, N; zero while the motors are off or braked.
    pub fn acting_n(&self) -> [f64; 3] {
        match self.motors_on && !self.brake {
            true => self.force_n,
            false => [0.0; 3],
        }
    }

    fn advance(&mut self) {
        let (now, acting) = (self.clock.now_s(), self.acting_n());
        let Some(plant) = &self.plant else { return };
        while self.stepped_s + STEP_S <= now {
            plant.step(&mut self.state, acting, rest_m(self.stepped_s));
            self.stepped_s += STEP_S;
        }
    }

    /// Position of the effector, rounded to the encoders' resolution, m.
    pub fn place_m(&self) -> [f64; 3] {
        let counts = OMEGA3.counts(self.state.map(|axis| axis.position()));
        counts.map(|n| f64::from(n) * OMEGA3.count_m)
    }

    /// Commands a force in N, which acts until the next command.
    pub fn force(&mut self, force_n: [f64; 3]) {
        self.force_n = force_n;
        self.note_zero();
    }

    /// Switches the motors off. `cause` is the library's number for the cause: the device itself or a program.
    pub fn motors_off(&mut self, cause: i32) {
        self.motors_on = false;
        self.off_cause = cause;
        self.note_zero();
    }

    /// Updates the records after a change of the force: since when no force acts, and the largest force.
    pub fn note_zero(&mut self) {
        let acting = self.acting_n();
        let length = acting.iter().map(|f| f * f).sum::<f64>().sqrt();
        self.noted.longest_n = self.noted.longest_n.max(length);
        if length == 0.0 {
            self.noted.zero_s.get_or_insert(self.clock.now_s());
        } else {
            self.noted.zero_s = None;
        }
    }

    /// Opens the device for this program; returns false if another program has it open. With the environment variable
    /// `TOUCHSTONE_MOCK_LOCK`, programs on one computer share a device by a lock file of that path.
    pub fn take(&mut self) -> bool {
        if self.has(&Planned::Held) {
            return false;
        }
        if let Some(path) = std::env::var_os("TOUCHSTONE_MOCK_LOCK") {
            let Ok(file) = File::create(path) else {
                return false;
            };
            if file.try_lock().is_err() {
                return false;
            }
            self.lock = Some(file);
        }
        self.open = true;
        // Drops what was recorded for another program.
        self.noted = Noted::default();
        self.note_zero();
        true
    }

    /// Records that the program closed the device (`closed`), or failed to close it. With the environment variable
    /// `TOUCHSTONE_MOCK_LOG`, writes the outcome to the file of that path.
    pub fn give_back(&mut self, closed: bool) {
        self.noted.released_s.get_or_insert(self.clock.now_s());
        if closed {
            self.open = false;
            self.lock = None;
            self.motors_off(0);
            self.force_n = [0.0; 3];
        }
        if let Some(path) = std::env::var_os("TOUCHSTONE_MOCK_LOG") {
            let acting = self.acting_n().iter().map(|f| f.abs()).sum::<f64>();
            let text = format!(
                "closed {closed} force {acting} longest {:.2}\n",
                self.noted.longest_n
            );
            // An error needs no report: the test that reads the log fails without it.
            let _ = std::fs::write(path, text);
        }
    }
}
