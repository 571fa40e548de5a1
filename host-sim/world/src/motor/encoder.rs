//! The data that encoders return for a shaft angle.

/// The encoder count nearest to an angle (rad), for an encoder with this number of counts per turn.
#[must_use]
pub fn count(angle_rad: f64, counts_per_rev: u32) -> i64 {
    (angle_rad / std::f64::consts::TAU * f64::from(counts_per_rev)).round() as i64
}

/// Answer of the encoder chip AS5047P to a request of its angle: 14 bits, with even parity in the top bit.
#[must_use]
pub fn as5047p_frame(count: i64) -> u16 {
    let angle = (count & 0x3FFF) as u16;
    angle | ((angle.count_ones() as u16 & 1) << 15)
}

/// SSI frame of 24 bits of the encoder chip MT6701: 14 bits of angle, 4 of status, and a CRC-6 (`x⁶ + x + 1`) of these 18 bits.
#[must_use]
pub fn mt6701_frame(count: i64, status: u8) -> u32 {
    let data = (((count & 0x3FFF) as u32) << 4) | u32::from(status & 0xF);
    let crc = (0..18).rev().fold(0_u32, |crc, bit| {
        let out = (crc >> 5 ^ data >> bit) & 1;
        (crc << 1 & 0x3F) ^ if out == 1 { 0b00_0011 } else { 0 }
    });
    data << 6 | crc
}
