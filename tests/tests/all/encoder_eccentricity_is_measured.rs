//! Tests that a calibration with measurement also finds the encoder's angle error from an off-centre magnet. The errors with one
//! and two periods per turn are found to within an encoder count and a hundredth of their amplitude, and within twice their stated
//! uncertainty. `-- --nocapture` prints the deviations.

use nalgebra::Complex;
use std::f64::consts::TAU;
use touchstone_drive::{ControlInput, CurrentSample, DeviceSettings, EncoderReading};
use touchstone_lab::identify::eccentricity::{
    CalibrationTick, Eccentricity, FIELD_FASTEST_TURNS_PER_S, KnownEncoder, NotSeen, Reseat,
    Witness,
};
use touchstone_protocol::settings::EncoderKind;
use touchstone_protocol::{Command, State};
use touchstone_tests::knob::{EncoderError, Knob, PERIOD_S, Tamper};
use touchstone_tests::random::Random;
use touchstone_world::motor::{GIMBAL, MotorParameters};
use touchstone_world::plant::train::Harmonic;
use touchstone_world::plant::{BareCoulomb, Coulomb, Device};

/// The simulated knob of the DLR thesis, with some dry friction.
const KNOB: Device = Device {
    inertia: 1e-4,
    damping: 4e-4,
    friction: Some(Coulomb {
        kinetic: 1e-3,
        breakaway: 1e-3,
    }),
};

const COUNTS: u32 = 16_384;
const COUNT_RAD: f64 = TAU / COUNTS as f64;
/// Allowed relative deviation of a measured amplitude, in addition to one encoder count.
const OFF_MOST: f64 = 0.01;

const fn torque(amplitude: f64, per_rev: f64, phase: f64) -> Harmonic {
    Harmonic {
        amplitude,
        per_rev,
        phase,
    }
}

/// Cogging torque of a motor with 12 slots and 14 poles.
const COGGING: [Harmonic; 4] = [
    torque(2e-3, 84.0, 0.4),
    torque(4e-4, 168.0, 2.0),
    torque(6e-4, 12.0, -1.0),
    torque(5e-4, 14.0, 3.0),
];
/// Torque of an unbalanced weight on the shaft, 1 mN·m: ten grams, ten millimetres from the axis.
const WEIGHT: Harmonic = torque(1e-3, 1.0, 0.7);

/// Adds random noise to the readings: 1.15 converter codes rms to the current sensors, 0.8 counts rms to the encoder.
struct Noisy(Random);

impl Tamper for Noisy {
    fn sample(&mut self, _: u32, sample: &mut CurrentSample) {
        for code in [&mut sample.phase_a, &mut sample.phase_b] {
            *code = code.saturating_add_signed((self.0.whole(1) + self.0.whole(1)) as i16);
        }
    }

    fn input(&mut self, _: u32, input: &mut ControlInput) -> bool {
        if let EncoderReading::Counter16(count) = &mut input.encoder {
            *count = count.wrapping_add_signed(self.0.whole(1) as i16);
        }
        true
    }
}

/// A test case: amplitude in degrees and phase of the encoder's error with one and with two periods per turn, and other
/// disturbances.
#[derive(Clone, Copy)]
struct Case {
    degrees: [f64; 2],
    phase_rad: [f64; 2],
    /// Resistance, flux, inertia, damping and friction, as multiples of the usual values.
    parts: [f64; 5],
    weight: bool,
    /// Whether the encoder counts in the opposite direction, and whether the motor's phases are swapped.
    reversed: [bool; 2],
}

impl Case {
    const fn of(degrees: [f64; 2], phase_rad: [f64; 2]) -> Self {
        Self {
            degrees,
            phase_rad,
            parts: [1.0; 5],
            weight: false,
            reversed: [false; 2],
        }
    }
}

fn settings(case: &Case) -> DeviceSettings {
    let mut settings = DeviceSettings::default();
    settings.encoder.kind = EncoderKind::Incremental;
    settings.encoder.counts_per_rev = COUNTS;
    settings.encoder.reversed = case.reversed[0];
    settings.calibration.measures = true;
    settings
}

/// Simulates a calibration. Returns its telemetry, the encoder's known properties, and the true encoder error relative to the
/// calibration's zero.
fn told(case: &Case, seed: u64) -> (Vec<CalibrationTick>, KnownEncoder, [Complex<f64>; 2]) {
    let settings = settings(case);
    let [r, flux, j, b, friction] = case.parts;
    let motor = MotorParameters {
        resistance_ohm: r * GIMBAL.resistance_ohm,
        flux_linkage_wb: flux * GIMBAL.flux_linkage_wb,
        electrical_zero_rad: seed as f64,
        reversed: case.reversed[1],
        ..GIMBAL
    };
    let kinetic = friction * 1e-3;
    let device = Device {
        inertia: j * KNOB.inertia,
        damping: b * KNOB.damping,
        friction: Some(Coulomb {
            kinetic,
            breakaway: kinetic,
        }),
    };
    let plant = BareCoulomb::new(&device, PERIOD_S / 2.0).unwrap();
    let mut knob = Knob::with_plant(&settings, motor, plant, 0.3, Noisy(Random::new(seed)));
    knob.rig.bridge.dead_share = 0.01;
    knob.rig.cogging = COGGING.to_vec();
    knob.rig.cogging.extend(case.weight.then_some(WEIGHT));
    knob.encoder_error = (0..2)
        .map(|index| EncoderError {
            amplitude_rad: case.degrees[index].to_radians(),
            per_rev: (index + 1) as f64,
            phase_rad: case.phase_rad[index],
        })
        .collect();
    knob.ask(Command::Calibrate);
    knob.tick();
    let mut ticks = vec![];
    while knob.device.state() == State::Calibrating {
        let told = knob.telemetry();
        ticks.push(CalibrationTick {
            tick: told.tick,
            part: told.measuring.map(|it| it.part),
            count: told.count,
        });
        knob.tick();
    }
    assert_eq!(knob.device.state(), State::Ready);
    let known = KnownEncoder {
        rate_hz: f64::from(settings.timing.rate_hz),
        counts_per_rev: f64::from(COUNTS),
        pole_pairs: f64::from(settings.motor.pole_pairs),
        field_turns_per_s: settings.calibration.electrical_turns_per_s.to_num(),
    };
    assert!(known.field_turns_per_s <= FIELD_FASTEST_TURNS_PER_S);
    let here = knob.rig.now().angle_rad;
    let zero = knob.encoder_error.iter().fold(here, |read, it| {
        read + it.amplitude_rad * (it.per_rev * here + it.phase_rad).sin()
    });
    let truth = std::array::from_fn(|index| {
        let it = &knob.encoder_error[index];
        let there = Complex::from_polar(it.amplitude_rad, it.phase_rad + it.per_rev * zero);
        // `-A sin(-n θ + φ)`.
        if case.reversed[0] {
            there.conj()
        } else {
            there
        }
    });
    (ticks, known, truth)
}

/// The encoder error that the desktop calculates from a simulated calibration, and the true one.
fn measured(case: &Case, seed: u64) -> (Eccentricity, [Complex<f64>; 2]) {
    let (ticks, known, truth) = told(case, seed);
    (Eccentricity::new(&ticks, &known).unwrap(), truth)
}

/// Deviation of the measured encoder error with one and with two periods per turn. Each is given in rad, and as a fraction of the
/// allowed deviation (twice the stated uncertainty, at least half a count).
fn off(found: &Eccentricity, truth: &[Complex<f64>; 2]) -> [[f64; 2]; 2] {
    std::array::from_fn(|index| {
        let it = &found.harmonics[index];
        let found = Complex::from_polar(it.amplitude_rad, it.phase_rad);
        let off = (found - truth[index]).norm();
        [off, off / (2.0 * it.uncertainty_rad).max(0.5 * COUNT_RAD)]
    })
}

/// Simulates each case and asserts that the encoder errors are found within their limits. Prints the largest and the smallest
/// deviation in degrees.
fn all_found(cases: &[Case]) {
    let (mut worst, mut best, mut surest) = (0.0_f64, f64::INFINITY, 0.0_f64);
    for (seed, case) in (1..).zip(cases) {
        let (found, truth) = measured(case, seed);
        let off = off(&found, &truth);
        println!(
            "{:?}° {:?} {:?}: off {:.4}° {:.4}°; said {:.4}° {:.4}°, by {:?}, apart {:?}",
            case.degrees,
            case.phase_rad,
            case.parts,
            off[0][0].to_degrees(),
            off[1][0].to_degrees(),
            found.harmonics[0].uncertainty_rad.to_degrees(),
            found.harmonics[1].uncertainty_rad.to_degrees(),
            found.witness,
            found.apart_rad.map(|it| it.map(f64::to_degrees)),
        );
        for (index, [off, share]) in off.into_iter().enumerate() {
            let allowed = COUNT_RAD + OFF_MOST * truth[index].norm();
            assert!(off < allowed, "order {}: {off} of {allowed}", index + 1);
            assert!(share < 1.0, "order {}: {off}, {found:?}", index + 1);
            worst = worst.max(off.to_degrees());
            best = best.min(off.to_degrees());
            surest = surest.max(share);
        }
    }
    println!("off by {best:.4} to {worst:.4} degrees; {surest:.2} of what is said at most");
}

#[test]
fn a_magnet_out_of_the_axis_is_found_whatever_its_phase() {
    all_found(&[
        Case::of([0.0, 0.0], [0.0, 0.0]),
        Case::of([0.3, 0.0], [1.0, 0.0]),
        Case::of([0.0, 0.3], [0.0, -2.0]),
        Case::of([0.3, 0.3], [-2.5, 0.4]),
        Case::of([1.0, 0.0], [0.5, 0.0]),
        Case::of([1.0, 0.3], [3.0, 1.5]),
        Case::of([0.3, 1.0], [-1.0, 2.6]),
        Case::of([2.0, 0.0], [2.0, 0.0]),
        Case::of([0.0, 2.0], [0.0, -0.7]),
        Case::of([2.0, 1.0], [-1.6, -2.9]),
    ]);
}

#[test]
fn another_motor_and_other_directions_make_no_difference() {
    let usual = Case::of([1.0, 0.3], [0.9, -2.2]);
    all_found(&[
        Case {
            parts: [1.3, 0.7, 1.3, 0.7, 1.3],
            ..usual
        },
        Case {
            parts: [0.7, 1.3, 0.7, 1.3, 0.7],
            ..usual
        },
        Case {
            parts: [1.3, 1.3, 1.0, 1.0, 5.0],
            ..usual
        },
        Case {
            parts: [0.7, 0.7, 1.0, 1.0, 0.0],
            ..usual
        },
        Case {
            reversed: [true, false],
            ..usual
        },
        Case {
            reversed: [false, true],
            ..usual
        },
    ]);
}

/// Multiples, for `Case::parts`, of a knob with little damping: a fortieth of the damping and half the friction.
const SMOOTH: [f64; 5] = [1.0, 1.0, 1.0, 0.025, 0.5];

#[test]
fn a_weight_out_of_the_axis_is_told_from_the_magnet_by_a_long_coast_alone() {
    let heavy = Case {
        weight: true,
        ..Case::of([0.3, 0.0], [1.0, 0.0])
    };
    // If the coast is short, the measurement with the calibration's field decides. Its result is wrong by the weight's torque
    // divided by the field's stiffness: 7 pole pairs times 0.25 N·m/A times 1 A.
    let (found, truth) = measured(&heavy, 40);
    assert_eq!(found.apart_rad, None);
    let [[once, _], [twice, _]] = off(&found, &truth);
    let by_weight = WEIGHT.amplitude / (7.0 * 0.25);
    println!("by the field, off by {once:.2e} rad; the weight makes {by_weight:.2e}");
    assert!((once / by_weight - 1.0).abs() < 0.2, "{once}");
    assert!(twice < COUNT_RAD);
    // A long coast shows the weight.
    let smooth = Case {
        parts: SMOOTH,
        ..heavy
    };
    let (found, _) = measured(&smooth, 41);
    assert_eq!(found.witness, [Witness::Coast, Witness::Field]);
    all_found(&[smooth]);
    // Without a weight, the measurement with the field decides also after a long coast.
    let light = Case {
        weight: false,
        ..smooth
    };
    let (found, _) = measured(&light, 42);
    assert!(found.apart_rad.is_some());
    assert_eq!(found.witness, [Witness::Field; 2]);
    all_found(&[light]);
}

#[test]
fn what_is_not_whole_or_no_turn_of_the_field_is_refused() {
    let (ticks, known, _) = told(&Case::of([0.3, 0.3], [0.0, 1.0]), 50);
    let field = ticks.iter().filter(|it| it.part.is_none()).count();
    let refused = |ticks: &[CalibrationTick]| Eccentricity::new(ticks, &known).unwrap_err();

    // Telemetry of the last half of the way back is lost.
    let lost: Vec<CalibrationTick> = [&ticks[..field - 900], &ticks[field - 1..]].concat();
    assert!(matches!(refused(&lost), NotSeen::Incomplete { .. }));
    assert!(matches!(refused(&[]), NotSeen::Incomplete { .. }));

    // A shaft that stands still, or that a hand moves by 2 degrees on the way back.
    let changed = |how: &dyn Fn(usize, &mut CalibrationTick)| -> Vec<CalibrationTick> {
        let mut changed = ticks.clone();
        changed
            .iter_mut()
            .enumerate()
            .for_each(|(at, it)| how(at, it));
        changed
    };
    let standing = changed(&|_, it| it.count = 0);
    assert!(matches!(refused(&standing), NotSeen::NotFollowed { .. }));
    let counts = 2.0 / 360.0 * f64::from(COUNTS);
    let held = changed(&|at, it| {
        if at + 1_700 > field {
            it.count += (counts * (TAU * at as f64 / 1_750.0).sin()) as i32;
        }
    });
    assert!(matches!(refused(&held), NotSeen::DoesNotRepeat { .. }));

    // Every second telemetry record is as good as all.
    let second: Vec<CalibrationTick> = ticks.iter().step_by(2).copied().collect();
    Eccentricity::new(&second, &known).unwrap();
}

#[test]
fn what_it_costs_is_that_of_its_largest_error() {
    let of = |degrees: [f64; 2]| {
        let (ticks, known, _) = told(&Case::of(degrees, [0.3, 1.0]), 60);
        Eccentricity::new(&ticks, &known).unwrap().cost(7.0)
    };
    // For an error of amplitude A with n periods per turn alone: `place_rad` is A, `torque_lost` 1 - cos(7 A), `stiffness_off` n A.
    let within = |found: f64, truth: f64, most: f64| {
        assert!((found - truth).abs() < most, "{found} for {truth}");
    };
    let cost = of([2.0, 0.0]);
    within(cost.place_rad.to_degrees(), 2.0, 0.05);
    within(cost.torque_lost, 1.0 - 14_f64.to_radians().cos(), 0.002);
    within(cost.stiffness_off, 2_f64.to_radians(), 0.001);
    assert_eq!(cost.reseat(), None);
    let cost = of([0.0, 2.0]);
    within(cost.stiffness_off, 4_f64.to_radians(), 0.002);
    assert_eq!(cost.reseat(), Some(Reseat::Stiffness));
    assert_eq!(of([2.0, 1.0]).reseat(), Some(Reseat::Electrical));
    assert_eq!(of([0.3, 0.3]).reseat(), None);
}
