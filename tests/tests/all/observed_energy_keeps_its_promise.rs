//! Tests what each control law with an energy observer guarantees about its own energy, and what it does not, for random and
//! hostile motions. The laws are compared with sums of raw integers in 128 bits.

use touchstone_control::law::Contact;
use touchstone_control::{Controller, Fixed32, LawKind, Number, ObserverForm, Position, Settings};
use touchstone_tests::random::Random;
use touchstone_tests::variants::all;

type Signal = <Fixed32 as Number>::Signal;

/// A virtual wall, and the sums of the energy that passed between wall and hand since the contact began. Numbers are raw integers
/// of the fixed-point formats.
struct Port {
    wall: Controller<Fixed32>,
    /// Penetration in the last control period, 0 outside, as a raw integer (2^-24 rad).
    last: i128,
    held: i128,
    /// `Σ f(n-1) Δe(n)`, with force `f` and penetration `e`: the energy that the wall absorbed.
    exact: i128,
    /// `Σ f(n) Δe(n)`, with force `f` and penetration `e`: the energy as the energy observer of the DLR thesis calculates it.
    thesis: i128,
}

impl Port {
    fn new(settings: &Settings) -> Self {
        Self {
            wall: Controller::new(settings).unwrap(),
            last: 0,
            held: 0,
            exact: 0,
            thesis: 0,
        }
    }

    /// Runs one control period at the penetration `e`; returns the force. Both are raw integers (2^-24 rad and 2^-24 N·m).
    fn tick(&mut self, e: i32) -> i128 {
        let f = self.wall.tick(Position(Signal::from_bits(e)));
        let f = i128::from(f.0.to_bits());
        if e <= 0 {
            (self.last, self.held, self.exact, self.thesis) = (0, 0, 0, 0);
            return f;
        }
        let moved = i128::from(e) - self.last;
        self.exact += self.held * moved;
        self.thesis += f * moved;
        (self.last, self.held) = (i128::from(e), f);
        f
    }

    fn observed(&self) -> i128 {
        i128::from(self.wall.view().energy.unwrap().0.to_bits())
    }
}

fn tdpa(observer: ObserverForm) -> Settings {
    Settings {
        law: LawKind::Tdpa,
        observer,
        ..Settings::thesis()
    }
}

/// A random list of penetrations as raw integers (2^-24 rad), mostly inside the wall, with rests, reversals, jumps and exits.
fn walk(random: &mut Random, ticks: usize) -> Vec<i32> {
    let mut e = 0_i32;
    (0..ticks)
        .map(|_| {
            match random.bits() % 64 {
                0 => e = random.whole(2 << 24),
                1..=8 => {}
                9..=24 => e += random.whole(100),
                _ => e += random.whole(1 << 16),
            }
            e = e.clamp(-(1 << 20), 2 << 24);
            e
        })
        .collect()
}

/// Checks that the control law TDPA with the thesis' energy observer gives the same forces as a plain spring. For every force `f`
/// that grows with the penetration `e`, with potential `G`, `f(n) Δe(n) >= G(e(n)) - G(e(n-1))`. So the thesis' sum over a spring,
/// limited or not, is never negative, and the law corrects nothing. This holds if the sum uses positions and not a filtered
/// velocity.
#[test]
fn tdpa_with_the_thesis_observer_is_the_plain_spring() {
    let mut tdpa = Port::new(&tdpa(ObserverForm::Thesis));
    let mut spring = Port::new(&Settings {
        law: LawKind::Spring,
        ..Settings::thesis()
    });
    let path = walk(&mut Random::new(10), 1_000_000);
    let mut given_away = 0;
    for (tick, e) in path.into_iter().enumerate() {
        assert_eq!(tdpa.tick(e), spring.tick(e), "tick {tick}");
        given_away = given_away.min(spring.exact);
        if e > 0 {
            assert!(tdpa.observed() >= 0, "tick {tick}");
            assert_eq!(tdpa.observed(), tdpa.thesis, "tick {tick}");
        }
    }
    // The energy that the thesis' observer did not count: a millijoule at least.
    let joule = 2_f64.powi(48);
    assert!((given_away as f64) < -1e-3 * joule, "{given_away}");
}

/// Checks the function that reduces a force for passivity: its energy sum stays non-negative, for any force and displacement.
#[test]
fn a_passivity_step_leaves_the_remainder_of_its_own_division() {
    let mut random = Random::new(15);
    let mut corrected = 0;
    for _ in 0..1_000_000 {
        let energy = (random.bits() >> 2 >> (random.bits() % 62)) as i64;
        let wanted = (random.bits() >> 33 >> (random.bits() % 31)) as i32;
        let moved = random.bits() as i32 >> (random.bits() % 31);
        let (after, force) = Fixed32::passivity_step(
            <Fixed32 as Number>::Energy::from_bits(energy),
            Signal::from_bits(wanted),
            Signal::from_bits(moved),
        );
        let (after, force) = (i128::from(after.to_bits()), i128::from(force.to_bits()));
        let moved = i128::from(moved);
        let whole = i128::from(energy) + force * moved;
        assert_eq!(after, whole.min(i64::MAX.into()));
        assert!(after >= 0 && (0..=i128::from(wanted)).contains(&force));
        if force < i128::from(wanted) {
            // One quantum more force would not have been allowed.
            assert!(moved < 0 && after < -moved);
            corrected += 1;
        }
    }
    assert!(corrected > 10_000, "{corrected} corrections only");
}

#[test]
fn tdpa_with_the_exact_observer_sees_the_port_to_the_bit() {
    let mut port = Port::new(&tdpa(ObserverForm::Exact));
    for (tick, e) in walk(&mut Random::new(11), 1_000_000)
        .into_iter()
        .enumerate()
    {
        port.tick(e);
        if e > 0 {
            assert_eq!(port.observed(), port.exact, "tick {tick}");
        }
    }
}

/// Checks the control law TDPA with the exact energy observer, which assumes that the next displacement is like the last. If the
/// motion goes on at least as fast, an energy deficit is gone after one control period, except for the rounding of the force. This
/// does not hold if the force limit cuts the correction short.
#[test]
fn tdpa_with_the_exact_observer_repairs_a_deficit_while_the_motion_goes_on() {
    let mut port = Port::new(&tdpa(ObserverForm::Exact));
    let limit = 1_i128 << 23;
    let mut moved = 0_i128;
    let mut force = 0_i128;
    let (mut deficit, mut repaired) = (false, 0);
    for (tick, e) in walk(&mut Random::new(12), 3_000_000)
        .into_iter()
        .enumerate()
    {
        let before = port.last;
        let next = i128::from(e.max(0)) - before;
        let goes_on = next.signum() == moved.signum() && next.abs() >= moved.abs() && moved != 0;
        let due = e > 0 && deficit && goes_on && force.abs() < limit;
        force = port.tick(e);
        if due {
            assert!(
                port.observed() > -moved.abs(),
                "tick {tick}: {}",
                port.observed()
            );
            repaired += 1;
        }
        deficit = e > 0 && port.observed() < 0;
        moved = next;
    }
    assert!(repaired > 1_000, "{repaired} repairs only");
}

/// Checks a motion that reverses in every control period. Each correction by the control law TDPA with the exact energy observer is
/// then wrong, and gives away up to the force limit times the displacement. No sum of past energy can prevent it. The control law
/// FBA prevents it, because its limit holds for every next displacement.
#[test]
fn a_motion_that_turns_at_every_tick_defeats_tdpa_with_the_exact_observer_but_not_fba() {
    let (near, far) = (167_772_i32, 201_327_i32); // 10 and 12 mrad
    let ticks = 1_000;
    let lowest = |settings: Settings| {
        let mut port = Port::new(&settings);
        let observed = (0..ticks).map(|tick| {
            port.tick(if tick % 2 == 0 { near } else { far });
            port.observed()
        });
        observed.min().unwrap()
    };
    let per_tick = i128::from(far - near) << 23; // the force limit, 0.5 N·m, over the way
    let tdpa = lowest(tdpa(ObserverForm::Exact));
    assert!(tdpa < -per_tick * (ticks - 100), "{tdpa}");
    assert!(tdpa >= -per_tick * ticks, "{tdpa}");
    let fba = lowest(Settings {
        law: LawKind::Fba,
        ..Settings::thesis()
    });
    assert!(fba >= 0, "{fba}");
}

/// Checks that the observed energy `E` of the control law FBA never gets negative. Its limit is `f <= sqrt(4 E c_i/T)`, with device
/// damping `c_i` and control period `T`. The next energy `E - f |Δe| + (c_i/T) Δe²` is then a square and not negative. The law
/// rounds the damper's energy down by less than one force step times the displacement; its sum may be too small by that much.
#[test]
fn fba_keeps_its_energy_whatever_comes_next() {
    let mut port = Port::new(&Settings {
        law: LawKind::Fba,
        ..Settings::thesis()
    });
    let mut random = Random::new(13);
    let mut lowest = 0_i128;
    for tick in 0..1_000_000 {
        let before = port.last;
        // Half of the time the worst displacement: Δe = -f/(2 c_i/T), with c_i/T = 0.5 N·m/rad here.
        let worst = i32::try_from(before - port.held).unwrap();
        let e = match random.bits() % 8 {
            0..4 => worst + random.whole(2),
            4..7 => before as i32 + random.whole(1 << 18),
            _ => random.whole(1 << 24),
        };
        port.tick(e);
        if e > 0 {
            let moved = (i128::from(e) - before).abs();
            assert!(
                port.observed() >= -moved,
                "tick {tick}: {}",
                port.observed()
            );
            lowest = lowest.min(port.observed());
        }
    }
    assert!(
        lowest > -(1 << 24),
        "{lowest}: more than a quantum over a radian"
    );
}

#[test]
fn the_enhanced_law_never_lends_more_than_its_credit() {
    let base = Settings::thesis();
    let credit = i128::from(Fixed32::energy(base.energy_credit).unwrap().to_bits());
    let path = walk(&mut Random::new(14), 100_000);
    for (name, settings) in all(&base) {
        if settings.law != LawKind::EnhancedSfa {
            continue;
        }
        let mut port = Port::new(&settings);
        let mut augmented = 0;
        for (tick, &e) in path.iter().enumerate() {
            port.tick(e);
            if port.wall.view().contact == Contact::Augmenting {
                augmented += 1;
                assert!(port.observed() >= -credit, "{name}, tick {tick}");
            }
        }
        assert!(augmented > 1_000, "{name}: {augmented} ticks only");
    }
}
