//! The one table of the control law's settings. Each row has path, type, range, default, unit, and a description for people.
//!
//! The rows generate the fields of [`crate::Settings`] with their defaults, and the variants of [`crate::Field`] with their range
//! checks. They also generate the settings of a device, the fields of a scene file, and the output of `touchstone config schema`. A
//! row has this form:
//!
//! ```text
//! Variant field, name: kind(range) = default, "unit", "words";
//! ```
//!
//! - `field` is the name in [`crate::Settings`], where the unit is that of an angle or of a length, depending on the device. `name`
//!   is the last part of the path in scene files and on devices; it ends in the unit for one degree of freedom.
//! - `kind` is one of `number(least, most)` with exact decimal texts, `u32(least, most)`, `flag()`, `choice(Enum)`, and
//!   `choice_of_law(Enum)`. A scene may leave out a `choice_of_law`; then the value that belongs to the law is used.
//! - `words` is the description that messages show after "give" and before the unit.
//!
//! `timing`, `wall` and `law` are tables of a scene and of a device, and their fields are fields of [`crate::Settings`] itself. The
//! sections after them are groups: a group is a struct, a field of [`crate::Settings`], and the table `law.GROUP`.
//!
//! The texts are constants, so a program contains only the texts that it uses.

/// Passes the table of settings to another macro, which generates code from it.
#[macro_export]
macro_rules! law_settings {
    ($with:ident $($more:tt)*) => {
        $with! {
            $($more)*
            timing {
                RateHz rate_hz, rate_hz: u32(1, 100_000) = 1000, "Hz", "the control rate";
            }
            wall {
                KDesired k_desired, k_desired_n_m_per_rad: number("0", "500000") = "5", "N·m/rad",
                    "the desired stiffness k_de";
            }
            law {
                Law law, kind: choice(LawKind) = EnhancedSfa, "",
                    "the control law";
                // k_v, B, the offset's fractions a, b and c, the filter and the estimator were tuned together over 216 device
                // variants (grips, encoders, inertias, dampings and delays), for k_de of 5 to 20 N·m/rad: `touchstone scorecard
                // thesis-knob --family`. The thesis' own values are in `thesis_settings`.
                KSoft k_soft, k_soft_n_m_per_rad: number("0.01", "500000") = "19.8", "N·m/rad",
                    "the soft stiffness k_v (stable by itself up to k_c = 2 c_i/T)";
                // Thesis §5.1, by the thesis' Algorithm 2.1: the critical stiffness k_c is then 1 N·m/rad at 1 kHz.
                DeviceDamping device_damping, device_damping_n_m_s_per_rad: number("0", "10000") = "0.0005", "N·m·s/rad",
                    "the damping c_i that device and fingertip are trusted to have";
                // Far above the bound for passivity at the hand, b - K T/2 (device damping b, wall stiffness K, control period
                // T). With estimated states so much damping makes the loop stable, and the energy guard bounds the energy that a
                // hand can get out.
                VirtualDamping virtual_damping, virtual_damping_n_m_s_per_rad: number("0", "10000") = "0.03", "N·m·s/rad",
                    "the virtual damping B of the laws spring-damper and enhanced-sfa";
                Observer observer, observer: choice(ObserverForm) = Exact, "",
                    "the form of the energy observer (thesis counts the sampling leak with the wrong sign)";
                CountDeviceDamping count_device_damping, count_device_damping: flag() = false, "",
                    "whether tdpa counts c_i as dissipation (2.6)";
                FirstContact first_contact, first_contact: choice_of_law(FirstContact) = ZeroOffset, "",
                    "what happens to the force when the first contact ends";
                // The only choice with which the hand feels k_de for every coupling k_f.
                Regulate regulate, regulate: choice(Regulate) = Hip, "",
                    "which stiffness the offset regulates";
                // With `turn-inward` and `inward` the offset changes on inward motion only. While the hand rests, only jitter of
                // the measured position changes the offset, and an offset that is too large stays.
                OffsetUpdate offset_update, offset_update: choice(OffsetUpdate) = EveryTick, "",
                    "when the enhanced law changes the offset";
                // With this choice one value of step_of_ideal serves all stiffnesses.
                IdealStep ideal_step, ideal_step: choice(IdealStep) = Force, "",
                    "what the offset's ideal step supposes to stay";
                StepOfIdeal step_of_ideal, step_of_ideal_per_ms: number("0", "1") = "0.0232", "",
                    "the step of the offset each millisecond as a share of the ideal one, c of (3.8)";
                LimitOfForce limit_of_force, limit_of_force_per_ms: number("0", "1") = "0.11", "",
                    "the largest step of the force each millisecond as a share of the force, b of (3.9)";
                LimitOfPenetration limit_of_penetration, limit_of_penetration_per_ms: number("0", "1") = "0.0115", "",
                    "the largest step of the offset each millisecond as a share of the penetration, a of (3.11)";
                // Four times the energy that the thesis' coupling k_f of 1 N·m/rad stores under the thesis' press F of 0.1 N·m:
                // F²/(2 k_f) = 5 mJ.
                EnergyCredit energy_credit, energy_credit_j: number("0", "1000") = "0.02", "J",
                    "the energy that is lent to a contact, which it may give beyond what it took (0: nothing is lent)";
                // The torque limit of the thesis' knob, five times a typical push in the thesis.
                ForceLimit force_limit, force_limit_n_m: number("0.000001", "100") = "0.5", "N·m",
                    "the largest force that is ever commanded";
                // An off-centre magnet of a magnetic encoder causes 0.2 to 1 degree (0.0035 to 0.017 rad).
                PositionError position_error, position_error_rad: number("0", "0.05") = "0", "rad",
                    "the largest error of a measured angle besides the rounding to counts, which the energy guard allows for";
                States states, states: choice(StatesKind) = Estimated, "",
                    "what the law is told of position and velocity (estimated: predicted for when its force acts)";
            }
            /// The virtual mass of the enhanced law between the hand's point (HIP) and the wall, given by physical parameters:
            /// mass, stiffness and dampings (thesis §3.5).
            filter FilterSettings {
                FilterMass mass, mass_kg_m2: number("0", "10000") = "0.000009", "kg·m²",
                    "the filter's virtual mass";
                // Far above the bound of sampling, 2 (c_i - c_f - B)/T: the energy guard bounds the energy that a hand can gain
                // from the sampled coupling.
                FilterStiffness stiffness, stiffness_n_m_per_rad: number("0.01", "500000") = "280", "N·m/rad",
                    "the coupling stiffness k_f (passive by itself up to 2 (c_i - c_f - B)/T)";
                FilterDamping damping, damping_n_m_s_per_rad: number("0", "10000") = "0.00561", "N·m·s/rad",
                    "the coupling damping c_f between HIP and virtual mass";
                FilterGroundDamping ground_damping, ground_damping_n_m_s_per_rad: number("0", "10000") = "0.01027", "N·m·s/rad",
                    "the damping c_env from virtual mass to ground (at least k_v T/2)";
            }
            /// The state estimator before the law, for `law.states = "estimated"`. It has inertia and damping values of its own,
            /// because tuned values can give better estimates than the measured ones.
            estimator EstimatorSettings {
                EstimatorBandwidth bandwidth_hz, bandwidth_hz: number("0.002", "20000") = "80", "Hz",
                    "the bandwidth with which the estimator believes what is measured (a 500th to a fifth of the control rate)";
                EstimatorInertia inertia, inertia_kg_m2: number("0", "10000") = "0.0000691", "kg·m²",
                    "the inertia that the estimator supposes of device and knob, without the hand";
                EstimatorDamping damping, damping_n_m_s_per_rad: number("0", "10000") = "0.0004", "N·m·s/rad",
                    "the damping that the estimator supposes of the device, without the hand";
                EstimatorDelay delay_s, delay_s: number("0", "2") = "0.001175", "s",
                    "the time from a sample until its force acts, over which the estimator predicts (at most two ticks)";
            }
            /// The energy guard after the law, which bounds the energy that any hand can get out of the device.
            guard GuardSettings {
                Guard on, on: flag() = true, "",
                    "whether the energy guard stands after the law";
                // The energy that the force limit of 0.5 N·m needs for every displacement at speeds up to 60 rad/s, if forces act
                // up to 0.4 ticks late.
                GuardCapacity capacity, capacity_j: number("0", "16") = "0.045", "J",
                    "the energy C that a hand may get out at once";
                // Too little power for a hand to notice, and enough to pay for the jitter of a hand that holds still.
                GuardRefill refill, refill_w: number("0", "1") = "0.0005", "W",
                    "the power P that a hand may get out again and again";
                GuardDamping damping, damping_n_m_s_per_rad: number("0", "1000") = "0.0004", "N·m·s/rad",
                    "the damping of the device alone, without a hand, as measured";
                GuardShare share_of_damping, share_of_damping: number("0", "1") = "0.8", "",
                    "the share of that damping that is trusted to be there";
                GuardOverspeed overspeed, overspeed_rad_per_s: number("0.001", "1000") = "60", "rad/s",
                    "the speed up to which every displacement is answered for (above it the force goes off and stays off)";
                GuardDelay delay, delay_s: number("0", "1") = "0", "s",
                    "the time from a sample until its force begins to act (with the lag at most one tick)";
                GuardLag lag, lag_s: number("0", "1") = "0", "s",
                    "the time from there to the force itself, as the mean of the current loop's step response";
                GuardChange change, change: choice(ChangeOfForce) = Estimated, "",
                    "what is known of the position when the force changes (measured: the encoder is also read then)";
            }
            /// The velocity filter of the law `spring-damper`. It filters the penetrations that the law gets.
            velocity VelocitySettings {
                VelocityFrom from, from: choice(VelocityKind) = Told, "",
                    "what the law spring-damper takes for the velocity (told: as every law, by law.states)";
                // Half of the bandwidth that a hand can reach. Values used in practice lie between 20 and 100 Hz at 1 kHz.
                VelocityBandwidth bandwidth_hz, bandwidth_hz: number("0.002", "20000") = "30", "Hz",
                    "the bandwidth of a filtered or Kalman velocity (a 500th to a fifth of the control rate)";
                VelocityWindow window_s, window_s: number("0", "1") = "0.015", "s",
                    "the longest window of an adaptive one (at most 16 ticks)";
            }
            /// What is added at the touch of a wall: a short torque that takes the device's momentum away, and a decaying
            /// vibration.
            impact ImpactSettings {
                ImpactMomentum momentum, share_of_momentum: number("0", "2") = "1", "",
                    "the share of the estimator inertia's momentum that a pulse takes away at the touch (0, or measured states: none)";
                ImpactVibration vibration, vibration_share_of_speed: number("0", "1") = "0", "",
                    "the speed of a decaying vibration after the touch, as a share of the speed before (0, or measured states: none)";
                ImpactFrequency frequency_hz, vibration_hz: number("1", "1000") = "100", "Hz",
                    "the vibration's frequency (at most a tenth of the control rate)";
                ImpactDecay decay_s, vibration_decay_s: number("0.001", "1") = "0.011", "s",
                    "the time in which the vibration's amplitude falls to 37 %";
            }
        }
    };
}

/// Passes the settings of the thesis to another macro, as `(table) field, name = value`. Only the settings that differ from the
/// table's defaults are listed. The thesis also uses measured states (`law.states`) and no guard (`law.guard.on`).
#[macro_export]
macro_rules! thesis_settings {
    ($with:ident $($more:tt)*) => {
        $with! {
            $($more)*
            // From the captions of thesis Figs. 3.2 and 3.5. The value is below k_c = 2 c_i/T = 1 N·m/rad, so the spring is
            // passive by the device's damping.
            (law) k_soft, k_soft_n_m_per_rad = "0.8";
            // The thesis' law adds no damper's force to the wall's.
            (law) virtual_damping, virtual_damping_n_m_s_per_rad = "0";
            // The fractions a, b and c and the filter come from a search over grips, encoders, touch and press, for k_de of 1 to 20
            // k_c; the thesis gives no values, only "a fraction".
            (law) step_of_ideal, step_of_ideal_per_ms = "0.012";
            // A torque step of 12.7 % is just felt at 60 mN·m (Weber fraction; Jandura and Srinivasan 1994). The 3 % per
            // millisecond here stay well below.
            (law) limit_of_force, limit_of_force_per_ms = "0.03";
            (law) limit_of_penetration, limit_of_penetration_per_ms = "0.03";
            // A thirtieth of the inertia of the thesis' knob, which a hand does not feel.
            (law filter) mass, mass_kg_m2 = "0.000003";
            // The bound of sampling, 2 (c_i - c_f)/T at 1 kHz: the stiffest coupling that is passive at the device.
            (law filter) stiffness, stiffness_n_m_per_rad = "1";
            // A damping of the coupling would lower the bound of k_f, and the damping to ground is enough.
            (law filter) damping, damping_n_m_s_per_rad = "0";
            // Far above the bound k_v T/2 = 4e-4. This damping sets how fast the mass follows the hand (c_env/k_f = 10 ms), and
            // so how steady the mass is.
            (law filter) ground_damping, ground_damping_n_m_s_per_rad = "0.01";
            // The thesis has no pulse at the touch.
            (law impact) momentum, share_of_momentum = "0";
        }
    };
}

/// Gives the Rust type of a setting from the kind in the setting's row of the table, such as `number` or `flag`.
#[macro_export]
macro_rules! setting_type {
    (number $range:tt) => {
        $crate::Si
    };
    (flag ()) => {
        bool
    };
    (choice ($choice:ident)) => {
        $choice
    };
    (choice_of_law ($choice:ident)) => {
        $choice
    };
    ($whole:ident $range:tt) => {
        $whole
    };
}

/// Gives the default of a setting, from the row's text, as a value of the setting's Rust type.
#[macro_export]
macro_rules! setting_value {
    ($value:tt: number $range:tt) => {
        const { $crate::Si::lit($value) }
    };
    ($value:tt: flag ()) => {
        $value
    };
    ($value:tt: choice ($choice:ident)) => {
        $choice::$value
    };
    ($value:tt: choice_of_law ($choice:ident)) => {
        $choice::$value
    };
    ($value:tt: $whole:ident $range:tt) => {
        $value
    };
}

/// The path of a setting as text, for example `setting_path!((law filter) mass_kg_m2)`.
#[macro_export]
macro_rules! setting_path {
    (($($table:ident)+) $name:ident) => { concat!($(stringify!($table), ".",)+ stringify!($name)) };
}

/// A setting whose value is one word of a fixed list, such as a control law's name.
pub trait Choice: Copy + PartialEq + 'static {
    /// All variants. A variant's index in this list is its number on the serial link, so new variants go to the end.
    const ALL: &'static [Self];
    /// The words of the variants in scene files, in the order of [`Choice::ALL`].
    const WORDS: &'static [&'static str];

    /// The variant's index in [`Choice::ALL`], which is its number on the serial link.
    #[must_use]
    fn number(self) -> u32 {
        // The index is at most the number of words, so it fits.
        (0..)
            .zip(Self::ALL)
            .find(|(_, it)| **it == self)
            .map_or(0, |(number, _)| number)
    }

    /// The word that stands for the variant in scene files (TOML files that describe a simulation) and on devices.
    #[must_use]
    fn word(self) -> &'static str {
        Self::ALL
            .iter()
            .zip(Self::WORDS)
            .find(|(it, _)| **it == self)
            .map_or("", |(_, word)| word)
    }

    /// The variant that has this word; `None` if there is none.
    #[must_use]
    fn of_word(word: &str) -> Option<Self> {
        Self::WORDS
            .iter()
            .zip(Self::ALL)
            .find(|(it, _)| **it == word)
            .map(|(_, it)| *it)
    }
}

/// Declares an enum whose variants have words: `Variant = "word"`. Every variant needs a doc comment.
#[macro_export]
macro_rules! choice {
    ($(#[$meta:meta])* $name:ident { $($(#[$variant_meta:meta])* $variant:ident = $word:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
        pub enum $name { $($(#[$variant_meta])* $variant,)+ }

        impl $crate::Choice for $name {
            const ALL: &'static [Self] = &[$(Self::$variant,)+];
            const WORDS: &'static [&'static str] = &[$($word,)+];
        }
    };
}

/// For each unit: the text that ends the names of settings in that unit, and the unit as people read it.
const UNITS: &[(&str, &str)] = &[
    ("", ""),
    ("hz", "Hz"),
    ("s", "s"),
    ("rad", "rad"),
    ("rad_per_s", "rad/s"),
    ("n_m", "N·m"),
    ("n_m_per_rad", "N·m/rad"),
    ("n_m_s_per_rad", "N·m·s/rad"),
    ("n_m_per_a", "N·m/A"),
    ("kg_m2", "kg·m²"),
    ("j", "J"),
    ("w", "W"),
    ("a", "A"),
    ("v", "V"),
    ("h", "H"),
    ("ohm", "Ω"),
    ("celsius", "°C"),
    ("turns_per_s", "turns/s"),
    ("per_rev", "counts/rev"),
];

/// Returns the end of a setting's name for a unit as people read it: `N·m/rad` gives `n_m_per_rad`. For constants only.
///
/// # Panics
/// No setting has this unit. Only constants call the function, so a panic stops the compiler and never a running program.
#[must_use]
pub const fn suffix(unit: &str) -> &'static str {
    let mut index = 0;
    while index < UNITS.len() {
        let (suffix, shown) = UNITS[index];
        if equal(shown, unit) {
            return suffix;
        }
        index += 1;
    }
    panic!("no setting has this unit")
}

/// Whether two texts are equal, for use in constants.
#[must_use]
pub const fn equal(left: &str, right: &str) -> bool {
    let (mut left, mut right) = (left.as_bytes(), right.as_bytes());
    while let ([first, left_rest @ ..], [other, right_rest @ ..]) = (left, right) {
        if *first != *other {
            return false;
        }
        (left, right) = (left_rest, right_rest);
    }
    left.is_empty() && right.is_empty()
}

#[cfg(test)]
mod tests {
    use super::suffix;
    use crate::choices::LawKind;
    use crate::{Choice, Field, Settings};

    macro_rules! rows {
        ($($(#[$doc:meta])* $table:ident $($group:ident)? { $($variant:ident $field:ident, $name:ident:
            $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+ })+) => {
            /// Variant, last part of the path, unit and description of each setting, in the order of the table of settings.
            const ROWS: &[(Field, &str, &str, &str)] = &[$($((Field::$variant, stringify!($name), $unit, $about),)+)+];
        };
    }
    crate::law_settings!(rows);

    #[test]
    fn a_name_ends_in_its_unit_and_a_path_in_its_name() {
        assert_eq!(ROWS.len(), Field::ALL.len());
        for (field, name, unit, about) in ROWS {
            assert!(field.path().ends_with(&format!(".{name}")), "{name}");
            assert!(name.ends_with(suffix(unit)), "{name}: {unit}");
            assert!(
                !about.is_empty() && !about.ends_with('.'),
                "{name}: {about}"
            );
        }
        let mut paths: Vec<_> = Field::ALL.iter().map(|field| field.path()).collect();
        paths.sort_unstable();
        paths.dedup();
        assert_eq!(paths.len(), Field::ALL.len());
    }

    #[test]
    fn the_defaults_are_within_their_ranges() {
        assert_eq!(Settings::default().validate(), Ok(()));
    }

    #[test]
    fn words_and_numbers_go_there_and_back() {
        for (number, word) in (0..).zip(LawKind::WORDS) {
            let kind = LawKind::of_word(word).expect("a word of its own");
            assert_eq!((kind.word(), kind.number()), (*word, number));
        }
        assert_eq!(LawKind::of_word("TDPA"), None);
    }
}
