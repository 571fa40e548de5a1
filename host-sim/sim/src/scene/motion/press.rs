//! Rest point of a hand that presses on a wall: move in, push with a given torque, optionally wiggle, hold, let go.

use std::f64::consts::TAU;

use super::minimum_jerk;
use crate::scene::device::Wall;
use crate::scene::operator::{Hand, PressWiggleRelease, RampAndHold, TouchAndPress};

/// Rest point of the hand over time during a press on a wall.
///
/// Wall, fingertip pad and hand are springs in series. A static torque `τ` therefore needs the rest point `τ·(1/k_de + 1/k_pad +
/// 1/k_hand)` beyond the wall's surface. `k_de` is the requested stiffness of the wall; `k_pad` and `k_hand` are those of pad and
/// hand. With a soft hand that distance is several radians: the person pulls towards the rest point without reaching it.
#[derive(Debug, Clone)]
pub(super) struct Press {
    outside_rad: f64,
    /// Rest point at the start of the press, rad: outside the wall, or the rest point of a light touch before the press.
    from_rad: f64,
    inside_rad: f64,
    touch_start_s: f64,
    touch_ramp_s: f64,
    start_s: f64,
    ramp_s: f64,
    wiggle_s: f64,
    hold_s: f64,
    release_s: f64,
    wiggle_rad: f64,
    wiggle_hz: f64,
}

/// Stiffness below which a wall counts as absent, N·m/rad. A torque of 1 N·m would deform such a wall by a million radians.
const LEAST_STIFFNESS: f64 = 1e-6;

/// Shift of the rest point per static torque, rad/(N·m), against a wall of the requested stiffness.
///
/// A wall softer than [`LEAST_STIFFNESS`] carries no torque, so only the springs of pad and hand count.
fn shift_per_n_m(hand: &Hand, wall: &Wall) -> f64 {
    let k = wall.k_desired_n_m_per_rad;
    hand.compliance_rad_per_n_m() + if k < LEAST_STIFFNESS { 0.0 } else { 1.0 / k }
}

impl Press {
    pub fn ramp_and_hold(spec: &RampAndHold, hand: &Hand, wall: &Wall) -> Self {
        let outside_rad = wall.surface_rad - spec.approach_rad;
        Press {
            outside_rad,
            from_rad: outside_rad,
            inside_rad: wall.surface_rad + spec.push_torque_n_m * shift_per_n_m(hand, wall),
            touch_start_s: spec.start_s,
            touch_ramp_s: 0.0,
            start_s: spec.start_s,
            ramp_s: spec.ramp_s,
            wiggle_s: 0.0,
            hold_s: spec.hold_s,
            release_s: spec.release_s,
            wiggle_rad: 0.0,
            wiggle_hz: 0.0,
        }
    }

    pub fn touch_and_press(spec: &TouchAndPress, hand: &Hand, wall: &Wall) -> Self {
        let shift = shift_per_n_m(hand, wall);
        let press = RampAndHold {
            start_s: spec.start_s + spec.touch_ramp_s + spec.touch_s,
            ramp_s: spec.ramp_s,
            hold_s: spec.hold_s,
            release_s: spec.release_s,
            push_torque_n_m: spec.push_torque_n_m,
            approach_rad: spec.approach_rad,
        };
        Press {
            from_rad: wall.surface_rad + spec.touch_torque_n_m * shift,
            touch_start_s: spec.start_s,
            touch_ramp_s: spec.touch_ramp_s,
            ..Press::ramp_and_hold(&press, hand, wall)
        }
    }

    pub fn wiggle(spec: &PressWiggleRelease, hand: &Hand, wall: &Wall) -> Self {
        let shift = shift_per_n_m(hand, wall);
        let outside_rad = wall.surface_rad - spec.approach_rad;
        Press {
            outside_rad,
            from_rad: outside_rad,
            inside_rad: wall.surface_rad + spec.push_torque_n_m * shift,
            touch_start_s: spec.start_s,
            touch_ramp_s: 0.0,
            start_s: spec.start_s,
            ramp_s: spec.ramp_s,
            wiggle_s: spec.wiggle_s,
            hold_s: spec.hold_s,
            release_s: spec.release_s,
            wiggle_rad: spec.wiggle_amplitude_n_m * shift,
            wiggle_hz: spec.wiggle_frequency_hz,
        }
    }

    pub fn rest_rad(&self, time_s: f64) -> f64 {
        let pressed = time_s - self.start_s - self.ramp_s;
        let released = pressed - self.wiggle_s - self.hold_s;
        if time_s < self.start_s {
            // Before the press: at rest outside, or the light touch. A touch ramp of length 0 means that there is no touch.
            let share = if self.touch_ramp_s > 0.0 {
                (time_s - self.touch_start_s) / self.touch_ramp_s
            } else {
                0.0
            };
            self.outside_rad + (self.from_rad - self.outside_rad) * minimum_jerk(share)
        } else if pressed < 0.0 {
            let way = self.inside_rad - self.from_rad;
            self.from_rad + way * minimum_jerk((time_s - self.start_s) / self.ramp_s)
        } else if released < 0.0 {
            self.inside_rad + self.wiggle_at(pressed)
        } else {
            self.inside_rad
                - (self.inside_rad - self.outside_rad) * minimum_jerk(released / self.release_s)
        }
    }

    /// Deviation of the rest point from that of the mean push, rad, at a time in s since the wiggle began. The sine swells and
    /// fades over half a period each (less if the time is short), so that its slope has no steps.
    fn wiggle_at(&self, time_s: f64) -> f64 {
        if time_s >= self.wiggle_s || self.wiggle_rad == 0.0 {
            return 0.0;
        }
        let swell = (0.5 / self.wiggle_hz).min(0.5 * self.wiggle_s);
        let envelope =
            minimum_jerk(time_s / swell) * minimum_jerk((self.wiggle_s - time_s) / swell);
        self.wiggle_rad * envelope * libm::sin(TAU * self.wiggle_hz * time_s)
    }
}
