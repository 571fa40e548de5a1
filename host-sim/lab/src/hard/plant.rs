//! Hard cases of the plants (device and hand) with a closed-form solution.

use super::random::Random;
use super::{Case, Effort, Finding};
use crate::accuracy::double::Double;
use crate::accuracy::reference::Reference;
use touchstone_sim::error::Result;
use touchstone_world::plant::{
    BareCoulomb, BareLinear, Coulomb, Device, Hand, HeldCoulomb, HeldLinear, Kinematics as _,
    LIGHT, MEDIUM, State, Stepper,
};

pub(super) const PERIOD_S: f64 = 1e-3;
pub(super) const KNOB: Device = Device {
    inertia: 1e-4,
    damping: 4e-4,
    friction: None,
};
pub(super) const STICKY: Device = Device {
    friction: Some(Coulomb {
        kinetic: 2e-3,
        breakaway: 3e-3,
    }),
    ..KNOB
};
const UNDAMPED: Hand = Hand {
    damping: 0.0,
    pad_damping: 0.0,
    ..MEDIUM
};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "energy-audit",
        about: "random torques and a hand that jumps, with and without friction",
        oracle: "books of energy, every tick: work = stored + lost",
        unit: "of the throughput",
        run: energy_audit,
    },
    Case {
        name: "mass-ratio",
        about: "hands from a millionth to a million times the device's inertia",
        oracle: "books of energy, every tick",
        unit: "of the throughput",
        run: mass_ratio,
    },
    Case {
        name: "zero-damping",
        about: "nothing is lost: 10^6 ticks of an oscillation, and a free fall",
        oracle: "conserved energy; u t²/(2 J)",
        unit: "of the value",
        run: zero_damping,
    },
    Case {
        name: "independent-solver",
        about: "40 random plants over four decades, held and free, with stops and starts",
        oracle: "extrapolation of order 16 in double the digits, events located",
        unit: "rad over the largest angle",
        run: independent,
    },
    Case {
        name: "stick",
        about: "nine tenths of the break-away torque for 10^4 ticks",
        oracle: "a device at rest stays at rest, bit for bit",
        unit: "rad",
        run: stick,
    },
    Case {
        name: "break-away",
        about: "a torque that grows by a step a tick up to the break-away torque and one step beyond",
        oracle: "the tick at which the torque first exceeds it, and no other",
        unit: "ticks off",
        run: break_away,
    },
    Case {
        name: "denormals",
        about: "a velocity that decays for 10^6 ticks until nothing smaller is left",
        oracle: "v exp(-b t/J): it only ever falls, and the way that is left is v J/b",
        unit: "of the way",
        run: denormals,
    },
];

pub(super) fn torque(random: &mut Random) -> [f64; 2] {
    [0.05 * random.uniform(), 0.3 * random.uniform()]
}

/// Largest error of a tick's energy balance under random torques, divided by the energy exchanged in the tick.
fn audit<const N: usize, S: Stepper<State = State<N>>>(plant: &S, ticks: u32, seed: u64) -> f64 {
    let mut random = Random::new(seed);
    let mut state = State::<N>::at_rest(0.1);
    let mut worst = 0.0_f64;
    let mut held = torque(&mut random);
    for tick in 0..ticks {
        // The torque changes only now and then, so that the device has time to stop.
        if tick % 16 == 0 {
            held = torque(&mut random);
        }
        let [u, r] = held;
        let (stored, from) = (plant.stored_energy_j(&state, r), state.position());
        let loss = plant.step_with_loss(&mut state, u, r).total_j();
        let work = u * (state.position() - from);
        let after = plant.stored_energy_j(&state, r);
        // The angle itself is rounded, and so is the torque's work.
        let rounding = u.abs() * f64::EPSILON * state.position().abs();
        let throughput = work.abs() + stored + after + loss + rounding / 1e-12;
        worst =
            worst.max((work - (after - stored) - loss).abs() / throughput.max(f64::MIN_POSITIVE));
    }
    worst
}

/// Runs an expression with each of the four plants: bare device and device with hand, each without and with friction.
macro_rules! each_plant {
    ($device:expr, $hand:expr, $interval:expr, |$name:ident, $plant:ident| $body:expr) => {{
        let (device, hand, interval) = ($device, $hand, $interval);
        let mut found = Vec::new();
        {
            let ($name, $plant) = ("bare", BareLinear::new(&device, interval));
            found.extend($plant.ok().map(|$plant| $body));
        }
        {
            let ($name, $plant) = ("bare, friction", BareCoulomb::new(&device, interval));
            found.extend($plant.ok().map(|$plant| $body));
        }
        {
            let ($name, $plant) = ("held", HeldLinear::new(&device, &hand, interval));
            found.extend($plant.ok().map(|$plant| $body));
        }
        {
            let ($name, $plant) = ("held, friction", HeldCoulomb::new(&device, &hand, interval));
            found.extend($plant.ok().map(|$plant| $body));
        }
        found
    }};
}
pub(super) use each_plant;

fn energy_audit(_: Effort) -> Result<Vec<Finding>> {
    Ok(each_plant!(STICKY, MEDIUM, PERIOD_S, |name, plant| {
        Finding::new(name, audit(&plant, 20_000, 5), 1e-12)
    }))
}

fn mass_ratio(_: Effort) -> Result<Vec<Finding>> {
    let mut found = Vec::new();
    for power in (-6..=6).step_by(2) {
        let hand = Hand {
            inertia: KNOB.inertia * 10_f64.powi(power),
            ..MEDIUM
        };
        if let Ok(plant) = HeldLinear::new(&KNOB, &hand, PERIOD_S) {
            found.push(Finding::new(
                format!("held, 1e{power}"),
                audit(&plant, 2_000, 7),
                1e-12,
            ));
        }
        let friction = format!("held, friction, 1e{power}");
        match HeldCoulomb::new(&STICKY, &hand, PERIOD_S) {
            Ok(plant) => found.push(Finding::new(friction, audit(&plant, 2_000, 7), 1e-12)),
            Err(invalid) => found.push(
                Finding::new(friction, f64::INFINITY, 1e-12).failing(format!("refused: {invalid}")),
            ),
        }
    }
    Ok(found)
}

fn zero_damping(_: Effort) -> Result<Vec<Finding>> {
    const TICKS: u32 = 1_000_000;
    let device = Device {
        damping: 0.0,
        ..KNOB
    };
    let mut found = Vec::new();
    // Each tick rounds four sums. The errors add up like a random walk at best, and linearly at worst.
    let bound = f64::from(TICKS) * 4.0 * f64::EPSILON;
    if let Ok(plant) = HeldLinear::new(&device, &UNDAMPED, PERIOD_S) {
        let mut state = State::from_array([0.2, 1.0, -0.1, 0.0]);
        let before = plant.stored_energy_j(&state, 0.0);
        for _ in 0..TICKS {
            plant.step(&mut state, 0.0, 0.0);
        }
        let off = (plant.stored_energy_j(&state, 0.0) / before - 1.0).abs();
        found.push(Finding::new("held, undamped", off, bound));
    }
    if let Ok(plant) = BareLinear::new(&device, PERIOD_S) {
        let mut state = State::from_array([0.0, 0.0]);
        for _ in 0..TICKS {
            plant.step(&mut state, 1e-6, 0.0);
        }
        let seconds = f64::from(TICKS) * PERIOD_S;
        let expected = 0.5 * 1e-6 / device.inertia * seconds * seconds;
        found.push(Finding::new(
            "bare, undamped",
            (state.position() / expected - 1.0).abs(),
            bound,
        ));
    }
    // A device without damping that starts at 5 rad/s. Dry friction alone takes the energy F |x|.
    let sticky = Device {
        damping: 0.0,
        ..STICKY
    };
    if let (Ok(plant), Some(friction)) = (BareCoulomb::new(&sticky, PERIOD_S), sticky.friction) {
        let mut state = State::from_array([0.0, 5.0]);
        for _ in 0..1000 {
            plant.step(&mut state, 0.0, 0.0);
        }
        // The device stops at J v²/(2 F), and stays there.
        let expected = 0.5 * sticky.inertia * 25.0 / friction.kinetic;
        found.push(Finding::new(
            "bare, friction only",
            (state.position() / expected - 1.0).abs(),
            1e-13,
        ));
    }
    Ok(found)
}

fn independent(_: Effort) -> Result<Vec<Finding>> {
    let mut random = Random::new(40);
    let mut found = Vec::new();
    for index in 0..40 {
        let friction = (index % 2 == 1).then(|| {
            let kinetic = random.decades(1e-4, 1e-2);
            Coulomb {
                kinetic,
                breakaway: kinetic * (1.2 + 0.5 * random.uniform().abs()),
            }
        });
        let device = Device {
            inertia: random.decades(1e-5, 1e-2),
            damping: random.decades(1e-5, 1e-2),
            friction,
        };
        let hand = (index % 4 >= 2).then(|| Hand {
            inertia: random.decades(1e-5, 1e-2),
            damping: random.decades(1e-5, 1e-2),
            stiffness: random.decades(1e-3, 1.0),
            pad_damping: random.decades(1e-5, 1e-3),
            pad_stiffness: random.decades(1e-2, 2.0),
        });
        let held: Vec<[f64; 2]> = (0..200)
            .map(|tick| {
                let slow = (f64::from(tick) / 20.0).sin();
                [0.02 * random.uniform(), 0.2 * slow]
            })
            .collect();
        let (off, events) = compare(&device, hand.as_ref(), &held);
        let name = match (&hand, friction) {
            (None, None) => "bare",
            (None, Some(_)) => "bare, friction",
            (Some(_), None) => "held",
            (Some(_), Some(_)) => "held, friction",
        };
        found.push(Finding::new(
            format!("{name} {index} ({events} events)"),
            off,
            1e-12,
        ));
    }
    Ok(found)
}

/// Largest difference of the angle in the closed-form solution from the reference, divided by the largest angle, and the number of
/// stops and starts.
fn compare(device: &Device, hand: Option<&Hand>, held: &[[f64; 2]]) -> (f64, u64) {
    let mut reference = Reference::new(device, hand, None, 4);
    let mut known = [Double::ZERO; 4];
    let expected: Vec<f64> = held
        .iter()
        .map(|&each| {
            reference.tick(&mut known, each, PERIOD_S);
            known[0].to_f64()
        })
        .collect();
    fn run<const N: usize>(plant: &impl Stepper<State = State<N>>, held: &[[f64; 2]]) -> Vec<f64> {
        let mut state = State::at_rest(0.0);
        held.iter()
            .map(|&[u, r]| {
                plant.step(&mut state, u, r);
                state.position()
            })
            .collect()
    }
    let angles = match (hand, device.friction) {
        (None, None) => BareLinear::new(device, PERIOD_S).map(|plant| run(&plant, held)),
        (None, Some(_)) => BareCoulomb::new(device, PERIOD_S).map(|plant| run(&plant, held)),
        (Some(hand), None) => {
            HeldLinear::new(device, hand, PERIOD_S).map(|plant| run(&plant, held))
        }
        (Some(hand), Some(_)) => {
            HeldCoulomb::new(device, hand, PERIOD_S).map(|plant| run(&plant, held))
        }
    };
    let Ok(angles) = angles else {
        return (f64::INFINITY, 0);
    };
    let largest = expected
        .iter()
        .fold(1e-3_f64, |most, angle| most.max(angle.abs()));
    let off = angles
        .iter()
        .zip(&expected)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    (off / largest, reference.events)
}

fn stick(_: Effort) -> Result<Vec<Finding>> {
    // The torque stays below the break-away torque. In a hand, the rest point stays where the device is.
    let found = each_plant!(STICKY, MEDIUM, PERIOD_S, |name, plant| {
        let mut state = State::at_rest(0.1);
        for _ in 0..10_000 {
            plant.step(&mut state, 0.9 * 3e-3, 0.1);
        }
        Finding::new(name, (state.position() - 0.1).abs(), 0.0)
    });
    Ok(found
        .into_iter()
        .map(|finding| {
            if finding.subject.contains("friction") {
                finding
            } else {
                finding.failing("has no friction: the torque moves it")
            }
        })
        .collect())
}

fn break_away(_: Effort) -> Result<Vec<Finding>> {
    // The torque rises to the break-away torque of 2^-8 N·m in 1024 steps that are exact in binary, so the two become equal to
    // the bit.
    let friction = Coulomb {
        kinetic: 0.001_953_125,
        breakaway: 0.003_906_25,
    };
    let device = Device {
        friction: Some(friction),
        ..KNOB
    };
    let step = friction.breakaway / 1024.0;
    let tick_of = |move_on: &mut dyn FnMut(f64) -> f64| {
        let first = (1..2000_u32).find(|&tick| move_on(step * f64::from(tick)) != 0.0);
        first.map_or(f64::INFINITY, |tick| (f64::from(tick) - 1025.0).abs())
    };
    let mut found = Vec::new();
    for sign in [1.0, -1.0] {
        if let Ok(plant) = BareCoulomb::new(&device, PERIOD_S) {
            let mut state = State::at_rest(0.0);
            let off = tick_of(&mut |torque| {
                plant.step(&mut state, sign * torque, 0.0);
                state.velocity()
            });
            found.push(Finding::new(format!("bare, {sign:+}"), off, 0.0));
        }
        // A hand whose pad is not compressed while the device rests does not change the result.
        if let Ok(plant) = HeldCoulomb::new(&device, &LIGHT, PERIOD_S) {
            let mut state = State::at_rest(0.0);
            let off = tick_of(&mut |torque| {
                plant.step(&mut state, sign * torque, 0.0);
                state.velocity()
            });
            found.push(Finding::new(format!("held, {sign:+}"), off, 0.0));
        }
    }
    Ok(found)
}

fn denormals(_: Effort) -> Result<Vec<Finding>> {
    let mut found = Vec::new();
    if let Ok(plant) = BareLinear::new(&KNOB, PERIOD_S) {
        let mut state = State::from_array([0.0, 1.0]);
        let mut before = 1.0;
        let mut rises = 0_u32;
        for _ in 0..1_000_000 {
            plant.step(&mut state, 0.0, 0.0);
            rises += u32::from(state.velocity() > before || state.velocity() < 0.0);
            before = state.velocity();
        }
        found.push(Finding::new("bare, ticks that rise", f64::from(rises), 0.0));
        // A tick takes 4e-3 of the velocity (b T/J). At 125 times the smallest denormal number that is half of this number, so
        // rounding stops the decay.
        found.push(Finding::new("bare, what is left", state.velocity(), 1e-321));
        let way = KNOB.inertia / KNOB.damping;
        found.push(Finding::new(
            "bare, way",
            (state.position() / way - 1.0).abs(),
            1e-13,
        ));
    }
    if let Ok(plant) = HeldLinear::new(&KNOB, &MEDIUM, PERIOD_S) {
        let mut state = State::from_array([0.3, 1.0, 0.2, -1.0]);
        for _ in 0..1_000_000 {
            plant.step(&mut state, 0.0, 0.0);
        }
        found.push(Finding::new(
            "held, what is left",
            plant.stored_energy_j(&state, 0.0),
            0.0,
        ));
    }
    Ok(found)
}
