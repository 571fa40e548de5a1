//! Reads STL files as programs write them: text in any letter case and spacing, with one or more solids; binary with a wrong count
//! of triangles.

use parry3d_f64::math::Vector;
use std::collections::HashMap;
use std::path::Path;

/// Size of the longest file that is read, bytes: five million triangles in binary.
const MOST_BYTES: u64 = 250_000_084;
/// Bytes of a binary file before its first triangle: header and number of triangles.
const HEAD: usize = 84;
/// Bytes of a triangle in a binary file.
const RECORD: usize = 50;

/// The triangles of a file. Vertices with the same coordinates become one vertex.
#[derive(Debug, Clone, Default)]
pub(crate) struct Triangles {
    pub vertices: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// Number of solids that the file names; 1 for a binary file.
    pub solids: usize,
    known: HashMap<[u32; 3], u32>,
}

impl Triangles {
    fn vertex(&mut self, at: [f32; 3]) -> u32 {
        // -0 is 0.
        let key = at.map(|value| (value + 0.0).to_bits());
        let next = self.vertices.len() as u32;
        let number = *self.known.entry(key).or_insert(next);
        if number == next {
            self.vertices.push(at);
        }
        number
    }

    fn triangle(&mut self, corners: [[f32; 3]; 3]) {
        let numbers = corners.map(|corner| self.vertex(corner));
        self.triangles.push(numbers);
    }

    /// The vertices in metres; `unit_m` is the file's unit in metres.
    pub fn vertices_m(&self, unit_m: f64) -> Vec<Vector> {
        self.vertices
            .iter()
            .map(|at| unit_m * Vector::from_array(at.map(f64::from)))
            .collect()
    }
}

/// Reads a file, also one whose size is unknown before, up to the largest size.
///
/// # Errors
/// What is wrong, and advice.
pub(crate) fn bytes_of(path: &Path) -> Result<Vec<u8>, (String, &'static str)> {
    touchstone_sim::input::bytes(path, MOST_BYTES).map_err(|error| match error.kind() {
        std::io::ErrorKind::FileTooLarge => {
            (error.to_string(), "export the object with fewer triangles")
        }
        _ => (error.to_string(), "give an STL file"),
    })
}

/// Reads the triangles from the bytes of a file. The file is text if it begins with the word `solid` and then has a `facet` or an
/// end; otherwise it is binary.
///
/// # Errors
/// What is wrong with the file.
pub(crate) fn parse(bytes: &[u8]) -> Result<Triangles, String> {
    let told = bytes.get(80..HEAD).map_or(0, |count| {
        count
            .iter()
            .rev()
            .fold(0_usize, |sum, byte| sum << 8 | usize::from(*byte))
    });
    // A binary file's count of triangles that fits its length is the one sign that a text cannot have by chance.
    if bytes.len() > HEAD && told.checked_mul(RECORD) == Some(bytes.len() - HEAD) {
        return Ok(binary(&bytes[HEAD..]));
    }
    let plain = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    // Zeros at the end are padding.
    let last = plain.iter().rposition(|byte| *byte != 0);
    let plain = &plain[..last.map_or(0, |at| at + 1)];
    if bytes.is_empty() {
        return Err("the file is empty".to_owned());
    }
    let mut words = Words::new(plain);
    if words.next().is_some_and(|word| word.is("solid")) && !plain.contains(&0) {
        return text(plain);
    }
    if let Some(kind) = other_format(plain) {
        return Err(format!("it is {kind}"));
    }
    if bytes.len() < HEAD {
        return Err(format!(
            "{} bytes without the word solid; a binary file has {HEAD} and more",
            bytes.len()
        ));
    }
    let there = bytes.len() - HEAD;
    Err(format!(
        "its count says {told} triangles, {} bytes are there for {}{}",
        there,
        there / RECORD,
        match there % RECORD {
            0 => String::new(),
            rest => format!(" and {rest} bytes more"),
        }
    ))
}

/// Name of another format that is sometimes stored as `.stl`; `None` if the bytes begin like none of these.
fn other_format(bytes: &[u8]) -> Option<&'static str> {
    let begins = |mark: &[u8]| bytes.starts_with(mark);
    let first = bytes.iter().position(|byte| !byte.is_ascii_whitespace())?;
    match bytes[first] {
        b'<' => Some("a page or another text in angle brackets"),
        b'{' => Some("JSON"),
        _ if begins(b"\x89PNG") => Some("a PNG picture"),
        _ if begins(b"PK\x03\x04") => Some("a zip archive, as 3MF is"),
        _ if begins(b"ply") => Some("PLY"),
        _ if begins(b"\x1f\x8b") => Some("compressed by gzip"),
        _ if begins(b"ISO-10303") => Some("STEP"),
        _ if begins(b"\xff\xfe") || begins(b"\xfe\xff") => Some("text in UTF-16"),
        _ if begins(b"v ") || begins(b"# ") || begins(b"o ") || begins(b"mtllib ") => Some("OBJ"),
        _ => None,
    }
}

fn binary(records: &[u8]) -> Triangles {
    let mut found = Triangles {
        solids: 1,
        ..Triangles::default()
    };
    for record in records.chunks_exact(RECORD) {
        let number = |at: usize| {
            let bytes: [u8; 4] = std::array::from_fn(|byte| record[4 * at + byte]);
            f32::from_le_bytes(bytes)
        };
        // The first three numbers are the normal, which is not used: the order of the corners says which side is outside.
        found.triangle([3, 6, 9].map(|at| [number(at), number(at + 1), number(at + 2)]));
    }
    found
}

/// Whether a byte is white space, including the vertical tab as in C.
fn is_space(byte: &u8) -> bool {
    byte.is_ascii_whitespace() || *byte == b'\x0b'
}

/// The words of a text with their line numbers. LF, CR or CRLF ends a line.
struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

#[derive(Clone, Copy)]
struct Word<'a> {
    bytes: &'a [u8],
    line: usize,
}

impl<'a> Words<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            at: 0,
            line: 1,
        }
    }

    fn ends_line(&self) -> bool {
        match self.bytes[self.at] {
            b'\n' => true,
            b'\r' => self.bytes.get(self.at + 1) != Some(&b'\n'),
            _ => false,
        }
    }

    /// Skips the rest of the line, which is a solid's name in any encoding.
    fn skip_line(&mut self) {
        while self.at < self.bytes.len() && !self.ends_line() {
            self.at += 1;
        }
    }

    fn wanted(&mut self, wanted: &str) -> Result<(), String> {
        match self.next() {
            Some(word) if word.is(wanted) => Ok(()),
            Some(word) => Err(word.instead_of(wanted)),
            None => Err(format!(
                "the text ends at line {} where \"{wanted}\" must follow",
                self.line
            )),
        }
    }

    fn number(&mut self) -> Result<f32, String> {
        let Some(word) = self.next() else {
            return Err(format!(
                "the text ends at line {} where a number must follow",
                self.line
            ));
        };
        let number = std::str::from_utf8(word.bytes)
            .ok()
            .and_then(|text| text.parse::<f32>().ok());
        number
            .filter(|number| number.is_finite())
            .ok_or_else(|| word.instead_of("a number"))
    }

    fn corner(&mut self) -> Result<[f32; 3], String> {
        self.wanted("vertex")?;
        Ok([self.number()?, self.number()?, self.number()?])
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = Word<'a>;

    fn next(&mut self) -> Option<Word<'a>> {
        while is_space(self.bytes.get(self.at)?) {
            self.line += usize::from(self.ends_line());
            self.at += 1;
        }
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(is_space).unwrap_or(rest.len());
        self.at += length;
        Some(Word {
            bytes: &rest[..length],
            line: self.line,
        })
    }
}

impl Word<'_> {
    fn is(&self, wanted: &str) -> bool {
        self.bytes.eq_ignore_ascii_case(wanted.as_bytes())
    }

    fn instead_of(&self, wanted: &str) -> String {
        let text: String = String::from_utf8_lossy(self.bytes)
            .chars()
            .take(40)
            .collect();
        format!("line {}: \"{text}\" instead of {wanted}", self.line)
    }
}

fn text(bytes: &[u8]) -> Result<Triangles, String> {
    let mut found = Triangles::default();
    let mut words = Words::new(bytes);
    while let Some(word) = words.next() {
        if !word.is("solid") {
            return Err(word.instead_of("solid"));
        }
        words.skip_line();
        found.solids += 1;
        loop {
            let Some(word) = words.next() else {
                return Err(format!(
                    "the text ends at line {} without endsolid, after {} triangles",
                    words.line,
                    found.triangles.len()
                ));
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
                return Err(word.instead_of("facet or endsolid"));
            }
            found.triangle(facet(&mut words)?);
        }
    }
    match found.triangles.len() {
        0 => Err("no facet is in it".to_owned()),
        _ => Ok(found),
    }
}

/// Reads a facet after its first word. The normal in the file is ignored, because many programs write no useful one, or `nan`.
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
    let corners = [words.corner()?, words.corner()?, words.corner()?];
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
