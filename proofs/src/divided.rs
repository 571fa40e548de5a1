//! Division for the checker: one quotient for one question, at 8 bits.
//!
//! The checker makes of each division a quotient and a rest of its own, and then has to find out that two divisions of the same numbers
//! have the same quotient, which takes it longer than all the rest. Here a quotient is what division says it is,
//! `q b <= a < (q + 1) b`, and who asks the same again gets the same again. A `divided_property!` puts these functions in the place
//! of the code's divisions and of the specification's; that the code's own are the same for all arguments is tried on all of them
//! (`proofs/tests/exhaustive.rs`). Settings are divided in 128 bits; there what a proof rests on is a quotient's sign.

#[cfg(kani)]
use fixed::{FixedI64, types::extra::LeEqU64};
#[cfg(kani)]
use touchstone_control::Si;

/// A property of which the checker puts functions in the place of others, named in pairs before it: as `property!` else.
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
            /// The property.
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

/// A property of code and specification at 8 bits that both divide, with the divisions of this file.
#[macro_export]
macro_rules! divided_property {
    ($($property:tt)*) => {
        $crate::replaced_property! {
            [(<touchstone_control::Fixed8 as touchstone_control::Number>::divide_by, $crate::divided::divide_by)
            (<touchstone_control::Fixed8 as touchstone_control::Number>::affordable, $crate::divided::affordable)
            ($crate::spec::at8::over, $crate::divided::over)]
            $($property)*
        }
    };
}

/// A property of settings, of whose products and quotients nothing is known but that those of what is not negative are not
/// negative, and that twice a number is its sum with itself.
#[macro_export]
macro_rules! settings_property {
    ($($property:tt)*) => {
        $crate::replaced_property! {
            [(touchstone_control::quotient::quotient, $crate::divided::quotient)
            (fixed::FixedI64::saturating_mul, $crate::divided::saturating_mul)]
            $($property)*
        }
    };
}

#[cfg(kani)]
pub use by_one_quotient::{affordable, divide_by, over};

/// For `quotient` of settings: any number with that sign; `p8_quotient_sign64` has the code's own.
#[cfg(kani)]
pub fn quotient(a: Si, b: Si) -> Si {
    let any = Si::from_bits(kani::any());
    kani::assume(a < Si::ZERO || b <= Si::ZERO || any >= Si::ZERO);
    any
}

/// For `saturating_mul` of settings: any number with that sign, and of twice a number the sum; `p8_product64` has the library's own.
#[cfg(kani)]
pub fn saturating_mul<Frac: LeEqU64>(a: FixedI64<Frac>, b: FixedI64<Frac>) -> FixedI64<Frac> {
    let any: i64 = kani::any();
    kani::assume(a.to_bits() < 0 || b.to_bits() < 0 || any >= 0);
    let two = 2_i64 << Frac::U32;
    kani::assume(b.to_bits() != two || any == a.to_bits().saturating_add(a.to_bits()));
    FixedI64::from_bits(any)
}

#[cfg(kani)]
mod by_one_quotient {
    use core::sync::atomic::{AtomicU16, AtomicUsize, Ordering::Relaxed};
    use touchstone_control::{Fixed8, Number};

    /// More divisions than a law and its specification make in a tick; a further one is answered without memory.
    const ROWS: usize = 8;
    static USED: AtomicUsize = AtomicUsize::new(0);
    static ROW: [[AtomicU16; 3]; ROWS] = [const { [const { AtomicU16::new(0) }; 3] }; ROWS];

    /// `floor(a / b)`; 0 for a `b` of 0.
    fn floor(a: u16, b: u16) -> u16 {
        let used = USED.load(Relaxed);
        let mut at = 0;
        while at < ROWS {
            let [of, by, found] = &ROW[at];
            if at < used && of.load(Relaxed) == a && by.load(Relaxed) == b {
                return found.load(Relaxed);
            }
            at += 1;
        }
        let quotient: u16 = kani::any();
        if b == 0 {
            kani::assume(quotient == 0);
        } else {
            let part = u32::from(quotient) * u32::from(b);
            kani::assume(part <= u32::from(a) && u32::from(a) - part < u32::from(b));
        }
        if used < ROWS {
            let [of, by, found] = &ROW[used];
            of.store(a, Relaxed);
            by.store(b, Relaxed);
            found.store(quotient, Relaxed);
            USED.store(used + 1, Relaxed);
        }
        quotient
    }

    type Signal = <Fixed8 as Number>::Signal;
    type Energy = <Fixed8 as Number>::Energy;

    fn signed(size: u16, negative: bool) -> Signal {
        let size = size.min(127) as i8;
        Signal::from_bits(if negative { -size } else { size })
    }

    /// For [`Number::divide_by`].
    pub fn divide_by(p: i16, k: &u8) -> Signal {
        signed(floor(p.unsigned_abs(), u16::from(*k)), p < 0)
    }

    /// For [`Number::affordable`].
    pub fn affordable(e: Energy, f: Signal) -> (Signal, Energy) {
        let (e, f) = (
            e.to_bits().max(0).unsigned_abs(),
            u16::from(f.to_bits().unsigned_abs()),
        );
        let moved = floor(e, f).min(127);
        (
            signed(moved, false),
            Energy::from_bits(e.saturating_sub(moved * f) as i16),
        )
    }

    /// For [`crate::spec::at8::over`].
    pub fn over(a: i32, b: i32) -> i32 {
        i32::from(floor(a as u16, b as u16))
    }
}
