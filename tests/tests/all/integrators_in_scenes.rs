//! Tests a numerical integrator that a scene file (description of a simulation) names in place of the exact solution of the motion.
//! The integrator's result converges to the exact solution. A scene that names the exact solution gives the results of one without
//! a name.

use touchstone_sim::run;
use touchstone_sim::scene::{Choice as _, Integrator, Scene};

/// Description of a simulated press without encoder and friction, with a linear control law in floating point. Small differences of
/// the motion are then not amplified.
fn smooth() -> Scene {
    Scene::load("press-hold")
        .unwrap()
        .with_overrides(&[
            "law.kind=spring",
            "wall.k_desired_n_m_per_rad=0.5",
            "law.number=f64",
        ])
        .unwrap()
}

fn angles(scene: &Scene) -> Vec<f64> {
    run::run(scene, true).unwrap().trace.unwrap().angle_rad
}

fn off(scene: &Scene, integrator: &str, substeps: u32) -> f64 {
    let changed = scene
        .with_overrides(&[
            format!("plant.integrator={integrator}"),
            format!("plant.substeps={substeps}"),
        ])
        .unwrap();
    angles(scene)
        .iter()
        .zip(angles(&changed))
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

#[test]
fn each_integrator_converges_to_the_exact_step_with_its_order() {
    for delay in ["0", "3e-4"] {
        let scene = smooth()
            .with_overrides(&[format!("timing.computational_delay_s={delay}")])
            .unwrap();
        for (integrator, order, substeps) in [
            ("implicit-euler", 1, 160),
            ("implicit-midpoint", 2, 40),
            ("semi-implicit-euler", 1, 160),
            ("runge-kutta-4", 4, 10),
        ] {
            let (coarse, fine) = (
                off(&scene, integrator, substeps),
                off(&scene, integrator, 2 * substeps),
            );
            let found = (coarse / fine).log2();
            println!("delay {delay} {integrator}: {coarse:.2e} {fine:.2e}, order {found:.2}");
            assert!(
                (found - f64::from(order)).abs() < 0.15,
                "{integrator}: {coarse:e} {fine:e}"
            );
        }
    }
}

#[test]
fn the_exact_step_by_its_name_is_the_one_of_a_scene_without_a_name() {
    for name in ["press-hold", "thesis-knob", "free-release"] {
        let scene = Scene::load(name).unwrap();
        assert!(scene.plant.is_none());
        assert_eq!(off(&scene, Integrator::Exact.word(), 3), 0.0, "{name}");
        assert!(off(&scene, "implicit-euler", 1) > 0.0, "{name}");
    }
}
