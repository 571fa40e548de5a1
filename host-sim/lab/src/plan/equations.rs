//! States and eigenvalues of the linear part of a scene's device and hand.

use nalgebra::DMatrix;
use serde::Serialize;
use touchstone_sim::error::Result;
use touchstone_sim::run::train::{self, Train};
use touchstone_sim::scene::Scene;
use touchstone_world::plant::Invalid;
use touchstone_world::plant::train::{Friction, Links};

/// An eigenvalue of the linear part of device and hand, 1/s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Eigenvalue {
    /// Real part, 1/s; the motion grows if it is positive.
    pub re_per_s: f64,
    /// Imaginary part, rad/s, not negative: one value stands for a conjugate pair.
    pub im_rad_per_s: f64,
    /// Undamped frequency of an oscillating pair, Hz; `None` for a real eigenvalue.
    pub frequency_hz: Option<f64>,
}

/// Names of the state variables of device and hand.
pub fn states(scene: &Scene) -> Vec<String> {
    let links = train::links(scene);
    let device = if links.transmission.is_some() {
        "the motor's"
    } else {
        "the device's"
    };
    let mut pairs = vec![device];
    if links.transmission.is_some() {
        pairs.push("the knob's");
    }
    if links.hand.is_some() {
        pairs.push("the hand's");
    }
    let mut names: Vec<String> = pairs
        .iter()
        .flat_map(|whose| [format!("{whose} angle"), format!("{whose} velocity")])
        .collect();
    if links.current.is_some() {
        names.push("the motor's torque".to_owned());
    }
    let bristles =
        Train::of(scene).is_some_and(|train| matches!(train.shaft.friction, Friction::Bristles(_)));
    if bristles {
        names.push("the bristles' deflection".to_owned());
    }
    names
}

fn matrix(links: &Links) -> std::result::Result<DMatrix<f64>, Invalid> {
    fn of<const N: usize, const K: usize>(
        links: &Links,
    ) -> std::result::Result<DMatrix<f64>, Invalid> {
        let matrix = links.matrix::<N, K>()?;
        Ok(DMatrix::from_fn(N, N, |row, column| matrix[(row, column)]))
    }
    match links.states() {
        2 => of::<2, 6>(links),
        3 => of::<3, 7>(links),
        4 => of::<4, 8>(links),
        5 => of::<5, 9>(links),
        6 => of::<6, 10>(links),
        _ => of::<7, 11>(links),
    }
}

/// Eigenvalues of the linear part, the smallest magnitude first.
///
/// # Errors
/// The plant's parameters are not valid.
pub fn eigenvalues(scene: &Scene) -> Result<Vec<Eigenvalue>> {
    let matrix = matrix(&train::links(scene)).map_err(|invalid| {
        scene.error(
            "device",
            invalid.to_string(),
            "correct these values of the scene",
        )
    })?;
    let mut found: Vec<Eigenvalue> = matrix
        .complex_eigenvalues()
        .iter()
        // Keeps one value of each conjugate pair. The imaginary part of a real eigenvalue is exactly 0.
        .filter(|value| value.im >= 0.0)
        .map(|value| Eigenvalue {
            re_per_s: value.re,
            im_rad_per_s: value.im,
            frequency_hz: (value.im > 0.0).then(|| value.norm() / std::f64::consts::TAU),
        })
        .collect();
    found.sort_by(|a, b| {
        let size = |value: &Eigenvalue| value.re_per_s.hypot(value.im_rad_per_s);
        size(a).total_cmp(&size(b))
    });
    Ok(found)
}
