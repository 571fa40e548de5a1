//! Tests of a mesh as the object of the control crate's wall, and of meshes from STL files.

mod shapes;

use shapes::{ball, block, mm};
use touchstone_control::settings::FilterSettings;
use touchstone_control::space::{
    LengthUnit, Magnitude, Rule, Shell, SpaceWall, Surface as _, SurfacePoint, Vector,
};
use touchstone_control::{AnyLaw, Fixed32, Force, LawKind, Position, Reported, Settings, Si};
use touchstone_mesh::{Mesh, MeshSurface};

const UNIT: LengthUnit = LengthUnit::Centimetre;

fn at(x: f64, y: f64, z: f64) -> Vector<Position<Fixed32>> {
    Vector([x, y, z].map(|x| Position(<Fixed32 as Reported>::signal_from_f64(0.1 * x))))
}

fn spring() -> AnyLaw<Fixed32> {
    let thesis = Settings::thesis();
    let settings = Settings {
        law: LawKind::Spring,
        k_desired: Si::from_num(1000),
        k_soft: Si::from_num(500),
        force_limit: Si::from_num(12),
        filter: FilterSettings {
            stiffness: Si::from_num(5000),
            ..thesis.filter
        },
        ..thesis
    };
    UNIT.law(&settings).expect("settings")
}

/// Tests a wall of 1 N/mm on a box: the force is proportional to the depth and points along the normal; outside there is no force.
#[test]
fn a_wall_of_triangles_pushes_like_one_of_planes() {
    let mesh = block(20.0, 20.0, 20.0).mesh();
    let surface = MeshSurface::new(&mesh, UNIT);
    let shell = Shell::Magnitude(Magnitude::new(spring()));
    let limit = Force::from_si(Si::from_num(12)).expect("a limit");
    let mut wall = SpaceWall::new(surface, SurfacePoint::new(Rule::Closest), shell, limit);
    let force = |wall: &mut SpaceWall<Fixed32, MeshSurface<'_>, AnyLaw<Fixed32>>, place| {
        wall.tick(place)
            .expect("no guard")
            .0
            .map(|x| <Fixed32 as Reported>::signal_to_f64(x.0))
    };
    assert_eq!(force(&mut wall, at(1.0, 2.0, 21.0)), [0.0; 3]);
    let [x, y, z] = force(&mut wall, at(1.0, 2.0, 17.0));
    // A depth of 3 mm gives 3 N, to within the gap of 7 nm and one step of the number format.
    assert!(
        (z - 3.0).abs() < 2e-5 && x.abs() < 1e-5 && y.abs() < 1e-5,
        "{x} {y} {z}"
    );
    assert_eq!(force(&mut wall, at(1.0, 2.0, 30.0)), [0.0; 3]);
}

/// Tests that outside the object the reported depth is minus the distance from the surface.
#[test]
fn outside_it_says_how_far_the_surface_is() {
    let mesh = ball(20.0, 32).mesh();
    let surface = MeshSurface::new(&mesh, UNIT);
    for height in [20.5, 25.0, 60.0] {
        let nearest = surface.nearest(at(0.0, 0.0, height), &Default::default());
        let depth = 10.0 * <Fixed32 as Reported>::signal_to_f64(nearest.depth.0);
        assert!((depth + height - 20.0).abs() < 1e-3, "{depth} at {height}");
    }
    assert_eq!(surface.proxy_m().map(|[_, _, z]| z), Some(60e-3));
}

#[test]
fn stl_files_are_read_and_others_refused() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let file = folder.join("tetrahedron.stl");
    let facet = |[a, b, c]: [&str; 3]| {
        format!(
            "facet normal 0 0 0\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n"
        )
    };
    let [o, x, y, z] = ["0 0 0", "10 0 0", "0 10 0", "0 0 10"];
    let facets = [[o, y, x], [o, x, z], [o, z, y], [x, y, z]]
        .map(facet)
        .concat();
    std::fs::write(&file, format!("solid t\n{facets}endsolid t\n")).unwrap();
    let mesh = Mesh::read(&file, 1e-3).unwrap();
    assert_eq!((mesh.triangles(), mesh.left_out()), (4, 0));
    assert!((mesh.size_m() - mm(10.0, 10.0, 10.0).length()).abs() < 1e-9);

    let missing = Mesh::read(&folder.join("none.stl"), 1e-3)
        .unwrap_err()
        .to_string();
    assert!(
        missing.contains("none.stl") && missing.contains("give an STL file"),
        "{missing}"
    );
    let words = folder.join("words.stl");
    std::fs::write(&words, "not a mesh").unwrap();
    let refused = Mesh::read(&words, 1e-3).unwrap_err().to_string();
    assert!(
        refused.contains("words.stl") && refused.contains("export the object"),
        "{refused}"
    );
}
