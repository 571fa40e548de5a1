//! The control interrupt's access to registers: reads registers into a [`ControlInput`] and writes a [`ControlOutput`] to
//! registers.

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
use crate::shared::{InThread, SharedWithInterrupt};
use crate::{analogue, board, pwm};

/// Largest number of telemetry records that wait for the serial port. At 10 kHz, 16 records arrive in 1.6 ms; the task that serves
/// the port runs at least every millisecond.
pub const QUEUED: usize = 16;

/// The values that the interrupt has read for a control period. The encoder's reading is not among them.
pub struct Readings {
    /// Whether the PWM timer's hardware break has switched the outputs off.
    pub hardware_break: bool,
    /// Whether the processor's supply has fallen below 2.9 V.
    pub brown_out: bool,
    /// Processor cycles from the time at which the control interrupt was due to its first instruction.
    pub lateness: u32,
}

/// All data of the control interrupt. The main thread reads them and gives commands through [`CONTROL`].
pub struct Control {
    /// The device's logic (crate `touchstone-drive`), which makes all decisions.
    pub device: Device,
    /// Number of control periods since the start.
    pub tick: u32,
    /// The device's state at the end of the last control period.
    pub state: State,
    /// A command that waits for the next control period.
    pub command: Option<Command>,
    /// Whether the last command had an effect; `None` until a control period has handled it.
    pub accepted: Option<bool>,
    /// Telemetry records that wait for the serial port, oldest first.
    pub telemetry: Deque<Telemetry, QUEUED>,
    /// Number of control periods per telemetry record; 0: no telemetry is sent.
    pub decimation: u16,
    /// Number of telemetry records dropped because the queue was full.
    pub dropped: u32,
    /// Longest duration of a control interrupt, in processor cycles.
    pub cycles_max: u32,
    /// Largest lateness of a control interrupt, in processor cycles.
    pub lateness_max: u32,
    /// State of the automatic start at power-on.
    #[cfg(feature = "g474re")]
    pub autostart: Autostart,
    since_sent: u16,
    /// Whether the last control period's record is not in the ring buffer yet.
    is_unkept: bool,
    duration: u32,
    encoder: EncoderKind,
    next_encoder: EncoderKind,
    rate_hz: u32,
    brown_out_told: bool,
}

/// Whether a frame from the computer arrived since the last control period. The flag is read and then cleared. The main thread,
/// which sets the flag, cannot run between the two.
#[inline(always)]
fn heard() -> bool {
    let heard = HEARD.load(Relaxed);
    if heard {
        HEARD.store(false, Relaxed);
    }
    heard
}

/// Runs one control period of the device. A separate function, so that the input is built in place and not copied.
#[inline(always)]
fn tick_of(device: &mut Device, input: &ControlInput) -> ControlOutput {
    #[cfg(not(feature = "g474re"))]
    return device.tick(input);
    #[cfg(feature = "g474re")]
    // SAFETY: this is called once per tick, and only in the control interrupt.
    device.tick_around(input, unsafe { AROUND.mine() })
}

/// The data of the control interrupt; `None` before the start.
pub static CONTROL: SharedWithInterrupt<Option<&'static mut Control>> =
    SharedWithInterrupt::new(None);

/// Calls `look` with the control interrupt's data while that interrupt is masked. `None` before the data exist; they exist before
/// the first request arrives.
pub fn control<R>(here: InThread, look: impl FnOnce(&mut Control) -> R) -> Option<R> {
    CONTROL.in_thread(here, |control| {
        control.as_mut().map(|control| look(control))
    })
}

/// The environment (further walls, end stops, detents) and the cogging map's table. It is large and must not be moved, like
/// [`RING`].
#[cfg(feature = "g474re")]
pub static AROUND: SharedWithInterrupt<touchstone_drive::around::Around> =
    SharedWithInterrupt::new(touchstone_drive::around::Around::new());
/// The ring buffer with the records of the last second. It is too large for the stack and must not be moved.
pub static RING: SharedWithInterrupt<Ring> = SharedWithInterrupt::new(Ring::new(1_000));

impl Control {
    /// The data of the control interrupt before its first run.
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

    /// Runs one control period: reads the encoder, lets the device decide, and passes the device's command on.
    #[inline]
    pub fn tick(&mut self, readings: &Readings) {
        if readings.brown_out && !self.brown_out_told {
            self.brown_out_told = true;
            self.device.report_fault(FaultCode::BrownOut, 0);
        }
        // While an encoder on the bus answers, the processor does the work that does not need the answer.
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
        // SAFETY: this runs in the control interrupt, and no other reference exists here.
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

    /// Reads the encoder a second time in a control period, when the commanded force changes.
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

    /// Adds the last control period's record to the ring buffer.
    #[inline(always)]
    fn keep(&mut self) {
        if core::mem::take(&mut self.is_unkept) {
            // SAFETY: this runs in the control interrupt, and no other reference exists here.
            unsafe { RING.mine() }.push(self.device.record());
            self.since_sent = self.since_sent.saturating_add(1);
        }
    }

    /// Queues the last control period's record for the serial port, once in `decimation` periods; never if `decimation` is 0.
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

    /// Stores the duration of the control interrupt, in processor cycles.
    #[inline]
    pub fn ended(&mut self, cycles: u32) {
        self.duration = cycles;
        self.cycles_max = self.cycles_max.max(cycles);
    }

    /// Passes the control period's command to the current loop or the amplifier. The command is written to the mailbox before the
    /// outputs are switched off. Otherwise a current loop that interrupts in between could find an old command and switch on again.
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

    /// Takes new settings and the coefficients computed from them. The decimation of the telemetry applies at once, the control law
    /// and the encoder's kind from the next calibration on.
    pub fn prepare(&mut self, settings: &DeviceSettings, config: Config) {
        self.device.prepare(config);
        self.next_encoder = settings.encoder.kind;
        self.rate_hz = settings.timing.rate_hz;
        self.decimation = settings.telemetry.decimation;
    }

    fn reconfigure(&mut self) {
        // SAFETY: only the control tick calls `give`.
        unsafe { CONFIG.give(self.device.current_config()) };
        self.encoder = self.next_encoder;
        board::magnetic::prepare(self.encoder);
    }

    /// Forgets errors of the hardware that are over; an error that lasts is found again at once.
    pub fn clear_latches(&mut self) {
        BROWN_OUT.store(false, Relaxed);
        self.brown_out_told = false;
        BREAK.store(false, Relaxed);
        board::forget_driver();
        pwm::clear_break();
    }

    /// Adds the values measured at the motor to the telemetry record that is already in the queue. To build the record elsewhere
    /// would cost a copy in every control period. To save another copy, the current loop's report is read a second time. That
    /// report is at most one PWM period newer than the record.
    #[cold]
    #[inline(never)]
    fn add_measuring(&mut self, part: MeasuringPart) {
        if let Some(telemetry) = self.telemetry.back_mut() {
            telemetry.measuring = Some(wire::measuring(part, &REPORT.get()));
        }
    }
}
