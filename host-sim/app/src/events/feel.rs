//! Feels that other programs choose: a shipped one by its name, any other one as the text or the tables of a scene.

use serde_json::Value as Json;
use touchstone_sim::error::Error;
use touchstone_sim::scene::{Environment, Scene, feels, list};

/// A feel (walls, end stops, detents) that a program chose.
#[derive(Debug, Clone)]
pub struct Feel {
    /// The name of a shipped feel; `None` for a feel that a program sent.
    pub name: Option<String>,
    pub around: Environment,
}

/// Why a request was refused.
#[derive(Debug)]
pub struct Refusal {
    /// The setting that is wrong; `None` if the request itself is wrong.
    pub setting: Option<String>,
    pub problem: String,
}

impl Refusal {
    /// A refusal of the request itself.
    pub fn of_request(problem: String) -> Self {
        Self {
            setting: None,
            problem,
        }
    }
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        let setting = match &error {
            Error::File { field, .. } => Some(field.clone()),
            Error::Option { option, .. } => Some(option.clone()),
            _ => None,
        };
        Self {
            setting,
            problem: error.to_string(),
        }
    }
}

impl Feel {
    /// Reads the feel that a program names or sends: a name, a TOML or JSON text, or a JSON object with the tables of a scene. Its
    /// torques are checked against the device's force limit, N·m.
    pub fn read(asked: &Json, force_limit_n_m: f64) -> Result<Self, Refusal> {
        let around = match asked {
            Json::String(name) if feels().contains(&&**name) => {
                return Ok(Self {
                    around: Scene::load(name)?.environment.unwrap_or_default(),
                    name: Some(name.clone()),
                });
            }
            Json::String(text) if text.trim_start().starts_with('{') => {
                let object = serde_json::from_str(text);
                let object = object.map_err(|error| {
                    Refusal::of_request(format!("feel: this is not valid JSON: {error}"))
                })?;
                of_object(&object, force_limit_n_m)?
            }
            // No name has one of these characters, and every TOML text has.
            Json::String(text) if text.contains(['=', '[', '\n']) => {
                Environment::of_text(text, force_limit_n_m)?
            }
            // Only shipped feels: a message must not make this program read a file.
            Json::String(name) => {
                let known = list(&feels());
                return Err(Refusal::of_request(format!(
                    "there is no feel {name}; give {known}"
                )));
            }
            object => of_object(object, force_limit_n_m)?,
        };
        Ok(Self { name: None, around })
    }
}

fn of_object(object: &Json, force_limit_n_m: f64) -> Result<Environment, Refusal> {
    let Json::Object(tables) = object else {
        let fix = "give a feel's name, the text of a scene, or its tables as an object";
        return Err(Refusal::of_request(format!("feel: is {object}; {fix}")));
    };
    let tables = toml::Table::try_from(tables).map_err(|error| {
        let fix = "give numbers, texts, true, false or lists of them";
        Refusal::of_request(format!("feel: {error}; {fix}"))
    })?;
    Ok(Environment::of_tables(tables, force_limit_n_m)?)
}
