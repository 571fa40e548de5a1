//! Magnetic encoders on the bus, from their data sheets: AS5047P and MT6701.

use super::spi::{Slave, SlaveFault};

/// Encoder counts per turn, the same for the AS5047P and the MT6701.
const COUNTS: f64 = 16_384.0;

/// The angle that an encoder of either type reports, and the encoder's injected fault.
#[derive(Debug, Clone, Copy, Default)]
struct Angle {
    turns: f64,
    fault: SlaveFault,
    held: Option<u16>,
    frames: u32,
}

impl Angle {
    fn count(&mut self) -> u16 {
        let count = ((self.turns.rem_euclid(1.0) * COUNTS) as u16) & 0x3fff;
        match self.fault {
            // Without a magnetic field the encoder would return noise. The model keeps the last angle.
            SlaveFault::Stuck | SlaveFault::NoMagnet => *self.held.get_or_insert(count),
            SlaveFault::Jump(by) => count.wrapping_add(by >> 2) & 0x3fff,
            _ => {
                self.held = None;
                count
            }
        }
    }

    /// The frame as it arrives: with the bits that the injected fault of the data line changes.
    fn disturb(&mut self, frame: u32, bits: u32) -> u32 {
        self.frames = self.frames.wrapping_add(1);
        match self.fault {
            SlaveFault::FlipSeventh if self.frames.is_multiple_of(7) => frame ^ 1,
            SlaveFault::Low => 0,
            SlaveFault::High => (1 << bits) - 1,
            SlaveFault::FlipBit(bit) => frame ^ 1 << (u32::from(bit) % bits),
            _ => frame,
        }
    }
}

/// The AS5047P: each frame answers the previous frame's command. After an error, every answer has the error flag set until the
/// program reads `ERRFL`.
#[derive(Debug, Default)]
pub struct As5047p {
    angle: Angle,
    command: u16,
    /// Content of the encoder's error register `ERRFL`.
    errors: u16,
}

/// Bit of the register `ERRFL` for a parity error in a frame.
const PARITY_ERROR: u16 = 1 << 2;

/// Value of the register `DIAAGC` with a magnet at the right distance. [`FIELD_WEAK`]: without a magnet (gain at its maximum, field
/// too weak). [`FIELD_STRONG`]: the magnet touches the chip (field too strong).
const FIELD_RIGHT: u16 = 1 << 8 | 0x60;
const FIELD_WEAK: u16 = 1 << 8 | 1 << 11 | 0xff;
const FIELD_STRONG: u16 = 1 << 8 | 1 << 10;

impl Slave for As5047p {
    // t_L and t_CSn of the data sheet's SPI timing.
    fn rests_ns(&self) -> u64 {
        350
    }

    fn select(&mut self) {}

    fn exchange(&mut self, sent: u16, bits: u32) -> u16 {
        if self.angle.fault == SlaveFault::SaysError {
            self.errors |= PARITY_ERROR;
        }
        let flag = u16::from(self.errors != 0) << 14;
        let data = match self.command & 0x3fff {
            0x3fff | 0x3ffe => {
                if self.angle.fault == SlaveFault::LowFromAngle {
                    self.angle.fault = SlaveFault::Low;
                }
                self.angle.count()
            }
            0x3ffc => match self.angle.fault {
                SlaveFault::NoMagnet => FIELD_WEAK,
                SlaveFault::MagnetTooNear => FIELD_STRONG,
                _ => FIELD_RIGHT,
            },
            0x0001 => std::mem::take(&mut self.errors),
            _ => 0,
        };
        let data = data | flag;
        let frame = data | ((data.count_ones() & 1) as u16) << 15;
        self.command = match self.angle.fault {
            SlaveFault::CommandDamaged => {
                self.angle.fault = SlaveFault::None;
                sent ^ 1
            }
            _ => sent,
        };
        if !self.command.count_ones().is_multiple_of(2) {
            self.errors |= PARITY_ERROR;
            // A command with the wrong parity is ignored.
            self.command = 0;
        }
        self.angle.disturb(u32::from(frame), bits) as u16
    }

    fn set_angle(&mut self, turns: f64) {
        self.angle.turns = turns;
    }

    fn set_fault(&mut self, fault: SlaveFault) {
        self.angle.fault = fault;
    }
}

/// MT6701 over SSI: 24 bits after each fall of the chip select.
#[derive(Debug, Default)]
pub struct Mt6701 {
    angle: Angle,
    word: u32,
    left: u32,
}

/// The MT6701's checksum: CRC of 18 bits with the polynomial x^6 + x + 1.
fn crc(mut data: u32) -> u32 {
    data <<= 6;
    for bit in (6..24).rev() {
        if data >> bit & 1 != 0 {
            data ^= 0b100_0011 << (bit - 6);
        }
    }
    data
}

impl Slave for Mt6701 {
    fn select(&mut self) {
        // Status bits: Mg3 means loss of track; of Mg1 and Mg0, the value 1 means a field too strong and 2 a field too weak.
        let status = match self.angle.fault {
            SlaveFault::SaysError => 8,
            SlaveFault::MagnetTooNear => 1,
            SlaveFault::NoMagnet => 2,
            _ => 0,
        };
        let data = u32::from(self.angle.count()) << 4 | status;
        self.word = self.angle.disturb(data << 6 | crc(data), 24);
        self.left = 24;
    }

    fn exchange(&mut self, _sent: u16, bits: u32) -> u16 {
        let taken = bits.min(self.left);
        self.left -= taken;
        let frame = self.word >> self.left & ((1 << taken) - 1);
        // After the last bit the line stays high.
        let rest = bits - taken;
        (frame << rest | ((1 << rest) - 1)) as u16
    }

    fn set_angle(&mut self, turns: f64) {
        self.angle.turns = turns;
    }

    fn set_fault(&mut self, fault: SlaveFault) {
        self.angle.fault = fault;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_by_as5047p_comes_one_frame_later_with_even_parity() {
        let mut chip = As5047p::default();
        chip.set_angle(0.25);
        chip.exchange(0xffff, 16);
        assert_eq!(chip.exchange(0xffff, 16), 0x9000);
        chip.set_fault(SlaveFault::FlipBit(3));
        assert_eq!(chip.exchange(0xffff, 16), 0x9008);
    }

    #[test]
    fn an_error_of_the_as5047p_stays_until_it_is_read() {
        let mut chip = As5047p::default();
        chip.exchange(0xffff, 16);
        chip.set_fault(SlaveFault::CommandDamaged);
        chip.exchange(0xffff, 16);
        for _ in 0..3 {
            assert_ne!(chip.exchange(0xffff, 16) & 1 << 14, 0);
        }
        chip.exchange(0x4001, 16);
        assert_eq!(chip.exchange(0xffff, 16), 0x4004, "ERRFL, with the flag");
        assert_eq!(chip.exchange(0xffff, 16) & 1 << 14, 0);
    }

    #[test]
    fn an_angle_by_mt6701_in_three_bytes() {
        let mut chip = Mt6701::default();
        chip.set_angle(0.5);
        chip.select();
        let bytes = [0, 0, 0].map(|sent| u32::from(chip.exchange(sent, 8)));
        let word = bytes[0] << 16 | bytes[1] << 8 | bytes[2];
        assert_eq!(word >> 10, 0x2000);
        assert_eq!(word & 63, crc(word >> 6));
        // A word and its check sum leave no remainder.
        assert_eq!(crc(word >> 6) ^ (word & 63), 0);
    }
}
