//! The chip: what is connected to what inside, and the time.

mod breaks;
mod map;
mod system;

use crate::board::Board;
use crate::cpu::core::Core;
use crate::cpu::handler::{Handler, Running};
use crate::cpu::nvic::Nvic;
use crate::cpu::{RAM, core::Cost};
use crate::peripheral::adc::Adc;
use crate::peripheral::exti::Exti;
use crate::peripheral::flash::{self, Flash};
use crate::peripheral::gpio::Port;
use crate::peripheral::iwdg::Iwdg;
use crate::peripheral::plain::Plain;
pub use crate::peripheral::rcc::ResetCause;
use crate::peripheral::rcc::{Pwr, Rcc};
use crate::peripheral::spi::Spi;
use crate::peripheral::timer::bridge::{BridgeTimer, Edge};
use crate::peripheral::timer::general::Timer;
use crate::peripheral::uart::Uart;
use crate::peripheral::wwdg::Wwdg;
use crate::peripheral::{NEVER, Peripheral};
use crate::world::World;
use map::{Block, MAP};

/// Interrupts (RM0440, table 97).
const TIMERS: [(u32, u32); 4] = [(28, 32), (29, 16), (30, 16), (50, 32)];
const ADC1_2: u32 = 18;
const SPI3: u32 = 51;
const USART2: u32 = 38;
const LPUART1: u32 = 91;

/// What is not the processor.
pub struct Chip {
    /// Time, counters.
    pub core: Core,
    /// The interrupt controller.
    pub nvic: Nvic,
    /// TIM1.
    pub bridge: BridgeTimer,
    timers: [Timer; 4],
    adcs: [Adc; 2],
    ports: Vec<Port>,
    /// The link to the desktop.
    pub lpuart1: Uart,
    /// The other board's link.
    pub usart2: Uart,
    /// The bus of the magnetic encoder.
    pub spi3: Spi,
    /// The independent watchdog.
    pub iwdg: Iwdg,
    /// The window watchdog.
    pub wwdg: Wwdg,
    /// The flash controller.
    pub flash: Flash,
    rcc: Rcc,
    /// The supply.
    pub pwr: Pwr,
    exti: Exti,
    plain: [Plain; 6],
    system: Plain,
    cycle_offset: u32,
    /// What is connected to the chip.
    pub board: Board,
    /// Motor, knob, hand.
    pub world: World,
    /// Exceptions that run.
    pub running: Vec<Running>,
    /// What each exception's handler has cost.
    pub handlers: Vec<Handler>,
    /// A reset that is due.
    pub reset_request: Option<ResetCause>,
    /// Accesses and instructions that there are not, so far.
    pub faults: Vec<String>,
    /// Registers that were used and are not modelled: addresses.
    pub unknown: std::collections::BTreeSet<u32>,
    /// Frequency of the watchdog's oscillator, Hz.
    lsi_hz: u64,
    /// An interrupt that is raised again and again by something that the program does not know: (number, period, next time).
    pub storm: Option<(u32, u64, u64)>,
}

impl Chip {
    /// A chip on a board in a world.
    #[must_use]
    pub fn new(board: Board, world: World, lsi_hz: u64) -> Self {
        let core = Core::new((flash::BASE, board.flash_bytes), (RAM, board.ram_bytes));
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
            pwr: Pwr::new(3.3),
            exti: Exti::default(),
            plain: Default::default(),
            system: Plain::default(),
            cycle_offset: 0,
            board,
            world,
            running: Vec::new(),
            handlers: vec![Handler::default(); 128],
            reset_request: None,
            faults: Vec::new(),
            unknown: Default::default(),
            lsi_hz,
            storm: None,
        };
        chip.spi3.slave = chip.board.encoder.slave();
        chip.bridge.gates = chip.board.gates;
        chip
    }

    /// Resets everything that a reset of the chip resets.
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
            // What was sent is with the desktop already.
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
        let (count, cut_at) = (self.flash.count, self.flash.cut_at);
        self.flash = Flash::new(self.board.option_bytes);
        self.flash.count = count;
        self.flash.cut_at = cut_at;
        self.rcc = Rcc::new(cause, Some(&self.rcc));
        self.pwr = Pwr::new(self.pwr.supply_v);
        self.exti = Exti::default();
        self.plain = Default::default();
        self.system = Plain::default();
        self.running.clear();
        self.reset_request = None;
    }

    /// The vector table.
    #[must_use]
    pub fn vectors(&self) -> u32 {
        match self.system.get(0xed08) {
            0 => flash::BASE,
            vectors => vectors,
        }
    }

    /// SYSCLK as the program has set it up, Hz.
    #[must_use]
    pub fn sysclk_hz(&self) -> u64 {
        self.rcc.sysclk_hz()
    }

    /// The serial port that the board's desktop link is on.
    pub fn link(&mut self) -> &mut Uart {
        match self.board.link_is_usart2 {
            true => &mut self.usart2,
            false => &mut self.lpuart1,
        }
    }

    fn peripheral(&mut self, block: Block) -> &mut dyn Peripheral {
        match block {
            Block::Timer(index) => &mut self.timers[index],
            Block::Iwdg => &mut self.iwdg,
            Block::Wwdg => &mut self.wwdg,
            Block::Spi3 => &mut self.spi3,
            Block::Usart2 => &mut self.usart2,
            Block::Lpuart1 => &mut self.lpuart1,
            Block::Pwr => &mut self.pwr,
            Block::Exti => &mut self.exti,
            Block::Tim1 => &mut self.bridge,
            Block::Rcc => &mut self.rcc,
            Block::Flash => &mut self.flash,
            Block::Port(index) => &mut self.ports[index],
            Block::Adc(index) => &mut self.adcs[index],
            Block::AdcCommon => &mut self.plain[0],
            Block::Dac => &mut self.plain[1],
            Block::Syscfg => &mut self.plain[2],
            Block::Analog => &mut self.plain[3],
            Block::Dma => &mut self.plain[4],
            Block::Other => &mut self.plain[5],
        }
    }

    fn find(&mut self, address: u32) -> (Block, u32) {
        let found = MAP
            .iter()
            .find(|(base, size, _)| (*base..base + size).contains(&address));
        match found {
            Some((base, _, block)) => (*block, address - base),
            None => {
                self.unknown.insert(address);
                (Block::Other, address)
            }
        }
    }

    /// A read by the program.
    pub fn read(&mut self, address: u32, size: usize) -> u32 {
        let now = self.core.now;
        let word = match address & !3 {
            system if system >= 0xe000_0000 => self.read_system(system),
            rom @ 0x1fff_7000..0x1fff_8000 => self.board.system_memory(rom),
            register => {
                let (block, offset) = self.find(register);
                let value = self.peripheral(block).read(offset, now);
                let value = self.board.read_back(register, value);
                self.refresh();
                value
            }
        };
        let shifted = word >> (8 * (address & 3));
        match size {
            1 => shifted & 0xff,
            2 => shifted & 0xffff,
            _ => shifted,
        }
    }

    /// A write by the program.
    pub fn write(&mut self, address: u32, value: u32, size: usize) {
        let now = self.core.now;
        if address >= 0xe000_0000 {
            self.write_system(address, value, size);
        } else {
            let (block, offset) = self.find(address & !3);
            let shift = 8 * (address & 3);
            if block == Block::Tim1 {
                // What changes the bridge changes it from now on.
                self.drive_world();
            }
            self.peripheral(block)
                .write(offset & !3, value << shift, now);
            self.after_write(block);
        }
        self.refresh();
        self.core.limit = self.core.limit.min(self.next_event());
    }

    /// What a write has changed elsewhere.
    fn after_write(&mut self, block: Block) {
        match block {
            Block::AdcCommon => {
                let common = self.plain[0].get(0x08);
                self.adcs.iter_mut().for_each(|adc| adc.set_common(common));
            }
            Block::Port(_) => {
                if let Some((port, pin)) = self.board.chip_select {
                    let level = self.ports[port].level(pin);
                    self.spi3.set_select(level);
                }
            }
            Block::Pwr => self.exti.set_detector(self.pwr.is_low()),
            Block::Tim1 => self.drive_world(),
            Block::Rcc => self.wwdg.set_clock(self.rcc.wwdg_hz(), self.core.now),
            _ => {}
        }
        if self.flash.busy_until() > self.core.now {
            self.core.interrupted = true;
        }
    }

    /// A store to the flash memory.
    pub fn store_to_flash(&mut self, address: u32, before: u32, value: u32) {
        let now = self.core.now;
        self.flash.store(address, value, now);
        // The memory must not keep what Unicorn stores: undone, or done rightly, at the next boundary.
        self.flash.stores.push((address, before));
        self.core.interrupted = true;
    }

    /// Tells the world what the bridge does from now on.
    fn drive_world(&mut self) {
        let now = self.core.now;
        let duty = self.bridge.duty();
        self.world.drive(now, duty);
    }

    /// Levels of all interrupt lines; stops the processor where something is to be delivered.
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

    /// When something next happens by itself.
    #[must_use]
    pub fn next_event(&self) -> u64 {
        let timers = self
            .timers
            .iter()
            .map(Peripheral::next_event)
            .min()
            .unwrap_or(NEVER);
        let adcs = self
            .adcs
            .iter()
            .map(Peripheral::next_event)
            .min()
            .unwrap_or(NEVER);
        let ports = self.lpuart1.next_event().min(self.usart2.next_event());
        let slow = self
            .rcc
            .next_event()
            .min(self.iwdg.next_event())
            .min(self.wwdg.next_event())
            .min(self.flash.next_event());
        let storm = self.storm.map_or(NEVER, |(_, _, next)| next);
        let fast = self.bridge.next_event().min(self.spi3.next_event());
        timers.min(adcs).min(ports).min(slow).min(fast).min(storm)
    }

    /// Does what is due by now.
    pub fn advance(&mut self) {
        let now = self.core.now;
        // In the order of time: what a converter sees depends on what the bridge did before.
        while let Some((time, edge)) = self.bridge.next_edge(now) {
            self.convert(time);
            let triggers = match edge {
                Edge::Trigger => true,
                Edge::Top | Edge::Bottom => {
                    let duty = self.bridge.duty();
                    self.world.drive(time, duty);
                    self.on_period(edge, time);
                    self.bridge.triggers_on_update() && self.bridge.was_update()
                }
            };
            if triggers {
                self.adcs.iter_mut().for_each(|adc| adc.trigger(time));
            }
        }
        self.convert(now);
        self.timers.iter_mut().for_each(|timer| timer.advance(now));
        self.lpuart1.advance(now);
        self.usart2.advance(now);
        self.spi3.advance(now);
        self.rcc.advance(now);
        self.flash.advance(now);
        self.wwdg.set_clock(self.rcc.wwdg_hz(), now);
        if self.wwdg.bites(now) {
            self.reset_request = Some(ResetCause::WindowWatchdog);
        }
        if self.iwdg.bites(now) {
            self.reset_request = Some(ResetCause::Watchdog);
        }
        if let Some((interrupt, period, next)) = &mut self.storm
            && *next <= now
        {
            *next = now + *period;
            self.nvic
                .pend(crate::cpu::nvic::FIRST + *interrupt as usize);
        }
        self.refresh();
        self.core.interrupted = false;
    }

    /// Lets the converters sample and finish what is due by a time.
    fn convert(&mut self, until: u64) {
        loop {
            let next = self
                .adcs
                .iter()
                .map(Peripheral::next_event)
                .min()
                .unwrap_or(NEVER);
            if next > until {
                return;
            }
            for (index, adc) in self.adcs.iter_mut().enumerate() {
                if let Some(channel) = adc.wants(next) {
                    self.world.advance(next);
                    let volts = self.board.analog(index, channel, &self.world);
                    adc.sample(crate::board::code(volts));
                }
                adc.advance(next);
            }
        }
    }

    /// Once a half period: shaft to encoders, break input, supply.
    fn on_period(&mut self, _edge: Edge, now: u64) {
        self.world.advance(now);
        let count = self.board.encoder_count(&self.world);
        for timer in &mut self.timers {
            timer.set_encoder(count);
        }
        if let Some(slave) = &mut self.spi3.slave {
            slave.set_angle(self.world.turns());
        }
        self.update_break(now);
    }

    /// A handler begins.
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
    }

    /// A handler ends; `None` if none runs.
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
        Some(())
    }

    /// Value of the DAC's channel 1, 12 bits.
    #[must_use]
    pub fn dac(&self) -> u32 {
        let dac = &self.plain[1];
        // Enabled: DHR12R1.
        if dac.get(0x00) & 1 != 0 {
            dac.get(0x08) & 0xfff
        } else {
            0
        }
    }

    /// A port.
    pub fn port(&mut self, index: usize) -> &mut Port {
        &mut self.ports[index]
    }
}
