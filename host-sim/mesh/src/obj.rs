//! Reads vertices and faces of Wavefront OBJ files. Colours, materials, textures, normals, points and lines are skipped, and no
//! other file is opened.

use crate::triangles::{Faces, MOST_VERTICES, Refused, Triangles};
use crate::words::{Word, is_space};

/// Keywords of curves and curved surfaces, which are refused because they are not triangles.
const FREE_FORM: [&[u8]; 4] = [b"curv", b"curv2", b"surf", b"cstype"];

/// Reads the bytes of an OBJ file.
///
/// # Errors
/// A line that is not valid OBJ, or too many triangles.
pub(crate) fn parse(bytes: &[u8]) -> Result<Triangles, Refused> {
    let plain = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut vertices: Vec<[f32; 3]> = Vec::new();
    let mut faces = Faces::default();
    let mut corners = Vec::new();
    let mut objects = 0;
    // The largest vertex that a face names, with its place: the vertex may come after the face.
    let mut largest: Option<(u32, Word<'_>)> = None;
    for (line, text) in lines(plain) {
        let code = text.split(|byte| *byte == b'#').next().unwrap_or(text);
        // A line that ends with a backslash goes on in the next one.
        let is_gap = |byte: &u8| is_space(byte) || *byte == b'\\';
        let mut words = code
            .split(is_gap)
            .filter(|word| !word.is_empty())
            .map(|bytes| Word { bytes, line });
        match words.next().map(|word| word.bytes) {
            Some(b"v") => {
                let mut number = || match words.next() {
                    Some(word) => word.number(),
                    None => Err(format!("line {line}: a vertex has three numbers")),
                };
                let at = [number()?, number()?, number()?];
                if vertices.len() == MOST_VERTICES {
                    return Err(Refused::MoreThanRead);
                }
                vertices.push(at);
            }
            Some(b"f") => {
                corners.clear();
                for word in words {
                    let corner = corner(word, vertices.len())?;
                    if largest.is_none_or(|(most, _)| corner > most) {
                        largest = Some((corner, word));
                    }
                    corners.push(corner);
                }
                faces.face(&corners, || format!("line {line}"))?;
            }
            Some(b"o") => objects += 1,
            Some(word) if FREE_FORM.contains(&word) => {
                let word = Word { bytes: word, line };
                return Err(word
                    .instead_of("faces; a free-form surface is not a mesh")
                    .into());
            }
            _ => {}
        }
    }
    if let Some((most, word)) = largest
        && most as usize >= vertices.len()
    {
        let there = vertices.len();
        return Err(word
            .instead_of(&format!("one of its {there} vertices"))
            .into());
    }
    faces.finish(vertices, objects)
}

/// Number of the vertex that a word of a face refers to, from 0. `so_far` is the number of vertices before the face; negative
/// numbers count back from it.
fn corner(word: Word<'_>, so_far: usize) -> Result<u32, String> {
    let number = word.bytes.split(|byte| *byte == b'/').next();
    let number = number.and_then(|number| std::str::from_utf8(number).ok());
    let vertex = match number.and_then(|number| number.parse::<i64>().ok()) {
        Some(number @ 1..) => Some(number - 1),
        Some(0) | None => None,
        Some(number) => number.checked_add(so_far as i64),
    };
    vertex
        .and_then(|vertex| u32::try_from(vertex).ok())
        .ok_or_else(|| word.instead_of("the number of a vertex"))
}

/// Splits a file into lines with their numbers from 1. LF, CR or CRLF ends a line, unless a backslash stands before it.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let (mut rest, mut line) = (bytes, 1);
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let (first, mut end, mut number) = (line, 0, 0);
        while end < rest.len() {
            let is_pair = rest[end] == b'\r' && rest.get(end + 1) == Some(&b'\n');
            if matches!(rest[end], b'\n' | b'\r') {
                number += 1;
                let goes_on = end > 0 && rest[end - 1] == b'\\';
                end += usize::from(is_pair);
                if !goes_on {
                    break;
                }
            }
            end += 1;
        }
        let (text, after) = rest.split_at(end);
        rest = after.get(1..).unwrap_or_default();
        line += number;
        Some((first, text))
    })
}
