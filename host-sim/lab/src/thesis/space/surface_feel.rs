//! What a scene of three axes adds to the wall along the normal: pulse and vibration at the touch (`[law.impact]`), and a texture
//! (`[object.texture]`).

use super::texture::{HIGHEST_MM, PERIODS_MM, Texture};
use super::tuned_wall::TunedWall;
use super::{Mechanism, RATE_HZ};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use touchstone_control::Si;
use touchstone_control::settings::ImpactSettings;
use touchstone_sim::scene::Law;

/// What is added to the wall of a cell along the normal of its surface; by default nothing but the shipped wall's own pulse.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SurfaceFeel {
    /// Pulse and vibration at the touch of the shipped wall; `None` for those that it was tuned with.
    pub impact: Option<ImpactSettings>,
    /// Grooves in the surface; `None` for a smooth one.
    pub texture: Option<Texture>,
}

/// Materials that a decaying vibration at the touch imitates (`docs/tuning.md`): share of the speed, Hz, and s.
pub const MATERIALS: [(&str, [f64; 3]); 3] = [
    ("rubber", [0.3, 20.0, 0.015]),
    ("wood", [0.3, 40.0, 0.012]),
    ("metal", [0.3, 100.0, 0.02]),
];

/// Pulse and vibration of a material on the shipped wall of a mechanism.
#[must_use]
pub fn material(values: [f64; 3], mechanism: Mechanism) -> ImpactSettings {
    material_table(values, mechanism).settings(mechanism)
}

/// The table `[law.impact]` that gives the shipped wall of a mechanism this material.
#[must_use]
pub fn material_table(values: [f64; 3], mechanism: Mechanism) -> SpaceImpact {
    let [share, hz, decay_s] = values.map(Some);
    SpaceImpact {
        share_of_momentum: Some(TunedWall::of(mechanism, RATE_HZ).pulse),
        vibration_share_of_speed: share,
        vibration_hz: hz,
        vibration_decay_s: decay_s,
    }
}

impl SurfaceFeel {
    /// The grooves for readers; `None` for a smooth surface.
    #[must_use]
    pub fn texture_text(&self) -> Option<String> {
        let Texture {
            height_mm,
            period_mm,
            along,
        } = self.texture?;
        let [x, y, z] = along.map(rounded);
        Some(format!(
            "grooves of {height_mm} mm every {period_mm} mm along ({x}, {y}, {z})"
        ))
    }

    /// The vibration at the touch for readers: the name of its material, or its values; `None` without a vibration.
    #[must_use]
    pub fn material_text(&self, mechanism: Mechanism) -> Option<String> {
        let impact = self.impact.filter(|impact| impact.vibration > 0)?;
        let known = MATERIALS.iter().find(|(_, values)| {
            let material = material(*values, mechanism);
            ImpactSettings {
                momentum: impact.momentum,
                ..material
            } == impact
        });
        Some(match known {
            Some((name, _)) => (*name).to_owned(),
            None => {
                // As in `SpaceImpact::settings`, but the other way: the share of the axis' own speed.
                let tuned = TunedWall::of(mechanism, RATE_HZ);
                let share = impact.vibration.to_num::<f64>() * tuned.estimator_kg / tuned.axis_kg;
                format!(
                    "vibration of {} of the speed at {} Hz for {} s",
                    rounded(share),
                    impact.frequency_hz,
                    impact.decay_s
                )
            }
        })
    }
}

/// A number rounded to three decimals, and without the sign of a zero.
fn rounded(number: f64) -> f64 {
    (1e3 * number).round() / 1e3 + 0.0
}

/// Table `[law.impact]` of the scene file, with the keys, units and ranges of a scene of one axis. Shares refer to the mass of
/// the device's lightest axis and the speed along the normal.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpaceImpact {
    /// Share of the device's momentum that a pulse takes away at the touch, 0 to 2. Default: that of the tuned wall.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share_of_momentum: Option<f64>,
    /// Speed of a decaying vibration after the touch as a share of the speed before, 0 to 1. Default: 0, no vibration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vibration_share_of_speed: Option<f64>,
    /// Frequency of the vibration, 1 to 100 Hz (a tenth of the control rate).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vibration_hz: Option<f64>,
    /// Time in which the vibration's amplitude falls to 37 %, 0.001 to 1 s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vibration_decay_s: Option<f64>,
}

/// Table `[object.texture]` of the scene file: grooves in the surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpaceTexture {
    /// Height of a ridge over a groove, mm; above 0, at most a tenth of `period_mm` and 5.
    pub height_mm: f64,
    /// Distance between two ridges along `along`, 0.2 to 100 mm.
    pub period_mm: f64,
    /// Direction across the grooves, of any length above 0. Default: x.
    #[serde(default = "x")]
    pub along: [f64; 3],
}

fn x() -> [f64; 3] {
    [1.0, 0.0, 0.0]
}

/// A field of a scene with what is wrong with its value.
type Refused = (&'static str, String);

/// A value of `[law.impact]`: name, least and largest value, description. The ranges are those of one axis
/// (`touchstone_control::law_settings`), with the largest frequency for the control rate of three axes.
const IMPACT: [(&str, f64, f64, &str); 4] = [
    (
        "law.impact.share_of_momentum",
        0.0,
        2.0,
        "share of the device's momentum that a pulse takes away at the touch; left out: that of the tuned wall",
    ),
    (
        "law.impact.vibration_share_of_speed",
        0.0,
        1.0,
        "speed of a decaying vibration after the touch as a share of the speed before; left out: 0, no vibration",
    ),
    (
        "law.impact.vibration_hz",
        1.0,
        RATE_HZ as f64 / 10.0,
        "the vibration's frequency, Hz; left out: 100",
    ),
    (
        "law.impact.vibration_decay_s",
        0.001,
        1.0,
        "time in which the vibration's amplitude falls to 37 %, s; left out: 0.011",
    ),
];

impl SpaceImpact {
    /// Checks the values, and fills in the defaults for a mechanism.
    ///
    /// # Errors
    /// The field whose value is out of range, and its range.
    pub(super) fn completed(self, mechanism: Mechanism) -> Result<Self, Refused> {
        let one_axis = Law::default().impact;
        let own = [
            TunedWall::of(mechanism, RATE_HZ).pulse,
            one_axis.vibration_share_of_speed,
            one_axis.vibration_hz,
            one_axis.vibration_decay_s,
        ];
        let given = [
            self.share_of_momentum,
            self.vibration_share_of_speed,
            self.vibration_hz,
            self.vibration_decay_s,
        ];
        let mut full = [None; 4];
        for (index, (field, least, most, _)) in IMPACT.into_iter().enumerate() {
            let value = given[index].unwrap_or(own[index]);
            if !(least..=most).contains(&value) {
                return Err((field, format!("must be {least} to {most}")));
            }
            full[index] = Some(value);
        }
        let [
            share_of_momentum,
            vibration_share_of_speed,
            vibration_hz,
            vibration_decay_s,
        ] = full;
        Ok(Self {
            share_of_momentum,
            vibration_share_of_speed,
            vibration_hz,
            vibration_decay_s,
        })
    }

    /// The settings of pulse and vibration for the tuned wall of a mechanism. The law computes both with the estimator's tuned mass.
    /// A factor makes them shares of the momentum and the speed of the axis itself.
    #[must_use]
    pub(super) fn settings(&self, mechanism: Mechanism) -> ImpactSettings {
        let tuned = TunedWall::of(mechanism, RATE_HZ);
        let plain = ImpactSettings::default();
        let si = |value: Option<f64>, default| value.map_or(default, Si::saturating_from_num);
        let share = |value: Option<f64>| {
            let of_estimator = |share: f64| share * tuned.axis_kg / tuned.estimator_kg;
            si(value.map(of_estimator), Si::ZERO)
        };
        ImpactSettings {
            momentum: share(self.share_of_momentum),
            vibration: share(self.vibration_share_of_speed),
            frequency_hz: si(self.vibration_hz, plain.frequency_hz),
            decay_s: si(self.vibration_decay_s, plain.decay_s),
        }
    }

    /// JSON schema of the table.
    pub(super) fn schema() -> Value {
        let properties: serde_json::Map<String, Value> = IMPACT
            .into_iter()
            .map(|(field, least, most, about)| {
                let name = field.rsplit('.').next().unwrap_or(field).to_owned();
                let value = json!({
                    "type": "number",
                    "minimum": least,
                    "maximum": most,
                    "description": about,
                });
                (name, value)
            })
            .collect();
        json!({
            "type": "object",
            "description": "what the approach \"shipped\" adds along the normal at the touch",
            "additionalProperties": false,
            "properties": properties,
        })
    }
}

impl SpaceTexture {
    /// Checks the values, and makes the direction a unit vector.
    ///
    /// # Errors
    /// The field whose value is out of range, and its range.
    pub(super) fn completed(self) -> Result<Self, Refused> {
        let named = |(name, range)| {
            let field = match name {
                "period_mm" => "object.texture.period_mm",
                "height_mm" => "object.texture.height_mm",
                _ => "object.texture.along",
            };
            (field, range)
        };
        let along = self.texture().validated().map_err(named)?.along;
        Ok(Self { along, ..self })
    }

    /// The grooves that the table describes.
    pub(super) fn texture(&self) -> Texture {
        Texture {
            height_mm: self.height_mm,
            period_mm: self.period_mm,
            along: self.along,
        }
    }

    /// JSON schema of the table.
    pub(super) fn schema() -> Value {
        let [least, most] = PERIODS_MM;
        json!({
            "type": "object",
            "description": "grooves in the surface; the force stays along the smooth object's normal",
            "additionalProperties": false,
            "required": ["height_mm", "period_mm"],
            "properties": {
                "height_mm": {
                    "type": "number",
                    "exclusiveMinimum": 0,
                    "maximum": HIGHEST_MM,
                    "description": "height of a ridge over a groove, mm; at most a tenth of period_mm",
                },
                "period_mm": {
                    "type": "number",
                    "minimum": least,
                    "maximum": most,
                    "description": "distance between two ridges, mm",
                },
                "along": {
                    "type": "array",
                    "items": {"type": "number"},
                    "minItems": 3,
                    "maxItems": 3,
                    "description": "direction across the grooves, x, y, z; left out: x",
                },
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_are_those_of_the_documentation() {
        let page = include_str!("../../../../../docs/tuning.md");
        for (name, [share, hz, decay_s]) in MATERIALS {
            let row = format!("| {name} | {share} | {hz} | {decay_s} |");
            assert!(page.contains(&row), "{row}");
        }
    }

    #[test]
    fn a_feel_is_named_for_readers() {
        let feel_along = |along: [i32; 3], impact: Value| {
            let scene = json!({
                "dof": 3,
                "object": {"texture": {"height_mm": 0.1, "period_mm": 2, "along": along}},
                "law": {"approach": "shipped", "impact": impact},
            });
            let scene: super::super::scene::SpaceScene = serde_json::from_value(scene).unwrap();
            scene.completed().unwrap().cell().touched()
        };
        let feel = |impact| feel_along([0, 5, 0], impact);
        assert_eq!(
            feel_along([1, -2, 0], json!({})),
            "horizontal plane, grooves of 0.1 mm every 2 mm along (0.447, -0.894, 0)"
        );
        let grooves = "horizontal plane, grooves of 0.1 mm every 2 mm along (0, 1, 0)";
        assert_eq!(feel(json!({})), grooves);
        let metal = json!({"vibration_share_of_speed": 0.3, "vibration_decay_s": 0.02});
        assert_eq!(feel(metal), format!("{grooves}, metal"));
        for [share, hz, decay_s] in [[0.3, 64.0, 0.125], [0.2, 40.0, 0.012]] {
            let own = json!({"vibration_share_of_speed": share, "vibration_hz": hz, "vibration_decay_s": decay_s});
            let vibration = format!("vibration of {share} of the speed at {hz} Hz for {decay_s} s");
            assert_eq!(feel(own), format!("{grooves}, {vibration}"));
        }
        assert_eq!(SurfaceFeel::default().texture_text(), None);
    }
}
