//! The emulated chip without its processor: the connections between its peripheral blocks, and its time.

mod breaks;
mod bus;
pub mod comparators;
mod map;
mod system;
mod time;

use crate::board::{Board, Source};
use crate::cpu::core::Core;
use crate::cpu::handler::{CONTROL_TICK, CURRENT_LOOP, Handler, Running};
use crate::cpu::nvic::Nvic;
use crate::cpu::{CCM, RAM, core::Cost};
use crate::peripheral::Peripheral;
use crate::peripheral::adc::Adc;
use crate::peripheral::exti::Exti;
use crate::peripheral::flash::{self, Flash};
use crate::peripheral::gpio::Port;
use crate::peripheral::iwdg::Iwdg;
use crate::peripheral::plain::Plain;
pub use crate::peripheral::rcc::ResetCause;
use crate::peripheral::rcc::{Pwr, Rcc};
use crate::peripheral::spi::Spi;
use crate::peripheral::timer::bridge::BridgeTimer;
use crate::peripheral::timer::general::Timer;
use crate::peripheral::uart::Uart;
use crate::peripheral::wwdg::Wwdg;
use crate::world::World;

/// Interrupt number and width in bits of the timers TIM2 to TIM5. [`ADC1_2`], [`SPI3`], [`USART2`] and [`LPUART1`] are further
/// interrupt numbers (RM0440, table 97).
const TIMERS: [(u32, u32); 4] = [(28, 32), (29, 16), (30, 16), (50, 32)];
const ADC1_2: u32 = 18;
const SPI3: u32 = 51;
const USART2: u32 = 38;
const LPUART1: u32 = 91;

/// The emulated chip with its board and simulated world, without the processor.
pub struct Chip {
    /// Time and counters of the processor.
    pub core: Core,
    /// The interrupt controller.
    pub nvic: Nvic,
    /// Timer TIM1, which switches the motor's power bridge.
    pub bridge: BridgeTimer,
    timers: [Timer; 4],
    adcs: [Adc; 2],
    ports: Vec<Port>,
    /// Serial port LPUART1, the link to the computer on some boards.
    pub lpuart1: Uart,
    /// Serial port USART2, the link to the computer on boards that do not use LPUART1 for it.
    pub usart2: Uart,
    /// The SPI controller SPI3, to which the magnetic encoder is connected.
    pub spi3: Spi,
    /// The independent watchdog.
    pub iwdg: Iwdg,
    /// The window watchdog.
    pub wwdg: Wwdg,
    /// The flash controller.
    pub flash: Flash,
    rcc: Rcc,
    /// Bit mask of the peripheral blocks that are clocked, by their row in the address map.
    clocked: u64,
    /// The power control block.
    pub pwr: Pwr,
    exti: Exti,
    plain: [Plain; 6],
    /// The comparators COMP1 to COMP4.
    pub comparators: comparators::Comparators,
    system: Plain,
    cycle_offset: u32,
    locked_up: bool,
    /// The board around the chip.
    pub board: Board,
    /// The simulated motor, knob and hand.
    pub world: World,
    /// Exceptions whose handlers are running, the outermost first.
    pub running: Vec<Running>,
    /// Costs in instructions and cycles of each exception's handler.
    pub handlers: Vec<Handler>,
    /// Cause of a reset that is due; `None` if none is.
    pub reset_request: Option<ResetCause>,
    /// Descriptions of accesses and instructions of the program that the real chip does not allow.
    pub faults: Vec<String>,
    /// Addresses of the registers that the firmware used and that are not modelled.
    pub unknown: std::collections::BTreeSet<u32>,
    /// Addresses of the registers that the firmware has written since power-on.
    pub written: std::collections::BTreeSet<u32>,
    /// Frequency of the oscillator that clocks the independent watchdog, Hz.
    lsi_hz: u64,
    /// An injected interrupt that is raised periodically without a cause: interrupt number, period and next time, both in processor
    /// cycles.
    pub storm: Option<(u32, u64, u64)>,
}

impl Chip {
    /// A chip on a board, with the simulated world around it. `lsi_hz` is the frequency of the independent watchdog's oscillator.
    #[must_use]
    pub fn new(board: Board, world: World, lsi_hz: u64) -> Self {
        let core = Core::new([
            (flash::BASE, board.flash_bytes),
            (CCM, board.ccm_bytes),
            (RAM, board.ram_bytes),
        ]);
        let mut chip = Self {
            core,
            nvic: Nvic::default(),
            bridge: BridgeTimer::default(),
            timers: TIMERS.map(|(interrupt, bits)| Timer::new(interrupt, bits)),
            adcs: [Adc::new(ADC1_2), Adc::new(ADC1_2)],
            ports: Vec::new(),
            lpuart1: Uart::new(LPUART1, true),
            usart2: Uart::new(USART2, false),
            spi3: Spi::new(SPI3),
            iwdg: Iwdg::new(lsi_hz),
            wwdg: Wwdg::default(),
            flash: Flash::new(board.option_bytes),
            rcc: Rcc::new(ResetCause::PowerOn, None),
            clocked: 0,
            pwr: Pwr::new(3.3),
            exti: Exti::default(),
            plain: Default::default(),
            comparators: Default::default(),
            system: Plain::default(),
            cycle_offset: 0,
            locked_up: false,
            board,
            world,
            running: Vec::new(),
            handlers: vec![Handler::default(); 128],
            reset_request: None,
            faults: Vec::new(),
            unknown: Default::default(),
            written: Default::default(),
            lsi_hz,
            storm: None,
        };
        chip.clocked = Self::clocked(&chip.rcc);
        chip.spi3.slave = chip.board.encoder.slave();
        chip.bridge.gates = chip.board.gates;
        chip
    }

    /// Resets the processor and the peripherals, as a reset of the chip does.
    pub fn reset(&mut self, cause: ResetCause) {
        let now = self.core.now;
        if self.bridge.is_on() {
            self.bridge.changes.push((now, false));
        }
        let changes = std::mem::take(&mut self.bridge.changes);
        self.bridge = BridgeTimer::default();
        self.bridge.gates = self.board.gates;
        self.bridge.changes = changes;
        self.core.reset();
        self.nvic = Nvic::default();
        self.timers = TIMERS.map(|(interrupt, bits)| Timer::new(interrupt, bits));
        self.adcs = [Adc::new(ADC1_2), Adc::new(ADC1_2)];
        self.ports = (0..7).map(Port::new).collect();
        for (uart, fresh) in [
            (&mut self.lpuart1, Uart::new(LPUART1, true)),
            (&mut self.usart2, Uart::new(USART2, false)),
        ] {
            // A reset does not lose the bytes that the port has sent: the desktop has already received them.
            let sent = std::mem::take(&mut uart.sent);
            *uart = fresh;
            uart.sent = sent;
        }
        let before = std::mem::replace(&mut self.spi3, Spi::new(SPI3));
        let hangs = before.hangs();
        self.spi3.slave = before.slave;
        self.spi3.set_hangs(hangs, self.core.now);
        self.iwdg = Iwdg::new(self.lsi_hz);
        self.wwdg = Wwdg::default();
        self.flash.reset(self.board.option_bytes);
        self.locked_up = false;
        self.rcc = Rcc::new(cause, Some(&self.rcc));
        self.clocked = Self::clocked(&self.rcc);
        self.pwr = Pwr::new(self.pwr.supply_v);
        self.exti = Exti::default();
        self.plain = Default::default();
        self.comparators.reset();
        self.system = Plain::default();
        self.running.clear();
        self.reset_request = None;
        // After a reset the pins float. The gate drivers read a floating input as off.
        self.drive_world();
    }

    /// Sets the magnetic encoder to its state at power-on, because the chip's board supplies it and has lost power.
    pub fn forget_encoder(&mut self) {
        self.spi3.slave = self.board.encoder.slave();
    }

    /// Address of the vector table that the program has set; the start of the flash before that.
    #[must_use]
    pub fn vectors(&self) -> u32 {
        match self.system.get(0xed08) {
            0 => flash::BASE,
            vectors => vectors,
        }
    }

    /// Frequency of the system clock SYSCLK as the firmware has set it up, Hz.
    #[must_use]
    pub fn sysclk_hz(&self) -> u64 {
        self.rcc.sysclk_hz()
    }

    /// The serial port that links the board to the computer.
    pub fn link(&mut self) -> &mut Uart {
        match self.board.link_is_usart2 {
            true => &mut self.usart2,
            false => &mut self.lpuart1,
        }
    }

    /// Handles a store instruction of the processor to a word in flash. `before` is the word's value before the instruction,
    /// `value` the stored one. The flash controller later carries the write out or undoes it.
    pub fn store_to_flash(&mut self, address: u32, before: u32, value: u32) {
        let now = self.core.now;
        self.flash.store(address, value, now);
        // Unicorn writes the value to its memory itself. At the next instruction boundary the former value is restored, or replaced
        // by the result of the flash model.
        self.flash.stores.push((address, before));
        self.core.interrupted = true;
    }

    /// Passes the power bridge's new state to the simulated world.
    fn drive_world(&mut self) {
        let now = self.core.now;
        let duty = self.bridge.duty();
        self.world.drive(now, duty);
    }

    /// Updates the levels of all interrupt lines; stops the processor if an interrupt is to be delivered.
    fn refresh(&mut self) {
        let mut lines = self.bridge.lines()
            | self.lpuart1.lines()
            | self.usart2.lines()
            | self.spi3.lines()
            | self.exti.lines()
            | self.flash.lines();
        for timer in &self.timers {
            lines |= timer.lines();
        }
        for adc in &self.adcs {
            lines |= adc.lines();
        }
        self.nvic.set_lines(lines);
        if self.nvic.any_pending() || self.reset_request.is_some() {
            self.core.interrupted = true;
        }
    }

    /// Called when an exception's handler begins.
    pub fn begin_handler(&mut self, exception: usize) {
        self.nvic.enter(exception);
        self.core.depth += 1;
        self.core.event = true;
        let begin = self.core.by_depth[self.core.depth.min(7)];
        self.running.push(Running {
            exception,
            entered: self.core.now,
            begin,
        });
        self.count_places();
    }

    /// Switches the counting of flash fetches by address: on while the current loop or the control interrupt runs, otherwise off.
    fn count_places(&mut self) {
        let runs = self.running.last().map(|running| running.exception);
        self.core.is_counting = matches!(runs, Some(CURRENT_LOOP | CONTROL_TICK));
    }

    /// Called when an exception's handler ends; `None` if no handler runs.
    pub fn end_handler(&mut self) -> Option<()> {
        let running = self.running.pop()?;
        let cost: Cost = self.core.by_depth[self.core.depth.min(7)].since(running.begin);
        self.core.depth = self.core.depth.saturating_sub(1);
        self.core.event = true;
        let handler = &mut self.handlers[running.exception];
        handler.runs += 1;
        handler.longest = handler.longest.max(self.core.now - running.entered);
        if cost.instructions > handler.worst.instructions {
            handler.worst_at = running.entered;
        }
        handler.worst = handler.worst.worst(cost);
        self.nvic.leave(running.exception);
        self.count_places();
        Some(())
    }

    /// Code of the digital-to-analog converter's channel 1, 0 to 4,095.
    #[must_use]
    pub fn dac(&self) -> u32 {
        let dac = &self.plain[1];
        // If channel 1 is enabled (EN1), its code is in DHR12R1.
        if dac.get(0x00) & 1 != 0 {
            dac.get(0x08) & 0xfff
        } else {
            0
        }
    }

    /// For each converter, the quantity that it samples or converts, and the time in processor cycles at which its sampling ends.
    /// `None` for a converter that is idle or on another channel.
    #[must_use]
    pub fn samplings(&self) -> [Option<(Source, u64)>; 2] {
        [0, 1].map(|adc| {
            let (channel, at) = self.adcs[adc].sampling()?;
            let mut pins = self.board.pins.iter();
            let (.., source) = pins.find(|(on, pin, _)| (*on, *pin) == (adc, channel))?;
            Some((*source, at))
        })
    }

    /// The GPIO port with this index: 0 is port A.
    pub fn port(&mut self, index: usize) -> &mut Port {
        &mut self.ports[index]
    }
}
