//! Reads vertices and faces of PLY (Stanford) files, as text or binary of either byte order. Other elements and properties are
//! skipped.

use crate::triangles::{Faces, MOST_TRIANGLES, MOST_VERTICES, Refused, Triangles};
use crate::words::Words;

/// Type of a number in a binary PLY file.
#[derive(Debug, Clone, Copy)]
struct Number {
    bytes: usize,
    is_float: bool,
    is_signed: bool,
}

#[derive(Debug)]
struct Property {
    name: String,
    /// Type of the number that gives a list's length; `None` if the property is not a list.
    length: Option<Number>,
    number: Number,
}

#[derive(Debug)]
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

/// The data after the header, from which numbers are read: text or binary.
enum Data<'a> {
    /// Text, in which each element has a line of its own.
    Text {
        words: Words<'a>,
        /// Line of the last number that was read; 0 before the first.
        last: usize,
        /// Whether no number of the present element has been read yet.
        is_new: bool,
    },
    Binary {
        rest: &'a [u8],
        is_big: bool,
    },
}

impl Number {
    fn of(name: &str) -> Option<Self> {
        let (bytes, is_float, is_signed) = match name {
            "char" | "int8" => (1, false, true),
            "uchar" | "uint8" => (1, false, false),
            "short" | "int16" => (2, false, true),
            "ushort" | "uint16" => (2, false, false),
            "int" | "int32" => (4, false, true),
            "uint" | "uint32" => (4, false, false),
            "float" | "float32" => (4, true, true),
            "double" | "float64" => (8, true, true),
            _ => return None,
        };
        Some(Self {
            bytes,
            is_float,
            is_signed,
        })
    }

    fn value(self, bytes: &[u8], is_big: bool) -> f64 {
        let add = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        let bits = match is_big {
            true => bytes.iter().fold(0, add),
            false => bytes.iter().rev().fold(0, add),
        };
        match (self.is_float, self.bytes) {
            (true, 4) => f64::from(f32::from_bits(bits as u32)),
            (true, _) => f64::from_bits(bits),
            (false, bytes) if self.is_signed => {
                let unused = 64 - 8 * bytes as u32;
                ((bits << unused) as i64 >> unused) as f64
            }
            _ => bits as f64,
        }
    }
}

impl Data<'_> {
    fn number(&mut self, kind: Number, place: &Place<'_>) -> Result<f64, String> {
        match self {
            Self::Text {
                words,
                last,
                is_new,
            } => {
                let word = words.next().ok_or_else(|| place.ends())?;
                match (*is_new, word.line == *last) {
                    (true, true) => {
                        return Err(word.instead_of("the end of a line, by its header"));
                    }
                    (false, false) => {
                        let wanted = format!("a number of the line before, {}", place.named());
                        return Err(word.instead_of(&wanted));
                    }
                    _ => (*last, *is_new) = (word.line, false),
                }
                let text = std::str::from_utf8(word.bytes).ok();
                text.and_then(|text| text.parse().ok())
                    .ok_or_else(|| word.instead_of("a number"))
            }
            Self::Binary { rest, is_big } => {
                let (own, after) = rest
                    .split_at_checked(kind.bytes)
                    .ok_or_else(|| place.ends())?;
                *rest = after;
                Ok(kind.value(own, *is_big))
            }
        }
    }

    /// Announces that the next number belongs to the next element.
    fn next_element(&mut self) {
        if let Self::Text { is_new, .. } = self {
            *is_new = true;
        }
    }

    /// Describes data after the last element, in words; `None` if there is none.
    fn left(&mut self) -> Option<String> {
        match self {
            Self::Text { words, .. } => words
                .next()
                .map(|word| word.instead_of("the end of the data, by its header's counts")),
            Self::Binary { rest, .. } => (!rest.is_empty()).then(|| {
                format!(
                    "{} bytes follow the data that its header announces",
                    rest.len()
                )
            }),
        }
    }
}

/// An element of the file by its number, from 0, for error messages.
struct Place<'a> {
    element: &'a Element,
    number: u64,
}

impl Place<'_> {
    fn named(&self) -> String {
        format!("{} {}", self.element.name, self.number)
    }

    fn ends(&self) -> String {
        let (name, count) = (&self.element.name, self.element.count);
        format!(
            "it ends in {} of {count} (from 0) of the element {name}",
            self.number
        )
    }
}

/// Reads the bytes of a PLY file.
///
/// # Errors
/// The bytes are not a PLY file with faces, or there are too many triangles.
pub(crate) fn parse(bytes: &[u8]) -> Result<Triangles, Refused> {
    let (elements, mut data) = head(bytes)?;
    let mut vertices: Vec<[f32; 3]> = Vec::new();
    let mut faces = Faces::default();
    let mut corners: Vec<u32> = Vec::new();
    for element in &elements {
        let [is_vertex, is_face] = ["vertex", "face"].map(|name| element.name == name);
        check(element)?;
        if element.properties.is_empty() {
            continue;
        }
        for number in 0..element.count {
            let place = Place { element, number };
            data.next_element();
            let mut at = [0.0; 3];
            for property in &element.properties {
                let axis = ["x", "y", "z"]
                    .iter()
                    .position(|axis| property.name == *axis);
                let Some(length) = property.length else {
                    let value = data.number(property.number, &place)?;
                    if let (true, Some(axis)) = (is_vertex, axis) {
                        at[axis] = value as f32;
                    }
                    continue;
                };
                let length = whole(data.number(length, &place)?, &place, "a list's length")?;
                let is_corners = is_face && is_corners(property);
                corners.clear();
                for _ in 0..length {
                    let value = data.number(property.number, &place)?;
                    if is_corners {
                        corners.push(whole(value, &place, "the number of a vertex")?);
                    }
                }
                if is_corners {
                    faces.face(&corners, || place.named())?;
                }
            }
            if is_vertex {
                if vertices.len() == MOST_VERTICES {
                    return Err(Refused::MoreThanRead);
                }
                vertices.push(at);
            }
        }
    }
    if let Some(left) = data.left() {
        return Err(left.into());
    }
    faces.finish(vertices, 1)
}

fn is_corners(property: &Property) -> bool {
    property.length.is_some() && ["vertex_indices", "vertex_index"].contains(&&*property.name)
}

/// Checks from the header that an element's properties can be read.
fn check(element: &Element) -> Result<(), Refused> {
    let has = |name: &str| {
        let own = |property: &Property| property.length.is_none() && property.name == name;
        element.properties.iter().any(own)
    };
    match &*element.name {
        "vertex" if !["x", "y", "z"].into_iter().all(has) => {
            Err("its vertices have no x, y and z".to_owned().into())
        }
        "vertex" if element.count > MOST_VERTICES as u64 => Err(Refused::MoreThanRead),
        "face" if !element.properties.iter().any(is_corners) => {
            Err("its faces have no vertex_indices".to_owned().into())
        }
        "face" if element.count > MOST_TRIANGLES as u64 => Err(Refused::TooMany {
            triangles: element.count,
        }),
        "tristrips" => Err(
            "its triangles are strips, which this program does not support"
                .to_owned()
                .into(),
        ),
        _ => Ok(()),
    }
}

/// Converts a number that must be a whole number, such as a list's length; `wanted` says in errors what it counts.
fn whole(value: f64, place: &Place<'_>, wanted: &str) -> Result<u32, String> {
    match value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value) {
        true => Ok(value as u32),
        false => Err(format!("{}: {value} instead of {wanted}", place.named())),
    }
}

/// Reads the header: the list of elements that follow, and whether the data are text or binary.
fn head(bytes: &[u8]) -> Result<(Vec<Element>, Data<'_>), String> {
    let mut elements: Vec<Element> = Vec::new();
    let (mut rest, mut number, mut form) = (bytes, 0, None);
    loop {
        let end = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let Some(end) = end else {
            return Err("its header has no end_header".to_owned());
        };
        let pair = usize::from(rest[end..].starts_with(b"\r\n"));
        let line = String::from_utf8_lossy(&rest[..end]);
        rest = &rest[end + 1 + pair..];
        number += 1;
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let wrong = || {
            let begin: String = line.chars().take(40).collect();
            format!("line {number}: \"{begin}\" is not a line of a PLY header")
        };
        let property = |name: &str, length: Option<&str>, kind: &str| {
            let length = match length {
                Some(length) => Some(Number::of(length).ok_or_else(wrong)?),
                None => None,
            };
            Ok::<_, String>(Property {
                name: name.to_owned(),
                length,
                number: Number::of(kind).ok_or_else(wrong)?,
            })
        };
        match (&words[..], elements.last_mut()) {
            (["ply"], _) if number == 1 => {}
            _ if number == 1 => return Err("its first line is not \"ply\"".to_owned()),
            (["comment" | "obj_info", ..] | [], _) => {}
            (["format", named, _], _) => form = Some((*named).to_owned()),
            (["element", name, count], _) => elements.push(Element {
                name: (*name).to_owned(),
                count: count.parse().map_err(|_| wrong())?,
                properties: Vec::new(),
            }),
            (["property", "list", length, kind, name], Some(element)) => {
                element.properties.push(property(name, Some(length), kind)?);
            }
            (["property", kind, name], Some(element)) => {
                element.properties.push(property(name, None, kind)?);
            }
            (["end_header"], _) => {
                let data = match form.as_deref() {
                    Some("ascii") => Data::Text {
                        words: Words::from_line(rest, number + 1),
                        last: 0,
                        is_new: true,
                    },
                    Some("binary_little_endian") => Data::Binary {
                        rest,
                        is_big: false,
                    },
                    Some("binary_big_endian") => Data::Binary { rest, is_big: true },
                    _ => return Err("its header names an unknown format".to_owned()),
                };
                return Ok((elements, data));
            }
            _ => return Err(wrong()),
        }
    }
}
