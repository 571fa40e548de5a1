//! The comparators COMP1 to COMP4 as the program has set them up: their inputs, thresholds and polarities. All STM32G4 have these
//! four.
//!
//! Sources: which signal is connected to which input is in ST's `stm32g4xx_hal_comp.h` (defgroups `COMP_InputPlus`,
//! `COMP_InputMinus`, `COMP_Hysteresis`, `COMP_OutputPolarity`). Where the register fields are is in `registers/vendor.tsv`. The
//! reference manual's chapters of COMP and DAC (RM0440) are from memory, unread: a DAC's output is its code / 4096 of the reference
//! voltage, and with a mode of 1 or 3 it is connected to blocks on the chip.
//!
//! Not modelled: delay, noise and offset of the comparators, blanking, and pins as inverting inputs.

use super::Chip;
use crate::board::REFERENCE_V;
use crate::peripheral::plain::Plain;
use crate::peripheral::timer::gates::Leg;

/// Offsets of the comparators' registers in the block of SYSCFG, COMP1 to COMP4.
const COMP_CSR: [u32; 4] = [0x200, 0x204, 0x208, 0x20c];
const EN: u32 = 1;
const INPSEL: u32 = 1 << 8;
const POLARITY: u32 = 1 << 15;
/// Bits SCALEN and BRGEN of a comparator's register. SCALEN switches the internal reference's buffer on, BRGEN the divider that
/// provides quarters of the reference.
const SCALER: u32 = 1 << 23;
const BRIDGE: u32 = 1 << 22;
/// The chip's internal reference voltage VREFINT, V. Typical value of the data sheet (from memory, unread).
const VREFINT_V: f64 = 1.212;
/// Comparator hysteresis per step of the register field HYST, V.
const HYSTERESIS_V: f64 = 0.01;

/// Port and pin of each comparator's two non-inverting inputs.
const PLUS: [[(usize, usize); 2]; 4] = [
    [(0, 1), (1, 1)],
    [(0, 7), (0, 3)],
    [(0, 0), (2, 1)],
    [(1, 0), (4, 7)],
];
/// Channel of DAC3, counted from 0, that each comparator can use as inverting input. [`DAC1`] has the channels of DAC1.
const DAC3: [usize; 4] = [0, 1, 0, 1];
const DAC1: [usize; 4] = [0, 1, 0, 0];

/// The comparators' outputs, and the currents at which the outputs rose.
#[derive(Debug, Clone, Default)]
pub struct Comparators {
    /// Whether each comparator's positive input is above its negative input, with hysteresis.
    above: [bool; 4],
    /// Every rise of a comparator's output: time in cycles, comparator (counted from 0), and current through the shunt to ground in
    /// A.
    pub risen: Vec<(u64, usize, f64)>,
}

impl Comparators {
    /// Sets the outputs as after a reset; the list of recorded currents is kept.
    pub fn reset(&mut self) {
        self.above = [false; 4];
    }
}

/// Voltage that a DAC's channel gives to other blocks on the chip, V; `None` where the channel is off, waits for a trigger, or only
/// drives a pin.
fn dac_v(dac: &Plain, channel: usize) -> Option<f64> {
    let (cr, mcr) = (dac.get(0x00), dac.get(0x3c));
    let is_on = cr >> (16 * channel) & 1 != 0;
    // If a trigger is enabled, the converter outputs the written code only at that trigger. The model has no such trigger, so the
    // code is never output.
    let is_triggered = cr >> (16 * channel + 1) & 1 != 0;
    let leads_inside = mcr >> (16 * channel) & 1 != 0;
    let code = dac.get([0x08, 0x14][channel]) & 0xfff;
    (is_on && !is_triggered && leads_inside).then(|| f64::from(code) / 4_096.0 * REFERENCE_V)
}

/// The voltage at a comparator's inverting input, V. `None` if nothing drives the input, or if a pin is selected, which is not
/// modelled.
fn minus_v(number: usize, csr: u32, dac1: &Plain, dac3: &Plain) -> Option<f64> {
    match csr >> 4 & 15 {
        3 if csr & SCALER != 0 => Some(VREFINT_V),
        select @ 0..=2 if csr & SCALER != 0 && csr & BRIDGE != 0 => {
            Some(VREFINT_V * f64::from(select + 1) / 4.0)
        }
        4 => dac_v(dac3, DAC3[number]),
        5 => dac_v(dac1, DAC1[number]),
        _ => None,
    }
}

impl Chip {
    /// Levels of the comparators' outputs, as a mask: bit 0 is COMP1. The bit of a comparator that is off is 0.
    pub(super) fn compare(&mut self, now: u64) -> u32 {
        let mut outputs = 0;
        for (number, offset) in COMP_CSR.into_iter().enumerate() {
            let csr = self.plain[2].get(offset);
            if csr & EN == 0 {
                self.comparators.above[number] = false;
                continue;
            }
            // An input that nothing drives floats. The model assumes 0 V.
            let minus = minus_v(number, csr, &self.plain[1], &self.plain[5]).unwrap_or(0.0);
            let pin = PLUS[number][usize::from(csr & INPSEL != 0)];
            let shunt = self.board.shunts.iter().find(|(at, _)| *at == pin);
            let shunt_a = shunt.map(|(_, phase)| self.shunt_a(*phase, now));
            let plus = shunt_a.map_or(0.0, |amps| self.board.shunt_pin_v(amps));
            let before = self.comparators.above[number];
            let hysteresis = f64::from(csr >> 16 & 7) * HYSTERESIS_V;
            let above = plus > minus - if before { hysteresis } else { 0.0 };
            let forced = self.board.wiring.comparators >> number & 1 != 0;
            if above && !before {
                let seen = (now, number, shunt_a.unwrap_or(0.0));
                self.comparators.risen.push(seen);
            }
            self.comparators.above[number] = above;
            let inverts = csr & POLARITY != 0;
            outputs |= u32::from((above || forced) != inverts) << number;
        }
        outputs
    }

    /// Current in A through the shunt below a phase's lower transistor, to ground. While that transistor conducts, it is the
    /// current out of the motor. With both transistors off, a current into the motor comes through the lower diode, and one out of
    /// the motor leaves through the upper diode.
    fn shunt_a(&self, phase: usize, now: u64) -> f64 {
        let out = -self.world.leg_a(phase);
        match self.bridge.legs(now)[phase] {
            Leg::Upper => 0.0,
            Leg::Lower => out,
            Leg::Open => out.min(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Plain, dac_v, minus_v};

    #[test]
    fn a_threshold_is_what_the_selected_source_gives() {
        let near = |it: Option<f64>, volts: f64| (it.unwrap() - volts).abs() < 1e-9;
        let off = Plain::default();
        let dac3 = Plain::default()
            .with(0x00, 1 | 1 << 16)
            .with(0x3c, 3 | 3 << 16)
            .with(0x08, 1_024)
            .with(0x14, 2_048);
        // Channel 1 of DAC3 leads to COMP1 and COMP3, channel 2 to COMP2 and COMP4.
        for (number, volts) in [(0, 0.825), (1, 1.65), (2, 0.825), (3, 1.65)] {
            assert!(near(minus_v(number, 4 << 4, &off, &dac3), volts));
            assert_eq!(minus_v(number, 5 << 4, &off, &dac3), None);
        }
        assert_eq!(dac_v(&dac3.clone().with(0x00, 0), 0), None);
        assert_eq!(dac_v(&dac3.clone().with(0x3c, 0), 0), None);
        assert_eq!(dac_v(&dac3.with(0x00, 3), 0), None);
        assert_eq!(minus_v(0, 3 << 4, &off, &off), None);
        assert!(near(minus_v(0, 3 << 4 | 1 << 23, &off, &off), 1.212));
        assert!(near(minus_v(0, 1 << 4 | 3 << 22, &off, &off), 0.606));
    }
}
