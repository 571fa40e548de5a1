//! Tests that the spring-damper with a velocity filter and its specification agree bit for bit, in force and whole memory. The
//! tests run every filter under random and hostile motions, for accepted settings of every size.

use touchstone_control::fixed::types::I8F24;
use touchstone_control::law::{Law as _, Sample};
use touchstone_control::velocity::{Velocity, VelocityState};
use touchstone_control::{
    AnyLaw, Fixed32, LawKind, Position, Settings, Si, VelocityKind, VelocitySettings,
};
use touchstone_proofs::estimated::motion;
use touchstone_proofs::spec::estimator::Motion;
use touchstone_proofs::spec::hands::{Hand, Random, any_law};
use touchstone_proofs::spec::velocity as spec;
use touchstone_proofs::spec::{Int, sfa};
use touchstone_proofs::specified::at32;

const KINDS: [VelocityKind; 4] = [
    VelocityKind::Filtered,
    VelocityKind::Kalman,
    VelocityKind::KalmanAcceleration,
    VelocityKind::Foaw,
];

fn wide(x: I8F24) -> Int {
    x.to_bits().into()
}

/// A velocity filter as the specification calculates it, with its memory.
enum Specified {
    Smoothed {
        share: Int,
        before: Option<Motion>,
    },
    Tracker {
        reach: Int,
        drift: Int,
        gains: [Int; 3],
        before: Option<Motion>,
    },
    Window {
        longest: usize,
        margin: Int,
        past: Option<[Int; spec::LONGEST]>,
    },
}

impl Specified {
    fn of(velocity: &Velocity<Fixed32>) -> Self {
        match velocity {
            Velocity::Smoothed(law) => Self::Smoothed {
                share: law.share.into(),
                before: None,
            },
            Velocity::Tracker(law) => Self::Tracker {
                reach: law.free.reach.into(),
                drift: law.free.drift.into(),
                gains: law.correction.map(Int::from),
                before: None,
            },
            Velocity::Window(law) => Self::Window {
                longest: law.longest.into(),
                margin: at32::position(law.margin),
                past: None,
            },
        }
    }

    fn tick(&mut self, at: Int) -> Int {
        match self {
            Self::Smoothed { share, before } => {
                let after = before.and_then(|before| spec::smoothed(*share, before, at));
                let (motion, told) = spec::told(after, at);
                *before = Some(motion);
                told
            }
            Self::Tracker {
                reach,
                drift,
                gains,
                before,
            } => {
                let after =
                    before.and_then(|before| spec::tracked(*reach, *drift, *gains, before, at));
                let (motion, told) = spec::told(after, at);
                *before = Some(motion);
                told
            }
            Self::Window {
                longest,
                margin,
                past,
            } => {
                let before = past.unwrap_or([at; spec::LONGEST]);
                let told = spec::window(&before, at, *longest, *margin);
                let mut after = [at; spec::LONGEST];
                after[1..].copy_from_slice(&before[..spec::LONGEST - 1]);
                *past = Some(after);
                told
            }
        }
    }

    fn remembers(&self, state: &VelocityState<Fixed32>) -> bool {
        match (self, state) {
            (
                Self::Smoothed { before, .. } | Self::Tracker { before, .. },
                VelocityState::Motion(found),
            ) => found.as_ref().map(motion) == *before,
            (Self::Window { past, .. }, VelocityState::Positions(found)) => {
                Some(found.map(at32::position)) == *past
            }
            _ => false,
        }
    }
}

#[test]
fn every_tick_of_a_damped_spring_is_its_specification() {
    for (kind, seed) in KINDS.into_iter().zip(21..) {
        let mut random = Random(seed);
        let (mut ticks, mut laws) = (0_u32, 0_u32);
        let (mut anew, mut pushes, mut moved) = (0_u32, 0_u32, 0_u32);
        while ticks < 300_000 {
            let law = any_law(&mut random, LawKind::SpringDamper);
            let rate = Si::from_num(law.rate_hz);
            let share = Si::from_bits(random.below(1 << 32).cast_signed());
            let velocity = VelocitySettings {
                from: kind,
                bandwidth_hz: rate * share / 5,
                window_s: Si::from_num(random.below(18)) / rate,
            };
            let settings = Settings { velocity, ..law };
            let Ok(AnyLaw::Damped(law, mut state)) = AnyLaw::<Fixed32>::new(&settings) else {
                continue;
            };
            laws += 1;
            let mut specified = Specified::of(&law.velocity);
            let (stiffness, damping) = (
                at32::gain(law.spring.desired),
                at32::gain(law.spring.damping),
            );
            let limit = wide(law.spring.limit.0);
            let mut hand = Hand::any(&mut random);
            let mut force = 0;
            for tick in 0..300 {
                ticks += 1;
                let (e, told) = hand.moves(&mut random, tick, force);
                let v = specified.tick(wide(e));
                force = sfa::spring_tick(stiffness, damping, limit, wide(e), v);
                // A law with a velocity filter does not use the displacement of its sample.
                let sample = Sample {
                    e: Position(e),
                    moved: Position(told),
                };
                let got = law.tick(&mut state, sample);
                assert_eq!(wide(got.0), force, "{settings:?} {e:?} {v}");
                assert!(specified.remembers(&state.velocity), "{settings:?} {e:?}");
                assert_eq!(state.spring.inside, wide(e) > 0);
                anew += u32::from(tick > 0 && v == 0 && told != I8F24::ZERO);
                pushes += u32::from(force > 0 && force < limit);
                moved += u32::from(v != 0);
            }
        }
        println!(
            "{kind:?}: {ticks} ticks of {laws} laws, {pushes} pushes, {moved} moved, {anew} still"
        );
        assert!(laws > 100 && pushes > 10_000 && moved > 50_000, "{kind:?}");
    }
}
