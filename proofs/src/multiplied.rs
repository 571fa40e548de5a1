//! Multiplication for the checker: one product for one question, at 32 bits.
//!
//! That a tick is its specification does not depend on what a product *is*: both sides multiply the same numbers and then add, shift
//! and compare what comes out. No solver follows these products at full width; so a `multiplied_property!` puts the functions of this
//! file in the place of the code's multiplications and of the specification's. A product is there any number that has the facts of
//! [`facts`], and the specification's next question gets the code's answer if it is the same question. What holds for every such
//! product holds for the product.
//!
//! ```text
//! a <= c, b <= d  implies  a b <= c d                 p3_product_in_order, obligations/check.py
//! 2^k b = b << k, (2^31 - 1) b = (b << 31) - b        p3_product_known, obligations/check.py
//! Fixed32::product, Fixed32::work are the products    p1_products_are_exact, edges::p1_edge_work
//! ```
//!
//! Questions are told apart by their order: those of the settings come first, then the memory's, the code's, and the specification's.
//! Who asks in another order than the code gets an answer of which nothing is known, which proves less, never more.

use crate::{cover, property};
use touchstone_control::{Fixed32, Number};

type Signal = <Fixed32 as Number>::Signal;
type Gain = <Fixed32 as Number>::Gain;

/// What is known of products of magnitudes.
pub mod facts {
    /// The product of smaller factors is not larger.
    #[must_use]
    pub fn in_order([a, b]: [u32; 2], less: u64, [c, d]: [u32; 2], more: u64) -> bool {
        a > c || b > d || less <= more
    }
    /// Factors whose products are known without a multiplication: a share of 1, a quarter of the format, its largest number.
    pub const FACTORS: [u32; 3] = [1 << 24, 1 << 29, (1 << 31) - 1];
    /// Their products.
    #[must_use]
    pub fn products(b: u32) -> [u64; 3] {
        let b = u64::from(b);
        [b << 24, b << 29, (b << 31) - b]
    }
}

property! {
    /// P3: the product of smaller factors is not larger: over the integers, in two solvers, `obligations/check.py`.
    equation "a <= c and b <= d implies a b <= c d"
    over "two pairs of words"
    by sampled fn p3_product_in_order(s) {
        let (a, b, c, d) = (s.u32(), s.u32(), s.u32(), s.u32());
        assert!(facts::in_order([a, b], u64::from(a) * u64::from(b), [c, d], u64::from(c) * u64::from(d)));
        cover!(s, a < c && b < d && a > 0, "smaller");
    }
}
property! {
    /// P3: a product with a power of two is a shift, one with the largest number a shift and a difference, as over the integers.
    equation "2^k b = b << k, (2^31 - 1) b = (b << 31) - b"
    over "word"
    by sampled fn p3_product_known(s) {
        let b = s.u32();
        assert!(facts::FACTORS.map(|a| u64::from(a) * u64::from(b)) == facts::products(b));
        cover!(s, b == u32::MAX, "largest");
    }
}
property! {
    /// P1: the code's product of a gain and a signal is the product, sign by sign, of their magnitudes.
    equation "p = k x = ± |k| |x|"
    over "gain and signal"
    by kissat fn p1_products_are_exact(s) {
        let (k, x) = (s.i32(), s.i32());
        let found = Fixed32::product(Gain::from_bits(k), Signal::from_bits(x));
        assert!(found == i64::from(k) * i64::from(x));
        cover!(s, found < 0, "negative");
    }
}

/// A property that at the shipped width has the multiplications of this file, `multiplied`, and at 8 bits the code's own, `plain`.
#[macro_export]
macro_rules! multiplied_property {
    (plain $($property:tt)*) => {
        $crate::property!($($property)*);
    };
    (multiplied $($property:tt)*) => {
        $crate::replaced_property! {
            [(<touchstone_control::Fixed32 as touchstone_control::Number>::product, $crate::multiplied::product)
            (<touchstone_control::Fixed32 as touchstone_control::Number>::work, $crate::multiplied::work)
            (<u32 as touchstone_control::magnitude::Word>::times, $crate::multiplied::words)
            ($crate::guard::times, $crate::multiplied::exact)
            ($crate::spec::times, $crate::multiplied::times)]
            $($property)*
        }
    };
}

/// The next product is the memory's first, the code's, the specification's.
#[cfg(not(kani))]
mod questions {
    /// The memory's.
    pub fn of_memory() {}
    /// The code's.
    pub fn of_code() {}
    /// The specification's.
    pub fn of_specification() {}
}
#[cfg(not(kani))]
pub use questions::{of_code, of_memory, of_specification};

#[cfg(kani)]
pub use by_one_product::*;
#[cfg(kani)]
mod by_one_product {
    use super::{Gain, Signal, facts};
    use crate::format::Format;
    use core::sync::atomic::{AtomicU32, AtomicU64, AtomicUsize, Ordering::Relaxed};
    use touchstone_control::{Fixed32, Number};

    /// Where the rows of the memory, of the code, and the end are: more than any property asks for.
    const MEMORY: usize = 5;
    const CODE: usize = 6;
    const END: usize = 18;
    /// The next question's row; from `END` on the specification asks.
    static AT: AtomicUsize = AtomicUsize::new(0);
    static LEFT: [AtomicU32; END] = [const { AtomicU32::new(0) }; END];
    static RIGHT: [AtomicU32; END] = [const { AtomicU32::new(0) }; END];
    static FOUND: [AtomicU64; END] = [const { AtomicU64::new(0) }; END];

    pub fn of_memory() {
        AT.store(MEMORY, Relaxed);
    }
    pub fn of_code() {
        AT.store(CODE, Relaxed);
    }
    pub fn of_specification() {
        AT.store(END, Relaxed);
    }

    /// Factors and product of a row.
    fn row(at: usize) -> ([u32; 2], u64) {
        let factors = [LEFT[at].load(Relaxed), RIGHT[at].load(Relaxed)];
        (factors, FOUND[at].load(Relaxed))
    }

    fn magnitude(a: u32, b: u32) -> u64 {
        let at = AT.load(Relaxed);
        AT.store(at + 1, Relaxed);
        let any: u64 = kani::any();
        if at >= END {
            let same = at - END + CODE;
            if same >= END {
                return any;
            }
            let (factors, found) = row(same);
            return if factors == [a, b] { found } else { any };
        }
        let known = [facts::products(a), facts::products(b)];
        let mut i = 0;
        while i < facts::FACTORS.len() {
            let factor = facts::FACTORS[i];
            kani::assume(facts::in_order([a, b], any, [factor, b], known[1][i]));
            kani::assume(facts::in_order([b, a], any, [factor, a], known[0][i]));
            i += 1;
        }
        let mut of = 0;
        while of < CODE && of < at {
            let (factors, found) = row(of);
            kani::assume(facts::in_order([a, b], any, factors, found));
            of += 1;
        }
        LEFT[at].store(a, Relaxed);
        RIGHT[at].store(b, Relaxed);
        FOUND[at].store(any, Relaxed);
        any
    }

    fn signed(a: i32, b: i32) -> i64 {
        let size = magnitude(a.unsigned_abs(), b.unsigned_abs()) as i64;
        if (a < 0) == (b < 0) {
            size
        } else {
            size.wrapping_neg()
        }
    }
    /// Of what the specification multiplies: words, which is asserted.
    fn word(x: i64) -> i32 {
        assert!(i32::try_from(x).is_ok());
        x as i32
    }

    /// For [`touchstone_control::magnitude::Word::times`].
    pub fn words(a: u32, b: u32) -> u64 {
        magnitude(a, b)
    }
    /// For [`Number::product`].
    pub fn product(k: Gain, x: Signal) -> i64 {
        signed(k.to_bits(), x.to_bits())
    }
    /// For [`Number::work`].
    pub fn work(f: Signal, d: Signal) -> <Fixed32 as Number>::Energy {
        <Fixed32 as Number>::Energy::from_bits(signed(f.to_bits(), d.to_bits()))
    }
    /// For [`crate::spec::times`].
    pub fn times(a: i64, b: i64) -> i64 {
        signed(word(a), word(b))
    }
    /// For [`crate::guard::times`].
    pub fn exact<N: Format>(a: i64, b: i64) -> N::Exact {
        N::exact(times(a, b))
    }
}
