//! Replacements for the parts of the enhanced law's tick when the model checker runs: any result, and the same result for equal
//! arguments.
//!
//! Whether a tick combines its parts as its specification does, does not depend on what the parts return. A `composed_property!`
//! replaces these parts in code and specification: the new offset, the force that drives the virtual mass, the move that stored
//! energy pays for, the thesis' passivity controller, and the coupling's force. The code gets any result. The specification gets
//! the same one for equal arguments, and any result for others.
//!
//! `refines_enhanced::w32::p11_offset`, `p11_mass_forces`, `p11_move_*` and `refines::w32::p11_passive` prove that the real results
//! are equal. What moves and passivity controller require of their arguments is asserted in this file; what offset and energy
//! bookkeeping require is assumed by the property.

/// Defines a property of the enhanced law's tick. At 32 bits (`multiplied`) the parts of the tick are replaced by those of this
/// file, at 8 bits (`plain`) they are the real ones.
#[macro_export]
macro_rules! composed_property {
    ($products:ident $($property:tt)*) => {
        $crate::divided_property! {
            $products and [
                (touchstone_control::law::EnhancedSfa::offset, $crate::pieces::offset)
                (touchstone_control::law::EnhancedSfa::affordable_move, $crate::pieces::affordable_move)
                (touchstone_control::law::EnhancedSfa::hand_over, $crate::pieces::no_hand_over)
                (touchstone_control::filter::VirtualMass::drive, $crate::pieces::drive)
                (touchstone_control::filter::VirtualMass::coupling, $crate::pieces::coupling)
                (<touchstone_control::Fixed32 as touchstone_control::Number>::passivity_step, $crate::pieces::passivity_step)
                ($crate::spec::tdpa::passive, $crate::pieces::passive)
                ($crate::spec::enhanced::Enhanced::offset, $crate::pieces::specified_offset)
                ($crate::spec::enhanced::Enhanced::paid_move, $crate::pieces::paid_move)
                ($crate::spec::enhanced::Enhanced::hand_over, $crate::pieces::no_specified_hand_over)
                ($crate::spec::enhanced::Enhanced::drive, $crate::pieces::specified_drive)
                ($crate::spec::enhanced::Enhanced::coupled, $crate::pieces::coupled)
            ]
            $($property)*
        }
    };
}

/// Defines a property of the guard's tick in which the sum of the energy account is replaced by any result.
#[macro_export]
macro_rules! booked_property {
    ($products:ident $($property:tt)*) => {
        $crate::multiplied_property! {
            $products and [
                (touchstone_control::Guard::booked, $crate::pieces::booked)
                ($crate::spec::guard::Guard::booked, $crate::pieces::specified_booked)
            ]
            $($property)*
        }
    };
}

/// Defines a property of a tick of the enhanced law in which the virtual mass does not take over. The hand-over cannot occur, so it
/// is replaced.
#[macro_export]
macro_rules! first_property {
    ($products:ident $($property:tt)*) => {
        $crate::divided_property! {
            $products and [
                (touchstone_control::law::EnhancedSfa::hand_over, $crate::pieces::no_hand_over)
                ($crate::spec::enhanced::Enhanced::hand_over, $crate::pieces::no_specified_hand_over)
            ]
            $($property)*
        }
    };
}

#[cfg(kani)]
pub use by_one_answer::*;
#[cfg(kani)]
mod by_one_answer {
    use crate::format::Format;
    use crate::multiplied::specifies;
    use crate::source::Symbolic;
    use crate::spec::Int;
    use crate::spec::enhanced::{Contact, Enhanced, Memory};
    use crate::valid::drive_ok;
    use core::sync::atomic::{AtomicI64, AtomicUsize, Ordering::Relaxed};
    use touchstone_control::filter::{MassState, VirtualMass};
    use touchstone_control::law::{self, EnhancedSfa, EnhancedState};
    use touchstone_control::{
        Energy, Fixed32, Force, Guard, GuardState, Number, Position, Tension,
    };

    const WORDS: usize = 9;
    type Words = [i64; WORDS];

    /// Record of the code's call of one part of the tick: arguments and result. Each part is called once in a tick.
    struct Piece {
        asked: AtomicUsize,
        question: [AtomicI64; WORDS],
        answer: [AtomicI64; 3],
    }
    static OFFSET: Piece = Piece::new();
    static DRIVE: Piece = Piece::new();
    static MOVE: Piece = Piece::new();
    static STEP: Piece = Piece::new();
    static BOOKED: Piece = Piece::new();
    static COUPLING: Piece = Piece::new();

    impl Piece {
        const fn new() -> Self {
            Self {
                asked: AtomicUsize::new(0),
                question: [const { AtomicI64::new(0) }; WORDS],
                answer: [const { AtomicI64::new(0) }; 3],
            }
        }
        fn told(&self, question: Words, answer: [i64; 3]) {
            assert!(
                !specifies() && self.asked.load(Relaxed) == 0,
                "the code asks once"
            );
            self.asked.store(1, Relaxed);
            let mut at = 0;
            while at < WORDS {
                self.question[at].store(question[at], Relaxed);
                at += 1;
            }
            at = 0;
            while at < 3 {
                self.answer[at].store(answer[at], Relaxed);
                at += 1;
            }
        }
        fn again(&self, question: Words, mut answer: [i64; 3]) -> [i64; 3] {
            let mut same = self.asked.load(Relaxed) == 1;
            let mut at = 0;
            while at < WORDS {
                same = same && self.question[at].load(Relaxed) == question[at];
                at += 1;
            }
            at = 0;
            while at < 3 {
                if same {
                    answer[at] = self.answer[at].load(Relaxed);
                }
                at += 1;
            }
            answer
        }
    }

    fn words<const M: usize>(of: [Int; M]) -> Words {
        let mut words = [0; WORDS];
        let mut at = 0;
        while at < M {
            assert!(
                i64::try_from(of[at]).is_ok(),
                "the specification's pieces are asked double words"
            );
            words[at] = of[at] as i64;
            at += 1;
        }
        words
    }
    fn at<N: Format>(x: Position<N>) -> Int {
        N::of_signal(x.0).into()
    }
    fn force<N: Format>(f: Force<N>) -> Int {
        N::of_signal(f.0).into()
    }

    /// Replaces [`EnhancedSfa::offset`] when the model checker runs the code: returns any value, and the same value for equal
    /// arguments.
    pub fn offset<N: Format>(
        _: &EnhancedSfa<N>,
        state: &EnhancedState<N>,
        e: Position<N>,
    ) -> Position<N> {
        let held = &state.augmented;
        let contact = match state.contact {
            law::Contact::Free => Contact::Free,
            law::Contact::First => Contact::First,
            law::Contact::Augmenting => Contact::Augmenting,
        };
        let mass = [
            at(held.mass.position),
            at(held.mass.moved),
            at(held.offset),
            force(held.at_mass),
        ];
        let question = words([
            contact as Int,
            at(state.last),
            force(state.force),
            N::of_energy(state.energy.0).into(),
            mass[0],
            mass[1],
            mass[2],
            mass[3],
            at(e),
        ]);
        let any = N::any_position(&mut Symbolic);
        OFFSET.told(question, [N::of_signal(any.0), 0, 0]);
        any
    }
    /// Replaces [`Enhanced::offset`] when the model checker runs the specification: returns the value that the code got for equal
    /// arguments.
    pub fn specified_offset(_: &Enhanced, m: &Memory, e: Int) -> Int {
        let question = words([
            m.contact as Int,
            m.last,
            m.force,
            m.energy,
            m.mass,
            m.mass_moved,
            m.offset,
            m.at_mass,
            e,
        ]);
        let any: i32 = kani::any();
        OFFSET.again(question, [any.into(), 0, 0])[0].into()
    }

    /// Replaces [`VirtualMass::drive`] when the model checker runs: any force within the bound that `enhanced::p6_drive_is_exact`
    /// proves.
    pub fn drive<N: Format>(
        law: &VirtualMass<N>,
        mass: &MassState<N>,
        e: Position<N>,
        moved: Position<N>,
    ) -> Tension<N> {
        let any = N::any_tension(&mut Symbolic);
        kani::assume(drive_ok(law, any));
        DRIVE.told(
            words([at(mass.position), at(mass.moved), at(e), at(moved)]),
            [N::of_tension(any.0), 0, 0],
        );
        any
    }
    /// Replaces [`Enhanced::drive`] when the model checker runs the specification: returns the value that the code got for equal
    /// arguments.
    pub fn specified_drive(_: &Enhanced, mass: Int, mass_moved: Int, e: Int, moved: Int) -> Int {
        let any: i64 = kani::any();
        DRIVE.again(words([mass, mass_moved, e, moved]), [any, 0, 0])[0].into()
    }

    /// Replaces [`EnhancedSfa::affordable_move`] when the model checker runs the code: returns any value, and the same value for
    /// equal arguments.
    pub fn affordable_move<N: Format>(
        law: &EnhancedSfa<N>,
        from: Position<N>,
        drive: Tension<N>,
        wanted: Force<N>,
        energy: &mut Energy<N>,
    ) -> (Force<N>, Position<N>) {
        assert!(
            wanted > Force::zero() && drive_ok(&law.mass, drive),
            "what p11_move_* assumes"
        );
        assert!(
            *energy >= Energy::zero() && *energy <= law.energy_cap,
            "what p11_move_* assumes"
        );
        let any = (
            N::any_energy(&mut Symbolic),
            N::any_force(&mut Symbolic),
            N::any_position(&mut Symbolic),
        );
        let question = [
            N::of_energy(energy.0).into(),
            at(from),
            N::of_tension(drive.0).into(),
            force(wanted),
        ];
        MOVE.told(
            words(question),
            [
                N::of_energy(any.0.0),
                N::of_signal(any.1.0),
                N::of_signal(any.2.0),
            ],
        );
        *energy = any.0;
        (any.1, any.2)
    }
    /// Replaces [`Enhanced::paid_move`] when the model checker runs the specification: returns the value that the code got for
    /// equal arguments.
    pub fn paid_move(
        _: &Enhanced,
        energy: Int,
        mass: Int,
        drive: Int,
        wanted: Int,
    ) -> (Int, Int, Int) {
        let any: (i64, i32, i32) = (kani::any(), kani::any(), kani::any());
        let told = MOVE.again(
            words([energy, mass, drive, wanted]),
            [any.0, any.1.into(), any.2.into()],
        );
        (told[0].into(), told[1].into(), told[2].into())
    }

    /// Replaces [`Number::passivity_step`] when the model checker runs: any energy and force. The law limits the energy to its cap.
    pub fn passivity_step(
        e: <Fixed32 as Number>::Energy,
        f: <Fixed32 as Number>::Signal,
        d: <Fixed32 as Number>::Signal,
    ) -> (<Fixed32 as Number>::Energy, <Fixed32 as Number>::Signal) {
        let cap = Fixed32::energy_cap();
        assert!(f >= 0 && e >= 0 && e <= cap.0, "what p11_passive assumes");
        let any = (
            Fixed32::any_energy(&mut Symbolic),
            Fixed32::any_force(&mut Symbolic),
        );
        STEP.told(
            words([e.to_bits().into(), f.to_bits().into(), d.to_bits().into()]),
            [any.0.min(cap).0.to_bits(), any.1.0.to_bits().into(), 0],
        );
        (any.0.0, any.1.0)
    }
    /// Replaces [`crate::spec::tdpa::passive`] when the model checker runs the specification: returns the value that the code got
    /// for equal arguments.
    pub fn passive(energy: Int, wanted: Int, moved: Int, _: Int) -> (Int, Int) {
        let any: (i64, i32) = (kani::any(), kani::any());
        let told = STEP.again(words([energy, wanted, moved]), [any.0, any.1.into(), 0]);
        (told[0].into(), told[1].into())
    }

    /// Replaces [`VirtualMass::coupling`] when the model checker runs the code: returns any value, and the same value for equal
    /// arguments.
    pub fn coupling<N: Format>(
        _: &VirtualMass<N>,
        mass: &MassState<N>,
        e: Position<N>,
        moved: Position<N>,
    ) -> Force<N> {
        let any = N::any_force(&mut Symbolic);
        COUPLING.told(
            words([at(mass.position), at(mass.moved), at(e), at(moved)]),
            [N::of_signal(any.0), 0, 0],
        );
        any
    }
    /// Replaces [`Enhanced::coupled`] when the model checker runs the specification: returns the value that the code got for equal
    /// arguments.
    pub fn coupled(_: &Enhanced, mass: Int, mass_moved: Int, e: Int, moved: Int) -> Int {
        let any: i32 = kani::any();
        COUPLING.again(words([mass, mass_moved, e, moved]), [any.into(), 0, 0])[0].into()
    }

    /// Replaces [`Guard::booked`], the sum of the energy account, when the model checker runs. `refines::w32::p11_guard_booked`
    /// proves that the sum stays far from the ends of the format.
    pub fn booked<N: Format>(
        _: &Guard<N>,
        state: &GuardState<N>,
        moved: Position<N>,
        distance: Position<N>,
        before_change: Position<N>,
    ) -> Energy<N> {
        assert!(distance == moved.modulus(), "what p11_guard_booked assumes");
        let any = N::any_energy(&mut Symbolic);
        kani::assume(N::of_energy(any.0) >= N::of_energy(N::energy_cap().0).wrapping_neg());
        let question = [
            N::of_energy(state.account.0).into(),
            force(state.force),
            force(state.older),
            at(moved),
            at(before_change),
        ];
        if specifies() {
            let again = BOOKED.again(words(question), [N::of_energy(any.0), 0, 0])[0];
            let same = N::any_energy(&mut Symbolic);
            kani::assume(N::of_energy(same.0) == again);
            return same;
        }
        BOOKED.told(words(question), [N::of_energy(any.0), 0, 0]);
        any
    }
    /// Replaces [`crate::spec::guard::Guard::booked`] when the model checker runs the specification: returns the value that the
    /// code got for equal arguments.
    pub fn specified_booked(
        _: &crate::spec::guard::Guard,
        m: &crate::spec::guard::Memory,
        moved: Int,
        before_change: Int,
    ) -> Int {
        let any: i64 = kani::any();
        BOOKED.again(
            words([m.account, m.force, m.older, moved, before_change]),
            [any, 0, 0],
        )[0]
        .into()
    }

    /// Replaces the hand-over to the virtual mass, which cannot occur in the property's case, so that the model checker does not
    /// follow its code.
    pub fn no_hand_over<N: Format>(_: &EnhancedSfa<N>, _: &mut EnhancedState<N>) {
        assert!(false, "the case has no hand-over");
        kani::assume(false);
    }
    /// Replaces the specification's hand-over to the virtual mass, which cannot occur in the property's case.
    pub fn no_specified_hand_over(_: &Enhanced, m: &Memory) -> Memory {
        assert!(false, "the case has no hand-over");
        kani::assume(false);
        *m
    }
}
