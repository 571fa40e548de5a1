//! A histogram of the lateness of the servo loop's control intervals (ticks).

/// Upper limits of the histogram's classes, µs. The last class has no upper limit.
const ENDS_US: [f64; 13] = [
    1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 1e4,
];

/// Numbers of control intervals (ticks) by their lateness.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TickLateness {
    counts: [u64; ENDS_US.len() + 1],
    worst_s: f64,
}

/// A class of the histogram: the control intervals (ticks) whose lateness is within the class's limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LatenessClass {
    /// Largest lateness of the class, µs; `None` for the last class, which has no upper limit.
    pub up_to_us: Option<f64>,
    /// Number of control intervals (ticks) in the class.
    pub ticks: u64,
}

impl TickLateness {
    /// Counts a control interval (tick) with this lateness, s.
    pub fn take(&mut self, late_s: f64) {
        let class = ENDS_US
            .iter()
            .position(|end| late_s * 1e6 <= *end)
            .unwrap_or(ENDS_US.len());
        self.counts[class] += 1;
        self.worst_s = self.worst_s.max(late_s);
    }

    /// Largest lateness of all control intervals (ticks), s.
    #[must_use]
    pub fn worst_s(&self) -> f64 {
        self.worst_s
    }

    /// All classes of the histogram, the one with the smallest lateness first.
    pub fn classes(&self) -> impl Iterator<Item = LatenessClass> + '_ {
        self.counts
            .iter()
            .enumerate()
            .map(|(i, ticks)| LatenessClass {
                up_to_us: ENDS_US.get(i).copied(),
                ticks: *ticks,
            })
    }

    /// The quantile of the lateness in µs, for the fraction `share` (0 to 1) of all ticks. It is the upper limit of the first class
    /// by which that many ticks are counted. `None` if it is in the last class.
    #[must_use]
    pub fn quantile_us(&self, share: f64) -> Option<f64> {
        let all: u64 = self.counts.iter().sum();
        let wanted = (share * all as f64).ceil() as u64;
        let mut seen = 0;
        self.classes()
            .find(|class| {
                seen += class.ticks;
                seen >= wanted
            })
            .and_then(|class| class.up_to_us)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_in_the_class_that_ends_at_or_above_them() {
        let mut late = TickLateness::default();
        for us in [0.0, 1.0, 1.1, 49.0, 20_000.0] {
            late.take(us * 1e-6);
        }
        let counts: Vec<u64> = late.classes().map(|class| class.ticks).collect();
        assert_eq!(counts, [2, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 1]);
        assert_eq!(late.quantile_us(0.4), Some(1.0));
        assert_eq!(late.quantile_us(0.8), Some(50.0));
        assert_eq!(late.quantile_us(1.0), None);
        assert!((late.worst_s() - 0.02).abs() < 1e-12);
    }
}
