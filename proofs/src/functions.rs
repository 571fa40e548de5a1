//! A number type whose operations give equal results for equal arguments. With it sums and equalities can be proved at 32 bits.
//!
//! A tick's energy is the energy before, plus the work, plus the damper's part. This sum does not depend on what a product *is*,
//! only on both sides having the same one. [`Functions32`] is [`Facts32`] (only proved facts of a result are known) with one more
//! fact: equal arguments give equal results. An equality that holds for all functions that have the facts also holds for those of
//! `Fixed32`. `edges::w32` proves that these are the exact products and the quotients of `heart`. The proofs run the shipped source
//! of the laws; no function is replaced.
//!
//! Without the model checker every operation is that of `Fixed32`, and nothing is recorded.

use crate::facts::Facts32;
use touchstone_control::number::Wide64;
use touchstone_control::{Number, Si};

type Signal = <Facts32 as Number>::Signal;
type Gain = <Facts32 as Number>::Gain;
type Energy = <Facts32 as Number>::Energy;

/// A number type like [`Facts32`]. Of its operations, proved facts are known, and that equal arguments give equal results.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Functions32;

/// Records of the results that an operation has returned.
#[cfg(kani)]
mod memo {
    use core::sync::atomic::{AtomicI64, AtomicUsize, Ordering::Relaxed};

    /// Number of rows in the record of one operation. It is meant to exceed the calls that one tick and its property make. Further
    /// calls are not recorded; less is then assumed of their results, so the proof stays valid.
    const ROWS: usize = 6;
    type Row = [AtomicI64; 5];

    /// Record of one operation: each row has three arguments and two results, of which some operations use fewer.
    pub struct Memo {
        used: AtomicUsize,
        rows: [Row; ROWS],
    }

    impl Memo {
        pub const fn new() -> Self {
            const ZERO: AtomicI64 = AtomicI64::new(0);
            const ROW: Row = [ZERO; 5];
            Self {
                used: AtomicUsize::new(0),
                rows: [ROW; ROWS],
            }
        }

        /// Assumes that the result equals the one recorded for the same arguments, if there is one.
        pub fn same(&self, arguments: [i64; 3], results: [i64; 2]) {
            let used = self.used.load(Relaxed);
            let mut known = false;
            let mut at = 0;
            while at < ROWS {
                let row = &self.rows[at];
                let asked = at < used
                    && row[0].load(Relaxed) == arguments[0]
                    && row[1].load(Relaxed) == arguments[1]
                    && row[2].load(Relaxed) == arguments[2];
                if asked {
                    kani::assume(
                        row[3].load(Relaxed) == results[0] && row[4].load(Relaxed) == results[1],
                    );
                    known = true;
                }
                at += 1;
            }
            if !known && used < ROWS {
                let row = &self.rows[used];
                row[0].store(arguments[0], Relaxed);
                row[1].store(arguments[1], Relaxed);
                row[2].store(arguments[2], Relaxed);
                row[3].store(results[0], Relaxed);
                row[4].store(results[1], Relaxed);
                self.used.store(used + 1, Relaxed);
            }
        }
    }
}

/// Defines an operation of [`Functions32`]. Under the model checker, a call with the arguments of an earlier call returns the same
/// result.
macro_rules! function {
    ([$($argument:expr),*], $result:expr, |$r:ident| [$($bits:expr),*]) => {{
        let $r = $result;
        #[cfg(kani)]
        {
            static MEMO: memo::Memo = memo::Memo::new();
            MEMO.same(three([$($argument),*]), two([$($bits),*]));
        }
        $r
    }};
}

#[cfg(kani)]
fn three<const N: usize>(arguments: [i64; N]) -> [i64; 3] {
    let get = |at| if at < N { arguments[at] } else { 0 };
    [get(0), get(1), get(2)]
}
#[cfg(kani)]
fn two<const N: usize>(results: [i64; N]) -> [i64; 2] {
    [results[0], if N > 1 { results[N - 1] } else { 0 }]
}
#[cfg(kani)]
fn bits(x: Signal) -> i64 {
    i64::from(x.to_bits())
}
#[cfg(kani)]
fn gain(x: Gain) -> i64 {
    i64::from(x.to_bits())
}

impl Number for Functions32 {
    type Signal = Signal;
    type Gain = Gain;
    type Ratio = Signal;
    type Energy = Energy;
    type Product = i64;
    type Divisor = Gain;
    type Wide = Wide64;
    const NAME: &'static str = "functions32";
    const QUANTUM: Signal = Facts32::QUANTUM;

    fn signal(si: Si) -> Option<Signal> {
        Facts32::signal(si)
    }
    fn saturating_signal(si: Si) -> Signal {
        Facts32::saturating_signal(si)
    }
    fn gain(si: Si) -> Option<Gain> {
        Facts32::gain(si)
    }
    fn ratio(si: Si) -> Option<Signal> {
        Facts32::ratio(si)
    }
    fn energy(si: Si) -> Option<Energy> {
        Facts32::energy(si)
    }
    fn add(a: Signal, b: Signal) -> Signal {
        Facts32::add(a, b)
    }
    fn sub(a: Signal, b: Signal) -> Signal {
        Facts32::sub(a, b)
    }
    fn neg(a: Signal) -> Signal {
        Facts32::neg(a)
    }
    fn modulus(a: Signal) -> Signal {
        Facts32::modulus(a)
    }
    fn scale(r: Signal, x: Signal) -> Signal {
        function!([bits(r), bits(x)], Facts32::scale(r, x), |y| [bits(y)])
    }
    fn product(k: Gain, x: Signal) -> i64 {
        function!([gain(k), bits(x)], Facts32::product(k, x), |y| [y])
    }
    fn lift(x: Signal) -> i64 {
        Facts32::lift(x)
    }
    fn add_product(a: i64, b: i64) -> i64 {
        Facts32::add_product(a, b)
    }
    fn sub_product(a: i64, b: i64) -> i64 {
        Facts32::sub_product(a, b)
    }
    fn add_fitting(a: i64, b: i64) -> i64 {
        Facts32::add_fitting(a, b)
    }
    fn sub_fitting(a: i64, b: i64) -> i64 {
        Facts32::sub_fitting(a, b)
    }
    fn positive_down(p: i64) -> Signal {
        Facts32::positive_down(p)
    }
    fn positive_up(p: i64) -> Signal {
        Facts32::positive_up(p)
    }
    fn round_to_zero(p: i64) -> Signal {
        Facts32::round_to_zero(p)
    }
    fn round_up(p: i64) -> Signal {
        Facts32::round_up(p)
    }
    fn divide(p: i64, k: Gain) -> Signal {
        function!([p, gain(k)], Facts32::divide(p, k), |y| [bits(y)])
    }
    fn divisor(k: Gain) -> Gain {
        k
    }
    fn divide_by(p: i64, k: &Gain) -> Signal {
        function!([p, gain(*k)], Facts32::divide_by(p, k), |y| [bits(y)])
    }
    fn widen(x: Signal) -> Wide64 {
        Facts32::widen(x)
    }
    fn narrow(x: Wide64) -> Signal {
        Facts32::narrow(x)
    }
    fn work(f: Signal, d: Signal) -> Energy {
        function!([bits(f), bits(d)], Facts32::work(f, d), |y| [y.to_bits()])
    }
    fn add_energy(a: Energy, b: Energy) -> Energy {
        Facts32::add_energy(a, b)
    }
    fn sub_energy(a: Energy, b: Energy) -> Energy {
        Facts32::sub_energy(a, b)
    }
    // The model checker and every test on random samples check that the sum and the difference fit.
    fn add_energy_fitting(a: Energy, b: Energy) -> Energy {
        Facts32::add_energy_fitting(a, b)
    }
    fn sub_energy_fitting(a: Energy, b: Energy) -> Energy {
        Facts32::sub_energy_fitting(a, b)
    }
    fn energy_digits_fitting(e: Energy) -> Signal {
        Facts32::energy_digits_fitting(e)
    }
    fn modulus_fitting(a: Signal) -> Signal {
        Facts32::modulus_fitting(a)
    }
    // Not recorded, because no property calls it twice with the same arguments. Less is then assumed of its results, so a proof
    // stays valid.
    fn scale_both_fitting(r: Signal, x: Signal, q: Signal, y: Signal) -> Signal {
        Facts32::scale_both_fitting(r, x, q, y)
    }
    fn round_down_fitting(p: i64) -> Signal {
        Facts32::round_down_fitting(p)
    }
    fn half_energy_up(e: Energy) -> Energy {
        Facts32::half_energy_up(e)
    }
    fn energy_per(e: Energy, x: Signal) -> Signal {
        function!([e.to_bits(), bits(x)], Facts32::energy_per(e, x), |y| [
            bits(y)
        ])
    }
    fn root(e: Energy) -> Signal {
        function!([e.to_bits()], Facts32::root(e), |y| [bits(y)])
    }
    fn root_of_four(k: Gain) -> Gain {
        Facts32::root_of_four(k)
    }
    fn affordable(e: Energy, f: Signal) -> (Signal, Energy) {
        function!([e.to_bits(), bits(f)], Facts32::affordable(e, f), |y| [
            bits(y.0),
            y.1.to_bits()
        ])
    }
    fn passivity_step(e: Energy, f: Signal, d: Signal) -> (Energy, Signal) {
        function!(
            [e.to_bits(), bits(f), bits(d)],
            Facts32::passivity_step(e, f, d),
            |y| [y.0.to_bits(), bits(y.1)]
        )
    }
}
