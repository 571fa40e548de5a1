//! Counts the telemetry records that arrived from a board, and the records that were lost on the way.

/// Numbers of telemetry records that arrived and that were lost.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counted {
    /// Number of records that arrived.
    pub records: u64,
    /// Number of records that were lost, calculated from the gaps in the control ticks of those that arrived.
    pub lost: u64,
    last: Option<u32>,
}

impl Counted {
    /// Counts a record that arrived. `tick` is its control tick, `decimation` the number of ticks per record. Returns the number of
    /// records lost just before it, and adds this number to [`Self::lost`].
    pub fn take(&mut self, tick: u32, decimation: u16) -> u32 {
        let steps = self.last.map_or(0, |last| {
            let steps = tick.wrapping_sub(last) / u32::from(decimation);
            // The number went backwards: the device was restarted.
            let forward = steps < u32::MAX / 2 / u32::from(decimation);
            if forward { steps } else { 0 }
        });
        let missing = steps.saturating_sub(1);
        self.lost += u64::from(missing);
        self.records += 1;
        self.last = Some(tick);
        missing
    }
}

#[cfg(test)]
mod tests {
    use super::Counted;

    #[test]
    fn gaps_count_across_the_wrap_and_a_restart_does_not() {
        let mut counted = Counted::default();
        for tick in [u32::MAX - 1, u32::MAX, 0, 3, 4, 0, 1] {
            counted.take(tick, 1);
        }
        assert_eq!((counted.records, counted.lost), (7, 2));
        let mut counted = Counted::default();
        for tick in [10, 20, 40, 50] {
            counted.take(tick, 10);
        }
        assert_eq!((counted.records, counted.lost), (4, 1));
    }
}
