//! Prints a scene as TOML with every value filled in.

use std::fmt::Write;

use toml::Value;

use super::draft::Draft;
use super::experiment::Scene;
use super::operator::Grip;
use super::schema::{self, FIELDS, Field, Kind};

impl Scene {
    /// Writes the scene as TOML, with every default filled in and with units and meanings as comments. Reading the text gives the
    /// same scene.
    ///
    /// Effects that the scene does not simulate are listed in comments.
    pub fn to_toml(&self) -> String {
        let draft = Draft::from_scene(self);
        let mut text = String::new();
        let mut table = "";
        for field in FIELDS
            .iter()
            .filter(|field| field.suits(self.operator.motion.name()))
        {
            let absent = schema::OPTIONAL_TABLES
                .iter()
                .find(|(path, _)| *path == field.table() && !draft.has_table(path));
            if field.table() != table {
                table = field.table();
                match absent {
                    Some((path, meaning)) => {
                        line(&mut text, &format!("\n# [{path}] absent: {meaning}\n"))
                    }
                    None => line(&mut text, &format!("\n[{table}]\n")),
                }
            }
            if absent.is_none() {
                line(&mut text, &entry(self, field, draft.fields.get(field.path)));
            }
        }
        text
    }
}

fn line(text: &mut String, line: &str) {
    text.write_str(line).expect("a string takes everything");
}

/// Formats one field of the scene as a TOML line with its comment.
fn entry(scene: &Scene, field: &Field, value: Option<&Value>) -> String {
    let name = field.name();
    let Some(value) = value else {
        return format!("# {name} absent: {}\n", field.absent.unwrap_or("no value"));
    };
    let value = match (field.kind, value) {
        // Large whole numbers, such as encoder counts, read better without a decimal point.
        (Kind::Number(_), Value::Float(number))
            if number.fract() == 0.0 && number.abs() >= 100.0 && number.abs() < 1e15 =>
        {
            format!("{number:.0}")
        }
        (Kind::Number(_), Value::Float(number)) => format!("{number:?}"),
        (_, value) => value.to_string(),
    };
    let mut line = format!("{name} = {value}");
    // Name and description at the top level need no explanation, and may take several lines.
    if !field.table().is_empty() {
        line = format!("{line:<44} # {}", field.about_with_unit());
        if let (Kind::Choice(words), false) = (field.kind, field.path == "operator.grip") {
            line += &format!(": {}", words.join(", "));
        }
    }
    if field.path == "operator.grip" {
        line += &grip_values(scene.operator.grip);
    }
    line + "\n"
}

/// Formats the mechanical values of a grip as comment lines.
fn grip_values(grip: Grip) -> String {
    match grip.hand() {
        Some(hand) => format!(
            ": pad {:.4} N·m/rad, {:.3e} N·m·s/rad; hand {:.3e} kg·m², {:.3e} N·m·s/rad, {:.4} N·m/rad",
            hand.pad_stiffness_n_m_per_rad,
            hand.pad_damping_n_m_s_per_rad,
            hand.inertia_kg_m2,
            hand.damping_n_m_s_per_rad,
            hand.stiffness_n_m_per_rad
        ),
        None => String::new(),
    }
}
