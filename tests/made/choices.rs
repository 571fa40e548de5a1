//! Random choices for the generators of test inputs. They come from a seed in the tests, or from bytes in the fuzzer, which learns
//! what each byte changes.

/// A source of choices, by which a generator of test inputs decides what to make.
pub trait Choices {
    /// An integer from 0 up to, not including, `most`, which must be at least 1.
    fn below(&mut self, most: usize) -> usize;

    /// Chooses one of the given texts.
    #[allow(dead_code, reason = "of generators with words")]
    fn of<'a>(&mut self, words: &[&'a str]) -> &'a str {
        words[self.below(words.len())]
    }
}

/// Choices from a seed, by the random number generator SplitMix64 (Steele, Lea and Flood, 2014).
pub struct Seeded(pub u64);

impl Choices for Seeded {
    fn below(&mut self, most: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % most as u64) as usize
    }
}

/// Choices from given bytes, two bytes per choice. After the last byte every choice is 0.
#[allow(dead_code, reason = "the fuzzer's")]
pub struct Given<'a>(pub &'a [u8]);

impl Choices for Given<'_> {
    fn below(&mut self, most: usize) -> usize {
        let Some((two, rest)) = self.0.split_first_chunk() else {
            return 0;
        };
        self.0 = rest;
        usize::from(u16::from_le_bytes(*two)) % most
    }
}
