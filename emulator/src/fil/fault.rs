//! The faults that can be injected, and how each is caused.

use touchstone_protocol::{DeviceCommand, Request};

use crate::bench::{Bench, US};
use crate::board::Source;
use crate::chip::{Chip, ResetCause};
use crate::peripheral::spi::SlaveFault;

/// The part of the firmware in which a fault is injected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// The main program outside of any interrupt handler.
    Thread,
    /// The handler of the interrupt with this number.
    Interrupt(usize),
}

/// Handler of the PWM interrupt, which runs the current loop.
pub const CURRENT_LOOP: Level = Level::Interrupt(18);
/// Handler of the control interrupt, which runs a control period.
pub const CONTROL_TICK: Level = Level::Interrupt(49);
/// Handler of the interrupt of the serial port to the computer.
pub const SERIAL: Level = Level::Interrupt(91);
/// Handler of the interrupt of the serial port to the computer, on the B-G431B-ESC1.
pub const SERIAL_ESC1: Level = Level::Interrupt(38);

/// Number of the control interrupt, which uses the vector of the timer LPTIM1.
pub const LPTIM1: u32 = 49;

/// A fault that a test injects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// The current sensor of this phase reports this current, A.
    Sensor(usize, f64),
    /// The gate driver pulls the break input for this time in µs; 0 keeps it pulled.
    Break(u64),
    /// A break of 1 us, which begins this many us after the handler of this level began.
    BreakWithin(Level, u64),
    /// A comparator (1 to 4) reports over-current for this time in µs; 0 keeps the report.
    Comparator(u32, u64),
    /// The supply bus has this voltage in V for this time in µs; 0 keeps the voltage.
    Bus(f64, u64),
    /// The driver and the motor have this temperature, °C.
    Temperature(f64),
    /// The pin of the thermistor carries this voltage, V.
    Thermistor(f64),
    /// A fault of the encoder on the serial bus.
    Encoder(SlaveFault),
    /// A fault of the encoder on the serial bus that begins with a control period.
    EncoderAtTick(SlaveFault),
    /// The SPI bus of the encoder hangs: frames never end.
    BusHangs,
    /// The count of the incremental encoder stops changing.
    TrackHeld,
    /// The incremental encoder jumps by this many counts.
    TrackJumps(i64),
    /// The shaft is turned from outside at this speed, rad/s.
    Turned(f64),
    /// The shaft is turned from outside to and fro at this speed in rad/s, each way for this time in µs.
    Shaken(f64, u64),
    /// A person turns the knob quickly, at this speed in rad/s for this time in µs, and then releases it.
    Flicked(f64, u64),
    /// Every instruction takes this many times its usual cycles.
    Slow(u64),
    /// An interrupt (first value: its number) is raised without a cause, again after this number of processor cycles (second
    /// value).
    Storm(u32, u64),
    /// An interrupt is disabled in the interrupt controller for this time in µs; 0 keeps it disabled.
    Lost(u32, u64),
    /// The main program masks the control interrupt for this time in µs; interrupts of higher priority run on.
    HeldOff(u64),
    /// A part of the firmware hangs in an endless loop.
    Hang(Level),
    /// A part of the firmware executes an undefined instruction.
    Undefined(Level),
    /// The stack of the firmware overflows.
    StackOverflow,
    /// The board's stop button is pressed for this time in µs.
    StopPressed(u64),
    /// The supply of the chip falls to this voltage in V, and recovers only with a reset.
    Supply(f64),
    /// The chip is reset.
    Reset(ResetCause),
    /// The computer requests a reset.
    Reboot,
    /// The serial line carries this many random bytes; the second value says whether they have framing errors.
    Noise(usize, bool),
}

/// Priority of the control interrupt as a value of the register BASEPRI.
const CONTROL_PRIORITY: u32 = 2 << 4;

/// Offset from 0xE000E100 of the registers that enable interrupts. [`ICER`] is that of the registers that disable them.
const ISER: u32 = 0x00;
const ICER: u32 = 0x80;

/// Runs to the beginning of a control period at 1 kHz. The control interrupt's handler also runs for the second encoder reading, in
/// the first half of a period. So the first run after a longer pause is the beginning of a period.
fn to_tick(bench: &mut Bench) -> Result<(), String> {
    bench.machine.run_to(CONTROL_TICK.exception())?;
    for _ in 0..3 {
        let before = bench.now();
        bench.run(100 * US)?;
        bench.machine.run_to(CONTROL_TICK.exception())?;
        if bench.now() - before > 500 * US {
            return Ok(());
        }
    }
    Err("no control tick after half a tick's rest".into())
}

impl Fault {
    /// Injects the fault now.
    ///
    /// # Errors
    /// The part of the firmware in which the fault is injected did not run.
    pub fn inject(self, bench: &mut Bench) -> Result<(), String> {
        let now = bench.now();
        let chip = bench.machine.chip_mut();
        let sensor = chip.board.current;
        match self {
            Self::Sensor(phase, amperes) => {
                let volts = sensor.0 + sensor.1 * amperes;
                chip.board.wiring.forced[0] = Some((Source::Current(phase), volts));
            }
            Self::Break(_) => {
                chip.board.wiring.break_pulled = true;
                chip.update_break(now);
            }
            Self::BreakWithin(level, us) => {
                bench.machine.run_to(level.exception())?;
                bench.run(us * US)?;
                return Self::Break(1).inject(bench);
            }
            Self::Comparator(number, _) => {
                chip.board.wiring.comparators = 1 << (number - 1);
                chip.update_break(now);
            }
            Self::Bus(volts, _) => chip.world.bridge.bus_v = volts,
            Self::Temperature(celsius) => {
                chip.world.temperature_c = celsius;
                chip.update_break(now);
            }
            Self::Thermistor(volts) => {
                chip.board.wiring.forced[1] = Some((Source::Temperature, volts));
            }
            Self::Encoder(fault) => {
                if let Some(slave) = &mut chip.spi3.slave {
                    slave.set_fault(fault);
                }
            }
            Self::EncoderAtTick(fault) => {
                to_tick(bench)?;
                return Self::Encoder(fault).inject(bench);
            }
            Self::BusHangs => chip.spi3.set_hangs(true, now),
            Self::TrackHeld => {
                let count = chip.board.encoder_count(&chip.world);
                chip.board.wiring.encoder_held = Some(count);
            }
            Self::TrackJumps(counts) => chip.board.wiring.encoder_moved = counts,
            Self::Turned(rad_per_s) | Self::Flicked(rad_per_s, _) => chip.world.force(rad_per_s),
            Self::Shaken(rad_per_s, us) => chip.world.shake(rad_per_s, us * US),
            Self::Slow(times) => chip.core.stretch = 256 * times,
            Self::Storm(interrupt, cycles) => chip.storm = Some((interrupt, cycles, now)),
            Self::Lost(interrupt, us) => {
                if interrupt == LPTIM1 && us > 0 {
                    before_a_control_tick(bench)?;
                }
                let chip = bench.machine.chip_mut();
                let (register, bit) = (4 * (interrupt / 32), 1 << (interrupt % 32));
                chip.nvic.write(ICER + register, bit, 4);
            }
            Self::HeldOff(_) => {
                before_a_control_tick(bench)?;
                return bench.machine.mask(CONTROL_PRIORITY);
            }
            Self::Hang(level) => {
                // b .
                let place = bench.machine.behind_program();
                bench.machine.set_memory(place, &[0xfe, 0xe7]);
                return bench.machine.divert(level.exception(), place);
            }
            Self::Undefined(level) => {
                // udf #0
                let place = bench.machine.behind_program() + 4;
                bench.machine.set_memory(place, &[0x00, 0xde]);
                return bench.machine.divert(level.exception(), place);
            }
            Self::StackOverflow => return bench.machine.exhaust_stack(),
            Self::Supply(volts) => {
                chip.pwr.supply_v = volts;
                chip.update_break(now);
            }
            Self::StopPressed(_) => press(chip, true),
            Self::Reset(cause) => chip.reset_request = Some(cause),
            Self::Reboot => {
                let (_, frame) = bench.link.ask(Request::Command(DeviceCommand::Reboot));
                bench.send(&frame);
            }
            Self::Noise(bytes, framing_errors) => {
                let mut random = Random(0x9e37_79b9_7f4a_7c15 ^ bytes as u64);
                let noise: Vec<u8> = (0..bytes).map(|_| random.byte()).collect();
                let uart = chip.link();
                uart.put_with_errors(&noise, framing_errors, now);
            }
        }
        Ok(())
    }

    /// Whether the injection first waits until the affected part of the firmware runs.
    #[must_use]
    pub const fn waits(self) -> bool {
        matches!(
            self,
            Self::Hang(_)
                | Self::Undefined(_)
                | Self::BreakWithin(..)
                | Self::EncoderAtTick(..)
                | Self::HeldOff(_)
        ) || matches!(self, Self::Lost(LPTIM1, us) if us > 0)
    }

    /// Duration of the fault in cycles; `None` for a fault that lasts until it is removed.
    #[must_use]
    pub fn lasts(self) -> Option<u64> {
        match self {
            Self::Break(us)
            | Self::Comparator(_, us)
            | Self::Bus(_, us)
            | Self::StopPressed(us)
            | Self::Flicked(_, us)
            | Self::Lost(_, us)
            | Self::HeldOff(us) => (us > 0).then_some(us * US),
            Self::BreakWithin(..) => Some(US),
            _ => None,
        }
    }

    /// Removes the fault, as far as that is possible from outside the chip.
    pub fn remove(self, bench: &mut Bench) {
        let now = bench.now();
        let chip = bench.machine.chip_mut();
        chip.board.wiring = Default::default();
        chip.world.bridge.bus_v = chip.board.supply_v;
        chip.world.temperature_c = 25.0;
        chip.spi3.set_hangs(false, now);
        if let Some(slave) = &mut chip.spi3.slave {
            slave.set_fault(SlaveFault::None);
        }
        chip.core.stretch = 256;
        chip.storm = None;
        chip.pwr.supply_v = 3.3;
        press(chip, false);
        if let Self::Lost(interrupt, _) = self {
            let (register, bit) = (4 * (interrupt / 32), 1 << (interrupt % 32));
            chip.nvic.write(ISER + register, bit, 4);
        }
        if matches!(self, Self::Flicked(..)) {
            chip.world.release();
        }
        if matches!(self, Self::Turned(_) | Self::Shaken(..)) {
            chip.world.force(0.0);
            chip.world.release();
        }
        chip.update_break(now);
        if matches!(self, Self::HeldOff(_)) {
            bench.machine.unmask();
        }
    }
}

/// Runs to 0.2 ms before a control period is due, at 1 kHz. The injection then always hits the beginning of a period. A period that
/// begins less than half a period late is not counted as missed.
fn before_a_control_tick(bench: &mut Bench) -> Result<(), String> {
    // The same interrupt also makes the second reading of a period, so the first one that comes may not begin a period.
    to_tick(bench)?;
    bench.run(800 * US)
}

fn press(chip: &mut Chip, pressed: bool) {
    if let Some((port, pin)) = chip.board.button {
        chip.port(port).drive(pin, Some(pressed));
    }
}

impl Level {
    /// The exception number of this part of the firmware; `None` for the main program.
    #[must_use]
    pub fn exception(self) -> Option<usize> {
        match self {
            Self::Thread => None,
            Self::Interrupt(number) => Some(crate::cpu::nvic::FIRST + number),
        }
    }
}

/// The pseudo-random generator xorshift64, with its state.
pub struct Random(pub u64);

impl Random {
    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// The next random byte.
    pub fn byte(&mut self) -> u8 {
        (self.bits() >> 32) as u8
    }
}
