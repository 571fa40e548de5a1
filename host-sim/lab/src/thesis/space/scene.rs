//! Scene files for three degrees of freedom (`dof = 3`), which `touchstone run` simulates.

use super::mechanism::Mechanism;
use super::{Approach, Cell, Object, shipped_n_per_mm};
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
            "object": table("what is touched", json!({"kind": {"enum": Object::ALL}})),
            "law": table("how the force is made", json!({
                "approach": {"enum": Approach::ALL},
                "k_desired_n_per_mm": {
                    "type": "number",
                    "exclusiveMinimum": 0,
                    "maximum": STIFFEST_N_PER_MM,
                    "description": "desired stiffness, N/mm; left out: five times the critical one of the mechanism, or that of the wall that ships",
                },
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
    fn the_documented_schema_is_this_one() {
        crate::documented::is_documented("space-scene.schema.json", &schema());
    }
}
