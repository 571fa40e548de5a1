//! Hard cases of symmetry: a plant's motion must not depend on how a step is divided, and must follow the sign and scale of its
//! inputs.

use super::plant::{KNOB, PERIOD_S, STICKY, each_plant, torque};
use super::random::Random;
use super::{Case, Effort, Finding};
use touchstone_sim::error::Result;
use touchstone_world::plant::{
    BareCoulomb, BareLinear, Coulomb, Device, FIRM, HeldCoulomb, HeldLinear, Kinematics as _,
    LIGHT, MEDIUM, State, Stepper,
};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "half-steps",
        about: "a tick in one step and in two halves",
        oracle: "Φ(T) = Φ(T/2)²",
        unit: "of the largest entry",
        run: half_steps,
    },
    Case {
        name: "jitter",
        about: "10^4 intervals from a tenth of a tick to three ticks, each crossed at once and in parts",
        oracle: "Φ(a) Φ(b) = Φ(a + b)",
        unit: "of the largest entry",
        run: jitter,
    },
    Case {
        name: "mirror",
        about: "everything turned round, with stops and starts",
        oracle: "x to -x, to the bit",
        unit: "ticks that differ",
        run: mirror,
    },
    Case {
        name: "powers-of-two",
        about: "torques, friction, angles times 2^-40 to 2^40",
        oracle: "the same motion times the power, to the bit",
        unit: "ticks that differ",
        run: powers_of_two,
    },
];

fn half_steps(_: Effort) -> Result<Vec<Finding>> {
    let mut found = Vec::new();
    for (name, hand) in [("light", LIGHT), ("medium", MEDIUM), ("firm", FIRM)] {
        for device in [KNOB, STICKY] {
            let halves = each_plant!(device, hand, 0.5 * PERIOD_S, |kind, plant| {
                (kind, walked(&plant, 2))
            });
            let wholes = each_plant!(device, hand, PERIOD_S, |_kind, plant| walked(&plant, 1));
            for ((kind, twice), once) in halves.into_iter().zip(wholes) {
                let off = twice
                    .iter()
                    .zip(&once)
                    .map(|(a, b)| (a - b).abs())
                    .fold(0.0, f64::max);
                // 1000 ticks with states of order 1, each rounded a few times.
                found.push(Finding::new(format!("{kind}, {name}"), off, 1e-11));
            }
        }
    }
    Ok(found)
}

fn walked<const N: usize>(plant: &impl Stepper<State = State<N>>, steps: u32) -> Vec<f64> {
    let mut random = Random::new(3);
    let mut state = State::at_rest(0.1);
    (0..1000)
        .map(|_| {
            let [u, r] = torque(&mut random);
            for _ in 0..steps {
                plant.step(&mut state, 0.1 * u, 0.1 + 0.1 * r);
            }
            state.position()
        })
        .collect()
}

fn jitter(_: Effort) -> Result<Vec<Finding>> {
    let mut random = Random::new(11);
    let mut worst = [0.0_f64; 4];
    let names = ["bare", "bare, friction", "held", "held, friction"];
    for _ in 0..2_500 {
        let (first, second) = (
            PERIOD_S * random.decades(0.1, 1.5),
            PERIOD_S * random.decades(0.1, 1.5),
        );
        let start = [
            0.1 * random.uniform(),
            2.0 * random.uniform(),
            0.1 * random.uniform(),
            2.0 * random.uniform(),
        ];
        let [u, r] = torque(&mut random);
        macro_rules! parts {
            ($index:expr, $make:expr, $count:expr) => {
                let make = $make;
                if let (Ok(a), Ok(b), Ok(all)) = (make(first), make(second), make(first + second)) {
                    let begin: [f64; $count] = std::array::from_fn(|i| start[i]);
                    let (mut parts, mut once) =
                        (State::from_array(begin), State::from_array(begin));
                    a.step(&mut parts, u, r);
                    b.step(&mut parts, u, r);
                    all.step(&mut once, u, r);
                    // A state that decays within the interval keeps the rounding error of its initial size.
                    let scale = State::from_array(begin);
                    worst[$index] = worst[$index].max(relative(&parts, &once, &scale));
                }
            };
        }
        parts!(0, |h| BareLinear::new(&KNOB, h), 2);
        parts!(1, |h| BareCoulomb::new(&STICKY, h), 2);
        parts!(2, |h| HeldLinear::new(&KNOB, &MEDIUM, h), 4);
        parts!(3, |h| HeldCoulomb::new(&STICKY, &MEDIUM, h), 4);
    }
    Ok(names
        .into_iter()
        .zip(worst)
        .map(|(name, worst)| Finding::new(name, worst, 1e-13))
        .collect())
}

/// Largest difference of the states `a` and `b`, divided by the largest entry of `b` or of the state `before` the step. Angles and
/// velocities each have their own scale.
fn relative<const N: usize>(a: &State<N>, b: &State<N>, before: &State<N>) -> f64 {
    let (a, b, before) = (a.to_array(), b.to_array(), before.to_array());
    let mut worst = 0.0_f64;
    for parity in 0..2 {
        let scale = (parity..N).step_by(2).fold(f64::MIN_POSITIVE, |most, i| {
            most.max(b[i].abs()).max(before[i].abs())
        });
        for i in (parity..N).step_by(2) {
            worst = worst.max((a[i] - b[i]).abs() / scale);
        }
    }
    worst
}

fn mirror(_: Effort) -> Result<Vec<Finding>> {
    Ok(each_plant!(STICKY, MEDIUM, PERIOD_S, |name, plant| {
        Finding::new(name, scaled(&plant, &plant, -1.0), 0.0)
    }))
}

/// Number of ticks in which a scaled plant breaks the symmetry. `plant` gets random inputs, `scaled` the same inputs times
/// `factor`. The state of `scaled` should be exactly `factor` times the state of `plant`.
fn scaled<const N: usize, S: Stepper<State = State<N>>>(plant: &S, scaled: &S, factor: f64) -> f64 {
    let mut random = Random::new(17);
    let (mut state, mut other) = (State::<N>::at_rest(0.0), State::<N>::at_rest(0.0));
    let mut differ = 0.0;
    for tick in 0..5000 {
        let [u, r] = torque(&mut random);
        // Some ticks without torque, so that the device can stop.
        let u = if tick % 64 < 32 { u } else { 0.0 };
        plant.step(&mut state, u, r);
        scaled.step(&mut other, factor * u, factor * r);
        let same = state
            .to_array()
            .iter()
            .zip(other.to_array())
            .all(|(a, b)| factor * a == b);
        differ += f64::from(u8::from(!same));
    }
    differ
}

fn powers_of_two(_: Effort) -> Result<Vec<Finding>> {
    let mut found = Vec::new();
    for power in [-40, -3, 7, 40] {
        let factor = 2_f64.powi(power);
        let friction = STICKY.friction.map(|friction| Coulomb {
            kinetic: factor * friction.kinetic,
            breakaway: factor * friction.breakaway,
        });
        let larger = Device { friction, ..STICKY };
        let name = |kind: &str| format!("{kind}, 2^{power}");
        macro_rules! pair {
            ($kind:expr, $make:expr) => {
                let make = $make;
                if let (Ok(a), Ok(b)) = (make(&STICKY), make(&larger)) {
                    found.push(Finding::new(name($kind), scaled(&a, &b, factor), 0.0));
                }
            };
        }
        pair!("bare", |d: &Device| BareLinear::new(d, PERIOD_S));
        pair!("bare, friction", |d: &Device| BareCoulomb::new(d, PERIOD_S));
        pair!("held", |d: &Device| HeldLinear::new(d, &MEDIUM, PERIOD_S));
        pair!("held, friction", |d: &Device| HeldCoulomb::new(
            d, &MEDIUM, PERIOD_S
        ));
    }
    Ok(found)
}
