//! Events that need no instruction: the switching edges of the power bridge, the conversions that the edges trigger, and all other
//! timed events.

use super::Chip;
use crate::peripheral::rcc::ResetCause;
use crate::peripheral::timer::bridge::Edge;
use crate::peripheral::{NEVER, Peripheral};

/// Time between two simulation steps of a short circuit's current, in processor cycles.
const LOOK: u64 = 4;

impl Chip {
    /// Time of the next event, in processor cycles.
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
        // The current of a short circuit rises fast, so it is checked as often as the instructions allow.
        let short = match self.world.short {
            Some(short) if self.bridge.is_on() || short.current_a != 0.0 => self.core.now + LOOK,
            _ => NEVER,
        };
        timers
            .min(short)
            .min(adcs)
            .min(ports)
            .min(slow)
            .min(fast)
            .min(storm)
    }

    /// Carries out all events that are due at the present time.
    pub fn advance(&mut self) {
        let now = self.core.now;
        // Events are handled in the order of their times, because a converter's sample depends on the bridge's earlier switching.
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
        if self.bridge.pass(now) {
            self.drive_world();
        }
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
        if self.world.short.is_some() {
            self.advance_short(now);
        }
        self.refresh();
        self.core.interrupted = false;
    }

    /// Advances the current of a short circuit with the present states of the transistors, and updates the comparators.
    fn advance_short(&mut self, now: u64) {
        let legs = self.bridge.legs(now);
        self.world.advance_short(now, legs);
        self.update_break(now);
        self.drive_world();
    }

    /// Lets the analog-to-digital converters sample and finish all conversions that are due until a time.
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
            let amplifies = [0, 1, 2].map(|amplifier| self.amplifies(amplifier));
            for (index, adc) in self.adcs.iter_mut().enumerate() {
                if let Some(channel) = adc.wants(next) {
                    self.world.advance(next);
                    let volts = match self.board.amplifier(index, channel) {
                        Some(amplifier) if !amplifies[amplifier] => 0.0,
                        _ => self.board.analog(index, channel, &self.world),
                    };
                    let noise = self.world.sensors.converter_codes();
                    adc.sample(crate::board::code_with(volts, noise));
                }
                adc.advance(next);
            }
        }
    }

    /// Runs twice per PWM period: moves the simulated world on, and passes the shaft's angle to the encoders and the levels to the
    /// break input.
    fn on_period(&mut self, _edge: Edge, now: u64) {
        self.world.advance(now);
        self.world.sensors.look();
        let count = self.board.encoder_count(&self.world);
        for timer in &mut self.timers {
            timer.set_encoder(count);
        }
        if let Some(slave) = &mut self.spi3.slave {
            slave.set_angle(self.world.encoder_turns());
        }
        self.update_break(now);
    }
}
