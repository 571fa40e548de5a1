//! What is outside of the board: motor, knob, hand, supply. A stand-in until the motor of host-sim is there.

/// The world.
#[derive(Debug, Clone)]
pub struct World {
    now: u64,
    angle_rad: f64,
    bus_v: f64,
    temperature_c: f64,
}

impl World {
    /// At rest.
    #[must_use]
    pub fn new() -> Self {
        Self {
            now: 0,
            angle_rad: 0.0,
            bus_v: 24.0,
            temperature_c: 25.0,
        }
    }

    /// From now on the bridge drives the phases so.
    pub fn drive(&mut self, now: u64, _duty: [Option<f64>; 3]) {
        self.advance(now);
    }

    /// Moves on.
    pub fn advance(&mut self, now: u64) {
        self.now = self.now.max(now);
    }

    /// Angle of the shaft, turns.
    #[must_use]
    pub fn turns(&self) -> f64 {
        self.angle_rad / std::f64::consts::TAU
    }

    /// Current of a phase, A.
    #[must_use]
    pub fn current_a(&self, _phase: usize) -> f64 {
        0.0
    }

    /// Bus voltage, V.
    #[must_use]
    pub fn bus_v(&self) -> f64 {
        self.bus_v
    }

    /// Temperature of driver and motor, degrees C.
    #[must_use]
    pub fn temperature_c(&self) -> f64 {
        self.temperature_c
    }

    /// The bridge's own comparators see too much current.
    #[must_use]
    pub fn hardware_over_current(&self) -> bool {
        false
    }
}

impl Default for World {
    fn default() -> Self {
        Self::new()
    }
}
