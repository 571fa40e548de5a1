//! Products of the estimator when the model checker runs: any result, and the same result for equal arguments, as in
//! [`crate::multiplied`]. The factors are a weight (coefficient) and a part (leading digits of a state).
//!
//! Whether a tick of the estimator equals its specification does not depend on its products. A `weighed_property!` replaces each by
//! any number, and the specification's next call gets the code's result if its arguments are equal. Here each sum is assumed not to
//! overflow; other properties prove that.
//!
//! ```text
//! no sum of the code overflows                            estimator::p3_flow_fits32, p3_motion_stays32
//! sums that do not overflow are exact                     wide::p3_wide_sums
//! the code's multiplications are exact products           p1_weight_times_part
//! 0 <= w <= 2^k  implies  w p between 0 and p << k        p3_weight_in_range, multiplied::p3_product_in_order, obligations/check.py
//! |x⁻| < 160 rad, |d⁻| < 21 rad                           estimator::p3_flow_fits32
//! ```
//!
//! Larger steps are replaced in the same way: the result of a prediction (`flowed_property!`, `bounded_property!`) and the
//! correction (`corrected_property!`). `estimated::p11_estimator_flow` and `p11_estimator_corrected` prove that these equal their
//! specification.

use crate::{cover, property};
use touchstone_control::number::{Wide as _, Wide64};

/// Whether a product has its proved facts: it lies between 0 and the other factor if the weight (coefficient) is from 0 to 1, and
/// between 0 and twice that factor if the weight is from 0 to 2.
#[must_use]
pub fn in_range(weight: i32, part: i32, product: i64) -> bool {
    let between = |end: i64| product >= end.min(0) && product <= end.max(0);
    weight < 0
        || (weight > 1 << 26 || between(i64::from(part) << 26))
            && (weight > 1 << 27 || between(i64::from(part) << 27))
}

property! {
    /// P1 (energy): the code's product of a weight (coefficient) and a part (leading digits of a state) is the exact product.
    equation "w p = w p"
    over "weight and part"
    by kissat fn p1_weight_times_part(s) {
        let (w, p) = (s.i32(), s.i32());
        let found = Wide64::product(w, p).0;
        assert!(found == i64::from(w) * i64::from(p));
        cover!(s, found < 0, "negative");
        cover!(s, w == i32::MIN && p == i32::MIN, "both lowest");
    }
}
property! {
    /// P3 (arithmetic): a weight (coefficient) from 0 to 1 gives a product between 0 and the other factor; one from 0 to 2, between
    /// 0 and twice that factor. This follows from the order of products, which two solvers show over the integers in
    /// `obligations/check.py`.
    equation "0 <= w <= 2^k implies w p between 0 and p << k, k = 26, 27"
    over "weight and part"
    by sampled fn p3_weight_in_range(s) {
        let (w, p) = (s.i32(), s.i32());
        assert!(in_range(w, p, i64::from(w) * i64::from(p)));
        cover!(s, w == 1 << 27 && p == i32::MIN, "twice the lowest");
    }
}

/// Defines a property of the estimator and its specification, in which the functions of this file replace the products.
#[macro_export]
macro_rules! weighed_property {
    (and [$($pair:tt)*] $($property:tt)*) => {
        $crate::replaced_property! {
            [(<touchstone_control::number::Wide64 as touchstone_control::number::Wide>::product, $crate::weighed::product)
            (<touchstone_control::number::Wide64 as touchstone_control::number::Wide>::plus_fitting, $crate::weighed::plus)
            (<touchstone_control::number::Wide64 as touchstone_control::number::Wide>::minus_fitting, $crate::weighed::minus)
            ($crate::spec::estimator::weighed, $crate::weighed::weighed)
            $($pair)*]
            $($property)*
        }
    };
    ($($property:tt)*) => {
        $crate::weighed_property!(and [] $($property)*);
    };
}
/// Defines a property of the estimator's correction, in which the prediction before it is replaced by any result.
#[macro_export]
macro_rules! flowed_property {
    ($($property:tt)*) => {
        $crate::weighed_property! {
            and [
                (touchstone_control::estimator::Flow::apply, $crate::weighed::end)
                ($crate::spec::estimator::Flow::end, $crate::weighed::specified_end)
            ]
            $($property)*
        }
    };
}
/// Defines a property of the estimator's tick, in which prediction and correction are replaced by any results.
#[macro_export]
macro_rules! corrected_property {
    ($($property:tt)*) => {
        $crate::replaced_property! {
            [(touchstone_control::estimator::Flow::apply, $crate::weighed::end)
            ($crate::spec::estimator::Flow::end, $crate::weighed::specified_end)
            (touchstone_control::Estimator::corrected, $crate::weighed::corrected)
            ($crate::spec::estimator::Estimator::corrected, $crate::weighed::specified_corrected)]
            $($property)*
        }
    };
}
/// Defines a property of the estimator's correction that holds for any result of the prediction within its range.
#[macro_export]
macro_rules! bounded_property {
    ($($property:tt)*) => {
        $crate::replaced_property! {
            [(<touchstone_control::number::Wide64 as touchstone_control::number::Wide>::product, $crate::weighed::bounded)
            (touchstone_control::estimator::Flow::apply, $crate::weighed::end)]
            $($property)*
        }
    };
}

/// Functions that mark whether code or specification multiplies from now on. Without the model checker they do nothing.
#[cfg(not(kani))]
mod questions {
    /// Does nothing: random tests need not know whether code or specification calls.
    pub fn of_specification() {}
}
#[cfg(not(kani))]
pub use questions::of_specification;

#[cfg(kani)]
pub use by_one_product::*;
#[cfg(kani)]
mod by_one_product {
    use super::in_range;
    use crate::multiplied::word;
    use crate::spec::estimator as spec;
    use core::sync::atomic::{AtomicI32, AtomicI64, AtomicUsize, Ordering::Relaxed};
    use touchstone_control::estimator::{EstimatedMotion, Flow, Part, TAPS};
    use touchstone_control::number::{Wide, Wide64};
    use touchstone_control::{Estimator, Number, Position};

    /// Number of rows in the record. No property makes so many products.
    const END: usize = 10;
    /// Row of the next product in the record.
    static AT: AtomicUsize = AtomicUsize::new(0);
    /// 1 while the specification multiplies, otherwise 0.
    static SPECIFIES: AtomicUsize = AtomicUsize::new(0);
    /// Number of multiplications by the code. Row `i` of the record belongs to the code's call `i`: weight, part, and their
    /// product.
    static ASKED: AtomicUsize = AtomicUsize::new(0);
    /// The weight (a coefficient of the estimator) in each row.
    static WEIGHT: [AtomicI32; END] = [const { AtomicI32::new(0) }; END];
    /// The part of a motion or torque by which the weight is multiplied, in each row.
    static PART: [AtomicI32; END] = [const { AtomicI32::new(0) }; END];
    /// The product in each row.
    static FOUND: [AtomicI64; END] = [const { AtomicI64::new(0) }; END];

    pub fn of_specification() {
        ASKED.store(AT.load(Relaxed), Relaxed);
        AT.store(0, Relaxed);
        SPECIFIES.store(1, Relaxed);
    }

    /// Replaces the code's product of a weight and a part when the model checker runs: any number, recorded for the specification.
    pub fn product(weight: i32, part: i32) -> Wide64 {
        let at = AT.load(Relaxed);
        AT.store(at + 1, Relaxed);
        let any: i64 = kani::any();
        WEIGHT[at].store(weight, Relaxed);
        PART[at].store(part, Relaxed);
        FOUND[at].store(any, Relaxed);
        Wide64(any)
    }
    /// Replaces [`crate::spec::estimator::weighed`] when the model checker runs the specification: returns the value that the code
    /// got for equal arguments.
    pub fn weighed(weight: i128, part: i128) -> i128 {
        assert!(
            SPECIFIES.load(Relaxed) == 1,
            "the code has no specification"
        );
        let (weight, part) = (word(weight), word(part));
        let at = AT.load(Relaxed);
        AT.store(at + 1, Relaxed);
        let any: i64 = kani::any();
        if at >= ASKED.load(Relaxed) || at >= END {
            return any.into();
        }
        let same = WEIGHT[at].load(Relaxed) == weight && PART[at].load(Relaxed) == part;
        if same {
            FOUND[at].load(Relaxed).into()
        } else {
            any.into()
        }
    }
    /// Replaces a sum of the code when the model checker runs. The sum is assumed not to overflow, which `estimator::p3_*` prove.
    pub fn plus(a: Wide64, b: Wide64) -> Wide64 {
        let sum = a.0.checked_add(b.0);
        kani::assume(sum.is_some());
        Wide64(sum.unwrap_or_default())
    }
    /// Replaces a difference of the code when the model checker runs. It is assumed not to overflow, which `estimator::p3_*` prove.
    pub fn minus(a: Wide64, b: Wide64) -> Wide64 {
        let difference = a.0.checked_sub(b.0);
        kani::assume(difference.is_some());
        Wide64(difference.unwrap_or_default())
    }

    /// Replaces the code's product when the model checker runs, in properties for which only the product's range matters.
    pub fn bounded(weight: i32, part: i32) -> Wide64 {
        let any: i64 = kani::any();
        kani::assume(in_range(weight, part, any));
        Wide64(any)
    }

    /// A wide number (an estimator's state) that can be made from any bits.
    pub trait Made: Wide {
        /// A wide number with these bits.
        fn made(bits: i64) -> Self;
        /// The bits of a wide number.
        fn bits(self) -> i64;
        /// The bits of a part: the leading digits of a wide number, which are one factor of a product.
        fn of_part(part: Self::Part) -> i64;
        /// The bits of a weight: the coefficient that is the other factor of a product.
        fn of_weight(weight: Self::Weight) -> i64;
    }
    impl Made for Wide64 {
        fn made(bits: i64) -> Self {
            Self(bits)
        }
        fn bits(self) -> i64 {
            self.0
        }
        fn of_part(part: i32) -> i64 {
            part.into()
        }
        fn of_weight(weight: i32) -> i64 {
            weight.into()
        }
    }

    const WORDS: usize = 15;
    /// Record of the code's only call of a replaced step of the tick: arguments and result.
    struct Piece {
        asked: AtomicUsize,
        question: [AtomicI64; WORDS],
        answer: [AtomicI64; 4],
    }
    static FLOW: Piece = Piece::new();
    static CORRECTED: Piece = Piece::new();

    impl Piece {
        const fn new() -> Self {
            Self {
                asked: AtomicUsize::new(0),
                question: [const { AtomicI64::new(0) }; WORDS],
                answer: [const { AtomicI64::new(0) }; 4],
            }
        }
        /// The result of a replaced step: any result at the first call. Later calls get the same result for equal arguments, and
        /// any result for others.
        fn answer(&self, question: [i64; WORDS]) -> [i64; 4] {
            let mut any: [i64; 4] = [kani::any(), kani::any(), kani::any(), kani::any()];
            let first = self.asked.load(Relaxed) == 0;
            let (mut same, mut at) = (true, 0);
            while at < WORDS {
                if first {
                    self.question[at].store(question[at], Relaxed);
                }
                same = same && self.question[at].load(Relaxed) == question[at];
                at += 1;
            }
            at = 0;
            while at < 4 {
                if first {
                    self.answer[at].store(any[at], Relaxed);
                }
                if same {
                    any[at] = self.answer[at].load(Relaxed);
                }
                at += 1;
            }
            self.asked.store(1, Relaxed);
            any
        }
    }

    /// Any result of a prediction within the range that `estimator::p3_flow_fits32` proves.
    fn any_end(question: [i64; WORDS]) -> (i64, i64) {
        let [position, moved, ..] = FLOW.answer(question);
        kani::assume(position.unsigned_abs() < 160 << Wide64::FRACTION);
        kani::assume(moved.unsigned_abs() < 21 << Wide64::FRACTION);
        (position, moved)
    }
    /// Replaces [`Flow::apply`] when the model checker runs the code: returns any value, and the same value for equal arguments.
    pub fn end<N: Number, const COMMANDS: usize>(
        flow: &Flow<N, COMMANDS>,
        from: &EstimatedMotion<N>,
        commands: &[Part<N>; TAPS],
    ) -> (N::Wide, N::Wide)
    where
        N::Wide: Made,
    {
        let mut question = [0; WORDS];
        question[0] = from.position.bits();
        question[1] = from.moved.bits();
        question[2] = from.pushed.bits();
        question[3] = N::Wide::of_weight(flow.reach);
        question[4] = N::Wide::of_weight(flow.drift);
        question[5] = N::Wide::of_weight(flow.loss);
        let mut i = 0;
        while i < COMMANDS {
            question[6 + i] = N::Wide::of_part(commands[i]);
            question[9 + 2 * i] = N::Wide::of_weight(flow.commands[i][0]);
            question[10 + 2 * i] = N::Wide::of_weight(flow.commands[i][1]);
            i += 1;
        }
        let (position, moved) = any_end(question);
        (N::Wide::made(position), N::Wide::made(moved))
    }
    /// Replaces [`spec::Flow::end`] when the model checker runs the specification: returns the value that the code got for equal
    /// arguments.
    pub fn specified_end<const COMMANDS: usize>(
        flow: &spec::Flow<COMMANDS>,
        from: spec::Motion,
        f: [i128; spec::REMEMBERED],
    ) -> (i128, i128) {
        let mut question = [0; WORDS];
        question[0] = double(from.x);
        question[1] = double(from.d);
        question[2] = double(from.g);
        question[3] = double(flow.reach);
        question[4] = double(flow.drift);
        question[5] = double(flow.loss);
        let mut i = 0;
        while i < COMMANDS {
            question[6 + i] = double(f[i]);
            question[9 + 2 * i] = double(flow.commands[i][0]);
            question[10 + 2 * i] = double(flow.commands[i][1]);
            i += 1;
        }
        let (position, moved) = any_end(question);
        (position.into(), moved.into())
    }
    fn double(x: i128) -> i64 {
        assert!(
            i64::try_from(x).is_ok(),
            "the specification asks double words"
        );
        x as i64
    }

    /// Replaces [`Estimator::corrected`] when the model checker runs: any estimated motion, or `None`.
    pub fn corrected<N: Number>(
        _: &Estimator<N>,
        before: &EstimatedMotion<N>,
        commands: &[Part<N>; TAPS],
        measured: Position<N>,
    ) -> Option<EstimatedMotion<N>>
    where
        N::Wide: Made,
    {
        let [position, moved, pushed] = any_corrected(
            [before.position, before.moved, before.pushed].map(Made::bits),
            commands.map(N::Wide::of_part),
            N::widen(measured.0).bits(),
        )?;
        Some(EstimatedMotion {
            position: N::Wide::made(position),
            moved: N::Wide::made(moved),
            pushed: N::Wide::made(pushed),
        })
    }
    fn any_corrected(before: [i64; 3], commands: [i64; 3], measured: i64) -> Option<[i64; 3]> {
        let mut question = [0; WORDS];
        let mut i = 0;
        while i < 3 {
            question[i] = before[i];
            question[3 + i] = commands[i];
            i += 1;
        }
        question[6] = measured;
        let [some, position, moved, pushed] = CORRECTED.answer(question);
        (some > 0).then_some([position, moved, pushed])
    }
    /// Replaces [`spec::Estimator::corrected`] when the model checker runs the specification: returns the value that the code got
    /// for equal arguments.
    pub fn specified_corrected(
        _: &spec::Estimator,
        before: spec::Motion,
        f: [i128; spec::REMEMBERED],
        e: i128,
    ) -> Option<spec::Motion> {
        let before = [double(before.x), double(before.d), double(before.g)];
        let [x, d, g] = any_corrected(before, f.map(double), double(spec::state(e)))?;
        Some(spec::Motion {
            x: x.into(),
            d: d.into(),
            g: g.into(),
        })
    }
}
