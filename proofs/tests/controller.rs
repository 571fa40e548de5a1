//! Tests that the controller runs its parts in order (states, surface, law, pulse at the touch, guard), and passes to each what it needs.

use touchstone_control::estimator::EstimatorState;
use touchstone_control::law::{Impact, YieldingSurface};
use touchstone_control::{
    AnyLaw, Controller, Field, Fixed16, Fixed32, Force, Guard, GuardSettings, Guarded, LawKind,
    Position, Settings, SettingsError, Si, States, StatesKind,
};
use touchstone_proofs::spec::hands::{Hand, Random, any_law, bits};

const KINDS: [LawKind; 6] = [
    LawKind::SpringDamper,
    LawKind::Tdpa,
    LawKind::Fba,
    LawKind::Sfa,
    LawKind::SfaContinuous,
    LawKind::EnhancedSfa,
];

/// Random settings of a law, with or without a guard.
fn any(random: &mut Random) -> Settings {
    let kind = KINDS[random.below(KINDS.len() as u64) as usize];
    let on = random.below(2) == 0;
    Settings {
        guard: GuardSettings {
            on,
            ..Settings::default().guard
        },
        states: [StatesKind::Measured, StatesKind::Estimated][random.below(2) as usize],
        ..any_law(random, kind)
    }
}

#[test]
fn a_tick_is_the_law_and_then_the_guard() {
    let mut random = Random(11);
    let (mut compared, mut limited, mut tripped, mut estimated) = (0, 0, 0, 0);
    while compared < 60_000 {
        let settings = any(&mut random);
        let (Ok(mut wall), Ok(mut law), Ok(mut impact)) = (
            Controller::<Fixed32>::new(&settings),
            AnyLaw::<Fixed32>::new(&settings),
            Impact::<Fixed32>::pulse_of(&settings),
        ) else {
            continue;
        };
        let guard = Guard::new(&settings.guard, &settings.guarded_device());
        let mut guard = settings
            .guard
            .on
            .then(|| Guarded::new(guard.expect("a controller was made of it")));
        let mut surface = YieldingSurface::<Fixed32>::surface_of(&settings).expect("as the law");
        let mut states = match settings.states {
            StatesKind::Measured => States::<Fixed32>::default(),
            StatesKind::Estimated => {
                let told = &settings.estimator;
                let estimator = told.estimator(settings.rate_hz, settings.force_limit);
                let estimator = estimator.expect("a controller was made of it");
                States::Estimated(estimator, EstimatorState::default())
            }
        };
        estimated += u64::from(settings.states == StatesKind::Estimated);
        assert!(!wall.tripped() && (wall.guard.is_some() == settings.guard.on));
        let mut hand = Hand::any(&mut random);
        let mut force = Force::<Fixed32>::zero();
        for tick in 0..300 {
            compared += 1;
            let (e, _) = hand.moves(&mut random, tick, i128::from(force.0.to_bits()));
            let e = Position(e);
            states.commanded(force);
            let sample = surface.from_surface(states.sample(e));
            let mut wanted = law.tick(sample);
            surface.give_way(sample, wanted);
            if let Some(impact) = &mut impact {
                wanted = impact.with_pulse_and_vibration(sample, wanted);
            }
            force = match &mut guard {
                Some(guard) => guard.tick(e, None, wanted),
                None => wanted,
            };
            assert_eq!(wall.tick(e), force, "{settings:?}");
            assert_eq!(wall.view(), law.view());
            assert_eq!((wall.states, wall.guard), (states, guard));
            assert_eq!(wall.surface, surface);
            assert_eq!(wall.tripped(), guard.is_some_and(|it| it.tripped));
            limited += u64::from(force != wanted);
            tripped += u64::from(wall.tripped());
            if random.below(16) == 0 {
                let told = Force(bits(random.signed(24)));
                wall.commanded(told);
                if let Some(Guarded { guard, state, .. }) = &mut guard {
                    guard.commanded(state, told);
                }
                assert_eq!(wall.guard, guard);
                force = told;
            }
        }
        let fresh = Controller::<Fixed32>::new(&settings).expect("it was accepted before");
        let mut again = wall;
        again.resume(&fresh);
        assert_eq!((again.law, again.states), (fresh.law, fresh.states));
        assert!(!again.tripped());
        if let (Some(before), Some(after)) = (&wall.guard, &again.guard) {
            assert_eq!(after.state.account, before.state.account);
        }
    }
    assert!(limited > 1000 && tripped > 1000, "{limited} {tripped}");
    assert!(estimated > 20, "{estimated}");
}

/// Checks that the configured damping of the device becomes a coefficient of the TDPA law only if the law is configured to count
/// it.
#[test]
fn tdpa_counts_the_device_s_damping_only_where_it_is_told_to() {
    let settings = |count_device_damping| Settings {
        law: LawKind::Tdpa,
        device_damping: Si::from_num(1) / 1000,
        count_device_damping,
        ..Settings::thesis()
    };
    let damping = |counts| match AnyLaw::<Fixed32>::new(&settings(counts)) {
        Ok(AnyLaw::Tdpa(law, _)) => i64::from(law.device_damping.0.to_bits()),
        other => panic!("{other:?}"),
    };
    // 0.001 in 32 bits is a little less than 0.001; times 1 kHz it is one step of the gain's format below 1.
    assert_eq!((damping(true), damping(false)), (4095, 0));
}

/// Checks equation (2.14a) of the thesis: in a tick with a motion inward, the offset of the soft spring moves by `k_c/k_v - 1`
/// times the displacement. `k_c` is the critical stiffness, `k_v` the soft stiffness. If that factor is negative, the offset does
/// not move.
#[test]
fn the_offset_s_step_is_what_the_device_s_damping_makes_up_for() {
    let gain = |damping: &str| {
        let settings = Settings {
            law: LawKind::Sfa,
            device_damping: damping.parse().expect("a number"),
            ..Settings::thesis()
        };
        match AnyLaw::<Fixed32>::new(&settings) {
            Ok(AnyLaw::Sfa(law, _)) => law.gain.0.to_num::<f64>(),
            other => panic!("{other:?}"),
        }
    };
    // 2 c/T over 0.8 N·m/rad, at 1 kHz.
    assert!((gain("0.0005") - 0.25).abs() < 1e-6);
    assert!((gain("0.001") - 1.5).abs() < 1e-6);
    assert!(gain("0.0001").abs() < 1e-12);
}

#[test]
fn a_coupling_that_a_format_rounds_to_nothing_is_refused() {
    let of = |stiffness: &str| {
        let mut settings = Settings::thesis();
        settings.filter.stiffness = stiffness.parse().expect("a number");
        settings.k_desired = "0.0149".parse().expect("a number");
        settings.k_soft = "0.0148".parse().expect("a number");
        settings
    };
    // One step of a gain's format in 16 bits is 1/64; a smaller stiffness is refused.
    let soft = of("0.015");
    let of_32 = AnyLaw::<Fixed32>::new(&soft);
    assert!(of_32.is_ok(), "{of_32:?}");
    let refused = AnyLaw::<Fixed16>::new(&soft);
    assert!(
        matches!(
            refused,
            Err(SettingsError::OutOfFormat {
                field: Field::FilterStiffness,
                ..
            })
        ),
        "{refused:?}"
    );
}
