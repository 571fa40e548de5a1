//! P11 (refinement): coefficients on three axes follow from settings as their specification says, at 32 bits.
//!
//! ```text
//! settings.friction(unit, rate, damping) = spec(settings, unit, rate, damping)      p11_friction_settings32
//! a length in a unit, a quantity per length, a law's settings in it                 p11_per_length64, p11_law_in_unit64
//! VectorGuard::new from two guards, one of them with √3 encoder counts              p11_vector_guard_settings32
//! ```

use crate::accepted::{any_law, any_settings};
use crate::set::{any_guard_settings, bits, setting};
use crate::source::Source;
use crate::spec::Int;
use crate::spec::friction_settings as friction;
use crate::spec::settings::{ONE, over, times};
use crate::{assume, cover, guarded_property, reckoned, reckoned_property};
use touchstone_control::space::{FrictionSettings, LengthUnit, VectorGuard};
use touchstone_control::{
    FilterSettings, Fixed32, Guard, GuardSettings, GuardedDevice, Position, Settings, Si,
    StatesKind, VelocityKind, VelocitySettings,
};

type N = Fixed32;

fn any_unit<S: Source>(s: &mut S) -> (LengthUnit, Int) {
    match s.u8() & 3 {
        0 => (LengthUnit::Metre, 1),
        1 => (LengthUnit::Centimetre, 100),
        _ => (LengthUnit::Millimetre, 1000),
    }
}
fn si(x: Int) -> Si {
    Si::from_bits(x as i64)
}

reckoned_property! {
    /// P11 (refinement): the friction that the code makes of the settings, or its refusal, equals the specification's.
    equation "0 < k <= 2 b/T, 0 <= μ_k <= μ_s <= 10  =>  k/u, μ_s u/k, μ_k u/k"
    over "settings of friction, unit, rate, damping"
    by minisat fn p11_friction_settings32(s) {
        let settings = FrictionSettings {
            stiffness: setting(s, 1000 << 32),
            static_coefficient: setting(s, 12 << 32),
            kinetic_coefficient: setting(s, 2 << 32),
        };
        let ((unit, per_metre), rate, damping) = (any_unit(s), s.bits(31) as u32, setting(s, 1 << 32));
        let found = settings.friction::<N>(unit, rate, damping).ok();
        reckoned::of_specification();
        let set = friction::Settings {
            stiffness: bits(settings.stiffness),
            fixed: bits(settings.static_coefficient),
            kinetic: bits(settings.kinetic_coefficient),
        };
        let expected = friction::made(&set, per_metre, rate.into(), bits(damping));
        let found = found.map(|law| friction::Friction {
            stiffness: law.stiffness.0.to_bits().into(),
            fixed: law.static_reach.0.to_bits().into(),
            kinetic: law.kinetic_reach.0.to_bits().into(),
        });
        assert!(found == expected);
        cover!(s, found.is_some_and(|law| law.kinetic < law.fixed), "made");
        cover!(s, found.is_none() && settings.stiffness > Si::ZERO, "refused");
    }
}
reckoned_property! {
    /// P11 (refinement): a quantity per metre is converted to one per unit of length by division by the number of units in a metre.
    equation "k per u = k/u"
    over "setting of 64 bits, unit"
    by minisat fn p11_per_length64(s) {
        let (set, (unit, per_metre)) = (Si::from_bits(s.i64()), any_unit(s));
        let found = unit.per_length(set);
        reckoned::of_specification();
        assume!(s, set >= Si::ZERO, "Settings::validate");
        assert!(found == si(over(bits(set), per_metre * ONE)));
        cover!(s, found > Si::ONE && per_metre > 1, "more than one");
    }
}
reckoned_property! {
    /// P11 (refinement): converting a law's settings to another unit of length converts the quantities per length and the lent
    /// energy. Guard, estimator and velocity filter are off.
    equation "k, b, m per u; E u"
    over "settings of any law, unit"
    by minisat fn p11_law_in_unit64(s) {
        let law = any_law(s);
        let (set, (unit, per_metre)) = (any_settings(s, law), any_unit(s));
        let found = unit.settings(&set);
        reckoned::of_specification();
        let filter = set.filter;
        let values = [set.k_desired, set.k_soft, set.device_damping, set.virtual_damping, filter.mass, filter.stiffness, filter.damping, filter.ground_damping, set.energy_credit];
        assume!(s, values.iter().all(|value| *value >= Si::ZERO), "Settings::validate");
        let per = |value: Si| si(over(bits(value), per_metre * ONE));
        let expected = Settings {
            k_desired: per(set.k_desired),
            k_soft: per(set.k_soft),
            device_damping: per(set.device_damping),
            virtual_damping: per(set.virtual_damping),
            energy_credit: si(times(bits(set.energy_credit), per_metre * ONE)),
            filter: FilterSettings {
                mass: per(filter.mass),
                stiffness: per(filter.stiffness),
                damping: per(filter.damping),
                ground_damping: per(filter.ground_damping),
            },
            guard: GuardSettings { on: false, ..GuardSettings::default() },
            states: StatesKind::Measured,
            velocity: VelocitySettings { from: VelocityKind::Told, ..VelocitySettings::default() },
            ..set
        };
        assert!(found == expected);
        cover!(s, found.energy_credit > set.energy_credit, "a loan");
    }
}
guarded_property! {
    /// P11 (refinement): the guard on three axes is that of one axis with √3 times the encoder count, and with one more step of the
    /// number format where a position is rounded. A change of force is charged as on one axis.
    equation "VectorGuard::new = (Guard::new(√3 δ), δ + q, i + q, slack of δ)"
    over "settings of the guard, rate, force limit, count; under the checker a guard of which each word is one that it was told"
    by minisat fn p11_vector_guard_settings32(s) {
        let (settings, device) = any_guard_settings(s);
        let found = VectorGuard::<N>::new(&settings, &device).ok();
        reckoned::of_specification();
        assume!(s, device.count >= Si::ZERO, "GuardSettings::validate");
        let of_axis = Guard::<N>::new(&settings, &device).ok();
        // A little more than the square root of 3, to seven digits.
        let count = si(times(bits(device.count), 7_439_101_971));
        let of_length = Guard::<N>::new(&settings, &GuardedDevice { count, ..device }).ok();
        let expected = of_axis.zip(of_length).map(|(of_axis, of_length)| VectorGuard::of(Guard {
            slack: of_axis.slack,
            count: of_length.count + Position::quantum(),
            in_flight: of_length.in_flight + Position::quantum(),
            ..of_length
        }));
        assert!(found == expected);
        cover!(s, found.is_some(), "made");
        cover!(s, found.is_none(), "refused");
    }
}
