//! Reads STL files with the deviations of common programs: text in any letter case and spacing, one or more solids, and binary
//! files with a wrong number of triangles.

use crate::triangles::{MOST_TRIANGLES, Refused, Triangles, Welded};
use crate::words::Words;

/// Number of bytes of a binary STL file before its first triangle: header and number of triangles.
pub(crate) const HEAD: usize = 84;
/// Number of bytes per triangle in a binary STL file.
const RECORD: usize = 50;

/// Reads the bytes of an STL file. The file is binary if its length fits the number of triangles in its header. Else it must be
/// text that begins with the word `solid` and contains no zero byte except at its end.
///
/// # Errors
/// The bytes are not STL, or hold more than [`MOST_TRIANGLES`].
pub(crate) fn parse(bytes: &[u8]) -> Result<Triangles, Refused> {
    // A text cannot contain a matching number of triangles by chance, so a matching number means a binary file.
    if let Some(count) = binary_count(bytes, bytes.len() as u64) {
        return match count > MOST_TRIANGLES as u64 {
            true => Err(Refused::TooMany { triangles: count }),
            false => Ok(binary(&bytes[HEAD..])),
        };
    }
    let told = count(bytes);
    let plain = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    // Zeros at the end are padding.
    let last = plain.iter().rposition(|byte| *byte != 0);
    let plain = &plain[..last.map_or(0, |at| at + 1)];
    if bytes.is_empty() {
        return Err("the file is empty".to_owned().into());
    }
    let mut words = Words::new(plain);
    if words.next().is_some_and(|word| word.is("solid")) && !plain.contains(&0) {
        return text(plain);
    }
    if let Some(kind) = other_format(plain) {
        return Err(format!("it is {kind}").into());
    }
    if bytes.len() < HEAD {
        return Err(format!(
            "{} bytes without the word solid; a binary file has {HEAD} and more",
            bytes.len()
        )
        .into());
    }
    let there = bytes.len() - HEAD;
    Err(format!(
        "its header announces {told} triangles, but its {} bytes of data hold {}{}",
        there,
        there / RECORD,
        match there % RECORD {
            0 => String::new(),
            rest => format!(" and {rest} bytes more"),
        }
    )
    .into())
}

/// Number of triangles that the first bytes of a binary STL file state.
fn count(head: &[u8]) -> u64 {
    head.get(80..HEAD).map_or(0, |count| {
        count
            .iter()
            .rev()
            .fold(0, |sum, byte| sum << 8 | u64::from(*byte))
    })
}

/// Number of triangles of a binary STL file, from its first [`HEAD`] bytes and its length in bytes; `None` if the two disagree.
pub(crate) fn binary_count(head: &[u8], length: u64) -> Option<u64> {
    let count = count(head);
    (length > HEAD as u64 && count * RECORD as u64 == length - HEAD as u64).then_some(count)
}

/// Name of another format that is sometimes stored as `.stl`; `None` if the bytes do not begin like a known other format.
fn other_format(bytes: &[u8]) -> Option<&'static str> {
    let begins = |mark: &[u8]| bytes.starts_with(mark);
    let first = bytes.iter().position(|byte| !byte.is_ascii_whitespace())?;
    match bytes[first] {
        b'<' => Some("a page or another text in angle brackets"),
        b'{' => Some("JSON"),
        _ if begins(b"ply") => Some("PLY"),
        _ if begins(b"ISO-10303") => Some("STEP"),
        _ if begins(b"v ") || begins(b"# ") || begins(b"o ") || begins(b"mtllib ") => Some("OBJ"),
        _ => touchstone_sim::input::kind_of(bytes),
    }
}

fn binary(records: &[u8]) -> Triangles {
    let mut found = Welded::default();
    for record in records.chunks_exact(RECORD) {
        let number = |at: usize| {
            let bytes: [u8; 4] = std::array::from_fn(|byte| record[4 * at + byte]);
            f32::from_le_bytes(bytes)
        };
        // The first three numbers are the normal, which is not used: the order of the corners says which side is outside.
        found.triangle([3, 6, 9].map(|at| [number(at), number(at + 1), number(at + 2)]));
    }
    found.finish(1)
}

fn text(bytes: &[u8]) -> Result<Triangles, Refused> {
    let mut found = Welded::default();
    let mut solids = 0;
    let mut words = Words::new(bytes);
    while let Some(word) = words.next() {
        if !word.is("solid") {
            return Err(word.instead_of("solid").into());
        }
        words.skip_line();
        solids += 1;
        loop {
            let Some(word) = words.next() else {
                return Err(format!(
                    "the text ends at line {} without endsolid, after {} triangles",
                    words.line,
                    found.len()
                )
                .into());
            };
            if word.is("endsolid") {
                words.skip_line();
                break;
            }
            if word.is("end") {
                words.wanted("solid")?;
                words.skip_line();
                break;
            }
            if !word.is("facet") {
                return Err(word.instead_of("facet or endsolid").into());
            }
            if found.len() == MOST_TRIANGLES {
                return Err(Refused::MoreThanRead);
            }
            found.triangle(facet(&mut words)?);
        }
    }
    match found.len() {
        0 => Err("it contains no facet".to_owned().into()),
        _ => Ok(found.finish(solids)),
    }
}

/// Reads a facet after the word `facet`. The normal in the file is ignored, because many programs write a useless one, or `nan`.
fn facet(words: &mut Words<'_>) -> Result<[[f32; 3]; 3], String> {
    words.wanted("normal")?;
    let mut left = 3;
    let mut word = words.next();
    while left > 0 && word.as_ref().is_some_and(|word| !word.is("outer")) {
        word = words.next();
        left -= 1;
    }
    match word {
        Some(word) if word.is("outer") => words.wanted("loop")?,
        Some(word) => return Err(word.instead_of("outer loop")),
        None => return Err("the text ends in a facet".to_owned()),
    }
    let corners = [corner(words)?, corner(words)?, corner(words)?];
    joined(words, "end", "loop")?;
    joined(words, "end", "facet")?;
    Ok(corners)
}

/// Reads two words that may be written as one, such as `endloop` or `end loop`.
fn joined(words: &mut Words<'_>, first: &str, second: &str) -> Result<(), String> {
    match words.next() {
        Some(word) if word.is(first) => words.wanted(second),
        Some(word) if word.is(&format!("{first}{second}")) => Ok(()),
        Some(word) => Err(word.instead_of(&format!("{first}{second}"))),
        None => Err(format!("the text ends where {first}{second} must follow")),
    }
}

fn corner(words: &mut Words<'_>) -> Result<[f32; 3], String> {
    words.wanted("vertex")?;
    Ok([words.number()?, words.number()?, words.number()?])
}
