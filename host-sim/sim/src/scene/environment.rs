//! Walls, end stops, detents and torque profiles in addition to the main wall of a scene.

use super::detent_list::DetentList;
use super::feel::{AddedInertia, CentreSpring, Clicks, DryFriction, ViscousFriction};
use super::torque_profile::TorqueProfile;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use touchstone_control::Si;
use touchstone_control::environment::{
    CentreSettings, ClickSettings, DrySettings, FeelSettings, InertiaSettings, Side, Spacing,
    ViscousSettings,
};

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

    /// The parts of the feel as the control law's settings. A part without a torque is left out.
    #[must_use]
    pub fn feel(&self) -> FeelSettings {
        FeelSettings {
            spring: (self.spring.as_ref())
                .filter(|it| it.stiffness_n_m_per_rad > 0.0 && it.strength_n_m > 0.0)
                .map(|it| CentreSettings {
                    centre: si(it.centre_rad),
                    stiffness: si(it.stiffness_n_m_per_rad),
                    strength: si(it.strength_n_m),
                }),
            viscous: (self.damper.as_ref())
                .filter(|it| it.damping_n_m_s_per_rad > 0.0)
                .map(|it| ViscousSettings {
                    damping: si(it.damping_n_m_s_per_rad),
                    bandwidth_hz: si(it.bandwidth_hz),
                }),
            dry: (self.dry_friction.as_ref())
                .filter(|it| it.strength_n_m > 0.0)
                .map(|it| DrySettings {
                    strength: si(it.strength_n_m),
                    stretch: si(it.stretch_rad),
                }),
            click: (self.click.as_ref())
                .filter(|it| it.strength_n_m > 0.0)
                .map(|it| ClickSettings {
                    spacing: match it.per_rev {
                        0 => Spacing::Pitch(si(it.pitch_rad)),
                        per_rev => Spacing::PerTurn(u16::try_from(per_rev).unwrap_or(u16::MAX)),
                    },
                    centre: si(it.centre_rad),
                    strength: si(it.strength_n_m),
                    duration_s: si(it.duration_s),
                }),
            inertia: (self.inertia.as_ref())
                .filter(|it| it.inertia_kg_m2 > 0.0)
                .map(|it| InertiaSettings {
                    inertia: si(it.inertia_kg_m2),
                    bandwidth_hz: si(it.bandwidth_hz),
                }),
        }
    }

    /// This environment with the parts of a feel from the control law's settings.
    #[must_use]
    pub fn with_feel(self, feel: &FeelSettings) -> Self {
        Environment {
            spring: feel.spring.map(|it| CentreSpring {
                centre_rad: plain(it.centre),
                stiffness_n_m_per_rad: plain(it.stiffness),
                strength_n_m: plain(it.strength),
            }),
            damper: feel.viscous.map(|it| ViscousFriction {
                damping_n_m_s_per_rad: plain(it.damping),
                bandwidth_hz: plain(it.bandwidth_hz),
            }),
            dry_friction: feel.dry.map(|it| DryFriction {
                strength_n_m: plain(it.strength),
                stretch_rad: plain(it.stretch),
            }),
            click: feel.click.map(|it| Clicks {
                per_rev: match it.spacing {
                    Spacing::PerTurn(per_turn) => per_turn.into(),
                    Spacing::Pitch(_) => 0,
                },
                pitch_rad: match it.spacing {
                    Spacing::Pitch(pitch) => plain(pitch),
                    Spacing::PerTurn(_) => Clicks::default().pitch_rad,
                },
                centre_rad: plain(it.centre),
                strength_n_m: plain(it.strength),
                duration_s: plain(it.duration_s),
            }),
            inertia: feel.inertia.map(|it| AddedInertia {
                inertia_kg_m2: plain(it.inertia),
                bandwidth_hz: plain(it.bandwidth_hz),
            }),
            ..self
        }
    }
}

fn si(value: f64) -> Si {
    Si::saturating_from_num(value)
}

/// The number rounded to nine decimals, as a person writes it. The fixed-point format has more digits.
fn plain(value: Si) -> f64 {
    let value: f64 = value.to_num();
    format!("{value:.9}").parse().unwrap_or(value)
}
