//! A knob, a hand and a wall, tick by tick: only what the search needs, so that a second costs a tenth of a millisecond.

use std::collections::VecDeque;
use std::f64::consts::TAU;
use touchstone_control::{Controller, CountScale, Fixed32, Si};
use touchstone_world::plant::{
    Coulomb, Device, Hand, HeldCoulomb, Kinematics as _, State, Stepper,
};

/// A device as it is, which need not be as its controller believes.
#[derive(Debug, Clone, Copy)]
pub struct Knob {
    pub inertia_kg_m2: f64,
    pub damping_n_m_s_per_rad: f64,
    pub friction_n_m: f64,
    pub counts_per_rev: u32,
    pub rate_hz: u32,
    pub delay_ticks: f64,
}

/// What the hand's rest point does; torques are those on a wall that shows its stiffness.
#[derive(Debug, Clone, Copy)]
pub enum Deed {
    /// Touch lightly, press, hold, let go.
    Press { touch_s: f64, hold_s: f64 },
    /// Press, then push harder and softer.
    Wiggle { frequency_hz: f64, seconds: f64 },
}

/// One tick as it was.
#[derive(Debug, Clone, Copy)]
pub struct Tick {
    pub time_s: f64,
    pub penetration_rad: f64,
    pub force_n_m: f64,
    /// Energy that the wall's port has taken up to this sample, J.
    pub wall_j: f64,
    /// The same of the hand's port: with what device and friction took, and what moves in the device.
    pub hand_j: f64,
}

pub const PUSH_N_M: f64 = 0.1;
const TOUCH_N_M: f64 = 0.02;
pub const SWING_N_M: f64 = 0.03;
const APPROACH_RAD: f64 = 0.05;
const START_S: f64 = 0.1;
const TOUCH_RAMP_S: f64 = 0.05;
pub const RAMP_S: f64 = 0.3;
const RELEASE_S: f64 = 0.4;
/// After the ramp, before the motion is judged.
pub const SETTLE_S: f64 = 0.4;
const SURFACE: Si = Si::lit("0.5");

fn minimum_jerk(share: f64) -> f64 {
    let t = share.clamp(0.0, 1.0);
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}

impl Deed {
    pub fn ramp_end_s(&self) -> f64 {
        match self {
            Self::Press { touch_s, .. } => START_S + TOUCH_RAMP_S + touch_s + RAMP_S,
            Self::Wiggle { .. } => START_S + RAMP_S,
        }
    }

    /// Until when the press is held, or the motion goes on.
    pub fn hold_end_s(&self) -> f64 {
        match self {
            Self::Press { hold_s, .. } => self.ramp_end_s() + hold_s,
            Self::Wiggle { seconds, .. } => self.ramp_end_s() + SETTLE_S + seconds,
        }
    }

    fn end_s(&self) -> f64 {
        match self {
            Self::Press { .. } => self.hold_end_s() + RELEASE_S + 0.1,
            Self::Wiggle { .. } => self.hold_end_s(),
        }
    }

    fn rest_rad(&self, shift: f64, t: f64) -> f64 {
        let ramp = |from: f64, to: f64, start: f64, length: f64| {
            from + (to - from) * minimum_jerk((t - start) / length)
        };
        let ramp_end = self.ramp_end_s();
        let (out, inside) = (-APPROACH_RAD, PUSH_N_M * shift);
        match *self {
            Self::Press { .. } if t >= self.hold_end_s() => {
                ramp(inside, out, self.hold_end_s(), RELEASE_S)
            }
            Self::Press { .. } if t < ramp_end - RAMP_S => {
                ramp(out, TOUCH_N_M * shift, START_S, TOUCH_RAMP_S)
            }
            Self::Press { .. } => ramp(TOUCH_N_M * shift, inside, ramp_end - RAMP_S, RAMP_S),
            Self::Wiggle { frequency_hz, .. } => {
                let swing = SWING_N_M * shift * minimum_jerk((t - ramp_end) * 2.0 * frequency_hz);
                ramp(out, inside, START_S, RAMP_S)
                    + swing * (TAU * frequency_hz * (t - ramp_end)).sin()
            }
        }
    }
}

/// Plays a deed; `None` where a plant cannot be built.
pub fn play(
    knob: &Knob,
    hand: &Hand,
    deed: &Deed,
    k_desired: f64,
    wall: &mut Controller<Fixed32>,
    mut take: impl FnMut(&Tick),
) -> Option<()> {
    let friction = Coulomb {
        kinetic: knob.friction_n_m,
        breakaway: knob.friction_n_m,
    };
    let device = Device {
        inertia: knob.inertia_kg_m2,
        damping: knob.damping_n_m_s_per_rad,
        friction: Some(friction),
    };
    let period = 1.0 / f64::from(knob.rate_hz);
    let (whole, fraction) = (knob.delay_ticks.floor(), knob.delay_ticks.fract());
    let before = HeldCoulomb::new(&device, hand, fraction * period).ok()?;
    let after = HeldCoulomb::new(&device, hand, (1.0 - fraction) * period).ok()?;
    let scale = CountScale::new(knob.counts_per_rev, SURFACE)?;
    let surface: f64 = SURFACE.to_num();
    let step = TAU / f64::from(knob.counts_per_rev);
    let shift = 1.0 / hand.pad_stiffness + 1.0 / hand.stiffness + 1.0 / k_desired;
    let mut state = State::<4>::at_rest(surface - APPROACH_RAD);
    let mut queue = VecDeque::from(vec![0.0; whole as usize + 1]);
    let (mut wall_j, mut lost_j) = (0.0, 0.0);
    for tick in 0..(deed.end_s() / period) as u64 {
        let time_s = tick as f64 * period;
        let rest = surface + deed.rest_rad(shift, time_s);
        let count = (state.position() / step).round() as i64;
        let force = wall.tick(scale.penetration::<Fixed32>(count)).to_f64();
        let v = state.velocity();
        take(&Tick {
            time_s,
            penetration_rad: state.position() - surface,
            force_n_m: force,
            wall_j,
            hand_j: wall_j + lost_j + 0.5 * knob.inertia_kg_m2 * v * v,
        });
        queue.push_back(-force);
        let old = queue.pop_front().unwrap_or(0.0);
        let new = queue.front().copied().unwrap_or(old);
        for (part, torque, length) in [(&before, old, fraction), (&after, new, 1.0 - fraction)] {
            if length > 0.0 {
                let from = state.position();
                lost_j += part.step_with_loss(&mut state, torque, rest).device_j;
                wall_j -= torque * (state.position() - from);
            }
        }
    }
    Some(())
}
