//! Tests of the energy guard of an environment (walls and detents): it has one energy account and one force limit for all, and no
//! force where a motion would not be counted.

use touchstone_control::environment::{
    CentreSettings, ClickSettings, DrySettings, Environment, Extent, FeelSettings, InertiaSettings,
    MOST_POINTS, ProfileSettings, Reached, Reading, Shape, Side, Spacing, ViscousSettings, WHOLE,
};
use touchstone_control::{Fixed16, Fixed32, Force, LawKind, Position, Settings, Si, StatesKind};
use touchstone_tests::environment::{COUNT_RAD, at, built, detents, mirrored, wall};
use touchstone_tests::random::Random;
use touchstone_tests::si::si;

/// One encoder count, rad.
const COUNT: Si = Si::lit("0.000157079632");

/// A spring of 5 N·m/rad behind a guard with 20 mJ that relies on no damping.
fn guarded_spring() -> Settings {
    let mut settings = Settings {
        law: LawKind::Spring,
        states: StatesKind::Measured,
        k_desired: si("5"),
        ..Settings::thesis()
    };
    settings.guard.on = true;
    settings.guard.capacity = si("0.02");
    settings.guard.share_of_damping = si("0");
    settings
}

/// Adds up the energy in J that a hand has got out of the motor, from the true positions.
struct Audit {
    force: f64,
    at: f64,
    taken: f64,
    least: f64,
    worst: f64,
}

impl Audit {
    fn new() -> Self {
        Self {
            force: 0.0,
            at: 0.0,
            taken: 0.0,
            least: 0.0,
            worst: 0.0,
        }
    }

    /// Moves the device to `at` (rad) under the last force; then `force` (N·m) acts. `refill` is the energy in J that the energy
    /// guard's account gains per control period.
    fn step(&mut self, at: f64, force: f64, refill: f64) {
        // A force against +x is work for the hand on the way to -x.
        self.taken -= self.force * (at - self.at) + refill;
        self.least = self.least.min(self.taken);
        self.worst = self.worst.max(self.taken - self.least);
        (self.force, self.at) = (force, at);
    }
}

/// Checks the energy guard's bound for a hand that goes into one wall within a control period and out within the next, then into
/// another wall. On each way out, a wall without a guard gives more than the hand put in.
#[test]
fn one_account_answers_for_all_walls_and_detents() {
    let settings = guarded_spring();
    let capacity = 0.02;
    let refill = 0.0005 / 1000.0;
    // Half a count at each end of a window, under the largest force that the account can cover.
    let rounding = 0.34 * COUNT_RAD;
    let walls = [wall("0.005", Side::Above), wall("-0.005", Side::Below)];
    let (mut guarded, mut apart) = ([0.0_f64; 2], 0.0_f64);
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let mut open = settings;
        open.guard.on = false;
        let mut one = built::<Fixed32>(&settings, &walls, Some(&detents()));
        let mut bare = built::<Fixed32>(&open, &walls, Some(&detents()));
        // For comparison, the energy from two guards: one controller with its guard per wall.
        let mut each = walls.map(|wall| built::<Fixed32>(&settings, &[wall], None));
        let mut audits = [Audit::new(), Audit::new(), Audit::new()];
        for tick in 0..4_000_u32 {
            let side = if seed % 2 == 0 {
                // Each wall in turn, for as long as its own account would allow.
                if (tick / 400).is_multiple_of(2) {
                    1.0
                } else {
                    -1.0
                }
            } else {
                random.real().signum()
            };
            // Deep in one tick, at the surface in the next, anywhere within a count.
            let depth = if tick.is_multiple_of(2) { 0.03 } else { 0.0 };
            let x = side * (0.005 + depth) + 0.5 * COUNT_RAD * random.real();
            let here = at((x / COUNT_RAD).round() as i64);
            let forces = [
                one.tick(&here, None).to_f64(),
                bare.tick(&here, None).to_f64(),
                each.iter_mut()
                    .map(|wall| wall.tick(&here, None).to_f64())
                    .sum(),
            ];
            for (audit, force) in audits.iter_mut().zip(forces) {
                audit.step(x, force, refill);
            }
        }
        guarded[0] = guarded[0].max(audits[0].worst);
        guarded[1] = guarded[1].max(audits[1].worst);
        apart = apart.max(audits[2].worst);
    }
    println!(
        "worst of 40 ways: one guard {:.2} mJ, none {:.0} mJ, a guard a wall {:.2} mJ, promised {:.0} mJ",
        1e3 * guarded[0],
        1e3 * guarded[1],
        1e3 * apart,
        1e3 * capacity
    );
    assert!(guarded[0] <= capacity + rounding, "{}", guarded[0]);
    assert!(
        guarded[0] > 0.5 * capacity,
        "the way is no test: {}",
        guarded[0]
    );
    assert!(guarded[1] > 5.0 * capacity);
    assert!(apart > 1.5 * capacity);
}

#[test]
fn what_all_of_them_ask_for_is_limited_as_one_force() {
    let settings = Settings {
        law: LawKind::Spring,
        states: StatesKind::Measured,
        ..Settings::thesis()
    };
    let limit = Force::<Fixed32>::from_si(settings.force_limit).unwrap();
    let nested = [wall("0", Side::Above), wall("0.01", Side::Above)];
    let mut both = built::<Fixed32>(&settings, &nested, Some(&detents()));
    // 0.06 rad deep: springs give 0.3 and 0.25 N·m, and detents push as well.
    let deep = (0.06 / COUNT_RAD) as i64;
    assert_eq!(both.tick(&at(deep), None), limit);
    let images = nested.each_ref().map(mirrored);
    let mut both = built::<Fixed32>(&settings, &images, None);
    assert_eq!(both.tick(&at(-deep), None), -limit);
    // Two walls that overlap from opposite sides push against each other.
    let facing = [wall("-0.02", Side::Above), wall("0.02", Side::Below)];
    let mut squeezed = built::<Fixed32>(&settings, &facing, None);
    assert_eq!(squeezed.tick(&at(0), None), Force::zero());
}

#[test]
fn overspeed_between_two_walls_takes_the_force_away_for_good() {
    let mut settings = Settings::thesis();
    settings.guard.on = true;
    let walls = [wall("0.05", Side::Above), wall("-0.05", Side::Below)];
    let mut environment = built::<Fixed32>(&settings, &walls, Some(&detents()));
    for count in [0, 300, 350, 100, -150, -350] {
        environment.tick(&at(count), None);
    }
    assert!(
        !environment.tripped(),
        "4.4e-2 rad a tick are below 60 rad/s"
    );
    environment.tick(&at(350), None);
    assert!(environment.tripped());
    for _ in 0..100 {
        assert_eq!(environment.tick(&at(350), None), Force::zero());
    }
    let fresh = built::<Fixed32>(&settings, &walls, Some(&detents()));
    let again = fresh.resumed(&environment);
    assert!(!again.tripped());
    let account = |it: &Environment<Fixed32>| it.guard.unwrap().account();
    assert_eq!(account(&again), account(&environment));
    assert!(account(&again) < account(&fresh));
}

/// An encoder reading at this angle in rad, which is far from every wall.
struct Far(Si);
impl Reading<Fixed32> for Far {
    fn angle(&self) -> Si {
        self.0
    }
    fn penetration(&self, _: &Reached) -> Position<Fixed32> {
        Position::zero()
    }
}

/// Checks that there is no force at the end of the range of angles, after 340 million turns, because a motion beyond it would not
/// be counted.
#[test]
fn no_force_where_angles_end() {
    let mut settings = Settings::thesis();
    settings.guard.on = true;
    for side in [Si::ONE, -Si::ONE] {
        let mut environment = built::<Fixed32>(&settings, &[], Some(&detents()));
        let mut angle = si("2147481590");
        let mut pushes = 0;
        while angle < si("2147481600") {
            pushes += u32::from(environment.tick(&Far(angle * side), None) != Force::zero());
            assert!(!environment.tripped());
            angle += si("0.01");
        }
        assert!(pushes > 900, "{pushes}");
        for beyond in ["2147481600.01", "2147483647", "2147481000"] {
            environment.tick(&Far(si(beyond) * side), None);
            let force = environment.tick(&Far(si(beyond) * side), None);
            assert_eq!(force, Force::zero());
            assert!(environment.tripped());
        }
    }
}

#[test]
fn a_knob_turns_on_without_end() {
    // 12,000 rad, beyond the positions of every format.
    let mut settings = Settings::thesis();
    settings.guard.on = true;
    let mut environment = built::<Fixed16>(&settings, &[], Some(&detents()));
    let mut count = 0;
    let mut pushes = 0;
    for _ in 0..260_000 {
        count += 300;
        let force = environment.tick(&at(count), None);
        pushes += u32::from(force != Force::zero());
        assert!(force.to_f64().abs() <= 0.03);
    }
    assert!(!environment.tripped() && pushes > 200_000);
}

/// The further parts of a feel at their strongest (spring, damper, dry friction, clicks, inertia) for odd seeds; none for even
/// seeds.
fn hostile_feel(settings: &Settings, seed: u64) -> FeelSettings {
    if seed.is_multiple_of(2) {
        return FeelSettings::default();
    }
    let strength = settings.force_limit;
    let bandwidth_hz = si("500");
    let viscous = ViscousSettings {
        damping: Si::ZERO,
        bandwidth_hz,
    };
    // The viscous friction has all the accepted damping, or a quarter of it, which leaves some for the mass.
    let damping = viscous.most(settings) / (1 + 3 * (i64::from(seed % 4 == 1)));
    let mut inertia = InertiaSettings {
        inertia: Si::ZERO,
        bandwidth_hz: si("5"),
    };
    inertia.inertia = inertia.heaviest(settings, damping);
    FeelSettings {
        spring: Some(CentreSettings {
            centre: si("0.05"),
            stiffness: si("100"),
            strength,
        }),
        viscous: Some(ViscousSettings {
            damping,
            bandwidth_hz,
        }),
        dry: Some(DrySettings {
            strength,
            stretch: si("0.02"),
        }),
        click: Some(ClickSettings {
            spacing: Spacing::PerTurn(1 + (seed as u16 * 13) % 900),
            centre: Si::ZERO,
            strength,
            duration_s: si("0.001"),
        }),
        inertia: Some(inertia),
    }
}

/// Checks that an environment computes the same as the proved stage [`Guarded::tick`]. For a force of one sign, force, account and
/// over-speed are those of the stage at the same positions, bit for bit. For the other sign they are those of the mirrored motion.
///
/// [`Guarded::tick`]: touchstone_control::Guarded::tick
#[test]
fn the_books_are_those_of_the_proved_stage() {
    let mut settings = guarded_spring();
    settings.guard.share_of_damping = si("0.8");
    let step = Si::from_bits(1 << 8);
    let (mut limited, mut trips) = (0, 0);
    for seed in 0..60_u64 {
        let sign = [1_i64, -1][seed as usize % 2];
        let mut random = Random::new(7_000 + seed);
        // Points of one sign; a point below 0 pushes against +x.
        let points: Vec<i16> = (0..16)
            .map(|_| -(random.whole(i32::from(WHOLE)).abs() * sign as i32) as i16)
            .collect();
        let profile = ProfileSettings {
            extent: Extent::PerTurn(5),
            start: si("0"),
            strength: settings.force_limit,
            shape: Shape::new(&points).unwrap(),
        };
        let made = |settings: &Settings| {
            built::<Fixed32>(settings, &[], None)
                .with_profile(&profile, settings.force_limit)
                .unwrap()
        };
        let mut open = settings;
        open.guard.on = false;
        let (mut environment, mut wanted) = (made(&settings), made(&open));
        let mut stage = environment.guard.unwrap();
        let seen = |x: Position<Fixed32>| if sign < 0 { -x } else { x };
        let mut count = 0_i64;
        for tick in 0..3_000 {
            // Within the range of positions; in some runs faster than the guard allows, once.
            let fast = if seed % 5 == 0 && tick == 2_000 {
                500
            } else {
                60
            };
            count += i64::from(random.whole(fast));
            if fast == 500 {
                count += 500;
            }
            let here = at(count);
            let e = Position::from_si(Reading::<Fixed32>::on_steps(&here, step)).unwrap();
            let since = (seed % 3 == 0)
                .then(|| Position::from_si(COUNT.saturating_mul(Si::from_num(random.whole(20)))))
                .flatten();
            let force = environment.tick(&here, since);
            let asked = wanted.tick(&here, None);
            let asked = if sign < 0 { -asked } else { asked };
            let at_change = since.map(|since| seen(e - since));
            let alone = stage.tick(seen(e), at_change, asked);
            assert_eq!(
                force,
                if sign < 0 { -alone } else { alone },
                "{seed} {tick}"
            );
            let guard = environment.guard.unwrap();
            assert_eq!(guard.account(), stage.account(), "{seed} {tick}");
            assert_eq!(guard.tripped, stage.tripped, "{seed} {tick}");
            limited += u32::from(guard.limited);
        }
        trips += u32::from(stage.tripped);
    }
    assert!(
        limited > 1_000 && (6..60).contains(&trips),
        "{limited} {trips}"
    );
}

/// Checks the energy guard's bound for 400 torque profiles with random points, each between two walls, half of them with
/// [`hostile_feel`]. A hand moves randomly, up to the over-speed limit of 0.06 rad per control period. Such a profile changes its
/// force between any two positions, as a hostile force field would.
#[test]
fn one_account_answers_for_hostile_profiles() {
    let settings = guarded_spring();
    let (capacity, refill) = (0.02, 0.0005 / 1000.0);
    let rounding = settings.force_limit.to_num::<f64>() * COUNT_RAD;
    let walls = [wall("0.2", Side::Above), wall("-0.2", Side::Below)];
    let (mut guarded, mut bare) = (0.0_f64, 0.0_f64);
    for seed in 0..400 {
        let mut random = Random::new(9_000 + seed);
        let points: Vec<i16> = (0..2 + seed as usize % (MOST_POINTS - 1))
            .map(|_| random.whole(i32::from(WHOLE)) as i16)
            .collect();
        let extent = match seed % 3 {
            0 => Extent::Until(si("0.21")),
            1 => Extent::PerTurn(1 + (seed as u16 * 7) % 200),
            _ => Extent::PerTurn(1),
        };
        let profile = ProfileSettings {
            extent,
            start: si("-0.2"),
            strength: settings.force_limit,
            shape: Shape::new(&points).unwrap(),
        };
        let made = |settings: &Settings| {
            built::<Fixed32>(settings, &walls, None)
                .with_profile(&profile, settings.force_limit)
                .unwrap()
                .with_feel(&hostile_feel(settings, seed), settings)
                .unwrap()
        };
        let mut open = settings;
        open.guard.on = false;
        let mut both = [made(&settings), made(&open)];
        let mut audits = [Audit::new(), Audit::new()];
        let (mut offset, mut width) = (0.0, 0.0);
        let (mut centre, mut target) = (0.0_f64, 0.0);
        for tick in 0..4_000_u32 {
            if tick.is_multiple_of(500) {
                width = [0.0299, 0.02, 0.01, 0.004][random.bits() as usize % 4];
                target = 0.21 * random.real();
            }
            // To and fro between two places, now and then from another pair of places.
            offset = if tick.is_multiple_of(2) && !tick.is_multiple_of(50) {
                -offset
            } else {
                width * random.real()
            };
            centre += (target - centre).clamp(-1e-4, 1e-4);
            let x = centre + offset;
            let here = at((x / COUNT_RAD).round() as i64);
            for (environment, audit) in both.iter_mut().zip(&mut audits) {
                audit.step(x, environment.tick(&here, None).to_f64(), refill);
            }
        }
        guarded = guarded.max(audits[0].worst);
        bare = bare.max(audits[1].worst);
    }
    println!(
        "worst of 400 profiles: guarded {:.2} mJ, without a guard {:.0} mJ, promised {:.0} mJ",
        1e3 * guarded,
        1e3 * bare,
        1e3 * capacity
    );
    assert!(guarded <= capacity + rounding, "{guarded} J");
    assert!(guarded > 0.8 * capacity, "the hand is no test: {guarded} J");
    assert!(bare > 20.0 * capacity, "{bare} J");
}
