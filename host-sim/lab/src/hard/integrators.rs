//! Hard cases that textbook integration methods fail, each with the limit at which a method begins to fail.

use super::plant::{KNOB, STICKY};
use super::{Case, Effort, Finding};
use touchstone_sim::error::Result;
use touchstone_world::integrator::{
    CREEP_RAD_PER_S, ExactLinear, ImplicitEuler, ImplicitMidpoint, Method, Model, RungeKutta4,
    SemiImplicitEuler, Substepped,
};
use touchstone_world::plant::{Device, Kinematics as _, State, Stepper as _};

const PERIOD_S: f64 = 1e-3;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "stiff-pole",
        about: "a current loop of 10 Hz to 1 MHz before an undamped device, by every method with 16 substeps",
        oracle: "u/J (t²/2 - t/w + (1 - exp(-w t))/w²); explicit methods end at w h = 2 and 2.785",
        unit: "rad over the way",
        run: stiff_pole,
    },
    Case {
        name: "stick-integrated",
        about: "nine tenths of the kinetic torque for 10^4 ticks, by every method",
        oracle: "set-valued friction holds bit for bit; smoothed friction creeps by v_s atanh(0.9) t",
        unit: "rad",
        run: stick,
    },
];

/// Angle in rad after `ticks` ticks (control periods) under a constant torque, with 16 substeps per tick.
fn pushed<M: Method<3>>(model: &Model<3>, ticks: u32) -> f64 {
    let Ok(plant) = Substepped::<M, 3>::new(model, PERIOD_S, 16) else {
        return f64::NAN;
    };
    let mut state = [0.0; 3];
    for _ in 0..ticks {
        plant.advance::<false>(&mut state, [0.01, 0.0]);
    }
    state[0]
}

fn stiff_pole(_: Effort) -> Result<Vec<Finding>> {
    const TICKS: u32 = 200;
    let device = Device {
        damping: 0.0,
        ..KNOB
    };
    let mut found = Vec::new();
    for hz in [10.0, 100.0, 1e3, 2e3, 5e3, 1e4, 1e5, 1e6] {
        let Ok(model) = Model::with_current_loop(&device, hz) else {
            continue;
        };
        let (w, t) = (std::f64::consts::TAU * hz, f64::from(TICKS) * PERIOD_S);
        let way = 0.01 / device.inertia * (0.5 * t * t - t / w - (-w * t).exp_m1() / (w * w));
        let off = |x: f64| (x / way - 1.0).abs();
        if let Ok(step) = ExactLinear::new(&model, PERIOD_S) {
            let mut state = [0.0; 3];
            for _ in 0..TICKS {
                step.step(&model, &mut state, [0.01, 0.0]);
            }
            found.push(Finding::new(
                format!("exact, {hz} Hz"),
                off(state[0]),
                1e-12,
            ));
        }
        // The bound is the relative change of the angle by a delay of one tick, far more than the error of any stable method.
        let coarse = 2.0 * PERIOD_S / t;
        let stiffness = w * PERIOD_S / 16.0;
        let implicit = [
            ("implicit-euler", pushed::<ImplicitEuler<3>>(&model, TICKS)),
            (
                "implicit-midpoint",
                pushed::<ImplicitMidpoint<3>>(&model, TICKS),
            ),
        ];
        for (name, x) in implicit {
            found.push(Finding::new(format!("{name}, {hz} Hz"), off(x), coarse));
        }
        let explicit = [
            (
                "semi-implicit-euler",
                pushed::<SemiImplicitEuler<3>>(&model, TICKS),
                2.0,
            ),
            (
                "runge-kutta-4",
                pushed::<RungeKutta4<3>>(&model, TICKS),
                2.785_293_563_405_282,
            ),
        ];
        for (name, x, most) in explicit {
            let finding = Finding::new(format!("{name}, {hz} Hz"), off(x), coarse);
            found.push(if stiffness > most {
                finding.failing(format!("w h is {stiffness:.2}, above {most:.3}"))
            } else {
                finding
            });
        }
    }
    Ok(found)
}

fn held<M: Method<2>>(torque: f64) -> f64 {
    let plant =
        Model::bare(&STICKY).and_then(|model| Substepped::<M, 2>::new(&model, PERIOD_S, 16));
    let Ok(plant) = plant else { return f64::NAN };
    let mut state = State::from_array([0.1, 0.0]);
    for _ in 0..10_000 {
        plant.step(&mut state, torque, 0.0);
    }
    (state.position() - 0.1).abs()
}

fn stick(_: Effort) -> Result<Vec<Finding>> {
    let torque = 0.9 * STICKY.friction.map_or(0.0, |friction| friction.kinetic);
    let creep = 1e4 * PERIOD_S * CREEP_RAD_PER_S * 0.9_f64.atanh();
    Ok(vec![
        Finding::new("implicit-euler", held::<ImplicitEuler<2>>(torque), 0.0),
        Finding::new(
            "implicit-midpoint",
            held::<ImplicitMidpoint<2>>(torque),
            0.0,
        ),
        Finding::new(
            "semi-implicit-euler",
            held::<SemiImplicitEuler<2>>(torque),
            0.0,
        ),
        Finding::new("runge-kutta-4", held::<RungeKutta4<2>>(torque), 0.0).failing(format!(
            "smoothed friction creeps: {creep:.3e} rad by the closed form"
        )),
        // The device's own damping takes b v of the torque, and the device needs a few ticks to reach its speed.
        Finding::new(
            "runge-kutta-4 less its creep, share",
            (held::<RungeKutta4<2>>(torque) / creep - 1.0).abs(),
            0.01,
        ),
    ])
}
