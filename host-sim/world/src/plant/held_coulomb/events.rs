//! Advances an interval with stops and starts of the device, which are located one after the other on power series of the exact
//! solution.

use super::HeldCoulomb;
use crate::plant::held::drive;
use crate::plant::state::State;
use crate::plant::stepper::{Loss, Stepper};
use crate::plant::taylor::{RECIPROCAL, Series, TERMS};

/// Largest number of stops and starts that are followed in one interval. A plant with usual values has one or two.
const MAX_EVENTS: u32 = 8;

/// Motion of the device between two events (stops or starts).
#[derive(Clone, Copy)]
pub(super) enum Mode {
    /// The device turns in the direction of this sign (1 or -1).
    Sliding(f64),
    Stuck,
}

/// The exact motion over a part of an interval, as power series in the elapsed fraction (0 to 1) of that part.
struct Piece {
    v: Series,
    strain: Series,
    v_h: Series,
    length_s: f64,
}

impl HeldCoulomb {
    /// Advances by an interval, from one stop or start to the next. Returns `None`, and leaves the state unchanged, if there is
    /// neither in the interval.
    ///
    /// After [`MAX_EVENTS`] stops and starts the device is held for the rest of the interval. A force on a body at rest does no
    /// work, so this error adds no energy.
    #[cold]
    #[inline(never)]
    pub(super) fn follow<const LOSS: bool>(
        &self,
        state: &mut State<4>,
        torque: f64,
        rest: f64,
        mut mode: Mode,
    ) -> Option<Loss> {
        let interval = self.sliding.interval_s();
        let mut now = *state;
        let mut loss = Loss::default();
        let mut events = 0;
        let mut elapsed = 0.0;
        while elapsed < interval {
            let piece = self.expand(
                &now,
                torque,
                rest,
                mode,
                (interval - elapsed).min(self.piece_s),
            );
            let event = match mode {
                Mode::Sliding(sign) => {
                    let speed = Series::combine(sign, &piece.v, 0.0, &piece.v, 0.0);
                    // A root that rounding puts on the end of the piece must not be lost between two pieces.
                    let at_end = || (speed.at(1.0) <= 0.0).then_some(1.0);
                    speed
                        .first_negative()
                        .or_else(at_end)
                        .map(|t| (t, Mode::Stuck))
                }
                Mode::Stuck if events < MAX_EVENTS => self.breaks_away(&piece, torque),
                Mode::Stuck => None,
            };
            let until = event.map_or(1.0, |(t, _)| t);
            if LOSS {
                loss += self.piece_loss(&piece, mode, until);
            }
            match mode {
                Mode::Sliding(_) => {
                    now.0[0] += piece.length_s * piece.v.integral(until);
                    now.0[1] = piece.v.at(until);
                }
                // All coefficients of the velocity's series are zero.
                Mode::Stuck => now.0[1] = 0.0,
            }
            now.0[2] += piece.length_s * piece.v_h.integral(until);
            now.0[3] = piece.v_h.at(until);
            elapsed += piece.length_s * until;
            if let Some((t, next)) = event {
                events += 1;
                mode = next;
                if matches!(mode, Mode::Stuck) {
                    now.0[1] = 0.0;
                    let at_rest = self.torque_at_rest(piece.strain.at(t), now.0[3], torque);
                    if at_rest.abs() > self.breakaway && events < MAX_EVENTS {
                        mode = Mode::Sliding(1.0_f64.copysign(at_rest));
                    }
                }
            }
        }
        if events == 0 {
            return None;
        }
        *state = now;
        Some(loss)
    }

    /// Elapsed fraction of the piece at which a stuck device starts to move, with the direction of the motion. `None` if it stays
    /// stuck.
    fn breaks_away(&self, piece: &Piece, torque: f64) -> Option<(f64, Mode)> {
        let hand = &self.sliding.hand;
        let (k_p, b_p) = (hand.pad_stiffness, hand.pad_damping);
        [1.0, -1.0]
            .into_iter()
            .filter_map(|sign| {
                // Torque that is missing to break away in this direction, N·m.
                let spare = self.breakaway - sign * torque;
                Series::combine(-sign * k_p, &piece.strain, -sign * b_p, &piece.v_h, spare)
                    .first_negative()
                    .map(|t| (t, Mode::Sliding(sign)))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Power series of the motion from `state` over the next `length_s` seconds, with the device sliding or stuck (`mode`).
    fn expand(&self, state: &State<4>, torque: f64, rest: f64, mode: Mode, length_s: f64) -> Piece {
        let (device, hand) = (&self.sliding.device, &self.sliding.hand);
        let [v, strain, v_h, hand_strain, _] = drive(state, torque, rest);
        let mut piece = Piece {
            v: Series::ZERO,
            strain: Series::ZERO,
            v_h: Series::ZERO,
            length_s,
        };
        let mut spring = hand_strain;
        (piece.v.0[0], piece.strain.0[0], piece.v_h.0[0]) = (v, strain, v_h);
        for (k, reciprocal) in RECIPROCAL.into_iter().enumerate().take(TERMS - 1) {
            let (v, strain, v_h) = (piece.v.0[k], piece.strain.0[k], piece.v_h.0[k]);
            let step = length_s * reciprocal;
            let pad = hand.pad_stiffness * strain + hand.pad_damping * (v_h - v);
            if let Mode::Sliding(sign) = mode {
                let held = if k == 0 {
                    torque - sign * self.kinetic
                } else {
                    0.0
                };
                let acceleration = (held + pad - device.damping * v) / device.inertia;
                piece.v.0[k + 1] = step * acceleration;
                // From rest a device can start only in the direction of the torque that moves it. At break-away with equal levels
                // of friction the net torque is zero, and rounding must not reverse the motion.
                if k == 0 && v == 0.0 && sign * acceleration < 0.0 {
                    piece.v.0[1] = 0.0;
                }
            }
            piece.strain.0[k + 1] = step * (v_h - v);
            piece.v_h.0[k + 1] =
                step * (hand.stiffness * spring - pad - hand.damping * v_h) / hand.inertia;
            spring = -step * v_h;
        }
        piece
    }

    /// Energy dissipated from the start of a piece of the interval up to the fraction `until` (0 to 1) of that piece.
    fn piece_loss(&self, piece: &Piece, mode: Mode, until: f64) -> Loss {
        let (device, hand) = (&self.sliding.device, &self.sliding.hand);
        let friction = match mode {
            Mode::Sliding(_) => self.kinetic * piece.v.integral(until).abs(),
            Mode::Stuck => 0.0,
        };
        let pad = Series::combine(1.0, &piece.v, -1.0, &piece.v_h, 0.0);
        let device_viscous = device.damping * piece.v.integral_of_square(until);
        let hand_viscous = hand.pad_damping * pad.integral_of_square(until)
            + hand.damping * piece.v_h.integral_of_square(until);
        Loss {
            device_j: piece.length_s * (device_viscous + friction),
            hand_j: piece.length_s * hand_viscous,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::plant::{Coulomb, Device, FIRM, HeldCoulomb, HeldLinear, State, Stepper};

    const DEVICE: Device = Device {
        inertia: 2e-5,
        damping: 3e-4,
        friction: Some(Coulomb {
            kinetic: 2e-3,
            breakaway: 3e-3,
        }),
    };
    const TORQUE: f64 = -5e-4;

    fn start(v: f64, v_h: f64) -> State<4> {
        State::from_array([0.1, v, 0.1, v_h])
    }

    /// Initial velocity with which the device comes to rest after `stop_s` seconds, to rounding. `v_h` is the velocity of the hand.
    fn velocity_that_stops_after(stop_s: f64, v_h: f64) -> f64 {
        let linear = HeldLinear::new(&DEVICE, &FIRM, stop_s).unwrap();
        let (mut low, mut high) = (0.0, 10.0);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            let mut state = start(middle, v_h);
            linear.step(&mut state, TORQUE - 2e-3, 0.1);
            if state.0[1] < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    /// Checks that a stop after `stop_s` seconds gives the same motion whether rounding puts it just before or just after a
    /// boundary.
    fn check(plant: &HeldCoulomb, stop_s: f64) {
        for hand in 0..40 {
            let v_h = 0.01 + 1e-3 * f64::from(hand);
            let around = velocity_that_stops_after(stop_s, v_h);
            let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
            for ulps in -50..=50 {
                let mut state = start(around + f64::from(ulps) * around * f64::EPSILON, v_h);
                plant.step(&mut state, TORQUE, 0.1);
                assert!(state.0[1] > -1e-15, "{ulps} ulps: {}", state.0[1]);
                plant.step(&mut state, TORQUE, 0.1);
                assert_eq!(state.0[1], 0.0, "{ulps} ulps");
                (low, high) = (low.min(state.0[0]), high.max(state.0[0]));
            }
            assert!(high - low < 1e-15, "{low} {high}");
        }
    }

    #[test]
    fn a_stop_on_the_edge_of_a_tick_is_one_stop() {
        check(&HeldCoulomb::new(&DEVICE, &FIRM, 1e-3).unwrap(), 1e-3);
    }

    #[test]
    fn a_stop_on_the_edge_of_a_series_is_one_stop() {
        let plant = HeldCoulomb::new(&DEVICE, &FIRM, 4e-3).unwrap();
        assert!(plant.piece_s < 2e-3, "the tick needs several series");
        check(&plant, plant.piece_s);
    }
}
