//! The controller around a law: a tick is the wall's surface, the law, the pulse at the touch and then the energy guard, for any law. The controller
//! stores the force that later stages report to it.
//!
//! `f` is the force, `e` the penetration, `B` the energy in the guard's account and `C` its capacity; `'` marks the new value.
//!
//! ```text
//! f = guard(pulse(law(seen(e, e - e(n-1)))))   p11_controller_tick
//! reported f: f(n-1) = f, in the guard too     p11_controller_told
//! resumed: memory new, B' = min(B, C')         p7_controller_resumes
//! built: law, guard if switched on, f = 0      p8_controller_made
//! ```

use crate::format::Format;
use crate::source::{Source, one_with};
use crate::stage::{any_stage, stage_holds};
use crate::valid::Valid;
use crate::yielding::surface_holds;
use crate::{assume, cover, replaced_property};
use touchstone_control::law::{Impact, Law, Sample, Spring, SpringState, YieldingSurface};
use touchstone_control::{
    AnyLaw, Controller, Fixed8, Fixed32, Force, Guard, Guarded, Number, Settings, Si, States,
    StatesKind, Stiffness,
};
#[cfg(kani)]
use touchstone_control::{
    Compliance, Energy, GuardSettings, GuardedDevice, Position, Ratio, SettingsError,
};

type N = Fixed8;

/// A controller with a spring of zero stiffness, measured positions and no guard.
pub(crate) fn plain<N: Number>() -> Controller<N> {
    let none = Stiffness::zero();
    let spring = Spring {
        desired: none,
        damping: none,
        limit: Force::zero(),
    };
    let law = AnyLaw::Spring(spring, SpringState::default());
    Controller::of_parts(law, States::default(), None)
}

/// Defines a property of a controller with a spring that holds whatever the guard and the products return.
macro_rules! controller_property {
    ($($property:tt)*) => {
        $crate::replaced_property! {
            [(<touchstone_control::Fixed8 as touchstone_control::Number>::product, crate::controller::product)
            (touchstone_control::Guarded::tick, crate::controller::kept)
            (touchstone_control::Guard::switched_off, crate::controller::ended)]
            $($property)*
        }
    };
}

/// Replaces the product of a gain and a signal of `Fixed8`. The result depends on every digit of both factors and stays exact when
/// it is rounded by a gain's fractional bits. The sum of two results fits.
#[cfg(kani)]
pub fn product(k: <Fixed8 as Number>::Gain, x: <Fixed8 as Number>::Signal) -> i16 {
    (i16::from(k.to_bits()) ^ i16::from(x.to_bits())) << 3
}

/// Replaces `Guarded::tick`: records the arguments in the guard's memory, and returns a force that differs from all of them.
#[cfg(kani)]
pub fn kept<N: Number>(
    guarded: &mut Guarded<N>,
    e: Position<N>,
    at_change: Option<Position<N>>,
    wanted: Force<N>,
) -> Force<N> {
    guarded.last = Some(e);
    guarded.state.force = wanted;
    guarded.state.older = Force(at_change.map_or(N::QUANTUM, |x| x.0));
    guarded.limited = at_change.is_some();
    guarded.tripped |= wanted == Force::zero();
    -wanted
}

/// Replaces `Guard::switched_off`: changes the guard's memory, so that the property can see the call.
#[cfg(kani)]
pub fn ended<N: Number>(_: &Guard<N>, state: &mut touchstone_control::GuardState<N>) {
    core::mem::swap(&mut state.force, &mut state.older);
}

/// A pulse at the touch with any memory.
fn any_pulse<S: Source>(s: &mut S) -> Impact<N> {
    Impact {
        brake: N::any_stiffness(s),
        limit: N::any_force(s),
        apart: s.bits(2) as u16,
        left: N::any_force(s),
        outside: s.bits(2) as u16,
        vibration: None,
    }
}

/// A controller with any spring, any pulse at the touch or none, any last sample, any guard or none, and any last force.
fn any_wall<S: Source>(s: &mut S) -> Controller<N> {
    let mut wall = plain::<N>();
    wall.impact = s.bool().then(|| any_pulse(s));
    wall.surface = YieldingSurface {
        limit: N::any_force(s),
        deepest: N::any_position(s),
        step: N::any_position(s),
        given: N::any_position(s),
    };
    let law = one_with(s, <Spring<N> as Valid<N>>::any, Spring::valid);
    wall.law = AnyLaw::Spring(law, <Spring<N> as Valid<N>>::any_state(s));
    wall.commanded(N::any_force(s));
    wall.states = States::Measured {
        last: N::any_position(s),
    };
    wall.guard = s
        .bool()
        .then(|| one_with(s, any_stage::<N, S>, stage_holds));
    wall
}

controller_property! {
    /// P11 (refinement): a tick is the law, with the penetration from the surface and its change, then the pulse at the touch, and
    /// then the guard. The surface may give way under the law's force. The guard gets the measured positions and the force that law and pulse request.
    equation "f = guard(e, at_change, pulse(law(seen(e, e - e(n-1)))))"
    over "spring, surface, pulse or none, guard or none, memories, sample, with and without one at the change of force; under the checker a guard that keeps what it is told and something in the place of the spring's products"
    by minisat fn p11_controller_tick(s) {
        let before = any_wall(s);
        assume!(s, cfg!(kani) || before.guard.as_ref().is_none_or(stage_holds), "Guard::new; invariant, kept by p1_account_stays, p4_overspeed and p9_no_way_uncounted");
        let AnyLaw::Spring(law, mut state) = before.law else { return };
        assume!(s, law.valid(), "validate");
        let States::Measured { last } = before.states else { return };
        assume!(s, surface_holds(&before.surface), "YieldingSurface::surface_of; invariant, kept by p4_surface_gives");
        let e = N::any_position(s);
        let at_change = s.bool().then(|| N::any_position(s));
        let mut wall = before;
        let shown = match at_change {
            None => wall.tick(e),
            Some(_) => wall.tick_with_change(e, at_change),
        };
        let mut surface = before.surface;
        let sample = surface.from_surface(Sample { e, moved: e - last });
        let mut wanted = law.tick(&mut state, sample);
        surface.give_way(sample, wanted);
        let mut impact = before.impact;
        if let Some(impact) = &mut impact {
            wanted = impact.with_pulse_and_vibration(sample, wanted);
        }
        let mut guard = before.guard;
        let force = match &mut guard {
            Some(guard) => guard.tick(e, at_change, wanted),
            None => wanted,
        };
        assert!(shown == force && wall.last_commanded() == force);
        assert!(wall.law == AnyLaw::Spring(law, state) && wall.view() == law.view(&state));
        assert!(wall.guard == guard && wall.states == States::Measured { last: e });
        assert!(wall.impact == impact && wall.surface == surface);
        assert!(wall.tripped() == guard.is_some_and(|guard| guard.tripped));
        cover!(s, guard.is_some() && force != Force::zero(), "a force, guarded");
        cover!(s, guard.is_none() && force != Force::zero(), "a force, not guarded");
        cover!(s, wanted > Force::quantum() + Force::quantum() + Force::quantum(), "a force of many digits");
        cover!(s, wall.tripped(), "overspeed");
        cover!(s, wall.surface.given > before.surface.given, "a surface that gives way");
    }
}
controller_property! {
    /// P11 (refinement): a force that a later stage commanded and reported reaches the guard, and is the controller's last force
    /// from then on.
    equation "told f: f(n-1) = f, guard(f)"
    over "guard or none, memories, force told"
    by cadical fn p11_controller_told(s) {
        let mut wall = any_wall(s);
        let mut guard = wall.guard;
        let told = N::any_force(s);
        if let Some(Guarded { guard, state, .. }) = &mut guard {
            guard.commanded(state, told);
        }
        let before = wall;
        wall.commanded(told);
        assert!(wall.last_commanded() == told && wall.guard == guard);
        assert!(wall.law == before.law && wall.states == before.states && wall.impact == before.impact && wall.surface == before.surface);
        cover!(s, wall.guard != before.guard, "the guard counts with it");
    }
}
controller_property! {
    /// P11 (refinement): a report to the controller that the force is switched off reaches its guard, and the last force becomes 0.
    /// The law's memory stays.
    equation "guard = switched_off(guard), f = 0"
    over "guard or none, memories"
    by cadical fn p11_controller_switched_off(s) {
        let mut wall = any_wall(s);
        let mut guard = wall.guard;
        if let Some(guard) = &mut guard {
            guard.guard.switched_off(&mut guard.state);
        }
        let before = wall;
        wall.switched_off();
        assert!(wall.last_commanded() == Force::zero() && wall.guard == guard);
        assert!(wall.law == before.law && wall.states == before.states && wall.impact == before.impact && wall.surface == before.surface);
        cover!(s, wall.guard != before.guard, "the guard counts with it");
    }
}
controller_property! {
    /// P7 (end of contact): a controller that is resumed at arming is as new, except for the energy that is left in its guard's
    /// account.
    equation "memory = new; B' = min(B, C'), f = 0"
    over "guard or none before and after, memories"
    by cadical fn p7_controller_resumes(s) {
        let before = any_wall(s);
        let mut fresh = plain::<N>();
        fresh.guard = s.bool().then(|| Guarded::new(Guard::<N>::any(s)));
        let mut wall = before;
        wall.resume(&fresh);
        assert!(wall.law == fresh.law && wall.states == fresh.states && wall.surface == fresh.surface);
        assert!(wall.last_commanded() == Force::zero());
        let guard = match (fresh.guard, before.guard) {
            (Some(fresh), Some(before)) => Some(fresh.resumed(&before)),
            (fresh, _) => fresh,
        };
        assert!(wall.guard == guard);
        if let (Some(after), Some(before)) = (&wall.guard, &before.guard) {
            assert_reached!(after.state.account == before.state.account.min(after.guard.capacity));
        }
        cover!(s, before.guard.is_some() && wall.guard.is_some(), "an account is kept");
        cover!(s, before.guard.is_some() && wall.guard.is_none(), "no guard any more");
    }
}

/// Replaces `AnyLaw::new`: returns a spring with zero stiffness and the given force limit, or an error for a negative stiffness.
#[cfg(kani)]
pub fn law_made<N: Number>(settings: &Settings) -> Result<AnyLaw<N>, SettingsError> {
    let (count, coarsest) = (settings.k_desired, Si::ZERO);
    if settings.k_desired < Si::ZERO {
        return Err(SettingsError::TooCoarse { count, coarsest });
    }
    let none = Stiffness::zero();
    let spring = Spring {
        desired: none,
        damping: none,
        limit: Force(N::saturating_signal(settings.force_limit)),
    };
    Ok(AnyLaw::Spring(spring, SpringState::default()))
}

/// Replaces `Guard::new`: returns a guard that holds the arguments, with a full account, or an error for a negative capacity.
#[cfg(kani)]
pub fn guard_made<N: Number>(
    settings: &GuardSettings,
    device: &GuardedDevice,
) -> Result<Guard<N>, SettingsError> {
    let (count, coarsest) = (device.count, settings.capacity);
    if settings.capacity < Si::ZERO {
        return Err(SettingsError::TooCoarse { count, coarsest });
    }
    let told = |value| Position(N::saturating_signal(value));
    Ok(Guard {
        capacity: Force::quantum() * Position::quantum(),
        refill: Energy::zero(),
        damping: Stiffness::zero(),
        furthest: told(device.force_limit),
        count: told(device.count),
        late: Ratio::zero(),
        stray: Compliance::zero(),
        slack: told(settings.capacity),
        per_reach: Stiffness::zero(),
        in_flight: Position::zero(),
        overrun: Compliance::zero(),
    })
}

/// Replaces `YieldingSurface::surface_of`: returns a surface that holds the arguments, or an error for a negative force limit.
#[cfg(kani)]
pub fn surface_made<N: Number>(settings: &Settings) -> Result<YieldingSurface<N>, SettingsError> {
    let (count, coarsest) = (settings.force_limit, Si::ZERO);
    if settings.force_limit < Si::ZERO {
        return Err(SettingsError::TooCoarse { count, coarsest });
    }
    Ok(YieldingSurface {
        limit: Force(N::saturating_signal(settings.force_limit)),
        deepest: Position(N::saturating_signal(settings.k_desired)),
        ..YieldingSurface::unyielding()
    })
}

replaced_property! {
    [(touchstone_control::AnyLaw::new, crate::controller::law_made)
    (touchstone_control::Guard::new, crate::controller::guard_made)
    (touchstone_control::law::YieldingSurface::surface_of, crate::controller::surface_made)]
    /// P8 (settings): with measured states, a controller consists of the surface, the law, the pulse and, if switched on, the guard of its
    /// settings, and commands no force. It is refused if one of them is refused, and for no other reason.
    equation "Controller(s) = (surface(s), law(s), pulse(s), guard(s) where on, f = 0)"
    over "guard on or off, its account, count, force limit, desired stiffness; states as measured; under the checker a law, a guard and a surface that are what they were told, or none"
    by cadical fn p8_controller_made(s) {
        let mut settings = Settings {
            states: StatesKind::Measured,
            ..Settings::default()
        };
        settings.guard.on = s.bool();
        let told = [&mut settings.guard.capacity, &mut settings.k_desired, &mut settings.force_limit, &mut settings.position.count, &mut settings.position_error];
        for value in told {
            let any = Si::from_bits(s.i64());
            *value = if s.shortcut() { Si::from_bits(value.to_bits() - (any.to_bits() & 7)) } else { any };
        }
        let found = Controller::<Fixed32>::new(&settings);
        let law = AnyLaw::<Fixed32>::new(&settings);
        let guard = Guard::<Fixed32>::new(&settings.guard, &settings.guarded_device());
        let guard = settings.guard.on.then_some(guard).transpose();
        let impact = Impact::<Fixed32>::pulse_of(&settings);
        let surface = YieldingSurface::<Fixed32>::surface_of(&settings);
        assert!(found.is_err() == (law.is_err() || guard.is_err() || impact.is_err() || surface.is_err()));
        cover!(s, law.is_err(), "no law");
        cover!(s, guard.is_err(), "no guard");
        if let (Ok(found), Ok(law), Ok(guard), Ok(impact)) = (found, law, guard, impact) {
            assert!(found.impact == impact && found.law == law && found.guard == guard.map(Guarded::new));
            assert!(surface.is_ok_and(|surface| found.surface == surface));
            assert!(found.states == States::default() && found.last_commanded() == Force::zero());
            cover!(s, found.guard.is_some(), "with a guard");
            cover!(s, found.guard.is_none(), "without one");
        }
    }
}
