//! An exact fixed-point value in SI units: 64 bits on the serial link, a decimal number for people.

use core::fmt;
use core::str::FromStr;
use fixed::traits::ToFixed;
#[cfg(feature = "wire")]
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error, de::Visitor};
use touchstone_control::Si;

/// A value in the fixed-point format `I32F32`: ±2.1e9 in steps of 2.3e-10.
///
/// Serialised for people, it is a decimal text, which reads back as the same bits. Serialised for the wire (postcard), it is its
/// bits.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct Decimal(pub Si);

impl Decimal {
    /// Makes the value from a decimal text, at compile time.
    ///
    /// # Panics
    /// The text is not a number, or the number is outside the format's range.
    #[must_use]
    pub const fn lit(text: &str) -> Self {
        Self(Si::lit(text))
    }

    /// The value of the format that is nearest to a number; the end of the range for a number outside.
    #[must_use]
    pub fn from_num(value: impl ToFixed) -> Self {
        Self(Si::saturating_from_num(value))
    }
}

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.0, f)
    }
}

impl fmt::Debug for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.0, f)
    }
}

impl FromStr for Decimal {
    type Err = fixed::ParseFixedError;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Si::from_str(text).map(Self)
    }
}

#[cfg(feature = "wire")]
impl Serialize for Decimal {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if serializer.is_human_readable() {
            serializer.collect_str(self)
        } else {
            serializer.serialize_i64(self.0.to_bits())
        }
    }
}

#[cfg(feature = "wire")]
impl<'de> Deserialize<'de> for Decimal {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            deserializer.deserialize_str(Text)
        } else {
            i64::deserialize(deserializer).map(|bits| Self(Si::from_bits(bits)))
        }
    }
}

#[cfg(feature = "wire")]
struct Text;

#[cfg(feature = "wire")]
impl Visitor<'_> for Text {
    type Value = Decimal;
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a decimal number")
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<Decimal, E> {
        Decimal::from_str(text).map_err(E::custom)
    }
}

/// Serialises a fixed-point number of the control law as its bits; for `#[serde(with = …)]`.
#[cfg(feature = "wire")]
pub(crate) mod bits {
    use fixed::types::I8F24;
    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(value: &I8F24, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_i32(value.to_bits())
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<I8F24, D::Error> {
        i32::deserialize(deserializer).map(I8F24::from_bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test values of 64 bits: the ends of the range, special patterns of bits, and values spread over the rest.
    fn samples() -> impl Iterator<Item = Si> {
        let edges = [
            0,
            1,
            -1,
            i64::MIN,
            i64::MAX,
            1 << 32,
            -(1 << 32),
            (1 << 32) - 1,
        ];
        let mut word = 0x9e37_79b9_7f4a_7c15_u64;
        let walk = core::iter::repeat_with(move || {
            word = word
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            // All magnitudes, not only the large ones.
            (word.cast_signed()) >> (word % 64)
        });
        edges
            .into_iter()
            .chain(walk.take(100_000))
            .map(Si::from_bits)
    }

    #[test]
    fn the_decimal_text_comes_back_as_the_same_bits() {
        for value in samples() {
            let text = Decimal(value).to_string();
            assert_eq!(text.parse(), Ok(Decimal(value)), "{text}");
        }
    }

    #[cfg(feature = "wire")]
    #[test]
    fn the_wire_comes_back_as_the_same_bits() {
        for value in samples() {
            let mut buffer = [0; 10];
            let bytes =
                postcard::to_slice(&Decimal(value), &mut buffer).expect("10 bytes hold 64 bits");
            assert_eq!(postcard::from_bytes(bytes), Ok(Decimal(value)));
        }
    }
}
