//! Faults of the sensors: an off-centre encoder magnet, noise of the encoder and of the converters. None by default.

use std::f64::consts::TAU;

/// Error of the encoder's angle due to an off-centre magnet: `A sin(n θ + φ)`. A shaft off the axis gives one period a
/// turn, a sensor off it two (TI's TIDUF97, table of the patterns of error; both together and a tilt: both).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EncoderError {
    /// `A`, rad.
    pub amplitude_rad: f64,
    /// Periods in a turn: `n`.
    pub per_rev: f64,
    /// `φ`, rad.
    pub phase_rad: f64,
}

/// Root-mean-square values of white, nearly normal noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Noise of the encoder's angle, rad.
    pub encoder_rad: f64,
    /// Noise of each conversion, codes of 12 bits.
    pub converter_codes: f64,
}

/// Errors and noise of the sensors.
#[derive(Debug, Clone)]
pub struct Sensors {
    /// Errors of the encoder, by order.
    pub encoder_error: Vec<EncoderError>,
    /// Noise of the encoder and of the converters; `None` for no noise.
    pub noise: Option<Noise>,
    /// xorshift64's state: the same numbers in each run.
    state: u64,
    /// Present noise of the encoder's angle, rad.
    drawn_rad: f64,
}

impl Default for Sensors {
    fn default() -> Self {
        Self {
            encoder_error: Vec::new(),
            noise: None,
            state: 0x9e37_79b9_7f4a_7c15,
            drawn_rad: 0.0,
        }
    }
}

impl Sensors {
    /// An angle with the encoder's error, rad.
    #[must_use]
    pub fn with_error(&self, angle_rad: f64) -> f64 {
        self.encoder_error.iter().fold(angle_rad, |read, it| {
            read + it.amplitude_rad * (it.per_rev * angle_rad + it.phase_rad).sin()
        })
    }

    /// Draws new noise for a reading of the encoder.
    pub fn look(&mut self) {
        let noise = self.noise.map(|it| it.encoder_rad);
        self.drawn_rad = noise.map_or(0.0, |rms| rms * self.normal());
    }

    /// Angle that the encoder reports, turns.
    #[must_use]
    pub fn shown_turns(&self, angle_rad: f64) -> f64 {
        (self.with_error(angle_rad) + self.drawn_rad) / TAU
    }

    /// Random noise of one conversion, in codes of the converter.
    pub fn converter_codes(&mut self) -> f64 {
        let noise = self.noise.map(|it| it.converter_codes);
        noise.map_or(0.0, |rms| rms * self.normal())
    }

    /// Mean 0, variance 1, at most 3.5: the sum of four that are evenly distributed.
    fn normal(&mut self) -> f64 {
        let mut sum = 0.0;
        for _ in 0..4 {
            self.state ^= self.state << 13;
            self.state ^= self.state >> 7;
            self.state ^= self.state << 17;
            sum += (self.state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
        }
        sum * 3_f64.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five standard deviations of the mean and of the variance of so many.
    #[test]
    fn noise_has_its_effective_value_and_none_is_none() {
        let mut sensors = Sensors::default();
        sensors.look();
        assert_eq!(
            (sensors.shown_turns(TAU), sensors.converter_codes()),
            (1.0, 0.0)
        );
        sensors.noise = Some(Noise {
            encoder_rad: 0.0,
            converter_codes: 2.0,
        });
        let count = 100_000;
        let all: Vec<f64> = (0..count).map(|_| sensors.converter_codes()).collect();
        let n = f64::from(count);
        let mean = all.iter().sum::<f64>() / n;
        let variance = all.iter().map(|it| it * it).sum::<f64>() / n;
        assert!(mean.abs() < 5.0 * 2.0 / n.sqrt(), "{mean}");
        assert!(
            (variance / 4.0 - 1.0).abs() < 5.0 * (2.0 / n).sqrt(),
            "{variance}"
        );
    }
}
