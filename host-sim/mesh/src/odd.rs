//! Checks of a mesh that warn about likely mistakes: inside out, doubled triangles, open, out of reach, another unit.

use super::mesh::Mesh;
use parry3d_f64::math::Vector;
use std::collections::HashMap;

/// Diagonal below which a mesh is probably in another unit, m.
const LEAST_M: f64 = 1e-3;
/// A mesh is probably in another unit if its diagonal is more than this many times that of the box which the device reaches.
const MOST_TIMES: f64 = 100.0;

/// Numbers of irregular edges and triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Edges {
    /// Number of edges that belong to one triangle only: the mesh is open there.
    pub open: usize,
    /// Number of edges along which two triangles run in the same direction: one of the two triangles is inside out.
    pub same_way: usize,
    /// Number of triangles with the same corners as another triangle, in any order.
    pub doubled: usize,
}

/// A part of a mesh: triangles connected by common corners.
struct Part {
    from: Vector,
    volume_m3: f64,
    least: Vector,
    most: Vector,
}

impl Part {
    fn is_around(&self, other: &Self) -> bool {
        let [low, high] = [self.least, self.most].map(|at| at.to_array());
        let [least, most] = [other.least, other.most].map(|at| at.to_array());
        (0..3).all(|axis| low[axis] <= least[axis] && most[axis] <= high[axis])
    }
}

impl Mesh {
    /// Volume that the triangles of a closed mesh enclose, m³; negative if they are inside out.
    #[must_use]
    pub fn signed_volume_m3(&self) -> f64 {
        // Volumes are relative to a point of the mesh: relative to a far origin, rounding would cancel the result.
        let from = self
            .faces
            .first()
            .map_or(Vector::ZERO, |face| face.corners[0]);
        let six = |corners: [Vector; 3]| {
            let [a, b, c] = corners.map(|corner| corner - from);
            a.dot(b.cross(c))
        };
        self.faces.iter().map(|face| six(face.corners)).sum::<f64>() / 6.0
    }

    /// Volume and bounding box of each part of the mesh. Different parts share no corner.
    fn parts(&self) -> Vec<Part> {
        let mut numbers: HashMap<[u64; 3], usize> = HashMap::new();
        // For each corner the number of an earlier corner of the same part, up to the first one (union–find).
        let mut above: Vec<usize> = Vec::new();
        let root = |above: &mut Vec<usize>, mut at: usize| {
            while above[at] != at {
                above[at] = above[above[at]];
                at = above[at];
            }
            at
        };
        let mut first_corners = Vec::with_capacity(self.faces.len());
        for face in &self.faces {
            let corners = face.corners.map(|corner| {
                let key = corner.to_array().map(|value| (value + 0.0).to_bits());
                let number = *numbers.entry(key).or_insert(above.len());
                if number == above.len() {
                    above.push(number);
                }
                root(&mut above, number)
            });
            let least = corners.into_iter().min().unwrap_or(0);
            corners.into_iter().for_each(|corner| above[corner] = least);
            first_corners.push(least);
        }
        let mut parts: HashMap<usize, Part> = HashMap::new();
        for (face, corner) in self.faces.iter().zip(first_corners) {
            let part = parts.entry(root(&mut above, corner)).or_insert(Part {
                from: face.corners[0],
                volume_m3: 0.0,
                least: face.corners[0],
                most: face.corners[0],
            });
            let [a, b, c] = face.corners.map(|corner| corner - part.from);
            part.volume_m3 += a.dot(b.cross(c)) / 6.0;
            for corner in face.corners {
                part.least = part.least.min(corner);
                part.most = part.most.max(corner);
            }
        }
        parts.into_values().collect()
    }

    /// Number of parts that are inside out, and number of all parts. A part counts as inside out if its volume is negative and it
    /// is no hollow in another part.
    fn inside_out(&self) -> (usize, usize) {
        let parts = self.parts();
        let is_hollow = |part: &Part| {
            let around = |other: &&Part| other.volume_m3 > 0.0 && other.is_around(part);
            parts.iter().any(|other| around(&other))
        };
        let turned = parts
            .iter()
            .filter(|part| part.volume_m3 < 0.0 && !is_hollow(part));
        (turned.count(), parts.len())
    }

    /// Counts the irregular edges and triangles of the mesh.
    #[must_use]
    pub fn edges(&self) -> Edges {
        let key = |corner: Vector| corner.to_array().map(|value| (value + 0.0).to_bits());
        let mut ways: HashMap<[[u64; 3]; 2], (u32, u32)> = HashMap::new();
        let mut seen: HashMap<[[u64; 3]; 3], u32> = HashMap::new();
        let mut found = Edges::default();
        for face in &self.faces {
            let corners = face.corners.map(key);
            let mut sorted = corners;
            sorted.sort_unstable();
            let times = seen.entry(sorted).or_default();
            *times += 1;
            if *times > 1 {
                found.doubled += 1;
                continue;
            }
            for at in 0..3 {
                let (from, to) = (corners[at], corners[(at + 1) % 3]);
                let way = ways.entry([from.min(to), from.max(to)]).or_default();
                match from < to {
                    true => way.0 += 1,
                    false => way.1 += 1,
                }
            }
        }
        for (there, back) in ways.into_values() {
            found.open += usize::from(there + back == 1);
            // If more than two triangles share an edge, as where solids touch, only the numbers of both directions must match.
            found.same_way +=
                usize::from(there + back > 1 && there != back && (there + back) % 2 == 0);
        }
        found
    }

    /// The mesh's bounding box, m: smallest and largest coordinates.
    #[must_use]
    pub fn bounds_m(&self) -> [[f64; 3]; 2] {
        let around = self.tree.local_aabb();
        [around.mins.to_array(), around.maxs.to_array()]
    }

    /// Remarks on the mesh for a person, one per line. `workspace_m` is the box that the device reaches.
    #[must_use]
    pub fn notes(&self, workspace_m: [[f64; 3]; 2]) -> Vec<String> {
        let mut notes = Vec::new();
        let edges = self.edges();
        let volume = self.signed_volume_m3();
        if self.solids() > 1 {
            notes.push(format!(
                "the file has {} solids; all are felt",
                self.solids()
            ));
        }
        if edges.doubled > 0 {
            notes.push(format!(
                "{} triangles lie on another one: parts of the mesh are doubled",
                edges.doubled
            ));
        }
        if edges.same_way > 0 {
            notes.push(format!(
                "{} edges run the same way in both triangles: some triangles are inside out and let the hand through",
                edges.same_way
            ));
        }
        if edges.open > 0 {
            notes.push(format!(
                "{} edges belong to one triangle alone: the mesh is open, its front alone is felt",
                edges.open
            ));
        } else if edges.same_way == 0 && volume < 0.0 {
            notes.push(format!(
                "its volume is {:.3} cm³: it is inside out, and nothing is felt from outside; flip its normals",
                1e6 * volume
            ));
        } else if edges.same_way == 0
            && let (turned @ 1.., parts) = self.inside_out()
        {
            notes.push(format!(
                "{turned} of its {parts} parts are inside out by their volume, and nothing of them is felt from outside; flip their normals"
            ));
        }
        let [least, most] = self.bounds_m();
        let [low, high] = workspace_m;
        let reach_m = (Vector::from_array(high) - Vector::from_array(low)).length();
        let mm = |metres: [f64; 3]| metres.map(|value| format!("{:.1}", 1e3 * value)).join(", ");
        if self.size_m() < LEAST_M {
            notes.push(format!(
                "it is {:.4} mm across: is --stl-unit-m its unit?",
                1e3 * self.size_m()
            ));
        } else if (0..3).any(|axis| least[axis] > high[axis] || most[axis] < low[axis]) {
            notes.push(format!(
                "its box from ({}) to ({}) mm does not meet the device's workspace from ({}) to ({}) mm: nothing is felt; move it, or give --stl-unit-m",
                mm(least), mm(most), mm(low), mm(high)
            ));
        } else if (0..3).all(|axis| least[axis] < low[axis] && most[axis] > high[axis]) {
            notes.push(format!(
                "its box from ({}) to ({}) mm encloses the device's whole workspace: is --stl-unit-m its unit?",
                mm(least), mm(most)
            ));
        } else if self.size_m() > MOST_TIMES * reach_m {
            notes.push(format!(
                "it is {:.0} m across, where the device reaches {reach_m:.3} m: is --stl-unit-m its unit?",
                self.size_m()
            ));
        }
        notes
    }
}
