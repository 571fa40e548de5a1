//! Frames of the encoders for a shaft angle.

/// The nearest count for an angle, rad, and a number of counts a turn.
#[must_use]
pub fn count(angle_rad: f64, counts_per_rev: u32) -> i64 {
    (angle_rad / std::f64::consts::TAU * f64::from(counts_per_rev)).round() as i64
}

/// AS5047P's answer to a read of its angle: 14 bits, even parity in the upper bit.
#[must_use]
pub fn as5047p_frame(count: i64) -> u16 {
    let angle = (count & 0x3FFF) as u16;
    angle | ((angle.count_ones() as u16 & 1) << 15)
}

/// MT6701's SSI frame of 24 bits: 14 of angle, 4 of status, CRC-6 (`x⁶ + x + 1`) over them.
#[must_use]
pub fn mt6701_frame(count: i64, status: u8) -> u32 {
    let data = (((count & 0x3FFF) as u32) << 4) | u32::from(status & 0xF);
    let crc = (0..18).rev().fold(0_u32, |crc, bit| {
        let out = (crc >> 5 ^ data >> bit) & 1;
        (crc << 1 & 0x3F) ^ if out == 1 { 0b00_0011 } else { 0 }
    });
    data << 6 | crc
}
