//! TIM1: the centre-aligned counter, the compare values of the bridge, the break that switches the bridge off, and the trigger of
//! the analogue-to-digital converters.

use super::super::plain::Plain;
use super::super::{NEVER, Peripheral};
use super::gates::{GateDriver, Leg};
use super::{
    AF1, ARR, BDTR, CCER, CCMR1, CCMR2, CCR1, CEN, CNT, CR1, CR2, DIER, EGR, PSC, RCR, SR,
};

const MOE: u32 = 1 << 15;
const AOE: u32 = 1 << 14;
const BKP: u32 = 1 << 13;
const BKE: u32 = 1 << 12;
const OSSR: u32 = 1 << 11;
const OSSI: u32 = 1 << 10;
/// Bits of the register BDTR that LOCK level 1 protects: dead time, break enable, break polarity, break filter, AOE (automatic
/// output enable). The level also protects the idle levels in CR2.
const LOCKED: u32 = 0xff | BKE | BKP | AOE | 0xf << 16;
const IDLE_LEVELS: u32 = 0x3f << 8;
/// Further bits of the register BDTR that LOCK level 2 protects: the behaviour of idle outputs. The level also protects the output
/// polarities in CCER.
const LOCKED_2: u32 = OSSI | OSSR;
const POLARITY: u32 = 0xaaa;
const BIF: u32 = 1 << 7;
/// Flag that the system break has occurred. It "must be reset to re-start PWM operation" (RM0440, TIM1_SR).
const SBIF: u32 = 1 << 13;
const UIF: u32 = 1;

/// Cycles of the timer's clock for which the break input must be active without a gap before it acts. BDTR.BKF gives a number of
/// samples and their rate: the timer's clock or the dead-time clock set by CR1.CKD (RM0440 Rev 4, p. 1209). 0 means at once,
/// without a clock.
///
/// The break input `tim_brk` combines the pin and the comparators. That the filter acts on the combined signal is taken from memory
/// of a figure in the manual.
fn filter_cycles(bdtr: u32, cr1: u32) -> u64 {
    const BY_CODE: [(u64, u64); 16] = [
        (1, 0),
        (1, 2),
        (1, 4),
        (1, 8),
        (2, 6),
        (2, 8),
        (4, 6),
        (4, 8),
        (8, 6),
        (8, 8),
        (16, 5),
        (16, 6),
        (16, 8),
        (32, 5),
        (32, 6),
        (32, 8),
    ];
    let code = (bdtr >> 16 & 15) as usize;
    let (every, samples) = BY_CODE[code];
    let division = if code < 4 { 1 } else { 1 << (cr1 >> 8 & 3) };
    every * samples * division
}

/// An event of the timer within a PWM period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edge {
    /// The counter reaches its top.
    Top,
    /// The counter reaches 0.
    Bottom,
    /// The trigger TRGO2, which starts the converters, rises.
    Trigger,
}

/// The timer TIM1, which drives the motor bridge.
#[derive(Debug, Clone)]
pub struct BridgeTimer {
    registers: Plain,
    /// Compare values in use. Values written by the program take effect at the next update event; the same holds for the
    /// auto-reload value.
    compare: [u32; 6],
    reload: u64,
    prescaler: u64,
    repetition: u32,
    status: u32,
    main_output: bool,
    /// Time in processor cycles at which the counter was last at 0.
    bottom: u64,
    /// Cycles since the start of the PWM period up to which [`BridgeTimer::next_edge`] has returned the edges.
    done: u64,
    break_pin: bool,
    comparators: u32,
    /// Time in processor cycles since which the break input has been active without a gap; `None` while it is inactive.
    active_since: Option<u64>,
    /// Whether a source inside the chip raises the system break: low supply, processor lockup, or an error in flash.
    system: bool,
    /// The gate drivers that the timer's outputs control.
    pub gates: GateDriver,
    /// Whether the gate drivers have switched themselves off, independently of their inputs.
    stage_off: bool,
    is_on: bool,
    /// Each change of [`BridgeTimer::is_on`]: the time in processor cycles, and whether the bridge is on from that time.
    pub changes: Vec<(u64, bool)>,
}

impl Default for BridgeTimer {
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
            // The break input's pin is high (pulled up), because the input is active low on the boards that use it.
            break_pin: true,
            comparators: 0,
            active_since: None,
            system: false,
            gates: GateDriver::L6387,
            stage_off: false,
            is_on: false,
            changes: Vec::new(),
        }
    }
}

impl BridgeTimer {
    /// Whether any phase is driven, that is, whether a transistor conducts. The bit MOE alone does not tell this.
    #[must_use]
    pub fn is_on(&self) -> bool {
        self.is_on
    }

    /// Present duty cycle of each phase: fraction of the time (0 to 1) for which it is connected to the bus voltage. `None` where
    /// the phase is not driven.
    #[must_use]
    pub fn duty(&self) -> [Option<f64>; 3] {
        [0, 1, 2].map(|phase| {
            let compare = f64::from(self.compare[phase]) / self.reload.max(1) as f64;
            // OC1REF to OC3REF are high while the counter is below the compare value.
            let leg = |reference| match self.stage_off {
                true => Leg::Open,
                false => self.gates.leg(self.wired(phase, reference)),
            };
            let (first, second) = (leg(true), leg(false));
            GateDriver::share(first, second, compare.min(1.0))
        })
    }

    /// Levels at the two driver inputs of a phase while its PWM reference is high or low; `None` where the timer does not drive the
    /// pins.
    fn wired(&self, phase: usize, reference: bool) -> Option<(bool, bool)> {
        let (first, second) = self.levels(phase, reference)?;
        match self.gates {
            GateDriver::Drv8313 => self.levels(0, reference).map(|(_, enable)| (first, enable)),
            _ => Some((first, second)),
        }
    }

    /// Levels of the two timer outputs of a phase while its PWM reference is high or low (RM0440, table 265). `None` where the
    /// timer does not drive both outputs.
    fn levels(&self, phase: usize, reference: bool) -> Option<(bool, bool)> {
        let outputs = self.registers.get(CCER) >> (4 * phase);
        let bdtr = self.registers.get(BDTR);
        // Level of an inactive output: the bit of its polarity.
        let inactive = (outputs & 2 != 0, outputs & 8 != 0);
        if self.main_output {
            match outputs & 5 {
                5 => Some((reference != inactive.0, reference == inactive.1)),
                // Only one output of the pair is enabled. With OSSR the other one is held at its inactive level.
                1 if bdtr & OSSR != 0 => Some((reference != inactive.0, inactive.1)),
                4 if bdtr & OSSR != 0 => Some((inactive.0, reference != inactive.1)),
                _ => None,
            }
        } else {
            let idle = self.registers.get(CR2) >> (8 + 2 * phase);
            let drives = bdtr & OSSI != 0 && outputs & 5 != 0;
            drives.then_some((idle & 1 != 0, idle & 2 != 0))
        }
    }

    /// Processor cycles per PWM period: counting up and down.
    #[must_use]
    pub fn period(&self) -> u64 {
        2 * self.reload.max(1) * self.prescaler
    }

    fn runs(&self) -> bool {
        self.registers.get(CR1) & CEN != 0
    }

    /// Sets the level of the break pin BKIN and the output levels of the comparators, one bit per comparator.
    pub fn set_break(&mut self, pin: bool, comparators: u32, now: u64) {
        self.break_pin = pin;
        self.comparators = comparators;
        self.look_at_break(now);
    }

    /// Sets whether the gate drivers have switched themselves off.
    pub fn set_stage_off(&mut self, off: bool, now: u64) {
        self.stage_off = off;
        self.note(now);
    }

    /// Sets whether a source inside the chip raises the system break, as enabled in SYSCFG_CFGR2. The system break depends neither
    /// on the enable bit BKE nor on a polarity (RM0440, "Using the break function").
    pub fn set_system_break(&mut self, active: bool, now: u64) {
        self.system = active;
        self.look_at_break(now);
    }

    fn break_is_active(&self) -> bool {
        let bdtr = self.registers.get(BDTR);
        let sources = self.registers.get(AF1);
        let active_high = bdtr & BKP != 0;
        let inverted = sources >> 9 & 1 != 0;
        let pin = sources & 1 != 0 && self.break_pin == (active_high != inverted);
        // BKCMP1P to BKCMP4P invert the level of a comparator.
        let levels = self.comparators ^ (sources >> 10 & 15);
        let active = if active_high { levels } else { !levels };
        bdtr & BKE != 0 && (pin || active & (sources >> 1 & 15) != 0)
    }

    /// Time in processor cycles at which the active break input passes the break filter; `None` while the input is inactive.
    fn passes_at(&self) -> Option<u64> {
        let filter = filter_cycles(self.registers.get(BDTR), self.registers.get(CR1));
        Some(self.active_since? + filter)
    }

    /// Checks at the time `now` whether the break input has passed its filter. Returns whether the break has just switched the
    /// outputs off.
    pub fn pass(&mut self, now: u64) -> bool {
        let was_on = self.main_output;
        self.look_at_break(now);
        was_on && !self.main_output
    }

    fn look_at_break(&mut self, now: u64) {
        self.active_since = match self.break_is_active() {
            true => Some(self.active_since.unwrap_or(now)),
            false => None,
        };
        let passed = self.passes_at().is_some_and(|at| at <= now);
        let pulls = [(passed, BIF), (self.system, SBIF)];
        for (_, flag) in pulls.into_iter().filter(|(pulls, _)| *pulls) {
            self.status |= flag;
            self.set_main_output(false, now);
        }
    }

    /// Whether the timer accepts a write of 1 to MOE (main output enable): no break is active, and SBIF, the flag of the system
    /// break, is clear.
    fn may_start(&self, now: u64) -> bool {
        let is_pulled = self.passes_at().is_some_and(|at| at <= now);
        !is_pulled && !self.system && self.status & SBIF == 0
    }

    fn set_main_output(&mut self, on: bool, now: u64) {
        self.main_output = on;
        self.note(now);
    }

    /// Adds an entry to `changes` if the bridge has gone on or off.
    fn note(&mut self, now: u64) {
        let on = self.duty().iter().any(Option::is_some);
        if on != self.is_on {
            self.is_on = on;
            self.changes.push((now, on));
        }
    }

    /// The value that a register gets by a write of `value`: bits that the timer's LOCK level protects keep their old value.
    fn unlocked(&self, offset: u32, value: u32) -> u32 {
        let level = self.registers.get(BDTR) >> 8 & 3;
        let kept = match (offset, level) {
            (_, 0) => 0,
            (BDTR, 1) => LOCKED | 0x300,
            (BDTR, _) => LOCKED | LOCKED_2 | 0x300,
            (CR2, _) => IDLE_LEVELS,
            (CCER, 2..) => POLARITY,
            _ => 0,
        };
        (value & !kept) | (self.registers.get(offset) & kept)
    }

    fn update(&mut self) {
        for (channel, compare) in self.compare.iter_mut().enumerate() {
            // CCR5 and CCR6 are at other addresses and are not used.
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

    /// Output compare mode (OCxM) of a channel, 0 to 15.
    fn mode(&self, channel: u32) -> u32 {
        let register = self.registers.get(if channel < 2 { CCMR1 } else { CCMR2 });
        let field = register >> (8 * (channel % 2));
        (field >> 4 & 7) | (field >> 13 & 8)
    }

    /// Cycles since the start of the PWM period at which TRGO2 rises; `None` where the update event raises it.
    fn trigger_at(&self) -> Option<u64> {
        // OC1REF to OC4REF.
        let channel = match self.registers.get(CR2) >> 20 & 15 {
            select @ 4..=7 => select - 4,
            _ => return None,
        };
        let compare = u64::from(self.compare[channel as usize]);
        let top = self.reload.max(1);
        let count = match self.mode(channel) {
            // The reference signal rises while the counter counts down in PWM mode 1, and while it counts up in mode 2.
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

    /// Returns the next edge that is due by `now`, with its time in processor cycles. After an edge with an update event that
    /// raises TRGO2, [`Edge::Trigger`] follows.
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

    /// Processor cycles since the timer's counter was last at 0.
    fn position(&self, now: u64) -> u64 {
        if self.runs() {
            (now - self.bottom) % self.period()
        } else {
            0
        }
    }
}

impl Peripheral for BridgeTimer {
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
                let value = self.unlocked(BDTR, value);
                self.registers.write(BDTR, value & !MOE, now);
                self.set_main_output(value & MOE != 0 && self.may_start(now), now);
            }
            _ => {
                let value = self.unlocked(offset, value);
                self.registers.write(offset, value, now);
                // Without preload a compare value takes effect at once.
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
        self.note(now);
    }

    fn next_event(&self) -> u64 {
        let waits = self.main_output || self.status & BIF == 0;
        let passes = self.passes_at().filter(|_| waits).unwrap_or(NEVER);
        if !self.runs() {
            return passes;
        }
        let next = self
            .edges()
            .into_iter()
            .find(|(at, _)| *at > self.done && *at != NEVER);
        passes.min(next.map_or(NEVER, |(at, _)| self.bottom + at))
    }

    fn lines(&self) -> u128 {
        let up = self.status & self.registers.get(DIER);
        // Break, update, compare.
        u128::from(self.breaks_interrupt()) << 24
            | u128::from(up & UIF != 0) << 25
            | u128::from(up & 0x1e != 0) << 27
    }
}

impl BridgeTimer {
    /// Whether a break now raises an interrupt: one of the flags BIF, B2IF and SBIF is set, and the enable bit BIE that they share.
    fn breaks_interrupt(&self) -> bool {
        self.registers.get(DIER) & BIF != 0 && self.status & (BIF | 0x100 | SBIF) != 0
    }

    /// Whether the update event raises TRGO2.
    #[must_use]
    pub fn triggers_on_update(&self) -> bool {
        self.registers.get(CR2) >> 20 & 15 == 2
    }

    /// Whether the last edge, [`Edge::Top`] or [`Edge::Bottom`], was an update event, which reloads the repetition counter.
    #[must_use]
    pub fn was_update(&self) -> bool {
        self.repetition == self.registers.get(RCR)
    }
}

mod pins;
#[cfg(test)]
mod tests;
