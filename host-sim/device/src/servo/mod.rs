//! The servo loop of a device without a control law of its own. In every control interval (tick) it reads a position, calculates a
//! force and commands it.
//!
//! ```text
//! pace -> position (stale? a number? a jump? outside?) -> law and guard -> ramp -> workspace -> limit -> force
//! ```
//!
//! Every end of the loop releases the device before anything else is done: a fault, a panic of the force law, a requested stop. If
//! this program is killed, only the device itself can switch its motors off.

mod lateness;
mod pace;
mod priority;
mod speed;

pub use lateness::TickLateness;
pub use pace::{DevicePace, Pace, RealTime, SimulatedPace, Waited};
pub use priority::{Priority, first_of_threads, real_time};
pub use speed::SpeedEstimate;

use crate::haptic::{Applied, DataSheet, HapticDevice, HapticFault, Workspace, length};

/// A force law: calculates a force from a position, once in every control interval (tick).
pub trait ForceLaw {
    /// Returns the force on the hand, N, for this position of the end effector, m.
    ///
    /// # Errors
    /// A fault after which no force may act.
    fn tick(&mut self, position_m: [f64; 3]) -> Result<[f64; 3], HapticFault>;

    /// Receives the force that acts, N. Limits or saturated motors may have made it smaller than that of [`ForceLaw::tick`].
    fn commanded(&mut self, _force_n: [f64; 3]) {}
}

/// The limits of the servo loop. They apply to every force that the force law returns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServoLimits {
    /// Largest force, N; never more than the device's own largest force.
    pub force_n: f64,
    /// Time in which the force fades in after the start, s.
    pub ramp_s: f64,
    /// The workspace in which a force may act. Outside it the force fades out over [`ServoLimits::margin_m`].
    pub workspace: Workspace,
    /// Distance outside the workspace at which the force has faded to zero, m.
    pub margin_m: f64,
    /// Distance outside the workspace that ends the servo loop, m.
    pub outside_m: f64,
    /// Largest speed between two measured positions, m/s. A higher one counts as a jump of the position and ends the servo loop.
    pub jump_m_per_s: f64,
    /// Lateness of a control interval (tick) or of a call's return, s, above which the servo loop ends: the last force acts too
    /// long.
    pub late_s: f64,
    /// Time without a new position that ends the servo loop, s.
    pub stale_s: f64,
    /// Time with saturated motors (less force than commanded) that ends the servo loop, s.
    pub saturated_s: f64,
}

impl ServoLimits {
    /// The limits for a device, from its data sheet.
    #[must_use]
    pub fn of(sheet: &DataSheet) -> Self {
        Self {
            force_n: sheet.force_n,
            ramp_s: 1.0,
            workspace: sheet.workspace,
            margin_m: 0.005,
            outside_m: 0.1,
            jump_m_per_s: 20.0,
            late_s: 0.01,
            stale_s: 0.005,
            saturated_s: 0.25,
        }
    }
}

/// How a servo loop ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Ending {
    /// The caller requested a stop.
    Asked,
    /// A fault ended the servo loop.
    Fault(HapticFault),
}

/// The result of a servo loop.
#[derive(Debug, Clone, PartialEq)]
pub struct ServoReport {
    /// Number of control intervals (ticks) that ran.
    pub ticks: u64,
    /// Number of control intervals (ticks) that were left out because the loop was late; the force was held for longer.
    pub missed_ticks: u64,
    /// Histogram of the lateness of the control intervals (ticks).
    pub lateness: TickLateness,
    /// Number of control intervals (ticks) in which the device repeated an old position.
    pub stale_ticks: u64,
    /// Number of control intervals (ticks) in which the motors gave less force than commanded.
    pub saturated_ticks: u64,
    /// Number of control intervals (ticks) in which the effector was outside the workspace.
    pub outside_ticks: u64,
    /// Largest force after all limits, N; under saturated motors the acting force, if the device reports it.
    pub force_max_n: f64,
    /// Highest speed of the end effector by the loop's own estimate, m/s.
    pub speed_max_m_per_s: f64,
    /// How the servo loop ended.
    pub ending: Ending,
    /// Whether the release of the device succeeded; the fault of a step that failed.
    pub release: Result<(), HapticFault>,
}

/// The data of a control interval (tick), after its force was commanded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServoTick {
    /// Number of the control interval (tick), from 0; missed ones are not counted.
    pub number: u64,
    /// Number of control intervals since the start of the loop, including missed ones.
    pub due: u64,
    /// Position of the end effector, m.
    pub position_m: [f64; 3],
    /// Force after all limits, N; under saturated motors the acting force, if the device reports it.
    pub force_n: [f64; 3],
}

/// A device whose motors are on. When this value goes out of scope for any reason, the device is released.
struct Engaged<'d, D: HapticDevice>(&'d mut D);

impl<D: HapticDevice> Drop for Engaged<'_, D> {
    fn drop(&mut self) {
        // Also runs after a panic. A second release does nothing, so its result is ignored.
        let _ = self.0.release();
    }
}

/// Time between two requests of the device's state (supply, motors), s.
const STANDING_S: f64 = 1e-3;

/// Runs the servo loop with a force law on a device, until `more` returns false or a fault occurs. The device is released in every
/// case.
pub fn play<D: HapticDevice>(
    device: &mut D,
    law: &mut impl ForceLaw,
    limits: &ServoLimits,
    rate_hz: u32,
    pace: &mut dyn Pace,
    mut more: impl FnMut(&ServoTick) -> bool,
) -> ServoReport {
    let mut report = ServoReport {
        ticks: 0,
        missed_ticks: 0,
        lateness: TickLateness::default(),
        stale_ticks: 0,
        saturated_ticks: 0,
        outside_ticks: 0,
        force_max_n: 0.0,
        speed_max_m_per_s: 0.0,
        ending: Ending::Asked,
        release: Ok(()),
    };
    let engaged = Engaged(device);
    let looped = looped(
        engaged.0,
        law,
        limits,
        rate_hz,
        pace,
        &mut more,
        &mut report,
    );
    // The release comes before anything is calculated or printed.
    report.release = engaged.0.release();
    if let Err(fault) = looped {
        report.ending = Ending::Fault(fault);
    }
    report
}

fn looped<D: HapticDevice>(
    device: &mut D,
    law: &mut impl ForceLaw,
    limits: &ServoLimits,
    rate_hz: u32,
    pace: &mut dyn Pace,
    more: &mut impl FnMut(&ServoTick) -> bool,
    report: &mut ServoReport,
) -> Result<(), HapticFault> {
    let interval_s = 1.0 / f64::from(rate_hz);
    let ticks_of = |seconds: f64| (seconds / interval_s).ceil().max(1.0) as u64;
    let force_limit_n = limits.force_n.min(device.sheet().force_n);
    let standing_ticks = ticks_of(STANDING_S);
    let (mut stale_run, mut saturated_run) = (0_u64, 0_u64);
    let mut speed = SpeedEstimate::new(rate_hz);
    let mut last: Option<[f64; 3]> = None;
    device.engage()?;
    pace.start();
    for number in 0.. {
        let waited = pace.wait();
        report.missed_ticks += waited.missed_ticks;
        report.lateness.take(waited.late_s);
        in_time(waited.late_s, limits)?;

        let sensed = device.sense()?;
        in_time(pace.late_s(), limits)?;
        let at = sensed.position_m;
        if !at.iter().all(|x| x.is_finite()) {
            return Err(HapticFault::NotFinite("position"));
        }
        // A tick that was missed and a position that was not read again give the device more time to move.
        let since_s = interval_s * (1 + waited.missed_ticks + stale_run) as f64;
        stale_run = if sensed.fresh { 0 } else { stale_run + 1 };
        report.stale_ticks += u64::from(!sensed.fresh);
        let stale_s = stale_run as f64 * interval_s;
        if stale_s > limits.stale_s {
            return Err(HapticFault::Stale(stale_s));
        }
        let moved = last.map_or(0.0, |was| length(std::array::from_fn(|i| at[i] - was[i])));
        if moved > limits.jump_m_per_s * since_s {
            return Err(HapticFault::Jumped(moved / since_s));
        }
        last = Some(at);
        let outside_m = limits.workspace.outside_m(at);
        if outside_m > limits.outside_m {
            return Err(HapticFault::Outside(outside_m));
        }
        report.speed_max_m_per_s = report.speed_max_m_per_s.max(speed.take(at));
        if number % standing_ticks == 0 {
            let standing = device.standing()?;
            // Without supply the motors are off too, so the supply is checked first: it is the cause to remove.
            if !standing.powered {
                return Err(HapticFault::Unusable(
                    "it has no supply".into(),
                    "switch its supply on, then start again".into(),
                ));
            }
            if let Some(cause) = standing.switched_off {
                return Err(HapticFault::SwitchedOff(cause));
            }
            if !standing.motors_on {
                return Err(HapticFault::SwitchedOff(crate::haptic::SwitchOff::Software));
            }
        }

        let wanted = law.tick(at)?;
        if !wanted.iter().all(|f| f.is_finite()) {
            return Err(HapticFault::NotFinite("force"));
        }
        report.outside_ticks += u64::from(outside_m > 0.0);
        let ramp = (number as f64 * interval_s / limits.ramp_s).min(1.0);
        let share = ramp * (1.0 - outside_m / limits.margin_m).clamp(0.0, 1.0);
        let longest = length(wanted);
        let share = share.min(force_limit_n / longest.max(force_limit_n));
        let force = wanted.map(|f| share * f);
        let applied = device.command(force)?;
        in_time(pace.late_s(), limits)?;
        let acts = match applied {
            Applied::Whole => force,
            // If the device does not report the acting force, the whole force counts as acting.
            Applied::Saturated(said) => said.unwrap_or(force),
        };
        saturated_run = match applied {
            Applied::Whole => 0,
            Applied::Saturated(_) => saturated_run + 1,
        };
        report.saturated_ticks += u64::from(saturated_run > 0);
        let saturated_s = saturated_run as f64 * interval_s;
        if saturated_s > limits.saturated_s {
            return Err(HapticFault::Saturated(saturated_s));
        }
        law.commanded(acts);
        report.force_max_n = report.force_max_n.max(length(acts));
        report.ticks += 1;
        let tick = ServoTick {
            number,
            due: number + report.missed_ticks,
            position_m: at,
            force_n: acts,
        };
        if !more(&tick) {
            break;
        }
    }
    Ok(())
}

/// Checks the lateness of a control interval. A force that acts for much longer than its interval is not controlled.
fn in_time(late_s: f64, limits: &ServoLimits) -> Result<(), HapticFault> {
    match late_s > limits.late_s {
        true => Err(HapticFault::Late(late_s)),
        false => Ok(()),
    }
}
