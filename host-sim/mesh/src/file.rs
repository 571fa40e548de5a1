//! Reads mesh files of all formats (STL, OBJ, PLY): the largest size, and what reads which format.

use crate::triangles::{Kind, MOST_TRIANGLES, Refused, Triangles};
use crate::{obj, ply, stl};
use std::fs::File;
use std::io::{ErrorKind, Read as _};
use std::path::Path;

/// Size of the largest file that is read, bytes.
const MOST_BYTES: u64 = 128_000_000;

/// Reads vertices and triangles from the bytes of a file in the format `kind`.
pub(crate) fn parse(bytes: &[u8], kind: Kind) -> Result<Triangles, Refused> {
    match kind {
        Kind::Stl => stl::parse(bytes),
        Kind::Obj => obj::parse(bytes),
        Kind::Ply => ply::parse(bytes),
    }
}

/// Reads the content of a file. Files that are too large, and binary STL files with too many triangles, are refused before they are
/// read.
///
/// # Errors
/// Problem and remedy, as text.
pub(crate) fn bytes_of(path: &Path, kind: Kind) -> Result<Vec<u8>, (String, String)> {
    if let Some(triangles) = stated_triangles(path, kind)
        && triangles > MOST_TRIANGLES as u64
    {
        return Err(Refused::TooMany { triangles }.said(kind));
    }
    touchstone_sim::input::bytes(path, MOST_BYTES).map_err(|error| {
        let fix = match error.kind() {
            ErrorKind::FileTooLarge => "export the object with fewer triangles".to_owned(),
            _ => match kind {
                Kind::Ply => "give a PLY file".to_owned(),
                _ => format!("give an {} file", kind.name()),
            },
        };
        (error.to_string(), fix)
    })
}

/// Number of triangles in a binary STL file, from its length and its first bytes; `None` for other files.
fn stated_triangles(path: &Path, kind: Kind) -> Option<u64> {
    // A pipe can be read only once.
    let meta = std::fs::metadata(path).ok()?;
    if kind != Kind::Stl || !meta.is_file() {
        return None;
    }
    let mut head = [0; stl::HEAD];
    File::open(path).ok()?.read_exact(&mut head).ok()?;
    stl::binary_count(&head, meta.len())
}
