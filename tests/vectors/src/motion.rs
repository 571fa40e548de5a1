//! The motion of the test vectors in encoder counts. It contains motions of a hand, random counts at the wall's surface, jumps as
//! from a faulty encoder, and the ends of all ranges.

/// The last encoder count outside the wall. The wall's surface is at 0.5 rad, which is 3183.1 counts.
const OUTSIDE: i64 = 3183;

/// A segment of the motion of the test vectors.
#[derive(Debug)]
pub struct Segment {
    /// Short name of the segment, without spaces.
    pub name: &'static str,
    /// Duration of the segment in control periods.
    pub ticks: u32,
    count: fn(&mut Motion, u32) -> i64,
}

/// The segments of the motion, 20,000 control periods in all.
pub const SEGMENTS: [Segment; 9] = [
    segment("presses", 5000, Motion::presses),
    segment("hold", 2500, Motion::hold),
    segment("creep", 2000, Motion::creep),
    segment("surface", 2000, Motion::surface),
    segment("grazing", 2000, Motion::grazing),
    segment("wander", 2500, Motion::wander),
    segment("taps", 1500, Motion::taps),
    segment("jumps", 1500, Motion::jumps),
    segment("extremes", 1000, Motion::extremes),
];

const fn segment(name: &'static str, ticks: u32, count: fn(&mut Motion, u32) -> i64) -> Segment {
    Segment { name, ticks, count }
}

/// State of the motion: its position and its random number generator.
#[derive(Debug)]
pub struct Motion {
    random: u64,
    depth: i64,
    height: i64,
}

impl Default for Motion {
    fn default() -> Self {
        Self {
            random: 2009,
            depth: 0,
            height: 0,
        }
    }
}

/// A triangle wave in encoder counts from 0 to `height`: up in the first half of the period, down in the second.
fn triangle(tick: u32, period: u32, height: i64) -> i64 {
    let phase = i64::from(tick % period);
    let half = i64::from(period / 2);
    (half - (phase - half).abs()) * height / half
}

impl Motion {
    /// The encoder count at control period `tick` of a segment.
    pub fn count(&mut self, segment: &Segment, tick: u32) -> i64 {
        (segment.count)(self, tick)
    }

    /// A random integer from `-size` to `size`, from the upper half of Knuth's 64-bit linear congruential generator.
    fn whole(&mut self, size: i64) -> i64 {
        let Self { random, .. } = self;
        *random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (*random >> 33) as i64 % (2 * size + 1) - size
    }

    /// The encoder count of presses to depths of 1 to 1001 counts from 50 counts outside, with two counts of noise. 1000 counts
    /// are 157 mrad, where the force is at its limit.
    fn presses(&mut self, tick: u32) -> i64 {
        if tick.is_multiple_of(500) {
            self.height = 501 + self.whole(500);
        }
        OUTSIDE - 50 + triangle(tick, 500, 50 + self.height) + self.whole(2)
    }

    /// The encoder count of a motion in to a depth of 300 counts, a hold there with one count of jitter, and a motion out.
    fn hold(&mut self, tick: u32) -> i64 {
        let way_in = i64::from(tick.min(2499 - tick)).min(300);
        OUTSIDE + way_in + self.whole(1)
    }

    /// The encoder count of a motion by one count in 16 control periods, in and out. In most periods the position does not change.
    fn creep(&mut self, tick: u32) -> i64 {
        OUTSIDE + triangle(tick, 2000, 1000) / 16
    }

    /// A random encoder count at the wall's surface: the last count outside the wall, or one of the first two inside.
    fn surface(&mut self, _: u32) -> i64 {
        OUTSIDE + (1 + self.whole(1)) / 2 + self.whole(1).max(0)
    }

    /// The encoder count of touches that last a few control periods and are a few counts deep.
    fn grazing(&mut self, tick: u32) -> i64 {
        let period = 20 + tick / 100;
        OUTSIDE - 8 + triangle(tick, 2 * period, 10) + self.whole(1)
    }

    /// The encoder count of a random walk with steps of up to 60 counts, which is drawn back to 100 counts inside the wall.
    fn wander(&mut self, _: u32) -> i64 {
        self.depth += self.whole(60) - self.depth / 16;
        OUTSIDE + 100 + self.depth
    }

    /// The encoder count of hammer taps: a jump by up to 3000 counts, in or out, in one control period, a return over the next
    /// five, and a sixth period beyond the start by a fifth of the jump.
    fn taps(&mut self, tick: u32) -> i64 {
        if tick.is_multiple_of(7) {
            self.height = self.whole(3000);
        }
        OUTSIDE + self.height - self.height * i64::from(tick % 7) / 5
    }

    /// A random encoder count within ±1.3 turns.
    fn jumps(&mut self, _: u32) -> i64 {
        self.whole(52_000)
    }

    /// Extreme encoder counts: the ends of the ranges of counts, angles and both number formats, with up to two counts of noise,
    /// and the wall's surface and other counts in between.
    fn extremes(&mut self, tick: u32) -> i64 {
        const ENDS: [i64; 12] = [
            i64::MAX,
            i64::MIN,
            OUTSIDE,
            // The ends of the formats at 128 rad and 2 rad.
            818_057,
            -811_691,
            15_915,
            -9_549,
            OUTSIDE + 1,
            // The end of angles at 32,767 rad.
            208_606_000,
            -208_606_000,
            1 << 40,
            0,
        ];
        let near = self.whole(2);
        // First all ends in a fixed order, then at random.
        let index = if tick < 500 {
            i64::from(tick) * 5
        } else {
            self.whole(1000) + 1000
        };
        ENDS[index as usize % ENDS.len()].saturating_add(near)
    }
}
