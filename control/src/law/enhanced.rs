//! Enhanced successive force augmentation (thesis Algorithm 3.1, Fig. 3.18), made passive up to a stated loan of energy.
//!
//! In the first contact the law is a spring of the desired stiffness `k_de`. When the motion turns, a virtual mass takes over. A
//! coupling spring `k_f` connects the hand's point (HIP) to the mass. The soft spring `k_v` pushes the mass out of the wall; it is
//! deformed by the mass' penetration plus an offset `O`. The law changes the offset until the stiffness felt at the HIP is `k_de`.
//!
//! **Passivity at the mass is exact.** The next displacement `d'` of a virtual mass, unlike that of a hand, is *known* before the
//! wall's force `f` is chosen: `d' = (N0 - f)/D`, with the driving force `N0` and the sum of coefficients `D` of [`VirtualMass`].
//! So the controller prevents a deficit of the stored energy `E` instead of repairing it. Pushed by the full force, the mass may
//! move out further than `E/f`, which needs more energy than `E`. Then the law reduces the force until the mass moves out by
//! exactly `E/f`. With no energy left the mass stands still, and the force neither jumps up nor falls to zero. `E >= 0` holds for
//! every input.
//!
//! **Loan (credit).** A wall that balances a hand's force `F` at the stiffness `k_de` through a coupling `k_f` stores `F²/(2
//! k_f)` in that coupling. But a slow press into a stiffness `k_de` absorbs only `F²/(2 k_de)`. So *no* passive wall whose
//! coupling is at most the critical stiffness of sampling, `k_f <= k_c`, can show more than about `2 k_f` to a resting hand. The
//! thesis' controller shows more, because its observer counts the energy leak of sampling with the wrong sign. Here the loan is
//! explicit. The observer starts each contact with the energy `energy_credit`, and over one contact the mass can never give more
//! than that beyond what it took.
//!
//! **A damper beside the augmented wall.** In every phase the force of a damper is added to the wall's force: `B/T` (virtual
//! damping over control period) times the hand's displacement `Δe`. The sum never pulls and stays within the force limit. For a
//! desired stiffness up to `k_v` the law is a damped spring with the damping `B k_de/k_v`. The energy sum at the *mass* leaves
//! the damper out. So the energy that the damper takes is never given back through the offset, and the offset regulates the
//! stiffness of the wall alone. At the *wall's* port the damper's force is held over a tick and acts over the next displacement.
//! So when the motion turns, the damper gives up to `(B/T) |Δe(n) Δe(n+1)|`. A device with the damping `k T/2 + B`, for a wall of
//! stiffness `k`, absorbs that energy. The energy guard bounds the total energy that a hand gets out.
//!
//! Settings can select the thesis' form: no damper, the thesis' observer, and an offset that changes on inward motion only.

use super::{Contact, Law, Sample, View};
use crate::filter::{MassState, VirtualMass};
use crate::{
    Compliance, Divisor, Energy, FirstContact, Force, Number, ObserverForm, OffsetUpdate, Position,
    Ratio, Regulate, Stiffness, Tension,
};

/// The rule that changes the offset of the soft spring step by step: Algorithm 3.1 of the thesis, lines 7–13, with the absolute
/// values that are missing there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Augmentation<N: Number> {
    /// Gain from the error of the force to the ideal step: a fraction `c`, divided by the soft stiffness `k_v` or the desired
    /// stiffness `k_de` (equations (3.7) and (3.8) of the thesis). See [`crate::IdealStep`].
    pub of_ideal: Compliance<N>,
    /// Limits the step of the offset in proportion to the force: a fraction `b` over the soft stiffness `k_v`, equation (3.9) of
    /// the thesis.
    pub of_force: Compliance<N>,
    /// Limits the step to this fraction `a` of the penetration, equation (3.11) of the thesis.
    pub of_penetration: Ratio<N>,
}

impl<N: Number> Augmentation<N> {
    /// Step of the soft spring's offset in a tick, never negative. It is the smallest of three: the ideal step, from the error
    /// `wanted - shown` of the force; a limit by `shown`, the force of the last tick; a limit by the penetration `e`.
    ///
    /// A force of zero counts as one step of the number format; otherwise the offset could never grow again from a force of exactly
    /// zero.
    #[inline]
    pub fn step(&self, wanted: Force<N>, shown: Force<N>, e: Position<N>) -> Position<N> {
        let shown = shown.modulus();
        let ideal = self.of_ideal * (wanted - shown).modulus();
        let weber = self.of_force * shown.max(Force::quantum());
        let near = self.of_penetration * e.modulus();
        Self::least(ideal, weber, near)
    }

    /// The smallest of the three limits of the offset's step. The second limit is at least one step of the number format.
    #[inline]
    pub fn least(ideal: Position<N>, weber: Position<N>, near: Position<N>) -> Position<N> {
        ideal.min(weber.max(Position::quantum())).min(near)
    }
}

/// The enhanced law for a desired stiffness above the soft stiffness. For a smaller desired stiffness [`super::Spring`] takes its
/// place (thesis §3.1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnhancedSfa<N: Number> {
    /// Desired stiffness of the wall, `k_de`.
    pub desired: Stiffness<N>,
    /// The stiffness that the law reaches by changing the offset: the desired stiffness, or that of equation (3.5) of the thesis
    /// for the virtual mass.
    pub target: Stiffness<N>,
    /// Virtual damping over the control period, of the damper whose force is added to the wall's; zero for the thesis' law.
    pub damper: Stiffness<N>,
    /// Stiffness of the soft spring, `k_v`.
    pub soft: Stiffness<N>,
    /// Compliance of the soft spring: `1/k_v`.
    pub compliance: Compliance<N>,
    /// The rule that changes the offset of the soft spring.
    pub augmentation: Augmentation<N>,
    /// The stiffness that the law regulates by the offset: that at the virtual mass or that at the hand's point (HIP).
    pub regulate: Regulate,
    /// The ticks (control periods) in which the offset of the soft spring changes.
    pub update: OffsetUpdate,
    /// The form of the energy observer: the exact one or that of the thesis.
    pub observer: ObserverForm,
    /// What happens to the force when the first contact ends (the first reversal of motion).
    pub first_contact: FirstContact,
    /// Coefficients of the virtual mass.
    pub mass: VirtualMass<N>,
    /// Stiffness of the spring between hand's point and virtual mass, prepared as a divisor.
    pub by_coupling: Divisor<N>,
    /// The sum of coupling stiffness `k_f` and soft stiffness `k_v`, prepared as a divisor.
    pub series: Divisor<N>,
    /// Energy in joules lent to each contact.
    pub credit: Energy<N>,
    /// Largest energy that the law stores, half of the number format's largest value.
    pub energy_cap: Energy<N>,
    /// Largest force that the law commands.
    pub limit: Force<N>,
}

/// Memory of the enhanced law after the first reversal of motion in a contact, while the virtual mass is in use.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Augmented<N: Number> {
    /// State of the virtual mass.
    pub mass: MassState<N>,
    /// Offset: deformation of the soft spring beyond the mass' penetration.
    pub offset: Position<N>,
    /// Force of the wall on the mass in the last tick, never negative.
    pub at_mass: Force<N>,
}

/// Memory of the enhanced law, [`EnhancedSfa`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EnhancedState<N: Number> {
    /// Phase of the contact: outside, first contact, or augmenting.
    pub contact: Contact,
    /// Penetration of the last tick.
    pub last: Position<N>,
    /// Force of the wall on the hand's point (HIP) in the last tick, without the force of the damper that is added to it.
    pub force: Force<N>,
    /// Stored energy left, including the energy lent to the contact; never negative after the first reversal of motion.
    pub energy: Energy<N>,
    /// Memory after the first reversal of motion: virtual mass and offset.
    pub augmented: Augmented<N>,
}

impl<N: Number> EnhancedSfa<N> {
    /// Sum of the augmented wall's force and the damper's, never pulling. The damper acts on the displacement inside the wall, as
    /// in [`super::Spring`].
    #[inline(always)]
    fn damped(&self, augmented: Force<N>, sample: Sample<N>) -> Force<N> {
        (augmented + (self.damper * sample.moved_inside()).towards_zero())
            .max(Force::zero())
            .min(self.limit)
    }

    /// Ends the first contact: places the virtual mass so that the energy absorbed so far covers the stretch of the spring between
    /// mass and hand.
    #[inline]
    pub fn hand_over(&self, state: &mut EnhancedState<N>) {
        let e = state.last;
        let (position, offset) = match self.first_contact {
            FirstContact::ZeroOffset => (self.mass.rest(e, &self.series), Position::zero()),
            FirstContact::KeepForce => {
                // The stretches of coupling and soft spring at which both give the force of the last tick.
                let position = e - state.force.lift().per(&self.by_coupling);
                (
                    position,
                    (self.compliance * state.force - position).max(Position::zero()),
                )
            }
        };
        // If the energy absorbed so far does not cover the stretch of the coupling, the mass starts at the hand's point (HIP)
        // instead.
        let stored = self.mass.stored(e - position);
        let left = stored
            .map(|stored| state.energy - stored)
            .filter(|left| *left >= Energy::zero());
        let position = if left.is_some() { position } else { e };
        state.energy = left.unwrap_or(state.energy.max(Energy::zero()));
        state.contact = Contact::Augmenting;
        state.augmented = Augmented {
            mass: MassState {
                position,
                moved: Position::zero(),
            },
            offset,
            at_mass: (self.soft * (position + offset)).outward(),
        };
    }

    /// The soft spring's new offset in this tick, lines 3–13 of Algorithm 3.1 of the thesis. It is never negative: a negative
    /// offset would end the contact inside the wall (§3.1).
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_pointer_width = "64"), inline)]
    pub fn offset(&self, state: &EnhancedState<N>, e: Position<N>) -> Position<N> {
        let held = &state.augmented;
        let due = match self.update {
            OffsetUpdate::TurnInward | OffsetUpdate::Inward => held.mass.moved > Position::zero(),
            OffsetUpdate::EveryTick => true,
        };
        if !due {
            return held.offset;
        }
        let (shown, at) = match self.regulate {
            Regulate::Hip => (state.force, e),
            Regulate::Mass | Regulate::MassCompensated => (held.at_mass, held.mass.position),
        };
        // The requested force is limited first, so that the limit gives no reason for a larger offset. Otherwise the offset would
        // grow while a hand presses a wall at its force limit. It would push the mass out, which costs energy.
        let wanted = (self.target * at).towards_zero().min(self.limit);
        let step = self.augmentation.step(wanted, shown, at);
        let changed = if shown < wanted {
            held.offset + step
        } else {
            held.offset - step
        };
        changed.max(Position::zero())
    }

    /// Chooses the wall's force on the virtual mass and moves the mass, so that the stored energy does not become negative. Returns
    /// the force.
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_pointer_width = "64"), inline)]
    pub fn move_mass(
        &self,
        state: &mut EnhancedState<N>,
        wanted: Force<N>,
        drive: Tension<N>,
    ) -> Force<N> {
        let mass = &mut state.augmented.mass;
        let (force, step) = match self.observer {
            ObserverForm::Exact => {
                self.affordable_move(mass.position, drive, wanted, &mut state.energy)
            }
            ObserverForm::Thesis => {
                // As in Fig. 3.18 of the thesis, the last displacement of the mass is used in the place of the next one.
                let (after, force) = N::passivity_step(state.energy.0, wanted.0, mass.moved.0);
                state.energy = Energy(after).min(self.energy_cap);
                let step = self.mass.displacement(mass.position, drive, Force(force));
                (Force(force), step)
            }
        };
        *mass = mass.moved_by(step);
        force
    }

    /// Force on the hand's point (HIP) after the first reversal of motion; `None` once the HIP has left the wall.
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_pointer_width = "64"), inline)]
    fn augmented_force(
        &self,
        state: &mut EnhancedState<N>,
        e: Position<N>,
        moved: Position<N>,
    ) -> Option<Force<N>> {
        state.augmented.offset = self.offset(state, e);
        let held = &state.augmented;
        let wanted = (self.soft * (held.mass.position + held.offset)).outward();
        if wanted == Force::zero() {
            // The mass has left the wall, including the deformation by the offset.
            return None;
        }
        let (mass, energy) = (held.mass, state.energy);
        state.augmented.at_mass = self.move_mass(state, wanted, self.mass.drive(&mass, e, moved));
        let shown = self.mass.coupling(&state.augmented.mass, e, moved);
        let pushes = shown > Force::zero();
        if pushes || (shown == Force::zero() && e > Position::zero()) {
            return Some(shown);
        }
        if e <= Position::zero() {
            // Outside the wall's surface the offset may still push the hand out (thesis 2.15), but nothing may pull it back in.
            return None;
        }
        self.leave_behind(state, &mass, energy, wanted);
        Some(Force::zero())
    }

    /// Moves the virtual mass while the hand's point (HIP) leaves it behind. A wall does not pull the hand, so the coupling does
    /// not pull the mass. The mass moves on as if it were not coupled, if the stored energy suffices, and otherwise stands still.
    /// (The divisor still contains the coupling's stiffness and damping, which act as one more damper to ground here.)
    #[inline(never)]
    fn leave_behind(
        &self,
        state: &mut EnhancedState<N>,
        mass: &MassState<N>,
        energy: Energy<N>,
        wanted: Force<N>,
    ) {
        let exact = self.observer == ObserverForm::Exact;
        let held = &mut state.augmented;
        // The thesis' energy sum counts the last displacement of the mass and not this one, so the force stays as it is.
        let force = if exact { wanted } else { held.at_mass };
        let coast = self.mass.coast(mass);
        let mut step = self.mass.displacement(mass.position, coast, force);
        if exact {
            let after = energy + force * step;
            let paid = after >= Energy::zero();
            if !paid {
                step = Position::zero();
            }
            state.energy = if paid {
                after.min(self.energy_cap)
            } else {
                energy
            };
        }
        held.at_mass = force;
        held.mass = mass.moved_by(step);
    }

    /// The exact passivity controller: reduces the force on the virtual mass so that the stored energy plus the work of its next
    /// displacement is not negative. Returns the force and that displacement.
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_pointer_width = "64"), inline)]
    pub fn affordable_move(
        &self,
        from: Position<N>,
        drive: Tension<N>,
        wanted: Force<N>,
        energy: &mut Energy<N>,
    ) -> (Force<N>, Position<N>) {
        let step = self.mass.displacement(from, drive, wanted);
        let after = *energy + wanted * step;
        if after >= Energy::zero() {
            *energy = after.min(self.energy_cap);
            return (wanted, step);
        }
        // Here `wanted > 0` and `step < 0`. At full force the energy suffices for an outward motion of `E/f`, which is less than
        // the step.
        let (retreat, rest) = energy.affordable(wanted);
        let force = self.mass.force_for_retreat(drive, retreat).min(wanted);
        if force <= Force::zero() {
            // The mass moves out further than that even without the wall's force: no force, no work.
            let step = self.mass.displacement(from, drive, Force::zero());
            return (Force::zero(), step);
        }
        // The energy less the work, written as a sum of non-negative terms: the remainder of the division, and what the smaller
        // force saves. (The cap never binds here; with it a solver finds the bound by a comparison.)
        *energy = (rest + (wanted - force) * retreat).min(self.energy_cap);
        (force, -retreat)
    }
}

impl<N: Number> Law<N> for EnhancedSfa<N> {
    type State = EnhancedState<N>;

    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_pointer_width = "64"), inline)]
    fn tick(&self, state: &mut EnhancedState<N>, sample: Sample<N>) -> Force<N> {
        let Sample { e, moved } = sample;
        if state.contact == Contact::Free && e > Position::zero() {
            *state = EnhancedState {
                contact: Contact::First,
                energy: self.credit,
                last: e,
                ..EnhancedState::default()
            };
            state.force = (self.desired * e).outward().min(self.limit);
            return self.damped(state.force, sample);
        }
        if state.contact == Contact::First {
            state.energy = (state.energy + state.force * moved).min(self.energy_cap);
            if moved < Position::zero() && e > Position::zero() {
                self.hand_over(state);
            }
        }
        let force = match state.contact {
            Contact::Free => None,
            Contact::First => (e > Position::zero()).then(|| (self.desired * e).outward()),
            Contact::Augmenting => self.augmented_force(state, e, moved),
        };
        match force {
            Some(force) => {
                state.last = e;
                // The force is not negative, so only the upper limit is needed.
                state.force = force.min(self.limit);
                self.damped(state.force, sample)
            }
            None => {
                *state = EnhancedState {
                    last: e,
                    ..EnhancedState::default()
                };
                Force::zero()
            }
        }
    }

    fn view(&self, state: &EnhancedState<N>) -> View<N> {
        let augmenting = state.contact == Contact::Augmenting;
        View {
            contact: state.contact,
            // The lent energy is not shown as energy that the wall took.
            energy: Some(if state.contact == Contact::Free {
                Energy::zero()
            } else {
                state.energy - self.credit
            }),
            offset: state.augmented.offset,
            mass: augmenting.then_some(state.augmented.mass.position),
        }
    }
}
