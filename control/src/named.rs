//! Sets one setting from text: a path such as `law.kind` and a value. Scene files, boards and bindings to other languages use this.

use crate::{Choice, Field, Settings};
use core::fmt;

/// Why [`Settings::set_by_path`] did not set a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum NotSet {
    /// No setting has this path.
    UnknownPath,
    /// The text is not a value of this setting: not a decimal number, or not one of the setting's words.
    NoValue,
}

impl fmt::Display for NotSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::UnknownPath => "no setting has this path",
            Self::NoValue => "the text is no value of this setting",
        })
    }
}

impl core::error::Error for NotSet {}

/// Parses a text as a value of a setting's type; `None` if the text is no such value.
macro_rules! parse {
    ($text:ident: choice ($choice:ident)) => {
        Choice::of_word($text)
    };
    ($text:ident: choice_of_law ($choice:ident)) => {
        Choice::of_word($text)
    };
    ($text:ident: $kind:ident $range:tt) => {
        $text.parse().ok()
    };
}

/// Sets the setting of a given path. The code for each setting is generated from the table of settings.
macro_rules! set {
    ($settings:ident $path:ident $text:ident:
        timing { $($timing:tt)* } wall { $($wall:tt)* } law { $($law:tt)* }
        $($(#[$doc:meta])* $group:ident $Group:ident { $($rows:tt)* })+
    ) => {
        set! { @rows $settings ($path $text) $($timing)* $($wall)* $($law)* }
        $(
            let group = &mut $settings.$group;
            set! { @rows group ($path $text) $($rows)* }
        )+
    };
    (@rows $place:ident ($path:ident $text:ident)
        $($variant:ident $field:ident, $name:ident: $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+) => {
        $(
            if $path == Field::$variant.path() {
                $place.$field = parse!($text: $kind $range).ok_or(NotSet::NoValue)?;
                return Ok(());
            }
        )+
    };
}

impl Settings {
    /// Sets the setting with this path, as scene files write it, to a decimal number or a word:
    /// `settings.set_by_path("wall.k_desired_n_m_per_rad", "5")`, `settings.set_by_path("law.kind", "tdpa")`.
    ///
    /// Ranges depend on each other, so [`Settings::validate`] checks them after all settings are set.
    ///
    /// # Errors
    /// No setting has this path, or the text is not a value of the setting. The settings then stay unchanged.
    pub fn set_by_path(&mut self, path: &str, text: &str) -> Result<(), NotSet> {
        crate::law_settings!(set self path text:);
        Err(NotSet::UnknownPath)
    }
}

#[cfg(test)]
mod tests {
    use super::NotSet;
    use crate::{Field, LawKind, Settings, Si};

    #[test]
    fn numbers_words_and_flags_are_set_by_their_paths() {
        let mut settings = Settings::default();
        assert_eq!(
            settings.set_by_path("wall.k_desired_n_m_per_rad", "7.5"),
            Ok(())
        );
        assert_eq!(settings.set_by_path("timing.rate_hz", "2000"), Ok(()));
        assert_eq!(settings.set_by_path("law.kind", "tdpa"), Ok(()));
        assert_eq!(settings.set_by_path("law.guard.on", "false"), Ok(()));
        assert_eq!(
            settings.set_by_path("law.estimator.delay_s", "0.001"),
            Ok(())
        );
        assert_eq!(settings.k_desired, Si::lit("7.5"));
        assert_eq!((settings.rate_hz, settings.law), (2000, LawKind::Tdpa));
        assert!(!settings.guard.on);
        assert_eq!(settings.estimator.delay_s, Si::lit("0.001"));
    }

    #[test]
    fn what_is_no_setting_or_no_value_changes_nothing() {
        let mut settings = Settings::default();
        for path in ["", "law", "law.kin", "law.kind ", "k_desired"] {
            assert_eq!(
                settings.set_by_path(path, "1"),
                Err(NotSet::UnknownPath),
                "{path}"
            );
        }
        for (path, text) in [
            ("law.kind", "TDPA"),
            ("law.kind", ""),
            ("timing.rate_hz", "-1"),
            ("timing.rate_hz", "1.5"),
            ("law.guard.on", "yes"),
            ("law.force_limit_n_m", "0,5"),
            ("law.force_limit_n_m", "nan"),
            ("law.force_limit_n_m", "9e99"),
        ] {
            assert_eq!(
                settings.set_by_path(path, text),
                Err(NotSet::NoValue),
                "{path}"
            );
        }
        assert_eq!(settings, Settings::default());
    }

    #[test]
    fn every_path_is_known() {
        for field in Field::ALL {
            let not_set = Settings::default().set_by_path(field.path(), "?");
            assert_eq!(not_set, Err(NotSet::NoValue), "{}", field.path());
        }
    }
}
