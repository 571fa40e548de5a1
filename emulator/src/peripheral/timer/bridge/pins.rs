//! The levels of TIM1's pins at a given time, including the dead time, as an oscilloscope would show them. The model of the motor
//! does not use them; it works with mean duty cycles of PWM periods.

use super::super::gates::{GateDriver, Leg};
use super::{BDTR, BridgeTimer, CCER, CR1};

/// Dead time in timer clock cycles for a code of BDTR.DTG with CKD = 0 (RM0440, TIM1_BDTR). The formula is written from memory and
/// was not compared with the manual.
fn dead_time(code: u32) -> u64 {
    let code = u64::from(code);
    match code >> 5 {
        0..=3 => code,
        4 | 5 => (64 + (code & 0x3f)) * 2,
        6 => (32 + (code & 0x1f)) * 8,
        _ => (32 + (code & 0x1f)) * 16,
    }
}

impl BridgeTimer {
    /// Processor cycles since the counter was at 0.
    #[must_use]
    pub fn since_bottom(&self, now: u64) -> u64 {
        self.position(now)
    }

    /// Levels of the two outputs of each phase at the time `now`; `None` where the timer does not drive both outputs.
    #[must_use]
    pub fn pins(&self, now: u64) -> [Option<(bool, bool)>; 3] {
        [0, 1, 2].map(|phase| {
            let position = self.position(now);
            let compare = u64::from(self.compare[phase]) * self.prescaler;
            let period = self.period();
            // OC1REF to OC3REF are high while the counter is below the compare value.
            let reference = position < compare || position >= period - compare.min(period);
            let since = match reference {
                true => (position + compare) % period,
                false => position - compare,
            };
            let switches = compare > 0 && 2 * compare < period;
            if switches && self.has_dead_time(phase) && since < self.dead_cycles() {
                let outputs = self.registers.get(CCER) >> (4 * phase);
                return Some((outputs & 2 != 0, outputs & 8 != 0));
            }
            self.levels(phase, reference)
        })
    }

    /// State of each phase's transistors at the time `now`.
    #[must_use]
    pub fn legs(&self, now: u64) -> [Leg; 3] {
        let pins = self.pins(now);
        [0, 1, 2].map(|phase| match self.stage_off {
            true => Leg::Open,
            false => self.gates.leg(match self.gates {
                GateDriver::Drv8313 => pins[phase].zip(pins[0]).map(|(it, first)| (it.0, first.1)),
                _ => pins[phase],
            }),
        })
    }

    /// Whether the timer inserts dead time in this phase: the main output and the two outputs of the phase are enabled.
    fn has_dead_time(&self, phase: usize) -> bool {
        self.main_output && self.registers.get(CCER) >> (4 * phase) & 5 == 5
    }

    fn dead_cycles(&self) -> u64 {
        let dts = 1 << (self.registers.get(CR1) >> 8 & 3);
        dead_time(self.registers.get(BDTR) & 0xff) * dts
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::{ARR, CCMR1, CCR1, CEN};
    use super::super::{BDTR, BridgeTimer, CCER, CR1, MOE};
    use super::dead_time;
    use crate::peripheral::Peripheral as _;

    #[test]
    fn neither_output_is_active_for_the_dead_time_after_an_edge() {
        assert_eq!([85, 0x84, 0xcb, 0xf6].map(dead_time), [85, 136, 344, 864]);
        let mut timer = BridgeTimer::default();
        timer.write(ARR, 1_000, 0);
        timer.write(CCMR1, 6 << 4, 0);
        timer.write(CCR1, 400, 0);
        timer.write(0x14, 1, 0);
        timer.write(CCER, 5, 0);
        timer.write(BDTR, MOE | 85, 0);
        timer.write(CR1, CEN, 0);
        let phase = |at| timer.pins(at)[0].unwrap();
        assert_eq!(phase(399), (true, false));
        assert_eq!(phase(400), (false, false));
        assert_eq!(phase(484), (false, false));
        assert_eq!(phase(485), (false, true));
        assert_eq!(phase(1_599), (false, true));
        assert_eq!(phase(1_600), (false, false));
        assert_eq!(phase(1_685), (true, false));
        assert_eq!(phase(2_000), (true, false));
    }
}
