//! Every control law with every option that changes what it computes, for tests over all of them.

use touchstone_control::settings::FilterSettings;
use touchstone_control::{
    FirstContact, IdealStep, LawKind, ObserverForm, OffsetUpdate, Regulate, Settings,
};

const OBSERVERS: [ObserverForm; 2] = [ObserverForm::Exact, ObserverForm::Thesis];
const FIRST_CONTACTS: [FirstContact; 2] = [FirstContact::KeepForce, FirstContact::ZeroOffset];
const UPDATES: [OffsetUpdate; 3] = [
    OffsetUpdate::TurnInward,
    OffsetUpdate::Inward,
    OffsetUpdate::EveryTick,
];
const IDEAL_STEPS: [IdealStep; 2] = [IdealStep::Position, IdealStep::Force];
const REGULATES: [Regulate; 3] = [Regulate::Mass, Regulate::MassCompensated, Regulate::Hip];

/// Every control law with every option, based on the given settings; each with a name for messages.
///
/// One option of the enhanced law (SFA with a virtual mass), the compensated regulator, needs a desired stiffness `k_de` below the
/// coupling stiffness `k_f`. For this option the coupling stiffness is set to twice `k_de`.
#[must_use]
pub fn all(base: &Settings) -> Vec<(String, Settings)> {
    let mut variants = Vec::new();
    let mut add = |settings: Settings| {
        let Settings {
            law,
            observer,
            count_device_damping,
            first_contact,
            regulate,
            offset_update,
            ideal_step,
            ..
        } = settings;
        let choices = match law {
            LawKind::Spring | LawKind::SpringDamper | LawKind::Fba => String::new(),
            LawKind::Tdpa => format!(" {observer:?} damping counted: {count_device_damping}"),
            LawKind::Sfa | LawKind::SfaContinuous => format!(" {first_contact:?}"),
            LawKind::EnhancedSfa => {
                format!(
                    " {observer:?} {first_contact:?} {regulate:?} {offset_update:?} step by {ideal_step:?}"
                )
            }
        };
        variants.push((format!("{law:?}{choices}"), settings));
    };
    for law in [LawKind::Spring, LawKind::SpringDamper, LawKind::Fba] {
        add(Settings { law, ..*base });
    }
    for observer in OBSERVERS {
        for count_device_damping in [false, true] {
            add(Settings {
                law: LawKind::Tdpa,
                observer,
                count_device_damping,
                ..*base
            });
        }
    }
    for first_contact in FIRST_CONTACTS {
        for law in [LawKind::Sfa, LawKind::SfaContinuous] {
            add(Settings {
                law,
                first_contact,
                ..*base
            });
        }
        for observer in OBSERVERS {
            for regulate in REGULATES {
                for offset_update in UPDATES {
                    let stiffness = if regulate == Regulate::MassCompensated {
                        base.k_desired + base.k_desired
                    } else {
                        base.filter.stiffness
                    };
                    let filter = FilterSettings {
                        stiffness,
                        ..base.filter
                    };
                    for ideal_step in IDEAL_STEPS {
                        add(Settings {
                            law: LawKind::EnhancedSfa,
                            observer,
                            first_contact,
                            regulate,
                            offset_update,
                            ideal_step,
                            filter,
                            ..*base
                        });
                    }
                }
            }
        }
    }
    variants
}
