//! The three-phase bridge of a motor, represented by its average voltages over a PWM period.

/// State of the bridge in a PWM period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drive {
    /// All six switches are open.
    Off,
    /// The bridge switches. The numbers are the PWM compare values of phases A, B and C; the voltage of a phase rises with its
    /// compare value.
    On([u16; 3]),
}

/// A three-phase bridge and its supply voltage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bridge {
    /// Voltage of the supply (bus), V.
    pub bus_v: f64,
    /// PWM compare value at which a phase is at the bus voltage during the whole PWM period.
    pub top: u16,
    /// Dead time as a fraction of the PWM period, dead time times PWM frequency; 0 for an ideal bridge. The dead time lowers a
    /// phase's average voltage while current flows into the motor, and raises it while current flows out.
    pub dead_share: f64,
    /// Forward voltage of the diode in parallel to a switch, V.
    pub diode_v: f64,
}

impl Bridge {
    /// Makes a bridge without dead time. Its diodes have a forward voltage of 0.7 V.
    #[must_use]
    pub const fn ideal(bus_v: f64, top: u16) -> Self {
        Self {
            bus_v,
            top,
            dead_share: 0.0,
            diode_v: 0.7,
        }
    }

    /// Average voltages of the phases against ground over a PWM period, V. The sign of each phase current decides whether the dead
    /// time raises or lowers the voltage.
    #[must_use]
    pub fn voltages(&self, duties: [u16; 3], currents_a: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|phase| {
            let share = f64::from(duties[phase]) / f64::from(self.top);
            let i = currents_a[phase];
            // Without a current the dead time has no effect.
            let lost = if i == 0.0 {
                0.0
            } else {
                self.dead_share.copysign(i)
            };
            self.bus_v * (share - lost).clamp(0.0, 1.0)
        })
    }
}
