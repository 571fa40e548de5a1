//! Compares each control law in every number format with the 32-bit one, on simple presses. The forces differ by no more than the
//! formats' rounding explains. Every bound in this file is derived, period by period where errors add up; none is fitted.
//!
//! Angles lie on the coarser format's grid and every stiffness is a multiple of 2^-6. So both formats get the same press and the
//! same wall, and only their rounding differs. `q` is the sum of the two formats' rounding errors of one force.

use touchstone_control::settings::FilterSettings;
use touchstone_control::{
    Controller, FirstContact, Fixed16, Fixed32, LawKind, Position, Settings, Si,
};
use touchstone_tests::grain::Grain;
use touchstone_tests::motion::{half_sine, hold, on_grid, wiggle};
use touchstone_tests::si::si;

/// Stiffness of the wall in N·m/rad, 301/64. Its products with angles fit no number format's force exactly, so that every force is
/// rounded.
const STIFFNESS: f64 = 4.703_125;

/// Settings of a wall whose coefficients are the same numbers in all formats. Exceptions are the square root in the control law FBA
/// and the steps by which the enhanced law shifts the surface.
fn wall(law: LawKind) -> Settings {
    Settings {
        law,
        rate_hz: 1024,
        k_desired: si("4.703125"),
        k_soft: Si::ONE,                       // 1/k_v is 1, too
        device_damping: si("0.000732421875"),  // c_i/T = 0.75
        virtual_damping: si("0.000244140625"), // per tick: 0.25
        step_of_ideal: si("0.064"),            // per tick: 0.0625
        limit_of_force: si("0.032"),
        limit_of_penetration: si("0.032"),
        filter: FilterSettings {
            mass: si("0.000003814697265625"), // m/T² = 4
            stiffness: si("2"),
            damping: Si::ZERO,
            ground_damping: si("0.0078125"), // c_env/T = 8
        },
        ..Settings::thesis()
    }
}

/// One control period of the same control law in two number formats.
#[derive(Debug, Clone, Copy, Default)]
struct Tick {
    e: f64,
    /// Displacement in this control period, rad; `moved_before` is the displacement in the period before.
    moved: f64,
    moved_before: f64,
    /// Force, observed energy, and the shift of the wall's surface by the control law. Each is given first in the format under
    /// test, then in the 32-bit format.
    force: [f64; 2],
    energy: [f64; 2],
    offset: [f64; 2],
}

impl Tick {
    /// The larger magnitude of the two formats' observed energies, for relative errors.
    fn energy_size(&self) -> f64 {
        self.energy[0].abs().max(self.energy[1].abs())
    }
    /// Whether the control law gave another force than a plain spring, in either number format.
    fn held_back(&self) -> bool {
        let spring = (STIFFNESS * self.e).min(0.5);
        self.force
            .iter()
            .any(|f| (f - spring).abs() > 1e-4 * spring)
    }
}

/// Runs both number formats along `path`. The function `bound` gets every control period and returns by how much the forces may
/// differ. Returns the largest difference, N·m.
fn compare<N: Grain>(
    settings: &Settings,
    path: &[f64],
    mut bound: impl FnMut(&Tick) -> f64,
) -> f64 {
    let mut tested = Controller::<N>::new(settings).unwrap();
    let mut reference = Controller::<Fixed32>::new(settings).unwrap();
    let (mut largest, mut last) = (0.0_f64, Tick::default());
    for (index, e) in on_grid(path, N::ANGLE_BITS).into_iter().enumerate() {
        let position = Position::<N>::from_f64(e);
        assert_eq!(position.to_f64(), e, "not on the grid of {}", N::NAME);
        let (a, b) = (tested.tick(position), reference.tick(Position::from_f64(e)));
        let (seen_a, seen_b) = (tested.view(), reference.view());
        let tick = Tick {
            e,
            moved: e - last.e,
            moved_before: last.moved,
            force: [a.to_f64(), b.to_f64()],
            energy: [
                seen_a.energy.map_or(0.0, |x| x.to_f64()),
                seen_b.energy.map_or(0.0, |x| x.to_f64()),
            ],
            offset: [seen_a.offset.to_f64(), seen_b.offset.to_f64()],
        };
        let difference = (tick.force[0] - tick.force[1]).abs();
        let bound = bound(&tick);
        assert!(
            difference <= bound,
            "{} {:?}, tick {index}: {difference:e} N·m, bound {bound:e} N·m, {tick:?}",
            N::NAME,
            settings.law
        );
        largest = largest.max(difference);
        last = tick;
    }
    largest
}

/// Sum of the two number formats' rounding errors of one force, N·m (`q` in the bounds of this file).
fn quantum<N: Grain>() -> f64 {
    N::FORCE_N_M + Fixed32::FORCE_N_M
}

/// Checks that an error bound is not far too wide: the largest difference found must be more than an eighth of it.
fn assert_tight(what: &str, largest: f64, bound: f64) {
    assert!(
        largest > bound / 8.0,
        "{what}: {largest:e} N·m of {bound:e} N·m"
    );
}

/// Bound for springs with and without damping: their force is one exact product, or the sum of two, which is rounded once.
fn springs<N: Grain>() {
    for law in [LawKind::Spring, LawKind::SpringDamper] {
        let q = quantum::<N>();
        let largest = compare::<N>(&wall(law), &half_sine(0.05, 400), |_| q);
        assert_tight(N::NAME, largest, q);
    }
}

/// Derives by how much two number formats of the control law TDPA may differ, with stiffness `k`, penetration `e`, displacement `Δ`
/// and observed energy `E`. `q` is the rounding error of a force. Let the energies of the two formats differ by `B`. Outwards `f =
/// min(k e, E/|Δ|)` and inwards `f = max(k e, -E/|Δ|)`, so `f` changes by at most `1/|Δ|` per energy. The forces differ by at most
/// `B/|Δ| + q` if one of them was corrected, and by `q` if none was.
///
/// The next energy is `E + f Δ'`. A motion in the same direction reduces the energies' difference, by at most `|Δ'|/|Δ|` of it; a
/// reversal adds to it. The force's rounding adds `q |Δ'|`, and a floating-point sum its own rounding.
fn tdpa<N: Grain>() {
    let q = quantum::<N>();
    let mut apart = 0.0;
    let mut slope = 0.0;
    let mut corrected = 0;
    compare::<N>(&wall(LawKind::Tdpa), &wiggle(0.04, 2000), |tick| {
        let share: f64 = slope * tick.moved.abs();
        let turned = tick.moved * tick.moved_before < 0.0;
        let factor = if turned {
            1.0 + share
        } else {
            f64::max(1.0, share - 1.0)
        };
        apart = apart * factor + q * tick.moved.abs() + 2.0 * N::ENERGY * tick.energy_size();
        let may_correct = tick.moved != 0.0 && tick.held_back();
        slope = if may_correct {
            1.0 / tick.moved.abs()
        } else {
            0.0
        };
        corrected += u32::from(may_correct);
        if tick.e <= 0.0 {
            apart = 0.0;
        }
        q + apart * slope
    });
    assert!(corrected > 10, "{}: {corrected} corrections only", N::NAME);
}

/// Derives by how much two number formats of the control law FBA may differ. Its force is `f = min(k e, G sqrt(E))` with `G =
/// sqrt(4 c_i/T)`, device damping `c_i`, control period `T`, observed energy `E`, stiffness `k` and penetration `e`. Each format
/// rounds `G` down, so the two differ by at most `g`; the root is rounded down by less than the force's rounding error `q`. If the
/// energies differ by `B`, the forces differ by at most `G (sqrt(E) - sqrt(E - B)) + g sqrt(E) + (G + 1) q`. This holds because the
/// root is concave and its secant below `E` is the steepest.
///
/// The next energy adds `f Δ'` (displacement `Δ'`) and the damper's energy, rounded by `q |Δ'|`. Inwards the force's error adds to
/// `B`; outwards it reduces `B`, at most down to the other sign.
fn fba<N: Grain>() {
    let settings = wall(LawKind::Fba);
    let q = quantum::<N>();
    let g = N::GAIN_N_M_PER_RAD + Fixed32::GAIN_N_M_PER_RAD;
    let bound = 3.0_f64.sqrt();
    let mut apart = 0.0;
    // Of the last tick: the part of the forces' difference that comes from the energies' difference, and the rest.
    let (mut by_energy, mut by_rounding) = (0.0, 0.0);
    let mut inwards = 0.0_f64;
    let largest = compare::<N>(&settings, &half_sine(0.05, 400), |tick| {
        let way = tick.moved.abs();
        apart = if tick.moved >= 0.0 {
            apart + by_energy * way
        } else {
            f64::max(apart, by_energy * way - apart)
        };
        apart += (by_rounding + q) * way + 3.0 * N::ENERGY * tick.energy_size();
        if tick.e <= 0.0 {
            apart = 0.0;
        }
        let energy = tick.energy[0].max(tick.energy[1]).max(0.0);
        by_energy = bound * (energy.sqrt() - (energy - apart).max(0.0).sqrt());
        by_rounding = g * energy.sqrt() + (bound + 1.0) * q;
        // On the way out the bound grows, because it leaves out that the errors shrink.
        if tick.moved > 0.0 {
            inwards = inwards.max(by_energy + by_rounding);
        }
        by_energy + by_rounding
    });
    assert_tight(N::NAME, largest, inwards);
}

/// Derives by how much two number formats of the control law SFA may differ, which shifts its surface in steps. The soft stiffness
/// `k_v = 1` and the step's gain are the same in all formats, and steps lie on the grid. The formats differ in the rounding of the
/// last force while the wall is soft. They also differ in the decision "too soft", which may fall either way if it is that close.
/// Such a control period moves the two surfaces apart by `2 gain |Δ|`, with displacement `Δ` and `gain = k_c/k_v - 1 = 0.5`; the
/// step itself is rounded once.
fn sfa<N: Grain>() {
    for (law, first_contact) in [
        (LawKind::Sfa, FirstContact::KeepForce),
        (LawKind::Sfa, FirstContact::ZeroOffset),
        (LawKind::SfaContinuous, FirstContact::KeepForce),
        (LawKind::SfaContinuous, FirstContact::ZeroOffset),
    ] {
        let settings = Settings {
            first_contact,
            ..wall(law)
        };
        let q = quantum::<N>();
        let mut apart = 2.0 * q;
        let mut offsets = [0.0; 2];
        compare::<N>(&settings, &wiggle(0.04, 2000), |tick| {
            let steps = [tick.offset[0] - offsets[0], tick.offset[1] - offsets[1]];
            if steps[0] * steps[1] < 0.0 {
                let close = (tick.force[1] - STIFFNESS * tick.e).abs();
                let reach = apart + q + STIFFNESS * tick.moved.abs();
                assert!(close <= reach, "{}: not close: {tick:?}", N::NAME);
                apart += tick.moved.abs();
            }
            if steps[1] != 0.0 {
                apart += q;
            }
            offsets = tick.offset;
            apart
        });
    }
}

/// Derives by how much two number formats of the enhanced control law may differ at rest. The law shifts its surface by steps `κ
/// |k_de e - f|` (desired stiffness `k_de`, penetration `e`, force `f`), with `κ = c/k_de` as the format holds it. The surface
/// stops where a step is rounded to nothing: below one step of a format that truncates, and below half the distance of two
/// positions if the format rounds to nearest. Each format then shows `k_de` up to a dead band of `step/κ`, and two formats may rest
/// at opposite ends of their dead bands.
fn enhanced_at_rest<N: Grain>(lost_step: f64) {
    let band = |lost: f64| lost / (lost * (0.0625 / STIFFNESS / lost).floor());
    // A float holds κ nearly exactly; its error is far below the following terms.
    let own = band(lost_step) + N::FORCE_N_M;
    let fixed32 = band(Fixed32::FORCE_N_M) + Fixed32::FORCE_N_M;
    let path = hold(0.025, 4000);
    let settled = path.len() - 500;
    let mut index = 0;
    compare::<N>(&wall(LawKind::EnhancedSfa), &path, |tick| {
        index += 1;
        if index <= settled {
            return f64::INFINITY;
        }
        let shown = (tick.force[0] - STIFFNESS * tick.e).abs();
        assert!(shown <= own, "{}: {shown:e} N·m off, {own:e}", N::NAME);
        own + fixed32
    });
}

/// Checks the enhanced control law from touch to release with the default settings. Its force differs from that in f64 by less than
/// 1e-4 N·m, which is this project's own requirement.
fn enhanced_all_the_way<N: Grain>() {
    for first_contact in [FirstContact::ZeroOffset, FirstContact::KeepForce] {
        let settings = Settings {
            first_contact,
            ..Settings::thesis()
        };
        for path in [half_sine(0.02, 400), wiggle(0.02, 4000), hold(0.02, 4000)] {
            compare::<N>(&settings, &path, |_| 1e-4);
        }
    }
}

#[test]
fn springs_differ_by_one_rounding() {
    springs::<Fixed16>();
    springs::<f32>();
    springs::<f64>();
}

#[test]
fn tdpa_differs_by_what_its_energy_collects() {
    tdpa::<Fixed16>();
    tdpa::<f32>();
    tdpa::<f64>();
}

#[test]
fn fba_differs_by_its_root_and_what_its_energy_collects() {
    fba::<Fixed16>();
    fba::<f32>();
    fba::<f64>();
}

#[test]
fn sfa_differs_by_its_hand_over_and_close_decisions() {
    sfa::<Fixed16>();
    sfa::<f32>();
    sfa::<f64>();
}

#[test]
fn the_enhanced_law_comes_to_rest_within_its_dead_band() {
    enhanced_at_rest::<Fixed16>(Fixed16::FORCE_N_M);
    // The offset that shows k_de here is e (k_de/k_f + k_de/k_v - 1) = 0.14 rad (equation 3.6 of the thesis), between 1/8 and
    // 1/4.
    enhanced_at_rest::<f32>(f64::from(f32::EPSILON) / 16.0);
    enhanced_at_rest::<f64>(f64::EPSILON / 16.0);
}

#[test]
fn the_enhanced_law_stays_within_a_tenth_of_a_millinewtonmetre_of_the_floats() {
    enhanced_all_the_way::<f32>();
    enhanced_all_the_way::<f64>();
}
