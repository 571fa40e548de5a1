//! Properties at 32 bits of a wall's surface that gives way to a hand that overpowers the motor.
//!
//! `e` is the penetration into the wall as drawn, and `g` how far the surface has given way. It gives way from the depth `d` on, by at
//! most `s` in a tick.
//!
//! ```text
//! g = 0: seen(sample) = sample                                          p9_surface_seen
//! seen e = e - g', g' = min(g, e) at least 0                            p9_surface_seen
//! g' > g only if f >= limit; g' - g <= s, displacement; e - g' >= d     p4_surface_gives
//! ```

use crate::format::Format;
use crate::refines::any_sample;
use crate::source::{Source, one_with};
use crate::{assume, cover, property};
use touchstone_control::law::YieldingSurface;
use touchstone_control::{Fixed32, Position};

type N = Fixed32;

/// Any surface, given way by any distance.
fn any_yielding32<S: Source>(s: &mut S) -> YieldingSurface<N> {
    one_with(
        s,
        |s| YieldingSurface {
            limit: N::any_force(s),
            deepest: N::any_position(s),
            step: N::any_position(s),
            given: if s.bool() {
                Position::zero()
            } else {
                N::any_position(s)
            },
        },
        surface_holds,
    )
}

/// Whether the depth can come from accepted settings, and the distance can be that of a tick.
pub(crate) fn surface_holds<N: Format>(it: &YieldingSurface<N>) -> bool {
    it.deepest >= Position::zero() && it.step >= Position::zero() && it.given >= Position::zero()
}

property! {
    /// P9: a surface that has not given way changes nothing. Another one takes exactly its distance off the penetration, goes back
    /// with the device, and is where it was drawn once the device is outside the wall.
    equation "g' = max(0, min(g, e)); seen e = e - g'; g = 0: seen = sample"
    over "depth, distance, limit, sample"
    fn p9_surface_seen(s) {
        let mut surface = any_yielding32(s);
        assume!(s, surface_holds(&surface), "YieldingSurface::surface_of; invariant, kept by p4_surface_gives");
        let sample = any_sample::<N, _>(s);
        let before = surface;
        let seen = surface.from_surface(sample);
        let given = before.given.min(sample.e).max(Position::zero());
        assert!(surface == YieldingSurface { given, ..before });
        assert!(seen.moved == sample.moved);
        assert!(N::of_signal(seen.e.0) + N::of_signal(given.0) == N::of_signal(sample.e.0));
        cover!(s, given > Position::zero() && given < before.given, "a surface that goes back");
        cover!(s, given == Position::zero() && before.given > given, "outside the wall");
    }
}

property! {
    /// P4: the surface gives way only deep inside the wall and under the law's largest force. It moves by no more than a step and the
    /// device's displacement. The law's spring stays at least as long as the depth that the surface always holds.
    equation "g <= g'; g' > g only if f >= limit; g' - g <= s, displacement; e - g' >= d"
    over "depth, distance, step, limit, sample as seen from the surface, force of the law"
    fn p4_surface_gives(s) {
        let mut surface = any_yielding32(s);
        let sample = any_sample::<N, _>(s);
        assume!(s, surface_holds(&surface), "YieldingSurface::surface_of; invariant, kept by this property");
        let inside = sample.e.max(Position::zero());
        let at = N::of_signal(inside.0) + N::of_signal(surface.given.0);
        assume!(s, at <= N::of_signal(N::HIGHEST), "p9_surface_seen: the penetration fits its format");
        let force = N::any_force(s);
        let before = surface;
        surface.give_way(sample, force);
        assert!(surface_holds(&surface) && surface.given >= before.given);
        let more = N::of_signal(surface.given.0) - N::of_signal(before.given.0);
        assert!(more <= N::of_signal(sample.moved.max(Position::zero()).0));
        let pushed = force >= before.limit;
        assert!(more == 0 || pushed && sample.e > before.deepest);
        assert!(more <= N::of_signal(before.step.0));
        assert!(more == 0 || N::of_signal(sample.e.0) - more >= N::of_signal(before.deepest.0));
        assert!(surface == YieldingSurface { given: surface.given, ..before });
        cover!(s, more > 0 && surface.given > before.given, "a surface that gives way");
        cover!(s, more == 0 && force >= before.limit && sample.e > before.deepest, "a device that goes out");
    }
}
