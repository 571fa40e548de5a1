//! TIM2 to TIM5: an up-counter with four compare channels, or a counter that follows a quadrature encoder.

use super::super::plain::Plain;
use super::super::{NEVER, Peripheral};
use super::{ARR, CCR1, CCR4, CEN, CNT, CR1, DIER, EGR, PSC, SMCR, SR};

/// A general-purpose timer, TIM2 to TIM5.
#[derive(Debug, Clone)]
pub struct Timer {
    interrupt: u32,
    mask: u32,
    registers: Plain,
    /// Clock divider in use. A value written to PSC takes effect at the next update event.
    prescaler: u64,
    count: u64,
    /// Time in processor cycles at which the counter had the value `count`.
    since: u64,
    status: u32,
    /// Last count of the encoder. If the timer follows the encoder, its counter moves by the same differences.
    encoder: i64,
}

impl Timer {
    /// A timer with this interrupt number, whose counter has this width in bits.
    #[must_use]
    pub fn new(interrupt: u32, bits: u32) -> Self {
        let mask = (u64::MAX >> (64 - bits)) as u32;
        Self {
            interrupt,
            mask,
            registers: Plain::default().with(ARR, mask),
            prescaler: 1,
            count: 0,
            since: 0,
            status: 0,
            encoder: 0,
        }
    }

    fn follows_encoder(&self) -> bool {
        matches!(self.registers.get(SMCR) & 0x1_0007, 1..=3) && self.registers.get(CR1) & CEN != 0
    }

    fn counts(&self) -> bool {
        self.registers.get(CR1) & CEN != 0 && !self.follows_encoder()
    }

    fn period(&self) -> u64 {
        u64::from(self.registers.get(ARR) & self.mask) + 1
    }

    /// Sets a new encoder count. If the timer follows the encoder, its counter moves by the difference.
    pub fn set_encoder(&mut self, count: i64) {
        let moved = count - self.encoder;
        self.encoder = count;
        if self.follows_encoder() {
            let period = self.period() as i64;
            self.count = (self.count as i64 + moved).rem_euclid(period) as u64;
        }
    }

    /// Number of timer ticks until the counter reaches `value`, at least 1.
    fn ticks_to(&self, value: u64) -> u64 {
        let period = self.period();
        let value = value % period;
        (value + period - self.count % period - 1) % period + 1
    }

    fn sync(&mut self, now: u64) {
        if !self.counts() {
            self.since = now;
            return;
        }
        let ticks = (now - self.since) / self.prescaler;
        if ticks == 0 {
            return;
        }
        self.since += ticks * self.prescaler;
        if ticks >= self.ticks_to(0) {
            self.status |= 1;
        }
        for channel in 0..4 {
            let compare = u64::from(self.registers.get(CCR1 + 4 * channel) & self.mask);
            if compare < self.period() && ticks >= self.ticks_to(compare) {
                self.status |= 2 << channel;
            }
        }
        self.count = (self.count + ticks) % self.period();
    }
}

impl Peripheral for Timer {
    fn read(&mut self, offset: u32, now: u64) -> u32 {
        self.sync(now);
        match offset {
            SR => self.status,
            CNT => self.count as u32,
            EGR => 0,
            _ => self.registers.get(offset),
        }
    }

    fn write(&mut self, offset: u32, value: u32, now: u64) {
        self.sync(now);
        match offset {
            // A written zero clears the flag, a one leaves it.
            SR => self.status &= value,
            CNT => {
                self.count = u64::from(value & self.mask);
                self.since = now;
            }
            EGR if value & 1 != 0 => {
                self.count = 0;
                self.since = now;
                self.prescaler = u64::from(self.registers.get(PSC) & 0xffff) + 1;
                // With URS set, only an overflow sets the flag.
                if self.registers.get(CR1) & 4 == 0 {
                    self.status |= 1;
                }
            }
            EGR => self.status |= value & 0x1e,
            _ => self.registers.write(offset, value, now),
        }
    }

    fn next_event(&self) -> u64 {
        if !self.counts() {
            return NEVER;
        }
        let wanted = self.registers.get(DIER) & !self.status;
        let mut ticks = NEVER;
        if wanted & 1 != 0 {
            ticks = self.ticks_to(0);
        }
        for channel in (0..4).filter(|channel| wanted & 2 << channel != 0) {
            let compare = u64::from(self.registers.get(CCR1 + 4 * channel) & self.mask);
            if compare < self.period() {
                ticks = ticks.min(self.ticks_to(compare));
            }
        }
        if ticks == NEVER {
            NEVER
        } else {
            self.since + ticks * self.prescaler
        }
    }

    fn advance(&mut self, now: u64) {
        self.sync(now);
    }

    fn lines(&self) -> u128 {
        let up = self.status & self.registers.get(DIER) & 0x5f != 0;
        u128::from(up) << self.interrupt
    }
}

const _: () = assert!(CCR4 == CCR1 + 12);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_compares_and_wraps() {
        let mut timer = Timer::new(50, 32);
        timer.write(PSC, 169, 0);
        timer.write(ARR, 0xffff, 0);
        timer.write(EGR, 1, 0);
        timer.write(SR, 0, 0);
        timer.write(CCR1, 100, 0);
        timer.write(DIER, 3, 0);
        timer.write(CR1, 1, 1_000);
        assert_eq!(timer.next_event(), 1_000 + 100 * 170);
        assert_eq!(timer.read(CNT, 1_000 + 100 * 170 - 1), 99);
        assert_eq!(timer.lines(), 0);
        timer.advance(1_000 + 100 * 170);
        assert_eq!(timer.lines(), 1 << 50);
        timer.write(SR, !2, 1_000 + 100 * 170);
        assert_eq!(timer.next_event(), 1_000 + 65_536 * 170);
        timer.advance(1_000 + 65_536 * 170);
        assert_eq!(timer.read(SR, 1_000 + 65_536 * 170) & 3, 1);
    }

    #[test]
    fn follows_an_encoder_through_its_wrap() {
        let mut timer = Timer::new(28, 16);
        timer.set_encoder(1_000);
        timer.write(SMCR, 3, 0);
        timer.write(CR1, 1, 0);
        timer.set_encoder(997);
        assert_eq!(timer.read(CNT, 0), 0xfffd);
        timer.set_encoder(1_001);
        assert_eq!(timer.read(CNT, 0), 1);
    }
}
