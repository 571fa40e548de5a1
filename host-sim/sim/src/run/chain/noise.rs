//! Errors of sensors: white noise, an error that repeats every turn, and the error of a current sensor.

use super::stage::Stage;

/// An independent random-number sequence, made from a seed and a purpose. A further sequence does not change the numbers of the
/// others, and every machine gives the same numbers.
///
/// The generator is SplitMix64 by Steele, Lea and Flood (OOPSLA 2014): a counter, and a function that mixes its bits.
#[derive(Debug, Clone, Copy)]
pub struct Stream {
    counter: u64,
    spare: Option<f64>,
}

/// Purpose of a random-number sequence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// Noise of the position sensor.
    Sensor = 1,
    /// Noise of the current sensor.
    Current = 2,
    /// Random lateness of position samples.
    Jitter = 3,
    /// Random delay of torque commands.
    Latency = 4,
    /// Which ticks (control periods) are lost.
    Lost = 5,
}

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

fn mixed(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

impl Stream {
    /// Random-number sequence for a seed and a purpose.
    #[must_use]
    pub fn new(seed: u32, channel: Channel) -> Self {
        Self {
            counter: mixed(u64::from(seed).wrapping_mul(GOLDEN) ^ mixed(channel as u64)),
            spare: None,
        }
    }

    /// A random number from 0 to below 1, each of `2^53` values equally likely.
    #[inline(always)]
    pub fn uniform(&mut self) -> f64 {
        self.counter = self.counter.wrapping_add(GOLDEN);
        (mixed(self.counter) >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// Normally distributed random number of mean 0 and variance 1. The method of Box and Muller makes two numbers at a time; the
    /// second is kept for the next call.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        // `1 - uniform` is above 0, so that the logarithm is finite.
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.uniform()));
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * self.uniform());
        self.spare = Some(radius * sin);
        radius * cos
    }
}

/// White noise that is added to the angle before the encoder counts it.
#[derive(Debug, Clone, Copy)]
pub struct Noisy {
    /// Root mean square of the noise, rad.
    pub rms_rad: f64,
    /// Random-number sequence of the noise.
    pub stream: Stream,
}

impl Stage for Noisy {
    fn angle_rad(&mut self, angle_rad: f64) -> f64 {
        angle_rad + self.rms_rad * self.stream.normal()
    }
}

/// Angle error that repeats every turn, `A sin(n x + phi) + A2 sin(2n x + phi2)`, where `x` is the angle. The cause is a sensor
/// disc or magnet off the axis; a tilt adds the second term.
#[derive(Debug, Clone, Copy)]
pub struct Eccentric {
    /// Amplitude `A` of the angle error, rad.
    pub amplitude_rad: f64,
    /// Number of periods `n` of the angle error per turn.
    pub per_rev: f64,
    /// Phase `phi` of the angle error, rad.
    pub phase_rad: f64,
    /// Amplitude `A2` and phase `phi2` of the component with `2n` periods per turn, rad; `None` without this component.
    pub second: Option<(f64, f64)>,
}

impl Stage for Eccentric {
    fn angle_rad(&mut self, angle_rad: f64) -> f64 {
        let turned = self.per_rev * angle_rad;
        let read = angle_rad + self.amplitude_rad * libm::sin(turned + self.phase_rad);
        match self.second {
            None => read,
            Some((amplitude_rad, phase_rad)) => {
                read + amplitude_rad * libm::sin(2.0 * turned + phase_rad)
            }
        }
    }
}

/// Torque error of a current controller whose current sensor has noise and finite resolution. The control law is not informed of
/// the error.
///
/// Quantisation is modelled as an error uniformly distributed within half a step (Widrow, IRE Trans. Circuit Theory 3(4) 266,
/// 1956). The model holds if the current controller runs many times per tick and the current ripples by more than a step.
#[derive(Debug, Clone, Copy)]
pub struct CurrentError {
    /// Root mean square of the sensor's noise, as torque, N·m.
    pub rms_n_m: f64,
    /// Resolution of the current sensor, as torque, N·m.
    pub step_n_m: f64,
    /// Random-number sequence of noise and quantisation error.
    pub stream: Stream,
}

impl Stage for CurrentError {
    const TOLD: bool = false;

    fn torque_n_m(&mut self, torque_n_m: f64) -> f64 {
        let noise = self.rms_n_m * self.stream.normal();
        torque_n_m + noise + self.step_n_m * (self.stream.uniform() - 0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_of_other_purposes_and_seeds_are_others() {
        let first = |seed, channel| Stream::new(seed, channel).uniform();
        let mut all: Vec<u64> = [Channel::Sensor, Channel::Current, Channel::Lost]
            .into_iter()
            .flat_map(|channel| (0..20).map(move |seed| first(seed, channel).to_bits()))
            .collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 60);
        assert_eq!(first(7, Channel::Sensor), first(7, Channel::Sensor));
    }

    /// Tests that mean, variance and higher moments lie within five standard deviations of their expected values.
    #[test]
    fn normal_numbers_have_the_moments_of_the_normal_distribution() {
        let count = 200_000;
        let mut stream = Stream::new(3, Channel::Sensor);
        let numbers: Vec<f64> = (0..count).map(|_| stream.normal()).collect();
        let n = f64::from(count);
        let moment = |power: i32| numbers.iter().map(|x| x.powi(power)).sum::<f64>() / n;
        // Variances of the sample moments: 1, 2, 15 and 96 over n.
        for (power, expected, variance) in
            [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0)]
        {
            let found = moment(power);
            let spread = (variance / n).sqrt();
            assert!((found - expected).abs() < 5.0 * spread, "{power}: {found}");
        }
        // The noise is white: neighbouring numbers, such as the two of a pair, are not correlated.
        for lag in 1..=8 {
            let sum: f64 = numbers.windows(lag + 1).map(|w| w[0] * w[lag]).sum();
            assert!((sum / n).abs() < 5.0 / n.sqrt(), "lag {lag}: {}", sum / n);
        }
    }
}
