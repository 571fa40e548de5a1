//! The current sensors' readings at zero current: their mean over 51 ms, and their spread.

/// The current sensors' readings at zero current.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Offsets {
    /// Mean reading of phase A's sensor, in 1/16 of a code of the analogue-to-digital converter.
    pub a: u16,
    /// Mean reading of phase B's sensor, in 1/16 of a code of the analogue-to-digital converter.
    pub b: u16,
    /// Largest less smallest reading of a phase, in codes of the analogue-to-digital converter; the larger value of phases A and B.
    pub spread: u16,
}

impl Offsets {
    /// Fractional bits of an offset, which is finer than a code of the converter because it is a mean of many readings.
    pub(super) const BITS: u32 = 4;
}

/// Number of samples from which an offset is averaged, as a power of two: 1,024 samples take 51 ms at 20 kHz.
const OFFSET_SAMPLES_LOG2: u32 = 10;

/// Sums of readings at zero current, from which the means are calculated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct OffsetSums {
    pub(super) count: u32,
    sum: [u32; 2],
    least: [u16; 2],
    most: [u16; 2],
}

impl OffsetSums {
    pub(super) const EMPTY: Self = Self {
        count: 0,
        sum: [0; 2],
        least: [u16::MAX; 2],
        most: [0; 2],
    };

    pub(super) fn add(&mut self, a: u16, b: u16) -> Option<Offsets> {
        let Self {
            sum: [sum_a, sum_b],
            least: [least_a, least_b],
            most: [most_a, most_b],
            ..
        } = self;
        *sum_a = sum_a.saturating_add(u32::from(a));
        *sum_b = sum_b.saturating_add(u32::from(b));
        (*least_a, *most_a) = ((*least_a).min(a), (*most_a).max(a));
        (*least_b, *most_b) = ((*least_b).min(b), (*most_b).max(b));
        let spread = most_a
            .saturating_sub(*least_a)
            .max(most_b.saturating_sub(*least_b));
        // Codes have 12 bits, so a mean in 1/16 of a code fits 16 bits. Wider codes saturate and are then implausible.
        let mean = |sum: u32| {
            u16::try_from(sum >> (OFFSET_SAMPLES_LOG2 - Offsets::BITS)).unwrap_or(u16::MAX)
        };
        let (a, b) = (mean(*sum_a), mean(*sum_b));
        self.count += 1;
        (self.count >= 1 << OFFSET_SAMPLES_LOG2).then_some(Offsets { a, b, spread })
    }
}
