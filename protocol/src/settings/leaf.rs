//! The encoding of one setting on the wire, for `#[serde(with)]` and `#[tree(with)]`. An exact number is its bits, and a choice is
//! its index in the list of words.

use super::{Decimal, DriveKind, EncoderKind, device_settings};
use core::any::Any;
use miniconf::{Keys, Schema, SerdeError, TreeDeserializer, ValueError};
use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use touchstone_control::choices::*;
use touchstone_control::{Choice, Si};

/// The type of a single setting, with its encoding on the wire.
pub trait Leaf: Copy + 'static {
    /// The type that goes over the wire.
    type Wire: Serialize + DeserializeOwned;
    /// Converts the value to the type that goes over the wire.
    fn to_wire(self) -> Self::Wire;
    /// Converts the value back from the wire; `None` if it is not valid.
    fn of_wire(wire: Self::Wire) -> Option<Self>;
}

macro_rules! plain {
    ($($plain:ty)*) => { $(impl Leaf for $plain {
        type Wire = Self;
        fn to_wire(self) -> Self { self }
        fn of_wire(wire: Self) -> Option<Self> { Some(wire) }
    })* };
}
plain!(u8 u16 u32 bool);

impl Leaf for Si {
    type Wire = Decimal;
    fn to_wire(self) -> Decimal {
        Decimal(self)
    }
    fn of_wire(wire: Decimal) -> Option<Self> {
        Some(wire.0)
    }
}

/// Implements [`Leaf`] (the encoding on the wire) for the types of settings that are one word of a list.
macro_rules! words {
    (
        own_wall { $($own_wall:tt)* } own { $($(#[$own_doc:meta])* $own:ident $Own:ident { $($own_rows:tt)* })+ }
        timing { $($timing:tt)* } wall { $($wall:tt)* } law { $($law:tt)* }
        $($(#[$doc:meta])* $group:ident $Group:ident { $($rows:tt)* })+
    ) => {
        words! { @own $($own_wall)* $($($own_rows)*)+ }
        words! { @law $($wall)* $($law)* $($($rows)*)+ }
    };
    (@law $($variant:ident $field:ident, $name:ident: $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+) => {
        $(words! { @word $kind $range })+
    };
    (@own $($name:ident: $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+) => {
        $(words! { @word $kind $range })+
    };
    (@word choice ($choice:ident)) => {
        impl Leaf for $choice {
            type Wire = u32;
            fn to_wire(self) -> u32 { self.number() }
            fn of_wire(wire: u32) -> Option<Self> { Self::ALL.get(usize::try_from(wire).ok()?).copied() }
        }
    };
    (@word choice_of_law $range:tt) => { words! { @word choice $range } };
    (@word $kind:ident $range:tt) => {};
}
device_settings!(words);

/// A setting's value that serde encodes by [`Leaf`].
struct OnWire<T>(T);

impl<T: Leaf> Serialize for OnWire<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serialize(&self.0, serializer)
    }
}

impl<'de, T: Leaf> Deserialize<'de> for OnWire<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserialize(deserializer).map(Self)
    }
}

pub fn serialize<T: Leaf, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
    value.to_wire().serialize(serializer)
}

pub fn deserialize<'de, T: Leaf, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    T::of_wire(T::Wire::deserialize(deserializer)?)
        .ok_or_else(|| Error::custom("no value of this setting"))
}

pub const fn schema<T>() -> &'static Schema {
    miniconf::leaf::schema::<T>()
}

pub fn serialize_by_key<T: Leaf, S: Serializer>(
    value: &T,
    keys: impl Keys,
    serializer: S,
) -> Result<S::Ok, SerdeError<S::Error>> {
    miniconf::leaf::serialize_by_key(&OnWire(*value), keys, serializer)
}

pub fn deserialize_by_key<'de, T: Leaf, D: TreeDeserializer<'de>>(
    value: &mut T,
    mut keys: impl Keys,
    deserializer: D,
) -> Result<D::Ok, SerdeError<D::Error>> {
    keys.finalize()?;
    let (OnWire(read), rest) = deserializer.deserialize()?;
    *value = read;
    Ok(rest)
}

pub fn probe_by_key<'de, T: Leaf, D: TreeDeserializer<'de>>(
    keys: impl Keys,
    deserializer: D,
) -> Result<D::Ok, SerdeError<D::Error>> {
    miniconf::leaf::probe_by_key::<OnWire<T>, D>(keys, deserializer)
}

pub fn ref_any_by_key(value: &impl Any, keys: impl Keys) -> Result<&dyn Any, ValueError> {
    miniconf::leaf::ref_any_by_key(value, keys)
}

pub fn mut_any_by_key(value: &mut impl Any, keys: impl Keys) -> Result<&mut dyn Any, ValueError> {
    miniconf::leaf::mut_any_by_key(value, keys)
}
