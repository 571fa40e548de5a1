//! A number type of whose products, quotients and roots only proved facts are known. With it the laws can be proved at 32 bits.
//!
//! No solver tried follows several 64-bit products and quotients through a whole tick. But the laws are generic over [`Number`], so
//! they can run on one more type. [`Facts32`] has the formats of `Fixed32` and its additions, comparisons and roundings. Of each
//! product, quotient and root it knows only the facts below: it may return any result that has them.
//!
//! What holds for all such results holds for those of `Fixed32`, provided that `Fixed32` has the facts. The properties of
//! `facts::fixed32` prove that at 32 bits; two solvers show the size of a product over the integers. The proofs run the shipped
//! source of the laws; no function is replaced.
//!
//! Without the model checker, `Facts32` calls `Fixed32` and asserts the facts, so every random test checks them too.

use touchstone_control::number::Wide64;
use touchstone_control::{Fixed32, Number, Si};

type Signal = <Fixed32 as Number>::Signal;
type Gain = <Fixed32 as Number>::Gain;
type Energy = <Fixed32 as Number>::Energy;

/// A number type like `Fixed32`, of whose products, quotients and roots only proved facts are known.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Facts32;

/// The facts that are assumed of products, quotients and roots. Each is one function, so that assumption and proof use the same
/// text.
pub mod fact {
    /// Whether a result is 0 or has the sign of `x`.
    pub fn sign_of(result: i64, x: i64) -> bool {
        (x != 0 || result == 0) && (x <= 0 || result >= 0) && (x >= 0 || result <= 0)
    }
    /// Facts of force times displacement: the result has the right sign, and a size that leaves room for one addition.
    pub fn work(result: i64, f: i64, d: i64) -> bool {
        result.unsigned_abs() <= 1 << 62 && sign_of(result, sign(f, d))
    }
    /// The sign of the product of `f` and `d`, found without a multiplication, because the solvers cannot follow one.
    pub fn sign(f: i64, d: i64) -> i64 {
        if f == 0 || d == 0 {
            0
        } else if (f < 0) == (d < 0) {
            1
        } else {
            -1
        }
    }
    /// Fact of a product of a gain and a signal: its size is at most the gain times the largest absolute value of a signal
    /// (position or force).
    pub fn product_size(result: i64, gain: i64) -> bool {
        gain < 0 || result.unsigned_abs() <= gain.unsigned_abs() << 31
    }
    /// Facts of a passivity step (a force bounded by stored energy). Energy and force stay non-negative, and the force never grows.
    /// Inward the force stays and the energy does not shrink; outward the energy does not grow.
    pub fn step(after: i64, shown: i64, e: i64, f: i64, d: i64) -> bool {
        after >= 0
            && shown >= 0
            && shown <= f
            && if d >= 0 {
                shown == f && after >= e
            } else {
                after <= e
            }
    }
    /// Facts of the outward displacement that energy pays for: it is not negative, and the energy left is between 0 and the energy
    /// before.
    pub fn affordable(moved: i64, rest: i64, e: i64) -> bool {
        moved >= 0 && rest >= 0 && rest <= e
    }
    /// Facts of a square root: it is not negative, and it is 0 if its argument is not positive.
    pub fn root(result: i64, e: i64) -> bool {
        result >= 0 && (e > 0 || result == 0)
    }
}

/// Defines one operation of [`Facts32`]. Under the model checker the result is any number with the given fact; otherwise it is
/// calculated, and the fact is asserted.
#[cfg(kani)]
macro_rules! known {
    ($op:literal, $exact:expr, |$r:ident| $fact:expr) => {{
        let $r: i64 = kani::any();
        kani::assume($fact);
        $r
    }};
}
#[cfg(not(kani))]
macro_rules! known {
    ($op:literal, $exact:expr, |$r:ident| $fact:expr) => {{
        let $r: i64 = $exact;
        assert!($fact, "{} gave {}", $op, $r);
        $r
    }};
}

fn bits(x: Signal) -> i64 {
    i64::from(x.to_bits())
}
fn signal(bits: i64) -> Signal {
    Signal::from_bits(bits as i32)
}
/// Whether a result fits a 32-bit word.
fn word(bits: i64) -> bool {
    i32::try_from(bits).is_ok()
}

impl Number for Facts32 {
    type Signal = Signal;
    type Gain = Gain;
    type Ratio = Signal;
    type Energy = Energy;
    type Product = i64;
    type Divisor = Gain;
    type Wide = Wide64;
    const NAME: &'static str = "facts32";
    const QUANTUM: Signal = Fixed32::QUANTUM;

    fn signal(si: Si) -> Option<Signal> {
        Fixed32::signal(si)
    }
    fn saturating_signal(si: Si) -> Signal {
        Fixed32::saturating_signal(si)
    }
    fn gain(si: Si) -> Option<Gain> {
        Fixed32::gain(si)
    }
    fn ratio(si: Si) -> Option<Signal> {
        Fixed32::ratio(si)
    }
    fn energy(si: Si) -> Option<Energy> {
        Fixed32::energy(si)
    }
    fn add(a: Signal, b: Signal) -> Signal {
        Fixed32::add(a, b)
    }
    fn sub(a: Signal, b: Signal) -> Signal {
        Fixed32::sub(a, b)
    }
    fn neg(a: Signal) -> Signal {
        Fixed32::neg(a)
    }
    fn modulus(a: Signal) -> Signal {
        Fixed32::modulus(a)
    }
    fn scale(r: Signal, x: Signal) -> Signal {
        signal(known!("Scale", bits(Fixed32::scale(r, x)), |y| word(y)
            && fact::sign_of(y, bits(x))))
    }
    fn product(k: Gain, x: Signal) -> i64 {
        let gain = i64::from(k.to_bits());
        known!("Product", Fixed32::product(k, x), |y| fact::work(
            y,
            gain,
            bits(x)
        )
            && fact::product_size(y, gain))
    }
    fn lift(x: Signal) -> i64 {
        Fixed32::lift(x)
    }
    fn add_product(a: i64, b: i64) -> i64 {
        Fixed32::add_product(a, b)
    }
    fn sub_product(a: i64, b: i64) -> i64 {
        Fixed32::sub_product(a, b)
    }
    // The model checker and every test on random samples check that the sum and the difference fit.
    fn add_fitting(a: i64, b: i64) -> i64 {
        Fixed32::add_fitting(a, b)
    }
    fn sub_fitting(a: i64, b: i64) -> i64 {
        Fixed32::sub_fitting(a, b)
    }
    fn positive_down(p: i64) -> Signal {
        Fixed32::positive_down(p)
    }
    fn positive_up(p: i64) -> Signal {
        Fixed32::positive_up(p)
    }
    fn round_to_zero(p: i64) -> Signal {
        Fixed32::round_to_zero(p)
    }
    fn round_up(p: i64) -> Signal {
        Fixed32::round_up(p)
    }
    fn divide(p: i64, k: Gain) -> Signal {
        signal(known!("Divide", bits(Fixed32::divide(p, k)), |y| word(y)
            && fact::sign_of(y, p)))
    }
    fn divisor(k: Gain) -> Gain {
        k
    }
    fn divide_by(p: i64, k: &Gain) -> Signal {
        let _exact = |k: &Gain| Fixed32::divide_by(p, &Fixed32::divisor(*k));
        signal(known!("DivideBy", bits(_exact(k)), |y| word(y)
            && fact::sign_of(y, p)))
    }
    fn widen(x: Signal) -> Wide64 {
        Fixed32::widen(x)
    }
    fn narrow(x: Wide64) -> Signal {
        Fixed32::narrow(x)
    }
    fn work(f: Signal, d: Signal) -> Energy {
        Energy::from_bits(known!("Work", Fixed32::work(f, d).to_bits(), |y| {
            fact::work(y, bits(f), bits(d))
        }))
    }
    fn add_energy(a: Energy, b: Energy) -> Energy {
        Fixed32::add_energy(a, b)
    }
    fn sub_energy(a: Energy, b: Energy) -> Energy {
        Fixed32::sub_energy(a, b)
    }
    // The model checker and every test on random samples check that the sum and the difference fit.
    fn add_energy_fitting(a: Energy, b: Energy) -> Energy {
        Fixed32::add_energy_fitting(a, b)
    }
    fn sub_energy_fitting(a: Energy, b: Energy) -> Energy {
        Fixed32::sub_energy_fitting(a, b)
    }
    fn energy_digits_fitting(e: Energy) -> Signal {
        Fixed32::energy_digits_fitting(e)
    }
    fn modulus_fitting(a: Signal) -> Signal {
        Fixed32::modulus_fitting(a)
    }
    // Nothing is known of the result except that it is a word.
    fn scale_both_fitting(r: Signal, x: Signal, q: Signal, y: Signal) -> Signal {
        signal(known!(
            "ScaleBoth",
            bits(Fixed32::scale_both_fitting(r, x, q, y)),
            |z| word(z)
        ))
    }
    fn round_down_fitting(p: i64) -> Signal {
        Fixed32::round_down_fitting(p)
    }
    fn half_energy_up(e: Energy) -> Energy {
        Fixed32::half_energy_up(e)
    }
    fn energy_per(e: Energy, x: Signal) -> Signal {
        signal(known!("Per", bits(Fixed32::energy_per(e, x)), |y| word(y)
            && y >= 0))
    }
    fn root(e: Energy) -> Signal {
        signal(known!("Root", bits(Fixed32::root(e)), |y| word(y)
            && fact::root(y, e.to_bits())))
    }
    fn root_of_four(k: Gain) -> Gain {
        Fixed32::root_of_four(k)
    }
    fn affordable(e: Energy, f: Signal) -> (Signal, Energy) {
        let (stored, force) = (e.to_bits(), bits(f));
        let (_exact_moved, _exact_rest) = if cfg!(kani) {
            (Signal::ZERO, Energy::ZERO)
        } else {
            Fixed32::affordable(e, f)
        };
        // Outside these conditions nothing is known of the result. The laws never call it there.
        let inside = stored >= 0 && force > 0;
        let moved = known!("Moved", bits(_exact_moved), |y| word(y)
            && (!inside || y >= 0));
        let rest = known!("Rest", _exact_rest.to_bits(), |y| !inside
            || fact::affordable(moved, y, stored));
        (signal(moved), Energy::from_bits(rest))
    }
    fn passivity_step(e: Energy, f: Signal, d: Signal) -> (Energy, Signal) {
        let (_exact_energy, _exact_force) = if cfg!(kani) {
            (Energy::ZERO, Signal::ZERO)
        } else {
            Fixed32::passivity_step(e, f, d)
        };
        let inside = e.to_bits() >= 0 && bits(f) >= 0;
        let shown = known!("StepForce", bits(_exact_force), |y| word(y)
            && (!inside || (y >= 0 && y <= bits(f))));
        let after = known!("StepEnergy", _exact_energy.to_bits(), |y| !inside
            || fact::step(y, shown, e.to_bits(), bits(f), bits(d)));
        (Energy::from_bits(after), signal(shown))
    }
}

/// Proofs that the operations of `Fixed32` have the facts that are assumed of [`Facts32`].
pub mod fixed32 {
    use super::{Energy, Fixed32, Gain, Number, Signal, bits, fact};
    use crate::{assume, cover, property};

    property! {
        /// P3 (arithmetic): `Fixed32` has the assumed fact of `scale`: a ratio times a position or force is 0 or keeps the sign.
        equation "sign(|r| x) = sign(x) or 0"
        over "pair of words"
        by kissat fn p3_fact_scale(s) {
            let (r, x) = (Signal::from_bits(s.i32()), Signal::from_bits(s.i32()));
            let y = Fixed32::scale(r, x);
            assert!(fact::sign_of(bits(y), bits(x)));
            cover!(s, y < 0, "negative");
        }
    }
    property! {
        /// P3 (arithmetic): `Fixed32` has the assumed fact of `product`: gain times signal has the sign of the factors' product. It
        /// holds for all gains, although `validate` keeps them non-negative.
        equation "sign(k x) = sign(k) sign(x)"
        over "pair of words"
        by kissat fn p3_fact_product_sign(s) {
            let (k, x) = (s.i32(), s.i32());
            let y = Fixed32::product(Gain::from_bits(k), Signal::from_bits(x));
            assert!(fact::sign_of(y, fact::sign(i64::from(k), i64::from(x))));
            cover!(s, y < 0 && k > 1, "negative");
        }
    }
    property! {
        /// P3 (arithmetic): `Fixed32` has the assumed fact on the size of a product: at most the gain times 2^31. The product is
        /// exact (`multiplied::p1_products_are_exact`); two solvers show its size over the integers in `obligations/check.py`.
        equation "|k x| <= k 2^31"
        over "pair of words"
        by sampled fn p3_fact_product_size(s) {
            let (k, x) = (s.i32(), s.i32());
            let y = Fixed32::product(Gain::from_bits(k), Signal::from_bits(x));
            assert!(fact::product_size(y, i64::from(k)));
            cover!(s, y < 0 && k > 1, "negative");
        }
    }
    property! {
        /// P3 (arithmetic): `Fixed32` has the assumed fact on the size of products and of work: a product of two words is at most
        /// 2^62, whatever the words stand for.
        equation "|f d| <= 2^62"
        over "pair of words"
        by kissat fn p3_fact_work_size(s) {
            let (f, d) = (s.i32(), s.i32());
            let y = Fixed32::work(Signal::from_bits(f), Signal::from_bits(d)).to_bits();
            assert!(y.unsigned_abs() <= 1 << 62);
            cover!(s, y == 1 << 62, "largest");
        }
    }
    property! {
        /// P3 (arithmetic): `Fixed32` has the assumed fact of `work`: force times displacement has the sign of the product.
        equation "sign(f d) = sign(f) sign(d)"
        over "pair of words"
        by kissat fn p3_fact_work_sign(s) {
            let (f, d) = (s.i32(), s.i32());
            let y = Fixed32::work(Signal::from_bits(f), Signal::from_bits(d)).to_bits();
            assert!(fact::sign_of(y, fact::sign(i64::from(f), i64::from(d))));
            cover!(s, y < 0, "given");
        }
    }
    property! {
        /// P3 (arithmetic): `Fixed32` has the assumed fact of `divide`: a quotient is 0 or has the dividend's sign.
        equation "sign(p / k) = sign(p) or 0"
        over "double word and word"
        by kissat fn p3_fact_divide(s) {
            let (p, k) = (s.i64(), s.i32());
            let y = Fixed32::divide(p, Gain::from_bits(k));
            assert!(fact::sign_of(bits(y), p));
            cover!(s, y < -5, "negative");
        }
    }
    property! {
        /// P3 (arithmetic): `Fixed32` has the assumed fact of `divide_by`: a quotient by a prepared divisor (stored reciprocal) is
        /// 0 or has the dividend's sign.
        equation "sign(p / k) = sign(p) or 0"
        over "double word and word"
        by kissat fn p3_fact_divide_by(s) {
            let (p, k) = (s.i64(), s.i32());
            let y = Fixed32::divide_by(p, &Fixed32::divisor(Gain::from_bits(k)));
            assert!(fact::sign_of(bits(y), p));
            cover!(s, y < -5, "negative");
        }
    }
    property! {
        /// P3 (arithmetic): `Fixed32` has the assumed fact of `energy_per`: energy divided by displacement is an absolute value, so
        /// it is not negative. Nothing else is known of it.
        equation "|E / d| >= 0"
        over "double word and word"
        by kissat fn p3_fact_per(s) {
            let y = Fixed32::energy_per(Energy::from_bits(s.i64()), Signal::from_bits(s.i32()));
            assert!(y >= 0);
            cover!(s, y > 5, "some");
        }
    }
    property! {
        /// P3 (arithmetic): `Fixed32` has the assumed fact of `root`: the root of an energy that is not positive is 0. By its type
        /// a root fits a word.
        equation "E <= 0  =>  root(E) = 0"
        over "double word"
        by kissat fn p3_fact_root(s) {
            let e = Energy::from_bits(s.i64());
            assume!(s, e <= 0, "the fact's own condition");
            let y = Fixed32::root(e);
            assert!(y == 0);
            cover!(s, e < 0, "deficit");
        }
    }
    property! {
        /// P3 (arithmetic): `Fixed32` has the assumed facts of `affordable`: the outward displacement is not negative, and the
        /// energy that is left is between 0 and the energy before.
        equation "m >= 0, 0 <= r <= E"
        over "stored energy, force above 0"
        by minisat fn p3_fact_affordable(s) {
            let (e, f) = (s.i64(), s.i32());
            assume!(s, e >= 0 && f > 0, "the fact's own condition");
            let (moved, rest) = Fixed32::affordable(Energy::from_bits(e), Signal::from_bits(f));
            assert!(fact::affordable(bits(moved), rest.to_bits(), e));
            cover!(s, moved > 5 && rest > 0, "some");
        }
    }
    property! {
        /// P3 (arithmetic): `Fixed32` has the assumed facts of `passivity_step`, outward: neither energy nor force grows or gets
        /// negative.
        equation "0 <= E' <= E, 0 <= f' <= f"
        over "stored energy, force, displacement below 0"
        by minisat fn p3_fact_step_outward(s) {
            let (e, f, d) = (s.i64(), s.i32(), s.i32());
            assume!(s, e >= 0 && f >= 0 && d < 0, "the fact's own condition");
            let (after, shown) = Fixed32::passivity_step(Energy::from_bits(e), Signal::from_bits(f), Signal::from_bits(d));
            assert!(fact::step(after.to_bits(), bits(shown), e, i64::from(f), i64::from(d)));
            cover!(s, bits(shown) < i64::from(f) && shown > 0, "force reduced");
        }
    }
    property! {
        /// P3 (arithmetic): `Fixed32` has the assumed facts of `passivity_step`, inward: the energy does not shrink, and the force
        /// stays.
        equation "E' >= E, f' = f"
        over "stored energy, force, displacement from 0"
        by kissat fn p3_fact_step_inward(s) {
            let (e, f, d) = (s.i64(), s.i32(), s.i32());
            assume!(s, e >= 0 && f >= 0 && d >= 0, "the fact's own condition");
            let (after, shown) = Fixed32::passivity_step(Energy::from_bits(e), Signal::from_bits(f), Signal::from_bits(d));
            assert!(fact::step(after.to_bits(), bits(shown), e, i64::from(f), i64::from(d)));
            cover!(s, after.to_bits() > e, "stored");
        }
    }
}
