//! Tests that boards without a broken part raise no fault in hard use. Hands are fast, and the values of motors and knobs differ
//! by up to 30 % from the settings. Sensors are noisy, and one reading in a thousand is bad. The bridge has dead time, the motor
//! has cogging. `TOUCHSTONE_TICKS` sets the control ticks (ms) of each of a board's 40 cases; 900,000 are ten hours a board.

use rayon::prelude::*;
use std::f64::consts::TAU;
use touchstone_drive::DeviceSettings;
use touchstone_protocol::Board;
use touchstone_tests::single_faults::good;
use touchstone_world::plant::train::Harmonic;
use touchstone_world::plant::{FIRM, LIGHT};

/// Resistance, torque constant and inductance of the motor, and inertia of the knob, as multiples of the values in the settings.
const PARTS: [[f64; 4]; 5] = [
    [1.0, 1.0, 1.0, 1.0],
    [1.3, 0.7, 1.3, 1.3],
    [0.7, 1.3, 0.7, 0.7],
    [1.3, 1.3, 1.3, 0.7],
    [0.7, 0.7, 0.7, 1.3],
];

/// Cogging torque of a motor with 12 slots and 14 poles: amplitude as a fraction of the largest torque, and periods per turn. A
/// perfect motor has 84 periods; unequal magnets add 12.
const COGGING: [(f64, f64); 2] = [(0.01, 84.0), (0.003, 12.0)];

/// How a hand moves. Its rest point is given in rad from the wall's surface, as a function of the time in ms.
#[derive(Debug, Clone, Copy)]
enum Stroke {
    /// To and fro with this frequency in Hz. No two strokes are alike, and now and then there is a rest deep in the wall.
    Swings(f64),
    /// Turns the knob at 30 rad/s up to the wall, stays a little inside, and comes back.
    Flicks,
}

impl Stroke {
    fn wants_rad(self, ms: u32) -> f64 {
        match self {
            Self::Swings(hertz) => {
                let phase = f64::from(ms) * hertz * TAU / 1e3;
                let deep = (phase / 17.0).sin();
                0.5 * deep + 0.4 * phase.sin() + 0.1 * (phase * 2.7).sin()
            }
            Self::Flicks => {
                let (flick, ms) = (ms / 700, f64::from(ms % 700));
                let inside = 0.05 * f64::from(1 + flick % 5);
                let back = (0.004 * (ms - 300.0)).clamp(0.0, 0.9 + inside);
                (0.03 * ms - 0.9).min(inside) - back
            }
        }
    }
}

#[test]
fn boards_without_a_broken_part_raise_no_fault_in_hard_use() {
    let ticks =
        std::env::var("TOUCHSTONE_TICKS").map_or(3_000, |text| text.parse().expect("ticks"));
    let mut cases = Vec::new();
    for board in Board::ALL {
        for parts in PARTS {
            for hand in [LIGHT, FIRM] {
                for (stroke, dead_share) in [
                    (Stroke::Swings(1.0), 0.01),
                    (Stroke::Swings(3.0), 0.0),
                    (Stroke::Swings(6.0), 0.01),
                    (Stroke::Flicks, 0.01),
                ] {
                    cases.push((board, parts, hand, stroke, dead_share));
                }
            }
        }
    }
    cases
        .into_par_iter()
        .for_each(|(board, parts, hand, stroke, dead_share)| {
            let (mut knob, surface_rad) = good(board, parts, &hand);
            knob.rig.bridge.dead_share = dead_share;
            // The cases with dead time have cogging too.
            let largest: f64 = DeviceSettings::defaults(board).law.force_limit_n_m.to_num();
            knob.rig.cogging = COGGING
                .into_iter()
                .filter(|_| dead_share > 0.0)
                .map(|(share, per_rev)| Harmonic {
                    amplitude: share * largest,
                    per_rev,
                    phase: 0.4,
                })
                .collect();
            let mut touched = 0;
            for tick in 0..ticks {
                knob.rest_rad = surface_rad + stroke.wants_rad(tick);
                knob.tick();
                touched += u32::from(knob.record.force.0 != 0);
                let fault = knob.device.fault();
                assert_eq!(
                    fault, None,
                    "{board:?} {parts:?} {hand:?} {stroke:?}, tick {tick}"
                );
            }
            // A light hand follows slowly, and hardly presses.
            let least = if hand == FIRM { ticks / 50 } else { 1 };
            assert!(
                touched >= least,
                "{board:?} {stroke:?}: {touched} of {ticks}"
            );
        });
}
