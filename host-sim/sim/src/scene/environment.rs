//! Walls, end stops, detents and torque profiles in addition to the main wall of a scene.

use super::detent_list::DetentList;
use super::feel::{AddedInertia, CentreSpring, Clicks, DryFriction, ViscousFriction};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use touchstone_control::environment::{FeelSettings, Refused, Shape, Side, WHOLE};

/// Walls, detents and torque profiles on the knob's axis in addition to `[wall]`. One energy guard bounds the sum of all torques.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Environment {
    /// Whether the main wall `[wall]` acts. Default true.
    pub first_wall: bool,
    /// A second wall. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wall2: Option<FurtherWall>,
    /// A third wall. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wall3: Option<FurtherWall>,
    /// A fourth wall. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wall4: Option<FurtherWall>,
    /// Walls at both ends of the travel. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub endstops: Option<Endstops>,
    /// Detents: angles to which the knob is pulled. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detents: Option<DetentRing>,
    /// A torque given as a curve over the angle. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<TorqueProfile>,
    /// Detents at listed angles, in place of a profile. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detent_list: Option<DetentList>,
    /// A spring that draws the knob to a centre. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spring: Option<CentreSpring>,
    /// Friction in proportion to the speed. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damper: Option<ViscousFriction>,
    /// Friction with a constant torque. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dry_friction: Option<DryFriction>,
    /// Short torques at evenly spaced angles. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub click: Option<Clicks>,
    /// A virtual mass that the knob drags. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inertia: Option<AddedInertia>,
}

impl Default for Environment {
    fn default() -> Self {
        Environment {
            first_wall: true,
            wall2: None,
            wall3: None,
            wall4: None,
            endstops: None,
            detents: None,
            profile: None,
            detent_list: None,
            spring: None,
            damper: None,
            dry_friction: None,
            click: None,
            inertia: None,
        }
    }
}

/// A wall in addition to `[wall]`, with its own copy of the control law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FurtherWall {
    /// Position of the surface, rad. Default 0.
    pub at_rad: f64,
    /// Side of the surface on which the wall is solid. Default `below`.
    #[serde(
        serialize_with = "super::law::word",
        deserialize_with = "super::law::of_word"
    )]
    pub solid: Side,
    /// Stiffness that the wall should display, N·m/rad, 0 to 500,000. Absent: the stiffness of `[wall]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffness_n_m_per_rad: Option<f64>,
}

impl Default for FurtherWall {
    fn default() -> Self {
        FurtherWall {
            at_rad: 0.0,
            // Opposite to the main wall, which is solid above its surface.
            solid: Side::Below,
            stiffness_n_m_per_rad: None,
        }
    }
}

/// Walls at both ends of the travel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Endstops {
    /// The lower end, rad: solid below it. Default -1.
    pub lower_rad: f64,
    /// The upper end, rad: solid above it. Default 1.
    pub upper_rad: f64,
    /// Stiffness that each of the two end stops should display, N·m/rad, 0 to 500,000. Absent: the stiffness of `[wall]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffness_n_m_per_rad: Option<f64>,
}

impl Default for Endstops {
    fn default() -> Self {
        Endstops {
            lower_rad: -1.0,
            upper_rad: 1.0,
            stiffness_n_m_per_rad: None,
        }
    }
}

/// Equally spaced detents. The torque is a triangle wave over the angle, of amplitude `strength_n_m`, with one period per detent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DetentRing {
    /// Number of detents per turn, 1 to 6283. With 0 the detents are `pitch_rad` apart. Default 24.
    pub per_rev: u32,
    /// Angle between two neighbouring detents, rad, 0.001 to a turn. Only used if `per_rev` is 0. Default 0.2.
    pub pitch_rad: f64,
    /// Largest torque of a detent, N·m, from 0 to the force limit of the control law; it acts a quarter of the way to the next
    /// detent. With 0 a program counts the detents and the hand does not feel them. Default 0.02.
    pub strength_n_m: f64,
    /// Position of one of the detents, rad. Default 0.
    pub centre_rad: f64,
}

impl Default for DetentRing {
    fn default() -> Self {
        DetentRing {
            per_rev: 24,
            pitch_rad: 0.2,
            strength_n_m: 0.02,
            centre_rad: 0.0,
        }
    }
}

/// A torque given as a curve over the angle: equally spaced points, joined by straight lines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TorqueProfile {
    /// Number of copies of the profile per turn, 1 to 6283. A straight line joins the last point of a copy to the first of the
    /// next.
    ///
    /// With 0 the profile exists once, from `start_rad` to `end_rad`; outside, the torque of the nearer end point acts. Default 6.
    pub per_rev: u32,
    /// Position of the first point, rad. Default 0.
    pub start_rad: f64,
    /// Position of the last point, rad. Only used if `per_rev` is 0. Default 1.
    pub end_rad: f64,
    /// Torque of a point of value 1, N·m, from 0 to the force limit of the control law. Default 0.02.
    pub strength_n_m: f64,
    /// The 2 to 96 points of the profile, each from -1 to 1 and rounded to 0.0001. A positive value pushes towards larger angles.
    ///
    /// Default: a magnetic detent. It attracts the knob within a quarter of the distance between detents on either side, most
    /// strongly at an eighth, and leaves the knob free elsewhere.
    pub shape: Vec<f64>,
}

impl Default for TorqueProfile {
    fn default() -> Self {
        TorqueProfile {
            per_rev: 6,
            start_rad: 0.0,
            end_rad: 1.0,
            strength_n_m: 0.02,
            shape: vec![0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        }
    }
}

impl TorqueProfile {
    /// Converts the points to the fixed-point format of the control law.
    ///
    /// # Errors
    /// There are fewer than 2 points or more than 96, or a point is outside -1 to 1.
    pub fn points(&self) -> std::result::Result<Shape, Refused> {
        let points: Vec<i16> = (self.shape.iter())
            .map(|point| (point * f64::from(WHOLE)).round() as i16)
            .collect();
        Shape::new(&points)
    }

    /// Converts points in the fixed-point format of the control law to floats for a scene.
    #[must_use]
    pub fn of_points(shape: &Shape) -> Vec<f64> {
        (shape.points().iter())
            .map(|point| f64::from(*point) / f64::from(WHOLE))
            .collect()
    }
}

impl Environment {
    /// Whether the scene has anything in addition to `[wall]`, or lacks `[wall]`.
    #[must_use]
    pub fn is_more_than_the_wall(&self) -> bool {
        let detents = self.detents.as_ref();
        !self.first_wall
            || self.endstops.is_some()
            || self.further().next().is_some()
            || detents.is_some_and(|it| it.strength_n_m > 0.0)
            || self.acting_profile().is_some()
            || self.feel() != FeelSettings::default()
    }

    /// The torque profile of the listed detents if they have torque, else that of the scene. `None` if there is none or its
    /// strength is 0.
    #[must_use]
    pub fn acting_profile(&self) -> Option<Cow<'_, TorqueProfile>> {
        match self.acting_list() {
            // The list of a checked scene converts without an error. An error would give `None`.
            Some(list) => list.profile().ok().map(Cow::Owned),
            None => self.profile.as_ref().map(Cow::Borrowed),
        }
        .filter(|it| it.strength_n_m > 0.0)
    }

    /// The list of detents; `None` if the scene has no list or no detent in it has torque.
    #[must_use]
    pub fn acting_list(&self) -> Option<&DetentList> {
        self.detent_list.as_ref().filter(|it| it.acts())
    }

    /// The table from which [`Environment::acting_profile`] comes.
    #[must_use]
    pub fn profile_table(&self) -> &'static str {
        match self.acting_list() {
            Some(_) => "environment.detent_list",
            None => "environment.profile",
        }
    }

    /// Walls in addition to `[wall]`, each with the name of its table in the scene file.
    pub fn further(&self) -> impl Iterator<Item = (&'static str, &FurtherWall)> {
        [
            ("environment.wall2", &self.wall2),
            ("environment.wall3", &self.wall3),
            ("environment.wall4", &self.wall4),
        ]
        .into_iter()
        .filter_map(|(table, wall)| Some((table, wall.as_ref()?)))
    }
}
