//! What every accepted configuration of a law or guard satisfies (`Valid`), and the invariant of the memory (`holds`). The
//! properties start from any configuration and any memory that satisfy these conditions, and show that a tick keeps the invariant.
//!
//! `settings.rs` proves and tests that every configuration that `Controller::new` accepts is valid. `p8_initial32` proves that the
//! first memory satisfies the invariant.

use crate::format::Format;
use crate::source::{Source, one_with};
use touchstone_control::filter::{MassState, VirtualMass};
use touchstone_control::law::{
    Augmentation, Augmented, Contact, EnhancedSfa, EnhancedState, Fba, FbaState, Sfa, SfaState,
    Spring, SpringState, Tdpa, TdpaState,
};
use touchstone_control::{
    Compliance, Divisor, Energy, FirstContact, Force, ObserverForm, OffsetUpdate, Position,
    Regulate, Stiffness, Tension,
};

/// A configuration (law or guard) that settings can give, with its memory.
pub trait Valid<N: Format>: Sized {
    /// The law's or guard's memory between ticks.
    type State;
    /// A configuration with any coefficients, from the source of inputs.
    fn any<S: Source>(s: &mut S) -> Self;
    /// A memory with any values, from the source of inputs.
    fn any_state<S: Source>(s: &mut S) -> Self::State;
    /// Whether the configuration satisfies what `Controller::new` guarantees.
    fn valid(&self) -> bool;
    /// Whether a memory satisfies the invariant, which every tick keeps.
    fn holds(&self, state: &Self::State) -> bool;
}

/// A stiffness with any bits; in random tests mostly one that is not negative.
fn any_gain<N: Format, S: Source>(s: &mut S) -> Stiffness<N> {
    one_with(s, N::any_stiffness, |k| gain_ok(*k))
}
/// Any force limit, in random tests mostly one that is not negative.
fn any_limit<N: Format, S: Source>(s: &mut S) -> Force<N> {
    one_with(s, N::any_force, |f| limit_ok(*f))
}
/// Any ratio, as a compliance; in random tests mostly one that is not negative.
fn any_share<N: Format, S: Source>(s: &mut S) -> Compliance<N> {
    one_with(s, N::any_compliance, |c| N::of_signal_ratio(c.0) >= 0)
}
/// An energy with any bits; in random tests mostly one that is not negative and within the cap.
fn any_stored<N: Format, S: Source>(s: &mut S) -> Energy<N> {
    let cap = N::energy_cap();
    one_with(s, N::any_energy, |e| *e >= Energy::zero() && *e <= cap)
}

fn limit_ok<N: Format>(limit: Force<N>) -> bool {
    limit >= Force::zero()
}
fn gain_ok<N: Format>(k: Stiffness<N>) -> bool {
    k >= Stiffness::zero()
}
fn shown<N: Format>(force: Force<N>, limit: Force<N>) -> bool {
    force >= Force::zero() && force <= limit
}

impl<N: Format> Valid<N> for Spring<N> {
    type State = SpringState;
    fn any<S: Source>(s: &mut S) -> Self {
        Self {
            desired: any_gain(s),
            damping: any_gain(s),
            limit: any_limit(s),
        }
    }
    fn any_state<S: Source>(s: &mut S) -> SpringState {
        SpringState { inside: s.bool() }
    }
    fn valid(&self) -> bool {
        gain_ok(self.desired) && gain_ok(self.damping) && limit_ok(self.limit)
    }
    fn holds(&self, _: &SpringState) -> bool {
        true
    }
}

impl<N: Format> Valid<N> for Tdpa<N> {
    type State = TdpaState<N>;
    fn any<S: Source>(s: &mut S) -> Self {
        Self {
            desired: any_gain(s),
            observer: any_observer(s),
            device_damping: any_gain(s),
            limit: any_limit(s),
            energy_cap: N::energy_cap(),
        }
    }
    fn any_state<S: Source>(s: &mut S) -> TdpaState<N> {
        let inside = s.bool();
        if !inside && s.shortcut() {
            return TdpaState::default();
        }
        TdpaState {
            force: N::any_force(s),
            energy: N::any_energy(s),
            inside,
        }
    }
    fn valid(&self) -> bool {
        gain_ok(self.desired) && gain_ok(self.device_damping) && limit_ok(self.limit)
    }
    fn holds(&self, state: &TdpaState<N>) -> bool {
        if !state.inside {
            return *state == TdpaState::default();
        }
        state.force.modulus() <= self.limit
            && state.energy <= self.energy_cap
            && match self.observer {
                ObserverForm::Thesis => {
                    state.energy >= Energy::zero() && state.force >= Force::zero()
                }
                ObserverForm::Exact => true,
            }
    }
}

impl<N: Format> Valid<N> for Fba<N> {
    type State = FbaState<N>;
    fn any<S: Source>(s: &mut S) -> Self {
        Self {
            desired: any_gain(s),
            device_damping: any_gain(s),
            bound: any_gain(s),
            limit: any_limit(s),
            energy_cap: N::energy_cap(),
        }
    }
    fn any_state<S: Source>(s: &mut S) -> FbaState<N> {
        let inside = s.bool();
        if !inside && s.shortcut() {
            return FbaState::default();
        }
        FbaState {
            force: N::any_force(s),
            energy: N::any_energy(s),
            inside,
        }
    }
    /// Whether the coefficients are valid. `p5_bound_of_damping` proves that the square of the bound is at most four times the
    /// device's damping per tick.
    fn valid(&self) -> bool {
        gain_ok(self.desired)
            && gain_ok(self.device_damping)
            && gain_ok(self.bound)
            && limit_ok(self.limit)
    }
    fn holds(&self, state: &FbaState<N>) -> bool {
        if !state.inside {
            return *state == FbaState::default();
        }
        shown(state.force, self.limit)
            && state.energy <= self.energy_cap
            // With an energy deficit (the counted damping is rounded down) the force is 0 until the deficit is worked off.
            && (state.energy >= Energy::zero() || state.force == Force::zero())
    }
}

impl<N: Format> Valid<N> for Sfa<N> {
    type State = SfaState<N>;
    fn any<S: Source>(s: &mut S) -> Self {
        Self {
            desired: any_gain(s),
            soft: any_gain(s),
            gain: N::any_ratio(s),
            compliance: any_share(s),
            update: any_update(s),
            first_contact: any_first(s),
            limit: any_limit(s),
        }
    }
    fn any_state<S: Source>(s: &mut S) -> SfaState<N> {
        SfaState {
            contact: any_contact(s),
            last: N::any_position(s),
            before_last: N::any_position(s),
            offset: N::any_position(s),
            force: N::any_force(s),
        }
    }
    fn valid(&self) -> bool {
        gain_ok(self.desired) && gain_ok(self.soft) && limit_ok(self.limit)
    }
    fn holds(&self, state: &SfaState<N>) -> bool {
        shown(state.force, self.limit)
            && match state.contact {
                Contact::Free => state.offset == Position::zero() && state.force == Force::zero(),
                Contact::First => state.offset == Position::zero(),
                Contact::Augmenting => true,
            }
    }
}

impl<N: Format> Valid<N> for EnhancedSfa<N> {
    type State = EnhancedState<N>;
    fn any<S: Source>(s: &mut S) -> Self {
        let mass = any_mass(s);
        Self {
            desired: any_gain(s),
            target: any_gain(s),
            damper: any_gain(s),
            soft: any_gain(s),
            compliance: any_share(s),
            augmentation: any_augmentation(s),
            regulate: match (s.bool(), s.bool()) {
                (false, false) => Regulate::Mass,
                (false, true) => Regulate::MassCompensated,
                (true, _) => Regulate::Hip,
            },
            update: any_update(s),
            observer: any_observer(s),
            first_contact: any_first(s),
            mass,
            // Divisors of any stiffness: what the law guarantees does not depend on where the mass starts.
            by_coupling: Divisor::of(N::any_stiffness(s)),
            series: Divisor::of(N::any_stiffness(s)),
            credit: any_stored(s),
            energy_cap: N::energy_cap(),
            limit: any_limit(s),
        }
    }
    fn any_state<S: Source>(s: &mut S) -> EnhancedState<N> {
        let contact = any_contact(s);
        if contact != Contact::Augmenting && s.shortcut() {
            let last = N::any_position(s);
            let (force, energy) = if contact == Contact::First {
                (N::any_force(s), N::any_energy(s))
            } else {
                (Force::zero(), Energy::zero())
            };
            return EnhancedState {
                contact,
                last,
                force,
                energy,
                ..EnhancedState::default()
            };
        }
        EnhancedState {
            contact,
            last: N::any_position(s),
            force: any_limit(s),
            energy: any_stored(s),
            augmented: Augmented {
                mass: MassState {
                    position: N::any_position(s),
                    moved: N::any_position(s),
                },
                offset: one_with(s, N::any_position, |o| *o >= Position::zero()),
                at_mass: any_limit(s),
            },
        }
    }
    fn valid(&self) -> bool {
        gain_ok(self.desired)
            && gain_ok(self.target)
            && gain_ok(self.damper)
            && gain_ok(self.soft)
            && augmentation_ok(&self.augmentation)
            && mass_ok(&self.mass)
            && self.credit >= Energy::zero()
            && self.credit <= self.energy_cap
            && limit_ok(self.limit)
    }
    fn holds(&self, state: &EnhancedState<N>) -> bool {
        match state.contact {
            Contact::Free => {
                *state
                    == EnhancedState {
                        last: state.last,
                        ..EnhancedState::default()
                    }
            }
            Contact::First => {
                state.last > Position::zero()
                    && shown(state.force, self.limit)
                    && state.energy >= Energy::zero()
                    && state.energy <= self.energy_cap
                    && state.augmented == Augmented::default()
            }
            Contact::Augmenting => {
                shown(state.force, self.limit)
                    && state.energy >= Energy::zero()
                    && state.energy <= self.energy_cap
                    && state.augmented.offset >= Position::zero()
                    && state.augmented.at_mass >= Force::zero()
            }
        }
    }
}

/// Any rule for changing the offset of the soft spring, from the source of inputs.
pub fn any_augmentation<N: Format, S: Source>(s: &mut S) -> Augmentation<N> {
    Augmentation {
        of_ideal: any_share(s),
        of_force: any_share(s),
        of_penetration: one_with(s, N::any_ratio, |r| N::of_signal_ratio(r.0) >= 0),
    }
}
/// Whether no coefficient of an offset's rule is negative.
pub fn augmentation_ok<N: Format>(a: &Augmentation<N>) -> bool {
    N::of_signal_ratio(a.of_ideal.0) >= 0
        && N::of_signal_ratio(a.of_force.0) >= 0
        && N::of_signal_ratio(a.of_penetration.0) >= 0
}
/// A virtual mass with any coefficients, from the source of inputs.
pub fn any_mass<N: Format, S: Source>(s: &mut S) -> VirtualMass<N> {
    let bits = |k: &Stiffness<N>| N::of_gain(k.0);
    let part = |s: &mut S| {
        one_with(s, N::any_stiffness, |k| {
            (0..=N::HALF_GAIN / 3).contains(&bits(k))
        })
    };
    let (inertia, stiffness, damping) = (part(s), part(s), part(s));
    let sum = bits(&inertia) + bits(&stiffness) + bits(&damping);
    let most = N::HALF_GAIN;
    let total = one_with(s, N::any_stiffness, |k| {
        bits(k) > 0 && (sum..=most).contains(&bits(k))
    });
    VirtualMass {
        inertia,
        stiffness,
        damping,
        total,
        by_total: Divisor::of(total),
    }
}
/// Whether a virtual mass is valid: its coefficients are not negative, their sum is at most the stored total, and twice the total
/// fits the format.
pub fn mass_ok<N: Format>(mass: &VirtualMass<N>) -> bool {
    let [inertia, stiffness, damping, total] =
        [mass.inertia, mass.stiffness, mass.damping, mass.total].map(|k| N::of_gain(k.0));
    inertia >= 0
        && stiffness >= 0
        && damping >= 0
        && total > 0
        && inertia + stiffness + damping <= total
        && total <= N::HALF_GAIN
}
/// Whether a force can occur as the force that drives the virtual mass: `enhanced::p6_drive_is_exact` shows that no larger one
/// does.
pub fn drive_ok<N: Format>(mass: &VirtualMass<N>, drive: Tension<N>) -> bool {
    let reach = N::of_gain(mass.total.0) << (N::BITS - 1);
    N::of_tension(drive.0).unsigned_abs() <= reach.unsigned_abs()
}

fn any_observer<S: Source>(s: &mut S) -> ObserverForm {
    if s.bool() {
        ObserverForm::Thesis
    } else {
        ObserverForm::Exact
    }
}
fn any_first<S: Source>(s: &mut S) -> FirstContact {
    if s.bool() {
        FirstContact::KeepForce
    } else {
        FirstContact::ZeroOffset
    }
}
fn any_update<S: Source>(s: &mut S) -> OffsetUpdate {
    match (s.bool(), s.bool()) {
        (false, false) => OffsetUpdate::TurnInward,
        (false, true) => OffsetUpdate::Inward,
        (true, _) => OffsetUpdate::EveryTick,
    }
}
fn any_contact<S: Source>(s: &mut S) -> Contact {
    match (s.bool(), s.bool()) {
        (false, false) => Contact::Free,
        (false, true) => Contact::First,
        (true, _) => Contact::Augmenting,
    }
}
