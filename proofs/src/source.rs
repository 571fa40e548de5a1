//! Sources of the inputs of a property (a statement about the code): the model checker, which takes all inputs at once, or a seeded
//! generator (many inputs, extreme values preferred). The body of a property is the same for both.
//!
//! The crate bolero offers such a common interface too. But its engine for the model checker Kani accepts a generator that has no
//! value to give, and it cannot report whether a cover (a situation) was reached. These proofs need both checks, which this file
//! has in few lines.

/// A source of a property's inputs; it also takes the property's assumptions and covers (situations to be reached).
pub trait Source {
    /// A random or symbolic number of this many bits.
    fn bits(&mut self, bits: u32) -> u64;
    /// Whether to continue with these inputs; under the model checker the call does not return if `holds` is `false`.
    fn assume(&mut self, holds: bool) -> bool;
    /// Whether a generator may construct a value that satisfies its condition: mostly `true` in random tests, always `false` under
    /// the model checker, which takes all values.
    fn shortcut(&mut self) -> bool;
    /// Counts a situation (cover) that must occur for at least one input; otherwise the property would prove nothing about it.
    fn cover(&mut self, reached: bool, what: &'static str);

    /// A boolean of any value.
    fn bool(&mut self) -> bool {
        self.bits(1) == 1
    }
    /// An 8-bit integer without sign, of any value.
    fn u8(&mut self) -> u8 {
        self.bits(8) as u8
    }
    /// A 16-bit integer without sign, of any value.
    fn u16(&mut self) -> u16 {
        self.bits(16) as u16
    }
    /// A 32-bit integer without sign, of any value.
    fn u32(&mut self) -> u32 {
        self.bits(32) as u32
    }
    /// A 64-bit integer without sign, of any value.
    fn u64(&mut self) -> u64 {
        self.bits(64)
    }
    /// A signed 8-bit integer of any value.
    fn i8(&mut self) -> i8 {
        self.u8().cast_signed()
    }
    /// A signed 16-bit integer of any value.
    fn i16(&mut self) -> i16 {
        self.u16().cast_signed()
    }
    /// A signed 32-bit integer of any value.
    fn i32(&mut self) -> i32 {
        self.u32().cast_signed()
    }
    /// A signed 64-bit integer of any value.
    fn i64(&mut self) -> i64 {
        self.u64().cast_signed()
    }
}

/// The model checker as a source of inputs: all inputs at once.
#[cfg(kani)]
pub struct Symbolic;

#[cfg(kani)]
impl Source for Symbolic {
    fn bits(&mut self, bits: u32) -> u64 {
        let any: u64 = kani::any();
        if bits < 64 {
            any & ((1 << bits) - 1)
        } else {
            any
        }
    }
    fn assume(&mut self, holds: bool) -> bool {
        kani::assume(holds);
        true
    }
    fn shortcut(&mut self) -> bool {
        false
    }
    fn cover(&mut self, _: bool, _: &'static str) {}
    // Each width has its own draw, instead of a part of 64 bits, because the integer solver does not know bit masks.
    fn bool(&mut self) -> bool {
        kani::any()
    }
    fn u8(&mut self) -> u8 {
        kani::any()
    }
    fn u16(&mut self) -> u16 {
        kani::any()
    }
    fn u32(&mut self) -> u32 {
        kani::any()
    }
    fn u64(&mut self) -> u64 {
        kani::any()
    }
    fn i8(&mut self) -> i8 {
        kani::any()
    }
    fn i16(&mut self) -> i16 {
        kani::any()
    }
    fn i32(&mut self) -> i32 {
        kani::any()
    }
    fn i64(&mut self) -> i64 {
        kani::any()
    }
}

/// Seeded random inputs that prefer extreme values: 0, 1, all ones, powers of two and their neighbours. Every length in bits is
/// equally likely.
#[cfg(not(kani))]
pub struct Sampler {
    state: u64,
    rejected: bool,
    covers: Vec<(&'static str, u64)>,
}

#[cfg(not(kani))]
impl Sampler {
    fn next(&mut self) -> u64 {
        // SplitMix64.
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

#[cfg(not(kani))]
impl Source for Sampler {
    fn bits(&mut self, bits: u32) -> u64 {
        let mask = u64::MAX >> (64 - bits);
        let random = self.next();
        let size = (self.next() % u64::from(bits)) as u32;
        let value = match self.next() % 16 {
            0 => 0,
            1 => u64::MAX,
            2 => 1 << size,
            3 => (1 << size) - 1,
            4 => (1 << size) + 1,
            5 => !(1 << size),
            6 => mask >> 1,
            7 => (mask >> 1) + 1,
            8 | 9 => random % 4,
            // A negative number in two's complement, of any size.
            10 | 11 => (random >> (63 - size)).wrapping_neg(),
            _ => random >> (63 - size),
        };
        value & mask
    }
    fn assume(&mut self, holds: bool) -> bool {
        self.rejected |= !holds;
        holds
    }
    fn shortcut(&mut self) -> bool {
        !self.next().is_multiple_of(64)
    }
    fn cover(&mut self, reached: bool, what: &'static str) {
        match self.covers.iter_mut().find(|(text, _)| *text == what) {
            Some((_, count)) => *count += u64::from(reached),
            None => self.covers.push((what, u64::from(reached))),
        }
    }
}

/// Runs a property in random tests until every cover (situation to be reached) was reached and a minimum number of samples was
/// accepted.
///
/// # Panics
/// The property panics, hardly any sample satisfies its assumptions, or a cover is never reached.
#[cfg(not(kani))]
pub fn sample(name: &str, property: fn(&mut Sampler)) {
    const ACCEPTED: u64 = 1_000;
    const TRIES: u64 = 20_000_000;
    // Each property has its own seed, the same in every run.
    let seed = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    let mut source = Sampler {
        state: seed,
        rejected: false,
        covers: Vec::new(),
    };
    let mut accepted = 0_u64;
    for _ in 0..TRIES {
        source.rejected = false;
        property(&mut source);
        accepted += u64::from(!source.rejected);
        if accepted >= ACCEPTED && source.covers.iter().all(|(_, count)| *count > 0) {
            return;
        }
    }
    let missing: Vec<_> = source
        .covers
        .iter()
        .filter(|(_, count)| *count == 0)
        .collect();
    panic!("{name}: {accepted} samples accepted, covers never reached: {missing:?}");
}

/// A value that probably satisfies a condition: random tests try a few times, the model checker takes any value.
pub fn one_with<T, S: Source>(s: &mut S, any: fn(&mut S) -> T, likes: impl Fn(&T) -> bool) -> T {
    loop {
        let value = any(s);
        if likes(&value) || !s.shortcut() {
            return value;
        }
    }
}

/// Continues only if a condition holds. The text names the code that ensures the condition at run time. If the condition selects a
/// case, the text says where the other case is proved. The proofs' table quotes condition and text.
#[macro_export]
macro_rules! assume {
    ($s:expr, $holds:expr, $who:literal) => {
        if !$s.assume($holds) {
            return;
        }
    };
}

/// A value that satisfies an assumed condition. Random tests draw until they have one; the model checker assumes the condition.
#[macro_export]
macro_rules! such {
    ($s:expr, $value:expr, |$x:ident| $holds:expr, $who:literal) => {{
        let mut tries = 0_u32;
        loop {
            let $x = $value;
            let holds = $holds;
            tries += 1;
            if cfg!(kani) || holds || tries > 20_000 {
                $crate::assume!($s, holds, $who);
                break $x;
            }
        }
    }};
}

/// Names a situation (cover) that at least one input must reach. Under the model checker each use is reported separately.
#[macro_export]
macro_rules! cover {
    ($s:expr, $reached:expr, $what:literal) => {
        #[cfg(kani)]
        kani::cover!($reached, $what);
        #[cfg(not(kani))]
        $s.cover($reached, $what);
    };
}

/// Defines a property (a statement about the code): its body, its proof with the model checker Kani, and its test on random samples
/// without Kani.
///
/// `equation` and `over` are texts for the proofs' table. `over` names the configurations, memories and inputs; the proof covers
/// all of them.
#[macro_export]
macro_rules! property {
    // This form is tested on random samples only: no solver finishes at this width, or two solvers show the statement over the
    // integers, or another test tries all inputs.
    ($(#[doc = $doc:literal])* equation $equation:literal over $over:literal by sampled fn $name:ident($s:ident) $body:block) => {
        $(#[doc = $doc])*
        pub mod $name {
            #[allow(unused_imports)]
            use super::*;
            /// The property's body: chooses inputs, runs the code and asserts.
            pub fn body<S: $crate::source::Source>($s: &mut S) $body

            #[cfg(all(test, not(kani)))]
            #[test]
            fn sampled() {
                $crate::source::sample(module_path!(), body::<$crate::source::Sampler>);
            }
        }
    };
    ($(#[doc = $doc:literal])* equation $equation:literal over $over:literal $(by $solver:ident)? fn $name:ident($s:ident) $body:block) => {
        $(#[doc = $doc])*
        pub mod $name {
            #[allow(unused_imports)]
            use super::*;
            /// The property's body: chooses inputs, runs the code and asserts.
            pub fn body<S: $crate::source::Source>($s: &mut S) $body

            #[cfg(kani)]
            #[kani::proof]
            $(#[kani::solver($solver)])?
            fn proof() {
                body(&mut $crate::source::Symbolic);
            }

            #[cfg(all(test, not(kani)))]
            #[test]
            fn sampled() {
                $crate::source::sample(module_path!(), body::<$crate::source::Sampler>);
            }
        }
    };
}
