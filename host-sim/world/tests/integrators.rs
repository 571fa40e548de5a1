//! Checks that each integration method has its textbook order, keeps the energy balance to that order, and lets the device rest or
//! creep as documented.

use touchstone_world::integrator::{
    CREEP_RAD_PER_S, ExactLinear, ImplicitEuler, ImplicitMidpoint, Method, Model, RungeKutta4,
    SemiImplicitEuler, Substepped,
};
use touchstone_world::plant::{
    BareCoulomb, Coulomb, Device, HeldCoulomb, HeldLinear, Kinematics as _, MEDIUM, State, Stepper,
};

const KNOB: Device = Device {
    inertia: 1e-4,
    damping: 4e-4,
    friction: None,
};
const STICKY: Device = Device {
    friction: Some(Coulomb {
        kinetic: 2e-3,
        breakaway: 3e-3,
    }),
    ..KNOB
};
const PERIOD_S: f64 = 1e-3;

/// Torque in N·m and rest point in rad that are held in a tick (control period); both change smoothly from tick to tick.
fn held(tick: u32) -> [f64; 2] {
    let t = PERIOD_S * f64::from(tick);
    [0.03 * (37.0 * t).sin(), 0.1 + 0.3 * (11.0 * t).sin()]
}

const START: [f64; 4] = [0.1, 2.0, 0.12, -1.0];

/// Largest difference of the device's angle from the closed-form solution, and largest error of a tick's energy balance.
fn errors(
    plant: &impl Stepper<State = State<4>>,
    exact: &impl Stepper<State = State<4>>,
) -> [f64; 2] {
    let (mut state, mut expected) = (State::from_array(START), State::from_array(START));
    let (mut off, mut gap) = (0.0_f64, 0.0_f64);
    for tick in 0..400 {
        let [torque, rest] = held(tick);
        let before = (plant.stored_energy_j(&state, rest), state.position());
        let loss = plant.step_with_loss(&mut state, torque, rest);
        let work = torque * (state.position() - before.1);
        let balance = work - (plant.stored_energy_j(&state, rest) - before.0) - loss.total_j();
        exact.step(&mut expected, torque, rest);
        off = off.max((state.position() - expected.position()).abs());
        gap = gap.max(balance.abs());
    }
    [off, gap]
}

/// Measured orders of angle error and energy error: binary logarithm of the ratio of the errors with `substeps` and with twice as
/// many substeps.
fn slopes<M: Method<4>>(substeps: u32) -> [f64; 2] {
    let model = Model::held(&KNOB, &MEDIUM).unwrap();
    let exact = HeldLinear::new(&KNOB, &MEDIUM, PERIOD_S).unwrap();
    let with = |n| {
        errors(
            &Substepped::<M, 4>::new(&model, PERIOD_S, n).unwrap(),
            &exact,
        )
    };
    let (coarse, fine) = (with(substeps), with(2 * substeps));
    println!("{substeps}: {coarse:?}, {}: {fine:?}", 2 * substeps);
    [0, 1].map(|i| (coarse[i] / fine[i]).log2())
}

/// Whether a measured order is within a tenth of the method's textbook order. The tolerance covers the next term of the error.
fn is_order(slope: f64, order: u32) -> bool {
    (slope - f64::from(order)).abs() < 0.1
}

#[test]
fn every_method_has_its_order_in_angle_and_in_energy() {
    let euler = slopes::<ImplicitEuler<4>>(256);
    assert!(is_order(euler[0], 1) && is_order(euler[1], 1), "{euler:?}");
    let symplectic = slopes::<SemiImplicitEuler<4>>(256);
    assert!(
        is_order(symplectic[0], 1) && is_order(symplectic[1], 1),
        "{symplectic:?}"
    );
    let midpoint = slopes::<ImplicitMidpoint<4>>(16);
    assert!(is_order(midpoint[0], 2), "{midpoint:?}");
    let runge_kutta = slopes::<RungeKutta4<4>>(4);
    assert!(
        is_order(runge_kutta[0], 4) && is_order(runge_kutta[1], 4),
        "{runge_kutta:?}"
    );
    assert_eq!(
        [1, 2, 1, 4],
        [
            ImplicitEuler::<4>::ORDER,
            ImplicitMidpoint::<4>::ORDER,
            SemiImplicitEuler::<4>::ORDER,
            RungeKutta4::<4>::ORDER
        ]
    );
}

#[test]
fn midpoint_keeps_the_books_to_rounding() {
    let model = Model::held(&KNOB, &MEDIUM).unwrap();
    let exact = HeldLinear::new(&KNOB, &MEDIUM, PERIOD_S).unwrap();
    let plant = Substepped::<ImplicitMidpoint<4>, 4>::new(&model, PERIOD_S, 1).unwrap();
    let [off, gap] = errors(&plant, &exact);
    // The energy balance closes although the motion is wrong; about 2e-4 J are stored.
    assert!(off > 1e-5 && gap < 1e-17, "{off:e} {gap:e}");
}

#[test]
fn the_exact_step_of_a_model_is_the_exact_plant() {
    let model = Model::held(&KNOB, &MEDIUM).unwrap();
    let step = ExactLinear::new(&model, PERIOD_S).unwrap();
    let exact = HeldLinear::new(&KNOB, &MEDIUM, PERIOD_S).unwrap();
    let (mut state, mut expected) = (START, State::from_array(START));
    for tick in 0..400 {
        let [torque, rest] = held(tick);
        step.step(&model, &mut state, [torque, rest]);
        exact.step(&mut expected, torque, rest);
        assert!((state[0] - expected.position()).abs() < 1e-13);
    }
    let sticky = Model::held(&STICKY, &MEDIUM).unwrap();
    assert!(ExactLinear::new(&sticky, PERIOD_S).is_err());
}

/// Checks that a method is of first order if the device stops and starts within substeps.
fn converges_on_friction<M: Method<4>>() {
    let model = Model::held(&STICKY, &MEDIUM).unwrap();
    let exact = HeldCoulomb::new(&STICKY, &MEDIUM, PERIOD_S).unwrap();
    let with = |n| {
        let plant = Substepped::<M, 4>::new(&model, PERIOD_S, n).unwrap();
        errors(&plant, &exact)[0]
    };
    let (coarse, fine) = (with(64), with(4096));
    println!("friction: {coarse:e} {fine:e}");
    // Six doublings at first order give a factor of 64. Stops and starts move within substeps, so single points scatter around it.
    assert!(
        fine < coarse / 30.0 && fine > coarse / 200.0,
        "{coarse:e} {fine:e}"
    );
}

#[test]
fn set_valued_methods_converge_to_the_closed_form_of_friction() {
    converges_on_friction::<ImplicitEuler<4>>();
    converges_on_friction::<ImplicitMidpoint<4>>();
    converges_on_friction::<SemiImplicitEuler<4>>();
}

fn hold<M: Method<2>>(substeps: u32) -> f64 {
    let model = Model::bare(&STICKY).unwrap();
    let plant = Substepped::<M, 2>::new(&model, PERIOD_S, substeps).unwrap();
    let mut state = State::from_array([0.1, 0.0]);
    for _ in 0..10_000 {
        // The torque is nine tenths of the kinetic friction, because smoothed friction has no break-away torque.
        plant.step(&mut state, 0.9 * 2e-3, 0.0);
    }
    state.position() - 0.1
}

#[test]
fn a_held_device_stays_to_the_bit_or_creeps_as_its_model_says() {
    assert_eq!(hold::<ImplicitEuler<2>>(3), 0.0);
    assert_eq!(hold::<ImplicitMidpoint<2>>(3), 0.0);
    assert_eq!(hold::<SemiImplicitEuler<2>>(3), 0.0);
    // Friction and viscous damping together balance the torque.
    let creep = hold::<RungeKutta4<2>>(64);
    let expected = 10.0 * CREEP_RAD_PER_S * 0.9_f64.atanh();
    assert!((creep / expected - 1.0).abs() < 0.01, "{creep} {expected}");
}

#[test]
fn explicit_methods_fail_beyond_their_pole_and_implicit_ones_do_not() {
    let model = Model::with_current_loop(&KNOB, 5000.0).unwrap();
    let exact = ExactLinear::new(&model, PERIOD_S).unwrap();
    fn end<M: Method<3>>(model: &Model<3>, substeps: u32) -> f64 {
        let plant = Substepped::<M, 3>::new(model, PERIOD_S, substeps).unwrap();
        let mut state = [0.0, 0.0, 0.0];
        for _ in 0..200 {
            plant.advance::<false>(&mut state, [0.01, 0.0]);
        }
        state[0]
    }
    let mut state = [0.0; 3];
    for _ in 0..200 {
        exact.step(&model, &mut state, [0.01, 0.0]);
    }
    let off = |x: f64| (x / state[0] - 1.0).abs();
    // The pole is 31416/s: explicit Euler needs more than 15.7 substeps, Runge–Kutta more than 11.3.
    let lost = |end: f64| end.is_nan() || end.abs() >= 1e6;
    assert!(lost(end::<SemiImplicitEuler<3>>(&model, 15)));
    assert!(off(end::<SemiImplicitEuler<3>>(&model, 17)) < 1e-2);
    assert!(lost(end::<RungeKutta4<3>>(&model, 11)));
    assert!(off(end::<RungeKutta4<3>>(&model, 12)) < 1e-3);
    assert!(off(end::<ImplicitEuler<3>>(&model, 1)) < 2e-2);
    assert!(off(end::<ImplicitMidpoint<3>>(&model, 1)) < 2e-2);
}

#[test]
fn an_interval_of_no_length_moves_nothing() {
    let model = Model::bare(&STICKY).unwrap();
    let plant = Substepped::<ImplicitEuler<2>, 2>::new(&model, 0.0, 4).unwrap();
    let mut state = State::from_array([0.3, 2.0]);
    plant.step(&mut state, 1.0, 0.0);
    assert_eq!(state.to_array(), [0.3, 2.0]);
    let exact = BareCoulomb::new(&STICKY, 0.0).unwrap();
    exact.step(&mut state, 1.0, 0.0);
    assert_eq!(state.to_array(), [0.3, 2.0]);
}
