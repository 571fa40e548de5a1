//! Properties at 32 bits of what is added to a law's force at the touch of a wall, for any law. The pulse never pulls, stays within
//! the force limit, and takes no more than the momentum that was set. With the vibration too, the force stays between 0 and the
//! limit.
//!
//! ```text
//! f <= pulse(f) <= max(f, limit)                                   p4_pulse_limited
//! e <= 0: pulse(f) = f, l = 0                                      p4_pulse_limited
//! l(n) + (pulse(f) - f) = l(n-1), or brake v at a touch            p9_pulse_impulse
//! no touch within `apart` control periods of another               p9_pulse_apart
//! 0 <= vibration(pulse(f)) <= limit; e <= 0: f                     p4_vibration_limited
//! l(n) = length at a touch, then one less each period              p9_vibration_ends
//! ```

use crate::format::Format;
use crate::refines::any_sample;
use crate::source::{Source, one_with};
use crate::{assume, cover, property, replaced_property};
#[cfg(kani)]
use touchstone_control::Number;
use touchstone_control::law::{Impact, Vibration};
use touchstone_control::{Fixed32, Force, Position, Stiffness};

type N = Fixed32;

/// Any pulse, with any memory.
fn any_pulse32<S: Source>(s: &mut S) -> Impact<N> {
    one_with(
        s,
        |s| {
            let apart = s.u16();
            let outside = if s.bool() { apart } else { s.u16() };
            Impact {
                brake: N::any_stiffness(s),
                limit: N::any_force(s),
                apart,
                left: N::any_force(s),
                outside,
                vibration: None,
            }
        },
        pulse_holds,
    )
}

/// Whether the settings could be accepted ones, and the memory could be that of a tick: see `Impact::pulse_of`.
fn pulse_holds(it: &Impact<N>) -> bool {
    it.brake >= Stiffness::zero()
        && it.limit >= Force::zero()
        && it.apart > 0
        && it.left >= Force::zero()
        && it.outside <= it.apart
}

/// Any vibration, with any memory.
fn any_vibration32<S: Source>(s: &mut S) -> Vibration<N> {
    let length = s.u16();
    let left = if s.bool() { s.u16() % 4 } else { s.u16() };
    Vibration {
        first: N::any_stiffness(s),
        most: one_with(s, N::any_force, |it| *it >= Force::zero()),
        last_share: N::any_ratio(s),
        older_share: N::any_ratio(s),
        length,
        next: N::any_force(s),
        last: N::any_force(s),
        left,
    }
}

property! {
    /// P4: if the law's force is between 0 and the limit, the pulse only adds to it, up to the limit, and keeps the invariant of
    /// its memory. Outside the wall it changes nothing.
    equation "f <= pulse(f) <= limit; e <= 0: pulse(f) = f"
    over "momentum, limit, memory, sample, force of the law"
    fn p4_pulse_limited(s) {
        let mut impact = any_pulse32(s);
        assume!(s, pulse_holds(&impact), "Impact::pulse_of; invariant, kept by this property");
        let sample = any_sample::<N, _>(s);
        let wanted = one_with(s, N::any_force, |it| *it >= Force::zero() && *it <= impact.limit);
        assume!(s, wanted >= Force::zero() && wanted <= impact.limit, "Law");
        let force = impact.with_pulse(sample, wanted);
        assert!(force >= wanted && force <= impact.limit);
        assert!(pulse_holds(&impact));
        let inside = sample.e > Position::zero();
        assert!(inside || (force == wanted && impact.left == Force::zero()));
        cover!(s, force > wanted && force < impact.limit, "a pulse within the limit");
        cover!(s, force == impact.limit && impact.left > Force::zero(), "a pulse that goes on");
    }
}
/// Replaces the product of a gain and a signal of `Fixed32`. The result depends on every digit of both factors and stays exact when
/// it is rounded by a gain's fractional bits.
#[cfg(kani)]
pub fn impulse_product(k: <N as Number>::Gain, x: <N as Number>::Signal) -> i64 {
    (i64::from(k.to_bits()) ^ i64::from(x.to_bits())) << 12
}

replaced_property! {
    [(<touchstone_control::Fixed32 as touchstone_control::Number>::product, crate::impact::impulse_product)]
    /// P9: the force that the pulse adds is subtracted exactly from the impulse that is left. A new impulse begins at a touch only;
    /// it is the brake times the displacement.
    equation "l(n) + (pulse(f) - f) = l(n-1); at a touch brake v"
    over "momentum, limit, memory, sample, force of the law; under the checker something in the place of the brake's product"
    by minisat fn p9_pulse_impulse(s) {
        let mut impact = any_pulse32(s);
        assume!(s, pulse_holds(&impact), "Impact::pulse_of; invariant, kept by p4_pulse_limited");
        let sample = any_sample::<N, _>(s);
        let wanted = one_with(s, N::any_force, |it| *it >= Force::zero() && *it <= impact.limit);
        assume!(s, wanted >= Force::zero() && wanted <= impact.limit, "Law");
        let before = impact;
        let force = impact.with_pulse(sample, wanted);
        let comes = sample.e > Position::zero() && sample.moved > Position::zero();
        let touch = before.outside == before.apart;
        let given = match (comes, touch) {
            (false, _) => Force::zero(),
            (true, true) => (before.brake * sample.moved).towards_zero(),
            (true, false) => before.left,
        };
        let played = N::of_signal(force.0) - N::of_signal(wanted.0);
        assert!(N::of_signal(impact.left.0) + played == N::of_signal(given.0));
        assert!(comes || (force == wanted && impact.left == Force::zero()));
        cover!(s, !comes && before.left > Force::zero(), "what is left is dropped");
        cover!(s, touch & (played > 0), "a touch");
        cover!(s, !touch & (played > 0), "a pulse that went on");
    }
}
property! {
    /// P9: after a control period inside the wall, a touch counts only when the device was outside for `apart` control periods.
    equation "inside: o = 0; outside: o(n) = min(o(n-1) + 1, apart)"
    over "momentum, limit, memory, sample, force of the law"
    fn p9_pulse_apart(s) {
        let mut impact = any_pulse32(s);
        assume!(s, pulse_holds(&impact), "Impact::pulse_of; invariant, kept by p4_pulse_limited");
        let sample = any_sample::<N, _>(s);
        let before = impact;
        let _ = impact.with_pulse(sample, N::any_force(s));
        let inside = sample.e > Position::zero();
        let counted = u32::from(before.outside) + 1;
        let expected = if inside { 0 } else { counted.min(u32::from(before.apart)) };
        assert!(u32::from(impact.outside) == expected);
        assert!((impact.brake, impact.limit, impact.apart) == (before.brake, before.limit, before.apart));
        cover!(s, impact.outside > 0 && impact.outside < impact.apart, "not long enough outside");
        cover!(s, !inside && impact.outside == impact.apart, "long enough outside");
    }
}
property! {
    /// P4: if the law's force is between 0 and the limit, it stays so with pulse and vibration, for any coefficients and memory of
    /// the vibration. Outside the wall they change nothing.
    equation "0 <= vibration(pulse(f)) <= limit; e <= 0: vibration(pulse(f)) = f"
    over "momentum, limit, vibration, memories, sample, force of the law"
    fn p4_vibration_limited(s) {
        let mut impact = any_pulse32(s);
        assume!(s, pulse_holds(&impact), "Impact::pulse_of; invariant, kept by p4_pulse_limited");
        impact.vibration = Some(any_vibration32(s));
        let sample = any_sample::<N, _>(s);
        let wanted = one_with(s, N::any_force, |it| *it >= Force::zero() && *it <= impact.limit);
        assume!(s, wanted >= Force::zero() && wanted <= impact.limit, "Law");
        let mut pulse = impact;
        let pulsed = pulse.with_pulse(sample, wanted);
        let force = impact.with_pulse_and_vibration(sample, wanted);
        assert!(force >= Force::zero() && force <= impact.limit);
        let inside = sample.e > Position::zero();
        assert!(inside || force == wanted);
        cover!(s, force > pulsed, "the vibration pushes");
        cover!(s, force < pulsed, "the vibration pulls");
    }
}
property! {
    /// P9: a vibration begins at a touch only and ends after its length, or when the device leaves the wall. Then it adds nothing.
    equation "touch: l = max(length - 1, 0); inside: l(n) = max(l(n-1) - 1, 0); outside: l = 0; l(n-1) = 0 and no touch: vibration(f) = f"
    over "limit, vibration, memory, sample, touch or not, force"
    fn p9_vibration_ends(s) {
        let before = any_vibration32(s);
        let (sample, touch) = (any_sample::<N, _>(s), s.bool());
        let (wanted, limit) = (N::any_force(s), N::any_force(s));
        let mut vibration = before;
        let force = vibration.with_vibration(sample, touch, wanted, limit);
        let inside = sample.e > Position::zero();
        let expected = match (inside, touch) {
            (false, _) => 0,
            (true, true) => before.length.saturating_sub(1),
            (true, false) => before.left.saturating_sub(1),
        };
        assert!(vibration.left == expected);
        assert!((inside && (touch || before.left > 0)) || force == wanted);
        cover!(s, inside & !touch && before.left == 1, "it ends");
    }
}
