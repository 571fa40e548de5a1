//! Converts coefficients and memory of each law and of the guard, at 32 or 8 bits, to the specification's types.

macro_rules! specified {
    ($(#[doc = $doc:literal])* $module:ident, $number:ident, $spec:path) => {
        $(#[doc = $doc])*
        pub mod $module {
            use $spec as spec;
            use spec::Int;
            pub use spec::times;
            use touchstone_control::law::{
                self, Contact, EnhancedSfa, EnhancedState, FbaState, SfaState, TdpaState,
            };
            use touchstone_control::{
                Compliance, Energy, FirstContact, Force, Guard, GuardState, ObserverForm, OffsetUpdate,
                Position, Ratio, Regulate, Stiffness, Tension,
            };

            type N = touchstone_control::$number;

            /// Most energy that a law stores, in steps of the energy format: half of the format's largest number.
            pub const ENERGY_CAP: Int = 1 << (2 * spec::BITS - 2);

            /// A stiffness as an integer, in steps of the number format.
            #[must_use]
            pub fn gain(k: Stiffness<N>) -> Int {
                Int::from(k.0.to_bits())
            }
            /// A force as an integer, in steps of the number format.
            #[must_use]
            pub fn force(f: Force<N>) -> Int {
                Int::from(f.0.to_bits())
            }
            /// A position as an integer, in steps of the number format.
            #[must_use]
            pub fn position(x: Position<N>) -> Int {
                Int::from(x.0.to_bits())
            }
            /// An energy as an integer, in steps of the number format.
            #[must_use]
            pub fn energy(e: Energy<N>) -> Int {
                Int::from(e.0.to_bits())
            }
            /// A tension (gain times signal) as an integer, in steps of the number format.
            #[must_use]
            pub fn tension(t: Tension<N>) -> Int {
                Int::from(t.0)
            }
            /// A ratio as an integer, in steps of the number format.
            #[must_use]
            pub fn ratio(r: Ratio<N>) -> Int {
                Int::from(r.0.to_bits())
            }
            /// A compliance as an integer, in steps of the number format.
            #[must_use]
            pub fn compliance(c: Compliance<N>) -> Int {
                Int::from(c.0.to_bits())
            }

            /// The specification's tick of the spring.
            pub use spec::sfa::spring_tick as spring;
            /// The specification of the thesis' passivity controller, which limits a force by stored energy.
            pub use spec::tdpa::passive;

            /// Converts a TDPA law (time-domain passivity) to the specification's type.
            #[must_use]
            pub fn tdpa(law: &law::Tdpa<N>) -> spec::tdpa::Tdpa {
                spec::tdpa::Tdpa {
                    desired: gain(law.desired),
                    exact: law.observer == ObserverForm::Exact,
                    device_damping: gain(law.device_damping),
                    limit: force(law.limit),
                    energy_cap: ENERGY_CAP,
                }
            }
            /// Converts the memory of a TDPA law (time-domain passivity) to the specification's type.
            #[must_use]
            pub fn of_tdpa(state: &TdpaState<N>) -> spec::tdpa::Memory {
                spec::tdpa::Memory {
                    force: force(state.force),
                    energy: energy(state.energy),
                    inside: state.inside,
                }
            }

            /// Converts an FBA law (force bounding) to the specification's type. The factor of the force bound belongs to the
            /// damping as it is stored.
            #[must_use]
            pub fn fba(law: &law::Fba<N>) -> spec::fba::Fba {
                spec::fba::Fba {
                    desired: gain(law.desired),
                    device_damping: gain(law.device_damping),
                    bound: spec::fba::Fba::bound_of(gain(law.device_damping)),
                    limit: force(law.limit),
                    energy_cap: ENERGY_CAP,
                }
            }
            /// Converts the memory of an FBA law (force bounding) to the specification's type.
            #[must_use]
            pub fn of_fba(state: &FbaState<N>) -> spec::fba::Memory {
                spec::fba::Memory {
                    force: force(state.force),
                    energy: energy(state.energy),
                    inside: state.inside,
                }
            }

            /// Converts an SFA law (successive force augmentation), original or continuous, to the specification's type.
            #[must_use]
            pub fn sfa(law: &law::Sfa<N>) -> spec::sfa::Sfa {
                spec::sfa::Sfa {
                    desired: gain(law.desired),
                    soft: gain(law.soft),
                    gain: ratio(law.gain),
                    compliance: compliance(law.compliance),
                    update: match law.update {
                        OffsetUpdate::TurnInward => spec::sfa::Update::TurnInward,
                        OffsetUpdate::Inward => spec::sfa::Update::Inward,
                        OffsetUpdate::EveryTick => spec::sfa::Update::EveryTick,
                    },
                    keep_force: law.first_contact == FirstContact::KeepForce,
                    limit: force(law.limit),
                }
            }
            /// Converts the memory of an SFA law (successive force augmentation) to the specification's type.
            #[must_use]
            pub fn of_sfa(state: &SfaState<N>) -> spec::sfa::Memory {
                spec::sfa::Memory {
                    inside: state.contact != Contact::Free,
                    augmenting: state.contact == Contact::Augmenting,
                    last: position(state.last),
                    before_last: position(state.before_last),
                    offset: position(state.offset),
                    force: force(state.force),
                }
            }

            /// Converts an enhanced law to the specification's type. `series` is the sum of coupling and soft stiffness, of which
            /// the code keeps only a prepared divisor (stored reciprocal).
            #[must_use]
            pub fn enhanced(law: &EnhancedSfa<N>, series: Int) -> spec::enhanced::Enhanced {
                spec::enhanced::Enhanced {
                    desired: gain(law.desired),
                    target: gain(law.target),
                    damper: gain(law.damper),
                    soft: gain(law.soft),
                    compliance: compliance(law.compliance),
                    of_ideal: compliance(law.augmentation.of_ideal),
                    of_force: compliance(law.augmentation.of_force),
                    of_penetration: ratio(law.augmentation.of_penetration),
                    at_hip: law.regulate == Regulate::Hip,
                    every_tick: law.update == OffsetUpdate::EveryTick,
                    exact: law.observer == ObserverForm::Exact,
                    keep_force: law.first_contact == FirstContact::KeepForce,
                    inertia: gain(law.mass.inertia),
                    coupling: gain(law.mass.stiffness),
                    damping: gain(law.mass.damping),
                    total: gain(law.mass.total),
                    series,
                    credit: energy(law.credit),
                    energy_cap: ENERGY_CAP,
                    limit: force(law.limit),
                }
            }
            /// Converts the enhanced law's memory to the specification's type.
            #[must_use]
            pub fn of_enhanced(state: &EnhancedState<N>) -> spec::enhanced::Memory {
                spec::enhanced::Memory {
                    contact: match state.contact {
                        Contact::Free => spec::enhanced::Contact::Free,
                        Contact::First => spec::enhanced::Contact::First,
                        Contact::Augmenting => spec::enhanced::Contact::Augmenting,
                    },
                    last: position(state.last),
                    force: force(state.force),
                    energy: energy(state.energy),
                    mass: position(state.augmented.mass.position),
                    mass_moved: position(state.augmented.mass.moved),
                    offset: position(state.augmented.offset),
                    at_mass: force(state.augmented.at_mass),
                }
            }

            /// Converts the guard to the specification's type.
            #[must_use]
            pub fn guard(law: &Guard<N>) -> spec::guard::Guard {
                spec::guard::Guard {
                    capacity: energy(law.capacity),
                    refill: energy(law.refill),
                    damping: gain(law.damping),
                    furthest: position(law.furthest),
                    count: position(law.count),
                    late: ratio(law.late),
                    stray: compliance(law.stray),
                    slack: position(law.slack),
                    per_reach: gain(law.per_reach),
                    in_flight: position(law.in_flight),
                    overrun: compliance(law.overrun),
                }
            }
            /// Converts the guard's memory to the specification's type.
            #[must_use]
            pub fn of_guard(state: &GuardState<N>) -> spec::guard::Memory {
                spec::guard::Memory {
                    account: energy(state.account),
                    force: force(state.force),
                    older: force(state.older),
                }
            }
        }
    };
}

specified!(
    /// The conversions of this file at 32 bits, the width of the firmware.
    at32, Fixed32, crate::spec
);
specified!(
    /// The conversions of this file at 8 bits.
    at8, Fixed8, crate::spec::at8
);
