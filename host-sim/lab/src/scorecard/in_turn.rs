//! Runs all actions of the scorecard's hand one after the other, for a real device that cannot be reset between actions.

use super::cases::Deed;
use super::direction::{Approach, OUTSIDE_M, smooth};
use touchstone_world::plant::Hand;

/// The actions of the hand in the order in which they are carried out.
pub const DEEDS: [Deed; 4] = [
    Deed::Press,
    Deed::Move(1.0),
    Deed::Move(2.0),
    Deed::Move(4.0),
];

/// Time in which the hand moves out of the wall after an action, s. The hand then rests outside for `REST_S`.
const OUT_S: f64 = 0.5;
const REST_S: f64 = 1.5;

/// A simulated hand that does all actions of the scorecard one after the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeedsInTurn {
    /// The wall and the forces of the hand.
    pub approach: Approach,
    /// Mechanical parameters of the simulated hand.
    pub hand: Hand,
    first: u64,
}

impl DeedsInTurn {
    /// Creates the hand. The actions begin at tick `first`; until then the hand rests outside the wall.
    #[must_use]
    pub fn new(approach: Approach, hand: Hand, first: u64) -> Self {
        Self {
            approach,
            hand,
            first,
        }
    }

    fn pause(&self) -> u64 {
        ((OUT_S + REST_S) * f64::from(self.approach.rate_hz)).round() as u64
    }

    /// Every action with the tick at which it begins.
    pub fn begun(&self) -> impl Iterator<Item = (Deed, u64)> + '_ {
        DEEDS.iter().scan(self.first, |next, deed| {
            let first = *next;
            *next += self.approach.ticks(*deed) + self.pause();
            Some((*deed, first))
        })
    }

    /// Number of ticks (control periods) that all actions take.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.begun()
            .map(|(deed, first)| first + self.approach.ticks(deed) + self.pause())
            .fold(0, u64::max)
    }

    /// Depth of the hand's rest point below the surface in a tick, m.
    #[must_use]
    pub fn rest_depth_m(&self, tick: u64) -> f64 {
        let Some((deed, first)) = self.begun().filter(|(_, first)| *first <= tick).last() else {
            return -OUTSIDE_M;
        };
        let ticks = self.approach.ticks(deed);
        let rate = f64::from(self.approach.rate_hz);
        let at = |ticks: u64| {
            self.approach
                .rest_depth_m(&self.hand, deed, ticks as f64 / rate)
        };
        match (tick - first).checked_sub(ticks) {
            None => at(tick - first),
            Some(after) => {
                let last = at(ticks);
                last - (last + OUTSIDE_M) * smooth(after as f64 / rate / OUT_S)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_world::plant::FIRM_TRANSLATION;

    #[test]
    fn the_deeds_are_those_of_the_scorecard_and_no_hand_jumps_between_them() {
        let approach = Approach {
            k_desired_n_per_m: 5000.0,
            push_n: 8.0,
            touch_n: 1.6,
            count_m: 1e-5,
            unsure_m: 5e-6,
            rate_hz: 1000,
        };
        let turn = DeedsInTurn::new(approach, FIRM_TRANSLATION, 1200);
        let deeds: Vec<_> = turn.begun().collect();
        assert_eq!(deeds.len(), 4);
        for (deed, first) in deeds {
            assert!((turn.rest_depth_m(first - 1) + OUTSIDE_M).abs() < 1e-9);
            for tick in 0..approach.ticks(deed) {
                let alone = approach.rest_depth_m(&FIRM_TRANSLATION, deed, tick as f64 / 1000.0);
                assert_eq!(turn.rest_depth_m(first + tick), alone, "{deed:?}");
            }
        }
        let most = (1..turn.ticks())
            .map(|tick| (turn.rest_depth_m(tick) - turn.rest_depth_m(tick - 1)).abs())
            .fold(0.0, f64::max);
        // The fastest motion is that of the light touch: some 8 mm in 50 ms.
        assert!(most < 2e-3, "{most} m in a tick");
    }
}
