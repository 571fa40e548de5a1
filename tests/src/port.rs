//! Simulates the mechanical port between device and hand, and sums the energy exactly: a hand, a control law, the energy guard,
//! an encoder and a delay.
//!
//! Each control period has two parts, before and after the force changes. In each part the position is linear in time, or follows
//! from the masses of a simulated hand. The energy is summed in `f64` from the true motion, not from the measured one.

pub mod felt;

use crate::board_loop::{BoardLoop, Stretch};
use touchstone_control::environment::ProfileSettings;
use touchstone_control::{
    ChangeOfForce, Controller, Fixed32, Force, Guard, GuardSettings, Guarded, GuardedDevice,
    Position, Reported, Settings, Si, Warning,
};

/// Control period, s.
pub const TICK_S: f64 = 1e-3;
/// Damping of the simulated knob in the DLR thesis.
pub const DAMPING_N_M_S_PER_RAD: f64 = 4e-4;
/// Inertia of the simulated knob in the DLR thesis.
pub const INERTIA_KG_M2: f64 = 1e-4;
/// One encoder count, rad, at 40,000 counts per turn.
pub const COUNT_RAD: f64 = std::f64::consts::TAU / 40_000.0;

/// A control law without an estimator: a spring, and virtual damping on differences of the measured position.
#[derive(Debug, Clone, Copy)]
pub struct SpringDamper {
    /// Stiffness of the spring, N·m/rad.
    pub k: f64,
    /// Virtual damping, N·m·s/rad.
    pub b: f64,
}

/// The control law that requests the force.
#[derive(Debug, Clone, Copy)]
pub enum PortLaw {
    /// A spring and damper in `f64`. They can request forces from the energy guard that no shipped control law would request.
    SpringDamper(SpringDamper),
    /// A control law of the control crate with its state estimator, at 1 kHz. Guard and force limit in these settings are not used,
    /// because [`Port`] has its own.
    Controlled(Settings),
    /// A torque profile in the environment of the control crate, with the environment's own guard. See [`felt`].
    Felt(ProfileSettings),
}

impl From<SpringDamper> for PortLaw {
    fn from(law: SpringDamper) -> Self {
        Self::SpringDamper(law)
    }
}

impl From<Settings> for PortLaw {
    fn from(settings: Settings) -> Self {
        Self::Controlled(settings)
    }
}

impl From<ProfileSettings> for PortLaw {
    fn from(profile: ProfileSettings) -> Self {
        Self::Felt(profile)
    }
}

/// A control law that runs, with its state.
enum Working {
    SpringDamper(SpringDamper, Position<Fixed32>),
    Controlled(Box<Controller<Fixed32>>),
}

impl Working {
    fn of(law: &PortLaw, start: Position<Fixed32>, force_limit_n_m: f64) -> Self {
        match law {
            PortLaw::SpringDamper(law) => Self::SpringDamper(*law, start),
            PortLaw::Controlled(settings) => {
                let mut settings = *settings;
                settings.guard.on = false;
                settings.force_limit = si(force_limit_n_m);
                Self::Controlled(Box::new(Controller::new(&settings).unwrap()))
            }
            PortLaw::Felt(_) => unreachable!("a feel is played by its own loop"),
        }
    }

    fn wanted(&mut self, now: Position<Fixed32>, limit_n_m: f64) -> Force<Fixed32> {
        match self {
            Self::SpringDamper(law, before) => {
                let e = now.to_f64();
                let step = e - before.to_f64();
                *before = now;
                let pull = law.k * e + law.b * step / TICK_S;
                if e > 0.0 {
                    Force::from_f64(pull.clamp(0.0, limit_n_m))
                } else {
                    Force::zero()
                }
            }
            Self::Controlled(controller) => controller.tick(now),
        }
    }

    fn commanded(&mut self, force: Force<Fixed32>) {
        if let Self::Controlled(controller) = self {
            controller.commanded(force);
        }
    }
}

/// A simulated hand that moves the device.
pub trait Hand {
    /// Penetration of the device in the first control period, rad.
    fn start(&self) -> f64;
    /// Moves the device for a part of a control period against a force. `late` says whether the force has already changed in this
    /// period. Returns the position in rad, and the energy in J that the device's damping dissipated.
    fn go(&mut self, tick: u32, late: bool, force_n_m: f64, seconds: f64) -> (f64, f64);
}

/// The simulated port: device, control law and energy guard, which a hand moves.
#[derive(Debug, Clone)]
pub struct Port {
    /// Delay from the encoder's sample to the force in control periods, 0 to 1. Not used with a board's current loop.
    pub delay_ticks: f64,
    /// Whether the board in `board` reads its encoder a second time when the force changes.
    pub reads: bool,
    /// A board's current loop, which changes the force gradually; `None` if the force changes at once.
    pub board: Option<BoardLoop>,
    /// Whether positions are measured in whole encoder counts.
    pub counts: bool,
    /// One encoder count, rad.
    pub count_rad: f64,
    /// Whether the energy guard is configured with the size of an encoder count (else with 0).
    pub told: bool,
    /// The control law that requests the force.
    pub law: PortLaw,
    /// Settings of the energy guard; `None` for no guard.
    pub guard: Option<GuardSettings>,
    /// Force limit of the control law, N·m.
    pub force_limit_n_m: f64,
}

/// Result of simulating a hand at the port.
#[derive(Debug, Clone, Copy, Default)]
pub struct Outcome {
    /// Most energy that the hand got out in any window of time, J.
    pub worst_window_j: f64,
    /// Most energy in J that the hand got out in any time window, minus the energy that refilled the energy guard's account in that
    /// window.
    pub above_refill_j: f64,
    /// As `above_refill_j`, in J, but including the control period in which the device exceeded the energy guard's speed limit, if
    /// the run ended so. The other energies exclude that period, as the guard's bound does.
    pub with_overspeed_j: f64,
    /// Lowest level of the energy guard's account, J.
    pub lowest_account_j: f64,
    /// Level of the energy guard's account at the end, J.
    pub last_account_j: f64,
    /// Number of control periods in which the energy guard changed the requested force.
    pub changed_ticks: u32,
    /// Number of control periods that were simulated: fewer than requested if an over-speed ended the run.
    pub ticks: u32,
    /// Sum of the magnitudes of all changes of the commanded force, N·m.
    pub changes_n_m: f64,
}

fn si(value: f64) -> Si {
    Si::from_num(value)
}

impl Port {
    /// The energy guard's usual settings in these tests: an account of at most 20 mJ that is refilled by 0.5 mW, 80 % of the
    /// device's damping, and a delay in control periods.
    #[must_use]
    pub fn settings(delay_ticks: f64) -> GuardSettings {
        GuardSettings {
            capacity: si(0.02),
            delay: si(delay_ticks * TICK_S),
            ..GuardSettings::default()
        }
    }

    /// A port with this control law, and the energy guard of [`Self::settings`] if `guarded` is true. `counts` says whether
    /// positions are measured in encoder counts.
    #[must_use]
    pub fn new(law: impl Into<PortLaw>, delay_ticks: f64, counts: bool, guarded: bool) -> Self {
        Self {
            delay_ticks,
            board: None,
            reads: true,
            counts,
            count_rad: COUNT_RAD,
            told: counts,
            law: law.into(),
            guard: guarded.then(|| Self::settings(delay_ticks)),
            force_limit_n_m: 0.3,
        }
    }

    /// The properties of the device with which the energy guard is configured.
    #[must_use]
    pub fn device(&self) -> GuardedDevice {
        GuardedDevice {
            rate_hz: 1000,
            force_limit: si(self.force_limit_n_m),
            count: if self.told {
                si(self.count_rad)
            } else {
                Si::ZERO
            },
        }
    }

    /// Warnings that the energy guard's settings cause.
    #[must_use]
    pub fn warnings(&self) -> [Option<Warning>; 2] {
        self.guard
            .map_or([None; 2], |guard| guard.warnings(&self.device()))
    }

    /// Simulates a hand for this many control periods.
    ///
    /// # Panics
    /// Guard or control law refuse their settings.
    pub fn play(&self, hand: &mut impl Hand, ticks: u32) -> Outcome {
        if let PortLaw::Felt(profile) = &self.law {
            return felt::play(self, profile, hand, ticks);
        }
        let signal = |x: f64| <Fixed32 as Reported>::signal_from_f64(x);
        let mut guard = self
            .guard
            .map(|settings| Guarded::new(Guard::new(&settings, &self.device()).unwrap()));
        let measured = self
            .guard
            .is_some_and(|settings| settings.change == ChangeOfForce::Measured);
        let refill_w = self.guard.map_or(0.0, |settings| settings.refill.to_num());
        let joules =
            |guard: &Option<Guarded<Fixed32>>| guard.map_or(0.0, |it| it.account().to_f64());
        let sample = |x: f64| {
            let x = if self.counts {
                (x / self.count_rad).round() * self.count_rad
            } else {
                x
            };
            Position::<Fixed32>(signal(x))
        };

        let early_s = self.delay_ticks * TICK_S;
        let late_s = TICK_S - early_s;
        let mut x = hand.start();
        let mut told = sample(x);
        let mut at_change = told;
        let mut acting = 0.0;
        let mut board = self.board;
        let mut stretches: Vec<Stretch> = Vec::new();
        let mut law = Working::of(&self.law, told, self.force_limit_n_m);
        let (mut out, mut lowest, mut lowest_above) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut outcome = Outcome {
            lowest_account_j: joules(&guard),
            ..Outcome::default()
        };
        // The two largest energies at the beginning of the last tick that was run.
        let mut settled = (0.0, 0.0);
        for tick in 0..ticks {
            let now = sample(x);
            if let Some(board) = &board {
                // `at_change` holds the second reading. It is replaced by the position that the board calculates from both
                // readings.
                let since = board.change.since_change(at_change - told, now - at_change);
                at_change = if self.reads { now - since } else { told };
            }
            let ways = [
                now - told,
                if measured {
                    at_change - told
                } else {
                    Position::zero()
                },
            ];
            told = now;
            let wanted = law.wanted(now, self.force_limit_n_m);
            let force = match &mut guard {
                None => wanted,
                Some(guard) => {
                    let force = guard.tick(now, measured.then_some(at_change), wanted);
                    // The guard's bound does not cover the energy of an over-speed, so only `with_overspeed_j` includes it.
                    if ways.iter().any(|way| way.modulus() > guard.guard.furthest) {
                        outcome.with_overspeed_j = outcome.above_refill_j;
                        (outcome.worst_window_j, outcome.above_refill_j) = settled;
                        break;
                    }
                    outcome.changed_ticks += u32::from(guard.limited);
                    outcome.lowest_account_j =
                        outcome.lowest_account_j.min(guard.account().to_f64());
                    force
                }
            };
            law.commanded(force);
            settled = (outcome.worst_window_j, outcome.above_refill_j);
            let refilled = refill_w * TICK_S * f64::from(tick);
            lowest = lowest.min(out);
            lowest_above = lowest_above.min(out - refilled);
            let new = Fixed32::signal_to_f64(force.0);
            outcome.changes_n_m += (new - acting).abs();
            match &mut board {
                Some(board) => board.tick(new, &mut stretches),
                None => {
                    stretches.clear();
                    stretches.extend([(false, acting, early_s), (true, new, late_s)]);
                }
            }
            let mut gone_s = 0.0;
            for &(late, force, seconds) in &stretches {
                if seconds > 0.0 {
                    let (to, damped) = hand.go(tick, late, force, seconds);
                    out -= force * (to - x) + damped;
                    x = to;
                }
                if !late {
                    at_change = sample(x);
                }
                gone_s += seconds;
                let refilled = refilled + refill_w * gone_s;
                outcome.worst_window_j = outcome.worst_window_j.max(out - lowest);
                outcome.above_refill_j = outcome.above_refill_j.max(out - refilled - lowest_above);
            }
            acting = new;
            outcome.ticks += 1;
        }
        outcome.last_account_j = joules(&guard);
        outcome
    }
}

/// A hand whose position is a given function of time, whatever the force. The device's damping dissipates as in a motion at
/// constant speed between the function's values.
#[derive(Debug, Clone)]
pub struct Imposed<F> {
    path: F,
    at: f64,
    time_s: f64,
}

impl<F: Fn(f64) -> f64> Imposed<F> {
    /// Creates a hand with the position `path(t)` in rad, from time 0 on.
    pub fn new(path: F) -> Self {
        let at = path(0.0);
        Self {
            path,
            at,
            time_s: 0.0,
        }
    }
}

impl<F: Fn(f64) -> f64> Hand for Imposed<F> {
    fn start(&self) -> f64 {
        self.at
    }
    fn go(&mut self, _: u32, _: bool, _: f64, seconds: f64) -> (f64, f64) {
        self.time_s += seconds;
        let to = (self.path)(self.time_s);
        let moved = to - self.at;
        self.at = to;
        (to, DAMPING_N_M_S_PER_RAD * moved * moved / seconds)
    }
}

/// A hand with mass, simulated in fine steps: it holds the knob by a spring and a damper, and pushes.
#[derive(Debug, Clone)]
pub struct Gripped<F> {
    /// Torque in N·m with which the hand pushes, as a function of time in s.
    pub push: F,
    /// The hand's inertia, kg·m².
    pub inertia: f64,
    /// Stiffness of the grip, N·m/rad.
    pub stiffness: f64,
    /// Damping of the grip, N·m·s/rad.
    pub grip_damping: f64,
    /// Position and speed of the knob, in rad and rad/s.
    pub knob: (f64, f64),
    /// Position and speed of the hand, in rad and rad/s.
    pub hand: (f64, f64),
    /// Time since the start of the simulation, s.
    pub time_s: f64,
}

impl<F: Fn(f64) -> f64> Gripped<F> {
    /// A hand with a medium grip that starts at the wall's surface and pushes.
    pub fn medium(push: F) -> Self {
        Self {
            push,
            inertia: 2e-4,
            stiffness: 20.0,
            grip_damping: 0.03,
            knob: (0.0, 0.0),
            hand: (0.0, 0.0),
            time_s: 0.0,
        }
    }
}

/// Torque of a hand that pushes with 0.1 N·m plus a sine of 0.03 N·m at `hz`, after a rise over 0.3 s. With 0 Hz the push is
/// constant.
pub fn wiggle(hz: f64) -> impl Fn(f64) -> f64 {
    move |t| (t / 0.3).min(1.0) * (0.1 + 0.03 * (std::f64::consts::TAU * hz * t).sin())
}

impl<F: Fn(f64) -> f64> Hand for Gripped<F> {
    fn start(&self) -> f64 {
        self.knob.0
    }
    fn go(&mut self, _: u32, _: bool, force: f64, seconds: f64) -> (f64, f64) {
        let steps = (seconds / 2e-5).ceil().max(1.0);
        let h = seconds / steps;
        let mut damped = 0.0;
        for _ in 0..steps as u32 {
            let grip = self.stiffness * (self.hand.0 - self.knob.0)
                + self.grip_damping * (self.hand.1 - self.knob.1);
            let drag = DAMPING_N_M_S_PER_RAD * self.knob.1;
            self.knob.1 += h * (grip - force - drag) / INERTIA_KG_M2;
            self.hand.1 += h * ((self.push)(self.time_s) - grip) / self.inertia;
            // The new speeds move the positions, so that the motion is linear within a step; the energies are those of this motion.
            self.knob.0 += h * self.knob.1;
            self.hand.0 += h * self.hand.1;
            damped += DAMPING_N_M_S_PER_RAD * self.knob.1 * self.knob.1 * h;
            self.time_s += h;
        }
        (self.knob.0, damped)
    }
}
