//! Reading and writing one setting by its path, e.g. `wall.surface_rad`.

use super::DeviceSettings;
use miniconf::{ConstPathIter, SerdeError, postcard as leaf};
use postcard::{de_flavors, ser_flavors};
use serde::{Deserialize, Serialize};

/// Longest value of a single setting on the serial link, in bytes: the serialiser postcard needs up to ten bytes for a 64-bit
/// number.
pub const VALUE_MAX: usize = 10;

/// Why a setting could not be read or written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum KeyError {
    /// No setting has this path.
    NoSuchField,
    /// The bytes are not a valid value of this setting's type.
    NotAValue,
}

fn keys(path: &str) -> ConstPathIter<'_, '.'> {
    ConstPathIter::new(Some(path))
}

fn why(error: SerdeError<postcard::Error>) -> KeyError {
    match error {
        SerdeError::Value(_) => KeyError::NoSuchField,
        SerdeError::Inner(_) | SerdeError::Finalization(_) => KeyError::NotAValue,
    }
}

impl DeviceSettings {
    /// Writes the setting's value into `buffer`, encoded by the serialiser postcard; [`VALUE_MAX`] bytes are always enough.
    ///
    /// # Errors
    /// No setting has this path, or the buffer is too small.
    pub fn get<'b>(&self, path: &str, buffer: &'b mut [u8]) -> Result<&'b [u8], KeyError> {
        leaf::get_by_key(self, keys(path), ser_flavors::Slice::new(buffer))
            .map(|bytes| &*bytes)
            .map_err(why)
    }

    /// Changes one setting to a value that is encoded by the serialiser postcard. Does not validate: the caller validates all
    /// settings together.
    ///
    /// # Errors
    /// No setting has this path, or the value is not valid for it. The settings are then unchanged.
    // A separate function, so that its copy of the settings leaves the stack before other work begins: a device's stack is small.
    #[inline(never)]
    pub fn set(&mut self, path: &str, value: &[u8]) -> Result<(), KeyError> {
        let mut changed = self.clone();
        let rest = leaf::set_by_key(&mut changed, keys(path), de_flavors::Slice::new(value))
            .map_err(why)?;
        if !rest.is_empty() {
            return Err(KeyError::NotAValue);
        }
        *self = changed;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::fields::FIELDS;
    use super::*;
    use crate::Board;
    use miniconf::TreeSchema;

    #[test]
    fn the_table_has_every_leaf_of_the_tree_and_no_other() {
        let mut leaves = 0;
        for node in DeviceSettings::SCHEMA.nodes::<miniconf::ConstPath<PathText, '.'>, 3>() {
            let path = node.expect("a path of at most PATH_MAX bytes").into_inner();
            let path = path.trim_start_matches('.');
            assert_eq!(FIELDS.get(leaves).map(|field| field.path), Some(path));
            leaves += 1;
        }
        assert_eq!(leaves, FIELDS.len());
    }

    use super::super::PathText;

    #[test]
    fn every_leaf_is_read_and_written_by_its_path() {
        let original = DeviceSettings::defaults(Board::NucleoG474re);
        for field in FIELDS {
            let mut settings = DeviceSettings::defaults(Board::NucleoG474re);
            let mut buffer = [0; VALUE_MAX];
            let value = settings
                .clone()
                .get(field.path, &mut buffer)
                .expect(field.path)
                .to_vec();
            settings.set(field.path, &value).expect(field.path);
            assert_eq!(settings, original);
            assert_eq!(
                settings.set(field.path, &[]),
                Err(KeyError::NotAValue),
                "{}",
                field.path
            );
            let long = [&value[..], &[0]].concat();
            assert_eq!(
                settings.set(field.path, &long),
                Err(KeyError::NotAValue),
                "{}",
                field.path
            );
            assert_eq!(settings, original);
        }
    }

    #[test]
    fn what_is_no_leaf_has_no_value() {
        let mut settings = DeviceSettings::defaults(Board::NucleoG474re);
        for path in [
            "",
            ".",
            "wall",
            "wall.",
            ".law.kind",
            "law.kind.x",
            "law.filter",
            "wall.0",
            "x",
            "law..kind",
        ] {
            let mut buffer = [0; VALUE_MAX];
            assert_eq!(
                settings.get(path, &mut buffer),
                Err(KeyError::NoSuchField),
                "{path}"
            );
            assert_eq!(
                settings.set(path, &[0]),
                Err(KeyError::NoSuchField),
                "{path}"
            );
        }
    }
}
