//! Tests of OBJ and PLY files: forms that users have, wrong and damaged files, and files that are too large.

#[path = "../../../tests/made/choices.rs"]
mod choices;
#[path = "../../../tests/made/stl.rs"]
#[allow(dead_code)]
mod stl;

use choices::Seeded;
use std::path::Path;
use stl::{block, damage, is_read_as};
use touchstone_mesh::{MOST_TRIANGLES, Mesh, MeshError, Vector};

/// Volume of the block, m³.
const VOLUME_M3: f64 = 0.12 * 0.12 * 0.02;

/// Corners of a block in mm, and its six faces, counter-clockwise from outside.
const CORNERS: [[i32; 3]; 8] = [
    [-60, -60, -20],
    [60, -60, -20],
    [60, 60, -20],
    [-60, 60, -20],
    [-60, -60, 0],
    [60, -60, 0],
    [60, 60, 0],
    [-60, 60, 0],
];
const QUADS: [[usize; 4]; 6] = [
    [0, 3, 2, 1],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
];

fn read(name: &str, bytes: impl AsRef<[u8]>) -> Result<Mesh, String> {
    Mesh::parse(bytes.as_ref(), Path::new(name), 1e-3).map_err(|error| error.to_string())
}

fn obj() -> String {
    let vertices = CORNERS.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
    let faces = QUADS.map(|corners| {
        let [a, b, c, d] = corners.map(|corner| corner + 1);
        format!("f {a} {b} {c} {d}\n")
    });
    format!("# a block\no slab\n{vertices}{}", faces.concat())
}

/// A PLY file in the format `form`, with colours on its vertices, which are ignored.
fn ply(form: &str) -> Vec<u8> {
    let head = format!(
        "ply\nformat {form} 1.0\ncomment a block\nelement vertex 8\nproperty float x\nproperty double y\nproperty short z\n\
         property uchar red\nelement face 6\nproperty list uchar int vertex_indices\nelement edge 1\nproperty ushort a\nend_header\n"
    );
    let mut bytes = head.into_bytes();
    if form == "ascii" {
        for [x, y, z] in CORNERS {
            bytes.extend(format!("{x} {y}.0 {z} 255\n").into_bytes());
        }
        for [a, b, c, d] in QUADS {
            bytes.extend(format!("4 {a} {b} {c} {d}\n").into_bytes());
        }
        bytes.extend(b"7\n");
        return bytes;
    }
    let mut add = |little: &[u8]| match form {
        "binary_big_endian" => bytes.extend(little.iter().rev()),
        _ => bytes.extend(little),
    };
    for [x, y, z] in CORNERS {
        add(&(x as f32).to_le_bytes());
        add(&f64::from(y).to_le_bytes());
        add(&(z as i16).to_le_bytes());
        add(&[255]);
    }
    for corners in QUADS {
        add(&[4]);
        corners
            .iter()
            .for_each(|corner| add(&(*corner as i32).to_le_bytes()));
    }
    add(&7_u16.to_le_bytes());
    bytes
}

const FORMS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

#[test]
fn obj_reads_the_same_however_it_is_written() {
    let plain = obj();
    let with_normals = plain
        .replace("f 1 4 3 2", "vt 0 0\nvn 0 0 -1\nf 1/1/1 4/1/1 3/1/1 2/1/1")
        .replace("f 5 6 7 8", "f 5//1 6//1 7//1 8//1");
    let (vertices, faces) = plain.split_at(plain.find("f 1").unwrap());
    let from_the_end = plain.replace("f 5 6 7 8", "f -4 -3 -2 -1");
    let coloured = plain.replace("v 60 60 0", "v 60 60 0 1.0 0.5 0.2");
    let materials =
        format!("mtllib ../../none.mtl\ng part\nusemtl red\ns off\n{plain}l 1 2\np 3\n");
    for (name, text) in [
        ("plain", plain.clone().into_bytes()),
        ("crlf", plain.replace('\n', "\r\n").into_bytes()),
        ("cr", plain.replace('\n', "\r").into_bytes()),
        ("bom", format!("\u{feff}{plain}").into_bytes()),
        ("tabs", plain.replace(' ', "\t ").into_bytes()),
        ("normals", with_normals.into_bytes()),
        ("faces-first", format!("{faces}{vertices}").into_bytes()),
        ("from-the-end", from_the_end.into_bytes()),
        ("coloured", coloured.into_bytes()),
        ("materials", materials.into_bytes()),
        (
            "two-lines",
            plain.replace("4 3 2", "4 \\\n 3 2").into_bytes(),
        ),
        (
            "two-lines-crlf",
            plain.replace("4 3 2", "4 \\\r\n 3 2").into_bytes(),
        ),
        (
            "remark",
            plain.replace("4 3 2", "4 3 2 # f 9 9 9").into_bytes(),
        ),
        ("no-last-line-end", plain.trim_end().as_bytes().to_vec()),
        ("latin", [b"# St\xfcck\n", plain.as_bytes()].concat()),
    ] {
        let mesh = read("a.OBJ", &text).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((mesh.triangles(), mesh.left_out()), (12, 0), "{name}");
        assert!(
            (mesh.signed_volume_m3() - VOLUME_M3).abs() < 1e-12,
            "{name}"
        );
        assert!(mesh.notes([[-0.06; 3], [0.06; 3]]).is_empty(), "{name}");
    }
}

#[test]
fn ply_reads_the_same_in_each_form() {
    for form in FORMS {
        let mesh = read("a.ply", ply(form)).unwrap_or_else(|error| panic!("{form}: {error}"));
        assert_eq!((mesh.triangles(), mesh.left_out()), (12, 0), "{form}");
        assert!(
            (mesh.signed_volume_m3() - VOLUME_M3).abs() < 1e-12,
            "{form}"
        );
        assert!(mesh.notes([[-0.06; 3], [0.06; 3]]).is_empty(), "{form}");
    }
    let text = String::from_utf8(ply("ascii")).unwrap();
    for (name, text) in [
        ("crlf", text.replace('\n', "\r\n")),
        ("other-name", text.replace("vertex_indices", "vertex_index")),
        (
            "sized-types",
            text.replace("list uchar int", "list uint8 int32"),
        ),
        ("blank-lines", text.replace("255\n", "255\n\n")),
    ] {
        let mesh = read("a.ply", &text).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(mesh.triangles(), 12, "{name}");
    }
}

#[test]
fn what_is_odd_is_noted_as_of_stl() {
    let notes =
        |name: &str, bytes: &[u8]| read(name, bytes).unwrap().notes([[-0.06; 3], [0.06; 3]]);
    let open = obj().replace("f 5 6 7 8\n", "");
    let turned = obj().replace("f 5 6 7 8", "f 8 7 6 5");
    let mirrored = obj()
        .replace("v -60", "v X")
        .replace("v 60", "v -60")
        .replace("v X", "v 60");
    let twice = format!("{}o other\nf 5 6 7 8\n", obj());
    // An arrow: its second corner is pushed in beyond the line from the first to the third.
    let arrow = "v 0 0 0\nv 10 40 0\nv 0 30 0\nv -10 40 0\nf 4 1 2 3\n";
    let text = String::from_utf8(ply("ascii")).unwrap();
    for (name, bytes, expected) in [
        ("a.obj", open, "4 edges belong to one triangle only"),
        ("a.obj", turned, "4 edges run the same way"),
        (
            "a.obj",
            mirrored,
            "its volume is -288.000 cm³: the mesh is inside out",
        ),
        ("a.obj", twice.clone(), "2 triangles lie on another one"),
        ("a.obj", twice, "has 2 solids"),
        ("a.obj", arrow.to_owned(), "1 of its faces are not convex"),
        (
            "a.ply",
            text.replace(" -20 255", " -20000 255")
                .replace(" 0 255", " 9000 255"),
            "m across, but the device reaches only",
        ),
        (
            "a.ply",
            text.replace("4 4 5 6 7", "4 7 6 5 4"),
            "4 edges run the same way",
        ),
        (
            "a.ply",
            text.replace("4 4 5 6 7", "3 4 5 6"),
            "3 edges belong to one triangle",
        ),
    ] {
        let notes = notes(name, bytes.as_bytes());
        let is_there = notes.iter().any(|note| note.contains(expected));
        assert!(is_there, "{expected}: {notes:?}");
    }
}

#[test]
fn what_is_wrong_is_refused_at_its_place() {
    let plain = obj();
    let text = String::from_utf8(ply("ascii")).unwrap();
    let binary = ply("binary_little_endian");
    let of = |from: &str, to: &str| text.replacen(from, to, 1).into_bytes();
    for (name, bytes, expected) in [
        ("a.obj", Vec::new(), "no OBJ: it contains no face"),
        ("a.obj", b"<!DOCTYPE html>".to_vec(), "it contains no face"),
        (
            "a.obj",
            plain.replace("f 5 6 7 8", "f 5 6 7 9").into_bytes(),
            "line 12: \"9\" instead of one of its 8 vertices",
        ),
        (
            "a.obj",
            plain.replace("f 5 6 7 8", "f 5 6 0 8").into_bytes(),
            "line 12: \"0\" instead of the number of a vertex",
        ),
        (
            "a.obj",
            plain.replace("f 5 6 7 8", "f 5 6 -9 8").into_bytes(),
            "line 12: \"-9\" instead of",
        ),
        (
            "a.obj",
            plain
                .replace("f 5 6 7 8", "f 5/-7 6 -9223372036854775808")
                .into_bytes(),
            "instead of the number of a vertex",
        ),
        (
            "a.obj",
            plain.replace("f 5 6 7 8", "f 5 6").into_bytes(),
            "line 12: a face of 2 corners",
        ),
        (
            "a.obj",
            plain.replace("f 5 6 7 8", "f").into_bytes(),
            "line 12: a face without a corner",
        ),
        (
            "a.obj",
            plain.replace("v 60 60 0", "v 60 nan 0").into_bytes(),
            "\"nan\" instead of a number",
        ),
        (
            "a.obj",
            plain.replace("v 60 60 0", "v 60,0 60 0").into_bytes(),
            "\"60,0\" instead of a number",
        ),
        (
            "a.obj",
            plain.replace("v 60 60 0", "v 60 60").into_bytes(),
            "a vertex has three numbers",
        ),
        (
            "a.obj",
            format!("{plain}surf 0 1 0 1 1 2\n").into_bytes(),
            "a free-form surface is not a mesh",
        ),
        ("a.ply", Vec::new(), "no PLY: its header has no end_header"),
        (
            "a.ply",
            b"solid a\nend_header\n".to_vec(),
            "its first line is not \"ply\"",
        ),
        ("a.ply", of("ascii", "ebcdic"), "an unknown format"),
        (
            "a.ply",
            of("vertex 8", "vertex 9"),
            "line 22: \"1\" instead of the end of a line, by its header",
        ),
        (
            "a.ply",
            of("vertex 8", "vertex -8"),
            "line 4: \"element vertex -8\" is not a line",
        ),
        (
            "a.ply",
            of("vertex 8", "vertex 3000001"),
            "more than 1000000 triangles or 3000000 vertices",
        ),
        (
            "a.ply",
            of("face 6", "face 4000000000"),
            "it has 4000000000 triangles; at most 1000000 are possible; export",
        ),
        (
            "a.ply",
            of("face 6", "face 5"),
            "instead of the end of the data, by its header's counts",
        ),
        (
            "a.ply",
            of("vertex 8", "vertex 7"),
            "face 0: -60 instead of a list's length",
        ),
        (
            "a.ply",
            of("-60 -60.0 -20 255", "-60 -60.0 -20"),
            "line 15: \"60\" instead of a number of the line before, vertex 0",
        ),
        (
            "a.ply",
            of("float x", "float u"),
            "its vertices have no x, y and z",
        ),
        (
            "a.ply",
            of("vertex_indices", "corners"),
            "its faces have no vertex_indices",
        ),
        (
            "a.ply",
            of("4 4 5 6 7", "4 4 5 6 8"),
            "has a vertex that is missing",
        ),
        (
            "a.ply",
            of("4 4 5 6 7", "4 4 5 6 1.5"),
            "face 1: 1.5 instead of the number of a vertex",
        ),
        (
            "a.ply",
            of("-60 -60.0", "-60 6e1e"),
            "\"6e1e\" instead of a number",
        ),
        (
            "a.ply",
            of("-60 -60.0", "1e39 -60.0"),
            "has a vertex that is missing or not a number",
        ),
        (
            "a.ply",
            of("element edge", "element tristrips"),
            "strips, which this program does not support",
        ),
        (
            "a.ply",
            binary[..binary.len() - 30].to_vec(),
            "it ends in 4 of 6 (from 0) of the element face",
        ),
        (
            "a.ply",
            [&binary[..], b"..."].concat(),
            "3 bytes follow the data that its header announces",
        ),
    ] {
        let error = read(name, &bytes).expect_err(expected);
        assert!(error.contains(expected), "{expected}: {error}");
        assert!(!error.contains('\n') && error.len() < 400, "{error}");
    }
}

#[test]
fn ten_thousand_damaged_files_are_read_or_refused_in_a_line() {
    let mut seeded = Seeded(52);
    let whole: Vec<(&str, Vec<u8>)> = FORMS
        .iter()
        .map(|form| ("a.ply", ply(form)))
        .chain([("a.obj", obj().into_bytes())])
        .collect();
    let read = (0..10_000).filter(|number| {
        let (name, mut bytes) = whole[number % 4].clone();
        damage(&mut bytes, &mut seeded);
        is_read_as(name, &bytes)
    });
    let read = read.count();
    println!("{read} of 10000 were read");
    // The generator must make both files that are read and files that are refused.
    assert!((1000..9000).contains(&read), "{read} were read");
}

#[test]
fn more_triangles_than_are_read_are_refused_by_number() {
    let many = MOST_TRIANGLES + 1;
    let soup = [Vector::ZERO; 3];
    let refused = Mesh::new(&soup, &vec![[0, 1, 2]; many]).unwrap_err();
    assert_eq!(refused, MeshError::TooMany);
    let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{}", "f 1 2 3\n".repeat(many));
    let error = read("a.obj", text).unwrap_err();
    assert!(error.contains("more than 1000000 triangles"), "{error}");
    let facet =
        "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\n";
    let error = read("a.stl", format!("solid\n{}endsolid", facet.repeat(many))).unwrap_err();
    assert!(error.contains("more than 1000000 triangles"), "{error}");

    // Only the first bytes of this binary STL file are read; the rest of the file is sparse.
    let file = std::env::temp_dir().join(format!("touchstone-many-{}.stl", std::process::id()));
    let triangles = block([-1.0; 3], [1.0; 3]);
    std::fs::write(&file, stl::binary(b"many", many as u32, &triangles)).unwrap();
    let length = 84 + 50 * many as u64;
    std::fs::File::options()
        .write(true)
        .open(&file)
        .unwrap()
        .set_len(length)
        .unwrap();
    let error = Mesh::read(&file, 1e-3).unwrap_err().to_string();
    assert!(
        error.contains("it has 1000001 triangles; at most 1000000 are possible; export the object with fewer triangles"),
        "{error}"
    );
    std::fs::File::options()
        .write(true)
        .open(&file)
        .unwrap()
        .set_len(9_000_000_000)
        .unwrap();
    let error = Mesh::read(&file, 1e-3).unwrap_err().to_string();
    assert!(error.contains("larger than 128 MB, the limit"), "{error}");
    std::fs::remove_file(file).unwrap();
}
