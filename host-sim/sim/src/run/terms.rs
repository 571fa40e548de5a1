//! Criteria by which a run is judged, such as the threshold of a limit cycle. They follow from the scene before the first tick.

use super::measure::Wiggle;
use super::tick::Tick;
use crate::scene::{MotionSpec, Scene};

/// Largest motion of the device during a hold that still counts as a limit cycle, rad peak to peak. With a larger motion the run
/// counts as unstable.
const UNSTABLE_RAD: f64 = 0.25;
/// Encoder counts per turn that set the threshold of a limit cycle for a scene without an encoder.
const ASSUMED_COUNTS: f64 = 40_000.0;
/// Least time from the start of a rhythmic motion to its measurement, s, so that the transient of the press has died away.
const SETTLING_S: f64 = 0.5;

/// Criteria by which a run is judged, computed from its scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Terms {
    /// Whether the main wall `[wall]` acts. Measures of a wall are taken only if it does.
    pub has_wall: bool,
    /// Whether the scene has an environment besides `[wall]`: detents, end stops, further walls or a torque profile.
    pub has_more: bool,
    /// Position `x_s` of the wall's surface, rad.
    pub surface_rad: f64,
    /// Stiffness `k_de` that the wall should display, N·m/rad.
    pub k_desired: f64,
    /// Inertia of the device, kg·m².
    pub inertia_kg_m2: f64,
    /// Control period, s.
    pub period_s: f64,
    /// Largest motion in a hold that counts as rest, rad peak to peak: four encoder counts. A larger motion is a limit cycle.
    pub limit_cycle_rad: f64,
    /// Largest motion in a hold that counts as a limit cycle, rad peak to peak. A larger motion counts as unstable.
    pub unstable_rad: f64,
    /// Whether the hand's motion is a recording. Its holds must then be detected during the run.
    pub recorded: bool,
    /// Peak-to-peak motion that the hand's tremor adds to its rest point, rad.
    pub tremor_rad: f64,
    /// Force at which the torque limit counts as reached, N·m: 0.1 % below the lower limit of device and law.
    pub force_limit_n_m: f64,
    /// Steady holds of the hand, each as its first tick and the tick after its last. The last hold is the press.
    pub holds: Vec<(u64, u64)>,
    /// The press of the hand; `None` for a motion without a press.
    pub press: Option<Press>,
    /// The hand's rhythmic motion inside the wall; `None` if the scene has no such motion, or one too short to be measured.
    pub wiggle: Option<Wiggle>,
    /// First tick, and tick after the last, of the measurement of torque ripple. It covers the rhythmic motion if there is one,
    /// else the second half of the press, else all ticks.
    pub ripple: (u64, u64),
    /// Number of ticks (control periods) in the run.
    pub ticks: u64,
}

/// A press of the hand into the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Press {
    /// Largest static torque of the hand's push, N·m, including the amplitude of a rhythmic motion.
    pub push_n_m: f64,
    /// Tick at which the ramp of the press ends.
    pub ramp_end: u64,
    /// Tick at which the hand begins to let go.
    pub release: u64,
}

impl Terms {
    /// Whether the wall is touched in a tick: the device is inside the wall, or the wall pushes already. A law that predicts the
    /// position pushes up to a control period before the device is inside. In a scene with an environment only the angle counts,
    /// because detents push, too.
    #[must_use]
    pub fn touches(&self, tick: &Tick) -> bool {
        tick.angle_rad > self.surface_rad || (tick.force_n_m > 0.0 && !self.has_more)
    }

    /// Computes the criteria for a scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let rate = f64::from(scene.timing.rate_hz);
        let ticks = scene.timing.ticks();
        let tick = |seconds: f64| ((seconds * rate).round() as u64).min(ticks);
        let step = scene
            .encoder
            .as_ref()
            .map_or(std::f64::consts::TAU / ASSUMED_COUNTS, |encoder| {
                encoder.step_rad()
            });
        let device_limit = scene.device.torque_limit_n_m.unwrap_or(f64::INFINITY);
        let holds: Vec<_> = scene
            .operator
            .motion
            .holds_s()
            .into_iter()
            .map(|(from, to)| (tick(from), tick(to)))
            .collect();
        let rhythm = rhythm_s(&scene.operator.motion);
        let window = |(from, to): (f64, f64)| (tick(from), tick(to));
        Self {
            has_wall: (scene.environment.as_ref()).is_none_or(|around| around.first_wall),
            has_more: scene.environment.is_some(),
            surface_rad: scene.wall.surface_rad,
            k_desired: scene.wall.k_desired_n_m_per_rad,
            inertia_kg_m2: scene.device.inertia_kg_m2,
            period_s: scene.timing.period_s(),
            limit_cycle_rad: 4.0 * step,
            unstable_rad: UNSTABLE_RAD,
            recorded: matches!(scene.operator.motion, MotionSpec::Recorded(_)),
            tremor_rad: match (&scene.operator.tremor, scene.operator.hand()) {
                (Some(tremor), Some(_)) => 2.0 * tremor.amplitude_rad,
                _ => 0.0,
            },
            // A force limited by the law may be one step of the number format below the limit, because it is rounded towards zero.
            force_limit_n_m: device_limit.min(scene.law.force_limit_n_m) * (1.0 - 1e-3),
            press: push(&scene.operator.motion).and_then(|(push_n_m, ramp_end_s)| {
                holds.last().map(|&(_, release)| Press {
                    push_n_m,
                    ramp_end: tick(ramp_end_s),
                    release,
                })
            }),
            wiggle: rhythm.map(|(frequency_hz, span)| Wiggle {
                frequency_hz,
                window: window(span),
            }),
            ripple: rhythm
                .map(|(_, span)| span)
                .or_else(|| scene.operator.motion.hold_window_s())
                .map_or((0, ticks), window),
            holds,
            ticks,
        }
    }
}

/// Largest static torque of a press, N·m, and the time at which its ramp ends, s. `None` for a motion without a press.
fn push(motion: &MotionSpec) -> Option<(f64, f64)> {
    match motion {
        MotionSpec::RampAndHold(m) => Some((m.push_torque_n_m, m.start_s + m.ramp_s)),
        MotionSpec::PressWiggleRelease(m) => Some((
            m.push_torque_n_m + m.wiggle_amplitude_n_m,
            m.start_s + m.ramp_s,
        )),
        MotionSpec::TouchAndPress(m) => Some((
            m.push_torque_n_m,
            m.start_s + m.touch_ramp_s + m.touch_s + m.ramp_s,
        )),
        MotionSpec::None | MotionSpec::Tap(_) | MotionSpec::Turn(_) | MotionSpec::Recorded(_) => {
            None
        }
    }
}

/// Frequency of the rhythmic motion, Hz, with start and end of its measurement, s. The measurement covers the last whole periods at
/// full amplitude.
///
/// It starts at the earliest after the first period, or after half a second if that is later. It ends before the half period over
/// which the motion fades. `None` if no whole period is left.
fn rhythm_s(motion: &MotionSpec) -> Option<(f64, (f64, f64))> {
    let MotionSpec::PressWiggleRelease(m) = motion else {
        return None;
    };
    let period_s = 1.0 / m.wiggle_frequency_hz;
    let start_s = m.start_s + m.ramp_s;
    let end_s = start_s + m.wiggle_s - 0.5 * period_s;
    let from_s = start_s + period_s.max(SETTLING_S);
    // The tolerance of 1e-9 counts a value slightly below a whole number as that number.
    let periods = ((end_s - from_s) / period_s + 1e-9).floor();
    (m.wiggle_amplitude_n_m > 0.0 && periods >= 1.0)
        .then_some((m.wiggle_frequency_hz, (end_s - periods * period_s, end_s)))
}
