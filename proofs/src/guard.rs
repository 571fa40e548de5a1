//! Properties of one tick of the energy guard, from every memory, for every configuration that `Guard::new` can give.
//!
//! `docs/energy-guard.md` proves that the guard's account is a lower bound of the true energy; `proofs/coq` proves it for the
//! code's integers. The properties here prove that the code calculates that account: the sum, its limits, the reserve, and the
//! bound on the force. `B` is the energy in the account, `C` its capacity, `R` the reserve, `A` the free energy `B - R`, `f` the
//! force and `D` the largest displacement.
//!
//! ```text
//! f D <= A  if  D/reach <= 1      p1_force_is_paid
//! B' = min(sum, C), at least R    p1_account_is_the_sum
//! 0 <= R <= B' <= C               p1_account_stays
//! |f| <= |requested|, same sign   p4_force_never_grows
//! ```

use crate::format::Format;
use crate::source::{Source, one_with};
use crate::valid::Valid;
use crate::{assume, cover, property, such};
use touchstone_control::{Energy, Fixed8, Fixed32, Force, Guard, GuardState, Position, Stiffness};

/// A quarter of the range of positions and forces, as an integer.
fn quarter<N: Format>() -> i64 {
    N::of_signal(N::HIGHEST) >> 2
}

/// Whether a position is at least 0 and at most a quarter of the range, so that its products have room.
pub fn room<N: Format>(x: &Position<N>) -> bool {
    *x >= Position::zero() && N::of_signal(x.0) <= quarter::<N>()
}

/// The exact product of two signed numbers of the format, given as integers.
pub fn times<N: Format>(a: i64, b: i64) -> N::Exact {
    N::exact(a) * N::exact(b)
}

impl<N: Format> Valid<N> for Guard<N> {
    type State = GuardState<N>;
    fn any<S: Source>(s: &mut S) -> Self {
        let most = quarter::<N>();
        let length = |s: &mut S| one_with(s, N::any_position, room);
        let gain = |s: &mut S| one_with(s, N::any_stiffness, |k| N::of_gain(k.0) >= 0);
        let energy = |s: &mut S| {
            let fits = |e: &Energy<N>| (0..=most << N::SIGNAL_BITS).contains(&N::of_energy(e.0));
            one_with(s, N::any_energy, fits)
        };
        let share = |x: i64| (0..=1 << N::SIGNAL_BITS).contains(&x);
        Self {
            capacity: energy(s),
            refill: energy(s),
            damping: gain(s),
            furthest: length(s),
            count: length(s),
            late: one_with(s, N::any_ratio, |x| share(N::of_signal_ratio(x.0))),
            stray: one_with(s, N::any_compliance, |x| N::of_signal_ratio(x.0) >= 0),
            slack: length(s),
            per_reach: gain(s),
            in_flight: length(s),
            overrun: one_with(s, N::any_compliance, |x| N::of_signal_ratio(x.0) >= 0),
        }
    }
    fn any_state<S: Source>(s: &mut S) -> GuardState<N> {
        let account = N::any_energy(s);
        if account < Energy::zero() && s.shortcut() {
            return GuardState {
                account,
                ..GuardState::default()
            };
        }
        let force = |s: &mut S| {
            let fits = |f: &Force<N>| N::of_signal(f.0).abs() <= quarter::<N>();
            one_with(s, N::any_force, fits)
        };
        GuardState {
            account,
            force: force(s),
            older: force(s),
        }
    }
    /// Whether the guard's coefficients fit their formats and are small enough for their products, as `Guard::new` guarantees.
    fn valid(&self) -> bool {
        let most = N::exact(quarter::<N>());
        let bits = |x: Energy<N>| N::exact(N::of_energy(x.0));
        let not_negative = self.capacity >= Energy::zero()
            && self.refill >= Energy::zero()
            && self.damping >= Stiffness::zero()
            && self.per_reach >= Stiffness::zero()
            && N::of_signal_ratio(self.late.0) >= 0
            && N::of_signal_ratio(self.stray.0) >= 0
            && N::of_signal_ratio(self.overrun.0) >= 0;
        let highest = N::exact(quarter::<N>() + 1) << N::SIGNAL_BITS;
        let rooms = room(&self.furthest)
            && room(&self.count)
            && room(&self.slack)
            && room(&self.in_flight)
            && bits(self.capacity) < highest
            && bits(self.refill) < highest
            && N::of_signal_ratio(self.late.0) <= 1 << N::SIGNAL_BITS;
        if !(not_negative && rooms) {
            return false;
        }
        let product = |k: Stiffness<N>, x| times::<N>(N::of_gain(k.0), x) >> N::GAIN_BITS;
        let largest = product(
            self.per_reach,
            N::of_energy(self.capacity.0) >> N::SIGNAL_BITS,
        );
        let damping = product(self.damping, N::of_signal(self.furthest.0));
        if largest > most || damping > most {
            return false;
        }
        let largest = N::of_signal(self.largest_force(self.capacity).0);
        let stray = times::<N>(N::of_signal_ratio(self.stray.0), largest + largest);
        stray >> N::SIGNAL_BITS <= most
            // The reserve of the largest force is less than the account that allows it.
            && times::<N>(largest, N::of_signal(self.in_flight.0)) <= bits(self.capacity)
    }
    fn holds(&self, state: &GuardState<N>) -> bool {
        let largest = self.largest_force(self.capacity);
        let allowed = |force: Force<N>| force <= largest && force >= Force::zero() - largest;
        let still = state.force == Force::zero() && state.older == Force::zero();
        state.account <= self.capacity
            && allowed(state.force)
            && allowed(state.older)
            // An energy deficit after an over-speed: no force acts, and the format holds the deficit.
            && (state.account >= Energy::zero()
                || still && N::of_energy(state.account.0) > -(N::of_energy(N::energy_cap().0)))
    }
}

/// Whether the displacement of a tick is above the largest that the guard accepts (overspeed).
fn too_fast<N: Format>(law: &Guard<N>, moved: Position<N>) -> bool {
    moved > law.furthest || moved < Position::zero() - law.furthest
}

macro_rules! guard {
    ($(#[doc = $doc:literal])* $module:ident, $number:ident, by $solver:ident, sum $sum:ident) => {
        $(#[doc = $doc])*
        pub mod $module {
            use super::*;
            type N = $number;

            property! {
                /// P1, P3, P4 and the invariant, energy guard: one tick does not panic, and no sum leaves its format. The account
                /// stays between reserve and capacity, for every displacement up to the largest and every requested force.
                equation "0 <= R <= B' <= C"
                over "valid configuration, memory in the invariant, displacement, wanted force"
                by $solver fn p1_account_stays(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p1_account_stays and p4_overspeed"
                    );
                    let (moved, wanted) = (N::any_position(s), N::any_force(s));
                    assume!(s, !too_fast(&law, moved), "case; the other is p4_overspeed");
                    let mut state = before;
                    let answer = law.tick(&mut state, moved, wanted);
                    assert!(answer == Ok(state.force));
                    assert!(law.holds(&state));
                    assert!(before.account < Energy::zero() || state.account >= law.reserve(before.force));
                    assert!(law.reserve(before.force) >= Energy::zero());
                    assert!(
                        before.account < Energy::zero()
                            || state.force.modulus() <= law.largest_force(state.account - law.reserve(before.force))
                    );
                    cover!(s, state.account == law.reserve(before.force) && before.force != Force::zero(), "at the reserve");
                    cover!(s, state.account == law.capacity && law.capacity > Energy::zero(), "full");
                    cover!(s, before.account < Energy::zero() && state.account >= Energy::zero(), "a deficit made up for");
                }
            }
            property! {
                /// P1 (energy): the guard's account is the exact sum of these terms: the account before, the refill, the work of
                /// each force over its own part of the displacement, the trusted damping, and the charge for the change of force.
                /// It is not below the reserve and not above the capacity.
                equation "B' = max(min(B + P T + f Δ - g u - |g| q + c m m, C), R)"
                over "valid configuration, memory in the invariant, displacement, wanted force"
                by $sum fn p1_account_is_the_sum(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p1_account_stays and p4_overspeed"
                    );
                    let (moved, wanted) = (N::any_position(s), N::any_force(s));
                    assume!(
                        s,
                        !too_fast(&law, moved) && before.account >= Energy::zero(),
                        "case; the others are p4_overspeed and p1_deficit"
                    );
                    let mut state = before;
                    let _ = law.tick(&mut state, moved, wanted);
                    let (wide, none) = (N::exact, N::exact(0));
                    let (force, older) = (wide(N::of_signal(before.force.0)), wide(N::of_signal(before.older.0)));
                    let x = wide(N::of_signal(moved.0));
                    let change = force - older;
                    let late = wide(N::of_signal_ratio(law.late.0));
                    let stray = wide(N::of_signal_ratio(law.stray.0));
                    let under_older = (late * x + stray * change) >> N::SIGNAL_BITS;
                    let size = |x: <N as Format>::Exact| x.max(-x);
                    let surely = (size(x) - wide(N::of_signal(law.count.0))).max(none);
                    let damping = (wide(N::of_gain(law.damping.0)) * surely) >> N::GAIN_BITS;
                    let energy = |e: Energy<N>| wide(N::of_energy(e.0));
                    let sum = energy(before.account) + energy(law.refill) + force * x - change * under_older
                        - size(change) * wide(N::of_signal(law.slack.0)) + damping * surely;
                    let reserve = size(force) * wide(N::of_signal(law.in_flight.0));
                    assert!(energy(state.account) == sum.min(energy(law.capacity)).max(reserve));
                    cover!(s, change * under_older > none && sum > reserve, "paid under the old force");
                    cover!(s, damping > none && x < none, "damped outward");
                    cover!(s, stray > none && change != none && x == none, "strayed");
                }
            }
            property! {
                /// P1 (energy): the guard's charge for an unknown position at the change of force never adds energy, because the
                /// change of force times its own scaled value has the sign of a square.
                equation "g floor(κ' g) >= 0, up to a quantum"
                over "valid configuration, change of force"
                by $solver fn p1_stray_is_charged(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    let change = N::any_force(s);
                    assume!(s, change.modulus() <= law.largest_force(law.capacity), "half of the largest change");
                    let under = law.late.of_and_fitting(Position::zero(), law.stray, change);
                    let (change_bits, none) = (N::exact(N::of_signal(change.0)), N::exact(0));
                    let charged = change_bits * N::exact(N::of_signal(under.0));
                    let quantum = change_bits.max(-change_bits);
                    assert!(charged >= -quantum);
                    // Rounding down loses less than one step of the format times the change of force, which `slack` contains.
                    let exact = N::exact(N::of_signal_ratio(law.stray.0)) * (change_bits * change_bits);
                    assert!((charged + quantum) << N::SIGNAL_BITS >= exact);
                    cover!(s, charged > none && change < Force::zero(), "a fall of the force");
                }
            }
            property! {
                /// P1 (energy): the free energy in the guard's account covers the allowed force over every displacement up to the
                /// largest. Reciprocal, energy and force are all rounded to the safe side.
                equation "D r <= 1  =>  |f| y <= A for every y <= D"
                over "valid configuration, free energy, reach, displacement"
                by $solver fn p1_force_is_paid(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    let free = N::any_energy(s);
                    assume!(s, free >= Energy::zero() && free <= law.capacity, "what tick passes: p1_account_stays");
                    let (reach, moved) = (N::any_position(s), N::any_position(s));
                    let (bits, none) = (|x: Position<N>| N::exact(N::of_signal(x.0)), N::exact(0));
                    let distance = bits(moved).max(-bits(moved));
                    assume!(
                        s,
                        reach >= Position::zero()
                            && N::exact(N::of_gain(law.per_reach.0)) * bits(reach) <= N::exact(1) << (N::GAIN_BITS + N::SIGNAL_BITS),
                        "Guard::new: the reciprocal is rounded down"
                    );
                    assume!(s, distance <= bits(reach), "case; further is overspeed");
                    let force = law.largest_force(free);
                    let work = N::exact(N::of_signal(force.0)) * distance;
                    assert!(force >= Force::zero() && work <= N::exact(N::of_energy(free.0)));
                    cover!(s, work > none && bits(moved) == -bits(reach), "the whole reach outward");
                }
            }
            property! {
                /// P4 (limits): the guard never makes the requested force larger and never reverses it.
                equation "|f| <= |f_wanted|, f f_wanted >= 0"
                over "valid configuration, memory in the invariant, displacement, wanted force"
                by $solver fn p4_force_never_grows(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    let mut state = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p1_account_stays and p4_overspeed"
                    );
                    let (moved, wanted) = (N::any_position(s), N::any_force(s));
                    let force = law.tick(&mut state, moved, wanted).unwrap_or(Force::zero());
                    let (least, most) = (wanted.min(Force::zero()), wanted.max(Force::zero()));
                    assert!(force >= least && force <= most);
                    cover!(s, force != Force::zero() && force != wanted, "cut");
                    cover!(s, force < Force::zero() && force == wanted, "pulls, untouched");
                }
            }
            property! {
                /// P4 (limits): more energy in the guard's account never allows less force, and no energy allows no force. So the
                /// wall gets softer gradually.
                equation "A <= A'  =>  f(A) <= f(A'), f(0) = 0"
                over "valid configuration, pair of energies"
                by $solver fn p4_force_follows_the_account(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    let (less, more) = (N::any_energy(s), N::any_energy(s));
                    assume!(
                        s,
                        less >= Energy::zero() && less <= more && more <= law.capacity,
                        "what tick passes: p1_account_stays"
                    );
                    assert!(law.largest_force(less) <= law.largest_force(more));
                    assert!(law.largest_force(Energy::zero()) == Force::zero());
                    cover!(s, law.largest_force(less) < law.largest_force(more), "softer");
                }
            }
            property! {
                /// P1 (energy): at rest and without a force, the guard's account grows by the refill, and by nothing else.
                equation "Δ = 0, f = 0  =>  B' = min(B + P T, C)"
                over "valid configuration, account"
                by $solver fn p1_refill(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    let account = N::any_energy(s);
                    assume!(
                        s,
                        account <= law.capacity && N::of_energy(account.0) > -N::of_energy(N::energy_cap().0),
                        "invariant, kept by p1_account_stays and p4_overspeed"
                    );
                    let mut state = GuardState { account, ..GuardState::default() };
                    let _ = law.tick(&mut state, Position::zero(), Force::zero());
                    let energy = |e: Energy<N>| N::exact(N::of_energy(e.0));
                    let exact = energy(account) + energy(law.refill);
                    assert!(energy(state.account) == exact.min(energy(law.capacity)));
                    cover!(s, account < Energy::zero() && state.account > account, "from a deficit");
                    cover!(s, state.account == law.capacity && account < law.capacity, "filled");
                }
            }
            property! {
                /// P1 (energy): while the guard's account has a deficit the force is 0, and no remembered force reduces the account
                /// further.
                equation "B < 0  =>  f = 0, B' >= B"
                over "valid configuration, memory in the invariant, displacement, wanted force"
                by $solver fn p1_deficit(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p1_account_stays and p4_overspeed"
                    );
                    let (moved, wanted) = (N::any_position(s), N::any_force(s));
                    assume!(
                        s,
                        before.account < Energy::zero() && !too_fast(&law, moved),
                        "case; the others are p4_overspeed and p1_account_is_the_sum"
                    );
                    let mut state = before;
                    assert!(law.tick(&mut state, moved, wanted) == Ok(Force::zero()));
                    assert!(state.force == Force::zero() && state.older == Force::zero());
                    assert!(state.account >= before.account);
                    cover!(s, state.account > before.account && wanted > Force::zero(), "making up");
                }
            }
            property! {
                /// P4 (limits): at overspeed the guard reports it, sets the force to 0, adds nothing to the account, and keeps the
                /// invariant.
                equation "|Δ| > d  =>  overspeed, f = 0, B' <= B"
                over "valid configuration, memory in the invariant, displacement, wanted force"
                by $solver fn p4_overspeed(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p1_account_stays and p4_overspeed"
                    );
                    let (moved, wanted) = (N::any_position(s), N::any_force(s));
                    assume!(s, too_fast(&law, moved), "case; the other is p1_account_stays");
                    let mut state = before;
                    assert!(law.tick(&mut state, moved, wanted).is_err());
                    assert!(state.force == Force::zero() && state.older == Force::zero());
                    assert!(state.account <= before.account && law.holds(&state));
                    cover!(s, state.account < before.account, "under a force");
                    cover!(s, moved.0 == N::LOWEST, "the largest displacement");
                }
            }
            property! {
                /// P1 (energy): switching off keeps the guard's invariant. After a tick that commands no force, the account is
                /// reduced by the reserve of the older force. Otherwise the account becomes at most 0.
                equation "f = 0: 0 <= B' = B - R; f != 0: B' = min(B, 0); f' = 0"
                over "valid configuration, memory in the invariant"
                by $solver fn p1_switched_off(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state) && (state.account < Energy::zero() || state.account >= law.reserve(state.older)),
                        "invariant, kept by p1_account_stays and p4_overspeed"
                    );
                    let mut state = before;
                    law.switched_off(&mut state);
                    assert!(state.force == Force::zero() && state.older == Force::zero() && law.holds(&state));
                    let energy = |e: Energy<N>| N::exact(N::of_energy(e.0));
                    let reserve = N::exact(N::of_signal(before.older.0).abs()) * N::exact(N::of_signal(law.in_flight.0));
                    let left = if before.force == Force::zero() {
                        energy(before.account) - reserve
                    } else {
                        energy(before.account).min(N::exact(0))
                    };
                    assert!(energy(state.account) == left && state.account >= before.account.min(Energy::zero()));
                    cover!(s, state.account < before.account && state.account > Energy::zero(), "the older force acts on");
                    cover!(s, state.account == Energy::zero() && before.account > Energy::zero(), "nobody knows how long it acted");
                }
            }
            property! {
                /// P4 (limits): reporting to the guard the force that was finally commanded never makes the remembered force
                /// larger.
                equation "|f'| <= |f|"
                over "valid configuration, memory in the invariant, force"
                by $solver fn p4_commanded(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p1_account_stays and p4_overspeed"
                    );
                    let told = N::any_force(s);
                    let mut state = before;
                    law.commanded(&mut state, told);
                    assert!(state.force.modulus() <= before.force.modulus());
                    assert!(law.holds(&state) && state.account == before.account);
                    assert!(told.modulus() > before.force.modulus() || state.force == told);
                    cover!(s, state.force != before.force && state.force == told, "less");
                }
            }
        }
    };
}

guard!(
    /// The properties of this file at 32 bits, the width of the firmware. They run in random tests, as no solver follows products
    /// of three unknown numbers at that width.
    w32, Fixed32, by sampled, sum sampled
);
guard!(
    /// The properties of this file at 8 bits, where a solver tries every case. The account's sum is proved at 32 bits instead
    /// (`refines::w32::p11_guard`, `p11_guard_booked`).
    w8, Fixed8, by cadical, sum sampled
);

#[cfg(all(test, not(kani)))]
mod accepted {
    use super::*;
    use crate::source::{Sampler, sample};
    use touchstone_control::{ChangeOfForce, GuardSettings, GuardedDevice, Si};

    /// P8 (settings): every guard that `Guard::new` accepts is valid, its memory at power-up satisfies the invariant, and its
    /// account covers the force over the largest displacement.
    fn body<N: Format>(s: &mut Sampler) {
        let mut value =
            |bits: u32| Si::from_bits(i64::from(s.u32()) << 8 >> (s.bits(5) as u32) << 6 >> bits);
        let settings = GuardSettings {
            capacity: value(0),
            refill: value(6),
            share_of_damping: value(4),
            overspeed: value(0),
            delay: value(14),
            lag: value(14),
            change: ChangeOfForce::Estimated,
            on: true,
            damping: Si::from_bits(i64::from(s.u32()) >> (s.bits(5) as u32)),
        };
        let device = GuardedDevice {
            rate_hz: 1 << s.bits(4),
            force_limit: Si::from_bits(i64::from(s.u32())),
            count: Si::from_bits(i64::from(s.u32()) << 8 >> (s.bits(5) as u32) << 6 >> 8),
        };
        let settings = if s.bool() {
            settings
        } else {
            GuardSettings {
                change: ChangeOfForce::Measured,
                ..settings
            }
        };
        let accepted = Guard::<N>::new(&settings, &device);
        cover!(s, accepted.is_err(), "refused");
        let Ok(law) = accepted else {
            s.assume(false);
            return;
        };
        assert!(law.valid(), "{settings:?} {device:?} {law:?}");
        assert!(law.holds(&law.full()));
        let reach = N::of_signal(law.furthest.0) + N::of_signal(law.count.0) - 3;
        assert!(
            i128::from(N::of_gain(law.per_reach.0)) * i128::from(reach)
                <= 1 << (N::GAIN_BITS + N::SIGNAL_BITS)
        );
        cover!(s, settings.delay > Si::ZERO, "delayed");
    }
    #[test]
    fn p8_accepted_is_valid_32() {
        sample("guard::accepted::32", body::<Fixed32>);
    }
    #[test]
    fn p8_accepted_is_valid_16() {
        sample("guard::accepted::16", body::<touchstone_control::Fixed16>);
    }
}
