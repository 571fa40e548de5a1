//! A survey: a haptic device's inertia, Jacobian and ranges as its library reports them with the motors off. It is a file from
//! which the device can be simulated.

use crate::Omega3;
use crate::haptic::{DeviceTwin, HapticDevice, HapticFault};
use serde::{Deserialize, Serialize};
use std::path::Path;
use touchstone_sim::error::{Error, Result};
use touchstone_world::plant::{Device, OMEGA3_AXIS};

/// The survey of a haptic device. Either the device's library reported all values except damping and friction, or the values were
/// measured ([`Survey::measured`]).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Survey {
    /// Name and serial number of the device.
    pub device: String,
    /// Version of the maker's library; empty if it is unknown.
    pub library: String,
    /// Mass of the effector in kilograms that the library assumes; `None` if it does not say.
    pub effector_mass_kg: Option<f64>,
    /// Inertia along each axis, kg: the mean over all recorded poses, or the measured mass.
    pub inertia_kg: [f64; 3],
    /// Damping of each axis, N·s/m. No library reports it, so it is the value of the thesis (§5.2) until `touchstone device
    /// identify` measures it.
    pub damping_n_s_per_m: [f64; 3],
    /// Dry friction of each axis, N; `None` if it was not measured. The simulated copy of the device has no dry friction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_n: Option<[f64; 3]>,
    /// Smallest coordinates of the recorded positions, m.
    pub position_min_m: [f64; 3],
    /// Largest coordinates of the recorded positions, m.
    pub position_max_m: [f64; 3],
    /// Lower ends of the joints' ranges, rad.
    pub joint_angle_min_rad: Vec<f64>,
    /// Upper ends of the joints' ranges, rad.
    pub joint_angle_max_rad: Vec<f64>,
    /// The recorded poses, each with the values that the library reported there.
    #[serde(default)]
    pub pose: Vec<Pose>,
}

/// A recorded position of the effector with the values that the library reported there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// Position of the effector, m.
    pub position_m: [f64; 3],
    /// Angles of the delta mechanism's three joints, rad.
    pub joint_angles_rad: [f64; 3],
    /// Inertia in Cartesian coordinates at this position, kg.
    pub inertia_kg: [[f64; 3]; 3],
    /// Jacobian at this position: metres of the effector per radian of each joint.
    pub jacobian_m_per_rad: [[f64; 3]; 3],
}

/// The first three rows and columns of a 6-by-6 matrix: those of the translation.
fn corner(matrix: &[[f64; 6]; 6]) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[i][j]))
}

impl Pose {
    /// Reads the present pose from the library. The motors stay as they are.
    ///
    /// # Errors
    /// The device's library does not have the values, or returned numbers that are not finite.
    pub fn now(omega: &mut Omega3) -> std::result::Result<Self, HapticFault> {
        let position_m = omega.sense()?.position_m;
        let (library, id) = omega.library()?;
        let said = library.as_expert(|| {
            let angles = library.joint_angles(id)?;
            let inertia = library.inertia(&angles, id)?;
            Ok::<_, touchstone_dhd::DhdError>((angles, inertia, library.jacobian(id)?))
        })?;
        let (angles, inertia, jacobian_m_per_rad) = said?;
        let pose = Self {
            position_m,
            joint_angles_rad: [angles[0], angles[1], angles[2]],
            inertia_kg: corner(&inertia),
            jacobian_m_per_rad,
        };
        let matrices = pose.inertia_kg.iter().chain(&pose.jacobian_m_per_rad);
        let mut numbers = matrices
            .flatten()
            .chain(&pose.position_m)
            .chain(&pose.joint_angles_rad);
        match numbers.all(|x| x.is_finite()) {
            true => Ok(pose),
            false => Err(HapticFault::NotFinite("inertia, Jacobian or position")),
        }
    }
}

impl Survey {
    /// Makes a survey from recorded poses.
    ///
    /// # Errors
    /// There is no pose, or the library does not return the ranges.
    pub fn of(omega: &mut Omega3, poses: Vec<Pose>) -> std::result::Result<Self, HapticFault> {
        let device = omega.sheet().name.clone();
        let (library, id) = omega.library()?;
        let (low, high) = library.as_expert(|| library.joint_range(id))??;
        let count = poses.len() as f64;
        if poses.is_empty() {
            return Err(HapticFault::Unusable(
                "no pose was read".into(),
                "survey it for longer".into(),
            ));
        }
        let of_axes = |pick: &dyn Fn(usize) -> f64| std::array::from_fn(pick);
        let along = |axis: usize| poses.iter().map(move |pose| pose.position_m[axis]);
        Ok(Self {
            device,
            library: library.version().unwrap_or_default(),
            effector_mass_kg: library.effector_mass_kg(id),
            inertia_kg: of_axes(&|axis| {
                poses
                    .iter()
                    .map(|pose| pose.inertia_kg[axis][axis])
                    .sum::<f64>()
                    / count
            }),
            damping_n_s_per_m: [OMEGA3_AXIS.damping; 3],
            friction_n: None,
            position_min_m: of_axes(&|axis| along(axis).fold(f64::INFINITY, f64::min)),
            position_max_m: of_axes(&|axis| along(axis).fold(f64::NEG_INFINITY, f64::max)),
            joint_angle_min_rad: low.to_vec(),
            joint_angle_max_rad: high.to_vec(),
            pose: poses,
        })
    }

    /// Makes a survey from measured mass, damping and friction of each axis, and the range of motion.
    #[must_use]
    pub fn measured(
        device: &str,
        axes: [[f64; 3]; 3],
        position_min_m: [f64; 3],
        position_max_m: [f64; 3],
    ) -> Self {
        Self {
            device: device.into(),
            library: String::new(),
            effector_mass_kg: None,
            inertia_kg: axes.map(|[mass, _, _]| mass),
            damping_n_s_per_m: axes.map(|[_, damping, _]| damping),
            friction_n: Some(axes.map(|[_, _, friction]| friction)),
            position_min_m,
            position_max_m,
            joint_angle_min_rad: Vec::new(),
            joint_angle_max_rad: Vec::new(),
            pose: Vec::new(),
        }
    }

    /// The survey as the text of a TOML file.
    ///
    /// # Errors
    /// A number cannot be written as TOML.
    pub fn to_toml(&self) -> std::result::Result<String, toml::ser::Error> {
        toml::to_string(self)
    }

    /// Reads a survey from a TOML file.
    ///
    /// # Errors
    /// The file cannot be read, or is no survey.
    pub fn read(path: &Path) -> Result<Self> {
        let text = touchstone_sim::input::text(path, touchstone_sim::input::MOST_OF_SETTINGS)
            .map_err(|error| Error::Io {
                path: path.to_owned(),
                problem: error.to_string(),
                fix: "give a file of `touchstone device survey`".into(),
            })?;
        let mut survey: Self = toml::from_str(&text).map_err(|error| {
            let before = error.span().map_or(0, |span| span.start).min(text.len());
            Error::File {
                file: path.to_owned(),
                line: 1 + text[..before].matches('\n').count(),
                field: "survey".into(),
                problem: error.message().to_owned(),
                fix: "give a file of `touchstone device survey`".into(),
            }
        })?;
        // The name is printed, and a file from elsewhere may contain any characters.
        survey.device = touchstone_sim::harmless::one_line(&survey.device);
        Ok(survey)
    }

    /// A simulated copy of the device: masses and damping from the survey, all other values those of an omega.3.
    ///
    /// # Errors
    /// A mass or a damping is outside the range that the simulation accepts.
    pub fn twin(&self) -> Result<DeviceTwin> {
        let axes = std::array::from_fn(|axis| Device {
            inertia: self.inertia_kg[axis],
            damping: self.damping_n_s_per_m[axis],
            friction: None,
        });
        let twin = DeviceTwin {
            axes,
            ..DeviceTwin::default()
        };
        twin.validate().map_err(|why| Error::Option {
            option: "--twin".into(),
            problem: why.to_string(),
            fix: "correct inertia_kg and damping_n_s_per_m in the survey".into(),
        })?;
        Ok(twin)
    }
}
