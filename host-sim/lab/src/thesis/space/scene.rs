//! Scene files for three degrees of freedom (`dof = 3`), which `touchstone run` simulates.

use super::mechanism::Mechanism;
use super::surface_feel::{SpaceImpact, SpaceTexture};
use super::{Approach, Cell, Object, SurfaceFeel, shipped_n_per_mm};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use touchstone_sim::harmless::one_line;

/// A scene for three degrees of freedom. Fields that the file leaves out have default values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpaceScene {
    /// Name of the scene, used as a heading.
    #[serde(default = "unnamed")]
    pub name: String,
    /// Description of the scene.
    #[serde(default)]
    pub description: String,
    /// Number of degrees of freedom, always 3.
    pub dof: u8,
    /// The object that the hand touches.
    #[serde(default)]
    pub object: SpaceObject,
    /// How the force is computed.
    #[serde(default)]
    pub law: SpaceLaw,
    /// Mechanism of the device.
    #[serde(default)]
    pub mechanism: SpaceMechanism,
}

/// Table `[object]` of the scene file: the touched object.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpaceObject {
    /// Type of the object.
    #[serde(default)]
    pub kind: Object,
    /// Grooves in its surface; a smooth surface if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texture: Option<SpaceTexture>,
}

/// Table `[law]` of the scene file: how the force is computed.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpaceLaw {
    /// Approach (way in which the force is computed): a control law, and the rule for the direction of its force.
    #[serde(default)]
    pub approach: Approach,
    /// Requested stiffness, N/mm. If left out, it is five times the largest stable stiffness of a plain spring on the mechanism,
    /// or, with the approach [`Approach::Shipped`], that of the shipped wall.
    #[serde(default)]
    pub k_desired_n_per_mm: Option<f64>,
    /// Pulse and vibration at the touch, for the approach [`Approach::Shipped`]; if left out, the pulse of the shipped wall.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub impact: Option<SpaceImpact>,
}

/// Table `[mechanism]` of the scene file: the device.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpaceMechanism {
    /// Type of the mechanism.
    #[serde(default)]
    pub kind: Mechanism,
}

fn unnamed() -> String {
    "three axes".to_owned()
}

/// Largest allowed stiffness, N/mm.
pub const STIFFEST_N_PER_MM: f64 = 50.0;

impl SpaceScene {
    /// Checks the values, and fills in the default stiffness if the file gives none.
    ///
    /// # Errors
    /// The field whose value is out of range, and its range.
    pub fn completed(mut self) -> Result<Self, (&'static str, String)> {
        self.name = one_line(&self.name);
        self.description = one_line(&self.description);
        if self.dof != 3 {
            return Err(("dof", "must be 3".to_owned()));
        }
        let own = self.own_stiffness_n_per_mm();
        let stiff = self.law.k_desired_n_per_mm.unwrap_or(own);
        if !(stiff > 0.0 && stiff <= STIFFEST_N_PER_MM) {
            let range = format!("must be above 0 and at most {STIFFEST_N_PER_MM}");
            return Err(("law.k_desired_n_per_mm", range));
        }
        if self.law.approach == Approach::Shipped && stiff != own {
            let tuned = format!("must be {own} or left out: the shipped wall was tuned for that");
            return Err(("law.k_desired_n_per_mm", tuned));
        }
        self.law.k_desired_n_per_mm = Some(stiff);
        let impact = self.law.impact;
        self.law.impact = match self.law.approach {
            Approach::Shipped => Some(impact.unwrap_or_default().completed(self.mechanism.kind)?),
            _ if impact.is_some() => {
                let needs = "needs law.approach = \"shipped\": other approaches do not estimate the speed at the touch";
                return Err(("law.impact", needs.to_owned()));
            }
            _ => None,
        };
        if let Some(texture) = self.object.texture {
            self.object.texture = Some(texture.completed()?);
        }
        Ok(self)
    }

    /// Default stiffness for a scene that gives none, N/mm.
    fn own_stiffness_n_per_mm(&self) -> f64 {
        let mechanism = self.mechanism.kind;
        match self.law.approach {
            Approach::Shipped => shipped_n_per_mm(mechanism),
            _ => mechanism.stiffnesses_n_per_mm()[1],
        }
    }

    /// The cell of the thesis' comparison that this scene describes.
    #[must_use]
    pub fn cell(&self) -> Cell {
        let given = self.law.k_desired_n_per_mm;
        Cell {
            mechanism: self.mechanism.kind,
            object: self.object.kind,
            k_desired_n_per_mm: given.unwrap_or(self.own_stiffness_n_per_mm()),
            approach: self.law.approach,
            feel: SurfaceFeel {
                impact: (self.law.impact).map(|impact| impact.settings(self.mechanism.kind)),
                texture: self.object.texture.map(|texture| texture.texture()),
            },
        }
    }
}

/// JSON schema of scene files for three degrees of freedom, stored in `docs/schema/space-scene.schema.json`.
#[must_use]
pub fn schema() -> Value {
    let table = |about: &str, properties: Value| {
        json!({
            "type": "object",
            "description": about,
            "additionalProperties": false,
            "properties": properties,
        })
    };
    let text = |about: &str| json!({"type": "string", "description": about});
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A scene of Touchstone in three axes",
        "type": "object",
        "required": ["dof"],
        "additionalProperties": false,
        "properties": {
            "name": text("heading"),
            "description": text("what it is about"),
            "dof": {"const": 3, "description": "degrees of freedom"},
            "object": table("what is touched", json!({
                "kind": {"enum": Object::ALL},
                "texture": SpaceTexture::schema(),
            })),
            "law": table("how the force is made", json!({
                "approach": {"enum": Approach::ALL},
                "k_desired_n_per_mm": {
                    "type": "number",
                    "exclusiveMinimum": 0,
                    "maximum": STIFFEST_N_PER_MM,
                    "description": "desired stiffness, N/mm; left out: five times the critical one of the mechanism, or that of the wall that ships",
                },
                "impact": SpaceImpact::schema(),
            })),
            "mechanism": table("what it is played on", json!({"kind": {"enum": Mechanism::ALL}})),
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(value: Value) -> Result<SpaceScene, String> {
        let scene: SpaceScene = serde_json::from_value(value).map_err(|why| why.to_string())?;
        scene
            .completed()
            .map_err(|(field, why)| format!("{field} {why}"))
    }

    #[test]
    fn what_is_left_out_has_the_mechanisms_own_and_what_is_unknown_is_refused() {
        let plain = read(json!({"dof": 3})).expect("a scene").cell();
        assert_eq!(
            (plain.mechanism, plain.k_desired_n_per_mm, plain.approach),
            (Mechanism::Cartesian, 25.0, Approach::Magnitude)
        );
        let delta =
            read(json!({"dof": 3, "mechanism": {"kind": "delta"}, "object": {"kind": "sphere"}}));
        let delta = delta.expect("a scene").cell();
        assert_eq!(
            delta.k_desired_n_per_mm,
            Mechanism::Delta.stiffnesses_n_per_mm()[1]
        );
        assert_eq!(
            (delta.mechanism, delta.object),
            (Mechanism::Delta, Object::Sphere)
        );
        let shipped = read(json!({"dof": 3, "law": {"approach": "shipped"}}));
        assert_eq!(shipped.expect("a scene").cell().k_desired_n_per_mm, 25.0);
        for wrong in [
            json!({"dof": 2}),
            json!({"dof": 3, "mechanism": {"kind": "detla"}}),
            json!({"dof": 3, "law": {"k_desired_n_per_mm": 0.0}}),
            json!({"dof": 3, "law": {"approach": "shipped", "k_desired_n_per_mm": 5.0}}),
            json!({"dof": 3, "law": {"k_desired": 1.0}}),
        ] {
            assert!(read(wrong.clone()).is_err(), "{wrong}");
        }
    }

    #[test]
    fn touch_and_texture_have_defaults_and_ranges_and_are_refused_by_name() {
        let shipped = |law: Value, object: Value| {
            let mut scene = json!({"dof": 3, "law": {"approach": "shipped"}, "object": object});
            scene["law"]["impact"] = law;
            read(scene)
        };
        let tuned = shipped(json!({}), json!({})).expect("a scene");
        let left_out = read(json!({"dof": 3, "law": {"approach": "shipped"}})).expect("a scene");
        assert_eq!(tuned, left_out);
        let impact = tuned.law.impact.expect("the pulse of the wall that ships");
        assert_eq!(
            (impact.share_of_momentum, impact.vibration_share_of_speed),
            (Some(0.3), Some(0.0))
        );
        assert_eq!(
            (impact.vibration_hz, impact.vibration_decay_s),
            (Some(100.0), Some(0.011))
        );
        // The law's own pulse, bit for bit.
        let own = super::super::TunedWall::of(Mechanism::Cartesian, super::super::RATE_HZ);
        let own = own.settings(super::super::RATE_HZ, 12.0).impact;
        assert_eq!(
            tuned.cell().feel.impact.expect("a pulse").momentum,
            own.momentum
        );
        let grooves = json!({"texture": {"height_mm": 0.1, "period_mm": 2, "along": [0, 3, 4]}});
        let grooved = shipped(json!({}), grooves).expect("a scene").cell();
        let along = grooved.feel.texture.expect("grooves").along;
        assert_eq!(along, [0.0, 0.6, 0.8]);
        for (law, texture, field) in [
            (
                json!({"share_of_momentum": 2.1}),
                json!(null),
                "law.impact.share_of_momentum",
            ),
            (
                json!({"vibration_share_of_speed": -0.1}),
                json!(null),
                "law.impact.vibration_share_of_speed",
            ),
            (
                json!({"vibration_hz": 101}),
                json!(null),
                "law.impact.vibration_hz",
            ),
            (
                json!({"vibration_decay_s": 0}),
                json!(null),
                "law.impact.vibration_decay_s",
            ),
            (
                json!({}),
                json!({"height_mm": 0.3, "period_mm": 2}),
                "object.texture.height_mm",
            ),
            (
                json!({}),
                json!({"height_mm": 0.01, "period_mm": 0.1}),
                "object.texture.period_mm",
            ),
            (
                json!({}),
                json!({"height_mm": 0.1, "period_mm": 2, "along": [0, 0, 0]}),
                "object.texture.along",
            ),
        ] {
            let refused = shipped(law, json!({"texture": texture})).unwrap_err();
            assert!(refused.starts_with(field), "{refused}");
        }
        for approach in [
            "spring",
            "spring-damper",
            "bounding",
            "per-axis",
            "magnitude",
        ] {
            let law = json!({"approach": approach, "impact": {"vibration_hz": 60}});
            let refused = read(json!({"dof": 3, "law": law})).unwrap_err();
            assert!(refused.starts_with("law.impact needs"), "{refused}");
        }
    }

    #[test]
    fn the_documented_schema_is_this_one() {
        crate::documented::is_documented("space-scene.schema.json", &schema());
    }
}
