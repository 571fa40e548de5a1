//! What a setting is judged by: every figure divided by what it may be, so that 1 is the limit of each.

use crate::bench::{Deed, Knob, PUSH_N_M, RAMP_S, SETTLE_S, Tick, play};
use std::f64::consts::TAU;
use touchstone_control::{Controller, Fixed32};
use touchstone_world::plant::Hand;

/// Worst figures of one knob and grip.
#[derive(Debug, Clone, Copy, Default)]
pub struct Figures {
    /// Peak penetration over `F/k_de`.
    pub peak: f64,
    /// Largest error of stiffness, in force, deeper than ten counts; after half a count: share of `k_de e`.
    pub moment: f64,
    /// The same while the hand lets go.
    pub release: f64,
    /// Peak penetration of the light touch over `F/k_de` of the press.
    pub touch: f64,
    /// The same from 50 ms after the ramp of the press, while it is held.
    pub held: f64,
    /// Largest deviation of the modulus of `F/x` from `k_de`, share, and of its phase, degrees (of either sign).
    pub modulus: f64,
    pub phase_deg: f64,
    /// Root mean square of the change of torque from tick to tick while moving, N·m.
    pub ripple_n_m: f64,
    /// Lowest energy of the wall's port and of the hand's port, J.
    pub wall_j: f64,
    pub hand_j: f64,
    /// Motion at the end of the hold, peak to peak, counts.
    pub restless_counts: f64,
}

impl Figures {
    pub fn worst(self, other: Self) -> Self {
        Self {
            peak: self.peak.max(other.peak),
            moment: self.moment.max(other.moment),
            release: self.release.max(other.release),
            touch: self.touch.max(other.touch),
            held: self.held.max(other.held),
            modulus: self.modulus.max(other.modulus),
            phase_deg: self.phase_deg.max(other.phase_deg),
            ripple_n_m: self.ripple_n_m.max(other.ripple_n_m),
            wall_j: self.wall_j.min(other.wall_j),
            hand_j: self.hand_j.min(other.hand_j),
            restless_counts: self.restless_counts.max(other.restless_counts),
        }
    }

    /// Each figure over its limit; `late` where the delay is half a millisecond or more.
    pub fn shares(&self, late: bool, ripple_limit: f64) -> [f64; 7] {
        [
            (self.peak - 1.0) / if late { 0.3 } else { 0.1 },
            self.moment / 0.15,
            self.release / 0.15,
            self.held / 0.05,
            self.modulus / 0.1,
            self.phase_deg / 12.0,
            self.ripple_n_m / ripple_limit,
        ]
    }
}

fn press(knob: &Knob, hand: &Hand, k: f64, wall: &Controller<Fixed32>, deed: &Deed) -> Figures {
    let step = TAU / f64::from(knob.counts_per_rev);
    let mut f = Figures::default();
    let (ramp_end, hold_end) = (deed.ramp_end_s(), deed.hold_end_s());
    let (mut low, mut high) = (f64::MAX, f64::MIN);
    let take = |t: &Tick| {
        let e = t.penetration_rad;
        f.wall_j = f.wall_j.min(t.wall_j);
        f.hand_j = f.hand_j.min(t.hand_j);
        // The brisk touch before it is a blow: what inertia carries into it is no matter of the law.
        if t.time_s < ramp_end - RAMP_S {
            f.touch = f.touch.max(e * k / PUSH_N_M);
            return;
        }
        f.peak = f.peak.max(e * k / PUSH_N_M);
        if e > 10.0 * step {
            let off = ((t.force_n_m - k * e).abs() - 0.5 * k * step).max(0.0) / (k * e);
            if t.time_s < hold_end {
                f.moment = f.moment.max(off);
            } else {
                f.release = f.release.max(off);
            }
            if t.time_s > ramp_end + 0.05 && t.time_s < hold_end {
                f.held = f.held.max(off);
            }
        } else if t.time_s > ramp_end && t.time_s < hold_end {
            // Not there at all.
            f.held = f64::INFINITY;
        }
        if t.time_s > hold_end - 0.25 && t.time_s < hold_end {
            low = low.min(e);
            high = high.max(e);
        }
    };
    let mut wall = *wall;
    if play(knob, hand, deed, k, &mut wall, take).is_none() {
        f.held = f64::INFINITY;
    }
    f.restless_counts = (high - low) / step;
    f
}

fn wiggle(knob: &Knob, hand: &Hand, k: f64, wall: &Controller<Fixed32>, hz: f64) -> Figures {
    let deed = Deed::Wiggle {
        frequency_hz: hz,
        seconds: (1.0 / hz).max(1.0),
    };
    let from = deed.ramp_end_s() + SETTLE_S;
    let (mut force, mut way, mut changes, mut n) = ([0.0; 2], [0.0; 2], 0.0, 0.0);
    let (mut last, mut outside) = (f64::NAN, false);
    let take = |t: &Tick| {
        if t.time_s < from {
            last = t.force_n_m;
            return;
        }
        let (sine, cosine) = (TAU * hz * (t.time_s - from)).sin_cos();
        force[0] += t.force_n_m * cosine;
        force[1] -= t.force_n_m * sine;
        way[0] += t.penetration_rad * cosine;
        way[1] -= t.penetration_rad * sine;
        changes += (t.force_n_m - last) * (t.force_n_m - last);
        n += 1.0;
        last = t.force_n_m;
        outside |= t.penetration_rad < 0.0;
    };
    let mut wall = *wall;
    let done = play(knob, hand, &deed, k, &mut wall, take);
    let size = |z: [f64; 2]| z[0].hypot(z[1]);
    let phase = (force[1].atan2(force[0]) - way[1].atan2(way[0])).to_degrees();
    let phase = (phase + 540.0).rem_euclid(360.0) - 180.0;
    let bad = done.is_none() || outside;
    Figures {
        modulus: if bad {
            9.0
        } else {
            (size(force) / size(way) / k - 1.0).abs()
        },
        phase_deg: if bad { 180.0 } else { phase.abs() },
        ripple_n_m: f64::sqrt(changes / f64::max(n, 1.0)),
        ..Figures::default()
    }
}

/// Press and motions of one knob and grip.
pub fn figures(
    knob: &Knob,
    hand: &Hand,
    k: f64,
    wall: &Controller<Fixed32>,
    deed: &Deed,
    frequencies_hz: &[f64],
) -> Figures {
    frequencies_hz
        .iter()
        .map(|hz| wiggle(knob, hand, k, wall, *hz))
        .fold(press(knob, hand, k, wall, deed), Figures::worst)
}
