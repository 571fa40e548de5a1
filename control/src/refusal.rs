//! Why settings are refused, and what an accepted setting is warned about.

use crate::{Choice as _, LawKind, Si};
use core::fmt;

macro_rules! fields {
    (
        timing { $($timing:tt)* } wall { $($wall:tt)* } law { $($law:tt)* }
        $($(#[$doc:meta])* $group:ident $Group:ident { $($rows:tt)* })+
    ) => {
        fields! { @rows
            (timing) { $($timing)* }
            (wall) { $($wall)* }
            (law) { $($law)* }
            $((law $group) { $($rows)* })+
        }
        fields! { @checks Settings { $($timing)* $($wall)* $($law)* } }
        $(fields! { @checks $Group { $($rows)* } })+
    };
    (@rows $($table:tt {
        $($variant:ident $field:ident, $name:ident: $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+
    })+) => {
        /// Names one setting of the control law.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Field {
            $($(#[doc = concat!("For ", $about)] $variant,)+)+
        }

        impl Field {
            /// All settings of the control law, in the order of the table of settings.
            pub const ALL: &[Field] = &[$($(Field::$variant,)+)+];

            /// The path of the setting in scene files and on devices, for example `wall.k_desired_n_m_per_rad`.
            #[must_use]
            pub fn path(self) -> &'static str {
                match self {
                    $($(Field::$variant => crate::setting_path!($table $name),)+)+
                }
            }
        }
    };
    (@checks $Table:ident {
        $($variant:ident $field:ident, $name:ident: $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+
    }) => {
        impl crate::settings::$Table {
            /// Checks every number against its own range in the table of settings.
            #[inline]
            pub(crate) fn check_ranges(&self) -> Result<(), SettingsError> {
                $(fields!(@check (self) $field, $variant: $kind $range);)+
                Ok(())
            }
        }
    };
    (@check ($($place:tt)+) $field:ident, $variant:ident: number ($min:literal, $max:literal)) => {
        within(Field::$variant, $($place)+.$field, const { Si::lit($min) }, const { Si::lit($max) })?
    };
    (@check ($($place:tt)+) $field:ident, $variant:ident: u32 ($min:literal, $max:literal)) => {
        within(
            Field::$variant,
            Si::saturating_from_num($($place)+.$field),
            const { Si::const_from_int($min) },
            const { Si::const_from_int($max) },
        )?
    };
    // A choice or a flag has only allowed values, so it needs no check.
    (@check $place:tt $field:ident, $variant:ident: $kind:ident $range:tt) => {};
}
crate::law_settings!(fields);

#[inline]
pub(crate) fn within(field: Field, value: Si, min: Si, max: Si) -> Result<(), SettingsError> {
    if value < min || value > max {
        Err(SettingsError::OutOfRange {
            field,
            value,
            min,
            max,
        })
    } else {
        Ok(())
    }
}

/// Why settings are refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SettingsError {
    /// The value is outside its physical range.
    OutOfRange {
        /// The setting that was refused.
        field: Field,
        /// The refused value in SI units.
        value: Si,
        /// Smallest allowed value, SI.
        min: Si,
        /// Largest allowed value, SI.
        max: Si,
    },
    /// A setting, or the coefficient that is computed from it, does not fit the number format.
    OutOfFormat {
        /// The setting that was refused.
        field: Field,
        /// The coefficient in SI units, for example mass over squared control period (`m/T²`) for the virtual mass.
        value: Si,
        /// Name of the number format.
        format: &'static str,
    },
    /// The desired stiffness `k_de` is at or above the coupling stiffness `k_f`. Then the target stiffness of equation (3.5) of the
    /// thesis, with which the hand would feel `k_de`, has no positive solution.
    NoCompensation {
        /// Desired stiffness of the wall, `k_de`.
        k_desired: Si,
        /// Stiffness `k_f` of the spring between hand and virtual mass.
        k_filter: Si,
    },
    /// The encoder's resolution is too coarse for the guard's energy account.
    TooCoarse {
        /// Angle or length of an encoder count, rad (m).
        count: Si,
        /// Largest allowed angle or length of an encoder count, rad (m).
        coarsest: Si,
    },
    /// The build has no such law: the crate's feature for it is off.
    LawLeftOut {
        /// The law that the settings choose.
        law: LawKind,
    },
}

impl SettingsError {
    /// Whether the error concerns the value of this setting.
    #[must_use]
    pub fn at(&self, setting: Field) -> bool {
        match self {
            Self::OutOfRange { field, .. } | Self::OutOfFormat { field, .. } => *field == setting,
            Self::NoCompensation { .. } => setting == Field::KDesired,
            Self::TooCoarse { .. } => false,
            Self::LawLeftOut { .. } => setting == Field::Law,
        }
    }
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange {
                field,
                value,
                min,
                max,
            } => {
                write!(f, "{} = {value} is outside {min} to {max}", field.path())
            }
            Self::OutOfFormat {
                field,
                value,
                format,
            } => {
                write!(
                    f,
                    "{}: its coefficient {value:.6} does not fit the number format {format}",
                    field.path()
                )
            }
            Self::NoCompensation {
                k_desired,
                k_filter,
            } => write!(
                f,
                "law.regulate = mass-compensated needs {} below {} (thesis 3.5), but {k_desired} >= {k_filter}",
                Field::KDesired.path(),
                Field::FilterStiffness.path()
            ),
            Self::TooCoarse { count, coarsest } => write!(
                f,
                "{} needs counts of the encoder of at most {coarsest:.2} rad, and these are {count:.6} rad",
                Field::Guard.path()
            ),
            Self::LawLeftOut { law } => {
                // `sfa` and `sfa-continuous` have the same crate feature.
                let feature = match law {
                    LawKind::SfaContinuous => LawKind::Sfa,
                    one => *one,
                };
                write!(
                    f,
                    "{} = {}: this build has no such law: build it with the feature `{}`, or choose another law",
                    Field::Law.path(),
                    law.word(),
                    feature.word()
                )
            }
        }
    }
}

// This implementation computes nothing, so the model checker's build leaves it out.
#[cfg(not(kani))]
impl core::error::Error for SettingsError {}

/// A passivity bound that the settings exceed, so that the wall may give a hand more energy than it took; or a guard setting that
/// softens the wall. The settings are accepted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Warning {
    /// The soft stiffness `k_v` is above the critical stiffness `k_c`: the soft spring alone already needs more damping than the
    /// device has.
    SoftAboveCritical {
        /// Stiffness of the soft spring, `k_v`.
        k_soft: Si,
        /// Critical stiffness `k_c = 2 c_i/T`, up to which the device's damping `c_i` makes a spring passive at the control period
        /// `T`.
        k_critical: Si,
    },
    /// The coupling stiffness `k_f` of the virtual mass is above `2 (c_i - c_f - B)/T`, so the sampled coupling can give energy to
    /// a hand. `c_i` is the device's, `c_f` the coupling's and `B` the virtual damping, `T` the control period.
    CouplingAboveBound {
        /// Stiffness `k_f` of the spring between hand and virtual mass.
        k_filter: Si,
        /// Largest passive coupling stiffness `2 (c_i - c_f - B)/T`, from the dampings of device, coupling and law and the control
        /// period `T`.
        bound: Si,
    },
    /// The ground damping `c_env` of the virtual mass is below `k_v T/2` (soft stiffness, control period). The wall's force is
    /// calculated from the mass' previous position, so it may inject energy into the mass.
    GroundDampingBelowBound {
        /// Damping of the virtual mass to ground over the control period: `c_env/T`.
        ground_damping_per_tick: Si,
        /// Smallest passive ground damping per tick: half the soft stiffness, `k_v/2`.
        bound: Si,
    },
    /// The energy observer has the form of the thesis, which counts the energy leak of sampling with the wrong sign.
    ThesisObserver,
    /// The time-domain passivity law sums energy over estimated displacements, which differ from those of the real device.
    ObservesEstimates,
    /// Each contact is lent energy: the wall may give the hand this much more than it took.
    EnergyCredit {
        /// The energy lent to each contact, J.
        credit: Si,
    },
    /// The guard's largest energy account is too small for the force limit: even a full account allows less force. So a hard press
    /// meets a softer wall.
    GuardSoftensAtForceLimit {
        /// Most energy that the guard's account holds, J.
        capacity: Si,
        /// Energy that the account would have to hold to allow the force limit, J.
        needed: Si,
    },
    /// The guard's refill power is 0. Rounding and jitter of one encoder count then use up the energy account in time, even if the
    /// hand holds still.
    GuardNeverRefilled,
}

impl Warning {
    /// Whether the warning is about energy that a hand can get out of the wall. An energy guard bounds that energy for any law, so
    /// the warning matters only without a guard.
    #[must_use]
    pub fn is_answered_by_guard(&self) -> bool {
        !matches!(
            self,
            Self::ObservesEstimates
                | Self::GuardSoftensAtForceLimit { .. }
                | Self::GuardNeverRefilled
        )
    }

    /// The setting that the warning is about.
    #[must_use]
    pub fn field(&self) -> Field {
        match self {
            Self::SoftAboveCritical { .. } => Field::KSoft,
            Self::CouplingAboveBound { .. } => Field::FilterStiffness,
            Self::GroundDampingBelowBound { .. } => Field::FilterGroundDamping,
            Self::ThesisObserver => Field::Observer,
            Self::ObservesEstimates => Field::States,
            Self::EnergyCredit { .. } => Field::EnergyCredit,
            Self::GuardSoftensAtForceLimit { .. } => Field::GuardCapacity,
            Self::GuardNeverRefilled => Field::GuardRefill,
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SoftAboveCritical { k_soft, k_critical } => write!(
                f,
                "k_v = {k_soft:.6} is above k_c = 2 c_i/T = {k_critical:.6}: the soft spring is then not stable by itself, and nothing below it is"
            ),
            Self::CouplingAboveBound { k_filter, bound } => write!(
                f,
                "k_f = {k_filter:.6} is above 2 (c_i - c_f - B)/T = {bound:.6}: filter and damper are then passive only with the hand's help"
            ),
            Self::GroundDampingBelowBound {
                ground_damping_per_tick,
                bound,
            } => write!(
                f,
                "c_env/T = {ground_damping_per_tick:.6} is below k_v/2 = {bound:.6}: the virtual mass may then gain energy from its own delay"
            ),
            Self::ThesisObserver => write!(
                f,
                "observer = thesis counts the sampling leak with the wrong sign: its E >= 0 says nothing about the true energy"
            ),
            Self::ObservesEstimates => write!(
                f,
                "states = estimated: the observer of tdpa then counts estimated displacements, not those of the port, and lets a wall ring that it would hold"
            ),
            Self::EnergyCredit { credit } => write!(
                f,
                "energy_credit = {credit:.6} J: one contact may give that much more than it took; 0 lends nothing and shows a resting hand at most about 2 k_f"
            ),
            Self::GuardSoftensAtForceLimit { capacity, needed } => write!(
                f,
                "capacity = {capacity:.6} J is less than the {needed:.6} J that the force limit needs: harder presses meet a softer wall; raise it, or lower the force limit or the guard's overspeed"
            ),
            Self::GuardNeverRefilled => write!(
                f,
                "refill = 0: chatter of one count uses the guard's account up in time; 0.0005 W lasts for ever"
            ),
        }
    }
}
