//! Writes tuned settings as a file: control rate, wall and law, with the fields that scene files and devices share.

use super::Tuned;
use crate::scorecard::rivals::Rival;
use serde_json::Value;
use std::fmt::Write;
use touchstone_sim::scene::Scene;

/// Fields of the law that only a scene has.
const OF_SCENES_ONLY: [&str; 1] = ["number"];

/// First words of every file with tuned settings: the law and the scene's name. `tune` recognises its own files by these words.
#[must_use]
pub fn title(rival: &Rival, scene: &Scene) -> String {
    format!("{} for {}:", rival.about, scene.name)
}

/// The tuned settings as TOML. `touchstone config import` accepts them, as does the option `--settings` of every command that takes
/// a scene.
#[must_use]
pub fn toml(tuned: &Tuned) -> String {
    let scene = &tuned.scene;
    let device = &scene.device;
    let friction = device.friction.as_ref().map_or(0.0, |it| it.kinetic_n_m);
    let counts = scene
        .encoder
        .as_ref()
        .map_or("no".to_owned(), |it| it.counts_per_rev.to_string());
    let mut text = String::new();
    // Writing into a string cannot fail.
    let _ = writeln!(
        text,
        "# {} inertia {:e} kg·m², damping {:e} N·m·s/rad, friction {friction:e} N·m,\n# {counts} counts, {} Hz, delay {:e} s. Seed {}, {} settings tried.",
        title(tuned.rival, scene),
        device.inertia_kg_m2,
        device.damping_n_m_s_per_rad,
        scene.timing.rate_hz,
        scene.timing.computational_delay_s,
        tuned.seed,
        tuned.evaluations,
    );
    let _ = writeln!(
        text,
        "# Largest share of a limit in the search: {}; see `touchstone scorecard` for all figures.",
        if tuned.worst.is_finite() {
            format!("{:.2}", tuned.worst)
        } else {
            "beyond all".to_owned()
        }
    );
    let _ = writeln!(
        text,
        "# On a device: touchstone config import FILE. In a scene: touchstone run SCENE --settings FILE."
    );
    text.push_str(&rows(scene));
    text
}

/// Lines of the file with control rate, stiffness and every setting of the law.
#[must_use]
pub fn rows(scene: &Scene) -> String {
    let mut text = format!("\n[timing]\nrate_hz = {}\n", scene.timing.rate_hz);
    let _ = writeln!(
        text,
        "\n[wall]\nk_desired_n_m_per_rad = {}",
        decimal(scene.wall.k_desired_n_m_per_rad)
    );
    let law = serde_json::to_value(&scene.law).unwrap_or_default();
    table(&mut text, "law", &law);
    text
}

fn table(text: &mut String, name: &str, value: &Value) {
    let Some(fields) = value.as_object() else {
        return;
    };
    let _ = writeln!(text, "\n[{name}]");
    for (key, value) in fields {
        if OF_SCENES_ONLY.contains(&key.as_str()) {
            continue;
        }
        let _ = match value {
            Value::Number(number) => writeln!(
                text,
                "{key} = {}",
                decimal(number.as_f64().unwrap_or(f64::NAN))
            ),
            Value::String(word) => writeln!(text, "{key} = \"{word}\""),
            Value::Bool(flag) => writeln!(text, "{key} = {flag}"),
            _ => Ok(()),
        };
    }
    for (key, value) in fields.iter().filter(|(_, value)| value.is_object()) {
        table(text, &format!("{name}.{key}"), value);
    }
}

/// Writes a decimal number without exponent and with a point, the only form that scene and device both accept.
fn decimal(value: f64) -> String {
    let plain = format!("{value}");
    match plain.contains('.') {
        true => plain,
        false => format!("{plain}.0"),
    }
}
