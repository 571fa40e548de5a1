//! A wall and the forces of a distant follower on one device, behind one energy guard.
//!
//! ```text
//! position -> wall ----------------------+-> force limit -> guard -> force on the hand
//! another thread -> follower's forces ---+   (a force that is not renewed fades to 0)
//! ```

use crate::haptic::HapticFault;
use crate::servo::ForceLaw;
use crate::wall::{N, account_j, place};
use crate::{DeviceWall, Obstacle, WallSettings};
use std::sync::{Arc, Mutex, PoisonError, TryLockError};
use std::time::{Duration, Instant};
use touchstone_control::space::{Vector, VectorGuard, VectorGuardState};
use touchstone_control::{Force, Position, SettingsError};

/// How long a follower's force acts if no newer force replaces it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fading {
    /// Age up to which the whole force acts, s.
    pub whole_s: f64,
    /// Time in which the force then fades to 0, s.
    pub fade_s: f64,
}

impl Fading {
    /// Fraction of a force that acts at the age `age_s` in s: 1 at first, then falling to 0. It is 0 for an age that is NaN.
    #[must_use]
    pub fn share(&self, age_s: f64) -> f64 {
        if age_s <= self.whole_s {
            return 1.0;
        }
        let left = 1.0 - (age_s - self.whole_s) / self.fade_s;
        // A fade time of 0 can make the fraction NaN, which counts as 0.
        if left > 0.0 { left.min(1.0) } else { 0.0 }
    }
}

#[derive(Debug, Clone, Copy)]
struct Sent {
    force_n: [f64; 3],
    since: Instant,
}

/// The follower's last force. Any thread may send one; the servo loop never waits for it.
#[derive(Debug, Clone, Default)]
pub struct FollowerForces(Arc<Mutex<Option<Sent>>>);

impl FollowerForces {
    /// Replaces the follower's force on the hand, N, which is `age` old. Returns whether the force was taken: a force with a
    /// component that is not finite is refused, and the last one stays.
    #[must_use]
    pub fn send(&self, force_n: [f64; 3], age: Duration) -> bool {
        let now = Instant::now();
        // The clock has no time as early as that: the force is too old to act.
        let Some(since) = now.checked_sub(age) else {
            return self.keep(None);
        };
        force_n.iter().all(|f| f.is_finite()) && self.keep(Some(Sent { force_n, since }))
    }

    fn keep(&self, sent: Option<Sent>) -> bool {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = sent;
        true
    }

    /// The last force; `None` while a thread is sending one.
    fn seen(&self) -> Option<Option<Sent>> {
        match self.0.try_lock() {
            Ok(sent) => Some(*sent),
            Err(TryLockError::Poisoned(sent)) => Some(*sent.into_inner()),
            Err(TryLockError::WouldBlock) => None,
        }
    }
}

/// A wall and a follower's forces, as the force law of the servo loop. Their sum is limited and goes through one energy guard.
#[derive(Debug, Clone)]
pub struct FollowedWall<'m> {
    wall: Option<DeviceWall<'m>>,
    forces: FollowerForces,
    last: Option<Sent>,
    fading: Fading,
    limit: Force<N>,
    guard: Option<(VectorGuard<N>, VectorGuardState<N>)>,
    before: Option<Vector<Position<N>>>,
}

impl<'m> FollowedWall<'m> {
    /// Makes the force law in the state before the first touch, with a full energy account. Without an obstacle, only the
    /// follower's forces act.
    ///
    /// # Errors
    /// The control law or the energy guard refuses the settings.
    pub fn new(
        settings: &WallSettings,
        obstacle: Option<Obstacle<'m>>,
        forces: FollowerForces,
        fading: Fading,
    ) -> Result<Self, SettingsError> {
        let behind = WallSettings {
            guard: None,
            ..settings.clone()
        };
        let wall = obstacle.map(|obstacle| DeviceWall::new(&behind, obstacle));
        Ok(Self {
            wall: wall.transpose()?,
            forces,
            last: None,
            fading,
            limit: Force::from_f64(settings.law.force_limit.to_num()),
            guard: settings.full_guard()?,
            before: None,
        })
    }

    /// Energy in the guard's account, J; `None` without an energy guard.
    #[must_use]
    pub fn account_j(&self) -> Option<f64> {
        self.guard.as_ref().map(|(_, state)| account_j(state))
    }

    /// The follower's force that acts now, N.
    fn follower_n(&mut self) -> [f64; 3] {
        if let Some(seen) = self.forces.seen() {
            self.last = seen;
        }
        self.last.map_or([0.0; 3], |sent| {
            let share = self.fading.share(sent.since.elapsed().as_secs_f64());
            sent.force_n.map(|f| share * f)
        })
    }
}

impl ForceLaw for FollowedWall<'_> {
    fn tick(&mut self, position_m: [f64; 3]) -> Result<[f64; 3], HapticFault> {
        let wall = match &mut self.wall {
            Some(wall) => wall.tick(position_m)?,
            None => [0.0; 3],
        };
        let follower = self.follower_n();
        let wanted: [f64; 3] = std::array::from_fn(|axis| wall[axis] + follower[axis]);
        let wanted = Vector(wanted.map(Force::<N>::from_f64)).within(self.limit);
        let at = place(position_m);
        let moved = self.before.map_or(Vector::default(), |before| at - before);
        self.before = Some(at);
        let allowed = match &mut self.guard {
            Some((guard, state)) => guard.tick_at(state, at, moved, wanted),
            None => Ok(wanted),
        };
        let allowed = allowed.map_err(|_| HapticFault::Overspeed)?;
        Ok(allowed.0.map(Force::to_f64))
    }

    fn commanded(&mut self, force_n: [f64; 3]) {
        // The wall's estimator gets the whole force that moves the device.
        if let Some(wall) = &mut self.wall {
            wall.commanded(force_n);
        }
        if let Some((guard, state)) = &mut self.guard {
            guard.commanded(state, Vector(force_n.map(Force::from_f64)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guard_settings;
    use touchstone_control::{Settings, Si};
    use touchstone_world::plant::OMEGA3_AXIS;

    const FADING: Fading = Fading {
        whole_s: 0.05,
        fade_s: 0.05,
    };

    fn law(forces: &FollowerForces, fading: Fading) -> FollowedWall<'static> {
        let settings = WallSettings {
            law: Settings {
                rate_hz: 1000,
                force_limit: Si::from_num(12),
                ..Settings::thesis()
            },
            per_axis: false,
            guard: Some(guard_settings(OMEGA3_AXIS.damping, 0.00025, 1000)),
            estimator: None,
            count_m: 1e-5,
        };
        FollowedWall::new(&settings, None, forces.clone(), fading).expect("settings")
    }

    #[test]
    fn a_force_fades_to_nothing_within_the_told_time() {
        assert_eq!(FADING.share(0.0), 1.0);
        assert_eq!(FADING.share(0.05), 1.0);
        assert!((FADING.share(0.075) - 0.5).abs() < 1e-9);
        for old in [0.1, 0.2, 1e9, f64::INFINITY, f64::NAN] {
            assert_eq!(FADING.share(old), 0.0, "{old}");
        }
        let at_once = Fading {
            whole_s: 0.05,
            fade_s: 0.0,
        };
        assert_eq!((at_once.share(0.05), at_once.share(0.051)), (1.0, 0.0));
    }

    #[test]
    fn a_followers_force_acts_and_an_old_one_does_not() {
        let forces = FollowerForces::default();
        let mut law = law(&forces, FADING);
        assert_eq!(law.tick([0.0; 3]).expect("no fault"), [0.0; 3]);
        assert!(forces.send([1.0, 0.0, -2.0], Duration::ZERO));
        let [x, y, z] = law.tick([0.0; 3]).expect("no fault");
        assert!((x - 1.0).abs() < 1e-5 && y == 0.0 && (z + 2.0).abs() < 1e-5);
        assert!(!forces.send([f64::NAN, 0.0, 0.0], Duration::ZERO));
        assert!(forces.send([1.0, 0.0, -2.0], Duration::from_millis(100)));
        assert_eq!(law.tick([0.0; 3]).expect("no fault"), [0.0; 3]);
        assert!(forces.send([1.0, 0.0, -2.0], Duration::MAX));
        assert_eq!(law.tick([0.0; 3]).expect("no fault"), [0.0; 3]);
    }

    /// A follower that pushes along every motion: the energy that a hand gets stays within the guard's bound.
    #[test]
    fn what_a_follower_gives_is_bounded() {
        let forces = FollowerForces::default();
        let long = Fading {
            whole_s: 1e9,
            fade_s: 1.0,
        };
        let mut law = law(&forces, long);
        let (mut given_j, mut acts, mut at) = (0.0, 0.0, 0.0);
        for tick in 0..2000 {
            // A hand that swings at 4 Hz by 10 mm.
            let next = 0.01 * (f64::from(tick) * 1e-3 * 4.0 * std::f64::consts::TAU).sin();
            given_j += acts * (next - at);
            let push = 10.0 * (next - at).signum();
            at = next;
            assert!(forces.send([push, 0.0, 0.0], Duration::ZERO));
            let force = law.tick([at, 0.0, 0.0]).expect("no fault");
            law.commanded(force);
            acts = force[0];
        }
        // The hand moves at up to 0.25 m/s, so the trusted damping of 0.8 * 2.5 N·s/m dissipates 0.063 W on average.
        let damping_j = 0.8 * 2.5 * 0.5 * (0.01 * 4.0 * std::f64::consts::TAU).powi(2) * 2.0;
        let bound_j = 0.04 + 0.0005 * 2.0 + damping_j;
        assert!(
            given_j > 0.04 && given_j <= bound_j,
            "{given_j} of {bound_j}"
        );
        assert!(law.account_j().expect("a guard") < 0.01);
    }
}
