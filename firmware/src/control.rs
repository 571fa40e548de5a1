//! The wiring of the control tick: reads registers into a [`ControlInput`] and writes a [`ControlOutput`] to registers.

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

/// Largest number of telemetry records that wait for the serial port: at 10 kHz those of one and a half rounds of the link's task.
pub const QUEUED: usize = 16;

/// What the interrupt has read for a tick, except the encoder.
pub struct Readings {
    /// Whether the PWM timer's hardware break has switched the outputs off.
    pub hardware_break: bool,
    /// Whether the processor's supply has fallen below 2.9 V.
    pub brown_out: bool,
    /// Processor cycles from when the tick was due to its first instruction.
    pub lateness: u32,
}

/// The state of the control tick. The thread reads it and gives commands through [`CONTROL`].
pub struct Control {
    /// The device's logic, which makes all decisions.
    pub device: Device,
    /// Number of control ticks since the start.
    pub tick: u32,
    /// The device's state at the end of the last tick.
    pub state: State,
    /// A command that waits for the next tick.
    pub command: Option<Command>,
    /// Whether the last command had an effect; `None` until a tick has handled it.
    pub accepted: Option<bool>,
    /// Telemetry records that wait for the serial port, oldest first.
    pub telemetry: Deque<Telemetry, QUEUED>,
    /// Number of control ticks per telemetry record; 0 for no telemetry.
    pub decimation: u16,
    /// Number of telemetry records dropped because the queue was full.
    pub dropped: u32,
    /// Longest duration of a tick, in processor cycles.
    pub cycles_max: u32,
    /// Largest lateness of a tick, in processor cycles.
    pub lateness_max: u32,
    /// State of the automatic start at power-on.
    #[cfg(feature = "g474re")]
    pub autostart: Autostart,
    since_sent: u16,
    /// The last tick's record is not in the ring buffer yet.
    is_unkept: bool,
    duration: u32,
    encoder: EncoderKind,
    next_encoder: EncoderKind,
    rate_hz: u32,
    brown_out_told: bool,
}

/// Whether a frame from the desktop arrived since the last tick. The flag is read and cleared in two steps; the thread, which sets
/// it, cannot run between them.
#[inline(always)]
fn heard() -> bool {
    let heard = HEARD.load(Relaxed);
    if heard {
        HEARD.store(false, Relaxed);
    }
    heard
}

/// Runs the device's tick, once per control tick. A function of its own, so that the input is built in place and not copied.
#[inline(always)]
fn tick_of(device: &mut Device, input: &ControlInput) -> ControlOutput {
    #[cfg(not(feature = "g474re"))]
    return device.tick(input);
    #[cfg(feature = "g474re")]
    // SAFETY: once in a tick, and the control interrupt runs it.
    device.tick_around(input, unsafe { AROUND.mine() })
}

/// The state of the control tick; `None` before the start.
pub static CONTROL: Guarded<Option<&'static mut Control>> = Guarded::new(None);
/// The environment (further walls, end stops, detents) and the cogging map's table. It is large and must not be moved, like
/// [`RING`].
#[cfg(feature = "g474re")]
pub static AROUND: Guarded<touchstone_drive::around::Around> =
    Guarded::new(touchstone_drive::around::Around::new());
/// The ring buffer with the records of the last second. It is too large for the stack and must not be moved.
pub static RING: Guarded<Ring> = Guarded::new(Ring::new(1_000));

impl Control {
    /// The control tick's state before the first tick.
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

    /// Runs one control tick.
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

    /// Reads the encoder again between two ticks, when the commanded force changes.
    #[inline]
    pub fn read_change(&mut self) {
        let last = magnetic::begin(self.encoder).and_then(|()| magnetic::go_on(self.encoder));
        self.device.read_change(self.encoder_end(last));
    }

    /// Finishes the reading of the encoder: waits for the last SPI frame, or reads the timer's count.
    #[inline(always)]
    fn encoder_end(&self, last: Option<magnetic::Last>) -> EncoderReading {
        match self.encoder {
            EncoderKind::Incremental => board::encoder_count(),
            EncoderKind::As5047p | EncoderKind::Mt6701 => magnetic::end(last),
        }
    }

    /// Adds the last tick's record to the ring buffer.
    #[inline(always)]
    fn keep(&mut self) {
        if core::mem::take(&mut self.is_unkept) {
            // SAFETY: nothing else holds it here, and the control interrupt runs it.
            unsafe { RING.mine() }.push(self.device.record());
            self.since_sent = self.since_sent.saturating_add(1);
        }
    }

    /// Queues the last tick's record for the serial port, in every `decimation`-th tick.
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

    /// Stores the duration of the tick in processor cycles.
    #[inline]
    pub fn ended(&mut self, cycles: u32) {
        self.duration = cycles;
        self.cycles_max = self.cycles_max.max(cycles);
    }

    /// Passes the tick's command to the current loop or the amplifier. The mailbox is written before the outputs are switched off:
    /// a current loop that interrupts between the two must not find an old command and switch on again.
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

    /// Takes new settings and the coefficients computed from them. They are used from the next calibration on.
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

    /// Adds the values measured at the motor to the telemetry record that is already in the queue. Building the record elsewhere
    /// would cost a copy in every tick. The current loop's report is read again for the same reason; it is at most one PWM period
    /// newer.
    #[cold]
    #[inline(never)]
    fn add_measuring(&mut self, part: MeasuringPart) {
        if let Some(telemetry) = self.telemetry.back_mut() {
            telemetry.measuring = Some(wire::measuring(part, &REPORT.get()));
        }
    }
}
