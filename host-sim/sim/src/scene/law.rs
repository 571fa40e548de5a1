//! The parameters of the control law in a scene file, as floats: one field for each entry of the control crate's list
//! [`touchstone_control::law_settings`].

use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use touchstone_control::choices::*;
use touchstone_control::{Choice, choice};

choice! {
    /// Number format in which the control law computes.
    Number {
        /// Fixed point, 32 bits: the format of the firmware.
        #[default]
        Fixed32 = "fixed32",
        /// Fixed point, 16 bits: small enough for proofs that go through all values.
        Fixed16 = "fixed16",
        /// IEEE single precision floating point, 32 bits.
        F32 = "f32",
        /// IEEE double precision: the reference for comparisons.
        F64 = "f64",
    }
}

/// Rust type, default value and text form of one type of entry in the list of law settings.
macro_rules! row {
    (@type number $range:tt) => { f64 };
    (@type flag ()) => { bool };
    (@type choice ($choice:ident)) => { $choice };
    (@type choice_of_law ($choice:ident)) => { Option<$choice> };

    (@default $default:tt number $range:tt) => { $default.parse().expect("the table has decimal numbers") };
    (@default $default:tt flag ()) => { $default };
    (@default $default:tt choice ($choice:ident)) => { $choice::$default };
    (@default $default:tt choice_of_law $choice:tt) => { None };

    (@leaf choice ($choice:ident)) => { row!(@leaf_of $choice); };
    (@leaf choice_of_law ($choice:ident)) => { row!(@leaf_of $choice); };
    (@leaf $kind:ident $range:tt) => {};
    (@leaf_of $choice:ident) => {
        impl Leaf for $choice {
            type Text = String;
            fn text(&self) -> String { self.word().to_owned() }
            fn of_text(text: String) -> Option<Self> { Self::of_word(&text) }
        }
    };
}

macro_rules! law {
    (
        timing { $($timing:tt)* }
        wall { $($w_variant:ident $w_field:ident, $w_name:ident: number $w_range:tt = $w_default:tt, $w_unit:literal, $w_about:literal;)+ }
        law { $($l_variant:ident $l_field:ident, $l_name:ident: $l_kind:ident $l_range:tt = $l_default:tt, $l_unit:literal, $l_about:literal;)+ }
        $($(#[$doc:meta])* $group:ident $Group:ident {
            $($variant:ident $field:ident, $name:ident: $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+
        })+
    ) => {
        law! { @table
            /// Parameters of all control laws. A law ignores parameters that it does not use, so that one scene can compare several
            /// laws.
            Law { $($l_name: $l_kind $l_range = $l_default, $l_unit, $l_about;)+ } {
                /// Number format in which the control law computes. Default `fixed32`.
                number Number
                $($(#[$doc])* $group $Group)+
            }
        }
        $(law! { @table $(#[$doc])* $Group { $($name: $kind $range = $default, $unit, $about;)+ } {} })+
        $(row!(@leaf $l_kind $l_range);)+
        $($(row!(@leaf $kind $range);)+)+
    };
    (@table $(#[$doc:meta])* $Table:ident {
        $($name:ident: $kind:ident $range:tt = $default:tt, $unit:literal, $about:literal;)+
    } { $($(#[$more_doc:meta])* $more:ident $More:ident)* }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $Table {
            $(
                #[doc = concat!("Gives ", $about, "; ", $unit, " `", stringify!($kind $range = $default), "`")]
                #[serde(with = "leaf", skip_serializing_if = "Leaf::is_absent")]
                pub $name: row!(@type $kind $range),
            )+
            $($(#[$more_doc])* pub $more: $More,)*
        }

        impl Default for $Table {
            fn default() -> Self {
                Self {
                    $($name: row!(@default $default $kind $range),)+
                    $($more: $More::default(),)*
                }
            }
        }
    };
}
touchstone_control::law_settings!(law);

impl Law {
    /// Rule for the wall's offset at the end of the first contact: the one that the scene gives, else a default.
    ///
    /// The default is `keep-force` for the original successive force augmentation (thesis, equation 2.17), and `zero-offset` for
    /// all other laws (thesis, §3.2).
    pub fn first_contact(&self) -> FirstContact {
        self.first_contact.unwrap_or(match self.kind {
            LawKind::Sfa => FirstContact::KeepForce,
            _ => FirstContact::ZeroOffset,
        })
    }
}

/// Converts one parameter of the control law from and to its text in a scene file.
trait Leaf: Sized {
    type Text: Serialize + DeserializeOwned;
    fn text(&self) -> Self::Text;
    fn of_text(text: Self::Text) -> Option<Self>;
    /// Whether the parameter is left out when the scene is written.
    fn is_absent(&self) -> bool {
        false
    }
}

macro_rules! plain {
    ($($plain:ty)*) => { $(impl Leaf for $plain {
        type Text = Self;
        fn text(&self) -> Self { *self }
        fn of_text(text: Self) -> Option<Self> { Some(text) }
    })* };
}
plain!(f64 bool);

impl<T: Leaf> Leaf for Option<T> {
    type Text = Option<T::Text>;
    fn text(&self) -> Self::Text {
        self.as_ref().map(T::text)
    }
    fn of_text(text: Self::Text) -> Option<Self> {
        match text {
            None => Some(None),
            Some(text) => T::of_text(text).map(Some),
        }
    }
    fn is_absent(&self) -> bool {
        self.is_none()
    }
}

mod leaf {
    use super::*;

    pub(super) fn serialize<T: Leaf, S: Serializer>(leaf: &T, to: S) -> Result<S::Ok, S::Error> {
        leaf.text().serialize(to)
    }

    pub(super) fn deserialize<'de, T: Leaf, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
        T::of_text(T::Text::deserialize(from)?).ok_or_else(|| D::Error::custom("unknown word"))
    }

    type Result<T, E> = std::result::Result<T, E>;
}

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, to: S) -> std::result::Result<S::Ok, S::Error> {
        word(self, to)
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(from: D) -> std::result::Result<Self, D::Error> {
        of_word(from)
    }
}

/// Reads a value of an enumeration from its name, for `#[serde(deserialize_with)]`.
pub(crate) fn of_word<'de, T: Choice, D: Deserializer<'de>>(
    from: D,
) -> std::result::Result<T, D::Error> {
    let text = String::deserialize(from)?;
    T::of_word(&text).ok_or_else(|| D::Error::custom("unknown word"))
}

/// Writes a value of an enumeration as its name, for `#[serde(serialize_with)]`.
pub(crate) fn word<T: Choice, S: Serializer>(
    choice: &T,
    to: S,
) -> std::result::Result<S::Ok, S::Error> {
    to.serialize_str(choice.word())
}
