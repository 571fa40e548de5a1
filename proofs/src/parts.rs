//! Properties of small parts of laws, guard and settings, each proved alone.
//!
//! `x_f` is the virtual mass' position, `d` its displacement per tick, `M` its inertia, `N0` the force that drives it. `B` is the
//! energy in the guard's account and `C` its capacity.
//!
//! ```text
//! x_f' = x_f + d', M d = N0 with no stretch   p6_mass_moves
//! B = C, f = 0                                p1_guard_starts_full
//! damped spring: first tick as the spring's   p11_damped_first
//! 1 m = 100 cm = 1000 mm                      p8_length_unit
//! ranges of what the guard and the estimator accept  p8_guard_settings, p8_estimator_bandwidth
//! ```

use crate::format::Format;
use crate::valid::{Valid, any_mass};
use crate::{cover, property};
use touchstone_control::estimator::EstimatedMotion;
use touchstone_control::filter::MassState;
use touchstone_control::law::{Damped, DampedState, Law, Sample, Spring};
use touchstone_control::space::LengthUnit;
use touchstone_control::velocity::{Smoothed, Velocity, VelocityState};
use touchstone_control::{
    EstimatorSettings, Fixed8, Force, Guard, GuardSettings, GuardState, GuardedDevice, Number,
    Position, Si,
};

type N = Fixed8;

property! {
    /// P6 (virtual mass): the virtual mass moves by its step, up to the end of the range of positions. With a coupling without
    /// stretch and a hand at rest, only its inertia drives it.
    equation "x_f' = x_f + d', d = d'; N0(x = x_f, Δx = 0) = M d"
    over "any virtual mass, its position and motion, a step"
    fn p6_mass_moves(s) {
        let mass = any_mass::<N, S>(s);
        let state = MassState { position: N::any_position(s), moved: N::any_position(s) };
        let step = N::any_position(s);
        let bits = |x: Position<N>| N::of_signal(x.0);
        let after = state.moved_by(step);
        let end = (bits(state.position) + bits(step)).clamp(-128, 127);
        assert!(bits(after.position) == end && after.moved == step);
        assert!(mass.coast(&state) == mass.drive(&state, state.position, Position::zero()));
        assert!(N::of_tension(mass.coast(&state).0) == N::of_gain(mass.inertia.0) * bits(state.moved));
        cover!(s, end == 127, "at the end of the format");
        cover!(s, N::of_tension(mass.coast(&state).0) < 0, "outward");
    }
}
property! {
    /// P1 (energy): at power-up the guard has a full energy account and no force.
    equation "B = C, f = f' = 0"
    over "any configuration"
    fn p1_guard_starts_full(s) {
        let guard = Guard::<N>::any(s);
        let GuardState { account, force, older } = guard.full();
        assert!(account == guard.capacity && force == Force::zero() && older == Force::zero());
        cover!(s, N::of_energy(account.0) > 1000, "an account");
    }
}
property! {
    /// P11 (refinement): the first tick of a damped spring with a filtered velocity is that of the spring for a device at rest. The
    /// reported values are the spring's.
    equation "f = spring(e, 0)"
    over "any spring, any share of the smoothing, position, displacement"
    fn p11_damped_first(s) {
        let spring = Spring::<N>::any(s);
        let at = N::any_position(s);
        let law = Damped { spring, velocity: Velocity::Smoothed(Smoothed { share: s.i32() }) };
        let mut state = DampedState::default();
        let force = law.tick(&mut state, Sample { e: at, moved: N::any_position(s) });
        let mut alone = Default::default();
        assert!(force == spring.tick(&mut alone, Sample { e: at, moved: Position::zero() }));
        assert!(state.spring == alone);
        let standing = EstimatedMotion { position: <N as Number>::widen(at.0), ..EstimatedMotion::default() };
        assert!(state.velocity == VelocityState::Motion(Some(standing)));
        let (shown, of_spring) = (law.view(&state), spring.view(&alone));
        assert!(shown.contact == of_spring.contact && shown.energy == of_spring.energy && shown.offset == of_spring.offset);
        cover!(s, force > Force::zero(), "pushed");
        cover!(s, at < Position::zero(), "outside");
    }
}
property! {
    /// P8 (settings): a length in centimetres or millimetres is a hundred or a thousand times the number of metres, up to the end
    /// of the range of settings.
    equation "x cm = 100 x, x mm = 1000 x"
    over "setting of 64 bits, unit"
    by kissat fn p8_length_unit(s) {
        let bits = s.i64();
        let (unit, many) = match s.u8() % 3 {
            0 => (LengthUnit::Metre, 1),
            1 => (LengthUnit::Centimetre, 100),
            _ => (LengthUnit::Millimetre, 1000),
        };
        assert!(unit.per_metre() == many);
        let exact = i128::from(bits) * i128::from(many);
        let shown = exact.clamp(i128::from(i64::MIN), i128::from(i64::MAX));
        assert!(i128::from(unit.of_length(Si::from_bits(bits)).to_bits()) == shown);
        cover!(s, shown != exact, "beyond the settings");
        cover!(s, many == 100 && bits < -1_000_000, "a length outward");
    }
}
property! {
    /// P8 (settings): if the guard's validation accepts settings for a device, the device's force limit and encoder count are in
    /// their ranges, and delay and lag are not negative.
    equation "0 <= limit <= 1000, 0 <= count <= 0.1, delay >= 0, lag >= 0"
    over "delay, lag, force limit and count of 64 bits each, any rate; other settings as by default"
    by kissat fn p8_guard_settings(s) {
        let si = |s: &mut S| Si::from_bits(s.i64());
        let device = GuardedDevice { rate_hz: s.u32(), force_limit: si(s), count: si(s) };
        let settings = GuardSettings { delay: si(s), lag: si(s), ..GuardSettings::default() };
        if settings.validate(&device).is_err() {
            return;
        }
        let tenth = Si::from_bits((1_i64 << 32) / 10);
        assert!(device.force_limit >= Si::ZERO && device.force_limit <= Si::const_from_int(1000));
        assert!(device.count >= Si::ZERO && device.count <= tenth + Si::DELTA);
        assert!(settings.delay >= Si::ZERO && settings.lag >= Si::ZERO);
        cover!(s, device.rate_hz > 100 && settings.delay > Si::ZERO, "delayed");
    }
}
property! {
    /// P8 (settings): a bandwidth that the estimator's validation accepts is from a 500th to a fifth of the control rate.
    equation "rate/500 <= p <= rate/5"
    over "bandwidth of 64 bits, at 300 Hz, 1 kHz and 100 kHz; other settings as by default"
    by minisat fn p8_estimator_bandwidth(s) {
        let si = |s: &mut S| Si::from_bits(s.i64());
        let settings = EstimatorSettings { bandwidth_hz: si(s), ..EstimatorSettings::default() };
        for rate in [300, 1_000, 100_000] {
            if settings.validate(rate, Si::ONE).is_err() {
                continue;
            }
            let bits = i128::from(settings.bandwidth_hz.to_bits());
            let most = i128::from(rate) << 32;
            assert!(bits > 0 && bits * 5 <= most);
            assert!((bits + 1) * 500 > most);
            cover!(s, rate == 300, "at 300 Hz");
            cover!(s, rate == 1_000, "at 1 kHz");
            cover!(s, rate == 100_000, "at 100 kHz");
        }
    }
}
