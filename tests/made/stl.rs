//! Generates STL files (triangle meshes) and damages them. Checks that each is read, or refused with a one-line message.

use super::choices::Choices;
use std::path::Path;
use touchstone_mesh::Mesh;

/// The twelve triangles of a block between two opposite corners. The corners of each triangle are counter-clockwise as seen from
/// outside.
pub fn block(low: [f64; 3], high: [f64; 3]) -> Vec<[[f64; 3]; 3]> {
    let corner = |n: usize| {
        [0, 1, 2].map(|axis| {
            if n >> axis & 1 == 1 {
                high[axis]
            } else {
                low[axis]
            }
        })
    };
    [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ]
    .map(|triangle: [usize; 3]| triangle.map(corner))
    .to_vec()
}

/// Writes triangles as a text STL file.
pub fn solid(name: &str, triangles: &[[[f64; 3]; 3]]) -> String {
    let vertex = |[x, y, z]: &[f64; 3]| format!("      vertex {x:e} {y:e} {z:e}\n");
    let facets: String = triangles
        .iter()
        .map(|corners| {
            let corners: String = corners.iter().map(vertex).collect();
            format!("  facet normal 0 0 0\n    outer loop\n{corners}    endloop\n  endfacet\n")
        })
        .collect();
    format!("solid {name}\n{facets}endsolid {name}\n")
}

/// Writes triangles as a binary STL file.
pub fn binary(head: &[u8], count: u32, triangles: &[[[f64; 3]; 3]]) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes[..head.len()].copy_from_slice(head);
    bytes.extend(count.to_le_bytes());
    for corners in triangles {
        bytes.extend([0; 12]);
        bytes.extend(
            corners
                .iter()
                .flatten()
                .flat_map(|value| (*value as f32).to_le_bytes()),
        );
        bytes.extend([0; 2]);
    }
    bytes
}

/// Makes a random STL file with up to three damages.
pub fn made(seeded: &mut impl Choices) -> Vec<u8> {
    let sizes = [1e-30, 1.0, 60.0, 1e30, 3e38];
    let mut corner = || [0; 3].map(|_| sizes[seeded.below(5)] * (seeded.below(7) as f64 - 3.0));
    let triangles = block(corner(), corner());
    let mut bytes = match seeded.below(2) {
        0 => solid(seeded.of(&["", "part", "facet normal"]), &triangles).into_bytes(),
        _ => binary(b"solid", 12, &triangles),
    };
    damage(&mut bytes, seeded);
    bytes
}

/// Damages the bytes of a file at up to three places.
pub fn damage(bytes: &mut Vec<u8>, seeded: &mut impl Choices) {
    for _ in 0..seeded.below(4) {
        let at = seeded.below(bytes.len().max(1)).min(bytes.len());
        match seeded.below(5) {
            0 => bytes.truncate(at),
            1 => bytes.insert(at, seeded.below(256) as u8),
            2 => drop(bytes.splice(at..at, *b" solid ")),
            3 => bytes.extend_from_within(at..),
            _ => {
                let bit = seeded.below(8);
                bytes[at..]
                    .iter_mut()
                    .take(1)
                    .for_each(|byte| *byte ^= 1 << bit);
            }
        }
    }
}

/// Whether an STL file is accepted. For an accepted one, also computes the remarks that the program prints on the mesh.
pub fn is_read(bytes: &[u8]) -> bool {
    is_read_as("made.stl", bytes)
}

/// Whether a mesh file is accepted in the format that the ending of its name says.
pub fn is_read_as(name: &str, bytes: &[u8]) -> bool {
    match Mesh::parse(bytes, Path::new(name), 1e-3) {
        Ok(mesh) => {
            let _ = mesh.notes([[-0.1; 3], [0.1; 3]]);
            true
        }
        Err(error) => {
            let error = error.to_string();
            assert!(!error.contains('\n') && error.len() < 400, "{error}");
            false
        }
    }
}
