//! Walls on both sides, several walls and detents: what they promise together, over hostile motions and every law.

use touchstone_control::environment::{
    Counted, DetentSettings, Environment, Face, MOST_WALLS, Reading, Refused, Side, WallSettings,
};
use touchstone_control::{
    Controller, CountScale, Fixed16, Fixed32, Force, LawKind, Position, Reported, Settings, Si,
    StatesKind,
};
use touchstone_tests::random::Random;
use touchstone_tests::si::si;

const COUNTS: u32 = 40_000;
const COUNT_RAD: f64 = std::f64::consts::TAU / 40_000.0;

fn encoder() -> CountScale {
    CountScale::new(COUNTS, Si::ZERO).unwrap()
}

fn wall(surface: &str, side: Side) -> WallSettings {
    WallSettings {
        face: Face {
            surface: si(surface),
            side,
        },
        k_desired: si("5"),
    }
}

fn mirrored(wall: &WallSettings) -> WallSettings {
    let side = match wall.face.side {
        Side::Above => Side::Below,
        Side::Below => Side::Above,
    };
    let surface = -wall.face.surface;
    WallSettings {
        face: Face { surface, side },
        ..*wall
    }
}

/// 12 to a half turn, one of them where no count is.
fn detents() -> DetentSettings {
    DetentSettings {
        pitch: si("0.2617994"),
        strength: si("0.03"),
        centre: si("0.01234567"),
    }
}

/// Ways of a hand over some counts: slow and fast, to and fro, with jumps over a wall.
fn path(seed: u64, ticks: usize, reach: i64) -> Vec<i64> {
    let mut random = Random::new(seed);
    let (mut at, mut speed) = (0_i64, 0_i32);
    (0..ticks)
        .map(|_| {
            match random.bits() % 64 {
                0 => at += i64::from(random.whole(150)),
                1..=3 => speed = random.whole(40),
                4 => speed = 0,
                _ => {}
            }
            at = (at + i64::from(speed) + i64::from(random.whole(1))).clamp(-reach, reach);
            at
        })
        .collect()
}

fn laws() -> Vec<Settings> {
    let mut all = Vec::new();
    for law in <LawKind as touchstone_control::Choice>::ALL {
        for states in [StatesKind::Measured, StatesKind::Estimated] {
            let mut settings = Settings {
                law: *law,
                states,
                ..Settings::thesis()
            };
            settings.guard.on = true;
            all.push(settings);
        }
    }
    all
}

fn built<N: Reported>(
    settings: &Settings,
    walls: &[WallSettings],
    detents: Option<&DetentSettings>,
) -> Environment<N> {
    Environment::new(settings, walls, detents).unwrap_or_else(|e| panic!("{e}"))
}

fn at(count: i64) -> Counted {
    Counted {
        scale: encoder(),
        count,
    }
}

#[test]
fn a_mirrored_environment_answers_a_mirrored_motion_with_mirrored_forces() {
    fn body<N: Reported>() {
        let walls = [
            wall("0.05", Side::Above),
            wall("-0.031", Side::Below),
            wall("0.09", Side::Above),
        ];
        let images = walls.each_ref().map(mirrored);
        let detent = detents();
        let image = DetentSettings {
            centre: -detent.centre,
            ..detent
        };
        for (seed, mut settings) in (1..).zip(laws()) {
            // A guard that has to limit, and one that has not: its roundings must be mirrored as well.
            settings.guard.capacity = si(if seed % 2 == 0 { "0.001" } else { "0.045" });
            // And one that answers for a late force, whose share of a displacement is rounded.
            settings.guard.delay = si(if seed % 3 == 0 { "0.0004" } else { "0" });
            let mut here = built::<N>(&settings, &walls, Some(&detent));
            let mut there = built::<N>(&settings, &images, Some(&image));
            let (mut limited, mut pushed) = (0, [0, 0]);
            for count in path(seed, 4_000, 700) {
                let (f, g) = (here.tick(&at(count), None), there.tick(&at(-count), None));
                assert_eq!(f, -g, "{:?} {:?} {count}", settings.law, settings.states);
                limited += u32::from(here.guard.as_ref().is_some_and(|it| it.limited));
                pushed[usize::from(f > Force::zero())] += 1;
            }
            assert!(pushed[0] > 300 && pushed[1] > 300, "{pushed:?}");
            assert!(seed % 2 == 1 || limited > 50, "{limited}");
        }
    }
    body::<Fixed32>();
    body::<Fixed16>();
    body::<f64>();
}

#[test]
fn two_walls_are_two_scenes() {
    // Gentle enough for the account to pay for everything, and not to be seen in any force.
    for mut settings in laws() {
        settings.guard.capacity = si("8");
        settings.guard.overspeed = si("900");
        settings.force_limit = si("0.5");
        let (right, left) = ("0.05", "-0.031");
        let mut both = built::<Fixed32>(
            &settings,
            &[wall(right, Side::Above), wall(left, Side::Below)],
            None,
        );
        let mut alone = built::<Fixed32>(&settings, &[wall(right, Side::Above)], None);
        let mut controllers = [(); 2].map(|()| Controller::<Fixed32>::new(&settings).unwrap());
        let scales = [si(right), -si(left)].map(|surface| encoder().before(surface));
        let mut touched = [0, 0];
        for count in path(3, 6_000, 500) {
            let ways = [count, -count];
            let mut forces = [Force::zero(); 2];
            for ((controller, scale), (way, force)) in controllers
                .iter_mut()
                .zip(&scales)
                .zip(ways.iter().zip(&mut forces))
            {
                *force = controller.tick(scale.penetration(*way));
            }
            // One estimator must not be told of a force that another scene has; where both push it is told of both.
            let together = both.tick(&at(count), None);
            assert_eq!(alone.tick(&at(count), None), forces[0], "{settings:?}");
            if settings.states == StatesKind::Measured {
                assert_eq!(together, forces[0] - forces[1], "{:?}", settings.law);
            }
            for (touched, force) in touched.iter_mut().zip(forces) {
                *touched += u32::from(force > Force::zero());
            }
        }
        assert!(touched[0] > 300 && touched[1] > 300, "{touched:?}");
    }
}

/// On estimated states each wall has an estimator that knows every force: as long as only one wall was ever touched, it says what that
/// wall's own scene says.
#[test]
fn a_wall_that_is_not_touched_is_not_there() {
    let settings = Settings::default();
    let far = [wall("0.05", Side::Above), wall("-2", Side::Below)];
    let mut both = built::<Fixed32>(&settings, &far, None);
    let mut own = Controller::<Fixed32>::new(&settings).unwrap();
    let scale = encoder().before(si("0.05"));
    let mut touched = 0;
    for n in 0..4_000_i32 {
        let count = (330.0 + 60.0 * (f64::from(n) / 80.0).sin()) as i64;
        let force = own.tick(scale.penetration(count));
        assert_eq!(both.tick(&at(count), None), force, "{n}");
        touched += u32::from(force > Force::zero());
    }
    assert!(touched > 1_000);
}

#[test]
fn detents_are_a_triangle_with_no_work_over_a_pitch() {
    fn body<N: Reported>(step: f64) {
        let quiet = Settings::thesis();
        let detent = detents();
        let (pitch, strength, centre) = (0.261_799_4, 0.03, 0.012_345_67);
        let triangle = |x: f64| {
            let beyond = (x - centre) / pitch;
            let beyond = beyond - beyond.round();
            let share = if beyond.abs() <= 0.25 {
                beyond
            } else {
                beyond.signum() * (0.5 - beyond.abs())
            };
            4.0 * strength * share
        };
        let mut environment = built::<N>(&quiet, &[], Some(&detent));
        // The pitch is known to 2^-33 rad and its inverse to as much: 20,000 turns away, to 5e-4 of a pitch.
        for turn in [0_i64, 1, -1, 50, -50, 20_000] {
            let from = turn * i64::from(COUNTS);
            let mut work = 0.0;
            let mut largest = 0.0_f64;
            for count in from - 833..from + 833 {
                let x = count as f64 * COUNT_RAD;
                let force = environment.tick(&at(count), None).to_f64();
                let drift = 4.0 * strength * (turn.unsigned_abs() as f64 * 24.0) * 2f64.powi(-30);
                assert!(
                    (force - triangle(x)).abs() < step + drift + 1e-9,
                    "{turn} {count}: {force} {}",
                    triangle(x)
                );
                largest = largest.max(force.abs());
                work += force * COUNT_RAD;
            }
            // Over the 1666 counts of a pitch: half a count's force at each end, and a step of each force.
            assert!(work.abs() < strength * COUNT_RAD + step * pitch, "{work}");
            assert!(largest <= strength && largest > strength * (1.0 - 0.02));
        }
    }
    body::<Fixed32>(2.0 * 2f64.powi(-24));
    body::<Fixed16>(2.0 * 2f64.powi(-14));
    body::<f64>(2f64.powi(-31));
}

/// What a hand got out of the motor so far, J, at the true positions.
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

    /// Moved to here under the last force; another takes its place. `refill` is what may be had for nothing in a tick.
    fn step(&mut self, at: f64, force: f64, refill: f64) {
        // A force against +x is work for the hand on the way to -x.
        self.taken -= self.force * (at - self.at) + refill;
        self.least = self.least.min(self.taken);
        self.worst = self.worst.max(self.taken - self.least);
        (self.force, self.at) = (force, at);
    }
}

/// Into one wall within a tick and out within the next, then into the other one: every wall pays for each way out what nobody put in.
#[test]
fn one_account_answers_for_all_walls_and_detents() {
    let mut settings = Settings {
        law: LawKind::Spring,
        states: StatesKind::Measured,
        k_desired: si("5"),
        ..Settings::thesis()
    };
    settings.guard.on = true;
    settings.guard.capacity = si("0.02");
    settings.guard.share_of_damping = si("0");
    let capacity = 0.02;
    let refill = 0.0005 / 1000.0;
    // Half a count at each end of a window under the largest force that the account can pay for.
    let rounding = 0.34 * COUNT_RAD;
    let walls = [wall("0.005", Side::Above), wall("-0.005", Side::Below)];
    let (mut guarded, mut apart) = ([0.0_f64; 2], 0.0_f64);
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let mut open = settings;
        open.guard.on = false;
        let mut one = built::<Fixed32>(&settings, &walls, Some(&detents()));
        let mut bare = built::<Fixed32>(&open, &walls, Some(&detents()));
        // What two guards would let through: a controller with a guard a wall.
        let mut each = walls.map(|wall| built::<Fixed32>(&settings, &[wall], None));
        let mut audits = [Audit::new(), Audit::new(), Audit::new()];
        for tick in 0..4_000_u32 {
            let side = if seed % 2 == 0 {
                // Each wall in turn, for as long as its own account would last.
                if (tick / 400).is_multiple_of(2) {
                    1.0
                } else {
                    -1.0
                }
            } else {
                random.real().signum()
            };
            // Deep in one tick, on the surface in the next, anywhere within a count.
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
    // 0.06 rad deep: 0.3 and 0.25 N·m of springs, and detents that push as well.
    let deep = (0.06 / COUNT_RAD) as i64;
    assert_eq!(both.tick(&at(deep), None), limit);
    let images = nested.each_ref().map(mirrored);
    let mut both = built::<Fixed32>(&settings, &images, None);
    assert_eq!(both.tick(&at(-deep), None), -limit);
    // Two that overlap from either side push against each other.
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

/// An angle, far from every wall.
struct Far(Si);
impl Reading<Fixed32> for Far {
    fn angle(&self) -> Si {
        self.0
    }
    fn penetration(&self, _: &Face) -> Position<Fixed32> {
        Position::zero()
    }
}

/// After 340 million turns angles end; a motion there would not be counted.
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
    // 12,000 rad: beyond what a position of any format can hold.
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

#[test]
fn what_cannot_be_is_refused_by_name() {
    let refused = |settings: &Settings, walls: &[WallSettings], detents: &DetentSettings| {
        Environment::<Fixed32>::new(settings, walls, Some(detents)).unwrap_err()
    };
    let (plain, good) = (Settings::thesis(), detents());
    let many = [wall("0", Side::Above); MOST_WALLS + 1];
    assert_eq!(refused(&plain, &many, &good), Refused::TooManyWalls);
    let mut stiff = wall("0", Side::Below);
    stiff.k_desired = si("500001");
    let two = [wall("0", Side::Above), stiff];
    assert!(matches!(refused(&plain, &two, &good), Refused::Wall(1, _)));
    for pitch in ["0.0009", "6.3", "0", "-1"] {
        let pitch = si(pitch);
        assert_eq!(
            refused(&plain, &[], &DetentSettings { pitch, ..good }),
            Refused::Pitch(pitch)
        );
    }
    for strength in ["-0.001", "0.500001"] {
        let strength = si(strength);
        let with = DetentSettings { strength, ..good };
        assert!(matches!(
            refused(&plain, &[], &with),
            Refused::Strength { .. }
        ));
    }
    for error in [
        refused(&plain, &two, &good),
        refused(&plain, &many, &good),
        refused(
            &plain,
            &[],
            &DetentSettings {
                pitch: si("7"),
                ..good
            },
        ),
    ] {
        touchstone_tests::si::assert_one_line(&error.to_string());
    }
}

#[test]
fn a_reading_is_odd() {
    let both = [Side::Above, Side::Below];
    let mut random = Random::new(2);
    for _ in 0..20_000 {
        let count = i64::from(random.whole(1 << 30)) << (random.bits() % 20);
        let (here, there) = (at(count), at(-count));
        let angle = |it: &Counted| Reading::<Fixed32>::angle(it);
        assert_eq!(angle(&here), -angle(&there));
        for side in both {
            let face = Face {
                surface: Si::from_num(random.real()),
                side,
            };
            let image = mirrored(&WallSettings {
                face,
                k_desired: Si::ZERO,
            })
            .face;
            let here: Position<Fixed32> = here.penetration(&face);
            assert_eq!(here, there.penetration(&image));
        }
    }
}
