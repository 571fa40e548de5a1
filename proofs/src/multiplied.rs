//! Multiplication at 32 bits when the model checker runs: any result that has proved facts, and the same result for equal
//! arguments.
//!
//! Whether a tick equals its specification does not depend on what a product *is*. Code and specification multiply the same
//! numbers, and then add, shift and compare the results. No solver follows these products at 32 bits, so a `multiplied_property!`
//! replaces the multiplications of code and specification by the functions of this file. A product here is any number that has the
//! facts of [`facts`]. The specification's next call gets the code's result if its arguments are equal. What holds for every such
//! product holds for the real one.
//!
//! ```text
//! a <= c, b <= d  implies  a b <= c d                 p3_product_in_order, obligations/check.py
//! 2^k b = b << k, (2^31 - 1) b = (b << 31) - b        p3_product_known, obligations/check.py
//! a b = c b + (a - c) b                               p3_product_adds_up, obligations/check.py
//! the code's multiplications are exact products       p1_products_are_exact, edges::p1_edge_work
//! ```
//!
//! Calls are matched by their order: first those of the settings, then those of the memory, the code and the specification. If a
//! call of the specification is not in the code's order, nothing is known of its result. The proof then assumes less, so it stays
//! valid.

use crate::{cover, property};
use touchstone_control::magnitude::Word;
use touchstone_control::{Fixed32, Number};

type Signal = <Fixed32 as Number>::Signal;
type Gain = <Fixed32 as Number>::Gain;

/// The facts that the model checker assumes of products of absolute values.
pub mod facts {
    /// Whether two products are in order: if both factors are at most those of the other product, the product is not larger.
    #[must_use]
    pub fn in_order([a, b]: [u32; 2], less: u64, [c, d]: [u32; 2], more: u64) -> bool {
        a > c || b > d || less <= more
    }
    /// Whether two products sum to a third one, where a factor of the third is split into two parts.
    #[must_use]
    pub fn adds_up(
        [a, b]: [u32; 2],
        whole: u64,
        [c, d]: [u32; 2],
        part: u64,
        [e, f]: [u32; 2],
        rest: u64,
    ) -> bool {
        b != d || b != f || a < c || a - c != e || part <= whole && whole - part == rest
    }
    /// Factors whose products are known without a multiplication: a ratio of 1, a quarter of the format's range, the format's
    /// largest number, and the absolute value of its lowest number.
    pub const FACTORS: [u32; 4] = [1 << 24, 1 << 29, (1 << 31) - 1, 1 << 31];
    /// The products of [`FACTORS`] with `b`, without a multiplication.
    #[must_use]
    pub fn products(b: u32) -> [u64; 4] {
        let b = u64::from(b);
        [b << 24, b << 29, (b << 31) - b, b << 31]
    }
}

property! {
    /// P3 (arithmetic): the product of smaller factors is not larger. Two solvers show it over the integers in
    /// `obligations/check.py`.
    equation "a <= c and b <= d implies a b <= c d"
    over "two pairs of words"
    by sampled fn p3_product_in_order(s) {
        let (a, b, c, d) = (s.u32(), s.u32(), s.u32(), s.u32());
        assert!(facts::in_order([a, b], u64::from(a) * u64::from(b), [c, d], u64::from(c) * u64::from(d)));
        cover!(s, a < c && b < d && a > 0, "smaller");
    }
}
property! {
    /// P3 (arithmetic): the products of two parts of a factor sum to the product of the whole. Two solvers show it over the
    /// integers in `obligations/check.py`.
    equation "a b = c b + (a - c) b"
    over "three words"
    by sampled fn p3_product_adds_up(s) {
        let (a, b, c, e) = (s.u32(), s.u32(), s.u32(), s.u32());
        let e = if c <= a && s.bool() { a - c } else { e };
        let product = |a: u32| u64::from(a) * u64::from(b);
        assert!(facts::adds_up([a, b], product(a), [c, b], product(c), [e, b], product(e)));
        cover!(s, c < a && a - c == e && b > 0, "parts");
    }
}
property! {
    /// P3 (arithmetic): a product with a power of two is a shift, and one with the largest number is a shift and a difference.
    equation "2^k b = b << k, (2^31 - 1) b = (b << 31) - b"
    over "word"
    by sampled fn p3_product_known(s) {
        let b = s.u32();
        assert!(facts::FACTORS.map(|a| u64::from(a) * u64::from(b)) == facts::products(b));
        cover!(s, b == u32::MAX, "largest");
    }
}
property! {
    /// P1 (energy): the code's product of a gain and a position or force is the exact product, and so is that of two absolute
    /// values.
    equation "p = k x"
    over "gain and signal, two magnitudes"
    by kissat fn p1_products_are_exact(s) {
        let (k, x) = (s.i32(), s.i32());
        let found = Fixed32::product(Gain::from_bits(k), Signal::from_bits(x));
        assert!(found == i64::from(k) * i64::from(x));
        cover!(s, found < 0, "negative");
        let (a, b) = (s.u32(), s.u32());
        assert_reached!(a.times(b) == u64::from(a) * u64::from(b));
    }
}

/// Defines a property that uses the multiplications of this file at 32 bits (`multiplied`), and the code's own at 8 bits (`plain`).
/// `and [..]` lists further pairs of a function and its replacement.
#[macro_export]
macro_rules! multiplied_property {
    (plain and [$($pair:tt)*] $($property:tt)*) => {
        $crate::property!($($property)*);
    };
    (plain $($property:tt)*) => {
        $crate::property!($($property)*);
    };
    (multiplied and [$($pair:tt)*] $($property:tt)*) => {
        $crate::replaced_property! {
            [(<touchstone_control::Fixed32 as touchstone_control::Number>::product, $crate::multiplied::product)
            (<touchstone_control::Fixed32 as touchstone_control::Number>::work, $crate::multiplied::work)
            (<u32 as touchstone_control::magnitude::Word>::times, $crate::multiplied::words)
            ($crate::guard::times, $crate::multiplied::exact)
            ($crate::spec::times, $crate::multiplied::times)
            $($pair)*]
            $($property)*
        }
    };
    (multiplied $($property:tt)*) => {
        $crate::multiplied_property!(multiplied and [] $($property)*);
    };
}

/// Functions that mark whether the products that follow belong to memory, code or specification. Without the model checker they do
/// nothing.
#[cfg(not(kani))]
mod questions {
    /// Marks that the products from now on belong to the law's memory.
    pub fn of_memory() {}
    /// Marks that the products from now on belong to the code.
    pub fn of_code() {}
    /// Marks that the products from now on belong to the specification.
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

    /// First row of the memory's products in the record.
    const MEMORY: usize = 5;
    /// First row of the code's products in the record.
    const CODE: usize = 6;
    /// Number of rows in the record. No property makes so many products.
    const END: usize = 13;
    /// Row of the next product in the record.
    static AT: AtomicUsize = AtomicUsize::new(0);
    /// 1 while the specification multiplies, otherwise 0.
    static SPECIFIES: AtomicUsize = AtomicUsize::new(0);
    /// Row of the record that follows the code's last product.
    static ASKED: AtomicUsize = AtomicUsize::new(CODE);
    /// First factor of the product in each row.
    static LEFT: [AtomicU32; END] = [const { AtomicU32::new(0) }; END];
    /// Second factor of the product in each row.
    static RIGHT: [AtomicU32; END] = [const { AtomicU32::new(0) }; END];
    /// The product in each row.
    static FOUND: [AtomicU64; END] = [const { AtomicU64::new(0) }; END];

    pub fn of_memory() {
        AT.store(MEMORY, Relaxed);
    }
    pub fn of_code() {
        AT.store(CODE, Relaxed);
    }
    pub fn of_specification() {
        ASKED.store(AT.load(Relaxed), Relaxed);
        AT.store(CODE, Relaxed);
        SPECIFIES.store(1, Relaxed);
    }
    /// Whether the specification multiplies now; before that, the code does.
    pub fn specifies() -> bool {
        SPECIFIES.load(Relaxed) == 1
    }

    /// The two factors and the product in a row of the record.
    fn row(at: usize) -> ([u32; 2], u64) {
        let factors = [LEFT[at].load(Relaxed), RIGHT[at].load(Relaxed)];
        (factors, FOUND[at].load(Relaxed))
    }
    /// Row of the record that follows the code's last product, also while the code still multiplies.
    fn asked() -> usize {
        if specifies() {
            ASKED.load(Relaxed)
        } else {
            AT.load(Relaxed)
        }
    }
    /// Assumes that a product is in order with every product of the code: if its factors are smaller, it is not larger
    /// (`facts::in_order`).
    pub fn in_order_with_the_code(factors: [u32; 2], found: u64) {
        let (mut of, end) = (CODE, asked());
        while of < END && of < end {
            let (before, product) = row(of);
            kani::assume(
                facts::in_order(factors, found, before, product)
                    && facts::in_order(before, product, factors, found),
            );
            of += 1;
        }
    }
    /// Assumes `whole = part + product` for each product of the code whose factor is the rest of the split factor
    /// (`facts::adds_up`).
    pub fn adds_up_with_the_code(factors: [u32; 2], whole: u64, parts: [u32; 2], part: u64) {
        let (mut of, end) = (CODE, asked());
        while of < END && of < end {
            let (rest, product) = row(of);
            kani::assume(facts::adds_up(factors, whole, parts, part, rest, product));
            of += 1;
        }
    }
    /// Assumes that `found`, the product of `a` and `b`, is at most `factor · b` for each factor of [`facts::FACTORS`] that is at least
    /// `a`, and the same with `a` and `b` exchanged. The products with these factors need no multiplication.
    pub fn known([a, b]: [u32; 2], found: u64) {
        let known = [facts::products(a), facts::products(b)];
        let mut i = 0;
        while i < facts::FACTORS.len() {
            let factor = facts::FACTORS[i];
            kani::assume(facts::in_order([a, b], found, [factor, b], known[1][i]));
            kani::assume(facts::in_order([b, a], found, [factor, a], known[0][i]));
            i += 1;
        }
    }

    /// The product of two absolute values: any number that has the assumed facts.
    pub fn magnitude(a: u32, b: u32) -> u64 {
        let at = AT.load(Relaxed);
        AT.store(at + 1, Relaxed);
        let any: u64 = kani::any();
        if specifies() {
            if at >= ASKED.load(Relaxed) || at >= END {
                return any;
            }
            let (factors, found) = row(at);
            return if factors == [a, b] { found } else { any };
        }
        known([a, b], any);
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

    /// Gives `size` the sign of the product `a b`.
    pub fn signed(a: i32, b: i32, size: u64) -> i64 {
        if (a < 0) == (b < 0) {
            size as i64
        } else {
            (size as i64).wrapping_neg()
        }
    }
    fn product_of(a: i32, b: i32) -> i64 {
        signed(a, b, magnitude(a.unsigned_abs(), b.unsigned_abs()))
    }
    /// Converts a number of the specification to a 32-bit word.
    pub fn word(x: i128) -> i32 {
        assert!(
            i32::try_from(x).is_ok(),
            "the specification multiplies words"
        );
        x as i32
    }

    /// Replaces [`touchstone_control::magnitude::Word::times`] when the model checker runs the code: returns any value, and the
    /// same value for equal arguments.
    pub fn words(a: u32, b: u32) -> u64 {
        magnitude(a, b)
    }
    /// Replaces [`Number::product`] when the model checker runs the code: returns any value, and the same value for equal
    /// arguments.
    pub fn product(k: Gain, x: Signal) -> i64 {
        product_of(k.to_bits(), x.to_bits())
    }
    /// Replaces [`Number::work`] when the model checker runs the code: returns any value, and the same value for equal arguments.
    pub fn work(f: Signal, d: Signal) -> <Fixed32 as Number>::Energy {
        <Fixed32 as Number>::Energy::from_bits(product_of(f.to_bits(), d.to_bits()))
    }
    /// Replaces [`crate::spec::times`] when the model checker runs the specification: returns the value that the code got for equal
    /// arguments.
    pub fn times(a: i128, b: i128) -> i128 {
        i128::from(product_of(word(a), word(b)))
    }
    /// Replaces [`crate::guard::times`] when the model checker runs the code: returns any value, and the same value for equal
    /// arguments.
    pub fn exact<N: Format>(a: i64, b: i64) -> N::Exact {
        N::exact(times(a.into(), b.into()) as i64)
    }
}
