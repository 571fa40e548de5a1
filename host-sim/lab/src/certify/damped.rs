//! Matrices of the control law `spring-damper` with a filtered velocity.
//!
//! The states are those of the filters in `touchstone_control::velocity`. A first-order filter has the last position and its
//! velocity, a Kalman filter its three states, a window of `n` ticks the last `n` positions. An adaptive window may stay at any
//! length, so each length is a phase. The matrices do not describe the moment when the length changes.

use super::linear_law::{LinearLaw, Phase};
use touchstone_control::law::Damped;
use touchstone_control::velocity::Velocity;

/// The linear phases in which the control law can stay.
pub(super) fn phases(law: &Damped<f64>) -> Vec<Phase> {
    let (k, b) = (law.spring.desired.0, law.spring.damping.0);
    let phase = |name, law| Phase { name, law };
    match law.velocity {
        Velocity::Smoothed(filter) => {
            let smoothed = LinearLaw::of(2, |state, e, _| {
                state[1] += filter.share * (e - state[0] - state[1]);
                state[0] = e;
                k * e + b * state[1]
            });
            vec![phase("filtered velocity", smoothed)]
        }
        Velocity::Tracker(tracker) => {
            let [alpha, beta, gamma] = tracker.correction;
            let tracked = LinearLaw::of(3, |state, e, _| {
                let [x, v, g] = [0, 1, 2].map(|i| state[i]);
                let expected = x + v + 0.5 * g;
                let surprise = e - expected;
                state[0] = expected + alpha * surprise;
                state[1] = v + g + beta * surprise;
                state[2] = g + gamma * surprise;
                k * e + b * state[1]
            });
            vec![phase("Kalman velocity", tracked)]
        }
        Velocity::Window(window) => (1..=usize::from(window.longest))
            .map(|ticks| {
                let over = LinearLaw::of(ticks, |past, e, _| {
                    let way = e - past[ticks - 1];
                    past.rotate_right(1);
                    past[0] = e;
                    k * e + b * way / ticks as f64
                });
                let name = if ticks == 1 {
                    "window of one tick"
                } else {
                    "window of several ticks"
                };
                phase(name, over)
            })
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::law::Phases;
    use touchstone_control::{
        AnyLaw, Controller, LawKind, Position, Settings, StatesKind, VelocityKind,
    };

    /// Checks that the matrices give the same forces as the control law, around a point of rest inside the wall.
    #[test]
    fn the_matrices_say_what_the_law_says() {
        let all = [
            VelocityKind::Filtered,
            VelocityKind::Kalman,
            VelocityKind::KalmanAcceleration,
            VelocityKind::Foaw,
        ];
        for from in all {
            let mut settings = Settings {
                law: LawKind::SpringDamper,
                states: StatesKind::Measured,
                ..Settings::thesis()
            };
            settings.velocity.from = from;
            let phases = Phases::of(&AnyLaw::<f64>::new(&settings).unwrap()).lasting;
            // During a ramp the adaptive window has its largest length.
            let model = phases.last().unwrap().law.on_measured();
            let mut law = Controller::<f64>::new(&settings).unwrap();
            let deep = 0.05;
            let rest = (0..600).map(|_| law.tick(Position(deep)).0).last().unwrap();
            let mut state = vec![0.0; model.a.nrows()];
            let mut largest = 0.0_f64;
            for n in 0..400_i32 {
                let moved = if from == VelocityKind::Foaw {
                    1e-5 * f64::from(n)
                } else {
                    1e-3 * (f64::from(n) / 9.0).sin()
                };
                let force = law.tick(Position(deep + moved)).0 - rest;
                let expected =
                    model.c.iter().zip(&state).map(|(c, s)| c * s).sum::<f64>() + model.d * moved;
                let next = &model.a * nalgebra::DVector::from_vec(state.clone()) + &model.b * moved;
                state = next.iter().copied().collect();
                // During its first ticks the window is still shorter.
                if from != VelocityKind::Foaw || n > 20 {
                    assert!(
                        (force - expected).abs() < 1e-9,
                        "{from:?} {n}: {force} {expected}"
                    );
                }
                largest = largest.max(force.abs());
            }
            assert!(largest > 4e-3, "{from:?}");
        }
    }
}
