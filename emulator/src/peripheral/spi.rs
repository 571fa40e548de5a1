//! The SPI controller as master with frames of 4 to 16 bits, and the encoder at the other end of the bus.

use std::collections::VecDeque;

use super::plain::Plain;
use super::{CORE_HZ, NEVER, Peripheral};

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const SR: u32 = 0x08;
const DR: u32 = 0x0c;
const SPE: u32 = 1 << 6;

/// A device on the SPI bus that answers the chip's frames: an encoder.
pub trait Slave: std::fmt::Debug {
    /// Time in ns for which the chip select line must be low before a frame, and high before it falls again.
    fn rests_ns(&self) -> u64 {
        0
    }
    /// Called when the chip select line falls, at the beginning of a transfer.
    fn select(&mut self);
    /// Takes a frame of this many bits from the chip, and returns the encoder's frame of the same length.
    fn exchange(&mut self, sent: u16, bits: u32) -> u16;
    /// Sets the shaft's angle, in turns.
    fn set_angle(&mut self, turns: f64);
    /// Sets the fault that the encoder has from now on.
    fn set_fault(&mut self, fault: SlaveFault);
}

/// Faults of an encoder on the SPI bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SlaveFault {
    /// The encoder has no fault.
    #[default]
    None,
    /// The encoder's data line stays low: the encoder has no power, or a wire with a pull-down is broken.
    Low,
    /// The data line stays low from the next answer with an angle on. For the AS5047P this is between the two frames of a reading.
    LowFromAngle,
    /// The encoder's data line stays high.
    High,
    /// The bit with this number is flipped in each frame.
    FlipBit(u8),
    /// One bit of every seventh frame is flipped.
    FlipSeventh,
    /// The encoder sends valid frames, in which the angle never changes.
    Stuck,
    /// The magnet is missing: the frames are valid and repeat the last angle, and the field register reports a weak field.
    NoMagnet,
    /// The magnet touches the encoder chip, so the field is too strong.
    MagnetTooNear,
    /// Each reported angle is too large by this many 65,536ths of a turn.
    Jump(u16),
    /// The encoder chip reports an error.
    SaysError,
    /// A bit of the next command is flipped: the encoder chip reports an error until its error register is read.
    CommandDamaged,
}

/// The chip's SPI controller, with the encoder on its bus.
#[derive(Debug, Default)]
pub struct Spi {
    interrupt: u32,
    registers: Plain,
    transmit: VecDeque<u16>,
    receive: VecDeque<u16>,
    shifting: Option<(u64, u16)>,
    /// The encoder at the other end of the bus.
    pub slave: Option<Box<dyn Slave>>,
    selected: bool,
    /// Time of the last change of the chip select line, in processor cycles.
    since: u64,
    /// Whether the timing of the chip select line was violated: a frame began too early after the line's fall, or the line was high
    /// for too short a time. The encoder then does not answer.
    rushed: bool,
    hangs: bool,
}

impl Spi {
    /// A controller that raises the interrupt of this number.
    #[must_use]
    pub fn new(interrupt: u32) -> Self {
        Self {
            interrupt,
            ..Self::default()
        }
    }

    /// Whether the bus hangs, so that no frame ends.
    #[must_use]
    pub fn hangs(&self) -> bool {
        self.hangs
    }

    /// Sets whether the bus hangs. While it does, no frame ends. When the hang ends, a frame in progress begins anew.
    pub fn set_hangs(&mut self, hangs: bool, now: u64) {
        if self.hangs == hangs {
            return;
        }
        self.hangs = hangs;
        let time = self.end_of_frame(now);
        if let Some((ends, _)) = &mut self.shifting {
            *ends = time;
        }
    }

    /// Sets the level of the chip select line, which is active low.
    pub fn set_select(&mut self, level: bool, now: u64) {
        if self.selected != level {
            return;
        }
        if !level {
            self.rushed = self.is_early(now);
            if let Some(slave) = &mut self.slave {
                slave.select();
            }
        }
        self.selected = !level;
        self.since = now;
    }

    /// Whether the chip select line changed so recently that the encoder does not yet accept the next change or frame.
    fn is_early(&self, now: u64) -> bool {
        let rests_ns = self.slave.as_ref().map_or(0, |slave| slave.rests_ns());
        (now - self.since) * 1_000_000_000 < rests_ns * CORE_HZ
    }

    fn bits(&self) -> u32 {
        ((self.registers.get(CR2) >> 8 & 15) + 1).max(4)
    }

    fn frame_time(&self) -> u64 {
        u64::from(self.bits()) * (2 << (self.registers.get(CR1) >> 3 & 7))
    }

    /// Time in processor cycles at which a frame that begins now ends.
    fn end_of_frame(&self, now: u64) -> u64 {
        match self.hangs {
            true => NEVER,
            false => now + self.frame_time(),
        }
    }

    fn begin(&mut self, now: u64) {
        if self.shifting.is_none()
            && self.registers.get(CR1) & SPE != 0
            && let Some(frame) = self.transmit.pop_front()
        {
            self.shifting = Some((self.end_of_frame(now), frame));
            self.rushed |= self.is_early(now);
        }
    }
}

impl Peripheral for Spi {
    fn read(&mut self, offset: u32, now: u64) -> u32 {
        match offset {
            SR => {
                let busy = self.shifting.is_some() || !self.transmit.is_empty();
                let received = (self.receive.len() as u32 * 2).min(3);
                u32::from(!self.receive.is_empty())
                    | u32::from(self.transmit.len() < 2) << 1
                    | u32::from(busy) << 7
                    | received << 9
                    | (self.transmit.len() as u32 * 2).min(3) << 11
            }
            DR => u32::from(self.receive.pop_front().unwrap_or(0)),
            _ => self.registers.read(offset, now),
        }
    }

    fn write(&mut self, offset: u32, value: u32, now: u64) {
        match offset {
            DR => {
                self.transmit.push_back(value as u16);
                self.begin(now);
            }
            SR => {}
            _ => {
                self.registers.write(offset, value, now);
                self.begin(now);
            }
        }
    }

    fn next_event(&self) -> u64 {
        self.shifting.map_or(NEVER, |(time, _)| time)
    }

    fn advance(&mut self, now: u64) {
        while let Some((time, frame)) = self.shifting.filter(|(time, _)| *time <= now) {
            // Without a slave nothing drives the line. The model reads it as ones.
            let bits = self.bits();
            let answer = match &mut self.slave {
                Some(slave) if self.selected && !self.rushed => slave.exchange(frame, bits),
                _ => 0xffff,
            };
            // The receive buffer holds two frames; further frames are lost.
            if self.receive.len() < 2 {
                self.receive.push_back(answer);
            }
            self.shifting = None;
            self.begin(time);
        }
    }

    fn lines(&self) -> u128 {
        let cr2 = self.registers.get(CR2);
        let up = cr2 >> 6 & 1 != 0 && !self.receive.is_empty()
            || cr2 >> 7 & 1 != 0 && self.transmit.len() < 2;
        u128::from(up) << self.interrupt
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peripheral::encoder::As5047p;

    /// The AS5047P's answer if chip select was high for `before` cycles and low for `lead` cycles before a frame. The data sheet
    /// requires 350 ns, 59.5 cycles, for each. A frame of 16 bits at an eighth of the clock takes 256 cycles.
    fn answer(before: u64, lead: u64) -> u32 {
        let mut spi = Spi::new(0);
        spi.slave = Some(Box::<As5047p>::default());
        spi.write(CR2, 15 << 8, 0);
        spi.write(CR1, SPE | 2 << 3, 0);
        spi.set_select(true, 0);
        // The slave answers each frame in the next one. The first frame requests the angle, which is 0.
        let mut now = 1_000;
        for lead in [60, lead] {
            spi.set_select(false, now);
            spi.write(DR, 0xffff, now + lead);
            now += lead + 256;
            spi.advance(now);
            spi.set_select(true, now);
            now += before;
        }
        spi.read(DR, now);
        spi.read(DR, now)
    }

    #[test]
    fn a_frame_that_comes_too_soon_is_not_taken() {
        assert_eq!(answer(60, 60), 0);
        assert_eq!(answer(60, 59), 0xffff, "after the line fell");
        assert_eq!(answer(59, 60), 0xffff, "before it fell");
    }
}
