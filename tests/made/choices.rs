//! What a generator chooses by: a seed, in the tests, or bytes, in the fuzzer, which finds out what they change.

/// A source of choices.
pub trait Choices {
    /// A number below `most`, which is at least 1.
    fn below(&mut self, most: usize) -> usize;

    /// One of these words.
    #[allow(dead_code, reason = "of generators with words")]
    fn of<'a>(&mut self, words: &[&'a str]) -> &'a str {
        words[self.below(words.len())]
    }
}

/// SplitMix64 (Steele, Lea and Flood, 2014).
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

/// Two bytes a choice; after the last one the first of everything.
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
