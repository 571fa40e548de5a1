//! Names of control laws, which every command accepts in the same form.
//!
//! A scene calls the enhanced law `enhanced-sfa`, a scorecard calls the same law `enhanced`. Every `--law` option accepts either
//! name.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use touchstone_control::{Choice, LawKind};
use touchstone_lab::scorecard::rivals::RIVALS;

/// Names of the enhanced control law: first the one in a scorecard, second the one in a scene file.
const ENHANCED: (&str, &str) = ("enhanced", "enhanced-sfa");

/// Parser of a `--law` option that accepts the names of the control laws in a scorecard.
pub fn of_scorecard() -> impl TypedValueParser<Value = String> {
    let names = RIVALS.map(|rival| match rival.name {
        name if name == ENHANCED.0 => PossibleValue::new(name).alias(ENHANCED.1),
        name => PossibleValue::new(name),
    });
    PossibleValuesParser::new(names).map(|name| match name {
        name if name == ENHANCED.1 => ENHANCED.0.to_owned(),
        name => name,
    })
}

/// Parser of a `--law` option that accepts every control law by its name in a scene file.
pub fn of_kind() -> impl TypedValueParser<Value = LawKind> {
    let names = LawKind::WORDS.iter().map(|name| match *name {
        name if name == ENHANCED.1 => PossibleValue::new(name).alias(ENHANCED.0),
        name => PossibleValue::new(name),
    });
    PossibleValuesParser::new(names).map(|name| {
        let name = of_scene(name);
        let same = |kind: &&LawKind| kind.word() == name;
        // The parser has refused every other name.
        LawKind::ALL.iter().find(same).copied().unwrap_or_default()
    })
}

/// Converts a control law's name to the name that a scene file uses.
pub fn of_scene(name: String) -> String {
    match name {
        name if name == ENHANCED.0 => ENHANCED.1.to_owned(),
        name => name,
    }
}
