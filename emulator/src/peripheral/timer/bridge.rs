//! TIM1: the counter that goes up and down, the compare values of the bridge, the break that switches it off, and the trigger
//! of the converters.

use super::super::plain::Plain;
use super::super::{NEVER, Peripheral};
use super::{
    AF1, ARR, BDTR, CCER, CCMR1, CCMR2, CCR1, CEN, CNT, CR1, CR2, DIER, EGR, PSC, RCR, SR,
};

const MOE: u32 = 1 << 15;
const AOE: u32 = 1 << 14;
const BKP: u32 = 1 << 13;
const BKE: u32 = 1 << 12;
/// What LOCK level 1 protects: dead time, break, its polarity and filter, AOE.
const LOCKED: u32 = 0xff | BKE | BKP | AOE | 0xf << 16;
const BIF: u32 = 1 << 7;
const UIF: u32 = 1;

/// What happens in a period, at a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edge {
    /// The counter is at its top.
    Top,
    /// The counter is at 0.
    Bottom,
    /// The trigger TRGO2 rises.
    Trigger,
}

/// TIM1.
#[derive(Debug, Clone)]
pub struct Bridge {
    registers: Plain,
    /// Compare values and auto-reload in use: those written count from the next update on.
    compare: [u32; 6],
    reload: u64,
    prescaler: u64,
    repetition: u32,
    status: u32,
    main_output: bool,
    /// When the counter was at 0 last.
    bottom: u64,
    /// Cycles into the period up to which edges have been handed out.
    done: u64,
    break_pin: bool,
    comparators: u32,
    /// Each change of MOE: when, and whether on.
    pub changes: Vec<(u64, bool)>,
}

impl Default for Bridge {
    fn default() -> Self {
        Self {
            registers: Plain::default().with(ARR, 0xffff),
            compare: [0; 6],
            reload: 0xffff,
            prescaler: 1,
            repetition: 0,
            status: 0,
            main_output: false,
            bottom: 0,
            done: 0,
            // Pulled up: the break input is active low on the boards that use it.
            break_pin: true,
            comparators: 0,
            changes: Vec::new(),
        }
    }
}

impl Bridge {
    /// Whether MOE is set.
    #[must_use]
    pub fn is_on(&self) -> bool {
        self.main_output
    }

    /// Duty of the three phases, 0 to 1, as it counts now; `None` where the phase is not driven.
    #[must_use]
    pub fn duty(&self) -> [Option<f64>; 3] {
        let enabled = self.registers.get(CCER);
        [0, 1, 2].map(|phase| {
            // The upper and the complementary lower output of the phase.
            let driven = self.main_output && enabled >> (4 * phase) & 5 == 5;
            let compare = f64::from(self.compare[phase]) / self.reload.max(1) as f64;
            driven.then(|| compare.min(1.0))
        })
    }

    /// Cycles of a period: up and down.
    #[must_use]
    pub fn period(&self) -> u64 {
        2 * self.reload.max(1) * self.prescaler
    }

    fn runs(&self) -> bool {
        self.registers.get(CR1) & CEN != 0
    }

    /// Level of the pin BKIN, and the active comparators as a mask.
    pub fn set_break(&mut self, pin: bool, comparators: u32, now: u64) {
        self.break_pin = pin;
        self.comparators = comparators;
        self.look_at_break(now);
    }

    /// A source inside of the chip pulls the break.
    pub fn pull_break(&mut self, now: u64) {
        if self.registers.get(BDTR) & BKE != 0 {
            self.status |= BIF;
            self.set_main_output(false, now);
        }
    }

    fn break_is_active(&self) -> bool {
        let bdtr = self.registers.get(BDTR);
        let sources = self.registers.get(AF1);
        let active_high = bdtr & BKP != 0;
        let inverted = sources >> 9 & 1 != 0;
        let pin = sources & 1 != 0 && self.break_pin == (active_high != inverted);
        let comparators = self.comparators & (sources >> 1 & 15);
        bdtr & BKE != 0 && (pin || comparators != 0 && active_high)
    }

    fn look_at_break(&mut self, now: u64) {
        if self.break_is_active() {
            self.status |= BIF;
            self.set_main_output(false, now);
        }
    }

    fn set_main_output(&mut self, on: bool, now: u64) {
        if on != self.main_output {
            self.main_output = on;
            self.changes.push((now, on));
        }
    }

    fn update(&mut self) {
        for (channel, compare) in self.compare.iter_mut().enumerate() {
            // CCR5 and CCR6 are elsewhere and not used.
            *compare = self.registers.get(CCR1 + 4 * channel as u32) & 0xffff;
        }
        self.reload = u64::from(self.registers.get(ARR) & 0xffff);
        self.prescaler = u64::from(self.registers.get(PSC) & 0xffff) + 1;
        self.repetition = self.registers.get(RCR);
    }

    fn overflow(&mut self) -> bool {
        if self.repetition > 0 {
            self.repetition -= 1;
            return false;
        }
        self.update();
        self.status |= UIF;
        true
    }

    /// Mode of a channel, 0 to 15.
    fn mode(&self, channel: u32) -> u32 {
        let register = self.registers.get(if channel < 2 { CCMR1 } else { CCMR2 });
        let field = register >> (8 * (channel % 2));
        (field >> 4 & 7) | (field >> 13 & 8)
    }

    /// Cycles into the period at which TRGO2 rises, where that is not the update.
    fn trigger_at(&self) -> Option<u64> {
        // OC1REF to OC4REF.
        let channel = match self.registers.get(CR2) >> 20 & 15 {
            select @ 4..=7 => select - 4,
            _ => return None,
        };
        let compare = u64::from(self.compare[channel as usize]);
        let top = self.reload.max(1);
        let count = match self.mode(channel) {
            // PWM mode 1 rises on the way down, mode 2 on the way up.
            6 if compare < top => 2 * top - compare,
            7 if compare < top => compare,
            _ => return None,
        };
        Some(count * self.prescaler)
    }

    fn edges(&self) -> [(u64, Edge); 3] {
        let trigger = self.trigger_at().unwrap_or(NEVER);
        let mut edges = [
            (self.period() / 2, Edge::Top),
            (self.period(), Edge::Bottom),
            (trigger, Edge::Trigger),
        ];
        edges.sort_by_key(|(at, _)| *at);
        edges
    }

    /// The next edge that is due, with its time. At an edge that is an update and triggers, [`Edge::Trigger`] follows.
    pub fn next_edge(&mut self, now: u64) -> Option<(u64, Edge)> {
        if !self.runs() {
            return None;
        }
        let (at, edge) = *self
            .edges()
            .iter()
            .find(|(at, _)| *at > self.done && *at != NEVER)?;
        let time = self.bottom + at;
        if time > now {
            return None;
        }
        self.done = at;
        match edge {
            Edge::Trigger => {}
            Edge::Top => {
                self.overflow();
            }
            Edge::Bottom => {
                self.bottom = time;
                self.done = 0;
                self.overflow();
            }
        }
        Some((time, edge))
    }

    /// Cycles from the last bottom.
    fn position(&self, now: u64) -> u64 {
        if self.runs() {
            (now - self.bottom) % self.period()
        } else {
            0
        }
    }
}

impl Peripheral for Bridge {
    fn read(&mut self, offset: u32, now: u64) -> u32 {
        let down = self.position(now) >= self.period() / 2;
        match offset {
            CR1 => (self.registers.get(CR1) & !0x10) | u32::from(down) << 4,
            SR => self.status,
            BDTR => (self.registers.get(BDTR) & !MOE) | u32::from(self.main_output) << 15,
            CNT => {
                let count = self.position(now) / self.prescaler;
                let top = self.reload.max(1);
                (if down { 2 * top - count } else { count }) as u32
            }
            EGR => 0,
            _ => self.registers.get(offset),
        }
    }

    fn write(&mut self, offset: u32, value: u32, now: u64) {
        match offset {
            SR => self.status &= value,
            EGR => {
                if value & 1 != 0 {
                    self.update();
                    self.bottom = now;
                    self.done = 0;
                    self.status |= UIF;
                }
                if value & 0x80 != 0 {
                    self.status |= BIF;
                    self.set_main_output(false, now);
                }
            }
            CR1 => {
                if !self.runs() && value & CEN != 0 {
                    self.bottom = now;
                    self.done = 0;
                }
                self.registers.write(CR1, value, now);
            }
            BDTR => {
                let before = self.registers.get(BDTR);
                let locked = before >> 8 & 3 != 0;
                let keep = if locked { LOCKED | 0x300 } else { 0 };
                let value = (value & !keep) | (before & keep);
                self.registers.write(BDTR, value & !MOE, now);
                self.set_main_output(value & MOE != 0 && !self.break_is_active(), now);
            }
            _ => {
                self.registers.write(offset, value, now);
                // Without preload a compare value counts at once.
                let channel = offset.wrapping_sub(CCR1) / 4;
                if channel < 4 {
                    let register = self.registers.get(if channel < 2 { CCMR1 } else { CCMR2 });
                    if register >> (8 * (channel % 2) + 3) & 1 == 0 {
                        self.compare[channel as usize] = value & 0xffff;
                    }
                }
            }
        }
        self.look_at_break(now);
    }

    fn next_event(&self) -> u64 {
        if !self.runs() {
            return NEVER;
        }
        let next = self
            .edges()
            .into_iter()
            .find(|(at, _)| *at > self.done && *at != NEVER);
        next.map_or(NEVER, |(at, _)| self.bottom + at)
    }

    fn lines(&self) -> u128 {
        let up = self.status & self.registers.get(DIER);
        // Break, update, compare.
        u128::from(up & (BIF | 0x100) != 0) << 24
            | u128::from(up & UIF != 0) << 25
            | u128::from(up & 0x1e != 0) << 27
    }
}

/// Whether the selected trigger is the update.
impl Bridge {
    /// Whether an update raises TRGO2.
    #[must_use]
    pub fn triggers_on_update(&self) -> bool {
        self.registers.get(CR2) >> 20 & 15 == 2
    }

    /// Whether the last edge at the top or bottom was an update: the repetition counter was reloaded by it.
    #[must_use]
    pub fn was_update(&self) -> bool {
        self.repetition == self.registers.get(RCR)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn started() -> Bridge {
        let mut tim = Bridge::default();
        tim.write(CR2, 7 << 20, 0);
        tim.write(ARR, 4_250, 0);
        tim.write(CCMR1, 0x6868, 0);
        tim.write(CCMR2, 0x7868, 0);
        tim.write(CCR1, 2_125, 0);
        tim.write(0x40, 4_230, 0);
        tim.write(CCER, 0x555, 0);
        tim.write(AF1, 1, 0);
        tim.write(BDTR, BKE | 1 << 8 | 85, 0);
        tim.write(EGR, 1, 0);
        tim.write(SR, 0, 0);
        tim.write(DIER, 1 << 7, 0);
        tim.write(CR1, CEN | 1 << 5, 100);
        tim
    }

    #[test]
    fn edges_come_in_order_and_the_trigger_before_the_top() {
        let mut tim = started();
        let mut edges = Vec::new();
        while let Some(edge) = tim.next_edge(100 + 17_000) {
            edges.push(edge);
        }
        assert_eq!(
            edges,
            [
                (4_330, Edge::Trigger),
                (4_350, Edge::Top),
                (8_600, Edge::Bottom),
                (12_830, Edge::Trigger),
                (12_850, Edge::Top),
                (17_100, Edge::Bottom),
            ]
        );
        assert_eq!(tim.read(CNT, 17_100 + 4_260), 4_240);
        assert_eq!(tim.read(CR1, 17_100 + 4_260) & 0x10, 0x10);
    }

    #[test]
    fn duty_counts_from_the_next_update_on() {
        let mut tim = started();
        tim.write(BDTR, BKE | MOE, 0);
        assert_eq!(tim.duty()[0], Some(0.5));
        tim.write(CCR1, 4_250, 200);
        assert_eq!(tim.duty()[0], Some(0.5));
        while tim.next_edge(4_350).is_some() {}
        assert_eq!(tim.duty()[0], Some(1.0));
    }

    #[test]
    fn the_break_switches_off_and_holds_off() {
        let mut tim = started();
        tim.write(BDTR, MOE, 200);
        assert!(tim.is_on());
        tim.set_break(false, 0, 300);
        assert!(!tim.is_on());
        assert_eq!(tim.lines(), 1 << 24);
        tim.write(BDTR, MOE, 400);
        assert!(!tim.is_on(), "not while the break is active");
        tim.set_break(true, 0, 500);
        assert!(!tim.is_on(), "not by itself");
        tim.write(SR, !BIF, 600);
        tim.write(BDTR, MOE, 600);
        assert!(tim.is_on());
        assert_eq!(tim.changes, [(200, true), (300, false), (600, true)]);
    }
}
