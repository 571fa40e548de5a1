//! The three-phase bridge, averaged over a PWM period.

/// State of the bridge in a period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drive {
    /// All six switches open.
    Off,
    /// Compare values of phases A, B, C; a phase's voltage rises with its value.
    On([u16; 3]),
}

/// A bridge and its supply.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bridge {
    /// Bus voltage, V.
    pub bus_v: f64,
    /// Compare value at which a phase is always at the bus.
    pub top: u16,
    /// Part of a period that is lost to dead time, per phase, `t_d f_pwm`; 0 for an ideal bridge. A current into the motor
    /// then lowers the phase's average, one out of it raises it.
    pub dead_share: f64,
    /// Forward voltage of the diodes, V.
    pub diode_v: f64,
}

impl Bridge {
    /// Ideal switches at a bus voltage.
    #[must_use]
    pub const fn ideal(bus_v: f64, top: u16) -> Self {
        Self {
            bus_v,
            top,
            dead_share: 0.0,
            diode_v: 0.7,
        }
    }

    /// Average phase voltages against ground, V, for the currents that flow.
    #[must_use]
    pub fn voltages(&self, duties: [u16; 3], currents_a: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|phase| {
            let share = f64::from(duties[phase]) / f64::from(self.top);
            let i = currents_a[phase];
            // No current, no direction.
            let lost = if i == 0.0 {
                0.0
            } else {
                self.dead_share.copysign(i)
            };
            self.bus_v * (share - lost).clamp(0.0, 1.0)
        })
    }
}
