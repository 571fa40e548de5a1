//! The SPI controller as master with frames of 4 to 16 bits, and the encoder at the other end of the bus.

use std::collections::VecDeque;

use super::plain::Plain;
use super::{CORE_HZ, NEVER, Peripheral};

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const SR: u32 = 0x08;
const DR: u32 = 0x0c;
const SPE: u32 = 1 << 6;

/// A device on the bus.
pub trait Slave: std::fmt::Debug {
    /// Time in ns for which the chip select line must be low before a frame, and high before it falls again.
    fn rests_ns(&self) -> u64 {
        0
    }
    /// The chip select line falls: a transfer begins.
    fn select(&mut self);
    /// Takes a frame of this many bits, and returns one.
    fn exchange(&mut self, sent: u16, bits: u32) -> u16;
    /// The shaft is at this angle, in turns.
    fn set_angle(&mut self, turns: f64);
    /// Sets a fault that lasts from now on.
    fn set_fault(&mut self, fault: SlaveFault);
}

/// The faults of an encoder on a bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SlaveFault {
    /// No fault.
    #[default]
    None,
    /// The data line stays low: no power, or a broken wire with a pull-down.
    Low,
    /// The data line stays low from the next answer that holds an angle, that is between two frames of a reading. For
    /// the AS5047P.
    LowFromAngle,
    /// The data line stays high.
    High,
    /// This bit of each frame is flipped.
    FlipBit(u8),
    /// One bit of every seventh frame is flipped.
    FlipSeventh,
    /// The reported angle never changes, in valid frames.
    Stuck,
    /// The magnet is gone: good frames with the last angle, and a weak field when its register is read.
    NoMagnet,
    /// The magnet touches the chip.
    MagnetTooNear,
    /// Each reported angle is larger by this many 65,536ths of a turn.
    Jump(u16),
    /// The encoder chip reports an error.
    SaysError,
    /// A bit of the next command is flipped: the chip reports an error until its flag is read.
    CommandDamaged,
}

/// The SPI controller.
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
    /// Time of the last change of the chip select line.
    since: u64,
    /// The frame began too early, or the line rose too short a time before: no chip answers for what it hears then.
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

    /// Whether the bus hangs.
    #[must_use]
    pub fn hangs(&self) -> bool {
        self.hangs
    }

    /// The bus hangs from now on: a frame that begins, or has begun, never ends. Or no more: then that frame begins over.
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

    /// Level of the chip select line, active low.
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

    /// Whether the chip select line changed so shortly before that the chip does not take what follows.
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

    /// Time at which a frame that begins now ends.
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
            // Without a slave the line is pulled up by nobody and read as ones.
            let bits = self.bits();
            let answer = match &mut self.slave {
                Some(slave) if self.selected && !self.rushed => slave.exchange(frame, bits),
                _ => 0xffff,
            };
            // Two frames fit; more are lost.
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

    /// 350 ns are 59.5 cycles. A frame of 16 bits at an eighth of the clock takes 256.
    fn answer(before: u64, lead: u64) -> u32 {
        let mut spi = Spi::new(0);
        spi.slave = Some(Box::<As5047p>::default());
        spi.write(CR2, 15 << 8, 0);
        spi.write(CR1, SPE | 2 << 3, 0);
        spi.set_select(true, 0);
        // Every frame answers the one before: the first asks for the angle, which is 0.
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
