//! Tests of STL files as common programs write them: variants of the text form, several solids, other formats stored as `.stl`, and
//! 10,000 generated files.

#[path = "../../../tests/made/choices.rs"]
mod choices;
#[path = "../../../tests/made/stl.rs"]
mod stl;

use choices::Seeded;
use std::path::Path;
use stl::{binary, block, is_read, made, solid};
use touchstone_mesh::Mesh;

fn slab() -> Vec<[[f64; 3]; 3]> {
    block([-60.0, -60.0, -20.0], [60.0, 60.0, 0.0])
}

fn read(name: &str, bytes: &[u8]) -> Result<Mesh, String> {
    Mesh::parse(bytes, Path::new(name), 1e-3).map_err(|error| error.to_string())
}

#[test]
fn text_reads_the_same_however_it_is_written() {
    let plain = solid("part", &slab());
    let lines: Vec<&str> = plain.lines().collect();
    for (name, text) in [
        ("plain", plain.clone()),
        ("upper", plain.to_uppercase()),
        (
            "title",
            plain
                .replace("solid part", "Solid part")
                .replace("vertex", "Vertex"),
        ),
        ("space", format!("  \n\t{plain}")),
        ("vertical-tab", format!("\u{b}{plain}")),
        ("padded", format!("{plain}\n\0\0\0")),
        ("crlf", plain.replace('\n', "\r\n")),
        ("cr", plain.replace('\n', "\r")),
        ("tabs", plain.replace("  ", "\t")),
        ("blank", lines.join("\n\n")),
        ("bom", format!("\u{feff}{plain}")),
        ("no-name", plain.replace(" part", "")),
        (
            "long-name",
            plain.replace(" part", &format!(" {}", "facet vertex ".repeat(400))),
        ),
        (
            "end-solid",
            plain
                .replace("endsolid", "end solid")
                .replace("endloop", "end loop"),
        ),
        (
            "nan-normal",
            plain.replace("normal 0 0 0", "normal nan -nan inf"),
        ),
        ("one-line", lines[1..].join(" ").replacen("", "solid\n", 1)),
        ("no-last-line-end", plain.trim_end().to_owned()),
        ("plus", plain.replace("vertex 6e1", "vertex +6.000E+001")),
    ] {
        let mesh = read(name, text.as_bytes()).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((mesh.triangles(), mesh.left_out()), (12, 0), "{name}");
        assert!(
            (mesh.signed_volume_m3() - 0.12 * 0.12 * 0.02).abs() < 1e-12,
            "{name}"
        );
    }
    // A name in Latin-1.
    let latin = [
        b"solid St\xfcck\n",
        &plain.as_bytes()["solid part\n".len()..],
    ]
    .concat();
    assert_eq!(read("latin", &latin).unwrap().triangles(), 12);
    // A binary file may call itself solid.
    let named = binary(b"solid part", 12, &slab());
    assert_eq!(read("binary-solid", &named).unwrap().triangles(), 12);
}

#[test]
fn all_solids_of_a_file_are_felt_in_any_order() {
    let button = block([-10.0, -10.0, 0.0], [10.0, 10.0, 20.0]);
    let [one, other] = [solid("slab", &slab()), solid("button", &button)];
    for (name, text) in [
        ("two", format!("{one}{other}")),
        ("swapped", format!("{other}{one}")),
        ("same-line", format!("{}\n\n\n{other}", one.trim_end())),
        ("second-upper", format!("{one}{}", other.to_uppercase())),
    ] {
        let mesh = read(name, text.as_bytes()).unwrap();
        assert_eq!((mesh.triangles(), mesh.solids()), (24, 2), "{name}");
        assert!((mesh.bounds_m()[1][2] - 0.02).abs() < 1e-9, "{name}");
    }
}

#[test]
fn what_is_no_stl_is_refused_by_what_it_is() {
    let good = binary(b"x", 12, &slab());
    let plain = solid("part", &slab());
    for (name, bytes, expected) in [
        ("empty", Vec::new(), "the file is empty"),
        (
            "empty-solid",
            b"solid a\nendsolid a\n".to_vec(),
            "it contains no facet",
        ),
        (
            "less",
            binary(b"x", 6, &slab()),
            "its header announces 6 triangles, but its 600 bytes of data hold 12",
        ),
        (
            "none",
            binary(b"x", 0, &slab()),
            "its header announces 0 triangles",
        ),
        (
            "huge",
            binary(b"x", u32::MAX, &slab()),
            "its header announces 4294967295 triangles, but its 600 bytes",
        ),
        (
            "cut",
            good[..good.len() - 30].to_vec(),
            "hold 11 and 20 bytes more",
        ),
        (
            "tail",
            [&good[..], &[0; 120]].concat(),
            "hold 14 and 20 bytes more",
        ),
        (
            "html",
            b"<!DOCTYPE html>\n<p>404</p>".to_vec(),
            "angle brackets",
        ),
        ("obj", b"v 0 0 0\nv 1 0 0\n".to_vec(), "it is OBJ"),
        ("png", b"\x89PNG\r\n\x1a\n...".to_vec(), "a PNG picture"),
        ("3mf", b"PK\x03\x04...".to_vec(), "a zip archive"),
        (
            "cut-text",
            plain[..plain.find("endsolid").unwrap()].into(),
            "the text ends at line 86 without endsolid, after 12 triangles",
        ),
        (
            "comma",
            plain.replace("6e1", "6,0").into_bytes(),
            "line 4: \"-6,0\" instead of a number",
        ),
        (
            "nan",
            plain.replacen("6e1", "nan", 1).into_bytes(),
            "line 4: \"-nan\" instead of a number",
        ),
        (
            "square",
            plain
                .replacen("endloop", "vertex 0 0 0\nendloop", 1)
                .into_bytes(),
            "instead of endloop",
        ),
    ] {
        let error = read(name, &bytes).expect_err(name);
        assert!(error.contains(expected), "{name}: {error}");
        assert!(
            !error.contains('\n') && error.len() < 400,
            "{name}: {error}"
        );
    }
}

#[test]
fn what_is_odd_is_noted_by_its_number() {
    let reach = [[-0.06; 3], [0.06; 3]];
    let notes = |name: &str, triangles: &[[[f64; 3]; 3]]| {
        read(name, solid("", triangles).as_bytes())
            .unwrap()
            .notes(reach)
    };
    assert_eq!(notes("fine", &slab()), Vec::<String>::new());
    let turned = |[a, b, c]: [[f64; 3]; 3]| [a, c, b];
    let moved = |by: f64, times: f64| -> Vec<[[f64; 3]; 3]> {
        let place = |corner: [f64; 3]| corner.map(|value| times * value + by);
        slab()
            .into_iter()
            .map(|corners| corners.map(place))
            .collect()
    };
    let inverted: Vec<_> = slab().into_iter().map(turned).collect();
    let half: Vec<_> = slab()
        .into_iter()
        .enumerate()
        .map(|(n, t)| if n < 6 { turned(t) } else { t })
        .collect();
    let button = block([-10.0, -10.0, 5.0], [10.0, 10.0, 25.0]);
    let hollow = block([-10.0, -10.0, -15.0], [10.0, 10.0, -5.0]);
    let turned_all = |solid: Vec<_>| solid.into_iter().map(turned).collect::<Vec<_>>();
    // A cavity in a block is valid and gives no warning.
    let with_hollow = [slab(), turned_all(hollow)].concat();
    assert_eq!(notes("hollow", &with_hollow), Vec::<String>::new());
    let ball_far_out = block([-1.0, -1.0, -1e6], [1.0, 1.0, -999_998.0]);
    for (name, triangles, expected) in [
        (
            "inverted",
            inverted,
            "its volume is -288.000 cm³: the mesh is inside out",
        ),
        ("half", half, "edges run the same way in both triangles"),
        (
            "one-turned",
            [&[turned(slab()[0])], &slab()[1..]].concat(),
            "3 edges run the same way",
        ),
        (
            "doubled",
            [slab(), slab()].concat(),
            "12 triangles lie on another one",
        ),
        (
            "doubled-turned",
            [slab(), slab().into_iter().map(turned).collect()].concat(),
            "12 triangles lie",
        ),
        (
            "open",
            slab()[1..].to_vec(),
            "3 edges belong to one triangle only",
        ),
        (
            "sheet",
            slab()[..2].to_vec(),
            "4 edges belong to one triangle only",
        ),
        (
            "far",
            moved(1000.0, 1.0),
            "does not meet the device's workspace",
        ),
        (
            "below",
            ball_far_out,
            "does not meet the device's workspace",
        ),
        ("metres", moved(0.0, 1e-3), "it is 0.1709 mm across"),
        ("micron", moved(0.0, 1e-4), "it is 0.0171 mm across"),
        (
            "one-of-two",
            [slab(), turned_all(button)].concat(),
            "1 of its 2 parts have a negative volume",
        ),
        (
            "kilometres",
            moved(0.0, 1e6),
            "it is 170880 m across, but the device reaches only 0.208 m",
        ),
        (
            "huge",
            moved(1e5, 1e4),
            "encloses the device's whole workspace",
        ),
    ] {
        let notes = notes(name, &triangles);
        assert!(
            notes.iter().any(|note| note.contains(expected)),
            "{name}: {notes:?}"
        );
    }
}

#[test]
fn ten_thousand_damaged_files_are_read_or_refused_in_a_line() {
    let mut seeded = Seeded(51);
    let read = (0..10_000).filter(|_| is_read(&made(&mut seeded))).count();
    println!("{read} of 10000 were read");
    // The generator must make both files that are read and files that are refused.
    assert!((1000..9000).contains(&read), "{read} were read");
}
