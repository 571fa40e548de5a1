//! An analogue-to-digital converter: power-up, calibration, injected sequences that a trigger starts, and single regular
//! conversions that software starts.
//!
//! The board supplies the channel's voltage at the end of the sampling time, so a code is as old as on the real chip.

use super::plain::Plain;
use super::{CYCLES_PER_US, NEVER, Peripheral};

const ISR: u32 = 0x00;
const IER: u32 = 0x04;
const CR: u32 = 0x08;
const SMPR1: u32 = 0x14;
const SMPR2: u32 = 0x18;
const SQR1: u32 = 0x30;
const DR: u32 = 0x40;
const JSQR: u32 = 0x4c;
const JDR1: u32 = 0x80;

const ADRDY: u32 = 1;
const EOC: u32 = 1 << 2;
const EOS: u32 = 1 << 3;
const JEOC: u32 = 1 << 5;
const JEOS: u32 = 1 << 6;

const ADEN: u32 = 1;
const ADDIS: u32 = 1 << 1;
const ADSTART: u32 = 1 << 2;
const JADSTART: u32 = 1 << 3;
const STOPS: u32 = 1 << 4 | 1 << 5;
const ADCAL: u32 = 1 << 31;

/// Sampling times of the codes 0 to 7 in half cycles of the converter's clock.
const SAMPLING: [u64; 8] = [5, 13, 25, 49, 95, 185, 495, 1281];
/// Duration of the 12-bit successive approximation in half cycles of the converter's clock.
const APPROXIMATION: u64 = 25;
/// Time from the trigger to the start of sampling in half cycles of the converter's clock.
const LATENCY: u64 = 6;
/// Code that selects TIM1_TRGO2 as the trigger of the injected sequence.
const TRGO2: u32 = 8;

/// A running sequence of conversions.
#[derive(Debug, Clone, Copy)]
struct Sequence {
    injected: bool,
    rank: u32,
    /// Time in processor cycles at which the sampling of the present conversion ends.
    sampled: u64,
    done: u64,
    /// Converted code of the present conversion in the sequence; `None` until its sampling has ended.
    code: Option<u16>,
}

/// An analogue-to-digital converter.
#[derive(Debug, Clone)]
pub struct Adc {
    registers: Plain,
    status: u32,
    control: u32,
    /// Processor cycles per half cycle of the converter's clock.
    half_cycle: u64,
    /// Operations that will complete: (time in processor cycles, bits of CR to clear, bits of ISR to set).
    completes: Vec<(u64, u32, u32)>,
    running: Option<Sequence>,
    injected: [u16; 4],
    regular: u16,
    /// Number of the interrupt that the two converters share.
    interrupt: u32,
    /// Number of triggers that arrived while a sequence was running, and had no effect.
    pub missed: u64,
}

impl Adc {
    /// A converter that raises the interrupt with this number.
    #[must_use]
    pub fn new(interrupt: u32) -> Self {
        Self {
            registers: Plain::default(),
            status: 0,
            // After a reset the converter is in deep power-down (DEEPPWD).
            control: 1 << 29,
            half_cycle: 2,
            completes: Vec::new(),
            running: None,
            injected: [0; 4],
            regular: 0,
            interrupt,
            missed: 0,
        }
    }

    /// Sets the register CCR, which both converters share and which holds the divider of the converters' clock.
    pub fn set_common(&mut self, ccr: u32) {
        const DIVIDERS: [u64; 12] = [1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256];
        let divider = match ccr >> 16 & 3 {
            0 => DIVIDERS[(ccr >> 18 & 15).min(11) as usize],
            mode => 1 << (mode - 1),
        };
        self.half_cycle = divider.div_ceil(2);
    }

    fn channel(&self, injected: bool, rank: u32) -> u32 {
        if injected {
            // JSQ1 to JSQ4, six bits apart.
            return self.registers.get(JSQR) >> (9 + 6 * rank) & 31;
        }
        let slot = rank + 1;
        self.registers.get(SQR1 + 4 * (slot / 5)) >> (6 * (slot % 5)) & 31
    }

    fn length(&self, injected: bool) -> u32 {
        match injected {
            true => (self.registers.get(JSQR) & 3) + 1,
            false => (self.registers.get(SQR1) & 15) + 1,
        }
    }

    fn begin(&mut self, injected: bool, rank: u32, now: u64) {
        let channel = self.channel(injected, rank);
        let register = self.registers.get(if channel < 10 { SMPR1 } else { SMPR2 });
        let sampling = SAMPLING[(register >> (3 * (channel % 10)) & 7) as usize];
        let sampled = now + (LATENCY * u64::from(rank == 0) + sampling) * self.half_cycle;
        let done = sampled + APPROXIMATION * self.half_cycle;
        self.running = Some(Sequence {
            injected,
            rank,
            sampled,
            done,
            code: None,
        });
    }

    /// Handles a rising edge of the trigger TIM1_TRGO2.
    pub fn trigger(&mut self, now: u64) {
        let jsqr = self.registers.get(JSQR);
        let selected = jsqr >> 2 & 31 == TRGO2 && jsqr >> 7 & 3 != 0;
        if self.control & JADSTART == 0 || !selected {
            return;
        }
        match self.running {
            Some(sequence) if sequence.injected => self.missed += 1,
            // On the chip an injected sequence interrupts a regular one, which then starts again. Here the regular one is lost.
            _ => self.begin(true, 0, now),
        }
    }

    /// The channel whose sampling has ended by `now`, if any. The board then supplies its code through [`Adc::sample`].
    #[must_use]
    pub fn wants(&self, now: u64) -> Option<u32> {
        let sequence = self.running?;
        (sequence.code.is_none() && sequence.sampled <= now)
            .then(|| self.channel(sequence.injected, sequence.rank))
    }

    /// The channel that is being sampled or converted, and the time in processor cycles at which its sampling ends.
    #[must_use]
    pub fn sampling(&self) -> Option<(u32, u64)> {
        let sequence = self.running?;
        Some((
            self.channel(sequence.injected, sequence.rank),
            sequence.sampled,
        ))
    }

    /// Stores the code of the channel whose sampling has ended.
    pub fn sample(&mut self, code: u16) {
        if let Some(sequence) = &mut self.running {
            sequence.code = Some(code);
        }
    }

    fn finish(&mut self, now: u64) {
        let Some(sequence) = self.running else { return };
        let Some(code) = sequence.code else { return };
        if sequence.done > now {
            return;
        }
        self.running = None;
        let last = sequence.rank + 1 == self.length(sequence.injected);
        if sequence.injected {
            self.injected[sequence.rank as usize & 3] = code;
            self.status |= JEOC | if last { JEOS } else { 0 };
        } else {
            self.regular = code;
            self.status |= EOC | if last { EOS } else { 0 };
        }
        if !last {
            self.begin(sequence.injected, sequence.rank + 1, sequence.done);
        } else if !sequence.injected {
            self.control &= !ADSTART;
        }
    }
}

impl Peripheral for Adc {
    fn read(&mut self, offset: u32, _now: u64) -> u32 {
        match offset {
            ISR => self.status,
            CR => self.control,
            DR => {
                self.status &= !EOC;
                u32::from(self.regular)
            }
            JDR1..0x90 => u32::from(self.injected[(offset - JDR1) as usize / 4]),
            _ => self.registers.get(offset),
        }
    }

    fn write(&mut self, offset: u32, value: u32, now: u64) {
        match offset {
            // Written ones clear the flags.
            ISR => self.status &= !value,
            CR => {
                // Written ones set these bits, and the converter clears them.
                const SET: u32 = ADEN | ADDIS | ADSTART | JADSTART | STOPS | ADCAL;
                let rising = value & SET & !self.control;
                self.control = (self.control & SET) | value & !SET | rising;
                if rising & ADEN != 0 {
                    self.completes.push((now + CYCLES_PER_US, 0, ADRDY));
                }
                if rising & ADDIS != 0 {
                    self.completes.push((now + 20, ADEN | ADDIS, 0));
                }
                if rising & ADCAL != 0 {
                    self.completes
                        .push((now + 116 * 2 * self.half_cycle, ADCAL, 0));
                }
                if rising & STOPS != 0 {
                    self.running = None;
                    self.completes
                        .push((now + 10, STOPS | ADSTART | JADSTART, 0));
                }
                let software = self.registers.get(JSQR) >> 7 & 3 == 0;
                if rising & ADSTART != 0 {
                    self.begin(false, 0, now);
                } else if rising & JADSTART != 0 && software {
                    self.begin(true, 0, now);
                }
            }
            _ => self.registers.write(offset, value, now),
        }
    }

    fn next_event(&self) -> u64 {
        let completes = self
            .completes
            .iter()
            .map(|(time, ..)| *time)
            .min()
            .unwrap_or(NEVER);
        let sequence = self.running.map_or(NEVER, |sequence| match sequence.code {
            None => sequence.sampled,
            Some(_) => sequence.done,
        });
        completes.min(sequence)
    }

    fn advance(&mut self, now: u64) {
        if self.completes.iter().any(|(time, ..)| *time <= now) {
            for (_, clear, set) in self.completes.iter().filter(|(time, ..)| *time <= now) {
                self.control &= !clear;
                self.status |= set;
            }
            self.completes.retain(|(time, ..)| *time > now);
        }
        self.finish(now);
    }

    fn lines(&self) -> u128 {
        let up = self.status & self.registers.get(IER) & 0x7ff != 0;
        u128::from(up) << self.interrupt
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_injected_sequence_takes_its_time() {
        let mut adc = Adc::new(18);
        adc.set_common(2 << 18);
        // Two ranks: channel 1 with 6.5 cycles, channel 7 with 47.5; trigger 8 rising.
        adc.write(SMPR1, 1 << 3 | 4 << 21, 0);
        adc.write(JSQR, 1 | 8 << 2 | 1 << 7 | 1 << 9 | 7 << 15, 0);
        adc.write(IER, JEOS, 0);
        adc.write(CR, JADSTART | 1 << 28, 0);
        adc.trigger(1_000);
        let first = 1_000 + (6 + 13) * 2;
        assert_eq!(adc.next_event(), first);
        assert_eq!((adc.wants(first - 1), adc.wants(first)), (None, Some(1)));
        adc.sample(2_048);
        adc.advance(first + 50);
        let second = first + 50 + 95 * 2;
        assert_eq!(adc.next_event(), second);
        assert_eq!(adc.wants(second), Some(7));
        assert_eq!(adc.lines(), 0);
        adc.sample(99);
        adc.advance(second + 50);
        assert_eq!(adc.lines(), 1 << 18);
        assert_eq!((adc.read(JDR1, 0), adc.read(JDR1 + 4, 0)), (2_048, 99));
        adc.write(ISR, JEOS | JEOC, 0);
        assert_eq!(adc.lines(), 0);
    }

    #[test]
    fn enabling_and_calibrating_take_time() {
        let mut adc = Adc::new(18);
        adc.write(CR, 1 << 28 | ADCAL, 0);
        assert_ne!(adc.read(CR, 0) & ADCAL, 0);
        adc.advance(adc.next_event());
        assert_eq!(adc.read(CR, 0) & ADCAL, 0);
        adc.write(CR, 1 << 28 | ADEN, 1_000);
        assert_eq!(adc.read(ISR, 1_000), 0);
        adc.advance(1_000 + CYCLES_PER_US);
        assert_eq!(adc.read(ISR, 0), ADRDY);
    }
}
