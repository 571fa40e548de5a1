//! Names of laws, understood alike by every command.
//!
//! A scene calls the enhanced law `enhanced-sfa`, a scorecard calls it `enhanced`. Every `--law` takes both.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use touchstone_lab::scorecard::rivals::RIVALS;

/// The enhanced law, as a scorecard names it and as a scene does.
const ENHANCED: (&str, &str) = ("enhanced", "enhanced-sfa");

/// Takes a law of the scorecard.
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

/// A law's name as a scene has it.
pub fn of_scene(name: String) -> String {
    match name {
        name if name == ENHANCED.0 => ENHANCED.1.to_owned(),
        name => name,
    }
}
