//! Tests of the parts of a knob's feel beside walls, detents and profile: spring to a centre, viscous and dry friction, click, and
//! what these share with inertia.

use touchstone_control::environment::{
    CentreSettings, ClickSettings, DrySettings, FeelSettings, InertiaSettings, Refused, Spacing,
    ViscousSettings,
};
use touchstone_control::{Fixed16, Fixed32, Force, Reported, Si};
use touchstone_tests::environment::{COUNT_RAD, COUNTS, at, built, feeling, unguarded};
use touchstone_tests::random::Random;
use touchstone_tests::si::si;

const RATE_HZ: f64 = 1000.0;

fn all() -> FeelSettings {
    FeelSettings {
        spring: Some(CentreSettings {
            centre: si("0.3"),
            stiffness: si("0.4"),
            strength: si("0.03"),
        }),
        viscous: Some(ViscousSettings {
            damping: si("0.002"),
            bandwidth_hz: si("100"),
        }),
        dry: Some(DrySettings {
            strength: si("0.01"),
            stretch: si("0.02"),
        }),
        click: Some(ClickSettings {
            spacing: Spacing::PerTurn(24),
            centre: si("0.05"),
            strength: si("0.02"),
            duration_s: si("0.006"),
        }),
        inertia: Some(InertiaSettings {
            inertia: si("0.00002"),
            bandwidth_hz: si("12"),
        }),
    }
}

/// Each part alone, with its name.
fn each() -> [(&'static str, FeelSettings); 5] {
    let all = all();
    let none = FeelSettings::default();
    [
        (
            "spring",
            FeelSettings {
                spring: all.spring,
                ..none
            },
        ),
        (
            "viscous",
            FeelSettings {
                viscous: all.viscous,
                ..none
            },
        ),
        (
            "friction",
            FeelSettings {
                dry: all.dry,
                ..none
            },
        ),
        (
            "click",
            FeelSettings {
                click: all.click,
                ..none
            },
        ),
        (
            "inertia",
            FeelSettings {
                inertia: all.inertia,
                ..none
            },
        ),
    ]
}

/// Counts of a motion to and fro of random speeds, up to some counts per tick.
fn hand(seed: u64, ticks: usize, fastest: i32) -> Vec<i64> {
    let mut random = Random::new(seed);
    let (mut count, mut speed) = (0_i64, 0);
    let mut counts = Vec::new();
    for tick in 0..ticks {
        if tick % 60 == 0 {
            speed = random.whole(fastest);
        }
        count += i64::from(speed + random.whole(2));
        counts.push(count);
    }
    counts
}

#[test]
fn a_spring_draws_to_its_centre_as_far_as_the_knob_turns() {
    fn body<N: Reported>(step: f64) {
        let mut environment = feeling::<N>(&each()[0].1);
        for turns in [0, 1, -1, 25, -300, 10_000, 40_000_000] {
            for count in (-20_000..20_000_i64).step_by(97) {
                let count = count + turns * i64::from(COUNTS);
                let way = count as f64 * COUNT_RAD - 0.3;
                let expected = (0.4 * way).clamp(-0.03, 0.03);
                let force = environment.tick(&at(count), None).to_f64();
                assert!((force - expected).abs() <= step, "{force} for {expected}");
            }
        }
    }
    body::<Fixed32>(4.0 * 2f64.powi(-24));
    body::<Fixed16>(4.0 * 2f64.powi(-14));
    // Positions are rounded to steps of 2^-24 rad before the spring stretches.
    body::<f64>(0.4 * 2f64.powi(-24));
}

#[test]
fn viscous_friction_is_in_proportion_to_the_speed_and_ends_at_rest() {
    fn body<N: Reported>(share: f64, rest: usize) {
        let mut environment = feeling::<N>(&each()[1].1);
        for speed in [40_i64, -13, 250] {
            let mut force = 0.0;
            for tick in 0..100 {
                force = environment.tick(&at(speed * tick), None).to_f64();
            }
            let expected = 0.002 * speed as f64 * COUNT_RAD * RATE_HZ;
            assert!(
                (force / expected - 1.0).abs() <= share,
                "{force} for {expected}"
            );
            for _ in 0..rest {
                force = environment.tick(&at(speed * 99), None).to_f64();
            }
            assert_eq!(force, 0.0, "at rest");
        }
    }
    // Each of two products loses up to a step of the format, and the filter adds up 1/(1-a) = 2.6 of such losses.
    body::<Fixed32>(1e-3, 60);
    body::<Fixed16>(0.11, 60);
}

#[test]
fn dry_friction_is_a_spring_until_the_knob_slides() {
    let mut environment = feeling::<Fixed32>(&each()[2].1);
    let slack = 4.0 * 2f64.powi(-24);
    let mut friction = |count: i64| environment.tick(&at(count), None).to_f64();
    // A stretch of 0.02 rad is 127.3 counts.
    for count in 0..=127 {
        let expected = 0.5 * count as f64 * COUNT_RAD;
        let force = friction(count);
        // The product of stiffness and stretch is wrong by the coefficient's last digit.
        assert!((force - expected).abs() <= slack, "{force} for {expected}");
    }
    for count in 128..5_000 {
        assert!((friction(count) - 0.01).abs() <= slack);
    }
    // When the knob turns back, the spring of the friction relaxes first; the force reverses within twice the stretch.
    assert!(friction(4_999 - 127).abs() < 1e-4);
    assert!((friction(4_999 - 255) + 0.01).abs() <= slack);
    // And a knob at rest is held by the same force.
    let held = friction(4_700);
    for _ in 0..1_000 {
        assert_eq!(friction(4_700), held);
    }
}

/// Checks that dry friction gives no energy around any closed path beyond what its spring stores. Exception: sampling a spring of
/// stiffness `k` adds `k Δ²/2` in a tick with the displacement `Δ`.
#[test]
fn dry_friction_takes_energy() {
    let mut environment = feeling::<Fixed32>(&each()[2].1);
    let (mut taken, mut force, mut last, mut leak) = (0.0, 0.0, 0, 0.0);
    for count in hand(7, 40_000, 20) {
        let way = (count - last) as f64 * COUNT_RAD;
        taken += force * way;
        leak += 0.5 * 0.5 * way * way;
        assert!(taken + leak >= -1e-9, "{taken} J");
        (force, last) = (environment.tick(&at(count), None).to_f64(), count);
    }
    // The hand slides by more than 5 rad against 0.01 N·m.
    assert!(taken > 0.01 * 5.0, "{taken} J: the motion is no test");
}

#[test]
fn a_position_clicks_once_for_each_crossing() {
    let (_, click) = each()[3];
    let mut environment = feeling::<Fixed32>(&click);
    let pitch = f64::from(COUNTS) / 24.0;
    let first = (0.05 / COUNT_RAD).ceil() as i64;
    let pulse = Force::<Fixed32>::from_f64(0.02);
    let mut pulses = Vec::new();
    // Three positions upwards, 20 counts a tick.
    let from = first - 900;
    for tick in 0..260 {
        let force = environment.tick(&at(from + 20 * tick), None);
        if force != Force::zero() {
            pulses.push((tick, force));
        }
    }
    let crossed: Vec<i64> = (0..3)
        .map(|n| (900.0 + f64::from(n) * pitch).div_euclid(20.0) as i64)
        .collect();
    assert_eq!(pulses.len(), 3 * 6, "{pulses:?}");
    for (pulse_ticks, crossed) in pulses.chunks(6).zip(crossed) {
        assert!((pulse_ticks[0].0 - crossed).abs() <= 1, "{pulses:?}");
        for (n, (tick, force)) in pulse_ticks.iter().enumerate() {
            assert_eq!(*tick, pulse_ticks[0].0 + n as i64);
            // Against the motion first, then with it.
            assert_eq!(*force, if n < 3 { pulse } else { -pulse });
        }
    }
    // A knob that trembles on a position is quiet: it came from below, and clicks once.
    let mut heard = 0;
    for tick in 0..2_000 {
        let count = if tick < 20 {
            first - 600
        } else {
            first - 3 + tick % 7
        };
        heard += u32::from(environment.tick(&at(count), None) != Force::zero());
    }
    assert_eq!(heard, 6);
}

#[test]
fn mirrored_motions_have_mirrored_forces() {
    fn body<N: Reported>() {
        let mut image = all();
        let mirror = |centre: &mut Si| *centre = -*centre;
        image
            .spring
            .iter_mut()
            .for_each(|it| mirror(&mut it.centre));
        image.click.iter_mut().for_each(|it| mirror(&mut it.centre));
        let (mut here, mut there) = (feeling::<N>(&all()), feeling::<N>(&image));
        for count in hand(3, 20_000, 60) {
            let (f, g) = (here.tick(&at(count), None), there.tick(&at(-count), None));
            assert_eq!(f, -g, "{count}");
        }
    }
    body::<Fixed32>();
    body::<Fixed16>();
    body::<f64>();
}

#[test]
fn every_turn_is_alike() {
    for (name, feel) in each().into_iter().skip(1) {
        let (mut here, mut there) = (feeling::<Fixed32>(&feel), feeling::<Fixed32>(&feel));
        for count in hand(5, 20_000, 60) {
            let far = count + 10_000 * i64::from(COUNTS);
            assert_eq!(
                here.tick(&at(count), None),
                there.tick(&at(far), None),
                "{name} at {count}"
            );
        }
    }
}

/// Checks that no part pushes harder than its settings allow, and that all parts together give the sum of the parts' forces, within
/// the force limit.
#[test]
fn the_parts_add_up_within_their_strengths() {
    let mut together = feeling::<Fixed32>(&all());
    let mut apart = each().map(|(_, feel)| feeling::<Fixed32>(&feel));
    let limit = unguarded().force_limit.to_num();
    let most = [0.03, limit, 0.01, 0.02, limit];
    let mut reached = [0.0_f64; 5];
    for count in hand(11, 60_000, 400) {
        let mut sum = Force::zero();
        for ((environment, most), reached) in apart.iter_mut().zip(most).zip(&mut reached) {
            let force = environment.tick(&at(count), None);
            assert!(force.to_f64().abs() <= most);
            *reached = reached.max(force.to_f64().abs());
            sum = sum + force;
        }
        let limit = Force::<Fixed32>::from_si(unguarded().force_limit).unwrap();
        assert_eq!(together.tick(&at(count), None), sum.within(limit));
    }
    // A leap to count 40,000 in a tick, for the damper and the mass.
    for part in [1, 4] {
        let leap = apart[part].tick(&at(i64::from(COUNTS)), None).to_f64();
        reached[part] = reached[part].max(leap.abs());
        assert!(reached[part] <= most[part]);
    }
    for (reached, most) in reached.iter().zip(most) {
        assert!(*reached > 0.99 * most, "{reached} of {most}");
    }
}

#[test]
fn no_parts_change_nothing() {
    let (mut with, mut without) = (
        feeling::<Fixed32>(&FeelSettings::default()),
        built::<Fixed32>(&unguarded(), &[], None),
    );
    assert_eq!(with, without);
    for count in hand(2, 500, 300) {
        assert_eq!(with.tick(&at(count), None), without.tick(&at(count), None));
    }
    assert_eq!(with, without);
}

#[test]
fn settings_out_of_range_are_refused_with_their_path() {
    let settings = unguarded();
    let limit = settings.force_limit;
    let over = limit + Si::DELTA;
    let refused = |change: &dyn Fn(&mut FeelSettings)| {
        let mut feel = all();
        change(&mut feel);
        match feel.feel::<Fixed32>(&settings) {
            Err(Refused::Part { path, .. }) => path.trim_start_matches("environment.").to_owned(),
            other => panic!("{other:?}"),
        }
    };
    macro_rules! refuses {
        ($($part:ident.$field:ident = $($value:expr),+ => $path:literal;)+) => {
            $($(assert_eq!(
                refused(&|feel| feel.$part.iter_mut().for_each(|it| it.$field = $value)),
                $path
            );)+)+
        };
    }
    let damper = all().viscous.unwrap();
    let most = damper.most(&settings);
    let heaviest = all().inertia.unwrap().heaviest(&settings, damper.damping);
    assert!(heaviest > si("0.00003"), "{heaviest}");
    refuses! {
        spring.stiffness = si("-0.001"), si("100.001") => "spring.stiffness_n_m_per_rad";
        spring.strength = -Si::DELTA, over => "spring.strength_n_m";
        viscous.damping = -Si::DELTA, most + Si::DELTA => "damper.damping_n_m_s_per_rad";
        viscous.bandwidth_hz = si("4.99"), si("500.01") => "damper.bandwidth_hz";
        dry.strength = -Si::DELTA, over => "dry_friction.strength_n_m";
        dry.stretch = si("0.00099"), si("1.001") => "dry_friction.stretch_rad";
        click.spacing = Spacing::PerTurn(0), Spacing::PerTurn(6284) => "click.per_rev";
        click.spacing = Spacing::Pitch(si("0.00099")), Spacing::Pitch(si("6.29")) => "click.pitch_rad";
        click.strength = -Si::DELTA, over => "click.strength_n_m";
        click.duration_s = si("0.00099"), si("0.101") => "click.duration_s";
        inertia.inertia = -Si::DELTA, heaviest + Si::DELTA => "inertia.inertia_kg_m2";
        inertia.bandwidth_hz = si("4.99"), si("30.01") => "inertia.bandwidth_hz";
    }
    // The ends themselves are accepted.
    let mut feel = all();
    feel.spring = Some(CentreSettings {
        centre: Si::MIN,
        stiffness: si("100"),
        strength: limit,
    });
    feel.inertia.as_mut().unwrap().inertia = heaviest;
    assert!(feel.feel::<Fixed32>(&settings).is_ok());
    // If the viscous friction has all the damping that is accepted, none is left for the mass.
    feel.viscous.as_mut().unwrap().damping = most;
    feel.inertia = None;
    feel.dry.as_mut().unwrap().stretch = Si::ONE;
    assert!(feel.feel::<Fixed32>(&settings).is_ok());
    // 16 bits have no coefficient above 2.
    feel.dry.as_mut().unwrap().stretch = si("0.001");
    match feel.feel::<Fixed16>(&settings) {
        Err(refused) => assert!(refused.to_string().contains("does not fit"), "{refused}"),
        Ok(_) => panic!("accepted"),
    }
}
