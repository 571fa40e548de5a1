//! A simulated device: a mass with damping on each axis, in a simulated hand. The hand is a spring whose rest point moves.

use super::{
    Applied, DataSheet, DeviceStanding, HapticDevice, HapticFault, Sensed, Workspace, length,
};
use touchstone_world::plant::{
    BareLinear, Cartesian, Device, FIRM_TRANSLATION, Hand, HeldLinear, Invalid, Limits, OMEGA3,
    OMEGA3_AXIS, State,
};

/// The parameters of a simulated device, with or without a hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeviceTwin {
    /// Limits of force, workspace, resolution and rate.
    pub limits: Limits,
    /// Mass (kg) and damping (N·s/m) of each axis.
    pub axes: [Device; 3],
    /// The hand that holds the device. Without one, the hand's rest point is used only as the start position.
    pub hand: Option<Hand>,
}

impl Default for DeviceTwin {
    /// The omega.3 with its published limits, in a firm hand.
    fn default() -> Self {
        Self {
            limits: OMEGA3,
            axes: [OMEGA3_AXIS; 3],
            hand: Some(FIRM_TRANSLATION),
        }
    }
}

/// The simulated equations of motion and their state, with a hand or for the device alone.
#[derive(Debug, Clone)]
#[expect(clippy::large_enum_variant, reason = "a device has only one")]
enum Simulated {
    Held(Cartesian<HeldLinear>, [State<4>; 3]),
    Alone(Cartesian<BareLinear>, [State<2>; 3]),
}

impl DeviceTwin {
    /// Checks that the device can be simulated.
    ///
    /// # Errors
    /// [`Invalid`] for settings that no device or hand can have.
    pub fn validate(&self) -> Result<(), Invalid> {
        self.simulated(1e-3, [0.0; 3]).map(|_| ())
    }

    fn simulated(&self, interval_s: f64, at: [f64; 3]) -> Result<Simulated, Invalid> {
        let [x, y, z] = self.axes;
        Ok(match &self.hand {
            Some(hand) => {
                let axis = |device| HeldLinear::new(&device, hand, interval_s);
                let plant = Cartesian::new([axis(x)?, axis(y)?, axis(z)?])?;
                Simulated::Held(plant, Cartesian::<HeldLinear>::at_rest(at))
            }
            None => {
                let axis = |device| BareLinear::new(&device, interval_s);
                let plant = Cartesian::new([axis(x)?, axis(y)?, axis(z)?])?;
                Simulated::Alone(plant, Cartesian::<BareLinear>::at_rest(at))
            }
        })
    }
}

impl Simulated {
    fn position(&self) -> [f64; 3] {
        match self {
            Self::Held(_, state) => Cartesian::<HeldLinear>::position(state),
            Self::Alone(_, state) => Cartesian::<BareLinear>::position(state),
        }
    }

    fn step(&mut self, force_n: [f64; 3], rest_m: [f64; 3]) {
        match self {
            Self::Held(plant, state) => plant.step(state, force_n, rest_m),
            Self::Alone(plant, state) => plant.step(state, force_n, rest_m),
        }
    }
}

/// The rest point of the hand's spring, m, as a function of time, s. It is where the hand intends to be.
pub type Rest = Box<dyn FnMut(f64) -> [f64; 3] + Send>;

/// A simulated device. Every commanded force advances the simulation by one control interval under that force.
pub struct SimulatedArm {
    sheet: DataSheet,
    twin: DeviceTwin,
    simulated: Simulated,
    rest: Rest,
    interval_s: f64,
    time_s: f64,
    engaged: bool,
}

impl SimulatedArm {
    /// A device at rest at the hand's rest point at time 0.
    ///
    /// # Errors
    /// [`HapticFault::Unusable`] for settings that no device or hand can have.
    pub fn new(twin: DeviceTwin, rate_hz: u32, mut rest: Rest) -> Result<Self, HapticFault> {
        let interval_s = 1.0 / f64::from(rate_hz);
        let simulated = twin.simulated(interval_s, rest(0.0)).map_err(|why| {
            HapticFault::Unusable(
                format!("no plant: {why}"),
                "correct inertia and damping".into(),
            )
        })?;
        let limits = twin.limits;
        let damping = twin.axes.iter().map(|axis| axis.damping);
        let least = damping.fold(f64::INFINITY, f64::min);
        Ok(Self {
            sheet: DataSheet {
                name: "simulated omega.3".into(),
                degrees: 3,
                force_n: limits.force_n,
                workspace: Workspace {
                    radius_m: limits.radius_m,
                    half_height_m: limits.half_height_m,
                },
                count_m: limits.count_m,
                rates_hz: limits.rates_hz,
                delay_s: 0.0,
                axes: Some(twin.axes),
                least_damping_n_s_per_m: Some(least),
                sets_the_pace: false,
            },
            twin,
            simulated,
            rest,
            interval_s,
            time_s: 0.0,
            engaged: false,
        })
    }

    /// The device with another name in its data sheet.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.sheet.name = name.into();
        self
    }
}

impl HapticDevice for SimulatedArm {
    fn sheet(&self) -> &DataSheet {
        &self.sheet
    }

    fn engage(&mut self) -> Result<(), HapticFault> {
        self.engaged = true;
        Ok(())
    }

    fn sense(&mut self) -> Result<Sensed, HapticFault> {
        let counts = self.twin.limits.counts(self.simulated.position());
        Ok(Sensed {
            position_m: counts.map(|n| f64::from(n) * self.twin.limits.count_m),
            fresh: true,
        })
    }

    fn command(&mut self, force_n: [f64; 3]) -> Result<Applied, HapticFault> {
        let acts = match self.engaged {
            true => self.twin.limits.limited(force_n),
            false => [0.0; 3],
        };
        self.simulated.step(acts, (self.rest)(self.time_s));
        self.time_s += self.interval_s;
        Ok(match length(force_n) > self.twin.limits.force_n {
            true => Applied::Saturated(Some(acts)),
            false => Applied::Whole,
        })
    }

    fn standing(&mut self) -> Result<DeviceStanding, HapticFault> {
        Ok(DeviceStanding {
            powered: true,
            calibrated: true,
            motors_on: self.engaged,
            switched_off: None,
        })
    }

    fn release(&mut self) -> Result<(), HapticFault> {
        self.engaged = false;
        Ok(())
    }
}
