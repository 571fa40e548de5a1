//! An FMU's `modelDescription.xml`, and the names that follow from a scene.

use crate::variables::{self, Causality, Variable};
use crate::{Half, MARK};
use std::fmt::Write as _;
use touchstone_sim::error::Result;
use touchstone_sim::harmless::one_line;
use touchstone_sim::scene::{RestPath, Scene};

/// Name of an FMU, and of its file and its shared library: a valid C identifier.
#[must_use]
pub fn identifier(scene: &Scene, half: Half) -> String {
    let letter = |it: char| if it.is_ascii_alphanumeric() { it } else { '_' };
    let name: String = scene.name.chars().map(letter).collect();
    let begins = name.starts_with(|it: char| it.is_ascii_alphabetic());
    let first = if begins { "" } else { "scene_" };
    format!("{first}{name}_{}", half.word())
}

/// Token by which the shared library checks that description and scene belong together: a hash (FNV-1a) of the scene's text, the
/// half and the program's version.
#[must_use]
pub fn token(text: &str, half: Half) -> String {
    let parts = [MARK, half.word(), text];
    let bytes = parts.iter().flat_map(|part| part.bytes());
    let hash = bytes.fold(0xCBF2_9CE4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
    });
    format!("{{touchstone-{}-{hash:016x}}}", half.word())
}

/// Writes the text of `modelDescription.xml`. `text` is the scene's text in the FMU's resources.
///
/// # Errors
/// A recording of the hand cannot be read.
pub fn xml(scene: &Scene, half: Half, text: &str) -> Result<String> {
    let period_s = scene.timing.period_s();
    let start_rad = scene.start_rad(&RestPath::from_scene(scene)?);
    let identifier = identifier(scene, half);
    let what = match half {
        Half::Law => "control law with energy guard",
        Half::Plant => "device and hand",
    };
    let mut xml = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>
<fmiModelDescription fmiVersion=\"3.0\" modelName=\"{identifier}\" instantiationToken=\"{}\"
  description=\"Touchstone's {what} of the scene {}; one step is one control period\"
  version=\"{version}\" license=\"MIT OR Apache-2.0\" generationTool=\"Touchstone {version}\">
  <CoSimulation modelIdentifier=\"{identifier}\" fixedInternalStepSize=\"{period_s:?}\"/>
  <UnitDefinitions>
    <Unit name=\"s\"><BaseUnit s=\"1\"/></Unit>
    <Unit name=\"rad\"><BaseUnit rad=\"1\"/></Unit>
    <Unit name=\"rad/s\"><BaseUnit rad=\"1\" s=\"-1\"/></Unit>
    <Unit name=\"N.m\"><BaseUnit kg=\"1\" m=\"2\" s=\"-2\"/></Unit>
    <Unit name=\"J\"><BaseUnit kg=\"1\" m=\"2\" s=\"-2\"/></Unit>
  </UnitDefinitions>
  <LogCategories>
    <Category name=\"logStatusWarning\"/>
    <Category name=\"logStatusError\"/>
  </LogCategories>
  <DefaultExperiment startTime=\"0\" stopTime=\"{:?}\" stepSize=\"{period_s:?}\"/>
  <ModelVariables>\n",
        token(text, half),
        escaped(&scene.name),
        scene.timing.ticks() as f64 * period_s,
        version = env!("CARGO_PKG_VERSION"),
    );
    for variable in variables::of(scene, half) {
        entry(&mut xml, variable, half, start_rad);
    }
    xml += "  </ModelVariables>\n  <ModelStructure>\n";
    // No output depends on an input of the same instant: a step lies between them.
    for element in ["Output", "InitialUnknown"] {
        let outputs =
            variables::of(scene, half).filter(|variable| variable.causality == Causality::Output);
        for variable in outputs {
            let number = variable.name as u32;
            line(
                &mut xml,
                &format!("    <{element} valueReference=\"{number}\" dependencies=\"\"/>\n"),
            );
        }
    }
    Ok(xml + "  </ModelStructure>\n</fmiModelDescription>\n")
}

/// Writes the element of one variable.
fn entry(xml: &mut String, variable: &Variable, half: Half, start_rad: f64) {
    let kind = variable.unit.map_or("Boolean", |_| "Float64");
    let causality = match variable.causality {
        Causality::Independent => "independent",
        Causality::Input => "input",
        Causality::Output => "output",
    };
    // The law changes its values only from step to step.
    let variability = match (half, variable.causality) {
        (_, Causality::Independent) | (Half::Plant, _) => "continuous",
        (Half::Law, _) => "discrete",
    };
    let unit = variable
        .unit
        .map_or(String::new(), |unit| format!(" unit=\"{unit}\""));
    let start = match (variable.causality, variable.name) {
        (Causality::Input, variables::Name::MeasuredAngle | variables::Name::MeasuredChange) => {
            format!(" start=\"{start_rad:?}\"")
        }
        (Causality::Input, _) => " start=\"0\"".to_owned(),
        _ => String::new(),
    };
    line(
        xml,
        &format!(
            "    <{kind} name=\"{}\" valueReference=\"{}\" causality=\"{causality}\" variability=\"{variability}\"{unit}{start}
      description=\"{}\"/>\n",
            variable.text,
            variable.name as u32,
            escaped(variable.meaning)
        ),
    );
}

fn line(xml: &mut String, line: &str) {
    xml.write_str(line).expect("a string takes everything");
}

/// A text as the value of an attribute, on one line.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for letter in one_line(text).chars() {
        match letter {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '"' => escaped += "&quot;",
            _ => escaped.push(letter),
        }
    }
    escaped
}
