//! Division and roots at 32 bits when the model checker runs: any result that has proved facts, and the same result for equal
//! arguments.
//!
//! A quotient here is any number that has the facts of [`facts`], as a product is in [`crate::multiplied`]. The specification's
//! next call gets the code's result if its arguments are equal. Quotient times divisor, the part of the dividend that the quotient
//! accounts for, is a product with the facts of products. A `divided_property!` replaces divisions and roots of code and
//! specification by the functions of this file, and products by those of [`crate::multiplied`].
//!
//! ```text
//! q b <= a, a - q b < b, and q < 2^31 where a < 2^31 b     p3_quotient, obligations/check.py
//! r < 2^31 where r^2 <= x < 2^62                           p3_root, obligations/check.py
//! ```
//!
//! `heart::p1_divide`, `p1_affordable`, `p6_quotient` and `p5_root_digit` prove that the code's operations have these facts; for
//! signed numbers, `edges::p1_edge_*` and `p6_edge_divide`. `control/src/reciprocal.rs` shows that the reciprocal gives the same
//! quotients. Settings are divided in 128 bits; of those quotients a proof uses only the sign.

use crate::{cover, property};
#[cfg(kani)]
use fixed::{FixedI64, types::extra::LeEqU64};
#[cfg(kani)]
use touchstone_control::Si;

/// Defines a property for whose proof the model checker replaces functions by others. The pairs of a function and its replacement
/// come first; the rest is as in `property!`.
#[macro_export]
macro_rules! replaced_property {
    ([$($pair:tt)*] $(#[doc = $doc:literal])* equation $equation:literal over $over:literal by sampled fn $name:ident($s:ident) $body:block) => {
        $crate::property! {
            $(#[doc = $doc])*
            equation $equation over $over by sampled fn $name($s) $body
        }
    };
    ([$($pair:tt)*] $(#[doc = $doc:literal])* equation $equation:literal over $over:literal by $solver:ident fn $name:ident($s:ident) $body:block) => {
        $(#[doc = $doc])*
        pub mod $name {
            #[allow(unused_imports)]
            use super::*;
            /// The property's body: chooses inputs, runs the code and asserts.
            pub fn body<S: $crate::source::Source>($s: &mut S) $body

            #[cfg(kani)]
            #[kani::proof]
            #[kani::solver($solver)]
            $(#[kani::stub $pair])*
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

/// Defines a property of code and specification that both divide. At 32 bits (`multiplied`) they use the divisions and roots of
/// this file and the products of [`crate::multiplied`], at 8 bits (`plain`) their own. `and [..]` lists further pairs of a function
/// and its replacement.
#[macro_export]
macro_rules! divided_property {
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
            (<u32 as touchstone_control::magnitude::Word>::divides_within, $crate::divided::divides_within)
            (touchstone_control::magnitude::divide_u32, $crate::divided::divide)
            (<touchstone_control::Fixed32 as touchstone_control::Number>::divisor, $crate::divided::divisor)
            (<touchstone_control::Fixed32 as touchstone_control::Number>::divide_by, $crate::divided::divide_by)
            (<touchstone_control::Fixed32 as touchstone_control::Number>::affordable, $crate::divided::affordable)
            (<touchstone_control::Fixed32 as touchstone_control::Number>::root, $crate::divided::root)
            (<touchstone_control::Fixed32 as touchstone_control::Number>::root_of_four, $crate::divided::root_of_four)
            ($crate::spec::times, $crate::divided::times)
            ($crate::spec::over, $crate::divided::over)
            ($crate::spec::fba::root, $crate::divided::specified_root)
            $($pair)*]
            $($property)*
        }
    };
    (multiplied $($property:tt)*) => {
        $crate::divided_property!(multiplied and [] $($property)*);
    };
}

/// Defines a property of a law's settings, for which only three facts are known. Products and quotients are not negative if their
/// arguments are not. Twice a number is its sum with itself. Accepted settings are in their ranges.
#[macro_export]
macro_rules! settings_property {
    ($($property:tt)*) => {
        $crate::replaced_property! {
            [(touchstone_control::quotient::quotient, $crate::divided::quotient)
            (touchstone_control::Settings::validate, $crate::accepted::validated)
            (<touchstone_control::Fixed32 as touchstone_control::Number>::divisor, $crate::divided::divisor)
            (fixed::FixedI64::saturating_mul, $crate::divided::saturating_mul)]
            $($property)*
        }
    };
}

#[cfg(kani)]
pub use by_one_quotient::*;

/// Replaces `quotient` of settings when the model checker runs: any number, which is not negative if `a` is not and `b` is
/// positive. `p8_quotient_sign64` proves this fact of the code's own quotient.
#[cfg(kani)]
pub fn quotient(a: Si, b: Si) -> Si {
    let any = Si::from_bits(kani::any());
    kani::assume(a < Si::ZERO || b <= Si::ZERO || any >= Si::ZERO);
    any
}

/// Replaces `saturating_mul` of settings when the model checker runs: any number, which is not negative if neither factor is, and
/// for twice a number the sum. `p8_product64` proves both facts of the library's own product.
#[cfg(kani)]
pub fn saturating_mul<Frac: LeEqU64>(a: FixedI64<Frac>, b: FixedI64<Frac>) -> FixedI64<Frac> {
    let any: i64 = kani::any();
    kani::assume(a.to_bits() < 0 || b.to_bits() < 0 || any >= 0);
    let two = 2_i64 << Frac::U32;
    kani::assume(b.to_bits() != two || any == a.to_bits().saturating_add(a.to_bits()));
    FixedI64::from_bits(any)
}

/// The facts that the model checker assumes of quotients and roots.
pub mod facts {
    /// Whether a result has the facts of a quotient; `part` is quotient times divisor. A quotient beyond a signed word has no such
    /// part.
    #[must_use]
    pub fn is_quotient(dividend: u64, divisor: u32, quotient: u64, part: u64) -> bool {
        let fits = dividend < u64::from(divisor) << 31;
        (quotient < 1 << 31) == fits
            && (!fits || part <= dividend && dividend - part < u64::from(divisor))
    }
    /// Whether a result has the facts of a square root.
    #[must_use]
    pub fn is_root(radicand: u64, root: u32) -> bool {
        radicand >= 1 << 62 || root < 1 << 31
    }
}

property! {
    /// P3 (arithmetic): the rounded-down quotient has the facts that the model checker assumes of quotients ([`facts`]). Two
    /// solvers show it over the integers in `obligations/check.py`.
    equation "q = floor(a / b): q b <= a < q b + b, and q < 2^31 where a < 2^31 b"
    over "double word, word above 0"
    by sampled fn p3_quotient(s) {
        let (dividend, divisor) = (s.u64(), s.u32().max(1));
        let quotient = dividend / u64::from(divisor);
        assert!(facts::is_quotient(dividend, divisor, quotient, quotient.wrapping_mul(divisor.into())));
        cover!(s, quotient >= 1 << 31, "beyond");
        cover!(s, quotient > 0 && quotient < 1 << 31, "within");
    }
}
property! {
    /// P3 (arithmetic): the rounded-down root has the facts that the model checker assumes of roots ([`facts`]). Two solvers show
    /// it over the integers in `obligations/check.py`.
    equation "r = floor(sqrt(x)) < 2^31 where x < 2^62"
    over "double word"
    by sampled fn p3_root(s) {
        let radicand = s.u64();
        let root = touchstone_control::magnitude::root::<u32>(radicand).root;
        assert!(facts::is_root(radicand, root) && u64::from(root) * u64::from(root) <= radicand);
        cover!(s, root >= 1 << 31, "beyond");
        cover!(s, root > 0 && root < 1 << 31, "within");
    }
}

#[cfg(kani)]
mod by_one_quotient {
    use super::facts;
    use crate::multiplied::{
        adds_up_with_the_code, in_order_with_the_code, known, magnitude, signed as product,
        specifies, word,
    };
    use core::sync::atomic::{AtomicU32, AtomicU64, AtomicUsize, Ordering::Relaxed};
    use touchstone_control::reciprocal::Reciprocal32;
    use touchstone_control::{Fixed32, Number};

    type Signal = <Fixed32 as Number>::Signal;
    type Gain = <Fixed32 as Number>::Gain;
    type Energy = <Fixed32 as Number>::Energy;

    /// Number of rows of the table of recorded quotients: more than a law's tick has divisions or roots.
    const ROWS: usize = 3;
    const HIGHEST: u64 = (1 << 31) - 1;

    /// Row of the table of quotients for the code's next division; `AGAIN` is the row for the specification's next one.
    static DIVIDED: AtomicUsize = AtomicUsize::new(0);
    static AGAIN: AtomicUsize = AtomicUsize::new(0);
    static DIVIDEND: [AtomicU64; ROWS] = [const { AtomicU64::new(0) }; ROWS];
    static DIVISOR: [AtomicU32; ROWS] = [const { AtomicU32::new(0) }; ROWS];
    static QUOTIENT: [AtomicU64; ROWS] = [const { AtomicU64::new(0) }; ROWS];
    static PART: [AtomicU64; ROWS] = [const { AtomicU64::new(0) }; ROWS];

    /// A quotient for the code, and quotient times divisor.
    fn quotient(dividend: u64, divisor: u32) -> (u64, u64) {
        let (quotient, part): (u64, u64) = (kani::any(), kani::any());
        if divisor == 0 {
            return (0, 0);
        }
        kani::assume(facts::is_quotient(dividend, divisor, quotient, part));
        if quotient <= HIGHEST {
            let (factors, turned) = ([divisor, quotient as u32], [quotient as u32, divisor]);
            known(factors, part);
            in_order_with_the_code(factors, part);
            in_order_with_the_code(turned, part);
        }
        let at = DIVIDED.load(Relaxed);
        DIVIDED.store(at + 1, Relaxed);
        DIVIDEND[at].store(dividend, Relaxed);
        DIVISOR[at].store(divisor, Relaxed);
        QUOTIENT[at].store(quotient, Relaxed);
        PART[at].store(part, Relaxed);
        (quotient, part)
    }

    fn signed(size: u64, negative: bool) -> Signal {
        let size = size.min(HIGHEST) as i32;
        Signal::from_bits(if negative { -size } else { size })
    }

    /// Replaces [`touchstone_control::magnitude::divide_u32`] when the model checker runs the code: returns any value, and the same
    /// value for equal arguments.
    pub fn divide(wide: u64, by: u32) -> (u64, u64) {
        quotient(wide, by)
    }
    /// Replaces [`touchstone_control::magnitude::Word::divides_within`] when the model checker runs the code: returns any value,
    /// and the same value for equal arguments.
    pub fn divides_within(by: u32, wide: u64) -> Option<(u32, u64)> {
        let (quotient, part) = quotient(wide, by);
        (quotient <= HIGHEST).then_some((quotient as u32, part))
    }
    /// Replaces [`Number::divisor`] when the model checker runs. It fills no inverse, since only the replaced division would use
    /// it.
    pub fn divisor(k: Gain) -> Reciprocal32 {
        let divisor = k.to_bits().unsigned_abs();
        Reciprocal32 {
            divisor,
            scale: 0,
            inverse: 0,
        }
    }
    /// Replaces [`Number::divide_by`] when the model checker runs the code: returns any value, and the same value for equal
    /// arguments.
    pub fn divide_by(p: i64, k: &Reciprocal32) -> Signal {
        signed(quotient(p.unsigned_abs(), k.divisor).0, p < 0)
    }
    /// Replaces [`Number::affordable`] when the model checker runs. If the outward displacement is beyond the format, the energy
    /// that is left is unknown.
    pub fn affordable(e: Energy, f: Signal) -> (Signal, Energy) {
        let energy = e.to_bits().max(0);
        let (moved, part) = quotient(energy.unsigned_abs(), f.to_bits().unsigned_abs());
        let rest = if moved <= HIGHEST {
            energy - part as i64
        } else {
            kani::any()
        };
        (signed(moved, false), Energy::from_bits(rest))
    }
    /// Replaces [`crate::spec::over`] when the model checker runs the specification: returns the value that the code got for equal
    /// arguments.
    pub fn over(a: i128, b: i128) -> i128 {
        assert!(
            u64::try_from(a).is_ok() && u32::try_from(b).is_ok() && b > 0,
            "the specification divides words"
        );
        let at = AGAIN.load(Relaxed);
        AGAIN.store(at + 1, Relaxed);
        let any: u64 = kani::any();
        if at >= DIVIDED.load(Relaxed) || at >= ROWS {
            return any.into();
        }
        let same = DIVIDEND[at].load(Relaxed) == a as u64 && DIVISOR[at].load(Relaxed) == b as u32;
        if same {
            QUOTIENT[at].load(Relaxed)
        } else {
            any
        }
        .into()
    }

    /// The specification's product. It agrees with the recorded products (quotient times divisor) of the code's quotients.
    fn beside(a: u32, b: u32) -> u64 {
        let product = magnitude(a, b);
        let mut at = 0;
        while at < ROWS && at < DIVIDED.load(Relaxed) {
            let (part, quotient) = (PART[at].load(Relaxed), QUOTIENT[at].load(Relaxed));
            if quotient <= HIGHEST {
                let (factors, turned) = (
                    [DIVISOR[at].load(Relaxed), quotient as u32],
                    [quotient as u32, DIVISOR[at].load(Relaxed)],
                );
                kani::assume([a, b] != factors && [a, b] != turned || product == part);
                adds_up_with_the_code(factors, part, [a, b], product);
            }
            at += 1;
        }
        product
    }
    /// Replaces [`crate::spec::times`] when the model checker runs the specification: returns the value that the code got for equal
    /// arguments.
    pub fn times(a: i128, b: i128) -> i128 {
        let (a, b) = (word(a), word(b));
        product(a, b, beside(a.unsigned_abs(), b.unsigned_abs())).into()
    }

    static ROOTS: AtomicUsize = AtomicUsize::new(0);
    static ROOTS_AGAIN: AtomicUsize = AtomicUsize::new(0);
    static RADICAND: [AtomicU64; ROWS] = [const { AtomicU64::new(0) }; ROWS];
    static ROOT: [AtomicU32; ROWS] = [const { AtomicU32::new(0) }; ROWS];

    fn root_of(radicand: u64) -> u32 {
        let any: u32 = kani::any();
        kani::assume(facts::is_root(radicand, any));
        let (again, made) = (ROOTS_AGAIN.load(Relaxed), ROOTS.load(Relaxed));
        if specifies() {
            ROOTS_AGAIN.store(again + 1, Relaxed);
            let same = again < made && again < ROWS && RADICAND[again].load(Relaxed) == radicand;
            return if same { ROOT[again].load(Relaxed) } else { any };
        }
        ROOTS.store(made + 1, Relaxed);
        RADICAND[made].store(radicand, Relaxed);
        ROOT[made].store(any, Relaxed);
        any
    }
    /// Replaces [`Number::root`] when the model checker runs the code: returns any value, and the same value for equal arguments.
    pub fn root(e: Energy) -> Signal {
        if e.to_bits() <= 0 {
            return Signal::ZERO;
        }
        signed(root_of(e.to_bits() as u64).into(), false)
    }
    /// Replaces [`Number::root_of_four`] when the model checker runs the code: returns any value, and the same value for equal
    /// arguments.
    pub fn root_of_four(k: Gain) -> Gain {
        if k.to_bits() <= 0 {
            return Gain::ZERO;
        }
        let radicand = u64::from(k.to_bits() as u32) << (Gain::FRAC_NBITS + 2);
        Gain::from_bits(root_of(radicand).min(HIGHEST as u32) as i32)
    }
    /// Replaces [`crate::spec::fba::root`] when the model checker runs the specification: returns the value that the code got for
    /// equal arguments.
    pub fn specified_root(x: i128) -> i128 {
        if x <= 0 {
            return 0;
        }
        assert!(
            u64::try_from(x).is_ok(),
            "the specification takes roots of double words"
        );
        root_of(x as u64).into()
    }
}
