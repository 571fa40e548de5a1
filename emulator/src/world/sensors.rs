//! Errors of the simulated sensors: an off-centre encoder magnet, and noise of the encoder and of the analogue-to-digital
//! converters. By default the sensors have no errors.

use std::f64::consts::TAU;

/// One sinusoidal error of the encoder's angle due to an off-centre magnet: `A sin(n θ + φ)` at the shaft's angle `θ`. A magnet off
/// the shaft's axis causes one period per turn, a sensor off the axis two (TI's TIDUF97, table of the error patterns). A tilted
/// magnet, or both off the axis, causes one and two periods at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EncoderError {
    /// Amplitude `A` of the error, rad.
    pub amplitude_rad: f64,
    /// Periods of the error per turn of the shaft: `n`.
    pub per_rev: f64,
    /// Phase `φ` of the error, rad.
    pub phase_rad: f64,
}

/// Root-mean-square values of white, approximately normal noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Noise of the encoder's angle, rad.
    pub encoder_rad: f64,
    /// Noise of each conversion, in codes of the 12-bit analogue-to-digital converter.
    pub converter_codes: f64,
}

/// Errors and noise of the sensors.
#[derive(Debug, Clone)]
pub struct Sensors {
    /// Sinusoidal errors of the encoder, one entry per number of periods per turn.
    pub encoder_error: Vec<EncoderError>,
    /// Noise of the encoder and of the converters; `None` for no noise.
    pub noise: Option<Noise>,
    /// State of the random-number generator xorshift64, whose fixed seed gives the same numbers in each run.
    state: u64,
    /// Noise of the encoder's angle for the current reading, rad.
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
    /// Adds the encoder's sinusoidal errors to the angle of the shaft, rad.
    #[must_use]
    pub fn with_error(&self, angle_rad: f64) -> f64 {
        self.encoder_error.iter().fold(angle_rad, |read, it| {
            read + it.amplitude_rad * (it.per_rev * angle_rad + it.phase_rad).sin()
        })
    }

    /// Draws a new noise value for the next reading of the encoder.
    pub fn look(&mut self) {
        let noise = self.noise.map(|it| it.encoder_rad);
        self.drawn_rad = noise.map_or(0.0, |rms| rms * self.normal());
    }

    /// Angle that the encoder reports for an angle of the shaft, in turns, with errors and noise.
    #[must_use]
    pub fn shown_turns(&self, angle_rad: f64) -> f64 {
        (self.with_error(angle_rad) + self.drawn_rad) / TAU
    }

    /// Draws the noise of one conversion, in codes of the 12-bit analogue-to-digital converter.
    pub fn converter_codes(&mut self) -> f64 {
        let noise = self.noise.map(|it| it.converter_codes);
        noise.map_or(0.0, |rms| rms * self.normal())
    }

    /// Draws an approximately normal number with mean 0, variance 1 and magnitude of at most 3.5: the scaled sum of four uniformly
    /// distributed numbers.
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

    /// Checks that mean and variance of 100,000 noise values lie within five standard deviations of the configured ones. Also
    /// checks that every value is 0 without configured noise.
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
