//! Properties of the parts of a knob's feel (spring to a centre, viscous and dry friction, click, inertia) at 32 bits: each force
//! is within its limit, and each memory within its bounds.
//!
//! `f` is the force, `A` its limit, `z` the stretch of a spring, `Z` the largest stretch. `l` is the number of ticks left of a
//! click of `2 h` ticks. `y` is the distance from the dragged mass to the device.
//!
//! ```text
//! |f| <= A, f z >= 0                              p4_elastic_force
//! |f| <= A, f' = f at the next tick               p4_viscous_force
//! |z| <= Z, |z' - z| <= |Δ|, |f| <= A             p4_dry_force
//! f = A or -A while l > 0, else 0; l <= 2 h       p4_click_force
//! |f| <= A, y, Δ >= 0 => y' >= 0                  p4_inertia_force
//! ```

use crate::format::Format;
use crate::source::{Source, one_with};
use crate::{assume, cover, property};
use touchstone_control::environment::feel::{Click, Dry, Elastic, Viscous};
use touchstone_control::environment::inertia::Dragged;
use touchstone_control::{Compliance, Fixed32, Force, Position, Ratio};

type N = Fixed32;

fn positive_force32<S: Source>(s: &mut S) -> Force<N> {
    one_with(s, N::any_force, |it| *it >= Force::zero())
}

fn any_elastic32<S: Source>(s: &mut S) -> Elastic<N> {
    Elastic {
        stiffness: one_with(s, N::any_compliance, |it| *it >= Compliance::zero()),
        most: positive_force32(s),
    }
}

/// Whether the spring could come from accepted settings: `CentreSettings::spring`, `DrySettings::dry`.
fn elastic_holds(it: &Elastic<N>) -> bool {
    it.stiffness >= Compliance::zero() && it.most >= Force::zero()
}

property! {
    /// P4: a spring to a centre pushes with at most its largest force, and never away from the centre.
    equation "|f| <= A; z >= 0 => f >= 0; z <= 0 => f <= 0"
    over "stiffness, largest force, stretch"
    fn p4_elastic_force(s) {
        let spring = any_elastic32(s);
        assume!(s, elastic_holds(&spring), "CentreSettings::spring");
        let stretch = N::any_position(s);
        let force = spring.force(stretch);
        assert!(force <= spring.most && force >= -spring.most);
        assert!(stretch < Position::zero() || force >= Force::zero());
        assert!(stretch > Position::zero() || force <= Force::zero());
        cover!(s, force == spring.most && force > Force::zero(), "the largest force");
        cover!(s, force < Force::zero() && force > -spring.most, "a smaller one");
    }
}
property! {
    /// P4: rendered viscous friction stays within the force limit, and stores its force for the next tick.
    equation "|f| <= A; f is the memory of the next tick"
    over "coefficients, force limit, last force, displacement"
    fn p4_viscous_force(s) {
        let mut viscous = Viscous::<N> {
            kept: one_with(s, N::any_ratio, |it| *it >= Ratio::zero()),
            per_way: one_with(s, N::any_compliance, |it| *it >= Compliance::zero()),
            most: positive_force32(s),
            force: N::any_force(s),
        };
        assume!(s, viscous.kept >= Ratio::zero() && viscous.per_way >= Compliance::zero() && viscous.most >= Force::zero(), "ViscousSettings::viscous");
        let before = viscous.force;
        let force = viscous.tick(N::any_position(s));
        assert!(force <= viscous.most && force >= -viscous.most);
        assert!(viscous.force == force);
        cover!(s, force == viscous.most && force > Force::zero(), "the force limit");
        cover!(s, force < Force::zero() && before > Force::zero(), "a turn");
    }
}
property! {
    /// P4: the force of rendered dry friction is at most its strength. Its spring is never longer than the largest stretch, and the
    /// stretch changes by at most the displacement.
    equation "|z'| <= Z, |z' - z| <= |Δ|, |f| <= A"
    over "stiffness, strength, largest stretch, stretch, displacement"
    fn p4_dry_force(s) {
        let spring = any_elastic32(s);
        let reach = one_with(s, N::any_position, |it| *it >= Position::zero());
        let stretch = one_with(s, N::any_position, |it| *it <= reach && *it >= -reach);
        let mut dry = Dry { spring, reach, stretch };
        assume!(s, elastic_holds(&spring) && reach >= Position::zero(), "DrySettings::dry");
        assume!(s, stretch <= reach && stretch >= -reach, "invariant, kept by this property");
        let moved = N::any_position(s);
        let force = dry.tick(moved);
        assert!(dry.stretch <= reach && dry.stretch >= -reach);
        let bits = |it: Position<N>| N::of_signal(it.0);
        assert!((bits(dry.stretch) - bits(stretch)).abs() <= bits(moved).abs());
        assert!(force <= spring.most && force >= -spring.most);
        cover!(s, dry.stretch == reach && moved > Position::zero(), "slides");
        cover!(s, dry.stretch != stretch && dry.stretch < reach && dry.stretch > -reach, "sticks");
    }
}
property! {
    /// P4: while a part of the pulse is left, a click's force is its strength in one of the two directions; otherwise 0. A pulse
    /// begins only when the device has passed the click's position from its other side, and lasts twice `half` ticks.
    equation "l > 0: |f| = A, l' = l - 1; else f = 0; l' <= 2 h; begins => side known before, unknown after"
    over "strength, length, side, direction, ticks left, distance from the position"
    fn p4_click_force(s) {
        let half = s.u16();
        let mut click = Click::<N> {
            pulse: positive_force32(s),
            half,
            side: s.bool().then(|| s.bool()),
            upward: s.bool(),
            left: s.u32() % (2 * u32::from(half) + 1),
        };
        assume!(s, click.pulse >= Force::zero() && half > 0, "ClickSettings::click");
        let before = click;
        let beyond = s.i32();
        let force = click.tick(beyond);
        let begins = before.side.is_some() && click.side.is_none();
        let left = if begins { 2 * u32::from(half) } else { before.left };
        assert!(click.left == left.saturating_sub(1));
        assert!(force == if left == 0 { Force::zero() } else if (left > u32::from(half)) == click.upward { click.pulse } else { -click.pulse });
        assert!(!begins || before.side == Some(click.upward));
        assert!(!begins || (beyond >= 0) == click.upward || beyond == 0);
        cover!(s, begins && click.upward, "begins upwards");
        cover!(s, begins && !click.upward, "begins downwards");
        cover!(s, !begins && left > 0 && left <= u32::from(half), "the second half");
    }
}
property! {
    /// P4: rendered inertia stays within the force limit and stores its force for the next tick. A device that is ahead of the mass
    /// that it drags, and moves on, stays ahead.
    equation "|f| <= A; f is the memory of the next tick; y >= 0, Δ >= 0 => y' >= 0; y <= 0, Δ <= 0 => y' <= 0"
    over "coefficients, force limit, last force, distance to the mass, displacement"
    fn p4_inertia_force(s) {
        let damper = Viscous::<N> {
            kept: one_with(s, N::any_ratio, |it| *it >= Ratio::zero()),
            per_way: one_with(s, N::any_compliance, |it| *it >= Compliance::zero()),
            most: positive_force32(s),
            force: N::any_force(s),
        };
        let kept = one_with(s, N::any_ratio, |it| *it >= Ratio::zero());
        let mut dragged = Dragged { kept, ahead: N::any_position(s), damper };
        assume!(s, damper.kept >= Ratio::zero() && damper.per_way >= Compliance::zero() && damper.most >= Force::zero(), "ViscousSettings::viscous");
        assume!(s, kept >= Ratio::zero(), "InertiaSettings::rendered");
        let before = dragged.ahead;
        let moved = N::any_position(s);
        let force = dragged.drag(moved);
        assert!(force <= damper.most && force >= -damper.most);
        assert!(dragged.damper.force == force);
        let none = Position::zero();
        assert!(before < none || moved < none || dragged.ahead >= none);
        assert!(before > none || moved > none || dragged.ahead <= none);
        cover!(s, force == damper.most && force > Force::zero(), "the force limit");
        cover!(s, before > none && moved < none, "a turn");
    }
}
