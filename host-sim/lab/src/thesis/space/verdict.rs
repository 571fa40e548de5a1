//! The verdict on a run in three axes, by the criteria of a run on one axis. The device must come to rest while the hand holds
//! still, and the hand must not get more energy out than it put in.
//!
//! The hand of such a run always holds still for `HOLD_S`. A run can therefore only be not judged if the mechanism ended it
//! before the end of the hold.

use super::motion::{HOLD_S, PROBE_S};
use super::record::length;
use super::{RATE_HZ, Record};
use touchstone_sim::run::verdict::{LEAST_REST_S, NotJudged, Verdict};

/// Ripple of the depth above which an interaction does not count as at rest, mm: five position counts of the device. A hand's
/// tremor is not simulated.
pub const AT_REST_MM: f64 = 0.05;

/// Last fraction of the hold in which the device is examined, as on one axis.
const EXAMINED: f64 = 0.25;
/// Fraction of the motors' largest force from which on a force counts as at the limit. The law's rounding keeps it slightly below
/// the limit.
const AT_LIMIT: f64 = 1.0 - 1e-3;

impl Record {
    /// The recorded ticks of the last quarter of the hold.
    fn examined(&self) -> std::ops::Range<usize> {
        let tick = |time_s: f64| (time_s * f64::from(RATE_HZ)).round() as usize;
        let most = self.time_s.len();
        let end = PROBE_S + HOLD_S;
        tick(end - EXAMINED * HOLD_S).min(most)..tick(end).min(most)
    }

    /// Verdict on the run, and the reason if it is not judged.
    #[must_use]
    pub fn judged(&self) -> (Verdict, Option<NotJudged>) {
        let examined = self.examined();
        let seen_s = examined.len() as f64 / f64::from(RATE_HZ);
        let pushes = |tick: usize| length(self.force_n[tick]) > 0.0;
        let most_n = AT_LIMIT * self.cell.mechanism.force_n();
        let left = examined
            .clone()
            .skip(1)
            .filter(|tick| pushes(tick - 1) && !pushes(*tick))
            .count();
        let at_limit = examined
            .clone()
            .any(|tick| length(self.force_n[tick]) >= most_n);
        let finite = self.hip_mm.iter().flatten().all(|x| x.is_finite());
        let moves = !examined.is_empty() && self.ripple_mm(examined) >= AT_REST_MM;
        let verdict = if !finite {
            Verdict::Unstable
        } else if !(0..self.force_n.len()).any(pushes) {
            Verdict::NoContact
        } else if seen_s < LEAST_REST_S {
            Verdict::NotJudged
        } else if moves && (left >= 2 || at_limit) {
            Verdict::Unstable
        } else if moves {
            Verdict::LimitCycle
        } else if self.energy.out_j() > 0.0 {
            Verdict::Active
        } else {
            Verdict::Passive
        };
        let why = (verdict == Verdict::NotJudged).then_some(NotJudged::TooShort {
            seen_s,
            least_s: LEAST_REST_S,
        });
        (verdict, why)
    }
}

#[cfg(test)]
mod tests {
    use super::super::port_energy::PortEnergy;
    use super::super::{Approach, Cell, Mechanism, Object, Phase, ProbingMotion, SurfaceFeel, run};
    use super::*;

    fn of(approach: Approach, k_desired_n_per_mm: f64) -> Record {
        run(&Cell {
            mechanism: Mechanism::Cartesian,
            object: Object::Horizontal,
            k_desired_n_per_mm,
            approach,
            feel: SurfaceFeel::default(),
        })
        .expect("settings of the comparison")
    }

    /// Removes all ticks from this time on, as if the mechanism had ended the run there.
    fn ended(mut record: Record, time_s: f64) -> Record {
        let ticks = record.time_s.partition_point(|t| *t < time_s);
        record.time_s.truncate(ticks);
        record.phase.truncate(ticks);
        record.hip_mm.truncate(ticks);
        record.force_n.truncate(ticks);
        record.stopped = true;
        record
    }

    #[test]
    fn a_wall_that_rests_and_one_that_does_not_are_told_apart() {
        let (soft, none) = of(Approach::SpringDamper, 1.0).judged();
        assert!(soft < Verdict::LimitCycle && none.is_none(), "{soft:?}");
        let (stiff, none) = of(Approach::Spring, 25.0).judged();
        assert!(
            matches!(stiff, Verdict::LimitCycle | Verdict::Unstable) && none.is_none(),
            "{stiff:?}"
        );
    }

    #[test]
    fn a_run_that_ended_before_the_hold_is_not_judged() {
        let whole = of(Approach::Spring, 25.0);
        for end_s in [0.6, PROBE_S, PROBE_S + 0.7 * HOLD_S] {
            let (verdict, why) = ended(whole.clone(), end_s).judged();
            assert_eq!(verdict, Verdict::NotJudged, "{end_s}");
            let why = why.expect("a reason").to_string();
            assert_eq!(
                why,
                "the run shows only 0.0 ms of rest; at least 20 ms are needed"
            );
        }
        // Enough of the hold was recorded to see the oscillation.
        let (verdict, why) = ended(whole.clone(), PROBE_S + 0.8 * HOLD_S).judged();
        assert!(verdict >= Verdict::LimitCycle && why.is_none());
        let (verdict, _) = ended(whole, 0.0).judged();
        assert_eq!(verdict, Verdict::NoContact);
    }

    /// The verdict assumes that the hand rests during the hold.
    #[test]
    fn the_hand_rests_in_the_hold() {
        for object in Object::ALL {
            let motion = ProbingMotion::of(object);
            let at = |tick: u32| f64::from(tick) / f64::from(RATE_HZ);
            let held: Vec<[f64; 3]> = (0..motion.ticks())
                .filter(|tick| motion.phase(at(*tick)) == Phase::Hold)
                .map(|tick| motion.rest_mm(at(tick)))
                .collect();
            assert_eq!(held.len(), (HOLD_S * f64::from(RATE_HZ)) as usize);
            assert!(held.iter().all(|place| *place == held[0]), "{object:?}");
        }
    }

    #[test]
    fn energy_out_is_what_the_user_got_beyond_what_it_gave() {
        let mut energy = PortEnergy::default();
        energy.add(-2.0, 0.5);
        assert_eq!(energy.out_j(), 0.0);
        energy.add(3.0, 0.0);
        assert!((energy.out_j() - 0.5).abs() < 1e-12);
        energy.add(-1.0, 0.0);
        assert!(
            (energy.out_j() - 0.5).abs() < 1e-12,
            "the most of all times"
        );
    }
}
