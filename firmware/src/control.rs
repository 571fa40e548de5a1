//! The control tick's wiring: registers into [`ControlInput`], [`ControlOutput`] into registers.

use core::sync::atomic::Ordering::Relaxed;

use heapless::Deque;
#[cfg(feature = "g474re")]
use touchstone_drive::autostart::Autostart;
use touchstone_drive::config::Config;
use touchstone_drive::{
    ControlInput, ControlOutput, CurrentCommand, CurrentMode, Device, DeviceSettings, DriveCommand,
    EncoderKind, EncoderReading, Ring, TickTiming, wire,
};
use touchstone_protocol::{Command, FaultCode, MeasuringPart, Outputs, State, Telemetry};

use crate::board::magnetic;
use crate::exchange::{BREAK, BROWN_OUT, COMMAND, CONFIG, HEARD, REPORT};
use crate::shared::Guarded;
use crate::{analogue, board, pwm};

/// How many telemetry records may wait for the port: at 10 kHz, those of one and a half of the link's rounds.
pub const QUEUED: usize = 16;

/// The readings of an interrupt for a tick, apart from the encoder.
pub struct Readings {
    /// The timer's break has pulled.
    pub hardware_break: bool,
    /// The supply has sagged.
    pub brown_out: bool,
    /// Cycles from when the tick was due to its first instruction.
    pub lateness: u32,
}

/// Everything that a control tick remembers. The thread gives orders and looks through [`CONTROL`].
pub struct Control {
    /// The device's logic, which makes all decisions.
    pub device: Device,
    /// The device's clock: ticks since the start.
    pub tick: u32,
    /// The state at the end of the last tick.
    pub state: State,
    /// A command that waits for the next tick.
    pub command: Option<Command>,
    /// What became of the last command.
    pub accepted: Option<bool>,
    /// Telemetry that waits for the port, oldest first.
    pub telemetry: Deque<Telemetry, QUEUED>,
    /// Number of control ticks for each telemetry record; 0 for no telemetry.
    pub decimation: u16,
    /// Telemetry records that the queue had no room for.
    pub dropped: u32,
    /// Most cycles of a tick.
    pub cycles_max: u32,
    /// Most cycles of lateness.
    pub lateness_max: u32,
    /// The unattended start.
    #[cfg(feature = "g474re")]
    pub autostart: Autostart,
    since_sent: u16,
    /// The last tick's record is not in the ring yet.
    is_unkept: bool,
    duration: u32,
    encoder: EncoderKind,
    next_encoder: EncoderKind,
    rate_hz: u32,
    brown_out_told: bool,
}

/// Whether a frame came since the last tick. The thread, which says so, does not run in between.
#[inline(always)]
fn heard() -> bool {
    let heard = HEARD.load(Relaxed);
    if heard {
        HEARD.store(false, Relaxed);
    }
    heard
}

/// The device's tick, called once in a control tick. It is a function of its own so that its input is built in place
/// and not copied.
#[inline(always)]
fn tick_of(device: &mut Device, input: &ControlInput) -> ControlOutput {
    #[cfg(not(feature = "g474re"))]
    return device.tick(input);
    #[cfg(feature = "g474re")]
    // SAFETY: once in a tick, and the control interrupt runs it.
    device.tick_around(input, unsafe { AROUND.mine() })
}

/// The control tick's state, in a static; `None` before the start.
pub static CONTROL: Guarded<Option<&'static mut Control>> = Guarded::new(None);
/// Things to touch in addition to the wall. As large as the ring is, so it never moves either.
#[cfg(feature = "g474re")]
pub static AROUND: Guarded<touchstone_drive::around::Around> =
    Guarded::new(touchstone_drive::around::Around::new());
/// The last second. Too large for a stack, so it never moves.
pub static RING: Guarded<Ring> = Guarded::new(Ring::new(1_000));

impl Control {
    /// The state before the first tick.
    pub fn new(device: Device, settings: &DeviceSettings) -> Self {
        Self {
            device,
            tick: 0,
            state: State::Boot,
            command: None,
            accepted: None,
            telemetry: Deque::new(),
            decimation: settings.telemetry.decimation,
            dropped: 0,
            cycles_max: 0,
            lateness_max: 0,
            #[cfg(feature = "g474re")]
            autostart: Autostart::new(false, touchstone_drive::ResetReason::PowerOn, false),
            since_sent: 0,
            is_unkept: false,
            duration: 0,
            encoder: settings.encoder.kind,
            next_encoder: settings.encoder.kind,
            rate_hz: settings.timing.rate_hz,
            brown_out_told: false,
        }
    }

    /// Runs one tick.
    #[inline]
    pub fn tick(&mut self, readings: &Readings) {
        if readings.brown_out && !self.brown_out_told {
            self.brown_out_told = true;
            self.device.report_fault(FaultCode::BrownOut, 0);
        }
        // While an encoder on a bus answers, the processor has nothing else to do than what does not need the answer.
        let begun = magnetic::begin(self.encoder);
        let report = REPORT.get();
        self.keep();
        let last = begun.and_then(|()| magnetic::go_on(self.encoder));
        self.send();
        let command = self.command.take();
        let encoder = self.encoder_end(last);
        let output = tick_of(
            &mut self.device,
            &ControlInput {
                encoder,
                current: report,
                command,
                hardware_break: readings.hardware_break,
                gate_driver_error: board::driver_complains(),
                stop_button: board::is_stop_pressed(),
                host_heard: heard(),
                timing: TickTiming {
                    lateness: readings.lateness,
                    duration: self.duration,
                },
            },
        );
        self.tick = output.record.tick;
        self.state = output.record.state;
        if command.is_some() {
            self.accepted = Some(output.accepted.unwrap_or(false));
        }
        self.drive(output.outputs, output.drive);
        // SAFETY: nothing else holds it here, and the control interrupt runs it.
        let ring = unsafe { RING.mine() };
        if output.reconfigure {
            self.reconfigure();
            ring.restart(self.rate_hz);
        }
        if output.clear_latches {
            ring.thaw();
            self.clear_latches();
        }
        self.is_unkept = true;
        self.lateness_max = self.lateness_max.max(readings.lateness);
    }

    /// Between two ticks: the encoder when the force changes.
    #[inline]
    pub fn read_change(&mut self) {
        let last = magnetic::begin(self.encoder).and_then(|()| magnetic::go_on(self.encoder));
        self.device.read_change(self.encoder_end(last));
    }

    /// What the encoder says now: its last frame's answer, or the timer's count.
    #[inline(always)]
    fn encoder_end(&self, last: Option<magnetic::Last>) -> EncoderReading {
        match self.encoder {
            EncoderKind::Incremental => board::encoder_count(),
            EncoderKind::As5047p | EncoderKind::Mt6701 => magnetic::end(last),
        }
    }

    /// Puts the last tick's record into the ring.
    #[inline(always)]
    fn keep(&mut self) {
        if core::mem::take(&mut self.is_unkept) {
            // SAFETY: nothing else holds it here, and the control interrupt runs it.
            unsafe { RING.mine() }.push(self.device.record());
            self.since_sent = self.since_sent.saturating_add(1);
        }
    }

    /// Puts the last tick's record into the telemetry, where it is its turn.
    #[inline(always)]
    fn send(&mut self) {
        if self.decimation == 0 || self.since_sent < self.decimation {
            return;
        }
        self.since_sent = 0;
        let telemetry = Telemetry::from(self.device.record());
        if self.telemetry.push_back(telemetry).is_err() {
            self.dropped = self.dropped.saturating_add(1);
        } else if let Some(part) = self.device.measuring() {
            self.add_measuring(part);
        }
    }

    /// Records how many cycles the tick took.
    #[inline]
    pub fn ended(&mut self, cycles: u32) {
        self.duration = cycles;
        self.cycles_max = self.cycles_max.max(cycles);
    }

    /// The mailbox first and the switch second: the current loop, which may come in between, must not find an old command and
    /// switch on again.
    fn drive(&mut self, outputs: Outputs, drive: DriveCommand) {
        let command = match (outputs, drive) {
            (Outputs::On, DriveCommand::Current(command)) => command,
            _ => CurrentCommand {
                tick: self.tick,
                mode: CurrentMode::Off,
                ..CurrentCommand::default()
            },
        };
        COMMAND.put(&command);
        if command.mode != CurrentMode::Drive {
            pwm::outputs_off();
        }
        match (outputs, drive) {
            (Outputs::On, DriveCommand::Analogue(code)) => analogue::on(code),
            _ => analogue::off(),
        }
    }

    /// Takes other settings and the coefficients computed from them, which are used from the next calibration on.
    pub fn prepare(&mut self, settings: &DeviceSettings, config: Config) {
        self.device.prepare(config);
        self.next_encoder = settings.encoder.kind;
        self.rate_hz = settings.timing.rate_hz;
        self.decimation = settings.telemetry.decimation;
    }

    fn reconfigure(&mut self) {
        // SAFETY: the control tick alone gives.
        unsafe { CONFIG.give(self.device.current_config()) };
        self.encoder = self.next_encoder;
        board::magnetic::prepare(self.encoder);
    }

    fn clear_latches(&mut self) {
        BROWN_OUT.store(false, Relaxed);
        self.brown_out_told = false;
        BREAK.store(false, Relaxed);
        board::forget_driver();
        pwm::clear_break();
    }

    /// What a measurement tells beside the record, in its place in the queue: a record that is built elsewhere is copied in every tick
    /// of the wall. The report is read anew for the same reason; it is a period younger at most.
    #[cold]
    #[inline(never)]
    fn add_measuring(&mut self, part: MeasuringPart) {
        if let Some(telemetry) = self.telemetry.back_mut() {
            telemetry.measuring = Some(wire::measuring(part, &REPORT.get()));
        }
    }
}
