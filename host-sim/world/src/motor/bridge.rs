//! The three-phase bridge of a motor, as its average over a PWM period.

/// State of the bridge in a PWM period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drive {
    /// All six switches are open.
    Off,
    /// Compare values of phases A, B, C. A phase's voltage rises with its compare value.
    On([u16; 3]),
}

/// A bridge and its supply.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bridge {
    /// Bus voltage, V.
    pub bus_v: f64,
    /// Compare value at which a phase is at the bus voltage during the whole period.
    pub top: u16,
    /// Dead time as a fraction of the PWM period, `t_d f_pwm`; 0 for an ideal bridge. For a current into the motor it lowers the
    /// phase's average voltage, for a current out of the motor it raises it.
    pub dead_share: f64,
    /// Forward voltage of a switch's diode, V.
    pub diode_v: f64,
}

impl Bridge {
    /// A bridge without dead time.
    #[must_use]
    pub const fn ideal(bus_v: f64, top: u16) -> Self {
        Self {
            bus_v,
            top,
            dead_share: 0.0,
            diode_v: 0.7,
        }
    }

    /// Average voltages of the phases against ground, V. The currents' signs decide the effect of the dead time.
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
