//! Random devices for simulation campaigns, reproducible from a seed.
//!
//! Inertia is 1e-6 to 1e-3 kg·m², damping 1e-5 to 1e-2 N·m·s/rad, the encoder has 1e3 to 1e5 counts per turn, and the control rate
//! is 0.5 to 20 kHz. Dry friction is none for a third of the devices, otherwise 1e-4 to 0.02 N·m. Delay is none for a third,
//! otherwise up to 2 ticks. Each value is drawn evenly on a logarithmic scale, except for the delay, which is drawn evenly on a
//! linear scale.

use touchstone_sim::scene::{Encoder, Friction, Scene};

/// Damping of a fingertip, N·m·s/rad. Control laws assume the total damping of device and fingertip
/// (`device_damping_n_m_s_per_rad`).
pub const FINGERTIP: f64 = 1e-4;

/// Random number generator SplitMix64 (Steele, Lea and Flood, 2014).
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// Creates the generator of a seed; different seeds give different sequences of random numbers.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut random = Self(seed);
        random.unit();
        random
    }

    /// Draws a number evenly in `[0, 1)`.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Draws a number between `low` and `high`, evenly on a logarithmic scale.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }
}

/// A random device with its encoder and control rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomDevice {
    /// Inertia of the device, kg·m².
    pub inertia: f64,
    /// Viscous damping of the device, N·m·s/rad.
    pub damping: f64,
    /// Kinetic dry friction, N·m; two thirds of the devices have some.
    pub friction: Option<f64>,
    /// Encoder counts per turn.
    pub counts: f64,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Computational delay from sample to force, in ticks (control periods).
    pub delay_ticks: f64,
}

impl RandomDevice {
    /// Draws the next device of the generator's sequence.
    pub fn drawn(random: &mut Random) -> Self {
        let inertia = random.between(1e-6, 1e-3);
        let damping = random.between(1e-5, 1e-2);
        let friction = random.between(1e-4, 0.02);
        let has_friction = random.unit() < 2.0 / 3.0;
        let counts = random.between(1e3, 1e5).round();
        let rate_hz = random.between(500.0, 20_000.0).round();
        let late = 2.0 * random.unit();
        let is_late = random.unit() < 2.0 / 3.0;
        Self {
            inertia,
            damping,
            friction: has_friction.then_some(friction),
            counts,
            rate_hz,
            delay_ticks: if is_late { late } else { 0.0 },
        }
    }

    /// Dry friction, N·m; 0 for a device without.
    #[must_use]
    pub fn friction_n_m(&self) -> f64 {
        self.friction.unwrap_or(0.0)
    }

    /// Replaces device, encoder, rate and delay of a scene by those of this random device.
    pub fn put_into(&self, scene: &mut Scene) {
        scene.device.inertia_kg_m2 = self.inertia;
        scene.device.damping_n_m_s_per_rad = self.damping;
        scene.device.friction = self.friction.map(|kinetic_n_m| Friction {
            kinetic_n_m,
            ..Friction::default()
        });
        scene.encoder = Some(Encoder {
            counts_per_rev: self.counts,
        });
        scene.timing.rate_hz = self.rate_hz as u32;
        scene.timing.computational_delay_s = self.delay_ticks / self.rate_hz;
    }
}
