//! The cases of the test vectors: every control law, with the options that take other paths through its code.

use touchstone_control::settings::{FilterSettings, VelocitySettings};
use touchstone_control::{
    FirstContact, IdealStep, LawKind, ObserverForm, OffsetUpdate, Regulate, Settings, Si,
    VelocityKind,
};

/// A test case: a control law with its settings.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Short name of the case, without spaces.
    pub name: &'static str,
    /// The settings of the control law: those of the thesis with the change that the case's name states.
    pub settings: Settings,
}

/// All cases of the test vectors.
#[must_use]
pub fn cases() -> [Case; 19] {
    let base = Settings::thesis();
    let of = |name, law| Case {
        name,
        settings: Settings { law, ..base },
    };
    let tdpa = |name, observer, count_device_damping| Case {
        name,
        settings: Settings {
            law: LawKind::Tdpa,
            observer,
            count_device_damping,
            ..base
        },
    };
    let damped = |name, from| Case {
        name,
        settings: Settings {
            law: LawKind::SpringDamper,
            virtual_damping: Si::lit("0.0002"),
            velocity: VelocitySettings {
                from,
                ..base.velocity
            },
            ..base
        },
    };
    let enhanced = |name, settings| Case { name, settings };
    [
        of("spring", LawKind::Spring),
        damped("spring-damper", VelocityKind::Told),
        damped("spring-damper-filtered", VelocityKind::Filtered),
        damped("spring-damper-foaw", VelocityKind::Foaw),
        damped("spring-damper-kalman", VelocityKind::Kalman),
        tdpa("tdpa-exact", ObserverForm::Exact, false),
        tdpa("tdpa-thesis", ObserverForm::Thesis, false),
        tdpa("tdpa-exact-damped", ObserverForm::Exact, true),
        tdpa("tdpa-thesis-damped", ObserverForm::Thesis, true),
        of("fba", LawKind::Fba),
        of("sfa", LawKind::Sfa),
        Case {
            name: "sfa-keep-force",
            settings: Settings {
                law: LawKind::Sfa,
                first_contact: FirstContact::KeepForce,
                ..base
            },
        },
        of("sfa-continuous", LawKind::SfaContinuous),
        enhanced("enhanced", base),
        enhanced(
            "enhanced-no-credit",
            Settings {
                energy_credit: Si::ZERO,
                ..base
            },
        ),
        enhanced(
            "enhanced-thesis",
            Settings {
                observer: ObserverForm::Thesis,
                offset_update: OffsetUpdate::Inward,
                ideal_step: IdealStep::Position,
                ..base
            },
        ),
        enhanced(
            "enhanced-keep-mass",
            Settings {
                first_contact: FirstContact::KeepForce,
                regulate: Regulate::Mass,
                ..base
            },
        ),
        enhanced(
            "enhanced-compensated",
            Settings {
                regulate: Regulate::MassCompensated,
                offset_update: OffsetUpdate::TurnInward,
                filter: FilterSettings {
                    stiffness: Si::const_from_int(10),
                    ..base.filter
                },
                ..base
            },
        ),
        // The default filter's coefficients are whole numbers, whose products need no rounding. These have fractions.
        enhanced(
            "enhanced-fractions",
            Settings {
                k_desired: Si::lit("7.3"),
                energy_credit: Si::lit("0.0007"),
                filter: FilterSettings {
                    mass: Si::lit("0.0000041"),
                    stiffness: Si::lit("1.7"),
                    damping: Si::lit("0.00013"),
                    ground_damping: Si::lit("0.0123"),
                },
                ..base
            },
        ),
    ]
}
