//! A test bench: an emulated device, the computer's end of its serial port, and the actions of a person at the knob.

use touchstone_control::Si;
use touchstone_protocol::settings::DeviceSettings;
use touchstone_protocol::{DeviceCommand, Fault, Phase, Refusal, Reply, Request, Status};
use touchstone_world::plant::Hand;

use crate::board::{Board, Encoder};
use crate::chip::{Chip, ResetCause};
use crate::cpu::elf::Program;
use crate::link::Link;
use crate::machine::{Halt, Machine};
use crate::world::{Parts, World};

/// Processor cycles per microsecond at 170 MHz.
pub const US: u64 = 170;
/// Processor cycles per millisecond at 170 MHz.
pub const MS: u64 = 1_000 * US;
/// Largest speed at which the simulated hand turns the knob to an angle, rad/s. [`TURN_S`] is the shortest time that it takes, s.
const TURN_RAD_PER_S: f64 = 3.0;
const TURN_S: f64 = 1.0;

/// Properties of the emulated device on the bench.
#[derive(Debug, Clone)]
pub struct Setup {
    /// The board, with its encoder.
    pub board: Board,
    /// Frequency of the oscillator that clocks the independent watchdog, Hz.
    pub lsi_hz: u64,
    /// Properties of the motor and the knob.
    pub parts: Parts,
}

impl Default for Setup {
    fn default() -> Self {
        Self::on(Board::nucleo_g474re(Encoder::As5047p))
    }
}

impl Setup {
    /// The set-up of a board with the motor and knob that are usually mounted on it.
    #[must_use]
    pub fn on(board: Board) -> Self {
        Self {
            parts: board.parts,
            lsi_hz: 32_000,
            board,
        }
    }
}

/// An emulated device, the simulated world around it, and the computer's end of its serial port.
pub struct Bench {
    /// The emulated chip with the simulated motor, knob and hand, into which faults can be injected.
    pub machine: Machine,
    /// The computer's end of the serial link.
    pub link: Link,
    /// Reason why the machine has halted; `None` while it runs.
    pub halted: Option<Halt>,
}

impl Bench {
    /// Builds the emulated device and switches its power on.
    ///
    /// # Errors
    /// The emulator refuses the program.
    pub fn new(program: &Program, setup: &Setup) -> Result<Self, String> {
        let mut world = World::new(&setup.parts, 0.3);
        world.bridge.bus_v = setup.board.supply_v;
        world.bridge.dead_share = setup.board.dead_share;
        world.break_a = setup.board.break_a;
        let chip = Chip::new(setup.board.clone(), world, setup.lsi_hz);
        let mut machine = Machine::new(chip, program)?;
        machine.power_on(ResetCause::PowerOn);
        Ok(Self {
            machine,
            link: Link::default(),
            halted: None,
        })
    }

    /// Time since power-on, in processor cycles.
    #[must_use]
    pub fn now(&self) -> u64 {
        self.machine.chip().core.now
    }

    /// Runs the machine for a number of cycles, and receives what the device sends.
    ///
    /// # Errors
    /// The machine halted.
    pub fn run(&mut self, cycles: u64) -> Result<(), String> {
        let until = self.now() + cycles;
        let ran = self.machine.run_until(until);
        let sent = std::mem::take(&mut self.machine.chip_mut().link().sent);
        self.link.receive(&sent);
        ran.map_err(|halt| {
            let text = format!("halted: {halt:?}");
            self.halted = Some(halt);
            text
        })
    }

    /// Runs the machine until a condition holds. The condition is examined every 100 µs.
    ///
    /// # Errors
    /// The condition did not occur within the time, or the machine halted.
    pub fn run_until(
        &mut self,
        what: &str,
        within: u64,
        mut is_so: impl FnMut(&mut Self) -> bool,
    ) -> Result<(), String> {
        let end = self.now() + within;
        while self.now() < end {
            if is_so(self) {
                return Ok(());
            }
            self.run(100 * US)?;
        }
        match is_so(self) {
            true => Ok(()),
            false => Err(format!("{what}: not within {} ms", within / MS)),
        }
    }

    /// Sends bytes to the device's serial port.
    pub fn send(&mut self, bytes: &[u8]) {
        let now = self.now();
        self.machine.chip_mut().link().put(bytes, now);
    }

    /// Sends a request to the device and waits for the answer: a reply or a refusal.
    ///
    /// # Errors
    /// No answer within a second, or the machine halted.
    pub fn ask(&mut self, request: Request<'_>) -> Result<Result<Reply, Refusal>, String> {
        let what = format!("an answer to {request:?}");
        let (id, frame) = self.link.ask(request);
        self.send(&frame);
        let mut answer = None;
        self.run_until(&what, 1_000 * MS, |bench| {
            answer = bench.link.answer(id);
            answer.is_some()
        })?;
        answer.ok_or(what)
    }

    /// Sends a request and returns the reply.
    ///
    /// # Errors
    /// The request was refused or not answered.
    pub fn demand(&mut self, request: Request<'_>) -> Result<Reply, String> {
        let what = format!("{request:?}");
        self.ask(request)?
            .map_err(|refusal| format!("{what}: refused, {refusal:?}"))
    }

    /// Sends a command; returns whether the device accepted it.
    ///
    /// # Errors
    /// No answer.
    pub fn command(&mut self, command: DeviceCommand) -> Result<bool, String> {
        Ok(self.ask(Request::Command(command))?.is_ok())
    }

    /// Requests the state of the device.
    ///
    /// # Errors
    /// No answer.
    pub fn status(&mut self) -> Result<Status, String> {
        match self.demand(Request::Status)? {
            Reply::Status(status) => Ok(status),
            other => Err(format!("not a status: {other:?}")),
        }
    }

    /// Requests the fault that the device has latched; `None` if it has none.
    ///
    /// # Errors
    /// No answer.
    pub fn fault(&mut self) -> Result<Option<Fault>, String> {
        Ok(self.status()?.fault)
    }

    /// Requests the device's state every 5 ms, for up to `within` processor cycles, until the device is in `phase`.
    ///
    /// # Errors
    /// The device did not reach the phase within the time.
    pub fn wait_for(&mut self, phase: Phase, within: u64) -> Result<(), String> {
        let end = self.now() + within;
        loop {
            let status = self.status()?;
            if status.phase == phase {
                return Ok(());
            }
            if self.now() > end {
                return Err(format!(
                    "{} ms for {}, but {} with {:?}",
                    within / MS,
                    phase.name(),
                    status.phase.name(),
                    status.fault
                ));
            }
            self.run(5 * MS)?;
        }
    }

    /// Waits after power-on until the device answers a request.
    ///
    /// # Errors
    /// The device refuses the request, does not answer within a second, or halts.
    pub fn boot(&mut self) -> Result<Reply, String> {
        self.run(20 * MS)?;
        // The zero byte ends a frame that noise may have begun while the port was not yet set up.
        self.send(&[0]);
        self.demand(Request::Hello)
    }

    /// Changes the settings of the device. Unless `change` sets it, the device's limit on the computer's silence is off, because
    /// the bench may send nothing for seconds.
    ///
    /// # Errors
    /// The device refuses the settings.
    pub fn configure(&mut self, change: impl FnOnce(&mut DeviceSettings)) -> Result<(), String> {
        let mut settings = self.settings()?;
        if let Some(motor) = self.machine.chip().board.told {
            motor.tell(&mut settings);
        }
        settings.limits.host_silence_s = Si::ZERO;
        change(&mut settings);
        self.demand(Request::SetAll(settings)).map(|_| ())
    }

    /// Requests the settings of the device.
    ///
    /// # Errors
    /// No answer.
    pub fn settings(&mut self) -> Result<DeviceSettings, String> {
        match self.demand(Request::GetAll)? {
            Reply::Settings(settings) => Ok(settings),
            other => Err(format!("not the settings: {other:?}")),
        }
    }

    /// Calibrates the device, which must be in the phase `Boot` or `Stopped`.
    ///
    /// # Errors
    /// The calibration fails.
    pub fn calibrate(&mut self) -> Result<(), String> {
        self.demand(Request::Command(DeviceCommand::Calibrate))?;
        self.wait_for(Phase::Ready, 20_000 * MS)
    }

    /// Calibrates the device and arms it.
    ///
    /// # Errors
    /// The calibration or the arming fails.
    pub fn arm(&mut self) -> Result<(), String> {
        self.calibrate()?;
        self.demand(Request::Command(DeviceCommand::Arm))?;
        self.wait_for(Phase::Armed, 100 * MS)
    }

    /// Whether the motor's power bridge is on.
    #[must_use]
    pub fn is_on(&self) -> bool {
        self.machine.chip().bridge.is_on()
    }

    /// The simulated hand grasps the knob and presses it into the virtual wall. The hand's torque rises to `torque_n_m` over
    /// `ramp_s`, stays for `hold_s` and falls over `ramp_s`.
    ///
    /// # Errors
    /// No telemetry has arrived, so the position of the wall is unknown.
    pub fn press(
        &mut self,
        hand: &Hand,
        torque_n_m: f64,
        ramp_s: f64,
        hold_s: f64,
    ) -> Result<(), String> {
        let settings = self.settings()?;
        let counts = f64::from(settings.encoder.counts_per_rev);
        let surface = number(settings.wall.surface_rad);
        let stiffness = number(settings.wall.k_desired_n_m_per_rad);
        self.press_at(hand, torque_n_m, ramp_s, hold_s, surface, counts, stiffness)
    }

    /// Same as [`Bench::press`], without reading the device's settings. The caller passes the position of the wall's surface in
    /// rad, the encoder counts per turn, and the wall's stiffness in N·m/rad.
    ///
    /// # Errors
    /// No telemetry has arrived, so the position of the wall is unknown.
    #[allow(clippy::too_many_arguments)]
    pub fn press_at(
        &mut self,
        hand: &Hand,
        torque_n_m: f64,
        ramp_s: f64,
        hold_s: f64,
        surface_rad: f64,
        counts: f64,
        stiffness: f64,
    ) -> Result<(), String> {
        let record = self.link.telemetry.last().ok_or("no telemetry")?;
        let turn = std::f64::consts::TAU / counts;
        let world = &mut self.machine.chip_mut().world;
        let here = world.angle_rad();
        // The shaft's true angle at the wall's surface, from the present true angle and the position that the device reports.
        let surface = here - f64::from(record.count) * turn + surface_rad;
        let give = 1.0 / hand.pad_stiffness + 1.0 / hand.stiffness;
        let inside = surface + torque_n_m * (give + 1.0 / stiffness);
        world.hold(hand, move |time| {
            let out = (time - ramp_s - hold_s) / ramp_s;
            here + (inside - here) * (minimum_jerk(time / ramp_s) - minimum_jerk(out))
        });
        Ok(())
    }

    /// The simulated hand takes hold of the knob, if it does not hold it yet, turns it and then holds it. `angle_rad` counts from
    /// the zero that the device reports; `counts` are the encoder counts per turn.
    ///
    /// # Errors
    /// No telemetry has arrived, so the zero is unknown.
    pub fn turn_to(&mut self, hand: &Hand, angle_rad: f64, counts: f64) -> Result<(), String> {
        let record = self.link.telemetry.last().ok_or("no telemetry")?;
        let reported = f64::from(record.count) / counts * std::f64::consts::TAU;
        let world = &mut self.machine.chip_mut().world;
        let to = world.angle_rad() - reported + angle_rad;
        let from = world.rest_rad().unwrap_or_else(|| {
            world.hold(hand, |_| 0.0);
            world.angle_rad()
        });
        let duration_s = ((to - from).abs() * 1.875 / TURN_RAD_PER_S).max(TURN_S);
        world.lead(move |time| from + (to - from) * minimum_jerk(time / duration_s));
        Ok(())
    }

    /// Lets the simulated hand release the knob.
    pub fn release(&mut self) {
        self.machine.chip_mut().world.release();
    }
}

/// A setting of fixed-point format as a floating-point number, in the same unit.
#[must_use]
pub fn number(value: Si) -> f64 {
    value.to_num()
}

/// A smooth rise from 0 to 1 along a minimum-jerk curve, as a person's hand moves; `share` is the elapsed fraction (0 to 1) of its
/// duration.
#[must_use]
pub fn minimum_jerk(share: f64) -> f64 {
    let s = share.clamp(0.0, 1.0);
    s * s * s * (10.0 + s * (6.0 * s - 15.0))
}
