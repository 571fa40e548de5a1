//! The environment (walls, end stops, detents) of a scene that another program sends, as TOML text or as tables.

use std::path::Path;

use toml::Value;

use super::draft::{Draft, PROFILE_FILE};
use super::environment::Environment;
use super::origin::Origin;
use crate::error::Result;

/// Name of a sent text in error messages, in place of a file's name.
const SENT: &str = "feel";
/// Largest number of inline tables in a sent text. With dotted keys, tables inside each other can be thousands of levels deep, too deep
/// for functions that call themselves for each level.
const MOST_INLINE_TABLES: usize = 16;

impl Environment {
    /// Reads the table `[environment]` of a scene from TOML text that a program sent. The text is checked like a scene's file, with
    /// the device's force limit (N·m) in place of the scene's. `base` may name a shipped scene or feel. The hand
    /// (`[operator]`) is ignored, and no file is read.
    ///
    /// # Errors
    /// [`Error::File`](crate::error::Error::File) for the first problem in the text, with its line in the text; among the problems
    /// are a missing `[environment]` and a profile in a file.
    pub fn of_text(text: &str, force_limit_n_m: f64) -> Result<Self> {
        if text.matches('{').count() > MOST_INLINE_TABLES {
            let problem = format!("more than {MOST_INLINE_TABLES} inline tables");
            let fix = "write tables under [headings]";
            return Err(Origin::of_file(Path::new(SENT)).error("environment", problem, fix));
        }
        checked(Draft::of_text(text, Path::new(SENT))?, force_limit_n_m)
    }

    /// Reads the environment of a scene from its tables, such as those of a JSON object, by the rules of [`Environment::of_text`].
    ///
    /// # Errors
    /// [`Error::Option`](crate::error::Error::Option) for the first problem, with the field's dotted path.
    pub fn of_tables(tables: toml::Table, force_limit_n_m: f64) -> Result<Self> {
        checked(Draft::of_tables(tables), force_limit_n_m)
    }
}

fn checked(draft: Draft, force_limit_n_m: f64) -> Result<Environment> {
    // A message must not make this program read a file.
    if draft.fields.contains_key(PROFILE_FILE) {
        let problem = "only a scene's file names the file of a profile";
        let fix = "give the points in environment.profile.shape";
        return Err(draft.origin.error(PROFILE_FILE, problem, fix));
    }
    let mut draft = draft.completed(Some(SENT.to_owned()))?;
    draft.origin.is_sent = true;
    // A feel has no hand. A recorded one would be a file that this program looks for.
    draft.remove_table("operator");
    let limit = Value::Float(force_limit_n_m);
    draft.fields.insert("law.force_limit_n_m".into(), limit);
    let scene = draft.build()?;
    let missing = || {
        let fix = "write it as in the scenes that `touchstone feels` lists";
        scene.error("environment", "the feel has no such table", fix)
    };
    scene.environment.clone().ok_or_else(missing)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT_N_M: f64 = 0.045;

    fn said(text: &str) -> String {
        Environment::of_text(text, LIMIT_N_M)
            .unwrap_err()
            .to_string()
    }

    /// Every shipped feel gives the same environment as its file, from its text and from its tables.
    #[test]
    fn a_sent_scene_is_read_like_its_file() {
        for name in super::super::feels() {
            let (text, _) = super::super::shipped::text(name).unwrap();
            let wanted = super::super::Scene::load(name).unwrap().environment;
            let read = Environment::of_text(text, LIMIT_N_M).unwrap();
            assert_eq!(Some(read), wanted, "{name}");
            let read = Environment::of_tables(text.parse().unwrap(), LIMIT_N_M).unwrap();
            assert_eq!(Some(read), wanted, "{name}");
        }
        let hand =
            "[environment]\n[operator.motion]\nkind = \"recorded\"\nfile = \"/etc/passwd\"\n";
        assert!(Environment::of_text(hand, LIMIT_N_M).is_ok());
        let more = "base = \"ratchet\"\n[environment.profile]\nper_rev = 12\n";
        let more = Environment::of_text(more, LIMIT_N_M).unwrap();
        assert_eq!(more.profile.unwrap().per_rev, 12);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let strong = "[environment.detents]\nstrength_n_m = 0.05\n";
        let too_strong = "environment.detents.strength_n_m: 0.05 is more than the device's \
                          law.force_limit_n_m = 0.045; give at most 0.045";
        assert_eq!(said(strong), format!("feel:2: {too_strong}"));
        // A limit in the text has no effect, so no message may advise one.
        let raised = format!("{strong}[law]\nforce_limit_n_m = 1.0\n");
        assert_eq!(said(&raised), said(strong));
        assert!(Environment::of_text(strong, 0.06).is_ok());
        for (text, wanted) in [
            (
                "[environment]\ndetent.per_rev = 3",
                "feel:2: environment.detent: ",
            ),
            (
                "[environment.detents]\nper_rev = 2.5",
                "feel:2: environment.detents.per_rev: ",
            ),
            ("[environment", "feel:1: scene: not valid TOML"),
            (
                "[wall]\nsurface_rad = 1.0",
                "feel:1: environment: the feel has no such table; ",
            ),
            (
                "base = \"/etc/passwd\"\n[environment]",
                "feel:1: base: no shipped scene",
            ),
            (
                "[environment.profile]\nfile = \"/etc/passwd\"",
                "feel:2: environment.profile.file: only a scene's file names the file of a profile; ",
            ),
        ] {
            assert!(said(text).starts_with(wanted), "{text}: {}", said(text));
        }
        let deep = "a={".repeat(17);
        assert!(
            said(&deep).contains("more than 16 inline tables"),
            "{}",
            said(&deep)
        );
        let tables = strong.parse().unwrap();
        let said = Environment::of_tables(tables, LIMIT_N_M).unwrap_err();
        assert_eq!(said.to_string(), too_strong);
    }
}
